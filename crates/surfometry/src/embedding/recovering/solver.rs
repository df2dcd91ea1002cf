//! The least corrections of one cluster.

use super::links::Links;

/// Sweeps over a cluster: a few dozen do nearly always, and the next round sees what they leave.
const SWEEPS: usize = 80;

/// Changes of phi below this end a solution. It is a quarter of the clearance that is asked for.
const TOLERANCE: f64 = 5e-5;

/// Changes of phi below this are not made: voxels that have settled cost nothing.
const NOTHING: f64 = 2e-6;

/// Steps go so much farther than to their voxel's own minimum: neighbours are nearly of one mind, and follow.
/// (Below 2 it converges.)
const FARTHER: f64 = 1.5;

/// Voxels that see each other.
#[derive(Debug)]
pub(super) struct Cluster {
    /// By voxel: what its lambda does to the others' excess.
    pub(super) links: Links,
    pub(super) lambdas: Vec<f64>,
    pub(super) caps: Vec<f64>,
    /// -s phi above what is asked for; negative where something is to be done.
    pub(super) excess: Vec<f64>,
}

/// Gauss and Seidel's steps in the order of the voxels, each cut to 0 ..= cap: the minimum of 1/2 lambda Q
/// lambda - b lambda, which has excess = 0 where lambda is between its bounds, >= 0 where it is 0 and <= 0
/// where it is capped. A voxel that does not move costs nothing, so a sweep costs the links of those that do.
pub(super) fn solve(cluster: Cluster, peak: f64) -> Vec<f64> {
    let Cluster { links, mut lambdas, caps, mut excess } = cluster;
    for _ in 0..SWEEPS {
        let mut largest = 0.0f64;
        for n in 0..lambdas.len() {
            let wanted = (lambdas[n] - FARTHER * excess[n] / peak).max(0.0).min(caps[n]);
            let step = wanted - lambdas[n];
            if step.abs() * peak < NOTHING {
                continue;
            }
            lambdas[n] = wanted;
            excess[n] += step * peak;
            for &(other, value) in links.of(n) {
                excess[other as usize] += step * f64::from(value);
            }
            largest = largest.max(step.abs() * peak);
        }
        if largest < TOLERANCE {
            break;
        }
    }
    lambdas
}
