//! The deepest violations, spread over the boundary.

use super::Listed;
use super::boundary::Boundary;
use std::collections::BTreeMap;

/// Edge of the boxes, in sigma, of which each gives one voxel a side at a time.
const EDGE: f64 = 0.5;

/// Boxes of the grid.
#[derive(Debug)]
pub(super) struct Spread {
    /// In voxels.
    edges: [i32; 3],
}

impl Spread {
    pub(super) fn new(sigma: f64, spacing: [f64; 3]) -> Self {
        Self { edges: spacing.map(|h| ((EDGE * sigma / h).round() as i32).max(1)) }
    }

    /// Of the voxels that are on the wrong side and that `entry` has something for, the deepest of each box
    /// and side; the first of equals, so that the choice depends on nothing else.
    pub(super) fn deepest(
        &self,
        boundary: &Boundary,
        entry: impl Fn(usize) -> Option<Listed>,
    ) -> Vec<Listed> {
        let mut best: BTreeMap<([i32; 3], bool), (f64, Listed)> = BTreeMap::new();
        for number in boundary.wrong() {
            let Some(listed) = entry(number) else { continue };
            let place = boundary.voxels().place(number);
            let key = (std::array::from_fn(|a| place[a].div_euclid(self.edges[a])), boundary.inside(number));
            let depth = boundary.depth(number);
            let known = best.entry(key).or_insert((depth, listed));
            if depth > known.0 {
                *known = (depth, listed);
            }
        }
        best.into_values().map(|(_, listed)| listed).collect()
    }
}
