//! Corrections of a mask after which its blur gives the object back.

mod boundary;
mod clusters;
mod evidence;
mod links;
mod pair_kernel;
mod price;
mod solver;
mod spread;
mod voxel_list;

#[cfg(test)]
mod tests;

pub use price::Price;

use super::EdgeProfile;
use crate::volume::{Mask, Shared};
use boundary::Boundary;
use clusters::Clusters;
use evidence::Evidence;
use pair_kernel::PairKernel;
use spread::Spread;
use std::sync::Arc;
use voxel_list::VoxelList;

/// Rounds of solving on the list and looking what is wrong now. Most objects take two to four, strict
/// recovery of noise ten; what is left after these is counted.
const ROUNDS: usize = 24;

/// Most voxels that are solved for: pairs within the kernel's reach are held, some ten kilobytes a voxel where all hang
/// together. Of an object with more, as white noise, nothing is corrected, and all is counted as refused and left.
const MOST_LISTED: usize = 100_000;

/// Most violations that are weighed one by one: with more of them no more are solved for than with none weighed, and it takes
/// minutes to tell.
const MOST_WEIGHED: usize = 2 * MOST_LISTED;

/// Most pairs of listed voxels that see each other: eight bytes each, twice while they are listed, which is half a gigabyte, and
/// looked at in each of some hundred sweeps. Noise of 60³ voxels took nine.
const MOST_PAIRS: usize = 1 << 25;

/// The same as [`MOST_LISTED`] where they are listed as needed.
const MOST_SPREAD: usize = 20_000;

/// What every listed voxel's |phi| should have at least, so that its sign does not hang on rounding: less
/// than a thousandth of a voxel.
const CLEARANCE: f64 = 2e-4;

/// How a blurred mask is made to give the object back.
///
/// The corrected embedding phi = 1/2 - K * I of a mask I
/// ([`GaussianEmbedding::corrected`](super::GaussianEmbedding::corrected)) has the wrong sign at centres of
/// voxels where it loses detail: thin parts, terraces, noise. With corrections c at few of them, all beside
/// the boundary, phi = 1/2 - K * (I + c) has the right ones, and is as smooth as before. The corrections are
/// the least ones, in the norm whose kernel is K: c = lambda >= 0 inside and -lambda outside, and 0 wherever
/// the sign is right anyhow. They are made for the taps that the embedding has, so that signs hold in the
/// field that is computed. `experiments/recovering_embedding` has what was tried.
///
/// ```
/// use surfometry::embedding::{CorrectedMask, Embedding, GaussianEmbedding, Price, Recovery, TRUNCATION};
/// use surfometry::tiling::IndexBox;
/// use surfometry::volume::{Grid, Mask};
///
/// // A rod of 3 x 3 voxels: a blur of 2 voxels leaves nothing of it.
/// let mask = Mask::from_predicate(Grid::axis_aligned([40, 21, 21], [1.0; 3])?, |[x, y, z]| {
///     (5..35).contains(&x) && (9..12).contains(&y) && (9..12).contains(&z)
/// });
/// let recovery = Recovery { sigma: 2.0, truncation: TRUNCATION, price: Price::Strict, margin: 0.0 };
/// let found = recovery.corrections(&mask);
/// assert_eq!(found.left, 0);
/// let recovered = CorrectedMask::new(mask.clone(), found.amounts);
/// let phi_at = |indicator| {
///     GaussianEmbedding::corrected(indicator, 2.0, TRUNCATION).evaluate(&IndexBox::voxel([20, 11, 11]), 0.5).get([20, 11, 11])
/// };
/// assert!(phi_at(&mask) > 0.0 && phi_at(&recovered) < 0.0);
/// # Ok::<(), surfometry::volume::VolumeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovery {
    /// Of the corrected embedding, mm.
    pub sigma: f64,
    /// Where that cuts its kernels, in sigma.
    pub truncation: f64,
    /// What a correction may cost.
    pub price: Price,
    /// How far beyond the centre of a voxel that was on the wrong side the surface is asked to lie: half of
    /// the depth at which it was, at most this many geometric mean spacings. 0 is best for curvature; 0.1 at
    /// a sigma of two spacings takes most of the shrinkage off thin parts' areas.
    pub margin: f64,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Corrections {
    /// Voxels, in memory order, and what is added to their bits, as [`CorrectedMask`](super::CorrectedMask)
    /// takes them.
    pub amounts: Vec<([usize; 3], f32)>,
    /// Voxels with a neighbour on the other side, by faces, within the image.
    pub beside: u64,
    /// Those of them that were on the wrong side of phi = 0.
    pub violated: u64,
    /// Those that still are.
    pub left: u64,
    /// Those that are not corrected at all, because they look like noise.
    pub refused: u64,
    /// Those whose price was reached.
    pub capped: u64,
    /// Groups of corrections that depend on each other.
    pub clusters: u64,
    /// Rounds of solving.
    pub rounds: usize,
    /// Rms depth, over all voxels beside the boundary, of the violations that nothing around them speaks for,
    /// in geometric mean spacings; and of the violations of a blur of one voxel, in voxels: both of the side
    /// of the boundary that has less, both sides taken to be like it. 0 where the price was given.
    pub noise: [f64; 2],
    /// Whether both are so high that what does not stand out from them was refused.
    pub noisy: bool,
}

