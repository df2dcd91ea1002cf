//! What a voxel adds to the integrals, and how that changes with the field's jet there.

use crate::integrals::Band;
use crate::local_geometry::Jet;

/// The integrals over phi = 0 that have a derivative here; or a weight for each, in the inverse units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IntegralValues {
    /// V, the integral of theta(-phi), mm^3.
    pub volume: f64,
    /// A, mm^2.
    pub surface_area: f64,
    /// Integral of H, mm.
    pub total_mean_curvature: f64,
    /// Integral of K, 2 pi chi.
    pub total_gaussian_curvature: f64,
    /// Integral of H^2, the bending energy.
    pub total_squared_mean_curvature: f64,
}

impl IntegralValues {
    /// Names in records and arrays, in the order of [`IntegralValues::to_array`], without units.
    pub const NAMES: [&'static str; 5] = [
        "volume",
        "surface_area",
        "total_mean_curvature",
        "total_gaussian_curvature",
        "total_squared_mean_curvature",
    ];

    /// The five numbers.
    pub fn to_array(self) -> [f64; 5] {
        [
            self.volume,
            self.surface_area,
            self.total_mean_curvature,
            self.total_gaussian_curvature,
            self.total_squared_mean_curvature,
        ]
    }

    /// Of the five numbers in their order.
    pub fn from_array(
        [volume, surface_area, total_mean_curvature, total_gaussian_curvature, total_squared_mean_curvature]: [f64; 5],
    ) -> Self {
        Self {
            volume,
            surface_area,
            total_mean_curvature,
            total_gaussian_curvature,
            total_squared_mean_curvature,
        }
    }

    /// What a voxel of the band adds, for each unit of volume.
    pub(super) fn of_voxel(jet: &Jet, band: &Band) -> Self {
        let volume = band.delta().heaviside(-jet.value);
        let Some((area, curvature)) = band.element(jet) else { return Self { volume, ..Self::default() } };
        let h = curvature.mean_curvature;
        Self {
            volume,
            surface_area: area,
            total_mean_curvature: area * h,
            total_gaussian_curvature: area * curvature.gaussian_curvature,
            total_squared_mean_curvature: area * h * h,
        }
    }

    /// Adds another's numbers times a factor.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        let (own, other) = (self.to_array(), other.to_array());
        *self = Self::from_array(std::array::from_fn(|n| own[n] + factor * other[n]));
    }
}

/// Derivatives, with respect to the jet's ten numbers, of the weighted sum of what a voxel of the band adds
/// ([`IntegralValues::of_voxel`]).
///
/// The weighted sum is delta(phi) F + w_V theta(-phi), where, with h and k the numerators of H = h / (2
/// |grad phi|^3) and K = k / |grad phi|^4, F = |grad phi| (w_A + w_M H + w_K K + w_B H^2).
pub(super) fn adjoint_jet(jet: &Jet, band: &Band, weights: &IntegralValues) -> Jet {
    let delta = band.delta().delta(jet.value);
    let outside = Jet { value: -weights.volume * delta, ..Jet::default() };
    let Some(curvature) = band.curvature(jet) else { return outside };
    let (mean, gaussian) = (curvature.mean_curvature, curvature.gaussian_curvature);
    let slope = jet.gradient_magnitude();
    let square = slope * slope;
    let along_normal = weights.surface_area
        + mean * (weights.total_mean_curvature + weights.total_squared_mean_curvature * mean)
        + weights.total_gaussian_curvature * gaussian;
    // Partial derivatives of F with respect to h, k and |grad phi|^2.
    let by_h = (0.5 * weights.total_mean_curvature + weights.total_squared_mean_curvature * mean) / square;
    let by_k = weights.total_gaussian_curvature / (square * slope);
    let by_square = (0.5 * weights.surface_area
        - mean * (weights.total_mean_curvature + 2.5 * weights.total_squared_mean_curvature * mean)
        - 1.5 * weights.total_gaussian_curvature * gaussian)
        / slope;
    let (h, k) = (mean_numerator(jet), gaussian_numerator(jet));
    Jet {
        value: outside.value + band.delta().slope(jet.value) * slope * along_normal,
        gradient: std::array::from_fn(|a| {
            delta * (by_h * h.gradient[a] + by_k * k.gradient[a] + 2.0 * by_square * jet.gradient[a])
        }),
        hessian: std::array::from_fn(|n| delta * (by_h * h.hessian[n] + by_k * k.hessian[n])),
    }
}

