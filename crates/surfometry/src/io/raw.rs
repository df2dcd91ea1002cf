//! Voxels without a header, of which the caller says how they are stored.

use super::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, ReadError};
use crate::volume::ScalarType;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::str::FromStr;
use thiserror::Error;

/// How a file without a header stores its voxels: `80x50x83:uint16`, then `:big` where numbers of several bytes are
/// not little-endian, and `:512` where so many bytes stand in front.
///
/// ```
/// use surfometry::io::RawLayout;
/// let layout: RawLayout = "80x50x83:uint16:big:512".parse()?;
/// assert_eq!(layout.to_string(), "80x50x83:uint16:big:512");
/// # Ok::<(), surfometry::io::RawLayoutError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct RawLayout {
    /// Voxels along x, y, z; x is the fastest in memory.
    dimensions: [usize; 3],
    scalar: ScalarType,
    order: ByteOrder,
    /// Bytes in front of the first voxel.
    offset: u64,
}

/// Text that is no [`RawLayout`].
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "`{0}`: write X x Y x Z voxels, the fastest axis first, and their type, as 80x50x83:uint16; behind them, where it is so, :big \
     for big-endian numbers and :N for N bytes in front of the voxels; types are uint8 to uint64, int8 to int64, float32, float64"
)]
pub struct RawLayoutError(String);

const TYPES: [ScalarType; 10] = [
    ScalarType::U8,
    ScalarType::I8,
    ScalarType::U16,
    ScalarType::I16,
    ScalarType::U32,
    ScalarType::I32,
    ScalarType::U64,
    ScalarType::I64,
    ScalarType::F32,
    ScalarType::F64,
];

impl FromStr for RawLayout {
    type Err = RawLayoutError;

    fn from_str(text: &str) -> Result<Self, RawLayoutError> {
        let wrong = || RawLayoutError(text.to_owned());
        let mut parts = text.split(':');
        let sizes = parts.next().unwrap_or_default().split('x').map(|n| n.trim().parse::<usize>());
        let sizes = sizes.collect::<Result<Vec<_>, _>>().map_err(|_| wrong())?;
        let name = parts.next().unwrap_or_default();
        let mut layout = Self {
            dimensions: sizes.try_into().map_err(|_| wrong())?,
            scalar: TYPES.into_iter().find(|scalar| scalar.name() == name).ok_or_else(wrong)?,
            order: ByteOrder::Little,
            offset: 0,
        };
        for part in parts {
            match part {
                "little" => layout.order = ByteOrder::Little,
                "big" => layout.order = ByteOrder::Big,
                bytes => layout.offset = bytes.parse().map_err(|_| wrong())?,
            }
        }
        Ok(layout)
    }
}

impl TryFrom<String> for RawLayout {
    type Error = RawLayoutError;

    fn try_from(text: String) -> Result<Self, RawLayoutError> {
        text.parse()
    }
}

impl From<RawLayout> for String {
    fn from(layout: RawLayout) -> Self {
        layout.to_string()
    }
}

impl std::fmt::Display for RawLayout {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.dimensions;
        write!(f, "{x}x{y}x{z}:{}", self.scalar.name())?;
        if self.order == ByteOrder::Big {
            write!(f, ":big")?;
        }
        if self.offset > 0 { write!(f, ":{}", self.offset) } else { Ok(()) }
    }
}

/// The header that a file of this layout would have.
pub(crate) fn read_header(path: &Path, layout: RawLayout) -> Result<ImageHeader, ReadError> {
    let dimensions = three_dimensions(&layout.dimensions)?;
    let data = Packed::open(path)?.data(layout.offset, Encoding::Raw, layout.order)?;
    Ok(ImageHeader::new(path, Format::Raw, dimensions, layout.scalar, Voxels::Stored(data)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_written_as_they_are_read() {
        for text in ["80x50x83:uint8", "1x2x3:int64:big", "4x5x6:float32:512", "4x5x6:uint16:big:348"] {
            assert_eq!(text.parse::<RawLayout>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "80x50:uint8",
            "80x50x83",
            "80x50x83:short",
            "axbxc:uint8",
            "8x8x8:uint8:-1",
            "8x8x8:uint8:middle",
        ] {
            let said = text.parse::<RawLayout>().unwrap_err().to_string();
            assert!(said.contains("80x50x83:uint16"), "{text}: {said}");
        }
    }
}