impl Corrections {
    /// Before any is made.
    fn of_evidence(boundary: &Boundary, evidence: &Evidence, believed: usize) -> Self {
        let violated = boundary.wrong().count() as u64;
        Self {
            beside: boundary.len() as u64,
            violated,
            refused: violated - believed as u64,
            noise: [evidence.noise, evidence.fine_noise],
            noisy: evidence.noisy,
            ..Self::default()
        }
    }

    /// Takes over what was solved.
    fn finish(&mut self, boundary: &Boundary, listed: &[Listed]) {
        self.left = boundary.wrong().count() as u64;
        self.capped = listed.iter().filter(|l| l.lambda >= l.cap).count() as u64;
        self.amounts = boundary.amounts(lambdas(listed));
    }
}

/// What is known before anything is solved.
struct Begun {
    boundary: Boundary,
    kernel: PairKernel,
    listed: Vec<Listed>,
    evidence: Evidence,
}

/// A voxel that may be corrected.
#[derive(Debug, Clone, Copy)]
struct Listed {
    /// Among the voxels beside the boundary.
    number: u32,
    lambda: f64,
    /// The largest lambda.
    cap: f64,
    /// The least -s phi that is asked for, with s = -1 inside.
    margin: f64,
}

impl Recovery {
    /// The same, of a blur that puts many voxels on the wrong side, of which few need a correction: they are
    /// listed as they turn out to be needed, at most one on either side of the boundary in half a sigma along
    /// each axis at a time, the deepest. Where both end with every sign right their fields differ by less
    /// than a thousandth of a voxel; what takes minutes with all listed takes seconds.
    pub(crate) fn corrections_of_wide_blur(&self, mask: impl Shared<Mask>) -> Corrections {
        let mask = &mask.shared();
        let Begun { mut boundary, kernel, listed: candidates, evidence } = self.begun(mask);
        let mut found = Corrections::of_evidence(&boundary, &evidence, candidates.len());
        let spread = Spread::new(self.sigma, mask.grid().spacing().mm());
        let cap = evidence.later * self.unit(mask) / kernel.peak();
        let mut listed: Vec<Listed> = Vec::new();
        while found.rounds < ROUNDS {
            let more = spread.deepest(&boundary, |number| {
                let at = |list: &[Listed]| list.binary_search_by_key(&(number as u32), |l| l.number);
                match (at(&listed), at(&candidates)) {
                    (Ok(_), _) => None,
                    (_, Ok(place)) => Some(candidates[place]),
                    // In a noisy object what comes up later is not believed.
                    _ if evidence.noisy || cap <= 0.0 => None,
                    _ => Some(Listed { number: number as u32, lambda: 0.0, cap, margin: CLEARANCE }),
                }
            });
            if listed.len() + more.len() > MOST_SPREAD {
                break;
            }
            let settled = listed.iter().all(|l| l.lambda >= l.cap || !boundary.is_wrong(l.number as usize));
            if settled && more.is_empty() {
                break;
            }
            listed.extend(more);
            listed.sort_by_key(|l| l.number);
            let Some(clusters) = solve(&mut boundary, &kernel, &mut listed) else { break };
            found.clusters = clusters;
            found.rounds += 1;
        }
        found.finish(&boundary, &listed);
        found
    }

