//! Files of meshes, as many programs write them: nothing that carries a surface is left out in silence, and what cannot
//! be read is refused by its name. The truth is a turned block, whose volume and centre are known.

mod common;

use common::phantom;
use std::io::Write;
use std::path::{Path, PathBuf};
use surfometry::Measurement;
use surfometry::accuracy::FlagCode;
use surfometry::inputs::{OpenOptions, open};
use surfometry::io::{MeshDocument, is_mesh, read_mesh, write_mesh};
use surfometry::phantoms::{Ellipsoid, Pose};
use surfometry::surface::Mesh;

const SIZES: [f64; 3] = [10.0, 6.0, 4.0];
const CENTRE: [f64; 3] = [20.0, -30.0, 40.0];
const VOLUME: f64 = 240.0;
/// Seen from outside, counter-clockwise.
const SIDES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// The corners of a block that is turned by 60 degrees about (1, 1, 1).
fn corners() -> [[f64; 3]; 8] {
    let turn = [[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]];
    std::array::from_fn(|n| {
        let local: [f64; 3] = std::array::from_fn(|a| SIZES[a] * (f64::from((n >> a & 1) as u8) - 0.5));
        let turned = turn.map(|row| (0..3).map(|a| row[a] * local[a]).sum::<f64>() / 3.0);
        std::array::from_fn(|a| CENTRE[a] + turned[a])
    })
}

fn triangles() -> Vec<[usize; 3]> {
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

fn place([x, y, z]: [f64; 3]) -> String {
    format!("{x} {y} {z}\n")
}

fn places() -> String {
    corners().map(place).concat()
}

fn faces(offset: usize) -> String {
    let of_side = |side: &[usize; 4]| format!("4 {}\n", side.map(|n| (n + offset).to_string()).join(" "));
    SIDES.iter().map(of_side).collect()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn read(&self, name: &str, bytes: impl AsRef<[u8]>) -> Mesh {
        read_mesh(&self.write(name, bytes)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    #[track_caller]
    fn refused(&self, name: &str, bytes: impl AsRef<[u8]>, words: &[&str]) {
        let error = read_mesh(&self.write(name, bytes)).unwrap_err().to_string();
        for word in words.iter().chain(&["export the mesh again"]) {
            assert!(error.contains(word), "`{word}` is missing in: {error}");
        }
        assert!(!error.contains('\u{1b}') && error.len() < 300, "{error}");
    }
}

/// Where a closed mesh's inside has its centre.
fn centre(mesh: &Mesh) -> [f64; 3] {
    let (mut sum, mut volume) = ([0.0; 3], 0.0);
    let origin = mesh.vertices[0];
    for &triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle).map(|v| [0, 1, 2].map(|i| v[i] - origin[i]));
        let of = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        volume += of;
        (0..3).for_each(|i| sum[i] += of * (a[i] + b[i] + c[i]) / 4.0);
    }
    [0, 1, 2].map(|i| origin[i] + sum[i] / volume)
}

/// It is the block, `times` of them in one place.
#[track_caller]
fn is_block(mesh: &Mesh, times: f64, centre_mm: [f64; 3]) {
    assert!((mesh.volume() / (times * VOLUME) - 1.0).abs() < 1e-5, "{} mm3", mesh.volume());
    let found = centre(mesh);
    assert!((0..3).all(|i| (found[i] - centre_mm[i]).abs() < 1e-3), "{found:?}");
}

fn text_solid(name: &str, end: &str) -> String {
    let facet = |t: &[usize; 3]| {
        let vertices = t.map(|n| format!("   vertex {}", place(corners()[n]))).concat();
        format!("facet normal nan nan nan\n  outer loop\n{vertices}  endloop\nendfacet\n")
    };
    let facets: String = triangles().iter().map(facet).collect();
    format!("solid{name}\n{facets}endsolid{name}\n").replace('\n', end)
}

fn binary_solid(header: &str, count: u32) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        let single = triangle.iter().flat_map(|&n| corners()[n]).flat_map(|c| (c as f32).to_le_bytes());
        bytes.extend(single);
        bytes.extend([7, 0]);
    }
    bytes
}

