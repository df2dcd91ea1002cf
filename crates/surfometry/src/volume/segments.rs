//! Segments that may overlap, in an image of one number a voxel.

use super::{LabelGroup, LabelImage, LabelSelection, VolumeError};
use std::collections::BTreeMap;

/// Which segments the values of an image stand for, where segments may overlap. A voxel that only one has is that one's
/// own number; each combination of several that occurs has a number beside.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Segments {
    /// The values of a segment; of one without voxels there are none.
    values: BTreeMap<i64, Vec<i64>>,
}

impl Segments {
    /// Of all segments, and the values that occurred, each with the segments that it stands for.
    pub(crate) fn new(
        segments: impl IntoIterator<Item = i64>,
        combinations: impl IntoIterator<Item = (i64, Vec<i64>)>,
    ) -> Self {
        let mut values: BTreeMap<i64, Vec<i64>> = segments.into_iter().map(|s| (s, Vec::new())).collect();
        for (value, combination) in combinations {
            for segment in combination {
                values.entry(segment).or_default().push(value);
            }
        }
        Self { values }
    }

    /// Whether a voxel is of several.
    pub fn overlap(&self) -> bool {
        self.values.iter().any(|(segment, values)| values.iter().any(|value| value != segment))
    }

    /// Segments without a voxel.
    pub fn empty(&self) -> impl Iterator<Item = i64> + '_ {
        self.values.iter().filter(|(_, values)| values.is_empty()).map(|(segment, _)| *segment)
    }

    /// Segments that have voxels, in ascending order.
    pub fn present(&self) -> impl Iterator<Item = i64> + '_ {
        self.values.iter().filter(|(_, values)| !values.is_empty()).map(|(segment, _)| *segment)
    }

    /// The values of the voxels that any of some segments has.
    pub fn values_of(&self, segments: &LabelGroup) -> LabelGroup {
        let values = segments.labels().iter().filter_map(|segment| self.values.get(segment)).flatten();
        let mut values: Vec<i64> = values.copied().collect();
        values.sort_unstable();
        values.dedup();
        LabelGroup::united(values)
    }
}

/// An object of an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selected {
    /// What it is called by: labels, or segments.
    pub label: LabelGroup,
    /// The values of its voxels.
    pub values: LabelGroup,
}

impl Selected {
    /// The objects that are selected in an image whose values stand for labels, or for segments.
    ///
    /// # Errors
    /// [`VolumeError::NoForeground`], or [`VolumeError::NoSuchLabel`] for one that does not occur.
    pub fn of(
        selection: &LabelSelection,
        image: &LabelImage,
        segments: Option<&Segments>,
    ) -> Result<Vec<Self>, VolumeError> {
        let (objects, missing) = Self::found(selection, image, segments)?;
        missing.into_iter().next().map_or(Ok(objects), Err)
    }

    /// The same, and [`VolumeError::NoSuchLabel`] for each that does not occur.
    pub(crate) fn found(
        selection: &LabelSelection,
        image: &LabelImage,
        segments: Option<&Segments>,
    ) -> Result<(Vec<Self>, Vec<VolumeError>), VolumeError> {
        let found = match segments {
            None => selection.find(image)?,
            Some(segments) => selection.find_among(segments.present())?,
        };
        let of = |label: LabelGroup| match segments {
            None => Self::of_labels(label),
            Some(segments) => Self { values: segments.values_of(&label), label },
        };
        Ok((found.groups.into_iter().map(of).collect(), found.missing))
    }

    /// Of labels that are their voxels' values.
    pub(crate) fn of_labels(label: LabelGroup) -> Self {
        Self { values: label.clone(), label }
    }
}
