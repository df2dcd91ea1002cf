//! Images in memory: grid, spacing, affine, labels, masks, fields, and the slabs in which they arrive.
//!
//! ```
//! use surfometry::volume::{Affine, Grid, LabelImage};
//! // Voxels of 1 x 1 x 2 mm, the first axis fastest; world coordinates are RAS, in mm.
//! let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let grid = Grid::new([3, 2, 2], Affine::from_directions(axes, [1.0, 1.0, 2.0], [0.0; 3]))?;
//! let image = LabelImage::from_voxels(grid, &[0_u8, 5, 5, 0, 0, 0, 7, 0, 0, 0, 0, 0])?;
//! assert_eq!(image.summary(5).map(|label| label.voxels), Some(2));
//! assert!(image.mask(7).get([0, 0, 1]));
//! # Ok::<(), surfometry::volume::VolumeError>(())
//! ```

mod affine;
mod continued;
mod dense_labels;
mod error;
mod field;
mod field_of_view;
mod grid;
mod label_block;
mod label_runs;
#[cfg(feature = "io")]
mod label_slabs;
mod label_table;
mod labels;
mod mask;
mod probability;
mod samples;
#[cfg(feature = "io")]
mod segments;
mod selection;
mod shared;
mod shear;
mod slab;
mod spacing;

pub use affine::Affine;
pub use error::VolumeError;
pub(crate) use field::LARGEST as LARGEST_FIELD_VALUE;
pub use field::{FieldImage, FieldValues};
pub use field_of_view::FieldOfView;
pub use grid::Grid;
pub use label_block::{LabelBlock, LabelBlockBuilder};
pub(crate) use label_runs::LabelRuns;
#[cfg(feature = "io")]
pub(crate) use label_slabs::{LabelRewrite, LabelSlabs};
#[cfg(feature = "io")]
pub(crate) use label_table::hexadecimal;
pub use label_table::{LabelEntry, LabelTable};
pub(crate) use labels::RunEncoder;
#[cfg(feature = "io")]
pub(crate) use labels::look_grey;
pub use labels::{LabelImage, LabelSummary};
pub use mask::Mask;
pub(crate) use mask::{Place, ones};
pub use probability::ProbabilityImage;
pub(crate) use probability::TOLERANCE as PROBABILITY_TOLERANCE;
pub use samples::{Samples, Scalar, ScalarType};
#[cfg(feature = "io")]
pub(crate) use samples::{collected, for_samples};
#[cfg(feature = "io")]
pub use segments::{Segments, Selected};
pub(crate) use selection::Found;
#[cfg(feature = "io")]
pub(crate) use selection::without_repeats;
pub use selection::{LabelGroup, LabelSelection, ParseSelectionError};
pub use shared::Shared;
pub(crate) use shear::Shear;
pub use slab::{Slab, SlabReader, slices_a_slab};
pub(crate) use slab::{check_made, made_slab};
pub use spacing::Spacing;