#[test]
fn every_solid_of_a_text_stl() {
    let folder = Folder::new();
    for end in ["\n", "\r\n", "\r"] {
        for name in ["", " a", " facet vertex 1 2 endsolid"] {
            is_block(&folder.read("a.stl", text_solid(name, end)), 1.0, CENTRE);
        }
        let three = text_solid(" a", end) + &text_solid("", end) + &text_solid(" b c", end);
        is_block(&folder.read("a.stl", three), 3.0, CENTRE);
    }
    // As in the tables of another language, in capitals, behind a mark, with padding.
    let mut odd = b"\xef\xbb\xbf".to_vec();
    odd.extend(text_solid("", "\n").to_uppercase().replace("NAN", "nan").bytes());
    odd.extend([b'\n', 0x1a, 0, 0]);
    is_block(&folder.read("a.stl", odd), 1.0, CENTRE);
    let latin = [&b"solid caf\xe9\n"[..], &text_solid("", "\n").as_bytes()[6..]].concat();
    is_block(&folder.read("a.stl", latin), 1.0, CENTRE);
    let turned = folder.read("a.stl", text_solid(" 3D Slicer output. SPACE=LPS", "\n"));
    is_block(&turned, 1.0, [-20.0, 30.0, 40.0]);
    let cut = text_solid(" a", "\n");
    folder.refused("a.stl", &cut[..cut.len() / 2], &["STL", "line"]);
    folder.refused("a.stl", cut.replacen("vertex", "vertx", 1), &["line 4", "vertx"]);
    folder.refused(
        "a.stl",
        cut.replacen("endloop\nendfacet", "endfacet", 1).replacen("vertex", "loop", 1),
        &["line"],
    );
    let both = text_solid(" SPACE=LPS", "\n") + &text_solid(" SPACE=RAS", "\n");
    folder.refused("a.stl", both, &["different axes"]);
}

#[test]
fn binary_stl_of_any_header_and_length() {
    let folder = Folder::new();
    for header in ["solid NAME\n", "solid", "", "solid facet endsolid", "COLOR=abcd SPACE=RAS"] {
        is_block(&folder.read("a.stl", binary_solid(header, 12)), 1.0, CENTRE);
    }
    is_block(
        &folder.read("a.stl", binary_solid("3D Slicer output. SPACE=LPS", 12)),
        1.0,
        [-20.0, 30.0, 40.0],
    );
    let two = [binary_solid("solid a\n", 12), binary_solid("solid b\n", 12)].concat();
    is_block(&folder.read("a.stl", &two), 2.0, CENTRE);
    // Who writes a stream does not know the number.
    for count in [0, u32::MAX] {
        is_block(&folder.read("a.stl", binary_solid("", count)), 1.0, CENTRE);
    }
    folder.refused("a.stl", binary_solid("solid a\n", 13), &["13 triangles", "734 bytes", "684"]);
    folder.refused("a.stl", &two[..600], &["12 triangles", "600"]);
    folder.refused("a.stl", [0; 40], &["40 bytes"]);
}

/// Bytes behind the last triangle: padding is none, others are told.
#[test]
fn bytes_behind_the_last_element_are_told() {
    let folder = Folder::new();
    let flags = |name: &str, behind: &[u8], bytes: Vec<u8>| {
        let path = folder.write(name, [&bytes, behind].concat());
        let source = open(
            path.to_str().unwrap(),
            &OpenOptions { spacing: Some([0.4, 0.5, 0.6]), ..OpenOptions::default() },
        )
        .unwrap();
        source.flags()
    };
    assert_eq!(flags("a.stl", &[0; 30], binary_solid("", 12)), []);
    for (name, bytes) in [("a.stl", binary_solid("", 12)), ("a.ply", ply("ascii", false).into_bytes())] {
        let found = flags(name, b"0 more bytes\0", bytes);
        assert_eq!(found[0].code, FlagCode::SurplusData);
        assert!(found[0].message.starts_with('1'), "{}", found[0].message);
    }
}

