//! Weights of local configurations (Lindblad 2005).

use super::{Prepared, ReferenceMethod, ReferenceValues};
use crate::local_geometry::solved;
use crate::space::{dot, half_sphere};
use crate::volume::{Mask, Spacing};
use rayon::prelude::*;

/// A from the 2 x 2 x 2 neighbourhoods: each has a weight, such that planes in random directions are measured
/// without bias and with the least variance.
///
/// Planes leave one weight open (on cubic voxels -1, 0, 1, 0, 2 may be added to those of one corner, an edge,
/// three corners, a face, a corner with its neighbours, without any effect on them); Lindblad chose for small
/// balls. His 0.636, 0.669, 0.554, 0.927, 0.421 come out on cubic voxels; for other spacings, what is open
/// stays as near to them as it can. A neighbourhood that no plane shows, as in narrow places, counts as the
/// pieces that its smaller phase has. Right on the mean over orientations, to 1.4 % for one (2.7 % where
/// spacings differ by 2); nothing is said of curvature.
#[derive(Debug, Clone, Copy)]
pub struct Lindblad;

impl ReferenceMethod for Lindblad {
    fn name(&self) -> &'static str {
        "lindblad"
    }

    fn measure(&self, mask: &Mask) -> ReferenceValues {
        self.prepared(mask.grid().spacing())(mask)
    }

    fn prepared(&self, spacing: Spacing) -> Prepared<'_> {
        let weights = weights(spacing.mm());
        Box::new(move |mask| {
            let counts = counts(mask);
            ReferenceValues {
                volume_mm3: Some(mask.voxels() as f64 * spacing.cell_volume()),
                surface_area_mm2: Some(counts.iter().zip(weights).map(|(&count, w)| count as f64 * w).sum()),
                ..ReferenceValues::default()
            }
        })
    }
}

/// How often each neighbourhood occurs.
fn counts(mask: &Mask) -> [u64; 256] {
    let rows: Vec<(i64, i64)> = mask.bounds().grown([1; 3]).rows().collect();
    rows.par_iter().map(|&(y, z)| row_counts(mask, y, z)).reduce(
        || [0u64; 256],
        |mut sum, row| {
            sum.iter_mut().zip(row).for_each(|(sum, count)| *sum += count);
            sum
        },
    )
}

/// How often each neighbourhood occurs whose first corner lies in a row; bit n of its number is the corner at
/// x + (n & 1), y + (n >> 1 & 1), z + (n >> 2).
fn row_counts(mask: &Mask, y: i64, z: i64) -> [u64; 256] {
    let mut counts = [0; 256];
    let (from, to) = (mask.bounds().lower[0] - 1, mask.bounds().upper[0]);
    let side = |x: i64| -> usize {
        let corners = [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]];
        corners.iter().enumerate().map(|(n, &[y, z])| usize::from(mask.get([x, y, z])) << (2 * n)).sum()
    };
    let mut left = side(from);
    for x in from..to {
        let right = side(x + 1);
        counts[left | right << 1] += 1;
        left = right;
    }
    counts
}

/// Planes that weights are fitted to.
const DIRECTIONS: usize = 4000;

/// How much it counts, against a plane, that a weight is the published one: only where planes leave it open.
const OPEN: f64 = 1e-6;

/// Lindblad's weight of a neighbourhood that planes show, on cubic voxels of 1 mm.
fn published(configuration: usize) -> f64 {
    let corners = configuration.count_ones();
    match corners.min(8 - corners) {
        1 => 0.636,
        2 => 0.669,
        3 => 0.554,
        _ if FACES.contains(&configuration) => 0.927,
        _ => 0.421,
    }
}

/// Neighbourhoods that are half full up to a plane between the voxels.
const FACES: [usize; 6] = [0x0f, 0xf0, 0x33, 0xcc, 0x55, 0xaa];

