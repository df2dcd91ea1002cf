//! Images that go by in slabs: the same bits as held whole, whatever the slabs, and memory that does not
//! follow the image.

mod common;

use common::{phantom, poses, without_times};
use surfometry::Measurement;
use surfometry::measurement::{Derivatives, EmbeddingKind};
use surfometry::phantoms::Genus;
use surfometry::volume::{Grid, LabelImage, LabelSelection, Samples, Slab, SlabReader, VolumeError};

/// An image as slabs of a number of slices.
struct InSlabs<'a> {
    image: &'a LabelImage,
    slices: usize,
    next: usize,
}

impl SlabReader for InSlabs<'_> {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        self.image.grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        let [nx, ny, nz] = self.image.grid().dimensions();
        let range = self.next..(self.next + self.slices).min(nz);
        self.next = range.end;
        let voxels = range.clone().flat_map(|z| (0..ny).map(move |y| (y, z)));
        let row = |(y, z)| (0..nx).map(move |x| [x, y, z]);
        let values: Vec<i16> = voxels.flat_map(row).map(|index| self.image.get(index) as i16).collect();
        let more = !range.is_empty();
        Ok(more.then_some(Slab { slices: range, samples: Samples::I16(values) }))
    }
}

/// Several objects along z, so that they begin and end in different layers; one of them spans all.
fn stack() -> LabelImage {
    let genus = phantom(Genus { genus: 2, major: 12.0, minor: 8.0 }, poses()[0], [0.9, 0.8, 0.7]);
    let whole = genus.labels().unwrap().mask(1);
    let [nx, ny, nz] = genus.grid().dimensions();
    let dimensions = [nx + 9, ny, 4 * nz + 40];
    let label = |[x, y, z]: [usize; 3]| {
        if x >= nx + 4 {
            // A bar with hollows.
            return if y > 3 && y + 3 < ny && !(z % 23 < 4 && x == nx + 6 && y % 7 < 3) { 9 } else { 0 };
        }
        let (copy, z) = (z / (nz + 10), z % (nz + 10));
        if z < nz && x < nx && whole.get([x, y, z].map(|v| v as i64)) { copy as i16 % 3 + 1 } else { 0 }
    };
    let grid = Grid::axis_aligned(dimensions, [0.9, 0.8, 0.7]).unwrap();
    let values: Vec<i16> = (0..grid.voxel_count()).map(|offset| label(grid.index_of(offset))).collect();
    LabelImage::from_voxels(grid, &values).unwrap()
}

#[test]
fn slabs_change_no_bit() {
    let image = stack();
    let default = Measurement::default().sigma_mm(1.6).thickness_mm(2.2);
    let selections = ["all", "9,1+2,3"].map(|text| text.parse::<LabelSelection>().unwrap());
    for measurement in [
        default,
        default.derivatives(Derivatives::Gaussian),
        Measurement::paper(),
        Measurement::default().embedding(EmbeddingKind::Distance),
    ] {
        for (selection, slices, threads) in
            [(&selections[0], 7, 3), (&selections[0], 130, 1), (&selections[1], 1, 2)]
        {
            let whole = without_times(&measurement.run_labels(&image, selection, |_, _| {}).unwrap());
            assert!(whole.len() >= 3);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut reader = InSlabs { image: &image, slices, next: 0 };
            let streamed = pool.install(|| measurement.run_slabs(&mut reader, selection, |_| {}));
            let streamed = without_times(&streamed.unwrap().results);
            assert_eq!(whole, streamed, "{slices} slices, {threads} threads, {measurement:?}");
        }
    }
}

#[test]
fn what_is_wrong_is_said_as_for_whole_images() {
    let image = stack();
    let of = |measurement: Measurement, selection: &str| {
        let selection: LabelSelection = selection.parse().unwrap();
        let mut reader = InSlabs { image: &image, slices: 40, next: 0 };
        let streamed = measurement.run_slabs(&mut reader, &selection, |_| {}).unwrap_err().to_string();
        assert_eq!(streamed, measurement.run_labels(&image, &selection, |_, _| {}).unwrap_err().to_string());
        streamed
    };
    assert!(of(Measurement::default(), "77,78").contains("77"));
    // Where some occur, they are measured.
    let mut reader = InSlabs { image: &image, slices: 40, next: 0 };
    let streamed = Measurement::default().run_slabs(&mut reader, &"1,77".parse().unwrap(), |_| {}).unwrap();
    assert!(streamed.results.len() == 1 && streamed.missing[0].to_string().contains("77"));
    assert!(of(Measurement::default().sigma_mm(-1.0), "all").contains("sigma"));
    // A blur that leaves nothing is no error, however wide it is.
    let mut reader = InSlabs { image: &image, slices: 40, next: 0 };
    let gone = Measurement::default().sigma_mm(1e4).run_slabs(&mut reader, &LabelSelection::All, |_| {});
    assert!(gone.unwrap().results.iter().all(|(_, m)| m.blurred.values.volume_mm3.is_none()));
}
