//! The vertex of a surface that is nearest to a point.

use crate::surface::{dot, minus};
use std::collections::HashMap;

/// Points in cells as wide as one looks.
pub(super) struct Nearest<'a> {
    points: &'a [[f64; 3]],
    reach: f64,
    /// Numbers of the points of each cell, as ranges of `order`.
    cells: HashMap<[i64; 3], std::ops::Range<usize>>,
    order: Vec<u32>,
}

impl<'a> Nearest<'a> {
    /// Among points, looking no further than `reach`, in their unit.
    pub(super) fn of(points: &'a [[f64; 3]], reach: f64) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let cell = |number: u32| cell_of(points[number as usize], reach);
        order.sort_by_cached_key(|&number| cell(number));
        let mut cells = HashMap::new();
        let mut start = 0;
        for same in order.chunk_by(|&a, &b| cell(a) == cell(b)) {
            cells.insert(cell(same[0]), start..start + same.len());
            start += same.len();
        }
        Self { points, reach, cells, order }
    }

    /// The number of the nearest, the first of equals; `None` where none is within reach.
    pub(super) fn to(&self, point: [f64; 3]) -> Option<usize> {
        let [x, y, z] = cell_of(point, self.reach);
        let around =
            (-1..=1).flat_map(|k| (-1..=1).flat_map(move |j| (-1..=1).map(move |i| [x + i, y + j, z + k])));
        let members =
            around.filter_map(|cell| self.cells.get(&cell)).flat_map(|range| &self.order[range.clone()]);
        let squared = |number: u32| {
            let away = minus(self.points[number as usize], point);
            dot(away, away)
        };
        let pairs = members.map(|&number| (squared(number), number));
        let nearest = pairs.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        (nearest.0 <= self.reach * self.reach).then_some(nearest.1 as usize)
    }
}

fn cell_of(point: [f64; 3], edge: f64) -> [i64; 3] {
    point.map(|v| libm::floor(v / edge) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

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
