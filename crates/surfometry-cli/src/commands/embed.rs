//! `surfometry embed`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::MeasureOptions;
use crate::output::{
    Layout, TableSink, check_output, digits, is_one_place, one_line, raised_text, status, with_scales,
};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use surfometry::Choice;
use surfometry::inputs::{distinct_parts, with_parts};
use surfometry::io::ResultOutput;
use surfometry::measurement::CurvatureScale;
use surfometry::runs::{Batch, EmbedTask, EmbeddedObject, FileLedger, MapFile};

/// Write the embedded objects as a label image: the voxels at which phi is negative
///
/// This is the blurred mask made binary again, with which the paper validates, and with which other programs
/// can be compared. The image has the input's lattice, and all labels their values (united ones the first;
/// fields and soft segmentations 1). By default each object is blurred, also where `measure` would recover what
/// the blur loses: --embedding recovering gives the mask itself back. Flags are those of that measurement; an
/// object of which nothing is left has failed, and without any object no image is written. A voxel that several objects claim goes to the one whose phi is the lowest there; the plain blur at the
/// level 0.5 leaves no such voxels. The field phi itself is what `map -o FILE.nii.gz --voxels phi` writes.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::EMBED)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    /// Image to write; where there are several inputs, `_NAME` goes before the ending
    #[arg(short, long, value_name = "FILE.nii.gz")]
    output: PathBuf,
    #[command(flatten)]
    options: MeasureOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let plan = args.options.plan(CurvatureScale::AsMeasured)?;
    let inputs = expand(&args.inputs);
    let read = args.options.files_read(&inputs, None);
    for part in distinct_parts(&inputs) {
        check_output(Some(&with_parts(&args.output, part.as_slice())), &read)?;
    }
    if MapFile::of_path(&args.output) != Some(MapFile::Voxels) {
        bail!("{}: the name must end in .nii or .nii.gz", args.output.display());
    }
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let scale_ledger = plan.scale_ledger.clone();
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let task = EmbedTask { plan, file: args.output.clone(), ledger: FileLedger::new(&read) };
    task.check()?;
    // Where both go to one place, stderr has told the failures there.
    let mut sink = TableSink::new(ResultOutput::stdout(), table, !is_one_place());
    let outcome = batch.run(&task, &mut sink)?;
    let out = sink.finish().context("stdout cannot be written")?;
    out.end(outcome.stopped).context("stdout cannot be written")?;
    Ok(with_scales(status(outcome), &scale_ledger, quiet))
}

const COLUMNS: [&str; 8] =
    ["label", "embedding", "sigma mm", "voxels", "phi < 0", "lost", "gained", "another's"];

fn table(objects: &[EmbeddedObject]) -> String {
    let mut layout = Layout::new(&COLUMNS);
    let name = |object: &EmbeddedObject| object.label.as_ref().map_or_else(String::new, ToString::to_string);
    for object in objects {
        let parameters = &object.parameters;
        let mut row = vec![
            name(object),
            parameters.embedding.word().to_owned(),
            parameters.sigma_mm.map_or_else(|| "-".to_owned(), digits),
        ];
        let counts = [object.voxels, object.inside, object.lost, object.gained, object.given_up];
        row.extend(counts.map(|count| count.to_string()));
        layout.row(row);
    }
    let flags = |object: &'_ EmbeddedObject| {
        object.flags.iter().map(|flag| (name(object), flag.clone())).collect::<Vec<_>>()
    };
    let raised: Vec<_> = objects.iter().flat_map(flags).collect();
    format!("{}\n{}{}", one_line(&objects[0].input), layout.text(), raised_text(&raised, objects.len()))
}
