//! NRRD headers: attached and detached; raw, gzip and bzip2.
//!
//! # References
//! <https://teem.sourceforge.net/nrrd/format.html>.

use super::file_series::{self, FileSeries};
use super::header::{
    ByteOrder, DataOffset, Encoding, ImageHeader, OpenedFile, VoxelData, Voxels, refuse_several,
    three_dimensions,
};
use super::packed::Packed;
use super::text_header::{Lines, beside, mm_per, numbers};
use super::{Format, ReadError, segmentation};
use crate::volume::{Affine, LabelTable, ScalarType};
use std::collections::HashMap;
use std::path::Path;

/// Axes that the format allows (NRRD_DIM_MAX).
const MOST_AXES: usize = 16;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "NRRD", reason: reason.into() }
}

/// Reads the header of a .nrrd or .nhdr file.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let mut lines = Lines::of(path)?;
    if !lines.next().is_some_and(|magic| magic.starts_with("NRRD000")) {
        return Err(error("no NRRD magic; the file is not NRRD, whatever its name"));
    }
    let fields = Fields::read(&mut lines)?;
    let sizes: Vec<usize> =
        numbers(fields.required("sizes")?).ok_or_else(|| error("`sizes` cannot be read"))?;
    if sizes.len() > MOST_AXES {
        return Err(error(format!("{} axes; NRRD has at most {MOST_AXES}", sizes.len())));
    }
    let scalar = scalar(fields.required("type")?)?;
    let is_segmentation = segmentation::is_segmentation(&fields.pairs);
    if is_segmentation && sizes.iter().all(|&n| n == 1) {
        return Err(ReadError::NoSegments);
    }
    let (axes, layers) = spatial_axes(&fields, &sizes, is_segmentation)?;
    let dimensions = three_dimensions(&axes.iter().map(|&a| sizes[a]).collect::<Vec<_>>())?;
    let Geometry { affine, stated_spacing } = geometry(&fields, &axes)?;
    let unknown_unit = unit(&fields, &axes)?.err();
    let data = if let Some(series) = series(path, &fields, &mut lines, scalar)? {
        series.voxels(dimensions, scalar.bytes()).map_err(error)?
    } else {
        let position = lines.position();
        Voxels::Stored(data(path, &fields, scalar, position, lines.into_file())?)
    };
    let header = ImageHeader {
        path: path.to_owned(),
        format: Format::Nrrd,
        dimensions,
        scalar,
        affine,
        stated_spacing,
        unknown_unit,
        other_spacing: None,
        labels: LabelTable::default(),
        data,
    };
    if is_segmentation { segmentation::of_segments(header, layers, &fields.pairs) } else { Ok(header) }
}

/// `field: value` lines up to the blank one.
struct Fields {
    fields: HashMap<String, String>,
    /// `key:=value`: the user's own, and segments of 3D Slicer's.
    pairs: HashMap<String, String>,
}

impl Fields {
    fn read(lines: &mut Lines) -> Result<Self, ReadError> {
        let (mut fields, mut pairs) = (HashMap::new(), HashMap::new());
        for line in lines {
            if line.is_empty() {
                break;
            }
            let field = line.split_once(':').filter(|_| !line.starts_with('#'));
            let Some((key, value)) = field else { continue };
            if let Some(value) = value.strip_prefix('=') {
                pairs.insert(key.trim().to_owned(), value.to_owned());
                continue;
            }
            let (key, value) = (key.trim().to_lowercase(), value.trim().to_owned());
            // The header's last line: the files' names follow.
            let is_last = value.starts_with("LIST") && key.replace(' ', "") == "datafile";
            if let Some(earlier) =
                fields.insert(key.clone(), value.clone()).filter(|earlier| *earlier != value)
            {
                return Err(error(format!(
                    "`{key}` stands there twice, as `{earlier}` and as `{value}`; take out the one that is wrong"
                )));
            }
            if is_last {
                break;
            }
        }
        Ok(Self { fields, pairs })
    }

    fn get(&self, names: &[&str]) -> Option<&str> {
        names.iter().find_map(|n| self.fields.get(*n)).map(String::as_str)
    }

