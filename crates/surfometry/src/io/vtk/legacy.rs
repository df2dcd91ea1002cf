//! Legacy VTK files that hold an image: DATASET STRUCTURED_POINTS, as text or binary, which is big-endian.
//!
//! # References
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>.

use super::{GHOSTS, lattice};
use crate::io::assembled::{AssembleVoxels, Assembled, Pieces};
use crate::io::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use crate::io::packed::PackedStretch;
use crate::io::text_header::{Lines, numbers};
use crate::io::text_numbers::TextNumbers;
use crate::io::{Format, ReadError};
use crate::volume::{Affine, ScalarType};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::LegacyVtk.name(), reason: reason.into() }
}

/// Reads the header of a .vtk file.
pub(in crate::io) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let mut lines = Lines::of(path)?;
    let fields = Fields::read(&mut lines)?;
    let (dimensions, origin) = lattice(fields.points, fields.origin, fields.spacing, fields.cells);
    let dimensions = three_dimensions(&dimensions)?;
    let values = dimensions.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
    if values != Some(fields.values) {
        return Err(error(format!(
            "{} values, where DIMENSIONS {:?} need another number; export the image again",
            fields.values, fields.points
        )));
    }
    let at = lines.position();
    let data = if fields.binary {
        Voxels::Stored(lines.into_file().data(at, Encoding::Raw, ByteOrder::Big)?)
    } else {
        let (scalar, shares, voxels) = (fields.scalar, fields.shares, fields.values as u64);
        let text = Text { path: path.to_owned(), at, scalar, shares, voxels };
        Voxels::Assembled(Assembled(Arc::new(text)))
    };
    Ok(ImageHeader {
        affine: Some(Affine { origin, ..Affine::diagonal(fields.spacing) }),
        stated_spacing: Some(fields.spacing),
        ..ImageHeader::new(path, Format::LegacyVtk, dimensions, fields.scalar, data)
    })
}

/// What stands in front of the first array.
struct Fields {
    points: [usize; 3],
    spacing: [f64; 3],
    origin: [f64; 3],
    binary: bool,
    cells: bool,
    scalar: ScalarType,
    /// Whether text has shares of 255, as that of bytes has: VTK calls them colours.
    shares: bool,
    values: usize,
}

