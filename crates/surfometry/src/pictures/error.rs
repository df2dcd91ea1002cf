//! Why a picture could not be made.

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The encoder refused.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The SVG document is not one: a fault of this library.
    #[error("the picture's SVG cannot be read back: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// More pixels than memory should be spent on, or none.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn; take another scale (1 is 96 dots per inch)"
    )]
    Size {
        /// Pixels in a row.
        width: f64,
        /// Rows.
        height: f64,
    },
    /// A block with more or fewer values than voxels.
    #[error("the block has {expected} voxels but {found} values")]
    Values {
        /// Voxels.
        expected: usize,
        /// Values.
        found: usize,
    },
    /// An affine that maps the block onto a plane.
    #[error("the block's affine is singular: two of its axes coincide or a spacing is 0")]
    SingularAffine,
    /// A quantity that the object does not have.
    #[error("{quantity} is defined for {condition} only: choose another quantity")]
    Undefined {
        /// The quantity.
        quantity: &'static str,
        /// What has it.
        condition: &'static str,
    },
    /// A slice that is nowhere near the object.
    #[error(
        "there is no slice {axis} = {index} of this object: it and what lies around it have {axis} = {first} to {last}"
    )]
    NoSlice {
        /// Name of the image axis.
        axis: char,
        /// What was asked for.
        index: i64,
        /// The first that there is.
        first: i64,
        /// The last.
        last: i64,
    },
    /// A picture that cannot be drawn as PDF.
    #[error("the picture cannot be written as PDF: {0}")]
    Pdf(&'static str),
}
