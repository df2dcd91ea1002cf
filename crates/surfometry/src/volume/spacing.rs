//! Voxel spacing.

use super::VolumeError;

/// Lengths in mm that are told from nonsense: a picometre to a thousand kilometres.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
/// Largest spacing in units of the smallest, beyond which no blur is round in space and small in voxels.
const LARGEST_RATIO: f64 = 1e4;

/// Distance between voxel centres along the three image axes, in mm; x, the fastest axis in memory, first.
///
/// The constructor is the only check: code that holds a `Spacing` may divide by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing([f64; 3]);

impl Spacing {
    /// Takes three spacings in mm.
    ///
    /// # Errors
    /// [`VolumeError::InvalidSpacing`] where one is not positive and finite, [`VolumeError::UnlikelySpacing`]
    /// where one is below 1e-9 or above 1e9 mm, and [`VolumeError::UnequalSpacing`] where one is more than
    /// 10,000 times another.
    pub fn new(mm: [f64; 3]) -> Result<Self, VolumeError> {
        if let Some(axis) = mm.iter().position(|h| !(h.is_finite() && *h > 0.0)) {
            return Err(VolumeError::InvalidSpacing { axis, value: mm[axis] });
        }
        if let Some(axis) = mm.iter().position(|h| !LENGTHS.contains(h)) {
            return Err(VolumeError::UnlikelySpacing { axis, value: mm[axis] });
        }
        let spacing = Self(mm);
        if spacing.largest() > LARGEST_RATIO * spacing.smallest() {
            return Err(VolumeError::UnequalSpacing { spacing: mm });
        }
        Ok(spacing)
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
    fn refuses_what_no_voxel_is() {
        for bad in [3e38, 1e-10, 1e10] {
            assert!(matches!(
                Spacing::new([1.0, 1.0, bad]),
                Err(VolumeError::UnlikelySpacing { axis: 2, .. })
            ));
        }
        for bad in [[1e6, 1.0, 1.0], [1.0, 1.0, 9e-5]] {
            assert!(matches!(Spacing::new(bad), Err(VolumeError::UnequalSpacing { .. })));
        }
        // Electron microscopes, thin sections of slides, and what was written in other units.
        for good in [[4e-6, 4e-6, 4e-5], [2.5e-4, 2.5e-4, 2.0], [4000.0, 4000.0, 40_000.0]] {
            assert!(Spacing::new(good).is_ok());
        }
    }

    #[test]
    fn geometric_mean_keeps_the_volume() {
        let spacing = Spacing::new([0.5, 1.0, 4.0]).unwrap();
        assert!((spacing.geometric_mean().powi(3) - 2.0).abs() < 1e-12);
        assert_eq!((spacing.smallest(), spacing.largest()), (0.5, 4.0));
    }
}
