//! `surfometry map`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::{CurvatureOptions, MeasureOptions};
use crate::output::{MapSink, check_output, deliver, one_line, say, status, with_scales};
use crate::picture_options::{PictureOptions, distinct};
use crate::values::one_of;
use anyhow::{Result, anyhow, bail};
use std::path::{Path, PathBuf};
use surfometry::io::mesh_paths;
use surfometry::measurement::{Outside, VoxelQuantity};
use surfometry::pictures::PictureStyle;
use surfometry::runs::picture_words::color_range;
use surfometry::runs::{
    Against, Batch, Choices, FileLedger, MapFile, MapStyle, MapTask, SampleImage, Settings, SharedFiles,
};
use surfometry::surface::LocalQuantity;

/// Map curvature on the surface: meshes, voxel maps, pictures, distributions
///
/// Each -o FILE is written for each object, in the format that its ending names: meshes with curvature at the
/// vertices (.ply, .vtp, .stl, .obj, .glb, .gii, .csv), voxel maps on the input's own grid (.nii, .nii.gz;
/// see --voxels), pictures (.png, .svg, .pdf; see --picture). A .json file holds the results, curvature summaries
/// and distributions of all objects. Where there are several inputs or objects, `_NAME` and `_label-N` go
/// before the ending, unless --together. The names of all files are printed.
///
/// With --against LATER, a later scan that was registered to this one, each vertex has the distance to the surface of the same
/// label there (positive where that lies outside) and the change of mean curvature, with standard errors: what two masks of one
/// object would show. Colours show it, and .json has means, quantiles and what is beyond noise.
///
/// Coordinates are RAS, in mm. Exit status as of `measure`.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::MAP)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    /// File to write; may be given several times
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: Vec<PathBuf>,
    /// Picture to write: the same as -o FILE
    #[arg(long, value_name = "FILE.png", help_heading = "Results")]
    png: Option<PathBuf>,
    /// A later image of the same objects, in the same world coordinates, on any grid: distances to its surfaces
    #[arg(long, value_name = "LATER", value_parser = input_name(), help_heading = "Measures on the surface")]
    against: Option<String>,
    /// Quantities of voxel maps, a file each
    #[arg(long, value_delimiter = ',', default_value = "mean-curvature", value_parser = one_of::<VoxelQuantity>(), help_heading = "Voxel maps")]
    voxels: Vec<VoxelQuantity>,
    /// Volume, on any lattice, whose values are put on the vertices, linear between voxels: an array of that name, by default
    /// the file's, and in a .json file how it goes with curvature; may be given several times
    #[arg(long, value_name = "[NAME=]FILE", help_heading = "Measures on the surface")]
    sample: Vec<SampleImage>,
    /// Label image, on any lattice, whose labels are regions: distributions by region as well, in a .json file
    #[arg(long, value_name = "FILE", help_heading = "Measures on the surface")]
    regions: Option<String>,
    /// What voxel maps of curvature have outside the band
    #[arg(long, default_value = "0", value_parser = one_of::<Outside>(), help_heading = "Voxel maps")]
    outside: Outside,
    /// One picture of all surfaces, on one colour scale: labels where they are, inputs beside each other; and one voxel
    /// map of all of an input's objects, in which a voxel has its own label's value, else that of the nearest surface.
    /// Meshes stay one an object
    #[arg(long, help_heading = "Pictures")]
    together: bool,
    /// Both ends of the colour scale, instead of --limit
    #[arg(long, value_name = "LOW..HIGH", conflicts_with = "limit", value_parser = color_range, allow_hyphen_values = true, help_heading = "Pictures")]
    range: Option<[f64; 2]>,
    /// Above pictures [default: the object's name]
    #[arg(long, value_name = "TEXT", help_heading = "Pictures")]
    title: Option<String>,
    /// Below pictures [default: how the surface was made]
    #[arg(long, value_name = "TEXT", help_heading = "Pictures")]
    caption: Option<String>,
    #[command(flatten)]
    pictures: PictureOptions,
    #[command(flatten)]
    curvature: CurvatureOptions,
    #[command(flatten)]
    options: MeasureOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let (inputs, style) = (expand(&args.inputs), style(args)?);
    let outputs = || args.output.iter().chain(&args.png);
    let beside = args.against.iter().chain(&args.regions).map(String::as_str);
    let read = args.options.files_read(&inputs, beside.chain(args.sample.iter().map(SampleImage::file)));
    let [documents, files] = targets(outputs(), &read)?;
    if args.against.is_some()
        && documents.is_empty()
        && files.iter().all(|file| MapFile::of_path(file) == Some(MapFile::Voxels))
    {
        bail!(
            "--against is for surfaces, and voxel maps have nothing of it: add -o FILE.json, a mesh (.vtp, .csv) or a picture (.png)"
        );
    }
    let scale = args.curvature.asked().unwrap_or_else(|| args.options.scale_of_map(&style, outputs()));
    let choices =
        Choices { regions: args.regions.clone(), samples: args.sample.clone(), ..args.options.choices() };
    let plan = choices.plan(scale)?;
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let (scale_ledger, settings) = (plan.scale_ledger.clone(), Settings::of(&plan));
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let (ledger, shared) = (FileLedger::new(&read), SharedFiles::new(&inputs));
    let against = args.against.as_ref().map(|later| Against::open(later, &plan, &control)).transpose()?;
    let mut sink = MapSink::new(documents, &settings, quiet)?;
    let task = MapTask { plan, against, files, style, ledger, shared };
    let outcome = batch.run(&task, &mut sink)?;
    if !outcome.stopped && outcome.rows > 0 {
        sink.written(&task.finish()?);
    }
    deliver(&sink.finish(outcome)?, None)?;
    if !quiet
        && !outcome.stopped
        && !args.options.chooses_labels()
        && let Some((name, labels)) =
            args.against.as_ref().zip(task.against.as_ref().and_then(Against::not_compared))
    {
        // What only the later image has is on no surface of the first.
        let name = one_line(name);
        say(&format!(
            "{name}: label {labels} of it was compared with nothing: no object of that label was mapped"
        ));
    }
    Ok(with_scales(status(outcome), &scale_ledger, quiet))
}

