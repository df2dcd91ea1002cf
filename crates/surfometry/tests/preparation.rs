//! Thresholds, largest pieces and filled cavities, against plain flood fills and closed forms.
#![cfg(feature = "io")]

use proptest::prelude::*;
use std::collections::BTreeSet;
use surfometry::inputs::{OpenOptions, Preparation, Source, open};
use surfometry::io::write_labels;
use surfometry::phantoms::Phantom;
use surfometry::runs::{Plan, records_of};
use surfometry::volume::{Grid, LabelImage};

const SPACING: [f64; 3] = [0.8, 1.0, 1.3];

fn preparation(threshold: &str, steps: &str) -> Preparation {
    let threshold = (!threshold.is_empty()).then(|| threshold.parse().unwrap());
    Preparation {
        threshold,
        largest_component: steps.contains("largest"),
        fill_cavities: steps.contains("fill"),
    }
}

/// The labels of an image in memory order, after it was written, opened and prepared.
fn prepared(size: [usize; 3], values: &[i64], preparation: Preparation) -> (Vec<i64>, Box<dyn Source>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.nii");
    let grid = Grid::axis_aligned(size, SPACING).unwrap();
    write_labels(&path, &LabelImage::from_voxels(grid, values).unwrap()).unwrap();
    let source =
        open(path.to_str().unwrap(), &OpenOptions { preparation, ..OpenOptions::default() }).unwrap();
    let image = LabelImage::from_slabs(&mut source.slabs().unwrap()).unwrap();
    let labels = (0..values.len()).map(|number| image.get(grid.index_of(number))).collect();
    (labels, source)
}

/// The voxels that can be reached from one over voxels that are wanted, and whether the image's edge is among them: slow and
/// plain.
fn reached(
    size: [usize; 3],
    from: usize,
    steps: i64,
    wanted: impl Fn(usize) -> bool,
) -> (BTreeSet<usize>, bool) {
    let index = |n: usize| [n % size[0], n / size[0] % size[1], n / size[0] / size[1]].map(|v| v as i64);
    let (mut seen, mut stack, mut edge) = (BTreeSet::from([from]), vec![from], false);
    while let Some(voxel) = stack.pop() {
        let [x, y, z] = index(voxel);
        for [dx, dy, dz] in (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]) {
            let next = [x + dx, y + dy, z + dz];
            if dx.abs() + dy.abs() + dz.abs() > steps {
                continue;
            }
            if (0..3).any(|a| next[a] < 0 || next[a] >= size[a] as i64) {
                edge = true;
                continue;
            }
            let number = ((next[2] * size[1] as i64 + next[1]) * size[0] as i64 + next[0]) as usize;
            if wanted(number) && seen.insert(number) {
                stack.push(number);
            }
        }
    }
    (seen, edge)
}

/// The largest piece of each label, by the definition.
fn largest_pieces(size: [usize; 3], values: &[i64]) -> Vec<i64> {
    let mut kept = vec![0; values.len()];
    for label in values.iter().copied().filter(|v| *v != 0).collect::<BTreeSet<_>>() {
        let starts = (0..values.len()).filter(|&n| values[n] == label);
        let pieces = starts.map(|n| reached(size, n, 3, |m| values[m] == label).0);
        // The first of the largest.
        let largest =
            pieces.fold(BTreeSet::new(), |best, piece| if piece.len() > best.len() { piece } else { best });
        for n in largest {
            kept[n] = label;
        }
    }
    kept
}

