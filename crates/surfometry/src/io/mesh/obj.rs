//! Wavefront OBJ: positions, normals, and colours behind the positions, which is no part of the format but
//! what MeshLab began and Blender, trimesh and others read. It has no place for other arrays.

use super::MeshDocument;
use std::io::{self, Write};

pub(super) fn write(out: &mut dyn Write, document: &MeshDocument<'_>) -> io::Result<()> {
    let MeshDocument { mesh, colors, .. } = *document;
    // 3D Slicer looks for SPACE=RAS and takes LPS where it is missing.
    writeln!(out, "# SPACE=RAS\n# {}", document.ascii_title())?;
    for (v, [x, y, z]) in mesh.vertices.iter().enumerate() {
        write!(out, "v {x:?} {y:?} {z:?}")?;
        if let Some(colors) = colors {
            let [r, g, b] = colors[v].map(|c| f32::from(c) / 255.0);
            write!(out, " {r:?} {g:?} {b:?}")?;
        }
        writeln!(out)?;
    }
    let normals = document.normals();
    for [x, y, z] in normals.unwrap_or_default().iter().map(|n| n.map(|c| c as f32)) {
        writeln!(out, "vn {x:?} {y:?} {z:?}")?;
    }
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v + 1)) {
        match normals {
            Some(_) => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?,
            None => writeln!(out, "f {a} {b} {c}")?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::tetrahedron;
    use super::*;

    fn lines(document: &MeshDocument<'_>) -> Vec<String> {
        let mut bytes = Vec::new();
        write(&mut bytes, document).unwrap();
        String::from_utf8(bytes).unwrap().lines().map(str::to_owned).collect()
    }

    #[test]
    fn with_and_without_normals_and_colours() {
        let owned = tetrahedron();
        let full = lines(&owned.document());
        assert_eq!(
            full[..3],
            ["# SPACE=RAS", "# surfometry <test> & \"more\" of ?", "v 0.5 -1.0 2.0 1.0 0.0 0.0"]
        );
        assert_eq!(full[7], "vn 1.0 0.0 0.0");
        assert_eq!(full[10], "f 1//1 3//3 2//2");
        let bare = lines(&MeshDocument { arrays: &[], colors: None, ..owned.document() });
        assert_eq!(
            bare[2..=6],
            ["v 0.5 -1.0 2.0", "v 1.5 -1.0 2.0", "v 0.5 0.0 2.0", "v 0.5 -1.0 3.1", "f 1 3 2"]
        );
    }
}
