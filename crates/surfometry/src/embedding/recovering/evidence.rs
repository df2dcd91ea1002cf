//! What the violations around a violation say of it.

use super::boundary::Boundary;
use super::voxel_list::VoxelList;
use rayon::prelude::*;

/// Prices in geometric mean spacings: of what is believed, and of what is in doubt where there is little
/// noise.
pub(super) const BELIEVED: f64 = 1.0;
const DOUBTED: f64 = 0.4;

/// A voxel has company where those around it that want the surface moved the same way, less those that want
/// the opposite (S), are this share of both together (T), in the small window or in the large one, and this
/// many times its own depth.
const AGREEMENT: [f64; 2] = [0.6, 0.8];
const COMPANY: f64 = 3.0;

/// It is alone where it is deeper than a terrace's edge on a clean mask, has no company, S is below this
/// share of T or this many times its depth, and a blur of one voxel along each axis violates it too (by this
/// much, in voxels), as it does single voxels that stick out, and neither struts and sheets nor most edges.
const SHALLOW: f64 = 0.15;
const AGAINST: f64 = 0.2;
const LITTLE: f64 = 1.5;
const SEEN: f64 = 0.1;

/// An object is noisy where two rms depths over all voxels beside its boundary are above these: of those
/// alone, and, in voxels, of all violations of the fine blur. Noise is on both sides of a boundary, a sharp
/// edge on one: both are of the side that has less, as if the other were like it.
const NOISY: f64 = 0.02;
const FINELY_NOISY: f64 = 0.01;

/// And where those alone are this share, in rms, of all violations: a thin part that is scanned coarsely has a
/// few voxels that look alone among many that do not.
const OF_ALL: f64 = 0.2;

/// Windows, in sigma, and the least that they are along any axis, in voxels; they end at three widths.
const WINDOWS: [f64; 2] = [0.5, 1.0];
const LEAST: f64 = 1.5;

/// Prices of the violations.
#[derive(Debug)]
pub(super) struct Evidence {
    /// By violation, in geometric mean spacings; 0 where it is taken for noise.
    pub(super) prices: Vec<f64>,
    /// Both depths.
    pub(super) noise: f64,
    pub(super) fine_noise: f64,
    pub(super) noisy: bool,
    /// Of what turns out to be violated later.
    pub(super) later: f64,
}

/// What one violation has around it, in one window.
#[derive(Debug, Clone, Copy, Default)]
struct Around {
    /// S and T.
    agreeing: f64,
    all: f64,
}

impl Evidence {
    /// The same price for all.
    pub(super) fn given(price: f64, count: usize) -> Self {
        Self { prices: vec![price; count], noise: 0.0, fine_noise: 0.0, noisy: false, later: price }
    }

    /// From the violated voxels' numbers and depths, in geometric mean spacings; `sigma` is in voxels, by
    /// axis, and `fine` the fine depths of all voxels beside the boundary.
    pub(super) fn weigh(
        boundary: &Boundary,
        (wrong, depths): (&[u32], &[f64]),
        fine: &[f64],
        sigma: [f64; 3],
    ) -> Self {
        let places = wrong.iter().map(|&n| boundary.voxels().place(n as usize)).collect();
        let list = VoxelList::new(boundary.voxels().bounds(), places);
        let windows = WINDOWS.map(|size| Window::new(sigma.map(|s| (size * s).max(LEAST))));
        let inside: Vec<bool> = wrong.iter().map(|&n| boundary.inside(n as usize)).collect();
        let around =
            |number: usize| windows.each_ref().map(|window| window.around(&list, (&inside, depths), number));
        let around: Vec<[Around; 2]> = (0..wrong.len()).into_par_iter().map(around).collect();
        let has_company = |number: usize, window: usize| {
            let Around { agreeing, all } = around[number][window];
            agreeing >= AGREEMENT[window] * all && agreeing >= COMPANY * depths[number]
        };
        let is_alone = |number: usize| {
            let Around { agreeing, all } = around[number][0];
            let little = agreeing < AGAINST * all || agreeing < LITTLE * depths[number];
            let seen = fine[wrong[number] as usize] > SEEN;
            seen && little && depths[number] > SHALLOW && !(0..2).any(|window| has_company(number, window))
        };
        let beside = boundary.len();
        let alone = (0..wrong.len()).filter(|&number| is_alone(number));
        let noise = lesser_side(beside, alone.map(|number| (inside[number], depths[number])));
        let all = lesser_side(beside, inside.iter().copied().zip(depths.iter().copied()));
        let fine_noise =
            lesser_side(beside, (0..).zip(fine).map(|(number, &depth)| (boundary.inside(number), depth)));
        let noisy = noise >= NOISY.max(OF_ALL * all) && fine_noise >= FINELY_NOISY;
        // A noisy object has thin parts, too: nothing but what is alone is left to the blur.
        let price = |number: usize| match (noisy, is_alone(number)) {
            (true, true) => 0.0,
            (true, false) if !(0..2).any(|window| has_company(number, window)) => DOUBTED,
            (false, true) => DOUBTED,
            _ => BELIEVED,
        };
        let prices = (0..wrong.len()).into_par_iter().map(price).collect();
        Self { prices, noise, fine_noise, noisy, later: if noisy { DOUBTED } else { BELIEVED } }
    }
}

/// Rms over a number of voxels of depths on the side of the boundary that has less, taken twice. Added up in
/// their order: the same bits always.
fn lesser_side(voxels: usize, depths: impl Iterator<Item = (bool, f64)>) -> f64 {
    let mut squares = [0.0; 2];
    for (inside, depth) in depths {
        squares[usize::from(inside)] += depth * depth;
    }
    (2.0 * squares[0].min(squares[1]) / voxels.max(1) as f64).sqrt()
}

/// A Gaussian window, 1 at no distance.
#[derive(Debug)]
struct Window {
    /// By axis and distance in voxels.
    weights: [Vec<f64>; 3],
}

impl Window {
    fn new(widths: [f64; 3]) -> Self {
        let weights = |width: f64| {
            let reach = (3.0 * width + 0.5) as usize;
            (0..=reach).map(|n| libm::exp(-0.5 * (n as f64 / width).powi(2))).collect()
        };
        Self { weights: widths.map(weights) }
    }

    fn reach(&self) -> [i64; 3] {
        self.weights.each_ref().map(|weights| weights.len() as i64 - 1)
    }

    fn at(&self, distance: [usize; 3]) -> f64 {
        (0..3).map(|a| self.weights[a][distance[a]]).product()
    }

    /// What is around a violation among those of a list.
    fn around(&self, list: &VoxelList, (inside, depths): (&[bool], &[f64]), number: usize) -> Around {
        let mut around = Around::default();
        list.for_each_within(list.place(number), self.reach(), |other, distance| {
            if other != number {
                let depth = self.at(distance) * depths[other];
                around.all += depth;
                around.agreeing += if inside[other] == inside[number] { depth } else { -depth };
            }
        });
        around
    }
}
