//! The mesh of phi = 0: a closed manifold whose Euler characteristic is exactly that of the trilinear
//! interpolant.

use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rand_like::Numbers;
use surfometry::surface::{Mesh, SurfaceSummary, extract};
use surfometry::volume::{Affine, FieldImage, FieldValues, Grid};

/// Numbers from proptest's generator: the tests need no other.
mod rand_like {
    use super::{Config, RngAlgorithm, TestRng, TestRunner};
    use proptest::prelude::*;
    use proptest::strategy::ValueTree;

    pub(super) struct Numbers(TestRunner);

    impl Numbers {
        pub(super) fn new() -> Self {
            Self(TestRunner::new_with_rng(
                Config::default(),
                TestRng::deterministic_rng(RngAlgorithm::ChaCha),
            ))
        }

        pub(super) fn up_to_one(&mut self) -> f64 {
            (-1.0..1.0f64).new_tree(&mut self.0).expect("a number").current()
        }
    }
}

/// A field of random values inside a border of ones.
fn random_field(n: [usize; 3], next: &mut impl FnMut() -> f64) -> FieldImage {
    let grid = Grid::axis_aligned(n, [1.0, 0.7, 1.3]).unwrap();
    let border = |i: usize| grid.index_of(i).iter().zip(n).any(|(&x, n)| x == 0 || x == n - 1);
    let values = (0..grid.voxel_count()).map(|i| if border(i) { 1.0 } else { next() as f32 });
    FieldImage::new(grid, FieldValues::F32(values.collect())).unwrap()
}

fn value(field: &FieldImage, [x, y, z]: [usize; 3]) -> f64 {
    let [nx, ny, _] = field.grid().dimensions();
    field.values().get((z * ny + y) * nx + x)
}

/// Euler number of the part of a square where the bilinear interpolant is <= 0: its pieces, which have no
/// holes. Values in turn round the square; `zero` is a corner whose value is 0 up to rounding, `touching`
/// says that the saddle is.
fn pieces_of_square(v: [f64; 4], zero: Option<usize>, touching: bool) -> i64 {
    let inside: [bool; 4] = std::array::from_fn(|i| v[i] < 0.0 || zero == Some(i));
    let count = inside.iter().filter(|&&i| i).count();
    let diagonal = inside[0] == inside[2] && inside[1] == inside[3] && count == 2;
    let (own, other) = if inside[0] { (v[0] * v[2], v[1] * v[3]) } else { (v[1] * v[3], v[0] * v[2]) };
    match count {
        0 => 0,
        2 if diagonal && !touching && own <= other => 2,
        _ => 1,
    }
}

/// Euler number of the part of a cell where the trilinear interpolant is <= 0.
///
/// The cell is swept by slices of constant x. Between events (a corner's value or the saddle's passes 0) all
/// slices look alike, and an open interval of them counts -chi(slice); the slices at the events count
/// chi(slice). This uses neither loops nor tubes, and sweeps another axis than the code under test.
fn euler_of_cell(field: &FieldImage, [x, y, z]: [usize; 3]) -> i64 {
    let corner = |i: usize, j: usize, k: usize| value(field, [x + i, y + j, z + k]);
    let round = [(0, 0), (1, 0), (1, 1), (0, 1)];
    let start = round.map(|(j, k)| corner(0, j, k));
    let rise: [f64; 4] = std::array::from_fn(|i| corner(1, round[i].0, round[i].1) - start[i]);
    let at = |s: f64| -> [f64; 4] { std::array::from_fn(|i| start[i] + s * rise[i]) };
    let mut events: Vec<(f64, Option<usize>, bool)> = vec![(0.0, None, false), (1.0, None, false)];
    events.extend((0..4).map(|i| (-start[i] / rise[i], Some(i), false)));
    let a = rise[0] * rise[2] - rise[1] * rise[3];
    let b = start[0] * rise[2] + rise[0] * start[2] - start[1] * rise[3] - rise[1] * start[3];
    let c = start[0] * start[2] - start[1] * start[3];
    let root = (b * b - 4.0 * a * c).sqrt();
    events.extend([(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)].map(|s| (s, None, true)));
    events.retain(|e| (0.0..=1.0).contains(&e.0));
    events.sort_by(|p, q| p.0.total_cmp(&q.0));
    let slices: i64 = events.iter().map(|&(s, zero, touching)| pieces_of_square(at(s), zero, touching)).sum();
    let between = |pair: &[(f64, Option<usize>, bool)]| {
        pieces_of_square(at(f64::midpoint(pair[0].0, pair[1].0)), None, false)
    };
    slices - events.windows(2).map(between).sum::<i64>()
}

/// chi of the surface: twice the solid's, which is a sum over cells, faces, edges and vertices with signs + -
/// + -.
fn exact_euler(field: &FieldImage) -> i64 {
    let n = field.grid().dimensions();
    let mut chi = 0;
    for i in 0..field.grid().voxel_count() {
        let p = field.grid().index_of(i);
        let fits = |axes: &[usize]| axes.iter().all(|&a| p[a] + 1 < n[a]);
        let moved = |axes: &[usize]| {
            let mut q = p;
            for &a in axes {
                q[a] += 1;
            }
            value(field, q)
        };
        chi -= i64::from(moved(&[]) < 0.0);
        for a in 0..3 {
            let b = (a + 1) % 3;
            if fits(&[a]) {
                chi += i64::from(moved(&[]) < 0.0 || moved(&[a]) < 0.0);
            }
            if fits(&[a, b]) {
                chi -= pieces_of_square([moved(&[]), moved(&[a]), moved(&[a, b]), moved(&[b])], None, false);
            }
        }
        if fits(&[0, 1, 2]) {
            chi += euler_of_cell(field, p);
        }
    }
    2 * chi
}

