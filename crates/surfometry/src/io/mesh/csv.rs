//! A table of the vertices: `x_mm,y_mm,z_mm`, then the arrays, vectors as `_x`, `_y`, `_z`. The shortest
//! digits that give the same doubles again.

use super::MeshDocument;
use super::document::columns;
use std::io::{self, Write};

pub(super) fn write(out: &mut dyn Write, document: &MeshDocument<'_>) -> io::Result<()> {
    let columns = columns(document.arrays);
    write!(out, "x_mm,y_mm,z_mm")?;
    columns.iter().try_for_each(|column| write!(out, ",{}", column.name))?;
    writeln!(out)?;
    for (v, [x, y, z]) in document.mesh.vertices.iter().enumerate() {
        write!(out, "{x:?},{y:?},{z:?}")?;
        columns.iter().try_for_each(|column| write!(out, ",{:?}", column.at(v)))?;
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::tetrahedron;
    use super::*;

    #[test]
    fn a_vertex_a_row() {
        let mut bytes = Vec::new();
        write(&mut bytes, &tetrahedron().document()).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let rows: Vec<_> = text.lines().collect();
        let header =
            "x_mm,y_mm,z_mm,normal_x,normal_y,normal_z,mean_curvature_per_mm,direction_1_x,direction_1_y";
        assert_eq!(rows[0], format!("{header},direction_1_z"));
        assert_eq!(rows[2], "1.5,-1.0,2.0,1.0,0.0,0.0,-1e-7,0.0,1.0,0.0");
        assert_eq!(rows.len(), 5);
    }
}