fn style(args: &Args) -> Result<MapStyle> {
    let quantity = args.against.as_ref().map_or(LocalQuantity::default(), |_| LocalQuantity::Distance);
    let style = args.pictures.map_style(quantity)?;
    if style.picture.quantity.is_change() && args.against.is_none() {
        bail!("--quantity {} is a change to a later image: add --against LATER", style.picture.quantity);
    }
    Ok(MapStyle {
        picture: PictureStyle { range: args.range, caption: args.caption.clone(), ..style.picture },
        title: args.title.clone(),
        voxels: distinct(&args.voxels),
        outside: args.outside,
        together: args.together,
        ..style
    })
}

/// The files asked for: documents of all objects, and those of which there is one an object.
fn targets<'a>(paths: impl Iterator<Item = &'a PathBuf>, inputs: &[String]) -> Result<[Vec<PathBuf>; 2]> {
    let all: Vec<&PathBuf> = paths.collect();
    if all.is_empty() {
        bail!("say what to write: -o FILE, whose name ends in one of {}, .json", MapFile::EXTENSIONS);
    }
    // Of one object alone; of several, what tells their files apart is the same for all outputs.
    let ledger = FileLedger::new(&[]);
    for path in &all {
        check_output(Some(path), inputs)?;
        if !is_json(path) && MapFile::of_path(path).is_none() {
            bail!("{}: the name must end in one of {}, .json", path.display(), MapFile::EXTENSIONS);
        }
        for file in mesh_paths(path).map_err(|error| anyhow!("{}: {error}", path.display()))? {
            ledger.claim(&file)?;
        }
    }
    let (documents, files): (Vec<_>, Vec<_>) = all.into_iter().cloned().partition(|path| is_json(path));
    Ok([documents, files])
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
}
