//! Zarr arrays and OME-Zarr images, in folders.
//!
//! # References
//! Zarr 2 and 3, <https://zarr-specs.readthedocs.io>; OME-Zarr 0.1 to 0.5, <https://ngff.openmicroscopy.org>. World
//! axes are those that the axes are named after, without an anatomy: x, y, z are taken as they are.

mod choice;
mod node;
mod place;
mod stored;
mod voxels;

use self::choice::{Chosen, choose};
use self::node::{Node, error};
use self::place::Place;
use self::voxels::ZarrVoxels;
use super::assembled::Assembled;
use super::header::{ImageHeader, Voxels, three_dimensions};
use super::{Format, ReadError};
use crate::volume::{LabelEntry, LabelTable};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

pub(super) use self::node::is_zarr;

/// Reads what a folder says that is an array, an image of several resolutions, its labels, or one of these.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let Chosen { array, image, level, groups } = choose(path)?;
    let node = Node::read(&array)?;
    let metadata = [groups, node.files()].concat();
    let stored = node.array()?;
    let place = match &image {
        Some(image) => Place::of(image, &level, stored.shape.len())?,
        None => Place::unknown(stored.shape.len()),
    };
    let axes = place.space_axes(&stored.shape)?;
    let dimensions = three_dimensions(&axes.map(|axis| stored.shape[axis]))?;
    let voxels = ZarrVoxels::open(&array, axes, &stored, metadata)?;
    let affine = place.affine(axes);
    Ok(ImageHeader {
        affine,
        unknown_unit: place.unknown_unit(axes),
        labels: image.map_or_else(LabelTable::default, |image| label_table(&image)),
        ..ImageHeader::new(
            &array,
            Format::Zarr,
            dimensions,
            stored.scalar,
            Voxels::Assembled(Assembled(Arc::new(voxels))),
        )
    })
}

/// Names and colours out of `image-label`. Which property is a name is not laid down: those in use are tried.
fn label_table(image: &Node) -> LabelTable {
    const NAMES: [&str; 4] = ["name", "label-name", "class", "label"];
    let entries =
        |key: &str| image.ome("image-label").get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let label = |entry: &Value| entry.get("label-value").and_then(whole);
    let name = |entry: &Value| NAMES.iter().find_map(|key| entry.get(key)?.as_str().map(str::to_owned));
    let colour = |entry: &Value| {
        let channel = |i: usize| whole(entry.get("rgba")?.get(i)?)?.try_into().ok();
        Some([channel(0)?, channel(1)?, channel(2)?])
    };
    let mut table = std::collections::BTreeMap::<i64, LabelEntry>::new();
    for entry in &entries("colors") {
        if let Some(label) = label(entry) {
            table.entry(label).or_default().colour = colour(entry);
        }
    }
    for entry in &entries("properties") {
        if let Some(label) = label(entry) {
            table.entry(label).or_default().name = name(entry);
        }
    }
    table.into_iter().collect()
}

/// A whole number however it is written: JSON's 1.0 is its 1. Beyond 2^53 such a number is no certain one.
fn whole(value: &Value) -> Option<i64> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let rounded = || value.as_f64().filter(|number| number.fract() == 0.0 && number.abs() < EXACT);
    value.as_i64().or_else(|| rounded().map(|number| number as i64))
}

/// The cure where something has to be chosen.
fn name_one(what: &str, of: &Path, names: &[String]) -> ReadError {
    let path = |name: &String| of.join(name).display().to_string();
    error(format!("{what}: {}; name one of them", names.iter().map(path).collect::<Vec<_>>().join(", ")))
}
