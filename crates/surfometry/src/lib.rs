#![doc = include_str!("../README.md")]
//! # Contents
//!
//! Each step is a module.
//!
//! | step | module |
//! |---|---|
//! | whatever a name stands for, opened once | [`inputs`], [`io`], [`phantoms`], [`voxelisation`] |
//! | the lattice and its labels, masks, fields | [`volume`] |
//! | boxes, tiles, sums that are exact | [`tiling`] |
//! | the smooth field phi whose zero level is the surface | [`embedding`] |
//! | its derivatives and curvature | [`local_geometry`] |
//! | the smeared delta and what is summed over its band | [`integrals`] |
//! | phi = 0 as a mesh with geometry at its vertices | [`surface`] |
//! | Euler numbers, components, places where two objects differ | [`topology`] |
//! | scale, compensation, standard errors, what a warning is | [`accuracy`] |
//! | choices to results, of one object or of an image | [`Measurement`], [`measurement`] |
//! | many inputs, and where results go | [`runs`], [`Control`] |
//! | figures and pages | [`pictures`], [`report`] |
//! | integrals with their derivatives, for optimisation | [`differentiable`] |
//! | classical estimators, agreement of two tables | [`reference_methods`], [`comparison`], [`statistics`] |
//! | how well all of it holds | [`validation`] |
//! | texts of files, as they may be shown | [`text`] |
//!
//! The shortest way in: [`runs::records_of`] for a file, [`Measurement::run`] for a mask in memory,
//! [`Measurement::run_labels`] for all labels of an image, [`measurement::PartialMeasurement`] for an image in
//! boxes.

pub mod accuracy;
mod choice;
#[cfg(feature = "io")]
pub mod comparison;
mod control;
pub mod differentiable;
pub mod embedding;
#[cfg(feature = "io")]
pub mod inputs;
pub mod integrals;
mod interfaces;
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
mod space;
pub mod statistics;
pub mod surface;
pub mod text;
pub mod tiling;
pub mod topology;
pub mod validation;
mod vectors;
pub mod volume;
pub mod voxelisation;

pub use choice::{Choice, UnknownChoice};
pub use control::{Control, Event, Stopped};
pub use measurement::Measurement;
