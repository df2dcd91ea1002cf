//! What a caller says of a measurement, and the plan that it stands for: the defaults of every front end.

use super::{CalledObjects, LabelScales, Lengths, Plan, RegionImage, RunError, SampleImage, SelectionWords};
#[cfg(feature = "pictures")]
use super::{MapFile, MapStyle};
use crate::inputs::{OpenOptions, Preparation};
use crate::integrals::{QuadratureRule, Smearing};
use crate::io::RawLayout;
use crate::measurement::{Clip, CurvatureScale, Derivatives, EmbeddingKind, Measurement, Padding};
#[cfg(feature = "pictures")]
use crate::pictures::PictureKind;
#[cfg(feature = "pictures")]
use crate::surface::LocalQuantity;
use crate::volume::{LabelSelection, LabelTable, Spacing};
#[cfg(feature = "pictures")]
use std::path::PathBuf;

/// What a caller says of a measurement. What is left out follows from the rest.
///
/// ```
/// use surfometry::measurement::CurvatureScale;
/// use surfometry::runs::Choices;
/// let plan = Choices { sigma: "1.5".parse()?, ..Choices::default() }.plan(CurvatureScale::AsMeasured)?;
/// // Objects of which this blur loses detail are given back, for no embedding was asked for.
/// assert!(plan.recover);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Choices {
    /// Which labels, by number or by name.
    pub labels: SelectionWords,
    /// Spacing in mm, fastest axis first, in the place of the input's.
    pub spacing: Option<Spacing>,
    /// What is done to the voxels before.
    pub preparation: Preparation,
    /// Names of labels, which win over the input's own.
    pub names: LabelTable,
    /// How voxels are stored in files without a header.
    pub raw: Option<RawLayout>,
    /// Blur, mm.
    pub sigma: Lengths,
    /// Thickness of the band, mm.
    pub thickness: Lengths,
    /// Half-width of the delta in units of the field, in the place of a thickness.
    pub epsilon: Option<f64>,
    /// Level of the blurred mask that is the surface.
    pub level: Option<f64>,
    /// How an object becomes a field.
    pub embedding: Option<EmbeddingKind>,
    /// How the field is differentiated.
    pub derivatives: Option<Derivatives>,
    /// How voxels are summed.
    pub quadrature: Option<QuadratureRule>,
    /// Profile of the delta.
    pub delta: Option<Smearing>,
    /// What becomes of objects that the edge of the image cuts.
    pub clip: Clip,
    /// What lies beyond a given field.
    pub padding: Option<Padding>,
    /// The paper's choices; others that are made beside win.
    pub paper: bool,
    /// A label image whose labels are regions that each object is split by.
    pub regions: Option<String>,
    /// Whether the contacts between objects are measured.
    pub interfaces: bool,
    /// Volumes that are put on surfaces.
    pub samples: Vec<SampleImage>,
}

impl Choices {
    /// The plan that they stand for, checked.
    ///
    /// # Errors
    /// [`RunError`] for choices that contradict each other, whatever the input.
    pub fn plan(&self, curvature: CurvatureScale) -> Result<Plan, RunError> {
        let (labels, called_labels) = CalledObjects::of_selection(&self.labels);
        let (sigma_mm, called_sigma) = CalledObjects::of_lengths(self.sigma.own());
        let (thickness_mm, called_thickness) = CalledObjects::of_lengths(self.thickness.own());
        let called =
            CalledObjects { labels: called_labels, sigma_mm: called_sigma, thickness_mm: called_thickness };
        let plan = Plan {
            measurement: self.measurement(),
            scales: LabelScales { sigma_mm, thickness_mm },
            open: self.open_options(),
            labels,
            called,
            curvature,
            recover: self.embedding.is_none(),
            regions: self.regions.clone().map(RegionImage::of),
            interfaces: self.interfaces,
            samples: self.samples.clone(),
            ..Plan::default()
        };
        plan.check()?;
        match &plan.labels {
            LabelSelection::Groups(objects) if plan.called.labels.is_none() => plan.scales.check(objects)?,
            _ => {}
        }
        Ok(plan)
    }

    /// What is known better than by the input.
    pub fn open_options(&self) -> OpenOptions {
        OpenOptions {
            spacing: self.spacing.map(|spacing| spacing.mm()),
            raw: self.raw,
            preparation: self.preparation,
            names: self.names.clone(),
        }
    }

    fn measurement(&self) -> Measurement {
        let mut m = if self.paper { Measurement::paper() } else { Measurement::default() };
        m = m.embedding(self.embedding.unwrap_or_default()).clip(self.clip).padding(self.padding);
        if let Some(sigma) = self.sigma.of_all {
            m = m.sigma_mm(sigma.mm());
        }
        if let Some(thickness) = self.thickness.of_all {
            m = m.thickness_mm(thickness.mm());
        }
        if let Some(epsilon) = self.epsilon {
            m = m.thickness_mm(None).epsilon(epsilon);
        }
        if let Some(level) = self.level {
            m = m.level(level);
        }
        if let Some(derivatives) = self.derivatives {
            m = m.derivatives(derivatives);
        }
        if let Some(quadrature) = self.quadrature {
            m = m.quadrature(quadrature);
        }
        if let Some(delta) = self.delta {
            m = m.delta(delta);
        }
        m
    }

    /// Whether a choice says which field is measured, and so which surface is meant.
    #[cfg(feature = "pictures")]
    pub fn names_a_field(&self) -> bool {
        let lengths = !self.sigma.is_empty() || !self.thickness.is_empty() || self.epsilon.is_some();
        let scheme = self.derivatives.is_some() || self.quadrature.is_some() || self.delta.is_some();
        lengths || scheme || self.level.is_some() || self.embedding.is_some() || self.paper
    }

    /// Where a map's curvature is taken, if nothing is said of it. Pictures of the surface alone show the original
    /// one at its own scale, as do error bars, which no other has; what changes to a later one, whose noise is known at one
    /// scale alone, and all else is as measured.
    #[cfg(feature = "pictures")]
    pub fn scale_of_map<'a>(
        &self,
        style: &MapStyle,
        outputs: impl IntoIterator<Item = &'a PathBuf>,
    ) -> CurvatureScale {
        let quantity = style.picture.quantity;
        let of_surface = |kind: &PictureKind| matches!(kind, PictureKind::Surface | PictureKind::Histogram);
        let drawn = |path: &PathBuf| MapFile::of_path(path).is_some_and(MapFile::is_picture);
        let pictures = style.pictures.iter().all(of_surface) && outputs.into_iter().all(drawn);
        let of_blur = quantity == LocalQuantity::Displacement;
        let is_free = pictures && !of_blur && !self.names_a_field();
        // Of changes the noise is known at one scale alone, and a larger one than that of the numbers loses them.
        if !quantity.is_change() && (quantity.is_standard_error() || is_free) {
            CurvatureScale::Auto
        } else {
            CurvatureScale::AsMeasured
        }
    }

    /// Whether the blur follows each image's spacing.
    pub fn sigma_is_automatic(&self) -> bool {
        let papers = self.paper && self.sigma.is_empty();
        self.embedding.unwrap_or_default().is_blur() && !self.sigma.is_explicit() && !papers
    }
}
