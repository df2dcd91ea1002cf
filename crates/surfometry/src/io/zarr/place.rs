//! Axes of an OME-Zarr image, and where its voxels lie.

use super::node::{Node, error};
use crate::io::ReadError;
use crate::io::text_header::mm_per;
use crate::volume::Affine;
use serde_json::Value;

/// Axes of images before 0.3, which do not name them.
const FIVE: [&str; 5] = ["t", "c", "z", "y", "x"];

/// An axis, and the way from its index to a length in its unit.
struct Axis {
    name: String,
    is_space: bool,
    unit: Option<String>,
    scale: f64,
    translation: f64,
}

/// All axes, slowest first.
pub(super) struct Place {
    axes: Vec<Axis>,
    /// Whether a scale is told.
    known: bool,
}

impl Place {
    /// Of an array that nothing is told of: any of its axes may be space.
    pub(super) fn unknown(rank: usize) -> Self {
        let axis = |name: usize| Axis {
            name: name.to_string(),
            is_space: true,
            unit: None,
            scale: 1.0,
            translation: 0.0,
        };
        Self { axes: (0..rank).map(axis).collect(), known: false }
    }

    /// Of a resolution of an image.
    pub(super) fn of(image: &Node, level: &str, rank: usize) -> Result<Self, ReadError> {
        let multiscale = image.ome("multiscales").get(0).unwrap_or(&Value::Null);
        let mut axes = axes(multiscale, rank)?;
        let datasets = multiscale.get("datasets").and_then(Value::as_array);
        let is_it = |dataset: &&Value| dataset.get("path").and_then(Value::as_str) == Some(level);
        let dataset = datasets.and_then(|list| list.iter().find(is_it)).unwrap_or(&Value::Null);
        // First those of the dataset, then those of all.
        let mut known = false;
        for transformations in [dataset, multiscale].map(|of| of.get("coordinateTransformations")) {
            for transformation in transformations.and_then(Value::as_array).into_iter().flatten() {
                known |= apply(transformation, &mut axes)?;
            }
        }
        Ok(Self { axes, known })
    }

    /// The axes of space, fastest first. Others may only have one sample; where nothing is told, axes of one sample
    /// in front or behind are dropped.
    pub(super) fn space_axes(&self, shape: &[usize]) -> Result<[usize; 3], ReadError> {
        let (mut space, other): (Vec<usize>, Vec<usize>) =
            (0..shape.len()).rev().partition(|&a| self.axes[a].is_space);
        while space.len() > 3 {
            let Some(single) = space.iter().rposition(|&a| shape[a] == 1) else { break };
            space.remove(single);
        }
        let several = other
            .iter()
            .filter(|&&a| shape[a] != 1)
            .map(|&a| format!("{} = {}", self.axes[a].name, shape[a]));
        let several: Vec<String> = several.collect();
        match (several.is_empty(), &space[..]) {
            (true, &[x, y, z]) => Ok([x, y, z]),
            (true, _) => Err(error(format!(
                "axes of {shape:?} samples, of which {} are space: surfometry measures 3-D images",
                space.len()
            ))),
            (false, _) => Err(error(format!(
                "several channels or times ({}): surfometry measures one 3-D image at a time; save the one that is meant as an image of its own",
                several.join(", ")
            ))),
        }
    }

    /// Index of x, y, z to mm; lengths as they are written where the unit is not known.
    pub(super) fn affine(&self, space: [usize; 3]) -> Option<Affine> {
        if !self.known {
            return None;
        }
        let mut affine = Affine::diagonal([0.0; 3]);
        for (column, (axis, world)) in space.iter().zip(self.world(space)).enumerate() {
            let Axis { unit, scale, translation, .. } = &self.axes[*axis];
            let mm = unit.as_deref().and_then(mm_per).unwrap_or(1.0);
            affine.linear[world][column] = scale * mm;
            affine.origin[world] = translation * mm;
        }
        Some(affine)
    }

    /// The world's axis of each: by its name, or else in the order of memory.
    fn world(&self, space: [usize; 3]) -> [usize; 3] {
        let named = space.map(|axis| {
            ["x", "y", "z"].iter().position(|name| self.axes[axis].name.eq_ignore_ascii_case(name))
        });
        match named {
            [Some(x), Some(y), Some(z)] if x != y && y != z && x != z => [x, y, z],
            _ => [0, 1, 2],
        }
    }

    /// The unit of an axis of space that is none known; where none is stated that is no mm.
    pub(super) fn unknown_unit(&self, space: [usize; 3]) -> Option<String> {
        let stated =
            |axis: usize| self.axes[axis].unit.as_deref().map(str::trim).filter(|unit| !unit.is_empty());
        space.iter().find_map(|&axis| match stated(axis) {
            None => Some("(none stated)".to_owned()),
            Some(unit) => mm_per(unit).is_none().then(|| unit.to_owned()),
        })
    }
}

fn axes(multiscale: &Value, rank: usize) -> Result<Vec<Axis>, ReadError> {
    let default: Vec<Value> = FIVE.iter().map(|name| Value::from(*name)).collect();
    let list = multiscale.get("axes").and_then(Value::as_array).unwrap_or(&default);
    if list.len() != rank {
        return Err(error(format!(
            "{} axes are named, the array has {rank}; export the image again",
            list.len()
        )));
    }
    let text = |axis: &Value, key: &str| axis.get(key).and_then(Value::as_str).map(str::to_owned);
    let axis = |axis: &Value| {
        let name = axis.as_str().map(str::to_owned).or_else(|| text(axis, "name")).unwrap_or_default();
        let of_space = ["x", "y", "z"].contains(&name.to_lowercase().as_str());
        let is_space = text(axis, "type").map_or(of_space, |kind| kind == "space");
        Axis { name, is_space, unit: text(axis, "unit"), scale: 1.0, translation: 0.0 }
    };
    Ok(list.iter().map(axis).collect())
}

/// Puts a transformation behind those that there are; whether it was a scale.
fn apply(transformation: &Value, axes: &mut [Axis]) -> Result<bool, ReadError> {
    let kind = transformation.get("type").and_then(Value::as_str).unwrap_or_default();
    let numbers = || {
        let list = transformation.get(kind).and_then(Value::as_array)?;
        let list = list.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()?;
        (list.len() == axes.len()).then_some(list)
    };
    let numbers = match kind {
        "identity" => return Ok(false),
        "scale" | "translation" => numbers().ok_or_else(|| {
            error(format!(
                "a {kind} without a number for each of {} axes; export the image again",
                axes.len()
            ))
        })?,
        other => {
            return Err(error(format!(
                "a transformation `{other}`, where scale and translation are read; resample the image"
            )));
        }
    };
    for (axis, number) in axes.iter_mut().zip(numbers) {
        if kind == "scale" {
            axis.scale *= number;
            axis.translation *= number;
        } else {
            axis.translation += number;
        }
    }
    Ok(kind == "scale")
}
