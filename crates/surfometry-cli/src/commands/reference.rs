//! `surfometry reference`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::{InputSelection, OutputOptions};
use crate::output::{Failures, Layout, check_output, digits, one_line, raised_text, write_results};
use anyhow::Result;
use surfometry::accuracy::Flag;
use surfometry::reference_methods::{METHODS, ReferenceMethod};
use surfometry::runs::{Batch, ReferenceRecord, ReferenceTask, Settings};

/// Measure objects by the classical methods: counted voxels, exact Euler numbers, triangulation, dilation,
/// Crofton
///
/// What each is and how far it is off is in docs/reference_methods.md. A table of one method, as CSV, can be
/// given to `compare`.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::REFERENCE)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    /// Method; may be given several times, or as a list [default: all]
    #[arg(long = "method", value_name = "NAME", value_delimiter = ',', value_parser = clap::builder::PossibleValuesParser::new(METHODS.map(|m| m.name())))]
    methods: Vec<String>,
    #[command(flatten)]
    selection: InputSelection,
    #[command(flatten)]
    results: OutputOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let inputs = expand(&args.inputs);
    check_output(args.results.path(), &args.selection.files_read(&inputs, None))?;
    args.results.check()?;
    let chosen = |method: &&&dyn ReferenceMethod| {
        args.methods.is_empty() || args.methods.iter().any(|name| name == method.name())
    };
    let methods: Vec<&dyn ReferenceMethod> = METHODS.iter().filter(chosen).copied().collect();
    let plan = args.selection.plan()?;
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let settings = Settings::of(&plan);
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let task = ReferenceTask { plan, methods };
    write_results(&args.results, table, &settings, quiet, Failures::Told, |sink| batch.run(&task, sink))
}

const COLUMNS: [&str; 8] =
    ["label", "method", "volume mm\u{b3}", "area mm\u{b2}", "total H mm", "mean H 1/mm", "chi", "SMI"];

fn table(records: &[ReferenceRecord]) -> String {
    let mut layout = Layout::new(&COLUMNS);
    for (n, record) in records.iter().enumerate() {
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), digits);
        let v = &record.values;
        let first = n == 0 || records[n - 1].label != record.label;
        let mut row = vec![if first { record.label.to_string() } else { String::new() }];
        row.push(record.method.clone());
        let values = [
            v.volume_mm3,
            v.surface_area_mm2,
            v.total_mean_curvature_mm,
            v.average_mean_curvature_per_mm,
            v.euler_characteristic,
            v.structure_model_index,
        ];
        row.extend(values.map(number));
        layout.row(row);
    }
    format!("{}\n{}{}", one_line(&records[0].input), layout.text(), flags(records))
}

/// Each flag of an object once, whichever methods have it.
fn flags(records: &[ReferenceRecord]) -> String {
    let objects: Vec<&[ReferenceRecord]> = records.chunk_by(|a, b| a.label == b.label).collect();
    let mut raised: Vec<(String, Flag)> = Vec::new();
    for object in &objects {
        for flag in object.iter().flat_map(|record| &record.flags) {
            let named = (object[0].label.to_string(), flag.clone());
            if !raised.contains(&named) {
                raised.push(named);
            }
        }
    }
    raised_text(&raised, objects.len())
}
