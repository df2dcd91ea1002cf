//! `surfometry map`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::{existing, expand};
use crate::options::MeasureOptions;
use crate::output::{check_output, deliver, say};
use crate::picture_options::PictureOptions;
use crate::progress::progress_bar;
use anyhow::{Result, bail};
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use surfometry::measurement::VoxelQuantity;
use surfometry::runs::{
    Failure, InputError, InputObject, MapFile, MapStyle, Output, SurfaceRecord, distinct_parts,
    visit_objects, with_parts, write_map_files,
};

/// Map curvature on the surface: meshes, voxel maps, pictures, distributions
///
/// Each -o FILE is written for each object, in the format that its ending names: meshes with curvature at the vertices
/// (.ply, .vtp, .stl, .obj, .glb, .gii, .csv), voxel maps on the input's own grid (.nii, .nii.gz; see --voxels), pictures
/// (.png, .svg; see --picture). A .json file holds the results, curvature summaries and distributions of all objects.
/// Where there are several inputs or objects, `_NAME` and `_label-N` go before the ending. The names of all files are
/// printed.
///
/// Coordinates are RAS, in mm. Exit status as of `measure`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,
    /// File to write; may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Picture to write: the same as -o FILE
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// Quantities of voxel maps, a file each
    #[arg(long, value_enum, value_delimiter = ',', default_value = "mean-curvature")]
    voxels: Vec<VoxelsOption>,
    #[command(flatten)]
    pictures: PictureOptions,
    #[command(flatten)]
    options: MeasureOptions,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum VoxelsOption {
    /// H in the band, 1/mm
    MeanCurvature,
    /// K in the band, 1/mm^2
    GaussianCurvature,
    /// Surface area a volume, 1/mm: its sum times a voxel's volume is the area
    Delta,
    /// The embedding
    Phi,
    /// 1 in the band, 0 outside
    Band,
}

impl VoxelsOption {
    fn quantity(self) -> VoxelQuantity {
        match self {
            Self::MeanCurvature => VoxelQuantity::MeanCurvature,
            Self::GaussianCurvature => VoxelQuantity::GaussianCurvature,
            Self::Delta => VoxelQuantity::Delta,
            Self::Phi => VoxelQuantity::Phi,
            Self::Band => VoxelQuantity::Band,
        }
    }
}

/// The files asked for: one an object, and documents of all objects.
struct Targets {
    files: Vec<PathBuf>,
    documents: Vec<PathBuf>,
}

impl Targets {
    fn new(paths: impl Iterator<Item = PathBuf>, inputs: &[String]) -> Result<Self> {
        let (documents, files): (Vec<_>, Vec<_>) = paths.partition(|path| is_json(path));
        if documents.is_empty() && files.is_empty() {
            bail!("say what to write: -o FILE, whose name ends in one of {}, .json", MapFile::EXTENSIONS);
        }
        for path in documents.iter().chain(&files) {
            check_output(Some(path), inputs)?;
        }
        match files.iter().find(|path| MapFile::of_path(path).is_none()) {
            Some(path) => {
                bail!("{}: the name must end in one of {}, .json", path.display(), MapFile::EXTENSIONS)
            }
            None => Ok(Self { files, documents }),
        }
    }
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let measurement = args.options.measurement()?;
    let wanted = args.options.inputs();
    let inputs = expand(&args.inputs);
    let targets = Targets::new(args.output.iter().chain(&args.png).cloned(), &inputs)?;
    let style = MapStyle {
        picture: args.pictures.style(),
        pictures: args.pictures.kinds(),
        dpi_scale: args.pictures.dpi_scale(),
        voxels: args.voxels.iter().map(|v| v.quantity()).collect(),
        protected: existing(&inputs),
    };
    let progress = progress_bar(inputs.len(), quiet);
    let (mut records, mut failures) = (Vec::new(), Vec::new());
    for (input, part) in inputs.iter().zip(distinct_parts(&inputs)) {
        let files: Vec<PathBuf> =
            targets.files.iter().map(|path| with_parts(path, part.as_slice())).collect();
        progress.set_message(input.clone());
        let mut failed = |failure: Failure| {
            progress.suspend(|| say(&failure.to_string()));
            failures.push(failure);
        };
        let outcome = visit_objects(input, &measurement, &wanted, |source| {
            progress.set_message(format!("{input}, object {} of {}", source.number + 1, source.count));
            let (record, error) = map_object(source, &files, &style);
            records.push(record);
            // The input's other objects are mapped all the same.
            if let Some(error) = error {
                failed(source.failure(&error));
            }
            Ok(())
        });
        if let Err(error) = outcome {
            failed(Failure::new(input, &error));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let status = if failures.is_empty() { ALL_DONE } else { SOME_FAILED };
    let mut names: Vec<String> = records.iter().flat_map(|r: &SurfaceRecord| r.files.clone()).collect();
    if !targets.documents.is_empty() {
        let document = serde_json::to_string_pretty(&Output::of_surfaces(records, failures))? + "\n";
        for path in &targets.documents {
            deliver(&document, Some(path))?;
            names.push(path.display().to_string());
        }
    }
    names.push(String::new());
    deliver(&names.join("\n"), None)?;
    Ok(status)
}

/// Writes an object's files; what is known of it, and what kept the rest from being written.
fn map_object(
    source: &InputObject,
    files: &[PathBuf],
    style: &MapStyle,
) -> (SurfaceRecord, Option<InputError>) {
    let surface = source.object.surface();
    let mut record = SurfaceRecord::new(source.record(), &surface);
    for path in files {
        match write_map_files(source, &surface, path, style) {
            Ok(written) => record.files.extend(written.iter().map(|path| path.display().to_string())),
            Err(error) => return (record, Some(error)),
        }
    }
    (record, None)
}
