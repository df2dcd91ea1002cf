#![doc = include_str!("../README.md")]

pub mod accuracy;
mod choice;
#[cfg(feature = "io")]
pub mod comparison;
mod control;
pub mod embedding;
#[cfg(feature = "io")]
pub mod inputs;
pub mod integrals;
#[cfg(feature = "io")]
pub mod io;

pub mod local_geometry;
pub mod measurement;
pub mod phantoms;
#[cfg(feature = "pictures")]
pub mod pictures;
pub mod reference_methods;
#[cfg(feature = "report")]
pub mod report;
#[cfg(feature = "io")]
pub mod runs;
pub mod statistics;
pub mod surface;
pub mod tiling;
pub mod topology;
pub mod validation;
pub mod volume;
pub mod voxelisation;

pub use choice::{Choice, UnknownChoice};
pub use control::{Control, Event, Stopped};
pub use measurement::Measurement;