    fn required(&self, name: &str) -> Result<&str, ReadError> {
        self.get(&[name]).ok_or_else(|| error(format!("no `{name}` field; the header is incomplete")))
    }
}

fn scalar(name: &str) -> Result<ScalarType, ReadError> {
    Ok(match name {
        "signed char" | "int8" | "int8_t" => ScalarType::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => ScalarType::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => ScalarType::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => ScalarType::U16,
        "int" | "signed int" | "int32" | "int32_t" => ScalarType::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => ScalarType::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => ScalarType::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            ScalarType::U64
        }
        "float" => ScalarType::F32,
        "double" => ScalarType::F64,
        other => return Err(ReadError::VoxelType(other.to_owned())),
    })
}

/// The axes that are space, and how many layers of segments alternate along the first. Other axes (vectors, time) may only
/// have one sample.
fn spatial_axes(
    fields: &Fields,
    sizes: &[usize],
    is_segmentation: bool,
) -> Result<(Vec<usize>, usize), ReadError> {
    let directions = fields.get(&["space directions"]).map(directions_of);
    let is_space = |axis: usize| match (&directions, fields.get(&["kinds"])) {
        (Some(directions), _) => directions.get(axis).is_none_or(Option::is_some),
        (None, Some(kinds)) => {
            kinds.split_whitespace().nth(axis).is_none_or(|k| matches!(k, "domain" | "space" | "???"))
        }
        (None, None) => axis < 3,
    };
    let (space, other): (Vec<usize>, Vec<usize>) = (0..sizes.len()).partition(|&a| is_space(a));
    if is_segmentation && other == [0] && sizes[0] > 0 {
        return Ok((space, sizes[0]));
    }
    refuse_several(sizes, other.iter().map(|&a| &sizes[a]))?;
    Ok((space, 1))
}

/// The vectors of `space directions`, `None` for `none`. Entries that cannot be read become NaN, which the
/// grid refuses.
fn directions_of(text: &str) -> Vec<Option<Vec<f64>>> {
    let mut directions = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            directions.push(None);
            rest = after.trim_start();
        } else {
            let (vector, after) = rest.split_once(')').unwrap_or((rest, ""));
            directions.push(Some(vector_of(vector)));
            rest = after.trim_start();
        }
    }
    directions
}

fn vector_of(text: &str) -> Vec<f64> {
    let inner = text.trim().trim_start_matches('(').trim_end_matches(')');
    inner.split(',').map(|v| v.trim().parse().unwrap_or(f64::NAN)).collect()
}

/// Where the lattice lies, and the spacing that this was made from.
#[derive(Default)]
struct Geometry {
    affine: Option<Affine>,
    stated_spacing: Option<[f64; 3]>,
}

fn geometry(fields: &Fields, axes: &[usize]) -> Result<Geometry, ReadError> {
    let unit = unit(fields, axes)?.unwrap_or(1.0);
    if let Some(text) = fields.get(&["space directions"]) {
        let columns: Vec<Vec<f64>> = directions_of(text).into_iter().flatten().collect();
        let origin = fields.get(&["space origin"]).map_or_else(|| vec![0.0; 3], vector_of);
        // A space of four dimensions, as of ITK's images of one time point, has three in front.
        let in_space = |vector: &Vec<f64>| vector.len() >= 3 && vector[3..].iter().all(|v| *v == 0.0);
        if columns.len() < 3 || !columns[..3].iter().all(in_space) || origin.len() < 3 {
            return Err(error("`space directions` and `space origin` must be vectors of three numbers"));
        }
        let linear = std::array::from_fn(|w| std::array::from_fn(|a| columns[a][w]));
        let affine = Affine { linear, origin: [origin[0], origin[1], origin[2]] }.scaled(unit);
        let affine = to_ras(affine, fields.get(&["space"]).unwrap_or_default())?;
        return Ok(Geometry { affine: Some(affine), stated_spacing: None });
    }
    let Some(text) = fields.get(&["spacings"]) else { return Ok(Geometry::default()) };
    let spacings: Vec<f64> =
        numbers(text).ok_or_else(|| error(format!("`spacings: {text}` cannot be read")))?;
    match axes.iter().map(|&a| spacings.get(a).map(|s| s * unit)).collect::<Option<Vec<_>>>().as_deref() {
        Some(&[x, y, z, ..]) => {
            let origin = first_voxel(fields, axes, [x, y, z], unit)?;
            let affine = to_ras(Affine { origin, ..Affine::diagonal([x, y, z]) }, "")?;
            Ok(Geometry { affine: Some(affine), stated_spacing: Some([x, y, z]) })
        }
        _ => Err(error("`spacings` has fewer values than there are axes")),
    }
}

