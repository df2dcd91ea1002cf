//! How soft the edges of a soft segmentation are of themselves, before anything blurs them.

use super::{Flag, FlagCode};
use crate::volume::{ProbabilityImage, Spacing};

/// What a soft segmentation's values tell of it beside its surface.
///
/// Where they are *occupancies*, the share of each voxel that the object fills, the image is that of the
/// object's indicator averaged over voxels: blurred already, by a box whose variance along an axis of spacing
/// h is h^2 / 12. A mask, with no value between 0 and 1, is not.
///
/// Which of both an image is, and anything between, is told by the integral of p (1 - p). Across an edge that
/// is half the mean distance between two draws of whatever blurred it: 0.57 of its standard deviation, be it
/// a box, a Gaussian or a logistic curve, and 0 of a mask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftEdges {
    /// Sum of the values times a voxel's volume, mm^3: of occupancies, the object's volume.
    pub volume: f64,
    /// Integral of p (1 - p), mm^3.
    softness: f64,
    spacing: Spacing,
}

/// Integral of p (1 - p) across a flat edge of occupancies, in units of the standard deviation of a voxel
/// along the edge's normal: on the mean over directions, to 0.2 % for spacings up to 1 : 3. (Axis-aligned 1 /
/// sqrt 3 = 0.577; of a Gaussian edge 1 / sqrt pi = 0.564, of a logistic one 0.551.)
const INTEGRAL_ACROSS: f64 = 0.574;

/// Edges that are softer than occupancies' by more than this factor are told of.
const SOFTER: f64 = 1.3;

impl SoftEdges {
    /// Of an image.
    pub fn of(image: &ProbabilityImage) -> Self {
        let spacing = image.grid().spacing();
        let cell = spacing.cell_volume();
        Self { volume: cell * image.sum(|p| p), softness: cell * image.sum(|p| p * (1.0 - p)), spacing }
    }

    /// Whether all values are 0 or 1.
    pub fn are_hard(&self) -> bool {
        self.softness == 0.0
    }

    /// How wide the edges of a surface of some area are, against those of occupancies: 1 of these, 0 of a
    /// mask.
    pub fn relative_width(&self, area: f64) -> f64 {
        let spacing = self.spacing;
        let across = INTEGRAL_ACROSS * mean_over_directions(|normal| deviation_of_voxel(spacing, normal));
        self.softness / (area * across)
    }

    /// Variance of what blurred the image before it came, mm^2, on the mean over directions: that of the
    /// voxels where edges are as wide as occupancies' or wider, less in proportion where they are not, 0 of a
    /// mask.
    pub fn own_variance(&self, area: f64) -> f64 {
        let voxel = self.spacing.mm().iter().map(|h| h * h).sum::<f64>() / 36.0;
        voxel * self.relative_width(area).min(1.0).powi(2)
    }

    /// Whether edges are those of occupancies.
    pub fn are_occupancies(&self, area: f64) -> bool {
        (1.0 / SOFTER..=SOFTER).contains(&self.relative_width(area))
    }

    /// What is to be said of edges that are softer than occupancies'.
    pub fn flag(&self, area: f64) -> Option<Flag> {
        let width = self.relative_width(area);
        let message = format!(
            "values change from 0 to 1 over {width:.1} times the width that shares of voxels would: the segmentation is blurred or unsure of itself beyond its \
             voxels, which compensation does not take off (the surface is where the blurred values are at the level)"
        );
        (width > SOFTER).then(|| Flag::new(FlagCode::SofterThanVoxels, message))
    }
}

/// Standard deviation along a direction of a point anywhere in a voxel.
fn deviation_of_voxel(spacing: Spacing, direction: [f64; 3]) -> f64 {
    let square = direction.iter().zip(spacing.mm()).map(|(n, h)| (n * h).powi(2)).sum::<f64>();
    (square / 12.0).sqrt()
}

/// Over an octant, which of an even function in every coordinate is over all.
fn mean_over_directions(of: impl Fn([f64; 3]) -> f64) -> f64 {
    const STEPS: i32 = 24;
    let middle = |n: i32| (f64::from(n) + 0.5) / f64::from(STEPS);
    let mut sum = 0.0;
    for height in (0..STEPS).map(middle) {
        let radius = (1.0 - height * height).sqrt();
        for angle in (0..STEPS).map(middle) {
            let (sin, cos) = libm::sincos(angle * std::f64::consts::FRAC_PI_2);
            sum += of([radius * cos, radius * sin, height]);
        }
    }
    sum / f64::from(STEPS * STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;

    /// A tilted half space seen through a box, a Gaussian and a logistic curve of the same width: the same is
    /// found of all, and of its mask nothing.
    #[test]
    fn width_is_told_whatever_blurred_the_edge() {
        let (h, n) = ([1.0, 0.8, 1.5], [60, 70, 40]);
        let grid = Grid::axis_aligned(n, h).unwrap();
        let spacing = grid.spacing();
        // Nearly along z, so that it leaves through the four sides.
        let normal = [0.10, 0.16, (1.0 - 0.0356f64).sqrt()];
        let distance = |index: [usize; 3]| {
            (0..3).map(|a| normal[a] * h[a] * (index[a] as f64 - 0.5 * (n[a] - 1) as f64)).sum::<f64>()
        };
        let area = h[0] * h[1] * (n[0] * n[1]) as f64 / normal[2];
        let edges = |profile: &dyn Fn(f64) -> f64| {
            let values =
                (0..grid.voxel_count()).map(|i| profile(distance(grid.index_of(i))) as f32).collect();
            SoftEdges::of(&ProbabilityImage::new(grid, values).unwrap())
        };
        let width = 1.7;
        let expected = width / mean_over_directions(|direction| deviation_of_voxel(spacing, direction));
        let logistic = |x: f64| 1.0 / (1.0 + libm::exp(x * std::f64::consts::PI / (3f64.sqrt() * width)));
        let gaussian = |x: f64| 0.5 * libm::erfc(x / (std::f64::consts::SQRT_2 * width));
        let uniform = |x: f64| (0.5 - x / (12f64.sqrt() * width)).clamp(0.0, 1.0);
        for profile in [&logistic as &dyn Fn(f64) -> f64, &gaussian, &uniform] {
            let found = edges(profile).relative_width(area);
            assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
        }
        let hard = edges(&|x| f64::from(u8::from(x < 0.0)));
        assert!(hard.are_hard() && hard.own_variance(area) == 0.0 && hard.flag(area).is_none());
        assert!(edges(&gaussian).flag(area).is_some());
    }

    #[test]
    fn own_variance_is_the_voxels() {
        let cubic = Spacing::new([0.6; 3]).unwrap();
        let edges = SoftEdges { volume: 0.0, softness: 1e9, spacing: cubic };
        assert!((edges.own_variance(1.0) - 0.36 / 12.0).abs() < 1e-12);
        // 0.6 / sqrt 12 in any direction.
        let mean = mean_over_directions(|direction| deviation_of_voxel(cubic, direction));
        assert!((mean - 0.6 / 12f64.sqrt()).abs() < 1e-12);
    }
}
