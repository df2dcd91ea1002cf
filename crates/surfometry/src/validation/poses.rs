//! Poses that cover rotations, shifts and sizes evenly, the same ones every time.

use serde::Serialize;

/// A pose in units that suit any grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct UnitPose {
    /// About x, then y, then z.
    pub degrees: [f64; 3],
    /// In voxels, -1/2 to 1/2.
    pub shift: [f64; 3],
    /// Between 0.9 and 1.1.
    pub size: f64,
}

/// Numbers that a pose takes.
const DIMENSIONS: i32 = 7;

/// The n-th pose of an additive recurrence with powers of the root of x^8 = x + 1, which fills the unit cube
/// of seven dimensions evenly (Roberts 2018). The rotations it stands for are uniform: those about x and z by
/// angle, that about y by the sine of it.
pub(super) fn pose(number: usize) -> UnitPose {
    let root = (0..60).fold(1.5, |x: f64, _| libm::pow(1.0 + x, 1.0 / f64::from(DIMENSIONS + 1)));
    let place = |n: i32| {
        let place = 0.5 + (number + 1) as f64 * root.powi(-n - 1);
        place - place.floor()
    };
    UnitPose {
        degrees: [360.0 * place(0), libm::asin(2.0 * place(1) - 1.0).to_degrees(), 360.0 * place(2)],
        shift: [place(3) - 0.5, place(4) - 0.5, place(5) - 0.5],
        size: 0.9 + 0.2 * place(6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means and variances of uniform numbers.
    #[test]
    fn places_are_uniform() {
        let poses: Vec<UnitPose> = (0..1000).map(pose).collect();
        let numbers = |p: &UnitPose| {
            let [x, y, z] = p.degrees;
            let [a, b, c] = p.shift;
            [x / 360.0 - 0.5, 0.5 * libm::sin(y.to_radians()), z / 360.0 - 0.5, a, b, c, 5.0 * (p.size - 1.0)]
        };
        for n in 0..DIMENSIONS as usize {
            let mean = poses.iter().map(|p| numbers(p)[n]).sum::<f64>() / 1000.0;
            let square = poses.iter().map(|p| numbers(p)[n].powi(2)).sum::<f64>() / 1000.0;
            assert!(mean.abs() < 0.005 && (12.0 * square - 1.0).abs() < 0.02, "{n}: {mean} {square}");
        }
    }
}
