//! Label images of what the embeddings say: the voxels at which phi is negative.

use super::{FileLedger, InputObject, Item, Opened, Plan, Reading, RunError, Task};
use crate::accuracy::Flag;
use crate::inputs::with_parts;
use crate::io::write_labels;
use crate::measurement::{Parameters, VoxelQuantity};
use crate::tiling::{Block, IndexBox};
use crate::volume::{Grid, LabelGroup, LabelImage, LabelSelection};
use std::path::PathBuf;

/// Writes, for each input, the label image of the embedded objects: the voxels at which the phi of an object is
/// negative have its label, or the first of united ones; of a field or soft segmentation they are 1. Each
/// object is embedded as the plan's measurement says, by default in its blur: [`Plan::recover`] is not regarded,
/// for the recovering embedding gives the mask itself back. Objects of which nothing is left are failures; of
/// an input of which nothing is left no image is written. A voxel that several objects claim goes to the one whose phi
/// is the lowest there, for a blur the one with the largest share of the voxel, and of equals to the first;
/// at levels from 0.5 on the plain blur leaves no such voxels.
///
/// ```
/// use surfometry::{Control, io::read_labels, runs::{Batch, Collected, EmbedTask, FileLedger, Plan}};
/// let folder = tempfile::tempdir()?;
/// let file = folder.path().join("ball.nii.gz");
/// let (inputs, control) = (["phantom:ball?radius=8".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let task = EmbedTask { plan: Plan::default(), file: file.clone(), ledger: FileLedger::new(&inputs) };
/// batch.run(&task, &mut Collected::default())?;
/// // The blur leaves the smaller ball.
/// let inside = read_labels(&file).expect("it was written").mask(1).voxels() as f64;
/// assert!(inside < 4.0 / 3.0 * std::f64::consts::PI * 8f64.powi(3));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct EmbedTask {
    /// What is asked.
    pub plan: Plan,
    /// The image, NIfTI; where there are several inputs, `_NAME` goes before its ending.
    pub file: PathBuf,
    /// The files of the run.
    pub ledger: FileLedger,
}

/// What became of an object's voxels.
#[derive(Debug, Clone, PartialEq)]
pub struct EmbeddedObject {
    /// The input as named.
    pub input: String,
    /// Label, or labels that were united; `None` of a field or soft segmentation.
    pub label: Option<LabelGroup>,
    /// The choices, filled in.
    pub parameters: Parameters,
    /// The object's own voxels.
    pub voxels: u64,
    /// Voxels at which its phi is negative.
    pub inside: u64,
    /// Its own voxels of which that is not so.
    pub lost: u64,
    /// Voxels of which it is so that are not its own.
    pub gained: u64,
    /// Voxels of which it is so that another object has in the image.
    pub given_up: u64,
    /// What its measurement in this embedding would be flagged with.
    pub flags: Vec<Flag>,
}

impl EmbedTask {
    /// Refuses objects that share labels, whose voxels could have the value of only one; whatever the input.
    ///
    /// # Errors
    /// [`RunError::SharedLabel`].
    pub fn check(&self) -> Result<(), RunError> {
        refuse_shared(&self.plan.labels)
    }
}

fn refuse_shared(labels: &LabelSelection) -> Result<(), RunError> {
    match labels.shared() {
        Some((label, [first, second])) => Err(RunError::SharedLabel { label, first, second }),
        None => Ok(()),
    }
}

impl Task for EmbedTask {
    type Row = EmbeddedObject;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<EmbeddedObject>)) -> Result<(), RunError> {
        let path = with_parts(&self.file, input.part.as_slice());
        self.ledger.claim(&path)?;
        self.check()?;
        let plan = Plan { recover: false, ..self.plan.clone() };
        let reading = Reading::of(input, &plan)?;
        refuse_shared(&LabelSelection::Groups(reading.labels()))?;
        let mut claims = Claims::new(*input.source.grid());
        let mut objects = Vec::new();
        for object in reading.objects() {
            let object = object?;
            let found = claims.add(&object);
            let failure = (found.inside == 0).then(|| object.failure(&RunError::NoSurface));
            objects.push((found, failure));
            input.control.check()?;
        }
        if objects.iter().any(|(found, _)| found.inside > 0) {
            let image = LabelImage::from_voxels(claims.grid, &claims.labels)?;
            write_labels(&path, &image).map_err(|source| RunError::Write { path, source })?;
        }
        for ((found, failure), given_up) in objects.into_iter().zip(claims.given_up) {
            match failure {
                Some(failure) => input.fail(failure, out),
                None => out(Item::Row(EmbeddedObject { given_up, ..found })),
            }
        }
        Ok(())
    }
}

/// Which object has which voxel so far.
struct Claims {
    grid: Grid,
    labels: Vec<i64>,
    /// Number of the object, from 1 on, and its phi, of each voxel that one has.
    owners: Vec<(u32, f32)>,
    given_up: Vec<u64>,
}

impl Claims {
    fn new(grid: Grid) -> Self {
        let count = grid.voxel_count();
        Self { grid, labels: vec![0; count], owners: vec![(0, 0.0); count], given_up: Vec::new() }
    }

    fn add(&mut self, object: &InputObject) -> EmbeddedObject {
        self.given_up.push(0);
        let mask = object.object.mask();
        let mut found = EmbeddedObject {
            input: object.input().to_owned(),
            label: object.label.clone(),
            parameters: *object.object.parameters(),
            voxels: mask.voxels(),
            inside: 0,
            lost: 0,
            gained: 0,
            given_up: 0,
            flags: object.record().measured.flags,
        };
        let value = object.label.as_ref().map_or(1, |label| label.labels()[0]);
        let region = object.object.inside_region();
        if let Some(phi) = object.object.voxel_map(VoxelQuantity::Phi, &region) {
            self.claim(&phi, &region, value, |at| {
                found.inside += 1;
                found.gained += u64::from(!mask.get(at));
            });
        }
        found.lost = found.voxels - (found.inside - found.gained);
        found
    }

    /// Gives an object what it claims and no other has at a lower phi.
    fn claim(&mut self, phi: &Block<f32>, region: &IndexBox, value: i64, mut tell: impl FnMut([i64; 3])) {
        let number = self.given_up.len() as u32;
        let [nx, ny, _] = self.grid.dimensions().map(|n| n as i64);
        for (y, z) in region.rows() {
            for x in region.lower[0]..region.upper[0] {
                let depth = phi.values()[phi.offset([x, y, z])];
                if depth >= 0.0 {
                    continue;
                }
                tell([x, y, z]);
                let place = ((z * ny + y) * nx + x) as usize;
                let (owner, theirs) = self.owners[place];
                let wins = owner == 0 || depth < theirs;
                let loser = if wins { owner } else { number };
                if loser > 0 {
                    self.given_up[loser as usize - 1] += 1;
                }
                if wins {
                    self.owners[place] = (number, depth);
                    self.labels[place] = value;
                }
            }
        }
    }
}
