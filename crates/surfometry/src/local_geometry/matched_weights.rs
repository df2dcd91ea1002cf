//! Weights of differences that are right where a blurred field has its spectrum.

use std::f64::consts::PI;

/// Voxels on each side of a voxel that its differences need.
pub(super) const SIDE: usize = 4;
/// Voxels of an axis that a difference at a voxel needs.
pub(super) const NODES: usize = 2 * SIDE + 1;
/// Voxels of an axis that a difference between two voxels needs.
pub(super) const NODES_BETWEEN: usize = 2 * SIDE + 2;

/// Weights of the value, the first and the second derivative, in units of 1/spacing^order.
pub(super) type Weights<const N: usize> = [[f64; N]; 3];

/// Share of the spectrum's peak, flat, that stands for the rounding of a field in f32: it keeps the weights small where the
/// blur leaves nothing to fit.
const NOISE: f64 = 1e-13;
/// Frequencies of the fit.
const FREQUENCIES: usize = 400;
/// Moments that are exact: of a constant, a ramp and a parabola.
const MOMENTS: usize = 3;

/// Weights of `N` neighbouring voxels, the first at `first`, for derivatives at a position between them; all in voxels. `sigma` is the
/// field's blur, in voxels too.
///
/// A field that a Gaussian has blurred has the spectrum exp(-sigma^2 omega^2 / 2), so a difference need not be right
/// beyond it. Among the weights that are exact for parabolas, those are chosen that minimise the squared error of the
/// derivative of waves, weighted by the energy of the field's gradient, which for a sharp surface is exp(-sigma^2 omega^2)
/// (`experiments/matched_stencils`). Taylor's weights (FD8) would be exact for the longest waves only.
pub(super) struct Fit<const N: usize> {
    sigma: f64,
    first: i64,
}

impl<const N: usize> Fit<N> {
    pub(super) fn new(sigma: f64, first: i64) -> Self {
        Self { sigma, first }
    }

    pub(super) fn weights(&self, position: f64) -> Weights<N> {
        let offsets: [f64; N] = std::array::from_fn(|k| (self.first + k as i64) as f64 - position);
        let waves: Vec<(f64, f64)> = (0..FREQUENCIES)
            .map(|n| (n as f64 + 0.5) * PI / FREQUENCIES as f64)
            .map(|omega| (omega, (-(self.sigma * omega).powi(2)).exp() + NOISE))
            .collect();
        let mean = |f: &dyn Fn(f64) -> f64| {
            waves.iter().map(|&(omega, energy)| energy * f(omega)).sum::<f64>() / FREQUENCIES as f64
        };
        // Normal equations with the moments as constraints (Lagrange's multipliers), a right-hand side an order.
        let size = N + MOMENTS;
        let mut system = vec![vec![0.0; size + 3]; size];
        // The products depend on the distance of two voxels alone.
        let products: [f64; N] = std::array::from_fn(|distance| mean(&|w| libm::cos(w * distance as f64)));
        for k in 0..N {
            for l in 0..N {
                system[k][l] = products[k.abs_diff(l)];
            }
            for p in 0..MOMENTS {
                let moment = offsets[k].powi(p as i32);
                system[k][N + p] = moment;
                system[N + p][k] = moment;
            }
            system[k][size] = mean(&|w| libm::cos(w * offsets[k]));
            system[k][size + 1] = mean(&|w| w * libm::sin(w * offsets[k]));
            system[k][size + 2] = mean(&|w| -w * w * libm::cos(w * offsets[k]));
        }
        for (order, value) in [1.0, 1.0, 2.0].into_iter().enumerate() {
            system[N + order][size + order] = value;
        }
        let solutions = solved(system);
        std::array::from_fn(|order| std::array::from_fn(|k| solutions[k][order]))
    }
}

/// Solves linear equations by elimination with row exchange, the right-hand sides behind the matrix's columns; a row of solutions
/// an unknown.
///
/// Own code: a dozen unknowns, once an object, do not need the linear algebra crates that were looked at.
fn solved(mut system: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let size = system.len();
    for column in 0..size {
        let largest = |&a: &usize, &b: &usize| system[a][column].abs().total_cmp(&system[b][column].abs());
        let pivot = (column..size).max_by(largest).expect("rows are left");
        system.swap(column, pivot);
        let lead = system[column].clone();
        for (number, row) in system.iter_mut().enumerate() {
            let factor = row[column] / lead[column];
            if number != column && factor != 0.0 {
                row.iter_mut().zip(&lead).for_each(|(value, above)| *value -= factor * above);
            }
        }
    }
    let unknown = |(n, row): (usize, &Vec<f64>)| row[size..].iter().map(|value| value / row[n]).collect();
    system.iter().enumerate().map(unknown).collect()
}

/// Differences at voxels: the antisymmetric and the symmetric half, from the nearest voxel outward, in f32.
#[derive(Debug, Clone, Copy)]
pub(super) struct CentralWeights {
    pub(super) first: [f32; SIDE],
    /// The centre's weight is minus twice their sum, so that a constant has exactly no derivative.
    pub(super) second: [f32; SIDE],
}

