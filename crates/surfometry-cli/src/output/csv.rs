//! Results as CSV: nested fields flattened, failed inputs as rows with an `error`.

use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};
use surfometry::runs::{Output, columns_of, flatten};

/// One record at a time, twice: once for the columns, once for the rows, so that many labels need little memory.
pub(crate) fn csv_text<R: Serialize>(output: &Output<R>) -> Result<String> {
    let columns = columns_of(records(output).map(|record| record.map(|r| flatten(&r))))?;
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&columns)?;
    for record in records(output) {
        let row = flatten(&record?);
        writer.write_record(columns.iter().map(|c| row.get(c).map_or_else(String::new, cell)))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn records<R: Serialize>(output: &Output<R>) -> impl Iterator<Item = serde_json::Result<Value>> + '_ {
    let results = output.results.iter().map(|record| {
        let mut value = serde_json::to_value(record)?;
        value["error"] = Value::Null;
        Ok(value)
    });
    results.chain(output.failures.iter().map(|f| Ok(json!({ "input": f.input, "error": f.error }))))
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
