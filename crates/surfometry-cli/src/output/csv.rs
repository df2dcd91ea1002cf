//! Results as CSV: nested fields flattened, failed inputs as rows with an `error`.

use anyhow::Result;
use serde_json::{Value, json};
use surfometry::runs::{Output, columns_and_rows};

pub(crate) fn csv_text(output: &Output) -> Result<String> {
    let mut records = output.results.iter().map(serde_json::to_value).collect::<Result<Vec<_>, _>>()?;
    for record in &mut records {
        record["error"] = Value::Null;
    }
    records.extend(output.failures.iter().map(|f| json!({ "input": f.input, "error": f.error })));
    let (columns, rows) = columns_and_rows(&records);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&columns)?;
    for row in rows {
        writer.write_record(row.iter().map(cell))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
