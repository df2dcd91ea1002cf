//! What a blur leaves of the voxels' terraces, and what that adds to area and mean curvature.
//!
//! A plane's sampled indicator has copies of its spectrum at every point xi of the reciprocal lattice. After
//! a blur, xi is seen on the plane as a wave of height exp(-2 pi^2 sigma^2 xi_t^2) / (2 pi xi) where xi's
//! part along the plane, xi_t, is small: where the normal is within about 1 / (2 pi sigma xi) of xi. Surfaces
//! that are curved have all normals; the formulas here are means over them.

use crate::embedding::EdgeProfile;
use crate::integrals::SmearedDelta;
use crate::volume::Spacing;
use std::f64::consts::PI;

/// The mean effect of terraces on a surface in random directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terraces {
    /// Their mean square slope.
    pub square_slope: f64,
    /// By how much the band's sum of area is off, as a share of it, because its samples and the terraces lie
    /// on one grid.
    pub sampling_excess: f64,
}

/// Frequencies, in units of the inverse thickness, above which a band's delta is not seen to be sampled.
const HIGHEST: f64 = 8.0;
/// Thinnest band, in units of the largest spacing, of which all such frequencies are summed: their number
/// grows with its square or cube.
const THINNEST: f64 = 0.05;
/// Mean over a wave's phase y, integrated over tau from 0, of cos(2 pi m Y), where Y = y + sum over k of
/// exp(-tau k^2) sin(2 pi k y) / (pi k): how a terrace's m-th harmonic meets the grid that it comes from. To
/// first order in its height the first is -1.
const HARMONICS: [f64; 4] = [-0.923, 0.592, -0.481, 0.422];

impl Terraces {
    /// Of a blurred mask of some spacing, seen by a delta; `lattice` is [`inverse_fourth_powers`] of the
    /// spacing.
    pub(super) fn new(spacing: Spacing, lattice: f64, profile: &EdgeProfile, delta: &SmearedDelta) -> Self {
        Self {
            square_slope: square_slope(profile, lattice),
            sampling_excess: sampling_excess(spacing, profile, delta),
        }
    }
}

/// `lattice` / (32 pi^4 sigma^4) of one blur: each wave's slope squared, over normals; `lattice` is
/// [`inverse_fourth_powers`].
fn square_slope(profile: &EdgeProfile, lattice: f64) -> f64 {
    let at_edge = profile.slope(0.0);
    let share = |&(weight, sigma): &(f64, f64)| weight / (sigma * libm::sqrt(2.0 * PI) * at_edge);
    let pairs = profile.terms().iter().flat_map(|a| profile.terms().iter().map(move |b| (a, b)));
    let sum: f64 = pairs.map(|(a, b)| share(a) * share(b) / (a.1 * a.1 + b.1 * b.1).powi(2)).sum();
    lattice * sum / (8.0 * PI.powi(4))
}

/// A delta that is sampled at the grid's frequency xi passes exp(2 pi i xi x), and the plane's wave of -xi
/// has that phase locked to it: a share of 2 D(xi) over the solid angle 1 / (4 pi^2 sigma^2 xi^2) in which
/// the wave is seen, with D the delta's spectrum across the edge. As the wave is as high as the delta is far
/// from uniform, harmonics count, by [`HARMONICS`].
fn sampling_excess(spacing: Spacing, profile: &EdgeProfile, delta: &SmearedDelta) -> f64 {
    let sampled = SampledDelta::new(spacing, profile, delta);
    let mut excess = 0.0;
    for frequency in sampled.frequencies() {
        let angle = 1.0 / (2.0 * PI * profile.sigma() * frequency).powi(2);
        for (harmonic, constant) in sampled.harmonics(frequency).zip(HARMONICS) {
            // A wave's change of height across the band, to first order in 1 / (2 pi sigma xi).
            let lean = 1.0 / (2.0 * PI * harmonic * profile.sigma().powi(2));
            excess += 2.0 * constant * angle * sampled.spectrum(harmonic, lean);
        }
    }
    excess
}

/// A band's delta across a flat edge, as the grid that it is sampled on sees it.
pub(super) struct SampledDelta<'a> {
    spacing: Spacing,
    profile: &'a EdgeProfile,
    delta: &'a SmearedDelta,
    /// Half of the band's thickness.
    half: f64,
    /// The frequency up to which it is looked at.
    highest: f64,
}

impl<'a> SampledDelta<'a> {
    pub(super) fn new(spacing: Spacing, profile: &'a EdgeProfile, delta: &'a SmearedDelta) -> Self {
        let half = profile.distance_of(delta.half_width().min(profile.value(6.0 * profile.sigma())));
        // What thinner bands miss or hit is chance, which is flagged (`thickness-below-spacing`); and
        // frequencies without end would take as long to sum.
        let highest = HIGHEST / (2.0 * half).max(spacing.smallest()).max(THINNEST * spacing.largest());
        Self { spacing, profile, delta, half, highest }
    }

    /// Magnitudes of the reciprocal lattice's points, one of xi and -xi, that are no multiples of others.
    pub(super) fn frequencies(&self) -> Vec<f64> {
        let h = self.spacing.mm();
        let reach = h.map(|h| (self.highest * h).floor() as i64);
        let mut frequencies = Vec::new();
        for k in -reach[2]..=reach[2] {
            for j in -reach[1]..=reach[1] {
                for i in -reach[0]..=reach[0] {
                    if is_primitive([i, j, k]) && [i, j, k] >= [0, 0, 0] {
                        let square = (0..3).map(|a| ([i, j, k][a] as f64 / h[a]).powi(2)).sum::<f64>();
                        frequencies.push(square.sqrt());
                    }
                }
            }
        }
        frequencies
    }

