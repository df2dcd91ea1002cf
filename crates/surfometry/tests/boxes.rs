//! Images cut into boxes that are measured apart: the same bits as in one piece, whatever the cuts and the
//! order, and errors that say what is amiss.

mod common;

use common::without_times;
use proptest::prelude::*;
use proptest::sample::Index;
use surfometry::Measurement;
use surfometry::measurement::{
    Clip, DecodeError, Derivatives, EmbeddingKind, MergeError, PartialMeasurement,
};
use surfometry::tiling::IndexBox;
use surfometry::volume::{Grid, LabelBlock, LabelImage, LabelSelection};

/// A few tiles, not all of them whole.
const N: [usize; 3] = [140, 100, 290];

/// An ellipsoid of a label; a hollow one leaves background inside.
#[derive(Debug, Clone)]
struct Ellipsoid {
    label: i16,
    centre: [f64; 3],
    radii: [f64; 3],
    hollow: bool,
}

impl Ellipsoid {
    fn label_at(&self, index: [usize; 3]) -> Option<i16> {
        let square = |a: usize| ((index[a] as f64 - self.centre[a]) / self.radii[a]).powi(2);
        let radius: f64 = (0..3).map(square).sum::<f64>();
        (radius <= 1.0).then_some(if self.hollow && radius < 0.4 { 0 } else { self.label })
    }
}

fn ellipsoid() -> impl Strategy<Value = Ellipsoid> {
    let centre = N.map(|n| 0.0..n as f64);
    let radii = [4.0..60.0, 4.0..50.0, 4.0..120.0];
    (1..4i16, centre, radii, any::<bool>()).prop_map(|(label, centre, radii, hollow)| Ellipsoid {
        label,
        centre,
        radii,
        hollow,
    })
}

/// Ellipsoids over each other, with small cubes of another label strewn in.
fn voxels(ellipsoids: &[Ellipsoid]) -> Vec<i16> {
    let [nx, ny, nz] = N;
    let index = (0..nx * ny * nz).map(|n| [n % nx, n / nx % ny, n / nx / ny]);
    let label = |index: [usize; 3]| {
        let [x, y, z] = index.map(|v| v / 5);
        let is_cube = (x * 7 + y * 31 + z * 17) % 499 == 0;
        ellipsoids.iter().find_map(|e| e.label_at(index)).unwrap_or(if is_cube { 7 } else { 0 })
    };
    index.map(label).collect()
}

/// The image cut at some places along each axis.
fn boxes(cuts: &[Vec<Index>; 3]) -> Vec<IndexBox> {
    let ends: [Vec<i64>; 3] = std::array::from_fn(|a| {
        let mut ends: Vec<i64> = cuts[a].iter().map(|cut| cut.index(N[a]) as i64).collect();
        ends.extend([0, N[a] as i64]);
        ends.sort_unstable();
        ends.dedup();
        ends
    });
    let mut boxes = Vec::new();
    for z in ends[2].windows(2) {
        for y in ends[1].windows(2) {
            boxes.extend(ends[0].windows(2).map(|x| IndexBox::new([x[0], y[0], z[0]], [x[1], y[1], z[1]])));
        }
    }
    boxes
}

/// A box of the image, and no more than is needed around it; of a box without tiles a voxel, there is no
/// empty block.
fn block(voxels: &[i16], grid: Grid, region: &IndexBox) -> LabelBlock {
    let region = if region.is_empty() { IndexBox::voxel([0; 3]) } else { *region };
    let row = |(y, z): (i64, i64)| {
        let start = (z as usize * N[1] + y as usize) * N[0];
        &voxels[start + region.lower[0] as usize..start + region.upper[0] as usize]
    };
    let values: Vec<i16> = region.rows().flat_map(|at| row(at).iter().copied()).collect();
    LabelBlock::from_voxels(grid, region, &values).unwrap()
}

fn measured(
    measurement: &Measurement,
    voxels: &[i16],
    grid: Grid,
    region: IndexBox,
    selection: &LabelSelection,
) -> PartialMeasurement {
    let needed = measurement.share(&grid, region).unwrap().needed;
    measurement.measure_box(&block(voxels, grid, &needed), region, selection).unwrap()
}

/// Two at a time, written and read in between.
fn merged(mut parts: Vec<PartialMeasurement>, order: &[Index]) -> PartialMeasurement {
    let mut order = order.iter().cycle();
    let mut next = |parts: &mut Vec<PartialMeasurement>| {
        let part = parts.swap_remove(order.next().unwrap().index(parts.len()));
        let read = PartialMeasurement::from_bytes(&part.to_bytes()).unwrap();
        assert_eq!(part, read);
        read
    };
    while parts.len() > 1 {
        let pair = [next(&mut parts), next(&mut parts)];
        let [a, b] = pair;
        parts.push(a.merged(b).unwrap());
    }
    parts.remove(0)
}