    /// Whether a mask looks noisy at this sigma: as [`Corrections::noisy`], without solving for any; or may, because so much
    /// of it is violated that it is not weighed.
    pub(crate) fn may_be_noisy(&self, mask: impl Shared<Mask>) -> bool {
        let Begun { boundary, evidence, .. } = self.begun(&mask.shared());
        evidence.noisy || boundary.wrong().count() > MOST_WEIGHED
    }

    /// The corrections of a mask. The same bits whatever the number of threads.
    pub fn corrections(&self, mask: impl Shared<Mask>) -> Corrections {
        let mask = &mask.shared();
        let Begun { mut boundary, kernel, mut listed, evidence } = self.begun(mask);
        let is_listed = |number: &u32| listed.binary_search_by_key(number, |l| l.number).is_ok();
        let wrong = boundary.wrong().map(|number| number as u32);
        let refused: Vec<u32> = wrong.filter(|number| !is_listed(number)).collect();
        let is_few = listed.len() <= MOST_LISTED && are_few(&voxel_list(&boundary, &listed), &kernel);
        if !is_few || self.is_wider_than(mask) {
            listed.clear();
        }
        let mut found = Corrections::of_evidence(&boundary, &evidence, listed.len());
        let mut before = usize::MAX / 10;
        while found.rounds < ROUNDS && !listed.is_empty() {
            let Some(clusters) = solve(&mut boundary, &kernel, &mut listed) else { break };
            found.clusters = clusters;
            found.rounds += 1;
            let settled = listed.iter().all(|l| l.lambda >= l.cap || !boundary.is_wrong(l.number as usize));
            let more = self.extend_list(mask, &boundary, &kernel, (&mut listed, &refused), evidence.later);
            // What a price holds down may push others over the line for ever: the last rounds then win
            // little.
            let wrong = boundary.wrong().count();
            let slow = self.price != Price::Strict && 10 * wrong > 9 * before;
            if (settled && more == 0) || slow {
                break;
            }
            before = wrong;
        }
        found.finish(&boundary, &listed);
        found
    }

    /// Whether the kernel is wider than all of an object, so that corrections would see nothing of its shape.
    fn is_wider_than(&self, mask: &Mask) -> bool {
        let edges = mask.bounds().extent().into_iter().zip(mask.grid().spacing().mm());
        self.sigma > edges.map(|(voxels, h)| 0.5 * voxels as f64 * h).fold(0.0, f64::max)
    }

    fn begun(&self, mask: &Arc<Mask>) -> Begun {
        let boundary = Boundary::new(mask, self.sigma, self.truncation);
        let kernel = PairKernel::corrected(self.sigma, mask.grid().spacing().mm(), self.truncation);
        let (listed, evidence) = self.first_list(mask, &boundary, &kernel);
        Begun { boundary, kernel, listed, evidence }
    }

