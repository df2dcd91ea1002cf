//! One input: a file or a phantom.

use super::objects::explain_records;
use super::{Record, visit_objects};
use crate::accuracy::{Flag, FlagCode};
use crate::io::{ImageHeader, ReadError, ReadOptions, VoxelStream, is_mesh, read_mesh};
use crate::measurement::{
    CurvatureScale, EmbeddingKind, MeasureError, Measured, Measurement, Progress, StreamError, Streamed,
};
use crate::phantoms::{ParsePhantomError, Phantom, Truth};
use crate::volume::{FieldImage, LabelGroup, LabelImage, LabelSelection, Spacing, VolumeError};
use crate::voxelisation::{VoxeliseError, VoxelisedMesh};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Why an input could not be measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InputError {
    /// The file.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The phantom.
    #[error(transparent)]
    Phantom(#[from] ParsePhantomError),
    /// The measurement.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// A mesh that cannot be put on a lattice.
    #[error(transparent)]
    Voxelise(#[from] VoxeliseError),
    /// An object without a surface.
    #[error(
        "nothing is left inside the level set at this sigma and level, so there is no surface; use a smaller --sigma"
    )]
    NoSurface,
    /// A picture that could not be drawn.
    #[cfg(feature = "pictures")]
    #[error(transparent)]
    Picture(#[from] crate::pictures::PictureError),
    /// A file that would replace an input.
    #[error("{path}: the output would replace an input; choose another name", path = path.display())]
    ReplacesInput {
        /// The file.
        path: PathBuf,
    },
    /// A file that an earlier output of the same run has become.
    #[error("{path}: another output of this run has that name already; choose names that differ, or use other folders", path = path.display())]
    NameTaken {
        /// The file.
        path: PathBuf,
    },
    /// A file that could not be written.
    #[error("{path}: cannot be written: {source}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A measure that records do not have.
    #[error("{0}: no number of that name was measured; names are those of the columns of --format csv")]
    NoMeasure(String),
    /// An option that the input cannot take.
    #[error("{0}")]
    Unfit(&'static str),
}

impl<E: std::error::Error + Into<Self>> From<StreamError<E>> for InputError {
    fn from(error: StreamError<E>) -> Self {
        match error {
            StreamError::Read(error) => error.into(),
            StreamError::Measure(error) => error.into(),
        }
    }
}

impl From<VolumeError> for InputError {
    fn from(error: VolumeError) -> Self {
        Self::Read(error.into())
    }
}

/// When it is looked into where the blur and the band change an object's topology.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExplainTopology {
    /// Never.
    Never,
    /// Where voxels, mesh and band disagree, unless the object is very large (2^22 voxels in its band).
    #[default]
    Disagreements,
    /// Always.
    Always,
}

/// What is asked of every input.
#[derive(Debug, Clone, Default)]
pub struct InputOptions {
    /// Which labels.
    pub labels: LabelSelection,
    /// Spacing in mm that replaces or supplies the file's.
    pub spacing: Option<[f64; 3]>,
    /// At which blur surfaces are mapped; of no meaning to integrals.
    pub curvature: CurvatureScale,
    /// Whether each 26-connected piece is an object of its own.
    pub per_component: bool,
    /// When it is said where the blur and the band change topology.
    pub explain_topology: ExplainTopology,
}

/// An opened label input.
pub struct LabelInput {
    /// The labels.
    pub image: LabelImage,
    /// The header, for files.
    pub header: Option<ImageHeader>,
    /// Exact integrals, for phantoms.
    pub truth: Option<Truth>,
    /// Warnings that come with the input.
    pub flags: Vec<Flag>,
    /// Time to read and decode, s.
    pub read_seconds: f64,
}

/// Opens `phantom:...` or a file; both come as slabs.
///
/// # Errors
/// [`InputError`].
pub fn open_labels(input: &str, spacing: Option<[f64; 3]>) -> Result<LabelInput, InputError> {
    let start = Instant::now();
    if Phantom::is_spec(input) {
        let (phantom, truth, flags) = open_phantom(input, spacing)?;
        let image = phantom.labels()?;
        let read_seconds = start.elapsed().as_secs_f64();
        return Ok(LabelInput { image, header: None, truth, flags, read_seconds });
    }
    if is_mesh(Path::new(input)) {
        let image = LabelImage::from_slabs(&mut open_mesh(input, spacing)?)?;
        let read_seconds = start.elapsed().as_secs_f64();
        return Ok(LabelInput { image, header: None, truth: None, flags: Vec::new(), read_seconds });
    }
    let mut stream = VoxelStream::open(Path::new(input), ReadOptions { spacing })?;
    let image = LabelImage::from_slabs(&mut stream)?;
    let header = stream.header().clone();
    let flags = conflict_flag(&header, spacing).into_iter().collect();
    let read_seconds = start.elapsed().as_secs_f64();
    Ok(LabelInput { image, header: Some(header), truth: None, flags, read_seconds })
}

/// A phantom with its truth, and a warning where that is not known.
fn open_phantom(
    input: &str,
    spacing: Option<[f64; 3]>,
) -> Result<(Phantom, Option<Truth>, Vec<Flag>), InputError> {
    if spacing.is_some() {
        return Err(InputError::Unfit("a phantom's spacing is part of its name: phantom:NAME?spacing=x,y,z"));
    }
    let phantom = Phantom::from_spec(input)?;
    let truth = phantom.truth();
    let unknown =
        "the phantom's exact integrals did not converge: the shape is too fine for its period and size";
    let flags =
        if truth.is_none() { vec![Flag::new(FlagCode::TruthNotConverged, unknown)] } else { Vec::new() };
    Ok((phantom, truth, flags))
}

/// A mesh on a lattice of some spacing.
fn open_mesh(input: &str, spacing: Option<[f64; 3]>) -> Result<VoxelisedMesh, InputError> {
    let unfit = InputError::Unfit(
        "a mesh has no voxels of its own: say with --spacing X,Y,Z how far apart they shall be, in mm",
    );
    let spacing = Spacing::new(spacing.ok_or(unfit)?)?;
    Ok(VoxelisedMesh::new(&read_mesh(Path::new(input))?, spacing)?)
}

fn conflict_flag(header: &ImageHeader, spacing: Option<[f64; 3]>) -> Option<Flag> {
    let (affine, other) = (header.affine.filter(|_| spacing.is_none())?, header.other_spacing?);
    let used = affine.column_lengths();
    let message = format!(
        "the header's affine says spacing {used:.6?} mm, its pixdim {other:.6?} mm; the affine is used: check which is \
         right, and override with --spacing X,Y,Z"
    );
    Some(Flag::new(FlagCode::SpacingConflict, message))
}

/// Measures every selected object of an input as its slices go by; `progress` is told after each slab.
///
/// # Errors
/// [`InputError`]; nothing of the input is reported then.
pub fn measure_input(
    input: &str,
    measurement: &Measurement,
    options: &InputOptions,
    progress: impl Fn(Progress),
) -> Result<InputRecords, InputError> {
    if measurement.embedding == EmbeddingKind::Given || options.per_component {
        let mut records = Vec::new();
        visit_objects(input, measurement, options, |object| {
            records.push(object.record());
            Ok(())
        })?;
        let read = records.first().and_then(|r: &Record| r.measured.read_seconds).unwrap_or_default();
        return Ok(InputRecords {
            records,
            read_seconds: read,
            decode_seconds: 0.0,
            read_again_seconds: 0.0,
        });
    }
    let mut found = if Phantom::is_spec(input) {
        let (phantom, truth, flags) = open_phantom(input, options.spacing)?;
        let streamed = measurement.run_slabs(&mut phantom.slabs(), &options.labels, progress)?;
        InputRecords::of(input, streamed, Duration::ZERO, truth, &flags)
    } else if is_mesh(Path::new(input)) {
        let start = Instant::now();
        let mut mesh = open_mesh(input, options.spacing)?;
        let opened = start.elapsed();
        let streamed = measurement.run_slabs(&mut mesh, &options.labels, progress)?;
        InputRecords::of(input, streamed, opened, None, &[])
    } else {
        let mut stream = VoxelStream::open(Path::new(input), ReadOptions { spacing: options.spacing })?;
        let streamed = measurement.run_slabs(&mut stream, &options.labels, progress)?;
        let flags: Vec<Flag> = conflict_flag(stream.header(), options.spacing).into_iter().collect();
        InputRecords::of(input, streamed, stream.file_time(), None, &flags)
    };
    found.read_again_seconds = explain_records(input, measurement, options, &mut found.records)?;
    Ok(found)
}

/// The records of an input, and how long it took to have its voxels.
#[derive(Debug, Clone)]
pub struct InputRecords {
    /// A record an object.
    pub records: Vec<Record>,
    /// Time to get bytes from the file, s.
    pub read_seconds: f64,
    /// Time to decompress them and to find the labels' runs, s.
    pub decode_seconds: f64,
    /// Time for both once more where topology was looked into, for which whole objects are held, s.
    pub read_again_seconds: f64,
}

impl InputRecords {
    fn of(input: &str, streamed: Streamed, file: Duration, truth: Option<Truth>, flags: &[Flag]) -> Self {
        let all = streamed.source_seconds + streamed.encode_seconds;
        let record = |(label, mut measured): (LabelGroup, Measured)| {
            measured.read_seconds = Some(all);
            measured.truth = truth;
            measured.flags.splice(0..0, flags.iter().cloned());
            Record { input: input.to_owned(), label: Some(label), component: None, name: None, measured }
        };
        let read_seconds = file.as_secs_f64();
        Self {
            records: streamed.results.into_iter().map(record).collect(),
            read_seconds,
            decode_seconds: all - read_seconds,
            read_again_seconds: 0.0,
        }
    }
}

/// An opened field.
pub(super) struct FieldInput {
    pub(super) field: FieldImage,
    pub(super) flags: Vec<Flag>,
    pub(super) read_seconds: f64,
}

pub(super) fn field_input(input: &str, options: &InputOptions) -> Result<FieldInput, InputError> {
    if Phantom::is_spec(input) {
        return Err(InputError::Unfit(
            "a phantom is a label image; --embedding given wants a file that holds a field",
        ));
    }
    if options.labels != LabelSelection::All {
        return Err(InputError::Unfit("a field has no labels: leave --label out with --embedding given"));
    }
    let start = Instant::now();
    let mut stream = VoxelStream::open(Path::new(input), ReadOptions { spacing: options.spacing })?;
    let field = FieldImage::from_slabs(&mut stream)?;
    let flags = conflict_flag(stream.header(), options.spacing).into_iter().collect();
    Ok(FieldInput { field, flags, read_seconds: start.elapsed().as_secs_f64() })
}
