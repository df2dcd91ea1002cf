//! One object in every file variant of ../shared/data/real/formats gives one set of numbers.
//!
//! Ignored, visibly, where that folder is absent; `tests/oracles` writes the same variants with other tools.

mod common;

use common::{shared, values};
use std::path::PathBuf;
use surfometry::Measurement;
use surfometry::io::{ReadOptions, read_labels, read_labels_with};
use surfometry::measurement::Measured;
use surfometry::phantoms::{Ellipsoid, Phantom, Pose};
use surfometry::volume::{Affine, Grid, LabelImage, LabelSelection, Samples, Slab, SlabReader, VolumeError};

fn data(name: &str) -> PathBuf {
    shared("formats").join(name)
}

fn measured(image: &LabelImage) -> Measured {
    let groups = LabelSelection::All.resolve(image).unwrap();
    assert_eq!(groups.len(), 1);
    Measurement::default().sigma_mm(3.0).thickness_mm(6.25).run(&image.group_mask(&groups[0])).unwrap()
}

/// Everything that does not depend on where the object lies, within `tolerance`.
fn assert_same(name: &str, found: &Measured, expected: &Measured, tolerance: f64) {
    for (i, (a, b)) in values(found).into_iter().zip(values(expected)).enumerate() {
        let (a, b) = (a.expect("a number"), b.expect("a number"));
        assert!((a / b - 1.0).abs() < tolerance, "{name}: value {i} is {a}, not {b}");
    }
    assert_eq!(found.voxels.count, expected.voxels.count, "{name}");
    assert_eq!(found.topology, expected.topology, "{name}");
}

fn assert_same_place(name: &str, found: &Measured, expected: &Measured) {
    for (a, b) in found.voxels.centroid_mm.iter().zip(expected.voxels.centroid_mm) {
        assert!((a - b).abs() < 1e-3, "{name}: centroid {a}, not {b}");
    }
}

/// Variants with the whole geometry, in the same storage order: the same voxels through another header. Headers in
/// f32 leave 1e-6.
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
    // Spacing is lost: the user gives it.
    let options = ReadOptions { spacing: Some([1.5, 2.0, 2.5]) };
    let found = measured(&read_labels_with(data("femur/femur.npy"), options).unwrap());
    assert_same("femur.npy", &found, &reference, 2e-6);
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
    for name in ["spine_seg.nrrd", "liver_seg.nrrd"] {
        let image = read_labels(data("original").join(name)).unwrap();
        let label = image.summaries()[0].label;
        assert!(image.mask(label).touches_border(), "{name} is cut top and bottom");
    }
    let grey = read_labels(data("original/example_nifti2.nii.gz")).unwrap_err().to_string();
    assert!(grey.contains("volumes in one file"), "{grey}");
}

/// A label image in memory as a source of slabs of one slice.
struct Source {
    grid: Grid,
    labels: Vec<i64>,
    next: usize,
}

impl SlabReader for Source {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        let [nx, ny, nz] = self.grid.dimensions();
        let z = self.next;
        self.next += 1;
        let slice = |z: usize| self.labels[z * nx * ny..(z + 1) * nx * ny].to_vec();
        Ok((z < nz).then(|| Slab { slices: z..z + 1, samples: Samples::I64(slice(z)) }))
    }
}

/// What is written is read back: voxels, labels of every width, oblique and mirrored affines, one or two versions.
#[test]
fn written_labels_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut oblique = Affine::from_directions(
        [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, -1.0]],
        [0.7, 1.1, 2.3],
        [10.5, -20.25, 30.125],
    );
    for (number, labels) in
        [[1, 255, 7], [-3, 2, 1], [300, 65_535, 2], [-40_000, 1, 2], [1 << 40, 3, -1]].into_iter().enumerate()
    {
        for ending in ["nii", "nii.gz"] {
            let grid = Grid::new([5, 4, 6], oblique).unwrap();
            let voxels = (0..120).map(|i| if i % 4 == 3 { 0 } else { labels[i % 4] }).collect();
            let image = LabelImage::from_slabs(&mut Source { grid, labels: voxels, next: 0 }).unwrap();
            let path = folder.path().join(format!("{number}.{ending}"));
            surfometry::io::write_labels(&path, &image).unwrap();
            let back = read_labels(&path).unwrap();
            for i in 0..120 {
                assert_eq!(back.get(grid.index_of(i)), image.get(grid.index_of(i)));
            }
            for corner in [[0.0; 3], [4.0, 3.0, 5.0]] {
                for (a, b) in back.grid().affine().apply(corner).iter().zip(grid.affine().apply(corner)) {
                    assert!((a - b).abs() < 1e-5, "{a} {b}");
                }
            }
        }
        // The other handedness next.
        oblique = Affine { linear: oblique.linear.map(|[x, y, z]| [-x, y, z]), ..oblique };
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 10, "no temporary file is left");
}

#[test]
fn a_long_axis_becomes_nifti_2() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid::axis_aligned([40_000, 2, 2], [0.5, 1.0, 1.0]).unwrap();
    let labels = (0..160_000).map(|i| i64::from(i % 40_000 > 39_990)).collect();
    let image = LabelImage::from_slabs(&mut Source { grid, labels, next: 0 }).unwrap();
    let path = folder.path().join("long.nii");
    surfometry::io::write_labels(&path, &image).unwrap();
    assert_eq!(std::fs::read(&path).unwrap()[..4], 540i32.to_le_bytes());
    let back = read_labels(&path).unwrap();
    assert_eq!(back.grid().dimensions(), [40_000, 2, 2]);
    assert_eq!(back.summaries(), image.summaries());
}

/// The same numbers from a file as from memory.
#[test]
fn a_phantom_survives_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let shape = Ellipsoid { radii: [9.0, 7.0, 6.0] };
    let phantom = Phantom::new(shape, Pose::new([10.0, 20.0, 30.0], [0.1; 3]), [0.5, 0.6, 0.7]).unwrap();
    let image = phantom.labels().unwrap();
    let path = folder.path().join("phantom.nii.gz");
    surfometry::io::write_labels(&path, &image).unwrap();
    let m = Measurement::default();
    let (file, memory) =
        (m.run(&read_labels(&path).unwrap().mask(1)).unwrap(), m.run(&image.mask(1)).unwrap());
    assert_same("phantom", &file, &memory, 1e-6);
    assert_same_place("phantom", &file, &memory);
}
