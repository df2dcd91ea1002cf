//! Where the viewer stands, anywhere.

use super::view::{Basis, View};
use crate::Choice;
use crate::space::cross;

/// Where the viewer stands: at a named side, or anywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Viewpoint {
    /// A named side.
    Named(View),
    /// By angles.
    Turned(CameraAngles),
}

/// Where the viewer stands, by angles in degrees: all 0 is in front of the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraAngles {
    /// Around the object toward its left: 90 is at its left, 180 behind.
    pub azimuth: f64,
    /// Above it: 90 looks down.
    pub elevation: f64,
    /// By how much the picture is turned clockwise.
    pub roll: f64,
}

impl From<View> for Viewpoint {
    fn from(view: View) -> Self {
        Self::Named(view)
    }
}

impl Viewpoint {
    /// The picture's axes.
    pub fn basis(self) -> Basis {
        match self {
            Self::Named(view) => view.basis(),
            Self::Turned(angles) => angles.basis(),
        }
    }

    /// Its name above a panel.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Named(view) => {
                let word = view.word();
                word[..1].to_uppercase() + &word[1..]
            }
            Self::Turned(CameraAngles { azimuth, elevation, roll }) => {
                let turned = if roll == 0.0 { String::new() } else { format!(", roll {roll}°") };
                format!("Azimuth {azimuth}°, elevation {elevation}°{turned}")
            }
        }
    }
}

impl CameraAngles {
    fn basis(self) -> Basis {
        let [(sin, cos), (above, along), (turn, upright)] =
            [self.azimuth, self.elevation, self.roll].map(|degrees| libm::sincos(degrees.to_radians()));
        let toward = [-sin * along, cos * along, above];
        let up = [sin * above, -cos * above, along];
        let right = cross(up, toward);
        let mixed = |a: f64, b: f64| std::array::from_fn(|i| a * right[i] + b * up[i]);
        Basis { right: mixed(upright, turn), up: mixed(-turn, upright), toward }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{dot, minus};

    fn angles(azimuth: f64, elevation: f64, roll: f64) -> Basis {
        Viewpoint::Turned(CameraAngles { azimuth, elevation, roll }).basis()
    }

    #[test]
    fn right_angles_are_the_named_sides() {
        let sides = [
            ([0.0, 0.0, 0.0], View::Anterior),
            ([90.0, 0.0, 0.0], View::Left),
            ([180.0, 0.0, 0.0], View::Posterior),
            ([-90.0, 0.0, 0.0], View::Right),
            ([180.0, 90.0, 0.0], View::Superior),
            ([0.0, -90.0, 0.0], View::Inferior),
        ];
        for ([azimuth, elevation, roll], view) in sides {
            let (found, named) = (angles(azimuth, elevation, roll), view.basis());
            for (a, b) in [(found.right, named.right), (found.up, named.up), (found.toward, named.toward)] {
                assert!(dot(minus(a, b), minus(a, b)) < 1e-24, "{view} {found:?}");
            }
        }
    }

    #[test]
    fn roll_turns_the_picture_clockwise() {
        // What points up in the picture points to its right after a quarter turn.
        let (plain, rolled) = (angles(30.0, 20.0, 0.0), angles(30.0, 20.0, 90.0));
        let [x, y, z] = rolled.coordinates(plain.up);
        assert!((x - 1.0).abs() < 1e-12 && y.abs() < 1e-12 && z.abs() < 1e-12);
        assert!((dot(cross(rolled.right, rolled.up), rolled.toward) - 1.0).abs() < 1e-12);
    }
}
