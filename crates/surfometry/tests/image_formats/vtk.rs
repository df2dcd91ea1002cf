//! VTK images: legacy files and XML.

use crate::{SIZE, SPACING, assert_read, assert_refused, file, gzip, voxels};
use surfometry::volume::Affine;

const ORIGIN: [f64; 3] = [-3.0, 4.5, 1000.25];

fn legacy(kind: &str, values: &str, of: &str) -> String {
    let [nx, ny, nz] = SIZE;
    let [x, y, z] = if of == "CELL_DATA" { [nx + 1, ny + 1, nz + 1] } else { SIZE };
    format!(
        "# vtk DataFile Version 3.0\na title\n{kind}\nDATASET STRUCTURED_POINTS\nDIMENSIONS {x} {y} {z}\nSPACING 0.5 0.75 2\n\
         ORIGIN -3 4.5 1000.25\n{of} {}\nSCALARS s {values} 1\nLOOKUP_TABLE default\n",
        nx * ny * nz
    )
}

fn words() -> String {
    voxels().iter().map(|v| format!("{v} ")).collect::<Vec<_>>().join("\n")
}

fn shorts() -> Vec<u8> {
    voxels().into_iter().flat_map(|v| (i16::from(v) * 300).to_be_bytes()).collect()
}

fn affine(half: f64) -> Affine {
    Affine { origin: std::array::from_fn(|a| ORIGIN[a] + half * SPACING[a]), ..Affine::diagonal(SPACING) }
}

#[test]
fn legacy_files() {
    for (of, half) in [("POINT_DATA", 0.0), ("CELL_DATA", 0.5)] {
        let binary =
            [legacy("BINARY", "short", of).into_bytes(), shorts(), b"\nMETADATA\n".to_vec()].concat();
        for (name, bytes) in [("a.vtk", binary.clone()), ("a.vtk.gz", gzip(&binary))] {
            let (_folder, path) = file(name, &bytes);
            assert_read(&path, None, 300, affine(half));
        }
        let text = legacy("ASCII", "unsigned_char", of) + &words();
        for (name, bytes) in [("a.vtk", text.clone().into_bytes()), ("a.vtk.gz", gzip(text.as_bytes()))] {
            let (_folder, path) = file(name, &bytes);
            assert_read(&path, None, 1, affine(half));
        }
    }
}

#[test]
fn legacy_files_that_are_refused() {
    let refused = |text: &str, words: &[&str]| {
        let (_folder, path) = file("a.vtk", text.as_bytes());
        assert_refused(&path, words);
    };
    let whole = legacy("ASCII", "unsigned_char", "POINT_DATA");
    refused(&(whole.clone() + &words()[..300]), &["end after"]);
    refused(&(whole.clone() + "1 2 x " + &words()), &["`x` is no uint8 number"]);
    refused(&(whole.clone() + "1 2 300 " + &words()), &["`300` is no uint8 number"]);
    refused(&whole.replace("s unsigned_char 1", "s unsigned_char 3"), &["3 components"]);
    refused(
        &whole.replace("STRUCTURED_POINTS", "POLYDATA"),
        &["DATASET POLYDATA", "images are STRUCTURED_POINTS"],
    );
    refused(&whole.replace("DATA 210", "DATA 211"), &["211 values"]);
    refused(whole.split_once("SCALARS").unwrap().0, &["no SCALARS"]);
    refused("something else", &["# vtk DataFile"]);
}

fn vti(array: &str, appended: &str) -> String {
    let [x, y, z] = SIZE.map(|n| n + 4);
    let extent = format!("5 {x} 5 {y} 5 {z}");
    let direction = "0 -1 0 1 0 0 0 0 1";
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"BigEndian\" header_type=\"UInt32\">\n\
         <ImageData WholeExtent=\"{extent}\" Origin=\"-3 4.5 1000.25\" Spacing=\"0.5 0.75 2\" Direction=\"{direction}\">\n\
         <Piece Extent=\"{extent}\"><PointData Scalars=\"labels\"><DataArray type=\"UInt8\" Name=\"other\" format=\"ascii\">9</DataArray>\n\
         {array}</PointData></Piece></ImageData>\n{appended}</VTKFile>"
    )
}

