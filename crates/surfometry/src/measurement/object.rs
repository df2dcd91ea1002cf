//! One object, ready for whatever is asked of it.

use super::clip::{CutObject, MeasuredPart};
use super::pass::{ObjectSums, Pass};
use super::scheme::Scheme;
use super::setup::{OpenPart, Setup, Totals};
use super::{EmbeddingKind, MeasureError, Measured, Measurement, Parameters, SurfaceValues};
use crate::integrals::{Band, Integrals, Quadrature, SmearedDelta};
use crate::local_geometry::{FiniteDifferences, MINIMUM_POINTS};
use crate::surface::{Surface, VertexExtras};
use crate::tiling::IndexBox;
use crate::volume::{FieldImage, Grid, Mask, VolumeError};
use std::borrow::Cow;
use std::time::{Duration, Instant};

/// An object with its parameters filled in and its field set up: the one that is measured, mapped and shown.
pub struct Object<'a> {
    pub(super) mask: Cow<'a, Mask>,
    pub(super) setup: Setup,
    /// `None` where the blur is known to leave nothing.
    pub(super) scheme: Option<Scheme<'a>>,
    /// Where it is measured, where the image cuts it and that is left out.
    pub(super) part: Option<MeasuredPart>,
    preparation: Duration,
}

impl Measurement {
    /// Sets up one object.
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask or parameters that make no sense.
    pub fn prepare<'a>(&self, mask: &'a Mask) -> Result<Object<'a>, MeasureError> {
        let start = Instant::now();
        let setup = Setup::of_masks(self, *mask.grid())?;
        if mask.is_empty() {
            return Err(VolumeError::NoForeground.into());
        }
        let scheme = Scheme::of_mask(&setup, mask)?;
        Ok(Object { mask: Cow::Borrowed(mask), setup, scheme, part: None, preparation: start.elapsed() })
    }

    /// Sets up an object from what [`Measurement::cut`] made of it; as [`Measurement::prepare`] does where that is nothing.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense.
    pub fn prepare_cut<'a>(
        &self,
        mask: &'a Mask,
        cut: Option<&'a CutObject>,
    ) -> Result<Object<'a>, MeasureError> {
        let Some(cut) = cut else { return self.prepare(mask) };
        let start = Instant::now();
        let setup = Setup::of_masks(self, *mask.grid())?;
        let scheme = Scheme::of_mask(&setup, &cut.continued)?.filter(|_| !cut.part.region.is_empty());
        let part = Some(cut.part);
        Ok(Object { mask: Cow::Borrowed(mask), setup, scheme, part, preparation: start.elapsed() })
    }

    /// Sets up the level set phi = 0 of a field that is an embedding already.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, a field without negative voxels, or one of fewer than six
    /// voxels along an axis.
    pub fn prepare_field<'a>(&self, field: &'a FieldImage) -> Result<Object<'a>, MeasureError> {
        let start = Instant::now();
        let measurement = Self { embedding: EmbeddingKind::Given, ..*self };
        let grid = field.grid();
        if let Some(axis) = grid.dimensions().iter().position(|&n| n < MINIMUM_POINTS) {
            return Err(MeasureError::FieldTooSmall { axis, voxels: grid.dimensions()[axis] });
        }
        let mut parameters = Parameters::resolve(&measurement, grid.spacing())?;
        let mask = field.inside();
        if mask.is_empty() {
            return Err(VolumeError::NothingInside.into());
        }
        let differences = FiniteDifferences::new(field, grid.spacing().mm());
        // A band of thickness t spans t |grad phi| in units of phi.
        let slope = differences.gradient_at_surface(&mask).filter(|g| g.is_finite() && *g > 0.0);
        match (self.epsilon, slope) {
            (Some(_), Some(slope)) => parameters.thickness_mm /= slope,
            (Some(_), None) => {}
            (None, slope) => parameters.epsilon *= slope.ok_or(MeasureError::FlatField)?,
        }
        let highest = field.values().highest();
        if parameters.epsilon >= highest {
            return Err(MeasureError::BandAboveField { epsilon: parameters.epsilon, highest });
        }
        let delta = SmearedDelta::new(measurement.delta, parameters.epsilon, f64::INFINITY);
        let setup = Setup {
            measurement,
            parameters,
            band: Band::new(delta, parameters.thickness_mm),
            quadrature: Quadrature::bounded(measurement.quadrature, grid.dimensions()),
            grid: *grid,
            weights: None,
            errors: None,
            terraces: None,
        };
        let scheme = Some(Scheme::Given(differences));
        Ok(Object { mask: Cow::Owned(mask), setup, scheme, part: None, preparation: start.elapsed() })
    }
}

