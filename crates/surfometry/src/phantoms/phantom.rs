//! A shape in a pose, sampled on a grid.

use super::chance::Chance;
use super::{Pose, Shape, Truth};
use crate::volume::{Affine, Grid, LabelImage, Slab, SlabReader, VolumeError, check_made, made_slab};

/// Background voxels around a phantom.
const MARGIN: usize = 2;

/// A shape, where it lies, and the spacing of the grid that it is sampled on.
pub struct Phantom {
    shape: Box<dyn Shape>,
    pose: Pose,
    grid: Grid,
    jitter: f64,
    flips: f64,
}

impl Phantom {
    /// A phantom on a grid just large enough; the world's origin is the middle of the grid.
    ///
    /// # Errors
    /// [`VolumeError`] for a bad spacing or a grid that is too large.
    pub fn new(shape: impl Shape + 'static, pose: Pose, spacing: [f64; 3]) -> Result<Self, VolumeError> {
        let half = pose.half_extent(shape.half_extent());
        let reach: [f64; 3] = std::array::from_fn(|a| half[a] + pose.shift()[a].abs());
        crate::volume::Spacing::new(spacing)?;
        // The conversion saturates at what no grid accepts, with room for the margin.
        let voxels = |a: usize| (2.0 * reach[a] / spacing[a]).ceil().min(1e15) as usize;
        let dimensions: [usize; 3] = std::array::from_fn(|a| voxels(a) + 1 + 2 * MARGIN);
        check_made(dimensions)?;
        let mut affine = Affine::diagonal(spacing);
        affine.origin = std::array::from_fn(|a| -0.5 * (dimensions[a] - 1) as f64 * spacing[a]);
        Ok(Self {
            shape: Box::new(shape),
            pose,
            grid: Grid::new(dimensions, affine)?,
            jitter: 0.0,
            flips: 0.0,
        })
    }

    /// The same with slices along z that are shifted against each other in plane, as hand-drawn contours are,
    /// by a standard deviation of some mm. The truth stays that of the shape.
    #[must_use]
    pub fn with_jitter(self, mm: f64) -> Self {
        Self { jitter: mm, ..self }
    }

    /// The same with a share of the voxels beside the boundary, by faces, changed into the other kind.
    #[must_use]
    pub fn with_flips(self, share: f64) -> Self {
        Self { flips: share, ..self }
    }

    /// Exact integrals; `None` where their quadrature did not converge.
    pub fn truth(&self) -> Option<Truth> {
        self.shape.truth()
    }

    /// The shape, in its own frame.
    pub fn shape(&self) -> &dyn Shape {
        &*self.shape
    }

    /// Where it lies.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The label image: 1 where a voxel's centre lies inside.
    ///
    /// # Errors
    /// [`VolumeError::TooLarge`] where memory does not suffice.
    pub fn labels(&self) -> Result<LabelImage, VolumeError> {
        LabelImage::from_slabs(&mut self.slabs())
    }

    /// The label image as a stream of slabs.
    pub fn slabs(&self) -> PhantomSlabs<'_> {
        PhantomSlabs { phantom: self, next_slice: 0 }
    }

    fn slice(&self, z: usize, voxels: &mut [u8]) {
        let [nx, ..] = self.grid.dimensions();
        let mut chance = Chance::new(z as u64);
        let [dx, dy] = [(); 2].map(|()| chance.about_zero(2.0 * self.jitter));
        let is_inside = |index: [f64; 3]| {
            let world = self.grid.affine().apply(index);
            self.shape.value(self.pose.to_shape([world[0] + dx, world[1] + dy, world[2]])) < 0.0
        };
        for (n, voxel) in voxels.iter_mut().enumerate() {
            let index = [n % nx, n / nx, z].map(|i| i as f64);
            let inside = is_inside(index);
            // One random number a voxel, whether it is needed or not.
            let is_drawn = self.flips > 0.0 && chance.even() < self.flips;
            let is_beside = || {
                (0..6).any(|n| {
                    let mut neighbour = index;
                    neighbour[n / 2] += if n % 2 == 0 { 1.0 } else { -1.0 };
                    is_inside(neighbour) != inside
                })
            };
            *voxel = u8::from(inside != (is_drawn && is_beside()));
        }
    }
}

/// A phantom's voxels, slab by slab, as a file would yield them.
pub struct PhantomSlabs<'a> {
    phantom: &'a Phantom,
    next_slice: usize,
}

impl SlabReader for PhantomSlabs<'_> {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        &self.phantom.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        let phantom = self.phantom;
        let slice = |z: usize, voxels: &mut [u8]| phantom.slice(z, voxels);
        made_slab(phantom.grid.dimensions(), &mut self.next_slice, slice)
    }
}
