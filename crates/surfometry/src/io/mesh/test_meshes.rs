//! What the formats' tests write.

use super::MeshDocument;
use crate::surface::{Mesh, VertexArray, VertexValues};

/// The parts of a document.
pub(super) struct OwnedDocument {
    pub(super) mesh: Mesh,
    pub(super) arrays: Vec<VertexArray>,
    pub(super) colors: Vec<[u8; 3]>,
}

impl OwnedDocument {
    pub(super) fn document(&self) -> MeshDocument<'_> {
        let Self { mesh, arrays, colors } = self;
        MeshDocument { mesh, arrays, colors: Some(colors), title: "surfometry <test> & \"more\"\nof \u{fc}" }
    }
}

/// A tetrahedron with normals, one scalar and one vector array, and colours.
pub(super) fn tetrahedron() -> OwnedDocument {
    let s = 1.0 / libm::sqrt(3.0);
    OwnedDocument {
        mesh: Mesh {
            vertices: vec![[0.5, -1.0, 2.0], [1.5, -1.0, 2.0], [0.5, 0.0, 2.0], [0.5, -1.0, 3.1]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        },
        arrays: vec![
            VertexArray {
                name: "normal".into(),
                values: VertexValues::Vector(vec![
                    [-s, -s, -s],
                    [1.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0],
                    [0.0, 0.0, 1.0],
                ]),
            },
            VertexArray {
                name: "mean_curvature_per_mm".into(),
                values: VertexValues::Scalar(vec![0.25, -1e-7, 0.1, 2.0]),
            },
            VertexArray {
                name: "direction_1".into(),
                values: VertexValues::Vector(vec![
                    [1.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0],
                    [0.0, 0.0, 1.0],
                    [1.0, 0.0, 0.0],
                ]),
            },
        ],
        colors: vec![[255, 0, 0], [0, 128, 0], [0, 0, 255], [10, 20, 30]],
    }
}

/// A number out of a buffer.
pub(super) fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_le_bytes(bytes[offset..offset + 4].try_into().unwrap())
}

/// A number out of a buffer.
pub(super) fn f64_at(bytes: &[u8], offset: usize) -> f64 {
    f64::from_le_bytes(bytes[offset..offset + 8].try_into().unwrap())
}

/// A number out of a buffer.
pub(super) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    u32::from_le_bytes(bytes[offset..offset + 4].try_into().unwrap())
}
