//! The page's JSON: all numbers of all objects, and what the viewer has to know beside.

use super::{Provenance, Report};
use crate::Choice;
use crate::pictures::{Basis, ColorScale, ScaleKind, View};
use crate::runs::{Failure, MadeBy, Record, SCHEMA, csv_lines};
use crate::surface::LocalQuantity;
use serde::Serialize;
use serde_json::{Value, json};
use std::io;

/// Everything but what the viewer of one object unpacks when that is opened.
#[derive(Debug, Serialize)]
struct PageData<'a> {
    title: &'a str,
    objects: Vec<Value>,
    failures: &'a [Failure],
    provenance: &'a Provenance,
    made_by: MadeBy,
    schema: &'static str,
    quantities: Vec<Value>,
    scales: Vec<Value>,
    views: Vec<Value>,
    /// The table of `measure --format csv`: its header, then a line an object.
    csv: Vec<String>,
}

/// The page's JSON, which may stand in a script element.
pub(super) fn page_json(report: &Report) -> io::Result<String> {
    let objects: Vec<Value> = report
        .objects
        .iter()
        .map(|object| serde_json::to_value(object).map(lasting))
        .collect::<serde_json::Result<_>>()?;
    let records: Vec<Value> = report
        .objects
        .iter()
        .map(|object| serde_json::to_value(&object.result.record).map(without_times))
        .collect::<serde_json::Result<_>>()?;
    let csv = csv_lines::<Record>(records)?;
    let data = PageData {
        title: &report.title,
        objects,
        failures: &report.failures,
        provenance: &report.provenance,
        made_by: MadeBy::this(),
        schema: SCHEMA,
        quantities: LocalQuantity::ALL.iter().map(|quantity| described(*quantity)).collect(),
        scales: scales(),
        views: View::ALL.iter().map(|view| seen_from(*view)).collect(),
        csv,
    };
    // What would end a script element, or begin a comment in it, begins so.
    Ok(serde_json::to_string(&data)?.replace('<', "\\u003c"))
}

/// Without what differs from run to run, and without histograms, of which the viewer makes its own.
fn lasting(mut object: Value) -> Value {
    object["result"] = without_times(object["result"].take());
    if let Some(distributions) = object["result"]["distributions"].as_array_mut() {
        for distribution in distributions.iter_mut().filter_map(Value::as_object_mut) {
            distribution.remove("histogram");
        }
    }
    object
}

fn without_times(mut record: Value) -> Value {
    for time in ["read_seconds", "seconds"] {
        record[time] = Value::Null;
    }
    record
}

fn described(quantity: LocalQuantity) -> Value {
    json!({
        "name": quantity.name(),
        "title": quantity.meaning(),
        "unit": quantity.unit(),
        "signed": quantity.is_signed(),
    })
}

fn seen_from(view: View) -> Value {
    let Basis { right, up, toward } = view.basis();
    json!({"name": view.word(), "right": right, "up": up, "toward": toward})
}

/// Stops of a colour scale.
const STOPS: u32 = 64;

/// Colour scales that the colour-blind can read, the first of each kind being that of the pictures.
fn scales() -> Vec<Value> {
    let own = |kind| {
        let stops = ColorScale::new(kind, 1.0).stops(STOPS as usize);
        stops.into_iter().map(|(_, rgb)| rgb).collect::<Vec<_>>()
    };
    let of = |gradient: colorous::Gradient| {
        let color = |n| gradient.eval_rational(n as usize, STOPS as usize);
        (0..STOPS).map(color).map(|color| [color.r, color.g, color.b]).collect::<Vec<_>>()
    };
    let reversed = |gradient| of(gradient).into_iter().rev().collect::<Vec<_>>();
    let scale =
        |name, signed, colors: Vec<[u8; 3]>| json!({"name": name, "signed": signed, "colors": colors});
    vec![
        scale("cool – warm", true, own(ScaleKind::Diverging)),
        scale("purple – orange", true, reversed(colorous::PURPLE_ORANGE)),
        scale("viridis", false, own(ScaleKind::Sequential)),
        scale("cividis", false, of(colorous::CIVIDIS)),
        scale("inferno", false, of(colorous::INFERNO)),
    ]
}