    /// The multiples of a frequency.
    pub(super) fn harmonics(&self, frequency: f64) -> impl Iterator<Item = f64> + use<> {
        let highest = self.highest;
        (1..).map(move |m| f64::from(m) * frequency).take_while(move |&harmonic| harmonic <= highest)
    }

    /// D: the delta across the edge at a frequency, and with it `lean` times the same of the distance from
    /// the edge.
    pub(super) fn spectrum(&self, frequency: f64, lean: f64) -> f64 {
        const STEPS: i32 = 32;
        let step = self.half / f64::from(STEPS);
        let turn = 2.0 * PI * frequency;
        let at = |v: f64| {
            let wave = libm::cos(turn * v) + lean * v * libm::sin(turn * v);
            self.delta.delta(self.profile.value(v)) * self.profile.slope(v) * wave
        };
        2.0 * step * (0..STEPS).map(|n| at((f64::from(n) + 0.5) * step)).sum::<f64>()
    }
}

pub(super) fn is_primitive(index: [i64; 3]) -> bool {
    let divisor = |mut a: i64, mut b: i64| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a.abs()
    };
    divisor(divisor(index[0], index[1]), index[2]) == 1
}

/// The sum over the reciprocal lattice, the origin left out, of 1 / xi^4, mm^4; what lies beyond the summed
/// box is integrated.
pub(super) fn inverse_fourth_powers(spacing: Spacing) -> f64 {
    const REACH: i32 = 12;
    let h = spacing.mm();
    let smallest = h.iter().map(|h| 1.0 / h).fold(f64::INFINITY, f64::min);
    // A ball of frequencies, as many cells along each axis as it takes.
    let radius = f64::from(REACH) * smallest;
    let reach = h.map(|h| (radius * h).floor() as i32);
    let mut sum = 0.0;
    for k in -reach[2]..=reach[2] {
        for j in -reach[1]..=reach[1] {
            for i in -reach[0]..=reach[0] {
                let square = [i, j, k].iter().zip(h).map(|(&n, h)| (f64::from(n) / h).powi(2)).sum::<f64>();
                if square > 0.0 && square <= radius * radius {
                    sum += 1.0 / (square * square);
                }
            }
        }
    }
    sum + 4.0 * PI * spacing.cell_volume() / radius
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Epstein's zeta function of the cubic lattice at 4 is 16.5323.
    #[test]
    fn lattice_sums() {
        let cubic = inverse_fourth_powers(Spacing::new([1.0; 3]).unwrap());
        assert!((cubic / 16.5323 - 1.0).abs() < 2e-3, "{cubic}");
        // On slices far apart it is that of a line of frequencies: 2 zeta(4) h^4.
        let thick = inverse_fourth_powers(Spacing::new([0.1, 0.1, 2.0]).unwrap());
        assert!((thick / (2.0 * 1.082_323 * 16.0) - 1.0).abs() < 0.03, "{thick}");
    }

    /// One blur's closed form; and the integral over directions, by brute force.
    #[test]
    fn slopes_of_random_planes() {
        let blur = square_slope(&EdgeProfile::blurred(2.0), 16.5323);
        assert!((blur / (16.5323 / (32.0 * PI.powi(4) * 16.0)) - 1.0).abs() < 1e-12);
        let profile = EdgeProfile::corrected(2.0);
        // One frequency of 1 / mm and its opposite: normals within pi / 2 of either.
        let step = 1e-5;
        let mut mean = 0.0;
        for n in 0..100_000 {
            let along = libm::sin((f64::from(n) + 0.5) * step);
            let wave = |&(weight, sigma): &(f64, f64)| {
                weight / (sigma * libm::sqrt(2.0 * PI)) * libm::exp(-2.0 * (PI * sigma * along).powi(2))
            };
            let height = profile.terms().iter().map(wave).sum::<f64>() / (2.0 * PI * profile.slope(0.0));
            mean += 2.0 * (2.0 * PI * along * height).powi(2) * along * step;
        }
        assert!((square_slope(&profile, 2.0) / mean - 1.0).abs() < 0.02, "{mean}");
    }

    #[test]
    fn harmonics_are_the_integrals_they_are_said_to_be() {
        for (m, constant) in (1..).zip(HARMONICS) {
            let mean = |tau: f64| {
                let phases = (0..500).map(|n| (f64::from(n) + 0.5) / 500.0);
                let wave = |y: f64, k: i32| {
                    let k = f64::from(k);
                    libm::exp(-tau * k * k) * libm::sin(2.0 * PI * k * y) / (PI * k)
                };
                let moved = |y: f64| y + (1..=20).map(|k| wave(y, k)).sum::<f64>();
                phases.map(|y| libm::cos(2.0 * PI * f64::from(m) * moved(y)) / 500.0).sum::<f64>()
            };
            // Steps that grow from 0, where harmonics vanish within 1 / k^2.
            let integral: f64 = (0..200)
                .map(|n| (f64::from(n) + 0.5) / 200.0)
                .map(|s| mean(8.0 * s.powi(3)) * 24.0 * s * s / 200.0)
                .sum();
            assert!((integral - constant).abs() < 2e-3, "{m}: {integral}");
        }
    }
}
