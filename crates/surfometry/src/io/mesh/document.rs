//! What a mesh file is made from, checked once for all formats.

use super::invalid;
use crate::surface::{Mesh, VertexArray, VertexValues};
use std::io;

/// What a mesh file is made from.
#[derive(Debug, Clone, Copy)]
pub struct MeshDocument<'a> {
    /// The triangles, in world coordinates (RAS, mm), facing outward.
    pub mesh: &'a Mesh,
    /// Values at the vertices. The vector array `normal` becomes the format's own normals.
    pub arrays: &'a [VertexArray],
    /// sRGB, a vertex each.
    pub colors: Option<&'a [[u8; 3]]>,
    /// One line that says where the mesh comes from. Characters outside ASCII are written as `?`.
    pub title: &'a str,
}

/// A number a vertex: a scalar array, or one component of a vector array.
pub(super) struct Column<'a> {
    /// The array's name, with `_x`, `_y` or `_z` for a vector's component.
    pub(super) name: String,
    flat: &'a [f64],
    stride: usize,
    axis: usize,
}

impl Column<'_> {
    /// The value at a vertex.
    pub(super) fn at(&self, vertex: usize) -> f64 {
        self.flat[vertex * self.stride + self.axis]
    }
}

/// Values of an array vertex by vertex, and how many a vertex has.
pub(super) fn flat(array: &VertexArray) -> (&[f64], usize) {
    match &array.values {
        VertexValues::Scalar(values) => (values, 1),
        VertexValues::Vector(values) => (values.as_flattened(), 3),
    }
}

/// Arrays split into components.
pub(super) fn columns<'a>(arrays: impl IntoIterator<Item = &'a VertexArray>) -> Vec<Column<'a>> {
    let of_array = |array: &'a VertexArray| {
        let (flat, stride) = flat(array);
        (0..stride).map(move |axis| {
            let suffix = if stride == 1 { "" } else { ["_x", "_y", "_z"][axis] };
            Column { name: format!("{}{suffix}", array.name), flat, stride, axis }
        })
    };
    arrays.into_iter().flat_map(of_array).collect()
}

fn is_normal(array: &VertexArray) -> bool {
    array.name == "normal" && matches!(array.values, VertexValues::Vector(_))
}

impl<'a> MeshDocument<'a> {
    /// The vector array `normal`.
    pub(super) fn normals(&self) -> Option<&'a [[f64; 3]]> {
        self.arrays.iter().filter(|a| is_normal(a)).find_map(|array| match &array.values {
            VertexValues::Vector(values) => Some(values.as_slice()),
            VertexValues::Scalar(_) => None,
        })
    }

    /// All arrays but the normals, for formats that have a place of their own for these.
    pub(super) fn other_arrays(&self) -> impl Iterator<Item = &'a VertexArray> {
        self.arrays.iter().filter(|a| !is_normal(a))
    }

    /// The title as one line of printable ASCII.
    pub(super) fn ascii_title(&self) -> String {
        let printable = |c: char| match c {
            ' '..='~' => c,
            _ if c.is_whitespace() || c.is_control() => ' ',
            _ => '?',
        };
        self.title.trim().chars().map(printable).collect()
    }

    /// Whether everything fits together and can be written in single precision and with 32-bit indices, which
    /// most formats have. One rule for all of them, so that a mesh is not refused in one format and cut short
    /// in another.
    pub(super) fn check(&self) -> io::Result<()> {
        let (vertices, triangles) = (self.mesh.vertices.len(), self.mesh.triangles.len());
        if triangles == 0 {
            return Err(invalid("the mesh has no triangles: there is nothing to write"));
        }
        if i32::try_from(vertices).is_err() || i32::try_from(triangles).is_err() {
            return Err(invalid(format!(
                "{vertices} vertices and {triangles} triangles: at most 2^31 - 1 fit"
            )));
        }
        if let Some(v) = self.mesh.triangles.as_flattened().iter().find(|&&v| v as usize >= vertices) {
            return Err(invalid(format!("a triangle names vertex {v} of {vertices}")));
        }
        check_values("the mesh's vertices", self.mesh.vertices.as_flattened(), 3, f32::is_finite)?;
        for array in self.arrays {
            let (values, components) = flat(array);
            check_length(&array.name, values.len() / components, vertices)?;
            // A number that is none stands for no value.
            let is_value = |v: f32| v.is_finite() || (components == 1 && v.is_nan());
            check_values(&array.name, values, components, is_value)?;
        }
        self.colors.map_or(Ok(()), |colors| check_length("the colours", colors.len(), vertices))
    }
}

