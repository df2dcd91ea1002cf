//! Two tables of the same objects: who goes with whom, and how far their numbers agree.
//!
//! ```
//! use surfometry::{comparison::{Table, compare}, statistics::Bootstrap};
//! let folder = tempfile::tempdir()?;
//! let table = |name: &str, rows: &str| {
//!     let path = folder.path().join(name);
//!     std::fs::write(&path, format!("input,label,volume_mm3\n{rows}"))?;
//!     Ok::<_, Box<dyn std::error::Error>>(Table::read(&path)?)
//! };
//! let ours = table("ours.csv", "a,1,101\nb,1,202\nc,1,299\n")?;
//! let theirs = table("theirs.csv", "a,1,100\nb,1,200\nc,1,300\n")?;
//! let names = ["ours".to_owned(), "theirs".to_owned()];
//! let comparison = compare([&ours, &theirs], names, &[], Bootstrap::default())?;
//! assert_eq!(comparison.matched, 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chosen;
mod column_pair;
mod decimals;
mod delimited;
mod error;
mod matching;
mod measures;
mod sheet;
mod table;
mod table_names;
mod variants;

pub use chosen::{chosen_columns, read_tables};
pub use column_pair::{ColumnChoice, ColumnPair};
pub use decimals::Place;
pub use error::TableError;
pub use matching::Matching;
pub(crate) use matching::by_name;
pub use measures::{
    COMPARE_SCHEMA, Comparison, EulerAgreement, MeasureAgreement, PairedValue, RowsTold, compare,
};
pub use table::{KeyColumns, ObjectKey, Row, Table, TableFiles};
pub use table_names::names_of;