/// A text of PLY: five sides as faces, the sixth as a strip where that is wanted.
fn ply(format: &str, strips: bool) -> String {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment made for a test\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
    );
    let list = "property list uchar int vertex_indices\n";
    let kinds = if strips {
        format!("element face 5\n{list}element tristrips 1\nproperty list int int vertex_indices\n")
    } else {
        format!("element face 6\n{list}")
    };
    let all = faces(0);
    let lines: Vec<&str> = all.lines().collect();
    let sides = if strips {
        // The last side's corners a, b, c, d as a strip: a, b, d, c; in two parts, one of which is empty.
        let [a, b, c, d] = SIDES[5];
        lines[..5].join("\n") + &format!("\n5 {a} {b} {d} {c} -1\n")
    } else {
        all.clone()
    };
    format!("{header}{kinds}end_header\n{}{sides}", places())
}

/// The same in bytes.
fn binary_ply(big: bool) -> Vec<u8> {
    let text = ply(if big { "binary_big_endian" } else { "binary_little_endian" }, true);
    let (header, body) = text.split_once("end_header\n").unwrap();
    let mut bytes = format!("{header}end_header\n").into_bytes();
    let int = |n: &str| n.parse::<i32>().unwrap();
    for line in body.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words.len() {
            3 => bytes.extend(words.iter().flat_map(|w| {
                let value: f64 = w.parse().unwrap();
                if big { value.to_be_bytes() } else { value.to_le_bytes() }
            })),
            n => {
                let of = |v: i32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
                if n == 5 {
                    bytes.push(4);
                } else {
                    bytes.extend(of(5));
                }
                bytes.extend(words[1..].iter().flat_map(|w| of(int(w))));
            }
        }
    }
    bytes
}

#[test]
fn all_faces_of_a_ply() {
    let folder = Folder::new();
    for strips in [false, true] {
        for end in ["\n", "\r\n", "\r"] {
            is_block(&folder.read("a.ply", ply("ascii", strips).replace('\n', end)), 1.0, CENTRE);
        }
    }
    for big in [false, true] {
        is_block(&folder.read("a.ply", binary_ply(big)), 1.0, CENTRE);
        let bytes = binary_ply(big);
        folder.refused("a.ply", &bytes[..bytes.len() - 3], &["PLY"]);
    }
    let text = ply("ascii", false);
    let latin: Vec<u8> =
        text.replace("a test", "M?ller").bytes().map(|b| if b == b'?' { 0xfc } else { b }).collect();
    is_block(&folder.read("a.ply", latin), 1.0, CENTRE);
    let slicer = text.replace("made for a test", "SPACE=LPS");
    is_block(&folder.read("a.ply", slicer), 1.0, [-20.0, 30.0, 40.0]);
    // Elements that say nothing of the surface are passed over; those that may be some of it are not.
    let more = |element: &str, line: &str| text.replace("end_header", &format!("{element}end_header")) + line;
    let edges = "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
    is_block(&folder.read("a.ply", more(edges, "0 1\n2 3\n")), 1.0, CENTRE);
    for element in ["range_grid", "tetrahedron", "quad", "tristrip", "other"] {
        let list = format!("element {element} 1\nproperty list uchar int vertex_indices\n");
        folder.refused("a.ply", more(&list, "3 0 1 2\n"), &[&format!("`{element}`")]);
    }
    for (from, to, word) in [
        ("4 0 2", "4 0 8", "vertex 8, counted from 0, of 8"),
        ("4 0 2", "4 0 -2", "face 0, counted from 0: a face names vertex -2"),
        ("4 0 2", "4 0 x", "`x` is no number"),
        ("format ascii", "format asci", "asci"),
        ("property double x", "property double q", "no x, y and z"),
        ("property double x", "property doubl x", "doubl"),
    ] {
        folder.refused("a.ply", text.replacen(from, to, 1), &[word]);
    }
}

