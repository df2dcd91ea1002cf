//! Axes that are up to a degree from perpendicular: volume, area and curvature are those in space, as a whole and at vertices.

mod common;

use common::{codes, rms};
use surfometry::Measurement;
use surfometry::local_geometry::Curvature;
use surfometry::measurement::{EmbeddingKind, Measured};
use surfometry::phantoms::{Ellipsoid, Pose, Shape, Torus};
use surfometry::volume::{Affine, FieldImage, FieldValues, Grid, Mask, VolumeError};

/// Axes of a spacing that are sheared by some degrees each way, turned in the world.
fn sheared(degrees: [f64; 3], spacing: [f64; 3], turned: f64) -> Affine {
    let [xy, xz, yz] = degrees.map(|d| d.to_radians().tan());
    let (sin, cos) = turned.to_radians().sin_cos();
    let columns = [[1.0, 0.0, 0.0], [xy, 1.0, 0.0], [xz, yz, 1.0]];
    let world = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    let columns = columns.map(world);
    let length = |c: [f64; 3]| c.iter().map(|v| v * v).sum::<f64>().sqrt();
    let linear =
        std::array::from_fn(|w| std::array::from_fn(|a| columns[a][w] * spacing[a] / length(columns[a])));
    Affine { linear, origin: [0.0; 3] }
}

/// A shape in the middle of such a grid.
struct Posed {
    grid: Grid,
    pose: Pose,
}

impl Posed {
    fn new(affine: Affine, shape: &dyn Shape, turn: [f64; 3]) -> Self {
        let size = 2.0 * shape.half_extent().iter().fold(0.0f64, |a, b| a.max(*b)) + 14.0;
        let dimensions = affine.column_lengths().map(|h| (size / h) as usize);
        let centre = affine.apply(dimensions.map(|n| n as f64 / 2.0));
        let shift = [0.31, 0.17, 0.43];
        let pose = Pose::new(turn, std::array::from_fn(|a| centre[a] + shift[a]));
        Self { grid: Grid::new(dimensions, affine).unwrap(), pose }
    }

    /// Its voxels: those whose centres lie inside, in space.
    fn mask(&self, shape: &dyn Shape) -> Mask {
        let world = |index: [usize; 3]| self.grid.affine().apply(index.map(|v| v as f64));
        Mask::from_predicate(self.grid, |index| shape.value(self.pose.to_shape(world(index))) < 0.0)
    }
}

fn measured(affine: Affine, shape: &dyn Shape, turn: [f64; 3]) -> Measured {
    Measurement::default().run(Posed::new(affine, shape, turn).mask(shape)).unwrap()
}

/// V, A and M with their standard errors.
fn globals(m: &Measured) -> [[f64; 2]; 3] {
    let (values, errors) = (&m.values, &m.standard_error);
    [
        [values.volume_mm3, errors.volume_mm3],
        [values.surface_area_mm2, errors.surface_area_mm2],
        [values.total_mean_curvature_mm, errors.total_mean_curvature_mm],
    ]
    .map(|pair| pair.map(|number| number.expect("a number")))
}

fn exact(shape: &dyn Shape) -> [f64; 3] {
    let truth = shape.truth().unwrap();
    [truth.volume, truth.surface_area, truth.total_mean_curvature]
}

const TURNS: [[f64; 3]; 3] = [[17.0, 31.0, 12.0], [63.0, -22.0, 40.0], [0.0, 0.0, 45.0]];

