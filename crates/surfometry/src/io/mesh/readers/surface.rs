//! Faces as triangles.

use super::Outcome;
use super::space::Space;
use crate::surface::Mesh;

/// What a file holds of a surface. Faces may come before the vertices that they name.
#[derive(Debug, Default)]
pub(super) struct Surface {
    pub(super) vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The axes, where the file names them.
    space: Option<Space>,
    /// Bytes behind the last element, which are no padding.
    pub(super) surplus: u64,
    /// Names of other files that it rests on.
    pub(super) beside: Vec<String>,
}

impl Surface {
    /// Takes a polygon, cut into a fan. One of less than three corners covers nothing.
    pub(super) fn polygon(&mut self, corners: &[u32]) {
        let fan = (2..corners.len()).map(|n| [corners[0], corners[n - 1], corners[n]]);
        self.triangles.extend(fan);
    }

    /// Takes a strip: each corner makes a triangle with the two before, every second one the other way round.
    /// Repeated corners, which join strips, make none.
    pub(super) fn strip(&mut self, corners: &[u32]) {
        let turned =
            |(n, c): (usize, &[u32])| if n % 2 == 0 { [c[0], c[1], c[2]] } else { [c[1], c[0], c[2]] };
        let solid = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        self.triangles.extend(corners.windows(3).enumerate().map(turned).filter(solid));
    }

    /// Hears a comment or title, which may name the axes; of one file all have the same.
    pub(super) fn comment(&mut self, text: &[u8]) -> Outcome<()> {
        match (Space::of_text(text), self.space) {
            (Some(named), Some(before)) if named != before => {
                Err("its parts have different axes (SPACE=RAS and SPACE=LPS): bring them into one".to_owned())
            }
            (named, before) => {
                self.space = named.or(before);
                Ok(())
            }
        }
    }

    /// The mesh in RAS.
    pub(super) fn into_mesh(self) -> Outcome<Mesh> {
        let count = self.vertices.len();
        if let Some(far) = self.triangles.as_flattened().iter().find(|&&corner| corner as usize >= count) {
            return Err(format!("a face names vertex {far}, counted from 0, of {count}"));
        }
        let mut mesh = Mesh { vertices: self.vertices, triangles: self.triangles };
        self.space.unwrap_or_default().turn(&mut mesh);
        Ok(mesh)
    }
}

/// The number of a vertex, counted from 0.
pub(super) fn corner(number: f64) -> Outcome<u32> {
    let whole = number >= 0.0 && number.fract() == 0.0 && number < f64::from(u32::MAX);
    if whole { Ok(number as u32) } else { Err(format!("a face names vertex {number}, which cannot be")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fans_and_strips() {
        let mut surface = Surface { vertices: vec![[0.0; 3]; 6], ..Surface::default() };
        surface.polygon(&[0, 1, 2, 3]);
        surface.polygon(&[0, 1]);
        surface.strip(&[0, 1, 2, 3, 3, 4, 5]);
        let triangles = surface.into_mesh().unwrap().triangles;
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [2, 1, 3], [3, 4, 5]]);
    }

    #[test]
    fn numbers_that_are_no_vertex() {
        for bad in [-1.0, 0.5, f64::NAN, 4e9 * 2.0] {
            assert!(corner(bad).is_err(), "{bad}");
        }
        let mut surface = Surface { vertices: vec![[0.0; 3]; 3], ..Surface::default() };
        surface.polygon(&[0, 1, 3]);
        assert!(surface.into_mesh().unwrap_err().contains("vertex 3, counted from 0, of 3"));
    }
}
