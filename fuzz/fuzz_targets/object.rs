//! Any mask of up to 12 voxels along an axis, at any spacing and blur: its numbers are finite, or there are none. The program
//! called `speck` has smaller ones, of which there are a thousand in the time of one that is blurred by 30 of its voxels.
#![no_main]

mod case;

use arbitrary::{Arbitrary, Unstructured};
use surfometry::Measurement;
use surfometry::measurement::{EmbeddingKind, SurfaceValues};
use surfometry::volume::{Grid, Mask};

/// Lengths are powers: each octave is as likely as the next.
#[derive(Debug, Arbitrary)]
struct Object {
    size: [u8; 3],
    /// 1e-6 mm at 0, 1e3 mm at 255.
    spacing: u8,
    /// Up to the largest ratio.
    ratios: [u8; 3],
    /// 0.3 voxels at 0, the widest blur at 255.
    sigma: Option<u8>,
    thickness: Option<u8>,
    level: Option<u8>,
    embedding: u8,
}

/// How far sizes go.
struct Ends {
    voxels: usize,
    ratio: f64,
    /// In geometric mean spacings.
    sigma: f64,
}

const LARGE: Ends = Ends { voxels: 12, ratio: 50.0, sigma: 30.0 };
const SMALL: Ends = Ends { voxels: 5, ratio: 3.0, sigma: 2.5 };

const KINDS: [EmbeddingKind; 4] = [
    EmbeddingKind::Corrected,
    EmbeddingKind::Recovering,
    EmbeddingKind::Distance,
    EmbeddingKind::DistanceToVoxels,
];

fn between(low: f64, high: f64, share: u8) -> f64 {
    low * (high / low).powf(f64::from(share) / 255.0)
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let mut data = Unstructured::new(data);
    let Ok(object) = Object::arbitrary(&mut data) else { return };
    let bits = data.take_rest();
    let Ends { voxels, ratio: most, sigma: widest } = if case::ENDING == "speck" { SMALL } else { LARGE };
    let size = object.size.map(|n| 1 + usize::from(n) % voxels);
    let finest = between(1e-6, 1e3, object.spacing);
    let spacing = object.ratios.map(|ratio| finest * between(1.0, most, ratio));
    let Some(grid) = case::refused(Grid::axis_aligned(size, spacing)) else { return };
    let mask = Mask::from_predicate(grid, |[x, y, z]| {
        let place = (z * 12 + y) * 12 + x;
        bits.get(place / 8).is_some_and(|byte| byte >> (place % 8) & 1 == 1)
    });
    let unit = spacing.iter().product::<f64>().cbrt();
    let mut measurement = Measurement::default().embedding(KINDS[usize::from(object.embedding) % KINDS.len()]);
    if let Some(share) = object.sigma {
        measurement = measurement.sigma_mm(unit * between(0.3, widest, share));
    }
    if let Some(share) = object.thickness {
        measurement = measurement.thickness_mm(unit * between(0.1, 100.0, share));
    }
    if let Some(share) = object.level {
        measurement = measurement.level(0.01 + 0.98 * f64::from(share) / 255.0);
    }
    let Some(measured) = case::refused(measurement.run_settled(mask)) else { return };
    for values in [&measured.values, &measured.standard_error, &measured.blurred.values, &measured.blurred.grid_noise] {
        assert!(numbers(values).into_iter().flatten().all(f64::is_finite), "{measured:?}");
    }
});

fn numbers(values: &SurfaceValues) -> [Option<f64>; 7] {
    [
        values.volume_mm3,
        values.surface_area_mm2,
        values.total_mean_curvature_mm,
        values.average_mean_curvature_per_mm,
        values.total_gaussian_curvature,
        values.euler_characteristic,
        values.total_squared_mean_curvature,
    ]
}