/// Where the first voxel lies of an image without directions: at the least position along each axis, or, as ITK has it, half
/// a voxel on, unless samples are said to be nodes. Zero where not all axes have one.
fn first_voxel(fields: &Fields, axes: &[usize], spacing: [f64; 3], unit: f64) -> Result<[f64; 3], ReadError> {
    let Some(text) = fields.get(&["axis mins", "axismins"]) else { return Ok([0.0; 3]) };
    let least: Vec<f64> =
        numbers(text).ok_or_else(|| error(format!("`axis mins: {text}` cannot be read")))?;
    let least: [f64; 3] = std::array::from_fn(|a| {
        axes.get(a).and_then(|&axis| least.get(axis)).map_or(f64::NAN, |least| least * unit)
    });
    if !least.iter().all(|least| least.is_finite()) {
        return Ok([0.0; 3]);
    }
    let kinds: Vec<&str> =
        fields.get(&["centers", "centerings"]).unwrap_or_default().split_whitespace().collect();
    let is_node =
        |a: usize| axes.get(a).and_then(|&axis| kinds.get(axis)).is_some_and(|kind| *kind == "node");
    Ok(std::array::from_fn(|a| least[a] + if is_node(a) { 0.0 } else { spacing[a] / 2.0 }))
}

/// Of a space that does not say where the patient is, as ITK has it, which writes such headers: LPS.
fn to_ras(affine: Affine, space: &str) -> Result<Affine, ReadError> {
    match space.to_lowercase().trim_end_matches("-time") {
        "left-posterior-superior"
        | "lps"
        | "lpst"
        | "scanner-xyz"
        | "3d-right-handed"
        | "3d-left-handed"
        | "" => Ok(affine.with_lps_swapped()),
        "left-anterior-superior" | "las" | "last" => Ok(mirrored_x(affine)),
        "right-anterior-superior" | "ras" | "rast" => Ok(affine),
        other => Err(error(format!("space `{other}` is not three-dimensional"))),
    }
}

fn mirrored_x(mut affine: Affine) -> Affine {
    affine.linear[0] = affine.linear[0].map(|v| -v);
    affine.origin[0] = -affine.origin[0];
    affine
}

/// mm in the header's unit of length, or its name where it is not known; mm where none is named. All axes of space must have
/// the same.
fn unit(fields: &Fields, axes: &[usize]) -> Result<Result<f64, String>, ReadError> {
    const ALL: &[usize] = &[0, 1, 2];
    // One for each direction of space, or one an axis: time has its own.
    let (text, of_space) = match (fields.get(&["space units"]), fields.get(&["units"])) {
        (Some(text), _) => (text, ALL),
        (None, Some(text)) => (text, &axes[..axes.len().min(3)]),
        (None, None) => return Ok(Ok(1.0)),
    };
    let names = quoted(text);
    let mut names = of_space.iter().filter_map(|&axis| names.get(axis)).filter(|name| !name.is_empty());
    let first = *names.next().unwrap_or(&"mm");
    if names.any(|name| *name != first) {
        return Err(error(format!(
            "axes of different units ({text}); give the spacing in mm in a header without units"
        )));
    }
    Ok(mm_per(first).ok_or_else(|| first.to_owned()))
}

/// Names in quotes, some of which may be empty; without quotes the words.
fn quoted(text: &str) -> Vec<&str> {
    let names: Vec<&str> = text.split('"').skip(1).step_by(2).map(str::trim).collect();
    if names.is_empty() { text.split_whitespace().collect() } else { names }
}

