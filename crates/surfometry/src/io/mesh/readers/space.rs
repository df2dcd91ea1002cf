//! The axes of a mesh's coordinates, where its file names them.

use crate::surface::Mesh;

/// Which axes run the other way than RAS.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Space([bool; 3]);

/// How files say it: 3D Slicer, and what `map` writes.
const WORD: &[u8] = b"SPACE=";

impl Space {
    /// By three letters, as `LPS`: to which side each axis runs.
    pub(super) fn of_letters(letters: &[u8]) -> Option<Self> {
        let [x, y, z] = letters.first_chunk::<3>()?.map(|letter| letter.to_ascii_uppercase());
        let side = |letter, [same, other]: [u8; 2]| match letter {
            _ if letter == same => Some(false),
            _ if letter == other => Some(true),
            _ => None,
        };
        Some(Self([side(x, *b"RL")?, side(y, *b"AP")?, side(z, *b"SI")?]))
    }

    /// By a comment or title that says `SPACE=LPS` somewhere.
    pub(super) fn of_text(text: &[u8]) -> Option<Self> {
        let mut places = text.windows(WORD.len()).enumerate().filter(|(_, word)| *word == WORD);
        places.find_map(|(at, _)| Self::of_letters(&text[at + WORD.len()..]))
    }

    /// Turns a mesh to RAS; where that mirrors it, its triangles are turned round, so that they face outward still.
    pub(super) fn turn(self, mesh: &mut Mesh) {
        for axis in (0..3).filter(|&axis| self.0[axis]) {
            mesh.vertices.iter_mut().for_each(|place| place[axis] = -place[axis]);
        }
        if self.0.iter().filter(|turned| **turned).count() % 2 == 1 {
            mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_and_words() {
        assert_eq!(Space::of_text(b"3D Slicer output. SPACE=LPS"), Some(Space([true, true, false])));
        assert_eq!(Space::of_text(b"NAMESPACE=foo SPACE=ras;"), Some(Space::default()));
        for none in [&b"SPACE=LP"[..], b"space", b"", b"SPACE=XYZ"] {
            assert_eq!(Space::of_text(none), None);
        }
    }

    #[test]
    fn a_mirrored_mesh_still_faces_outward() {
        let mut mesh = Mesh {
            vertices: vec![[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        };
        let volume = mesh.volume();
        assert!(volume > 0.0);
        Space::of_letters(b"LAS").unwrap().turn(&mut mesh);
        assert_eq!((mesh.vertices[1], mesh.volume()), ([-2.0, 0.0, 0.0], volume));
    }
}
