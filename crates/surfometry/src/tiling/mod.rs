//! Boxes with halos, blocks of values on them, and sums that do not depend on order.
//!
//! Every stage works on an index box and every result is a sum over boxes. Tiles are anchored at image index 0,
//! never at a crop, so that a voxel belongs to the same tile whatever else is measured, on any number of threads.

mod block;
mod exact_sum;
mod index_box;
mod pool;

pub use block::Block;
pub use exact_sum::ExactSum;
pub use index_box::IndexBox;
pub use pool::Pool;

/// Edge of a tile in voxels. 64 keeps a tile's fields near 10 MB a thread and the halo's share moderate for
/// blurs up to a few voxels.
pub const TILE_EDGE: i64 = 64;
