//! The vertex of a surface that is nearest to a point.

use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};

/// Points with their numbers.
pub(super) struct Nearest {
    points: RTree<GeomWithData<[f64; 3], usize>>,
    reach: f64,
}

impl Nearest {
    /// Among points, looking no further than `reach`, in their unit.
    pub(super) fn of(points: &[[f64; 3]], reach: f64) -> Self {
        let numbered = points.iter().enumerate().map(|(number, &point)| GeomWithData::new(point, number));
        Self { points: RTree::bulk_load(numbered.collect()), reach }
    }

    /// The number of the nearest; `None` where none is within reach.
    pub(super) fn to(&self, point: [f64; 3]) -> Option<usize> {
        let nearest = self.points.nearest_neighbor(point)?;
        (nearest.distance_2(&point) <= self.reach * self.reach).then_some(nearest.data)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{dot, minus};

    #[test]
    fn the_nearest_is_that_of_a_look_at_all() {
        // Numbers in a row must not lie on lines.
        let number = |i: u32| {
            let mixed = i.wrapping_mul(0x9e37_79b9);
            let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85eb_ca6b);
            f64::from((mixed ^ (mixed >> 13)) >> 16) / 6_553.6
        };
        let points: Vec<[f64; 3]> = (0..300).map(|i| [0, 1, 2].map(|a| number(3 * i + a) - 5.0)).collect();
        let nearest = Nearest::of(&points, 0.8);
        let mut found = 0;
        for i in 1_000..1_200 {
            let point = [0, 1, 2].map(|a| number(3 * i + a) - 5.0);
            let squared = |p: &[f64; 3]| dot(minus(*p, point), minus(*p, point));
            let all = (0..300).min_by(|&a, &b| squared(&points[a]).total_cmp(&squared(&points[b]))).unwrap();
            let expected = (squared(&points[all]) <= 0.64).then_some(all);
            assert_eq!(nearest.to(point), expected);
            found += usize::from(expected.is_some());
        }
        assert!(found > 50 && found < 150, "{found}");
    }
}
