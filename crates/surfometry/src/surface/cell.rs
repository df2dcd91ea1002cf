//! The loops in which a level set crosses the faces of one cell.
//!
//! A cell is the cube between eight voxel centres. Corner c lies at x = c & 1, y = c >> 1 & 1, z = c >> 2; a
//! set bit of a configuration is a corner inside (phi < 0). Edge 4 a + u + 2 v runs along axis a; u and v are
//! its places on axes (a + 1) mod 3 and (a + 2) mod 3. Face 2 a + s is across axis a, on side s.

/// Places along x, y, z of the corner that an edge starts from.
pub(crate) const fn edge_base(edge: u8) -> [usize; 3] {
    let (a, u, v) = (edge as usize / 4, edge as usize & 1, edge as usize >> 1 & 1);
    let mut base = [0; 3];
    base[(a + 1) % 3] = u;
    base[(a + 2) % 3] = v;
    base
}

/// [`edge_base`] of all edges.
pub(crate) const EDGE_BASES: [[usize; 3]; 12] = {
    let mut bases = [[0; 3]; 12];
    let mut edge = 0;
    while edge < 12 {
        bases[edge] = edge_base(edge as u8);
        edge += 1;
    }
    bases
};

/// The two corners of an edge.
pub(crate) const fn edge_corners(edge: u8) -> [usize; 2] {
    let [x, y, z] = edge_base(edge);
    let first = x | y << 1 | z << 2;
    [first, first | 1 << (edge / 4)]
}

/// Corners of a face, counter-clockwise as seen from outside the cell.
pub(crate) const fn face_corners(face: usize) -> [usize; 4] {
    let (a, side) = (face / 2, face % 2);
    let (b, c) = (1 << ((a + 1) % 3), 1 << ((a + 2) % 3));
    let base = side << a;
    if side == 1 {
        [base, base | b, base | b | c, base | c]
    } else {
        [base, base | c, base | b | c, base | b]
    }
}

/// The edge between two corners that share one.
const fn edge_between(p: usize, q: usize) -> u8 {
    let a = (p ^ q).trailing_zeros() as usize;
    let base = p & q;
    let (u, v) = (base >> ((a + 1) % 3) & 1, base >> ((a + 2) % 3) & 1);
    (4 * a + u + 2 * v) as u8
}

/// Whether the corners of a face are inside and outside in turn, so that two ways of crossing it are
/// possible.
pub(crate) fn is_ambiguous(configuration: u8, face: usize) -> bool {
    let [a, b, c, d] = face_corners(face).map(|corner| configuration >> corner & 1);
    a == c && b == d && a != b
}

/// Closed loops of edge numbers.
///
/// Each loop is the boundary of a piece of the surface, counter-clockwise as seen from outside the object.
/// `joined(face)` says of an ambiguous face whether its two inside corners are connected across it.
pub(crate) fn loops(configuration: u8, joined: impl Fn(usize) -> bool) -> Vec<Vec<u8>> {
    let mut next = successors(configuration, joined);
    let mut loops = Vec::new();
    for start in 0..12u8 {
        let (mut edges, mut edge) = (Vec::new(), start);
        while let Some(following) = next[edge as usize].take() {
            edges.push(edge);
            edge = following;
        }
        if !edges.is_empty() {
            loops.push(edges);
        }
    }
    loops
}

/// For each edge that the surface crosses, the one that follows it in its loop.
///
/// Seen from outside the cell, a segment on a face has the inside to its right: walking round the face
/// counter-clockwise, it starts where the walk enters the object and ends where it leaves it.
fn successors(configuration: u8, joined: impl Fn(usize) -> bool) -> [Option<u8>; 12] {
    let mut next = [None; 12];
    for face in 0..6 {
        let corners = face_corners(face);
        let inside = |i: usize| configuration >> corners[i % 4] & 1 == 1;
        let edge = |i: usize| edge_between(corners[i % 4], corners[(i + 1) % 4]);
        let leaves = |i: usize| inside(i) && !inside(i + 1);
        // Around the inside corner that was entered, or, if those are joined, around the outside corner that
        // was left.
        let backward = is_ambiguous(configuration, face) && joined(face);
        for entered in (0..4).filter(|&i| !inside(i) && inside(i + 1)) {
            let mut steps = (1..4).map(|step| if backward { entered + 4 - step } else { entered + step });
            next[edge(entered) as usize] = steps.find(|&i| leaves(i)).map(edge);
        }
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_faces_fit_together() {
        for edge in 0..12 {
            let [p, q] = edge_corners(edge);
            assert_eq!((edge_between(p, q), edge_between(q, p)), (edge, edge));
        }
        // Every edge is passed once each way by the walks round the faces.
        let mut passed = vec![];
        for face in 0..6 {
            let c = face_corners(face);
            passed.extend((0..4).map(|i| (c[i], c[(i + 1) % 4])));
        }
        passed.sort_unstable();
        passed.dedup();
        assert_eq!(passed.len(), 24);
    }

    #[test]
    fn every_crossed_edge_is_in_one_loop_whatever_the_faces_say() {
        for configuration in 0..=255u8 {
            for decisions in 0..64u8 {
                let loops = loops(configuration, |face| decisions >> face & 1 == 1);
                let mut edges: Vec<u8> = loops.concat();
                edges.sort_unstable();
                let crossed = |&e: &u8| {
                    let [p, q] = edge_corners(e);
                    (configuration >> p ^ configuration >> q) & 1 == 1
                };
                assert_eq!(edges, (0..12).filter(crossed).collect::<Vec<_>>());
                assert!(loops.iter().all(|l| l.len() >= 3));
            }
        }
    }

    #[test]
    fn loops_turn_counter_clockwise_seen_from_outside() {
        // The lower half inside: a loop in the plane between, counter-clockwise seen from above.
        let ring = &loops(0b0000_1111, |_| false)[0];
        let at = |edge: u8| edge_base(edge).map(|v| v as f64 - 0.5);
        let area: f64 = (0..4)
            .map(|i| (at(ring[i]), at(ring[(i + 1) % 4])))
            .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
            .sum();
        assert!(area > 0.0);
    }
}
