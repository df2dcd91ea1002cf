//! What the trilinear interpolant does inside a cell that its corners leave open.
//!
//! Pieces of one sign that lie apart on the cell's faces may be connected through its interior. The surface
//! between them is then a tube and not a disc at each (the tunnels of Chernyaev's cases 4, 6, 7, 10, 12 and
//! 13).

use super::cell::{edge_corners, face_corners, is_ambiguous};
use crate::tiling::DisjointSets;

/// Whether the two inside corners of an ambiguous face are connected across it: the sign of the bilinear
/// interpolant's saddle (the asymptotic decider of Nielson and Hamann, 1991).
///
/// Products commute, so both cells at the face get the same answer; of f32 values they are exact.
pub(crate) fn joined_across(values: &[f64; 8], face: usize) -> bool {
    let [a, b, c, d] = face_corners(face).map(|corner| values[corner]);
    inside_is_joined([a, b, c, d])
}

/// The same for four values in turn round a square, inside and outside alternately.
pub(crate) fn inside_is_joined([a, b, c, d]: [f64; 4]) -> bool {
    if a < 0.0 { a * c > b * d } else { b * d > a * c }
}

/// Pairs of loops (by number) between which the surface is a tube.
pub(crate) fn tunnels(configuration: u8, values: &[f64; 8], loops: &[Vec<u8>]) -> Vec<[usize; 2]> {
    if loops.len() < 2 {
        return Vec::new();
    }
    let (on_faces, inside) = (regions_on_faces(configuration, values), regions_inside(values));
    // Each loop has a region of the cell's surface on its inner and on its outer side.
    let sides: Vec<[usize; 2]> = loops
        .iter()
        .map(|l| edge_corners(l[0]))
        .map(|[p, q]| if configuration >> p & 1 == 1 { [p, q] } else { [q, p] })
        .collect();
    let mut pairs = Vec::new();
    for (first, a) in sides.iter().enumerate() {
        for (second, b) in sides.iter().enumerate().skip(first + 1) {
            let bridge = |near: usize, far: usize| {
                on_faces[a[near]] == on_faces[b[near]]
                    && on_faces[a[far]] != on_faces[b[far]]
                    && inside[a[far]] == inside[b[far]]
            };
            // Of a trilinear interpolant a cell has one tube at most; ties (a saddle at exactly 0) could seem
            // to give a loop two of them.
            let free = !pairs.iter().any(|pair: &[usize; 2]| pair.contains(&first) || pair.contains(&second));
            if free && (bridge(0, 1) || bridge(1, 0)) {
                pairs.push([first, second]);
            }
        }
    }
    pairs
}

/// For each corner, what stands for all that is connected with it within one sign over the cell's edges and
/// faces.
fn regions_on_faces(configuration: u8, values: &[f64; 8]) -> [usize; 8] {
    let mut regions = DisjointSets::default();
    regions.add(8);
    for edge in 0..12 {
        let [p, q] = edge_corners(edge);
        if configuration >> p & 1 == configuration >> q & 1 {
            regions.join(p, q);
        }
    }
    for face in (0..6).filter(|&face| is_ambiguous(configuration, face)) {
        let [a, b, c, d] = face_corners(face);
        let inside_first = configuration >> a & 1 == 1;
        if joined_across(values, face) == inside_first {
            regions.join(a, c);
        } else {
            regions.join(b, d);
        }
    }
    std::array::from_fn(|corner| regions.root(corner))
}

/// The same through the cell's interior.
///
/// On a slice of constant z the interpolant is bilinear, so every piece of one sign holds a corner of the
/// slice, and how the corners are connected changes only where one of them or the saddle's numerator (a
/// quadratic in z) passes 0. Between those heights one slice stands for all, and neighbouring slices are
/// connected along the four vertical edges.
fn regions_inside(values: &[f64; 8]) -> [usize; 8] {
    let heights = slice_heights(values);
    let slices: Vec<[f64; 4]> = heights.iter().map(|&z| slice(values, z)).collect();
    let node = |level: usize, corner: usize| 8 + 4 * level + corner;
    let mut regions = DisjointSets::default();
    regions.add(8 + 4 * slices.len());
    for (level, square) in slices.iter().enumerate() {
        let inside = square.map(|v| v < 0.0);
        for corner in 0..4 {
            let following = (corner + 1) % 4;
            if inside[corner] == inside[following] {
                regions.join(node(level, corner), node(level, following));
            }
            if level > 0 && inside[corner] == (slices[level - 1][corner] < 0.0) {
                regions.join(node(level, corner), node(level - 1, corner));
            }
        }
        if inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1] {
            let first = usize::from(inside_is_joined(*square) != inside[0]);
            regions.join(node(level, first), node(level, first + 2));
        }
    }
    // Round a slice the corners come as 0, 1, 3, 2.
    for (corner, place) in [0, 1, 3, 2].into_iter().enumerate() {
        regions.join(corner, node(0, place));
        regions.join(corner + 4, node(slices.len() - 1, place));
    }
    std::array::from_fn(|corner| regions.root(corner))
}

/// Values round the square at height z, in turn.
fn slice(values: &[f64; 8], z: f64) -> [f64; 4] {
    [0, 1, 3, 2].map(|corner| values[corner] * (1.0 - z) + values[corner + 4] * z)
}

/// A height in each interval between the events of [`regions_inside`].
fn slice_heights(values: &[f64; 8]) -> Vec<f64> {
    let mut events = vec![0.0, 1.0];
    let lower = [0, 1, 3, 2].map(|corner| values[corner]);
    let rise = [0, 1, 3, 2].map(|corner| values[corner + 4] - values[corner]);
    events.extend((0..4).map(|i| -lower[i] / rise[i]));
    let product = |f: &[f64; 4], g: &[f64; 4]| f[0] * g[2] - f[1] * g[3];
    let linear = product(&lower, &rise) + product(&rise, &lower);
    events.extend(quadratic_roots(product(&rise, &rise), linear, product(&lower, &lower)));
    events.retain(|z| (0.0..=1.0).contains(z));
    events.sort_unstable_by(f64::total_cmp);
    events.dedup();
    events.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect()
}

/// Real roots of a z^2 + b z + c, or something that is not finite for one that is missing.
fn quadratic_roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    // Adding two numbers of the same sign, so that nothing cancels.
    let q = -0.5 * (b + libm::sqrt(b * b - 4.0 * a * c).copysign(b));
    [q / a, c / q]
}
