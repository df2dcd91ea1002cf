//! Which boxes of an image are known, in whatever order they come.

use super::IndexBox;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Disjoint boxes of an image, ascending.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Cover {
    image: IndexBox,
    boxes: Vec<IndexBox>,
}

/// What becomes known where two covers meet.
#[derive(Debug)]
pub(crate) struct Joint {
    /// By box, those of the other cover that share a face, an edge or a corner with it.
    contacts: BTreeMap<IndexBox, Vec<IndexBox>>,
    /// Boxes in contact around which nothing of the image is missing any more.
    surrounded: BTreeSet<IndexBox>,
}

impl Cover {
    /// One box of an image, or nothing of it.
    pub(crate) fn of(image: IndexBox, region: IndexBox) -> Self {
        let boxes = if region.is_empty() { Vec::new() } else { vec![region] };
        Self { image, boxes }
    }

    /// The image.
    pub(crate) fn image(&self) -> &IndexBox {
        &self.image
    }

    pub(crate) fn boxes(&self) -> &[IndexBox] {
        &self.boxes
    }

    /// Both covers as one, and what is new in it.
    ///
    /// # Errors
    /// Two boxes that overlap.
    pub(crate) fn merged(&self, other: &Self) -> Result<(Self, Joint), [IndexBox; 2]> {
        let mut contacts = BTreeMap::<IndexBox, Vec<IndexBox>>::new();
        for a in &self.boxes {
            for b in &other.boxes {
                if !a.intersection(b).is_empty() {
                    return Err([*a, *b]);
                }
                if a.is_near(b) {
                    contacts.entry(*a).or_default().push(*b);
                    contacts.entry(*b).or_default().push(*a);
                }
            }
        }
        let mut boxes = [&self.boxes[..], &other.boxes[..]].concat();
        boxes.sort_unstable();
        let cover = Self { image: self.image, boxes };
        let surrounded = contacts.keys().copied().filter(|region| cover.surrounds(region)).collect();
        Ok((cover, Joint { contacts, surrounded }))
    }

    /// Whether all of the image around a box, itself included, is known.
    fn surrounds(&self, region: &IndexBox) -> bool {
        let around = region.grown([1; 3]).intersection(&self.image);
        let known: usize = self.boxes.iter().map(|known| known.intersection(&around).voxels()).sum();
        known == around.voxels()
    }

    /// What is not known of the image, as disjoint boxes.
    pub(crate) fn missing(&self) -> Vec<IndexBox> {
        let without = |missing: Vec<IndexBox>, known: &IndexBox| {
            missing.iter().flat_map(|part| part.without(known)).collect()
        };
        self.boxes.iter().fold(vec![self.image], without)
    }

    /// Whether the boxes are disjoint parts of the image, ascending.
    pub(crate) fn is_valid(&self) -> bool {
        let apart = |(n, a): (usize, &IndexBox)| {
            self.boxes[n + 1..].iter().all(|b| a < b && a.intersection(b).is_empty())
        };
        self.boxes.iter().all(|part| part.has_voxels() && self.image.holds(part))
            && self.boxes.iter().enumerate().all(apart)
    }
}

impl Joint {
    /// The boxes of the other cover that touch a box.
    pub(crate) fn contacts(&self, region: &IndexBox) -> &[IndexBox] {
        self.contacts.get(region).map_or(&[], Vec::as_slice)
    }

    /// Whether nothing is missing any more around a box in contact.
    pub(crate) fn surrounds(&self, region: &IndexBox) -> bool {
        self.surrounded.contains(region)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_meet_once_and_what_is_missing_is_named() {
        let image = IndexBox::new([0; 3], [8, 4, 4]);
        let part = |x0, x1| Cover::of(image, IndexBox::new([x0, 0, 0], [x1, 4, 4]));
        let (ends, joint) = part(6, 8).merged(&part(0, 2)).unwrap();
        assert!(joint.contacts(&ends.boxes()[0]).is_empty() && ends.is_valid());
        assert_eq!(ends.missing(), [IndexBox::new([2, 0, 0], [6, 4, 4])]);
        let (all, joint) = part(2, 6).merged(&ends).unwrap();
        assert_eq!(joint.contacts(&all.boxes()[1]), [all.boxes()[0], all.boxes()[2]]);
        assert!(all.boxes().iter().all(|region| joint.surrounds(region)));
        assert!(all.missing().is_empty());
        assert_eq!(
            all.merged(&part(1, 3)).unwrap_err(),
            [all.boxes()[0], IndexBox::new([1, 0, 0], [3, 4, 4])]
        );
        assert_eq!(Cover::of(image, IndexBox::EMPTY).missing(), [image]);
    }
}
