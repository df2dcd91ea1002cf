//! The surface phi = 0 as a mesh, and what is known at its vertices.
//!
//! ```
//! use surfometry::{Measurement, phantoms::Phantom};
//! let mask = Phantom::from_spec("ball?radius=10&shift=0.3,0.2,0.1")?.labels()?.mask(1);
//! let surface = Measurement::default().prepare(&mask)?.surface();
//! // Each vertex has its curvature; the blurred ball's is a little more than 1 / 10 mm.
//! let summary = surface.curvature_summary().expect("a surface");
//! assert!((summary.mean_curvedness_per_mm - 0.1).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cell;
mod cell_interior;
mod change;
mod closest_point;
mod creases;
mod curvature_summary;
mod distribution;
mod isosurface;
mod local_scale;
mod mesh;
mod quantity;
mod sampled;
mod spectrum;
mod spread_mean;
mod surface_map;
mod tile_mesh;
mod triangulation;
mod vertex_array;
mod vertex_geometry;

#[cfg(feature = "pictures")]
pub(crate) use cell_interior::inside_is_joined;
pub use change::{ChangeMoments, Placed, SurfaceChange, VertexChange};
pub(crate) use creases::Creases;
pub use curvature_summary::CurvatureSummary;
pub use distribution::{Distribution, Histogram, Moments, QUANTILES};
pub use isosurface::{SurfaceSummary, extract};
pub(crate) use isosurface::{SurfaceSums, cell_limits, cells_around};
pub(crate) use local_scale::ScaledField;
pub use mesh::Mesh;
pub use quantity::LocalQuantity;
pub use sampled::{JointHistogram, Sample, SampleCorrelation, SampleSummary, SampledVolume};
pub(crate) use spectrum::Spectrum;
pub(crate) use surface_map::VertexExtras;
pub use surface_map::{Surface, SurfacePart};
pub(crate) use tile_mesh::TileMesh;
pub use vertex_array::{VertexArray, VertexValues};
pub use vertex_geometry::VertexGeometry;
