//! NIfTI-1 and NIfTI-2 headers, single files and pairs.
//!
//! Own code: the crate `nifti` reads no NIfTI-2, stops after the first gzip member and leaves the qform to
//! the caller.
//!
//! # References
//! nifti1.h and nifti2.h, <https://nifti.nimh.nih.gov>.

use super::header::{ByteOrder, Encoding, ImageHeader, VoxelData, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, PACKED, ReadError, nifti_labels};
use crate::volume::{Affine, ScalarType};
use std::io::Read;
use std::path::{Path, PathBuf};

const SIZE_1: i32 = 348;
const SIZE_2: i32 = 540;
/// Bytes behind a header that say whether extensions follow.
const EXTENDER: u64 = 4;
/// Bytes of a header with its extensions; bounds what is read of a file that is none.
const LONGEST_HEADER: u64 = 1 << 24;
/// Square of the real part of a quaternion below which it counts as none (nifti1_io).
const HALF_TURN: f64 = 1e-7;
/// Relative difference of pixdim and sform spacings that is worth a warning.
const CONFLICT: f64 = 0.01;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "NIfTI", reason: reason.into() }
}

/// Reads the header of a .nii, .hdr or .img file, packed or not.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let (header_path, data_path) = parts(path);
    let file = Packed::open(&header_path)?;
    let bytes = header_bytes(&file)?;
    let fields = Fields::parse(&bytes)?;
    let dimensions = three_dimensions(&fields.dimensions)?;
    let affine = fields.affine();
    let between = fields.extensions(&file, &bytes)?;
    // Of a pair, whose two names tell it whatever the magic says, header and image may be compressed apart.
    let single = header_path == data_path || fields.single_file && !data_path.is_file();
    let data_file = if single {
        file
    } else {
        if file.is_packed() {
            compare_checksum(file)?;
        }
        Packed::open(&data_path)?
    };
    let offset = match (single, fields.single_file) {
        (true, _) => fields.vox_offset.max(fields.header_size + 4),
        // That of a file which it is not.
        (false, true) => 0,
        (false, false) => fields.vox_offset,
    };
    let labels = nifti_labels::labels(&between, fields.order).map_err(|reason| {
        error(format!(
            "{reason} of the label table in the extension (`wb_command -volume-label-import` writes it anew)"
        ))
    })?;
    let data = data_file.data(offset, Encoding::Raw, fields.order)?;
    Ok(ImageHeader {
        path: header_path,
        format: Format::Nifti,
        dimensions,
        scalar: fields.scalar()?,
        affine,
        stated_spacing: (!fields.has_sform()).then(|| fields.spacing()),
        unknown_unit: None,
        other_spacing: fields.conflicting_spacing(affine.as_ref()),
        labels,
        data: Voxels::Stored(VoxelData { scaling: fields.scaling(), ..data }),
    })
}

/// Header and image file of a path that may name either of a pair. The other one may differ in being compressed, and in its
/// letters' case.
fn parts(path: &Path) -> (PathBuf, PathBuf) {
    let name = path.to_string_lossy();
    let lower = name.to_ascii_lowercase();
    let packed = PACKED.iter().find(|ending| lower.ends_with(*ending)).map_or(0, |ending| ending.len());
    let (stem, packing) = name.split_at(name.len() - packed);
    let Some((base, ending)) = stem.rsplit_once('.') else { return (path.to_owned(), path.to_owned()) };
    let other = |of_other: &str| {
        let endings = [in_case_of(of_other, ending), of_other.to_owned(), of_other.to_ascii_uppercase()];
        let packings = || [packing, ""].into_iter().chain(PACKED);
        let candidates: Vec<PathBuf> = endings
            .iter()
            .flat_map(|ending| packings().map(move |packing| format!("{base}.{ending}{packing}").into()))
            .collect();
        candidates.iter().find(|p| p.exists()).unwrap_or(&candidates[0]).clone()
    };
    match ending.to_ascii_lowercase().as_str() {
        "hdr" => (path.to_owned(), other("img")),
        "img" => (other("hdr"), path.to_owned()),
        _ => (path.to_owned(), path.to_owned()),
    }
}

/// A word in lower case with capitals where another one has them.
fn in_case_of(word: &str, other: &str) -> String {
    let in_case = |(letter, of): (char, char)| {
        if of.is_ascii_uppercase() { letter.to_ascii_uppercase() } else { letter }
    };
    word.chars().zip(other.chars()).map(in_case).collect()
}

fn header_bytes(file: &Packed) -> Result<Vec<u8>, ReadError> {
    let (bytes, damage) = file.start(SIZE_2 as u64 + EXTENDER)?;
    if bytes.len() < SIZE_1 as usize {
        let cause = damage.map_or_else(String::new, |e| format!(" ({e})"));
        return Err(error(format!(
            "the file ends after {} bytes{cause}; copy or export it again",
            bytes.len()
        )));
    }
    Ok(bytes)
}

