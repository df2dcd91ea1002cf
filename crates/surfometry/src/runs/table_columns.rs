//! Results as the columns of a table, for data frames.

use super::Row;
use super::flatten::each_field;
use serde_json::Value;
use std::collections::HashMap;

/// Results as columns, with the names and in the order of CSV: nested fields flattened, null where a row has
/// nothing to say.
///
/// ```
/// use surfometry::runs::{Plan, records_of, table_columns};
/// let records = records_of("phantom:ball?radius=6", &Plan::default())?;
/// let columns = table_columns(records)?;
/// assert_eq!((columns[0].0.as_str(), columns[0].1.len()), ("input", 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A row that cannot be a document.
pub fn table_columns<R: Row>(
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<(String, Vec<Value>)>, serde_json::Error> {
    let names = R::columns();
    let places: HashMap<&str, usize> = names.iter().map(String::as_str).zip(0..).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for (number, row) in rows.into_iter().enumerate() {
        each_field(&mut String::new(), serde_json::to_value(row)?, &mut |name, value| {
            if let Some(&place) = places.get(name) {
                columns[place].push(value);
            }
        });
        for column in &mut columns {
            column.resize(number + 1, Value::Null);
        }
    }
    drop(places);
    Ok(names.into_iter().zip(columns).collect())
}
