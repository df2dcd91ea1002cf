//! One-dimensional Gaussian kernels and their derivatives.

/// Kernels end at this many standard deviations.
///
/// Cut at 4 the area is off by 1e-4 and M by 1e-3, at 5 by 5e-7 and 1e-5; at blurs of 10 voxels and more,
/// where the cut is not rounded up, M by 4e-5 and chi by 2e-4 (`tests/truncation.rs`).
pub const TRUNCATION: f64 = 5.0;

/// The same for a blur alone, the derivatives of which are differences: a cut at 4 sigma changes V by 8e-6, A
/// by 5e-6 and M by 1e-6 then (`tests/truncation.rs`), because what it loses is smooth.
pub const TRUNCATION_OF_BLUR: f64 = 4.0;

/// Taps of a sampled Gaussian (order 0) or its first or second derivative, in units of 1/length^order.
///
/// Taps are sampled, not integrated over voxels, then normalised so that, before the cut, a constant (order
/// 0), a ramp (order 1) and a parabola (order 2) are reproduced exactly at any ratio of sigma to spacing; a
/// cut kernel still takes a constant to exactly 1 or 0. (Normalising the *cut* kernel would scale second
/// derivatives up by its missing fourth moment, 2e-4 at 5 sigma, which costs M and chi twice as much as the
/// missing tails do.) Below sigma = 0.8 voxels the samples no longer represent a Gaussian: the flag
/// `sigma-below-spacing` warns from 1 voxel down.
#[derive(Debug, Clone, PartialEq)]
pub struct GaussianKernel {
    taps: Vec<f64>,
}

/// Beyond this many sigma nothing is left in f64.
pub(super) const WHOLE: f64 = 9.0;

impl GaussianKernel {
    /// The kernel of a derivative order (0, 1 or 2) for sigma and spacing in the same unit, cut at
    /// `truncation` sigma.
    ///
    /// # Panics
    /// For a higher order.
    pub fn new(sigma: f64, spacing: f64, order: usize, truncation: f64) -> Self {
        let cut = Samples::new(sigma, spacing, truncation);
        let whole = Samples::new(sigma, spacing, truncation.max(WHOLE));
        let variance = whole.moment(2);
        let taps = match order {
            0 => cut.bell.clone(),
            1 => cut.weighted(|x| -x / variance),
            2 => {
                let scale = whole.bend();
                let cut_variance = cut.moment(2);
                cut.weighted(|x| (x * x - cut_variance) * scale)
            }
            _ => panic!("derivatives beyond the second are not used"),
        };
        if taps.iter().all(|t| t.is_finite()) {
            return Self { taps };
        }
        // sigma so far below the spacing that the side samples underflow: central differences are the limit.
        let (slope, bend) = (0.5 / spacing, 1.0 / (spacing * spacing));
        Self { taps: if order == 1 { vec![slope, 0.0, -slope] } else { vec![bend, -2.0 * bend, bend] } }
    }

    /// Taps on each side of the centre. A hair is taken off before rounding up, so that a spacing that went
    /// through f32 has as many taps as the same spacing that did not.
    pub fn radius_for(sigma: f64, spacing: f64, truncation: f64) -> i64 {
        (truncation * sigma / spacing - 1e-3).ceil().max(1.0) as i64
    }

    /// Taps on each side of the centre.
    pub fn radius(&self) -> usize {
        self.taps.len() / 2
    }

    /// The largest sum of `count` neighbouring taps, which of a bell are the middle ones.
    pub fn largest_sum(&self, count: usize) -> f64 {
        let count = count.min(self.taps.len());
        self.taps.windows(count).map(|window| window.iter().sum()).fold(0.0, f64::max)
    }

    /// The taps, at offsets -radius ..= radius.
    pub fn taps(&self) -> &[f64] {
        &self.taps
    }
}

/// A Gaussian sampled at multiples of the spacing, with sum 1.
pub(super) struct Samples {
    positions: Vec<f64>,
    pub(super) bell: Vec<f64>,
}

impl Samples {
    pub(super) fn new(sigma: f64, spacing: f64, truncation: f64) -> Self {
        let radius = GaussianKernel::radius_for(sigma, spacing, truncation);
        let positions: Vec<f64> = (-radius..=radius).map(|i| i as f64 * spacing).collect();
        let bell: Vec<f64> = positions.iter().map(|x| libm::exp(-x * x / (2.0 * sigma * sigma))).collect();
        let sum: f64 = bell.iter().sum();
        Self { positions, bell: bell.iter().map(|g| g / sum).collect() }
    }

