//! Segments of 3D Slicer's segmentations, which are NRRD with further fields: `.seg.nrrd`.
//!
//! # References
//! <https://slicer.readthedocs.io/en/latest/developer_guide/modules/segmentations.html#segmentation-file-format-seg-nrrd>.

use super::nifti_labels::of_share;
use super::overlay::{Layer, Layers, Overlay};
use super::text_header::numbers;
use super::{ImageHeader, ReadError, Voxels};
use crate::volume::{Affine, LabelEntry, LabelTable, ScalarType, VolumeError};
use std::collections::{BTreeMap, HashMap};

/// A segment: a label in a layer.
struct Segment {
    layer: usize,
    value: i64,
    entry: LabelEntry,
}

/// An image of segments: its names, and, where layers of them alternate or it was cropped, its voxels put together.
pub(super) fn of_segments(
    header: ImageHeader,
    layers: usize,
    pairs: &HashMap<String, String>,
) -> Result<ImageHeader, ReadError> {
    let segments = segments(pairs, layers);
    check_apart(&segments)?;
    let numbers = numbers_of(&segments);
    let labels: LabelTable = numbers
        .iter()
        .zip(&segments)
        .map(|(number, segment)| (i64::from(*number), segment.entry.clone()))
        .collect();
    let padding = padding(pairs, header.dimensions);
    if layers == 1 && padding == [[0; 2]; 3] {
        return Ok(ImageHeader { labels, ..header });
    }
    let of_layer = |layer: usize| {
        let known = numbers.iter().zip(&segments).filter(|(_, segment)| segment.layer == layer);
        Layer::Labels(known.map(|(number, segment)| (segment.value, *number)).collect())
    };
    let [nx, ny, nz] = header.dimensions;
    let along_x = nx.checked_mul(layers).ok_or(VolumeError::TooLarge { dimensions: header.dimensions })?;
    let stored = ImageHeader { dimensions: [along_x, ny, nz], ..header.clone() };
    let layers = if layers == 1 { vec![Layer::Plain] } else { (0..layers).map(of_layer).collect() };
    let data = Overlay::assembled(vec![Layers { header: stored, layers }], header.dimensions, padding);
    let front = padding.map(|[front, _]| -(front as f64));
    Ok(ImageHeader {
        dimensions: std::array::from_fn(|a| header.dimensions[a] + padding[a][0] + padding[a][1]),
        affine: header.affine.map(|affine| Affine { origin: affine.apply(front), ..affine }),
        scalar: ScalarType::I32,
        labels,
        data: Voxels::Assembled(data),
        ..header
    })
}

/// Whether such fields are there.
pub(super) fn is_segmentation(pairs: &HashMap<String, String>) -> bool {
    pairs.keys().any(|key| key.starts_with("Segmentation_") || key.starts_with("Segment0_"))
}

/// The segments that `key:=value` fields describe, in whatever order they stand; `layers` is how many the image has. What a
/// segment does not say follows from its place: in files of old each has a layer of its own, in which it is 1.
fn segments(pairs: &HashMap<String, String>, layers: usize) -> Vec<Segment> {
    let mut fields: BTreeMap<usize, HashMap<&str, &str>> = BTreeMap::new();
    for (key, value) in pairs {
        let Some((number, field)) = key.strip_prefix("Segment").and_then(|rest| rest.split_once('_')) else {
            continue;
        };
        if let Ok(number) = number.parse() {
            fields.entry(number).or_default().insert(field, value);
        }
    }
    let a_layer_each = fields.len() == layers;
    let segment = |(place, fields): (usize, &HashMap<&str, &str>)| {
        let number = |field: &str| fields.get(field)?.trim().parse::<i64>().ok();
        let stated = number("Layer").and_then(|layer| usize::try_from(layer).ok());
        let layer = stated.unwrap_or(if a_layer_each { place } else { 0 });
        let default = if a_layer_each && layers > 1 { 1 } else { place as i64 + 1 };
        let entry = LabelEntry {
            name: fields.get("Name").map(|name| (*name).to_owned()),
            colour: fields.get("Color").and_then(|text| colour(text)),
        };
        Segment { layer, value: number("LabelValue").unwrap_or(default), entry }
    };
    fields.values().enumerate().map(segment).collect()
}

/// Refuses two segments of one label in one layer, which no voxel tells apart.
fn check_apart(segments: &[Segment]) -> Result<(), ReadError> {
    let name = |segment: &Segment| segment.entry.name.clone().unwrap_or_else(|| "without a name".to_owned());
    for (number, one) in segments.iter().enumerate() {
        let same = |other: &&Segment| (other.layer, other.value) == (one.layer, one.value);
        if let Some(other) = segments[number + 1..].iter().find(same) {
            return Err(ReadError::Header {
                format: "NRRD",
                reason: format!(
                    "segments `{}` and `{}` have the same LabelValue {} in layer {}; export the segmentation again",
                    name(one),
                    name(other),
                    one.value,
                    one.layer
                ),
            });
        }
    }
    Ok(())
}

/// What a segment is called by: its own label, or, where layers use the same labels, its place in the list, from 1 on.
fn numbers_of(segments: &[Segment]) -> Vec<i32> {
    let mut own: Vec<i32> = segments.iter().filter_map(|segment| i32::try_from(segment.value).ok()).collect();
    let in_order = own.clone();
    own.sort_unstable();
    own.dedup();
    if own.len() == segments.len() { in_order } else { (1..).take(segments.len()).collect() }
}

/// Voxels of background that are put around a segmentation that was cropped, along x, y, z in front and behind: one where the image that it was
/// made on goes on, so that what ends at the cut is not taken for cut by the image.
fn padding(pairs: &HashMap<String, String>, dimensions: [usize; 3]) -> [[usize; 2]; 3] {
    let offset = pairs.get("Segmentation_ReferenceImageExtentOffset").and_then(|text| numbers::<i64>(text));
    let Some(offset) = offset.filter(|offset| offset.len() == 3) else { return [[0; 2]; 3] };
    let whole = pairs.get("Segmentation_ConversionParameters").and_then(|text| reference_extent(text));
    let cropped = offset.iter().any(|&first| first > 0);
    std::array::from_fn(|a| {
        let last = offset[a].saturating_add(dimensions[a] as i64 - 1);
        // Where nobody says how far the image went, a cropped one went on.
        let [first, end] = whole.map_or([0, if cropped { i64::MAX } else { last }], |whole| whole[a]);
        [usize::from(offset[a] > first), usize::from(last < end)]
    })
}

/// First and last index along x, y, z of the image that a segmentation was made on: the last six of the numbers that
/// describe its geometry.
fn reference_extent(parameters: &str) -> Option<[[i64; 2]; 3]> {
    let (_, geometry) = parameters.split_once("Reference image geometry|")?;
    let geometry = geometry.split('|').next()?;
    let values: Vec<f64> = geometry
        .split(';')
        .filter(|v| !v.trim().is_empty())
        .map(|v| v.trim().parse().ok())
        .collect::<Option<_>>()?;
    let extent = values.get(16..22)?;
    Some(std::array::from_fn(|a| [extent[2 * a] as i64, extent[2 * a + 1] as i64]))
}

/// Three shares of full brightness.
fn colour(text: &str) -> Option<[u8; 3]> {
    let shares: Vec<f64> = numbers(&text.replace(',', " "))?;
    Some([of_share(*shares.first()?), of_share(*shares.get(1)?), of_share(*shares.get(2)?)])
}