/// Every background voxel that a label encloses, by the definition.
fn without_cavities(size: [usize; 3], values: &[i64]) -> Vec<i64> {
    let labels: BTreeSet<i64> = values.iter().copied().filter(|v| *v != 0).collect();
    let filled = |n: usize| {
        let enclosing = labels.iter().filter_map(|&label| {
            let (cavity, edge) = reached(size, n, 1, |m| values[m] != label);
            (!edge).then_some((cavity.len(), label))
        });
        enclosing.min().map_or(0, |(_, label)| label)
    };
    (0..values.len()).map(|n| if values[n] == 0 { filled(n) } else { values[n] }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn as_flood_fills_say(values in prop::collection::vec(prop::sample::select(vec![0i64, 0, 0, 1, 1, 1, 1, 7, -2]), 6 * 5 * 4)) {
        prop_assume!(values.iter().any(|v| *v != 0));
        let size = [6, 5, 4];
        let pieces = largest_pieces(size, &values);
        prop_assert_eq!(&prepared(size, &values, preparation("", "largest")).0, &pieces);
        prop_assert_eq!(prepared(size, &values, preparation("", "fill")).0, without_cavities(size, &values));
        // Pieces first: what was a speck in a cavity is filled.
        prop_assert_eq!(prepared(size, &values, preparation("", "largest fill")).0, without_cavities(size, &pieces));
        if values.contains(&7) {
            let within: Vec<i64> = values.iter().map(|v| i64::from((1..=7).contains(v))).collect();
            prop_assert_eq!(prepared(size, &values, preparation("1..7", "")).0, within);
        }
    }
}

/// A lesion (2) with a hole of its own in a bone (1): the hole is the lesion's, the gap around it the bone's.
#[test]
fn the_innermost_label_has_a_cavity() {
    let size = [11; 3];
    let distance =
        |n: usize| [n % 11, n / 11 % 11, n / 121].into_iter().map(|v| v.abs_diff(5)).max().unwrap();
    let values: Vec<i64> = (0..11 * 11 * 11).map(|n| [0, 2, 0, 0, 1, 0][distance(n)]).collect();
    let (filled, source) = prepared(size, &values, preparation("", "fill"));
    let expected: Vec<i64> = (0..values.len()).map(|n| [2, 2, 1, 1, 1, 0][distance(n)]).collect();
    assert_eq!(filled, expected);
    let counts = source.preparations().unwrap();
    let of = |label: &str| match label.parse().unwrap() {
        surfometry::volume::LabelSelection::Groups(groups) => {
            counts.of(Some(&groups[0])).changes.filled_voxels
        }
        surfometry::volume::LabelSelection::All => counts.of(None).changes.filled_voxels,
    };
    assert_eq!([of("1"), of("2"), of("1+2"), of("all")], [7 * 7 * 7 - 27, 1, 7 * 7 * 7 - 26, 7 * 7 * 7 - 26]);
}

/// A scan's bone: a shell of 700, marrow of 0, air of -1000, and specks. What is made of it is the ball, whose closed form its
/// numbers hold.
#[test]
fn a_bone_out_of_grey_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ct.nii.gz");
    let spec = |shape: &str| format!("{shape}&spacing=0.8,1,1.3&shift=0.3,0.1,0.2");
    let outer = Phantom::from_spec(&spec("ball?radius=15")).unwrap();
    let (ball, grid) = (outer.labels().unwrap(), *outer.grid());
    let centre: Vec<f64> = (0..3).map(|a| (grid.dimensions()[a] / 2) as f64).collect();
    let grey = |number: usize| {
        let index = grid.index_of(number);
        let square: f64 = (0..3).map(|a| ((index[a] as f64 - centre[a]) * SPACING[a]).powi(2)).sum();
        match (ball.get(index), square < 81.0) {
            (0, _) if number.is_multiple_of(997) && square > 324.0 => 900,
            (0, _) => -1000,
            (_, true) => 0,
            _ => 700 + (number % 41) as i64,
        }
    };
    let values: Vec<i64> = (0..grid.voxel_count()).map(grey).collect();
    write_labels(&path, &LabelImage::from_voxels(grid, &values).unwrap()).unwrap();
    let plan =
        |preparation| Plan { open: OpenOptions { preparation, ..OpenOptions::default() }, ..Plan::default() };
    let records = records_of(path.to_str().unwrap(), &plan(preparation("400..", "largest fill"))).unwrap();
    let [record] = &records[..] else { panic!("one object") };
    let (own, exact) = (&record.measured, outer.truth().unwrap());
    assert_eq!(own.voxels.count, ball.mask(1).voxels());
    let off = |value: Option<f64>, error: Option<f64>, exact: f64| (value.unwrap() - exact) / error.unwrap();
    assert!(off(own.volume_mm3, own.standard_error.volume_mm3, exact.volume).abs() < 3.0);
    assert!(off(own.surface_area_mm2, own.standard_error.surface_area_mm2, exact.surface_area).abs() < 3.0);
    let prepared = record.preparation.unwrap();
    let specks = values.iter().filter(|v| **v == 900).count() as u64;
    let marrow = values.iter().filter(|v| **v == 0).count() as u64;
    assert_eq!((prepared.changes.dropped_voxels, prepared.changes.filled_voxels), (specks, marrow));
    let flags: Vec<String> = own.flags.iter().map(|flag| flag.code.to_string()).collect();
    assert!(
        ["pieces-dropped", "cavities-filled"].iter().all(|code| flags.contains(&(*code).to_owned())),
        "{flags:?}"
    );
    // A threshold alone streams, and names nothing that was changed.
    let records = records_of(path.to_str().unwrap(), &plan(preparation("400..", ""))).unwrap();
    assert_eq!(records[0].measured.voxels.count, values.iter().filter(|v| **v >= 400).count() as u64);
    assert!(!records[0].measured.flags.iter().any(|flag| flag.code.to_string().ends_with("dropped")));
    // Nothing within says what there is.
    let nothing = records_of(path.to_str().unwrap(), &plan(preparation("5000..", ""))).unwrap_err();
    assert!(nothing.to_string().contains("from -1000 to 900"), "{nothing}");
}

