//! Voxel spacing.

use super::VolumeError;

/// Distance between voxel centres along the three image axes, in mm; x, the fastest axis in memory, first.
///
/// The constructor is the only check: code that holds a `Spacing` may divide by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing([f64; 3]);

impl Spacing {
    /// Takes three spacings in mm.
    ///
    /// # Errors
    /// [`VolumeError::InvalidSpacing`] where one is not positive and finite.
    pub fn new(mm: [f64; 3]) -> Result<Self, VolumeError> {
        match mm.iter().position(|h| !(h.is_finite() && *h > 0.0)) {
            Some(axis) => Err(VolumeError::InvalidSpacing { axis, value: mm[axis] }),
            None => Ok(Self(mm)),
        }
    }

    /// The three spacings in mm.
    pub fn mm(&self) -> [f64; 3] {
        self.0
    }

    /// Volume of a voxel in mm^3.
    pub fn cell_volume(&self) -> f64 {
        self.0[0] * self.0[1] * self.0[2]
    }

    /// The largest of the three, in mm.
    pub fn largest(&self) -> f64 {
        self.0[0].max(self.0[1]).max(self.0[2])
    }

    /// The smallest of the three, in mm.
    pub fn smallest(&self) -> f64 {
        self.0[0].min(self.0[1]).min(self.0[2])
    }

    /// Edge of the cube that has a voxel's volume, in mm.
    pub fn geometric_mean(&self) -> f64 {
        libm::cbrt(self.cell_volume())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_cannot_be_a_length() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Spacing::new([1.0, bad, 1.0]),
                Err(VolumeError::InvalidSpacing { axis: 1, .. })
            ));
        }
    }

    #[test]
    fn geometric_mean_keeps_the_volume() {
        let spacing = Spacing::new([0.5, 1.0, 4.0]).unwrap();
        assert!((spacing.geometric_mean().powi(3) - 2.0).abs() < 1e-12);
        assert_eq!((spacing.smallest(), spacing.largest()), (0.5, 4.0));
    }
}
