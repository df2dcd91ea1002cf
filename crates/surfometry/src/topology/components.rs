//! Connected components of a mask and of its background, by runs.

use super::DisjointSets;
use crate::volume::Mask;

/// What is counted and when two voxels are neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Connectivity {
    /// Inside voxels that share a face, an edge or a corner.
    Foreground26,
    /// Outside voxels that share a face; everything beyond the bounding box is one of the components.
    Background6,
}

/// A run of equal voxels in a row: half-open in x.
type Run = (i64, i64);

/// Number of connected components. Memory is proportional to the number of runs, not of voxels.
pub fn count_components(mask: &Mask, connectivity: Connectivity) -> u64 {
    let region = mask.bounds().grown([1; 3]);
    if region.is_empty() {
        return u64::from(connectivity == Connectivity::Background6);
    }
    let (y0, y1, z0, z1) = (region.lower[1], region.upper[1], region.lower[2], region.upper[2]);
    let row_runs = |y, z| match connectivity {
        Connectivity::Foreground26 => mask.runs(y, z).collect::<Vec<_>>(),
        Connectivity::Background6 => gaps(mask.runs(y, z), region.lower[0], region.upper[0]),
    };
    // 26: runs of neighbouring rows also touch where they end one voxel apart; 6: only rows that share a face.
    let (slack, earlier): (i64, &[(i64, i64)]) = match connectivity {
        Connectivity::Foreground26 => (1, &[(-1, 0), (-1, -1), (0, -1), (1, -1)]),
        Connectivity::Background6 => (0, &[(-1, 0), (0, -1)]),
    };
    let mut sets = DisjointSets::default();
    // Runs of the previous and of this slice, row by row, each with the number of its first run.
    let mut previous: Vec<(usize, Vec<Run>)> = Vec::new();
    for z in z0..z1 {
        let mut current: Vec<(usize, Vec<Run>)> = Vec::with_capacity((y1 - y0) as usize);
        for y in y0..y1 {
            let runs = row_runs(y, z);
            let first = sets.add(runs.len());
            for (dy, dz) in earlier {
                let rows = if *dz == 0 { &current } else { &previous };
                if let Some((other_first, other)) =
                    usize::try_from(y + dy - y0).ok().and_then(|r| rows.get(r))
                {
                    join_touching(&mut sets, (first, &runs), (*other_first, other), slack);
                }
            }
            current.push((first, runs));
        }
        previous = current;
    }
    sets.count()
}

/// What lies between runs on x0..x1.
fn gaps(runs: impl Iterator<Item = Run>, x0: i64, x1: i64) -> Vec<Run> {
    let mut gaps = Vec::new();
    let mut start = x0;
    for (a, b) in runs {
        if start < a {
            gaps.push((start, a));
        }
        start = b;
    }
    if start < x1 {
        gaps.push((start, x1));
    }
    gaps
}

fn join_touching(
    sets: &mut DisjointSets,
    (first, runs): (usize, &[Run]),
    (other_first, other): (usize, &[Run]),
    slack: i64,
) {
    let (mut i, mut j) = (0, 0);
    while i < runs.len() && j < other.len() {
        if runs[i].0 < other[j].1 + slack && other[j].0 < runs[i].1 + slack {
            sets.join(first + i, other_first + j);
        }
        if runs[i].1 < other[j].1 { i += 1 } else { j += 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;
    use proptest::prelude::*;

    /// Flood fill on a padded array: slow and plain.
    fn flood(n: [usize; 3], on: &[bool], connectivity: Connectivity) -> u64 {
        let [nx, ny, nz] = n.map(|v| v as i64 + 2);
        let inside = |p: [i64; 3]| {
            (0..3).all(|a| p[a] > 0 && p[a] <= n[a] as i64)
                && on[((p[2] as usize - 1) * n[1] + p[1] as usize - 1) * n[0] + p[0] as usize - 1]
        };
        let wanted = |p: [i64; 3]| inside(p) == (connectivity == Connectivity::Foreground26);
        let mut seen = std::collections::HashSet::new();
        let mut count = 0;
        for start in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]) {
            if !wanted(start) || !seen.insert(start) {
                continue;
            }
            count += 1;
            let mut stack = vec![start];
            while let Some(p) = stack.pop() {
                for d in (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]) {
                    let steps: i64 = d.iter().map(|v: &i64| v.abs()).sum();
                    let q = [p[0] + d[0], p[1] + d[1], p[2] + d[2]];
                    let in_box = (0..3).all(|a| q[a] >= 0 && q[a] < [nx, ny, nz][a]);
                    let neighbour = connectivity == Connectivity::Foreground26 || steps == 1;
                    if in_box && neighbour && wanted(q) && seen.insert(q) {
                        stack.push(q);
                    }
                }
            }
        }
        count
    }

    proptest! {
        #[test]
        fn agrees_with_flood_fill(on in prop::collection::vec(prop::bool::weighted(0.35), 7 * 5 * 4)) {
            let n = [7, 5, 4];
            let grid = Grid::axis_aligned(n, [1.0; 3]).unwrap();
            let mask = Mask::from_predicate(grid, |[x, y, z]| on[(z * n[1] + y) * n[0] + x]);
            prop_assume!(!mask.is_empty());
            for connectivity in [Connectivity::Foreground26, Connectivity::Background6] {
                prop_assert_eq!(count_components(&mask, connectivity), flood(n, &on, connectivity));
            }
        }
    }
}