    pub(super) fn moment(&self, power: i32) -> f64 {
        self.positions.iter().zip(&self.bell).map(|(x, g)| x.powi(power) * g).sum()
    }

    /// What scales x^2 less its mean to a second derivative: 2 / (fourth moment - variance^2).
    pub(super) fn bend(&self) -> f64 {
        2.0 / (self.moment(4) - self.moment(2) * self.moment(2))
    }

    fn weighted(&self, weight: impl Fn(f64) -> f64) -> Vec<f64> {
        self.positions.iter().zip(&self.bell).map(|(&x, g)| weight(x) * g).collect()
    }
}

/// Running sums of a kernel, which turn the convolution of a row of runs into two look-ups a voxel and run.
#[derive(Debug, Clone, Default)]
pub(crate) struct CumulativeKernel {
    radius: i64,
    /// `sums[k]` is the sum of the first k taps.
    sums: Vec<f64>,
}

impl CumulativeKernel {
    /// Of an odd number of taps of a derivative order.
    pub(super) fn new(taps: &[f64], order: usize) -> Self {
        let mut kernel = Self::default();
        kernel.set_taps(taps, order);
        kernel
    }

    /// Becomes that of other taps.
    pub(crate) fn set_taps(&mut self, taps: &[f64], order: usize) {
        self.radius = taps.len() as i64 / 2;
        self.sums.clear();
        let mut sum = 0.0;
        for tap in taps {
            self.sums.push(sum);
            sum += tap;
        }
        // The full sum is known: exact saturation makes a row's value independent of runs out of reach.
        self.sums.push(if order == 0 { 1.0 } else { 0.0 });
    }

    /// Sum of the taps from number `a` up to, not including, number `b`.
    pub(crate) fn between(&self, a: i64, b: i64) -> f64 {
        self.sums[b as usize] - self.sums[a as usize]
    }

    /// Taps on each side of the centre.
    pub(crate) fn radius(&self) -> i64 {
        self.radius
    }

    /// Adds to `row`, whose first voxel is `x0`, the convolution of a run [a, b) of voxels with the same
    /// value.
    pub(crate) fn add_run(&self, row: &mut [f64], x0: i64, (a, b): (i64, i64), value: f64) {
        let end = x0 + row.len() as i64;
        let last = self.sums.len() as i64 - 1;
        let sum_at = |k: i64| self.sums[k.clamp(0, last) as usize];
        for x in (a - self.radius).max(x0)..(b + self.radius).min(end) {
            // Taps at offsets x - b + 1 ..= x - a, and the tap at offset d is number d + radius.
            let share = sum_at(x - a + 1 + self.radius) - sum_at(x - b + 1 + self.radius);
            row[(x - x0) as usize] += value * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_the_order_come_out_exactly() {
        for (sigma, spacing) in [(2.0, 1.0), (0.9, 0.7), (1.0, 2.5), (1.0, 60.0)] {
            for order in 0..3 {
                // Convolution at 0 of x^power.
                let response = |truncation: f64, power: i32| -> f64 {
                    let kernel = GaussianKernel::new(sigma, spacing, order, truncation);
                    let r = kernel.radius() as i64;
                    (-r..=r).zip(kernel.taps()).map(|(i, t)| t * (-i as f64 * spacing).powi(power)).sum()
                };
                let exact = [1.0, 1.0, 2.0][order];
                assert!((response(WHOLE, order as i32) - exact).abs() < 1e-12, "{sigma} {spacing} {order}");
                assert!(
                    (response(TRUNCATION, order as i32) / exact - 1.0).abs() < 3e-4,
                    "{sigma} {spacing} {order}"
                );
                for lower in 0..order as i32 {
                    assert!(response(TRUNCATION, lower).abs() < 1e-12, "{sigma} {spacing} {order} {lower}");
                }
            }
        }
    }

    #[test]
    fn runs_are_convolved_as_their_voxels() {
        for order in 0..3 {
            let kernel = GaussianKernel::new(1.7, 1.0, order, TRUNCATION);
            let r = kernel.radius() as i64;
            let mut row = vec![0.0; 40];
            CumulativeKernel::new(kernel.taps(), order).add_run(&mut row, -5, (3, 21), 1.0);
            for (i, &value) in row.iter().enumerate() {
                let x = i as i64 - 5;
                let direct: f64 =
                    (3..21).filter(|m| (x - m).abs() <= r).map(|m| kernel.taps()[(x - m + r) as usize]).sum();
                assert!((value - direct).abs() < 1e-13, "{order} {x} {value} {direct}");
            }
        }
    }
}
