//! Sums without rounding.
//!
//! A long fixed-point number that reaches over the whole range of f64, of which only the digits that are not
//! 0 are kept (a small superaccumulator, Neal 2015, arXiv:1505.05571). Own code because what is needed is the
//! merging of two unfinished sums, which the crates that were looked at (`xsum`, `accurate`) do not offer.

use serde::{Deserialize, Serialize};

const LIMB_BITS: usize = 32;
/// 2098 bits from the smallest subnormal to the largest finite f64, and room for more additions than can be
/// made.
const LIMBS: usize = 72;
/// Limbs that a sum which was written may have.
const LIMBS_WRITTEN: usize = 70;
/// Exponent of the lowest bit.
const LOWEST: i32 = -1074;

/// A sum of f64 values that is exact, so that the order of adding and merging cannot change a bit of it.
///
/// Equal sums are equal in every byte, however they came about.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Digits")]
pub struct ExactSum {
    negative: bool,
    /// Place of the lowest limb that is kept.
    first: u8,
    /// The magnitude's digits to the base 2^32, lowest first; neither the lowest nor the highest is 0.
    limbs: Vec<u32>,
}

/// A sum as it is read, before it is checked.
#[derive(Deserialize)]
struct Digits {
    negative: bool,
    first: u8,
    limbs: Vec<u32>,
}

impl TryFrom<Digits> for ExactSum {
    type Error = &'static str;

    fn try_from(Digits { negative, first, limbs }: Digits) -> Result<Self, Self::Error> {
        let normal = match limbs[..] {
            [] => first == 0 && !negative,
            [lowest, .., highest] => lowest != 0 && highest != 0,
            [only] => only != 0,
        };
        if normal && usize::from(first) + limbs.len() <= LIMBS_WRITTEN {
            Ok(Self { negative, first, limbs })
        } else {
            Err("an exact sum's digits are not in their one form")
        }
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
        let wide = u128::from(mantissa) << (position % LIMB_BITS);
        let limbs = [0, 1, 2].map(|part| (wide >> (part * LIMB_BITS)) as u32);
        self.add_limbs(value.is_sign_negative(), position / LIMB_BITS, &limbs);
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &Self) {
        self.add_limbs(other.negative, usize::from(other.first), &other.limbs);
    }

    /// Adds a number of the given digits, of which `first` is the place of the lowest.
    fn add_limbs(&mut self, negative: bool, first: usize, limbs: &[u32]) {
        let own = usize::from(self.first)..usize::from(self.first) + self.limbs.len();
        let low = if self.limbs.is_empty() { first } else { first.min(own.start) };
        let high = own.end.max(first + limbs.len());
        let mut work = [0i64; LIMBS];
        let digits = &mut work[..=high - low];
        for (negative, first, limbs) in
            [(self.negative, own.start.max(low), &self.limbs[..]), (negative, first, limbs)]
        {
            for (digit, &limb) in digits[first - low..].iter_mut().zip(limbs) {
                *digit += if negative { -i64::from(limb) } else { i64::from(limb) };
            }
        }
        carry(digits);
        self.negative = digits[high - low] < 0;
        if self.negative {
            for digit in digits.iter_mut() {
                *digit = -*digit;
            }
            carry(digits);
        }
        let zeros = digits.iter().take_while(|&&digit| digit == 0).count();
        let end = digits.iter().rposition(|&digit| digit != 0).map_or(zeros, |highest| highest + 1);
        self.first = if zeros == end { 0 } else { (low + zeros) as u8 };
        self.limbs.clear();
        self.limbs.extend(digits[zeros..end].iter().map(|&digit| digit as u32));
    }

    /// The f64 nearest to the exact sum.
    pub fn value(&self) -> f64 {
        // The top three limbs hold at least 65 significant bits; a sticky bit stands for everything below.
        let low = self.limbs.len().saturating_sub(3);
        let mut head = self.limbs[low..].iter().rev().fold(0u128, |h, &l| h << LIMB_BITS | u128::from(l));
        if low > 0 {
            head |= 1;
        }
        let magnitude =
            libm::ldexp(head as f64, LOWEST + ((usize::from(self.first) + low) * LIMB_BITS) as i32);
        if self.negative { -magnitude } else { magnitude }
    }
}

/// Brings digits into 0 .. 2^32, the sign left in the last one.
fn carry(digits: &mut [i64]) {
    for i in 1..digits.len() {
        digits[i] += digits[i - 1] >> LIMB_BITS;
        digits[i - 1] &= (1 << LIMB_BITS) - 1;
    }
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
            prop_assert_eq!(&forward, &sum(&values));
            prop_assert_eq!(&forward, &merged);
            // What is taken off again leaves no trace.
            for v in &values {
                merged.add(-v);
            }
            prop_assert_eq!(merged, ExactSum::default());
        }
    }
}