/// Sheared by 0.1 to 1 degree, along one pair of axes and all three, cubic and thick voxels: V, A and M of an ellipsoid are
/// within two standard errors.
#[test]
fn ellipsoids_keep_their_numbers() {
    let shape = Ellipsoid { radii: [18.0, 10.0, 7.0] };
    let exact = exact(&shape);
    let (mut worst, mut count) = ([0.0f64; 3], 0);
    for degrees in [[0.0, 0.0, 0.1], [0.0, 0.0, 0.5], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.9, -0.9, 0.9]] {
        for spacing in [[0.8; 3], [0.7, 0.7, 1.2]] {
            for (n, turn) in TURNS.into_iter().enumerate() {
                let found = measured(sheared(degrees, spacing, 20.0 * n as f64), &shape, turn);
                assert!(codes(&found).contains(&"sheared-grid".into()), "{degrees:?}");
                let numbers = globals(&found);
                let z = [0, 1, 2].map(|i| (numbers[i][0] - exact[i]) / numbers[i][1]);
                println!("{degrees:?} {spacing:?} {turn:?}: z of V, A, M {z:+.2?}");
                (0..3).for_each(|i| worst[i] = worst[i].max(z[i].abs()));
                count += usize::from(z.iter().all(|z| z.abs() < 2.0));
            }
        }
    }
    assert!(count >= 28, "{count} of 30, worst {worst:?}");
    assert!(worst.iter().all(|z| *z < 3.0), "{worst:?}");
}

/// A long body along the direction in which lengths are most wrong: by perpendicular axes its A is half a percent off.
#[test]
fn areas_and_curvature_are_those_in_space() {
    let affine = sheared([0.9, 0.9, 0.9], [0.5, 0.5, 0.65], 25.0);
    let perpendicular = sheared([0.0; 3], Grid::new([4; 3], affine).unwrap().spacing().mm(), 25.0);
    // Along the sum of the three axes, which is the diagonal that the strain makes longest.
    let along: [f64; 3] =
        std::array::from_fn(|w| (0..3).map(|a| affine.linear[w][a] / affine.column_lengths()[a]).sum());
    let elevation = along[2].atan2(along[0].hypot(along[1])).to_degrees();
    let turn = [0.0, -elevation, along[1].atan2(along[0]).to_degrees()];
    let shape = Ellipsoid { radii: [30.0, 6.0, 6.0] };
    let truth = exact(&shape);
    let posed = Posed::new(affine, &shape, turn);
    let found = globals(&Measurement::default().run(posed.mask(&shape)).unwrap());
    let error = [0, 1, 2].map(|i| 100.0 * (found[i][0] / truth[i] - 1.0));
    let told = [0, 1, 2].map(|i| 100.0 * found[i][1] / truth[i]);
    println!("V, A, M off by {error:+.3?} %, standard errors {told:.3?} %");
    assert!(error[1].abs() < 0.2 && error[2].abs() < 0.2, "{error:?}");
    // The same voxels as if their axes were perpendicular.
    let straight = Grid::new(posed.grid.dimensions(), perpendicular).unwrap();
    let voxels = posed.mask(&shape);
    let taken = Mask::from_predicate(straight, |index| voxels.get(index.map(|i| i as i64)));
    let taken = globals(&Measurement::default().run(taken).unwrap());
    println!("A by perpendicular axes {:+.3} %", 100.0 * (taken[1][0] / truth[1] - 1.0));
    assert!((taken[1][0] / truth[1] - 1.0).abs() > 0.004, "{taken:?} {truth:?}");
}

/// A ring's numbers, and the topology of its blurred surface by Gauss and Bonnet.
#[test]
fn a_torus_keeps_its_numbers() {
    let shape = Torus { major: 14.0, minor: 5.5 };
    let truth = exact(&shape);
    for degrees in [[0.9, -0.9, 0.9], [1.0, 0.0, 0.0]] {
        let found = measured(sheared(degrees, [0.8, 0.8, 1.1], 40.0), &shape, TURNS[1]);
        let numbers = globals(&found);
        let z = [0, 1, 2].map(|i| (numbers[i][0] - truth[i]) / numbers[i][1]);
        println!("{degrees:?}: z of V, A, M {z:+.2?}, chi {:?}", found.blurred.euler_characteristic);
        assert!(z.iter().all(|z| z.abs() < 2.5), "{z:?}");
        assert!(found.blurred.euler_characteristic.unwrap().abs() < 0.02, "{:?}", found.blurred);
    }
}