/// x of the image runs along y of the world, y against x; the extent begins at 5.
fn turned() -> Affine {
    let affine =
        Affine::from_directions([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], SPACING, ORIGIN);
    Affine { origin: affine.apply([5.0; 3]), ..affine }
}

#[test]
fn image_data() {
    let text = vti(
        &format!("<DataArray type=\"Int8\" Name=\"labels\" format=\"ascii\">\n{}\n</DataArray>", words()),
        "",
    );
    let (_folder, path) = file("a.vti", text.as_bytes());
    assert_read(&path, None, 1, turned());
    let (_folder, path) = file("a.vti.gz", &gzip(text.as_bytes()));
    assert_read(&path, None, 1, turned());
    let raw = vti(
        "<DataArray type=\"Int16\" Name=\"labels\" format=\"appended\" offset=\"3\"/>",
        "<AppendedData encoding=\"raw\">\n_abc",
    );
    let raw = raw.strip_suffix("</VTKFile>").unwrap();
    let data = [raw.as_bytes(), &420u32.to_be_bytes(), &shorts(), b"\n</AppendedData></VTKFile>"].concat();
    let (_folder, path) = file("a.vti", &data);
    assert_read(&path, None, 300, turned());
    let (_folder, path) = file("a.vti", &data[..data.len() - 100]);
    assert_refused(&path, &["end after"]);
    let surplus = [raw.as_bytes(), &430u32.to_be_bytes(), &shorts(), &[0; 10]].concat();
    let (_folder, path) = file("a.vti", &surplus);
    assert_refused(&path, &["430 bytes of voxels", "420"]);
}

/// Comments, declarations and other elements, wherever they stand, and base64 in lines and parts: of a part the padding ends it.
#[test]
fn image_data_among_other_things() {
    let bytes = voxels();
    let parts = [&(bytes.len() as u32).to_be_bytes()[..], &bytes[..100], &bytes[100..]];
    let encoded: Vec<String> = parts.iter().map(|part| base64(part)).collect();
    let text = vti(
        &format!(
            "<!-- <DataArray> \" --><DataArray type=\"UInt8\" a='>' Name=\"labels\" format=\"binary\">\n{}\n  {}{}<!-- 7 --></DataArray>",
            encoded[0], encoded[1], encoded[2]
        ),
        "",
    );
    let text = text.replacen("<VTK", "<!-- <AppendedData> _ -->\n<VTK", 1);
    for (name, bytes) in [("a.vti", text.clone().into_bytes()), ("a.vti.gz", gzip(text.as_bytes()))] {
        let (_folder, path) = file(name, &bytes);
        assert_read(&path, None, 1, turned());
    }
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = |three: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(*three.get(i).unwrap_or(&0)));
        let digit = |i: usize| {
            if i <= three.len() { char::from(DIGITS[(bits >> (18 - 6 * i) & 63) as usize]) } else { '=' }
        };
        (0..4).map(digit).collect::<String>()
    };
    bytes.chunks(3).map(digits).collect()
}

#[test]
fn image_data_that_is_refused() {
    let refused = |text: &str, words: &[&str]| {
        let (_folder, path) = file("a.vti", text.as_bytes());
        assert_refused(&path, words);
    };
    let array =
        |of: &str| vti(&format!("<DataArray type=\"UInt8\" Name=\"labels\" {of}>AAAA</DataArray>"), "");
    refused(&array("format=\"binary\""), &["damaged"]);
    refused(&array("format=\"binary\" NumberOfComponents=\"3\""), &["3 components"]);
    refused(&array("format=\"appended\" offset=\"0\""), &["no AppendedData"]);
    refused(
        &array("format=\"ascii\"").replace("<Piece", "<Piece Extent=\"0 1 0 1 0 1\"/><Piece"),
        &["2 pieces"],
    );
    refused(
        &array("format=\"ascii\"").replace("UInt32", "UInt64").replace("5 11 5", "5 4 5"),
        &["an axis without voxels"],
    );
    refused(&array("format=\"ascii\"").replace("ImageData", "PolyData"), &["no ImageData"]);
    refused(&array("format=\"ascii\"")[..200], &["ends early"]);
}
