//! A Zarr array of one chunk: its metadata, a NUL byte, the chunk.
#![no_main]

mod case;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let end = data.iter().position(|&byte| byte == 0).unwrap_or(data.len());
    let folder = case::folder().join("case.zarr");
    let chunk = folder.join("c/0/0/0");
    std::fs::create_dir_all(chunk.parent().expect("a folder")).expect("a folder for the chunk");
    std::fs::write(folder.join("zarr.json"), &data[..end]).expect("metadata");
    std::fs::write(chunk, data.get(end + 1..).unwrap_or_default()).expect("a chunk");
    case::voxels(&folder);
});
