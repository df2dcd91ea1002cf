//! Sums without rounding.
//!
//! A long fixed-point number that covers the whole range of f64 (a small superaccumulator, Neal 2015,
//! arXiv:1505.05571). Own code because what is needed is the merging of two unfinished sums, which the crates that
//! were looked at (`xsum`, `accurate`) do not offer.

const LIMB_BITS: usize = 32;
/// 2098 bits from the smallest subnormal to the largest finite f64, and room for carries.
const LIMBS: usize = 67;
/// Exponent of the lowest bit.
const LOWEST: i32 = -1074;
/// Additions after which carries must be propagated: each adds less than 2^32 to a limb of 63 bits.
const CARRY_AFTER: u32 = 1 << 30;

/// A sum of f64 values that is exact, so that the order of adding and merging cannot change a bit of it.
#[derive(Debug, Clone)]
pub struct ExactSum {
    limbs: [i64; LIMBS],
    pending: u32,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self { limbs: [0; LIMBS], pending: 0 }
    }
}

impl ExactSum {
    /// Adds a finite value.
    ///
    /// # Panics
    /// In debug builds, for a value that is not finite: sums are only fed with checked numbers.
    pub fn add(&mut self, value: f64) {
        debug_assert!(value.is_finite(), "ExactSum::add({value})");
        let bits = value.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as usize;
        let fraction = bits & ((1 << 52) - 1);
        // Subnormals share the exponent of the smallest normal numbers and lack the implicit bit.
        let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        let position = exponent.max(1) - 1;
        let (limb, shift) = (position / LIMB_BITS, position % LIMB_BITS);
        let wide = u128::from(mantissa) << shift;
        let sign = if value.is_sign_negative() { -1 } else { 1 };
        for part in 0..3 {
            self.limbs[limb + part] += sign * i64::from((wide >> (part * LIMB_BITS)) as u32);
        }
        self.count(1);
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &Self) {
        self.limbs.iter_mut().zip(&other.limbs).for_each(|(a, b)| *a += b);
        self.count(other.pending + 1);
    }

    fn count(&mut self, additions: u32) {
        self.pending += additions;
        if self.pending >= CARRY_AFTER {
            self.limbs = carried(self.limbs);
            self.pending = 1;
        }
    }

    /// The f64 nearest to the exact sum.
    pub fn value(&self) -> f64 {
        let mut limbs = carried(self.limbs);
        let negative = limbs[LIMBS - 1] < 0;
        if negative {
            limbs = carried(limbs.map(|l| -l));
        }
        let Some(top) = limbs.iter().rposition(|&l| l != 0) else { return 0.0 };
        // The top three limbs hold at least 65 significant bits; a sticky bit stands for everything below.
        let low = top.saturating_sub(2);
        let mut head = limbs[low..=top].iter().rev().fold(0u128, |h, &l| h << LIMB_BITS | l as u128);
        if limbs[..low].iter().any(|&l| l != 0) {
            head |= 1;
        }
        let magnitude = libm::ldexp(head as f64, LOWEST + (low * LIMB_BITS) as i32);
        if negative { -magnitude } else { magnitude }
    }
}

/// Limbs brought into 0 .. 2^32, the sign left in the last one.
fn carried(mut limbs: [i64; LIMBS]) -> [i64; LIMBS] {
    for i in 0..LIMBS - 1 {
        limbs[i + 1] += limbs[i] >> LIMB_BITS;
        limbs[i] &= (1 << LIMB_BITS) - 1;
    }
    limbs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum(values: &[f64]) -> ExactSum {
        let mut total = ExactSum::default();
        for &v in values {
            total.add(v);
        }
        total
    }

    #[test]
    fn keeps_what_floating_point_loses() {
        assert_eq!(sum(&[1e300, 1.0, -1e300]).value(), 1.0);
        assert_eq!(sum(&[f64::MAX, f64::MIN_POSITIVE, -f64::MAX]).value(), f64::MIN_POSITIVE);
        assert_eq!(sum(&[5e-324, 5e-324]).value(), 1e-323);
        assert_eq!(sum(&[-0.1, -0.2]).value(), -0.1 - 0.2);
        assert_eq!(sum(&[]).value(), 0.0);
        // Half a unit in the last place rounds to even; anything more rounds up.
        let half = f64::EPSILON / 2.0;
        assert_eq!(sum(&[1.0, half]).value(), 1.0);
        assert_eq!(sum(&[1.0, half, 1e-200]).value(), 1.0 + f64::EPSILON);
    }

    proptest! {
        #[test]
        fn a_sum_of_two_is_the_rounded_sum(a in -1e30..1e30, b in -1e-3..1e-3) {
            prop_assert_eq!(sum(&[a, b]).value(), a + b);
        }

        #[test]
        fn order_and_grouping_do_not_matter(mut values in prop::collection::vec(-1e9..1e9, 2..60), cut in 0usize..60) {
            let forward = sum(&values);
            let cut = cut.min(values.len());
            let mut merged = sum(&values[cut..]);
            merged.merge(&sum(&values[..cut]));
            values.reverse();
            prop_assert_eq!(forward.value().to_bits(), merged.value().to_bits());
            prop_assert_eq!(forward.value().to_bits(), sum(&values).value().to_bits());
        }
    }
}
