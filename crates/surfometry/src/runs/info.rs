//! What an input holds.

use super::reading::Watched;
use super::{Item, Opened, RunError, Task};
use crate::accuracy::Flag;
use crate::inputs::Source;
use crate::tiling::IndexBox;
use crate::volume::{LabelEntry, LabelGroup, LabelImage, LabelSelection, Selected, VolumeError, hexadecimal};
use serde::Serialize;

/// Describes every input: format, lattice, orientation, labels.
///
/// ```
/// use surfometry::{Control, runs::{Batch, Collected, InfoTask}};
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let mut found = Collected::default();
/// batch.run(&InfoTask, &mut found)?;
/// assert_eq!(found.results[0].labels.len(), 1);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct InfoTask;

/// What an input holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputDescription {
    /// The input as named.
    pub input: String,
    /// Name of its format.
    pub format: &'static str,
    /// Type of its voxels, as NumPy names it.
    pub voxel_type: &'static str,
    /// Voxels along x, y, z.
    pub dimensions: [usize; 3],
    /// Spacing along x, y, z.
    pub spacing_mm: [f64; 3],
    /// Where the axes point: right or left, anterior or posterior, superior or inferior.
    pub axes: String,
    /// From index to world (RAS), mm.
    pub affine_ras_mm: AffineDescription,
    /// The labels that occur, background left out.
    pub labels: Vec<LabelDescription>,
    /// Warnings.
    pub flags: Vec<Flag>,
}

/// An index-to-world transform: world = linear * index + origin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AffineDescription {
    /// Rows of its matrix.
    pub linear: [[f64; 3]; 3],
    /// Where the first voxel is.
    pub origin: [f64; 3],
}

/// A label that occurs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LabelDescription {
    /// The label.
    pub label: i64,
    /// Its name, where the input holds one.
    pub name: Option<String>,
    /// Its colour in sRGB, as `#rrggbb`, where the input holds one.
    pub colour: Option<String>,
    /// Number of voxels.
    pub voxels: u64,
    /// Their volume.
    pub volume_mm3: f64,
    /// First and last voxel index along x, y, z, both inclusive.
    pub bounding_box: [[i64; 3]; 2],
}

impl Task for InfoTask {
    type Row = InputDescription;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<InputDescription>)) -> Result<(), RunError> {
        let Opened { name, source, control, .. } = input;
        let image = LabelImage::from_slabs(&mut Watched { slabs: source.slabs()?, input: name, control })?;
        let (grid, header) = (source.grid(), source.header());
        out(Item::Row(InputDescription {
            input: (*name).to_owned(),
            format: header.format,
            voxel_type: header.voxel_type,
            dimensions: grid.dimensions(),
            spacing_mm: grid.spacing().mm(),
            axes: grid.affine().axis_codes(),
            affine_ras_mm: AffineDescription { linear: grid.affine().linear, origin: grid.affine().origin },
            labels: described(&image, &**source)?,
            flags: source.flags(),
        }));
        Ok(())
    }
}

/// The labels that occur, or the segments.
fn described(image: &LabelImage, source: &dyn Source) -> Result<Vec<LabelDescription>, RunError> {
    let table = source.label_table();
    let entry = |label: &LabelGroup| table.get(label.labels()[0]).cloned().unwrap_or_default();
    let objects = match Selected::of(&LabelSelection::All, image, source.segments().as_ref()) {
        Err(VolumeError::NoForeground) => Vec::new(),
        objects => objects?,
    };
    let describe = |Selected { label, values }: Selected| {
        let parts = values.labels().iter().filter_map(|&value| image.summary(value));
        let (voxels, bounds) = parts.fold((0, IndexBox::EMPTY), |(voxels, bounds), part| {
            (voxels + part.voxels, bounds.hull(&part.bounds))
        });
        let LabelEntry { name, colour } = entry(&label);
        LabelDescription {
            label: label.labels()[0],
            name,
            colour: colour.map(hexadecimal),
            voxels,
            volume_mm3: voxels as f64 * image.grid().spacing().cell_volume(),
            bounding_box: [bounds.lower, bounds.upper.map(|u| u - 1)],
        }
    };
    Ok(objects.into_iter().map(describe).collect())
}