fn check(field: &FieldImage) -> Mesh {
    let mesh = extract(&field, field.grid());
    assert!(mesh.is_closed(), "not a closed, oriented manifold");
    assert_eq!(mesh.euler_characteristic(), exact_euler(field), "{:?}", field.values());
    let summary = SurfaceSummary::of(&field, field.grid());
    assert_eq!(summary.euler_characteristic(), mesh.euler_characteristic());
    assert_eq!(
        (summary.vertices, summary.triangles),
        (mesh.vertices.len() as u64, mesh.triangles.len() as u64)
    );
    mesh
}

#[test]
fn ten_thousand_random_fields() {
    let mut numbers = Numbers::new();
    let (mut chis, mut vertices) = (std::collections::BTreeMap::<i64, u32>::new(), 0);
    for _ in 0..10_000 {
        let field = random_field([6, 7, 6], &mut || numbers.up_to_one());
        let mesh = check(&field);
        *chis.entry(mesh.euler_characteristic()).or_default() += 1;
        vertices += mesh.vertices.len();
    }
    println!("{vertices} vertices; chi: {chis:?}");
    assert!(chis.len() > 10, "the fields are too alike");
}

/// Values of very different size make saddles, and so tubes inside cells, frequent.
#[test]
fn fields_with_long_tails() {
    let mut numbers = Numbers::new();
    for _ in 0..2_000 {
        check(&random_field([6, 6, 6], &mut || {
            let v = numbers.up_to_one();
            v.signum() * 10f64.powf(2.0 * numbers.up_to_one())
        }));
    }
}

/// Tiles end at multiples of 64: a field that spans several in every direction has no seams.
#[test]
fn no_seams_between_tiles() {
    let mut numbers = Numbers::new();
    for n in [[131, 6, 6], [6, 130, 7], [7, 6, 129], [67, 66, 68]] {
        check(&random_field(n, &mut || numbers.up_to_one()));
    }
}

/// Chernyaev's case 4: two opposite corners of a cell inside. Where they are deep, a tube joins them.
#[test]
fn opposite_corners_are_joined_through_a_cell() {
    for (depth, pieces) in [(0.5, 2), (10.0, 1)] {
        let deep = [[3, 3, 3], [4, 4, 4]];
        let mut at = 0;
        let field = random_field([8; 3], &mut || {
            let inner = [at % 6 + 1, at / 6 % 6 + 1, at / 36 + 1];
            at += 1;
            if deep.contains(&inner) { -depth } else { 1.0 }
        });
        assert_eq!(check(&field).euler_characteristic(), 2 * pieces, "depth {depth}");
    }
}

/// A voxel that is exactly 0 is outside, and the vertices on its edges do not coincide. (Those inside cells
/// may, where a cell's values are symmetric and two sheets touch in its middle.)
#[test]
fn zeros_at_voxels_leave_a_manifold() {
    let mut numbers = Numbers::new();
    for _ in 0..500 {
        let field = random_field([6; 3], &mut || (3.0 * numbers.up_to_one()).trunc());
        let mesh = extract(&&field, field.grid());
        assert!(mesh.is_closed());
        let spacing = field.grid().spacing().mm();
        let off_grid = |i: f64| (i - i.round()).abs() > 1e-9;
        let on_edge = |v: &&[f64; 3]| (0..3).filter(|&a| off_grid(v[a] / spacing[a])).count() <= 1;
        let on_edges: Vec<_> = mesh.vertices.iter().filter(on_edge).map(|v| v.map(f64::to_bits)).collect();
        let different: std::collections::HashSet<_> = on_edges.iter().collect();
        assert!(2 * on_edges.len() > mesh.vertices.len());
        assert_eq!(different.len(), on_edges.len());
    }
}

/// Outward in the world whatever the affine, and the enclosed volume is the same.
#[test]
fn outward_also_where_the_affine_mirrors() {
    let ball = |affine: Affine| {
        let grid = Grid::new([30; 3], affine).unwrap();
        let radius =
            |i: usize| grid.index_of(i).iter().map(|&x| (x as f64 - 14.3).powi(2)).sum::<f64>().sqrt();
        let values = (0..grid.voxel_count()).map(|i| radius(i) - 10.0);
        extract(&&FieldImage::new(grid, FieldValues::F64(values.collect())).unwrap(), &grid)
    };
    let straight = ball(Affine::diagonal([0.5; 3]));
    let mirrored = ball(Affine {
        linear: [[-0.3, 0.4, 0.0], [0.4, 0.3, 0.0], [0.0, 0.0, 0.5]],
        origin: [70.0, -20.0, 5.0],
    });
    for mesh in [&straight, &mirrored] {
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 125.0;
        assert!((mesh.volume() / exact - 1.0).abs() < 0.01 && mesh.volume() < exact);
        assert!(mesh.is_closed() && mesh.euler_characteristic() == 2);
    }
    assert!((straight.volume() / mirrored.volume() - 1.0).abs() < 1e-9);
}

/// A field that ends is left open there, and counted as such.
#[test]
fn open_where_a_field_ends() {
    let grid = Grid::axis_aligned([20; 3], [1.0; 3]).unwrap();
    let values = (0..grid.voxel_count()).map(|i| grid.index_of(i)[0] as f64 - 9.6).collect();
    let field = FieldImage::new(grid, FieldValues::F64(values)).unwrap();
    let (mesh, summary) = (extract(&&field, &grid), SurfaceSummary::of(&&field, &grid));
    assert!(!mesh.is_closed());
    assert_eq!(mesh.euler_characteristic(), 1);
    assert_eq!((summary.euler_characteristic(), summary.volume), (1, None));
    assert!((summary.area - 361.0).abs() < 1e-9);
}