fn cuts() -> impl Strategy<Value = [Vec<Index>; 3]> {
    [1, 1, 2].map(|most| prop::collection::vec(any::<Index>(), 0..=most))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5, max_shrink_iters: 20, ..ProptestConfig::default() })]
    #[test]
    fn boxes_change_no_bit(
        ellipsoids in prop::collection::vec(ellipsoid(), 2..6),
        cuts in cuts(),
        order in prop::collection::vec(any::<Index>(), 24),
        other_order in prop::collection::vec(any::<Index>(), 24),
        spacing in prop_oneof![Just([1.0, 1.0, 1.0]), Just([0.7, 0.8, 0.5])],
        which in 0..4usize,
    ) {
        let grid = Grid::axis_aligned(N, spacing).unwrap();
        let default = Measurement::default();
        let measurement = [
            default,
            default.derivatives(Derivatives::Gaussian),
            Measurement::paper(),
            default.embedding(EmbeddingKind::Distance),
        ][which];
        let voxels = voxels(&ellipsoids);
        let image = LabelImage::from_voxels(grid, &voxels).unwrap();
        // Some label of the first group is there; that of the second always.
        let first = image.summaries()[0].label;
        for selection in ["all".to_owned(), format!("{first},7+{first}")] {
            let selection: LabelSelection = selection.parse().unwrap();
            let whole = without_times(&measurement.run_labels(&image, &selection, |_, _| {}).unwrap());
            let part = |region| measured(&measurement, &voxels, grid, region, &selection);
            let parts: Vec<PartialMeasurement> = boxes(&cuts).into_iter().map(part).collect();
            let all = merged(parts.clone(), &order);
            prop_assert_eq!(&whole, &without_times(&all.results().unwrap()));
            let in_other_order = merged(parts, &other_order);
            prop_assert_eq!(&whole, &without_times(&in_other_order.results().unwrap()));
        }
    }
}

/// Two boxes of an image with a ball that both cut.
fn halves() -> (Grid, Vec<i16>, [IndexBox; 2]) {
    let grid = Grid::axis_aligned(N, [1.0; 3]).unwrap();
    let ball = Ellipsoid { label: 3, centre: [70.0, 50.0, 130.0], radii: [20.0; 3], hollow: false };
    let voxels = (0..grid.voxel_count()).map(|n| ball.label_at(grid.index_of(n)).unwrap_or(0)).collect();
    let [nx, ny, nz] = N.map(|n| n as i64);
    (grid, voxels, [IndexBox::new([0; 3], [nx, ny, 128]), IndexBox::new([0, 0, 128], [nx, ny, nz])])
}

#[test]
fn what_is_amiss_is_said() {
    let (grid, voxels, [lower, upper]) = halves();
    let (default, all) = (Measurement::default(), LabelSelection::All);
    let of = |measurement: &Measurement, region, selection| {
        measured(measurement, &voxels, grid, region, selection)
    };
    let part = of(&default, lower, &all);
    let other = of(&default, upper, &all);

    let missing = part.results().unwrap_err().to_string();
    assert!(missing.contains("2268000 voxels") && missing.contains("z 128..290"), "{missing}");
    assert!(
        matches!(part.clone().merged(part.clone()), Err(MergeError::Overlap { first, .. }) if first == lower)
    );
    for (stranger, what) in [
        (of(&default.sigma_mm(1.9), upper, &all), "parameters"),
        (of(&default, upper, &"3".parse().unwrap()), "selected labels"),
    ] {
        let error = part.clone().merged(stranger).unwrap_err();
        assert!(matches!(error, MergeError::Differs { what: differs, .. } if differs == what), "{error}");
    }
    let coarser = Grid::axis_aligned(N, [2.0, 1.0, 1.0]).unwrap();
    let stranger = PartialMeasurement::new(&default, coarser, &all).unwrap();
    assert!(matches!(part.clone().merged(stranger), Err(MergeError::Differs { what: "affine", .. })));

    let narrow = default.measure_box(&block(&voxels, grid, &lower), lower, &all).unwrap_err().to_string();
    assert!(narrow.contains("z 0..128") && narrow.contains("z 0..1"), "{narrow}");
    assert!(default.clip(Clip::Exclude).share(&grid, lower).is_err());
    assert!(LabelBlock::from_voxels(grid, IndexBox::new([0; 3], [1, 1, 291]), &[0u8; 291]).is_err());

    let unknown = default.measure_box(
        &block(&voxels, grid, &grid.index_box()),
        grid.index_box(),
        &"5".parse().unwrap(),
    );
    assert!(unknown.unwrap().results().unwrap_err().to_string().contains("no label 5"));
    assert_eq!(part.merged(other).unwrap().results().unwrap().len(), 1);
}

#[test]
fn a_value_is_small_and_damage_is_found() {
    let (grid, voxels, [lower, _]) = halves();
    let part = measured(&Measurement::default(), &voxels, grid, lower, &LabelSelection::All);
    let bytes = part.to_bytes();
    assert!(bytes.len() < 4000, "{} bytes", bytes.len());
    assert_eq!(PartialMeasurement::from_bytes(b"no value"), Err(DecodeError::NotOne));
    let mut other = bytes.clone();
    other[20] = b'9';
    assert_eq!(
        PartialMeasurement::from_bytes(&other),
        Err(DecodeError::OtherForm("surfometry-partial/9".to_owned()))
    );
    for length in 0..bytes.len() {
        assert!(
            PartialMeasurement::from_bytes(&bytes[..length]).is_err(),
            "{length} of {} bytes",
            bytes.len()
        );
    }
    // Whatever a byte becomes, what is read is refused or can be used.
    for place in 21..bytes.len() {
        for value in [0, 1, 127, 255] {
            let mut damaged = bytes.clone();
            damaged[place] = value;
            if let Ok(read) = PartialMeasurement::from_bytes(&damaged) {
                assert!(read.results().is_err(), "half of an image is no result");
                let _ = part.clone().merged(read);
            }
        }
    }
}
