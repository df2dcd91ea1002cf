//! Fourth-order finite-difference weights, central inside and shifted at an image's edge.

/// Points that the widest shifted stencil needs along an axis.
pub const MINIMUM_POINTS: usize = 6;

/// Weights of a first or second derivative at one point of an axis, in units of 1/spacing^order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stencil {
    /// Offset of the first weight from the point.
    pub(crate) start: i64,
    /// Weights; trailing zeros where fewer than six points are used.
    pub(crate) weights: [f64; 6],
}

// Besler et al., appendix (central); the shifted ones match Taylor series to the same order.
const FIRST_CENTRAL: [f64; 6] = [1.0 / 12.0, -2.0 / 3.0, 0.0, 2.0 / 3.0, -1.0 / 12.0, 0.0];
const FIRST_AT_0: [f64; 6] = [-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -1.0 / 4.0, 0.0];
const FIRST_AT_1: [f64; 6] = [-1.0 / 4.0, -5.0 / 6.0, 3.0 / 2.0, -1.0 / 2.0, 1.0 / 12.0, 0.0];
const SECOND_CENTRAL: [f64; 6] = [-1.0 / 12.0, 4.0 / 3.0, -5.0 / 2.0, 4.0 / 3.0, -1.0 / 12.0, 0.0];
const SECOND_AT_0: [f64; 6] = [15.0 / 4.0, -77.0 / 6.0, 107.0 / 6.0, -13.0, 61.0 / 12.0, -5.0 / 6.0];
const SECOND_AT_1: [f64; 6] = [5.0 / 6.0, -5.0 / 4.0, -1.0 / 3.0, 7.0 / 6.0, -1.0 / 2.0, 1.0 / 12.0];

impl Stencil {
    /// The first derivative at `index` of an axis whose values exist on `lower..upper`.
    pub(crate) fn first(index: i64, lower: i64, upper: i64) -> Self {
        Self::choose(index, lower, upper, [FIRST_CENTRAL, FIRST_AT_0, FIRST_AT_1], -1.0)
    }

    /// The second derivative at `index` of an axis whose values exist on `lower..upper`.
    pub(crate) fn second(index: i64, lower: i64, upper: i64) -> Self {
        Self::choose(index, lower, upper, [SECOND_CENTRAL, SECOND_AT_0, SECOND_AT_1], 1.0)
    }

    /// `parity` is the factor that reversing the axis puts on the derivative.
    fn choose(index: i64, lower: i64, upper: i64, [central, at_0, at_1]: [[f64; 6]; 3], parity: f64) -> Self {
        let mirrored = |weights: [f64; 6]| {
            let mut reversed = weights.map(|w| w * parity);
            reversed.reverse();
            reversed
        };
        match (index - lower, upper - 1 - index) {
            (0, _) => Self { start: 0, weights: at_0 },
            (1, _) => Self { start: -1, weights: at_1 },
            (_, 0) => Self { start: -5, weights: mirrored(at_0) },
            (_, 1) => Self { start: -4, weights: mirrored(at_1) },
            _ => Self { start: -2, weights: central },
        }
    }

    /// Offsets and weights that are not zero.
    pub(crate) fn terms(&self) -> impl Iterator<Item = (i64, f64)> + '_ {
        (self.start..).zip(self.weights).filter(|(_, w)| *w != 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fourth order means: exact on polynomials up to degree 4 (first) and 5 (second, where six points are
    /// used).
    #[test]
    fn exact_on_polynomials_at_every_position() {
        for index in 0..7 {
            for power in 0..=4i32 {
                let value = |x: i64| (x as f64 - 2.5).powi(power);
                let x = index as f64 - 2.5;
                let p = f64::from(power);
                let first = if power >= 1 { p * x.powi(power - 1) } else { 0.0 };
                let second = if power >= 2 { p * (p - 1.0) * x.powi(power - 2) } else { 0.0 };
                let apply = |s: Stencil| s.terms().map(|(o, w)| w * value(index + o)).sum::<f64>();
                assert!((apply(Stencil::first(index, 0, 7)) - first).abs() < 1e-10, "{index} {power}");
                assert!((apply(Stencil::second(index, 0, 7)) - second).abs() < 1e-10, "{index} {power}");
            }
        }
    }
}
