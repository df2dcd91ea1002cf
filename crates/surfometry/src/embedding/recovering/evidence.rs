//! What the violations around a violation say of it.

use super::boundary::Boundary;
use super::voxel_list::VoxelList;
use rayon::prelude::*;

/// Prices in geometric mean spacings: of what is believed, and of what is in doubt where there is little noise.
pub(super) const BELIEVED: f64 = 1.0;
const DOUBTED: f64 = 0.4;

/// A voxel has company where those around it that want the surface moved the same way, less those that want the opposite (S), are this share of both together (T), in
/// the small window or in the large one, and this many times its own depth.
const AGREEMENT: [f64; 2] = [0.6, 0.8];
const COMPANY: f64 = 3.0;

/// It is alone where it is deeper than a terrace's edge on a clean mask, has no company, and S is below this share of T or this many times its depth.
const SHALLOW: f64 = 0.15;
const AGAINST: f64 = 0.2;
const LITTLE: f64 = 1.5;

/// An object is noisy where the rms depth of those alone, over all voxels beside its boundary, is above this. Clean shapes stay below 0.024, 1 % of flipped voxels give 0.022
/// to 0.08, 5 % 0.05 to 0.17, slices shifted by a voxel 0.02 to 0.17 (tubes of 2 to 3 voxels least).
const NOISY: f64 = 0.025;

/// In a noisy object company must stand this many times above the noise, as its mean depth over the voxels beside the boundary.
const ABOVE: f64 = 1.5;

/// Windows, in sigma, and the least that they are along any axis, in voxels; they end at three widths.
const WINDOWS: [f64; 2] = [0.5, 1.0];
const LEAST: f64 = 1.5;

/// Prices of the violations.
#[derive(Debug)]
pub(super) struct Evidence {
    /// By violation, in geometric mean spacings; 0 where it is taken for noise.
    pub(super) prices: Vec<f64>,
    /// Rms depth of those alone, over all voxels beside the boundary.
    pub(super) noise: f64,
    pub(super) noisy: bool,
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
        Self { prices: vec![price; count], noise: 0.0, noisy: false }
    }

    /// From the violated voxels' numbers and depths, in geometric mean spacings; `sigma` is in voxels, by axis.
    pub(super) fn weigh(boundary: &Boundary, wrong: &[u32], depths: &[f64], sigma: [f64; 3]) -> Self {
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
            little && depths[number] > SHALLOW && !(0..2).any(|window| has_company(number, window))
        };
        let square = |number: usize| if is_alone(number) { depths[number].powi(2) } else { 0.0 };
        // In order of the list: the same bits always.
        let noise = ((0..wrong.len()).map(square).sum::<f64>() / boundary.len().max(1) as f64).sqrt();
        let noisy = noise >= NOISY;
        let stands_out = |number: usize| {
            (0..2).any(|window| {
                has_company(number, window) && {
                    let beside = windows[window].weight(boundary.voxels(), list.place(number));
                    around[number][window].agreeing >= ABOVE * noise * beside
                }
            })
        };
        let price = |number: usize| match (noisy, noisy && stands_out(number)) {
            (true, true) => BELIEVED,
            (true, false) => 0.0,
            (false, _) => {
                if is_alone(number) {
                    DOUBTED
                } else {
                    BELIEVED
                }
            }
        };
        let prices = (0..wrong.len()).into_par_iter().map(price).collect();
        Self { prices, noise, noisy }
    }
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

    /// The sum over a list's voxels around a place, without the one there.
    fn weight(&self, list: &VoxelList, place: [i32; 3]) -> f64 {
        let mut sum = -1.0;
        list.for_each_within(place, self.reach(), |_, distance| sum += self.at(distance));
        sum
    }
}
