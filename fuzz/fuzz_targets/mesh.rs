//! A mesh in one file.
#![no_main]

mod case;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    case::refused(surfometry::io::read_mesh(&case::file(data)));
});
