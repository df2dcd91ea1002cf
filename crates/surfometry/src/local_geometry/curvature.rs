//! Curvature of a level set from the field's derivatives.

use super::Jet;

/// Mean and Gaussian curvature of the level set through a point.
///
/// With phi negative inside, a sphere of radius R has H = +1/R and K = 1/R^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// H = (k1 + k2) / 2, 1/mm.
    pub mean_curvature: f64,
    /// K = k1 k2, 1/mm^2.
    pub gaussian_curvature: f64,
}

impl Curvature {
    /// H and K, or `None` where the gradient vanishes (or is too small for its square to be a number): there
    /// the level set has no normal. Where it is small but not 0, as half-way through a plate, they are
    /// numbers without meaning; the integrals leave those voxels out (`integrals::Band`).
    ///
    /// # References
    /// Besler et al., appendix, with two corrections: H is half of what is printed, and the last term of K is
    /// 2 phi_x **phi_z** (phi_xy phi_yz - phi_xz phi_yy). The printed phi_x phi_y is invisible on
    /// axis-aligned shapes.
    pub fn of(jet: &Jet) -> Option<Self> {
        let curvature = Self::formula(jet);
        curvature.is_finite().then_some(curvature)
    }

    #[inline(always)]
    pub(crate) fn is_finite(&self) -> bool {
        self.mean_curvature.is_finite() & self.gaussian_curvature.is_finite()
    }

    /// H and K by their formula, whatever comes out where there is no normal.
    #[inline(always)]
    pub(crate) fn formula(jet: &Jet) -> Self {
        let [x, y, z] = jet.gradient;
        let [xx, yy, zz, xy, xz, yz] = jet.hessian;
        let (x2, y2, z2) = (x * x, y * y, z * z);
        let square = x2 + y2 + z2;
        let h =
            x2 * (yy + zz) + y2 * (xx + zz) + z2 * (xx + yy) - 2.0 * (x * y * xy + x * z * xz + y * z * yz);
        let k = x2 * (yy * zz - yz * yz)
            + y2 * (xx * zz - xz * xz)
            + z2 * (xx * yy - xy * xy)
            + 2.0 * x * y * (xz * yz - xy * zz)
            + 2.0 * y * z * (xy * xz - yz * xx)
            + 2.0 * x * z * (xy * yz - xz * yy);
        // One division and one root are what these cost.
        let inverse = 1.0 / square;
        Self {
            mean_curvature: 0.5 * h * inverse * inverse * square.sqrt(),
            gaussian_curvature: k * inverse * inverse,
        }
    }

    /// The larger of |k1| and |k2|, |H| + sqrt(H^2 - K), 1/mm.
    #[inline(always)]
    pub fn larger(&self) -> f64 {
        self.mean_curvature.abs() + self.half_difference()
    }

    /// (k1 - k2) / 2. H^2 - K, which rounding can make negative at umbilics, is clamped at 0.
    #[inline(always)]
    fn half_difference(&self) -> f64 {
        (self.mean_curvature * self.mean_curvature - self.gaussian_curvature).max(0.0).sqrt()
    }

    /// k1 >= k2, 1/mm.
    pub fn principal(&self) -> [f64; 2] {
        let root = self.half_difference();
        [self.mean_curvature + root, self.mean_curvature - root]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The determinant form of K (Besler et al., eq. for K), expanded by minors: another route to the same
    /// number.
    fn bordered_determinant_k(jet: &Jet) -> f64 {
        let [x, y, z] = jet.gradient;
        let [xx, yy, zz, xy, xz, yz] = jet.hessian;
        let m = [[xx, xy, xz, x], [xy, yy, yz, y], [xz, yz, zz, z], [x, y, z, 0.0]];
        -determinant(&m.map(|row| row.to_vec())) / jet.gradient_magnitude().powi(4)
    }

    fn determinant(m: &[Vec<f64>]) -> f64 {
        if m.len() == 1 {
            return m[0][0];
        }
        let minor = |skip: usize| -> Vec<Vec<f64>> {
            m[1..]
                .iter()
                .map(|r| r.iter().enumerate().filter(|(i, _)| *i != skip).map(|(_, v)| *v).collect())
                .collect()
        };
        (0..m.len()).map(|i| m[0][i] * determinant(&minor(i)) * if i % 2 == 0 { 1.0 } else { -1.0 }).sum()
    }

    /// Divergence of the unit normal: H = (trace(Hess) - n.Hess.n) / (2 |grad|).
    fn divergence_h(jet: &Jet) -> f64 {
        let g = jet.gradient_magnitude();
        let n = jet.gradient.map(|v| v / g);
        let [xx, yy, zz, xy, xz, yz] = jet.hessian;
        let along = n[0] * n[0] * xx
            + n[1] * n[1] * yy
            + n[2] * n[2] * zz
            + 2.0 * (n[0] * n[1] * xy + n[0] * n[2] * xz + n[1] * n[2] * yz);
        (xx + yy + zz - along) / (2.0 * g)
    }

    proptest! {
        #[test]
        fn agrees_with_the_determinant_and_the_divergence(
            gradient in prop::array::uniform3(-1.0..1.0f64), hessian in prop::array::uniform6(-1.0..1.0f64)
        ) {
            let jet = Jet { value: 0.0, gradient, hessian };
            prop_assume!(jet.gradient_magnitude() > 0.1);
            let curvature = Curvature::of(&jet).unwrap();
            prop_assert!((curvature.gaussian_curvature - bordered_determinant_k(&jet)).abs() < 1e-9 * (1.0 + curvature.gaussian_curvature.abs()));
            prop_assert!((curvature.mean_curvature - divergence_h(&jet)).abs() < 1e-11 * (1.0 + curvature.mean_curvature.abs()));
            let [k1, k2] = curvature.principal();
            prop_assert!(k1 >= k2);
        }
    }

    #[test]
    fn no_normal_no_curvature() {
        assert_eq!(Curvature::of(&Jet::default()), None);
        let tiny = Jet { value: 0.0, gradient: [1e-170, 0.0, 0.0], hessian: [1.0; 6] };
        assert_eq!(Curvature::of(&tiny), None);
    }
}
