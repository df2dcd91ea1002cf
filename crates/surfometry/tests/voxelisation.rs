//! Closed meshes as voxels, against the shapes that they were made of and against another tool's voxels.

mod common;

use common::{phantom, poses};
use surfometry::Measurement;
use surfometry::io::{MeshDocument, read_mesh, write_mesh};
use surfometry::phantoms::{Ellipsoid, Pose, Torus};
use surfometry::surface::Mesh;
use surfometry::volume::{Mask, Spacing};
use surfometry::voxelisation::{VoxeliseError, VoxelisedMesh};

fn voxels(mesh: &Mesh, spacing: [f64; 3]) -> Mask {
    let voxelised = VoxelisedMesh::new(mesh, Spacing::new(spacing).unwrap()).unwrap();
    voxelised.labels().unwrap().mask(1)
}

/// A box with corners at given places, two triangles a side.
fn cuboid(lower: [f64; 3], upper: [f64; 3]) -> Mesh {
    let vertices =
        (0..8).map(|n| std::array::from_fn(|a| if n >> a & 1 == 1 { upper[a] } else { lower[a] })).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { vertices, triangles }
}

/// A mesh as wide and high as this has 10^10 rows of voxels, each to be looked for in each triangle.
#[test]
fn more_rows_than_can_be_looked_at_are_refused() {
    let mesh = cuboid([0.0; 3], [3.0, 1e5, 1e5]);
    let refused = VoxelisedMesh::new(&mesh, Spacing::new([1.0; 3]).unwrap()).unwrap_err();
    assert!(matches!(refused, VoxeliseError::TooLarge { .. }), "{refused}");
    // Coarser, it is what it is: 100 x 100 rows and a voxel.
    assert_eq!(voxels(&mesh, [3.0, 1e3, 1e3]).voxels(), 10_000);
}

/// Faces, edges and corners that pass exactly through voxel centres: each centre on the lower side is in,
/// each on the upper out, or the other way, but none twice or not at all.
#[test]
fn faces_through_centres() {
    let mesh = cuboid([1.0, 2.0, 3.0], [5.0, 8.0, 6.0]);
    assert!(mesh.volume() > 0.0 && mesh.is_closed());
    let mask = voxels(&mesh, [1.0; 3]);
    assert_eq!(mask.voxels(), 4 * 6 * 3);
    let extent = mask.bounds().extent();
    assert_eq!(extent, [4, 6, 3]);
    // Inside out, and in two halves that share a wall.
    let turned =
        Mesh { triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..mesh.clone() };
    assert_eq!(voxels(&turned, [1.0; 3]).voxels(), 72);
    let mut halves = cuboid([1.0, 2.0, 3.0], [3.0, 8.0, 6.0]);
    let other = cuboid([3.0, 2.0, 3.0], [5.0, 8.0, 6.0]);
    halves.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + 8)));
    halves.vertices.extend(other.vertices);
    assert_eq!(voxels(&halves, [1.0; 3]).voxels(), 72);
    // Overlapping parts are in once, a cavity is out.
    let mut hollow = cuboid([0.0; 3], [10.0; 3]);
    let inner = cuboid([3.0; 3], [7.0; 3]);
    hollow.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [a + 8, c + 8, b + 8]));
    hollow.vertices.extend(inner.vertices);
    assert_eq!(voxels(&hollow, [1.0; 3]).voxels(), 1000 - 64);
}

/// The fine mesh of a torus in any pose, on cubic and unequal spacings: nearly the voxels of the shape
/// itself, whose surface the mesh is within a hundredth of a voxel of, and V and A of the original object
/// within what the grid allows.
#[test]
fn voxels_of_a_mesh_are_those_of_its_shape() {
    for pose in poses() {
        let fine = phantom(Torus { major: 26.0, minor: 12.0 }, pose, [0.5; 3]);
        let mesh = Measurement::default()
            .sigma_mm(1.0)
            .prepare(fine.labels().unwrap().mask(1))
            .unwrap()
            .surface()
            .mesh;
        for spacing in [[1.0; 3], [0.8, 1.0, 1.4]] {
            let mask = voxels(&mesh, spacing);
            let measured = Measurement::default().run(&mask).unwrap();
            let c = &measured.values;
            // The mesh's own integrals are the truth here; M has none that simple.
            let within = |value: Option<f64>, exact: f64, percent: f64| {
                let off = 100.0 * (value.unwrap() / exact - 1.0);
                println!("{spacing:?} {off:+.3} %");
                assert!(off.abs() < percent, "{spacing:?} {off} %");
            };
            within(c.volume_mm3, mesh.volume(), 0.15);
            within(c.surface_area_mm2, mesh.area(), 0.25);
            assert_eq!(measured.topology.euler_characteristic_mesh, Some(0));
            assert!(
                (mask.voxels() as f64 * spacing.iter().product::<f64>() / mesh.volume() - 1.0).abs() < 2e-3
            );
        }
    }
}

