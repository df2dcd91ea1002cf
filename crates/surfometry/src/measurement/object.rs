//! One object, ready for whatever is asked of it.

use super::clip::MeasuredPart;
use super::detail::{Watch, WrongSides};
use super::evaluation::{OpenPart, Totals};
use super::local_scales::AtScale;
use super::pass::{ObjectSums, Pass};
use super::recovery::{Recovered, RecoverySummary, check_recoverable, recovered};
use super::scheme::Scheme;
use super::setup::Setup;
use super::voxels::VoxelCounts;
use super::{EmbeddingKind, MeasureError, Measured, Measurement, Parameters, SurfaceValues};
use crate::Control;
use crate::embedding::{CorrectedMask, Indicator};
use crate::integrals::{Band, Integrals, Quadrature, SmearedDelta};
use crate::local_geometry::{FiniteDifferences, MINIMUM_POINTS};
use crate::surface::{Surface, VertexExtras};
use crate::tiling::IndexBox;
use crate::topology::VoxelTopology;
use crate::volume::{FieldImage, Grid, Mask, ProbabilityImage, Shared, VolumeError};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// An object with its parameters filled in and its field set up: the one that is measured, mapped and shown.
/// It owns what it needs, so that a thread or another language can hold it.
///
/// ```
/// use surfometry::{Measurement, phantoms::Phantom};
/// let ball = Phantom::from_spec("phantom:ball?radius=8")?.labels()?.mask(1);
/// let object = Measurement::default().prepare(ball)?;
/// let (measured, surface) = (object.measure(), object.surface());
/// assert_eq!(measured.mesh.triangles, Some(surface.mesh.triangles.len() as u64));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Object {
    pub(super) mask: Arc<Mask>,
    pub(super) setup: Setup,
    pub(super) content: Content,
    /// The same at the scales of which each vertex of its surface has one; none where all have that of `content`.
    pub(super) scales: Vec<AtScale>,
    /// Where it is measured, where the image cuts it and that is left out.
    pub(super) part: Option<MeasuredPart>,
    pub(super) preparation: Duration,
}

/// What an object's field is made of.
#[derive(Debug, Clone)]
pub(super) enum Content {
    /// The blur is known to leave nothing.
    Nothing,
    /// Voxels: the object's, or those of the object continued beyond the edge of its image.
    Mask(Arc<Mask>),
    /// Voxels with corrections.
    Corrected(Arc<CorrectedMask>, RecoverySummary),
    /// A soft segmentation.
    Probability(Arc<ProbabilityImage>),
    /// The field itself.
    Field(Arc<FieldImage>),
}

impl Measurement {
    /// Sets up one object; with [`Clip::Exclude`](super::Clip::Exclude), and where the edge of its image cuts
    /// it, the part between the cuts.
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask or parameters that make no sense.
    pub fn prepare(&self, mask: impl Shared<Mask>) -> Result<Object, MeasureError> {
        let (mask, start) = (mask.shared(), Instant::now());
        let setup = Setup::of_masks(self, *mask.grid())?;
        if mask.is_empty() {
            return Err(VolumeError::NoForeground.into());
        }
        let cut = self.cut(&mask)?;
        let part = cut.as_ref().map(|cut| cut.part);
        let voxels = cut.map_or_else(|| Arc::clone(&mask), |cut| Arc::new(cut.continued));
        if let Some(radius) = self.radius_of_scales {
            return Ok(self.at_local_scales(setup, &mask, radius));
        }
        if self.embedding == EmbeddingKind::Recovering {
            Scheme::check_reach(&setup)?;
            check_recoverable(&setup)?;
            let (corrected, recovered) = recovered(&setup, &mask);
            let content = Content::Corrected(Arc::new(corrected), recovered);
            let (part, preparation) = (None, start.elapsed());
            return Ok(Object { mask, setup, content, scales: Vec::new(), part, preparation });
        }
        let leaves_something = Scheme::of_mask(&setup, &voxels)?.is_some();
        let content = match part {
            Some(part) if part.region.is_empty() => Content::Nothing,
            _ if leaves_something => Content::Mask(voxels),
            _ => Content::Nothing,
        };
        Ok(Object { mask, setup, content, scales: Vec::new(), part, preparation: start.elapsed() })
    }