fn check_length(name: &str, length: usize, vertices: usize) -> io::Result<()> {
    if length == vertices {
        return Ok(());
    }
    Err(invalid(format!("{name}: {length} values for {vertices} vertices")))
}

fn check_values(
    name: &str,
    values: &[f64],
    components: usize,
    is_value: impl Fn(f32) -> bool,
) -> io::Result<()> {
    // A double beyond the range of f32 would turn into infinity on its way into the file.
    match values.iter().position(|&v| !is_value(v as f32)) {
        None => Ok(()),
        Some(at) => Err(invalid(format!(
            "{name}: the value at vertex {} is {:e}, which is not a finite number of single precision",
            at / components,
            values[at]
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::{OwnedDocument, tetrahedron};
    use super::*;

    fn refused(change: impl FnOnce(&mut OwnedDocument)) -> String {
        let mut owned = tetrahedron();
        change(&mut owned);
        let error = owned.document().check().unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
        error.to_string()
    }

    #[test]
    fn refusals_name_the_array() {
        tetrahedron().document().check().unwrap();
        assert!(refused(|d| d.mesh.triangles.clear()).contains("no triangles"));
        assert!(refused(|d| d.mesh.triangles[2][1] = 4).contains("vertex 4 of 4"));
        assert!(
            refused(|d| d.mesh.vertices[2][1] = f64::INFINITY).contains("vertices: the value at vertex 2")
        );
        assert!(refused(|d| d.colors.truncate(3)).contains("colours: 3 values for 4"));
        let scalar = |v: Vec<f64>| VertexValues::Scalar(v);
        let short = refused(|d| d.arrays[1].values = scalar(vec![0.0; 3]));
        assert!(short.contains("mean_curvature_per_mm: 3 values for 4 vertices"));
        for bad in [f64::INFINITY, f64::NEG_INFINITY, 1e39] {
            let message = refused(|d| d.arrays[1].values = scalar(vec![0.0, bad, 0.0, 0.0]));
            assert!(message.contains("mean_curvature_per_mm: the value at vertex 1"), "{message}");
        }
    }

    /// Not a number stands for no value, which no coordinate lacks.
    #[test]
    fn scalars_may_lack_values() {
        let mut owned = tetrahedron();
        owned.arrays[1].values = VertexValues::Scalar(vec![0.0, f64::NAN, 0.0, 0.0]);
        owned.document().check().unwrap();
        assert!(refused(|d| d.mesh.vertices[2][1] = f64::NAN).contains("vertices: the value at vertex 2"));
        let vectors = VertexValues::Vector(vec![[0.0, f64::NAN, 0.0]; 4]);
        assert!(refused(|d| d.arrays[1].values = vectors).contains("the value at vertex 0"));
    }

    #[test]
    fn columns_titles_and_normals() {
        let owned = tetrahedron();
        let document = owned.document();
        assert_eq!(document.ascii_title(), "surfometry <test> & \"more\" of ?");
        assert_eq!(document.normals().unwrap()[1], [1.0, 0.0, 0.0]);
        let columns = columns(document.other_arrays());
        let names: Vec<_> = columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["mean_curvature_per_mm", "direction_1_x", "direction_1_y", "direction_1_z"]);
        assert_eq!((columns[0].at(3), columns[2].at(1), columns[3].at(1)), (2.0, 1.0, 0.0));
    }
}