/// Where the voxels are: behind the header in the file itself, or in a data file.
fn data(
    path: &Path,
    fields: &Fields,
    scalar: ScalarType,
    header_end: u64,
    file: Packed,
) -> Result<VoxelData, ReadError> {
    let (encoding, skip, order) = (encoding(fields)?, skip(fields)?, byte_order(fields, scalar)?);
    let Some(name) = fields.get(&["data file", "datafile"]) else {
        let data = match (u64::try_from(skip), encoding) {
            (Ok(skip), Encoding::Raw) => file.data(header_end.saturating_add(skip), encoding, order)?,
            (Ok(0), _) => file.data(header_end, encoding, order)?,
            (Err(_), Encoding::Raw) if !file.is_packed() => {
                VoxelData { offset: DataOffset::FromEnd, ..file.data(0, encoding, order)? }
            }
            _ => return Err(skipped_and_packed(skip)),
        };
        return Ok(data);
    };
    let (path, offset) = (beside(path, name), detached(skip, encoding)?);
    Ok(VoxelData { path, opened: OpenedFile::default(), encoding, offset, order, scaling: None })
}

fn skipped_and_packed(skip: i64) -> ReadError {
    error(format!("`byte skip: {skip}` with compressed data is not supported"))
}

/// Where the voxels begin in a data file.
fn detached(skip: i64, encoding: Encoding) -> Result<DataOffset, ReadError> {
    match (u64::try_from(skip), encoding) {
        (Ok(skip), Encoding::Raw) => Ok(DataOffset::Stored(skip)),
        (Ok(skip), _) => Ok(DataOffset::Decoded(skip)),
        (Err(_), Encoding::Raw) => Ok(DataOffset::FromEnd),
        _ => Err(skipped_and_packed(skip)),
    }
}

/// The data files, where there are several.
fn series(
    path: &Path,
    fields: &Fields,
    lines: &mut Lines,
    scalar: ScalarType,
) -> Result<Option<FileSeries>, ReadError> {
    let Some(name) = fields.get(&["data file", "datafile"]) else { return Ok(None) };
    let Some(files) = file_series::files_named(path, name, lines) else { return Ok(None) };
    let files = files.map_err(|wrong| error(format!("`data file: {name}` {wrong}")))?;
    let (encoding, order) = (encoding(fields)?, byte_order(fields, scalar)?);
    let offset = detached(skip(fields)?, encoding)?;
    Ok(Some(FileSeries { files, encoding, offset, order, width: scalar.bytes() }))
}

fn encoding(fields: &Fields) -> Result<Encoding, ReadError> {
    Ok(match fields.required("encoding")?.to_lowercase().as_str() {
        "raw" => Encoding::Raw,
        "gzip" | "gz" => Encoding::Gzip,
        "bzip2" | "bz2" => Encoding::Bzip2,
        other => {
            let cure = "save the image as raw, gzip or bzip2";
            return Err(error(format!("encoding `{other}` is not read; {cure}")));
        }
    })
}

/// Bytes to skip in front of the voxels; -1 for voxels that end the file.
fn skip(fields: &Fields) -> Result<i64, ReadError> {
    if fields.get(&["line skip", "lineskip"]).is_some_and(|v| v != "0") {
        return Err(error("`line skip` is not supported; save the image without it"));
    }
    let Some(text) = fields.get(&["byte skip", "byteskip"]) else { return Ok(0) };
    text.parse().map_err(|_| error(format!("`byte skip: {text}` cannot be read")))
}

fn byte_order(fields: &Fields, scalar: ScalarType) -> Result<ByteOrder, ReadError> {
    match fields.get(&["endian"]).map(str::to_lowercase).as_deref() {
        Some("big") => Ok(ByteOrder::Big),
        Some("little") => Ok(ByteOrder::Little),
        None if scalar.bytes() == 1 => Ok(ByteOrder::Little),
        _ => Err(error("no `endian: little` or `endian: big` for voxels of several bytes")),
    }
}
