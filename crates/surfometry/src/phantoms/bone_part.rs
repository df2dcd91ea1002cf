//! What bones are made of: implicit functions that are polynomials or roots of such, so analytic everywhere.

use super::jet_arithmetic::Smooth;

/// A part in its place. Its function is about the distance in mm near the surface, along its shortest axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    form: Form,
    centre: [f64; 3],
    /// Cosine and sine of a turn about y.
    turn: [f64; 2],
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    /// Half-axes.
    Ellipsoid([f64; 3]),
    /// Half-axes of an elliptic disc with rounded rims, its height along z: a superellipsoid of exponent 6
    /// there.
    Drum([f64; 3]),
    /// About z: radius of the circle, of the tube, and how many times as high as wide that is.
    Ring([f64; 3]),
}

/// Keeps roots away from 0.
const CORE: f64 = 0.01;

impl Part {
    pub(super) fn ellipsoid(centre: [f64; 3], radii: [f64; 3]) -> Self {
        Self { form: Form::Ellipsoid(radii), centre, turn: [1.0, 0.0] }
    }

    pub(super) fn drum(centre: [f64; 3], radii: [f64; 3]) -> Self {
        Self { form: Form::Drum(radii), centre, turn: [1.0, 0.0] }
    }

    pub(super) fn ring(centre: [f64; 3], major: f64, minor: f64) -> Self {
        Self { form: Form::Ring([major, minor, 1.0]), centre, turn: [1.0, 0.0] }
    }

    /// Of a ring: a tube that is higher than wide.
    pub(super) fn stretched(self, factor: f64) -> Self {
        match self.form {
            Form::Ring([major, minor, _]) => Self { form: Form::Ring([major, minor, factor]), ..self },
            _ => self,
        }
    }

    pub(super) fn turned_about_y(self, degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { turn: [cos, sin], ..self }
    }

    pub(super) fn scaled(self, size: f64) -> Self {
        let form = match self.form {
            Form::Ellipsoid(radii) => Form::Ellipsoid(radii.map(|r| r * size)),
            Form::Drum(radii) => Form::Drum(radii.map(|r| r * size)),
            Form::Ring([major, minor, stretch]) => Form::Ring([major * size, minor * size, stretch]),
        };
        Self { form, centre: self.centre.map(|c| c * size), ..self }
    }

    pub(super) fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let [x, y, z]: [T; 3] = std::array::from_fn(|a| p[a] + -self.centre[a]);
        let [cos, sin] = self.turn;
        let q = [x * cos + z * -sin, y, x * sin + z * cos];
        match self.form {
            Form::Ellipsoid(radii) => {
                let squares: [T; 3] = std::array::from_fn(|a| (q[a] * (1.0 / radii[a])).square());
                (squares[0] + squares[1] + squares[2] + -1.0) * (0.5 * shortest(radii))
            }
            Form::Drum(radii) => {
                let squares: [T; 3] = std::array::from_fn(|a| (q[a] * (1.0 / radii[a])).square());
                let cube = |v: T| v.square() * v;
                let sixth = cube(squares[0] + squares[1]) + cube(squares[2]) + CORE;
                (sixth.powf(1.0 / 3.0) + -libm::pow(1.0 + CORE, 1.0 / 3.0)) * (0.5 * shortest(radii))
            }
            Form::Ring([major, minor, stretch]) => {
                let out = (q[0].square() + q[1].square() + CORE * major * major).sqrt() + -major;
                (out.square() + (q[2] * (1.0 / stretch)).square()) * (0.5 / minor) + -0.5 * minor
            }
        }
    }

    /// How far from the origin it reaches along an axis.
    pub(super) fn reach(&self, axis: usize) -> f64 {
        let radii = match self.form {
            Form::Ellipsoid(radii) | Form::Drum(radii) => radii,
            Form::Ring([major, minor, stretch]) => [major + minor, major + minor, minor * stretch],
        };
        let [cos, sin] = self.turn;
        let own = match axis {
            0 => libm::hypot(cos * radii[0], sin * radii[2]),
            1 => radii[1],
            _ => libm::hypot(sin * radii[0], cos * radii[2]),
        };
        self.centre[axis].abs() + own
    }
}

fn shortest(radii: [f64; 3]) -> f64 {
    radii.into_iter().fold(f64::INFINITY, f64::min)
}
