//! The lattice of voxel centres and where it lies in the world.

use super::shear::Shear;
use super::{Affine, Spacing, VolumeError};
use crate::tiling::IndexBox;
use serde::{Deserialize, Serialize};

/// Cosine between two image axes above which the affine counts as sheared. Oblique headers in f32 reach 1e-6,
/// rounded ones of some exporters 1e-4; 1e-3 (0.06 degrees) changes the area of a ball by less than 1e-6.
const SHEAR_TOLERANCE: f64 = 1e-3;
/// The same from which on an image is refused: 1 degree, and a hair of room for what f32 holds. Computed tomographs state
/// 0.01 to 0.5 degrees.
const MOST_SHEAR: f64 = 0.017_46;

/// Most voxels along an axis. Each slice and each row has memory of its own, however few voxels it has.
const LONGEST_AXIS: usize = 1 << 20;

/// Dimensions, spacing and index-to-world affine of an image. Axis 0 (x) is the fastest in memory.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Lattice", into = "Lattice")]
pub struct Grid {
    dimensions: [usize; 3],
    spacing: Spacing,
    affine: Affine,
}

/// What a grid is written as.
#[derive(Serialize, Deserialize)]
struct Lattice {
    dimensions: [usize; 3],
    affine: Affine,
}

impl From<Grid> for Lattice {
    fn from(Grid { dimensions, affine, .. }: Grid) -> Self {
        Self { dimensions, affine }
    }
}

impl TryFrom<Lattice> for Grid {
    type Error = VolumeError;

    fn try_from(Lattice { dimensions, affine }: Lattice) -> Result<Self, VolumeError> {
        Self::new(dimensions, affine)
    }
}

impl Grid {
    /// A grid in the world. Axes may be up to 1 degree from perpendicular; the spacings are scaled then so that their product is
    /// the voxel's true volume.
    ///
    /// # Errors
    /// [`VolumeError`] for an empty axis, too many voxels, a spacing that is not positive, or an affine that is sheared
    /// by more.
    pub fn new(dimensions: [usize; 3], affine: Affine) -> Result<Self, VolumeError> {
        check_dimensions(dimensions)?;
        if !affine.is_finite() {
            return Err(VolumeError::NonFiniteAffine);
        }
        let lengths = Spacing::new(affine.column_lengths())?;
        check_shear(&affine)?;
        let shrunk = libm::cbrt(affine.determinant().abs() / lengths.cell_volume());
        if strain(&affine) == 0.0 {
            return Ok(Self { dimensions, spacing: lengths, affine });
        }
        let spacing = Spacing::new(lengths.mm().map(|h| h * shrunk))?;
        Ok(Self { dimensions, spacing, affine })
    }

    /// By how much a length may differ from what it would be if the axes were perpendicular, as a share of it; 0 where they
    /// are, up to rounding.
    pub(crate) fn strain(&self) -> f64 {
        strain(&self.affine)
    }