/// Derivatives of h = |g|^2 tr(Hess) - g . Hess g.
fn mean_numerator(jet: &Jet) -> Jet {
    let [x, y, z] = jet.gradient;
    let [xx, yy, zz, xy, xz, yz] = jet.hessian;
    Jet {
        value: 0.0,
        gradient: [
            2.0 * (x * (yy + zz) - y * xy - z * xz),
            2.0 * (y * (xx + zz) - x * xy - z * yz),
            2.0 * (z * (xx + yy) - x * xz - y * yz),
        ],
        hessian: [y * y + z * z, x * x + z * z, x * x + y * y, -2.0 * x * y, -2.0 * x * z, -2.0 * y * z],
    }
}

/// Derivatives of k = g . adj(Hess) g.
fn gaussian_numerator(jet: &Jet) -> Jet {
    let [x, y, z] = jet.gradient;
    let [xx, yy, zz, xy, xz, yz] = jet.hessian;
    let adjugate = [
        yy * zz - yz * yz,
        xx * zz - xz * xz,
        xx * yy - xy * xy,
        xz * yz - xy * zz,
        xy * yz - xz * yy,
        xy * xz - yz * xx,
    ];
    Jet {
        value: 0.0,
        gradient: [
            2.0 * (adjugate[0] * x + adjugate[3] * y + adjugate[4] * z),
            2.0 * (adjugate[3] * x + adjugate[1] * y + adjugate[5] * z),
            2.0 * (adjugate[4] * x + adjugate[5] * y + adjugate[2] * z),
        ],
        hessian: [
            y * y * zz + z * z * yy - 2.0 * y * z * yz,
            x * x * zz + z * z * xx - 2.0 * x * z * xz,
            x * x * yy + y * y * xx - 2.0 * x * y * xy,
            2.0 * (y * z * xz + x * z * yz - x * y * zz - z * z * xy),
            2.0 * (x * y * yz + y * z * xy - x * z * yy - y * y * xz),
            2.0 * (x * y * xz + x * z * xy - y * z * xx - x * x * yz),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrals::{SmearedDelta, Smearing};
    use proptest::prelude::*;

    fn numbers(jet: &Jet) -> [f64; 10] {
        let mut all = [jet.value; 10];
        all[1..4].copy_from_slice(&jet.gradient);
        all[4..].copy_from_slice(&jet.hessian);
        all
    }

    fn jet(numbers: [f64; 10]) -> Jet {
        Jet {
            value: numbers[0],
            gradient: std::array::from_fn(|a| numbers[1 + a]),
            hessian: std::array::from_fn(|n| numbers[4 + n]),
        }
    }

    proptest! {
        /// Central differences of each integral by each number of the jet, with both deltas.
        #[test]
        fn is_the_derivative_of_what_a_voxel_adds(
            value in -0.35..0.35f64, gradient in prop::array::uniform3(-1.0..1.0f64), hessian in prop::array::uniform6(-1.0..1.0f64)
        ) {
            let mut at = [value; 10];
            at[1..4].copy_from_slice(&gradient);
            at[4..].copy_from_slice(&hessian);
            prop_assume!(jet(at).gradient_magnitude() > 0.2);
            for smearing in [Smearing::Sine, Smearing::Tanh] {
                let band = Band::new(SmearedDelta::new(smearing, 0.4, 1.0), 2.5);
                for integral in 0..5 {
                    let mut weights = [0.0; 5];
                    weights[integral] = 1.0;
                    let found = numbers(&adjoint_jet(&jet(at), &band, &IntegralValues::from_array(weights)));
                    let scale = found.iter().fold(1.0, |most: f64, v| most.max(v.abs()));
                    for n in 0..10 {
                        let moved = |step: f64| {
                            let mut moved = at;
                            moved[n] += step;
                            IntegralValues::of_voxel(&jet(moved), &band).to_array()[integral]
                        };
                        let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                        prop_assert!((found[n] - difference).abs() < 1e-6 * scale, "{} by {}: {} {}", integral, n, found[n], difference);
                    }
                }
            }
        }
    }
}
