//! A cohort that anyone can make, after the one of Besler et al.

use super::chance::Chance;

/// A bone of the cohort: what its file is called, and the phantom that it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CohortMember {
    /// `femur_01`, ...
    pub name: String,
    /// `phantom:femur?individual=1&spacing=...`.
    pub spec: String,
}

/// Which vertebrae have a second hole, as two of the paper's 50.
const SECOND_HOLES: [u32; 2] = [13, 37];
/// Standard deviation of the shift of a slice by hand-drawn contours, mm.
const JITTER: f64 = 0.15;

/// Right proximal femurs and fourth lumbar vertebrae, numbered from 1.
///
/// Each has a shape and size of its own, lies as a patient does (within some degrees), anywhere on the
/// lattice, and has the spacing of a clinical scan as in the paper: 0.58 to 0.98 mm in plane (median 0.70),
/// slices of 0.62 to 1.0 mm (median 0.625); its slices are shifted a little against each other, as contours
/// drawn by hand are.
pub fn cohort(femurs: u32, vertebrae: u32) -> Vec<CohortMember> {
    let femur = |n: u32| member("femur", n, "");
    let holes = |n: u32| if SECOND_HOLES.contains(&n) { "&holes=2" } else { "" };
    let vertebra = |n: u32| member("vertebra", n, holes(n));
    (1..=femurs).map(femur).chain((1..=vertebrae).map(vertebra)).collect()
}

fn member(bone: &str, number: u32, more: &str) -> CohortMember {
    let mut chance = Chance::new(u64::from(number) << 32 | bone.len() as u64);
    // Half of the scans below 0.703 mm.
    let even = chance.even();
    let in_plane = if even < 0.5 { 0.58 + 0.246 * even } else { 0.703 + 0.548 * (even - 0.5) };
    let slices = if chance.even() < 0.7 { 0.625 } else { 0.625 + 0.375 * chance.even() };
    let degrees = [(); 3].map(|()| chance.about_zero(8.0));
    let shift = [in_plane, in_plane, slices].map(|h| h * (chance.even() - 0.5));
    let three = |v: [f64; 3]| v.map(|c| format!("{c:.3}")).join(",");
    let spec = format!(
        "phantom:{bone}?individual={number}{more}&spacing={}&rotate={}&shift={}&jitter={JITTER}",
        three([in_plane, in_plane, slices]),
        three(degrees),
        three(shift)
    );
    CohortMember { name: format!("{bone}_{number:02}"), spec }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantoms::Phantom;

    #[test]
    fn a_hundred_clinical_scans() {
        let members = cohort(50, 50);
        let mut spacings: Vec<[f64; 3]> = Vec::new();
        for member in &members {
            spacings.push(Phantom::from_spec(&member.spec).unwrap().grid().spacing().mm());
        }
        let median = |axis: usize| {
            let mut values: Vec<f64> = spacings.iter().map(|h| h[axis]).collect();
            values.sort_by(f64::total_cmp);
            assert!(values[0] >= 0.58 && values[99] <= 1.0);
            values[50]
        };
        assert!((median(0) - 0.703).abs() < 0.05 && (median(2) - 0.625).abs() < 1e-3);
        assert_eq!(members.iter().filter(|m| m.spec.contains("holes=2")).count(), 2);
        assert_eq!(members[62].name, "vertebra_13");
        assert_eq!(cohort(50, 50), members);
    }
}
