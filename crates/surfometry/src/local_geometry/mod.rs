//! Derivatives of the embedding at a voxel and the curvatures of the level set through it.

mod band_voxels;
mod curvature;
mod finite_difference;
mod gaussian_derivatives;
mod interpolation;
mod jet;
mod matched_band;
mod matched_difference;
mod matched_weights;
mod stencil;
mod unsheared;

pub use band_voxels::{BandVoxel, BandVoxels};
pub(crate) use band_voxels::{CAPACITY as BAND_CAPACITY, GROUP as BAND_GROUP};
pub use curvature::Curvature;
pub use finite_difference::FiniteDifferences;
pub use gaussian_derivatives::GaussianDerivatives;
pub use jet::Jet;
pub use matched_difference::MatchedDifferences;
pub(crate) use matched_weights::{CentralWeights, MatchedWeights, SIDE as MATCHED_SIDE, solved};
pub use stencil::MINIMUM_POINTS;
pub(crate) use stencil::Stencil;
pub(crate) use unsheared::Unsheared;

use crate::embedding::{Embedding, Precision};
use crate::tiling::{Block, IndexBox};

/// A scheme that differentiates an embedding near its surface.
///
/// Whoever asks has evaluated the embedding on [`Differentiation::field_region`] of a tile, once for all that
/// is wanted there.
///
/// Derivatives of one's own are integrated, and taken at points, like those of this crate. Here of a ball,
/// exact:
///
/// ```
/// use surfometry::embedding::Embedding;
/// use surfometry::integrals::{Band, Integrals, Quadrature, QuadratureRule, SmearedDelta, Smearing, integrate_boxes};
/// use surfometry::local_geometry::{BandVoxel, BandVoxels, Differentiation, Jet};
/// use surfometry::tiling::{Block, IndexBox, TILE};
/// use surfometry::volume::Spacing;
///
/// /// phi = |x|^2 / 2 R - R / 2 about voxel 0, in voxels of 1 mm.
/// struct Ball(f64);
///
/// impl Ball {
///     fn jet(&self, point: [f64; 3]) -> Jet {
///         let Ball(radius) = *self;
///         let square: f64 = point.iter().map(|v| v * v).sum();
///         let bend = 1.0 / radius;
///         Jet {
///             value: 0.5 * (square * bend - radius),
///             gradient: point.map(|v| v * bend),
///             hessian: [bend, bend, bend, 0.0, 0.0, 0.0],
///         }
///     }
///
///     fn at(&self, index: [i64; 3]) -> Jet {
///         self.jet(index.map(|v| v as f64))
///     }
/// }
///
/// impl Embedding for Ball {
///     type Value = f64;
///
///     fn support(&self, half_width: f64) -> IndexBox {
///         IndexBox::voxel([0; 3]).grown([(self.0 + half_width).ceil() as i64; 3])
///     }
///
///     fn halo(&self, _half_width: f64) -> [i64; 3] {
///         [0; 3]
///     }
///
///     fn evaluate_in(&self, storage: Vec<f64>, region: &IndexBox, _half_width: f64) -> Block<f64> {
///         let mut phi = Block::reusing(storage, *region, 0.0);
///         for (y, z) in region.rows() {
///             for (x, value) in (region.lower[0]..).zip(phi.row_mut(y, z)) {
///                 *value = self.at([x, y, z]).value;
///             }
///         }
///         phi
///     }
///
///     fn constant_on(&self, _region: &IndexBox, _half_width: f64) -> Option<f64> {
///         None
///     }
/// }
///
/// impl Differentiation for Ball {
///     type Field = Self;
///
///     fn embedding(&self) -> &Self {
///         self
///     }
///
///     fn field_region(&self, tile: &IndexBox) -> IndexBox {
///         tile.grown([1; 3])
///     }
///
///     fn visit_band(
///         &self,
///         field: &Block<f64>,
///         tile: &IndexBox,
///         half_width: f64,
///         visit: &mut dyn FnMut(&BandVoxels),
///     ) {
///         let rows = tile.rows().flat_map(|(y, z)| (tile.lower[0]..tile.upper[0]).map(move |x| [x, y, z]));
///         let near = rows.filter(|&index| field.get(index).abs() <= half_width);
///         BandVoxels::hand_on(near.map(|index| BandVoxel { index, jet: self.at(index) }), visit);
///     }
///
///     fn jets_at(&self, _field: &Block<f64>, points: &[[f64; 3]]) -> Vec<Jet> {
///         points.iter().map(|&point| self.jet(point)).collect()
///     }
/// }
///
/// let ball = Ball(12.3);
/// let band = Band::new(SmearedDelta::new(Smearing::Sine, 1.5, f64::INFINITY), 3.0);
/// let tiles = ball.support(2.0).tiles(TILE);
/// let sums = integrate_boxes(&ball, &tiles, &band, &Quadrature::unbounded(QuadratureRule::Sum));
/// let integrals = Integrals::of(&sums, Spacing::new([1.0; 3])?);
/// let area = 4.0 * std::f64::consts::PI * 12.3 * 12.3;
/// assert!((integrals.surface.area / area - 1.0).abs() < 0.01);
/// # Ok::<(), surfometry::volume::VolumeError>(())
/// ```
pub trait Differentiation: Sync {
    /// The embedding.
    type Field: Embedding;

