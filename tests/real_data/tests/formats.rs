//! One object in every file variant gives one set of numbers; `tests/oracles` writes the same variants with
//! other tools.

#[path = "../../../crates/surfometry/tests/common/mod.rs"]
mod common;

use common::{assert_same, assert_same_place};
use std::path::PathBuf;
use surfometry::Measurement;
use surfometry::io::{ReadOptions, read_labels, read_labels_with};
use surfometry::measurement::Measured;
use surfometry::volume::{LabelImage, LabelSelection};
use surfometry_real_data::real;

fn data(name: &str) -> PathBuf {
    real("formats").join(name)
}

fn measured(image: &LabelImage) -> Measured {
    let groups = LabelSelection::All.resolve(image).unwrap();
    assert_eq!(groups.len(), 1);
    Measurement::default().sigma_mm(3.0).thickness_mm(6.25).run(image.group_mask(&groups[0])).unwrap()
}

/// Variants with the whole geometry, in the same storage order: the same voxels through another header.
/// Headers in f32 leave 1e-6.
const WHOLE: [&str; 17] = [
    "femur.nii",
    "femur_nifti2.nii.gz",
    "femur_bigendian_i16.nii.gz",
    "femur_pair.hdr",
    "femur_pair.img",
    "femur_f32_255.nii.gz",
    "femur_i64.nii.gz",
    "femur_sclslope.nii.gz",
    "femur_qform_only.nii.gz",
    "femur_4d_singleton.nii.gz",
    "femur_micron.nii.gz",
    "femur_zlib.mha",
    "femur.mhd",
    "femur_msb.mhd",
    "femur_gzip.nrrd",
    "femur_detached.nhdr",
    "femur_raw.nrrd",
];

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn every_variant_gives_the_same_numbers() {
    let reference = measured(&read_labels(data("femur/femur.nii.gz")).unwrap());
    assert_eq!(reference.voxels.count, 24_584);
    assert!((reference.voxels.volume_mm3 - 184_380.0).abs() < 0.1);
    for name in WHOLE.iter().chain(&["femur_bzip2.nrrd"]) {
        let found = measured(&read_labels(data("femur").join(name)).unwrap());
        assert_same(name, &found, &reference, 2e-6);
        assert_same_place(name, &found, &reference);
    }
    // Stored in another order: other tiles, the same place in the world.
    for name in ["femur_flipped_x.nii.gz", "femur_permuted.nii.gz"] {
        let found = measured(&read_labels(data("femur").join(name)).unwrap());
        assert_same(name, &found, &reference, 1e-5);
        assert_same_place(name, &found, &reference);
    }
    // Place and orientation are lost, spacing is not.
    for name in ["femur_noform.nii.gz", "femur_spacings_only.nrrd"] {
        assert_same(name, &measured(&read_labels(data("femur").join(name)).unwrap()), &reference, 2e-6);
    }
    // These formats have no directions.
    for name in [
        "femur.AIM",
        "femur_i16.AIM",
        "femur.vtk",
        "femur_imagej.tif",
        "femur_ome0.4.zarr",
        "femur_ome0.5.zarr",
    ] {
        assert_same(name, &measured(&read_labels(data("femur").join(name)).unwrap()), &reference, 2e-6);
    }
    // Spacing is lost: the user gives it.
    let options = ReadOptions { spacing: Some([1.5, 2.0, 2.5]) };
    for name in ["femur.npy", "femur_plain_zlib.tif", "femur_big.tif", "femur_1bit.tif"] {
        let found = measured(&read_labels_with(data("femur").join(name), options).unwrap());
        assert_same(name, &found, &reference, 2e-6);
    }
    let refused = read_labels(data("femur/femur.npy")).unwrap_err().to_string();
    assert!(refused.contains("say what"), "{refused}");
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn other_peoples_files() {
    for name in ["nii.gz", "nrrd", "nhdr"] {
        let path = data("original").join(format!("BallBinary30x30x30.{name}"));
        let image = read_labels(&path).unwrap();
        assert_eq!(image.summaries()[0].label, 257, "{name}");
        assert_eq!(image.summaries()[0].voxels, 14_328, "{name}");
    }
    let gzipped = read_labels(data("original/BallBinary30x30x30_gz.nrrd")).unwrap();
    assert_eq!(gzipped.summaries()[0].voxels, 14_328);
    let isq = read_labels(data("original/test_isq_calibrated_binary_25.ISQ")).unwrap();
    assert_eq!(isq.summaries()[0].voxels, 547);
    assert_eq!(isq.grid().spacing().mm(), [0.06; 3]);
    let galaxy = read_labels(data("original/galaxy_input9_v05.zarr")).unwrap();
    assert_eq!((galaxy.grid().dimensions(), galaxy.summaries()[0].voxels), ([100, 100, 2], 10_076));
    for name in ["spine_seg.nrrd", "liver_seg.nrrd"] {
        let image = read_labels(data("original").join(name)).unwrap();
        let label = image.summaries()[0].label;
        assert!(image.mask(label).touches_border(), "{name} is cut top and bottom");
    }
    let grey = read_labels(data("original/example_nifti2.nii.gz")).unwrap_err().to_string();
    assert!(grey.contains("volumes or channels in one file"), "{grey}");
}
