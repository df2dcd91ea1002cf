//! Small files that earlier versions got wrong; tests beside the code make others of each kind.

use surfometry::io::read_labels;
use surfometry_real_data::fault;

fn refusal(name: &str) -> String {
    read_labels(fault(name)).map(drop).expect_err(name).to_string()
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn damaged_streams_are_refused() {
    for name in [
        "io/B1_flipped_bit_one_byte_more.nii.gz",
        "reliability/checksum_mha_zlib_0004.mha",
        "reliability/checksum_nii_gz_0002.nii.gz",
        "reliability/checksum_nrrd_bzip2_0000.nrrd",
        "reliability/checksum_nrrd_gzip_0000.nrrd",
    ] {
        let message = refusal(name);
        assert!(message.contains("the compressed voxel data are damaged"), "{name}: {message}");
    }
    let padded = read_labels(fault("io/B4_gz_with_4_zero_bytes_behind.nii.gz")).unwrap();
    assert_eq!(padded.summaries()[0].voxels, 3885);
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn an_unknown_header_is_told() {
    let input = fault("io/B3_raw_512_bytes_too_long.mhd");
    let source = surfometry::inputs::open(input.to_str().unwrap(), &Default::default()).unwrap();
    let flags = source.flags();
    assert!(flags[0].message.contains("512 bytes more"), "{flags:?}");
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn spacings_that_no_voxel_has_are_refused() {
    for name in ["spacing_3e38_hang.nii", "one_flipped_bit_hang.nii.gz"] {
        let message = refusal(&format!("reliability/{name}"));
        assert!(message.contains("give the right spacing"), "{name}: {message}");
    }
}
