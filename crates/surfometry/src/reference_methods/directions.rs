//! Directions of a lattice and their shares of the sphere.

use crate::space::half_sphere;

/// Points of a sphere that shares are counted on.
const POINTS: usize = 100_000;

/// Shares of the sphere, by which of the lines along unit vectors is nearest: they add up to 1. To about
/// 1e-4.
pub(super) fn shares(directions: &[[f64; 3]]) -> Vec<f64> {
    let mut counts = vec![0.0; directions.len()];
    for point in half_sphere(POINTS) {
        let along = |d: &[f64; 3]| (0..3).map(|a| d[a] * point[a]).sum::<f64>().abs();
        let nearest = (0..directions.len())
            .max_by(|&a, &b| along(&directions[a]).total_cmp(&along(&directions[b])))
            .unwrap_or_default();
        counts[nearest] += 1.0 / POINTS as f64;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::HALF_OF_NEIGHBOURS;
    use crate::space::unit;

    /// Of the cubic lattice: Ohser and Mücklich (2000), 0.0458, 0.0370 and 0.0352 of each of 26 directions.
    #[test]
    fn of_the_cubic_lattice() {
        let directions = HALF_OF_NEIGHBOURS.map(|step| unit(step.map(|c| c as f64)));
        let found = shares(&directions);
        for (n, share) in found.iter().enumerate() {
            let expected = [0.045_778, 0.036_981, 0.035_196][usize::from(n >= 3) + usize::from(n >= 9)];
            assert!((share / (2.0 * expected) - 1.0).abs() < 5e-3, "{n}: {share}");
        }
    }
}
