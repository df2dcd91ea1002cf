//! The cohort, and what is done with a bone in more than one experiment.

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};
use surfometry::Measurement;
use surfometry::integrals::QuadratureRule;
use surfometry::io::read_labels;
use surfometry::measurement::{Derivatives, EmbeddingKind, Object, VoxelQuantity};
use surfometry::phantoms::{Phantom, Truth};
use surfometry::pictures::{Figure, PictureKind, PictureStyle, View, picture};
use surfometry::runs::write_cohort;
use surfometry::surface::LocalQuantity;
use surfometry::volume::Mask;

/// Femurs and vertebrae each, as in the paper.
const COUNT: u32 = 50;

/// A bone of the cohort.
pub(crate) struct Bone {
    /// `femur_01`
    pub(crate) name: String,
    /// Its labels.
    pub(crate) path: PathBuf,
    /// Its exact integrals.
    pub(crate) truth: Truth,
}

impl Bone {
    /// Its voxels.
    pub(crate) fn mask(&self) -> Result<Mask> {
        Ok(read_labels(&self.path)?.mask(1))
    }

    /// One of [`KINDS`].
    pub(crate) fn kind(&self) -> &'static str {
        if self.name.starts_with("femur") { "Femur" } else { "L4" }
    }
}

/// Both kinds.
pub(crate) const KINDS: [&str; 2] = ["Femur", "L4"];

/// Reads the cohort, after making what is missing.
pub(crate) fn cohort(folder: &Path) -> Result<Vec<Bone>> {
    let members = surfometry::phantoms::cohort(COUNT, COUNT);
    let bar = progress("cohort", members.len());
    let files = write_cohort(folder, &members, |_| bar.inc(1))?;
    bar.finish_and_clear();
    let bones = members.into_iter().zip(files);
    Ok(bones.map(|(member, file)| Bone { name: member.name, path: file.path, truth: file.truth }).collect())
}

/// A bar on stderr, where that is a terminal.
pub(crate) fn progress(what: &'static str, count: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("  {bar:24} {pos}/{len} {msg}").expect("a constant template");
    ProgressBar::new(count as u64).with_style(style).with_message(what)
}

/// The voxels of a phantom.
pub(crate) fn phantom_mask(spec: &str) -> Result<Mask> {
    Ok(Phantom::from_spec(spec)?.labels()?.mask(1))
}

/// The distance embedding measured as in the paper: fourth-order differences, Simpson's rule, a band of 2.5
/// mm.
pub(crate) fn paper_distance() -> Measurement {
    Measurement::default()
        .embedding(EmbeddingKind::Distance)
        .derivatives(Derivatives::FiniteDifference)
        .quadrature(QuadratureRule::Simpson)
        .thickness_mm(2.5)
}

/// The voxels where an object's embedding is below zero: the paper's re-binarised image.
pub(crate) fn rebinarised(object: &Object) -> Result<Mask> {
    let grid = *object.grid();
    let phi = object.voxel_map(VoxelQuantity::Phi, &grid.index_box()).context("the blur left nothing")?;
    Ok(Mask::from_predicate(grid, |index| phi.get(index.map(|i| i as i64)) < 0.0))
}

/// A picture of an object's surface, coloured up to a limit where one is given.
pub(crate) fn surface_picture(
    object: &Object,
    title: &str,
    (quantity, limit): (LocalQuantity, Option<f64>),
    view: View,
) -> Result<Figure> {
    let views = vec![view.into()];
    let style = PictureStyle { quantity, limit, views, title: title.to_owned(), ..PictureStyle::default() };
    Ok(picture(PictureKind::Surface, object, &object.surface(), &style)?)
}

/// The one in the middle of a sorted order.
pub(crate) fn median_of<T>(mut items: Vec<T>, value: impl Fn(&T) -> f64) -> T {
    items.sort_by(|a, b| value(a).total_cmp(&value(b)));
    let middle = items.len() / 2;
    items.swap_remove(middle)
}
