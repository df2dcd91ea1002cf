//! VTK XML poly data with raw appended arrays ("VTK XML Formats", docs.vtk.org): all digits of everything.

use super::MeshDocument;
use super::document::flat;
use super::little_endian::write_f64;
use std::io::{self, Write};

/// Values of one array.
enum Values<'a> {
    Double(&'a [f64]),
    Byte(&'a [u8]),
    /// Vertex numbers.
    Connectivity(&'a [u32]),
    /// Where each of so many triangles ends in the connectivity.
    Offsets(usize),
}

impl Values<'_> {
    fn vtk_type(&self) -> &'static str {
        match self {
            Self::Double(_) => "Float64",
            Self::Byte(_) => "UInt8",
            Self::Connectivity(_) | Self::Offsets(_) => "Int64",
        }
    }

    fn byte_count(&self) -> usize {
        match self {
            Self::Double(values) => 8 * values.len(),
            Self::Byte(values) => values.len(),
            Self::Connectivity(values) => 8 * values.len(),
            Self::Offsets(count) => 8 * count,
        }
    }

    /// The byte count as header_type says, then the values.
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(&(self.byte_count() as u64).to_le_bytes())?;
        let mut integer = |v: i64| out.write_all(&v.to_le_bytes());
        match self {
            Self::Connectivity(values) => values.iter().try_for_each(|&v| integer(i64::from(v))),
            Self::Offsets(count) => (1..=*count as i64).try_for_each(|i| integer(3 * i)),
            Self::Double(values) => write_f64(out, values),
            Self::Byte(values) => out.write_all(values),
        }
    }
}

/// Arrays named so far, and where the next one begins in the appended data.
#[derive(Default)]
struct Appended<'a> {
    arrays: Vec<Values<'a>>,
    offset: usize,
}

impl<'a> Appended<'a> {
    /// The element that stands for an array; its values follow at the end of the file.
    fn element(&mut self, name: &str, components: usize, values: Values<'a>) -> String {
        let (kind, offset) = (values.vtk_type(), self.offset);
        self.offset += size_of::<u64>() + values.byte_count();
        self.arrays.push(values);
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{offset}\"/>\n"
        )
    }
}

pub(super) fn write(out: &mut dyn Write, document: &MeshDocument<'_>) -> io::Result<()> {
    let MeshDocument { mesh, arrays, colors, .. } = *document;
    let mut appended = Appended::default();
    out.write_all(
        b"<?xml version=\"1.0\"?>\n\
          <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
          <PolyData>\n",
    )?;
    // 3D Slicer looks for the field SPACE and takes LPS where it is missing.
    let fields = string_element("SPACE", "RAS") + &string_element("title", &document.ascii_title());
    write!(out, "<FieldData>\n{fields}</FieldData>\n")?;
    let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
    writeln!(out, "<Piece NumberOfPoints=\"{vertices}\" NumberOfPolys=\"{triangles}\">")?;
    writeln!(out, "<PointData{}>", active_arrays(document))?;
    for array in arrays {
        let (values, components) = flat(array);
        out.write_all(appended.element(&array.name, components, Values::Double(values)).as_bytes())?;
    }
    if let Some(colors) = colors {
        out.write_all(appended.element("color", 3, Values::Byte(colors.as_flattened())).as_bytes())?;
    }
    let points = appended.element("Points", 3, Values::Double(mesh.vertices.as_flattened()));
    write!(out, "</PointData>\n<Points>\n{points}</Points>\n")?;
    let connectivity =
        appended.element("connectivity", 1, Values::Connectivity(mesh.triangles.as_flattened()));
    let offsets = appended.element("offsets", 1, Values::Offsets(triangles));
    write!(out, "<Polys>\n{connectivity}{offsets}</Polys>\n</Piece>\n</PolyData>\n")?;
    out.write_all(b"<AppendedData encoding=\"raw\">\n_")?;
    appended.arrays.iter().try_for_each(|values| values.write(out))?;
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}

/// What a viewer shows at first.
fn active_arrays(document: &MeshDocument<'_>) -> String {
    let normals = document.normals().map(|_| " Normals=\"normal\"");
    let curvature = "mean_curvature_per_mm";
    let scalars = document.arrays.iter().any(|a| a.name == curvature && flat(a).1 == 1);
    let scalars = scalars.then(|| format!(" Scalars=\"{curvature}\""));
    normals.unwrap_or_default().to_owned() + &scalars.unwrap_or_default()
}

/// A text as VTK writes it in place: the codes of its characters, and a zero. So there is nothing to escape.
fn string_element(name: &str, text: &str) -> String {
    let codes: Vec<String> = text.bytes().chain([0]).map(|b| b.to_string()).collect();
    format!(
        "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">{}</Array>\n",
        codes.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::{f64_at, tetrahedron};
    use super::*;

    #[test]
    fn offsets_lead_to_the_arrays() {
        let owned = tetrahedron();
        let mut bytes = Vec::new();
        write(&mut bytes, &owned.document()).unwrap();
        let marker = b"encoding=\"raw\">\n_";
        let start = bytes.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len();
        let header = std::str::from_utf8(&bytes[..start]).unwrap();
        assert!(header.contains("<PointData Normals=\"normal\" Scalars=\"mean_curvature_per_mm\">"));
        assert!(header.contains("Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">82 65 83 0<"));
        let found = |name: &str, wanted: &[f64]| {
            let element = header.split(&format!("Name=\"{name}\"")).nth(1).unwrap();
            let offset = element.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
            let at = start + offset.parse::<usize>().unwrap();
            assert_eq!(bytes[at..at + 8], (8 * wanted.len() as u64).to_le_bytes(), "{name}");
            for (i, &value) in wanted.iter().enumerate() {
                assert_eq!(f64_at(&bytes, at + 8 + 8 * i), value, "{name}");
            }
        };
        found("mean_curvature_per_mm", flat(&owned.arrays[1]).0);
        found("direction_1", flat(&owned.arrays[2]).0);
        found("Points", owned.mesh.vertices.as_flattened());
    }
}
