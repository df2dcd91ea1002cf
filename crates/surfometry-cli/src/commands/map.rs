//! `surfometry map`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::expand;
use crate::options::{CurvatureOptions, MeasureOptions};
use crate::output::{check_output, deliver, flags_text, json_text, say};
use crate::picture_options::{PictureOptions, distinct, one_of};
use crate::progress::{announce, progress_bar};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use surfometry::measurement::VoxelQuantity;
use surfometry::runs::{
    Failure, FileLedger, InputObject, MapFile, MapStyle, Output, SurfaceRecord, distinct_parts,
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
    #[arg(long, value_delimiter = ',', default_value = "mean-curvature", value_parser = one_of(&VoxelQuantity::ALL, VoxelQuantity::option, VoxelQuantity::title))]
    voxels: Vec<VoxelQuantity>,
    #[command(flatten)]
    pictures: PictureOptions,
    #[command(flatten)]
    curvature: CurvatureOptions,
    #[command(flatten)]
    options: MeasureOptions,
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
        let all: Vec<&PathBuf> = documents.iter().chain(&files).collect();
        if let Some(twice) = all.iter().enumerate().find(|(i, path)| all[..*i].contains(path)) {
            bail!("{}: named twice", twice.1.display());
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
    let wanted = args.options.inputs(args.curvature.scale());
    let inputs = expand(&args.inputs);
    let targets = Targets::new(args.output.iter().chain(&args.png).cloned(), &inputs)?;
    let style = MapStyle { voxels: distinct(&args.voxels), ..args.pictures.map_style() };
    let progress = progress_bar(inputs.len(), quiet);
    let mut run = Run { style, ledger: FileLedger::new(&inputs), records: Vec::new(), failures: Vec::new() };
    for (input, part) in inputs.iter().zip(distinct_parts(&inputs)) {
        let files: Vec<PathBuf> = targets.files.iter().map(|p| with_parts(p, part.as_slice())).collect();
        progress.set_message(input.clone());
        let outcome = visit_objects(input, &measurement, &wanted, |source| {
            announce(&progress, source);
            run.map_object(source, &files);
            Ok(())
        });
        if let Err(error) = outcome {
            run.failures.push(Failure::new(input, &error));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    run.conclude(&targets.documents, quiet)
}

/// What a run needs and gathers.
struct Run {
    style: MapStyle,
    ledger: FileLedger,
    records: Vec<SurfaceRecord>,
    failures: Vec<Failure>,
}

impl Run {
    /// Writes an object's files. What cannot be written is listed, and the others are written all the same.
    fn map_object(&mut self, source: &InputObject, files: &[PathBuf]) {
        let mut written = Vec::new();
        let mut errors: Vec<String> = Vec::new();
        for path in files {
            match write_map_files(source, path, &self.style, &mut self.ledger) {
                Ok(paths) => written.extend(paths.iter().map(|path| path.display().to_string())),
                // That there is no surface is said once, not for each file.
                Err(error) if errors.contains(&error.to_string()) => {}
                Err(error) => errors.push(error.to_string()),
            }
        }
        self.failures.extend(errors.iter().map(|error| source.failure(error)));
        let record = SurfaceRecord::new(source.record(), source.surface());
        self.records.push(SurfaceRecord { files: written, ..record });
    }

    /// Says what went wrong and what to mind, writes the documents, names the files.
    fn conclude(self, documents: &[PathBuf], quiet: bool) -> Result<u8> {
        self.failures.iter().for_each(|failure| say(&failure.to_string()));
        if !quiet {
            for of_input in self.records.chunk_by(|a, b| a.record.input == b.record.input) {
                let flags = flags_text(&of_input.iter().map(|r| &r.record).collect::<Vec<_>>());
                if !flags.is_empty() {
                    say(&format!("{}\n{}", of_input[0].record.input, flags.trim_end()));
                }
            }
        }
        let status = if self.failures.is_empty() { ALL_DONE } else { SOME_FAILED };
        let mut names: Vec<String> = self.records.iter().flat_map(|r| r.files.clone()).collect();
        if !documents.is_empty() {
            let text = json_text(&Output::of_surfaces(self.records, self.failures))?;
            for path in documents {
                deliver(&text, Some(path))?;
                names.push(path.display().to_string());
            }
        }
        names.push(String::new());
        deliver(&names.join("\n"), None)?;
        Ok(status)
    }
}
