//! Weights of differences that are right where a blurred field has its spectrum.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Voxels on each side of a voxel that its differences need.
pub(crate) const SIDE: usize = 4;
/// Voxels of an axis that a difference at a voxel needs.
pub(super) const NODES: usize = 2 * SIDE + 1;
/// Voxels of an axis that a difference between two voxels needs.
pub(super) const NODES_BETWEEN: usize = 2 * SIDE + 2;

/// Weights of the value, the first and the second derivative, in units of 1/spacing^order.
pub(super) type Weights<const N: usize> = [[f64; N]; 3];

/// Share of the spectrum's peak, flat, that stands for the rounding of a field in f32: it keeps the weights
/// small where the blur leaves nothing to fit.
const NOISE: f64 = 1e-13;
/// Frequencies of the fit.
const FREQUENCIES: usize = 200;
/// Moments that are exact: of a constant, a ramp and a parabola.
const MOMENTS: usize = 3;

/// Weights of `N` neighbouring voxels, the first at `first`, for derivatives at a position between them; all
/// in voxels. `sigma` is the field's blur, in voxels too.
///
/// A field that a Gaussian has blurred has the spectrum exp(-sigma^2 omega^2 / 2), so a difference need not
/// be right beyond it. Among the weights that are exact for parabolas, those are chosen that minimise the
/// squared error of the derivative of waves, weighted by the energy of the field's gradient, which for a
/// sharp surface is exp(-sigma^2 omega^2) (`experiments/matched_stencils`). Taylor's weights (FD8) would be
/// exact for the longest waves only.
pub(super) struct Fit<const N: usize> {
    first: i64,
    waves: Vec<Wave<N>>,
    /// Mean products of waves at voxels that are as far apart as the place says.
    products: [f64; N],
}

/// A wave at the nodes: its frequency, its share in the field's energy, cosine and sine.
struct Wave<const N: usize> {
    omega: f64,
    energy: f64,
    cosines: [f64; N],
    sines: [f64; N],
}

impl<const N: usize> Fit<N> {
    pub(super) fn new(sigma: f64, first: i64) -> Self {
        let wave = |n: usize| {
            let omega = (n as f64 + 0.5) * PI / FREQUENCIES as f64;
            let energy = libm::exp(-(sigma * omega).powi(2)) + NOISE;
            let angle = |k: usize| (first + k as i64) as f64 * omega;
            Wave {
                omega,
                energy: energy / FREQUENCIES as f64,
                cosines: std::array::from_fn(|k| libm::cos(angle(k))),
                sines: std::array::from_fn(|k| libm::sin(angle(k))),
            }
        };
        let waves: Vec<Wave<N>> = (0..FREQUENCIES).map(wave).collect();
        let product = |distance: usize| {
            waves.iter().map(|w| w.energy * libm::cos(w.omega * distance as f64)).sum::<f64>()
        };
        let products = std::array::from_fn(product);
        Self { first, waves, products }
    }

    /// Normal equations with the moments as constraints (Lagrange's multipliers), a right-hand side an order.
    pub(super) fn weights(&self, position: f64) -> Weights<N> {
        let size = N + MOMENTS;
        let mut system = vec![vec![0.0; size + 3]; size];
        for k in 0..N {
            for l in 0..N {
                system[k][l] = self.products[k.abs_diff(l)];
            }
            let offset = (self.first + k as i64) as f64 - position;
            for p in 0..MOMENTS {
                let moment = offset.powi(p as i32);
                system[k][N + p] = moment;
                system[N + p][k] = moment;
            }
        }
        for wave in &self.waves {
            let (sin, cos) = libm::sincos(wave.omega * position);
            for (k, row) in system[..N].iter_mut().enumerate() {
                let cosine = wave.energy * (wave.cosines[k] * cos + wave.sines[k] * sin);
                let sine = wave.energy * (wave.sines[k] * cos - wave.cosines[k] * sin);
                row[size] += cosine;
                row[size + 1] += wave.omega * sine;
                row[size + 2] -= wave.omega * wave.omega * cosine;
            }
        }
        for (order, value) in [1.0, 1.0, 2.0].into_iter().enumerate() {
            system[N + order][size + order] = value;
        }
        let mut solutions = solved(system.clone());
        // The equations of a wide blur are nearly dependent: what the solution leaves of the right-hand sides
        // is solved for again, so that the moments, on which areas rest, come out exact.
        for equation in &mut system {
            for order in 0..3 {
                let found: f64 = (0..size).map(|n| equation[n] * solutions[n][order]).sum();
                equation[size + order] -= found;
            }
        }
        for (solution, rest) in solutions.iter_mut().zip(solved(system)) {
            solution.iter_mut().zip(rest).for_each(|(value, rest)| *value += rest);
        }
        std::array::from_fn(|order| std::array::from_fn(|k| solutions[k][order]))
    }
}

