//! STL, binary: an 80-byte header, the number of triangles, 50 bytes each. It has no shared vertices and no
//! arrays.

use super::MeshDocument;
use super::little_endian::write_f32;
use std::io::{self, Write};

pub(super) fn write(out: &mut dyn Write, document: &MeshDocument<'_>) -> io::Result<()> {
    let mesh = document.mesh;
    out.write_all(&header(&document.ascii_title()))?;
    out.write_all(&(mesh.triangles.len() as u32).to_le_bytes())?;
    for &triangle in &mesh.triangles {
        write_f32(out, &mesh.normal(triangle))?;
        write_f32(out, mesh.corners(triangle).as_flattened())?;
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

/// 3D Slicer looks for `SPACE=RAS`. In front, it keeps the word `solid` away from where it would mean a text
/// file.
fn header(title: &str) -> [u8; 80] {
    let mut header = [b' '; 80];
    let text = format!("SPACE=RAS {title}");
    let length = text.len().min(header.len());
    header[..length].copy_from_slice(&text.as_bytes()[..length]);
    header
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::{f32_at, tetrahedron, u32_at};
    use super::*;

    #[test]
    fn triangles_with_normals() {
        let owned = tetrahedron();
        let mut bytes = Vec::new();
        write(&mut bytes, &owned.document()).unwrap();
        assert_eq!(bytes.len(), 84 + 4 * 50);
        assert!(bytes.starts_with(b"SPACE=RAS surfometry <test>"));
        assert_eq!(u32_at(&bytes, 80), 4);
        // The first one lies at the bottom and faces down.
        assert_eq!([f32_at(&bytes, 84), f32_at(&bytes, 88), f32_at(&bytes, 92)], [0.0, 0.0, -1.0]);
        assert_eq!(f32_at(&bytes, 84 + 50 * 3 + 12), 1.5);
    }

    #[test]
    fn a_long_title_is_cut() {
        assert_eq!(header(&"t".repeat(200))[70..], [b't'; 10]);
        assert_eq!(header("")[9..], [b' '; 71]);
    }
}
