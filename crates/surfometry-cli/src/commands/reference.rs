//! `surfometry reference`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::expand;
use crate::options::{InputSelection, OutputFormat, OutputOptions};
use crate::output::{Layout, check_output, csv_text, deliver, digits, failures_text, json_text};
use crate::progress::{progress_bar, said_failure};
use anyhow::Result;
use surfometry::reference_methods::{METHODS, ReferenceMethod};
use surfometry::runs::{InputOptions, Output, ReferenceRecord, reference_input};

/// Measure objects by the classical methods: counted voxels, exact Euler numbers, triangulation, dilation, Crofton
///
/// What each is and how far it is off is in docs/reference_methods.md. A table of one method, as CSV, can be given to `compare`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,
    /// Method; may be given several times [default: all]
    #[arg(long = "method", value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(METHODS.map(|m| m.name())))]
    methods: Vec<String>,
    #[command(flatten)]
    selection: InputSelection,
    #[command(flatten)]
    results: OutputOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let wanted = args.selection.inputs();
    let inputs = expand(&args.inputs);
    check_output(args.results.path(), &inputs)?;
    let chosen = |method: &&&dyn ReferenceMethod| {
        args.methods.is_empty() || args.methods.iter().any(|name| name == method.name())
    };
    let methods: Vec<&dyn ReferenceMethod> = METHODS.iter().filter(chosen).copied().collect();
    let output = measured(&inputs, &methods, &wanted, quiet);
    let text = match args.results.format() {
        OutputFormat::Table => table(&output) + &failures_text(&output),
        OutputFormat::Json => json_text(&output)?,
        OutputFormat::Csv => csv_text(&output)?,
    };
    deliver(&text, args.results.path())?;
    Ok(if output.failures.is_empty() { ALL_DONE } else { SOME_FAILED })
}

fn measured(
    inputs: &[String],
    methods: &[&dyn ReferenceMethod],
    wanted: &InputOptions,
    quiet: bool,
) -> Output<ReferenceRecord> {
    let progress = progress_bar(inputs.len(), quiet);
    let (mut results, mut failures) = (Vec::new(), Vec::new());
    for input in inputs {
        progress.set_message(input.clone());
        match reference_input(input, methods, wanted) {
            Ok(records) => results.extend(records),
            Err(error) => failures.push(said_failure(&progress, input, &error)),
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    Output::of_reference(results, failures)
}

const COLUMNS: [&str; 8] =
    ["label", "method", "volume mm\u{b3}", "area mm\u{b2}", "total H mm", "mean H 1/mm", "chi", "SMI"];

fn table(output: &Output<ReferenceRecord>) -> String {
    let by_input = output.results.chunk_by(|a, b| a.input == b.input);
    let tables = by_input.map(|records| {
        let mut layout = Layout::new(&COLUMNS);
        for (n, record) in records.iter().enumerate() {
            let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), digits);
            let v = &record.values;
            let first = n == 0 || records[n - 1].label != record.label;
            let mut row = vec![if first { record.label.to_string() } else { String::new() }];
            row.push(record.method.to_owned());
            row.extend(
                [
                    v.volume_mm3,
                    v.surface_area_mm2,
                    v.total_mean_curvature_mm,
                    v.average_mean_curvature_per_mm,
                ]
                .map(number),
            );
            row.extend([v.euler_characteristic, v.structure_model_index].map(number));
            layout.row(row);
        }
        format!("{}\n{}", records[0].input, layout.text())
    });
    tables.collect::<Vec<_>>().join("\n")
}