/// Solves linear equations with the right-hand sides behind the matrix's columns, by elimination with row
/// exchange and substitution; a row of solutions an unknown.
///
/// Own code: a dozen unknowns once an object, or some hundred once an image of interfaces, do not need the linear algebra crates
/// that were looked at.
pub(crate) fn solved(mut system: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let size = system.len();
    for column in 0..size {
        let largest = |&a: &usize, &b: &usize| system[a][column].abs().total_cmp(&system[b][column].abs());
        let pivot = (column..size).max_by(largest).expect("rows are left");
        system.swap(column, pivot);
        let (above, below) = system.split_at_mut(column + 1);
        let lead = &above[column];
        for row in below {
            let factor = row[column] / lead[column];
            row.iter_mut().zip(lead).skip(column).for_each(|(value, above)| *value -= factor * above);
        }
    }
    let mut solutions = vec![vec![]; size];
    for n in (0..size).rev() {
        let row = &system[n];
        let unknown = |order: usize| {
            let known: f64 = (n + 1..size).map(|m| row[m] * solutions[m][order]).sum();
            (row[size + order] - known) / row[n]
        };
        solutions[n] = (0..row.len() - size).map(unknown).collect::<Vec<f64>>();
    }
    solutions
}

/// Weights along the three axes of a grid, for a blur of sigma, mm: at voxels, and between them once they are asked for.
#[derive(Debug)]
pub(crate) struct MatchedWeights {
    sigma: f64,
    spacing: [f64; 3],
    central: [CentralWeights; 3],
    between: OnceLock<[PointWeights; 3]>,
}

impl MatchedWeights {
    pub(crate) fn new(sigma: f64, spacing: [f64; 3]) -> Self {
        let central = by_axis(spacing, |h| CentralWeights::new(sigma, h));
        Self { sigma, spacing, central, between: OnceLock::new() }
    }

    pub(crate) fn central(&self) -> &[CentralWeights; 3] {
        &self.central
    }

    pub(super) fn between(&self) -> &[PointWeights; 3] {
        self.between.get_or_init(|| by_axis(self.spacing, |h| PointWeights::new(self.sigma, h)))
    }
}

/// What depends on the spacing of an axis, made once where they are equal.
fn by_axis<T: Clone>([x, y, z]: [f64; 3], make: impl Fn(f64) -> T) -> [T; 3] {
    let along_x = make(x);
    let along_y = if y == x { along_x.clone() } else { make(y) };
    let along_z = if z == y { along_y.clone() } else { make(z) };
    [along_x, along_y, along_z]
}

/// Differences at voxels: the antisymmetric and the symmetric half, from the nearest voxel outward, in f32.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CentralWeights {
    pub(crate) first: [f32; SIDE],
    /// The centre's weight is minus twice their sum, so that a constant has exactly no derivative.
    pub(crate) second: [f32; SIDE],
}

impl CentralWeights {
    /// For a field of blur `sigma` on an axis of a spacing, both in the same unit; derivatives come out in
    /// that unit.
    pub(super) fn new(sigma: f64, spacing: f64) -> Self {
        let [_, first, second] = Fit::<NODES>::new(sigma / spacing, -(SIDE as i64)).weights(0.0);
        let outward = |weights: [f64; NODES], scale: f64| {
            std::array::from_fn(|n| (weights[SIDE + 1 + n] / scale) as f32)
        };
        Self { first: outward(first, spacing), second: outward(second, spacing * spacing) }
    }
}

