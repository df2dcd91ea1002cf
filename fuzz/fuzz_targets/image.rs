//! An image in one file.
#![no_main]

mod case;

libfuzzer_sys::fuzz_target!(|data: &[u8]| case::voxels(&case::file(data)));
