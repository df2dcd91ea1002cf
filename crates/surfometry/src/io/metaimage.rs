//! MetaImage headers: .mha, and .mhd with a raw file.
//!
//! # References
//! <https://itk.org/Wiki/ITK/MetaIO/Documentation>. World coordinates are LPS.

use super::file_series::{self, FileSeries};
use super::header::{
    ByteOrder, DataOffset, Encoding, ImageHeader, OpenedFile, VoxelData, Voxels, three_dimensions,
};
use super::packed::Packed;
use super::text_header::{Lines, beside, mm_per, numbers};
use super::{Format, ReadError};
use crate::volume::{Affine, LabelTable, ScalarType};
use std::collections::HashMap;
use std::path::Path;

/// Axes that MetaIO allows.
const MOST_AXES: usize = 10;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "MetaImage", reason: reason.into() }
}

/// Reads the header of a .mha or .mhd file.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let mut lines = Lines::of(path)?;
    let keys = Keys::read(&mut lines)?;
    let axes: Vec<usize> =
        keys.list("DimSize")?.ok_or_else(|| error("no DimSize; is this a MetaImage file?"))?;
    if axes.len() > MOST_AXES {
        return Err(error(format!("{} axes; MetaImage has at most {MOST_AXES}", axes.len())));
    }
    let channels: usize = keys.one("ElementNumberOfChannels")?.unwrap_or(1);
    if channels > 1 {
        return Err(ReadError::SeveralVolumes { dimensions: axes, count: channels });
    }
    let dimensions = three_dimensions(&axes)?;
    let scalar = scalar(keys.text("ElementType").unwrap_or("none"))?;
    let affine = affine(&keys, axes.len())?;
    let data = if let Some(series) = series(path, &keys, &mut lines, scalar)? {
        series.voxels(dimensions, scalar.bytes()).map_err(error)?
    } else {
        let position = lines.position();
        Voxels::Stored(data(path, &keys, position, lines.into_file())?)
    };
    let stated_spacing = spacing(&keys)?;
    Ok(ImageHeader {
        path: path.to_owned(),
        format: Format::MetaImage,
        dimensions,
        scalar,
        affine,
        stated_spacing,
        unknown_unit: unit(&keys).err(),
        other_spacing: None,
        labels: LabelTable::default(),
        data,
    })
}

/// `Key = Value` lines, or `Key: Value`, as MetaIO reads them, up to ElementDataFile, which is the last.
struct Keys(HashMap<String, String>);

