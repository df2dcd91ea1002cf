//! Which of several scales suits a vertex.

use super::rms_spacing;
use crate::volume::Spacing;
use std::f64::consts::SQRT_2;

/// Largest scale in units of sqrt(h R), with h the rms spacing and R the object's radius of curvature. Larger ones
/// go on lowering the error of smooth bodies, at a price: the time to recover an object grows with sigma's
/// fourth power.
const COARSEST: f64 = 1.6;
/// Least of it, in rms spacings: two scales at least.
const LEAST_COARSEST: f64 = 2.2;
/// Most of it, in smallest spacings: beyond, derivatives at vertices take ten times as long. Of thick slices at
/// least three rms spacings.
const MOST_COARSEST: f64 = 8.0;
const MOST_OF_SLICES: f64 = 3.0;
/// Least scale in rms spacings: below, all is noise.
const FINEST_SPACINGS: f64 = 1.5;
/// Noise of H with the corrected embedding at a vertex whose normal is away from the grid's axes, in units of
/// h^2 / sigma^3: rms over balls, tori and ellipsoids of 10 and 20 voxels.
const NOISE: f64 = 0.079;
/// Cosine of 16 degrees: where the normal is nearer to an axis of the grid the voxels' steps are wide.
const NEAR_AXIS: f64 = 0.96;
/// Noise there in units of that elsewhere.
const NEAR_SHARE: f64 = 1.9;
/// How many times its noise the local rms of what changes between a scale and a larger one may reach before
/// the larger one is taken to be biased. On smooth shapes 3 is passed by less than one vertex in a thousand.
const BIASED: f64 = 3.0;
/// Rms change between the two finest scales of a clean mask, in units of the finer one's noise, as its median
/// over a surface.
const CLEAN_CHANGE: f64 = 0.7;

/// Scales in mm, ascending by factors of sqrt 2, of which each vertex may have one or one between two: from 1.5
/// to 2.1 rms spacings up to 1.6 sqrt(h R), for an object whose larger principal curvature is 1/R in rms.
pub fn local_scales(spacing: Spacing, radius: f64) -> Vec<f64> {
    let h = rms_spacing(spacing);
    let most = (MOST_COARSEST * spacing.smallest()).max(MOST_OF_SLICES * h);
    let coarsest = (COARSEST * (h * radius).sqrt()).clamp(LEAST_COARSEST * h, most);
    let mut scales: Vec<f64> = (0..16)
        .map(|step| coarsest / SQRT_2.powi(step))
        .take_while(|&sigma| sigma >= FINEST_SPACINGS * h)
        .collect();
    scales.reverse();
    scales
}

/// Noise of H at a vertex, 1/mm, from sigma in mm and the largest component of its normal along the grid's axes.
pub(crate) fn vertex_noise(sigma: f64, spacing: Spacing, along_axis: f64) -> f64 {
    let share = if along_axis > NEAR_AXIS { NEAR_SHARE } else { 1.0 };
    share * NOISE * rms_spacing(spacing).powi(2) / sigma.powi(3)
}

/// How many times the noise of a clean mask a mask's noise is, at least 1, from changes between its two finest
/// scales in units of the finer one's noise.
pub(crate) fn noise_factor(mut changes: Vec<f64>) -> f64 {
    if changes.is_empty() {
        return 1.0;
    }
    let middle = changes.len() / 2;
    let (_, median, _) = changes.select_nth_unstable_by(middle, f64::total_cmp);
    (*median / CLEAN_CHANGE).max(1.0)
}

/// The largest scale that agrees with all smaller ones (Lepski's rule), by number: the rms change from scale
/// `fine` to scale `coarse`, both by number, in units of the finer one's noise, must stay below 3 for all
/// pairs up to there.
pub(crate) fn largest_agreeing(scales: usize, change: impl Fn(usize, usize) -> f64) -> usize {
    let agrees = |&coarse: &usize| (0..coarse).all(|fine| change(fine, coarse) < BIASED);
    (1..scales).take_while(agrees).last().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_reach_from_the_voxels_to_the_radius() {
        let spacing = Spacing::new([0.5; 3]).unwrap();
        let scales = local_scales(spacing, 10.0);
        let coarsest = 1.6 * 5f64.sqrt();
        assert!((scales.last().unwrap() - coarsest).abs() < 1e-12);
        assert!(scales.windows(2).all(|pair| (pair[1] / pair[0] - SQRT_2).abs() < 1e-12));
        assert!((0.75..1.07).contains(&scales[0]), "{scales:?}");
        // A tube of one voxel has two scales, a plane those up to eight voxels.
        assert_eq!(local_scales(spacing, 0.5).len(), 2);
        assert!((local_scales(spacing, 1e9).last().unwrap() - 4.0).abs() < 1e-12);
    }

    /// A change at the third scale ends it there, whatever the fourth says.
    #[test]
    fn the_largest_that_agrees_with_all_smaller_ones() {
        let changes = |at: usize| move |_: usize, coarse: usize| if coarse == at { 3.1 } else { 2.9 };
        assert_eq!([1, 2, 3, 4].map(|at| largest_agreeing(4, changes(at))), [0, 1, 2, 3]);
        assert_eq!(largest_agreeing(1, changes(0)), 0);
    }

    #[test]
    fn noise_is_never_taken_for_less_than_the_grids() {
        assert_eq!(noise_factor(vec![0.1, 0.2, 0.3]), 1.0);
        assert!((noise_factor(vec![9.0, 1.4, 0.1]) - 2.0).abs() < 1e-12);
        assert_eq!(noise_factor(Vec::new()), 1.0);
    }
}