/// Reads a compressed header to its end: that of a pair is not compared when the voxels are.
fn compare_checksum(file: Packed) -> Result<(), ReadError> {
    std::io::copy(&mut file.into_reader()?.take(LONGEST_HEADER), &mut std::io::sink())
        .map(drop)
        .map_err(|e| error(format!("{e}; copy or export the file again")))
}

/// The fields that matter, of either version.
struct Fields {
    order: ByteOrder,
    header_size: u64,
    single_file: bool,
    dimensions: Vec<usize>,
    datatype: i16,
    /// qfac, then the spacings.
    pixdim: [f64; 4],
    vox_offset: u64,
    slope: f64,
    intercept: f64,
    qform_code: i32,
    sform_code: i32,
    quaternion: [f64; 3],
    quaternion_offset: [f64; 3],
    sform: [[f64; 4]; 3],
    units: i32,
}

/// Numbers out of a header of known byte order.
struct Numbers<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
}

macro_rules! number {
    ($name:ident, $type:ty) => {
        fn $name(&self, offset: usize) -> $type {
            let bytes =
                self.bytes[offset..offset + size_of::<$type>()].try_into().expect("slice of that length");
            match self.order {
                ByteOrder::Little => <$type>::from_le_bytes(bytes),
                ByteOrder::Big => <$type>::from_be_bytes(bytes),
            }
        }
    };
}

impl Numbers<'_> {
    number!(i16, i16);
    number!(i32, i32);
    number!(i64, i64);
    number!(f32, f32);
    number!(f64, f64);
}

