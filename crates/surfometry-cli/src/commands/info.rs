//! `surfometry info`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::{LatticeOptions, NameOptions};
use crate::output::{deliver, description_text, json_text, plain, status};
use anyhow::Result;
use serde_json::{Value, json};
use std::io;
use surfometry::inputs::OpenOptions;
use surfometry::io::{ImageHeader, read_header};
use surfometry::runs::{Batch, Failure, InfoTask, InputDescription, Sink};

/// Show what a file holds: format, grid, orientation, labels
///
/// Where the voxels are no labels, as in a field or a grey image, the header is shown and the reason given.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::INFO)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    #[command(flatten)]
    lattice: LatticeOptions,
    #[command(flatten)]
    names: NameOptions,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let inputs = expand(&args.inputs);
    let LatticeOptions { spacing, raw } = args.lattice;
    let spacing = spacing.map(|spacing| spacing.mm());
    let open = OpenOptions { spacing, raw, names: args.names.table(), ..OpenOptions::default() };
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let mut documents = Documents::default();
    let outcome = Batch { inputs: &inputs, open, control: &control, cure }.run(&InfoTask, &mut documents)?;
    let documents = documents.0;
    let text = if args.json { json_text(&documents)? } else { documents.iter().map(plain_text).collect() };
    deliver(&text, None)?;
    Ok(status(outcome))
}

fn plain_text(document: &Value) -> String {
    plain(&description_text(document)).into_owned()
}

/// A document an input, in their order.
#[derive(Default)]
struct Documents(Vec<Value>);

impl Sink<InputDescription> for Documents {
    fn row(&mut self, row: InputDescription) -> io::Result<()> {
        self.0.push(serde_json::to_value(row)?);
        Ok(())
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        let header = read_header(&failure.input).ok();
        let Failure { input, error } = failure;
        self.0.push(json!({ "input": input, "error": error, "header": header.as_ref().map(facts) }));
        Ok(())
    }
}

/// What a header alone says.
fn facts(header: &ImageHeader) -> Value {
    json!({
        "format": header.format.name(),
        "voxel_type": header.scalar.name(),
        "dimensions": header.dimensions,
        "spacing_mm": header.affine.map(|a| a.column_lengths()),
    })
}
