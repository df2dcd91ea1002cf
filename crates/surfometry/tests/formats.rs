//! What is written is read back.

mod common;

use common::{assert_same, assert_same_place};
use surfometry::Measurement;
use surfometry::io::read_labels;
use surfometry::phantoms::{Ellipsoid, Phantom, Pose};
use surfometry::volume::{Affine, Grid, LabelImage, Samples, Slab, SlabReader, VolumeError};

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

/// What is written is read back: voxels, labels of every width, oblique and mirrored affines, one or two
/// versions.
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
    let (file, memory) = (m.run(read_labels(&path).unwrap().mask(1)).unwrap(), m.run(image.mask(1)).unwrap());
    assert_same("phantom", &file, &memory, 1e-6);
    assert_same_place("phantom", &file, &memory);
}