/// The weight of each of the 256 neighbourhoods, mm^2.
fn weights(h: [f64; 3]) -> [f64; 256] {
    let classes = classes();
    let mut shown: Vec<usize> = Vec::new();
    let planes: Vec<Vec<(usize, f64)>> =
        half_sphere(DIRECTIONS).map(|normal| frequencies(normal, h)).collect();
    let mut chosen: Vec<f64> = Vec::new();
    for &(configuration, _) in planes.iter().flatten() {
        let class = classes[configuration];
        if !shown.contains(&class) {
            shown.push(class);
            chosen.push(published(configuration) * h.iter().product::<f64>().powf(2.0 / 3.0));
        }
    }
    let place = |configuration: usize| shown.iter().position(|&c| c == classes[configuration]);
    // Least squares of area - 1 over directions with a mean of 0, by Lagrange's multiplier: the last row and
    // column.
    let size = shown.len();
    let mut system = vec![vec![0.0; size + 2]; size + 1];
    for plane in &planes {
        let mut seen = vec![0.0; size];
        for &(configuration, frequency) in plane {
            seen[place(configuration).expect("it was collected from here")] += frequency;
        }
        for a in 0..size {
            for b in 0..size {
                system[a][b] += seen[a] * seen[b];
            }
            system[a][size] += seen[a];
            system[size][a] += seen[a];
            system[a][size + 1] += seen[a];
        }
    }
    system[size][size + 1] = planes.len() as f64;
    for (n, weight) in chosen.iter().enumerate() {
        system[n][n] += OPEN;
        system[n][size + 1] += OPEN * weight;
    }
    let fitted: Vec<f64> = solved(system).into_iter().map(|row| row[0]).collect();
    let of_shown = |configuration: usize| place(configuration).map(|n| fitted[n]);
    std::array::from_fn(|configuration| match configuration {
        0 | 255 => 0.0,
        _ => of_shown(configuration).unwrap_or_else(|| {
            pieces(configuration).into_iter().map(|piece| of_shown(piece).unwrap_or(fitted[0])).sum()
        }),
    })
}

/// The neighbourhoods that a plane shows, and how many of each to its area: a plane at any depth between two
/// corners shows the same one, and there are as many cells to a slab as their volume tells.
fn frequencies(normal: [f64; 3], h: [f64; 3]) -> Vec<(usize, f64)> {
    let corner = |n: usize| [n & 1, n >> 1 & 1, n >> 2].map(|i| i as f64);
    let depth = |n: usize| dot(normal, std::array::from_fn(|a| h[a] * corner(n)[a]));
    let mut order: Vec<(f64, usize)> = (0..8).map(|n| (depth(n), n)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut inside = 0;
    let cell = h.iter().product::<f64>();
    let pairs = order.windows(2);
    pairs
        .map(|pair| {
            inside |= 1 << pair[0].1;
            (inside, (pair[1].0 - pair[0].0) / cell)
        })
        .collect()
}

/// The least of a neighbourhood's numbers under reflections and exchange of phases: those have one weight,
/// whatever the spacing.
fn classes() -> [usize; 256] {
    std::array::from_fn(|configuration| {
        let reflected = |mirror: usize| -> usize {
            (0..8).filter(|n| configuration >> (n ^ mirror) & 1 == 1).map(|n| 1 << n).sum()
        };
        let all = (0..8).flat_map(|mirror| [reflected(mirror), 255 - reflected(mirror)]);
        all.min().unwrap_or(configuration)
    })
}

/// The face-connected pieces of a neighbourhood's smaller phase, each as a neighbourhood of its own; one that
/// stays whole is cut into its corners.
fn pieces(configuration: usize) -> Vec<usize> {
    let small = if configuration.count_ones() > 4 { 255 - configuration } else { configuration };
    let mut rest = small;
    let mut pieces = Vec::new();
    while rest != 0 {
        let mut piece = rest & rest.wrapping_neg();
        loop {
            let grown = (0..8)
                .filter(|n| piece >> n & 1 == 1)
                .fold(piece, |grown, n| grown | (1 << (n ^ 1) | 1 << (n ^ 2) | 1 << (n ^ 4)) & rest);
            if grown == piece {
                break;
            }
            piece = grown;
        }
        rest &= !piece;
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lindblad (2005) of the five neighbourhoods that planes show, in the order 1, 2, 3, 4 in a face, 4
    /// around a corner.
    #[test]
    fn of_cubic_voxels() {
        let weights = weights([1.0; 3]);
        for (configuration, published) in [(1, 0.636), (3, 0.669), (7, 0.554), (15, 0.927), (23, 0.421)] {
            assert!(
                (weights[configuration] - published).abs() < 2e-3,
                "{configuration}: {}",
                weights[configuration]
            );
        }
        // Apart: two corners, and a corner beside three.
        assert!((weights[0b1000_0001] - 2.0 * weights[1]).abs() < 1e-12);
        assert!((weights[0b1000_0111] - weights[7] - weights[1]).abs() < 1e-12);
    }

    /// Without bias over the directions, at any spacing, and closer than the faces' 50 %.
    #[test]
    fn planes_of_any_direction() {
        for h in [[1.0; 3], [0.7, 0.7, 1.4]] {
            let weights = weights(h);
            let areas: Vec<f64> = half_sphere(DIRECTIONS)
                .map(|normal| frequencies(normal, h).into_iter().map(|(c, f)| weights[c] * f).sum())
                .collect();
            let mean = areas.iter().sum::<f64>() / areas.len() as f64;
            let spread = (areas.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / areas.len() as f64).sqrt();
            assert!((mean - 1.0).abs() < 1e-9, "{mean}");
            println!("{h:?}: {spread}");
            assert!(spread < 0.04, "{spread}");
        }
    }
}
