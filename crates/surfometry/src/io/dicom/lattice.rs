//! The lattice that parallel frames lie on.

use super::error;
use super::frame::Plane;
use crate::io::ReadError;
use crate::space::dot;
use crate::volume::Affine;

/// Part of the distance of slices by which places may differ from even ones: positions are written with few digits.
const SLACK: f64 = 0.02;
/// Where planes count as one, mm.
const SAME_PLACE: f64 = 1e-4;
/// What positions that are written with two digits may be off, mm, up to a tenth of the distance of slices.
const ROUNDED: f64 = 0.01;
/// Gantry tilt, degrees, up to which the lattice may take it for its own shear.
const MOST_TILT: f64 = 1.0;

/// Parallel planes in order, each on a slice of its own or on those of others.
#[derive(Debug)]
pub(super) struct Stack {
    /// From the indices of a lattice (column, row, slice) to RAS, mm.
    pub(super) affine: Affine,
    pub(super) slices: usize,
    /// The slice of each plane.
    pub(super) slice_of: Vec<usize>,
}

/// How far slices are apart, where some may be missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Gaps {
    /// None may be missing.
    None,
    /// Empty ones are left out.
    Empty(Stated),
}

/// What a header says of the distance of slices, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stated {
    pub(super) spacing: Option<f64>,
    /// How thick a slice is, which may be less than the distance, or more.
    pub(super) thickness: Option<f64>,
}

impl Stack {
    /// Of planes in any order; `name` says which one is meant.
    ///
    /// # Errors
    /// Planes that are not parallel, gaps, steps that differ, a tilted gantry.
    pub(super) fn of(
        planes: &[Plane],
        gaps: Gaps,
        name: impl Fn(usize) -> String,
    ) -> Result<Self, ReadError> {
        let first = planes.first().ok_or_else(|| error("no frame"))?;
        if let Some(other) = planes.iter().position(|plane| !plane.is_like(first)) {
            return Err(error(format!(
                "{} and {} have other orientations or pixel spacings: mixed series; name a file of the one that is meant, or take the others out of the folder",
                name(0),
                name(other)
            )));
        }
        let normal = first.normal();
        let mut order: Vec<usize> = (0..planes.len()).collect();
        order.sort_by(|&a, &b| planes[a].place(normal).total_cmp(&planes[b].place(normal)));
        let places: Vec<f64> = order.iter().map(|&n| planes[n].place(normal)).collect();
        let step = step(&places, gaps);
        let (mut slice, mut slice_of) = (0, vec![0; planes.len()]);
        for n in 1..order.len() {
            let gap = places[n] - places[n - 1];
            let steps = if gaps == Gaps::None { 1.0 } else { (gap / step).round() };
            let slack = (SLACK * step * steps.max(1.0)).max(ROUNDED.min(step / 10.0));
            if (gap - steps * step).abs() > slack {
                return Err(error(format!(
                    "{} and {} are {gap:.4} mm apart, as a rule slices are {step:.4}: slices are missing, double or uneven; export \
                     the whole series again",
                    name(order[n - 1]),
                    name(order[n])
                )));
            }
            slice += steps as usize;
            slice_of[order[n]] = slice;
        }
        let slices = slice_of.iter().max().map_or(0, |last| last + 1);
        let [begin, end] = [order[0], order[order.len() - 1]].map(|n| planes[n].position);
        let along = match slices {
            1 => normal.map(|v| v * step),
            _ => std::array::from_fn(|w| (end[w] - begin[w]) / (slices - 1) as f64),
        };
        check_straight(&order, planes, begin, along, &slice_of, &name)?;
        let columns = [0, 1].map(|n| first.directions[n].map(|v| v * first.spacing[n]));
        let linear = std::array::from_fn(|w| [columns[0][w], columns[1][w], along[w]]);
        Ok(Self { affine: Affine { linear, origin: begin }.with_lps_swapped(), slices, slice_of })
    }
}

/// How far slices are apart: what most are; where some are left out, the spacing that the header says, if they lie on its
/// multiples, or what the nearest are. Of one slice there is nothing but what the header says.
fn step(places: &[f64], gaps: Gaps) -> f64 {
    let steps = places.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| *step > SAME_PLACE).collect();
    steps.sort_by(f64::total_cmp);
    let fits = |stated: &f64| {
        let off = |step: &f64| (step / stated - (step / stated).round()).abs();
        *stated > SAME_PLACE && steps.iter().all(|step| *step > stated / 2.0 && off(step) <= SLACK)
    };
    let known = match gaps {
        Gaps::None => steps.get(steps.len() / 2).copied(),
        Gaps::Empty(Stated { spacing, thickness }) => {
            let alone = || thickness.filter(|thickness| *thickness > SAME_PLACE);
            spacing.filter(fits).or(steps.first().copied()).or_else(alone)
        }
    };
    known.unwrap_or(1.0)
}

/// Refuses slices that are shifted in their planes, by a tilted gantry or otherwise.
fn check_straight(
    order: &[usize],
    planes: &[Plane],
    begin: [f64; 3],
    along: [f64; 3],
    slice_of: &[usize],
    name: &impl Fn(usize) -> String,
) -> Result<(), ReadError> {
    let length = libm::sqrt(dot(along, along));
    let tilt = libm::acos((dot(along, planes[0].normal()) / length).clamp(-1.0, 1.0)).to_degrees();
    if tilt > MOST_TILT {
        return Err(error(format!(
            "the slices are shifted against each other by {tilt:.2} degrees (gantry tilt): the voxels are no boxes; resample the series, as `dcm2niix` does"
        )));
    }
    let smallest = planes[0].spacing.into_iter().fold(f64::INFINITY, f64::min);
    let off = order.iter().find(|&&n| {
        let straight: [f64; 3] = std::array::from_fn(|w| begin[w] + along[w] * slice_of[n] as f64);
        (0..3).any(|w| (planes[n].position[w] - straight[w]).abs() > 0.05 * smallest.max(length))
    });
    match off {
        Some(&n) => Err(error(format!(
            "{} does not lie in line with the others: mixed series; export one series",
            name(n)
        ))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thickness_is_no_distance() {
        let step =
            |places: &[f64], spacing, thickness| step(places, Gaps::Empty(Stated { spacing, thickness }));
        assert_eq!(step(&[0.0, 2.0, 4.0, 8.0], None, Some(1.0)), 2.0);
        // Frames of empty slices may be left out.
        assert_eq!(step(&[0.0, 4.0, 8.0], Some(2.0), Some(1.0)), 2.0);
        assert_eq!(step(&[0.0, 4.0, 8.0], Some(3.0), Some(1.0)), 4.0);
        assert_eq!(step(&[5.0, 5.0], None, Some(1.5)), 1.5);
        assert_eq!(step(&[5.0, 5.0], Some(2.5), Some(1.5)), 2.5);
        assert_eq!(step(&[5.0], None, None), 1.0);
    }
}
