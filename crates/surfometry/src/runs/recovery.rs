//! Objects of which the blur loses detail are measured again, in the embedding that gives it back.

use super::{Plan, RunError};
use crate::accuracy::FlagCode;
use crate::measurement::{EmbeddingKind, Measured, Object};
use crate::{Control, Measurement};

/// What says that a blur may have lost something.
const DOUBTS: [FlagCode; 8] = [
    FlagCode::DetailLost,
    FlagCode::LargeError,
    FlagCode::ThinForSigma,
    FlagCode::NarrowGap,
    FlagCode::CompensationFailed,
    FlagCode::SurfaceVanished,
    FlagCode::ThicknessAboveObject,
    FlagCode::EulerDiffersFromVoxels,
];

/// The choices by which doubtful objects are measured again; `None` where the blur is the caller's own choice.
pub(super) fn recovering(plan: &Plan) -> Option<Measurement> {
    let own = plan.measurement != Measurement::default();
    (plan.recover && !own).then(|| Measurement::default().embedding(EmbeddingKind::Recovering))
}

/// Voxels from which on an object has a shape to speak of.
const LEAST_VOXELS: u64 = 30;
/// Surface, in faces of voxels, up to which an object is measured again without being asked: a second, and some 100 MB. Where
/// all of a large network hangs together, corrections take a hundred times as long as its blur.
const MOST_FACES: f64 = 65_536.0;

/// Whether an object is to be measured again.
pub(super) fn is_doubtful(measured: &Measured) -> bool {
    let spacing = measured.grid.spacing_mm;
    let face = spacing.iter().product::<f64>().cbrt().powi(2);
    // Of an object that the blur left nothing of, no more than its voxels are known.
    let unknown = 2.0 * measured.voxels.count as f64;
    let faces = measured.blurred.surface_area_mm2.map_or(unknown, |area| area / face);
    let feasible = measured.voxels.count >= LEAST_VOXELS && faces <= MOST_FACES;
    feasible && measured.flags.iter().any(|flag| DOUBTS.contains(&flag.code))
}

/// Standard error of the area as a share of it; without bound where there is none.
fn error_of_area(measured: &Measured) -> f64 {
    let error = measured.standard_error.surface_area_mm2.zip(measured.surface_area_mm2);
    error.map_or(f64::INFINITY, |(error, area)| error / area)
}

/// Measures an object again. It and its numbers, where their errors are the smaller ones.
pub(super) fn recovered(
    choices: &Measurement,
    object: &Object,
    measured: &Measured,
    control: &Control,
) -> Result<Option<(Object, Measured)>, RunError> {
    let again = choices.prepare(object.mask())?.under(control);
    let mut found = again.measure();
    control.check()?;
    if error_of_area(&found) >= error_of_area(measured) {
        return Ok(None);
    }
    found.timings = found.timings.plus(&measured.timings);
    Ok(Some((again, found)))
}