#[test]
fn wavefront_and_geomview() {
    let folder = Folder::new();
    let v = places().lines().map(|line| format!("v {line} 1 0 0\n")).collect::<Vec<_>>().concat();
    let f = |corner: &dyn Fn(usize) -> String| -> String {
        SIDES.map(|side| format!("f {}\n", side.map(corner).join(" "))).concat()
    };
    for corners in [
        f(&|n| (n + 1).to_string()),
        f(&|n| format!("{0}//{0}", n + 1)),
        f(&|n| format!("{}/1", n as i64 - 8)),
    ] {
        is_block(
            &folder.read("a.obj", format!("# a\u{e9}\nmtllib a.mtl\n{v}vn 0 0 1\ns off\n{corners}")),
            1.0,
            CENTRE,
        );
    }
    let joined = format!("# SPACE=LPS\r\n{v}{}", f(&|n| format!("\\\r\n{}", n + 1)));
    is_block(&folder.read("a.obj", joined), 1.0, [-20.0, 30.0, 40.0]);
    let good = v.clone() + &f(&|n| (n + 1).to_string());
    folder.refused("a.obj", good.replacen("f 1 3", "f 0 3", 1), &["line 9", "vertex 0"]);
    folder.refused("a.obj", good.replacen("f 1 3", "f 1 33", 1), &["vertex 32, counted from 0, of 8"]);
    folder.refused("a.obj", good.replacen("f 1 3", "f 1 -9", 1), &["line 9", "vertex -1"]);
    folder.refused("a.obj", good + "surf 0 1 0 1 1 2\n", &["free-form", "surf"]);
    folder.refused("a.obj", b"\x7fELF\0\0\0", &["Wavefront"]);

    let off = |first: &str, behind: &str| {
        let rows = places().lines().map(|line| format!("{line}{behind}\n")).collect::<Vec<_>>().concat();
        format!("{first}# made for a test, \u{e9}\n\n{rows}{}", faces(0).replace('\n', " 255 0 0\n"))
    };
    for (first, behind) in [
        ("OFF\n8 6 0\n", ""),
        ("OFF 8 6 12\n", ""),
        ("8 6 0\n", ""),
        ("COFF\n8 6 0\n", " 1 0 0 1"),
        ("NOFF\n8 6 0\n", " 0 0 1"),
    ] {
        is_block(&folder.read("a.off", off(first, behind)), 1.0, CENTRE);
    }
    folder.refused("a.off", off("4OFF\n8 6 0\n", " 1"), &["4OFF"]);
    folder.refused("a.off", off("OFF BINARY\n8 6 0\n", ""), &["binary"]);
    folder.refused("a.off", off("OFF\n8 7 0\n", ""), &["faces"]);
    folder.refused("a.off", off("OFF\n8 5 0\n", ""), &["behind the last face"]);
    folder.refused("a.off", off("OFF\n4000000000 1 0\n", ""), &["OFF"]);
}

fn vtk(title: &str, cells: &str) -> String {
    format!(
        "# vtk DataFile Version 3.0\n{title}\nASCII\nDATASET POLYDATA\nPOINTS 8 double\n{}{cells}",
        places()
    )
}

