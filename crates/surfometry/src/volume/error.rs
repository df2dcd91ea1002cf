//! What can be wrong with an image before anything is measured.

use crate::tiling::IndexBox;
use thiserror::Error;

/// Why an image cannot be used; every message says what to do about it.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum VolumeError {
    /// A spacing is zero, negative, infinite or not a number.
    #[error(
        "the voxel spacing along axis {axis} is {value} mm; it must be positive and finite: say what it is"
    )]
    InvalidSpacing {
        /// Axis 0, 1 or 2; 0 is the fastest in memory.
        axis: usize,
        /// The offending value, in mm.
        value: f64,
    },
    /// A spacing that is no length between voxels, whatever the image is of.
    #[error(
        "the voxel spacing along axis {axis} is {value:e} mm: the header is damaged or names another unit; give the right spacing"
    )]
    UnlikelySpacing {
        /// Axis 0, 1 or 2; 0 is the fastest in memory.
        axis: usize,
        /// The offending value, in mm.
        value: f64,
    },
    /// Voxels so long that no blur suits all their axes.
    #[error(
        "voxels of {spacing:?} mm are more than 10000 times as long along one axis as along another: the header is damaged or mixes units; give \
         the right spacing"
    )]
    UnequalSpacing {
        /// All three, mm.
        spacing: [f64; 3],
    },
    /// The file's unit of length is not known.
    #[error(
        "the file's unit of length is `{unit}`, which is not known: say what the voxel spacing is, in mm, fastest axis first"
    )]
    UnknownUnit {
        /// As written.
        unit: String,
    },
    /// The file names no spacing at all.
    #[error("the file holds no voxel spacing: say what it is, in mm, fastest axis first")]
    MissingSpacing,
    /// The index-to-world affine has an entry that is not finite.
    #[error(
        "the index-to-world affine holds a value that is not finite; repair the header, or say what the spacing is"
    )]
    NonFiniteAffine,
    /// Two image axes are more than 1 degree from perpendicular in the world.
    #[error(
        "the affine is sheared: axes {first} and {second} meet at {degrees:.3} degrees; lengths and curvatures need \
         axes within 1 degree of perpendicular: resample the image to an orthogonal grid first"
    )]
    Sheared {
        /// First axis.
        first: usize,
        /// Second axis.
        second: usize,
        /// Angle between them.
        degrees: f64,
    },
    /// Not a 3-D image.
    #[error("the image is {dimensions:?}: surfometry measures 3-D images; {cure}")]
    NotThreeDimensional {
        /// Dimensions as stored.
        dimensions: Vec<usize>,
        /// What to do.
        cure: &'static str,
    },
    /// An axis has no voxels.
    #[error(
        "the image is {dimensions:?}: an axis without voxels; the file is empty or its header is damaged"
    )]
    EmptyAxis {
        /// Dimensions as stored.
        dimensions: Vec<usize>,
    },
    /// More slices, rows or columns than any image has.
    #[error(
        "{voxels} voxels along axis {axis} are more than the {most} that an image may have: the header is damaged, or this axis is not one of space"
    )]
    LongAxis {
        /// Axis 0, 1 or 2.
        axis: usize,
        /// Voxels along it.
        voxels: usize,
        /// The most.
        most: usize,
    },
    /// More voxels than can be counted or held.
    #[error(
        "an image of {dimensions:?} voxels is more than this machine's memory can hold; where a file's header says so it may \
         be damaged, otherwise crop the image or take a coarser one"
    )]
    TooLarge {
        /// Dimensions as stored.
        dimensions: [usize; 3],
    },
    /// An image that is made here, of more voxels than anybody waits for.
    #[error(
        "an image of {dimensions:?} voxels would take days to make: take a coarser spacing or a smaller shape"
    )]
    TooMuchToMake {
        /// Dimensions.
        dimensions: [usize; 3],
    },
    /// A voxel of a label image or field is not a number or infinite.
    #[error("voxel {index:?} is {value}; replace such voxels (for labels with 0) before measuring")]
    NotFinite {
        /// Image index, x first.
        index: [usize; 3],
        /// The value.
        value: f64,
    },
    /// A voxel of a sampled volume is infinite, or as good as that.
    #[error(
        "voxel {index:?} is {value:e}, beyond 1e30: where that stands for no value write NaN, which is left out; otherwise scale the values"
    )]
    InfiniteSample {
        /// Image index, x first.
        index: [usize; 3],
        /// The value.
        value: f64,
    },
    /// A voxel of a soft segmentation is no probability.
    #[error(
        "voxel {index:?} is {value}: a soft segmentation has values from 0 to 1; where they are 0..255 or percent divide them first, and \
         where they are labels or a level set choose another embedding"
    )]
    NotAProbability {
        /// Image index, x first.
        index: [usize; 3],
        /// The value.
        value: f64,
    },
    /// A voxel of a field is so large that nothing can be computed from it.
    #[error(
        "voxel {index:?} of the field is {value:e}, beyond 1e30: scale the field, which changes no surface, or replace values that stand for none"
    )]
    HugeValue {
        /// Image index, x first.
        index: [usize; 3],
        /// The value.
        value: f64,
    },
    /// No voxel of a soft segmentation exceeds the level.
    #[error(
        "no value exceeds the level {level}, the largest is {highest:.4}, so nothing lies inside; choose a lower level, or check that this is \
         the segmentation of the object"
    )]
    NothingAbove {
        /// T.
        level: f64,
        /// Largest value.
        highest: f64,
    },
    /// A voxel of a label image is not a whole number.
    #[error(
        "voxel {index:?} is {value}, not a whole number, so this is no label image; threshold it first, or, if it is a \
         level-set field (negative inside), measure it as a given field"
    )]
    Fractional {
        /// Image index, x first.
        index: [usize; 3],
        /// The value.
        value: f64,
    },
    /// So many values, so mixed, that they are no labels.
    #[error(
        "the image has {labels} values, which lie all over it: they look like grey values, not like labels; say which of them are the object: threshold it"
    )]
    GreyValues {
        /// How many values there are beside 0.
        labels: usize,
    },
    /// A label does not fit 64 signed bits.
    #[error("voxel {index:?} is {value}: labels must lie within -2^63 .. 2^63; relabel the image")]
    LabelOutOfRange {
        /// Image index, x first.
        index: [usize; 3],
        /// The value.
        value: f64,
    },
    /// Fewer voxels arrived than the grid has.
    #[error("the voxels end early: {found} of {expected}; the file is truncated: copy or export it again")]
    Incomplete {
        /// Voxels that arrived.
        found: usize,
        /// Voxels of the grid.
        expected: usize,
    },
    /// A box that is not a part of its image.
    #[error("the box {region} is no part of the image {image}: give a box of its voxels, of at least one")]
    BoxBeyondImage {
        /// The box.
        region: IndexBox,
        /// The image.
        image: IndexBox,
    },
    /// No voxel differs from the background.
    #[error("no foreground: every voxel is 0; check that this is the segmentation and not an empty export")]
    NoForeground,
    /// Every voxel rounds to the background.
    #[error(
        "no foreground: every voxel rounds to 0, the largest value is {largest:.2e}; this is no label image: threshold it, or scale it"
    )]
    FaintForeground {
        /// Largest magnitude.
        largest: f64,
    },
    /// No grey value lies within the threshold.
    #[error("no voxel lies within the threshold: values go from {lowest} to {highest}; choose another range")]
    NothingWithin {
        /// The least value.
        lowest: f64,
        /// The largest.
        highest: f64,
    },
    /// A field has no voxel below zero.
    #[error(
        "no voxel of the field is negative, so nothing lies inside; surfometry takes phi < 0 as inside: negate the \
         field if yours is positive inside"
    )]
    NothingInside,
    /// A field has no voxel above zero.
    #[error(
        "no voxel of the field is positive, so all of the image lies inside and there is no surface in it; surfometry takes \
         phi < 0 as inside: check the sign, or subtract the level that is meant"
    )]
    NothingOutside,
    /// A label that was asked for does not occur.
    #[error("no label {missing} in the image; it holds {present}")]
    NoSuchLabel {
        /// What was asked for.
        missing: i64,
        /// What is there, shortened.
        present: String,
    },
}
