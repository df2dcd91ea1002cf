//! Where a field on a plane of voxels is zero.

use crate::surface::inside_is_joined;

/// Segments along which values (u fastest, `size` of them) pass 0, both ends in voxels from the first one's
/// centre.
///
/// Linear along the sides of the squares between voxels; where corners are inside and outside in turn, the
/// sign in the middle decides (the bilinear saddle's), so that this is the trace of the surface's mesh in the
/// plane.
pub(super) fn contour(values: &[f32], [nu, nv]: [usize; 2]) -> Vec<[[f64; 2]; 2]> {
    let mut segments = Vec::new();
    for v in 0..nv.saturating_sub(1) {
        for u in 0..nu.saturating_sub(1) {
            let corners = [[u, v], [u + 1, v], [u + 1, v + 1], [u, v + 1]];
            let at = corners.map(|[u, v]| f64::from(values[v * nu + u]));
            let crossings: Vec<[f64; 2]> = (0..4)
                .filter(|&i| (at[i] < 0.0) != (at[(i + 1) % 4] < 0.0))
                .map(|i| crossing(corners[i], corners[(i + 1) % 4], at[i] / (at[i] - at[(i + 1) % 4])))
                .collect();
            match crossings[..] {
                [a, b] => segments.push([a, b]),
                [a, b, c, d] => {
                    // The inside corners are connected where the saddle is inside; the other two are then cut
                    // off.
                    let first_connected = inside_is_joined(at) == (at[0] < 0.0);
                    segments.extend(if first_connected { [[a, b], [c, d]] } else { [[d, a], [b, c]] });
                }
                _ => {}
            }
        }
    }
    segments
}

fn crossing(from: [usize; 2], to: [usize; 2], share: f64) -> [f64; 2] {
    std::array::from_fn(|i| from[i] as f64 + share * (to[i] as f64 - from[i] as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_closes_at_its_radius() {
        let size = [40, 30];
        let distance = |u: f64, v: f64| (u - 19.3).hypot(v - 14.6);
        let values: Vec<f32> = (0..size[0] * size[1])
            .map(|i| (distance((i % size[0]) as f64, (i / size[0]) as f64) - 9.0) as f32)
            .collect();
        let segments = contour(&values, size);
        let mut ends = std::collections::HashMap::new();
        for end in segments.iter().flatten() {
            assert!((distance(end[0], end[1]) - 9.0).abs() < 0.02);
            *ends.entry(end.map(f64::to_bits)).or_insert(0) += 1;
        }
        assert!(ends.values().all(|&n| n == 2));
        let length: f64 = segments.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert!((length / (18.0 * std::f64::consts::PI) - 1.0).abs() < 3e-3);
    }

    #[test]
    fn opposite_corners_are_connected_through_an_inside_saddle() {
        let middle = |values: [f32; 4]| {
            // Whether a segment separates the first corner from the middle.
            let near = |p: &[f64; 2]| p[0] + p[1] < 1.0;
            contour(&values, [2, 2]).iter().any(|s| s.iter().all(near))
        };
        assert!(!middle([-3.0, 1.0, 1.0, -3.0]));
        assert!(middle([-1.0, 3.0, 3.0, -1.0]));
        assert!(middle([1.0, -3.0, -3.0, 1.0]));
        assert!(!middle([3.0, -1.0, -1.0, 3.0]));
    }
}
