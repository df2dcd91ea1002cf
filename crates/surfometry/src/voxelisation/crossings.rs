//! Where rows of voxels pass through triangles.

use robust::{Coord, orient2d};

/// A point at which a row along x passes through a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Index along x, between voxels.
    pub(super) x: f64,
    /// 1 into the object, -1 out of it, for triangles that face outward.
    pub(super) winding: i32,
}

/// Hands on the crossings of a triangle, whose corners are in units of voxels, with the rows that pass
/// through it, by their y and z.
///
/// A row belongs to exactly one of the triangles around an edge or a corner: predicates are exact (Shewchuk
/// 1997), and where a row meets an edge it counts as moved by an infinitesimal step along y and a smaller one
/// along z (simulation of simplicity, Edelsbrunner and Mücke 1990). So closed meshes have closed crossings.
pub(super) fn crossings_of(corners: [[f64; 3]; 3], mut found: impl FnMut([i64; 2], Crossing)) {
    let range = |axis: usize| {
        let (low, high) = least_and_largest(corners.map(|c| c[axis]));
        (low.ceil() as i64, high.floor() as i64)
    };
    let ((y_first, y_last), (z_first, z_last)) = (range(1), range(2));
    for z in z_first..=z_last {
        // Of a sliver that lies oblique, a few of the box's rows.
        let (low, high) = span_at(corners, z as f64);
        for y in y_first.max(low)..=y_last.min(high) {
            let row = [y as f64, z as f64];
            let sides = [(0, 1), (1, 2), (2, 0)].map(|(from, to)| side(corners[from], corners[to], row));
            if sides[0] == sides[1] && sides[1] == sides[2] {
                // A row that sees the triangle's corners turn counter-clockwise in y and z has its normal
                // ahead: it leaves.
                found([y, z], Crossing { x: height(corners, row), winding: -sides[0] });
            }
        }
    }
}

/// Between which rows a slice may pass through a triangle, one more on both sides.
fn span_at(corners: [[f64; 3]; 3], z: f64) -> (i64, i64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (corners[from], corners[to])) {
        let share = (z - from[2]) / (to[2] - from[2]);
        // Along the slice, or beside it.
        let ends = if share.is_finite() { [share.clamp(0.0, 1.0); 2] } else { [0.0, 1.0] };
        for y in ends.map(|share| from[1] + share * (to[1] - from[1])) {
            (low, high) = (low.min(y), high.max(y));
        }
    }
    (low.floor() as i64 - 1, high.ceil() as i64 + 1)
}

/// On which side of an edge, seen in y and z, a row is; never on it.
fn side(from: [f64; 3], to: [f64; 3], [y, z]: [f64; 2]) -> i32 {
    let flat = |corner: [f64; 3]| Coord { x: corner[1], y: corner[2] };
    // Of both triangles at an edge the same arithmetic, to the last bit.
    let (low, high, sign) =
        if (from[1], from[2], from[0]) <= (to[1], to[2], to[0]) { (from, to, 1) } else { (to, from, -1) };
    let turn = orient2d(flat(low), flat(high), Coord { x: y, y: z });
    let turn = if turn == 0.0 {
        // Moving the row by (e, e^2) changes the determinant by dy e^2 - dz e.
        let (dy, dz) = (high[1] - low[1], high[2] - low[2]);
        if dz == 0.0 { dy } else { -dz }
    } else {
        turn
    };
    if turn > 0.0 {
        sign
    } else if turn < 0.0 {
        -sign
    } else {
        // An edge along x is a point here: any side, the same for both triangles.
        sign
    }
}

/// x of the triangle's plane at a row, within the triangle's own range.
fn height(corners: [[f64; 3]; 3], [y, z]: [f64; 2]) -> f64 {
    let [a, b, c] = corners;
    let (u, v) = ([b[1] - a[1], b[2] - a[2]], [c[1] - a[1], c[2] - a[2]]);
    let (p, area) = ([y - a[1], z - a[2]], u[0] * v[1] - u[1] * v[0]);
    let (low, high) = least_and_largest(corners.map(|corner| corner[0]));
    if area == 0.0 {
        return 0.5 * (low + high);
    }
    let of_b = (p[0] * v[1] - p[1] * v[0]) / area;
    let of_c = (u[0] * p[1] - u[1] * p[0]) / area;
    (a[0] + of_b * (b[0] - a[0]) + of_c * (c[0] - a[0])).clamp(low, high)
}

fn least_and_largest(values: [f64; 3]) -> (f64, f64) {
    (
        values.iter().copied().fold(f64::INFINITY, f64::min),
        values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    )
}
