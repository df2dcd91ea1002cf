//! Where the viewer stands.

use crate::choice::choices;
use crate::space::{cross, dot, unit};

/// A side from which an object is looked at, named by where the viewer stands. World axes are RAS.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum View {
    /// In front. The object's right is at the picture's left.
    Anterior,
    /// Behind.
    Posterior,
    /// At the object's left; its front is at the picture's left.
    Left,
    /// At the object's right; its front is at the picture's right.
    Right,
    /// Above; the object's front is at the top.
    Superior,
    /// Below; the object's front is at the top, its right at the left, as radiologists look at axial slices.
    Inferior,
    /// In front, to the left and above.
    Oblique,
}

choices!(View, "view": {
    Anterior = "anterior": "from the front",
    Posterior = "posterior": "from behind",
    Left = "left": "from the object's left",
    Right = "right": "from the object's right",
    Superior = "superior": "from above",
    Inferior = "inferior": "from below",
    Oblique = "oblique": "from the front, the left and above",
});

/// Right-handed unit vectors of a picture, in world coordinates (RAS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Basis {
    /// To the picture's right.
    pub right: [f64; 3],
    /// To the picture's top.
    pub up: [f64; 3],
    /// Out of the picture, toward the viewer.
    pub toward: [f64; 3],
}

impl View {
    /// The picture's axes.
    pub fn basis(self) -> Basis {
        let (toward, up) = match self {
            Self::Anterior => ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            Self::Posterior => ([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
            Self::Left => ([-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            Self::Right => ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            Self::Superior => ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
            Self::Inferior => ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
            Self::Oblique => (unit([-0.7, 1.0, 0.65]), [0.0, 0.0, 1.0]),
        };
        let right = unit(cross(up, toward));
        Basis { right, up: cross(toward, right), toward }
    }

    /// Letters (L, R, A, P, I, S) at the picture's left, right, bottom and top; none where the axes are
    /// oblique.
    pub fn letters(self) -> Option<[char; 4]> {
        self.basis().letters()
    }
}

impl Basis {
    /// Letters at the picture's left, right, bottom and top; none where its axes are not the world's.
    pub(crate) fn letters(&self) -> Option<[char; 4]> {
        let Self { right, up, .. } = *self;
        Some([letter(right.map(|v| -v))?, letter(right)?, letter(up.map(|v| -v))?, letter(up)?])
    }
}

/// The anatomical direction of a unit vector along a world axis.
fn letter(direction: [f64; 3]) -> Option<char> {
    let ways = [([1.0, 0.0, 0.0], ['R', 'L']), ([0.0, 1.0, 0.0], ['A', 'P']), ([0.0, 0.0, 1.0], ['S', 'I'])];
    ways.into_iter().find_map(|(axis, [positive, negative])| match dot(direction, axis) {
        d if d > 0.999 => Some(positive),
        d if d < -0.999 => Some(negative),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Choice;

    #[test]
    fn bases_are_right_handed_and_letters_match_the_convention() {
        for &view in View::ALL {
            let Basis { right, up, toward } = view.basis();
            assert!((dot(cross(right, up), toward) - 1.0).abs() < 1e-12, "{view}");
            assert!(dot(right, up).abs() < 1e-12 && up[2].max(up[1]) > 0.5, "{view}");
            assert_eq!(view.to_string().to_uppercase().parse(), Ok(view));
        }
        let letters = |view: View| view.letters().map(String::from_iter);
        assert_eq!(letters(View::Anterior).as_deref(), Some("RLIS"));
        assert_eq!(letters(View::Posterior).as_deref(), Some("LRIS"));
        assert_eq!(letters(View::Left).as_deref(), Some("APIS"));
        assert_eq!(letters(View::Right).as_deref(), Some("PAIS"));
        assert_eq!(letters(View::Superior).as_deref(), Some("LRPA"));
        assert_eq!(letters(View::Inferior).as_deref(), Some("RLPA"));
        assert_eq!(letters(View::Oblique), None);
        assert!("front".parse::<View>().unwrap_err().to_string().contains("anterior"));
    }
}
