//! Small files that earlier versions got wrong; tests beside the code make others of each kind.

use surfometry::io::{ReadOptions, read_labels, read_labels_with};
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
    let source =
        surfometry::inputs::open(input.to_str().unwrap(), &surfometry::inputs::OpenOptions::default())
            .unwrap();
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

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn headers_are_read_as_metaio_does() {
    let doubled = read_labels(fault("reliability/transform_matrix_doubled.mha")).unwrap();
    assert_eq!(doubled.grid().spacing().mm(), [0.8, 0.9, 1.1]);
    let quaternion = read_labels(fault("io/C1_quaternion_0.71.nii.gz")).unwrap();
    for (found, stated) in quaternion.grid().spacing().mm().iter().zip([0.8, 1.0, 1.5]) {
        assert!((found / stated - 1.0).abs() < 1e-6, "{found}");
    }
    let image = read_labels(fault("reliability/msb_T.mha")).unwrap();
    assert_eq!(image.summaries().iter().map(|summary| summary.label).collect::<Vec<_>>(), [1, 300]);
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn what_cannot_be_is_refused() {
    let mesh = surfometry::io::read_mesh(&fault("reliability/elements_2e9.ply")).map(drop).unwrap_err();
    assert!(mesh.to_string().contains("export the mesh again"), "{mesh}");
    let field = surfometry::io::read_field(fault("reliability/field_1e300.nii.gz"), ReadOptions::default());
    let refused = field.map(drop).unwrap_err().to_string();
    assert!(refused.contains("scale the field"), "{refused}");
}

/// Headers as other programs write them: 3885 voxels of 0.8 x 1 x 1.5 mm.
#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn headers_of_other_programs_are_read() {
    let spacing = [0.8, 1.0, 1.5];
    for (name, told) in [
        ("D6_singleton_4d_itk.nrrd", None),
        ("D7_unit_pixel.nrrd", Some(spacing)),
        ("D9_unit_Microns.nrrd", Some(spacing)),
        ("D11_pair_magic_n+1.hdr", None),
        ("D11_pair_magic_n+1.img", None),
    ] {
        let image =
            read_labels_with(fault(&format!("io/{name}")), ReadOptions { spacing: told }).expect(name);
        assert_eq!(image.summaries()[0].voxels, 3885, "{name}");
        for (found, stated) in image.grid().spacing().mm().iter().zip(spacing) {
            assert!((found / stated - 1.0).abs() < 1e-6, "{name}: {found}");
        }
    }
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn refusals_name_the_cause() {
    for (name, words) in [
        ("D7_unit_pixel.nrrd", "`pixel`"),
        ("D13_channel_first.nii.gz", "is a channel"),
        ("E8_rgb.nii.gz", "RGB24"),
        ("E9_values_5e-5.nii.gz", "the largest value is 5.00e-5"),
    ] {
        let message = refusal(&format!("io/{name}"));
        assert!(message.contains(words), "{name}: {message}");
    }
}
