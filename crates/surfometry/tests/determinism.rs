//! The same bits for any number of threads, and whatever else is in the image.

mod common;

use common::{poses, values};
use surfometry::Measurement;
use surfometry::embedding::{Embedding, GaussianEmbedding, TRUNCATION};
use surfometry::integrals::{
    Band, Integrals, Partial, Quadrature, QuadratureRule, SmearedDelta, Smearing, integrate_boxes,
};
use surfometry::local_geometry::{Differentiation, GaussianDerivatives};
use surfometry::measurement::{Derivatives, EmbeddingKind, Measured};
use surfometry::phantoms::{Genus, Phantom};
use surfometry::tiling::{IndexBox, TILE};
use surfometry::volume::{Grid, Mask};

fn bits(m: &Measured) -> Vec<u64> {
    values(m).iter().flatten().map(|v| v.to_bits()).collect()
}

fn on_threads(threads: usize, measurement: &Measurement, mask: &Mask) -> Vec<u64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    bits(&pool.install(|| measurement.run(mask).unwrap()))
}

#[test]
fn threads_do_not_change_a_bit() {
    let shape = Genus { genus: 2, major: 12.0, minor: 8.0 };
    let mask = Phantom::new(shape, poses()[0], [0.7, 0.5, 0.9]).unwrap().labels().unwrap().mask(1);
    let base = Measurement::default().sigma_mm(1.5);
    for measurement in [
        base,
        base.derivatives(Derivatives::FiniteDifference),
        Measurement::paper(),
        Measurement::default().embedding(EmbeddingKind::Distance),
    ] {
        let one = on_threads(1, &measurement, &mask);
        assert!(one.len() >= 5);
        for threads in [2, 3, 5] {
            assert_eq!(one, on_threads(threads, &measurement, &mask), "{threads} threads, {measurement:?}");
        }
    }
}

/// Tiles hang on image index 0, so neither another object nor a larger image behind it changes a result.
#[test]
fn surroundings_do_not_change_a_bit() {
    let mask = Phantom::new(Genus { genus: 1, major: 12.0, minor: 8.0 }, poses()[1], [1.0; 3]).unwrap();
    let mask = mask.labels().unwrap().mask(1);
    let dimensions = mask.grid().dimensions().map(|n| n + 57);
    let grid = Grid::axis_aligned(dimensions, [1.0; 3]).unwrap();
    let larger = Mask::from_predicate(grid, |i| mask.get(i.map(|v| v as i64)));
    for m in [Measurement::default(), Measurement::paper()] {
        assert_eq!(bits(&m.run(&mask).unwrap()), bits(&m.run(&larger).unwrap()));
    }
}

/// Tiles dealt out in any way, merged in any order: the same bits. This is what slabs and machines will rest
/// on.
#[test]
fn any_split_of_the_tiles_merges_to_the_same_bits() {
    let shape = Genus { genus: 2, major: 12.0, minor: 8.0 };
    let mask = Phantom::new(shape, poses()[2], [0.7, 0.6, 0.8]).unwrap().labels().unwrap().mask(1);
    let scheme = GaussianDerivatives::new(GaussianEmbedding::new(&mask, 1.6, 0.5, TRUNCATION));
    let band = Band::new(SmearedDelta::new(Smearing::Sine, 0.25, 0.5), 2.2);
    let quadrature = Quadrature::unbounded(QuadratureRule::Sum);
    let tiles = scheme.embedding().support(band.delta().half_width()).tiles(TILE);
    let spacing = mask.grid().spacing();
    let whole = Integrals::of(&integrate_boxes(&scheme, &tiles, &band, &quadrature), spacing);
    for parts in [2, 3, 7] {
        let part = |n: usize| -> Partial {
            let own: Vec<IndexBox> = tiles.iter().skip(n).step_by(parts).copied().collect();
            integrate_boxes(&scheme, &own, &band, &quadrature)
        };
        let merged = (0..parts).rev().fold(Partial::default(), |sum, n| sum.merged(&part(n)));
        assert_eq!(Integrals::of(&merged, spacing), whole, "{parts} parts of {} tiles", tiles.len());
    }
    assert!(tiles.len() > 7 && whole.surface.area > 0.0);
}