/// The world's origin and axes are the mesh's: the voxels' centroid is its own.
#[test]
fn voxels_stand_where_the_mesh_does() {
    let mesh = cuboid([100.2, -50.3, 7.1], [110.2, -44.3, 12.1]);
    let measured = Measurement::default().run(voxels(&mesh, [0.5, 0.4, 0.3])).unwrap();
    let centroid = measured.voxels.centroid_mm;
    for (found, exact) in centroid.iter().zip([105.2, -47.3, 9.6]) {
        assert!((found - exact).abs() < 0.25, "{centroid:?}");
    }
}

#[test]
fn meshes_without_an_inside() {
    let spacing = Spacing::new([1.0; 3]).unwrap();
    let mut open = cuboid([1.0; 3], [5.0; 3]);
    open.triangles.pop();
    let error = VoxelisedMesh::new(&open, spacing).unwrap_err();
    assert!(matches!(error, VoxeliseError::Open { edges: 3, .. }), "{error}");
    assert_eq!(VoxelisedMesh::new(&Mesh::default(), spacing).unwrap_err(), VoxeliseError::Empty);
    let mut far = cuboid([1.0; 3], [5.0; 3]);
    far.vertices[3][1] = f64::NAN;
    assert_eq!(VoxelisedMesh::new(&far, spacing).unwrap_err(), VoxeliseError::NotFinite(3));
    let fine = Spacing::new([1e-6; 3]).unwrap();
    assert!(matches!(
        VoxelisedMesh::new(&cuboid([1.0; 3], [5.0; 3]), fine),
        Err(VoxeliseError::TooLarge { .. })
    ));
}

/// What was written is read: STL loses shared vertices and finds them again.
#[test]
fn files_of_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let shape =
        phantom(Ellipsoid { radii: [9.0, 7.0, 6.0] }, Pose::new([10.0, 20.0, 30.0], [0.0; 3]), [1.0; 3]);
    let surface = Measurement::default().prepare(shape.labels().unwrap().mask(1)).unwrap().surface();
    for name in ["a.stl", "a.ply"] {
        let path = folder.path().join(name);
        let document = MeshDocument { mesh: &surface.mesh, arrays: &[], colors: None, title: "test" };
        write_mesh(&path, &document).unwrap();
        let read = read_mesh(&path).unwrap();
        assert_eq!(read.triangles.len(), surface.mesh.triangles.len());
        assert!(read.is_closed() && (read.volume() / surface.mesh.volume() - 1.0).abs() < 1e-6);
        assert_eq!(
            voxels(&read, [0.7, 0.8, 0.9]).voxels() / 10,
            voxels(&surface.mesh, [0.7, 0.8, 0.9]).voxels() / 10
        );
    }
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let path = folder.path().join("text.stl");
    std::fs::write(&path, text).unwrap();
    assert_eq!(read_mesh(&path).unwrap().triangles, [[0, 1, 2]]);
    for (name, bytes) in [("bad.stl", &b"solid\nfacet nonsense"[..]), ("bad.ply", b"ply\nnonsense")] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let error = read_mesh(&path).unwrap_err().to_string();
        assert!(error.contains("export the mesh again"), "{error}");
    }
}

/// A ball of triangles of equal size, which do not share vertices: each has corners of its own.
fn loose_ball() -> Mesh {
    let shape =
        phantom(Ellipsoid { radii: [9.0, 7.0, 6.0] }, Pose::new([10.0, 20.0, 30.0], [0.0; 3]), [1.0; 3]);
    let mesh = Measurement::default().prepare(shape.labels().unwrap().mask(1)).unwrap().surface().mesh;
    let vertices: Vec<[f64; 3]> = mesh.triangles.iter().flat_map(|&t| mesh.corners(t)).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    Mesh { vertices, triangles }
}

fn refusal(mesh: &Mesh, spacing: [f64; 3]) -> VoxeliseError {
    VoxelisedMesh::new(mesh, Spacing::new(spacing).unwrap()).unwrap_err()
}

