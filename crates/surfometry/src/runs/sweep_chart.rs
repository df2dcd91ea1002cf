//! An object's numbers over a range of a parameter, as a picture.

use super::map_files::write_figure;
use super::{FileLedger, Record, RunError, SweptParameter, flatten};
use crate::inputs::input_title;
use crate::measurement::{DescribedSurface, Measured, SurfaceValues};
use crate::pictures::{ChartLine, ChartPanel, LineChart};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// A chart of an object's numbers over a range.
#[derive(Debug, Clone)]
pub struct SweepChart {
    /// The file; where there are several inputs or objects, `_NAME` and `_label-N` go before its ending.
    pub path: PathBuf,
    /// What it shows, by names of columns; without any V, A, M and chi, of the blurred and of the original
    /// object.
    pub measures: Vec<String>,
    /// Whether equal ratios are equally far apart.
    pub log: bool,
    /// Pixels of a PNG to a CSS pixel.
    pub dpi_scale: f64,
}

/// What lines and bands are: of the chart without a choice, and of chosen measures.
const WHOLE: &str = "Blurred: of the smoothed object. Original: with the smoothing's shift undone; the band is its 95 % interval.";
const CHOSEN: &str = "The band is the 95 % interval; of blurred measures it is 1.96 standard deviations over sub-voxel shifts.";

/// Half-width of a 95 % interval in standard errors.
const INTERVAL: f64 = 1.96;

/// Writes a chart of one object's records, in their order, against what was swept, with 95 % bars where there
/// are standard errors.
pub(super) fn write_sweep_chart(
    records: &[Record],
    over: SweptParameter,
    chart: &SweepChart,
    path: &Path,
    ledger: &FileLedger,
) -> Result<(), RunError> {
    let values: Vec<f64> = records.iter().filter_map(|r| over.of(&r.measured.parameters)).collect();
    let first = records.first().filter(|_| values.len() == records.len());
    let first = first.ok_or(RunError::Unfit("nothing was measured that a chart could show"))?;
    ledger.claim(path)?;
    let (panels, what) = if chart.measures.is_empty() {
        (sweep_panels(&records.iter().map(|record| &record.measured).collect::<Vec<_>>()), WHOLE)
    } else {
        (measure_panels(records, &chart.measures)?, CHOSEN)
    };
    let label = first.label.as_ref().map_or_else(String::new, |label| format!(", label {label}"));
    let drawn = LineChart {
        along: over.axis(),
        values: &values,
        marks: &[],
        log: chart.log,
        panels: &panels,
        title: &format!("{}{label}", input_title(&first.input)),
        caption: &format!(
            "{what} Where a line stays level the choice does not matter, but what every blur of the range took away (see the flags) is missing all along it; \
             where it drifts or jumps, parts are lost or the grid shows."
        ),
    };
    write_figure(&drawn.figure(), path, chart.dpi_scale)
}

/// A panel for each measure.
fn measure_panels<'a>(records: &[Record], measures: &'a [String]) -> Result<Vec<ChartPanel<'a>>, RunError> {
    let rows: Vec<Map<String, Value>> = records
        .iter()
        .map(|record| serde_json::to_value(record).map(|value| flatten(&value)))
        .collect::<Result<_, _>>()
        .map_err(|_| RunError::Unfit("a record that is no table row"))?;
    let column = |name: &str| rows.iter().map(|row| row.get(name).and_then(Value::as_f64)).collect();
    let panel = |name: &'a String| {
        let values: Vec<Option<f64>> = column(name);
        if values.iter().all(Option::is_none) {
            return Err(RunError::NoMeasure(name.clone()));
        }
        let standard_error = match name.strip_prefix("blurred_") {
            Some(measure) => format!("blurred_grid_noise_{measure}"),
            None => format!("standard_error_{name}"),
        };
        let errors: Vec<Option<f64>> = column(&standard_error);
        let errors = errors.into_iter().map(|error| error.map(|e| INTERVAL * e)).collect();
        Ok(ChartPanel { name, lines: vec![ChartLine { name: "value, 95 %", values, errors }] })
    };
    measures.iter().map(panel).collect()
}

/// V, A, M and chi of the same object, measured in several ways.
pub(crate) fn sweep_panels(measured: &[&Measured]) -> Vec<ChartPanel<'static>> {
    let line = |name, value: &dyn Fn(&Measured) -> Option<f64>| {
        ChartLine::new(name, measured.iter().map(|m| value(m)).collect())
    };
    let panel = |name, value: fn(&SurfaceValues) -> Option<f64>| {
        let is_original = |m: &Measured| m.surface == DescribedSurface::Original;
        let error = |m: &&Measured| value(&m.standard_error).map(|e| INTERVAL * e);
        let original = ChartLine {
            errors: measured.iter().map(error).collect(),
            ..line("original", &|m: &Measured| value(&m.values).filter(|_| is_original(m)))
        };
        ChartPanel { name, lines: vec![original, line("blurred", &|m: &Measured| value(&m.blurred))] }
    };
    let mut volume = panel("volume (mm\u{b3})", |v| v.volume_mm3);
    // Of an object that its image cuts, the part between the cuts; its voxels' topology is that of the whole.
    let counted = |m: &Measured| Some(m.clip.map_or(m.voxels.volume_mm3, |clip| clip.voxel_volume_mm3));
    volume.lines.push(line("voxels", &counted));
    let voxels = |m: &Measured| m.clip.is_none().then_some(m.topology.euler_characteristic_voxels_26 as f64);
    let euler =
        vec![line("blurred", &|m: &Measured| m.blurred.euler_characteristic), line("voxels", &voxels)];
    vec![
        volume,
        panel("surface area (mm\u{b2})", |v| v.surface_area_mm2),
        panel("total mean curvature (mm)", |v| v.total_mean_curvature_mm),
        ChartPanel { name: "Euler characteristic", lines: euler },
    ]
}