impl Fields {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let size = |order| Numbers { bytes, order }.i32(0);
        let order = match (size(ByteOrder::Little), size(ByteOrder::Big)) {
            (SIZE_1 | SIZE_2, _) => ByteOrder::Little,
            (_, SIZE_1 | SIZE_2) => ByteOrder::Big,
            (other, _) => {
                return Err(error(format!(
                    "sizeof_hdr is {other}, not 348 or 540: the file is not NIfTI, whatever its name"
                )));
            }
        };
        let n = Numbers { bytes, order };
        if n.i32(0) == SIZE_1 {
            Self::version_1(&n)
        } else if bytes.len() < SIZE_2 as usize {
            Err(error("the file ends inside its header; copy or export it again"))
        } else {
            Self::version_2(&n)
        }
    }

    fn version_1(n: &Numbers) -> Result<Self, ReadError> {
        let f = |offset: usize| f64::from(n.f32(offset));
        let single_file = match &n.bytes[344..348] {
            b"n+1\0" => true,
            b"ni1\0" => false,
            // Analyze 7.5 has no magic, no orientation and no rule for left and right.
            _ => return Err(error("no NIfTI magic (an Analyze 7.5 file?); convert it to NIfTI")),
        };
        Ok(Self {
            order: n.order,
            header_size: SIZE_1 as u64,
            single_file,
            dimensions: dimensions(i64::from(n.i16(40)), |i| i64::from(n.i16(40 + 2 * i)))?,
            datatype: n.i16(70),
            pixdim: std::array::from_fn(|i| f(76 + 4 * i)),
            vox_offset: vox_offset(f(108))?,
            slope: f(112),
            intercept: f(116),
            qform_code: n.i16(252).into(),
            sform_code: n.i16(254).into(),
            quaternion: std::array::from_fn(|i| f(256 + 4 * i)),
            quaternion_offset: std::array::from_fn(|i| f(268 + 4 * i)),
            sform: std::array::from_fn(|r| std::array::from_fn(|c| f(280 + 16 * r + 4 * c))),
            units: n.bytes[123].into(),
        })
    }

    fn version_2(n: &Numbers) -> Result<Self, ReadError> {
        let single_file = match &n.bytes[4..8] {
            b"n+2\0" => true,
            b"ni2\0" => false,
            _ => return Err(error("no NIfTI-2 magic; export the file again")),
        };
        Ok(Self {
            order: n.order,
            header_size: SIZE_2 as u64,
            single_file,
            dimensions: dimensions(n.i64(16), |i| n.i64(16 + 8 * i))?,
            datatype: n.i16(12),
            pixdim: std::array::from_fn(|i| n.f64(104 + 8 * i)),
            vox_offset: vox_offset(n.i64(168) as f64)?,
            slope: n.f64(176),
            intercept: n.f64(184),
            qform_code: n.i32(344),
            sform_code: n.i32(348),
            quaternion: std::array::from_fn(|i| n.f64(352 + 8 * i)),
            quaternion_offset: std::array::from_fn(|i| n.f64(376 + 8 * i)),
            sform: std::array::from_fn(|r| std::array::from_fn(|c| n.f64(400 + 32 * r + 8 * c))),
            units: n.i32(500),
        })
    }

    /// What stands between the header and the voxels, or the end of a header's own file; nothing where no extension is
    /// announced. `start` is how the file begins.
    fn extensions(&self, file: &Packed, start: &[u8]) -> Result<Vec<u8>, ReadError> {
        let header = self.header_size as usize;
        if start.get(header).is_none_or(|mark| *mark == 0) {
            return Ok(Vec::new());
        }
        let end = if self.single_file { self.vox_offset.min(LONGEST_HEADER) } else { LONGEST_HEADER };
        let (mut bytes, _) = file.start(end)?;
        Ok(bytes.split_off(header.min(bytes.len())))
    }

    fn scalar(&self) -> Result<ScalarType, ReadError> {
        Ok(match self.datatype {
            2 => ScalarType::U8,
            4 => ScalarType::I16,
            8 => ScalarType::I32,
            16 => ScalarType::F32,
            64 => ScalarType::F64,
            256 => ScalarType::I8,
            512 => ScalarType::U16,
            768 => ScalarType::U32,
            1024 => ScalarType::I64,
            1280 => ScalarType::U64,
            other => return Err(ReadError::VoxelType(other_type(other))),
        })
    }

    /// Slope 0 (or not a number) means that the stored values are the values.
    fn scaling(&self) -> Option<(f64, f64)> {
        let identity = self.slope == 1.0 && self.intercept == 0.0;
        let usable = self.slope != 0.0 && self.slope.is_finite() && self.intercept.is_finite();
        (usable && !identity).then_some((self.slope, self.intercept))
    }

    /// mm in the file's unit of length. An unknown unit is taken as mm, as everyone does.
    fn unit(&self) -> f64 {
        match self.units & 7 {
            1 => 1000.0,
            3 => 1e-3,
            _ => 1.0,
        }
    }

    fn spacing(&self) -> [f64; 3] {
        [1, 2, 3].map(|i| self.pixdim[i] * self.unit())
    }

    /// Whether the sform is named and was filled in.
    fn has_sform(&self) -> bool {
        self.sform_code > 0 && self.sform.iter().flatten().any(|&v| v != 0.0)
    }

    /// The sform where it is set, else the qform, else the spacings alone.
    fn affine(&self) -> Option<Affine> {
        let affine = if self.has_sform() {
            let linear = self.sform.map(|row| [row[0], row[1], row[2]]);
            Affine { linear, origin: self.sform.map(|row| row[3]) }.scaled(self.unit())
        } else if self.qform_code > 0 {
            let origin = self.quaternion_offset.map(|v| v * self.unit());
            Affine::from_directions(self.quaternion_directions(), self.spacing(), origin)
        } else {
            Affine::diagonal(self.spacing())
        };
        // An affine of zeros is a header that was never filled in.
        let missing = affine.column_lengths().iter().all(|&l| l == 0.0);
        (!missing).then_some(affine)
    }

    /// Unit vectors of the image axes from the quaternion (nifti1.h, method 2).
    fn quaternion_directions(&self) -> [[f64; 3]; 3] {
        let [b, c, d] = self.quaternion;
        let square = b * b + c * c + d * d;
        // As nifti1_io has it: of a quaternion longer than 1, or as long, the rotation is by 180 degrees
        // about its axis.
        let (a, length) = if 1.0 - square < HALF_TURN {
            (0.0, libm::sqrt(square))
        } else {
            (libm::sqrt(1.0 - square), 1.0)
        };
        let [b, c, d] = [b, c, d].map(|v| v / length);
        let x = [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)];
        let y = [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)];
        let z = [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c];
        let qfac = if self.pixdim[0] < 0.0 { -1.0 } else { 1.0 };
        [x, y, z.map(|v| v * qfac)]
    }

    fn conflicting_spacing(&self, affine: Option<&Affine>) -> Option<[f64; 3]> {
        let (used, pixdim) = (affine?.column_lengths(), self.spacing());
        let differs = (0..3).any(|a| (pixdim[a].abs() - used[a]).abs() > CONFLICT * used[a]);
        (self.has_sform() && differs).then_some(pixdim)
    }
}

/// Name of a type that is not read (nifti1.h).
fn other_type(code: i16) -> String {
    let name = match code {
        0 => "unknown",
        1 => "binary, one bit a voxel",
        32 => "complex64",
        128 => "RGB24, three colours a voxel",
        1536 => "float128",
        1792 => "complex128",
        2048 => "complex256",
        2304 => "RGBA32, four colours a voxel",
        _ => return format!("NIfTI datatype {code}"),
    };
    format!("{name} (NIfTI datatype {code})")
}

fn dimensions(count: i64, at: impl Fn(usize) -> i64) -> Result<Vec<usize>, ReadError> {
    if !(1..=7).contains(&count) {
        return Err(error(format!("dim[0] is {count}, not 1 to 7; the header is damaged")));
    }
    (1..=count as usize)
        .map(|i| {
            usize::try_from(at(i)).map_err(|_| error(format!("dim[{i}] is {}; the header is damaged", at(i))))
        })
        .collect()
}

fn vox_offset(value: f64) -> Result<u64, ReadError> {
    if value.is_finite() && (0.0..1e15).contains(&value) {
        Ok(value as u64)
    } else {
        Err(error(format!("vox_offset is {value}; the header is damaged")))
    }
}
