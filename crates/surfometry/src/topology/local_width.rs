//! How wide an object, or a gap in it, is at a voxel.

use super::Connectivity;
use crate::tiling::IndexBox;
use crate::volume::{Mask, Spacing};

/// The largest width at a voxel and its neighbours on the same side: a core that is one voxel wide runs
/// beside the middle as often as in it.
pub(super) fn width_around(mask: &Mask, voxel: [i64; 3]) -> f64 {
    let alike = Connectivity::Foreground26.neighbours(voxel).filter(|&v| mask.get(v) == mask.get(voxel));
    alike.map(|neighbour| width_at(mask, neighbour)).fold(width_at(mask, voxel), f64::max)
}

/// Width of the part that a voxel is the middle of, mm: twice the distance to the nearest voxel on the other
/// side, less a voxel.
fn width_at(mask: &Mask, [x, y, z]: [i64; 3]) -> f64 {
    let spacing = mask.grid().spacing();
    let side = mask.get([x, y, z]);
    let mut nearest = f64::INFINITY;
    let reach =
        mask.bounds().hull(&IndexBox::voxel([x, y, z])).extent().into_iter().max().unwrap_or(0) as i64;
    for steps in 0..=reach {
        // No row that is so many steps away is nearer.
        if nearest <= (2 * steps - 1) as f64 * spacing.smallest() {
            break;
        }
        for (dy, dz) in rows_around(steps) {
            let found = mask.nearest_in_row([x, y + dy, z + dz], !side).map(|dx| [dx, dy, dz]);
            if let Some(steps) = found.filter(|&steps| least_width(spacing, steps) <= nearest) {
                nearest = nearest.min(width_towards(spacing, steps));
            }
        }
    }
    nearest
}

/// The (y, z) of the rows that are so many steps from one, along y, z or both.
fn rows_around(steps: i64) -> impl Iterator<Item = (i64, i64)> {
    (-steps..=steps).flat_map(move |dz| {
        let stride = if dz.abs() == steps { 1 } else { 2 * steps as usize };
        (-steps..=steps).step_by(stride).map(move |dy| (dy, dz))
    })
}

/// A little less than the least that [`width_towards`] may be, in a tenth of its time.
fn least_width(spacing: Spacing, steps: [i64; 3]) -> f64 {
    let squared: f64 = (0..3).map(|a| (steps[a] as f64 * spacing.mm()[a]).powi(2)).sum();
    (2.0 - 1e-9) * squared.sqrt() - spacing.largest()
}

/// Twice the distance of voxels' centres that are so many steps apart, less the spacing in that direction.
fn width_towards(spacing: Spacing, steps: [i64; 3]) -> f64 {
    let norm = |along: [f64; 3]| libm::hypot(libm::hypot(along[0], along[1]), along[2]);
    let offset: [f64; 3] = std::array::from_fn(|a| steps[a] as f64 * spacing.mm()[a]);
    let distance = norm(offset);
    2.0 * distance - norm(std::array::from_fn(|a| offset[a] / distance * spacing.mm()[a]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;
    use proptest::prelude::*;

    proptest! {
        /// The nearest voxel on the other side is that of all in the image and around it.
        #[test]
        fn agrees_with_looking_everywhere(
            n in prop::array::uniform3(1usize..9),
            x_stretch in 1usize..20,
            mm in prop::array::uniform3(0.3..3.0f64),
            share in 0.0..1.0f64,
            chance in prop::collection::vec(0.0..1.0f64, 9 * 9 * 180),
            voxel in prop::array::uniform3(-3i64..12),
        ) {
            let n = [n[0] * x_stretch, n[1], n[2]];
            let grid = Grid::axis_aligned(n, mm).unwrap();
            let mask = Mask::from_predicate(grid, |[x, y, z]| chance[(z * n[1] + y) * n[0] + x] < share);
            prop_assume!(!mask.is_empty());
            let side = mask.get(voxel);
            let all = mask.bounds().hull(&IndexBox::voxel(voxel)).grown([1; 3]);
            let voxels = all.rows().flat_map(|(y, z)| (all.lower[0]..all.upper[0]).map(move |x| [x, y, z]));
            let apart = |v: [i64; 3]| width_towards(grid.spacing(), std::array::from_fn(|a| v[a] - voxel[a]));
            let nearest = voxels.filter(|&v| mask.get(v) != side).map(apart).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(width_at(&mask, voxel), nearest);
        }
    }
}
