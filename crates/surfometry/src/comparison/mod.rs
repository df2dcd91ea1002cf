//! Two tables of the same objects: who goes with whom, and how far their numbers agree.

mod matching;
mod measures;
mod table;

pub use matching::Matching;
pub use measures::{
    COMPARE_SCHEMA, ColumnPair, Comparison, EulerAgreement, MeasureAgreement, PairedValue, compare,
};
pub use table::{ObjectKey, Row, Table, TableError};
