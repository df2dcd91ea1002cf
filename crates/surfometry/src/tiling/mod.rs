//! Boxes with halos, blocks of values on them, and sums that do not depend on order.
//!
//! Every stage works on an index box and every result is a sum over boxes. Tiles are anchored at image index
//! 0, never at a crop, so that a voxel belongs to the same tile whatever else is measured, on any number of
//! threads.
//!
//! ```
//! use surfometry::tiling::ExactSum;
//! let sum = |numbers: &[f64]| {
//!     let mut sum = ExactSum::default();
//!     numbers.iter().for_each(|&number| sum.add(number));
//!     sum.value()
//! };
//! assert_eq!(sum(&[1e16, 1.0, -1e16]), 1.0);
//! assert_eq!(sum(&[1.0, -1e16, 1e16]), 1.0);
//! ```

mod axis_weights;
mod block;
mod cover;
mod disjoint_sets;
mod exact_sum;
mod index_box;
pub(crate) mod pairs;
mod pool;
mod sparse_field;
mod work_time;

pub(crate) use axis_weights::AxisWeights;
pub use block::Block;
pub(crate) use cover::{Cover, Joint};
pub(crate) use disjoint_sets::DisjointSets;
pub use exact_sum::ExactSum;
pub use index_box::IndexBox;
pub use pool::Pool;
pub use sparse_field::{SparseField, SparseTile};
pub use work_time::WorkTime;

/// Voxels of a tile along x, y, z. What a tile must know around it, ten voxels or so on each side, is then a
/// moderate share, and what is worked on at a time stays in a processor's second cache.
pub const TILE: [i64; 3] = [64, 64, 128];
