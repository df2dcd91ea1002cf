//! Which of several segments that may overlap a voxel is of, as one number.

use super::ReadError;
use crate::volume::{Samples, Scalar, Segments, for_samples};
use std::collections::{BTreeSet, HashMap};

/// Numbers of segments, and of the combinations of them that have occurred, in order of appearance. A voxel that one
/// segment has is that one's number; numbers of combinations lie above those of all segments.
#[derive(Debug, Default)]
pub(super) struct Combinations {
    segments: Vec<i32>,
    /// Segments that have occurred.
    seen: BTreeSet<i32>,
    sets: Vec<Vec<i64>>,
    number_of: HashMap<Vec<i64>, i32>,
    /// What a number and a segment beside it become.
    joined: HashMap<(i32, i32), i32>,
}

impl Combinations {
    pub(super) fn new(segments: Vec<i32>) -> Self {
        Self { segments, ..Self::default() }
    }

    /// The values of all segments, so far.
    pub(super) fn segments(&self) -> Segments {
        let first = self.first();
        let alone = self.seen.iter().map(|&segment| (segment.into(), vec![segment.into()]));
        let combined = self.sets.iter().cloned().zip(i64::from(first)..).map(|(set, number)| (number, set));
        let all = self.segments.iter().copied().map(i64::from);
        Segments::new(all, alone.chain(combined))
    }

    fn first(&self) -> i32 {
        self.segments.iter().copied().max().unwrap_or(0).max(0) + 1
    }

    /// Lays a layer over a slice of numbers; `number_of` says which segment a value of the layer is.
    pub(super) fn lay(
        &mut self,
        slice: &mut [i32],
        layer: &Samples,
        mut number_of: impl FnMut(i64) -> Result<i32, ReadError>,
    ) -> Result<(), ReadError> {
        for_samples!(layer, values => self.lay_values(slice, values, &mut number_of))
    }

    fn lay_values<T: Scalar>(
        &mut self,
        slice: &mut [i32],
        values: &[T],
        number_of: &mut impl FnMut(i64) -> Result<i32, ReadError>,
    ) -> Result<(), ReadError> {
        // Neighbours are alike, as a rule.
        let mut last: Option<(T, i32, i32)> = None;
        for (number, &value) in slice.iter_mut().zip(values) {
            if value.to_f64() == 0.0 {
                continue;
            }
            *number = match last {
                Some((known, below, joined)) if known == value && below == *number => joined,
                _ => {
                    let label =
                        value.to_label().ok_or_else(|| ReadError::NoMask { value: value.to_f64() })?;
                    let joined = if label == 0 { *number } else { self.join(*number, number_of(label)?) };
                    last = Some((value, *number, joined));
                    joined
                }
            };
        }
        Ok(())
    }

    /// What a voxel becomes that another segment has as well.
    fn join(&mut self, number: i32, segment: i32) -> i32 {
        if number == 0 {
            self.seen.insert(segment);
            return segment;
        }
        if number == segment {
            return segment;
        }
        if let Some(&known) = self.joined.get(&(number, segment)) {
            return known;
        }
        let mut set = self.set_of(number);
        set.push(segment.into());
        set.sort_unstable();
        set.dedup();
        let next = self.first().saturating_add(self.sets.len() as i32);
        let joined = *self.number_of.entry(set.clone()).or_insert(next);
        if joined == next {
            self.sets.push(set);
        }
        self.joined.insert((number, segment), joined);
        joined
    }

    fn set_of(&self, number: i32) -> Vec<i64> {
        let place = usize::try_from(number - self.first()).ok();
        place.and_then(|place| self.sets.get(place)).cloned().unwrap_or_else(|| vec![number.into()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::LabelGroup;

    #[test]
    fn numbers_are_of_segments_alone_and_of_sets_that_occur() {
        let mut all = Combinations::new(vec![3, 1, 7]);
        let mut slice = [0; 6];
        let mut lay = |segment: i32, values: Vec<u8>| {
            all.lay(&mut slice, &Samples::U8(values), |_| Ok(segment)).unwrap();
        };
        lay(3, vec![1, 1, 1, 0, 0, 0]);
        lay(1, vec![0, 1, 1, 1, 0, 0]);
        lay(7, vec![0, 0, 1, 1, 0, 0]);
        assert_eq!(slice, [3, 8, 9, 10, 0, 0]);
        let segments = all.segments();
        let values =
            |labels: &[i64]| segments.values_of(&LabelGroup::united(labels.to_vec())).labels().to_vec();
        assert_eq!(values(&[3]), [3, 8, 9]);
        assert_eq!(values(&[1]), [1, 8, 9, 10]);
        assert_eq!(values(&[7, 3]), [3, 8, 9, 10]);
        assert_eq!(segments.present().count(), 3);
    }
}