    /// What is wrong at first, without what looks like noise.
    fn first_list(&self, mask: &Mask, boundary: &Boundary, kernel: &PairKernel) -> (Vec<Listed>, Evidence) {
        let unit = self.unit(mask);
        let wrong: Vec<u32> = boundary.wrong().map(|number| number as u32).collect();
        let depths: Vec<f64> = wrong.iter().map(|&n| boundary.depth(n as usize) / unit).collect();
        let evidence = match self.price {
            Price::Strict => Evidence::given(f64::INFINITY, wrong.len()),
            Price::Capped(price) => Evidence::given(price.max(0.0), wrong.len()),
            Price::FromEvidence if wrong.len() > MOST_WEIGHED => Evidence::given(0.0, wrong.len()),
            Price::FromEvidence => {
                let widths = mask.grid().spacing().mm().map(|h| self.sigma / h);
                Evidence::weigh(boundary, (&wrong, &depths), &boundary.fine_depths(), widths)
            }
        };
        let to_lambda = unit / kernel.peak();
        let listed = wrong.iter().zip(&depths).zip(&evidence.prices).filter(|(_, price)| **price > 0.0);
        let listed = listed.map(|((&number, &depth), &price)| Listed {
            number,
            lambda: 0.0,
            cap: price * to_lambda,
            margin: CLEARANCE + unit * self.margin.max(0.0).min(depth / 2.0),
        });
        (listed.collect(), evidence)
    }

    /// Adds what is wrong now and was not refused; how many those are.
    fn extend_list(
        &self,
        mask: &Mask,
        boundary: &Boundary,
        kernel: &PairKernel,
        (listed, refused): (&mut Vec<Listed>, &[u32]),
        price: f64,
    ) -> usize {
        let cap = price * self.unit(mask) / kernel.peak();
        if cap <= 0.0 {
            return 0;
        }
        let known = |number: usize| {
            let number = number as u32;
            listed.binary_search_by_key(&number, |l| l.number).is_ok()
                || refused.binary_search(&number).is_ok()
        };
        let new: Vec<usize> = boundary.wrong().filter(|&number| !known(number)).collect();
        let entry = |&number: &usize| Listed { number: number as u32, lambda: 0.0, cap, margin: CLEARANCE };
        listed.extend(new.iter().map(entry));
        listed.sort_by_key(|l| l.number);
        new.len()
    }

    /// What phi changes by across one geometric mean spacing at a flat face: the unit of depths and prices.
    fn unit(&self, mask: &Mask) -> f64 {
        EdgeProfile::corrected(self.sigma).slope(0.0) * mask.grid().spacing().geometric_mean()
    }
}

/// Whether the pairs on a list are so few that they can be held and solved for.
fn are_few(list: &VoxelList, kernel: &PairKernel) -> bool {
    Clusters::pairs(list, kernel) <= MOST_PAIRS
}

fn voxel_list(boundary: &Boundary, listed: &[Listed]) -> VoxelList {
    let places = listed.iter().map(|l| boundary.voxels().place(l.number as usize)).collect();
    VoxelList::new(boundary.voxels().bounds(), places)
}

/// Solves on the list and brings the boundary's phi up to date; the number of clusters, or `None`, and nothing done, where there
/// are too many pairs.
fn solve(boundary: &mut Boundary, kernel: &PairKernel, listed: &mut [Listed]) -> Option<u64> {
    let list = voxel_list(boundary, listed);
    if !are_few(&list, kernel) {
        return None;
    }
    let directions: Vec<f64> = listed.iter().map(|l| boundary.direction(l.number as usize)).collect();
    let clusters = Clusters::new(&list, &directions, kernel);
    let given: Vec<f64> = listed
        .iter()
        .zip(&directions)
        .map(|(l, direction)| -direction * boundary.phi(l.number as usize) - l.margin)
        .collect();
    let count = clusters.count();
    let solved = clusters.solve(listed, &given, kernel.peak());
    for (l, lambda) in listed.iter_mut().zip(solved) {
        l.lambda = lambda;
    }
    boundary.blur(boundary.amounts(lambdas(listed)));
    Some(count)
}

fn lambdas(listed: &[Listed]) -> impl Iterator<Item = (u32, f64)> {
    listed.iter().map(|l| (l.number, l.lambda))
}
