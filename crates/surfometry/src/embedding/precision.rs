//! Numbers that a field is kept in.

use std::ops::Neg;

/// A floating-point number of a field.
pub trait Precision: Copy + PartialOrd + Neg<Output = Self> + Into<f64> + Send {
    /// The largest that is not above `bound`: a value of the field is at most the one just where it is at
    /// most the other. So that a field is compared without being converted, many values at once.
    fn at_most(bound: f64) -> Self;
}

impl Precision for f64 {
    fn at_most(bound: f64) -> Self {
        bound
    }
}

impl Precision for f32 {
    fn at_most(bound: f64) -> Self {
        let nearest = bound as f32;
        if f64::from(nearest) > bound { nearest.next_down() } else { nearest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparing_with_a_rounded_bound_is_comparing_with_the_bound() {
        for bound in [0.3, 0.1, 0.25, 1.0 / 3.0, 1e-50, 0.234_000_000_1] {
            let rounded = f32::at_most(bound);
            for value in [rounded, rounded.next_up(), rounded.next_down(), 0.0] {
                assert_eq!(value <= rounded, f64::from(value) <= bound, "{value} {bound}");
                assert_eq!(-value < -rounded, f64::from(-value) < -bound, "{value} {bound}");
            }
        }
    }
}