/// Of a ball's quadratic field differences are exact, so H, K, normals and places are those of the ball to the last digits.
#[test]
fn vertices_of_an_exact_field_are_exact() {
    let (radius, affine) = (9.0, sheared([0.9, -0.9, 0.9], [0.8, 0.9, 1.3], 30.0));
    for mirrored in [1.0, -1.0] {
        let linear = affine.linear.map(|[x, y, z]| [mirrored * x, y, z]);
        let grid = Grid::new([30, 28, 22], Affine { linear, ..affine }).unwrap();
        let centre = grid.affine().apply([14.3, 13.2, 10.6]);
        let from = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|a| p[a] - centre[a]) };
        let square = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
        let phi = |offset| {
            let place = grid.affine().apply(grid.index_of(offset).map(|i| i as f64));
            (square(from(place)) - radius * radius) / (2.0 * radius)
        };
        let values = FieldValues::F64((0..grid.voxel_count()).map(phi).collect());
        let field = FieldImage::new(grid, values).unwrap();
        let surface = Measurement::default().prepare_field(field).unwrap().surface();
        assert!(surface.vertices.len() > 1000);
        for (vertex, place) in surface.vertices.iter().zip(&surface.mesh.vertices) {
            let outward = from(*place);
            // A vertex lies where its grid edge crosses 0 by linear interpolation, and so a little inside.
            let distance = square(outward).sqrt();
            assert!((distance - radius).abs() < 0.06, "{distance}");
            let along: f64 = (0..3).map(|a| vertex.normal[a] * outward[a] / distance).sum();
            assert!((along - 1.0).abs() < 1e-12, "{along}");
            assert!((vertex.curvature.mean_curvature * distance - 1.0).abs() < 1e-10);
            assert!((vertex.curvature.gaussian_curvature * distance * distance - 1.0).abs() < 1e-10);
            let across: f64 = (0..3).map(|a| vertex.direction_1[a] * outward[a]).sum();
            assert!(across.abs() < 1e-10);
        }
    }
}

/// The local curvature of a mask, in an embedding that leaves no shift: as right as on a grid that is not sheared.
#[test]
fn vertices_of_a_mask_are_as_right_as_ever() {
    let shape = Ellipsoid { radii: [16.0, 11.0, 8.0] };
    let errors = [[0.0; 3], [0.9, -0.9, 0.9]].map(|degrees| {
        let posed = Posed::new(sheared(degrees, [0.7, 0.7, 0.9], 25.0), &shape, TURNS[0]);
        let mask = posed.mask(&shape);
        let local = Measurement::default().embedding(EmbeddingKind::Corrected).sigma_mm(2.2);
        let surface = local.prepare(mask).unwrap().surface();
        let of = |(vertex, place): (&surfometry::surface::VertexGeometry, &[f64; 3])| {
            let truth = Curvature::of(&shape.jet(posed.pose.to_shape(*place))).unwrap();
            vertex.curvature.mean_curvature / truth.mean_curvature - 1.0
        };
        100.0 * rms(surface.vertices.iter().zip(&surface.mesh.vertices).map(of))
    });
    println!("H off by {errors:.3?} % in rms, not sheared and sheared");
    assert!(errors[1] < 1.1 * errors[0], "{errors:?}");
}

/// A voxel's volume is the determinant, to the last digits; up to rounding perpendicular axes are taken as they are stated.
#[test]
fn volume_is_the_determinant() {
    let affine = sheared([0.9, -0.9, 0.9], [0.7, 0.8, 1.2], 30.0);
    let grid = Grid::new([10; 3], affine).unwrap();
    assert!((grid.spacing().cell_volume() / affine.determinant().abs() - 1.0).abs() < 1e-14);
    let stated = affine.column_lengths().iter().product::<f64>();
    assert!(stated / grid.spacing().cell_volume() > 1.0002);
    let rounded = sheared([0.05, 0.0, 0.05], [0.7, 0.8, 1.2], 30.0);
    assert_eq!(Grid::new([10; 3], rounded).unwrap().spacing().mm(), rounded.column_lengths());
    let beyond = Grid::new([10; 3], sheared([0.0, 1.1, 0.0], [1.0; 3], 0.0));
    assert!(matches!(beyond, Err(VolumeError::Sheared { first: 0, second: 2, .. })));
}