    /// Sets up the level set phi = 0 of a field that is an embedding already.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, a field without negative voxels, or one of fewer
    /// than six voxels along an axis.
    pub fn prepare_field(&self, field: impl Shared<FieldImage>) -> Result<Object, MeasureError> {
        let (field, start) = (field.shared(), Instant::now());
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
        let highest = field.values().highest();
        if highest <= 0.0 {
            return Err(VolumeError::NothingOutside.into());
        }
        let differences = FiniteDifferences::new(&*field, grid.spacing().mm());
        // A band of thickness t spans t |grad phi| in units of phi.
        let slope = differences.gradient_at_surface(&mask).filter(|g| g.is_finite() && *g > 0.0);
        match (self.epsilon, slope) {
            (Some(_), Some(slope)) => parameters.thickness_mm /= slope,
            (Some(_), None) => {}
            (None, slope) => parameters.epsilon *= slope.ok_or(MeasureError::FlatField)?,
        }
        if parameters.epsilon >= highest {
            return Err(MeasureError::BandAboveField { epsilon: parameters.epsilon, highest });
        }
        parameters.padding = self.padding.map(|padding| padding.of(highest));
        if let Some(value) = parameters.padding.filter(|padding| *padding <= parameters.epsilon) {
            let range = "above epsilon, the half-width of the band in units of the field";
            return Err(MeasureError::OutOfRange { name: "padding", value, range });
        }
        let quadrature = match parameters.padding {
            None => Quadrature::bounded(measurement.quadrature, grid.dimensions()),
            Some(_) => Quadrature::unbounded(measurement.quadrature),
        };
        let delta = SmearedDelta::new(measurement.delta, parameters.epsilon, f64::INFINITY);
        let setup = Setup {
            measurement,
            parameters,
            band: Band::new(delta, parameters.thickness_mm),
            quadrature,
            grid: *grid,
            weights: None,
            errors: None,
            terraces: None,
            soft: None,
            control: Control::default(),
        };
        let (mask, content) = (Arc::new(mask), Content::Field(field));
        let preparation = start.elapsed();
        Ok(Object { mask, setup, content, scales: Vec::new(), part: None, preparation })
    }
}

impl Object {
    /// The voxels: of a field, those where it is negative; of a soft segmentation, those whose values exceed
    /// the level.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// The control that it is under.
    pub(super) fn control(&self) -> &Control {
        &self.setup.control
    }

    /// The same under a control: once that says stop, whatever is asked of the object ends early and is not
    /// to be used. [`Control::check`] tells.
    #[must_use]
    pub fn under(mut self, control: &Control) -> Self {
        self.setup.control = control.clone();
        self
    }

    /// The image's lattice.
    pub fn grid(&self) -> &Grid {
        self.mask.grid()
    }

    /// The choices, filled in.
    pub fn parameters(&self) -> &Parameters {
        &self.setup.parameters
    }

