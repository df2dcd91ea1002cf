//! Where a frame lies and what it belongs to: of a file of one, or out of the functional groups of one of several.

use super::data_set::{DataSet, Elements};
use super::error;
use crate::io::ReadError;
use crate::space::dot;
use dicom_dictionary_std::tags;
use dicom_object::{InMemDicomObject, Tag};

/// Where a frame lies, in DICOM's axes (LPS), mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    /// Centre of the first pixel.
    pub(super) position: [f64; 3],
    /// Unit vectors along a row, and down a column.
    pub(super) directions: [[f64; 3]; 2],
    /// Distance of pixels along a row, and down a column.
    pub(super) spacing: [f64; 2],
}

/// Where the elements of a frame stand: its own groups, those that all frames share, and the data set itself.
pub(super) struct FrameGroups<'a> {
    groups: Vec<&'a InMemDicomObject>,
    data_set: &'a InMemDicomObject,
}

/// The groups of each frame; of a file that says nothing of frames, of one.
pub(super) fn groups(data_set: &DataSet) -> Vec<FrameGroups<'_>> {
    let shared = data_set.items(tags::SHARED_FUNCTIONAL_GROUPS_SEQUENCE).first();
    let own = data_set.items(tags::PER_FRAME_FUNCTIONAL_GROUPS_SEQUENCE);
    let frame = |groups: Vec<_>| FrameGroups { groups, data_set: data_set.elements() };
    if own.is_empty() {
        return vec![frame(shared.into_iter().collect())];
    }
    own.iter().map(|own| frame([own].into_iter().chain(shared).collect())).collect()
}

impl FrameGroups<'_> {
    /// What holds an element: an item of a group's sequence, or the data set.
    pub(super) fn holder(&self, sequence: Tag, element: Tag) -> Option<&InMemDicomObject> {
        let items = self.groups.iter().filter_map(|group| group.items(sequence).first());
        items.chain([self.data_set]).find(|holder| holder.get(element).is_some())
    }

    /// Where the frame lies.
    ///
    /// # Errors
    /// What of that is not said, or makes no sense.
    pub(super) fn plane(&self) -> Result<Plane, ReadError> {
        let position = self.numbers(tags::PLANE_POSITION_SEQUENCE, tags::IMAGE_POSITION_PATIENT);
        let orientation =
            self.numbers::<6>(tags::PLANE_ORIENTATION_SEQUENCE, tags::IMAGE_ORIENTATION_PATIENT);
        let spacing = self.numbers::<2>(tags::PIXEL_MEASURES_SEQUENCE, tags::PIXEL_SPACING);
        let missing = |name: &str| {
            error(format!(
                "no {name}: where the pixels lie is not known; export the original series, not screenshots or derived pictures"
            ))
        };
        let [a, b, c, d, e, f] = orientation.ok_or_else(|| missing("ImageOrientationPatient (0020,0037)"))?;
        // (between rows, between columns): down a column, then along a row.
        let [down, along] = spacing.ok_or_else(|| missing("PixelSpacing (0028,0030)"))?;
        let position = position.ok_or_else(|| missing("ImagePositionPatient (0020,0032)"))?;
        Ok(Plane { position, directions: [unit([a, b, c])?, unit([d, e, f])?], spacing: [along, down] })
    }

    pub(super) fn numbers<const N: usize>(&self, sequence: Tag, element: Tag) -> Option<[f64; N]> {
        self.holder(sequence, element)?.numbers(element)
    }
}

impl Plane {
    /// Perpendicular to the plane, right-handed.
    pub(super) fn normal(&self) -> [f64; 3] {
        let [[a, b, c], [d, e, f]] = self.directions;
        [b * f - c * e, c * d - a * f, a * e - b * d]
    }

    /// How far along a direction the plane lies, mm.
    pub(super) fn place(&self, direction: [f64; 3]) -> f64 {
        dot(self.position, direction)
    }

    /// Whether another plane is parallel, with the same pixels.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        const SLACK: f64 = 1e-3;
        let parallel =
            (0..2).all(|n| dot(self.directions[n], other.directions[n]) > 1.0 - SLACK * SLACK / 2.0);
        let spaced =
            (0..2).all(|n| (self.spacing[n] - other.spacing[n]).abs() <= SLACK * self.spacing[n].abs());
        parallel && spaced
    }
}

/// A direction that is written with few digits, as one of length 1; what is far from it is none.
fn unit(direction: [f64; 3]) -> Result<[f64; 3], ReadError> {
    let length = libm::sqrt(dot(direction, direction));
    if (length - 1.0).abs() > 0.01 {
        let text = format!(
            "ImageOrientationPatient has a direction of length {length}, not 1; export the series again"
        );
        return Err(error(text));
    }
    Ok(direction.map(|v| v / length))
}
