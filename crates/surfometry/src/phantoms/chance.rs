//! Random numbers that are the same for ever, which random number crates do not promise.

/// SplitMix64 (Steele et al. 2014).
pub(super) struct Chance(u64);

impl Chance {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Evenly between 0 and 1.
    pub(super) fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 18_446_744_073_709_551_616.0
    }

    /// About 0 with a standard deviation of half of `size`, at most one and a half: three even numbers,
    /// added.
    pub(super) fn about_zero(&mut self, size: f64) -> f64 {
        size * (self.even() + self.even() + self.even() - 1.5)
    }
}
