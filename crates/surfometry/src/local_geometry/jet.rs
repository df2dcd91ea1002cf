//! A field's value and derivatives at a point.

use crate::volume::Shear;

/// Value, gradient and Hessian of a field at one point (its 2-jet), in mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet {
    /// phi.
    pub value: f64,
    /// phi_x, phi_y, phi_z, 1/mm.
    pub gradient: [f64; 3],
    /// phi_xx, phi_yy, phi_zz, phi_xy, phi_xz, phi_yz, 1/mm^2.
    pub hessian: [f64; 6],
}

impl Jet {
    /// The same along perpendicular axes, of derivatives along axes that are not.
    pub(super) fn unsheared(&self, shear: &Shear) -> Self {
        Self {
            value: self.value,
            gradient: shear.gradient(self.gradient),
            hessian: shear.hessian(self.hessian),
        }
    }

    /// |grad phi|, 1/mm.
    #[inline(always)]
    pub fn gradient_magnitude(&self) -> f64 {
        let [x, y, z] = self.gradient;
        (x * x + y * y + z * z).sqrt()
    }
}
