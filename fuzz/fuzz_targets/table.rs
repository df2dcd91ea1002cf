//! Two tables of numbers, behind each other, that are compared.
#![no_main]

mod case;

use surfometry::comparison::{Table, compare};
use surfometry::statistics::Bootstrap;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let Some(table) = case::refused(Table::read(&case::file(data))) else { return };
    let names = ["a".to_owned(), "b".to_owned()];
    let bootstrap = Bootstrap { samples: 20, ..Bootstrap::default() };
    case::refused(compare([&table, &table], names, &[], bootstrap));
});