/// Positions between two voxels at which weights are kept.
const STEPS: usize = 128;

/// Differences at any position of an axis.
#[derive(Debug, Clone)]
pub(super) struct PointWeights(Vec<Weights<NODES_BETWEEN>>);

impl PointWeights {
    /// As [`CentralWeights::new`].
    pub(super) fn new(sigma: f64, spacing: f64) -> Self {
        let fit = Fit::<NODES_BETWEEN>::new(sigma / spacing, -(SIDE as i64));
        // At a voxel the weights are those of its band: symmetric, without the farthest node, the value being
        // the voxel's own.
        let central = Fit::<NODES>::new(sigma / spacing, -(SIDE as i64)).weights(0.0);
        let at_voxel = |number: usize| {
            let weight = |order: usize, k: usize| match (order, k.checked_sub(number)) {
                (_, None | Some(NODES)) | (1, Some(SIDE)) => 0.0,
                (0, Some(node)) => f64::from(u8::from(node == SIDE)),
                (order, Some(node)) => central[order][node],
            };
            std::array::from_fn(|order| std::array::from_fn(|k| weight(order, k)))
        };
        let scaled = |step: usize| {
            let weights: Weights<NODES_BETWEEN> = match step {
                0 => at_voxel(0),
                STEPS => at_voxel(1),
                _ => fit.weights(step as f64 / STEPS as f64),
            };
            let scale = [1.0, spacing, spacing * spacing];
            std::array::from_fn(|order| weights[order].map(|w| w / scale[order]))
        };
        Self((0..=STEPS).map(scaled).collect())
    }

    /// The first voxel that is needed for a fractional index, and the weights, by the parabola through three
    /// that are kept.
    #[inline(always)]
    pub(super) fn at(&self, position: f64) -> (i64, Weights<NODES_BETWEEN>) {
        let voxel = position.floor();
        let first = voxel as i64 - SIDE as i64;
        let step = (position - voxel) * STEPS as f64;
        if step == 0.0 {
            return (first, self.0[0]);
        }
        let middle = ((step + 0.5) as usize).clamp(1, STEPS - 1);
        let x = step - middle as f64;
        let (low, high) = (0.5 * x * (x - 1.0), 0.5 * x * (x + 1.0));
        let [before, kept, behind] = [&self.0[middle - 1], &self.0[middle], &self.0[middle + 1]];
        let mut weights = [[0.0; NODES_BETWEEN]; 3];
        for order in 0..3 {
            for k in 0..NODES_BETWEEN {
                weights[order][k] =
                    low * before[order][k] + (1.0 - x * x) * kept[order][k] + high * behind[order][k];
            }
        }
        (first, weights)
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

    /// Relative to the edge's largest slope (1/sigma) and bend (1/sigma^2), over the band; and better than
    /// Taylor's.
    #[test]
    fn derivatives_of_a_blurred_edge() {
        // At sigma 1.5 and 2 voxels, measured with the study's weights: 4.3e-4 and 4.6e-5 of the slope (rms).
        // From 5 on little is left to fit, and what is left of the equations' conditioning is seen.
        for (sigma, bound) in [(1.5, 1e-3), (2.0, 1.1e-4), (3.0, 5e-6), (5.0, 1e-5), (8.0, 1e-5)] {
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
                    let off_grid =
                        (apply(&weights[order], first as f64 - share) - exact[order]).abs() * scale;
                    assert!(on_grid < bound, "sigma {sigma}, order {order}, x {x}: {on_grid:.1e}");
                    // Between the positions that are kept, weights are interpolated.
                    assert!(
                        off_grid < bound + 2e-6,
                        "sigma {sigma}, order {order}, x {x}: {off_grid:.1e} off grid"
                    );
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
