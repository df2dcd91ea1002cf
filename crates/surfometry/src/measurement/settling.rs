//! Objects of which the blur loses detail are measured again, in the embedding that gives it back.

use super::{Clip, Derivatives, EmbeddingKind, MeasureError, Measured, Measurement, Object, SurfaceValues};
use crate::accuracy::FlagCode;
use crate::volume::{Mask, Shared};

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

/// Voxels from which on an object has a shape to speak of.
const LEAST_VOXELS: u64 = 30;
/// Surface, in faces of voxels, up to which an object is measured again without being asked: some seconds, and half a
/// gigabyte. Where all of a large network hangs together, corrections take ten times as long as its blur.
const MOST_FACES: f64 = 524_288.0;
/// The same where derivatives are not differences of the field but convolved at each vertex, which takes ten times as long.
const MOST_FACES_CONVOLVED: f64 = 65_536.0;

impl Measurement {
    /// As [`Measurement::run`]; but what the default choices are doubtful of is measured again in the recovering
    /// embedding, and the numbers of smaller error count: those of the command line. Choices of the caller's own
    /// are kept to.
    ///
    /// # Errors
    /// Those of [`Measurement::run`].
    ///
    /// ```
    /// use surfometry::{Measurement, measurement::EmbeddingKind, phantoms::Phantom};
    /// // A rod of which a blur of two voxels leaves nothing.
    /// let rod = Phantom::from_spec("capsule?radius=1.5&length=20&rotate=30,40,50")?;
    /// let measured = Measurement::default().run_settled(rod.labels()?.mask(1))?;
    /// assert_eq!(measured.parameters.embedding, EmbeddingKind::Recovering);
    /// let exact = rod.truth().expect("a closed form").surface_area;
    /// assert!((measured.surface_area_mm2.expect("an area") / exact - 1.0).abs() < 0.06);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run_settled(&self, mask: impl Shared<Mask>) -> Result<Measured, MeasureError> {
        let object = self.prepare(mask)?;
        let measured = object.measure();
        let Some(choices) = self.recovering() else { return Ok(measured) };
        Ok(again(&choices, &object, &measured)?.map_or(measured, |(_, recovered)| recovered))
    }

    /// The choices by which doubtful objects are measured again; `None` where the blur is the caller's own choice.
    pub(crate) fn recovering(&self) -> Option<Self> {
        // What becomes of cut objects says nothing of the others.
        let others = Self { clip: Clip::Cap, ..*self };
        (others == Self::default()).then(|| others.embedding(EmbeddingKind::Recovering))
    }
}

impl Measured {
    /// Whether the object is to be measured again.
    pub(crate) fn is_doubtful(&self) -> bool {
        let spacing = self.grid.spacing_mm;
        let face = spacing.iter().product::<f64>().cbrt().powi(2);
        let most = match self.parameters.derivatives {
            Derivatives::Matched => MOST_FACES,
            Derivatives::Gaussian | Derivatives::FiniteDifference => MOST_FACES_CONVOLVED,
        };
        // Of an object that the blur left nothing of, no more than its voxels are known.
        let unknown = 2.0 * self.voxels.count as f64;
        // Of stripes a voxel wide the band sees nothing, and of a checkerboard the mesh: there the error is the surface.
        let others = [self.mesh.surface_area_mm2, self.standard_error.surface_area_mm2];
        let largest = |area: f64| others.into_iter().flatten().fold(area, f64::max);
        let faces = self.blurred.surface_area_mm2.map_or(unknown, |area| largest(area) / face);
        let feasible = self.voxels.count >= LEAST_VOXELS && faces <= most;
        feasible && self.clip.is_none() && self.flags.iter().any(|flag| DOUBTS.contains(&flag.code))
    }

    /// What the errors of A and M amount to together: their product, in which neither's unit counts; without bound where
    /// one is not known. A alone would leave noisy masks to the blur, whose M then has no error to speak of.
    fn uncertainty(&self) -> f64 {
        let SurfaceValues { surface_area_mm2, total_mean_curvature_mm, .. } = self.standard_error;
        surface_area_mm2.zip(total_mean_curvature_mm).map_or(f64::INFINITY, |(area, mean)| area * mean)
    }
}

/// A doubtful object by other choices, with its numbers, where their errors are the smaller ones.
pub(crate) fn again(
    choices: &Measurement,
    object: &Object,
    measured: &Measured,
) -> Result<Option<(Object, Measured)>, MeasureError> {
    if !measured.is_doubtful() {
        return Ok(None);
    }
    let other = choices.prepare(object.mask())?.under(object.control());
    let mut found = other.measure();
    if found.uncertainty() >= measured.uncertainty() {
        return Ok(None);
    }
    found.timings = found.timings.plus(&measured.timings);
    Ok(Some((other, found)))
}