#[test]
fn poly_data_of_vtk() {
    let folder = Folder::new();
    let polygons = format!("POLYGONS 6 30\n{}", faces(0));
    is_block(&folder.read("a.vtk", vtk("caf\u{e9}", &polygons)), 1.0, CENTRE);
    is_block(&folder.read("a.vtk", vtk("SPACE=LPS", &polygons)), 1.0, [-20.0, 30.0, 40.0]);
    // As 3D Slicer names the axes in a field, among others.
    let field = |rows: &str| {
        let text = format!("FIELD FieldData 2\nother 2 1 int\n7 8\nSPACE 1 {rows} string\nLPS\n");
        vtk("caf\u{e9}", &polygons).replace("POINTS", &(text + "POINTS"))
    };
    is_block(&folder.read("a.vtk", field("1")), 1.0, [-20.0, 30.0, 40.0]);
    let texts = vtk("a", "FIELD FieldData 1\nSPACE 9 9 string\nLPS\nand a few more\n");
    folder.refused("a.vtk", texts, &["the file ends within a text"]);
    let [a, b, c, d] = SIDES[5];
    let all = faces(0);
    let five: Vec<&str> = all.lines().take(5).collect();
    let five = five.join("\n");
    let strip = format!("POLYGONS 5 25\n{five}\nTRIANGLE_STRIPS 1 5\n4 {a} {b} {d} {c}\n");
    let data = "CELL_DATA 6\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5 6\n";
    is_block(&folder.read("a.vtk", vtk("", &(strip + data))), 1.0, CENTRE);
    folder.refused("a.vtk", vtk("", &polygons.replacen("4 0 2", "4 0 9", 1)), &["vertex 9"]);
    folder.refused("a.vtk", vtk("", &polygons.replacen("6 30", "6 29", 1)), &["VTK"]);
    folder.refused("a.vtk", vtk("", "POLYGONS 2000000000 8000000000\n"), &["2000000000 cells"]);
    let grid = folder.write("grid.vtk", vtk("", "").replace("POLYDATA", "UNSTRUCTURED_GRID"));
    assert!(is_mesh(&grid) && read_mesh(&grid).unwrap_err().to_string().contains("extract its surface"));
    // Images have the same ending.
    assert!(!is_mesh(&folder.write("image.vtk", vtk("", "").replace("POLYDATA", "STRUCTURED_POINTS"))));

    let vtp = |kind: &str, cells: &str| {
        format!(
            "<?xml version=\"1.0\"?><VTKFile type=\"{kind}\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"8\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray></Points>{cells}</Piece></PolyData></VTKFile>",
            places()
        )
    };
    let array = |name: &str, numbers: String| {
        format!("<DataArray type=\"Int32\" Name=\"{name}\" format=\"ascii\">{numbers}</DataArray>")
    };
    let flat: Vec<String> = SIDES[..5].as_flattened().iter().map(ToString::to_string).collect();
    let polys = array("connectivity", flat.join(" ")) + &array("offsets", "4 8 12 16 20".to_owned());
    let strips = array("connectivity", format!("{a} {b} {d} {c}")) + &array("offsets", "4".to_owned());
    let cells = format!("<Polys>{polys}</Polys><Strips>{strips}</Strips>");
    is_block(&folder.read("a.vtp", vtp("PolyData", &cells)), 1.0, CENTRE);
    folder.refused("a.vtp", vtp("ImageData", &cells), &["ImageData"]);
    folder.refused("a.vtp", vtp("PolyData", &cells.replace("12 16 20", "12 16 30")), &["offsets"]);
    folder.refused("a.vtp", vtp("PolyData", &cells.replace("12 16 20", "12 16")), &["offsets"]);
    folder.refused("a.vtp", &vtp("PolyData", &cells)[..400], &["XML"]);
    folder.refused("a.vtp", "<a>".repeat(100_000), &["XML"]);
    folder.refused("a.vtp", "<a/>".repeat(1_000_000), &["XML"]);
}

/// What `map` writes is read again, packed or not: the same volume, at the same place.
#[test]
fn what_is_written_is_read() {
    let folder = Folder::new();
    let shape =
        phantom(Ellipsoid { radii: [9.0, 7.0, 6.0] }, Pose::new([10.0, 20.0, 30.0], CENTRE), [1.0, 1.0, 1.3]);
    let surface = Measurement::default().prepare(shape.labels().unwrap().mask(1)).unwrap().surface();
    let mesh = &surface.mesh;
    for name in ["a.stl", "a.ply", "a.obj", "a.vtp", "a.surf.gii", "a.gii", "a.glb"] {
        let path = folder.0.path().join(name);
        write_mesh(&path, &MeshDocument { mesh, arrays: &[], colors: None, title: "test" }).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let pack = |packed: &mut dyn Write| packed.write_all(&bytes).unwrap();
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        pack(&mut gzip);
        let mut bzip2 = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
        pack(&mut bzip2);
        let packed = gzip.finish().unwrap();
        for read in [
            read_mesh(&path).unwrap(),
            folder.read(&format!("{name}.gz"), &packed),
            folder.read(&format!("{name}.bz2"), bzip2.finish().unwrap()),
        ] {
            assert_eq!(read.triangles.len(), mesh.triangles.len(), "{name}");
            assert!(read.is_closed() && (read.volume() / mesh.volume() - 1.0).abs() < 1e-6, "{name}");
            let (found, expected) = (centre(&read), centre(mesh));
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-4), "{name}: {found:?}");
        }
        let mut damaged = packed.clone();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 4;
        folder.refused(&format!("{name}.gz"), &damaged, &["compressed data are damaged"]);
        assert!(is_mesh(Path::new(&format!("x/{}.GZ", name.to_uppercase()))));
    }
}

