//! PLY, binary (Turk, "The PLY Polygon File Format", 1994).
//!
//! Positions are doubles, so that they lose nothing: MeshLab, trimesh and meshio keep them, VTK converts.
//! Everything else is `float`, as most programs write it. Blender takes properties beyond the usual ones as
//! attributes.

use super::MeshDocument;
use super::document::columns;
use super::little_endian::{write_f32, write_f64, write_indices};
use std::io::{self, Write};

pub(super) fn write(out: &mut dyn Write, document: &MeshDocument<'_>) -> io::Result<()> {
    let MeshDocument { mesh, colors, .. } = *document;
    let (normals, columns) = (document.normals(), columns(document.other_arrays()));
    let names = columns.iter().map(|c| c.name.as_str());
    let float_properties = ["nx", "ny", "nz"].into_iter().take(3 * usize::from(normals.is_some()));
    // 3D Slicer looks for SPACE=RAS and takes LPS where it is missing.
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment SPACE=RAS\n")?;
    writeln!(out, "comment {}", document.ascii_title())?;
    writeln!(out, "element vertex {}", mesh.vertices.len())?;
    ["x", "y", "z"].iter().try_for_each(|name| writeln!(out, "property double {name}"))?;
    float_properties.chain(names).try_for_each(|name| writeln!(out, "property float {name}"))?;
    if colors.is_some() {
        ["red", "green", "blue"].iter().try_for_each(|name| writeln!(out, "property uchar {name}"))?;
    }
    writeln!(out, "element face {}\nproperty list uchar int vertex_indices", mesh.triangles.len())?;
    writeln!(out, "end_header")?;
    for (v, position) in mesh.vertices.iter().enumerate() {
        write_f64(out, position)?;
        normals.map_or(Ok(()), |normals| write_f32(out, &normals[v]))?;
        columns.iter().try_for_each(|column| write_f32(out, &[column.at(v)]))?;
        colors.map_or(Ok(()), |colors| out.write_all(&colors[v]))?;
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        write_indices(out, std::slice::from_ref(triangle))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::{f32_at, f64_at, tetrahedron, u32_at};
    use super::*;

    #[test]
    fn header_and_rows() {
        let mut bytes = Vec::new();
        write(&mut bytes, &tetrahedron().document()).unwrap();
        let marker = b"end_header\n";
        let start = bytes.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len();
        let header = std::str::from_utf8(&bytes[..start]).unwrap();
        let properties: Vec<_> = header.lines().filter_map(|l| l.strip_prefix("property float ")).collect();
        let vector = ["direction_1_x", "direction_1_y", "direction_1_z"];
        assert_eq!(properties[..4], ["nx", "ny", "nz", "mean_curvature_per_mm"]);
        assert_eq!(properties[4..], vector);
        assert!(header.contains("comment SPACE=RAS\ncomment surfometry <test> & \"more\" of ?\n"));
        let row = 3 * 8 + 7 * 4 + 3;
        assert_eq!(bytes.len(), start + 4 * row + 4 * 13);
        let second = start + row;
        assert_eq!(f64_at(&bytes, second), 1.5);
        assert_eq!(f32_at(&bytes, second + 24), 1.0);
        assert_eq!(f32_at(&bytes, second + 36), -1e-7);
        assert_eq!(bytes[second + 52..second + 55], [0, 128, 0]);
        assert_eq!(bytes[start + 4 * row], 3);
        assert_eq!(u32_at(&bytes, start + 4 * row + 5), 2);
    }
}