/// Vertices that programs rounded apart are one, up to 1/100 of the least spacing; what is further apart is a gap, which
/// is said. The voxels are those of the whole mesh.
#[test]
fn vertices_that_are_rounded_apart() {
    let spacing = [0.9, 0.7, 1.1];
    let whole = loose_ball();
    let expected = voxels(&whole, spacing).voxels();
    // Each corner is moved to another side, the same every time.
    let moved = |by: f64| {
        let shifted =
            |(n, v): (usize, &[f64; 3])| [0, 1, 2].map(|a| v[a] + by * [-1.0, 0.0, 1.0][(n * 7 + a * 5) % 3]);
        Mesh { vertices: whole.vertices.iter().enumerate().map(shifted).collect(), ..whole.clone() }
    };
    for by in [1e-15, 1e-7, 1e-4] {
        let found = voxels(&moved(by), spacing).voxels();
        assert!(found.abs_diff(expected) <= 1 + expected / 1000, "{by}: {found} for {expected}");
    }
    let apart = refusal(&moved(0.02), spacing);
    assert!(matches!(apart, VoxeliseError::Open { .. }), "{apart}");
    assert!(apart.to_string().contains("merge vertices that are close"), "{apart}");
}

/// Why a mesh has no inside is told apart: holes, faces turned round, walls inside.
#[test]
fn what_keeps_a_mesh_from_having_an_inside() {
    let block = cuboid([1.0, 2.0, 3.0], [9.0, 8.0, 9.0]);
    let mut turned = block.clone();
    turned.triangles[5].swap(0, 1);
    let error = refusal(&turned, [1.0; 3]);
    assert!(matches!(error, VoxeliseError::Turned { edges: 3, .. }), "{error}");
    assert!(error.to_string().contains("orient them alike"), "{error}");
    // Of a half that is turned the edges around it show.
    let mut half = block.clone();
    half.triangles.iter_mut().take(2).for_each(|t| t.swap(0, 1));
    assert!(matches!(refusal(&half, [1.0; 3]), VoxeliseError::Turned { edges: 4, .. }));
    let mut wall = block.clone();
    wall.triangles.push(wall.triangles[0]);
    assert!(matches!(refusal(&wall, [1.0; 3]), VoxeliseError::Branched { edges: 3, .. }));
    // A hole is named before what else is wrong.
    turned.triangles.remove(0);
    assert!(matches!(refusal(&turned, [1.0; 3]), VoxeliseError::Open { .. }));
    let missing = Mesh { vertices: block.vertices[..7].to_vec(), ..block };
    assert_eq!(refusal(&missing, [1.0; 3]), VoxeliseError::NoSuchVertex { number: 7, count: 7 });
}

/// Vertices that no triangle names neither size the lattice nor are asked whether they are finite.
#[test]
fn only_vertices_of_triangles_count() {
    let block = cuboid([1.0, 2.0, 3.0], [9.0, 8.0, 9.0]);
    let expected = voxels(&block, [1.0, 0.8, 0.7]);
    let mut more = block;
    more.vertices.extend([[1e7, -1e7, 1e300], [f64::NAN; 3]]);
    let found = VoxelisedMesh::new(&more, Spacing::new([1.0, 0.8, 0.7]).unwrap()).unwrap();
    assert_eq!(found.grid().dimensions(), expected.grid().dimensions());
    assert_eq!(found.labels().unwrap().mask(1).voxels(), expected.voxels());
}

/// Meshes in metres and micrometres are told by their size, also where a voxel's centre happens to be inside; and so is
/// a plate that lies between centres.
#[test]
fn meshes_in_other_units() {
    let scaled = |by: f64, shift: f64| {
        let ball = loose_ball();
        Mesh { vertices: ball.vertices.iter().map(|v| v.map(|c| c * by + shift)).collect(), ..ball }
    };
    for shift in [0.0, 0.25] {
        let metres = refusal(&scaled(1e-3, shift), [0.5; 3]);
        assert!(matches!(metres, VoxeliseError::TooSmall { .. }), "{metres}");
        assert!(metres.to_string().contains("in metres, scale them by 1000"), "{metres}");
    }
    let micrometres = refusal(&scaled(1e3, 0.0), [0.5; 3]);
    assert!(micrometres.to_string().contains("in micrometres, scale them by 0.001"), "{micrometres}");
    let plate = refusal(&cuboid([0.3, 0.3, 0.3], [9.0, 9.0, 0.6]), [1.0; 3]);
    assert!(
        matches!(plate, VoxeliseError::NoVoxel { volume, .. } if (volume - 22.707).abs() < 1e-9),
        "{plate}"
    );
}
