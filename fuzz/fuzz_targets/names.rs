//! A table of labels' names.
#![no_main]

mod case;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    case::refused(surfometry::io::read_label_names(case::file(data)));
});