impl CentralWeights {
    /// For a field of blur `sigma` on an axis of a spacing, both in the same unit; derivatives come out in that unit.
    pub(super) fn new(sigma: f64, spacing: f64) -> Self {
        let [_, first, second] = Fit::<NODES>::new(sigma / spacing, -(SIDE as i64)).weights(0.0);
        let outward = |weights: [f64; NODES], scale: f64| {
            std::array::from_fn(|n| (weights[SIDE + 1 + n] / scale) as f32)
        };
        Self { first: outward(first, spacing), second: outward(second, spacing * spacing) }
    }
}

/// Positions between two voxels at which weights are kept.
const STEPS: usize = 256;

/// Differences at any position of an axis.
#[derive(Debug)]
pub(super) struct PointWeights(Vec<Weights<NODES_BETWEEN>>);

impl PointWeights {
    /// As [`CentralWeights::new`].
    pub(super) fn new(sigma: f64, spacing: f64) -> Self {
        let fit = Fit::<NODES_BETWEEN>::new(sigma / spacing, -(SIDE as i64));
        let scaled = |step: usize| {
            let mut weights = fit.weights(step as f64 / STEPS as f64);
            if step % STEPS == 0 {
                // At a voxel, its own value without the fit's rounding.
                let voxel = SIDE + step / STEPS;
                weights[0] = std::array::from_fn(|k| f64::from(u8::from(k == voxel)));
            }
            let scale = [1.0, spacing, spacing * spacing];
            std::array::from_fn(|order| weights[order].map(|w| w / scale[order]))
        };
        Self((0..=STEPS).map(scaled).collect())
    }

    /// The first voxel that is needed for a fractional index, and the weights, interpolated between those that are kept.
    pub(super) fn at(&self, position: f64) -> (i64, Weights<NODES_BETWEEN>) {
        let voxel = position.floor();
        let step = (position - voxel) * STEPS as f64;
        let below = (step as usize).min(STEPS - 1);
        let share = step - below as f64;
        let (low, high) = (&self.0[below], &self.0[below + 1]);
        let mix = |order: usize, k: usize| low[order][k] + share * (high[order][k] - low[order][k]);
        (voxel as i64 - SIDE as i64, std::array::from_fn(|o| std::array::from_fn(|k| mix(o, k))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The field across a flat edge is an error function, whose derivatives are known.
    fn edge(sigma: f64, x: f64) -> [f64; 3] {
        let bell = (-x * x / (2.0 * sigma * sigma)).exp() / (sigma * (2.0 * PI).sqrt());
        [0.5 * libm::erf(x / (sigma * 2f64.sqrt())), bell, -x / (sigma * sigma) * bell]
    }

    /// Relative to the edge's largest slope (1/sigma) and bend (1/sigma^2), over the band; and better than Taylor's.
    #[test]
    fn derivatives_of_a_blurred_edge() {
        // At sigma 1.5 and 2 voxels, measured with the study's weights: 4.3e-4 and 4.6e-5 of the slope (rms).
        for (sigma, bound) in [(1.5, 1e-3), (2.0, 1.1e-4), (3.0, 5e-6), (5.0, 2e-6), (8.0, 4e-6)] {
            let central = Fit::<NODES>::new(sigma, -4).weights(0.0);
            let between = PointWeights::new(sigma, 1.0);
            for step in -25..=25 {
                let x = f64::from(step) * 0.05;
                let apply = |weights: &[f64], first: f64| {
                    let value = |(k, w): (usize, &f64)| w * edge(sigma, x + first + k as f64)[0];
                    weights.iter().enumerate().map(value).sum::<f64>()
                };
                let exact = edge(sigma, x);
                let share = 0.37;
                let (first, weights) = between.at(share);
                for order in 0..3 {
                    let scale = sigma.powi(order as i32) * (2.0 * PI).sqrt();
                    let on_grid = (apply(&central[order], -4.0) - exact[order]).abs() * scale;
                    let off_grid = (apply(&weights[order], first as f64 - share) - exact[order]).abs() * scale;
                    assert!(on_grid < bound, "sigma {sigma}, order {order}, x {x}: {on_grid:.1e}");
                    assert!(off_grid < bound, "sigma {sigma}, order {order}, x {x}: {off_grid:.1e} off grid");
                }
            }
        }
    }

    #[test]
    fn parabolas_are_exact_at_any_spacing() {
        let h = 0.4;
        let weights = CentralWeights::new(0.9, h);
        let f = |x: f64| 3.0 + 2.0 * x - 0.7 * x * x;
        let (mut slope, mut bend) = (0.0, 0.0);
        for n in 0..SIDE {
            let step = (n + 1) as f64 * h;
            slope += f64::from(weights.first[n]) * (f(1.0 + step) - f(1.0 - step));
            bend += f64::from(weights.second[n]) * (f(1.0 + step) + f(1.0 - step) - 2.0 * f(1.0));
        }
        assert!((slope - 0.6).abs() < 1e-5 && (bend + 1.4).abs() < 1e-5, "{slope} {bend}");
    }
}
