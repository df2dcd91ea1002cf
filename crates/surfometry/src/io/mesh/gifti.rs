//! GIFTI 1.0 (Harwell et al., "GIFTI Surface Data Format", 2011): XML with arrays deflated and in base 64.
//!
//! Workbench takes a surface file that holds a point set and triangles and nothing else, so the arrays lie
//! beside it, under the extensions that the format has for them: `.shape.gii` (scalars) and `.vector.gii`
//! (vectors).

use super::document::flat;
use super::little_endian::{write_f32, write_indices};
use super::{MeshDocument, invalid, write_whole};
use base64::{engine::general_purpose::STANDARD, write::EncoderWriter};
use flate2::{Compression, write::ZlibEncoder};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// One array of a file.
struct DataArray<'a> {
    intent: &'static str,
    name: Option<&'a str>,
    components: usize,
    values: Values<'a>,
}

enum Values<'a> {
    Float(&'a [f64]),
    Index(&'a [[u32; 3]]),
}

/// Writes the surface and the files beside it; all of them or none, unless the file system fails between two
/// renames.
pub(super) fn write_files(path: &Path, document: &MeshDocument<'_>) -> io::Result<Vec<PathBuf>> {
    let [surface_path, scalars, vectors] = paths(path)?;
    let mut files = vec![(surface_path, surface(document))];
    for (components, intent, path) in
        [(1, "NIFTI_INTENT_SHAPE", scalars), (3, "NIFTI_INTENT_VECTOR", vectors)]
    {
        let arrays = document.arrays.iter().map(|array| (array.name.as_ref(), flat(array)));
        let arrays = arrays.filter(|(_, (_, n))| *n == components).map(|(name, (values, _))| DataArray {
            intent,
            name: Some(name),
            components,
            values: Values::Float(values),
        });
        files.push((path, arrays.collect()));
    }
    files.retain(|(_, arrays)| !arrays.is_empty());
    write_all(&files, &document.ascii_title())?;
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

/// The surface, its scalars and its vectors.
pub(super) fn paths(path: &Path) -> io::Result<[PathBuf; 3]> {
    let base = base_name(path)?;
    Ok([path.to_owned(), base.with_added_extension("shape.gii"), base.with_added_extension("vector.gii")])
}

/// The name without `.gii` or `.surf.gii`.
fn base_name(path: &Path) -> io::Result<PathBuf> {
    let base = path.with_extension("");
    let kind = base.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match kind.as_deref() {
        Some("surf") => Ok(base.with_extension("")),
        Some(kind @ ("shape" | "func" | "vector" | "label")) => Err(invalid(format!(
            ".{kind}.gii is the name of data: name the surface, .surf.gii; its data are written beside it"
        ))),
        _ => Ok(base),
    }
}

/// A file takes its place only when those after it have.
fn write_all(files: &[(PathBuf, Vec<DataArray<'_>>)], title: &str) -> io::Result<()> {
    let Some(((path, arrays), rest)) = files.split_first() else { return Ok(()) };
    write_whole(path, |out| {
        write(out, arrays, title)?;
        write_all(rest, title)
    })
}

fn surface<'a>(document: &MeshDocument<'a>) -> Vec<DataArray<'a>> {
    let points = Values::Float(document.mesh.vertices.as_flattened());
    let triangles = Values::Index(&document.mesh.triangles);
    let array = |intent, values| DataArray { intent, name: None, components: 3, values };
    vec![array("NIFTI_INTENT_POINTSET", points), array("NIFTI_INTENT_TRIANGLE", triangles)]
}

fn write(out: &mut dyn Write, arrays: &[DataArray<'_>], title: &str) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(out, "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">")?;
    writeln!(out, "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"{}\">", arrays.len())?;
    writeln!(out, "{}\n<LabelTable/>", meta_data(&[("Title", title)]))?;
    arrays.iter().try_for_each(|array| write_array(out, array))?;
    writeln!(out, "</GIFTI>")
}

/// In CDATA, since gifticlib takes no other text in these elements.
fn meta_data(entries: &[(&str, &str)]) -> String {
    let entry = |(name, value): &(&str, &str)| {
        let value = value.replace("]]>", "]] >");
        format!("<MD><Name><![CDATA[{name}]]></Name><Value><![CDATA[{value}]]></Value></MD>")
    };
    format!("<MetaData>{}</MetaData>", entries.iter().map(entry).collect::<String>())
}

fn write_array(out: &mut dyn Write, array: &DataArray<'_>) -> io::Result<()> {
    let (kind, rows) = match array.values {
        Values::Float(values) => ("NIFTI_TYPE_FLOAT32", values.len() / array.components),
        Values::Index(triangles) => ("NIFTI_TYPE_INT32", triangles.len()),
    };
    let sizes = match array.components {
        1 => format!("Dimensionality=\"1\" Dim0=\"{rows}\""),
        n => format!("Dimensionality=\"2\" Dim0=\"{rows}\" Dim1=\"{n}\""),
    };
    writeln!(
        out,
        "<DataArray Intent=\"{}\" DataType=\"{kind}\" ArrayIndexingOrder=\"RowMajorOrder\" {sizes} \
         Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" ExternalFileOffset=\"\">",
        array.intent
    )?;
    let name = array.name.map(|name| ("Name", name));
    writeln!(out, "{}", meta_data(name.as_slice()))?;
    if array.intent == "NIFTI_INTENT_POINTSET" {
        out.write_all(SCANNER_COORDINATES.as_bytes())?;
    }
    write!(out, "<Data>")?;
    // Named after gzip, the encoding is zlib's format.
    let encoder = ZlibEncoder::new(EncoderWriter::new(&mut *out, &STANDARD), Compression::new(4));
    let mut buffered = BufWriter::new(encoder);
    match array.values {
        Values::Float(values) => write_f32(&mut buffered, values)?,
        Values::Index(triangles) => write_indices(&mut buffered, triangles)?,
    }
    buffered.into_inner()?.finish()?.finish()?;
    writeln!(out, "</Data>\n</DataArray>")
}

/// Points are where the scanner saw them: RAS, mm.
const SCANNER_COORDINATES: &str = "\
<CoordinateSystemTransformMatrix>
<DataSpace><![CDATA[NIFTI_XFORM_SCANNER_ANAT]]></DataSpace>
<TransformedSpace><![CDATA[NIFTI_XFORM_SCANNER_ANAT]]></TransformedSpace>
<MatrixData>
1 0 0 0
0 1 0 0
0 0 1 0
0 0 0 1
</MatrixData>
</CoordinateSystemTransformMatrix>
";

#[cfg(test)]
mod tests {
    use super::super::test_meshes::{f32_at, tetrahedron};
    use super::*;
    use base64::Engine;
    use std::io::Read;

    fn decoded(text: &str, array: usize) -> Vec<u8> {
        let data = text.split("<Data>").nth(array + 1).unwrap().split("</Data>").next().unwrap();
        let deflated = STANDARD.decode(data).unwrap();
        let mut bytes = Vec::new();
        flate2::read::ZlibDecoder::new(&deflated[..]).read_to_end(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn a_surface_and_its_data() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["L4.v2.surf.gii", "L4.v2.gii"] {
            let path = folder.path().join(name);
            let written = write_files(&path, &tetrahedron().document()).unwrap();
            let beside = |name: &str| folder.path().join(name);
            assert_eq!(written, [path, beside("L4.v2.shape.gii"), beside("L4.v2.vector.gii")]);
            let [surface, shape, vector] =
                [0, 1, 2].map(|i: usize| std::fs::read_to_string(&written[i]).unwrap());
            assert!(surface.contains("NumberOfDataArrays=\"2\""));
            assert_eq!(f32_at(&decoded(&surface, 0), 12), 1.5);
            assert_eq!(decoded(&surface, 1)[4..8], 2i32.to_le_bytes());
            assert!(shape.contains("<Value><![CDATA[mean_curvature_per_mm]]></Value>"));
            assert_eq!(f32_at(&decoded(&shape, 0), 12), 2.0);
            assert!(vector.contains("<![CDATA[normal]]>") && vector.contains("<![CDATA[direction_1]]>"));
            assert_eq!(decoded(&vector, 1).len(), 4 * 3 * 4);
        }
    }

    #[test]
    fn all_files_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.surf.gii");
        std::fs::create_dir(folder.path().join("a.vector.gii")).unwrap();
        assert!(write_files(&path, &tetrahedron().document()).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        let data = folder.path().join("a.Shape.gii");
        let refused = write_files(&data, &tetrahedron().document()).unwrap_err();
        assert!(refused.to_string().contains(".surf.gii"));
    }
}
