//! Sweeps as tables for people.

use super::width::wrapped;
use super::{Layout, Presenter, digits, one_line};
use surfometry::runs::{Record, SweptParameter};

const LEGEND: &str = "V mm\u{b3}, A mm\u{b2}, M = total H mm of the object as it was segmented, with standard errors; blurred: of the \
                      smoothed surface.";

/// At other levels than 0.5 nothing is compensated.
const OF_LEVELS: &str = "V mm\u{b3}, A mm\u{b2}, M = total H mm of the smoothed surface at that level, which is another one than the \
                         object's; with standard errors at 0.5 alone.";

/// Sweeps over one parameter.
pub(crate) struct SweepTables(pub(crate) SweptParameter);

impl Presenter<Record> for SweepTables {
    fn of_input(&mut self, records: &[Record]) -> String {
        table(self.0, records)
    }

    fn ending(&self) -> String {
        let legend = if self.0 == SweptParameter::Level { OF_LEVELS } else { LEGEND };
        format!("\n{}", wrapped(legend, "", ""))
    }
}

fn table(over: SweptParameter, records: &[Record]) -> String {
    let columns = [
        "label",
        over.heading(),
        "V",
        "\u{b1}",
        "blurred",
        "A",
        "\u{b1}",
        "blurred",
        "M",
        "\u{b1}",
        "blurred",
        "chi",
        "chi mesh",
        "flags",
    ];
    let mut layout = Layout::new(&columns);
    for record in records {
        layout.row(row(over, record));
    }
    format!("{}\n{}", one_line(&records[0].input), layout.text())
}

fn row(over: SweptParameter, record: &Record) -> Vec<String> {
    let m = &record.measured;
    let number = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), digits);
    let rough = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.2e}"));
    let (e, b) = (&m.standard_error, &m.blurred);
    let codes: Vec<String> = m.flags.iter().map(|flag| flag.code.to_string()).collect();
    vec![
        record.label.as_ref().map_or_else(String::new, ToString::to_string),
        number(over.of(&m.parameters)),
        number(m.volume_mm3),
        rough(e.volume_mm3),
        number(b.volume_mm3),
        number(m.surface_area_mm2),
        rough(e.surface_area_mm2),
        number(b.surface_area_mm2),
        number(m.total_mean_curvature_mm),
        rough(e.total_mean_curvature_mm),
        number(b.total_mean_curvature_mm),
        b.euler_characteristic.map_or_else(|| "-".to_owned(), |chi| format!("{chi:.2}")),
        m.topology.euler_characteristic_mesh.map_or_else(|| "-".to_owned(), |chi| chi.to_string()),
        codes.join(";"),
    ]
}