/// An image in which an object keeps its grey values and all else is 0 is told of; one of as many cells is not.
#[test]
fn grey_values_are_not_labels() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid::axis_aligned([40; 3], [1.0; 3]).unwrap();
    let mixed = |n: usize| (n * 2_654_435_761 % 4093 % 1500) as i64;
    let cells = |n: usize| {
        let [x, y, z] = grid.index_of(n).map(|v| v / 4);
        ((z * 10 + y) * 10 + x) as i64 + 1
    };
    let flagged = |values: Vec<i64>, preparation: Preparation| {
        let path = folder.path().join("image.nii");
        write_labels(&path, &LabelImage::from_voxels(grid, &values).unwrap()).unwrap();
        let open = OpenOptions { preparation, ..OpenOptions::default() };
        let plan = Plan { open, labels: "3".parse().unwrap(), per_component: true, ..Plan::default() };
        let records = records_of(path.to_str().unwrap(), &plan);
        records.map(|records| {
            records[0].measured.flags.iter().any(|flag| flag.code.to_string() == "grey-values")
        })
    };
    let none = Preparation::default();
    assert!(flagged((0..64_000).map(mixed).collect(), none).unwrap());
    assert!(!flagged((0..64_000).map(cells).collect(), none).unwrap());
    let refused = flagged((0..64_000).map(mixed).collect(), preparation("", "fill")).unwrap_err().to_string();
    assert!(refused.contains("grey values") && refused.contains("threshold"), "{refused}");
}

/// A shape's truth stays where nothing was changed, and goes where something was.
#[test]
fn truth_is_of_the_shape_as_it_was() {
    let known = |spec: &str| {
        let preparation = preparation("", "largest fill");
        let source = open(spec, &OpenOptions { preparation, ..OpenOptions::default() }).unwrap();
        LabelImage::from_slabs(&mut source.slabs().unwrap()).unwrap();
        source.truth().is_some()
    };
    assert!(known("phantom:ball?radius=6") && !known("phantom:shell?radius=9&inner=4"));
}

/// The ends of a threshold lie inside, also where a float of single precision has no number that is theirs: 0.1, 0.3 and a
/// third are not among its, and the nearest ones are meant.
#[test]
fn ends_of_a_threshold_are_inside_in_single_precision() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let ends = [0.1f32, 0.3, 1.0 / 3.0];
    let values = |end: f32| [end.next_down(), end, end.next_up()];
    let all: Vec<f32> = ends.into_iter().flat_map(values).cycle().take(4 * 5 * 6).collect();
    let mut header = "{'descr': '<f4', 'fortran_order': True, 'shape': (4, 5, 6), }".to_owned();
    header += &" ".repeat(117 - header.len());
    let bytes: Vec<u8> = all.iter().flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(&path, [b"\x93NUMPY\x01\0\x76\0", header.as_bytes(), b"\n", &bytes].concat()).unwrap();
    let inside = |threshold: &str| {
        let options = OpenOptions {
            spacing: Some(SPACING),
            preparation: preparation(threshold, ""),
            ..OpenOptions::default()
        };
        let source = open(path.to_str().unwrap(), &options).unwrap();
        let image = LabelImage::from_slabs(&mut source.slabs().unwrap()).unwrap();
        (0..all.len()).map(|i| image.get(image.grid().index_of(i)) == 1).collect::<Vec<bool>>()
    };
    for (text, nearest) in [("0.1", ends[0]), ("0.3", ends[1]), ("0.3333333333333333", ends[2])] {
        let expected =
            |is_inside: &dyn Fn(f32) -> bool| all.iter().map(|v| is_inside(*v)).collect::<Vec<_>>();
        assert_eq!(inside(&format!("{text}..")), expected(&|value| value >= nearest), "{text}..");
        assert_eq!(inside(&format!("..{text}")), expected(&|value| value <= nearest), "..{text}");
        assert_eq!(inside(&format!("{text}..{text}")), expected(&|value| value == nearest), "{text}");
    }
}