    /// The field that is differentiated.
    fn embedding(&self) -> &Self::Field;

    /// Where the field must be known for a tile: at least on the tile and one voxel around it, as far as the
    /// field exists.
    fn field_region(&self, tile: &IndexBox) -> IndexBox;

    /// Hands on the voxels of a tile where |phi| <= `half_width`, with the first and second derivatives
    /// there, in an order that depends on nothing else.
    fn visit_band(
        &self,
        field: &FieldBlock<Self>,
        tile: &IndexBox,
        half_width: f64,
        visit: &mut dyn FnMut(&BandVoxels),
    );

    /// The field and its derivatives, taken there, at points of a tile off the grid: fractional voxel
    /// indices. Derivatives are along the image's axes, in mm. (Where these are not perpendicular, whoever
    /// measures turns them.)
    fn jets_at(&self, field: &FieldBlock<Self>, points: &[[f64; 3]]) -> Vec<Jet>;

    /// The field of a tile, in memory that was used before.
    fn tile_field(
        &self,
        storage: Vec<FieldValue<Self>>,
        tile: &IndexBox,
        half_width: f64,
    ) -> TileField<Self> {
        // A tile's cells reach one voxel beyond it.
        let cells = self.embedding().available(&IndexBox::new(tile.lower, tile.upper.map(|u| u + 1)));
        match self.embedding().constant_on(&cells, half_width) {
            Some(phi) => TileField::Constant(phi),
            None => TileField::Varying(self.embedding().evaluate_in(
                storage,
                &self.field_region(tile),
                half_width,
            )),
        }
    }

    /// The band's voxels in a tile.
    fn band(&self, tile: &IndexBox, half_width: f64) -> Vec<BandVoxel> {
        let mut voxels = Vec::new();
        if let TileField::Varying(field) = self.tile_field(Vec::new(), tile, half_width) {
            self.visit_band(&field, tile, half_width, &mut |band| voxels.extend(band.iter()));
        }
        voxels
    }

    /// As [`Differentiation::jets_at`], for points near each other, from the embedding.
    fn jets(&self, points: &[[f64; 3]]) -> Vec<Jet> {
        let Some(hull) = IndexBox::around(points) else { return Vec::new() };
        self.jets_at(&self.embedding().evaluate(&self.field_region(&hull), 0.0), points)
    }
}

/// Precision of a scheme's field.
pub type FieldValue<D> = <<D as Differentiation>::Field as Embedding>::Value;
/// A block of a scheme's field.
pub type FieldBlock<D> = Block<FieldValue<D>>;

/// The field that a tile needs.
pub enum TileField<D: Differentiation + ?Sized> {
    /// No voxel of the tile's cells lies in the band, and all are on one side of it: a value of that side.
    Constant(f64),
    /// The field on the region that the scheme needs for the tile.
    Varying(FieldBlock<D>),
}

/// Indices of a tile where |phi| <= `half_width`, in memory order.
fn band_indices<T: Precision>(field: &Block<T>, tile: &IndexBox, half_width: f64) -> Vec<[i64; 3]> {
    let mut indices = Vec::new();
    let bound = T::at_most(half_width);
    for (y, z) in tile.rows() {
        let start = field.offset([tile.lower[0], y, z]);
        for (x, &value) in (tile.lower[0]..tile.upper[0]).zip(&field.values()[start..]) {
            if value <= bound && -value <= bound {
                indices.push([x, y, z]);
            }
        }
    }
    indices
}