impl Object<'_> {
    /// The voxels: of a field, those where it is negative.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// The image's lattice.
    pub fn grid(&self) -> &Grid {
        self.mask.grid()
    }

    /// The choices, filled in.
    pub fn parameters(&self) -> &Parameters {
        &self.setup.parameters
    }

    /// The smeared delta.
    pub fn delta(&self) -> &SmearedDelta {
        self.setup.band.delta()
    }

    /// Where there is a field: everywhere, unless it is given and ends with its image.
    pub fn available(&self, region: &IndexBox) -> IndexBox {
        match self.setup.parameters.embedding {
            EmbeddingKind::Given => region.intersection(&self.grid().index_box()),
            _ => *region,
        }
    }

    /// The surface phi = 0 with the geometry at its vertices; empty where the blur left nothing.
    pub fn surface(&self) -> Surface {
        let Some(scheme) = &self.scheme else { return Surface::default() };
        let (parameters, mask) = (self.setup.parameters, &*self.mask);
        let uncorrected = Setup { parameters: parameters.uncorrected(), ..self.setup };
        let plain =
            (parameters.embedding == EmbeddingKind::Corrected).then(|| Scheme::of_part(&uncorrected, mask));
        let plain_jets =
            |points: &[[f64; 3]]| plain.as_ref().map(|plain| plain.jets(points)).unwrap_or_default();
        let kind = match parameters.sigma_mm {
            Some(sigma) if plain.is_some() => {
                VertexExtras::Errors { sigma, spacing: self.grid().spacing(), plain_jets: &plain_jets }
            }
            _ => parameters.shift_sigma().map_or(VertexExtras::None, |sigma| VertexExtras::Shift { sigma }),
        };
        scheme.surface(self.grid(), &self.setup.band, &kind, self.region())
    }

    /// The scheme, and |phi| at 0.6 voxels from a flat surface.
    pub(super) fn beside_surface(&self) -> Option<(&Scheme<'_>, f64)> {
        let slope = self.setup.parameters.profile()?.slope(0.0).abs();
        Some((self.scheme.as_ref()?, 0.6 * slope * self.grid().spacing().geometric_mean()))
    }

    /// What the tiles of the measured part add up to.
    fn sums(&self, with_surface: bool) -> ObjectSums {
        let pass = Pass { region: self.region(), ..self.setup.pass(with_surface) };
        self.scheme.as_ref().map(|scheme| scheme.sums(&pass)).unwrap_or_default()
    }

    /// The part that is measured, with what its boundary adds.
    fn open(&self) -> Option<OpenPart> {
        let part = self.part?;
        let boundary = self.scheme.as_ref().map(|scheme| part.boundary(scheme, &self.setup));
        Some(OpenPart { part, boundary: boundary.unwrap_or_default() })
    }

    fn region(&self) -> Option<IndexBox> {
        self.part.map(|part| part.region)
    }

    /// Integrals over phi = 0, and V, A, M and M / A of the original object, without mesh, topology and flags.
    pub fn integrals(&self) -> [SurfaceValues; 2] {
        self.setup.values(&self.sums(false), self.open().as_ref())
    }

    /// The integrals as they were summed; `None` where nothing is inside the level set.
    pub(super) fn plain_integrals(&self) -> Option<Integrals> {
        self.setup.surviving(&self.sums(false))
    }

    /// All numbers at other blurs, mm, the rest of the choices as they are; those that make no sense are left out.
    pub fn measure_at(&self, sigmas: &[f64]) -> Vec<Measured> {
        let measured = |&sigma: &f64| self.setup.measurement.sigma_mm(sigma).run(&self.mask).ok();
        sigmas.iter().filter_map(measured).collect()
    }

    /// All numbers.
    pub fn measure(&self) -> Measured {
        let start = Instant::now();
        let sums = self.sums(true);
        let integrated = self.preparation + sums.times.share_of_integrals(start.elapsed());
        let mut totals = Totals { sums, open: self.open(), integrated, ..Totals::default() };
        totals.add_voxels(&self.mask, i64::MIN / 2..i64::MAX / 2);
        self.setup.measured(&totals)
    }
}