#[test]
fn empty_files_and_empty_meshes() {
    let folder = Folder::new();
    for ending in ["stl", "ply", "obj", "off", "vtp", "vtk", "gii", "glb"] {
        folder.refused(&format!("a.{ending}"), "", &["the file is empty (0 bytes)"]);
    }
    let measured = |name: &str, text: String| {
        let path = folder.write(name, text);
        open(path.to_str().unwrap(), &OpenOptions { spacing: Some([1.0; 3]), ..OpenOptions::default() })
            .map(drop)
            .unwrap_err()
            .to_string()
    };
    for (name, text) in [
        ("a.stl", "solid\nendsolid\n".to_owned()),
        ("a.stl", "\0".repeat(84)),
        (
            "a.ply",
            ply("ascii", false).split("element face").next().unwrap().to_owned() + "end_header\n" + &places(),
        ),
        ("a.obj", "# nothing\n".to_owned()),
        ("a.off", "OFF\n0 0 0\n".to_owned()),
        ("a.vtk", vtk("", "")),
        ("a.vtp", "<VTKFile type=\"PolyData\"><PolyData/></VTKFile>".to_owned()),
    ] {
        assert!(measured(name, text).contains("it has no triangles"), "{name}");
    }
}

/// Numbers of one sequence, for damage that is the same at every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end.max(1)
    }
}

/// Damage of every kind at any place: an error in words or a mesh, no panic, no hang, no memory for what is not there.
#[test]
fn damaged_files_of_every_format() {
    let folder = Folder::new();
    let mesh = folder.read("a.stl", binary_solid("", 12));
    let written = |name: &str| {
        let path = folder.0.path().join(name);
        write_mesh(&path, &MeshDocument { mesh: &mesh, arrays: &[], colors: None, title: "test" }).unwrap();
        (name.to_owned(), std::fs::read(&path).unwrap())
    };
    let mut files: Vec<(String, Vec<u8>)> =
        ["a.stl", "a.ply", "a.obj", "a.vtp", "a.surf.gii", "a.glb"].map(written).into();
    files.push(("a.stl".to_owned(), text_solid(" a", "\n").into()));
    files.push(("a.ply".to_owned(), ply("ascii", true).into()));
    files.push(("a.vtk".to_owned(), vtk("a", &format!("POLYGONS 6 30\n{}", faces(0))).into()));
    files.push(("a.off".to_owned(), format!("OFF\n8 6 0\n{}{}", places(), faces(0)).into()));
    let mut dice = Dice(1);
    let start = std::time::Instant::now();
    for (name, whole) in &files {
        for _ in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..=dice.below(3) {
                let at = dice.below(bytes.len());
                match dice.below(6) {
                    0 => bytes.truncate(at),
                    1 => bytes[at..].iter_mut().take(1).for_each(|byte| *byte ^= 1 << (at % 8)),
                    2 => drop(bytes.splice(at..at, *b"4294967295")),
                    3 => drop(bytes.splice(at..at, *b" -1 ")),
                    4 => bytes[at..].iter_mut().take(4).for_each(|byte| *byte = 0xff),
                    _ => {
                        let end = at + dice.below(40).min(bytes.len() - at);
                        drop(bytes.splice(at..end, *b"\n"));
                    }
                }
            }
            let path = folder.write(name, &bytes);
            let source = open(
                path.to_str().unwrap(),
                &OpenOptions { spacing: Some([1.0, 1.5, 2.0]), ..OpenOptions::default() },
            );
            if let Err(error) = source.map(drop) {
                assert!(error.to_string().len() < 600, "{error}");
            }
        }
    }
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}
