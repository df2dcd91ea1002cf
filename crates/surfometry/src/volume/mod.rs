//! Images in memory: grid, spacing, affine, labels, masks, fields, and the slabs in which they arrive.

mod affine;
mod error;
mod field;
mod grid;
mod label_block;
mod label_runs;
mod labels;
mod mask;
mod probability;
mod samples;
mod selection;
mod shared;
mod slab;
mod spacing;

pub use affine::Affine;
pub use error::VolumeError;
pub use field::{FieldImage, FieldValues};
pub use grid::Grid;
pub use label_block::LabelBlock;
pub(crate) use label_runs::LabelRuns;
pub(crate) use labels::RunEncoder;
pub use labels::{LabelImage, LabelSummary};
pub use mask::Mask;
pub(crate) use mask::{Place, ones};
pub use probability::ProbabilityImage;
#[cfg(feature = "io")]
pub(crate) use samples::collected;
pub use samples::{Samples, Scalar, ScalarType};
pub use selection::{LabelGroup, LabelSelection, ParseSelectionError};
pub use shared::Shared;
#[cfg(feature = "io")]
pub(crate) use slab::slices_a_slab;
pub use slab::{Slab, SlabReader};
pub(crate) use slab::{check_made, made_slab};
pub use spacing::Spacing;