impl Keys {
    fn read(lines: &mut Lines) -> Result<Self, ReadError> {
        let mut keys = HashMap::new();
        for line in lines {
            let Some((key, value)) = line.split_once(['=', ':']) else {
                return Err(error("a line without `=`; the file is not MetaImage, whatever its name"));
            };
            let last = key.trim() == "ElementDataFile";
            keys.insert(key.trim().to_owned(), value.trim().to_owned());
            if last {
                return Ok(Self(keys));
            }
        }
        Err(error("no ElementDataFile line; the header is incomplete"))
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    fn list<T: std::str::FromStr>(&self, key: &str) -> Result<Option<Vec<T>>, ReadError> {
        let Some(text) = self.text(key) else { return Ok(None) };
        numbers(text).map(Some).ok_or_else(|| error(format!("{key} = {text} cannot be read as numbers")))
    }

    fn one<T: std::str::FromStr + Copy>(&self, key: &str) -> Result<Option<T>, ReadError> {
        Ok(self.list(key)?.and_then(|list| list.first().copied()))
    }

    /// Whether a key says yes, no, or is not there. MetaIO looks at the first letter.
    fn flag(&self, key: &str) -> Result<Option<bool>, ReadError> {
        let Some(text) = self.text(key) else { return Ok(None) };
        match text.as_bytes().first() {
            Some(b'T' | b't' | b'1') => Ok(Some(true)),
            Some(b'F' | b'f' | b'0') => Ok(Some(false)),
            _ => Err(error(format!("{key} = {text} is neither True nor False"))),
        }
    }
}

fn scalar(name: &str) -> Result<ScalarType, ReadError> {
    Ok(match name {
        "MET_UCHAR" => ScalarType::U8,
        "MET_CHAR" => ScalarType::I8,
        "MET_USHORT" => ScalarType::U16,
        "MET_SHORT" => ScalarType::I16,
        // MetaIO's long is four bytes wide, on every machine.
        "MET_UINT" | "MET_ULONG" => ScalarType::U32,
        "MET_INT" | "MET_LONG" => ScalarType::I32,
        "MET_ULONG_LONG" => ScalarType::U64,
        "MET_LONG_LONG" => ScalarType::I64,
        "MET_FLOAT" => ScalarType::F32,
        "MET_DOUBLE" => ScalarType::F64,
        other => return Err(ReadError::VoxelType(other.to_owned())),
    })
}

/// mm in the header's unit of length, or its name where it is not known; mm where none is named.
fn unit(keys: &Keys) -> Result<f64, String> {
    let name = keys.text("DistanceUnits").unwrap_or("mm");
    mm_per(name).ok_or_else(|| name.to_owned())
}

fn spacing(keys: &Keys) -> Result<Option<[f64; 3]>, ReadError> {
    match keys.list::<f64>("ElementSpacing")?.or(keys.list("ElementSize")?).as_deref() {
        None => Ok(None),
        Some(&[x, y, z, ..]) => Ok(Some([x, y, z])),
        Some(_) => Err(error("ElementSpacing has fewer than three values")),
    }
}

fn affine(keys: &Keys, axes: usize) -> Result<Option<Affine>, ReadError> {
    let Some(spacing) = spacing(keys)? else { return Ok(None) };
    let first = |key: &str| -> Result<Option<Vec<f64>>, ReadError> { keys.list(key) };
    // Rows of the matrix are the directions of the image axes.
    let matrix = match first("TransformMatrix")?.or(first("Rotation")?).or(first("Orientation")?) {
        Some(matrix) => matrix,
        None => (0..axes * axes).map(|i| f64::from(u8::from(i % (axes + 1) == 0))).collect(),
    };
    let origin = match first("Offset")?.or(first("Position")?).or(first("Origin")?) {
        Some(origin) => origin,
        None => vec![0.0; axes],
    };
    if matrix.len() != axes * axes || origin.len() < 3 {
        return Err(error("TransformMatrix or Offset have the wrong number of values"));
    }
    let directions = std::array::from_fn(|a| std::array::from_fn(|w| matrix[a * axes + w]));
    let affine = Affine::from_directions(directions, spacing, [origin[0], origin[1], origin[2]]);
    Ok(Some(affine.with_lps_swapped().scaled(unit(keys).unwrap_or(1.0))))
}

/// The data files, where there are several.
fn series(
    path: &Path,
    keys: &Keys,
    lines: &mut Lines,
    scalar: ScalarType,
) -> Result<Option<FileSeries>, ReadError> {
    let file = keys.text("ElementDataFile").unwrap_or_default();
    let Some(files) = file_series::files_named(path, file, lines) else { return Ok(None) };
    let files = files.map_err(|wrong| error(format!("ElementDataFile = {file} {wrong}")))?;
    let Storage { encoding, order, offset } = storage(keys)?;
    Ok(Some(FileSeries { files, encoding, offset, order, width: scalar.bytes() }))
}

/// How voxels are stored that are not behind the header.
struct Storage {
    encoding: Encoding,
    order: ByteOrder,
    offset: DataOffset,
}

fn storage(keys: &Keys) -> Result<Storage, ReadError> {
    if keys.flag("BinaryData")? == Some(false) {
        return Err(error("voxels written as text; save the image with binary data"));
    }
    let big = keys.flag("BinaryDataByteOrderMSB")?.or(keys.flag("ElementByteOrderMSB")?) == Some(true);
    let compressed = keys.flag("CompressedData")? == Some(true);
    let encoding = if compressed { Encoding::Zlib } else { Encoding::Raw };
    let order = if big { ByteOrder::Big } else { ByteOrder::Little };
    let offset = match keys.one::<i64>("HeaderSize")?.unwrap_or(0) {
        -1 => DataOffset::FromEnd,
        skip => DataOffset::Stored(u64::try_from(skip).map_err(|_| error(format!("HeaderSize = {skip}")))?),
    };
    Ok(Storage { encoding, order, offset })
}

fn data(path: &Path, keys: &Keys, header_end: u64, header: Packed) -> Result<VoxelData, ReadError> {
    let file = keys.text("ElementDataFile").unwrap_or_default();
    let Storage { encoding, order, offset } = storage(keys)?;
    if file.eq_ignore_ascii_case("local") {
        // MetaIO counts HeaderSize from the file's beginning, and -1 from its end.
        return match offset {
            DataOffset::FromEnd if encoding == Encoding::Raw && !header.is_packed() => {
                Ok(VoxelData { offset, ..header.data(0, encoding, order)? })
            }
            DataOffset::FromEnd => Err(error("HeaderSize = -1 with compressed data is not supported")),
            DataOffset::Stored(start) if start > 0 => header.data(start, encoding, order),
            _ => header.data(header_end, encoding, order),
        };
    }
    let path = beside(path, file);
    Ok(VoxelData { path, opened: OpenedFile::default(), encoding, offset, order, scaling: None })
}