impl Fields {
    fn read(lines: &mut Lines) -> Result<Self, ReadError> {
        if !lines.next().is_some_and(|magic| magic.starts_with("# vtk DataFile")) {
            return Err(error("no `# vtk DataFile` in front; is this a legacy VTK file?"));
        }
        let _title = lines.next();
        let binary = match lines.next().unwrap_or_default().trim().to_uppercase().as_str() {
            "BINARY" => true,
            "ASCII" => false,
            other => return Err(error(format!("`{other}`, where ASCII or BINARY should stand"))),
        };
        let (mut points, mut spacing, mut origin) = (None, None, [0.0; 3]);
        let mut of: Option<(bool, usize)> = None;
        while let Some(line) = lines.next() {
            let (key, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
            let key = key.to_uppercase();
            match key.as_str() {
                "" => {}
                "DATASET" if rest.trim().eq_ignore_ascii_case("STRUCTURED_POINTS") => {}
                "DATASET" => {
                    return Err(error(format!(
                        "DATASET {rest}, where images are STRUCTURED_POINTS; resample it to an image, or save its surface as PLY or STL"
                    )));
                }
                "DIMENSIONS" => points = Some(three::<usize>(&key, rest)?),
                "SPACING" | "ASPECT_RATIO" => spacing = Some(three::<f64>(&key, rest)?),
                "ORIGIN" => origin = three(&key, rest)?,
                "POINT_DATA" | "CELL_DATA" => {
                    let count =
                        rest.trim().parse().map_err(|_| error(format!("{key} {rest} is no number")))?;
                    of = Some((key == "CELL_DATA", count));
                }
                "SCALARS" | "COLOR_SCALARS" | "FIELD" if of.is_some() => {
                    let (scalar, components) = match key.as_str() {
                        "SCALARS" => scalars(rest, lines)?,
                        "COLOR_SCALARS" => (ScalarType::U8, colours(rest)?),
                        _ => field(lines)?,
                    };
                    if components != 1 {
                        return Err(error(format!(
                            "{components} components a voxel; save the label image alone, with one"
                        )));
                    }
                    let (cells, values) = of.unwrap_or_default();
                    let points = points.ok_or_else(|| error("no DIMENSIONS; export the image again"))?;
                    let spacing = spacing.ok_or_else(|| error("no SPACING; export the image again"))?;
                    let shares = key == "COLOR_SCALARS";
                    return Ok(Self { points, spacing, origin, binary, cells, scalar, shares, values });
                }
                other => {
                    return Err(error(format!(
                        "`{other}` in front of the voxels is not read; save the image as .vti, or with SCALARS first"
                    )));
                }
            }
        }
        Err(error("no SCALARS; the file holds no image, or ends early"))
    }
}

fn three<T: std::str::FromStr + Copy>(key: &str, text: &str) -> Result<[T; 3], ReadError> {
    let list: Option<Vec<T>> = numbers(text);
    list.and_then(|list| list.try_into().ok())
        .ok_or_else(|| error(format!("{key} {text} is not three numbers")))
}

/// `SCALARS name type [components]`, then a line that names a lookup table.
fn scalars(rest: &str, lines: &mut Lines) -> Result<(ScalarType, usize), ReadError> {
    let words: Vec<&str> = rest.split_whitespace().collect();
    let scalar = scalar(words.get(1).copied().unwrap_or_default())?;
    let components =
        words.get(2).map_or(Some(1), |n| n.parse().ok()).ok_or_else(|| error(format!("SCALARS {rest}")))?;
    if !lines.next().is_some_and(|line| line.trim().to_uppercase().starts_with("LOOKUP_TABLE")) {
        return Err(error("no LOOKUP_TABLE behind SCALARS; export the image again"));
    }
    Ok((scalar, components))
}

/// `COLOR_SCALARS name components`.
fn colours(rest: &str) -> Result<usize, ReadError> {
    let components = rest.split_whitespace().nth(1).and_then(|n| n.parse().ok());
    components.ok_or_else(|| error(format!("COLOR_SCALARS {rest} has no number of components")))
}

/// The first array of a field: `name components tuples type`.
fn field(lines: &mut Lines) -> Result<(ScalarType, usize), ReadError> {
    let line = lines.next().unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        [GHOSTS, ..] => Err(error(format!(
            "an array {GHOSTS}, which marks what does not count, stands in front of the voxels; save the image as .vti, or with its \
             labels as the active scalars"
        ))),
        [_, components, _, kind] => {
            let components =
                components.parse().map_err(|_| error(format!("`{line}` is no array of a field")))?;
            Ok((scalar(kind)?, components))
        }
        _ => Err(error(format!("`{line}` is no array of a field"))),
    }
}

fn scalar(name: &str) -> Result<ScalarType, ReadError> {
    Ok(match name.to_lowercase().as_str() {
        "unsigned_char" => ScalarType::U8,
        "char" | "signed_char" => ScalarType::I8,
        "unsigned_short" => ScalarType::U16,
        "short" => ScalarType::I16,
        "unsigned_int" => ScalarType::U32,
        "int" => ScalarType::I32,
        // Eight bytes where files are written today, but for Windows, which writes vtktypeint64.
        "unsigned_long" | "vtktypeuint64" => ScalarType::U64,
        "long" | "vtktypeint64" | "vtkidtype" => ScalarType::I64,
        "float" => ScalarType::F32,
        "double" => ScalarType::F64,
        other => return Err(ReadError::VoxelType(format!("VTK {other}"))),
    })
}

/// Voxels as text.
#[derive(Debug)]
struct Text {
    path: PathBuf,
    at: u64,
    scalar: ScalarType,
    shares: bool,
    voxels: u64,
}

impl AssembleVoxels for Text {
    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let stored = PackedStretch::open(&self.path, self.at, u64::MAX)?;
        let mut numbers = if self.shares {
            TextNumbers::shares(stored, self.voxels)
        } else {
            TextNumbers::new(stored, self.scalar, self.voxels)
        };
        Ok(Box::new(Pieces::new(move || numbers.next())))
    }
}