    /// The field with its derivatives; `None` where the blur is known to leave nothing.
    pub(super) fn scheme(&self) -> Option<Scheme<'_>> {
        match &self.content {
            Content::Nothing => None,
            Content::Mask(mask) => Some(Scheme::of_part(&self.setup, mask)),
            Content::Corrected(mask, _) => Scheme::of_blur(&self.setup, &**mask),
            Content::Probability(image) => Scheme::of_blur(&self.setup, &**image),
            Content::Field(field) => Some(Scheme::of_field(&self.setup, field)),
        }
    }

    /// Whether each vertex of its surface has a scale of its own.
    pub fn has_scales_of_vertices(&self) -> bool {
        self.setup.measurement.radius_of_scales.is_some()
    }

    /// The smeared delta.
    pub fn delta(&self) -> &SmearedDelta {
        self.setup.band.delta()
    }

    /// Where there is a field: everywhere, unless it is given and ends with its image.
    pub fn available(&self, region: &IndexBox) -> IndexBox {
        match self.setup.parameters.embedding {
            EmbeddingKind::Given if self.setup.parameters.padding.is_none() => {
                region.intersection(&self.grid().index_box())
            }
            _ => *region,
        }
    }

    /// The surface phi = 0 with the geometry at its vertices; empty where the blur left nothing.
    pub fn surface(&self) -> Surface {
        if !self.scales.is_empty() {
            return self.surface_at_local_scales();
        }
        let Some(scheme) = self.scheme() else { return Surface::default() };
        let parameters = self.setup.parameters;
        let uncorrected = Setup { parameters: parameters.uncorrected(), ..self.setup.clone() };
        let indicator: &dyn Indicator = match &self.content {
            Content::Probability(image) => &**image,
            _ => &*self.mask,
        };
        let plain =
            parameters.embedding.is_corrected().then(|| Scheme::of_blur(&uncorrected, indicator)).flatten();
        let plain_jets =
            |points: &[[f64; 3]]| plain.as_ref().map(|plain| plain.jets(points)).unwrap_or_default();
        let kind = match parameters.sigma_mm {
            Some(sigma) if plain.is_some() => {
                VertexExtras::Errors { sigma, spacing: self.grid().spacing(), plain_jets: &plain_jets }
            }
            _ => parameters.shift_sigma().map_or(VertexExtras::None, |sigma| VertexExtras::Shift { sigma }),
        };
        scheme.surface(self.grid(), &self.setup.band, &kind, self.region(), &self.setup.control)
    }

    /// The same with curvature alone at its vertices, neither shifts nor standard errors.
    pub(super) fn bare_surface(&self) -> Surface {
        let Some(scheme) = self.scheme() else { return Surface::default() };
        let Setup { band, control, .. } = &self.setup;
        scheme.surface(self.grid(), band, &VertexExtras::None, self.region(), control)
    }

    /// The scheme, and |phi| at 0.6 voxels from a flat surface.
    pub(super) fn beside_surface(&self) -> Option<(Scheme<'_>, f64)> {
        let slope = self.setup.parameters.profile()?.slope(0.0).abs();
        Some((self.scheme()?, 0.6 * slope * self.grid().spacing().geometric_mean()))
    }

    /// What compares its field with the voxels that it was made of.
    fn watch(&self) -> Option<Watch<'_>> {
        match &self.content {
            Content::Mask(mask) => self.setup.watch(mask, self.region().unwrap_or(IndexBox::EVERYTHING)),
            Content::Corrected(mask, _) => self.setup.watch(mask.mask(), IndexBox::EVERYTHING),
            _ => None,
        }
    }

    /// Voxels on the wrong side of the surface: what the blur took for good, and what it filled. None where there is
    /// no blur of voxels, or where it leaves nothing.
    pub fn wrong_sides(&self) -> WrongSides {
        let pass = Pass {
            region: self.region(),
            watch: self.watch().map(Watch::with_places),
            ..self.setup.pass(false)
        };
        self.scheme().map(|scheme| scheme.sums(&pass).detail.places()).unwrap_or_default()
    }

    /// What the tiles of the measured part add up to.
    fn sums(&self, with_surface: bool) -> ObjectSums {
        let pass = Pass { region: self.region(), watch: self.watch(), ..self.setup.pass(with_surface) };
        self.scheme().map(|scheme| scheme.sums(&pass)).unwrap_or_default()
    }

    /// The part that is measured, with what its boundary adds.
    fn open(&self) -> Option<OpenPart> {
        let part = self.part?;
        let boundary = self.scheme().map(|scheme| part.boundary(&scheme, &self.setup));
        Some(OpenPart { part, boundary: boundary.unwrap_or_default() })
    }

    pub(super) fn region(&self) -> Option<IndexBox> {
        self.part.map(|part| part.region)
    }

    /// Integrals over phi = 0, and V, A, M and M / A of the original object, without mesh, topology and
    /// flags.
    pub fn integrals(&self) -> [SurfaceValues; 2] {
        self.setup.values(&self.sums(false), self.open().as_ref())
    }

    /// The integrals as they were summed; `None` where nothing is inside the level set.
    pub(super) fn plain_integrals(&self) -> Option<Integrals> {
        self.setup.surviving(&self.sums(false))
    }

    /// All numbers at other blurs, mm, the rest of the choices as they are; those that make no sense are left
    /// out.
    pub fn measure_at(&self, sigmas: &[f64]) -> Vec<Measured> {
        let counted = self.counted();
        let measured = |&sigma: &f64| {
            // How an object depends on the blur is seen without what undoes that.
            let measurement = match self.setup.measurement.embedding {
                EmbeddingKind::Recovering => self.setup.measurement.embedding(EmbeddingKind::Gaussian),
                _ => self.setup.measurement,
            };
            let measurement = measurement.sigma_mm(sigma);
            let object = match &self.content {
                Content::Probability(image) => measurement.prepare_probability(image),
                _ => measurement.prepare(&self.mask),
            };
            object.ok().map(|object| object.measure_counted(&counted))
        };
        sigmas.iter().filter_map(measured).collect()
    }

    /// All numbers.
    pub fn measure(&self) -> Measured {
        self.measure_counted(&self.counted())
    }

    /// The voxels' numbers and their topology.
    fn counted(&self) -> Totals {
        let start = Instant::now();
        let topology = VoxelTopology::of(&self.mask);
        let voxels = VoxelCounts::of(&self.mask, &self.grid().index_box());
        Totals { topology, voxels, topology_time: start.elapsed(), ..Totals::default() }
    }

    /// What corrections did and the surface that came of it, and the time that took.
    fn recovered(&self) -> (Option<Recovered>, Duration) {
        let Content::Corrected(_, summary) = &self.content else { return <_>::default() };
        let start = Instant::now();
        let recovered = Recovered::new(*summary, &self.bare_surface(), self.grid(), self.setup.errors);
        (Some(recovered), self.preparation + start.elapsed())
    }

    /// All numbers, of voxels that were counted.
    fn measure_counted(&self, counted: &Totals) -> Measured {
        let start = Instant::now();
        let sums = self.sums(true);
        let integrated = self.preparation + sums.times.share_of_integrals(start.elapsed());
        let (recovered, recover_time) = self.recovered();
        let totals = Totals { sums, open: self.open(), integrated, recovered, recover_time, ..*counted };
        self.setup.measured(&totals)
    }
}
