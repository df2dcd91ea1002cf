//! How far a blur can spread an object, known without blurring it.

use super::setup::Setup;
use crate::embedding::GaussianKernel;
use crate::surface::cells_around;
use crate::tiling::IndexBox;
use crate::volume::Mask;

/// Bounds on the blurred indicator of an object in a box.
pub(super) struct BlurBound {
    /// Of the blur that adds; of a combination, what is taken off may be nothing.
    weight: f64,
    axes: [Axis; 3],
    /// The blurred indicator where the band ends, outside.
    band: f64,
}

/// A blur along one axis.
enum Axis {
    Taps(GaussianKernel),
    /// Of so many voxels that an error function will do.
    Fine {
        sigma: f64,
        spacing: f64,
    },
}

impl Axis {
    /// Voxels a sigma from which on samples and the integral differ by less than the hundredth that is added.
    const FINE: f64 = 20.0;

    fn new(sigma: f64, spacing: f64, truncation: f64) -> Self {
        if sigma > Self::FINE * spacing {
            Self::Fine { sigma, spacing }
        } else {
            Self::Taps(GaussianKernel::new(sigma, spacing, 0, truncation))
        }
    }

    /// The most that comes of so many voxels in a row.
    fn highest(&self, voxels: usize) -> f64 {
        match self {
            Self::Taps(kernel) => kernel.largest_sum(voxels),
            Self::Fine { sigma, spacing } => {
                let width = voxels as f64 * spacing;
                (1.01 * libm::erf(width / (2.0 * std::f64::consts::SQRT_2 * sigma))).min(1.0)
            }
        }
    }

    /// How many voxels beside as many in a row at most have more than a value.
    fn reach(&self, voxels: usize, value: f64) -> Option<i64> {
        let Self::Taps(kernel) = self else { return None };
        let taps = &kernel.taps()[kernel.radius()..];
        let is_below = |&distance: &usize| taps[distance..].iter().take(voxels).sum::<f64>() < value;
        Some((1..taps.len()).find(is_below).unwrap_or(taps.len()) as i64 - 1)
    }
}

impl BlurBound {
    /// `None` without a blur.
    pub(super) fn of(setup: &Setup) -> Option<Self> {
        let sigma = setup.parameters.sigma_mm?;
        let axis = |spacing| Axis::new(sigma, spacing, setup.truncation());
        Some(Self {
            weight: setup.parameters.embedding.profile(sigma).terms()[0].0,
            axes: setup.grid.spacing().mm().map(axis),
            band: setup.parameters.level_or_half() - setup.band.delta().half_width(),
        })
    }

    /// Whether the blurred indicator of an object in a box is known to stay below a value everywhere.
    ///
    /// It is at most that of the box, whose maximum is a product over the axes of the largest sum of as many
    /// neighbouring taps as the box is wide; and at most that of all voxels, `total`, in one place.
    pub(super) fn is_below(&self, bounds: &IndexBox, total: impl Fn() -> f64, value: f64) -> bool {
        let product = |extent: [usize; 3]| (0..3).map(|a| self.axes[a].highest(extent[a])).product::<f64>();
        self.weight * product(bounds.extent()) < value || self.weight * total() * product([1; 3]) < value
    }

    /// Whether the band of an object, and with it the surface, is known to be nowhere.
    pub(super) fn has_no_band(&self, mask: &Mask) -> bool {
        self.is_below(&mask.bounds(), || mask.voxels() as f64, self.band * (1.0 - 1e-6))
    }

    /// A box, of voxels that are worked on together, outside which the band of an object is known to be
    /// nowhere; `None` where no bound is known.
    pub(super) fn cells_of_band(&self, mask: &Mask) -> Option<IndexBox> {
        // Fields are in single precision.
        let band = self.band - 1e-4;
        let (bounds, extent) = (mask.bounds(), mask.bounds().extent());
        let highest: [f64; 3] = std::array::from_fn(|a| self.axes[a].highest(extent[a]));
        let mut reach = [0; 3];
        for a in 0..3 {
            // Beside the object's box the blur is at most what comes of a box as wide, so far off along that
            // axis.
            let others = self.weight * highest[(a + 1) % 3] * highest[(a + 2) % 3];
            reach[a] = self.axes[a].reach(extent[a], band / others)?;
        }
        (band > 0.0).then(|| cells_around(&bounds.grown(reach)))
    }
}