    /// A grid whose axes are the world's and whose first voxel is the world's origin.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn axis_aligned(dimensions: [usize; 3], spacing: [f64; 3]) -> Result<Self, VolumeError> {
        Spacing::new(spacing)?;
        Self::new(dimensions, Affine::diagonal(spacing))
    }

    /// Of an image that knows its affine or not, with the spacing, mm, of a caller who knows better.
    ///
    /// # Errors
    /// As of [`Grid::new`], and [`VolumeError::MissingSpacing`] where neither is known.
    pub fn of_known(
        dimensions: [usize; 3],
        affine: Option<Affine>,
        spacing: Option<[f64; 3]>,
    ) -> Result<Self, VolumeError> {
        let affine = match (affine, spacing) {
            (None, None) => return Err(VolumeError::MissingSpacing),
            (Some(affine), None) => affine,
            (None, Some(spacing)) => Affine::diagonal(Spacing::new(spacing)?.mm()),
            (Some(affine), Some(spacing)) => {
                let spacing = Spacing::new(spacing)?.mm();
                if affine.is_finite() && Spacing::new(affine.column_lengths()).is_ok() {
                    affine.with_spacing(spacing)
                } else {
                    Affine::diagonal(spacing)
                }
            }
        };
        Self::new(dimensions, affine)
    }

    /// Voxels along x, y, z.
    pub fn dimensions(&self) -> [usize; 3] {
        self.dimensions
    }

    /// Spacing in mm.
    pub fn spacing(&self) -> Spacing {
        self.spacing
    }

    /// Index-to-world transform, mm, RAS.
    pub fn affine(&self) -> &Affine {
        &self.affine
    }

    /// How the axes differ from perpendicular ones; `None` where they do not, up to rounding.
    pub(crate) fn shear(&self) -> Option<Shear> {
        (self.strain() > 0.0).then(|| Shear::of(&self.affine, self.spacing))
    }

    /// The grid's axes, or the perpendicular ones nearest to them, unit vectors of the world; they may be left-handed.
    pub(crate) fn axes(&self) -> [[f64; 3]; 3] {
        let (affine, spacing) = (&self.affine, self.spacing.mm());
        match self.shear() {
            Some(shear) => *shear.axes(),
            None => std::array::from_fn(|a| affine.column(a).map(|step| step / spacing[a])),
        }
    }

    /// All voxel indices.
    pub fn index_box(&self) -> IndexBox {
        IndexBox::from_dimensions(self.dimensions)
    }

    /// Number of voxels.
    pub fn voxel_count(&self) -> usize {
        self.dimensions.iter().product()
    }

    /// Whether a box has voxels in the first or last slice of any axis, or beyond.
    pub(crate) fn is_touched_by(&self, bounds: &IndexBox) -> bool {
        let image = self.index_box();
        (0..3).any(|a| bounds.lower[a] <= image.lower[a] || bounds.upper[a] >= image.upper[a])
    }

    /// The cosine of the angle between a unit vector of the world and the nearest of the grid's axes.
    pub(crate) fn cosine_to_nearest_axis(&self, world: [f64; 3]) -> f64 {
        let along = |a: usize| {
            let axis = self.affine().column(a);
            ((0..3).map(|w| world[w] * axis[w]).sum::<f64>() / self.spacing().mm()[a]).abs()
        };
        (0..3).map(along).fold(0.0, f64::max)
    }

    /// Index (x, y, z) of the n-th voxel in memory.
    pub fn index_of(&self, offset: usize) -> [usize; 3] {
        let [nx, ny, _] = self.dimensions;
        [offset % nx, offset / nx % ny, offset / nx / ny]
    }
}

fn check_dimensions(dimensions: [usize; 3]) -> Result<(), VolumeError> {
    if dimensions.contains(&0) {
        return Err(VolumeError::EmptyAxis { dimensions: dimensions.to_vec() });
    }
    if let Some(axis) = dimensions.iter().position(|&n| n > LONGEST_AXIS) {
        return Err(VolumeError::LongAxis { axis, voxels: dimensions[axis], most: LONGEST_AXIS });
    }
    let voxels = dimensions.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
    // Room for 8-byte values and for signed index arithmetic with halos.
    match voxels {
        Some(n) if n <= isize::MAX as usize / 16 => Ok(()),
        _ => Err(VolumeError::TooLarge { dimensions }),
    }
}

/// Pairs of axes.
const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

fn check_shear(affine: &Affine) -> Result<(), VolumeError> {
    for (first, second) in PAIRS {
        let cosine = affine.cosine(first, second);
        if cosine.abs() > MOST_SHEAR {
            return Err(VolumeError::Sheared { first, second, degrees: libm::acos(cosine).to_degrees() });
        }
    }
    Ok(())
}

/// The largest principal strain between perpendicular axes and those of an affine: the largest root of x^3 - 3 p x - 2 q, which
/// are the eigenvalues of a symmetric matrix without diagonal, of which the other entries are half of the cosines.
fn strain(affine: &Affine) -> f64 {
    let cosines = PAIRS.map(|(first, second)| affine.cosine(first, second));
    if cosines.iter().all(|cosine| cosine.abs() <= SHEAR_TOLERANCE) {
        return 0.0;
    }
    let [a, b, c] = cosines.map(|cosine| cosine / 2.0);
    let (p, q) = ((a * a + b * b + c * c) / 3.0, (a * b * c).abs());
    2.0 * libm::sqrt(p) * libm::cos(libm::acos((q / (p * libm::sqrt(p))).min(1.0)) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_shear_and_absurd_sizes() {
        let mut affine = Affine::diagonal([1.0, 1.0, 1.0]);
        affine.linear[0][1] = 0.1;
        assert!(matches!(
            Grid::new([4, 4, 4], affine),
            Err(VolumeError::Sheared { first: 0, second: 1, .. })
        ));
        assert!(matches!(Grid::axis_aligned([4, 0, 4], [1.0; 3]), Err(VolumeError::EmptyAxis { .. })));
        assert!(matches!(Grid::axis_aligned([1 << 20; 3], [1.0; 3]), Err(VolumeError::TooLarge { .. })));
        let long = Grid::axis_aligned([4, 1 << 30, 4], [1.0; 3]);
        assert!(matches!(long, Err(VolumeError::LongAxis { axis: 1, .. })));
        affine = Affine::diagonal([1.0, f64::NAN, 1.0]);
        assert_eq!(Grid::new([4, 4, 4], affine), Err(VolumeError::NonFiniteAffine));
    }
}
