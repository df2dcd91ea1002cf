//! From values to colours.

use rayon::prelude::*;

use super::palette::Palette;
use super::ticks::{Ticks, round_up};

/// Colour where there is no value: darker than any colour of the diverging scale's middle, without hue.
const MISSING: [u8; 3] = [96; 3];
/// Share of the surface whose values lie within robust limits.
const SHOWN: f64 = 0.98;

/// Which way colours run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScaleKind {
    /// From a light middle to both sides, lightness falling evenly. For quantities with a sign.
    Diverging,
    /// From dark to light, lightness rising evenly. For quantities that are never negative.
    Sequential,
}

impl ScaleKind {
    /// The palette where none is chosen: cool-warm, viridis.
    fn palette(self) -> Palette {
        match self {
            Self::Diverging => Palette::CoolWarm,
            Self::Sequential => Palette::Viridis,
        }
    }
}

/// A colour for every value between two limits; values beyond take the colour of the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorScale {
    palette: Palette,
    limits: [f64; 2],
}

impl ColorScale {
    /// From `-limit` to `limit` (diverging) or from 0 to `limit` (sequential). A limit that is not positive
    /// and finite is replaced by 1: there is nothing to tell apart then.
    pub fn new(kind: ScaleKind, limit: f64) -> Self {
        let limit = if limit.is_finite() && limit > 0.0 { limit } else { 1.0 };
        let low = if kind == ScaleKind::Diverging { -limit } else { 0.0 };
        Self { palette: kind.palette(), limits: [low, limit] }
    }

    /// Between two limits, of which the first is the lower.
    pub fn between(kind: ScaleKind, limits: [f64; 2]) -> Self {
        Self { palette: kind.palette(), limits }
    }

    /// The same limits in other colours.
    #[must_use]
    pub fn in_colors(self, palette: Palette) -> Self {
        Self { palette, ..self }
    }

    /// Limits from data: the weighted 98th percentile of the values' magnitudes, rounded up to a round
    /// number, so that a few spikes do not bleach the rest. Weights are the vertices' areas; without any
    /// (`&[]`) all values count the same. Values that are not finite are passed over.
    pub fn robust(kind: ScaleKind, values: &[f64], weights: &[f64]) -> Self {
        let percentile = magnitude_percentile(values, weights, SHOWN);
        Self::new(kind, if percentile > 0.0 { round_up(percentile) } else { 1.0 })
    }

    /// Which way colours run.
    pub fn kind(&self) -> ScaleKind {
        self.palette.kind()
    }

    /// The values at the ends.
    pub fn limits(&self) -> [f64; 2] {
        self.limits
    }

    /// Colour of a value, sRGB; dark grey for NaN.
    pub fn rgb(&self, value: f64) -> [u8; 3] {
        if value.is_nan() { MISSING } else { self.palette.color(self.position(value)) }
    }

    /// Where a value is in the palette, 0 to 1. Zero has a diverging palette's middle where it lies between the
    /// limits: the colours of equal magnitudes are then equally strong, also where one side ends earlier.
    fn position(&self, value: f64) -> f64 {
        let [low, high] = self.limits;
        let value = value.clamp(low, high);
        if self.kind() == ScaleKind::Diverging && low < 0.0 && high > 0.0 {
            0.5 + 0.5 * (value / high.max(-low))
        } else {
            (value - low) / (high - low)
        }
    }

    /// Colours of many values.
    pub fn colors(&self, values: &[f64]) -> Vec<[u8; 3]> {
        values.par_iter().map(|v| self.rgb(*v)).collect()
    }

    /// `count` (at least 2) evenly spaced colours with their places, from 0 at the lower limit to 1 at the
    /// upper: what viewers take as a colour scale.
    pub fn stops(&self, count: usize) -> Vec<(f64, [u8; 3])> {
        let [low, high] = self.limits();
        let last = count.max(2) - 1;
        let at = |i: usize| i as f64 / last as f64;
        (0..=last).map(|i| (at(i), self.rgb(low + at(i) * (high - low)))).collect()
    }

    /// Round values to mark on a colour bar.
    pub fn ticks(&self) -> Vec<f64> {
        self.marks().values
    }

    pub(crate) fn marks(&self) -> Ticks {
        Ticks::new(self.limits(), 5)
    }

    /// Whether there are values below the lower and above the upper limit.
    pub(crate) fn exceeded(&self, values: impl IntoIterator<Item = f64>) -> [bool; 2] {
        let [low, high] = self.limits();
        values.into_iter().fold([false; 2], |[below, above], v| [below || v < low, above || v > high])
    }
}

/// The magnitude below which a share of the weight lies; 0 without data.
fn magnitude_percentile(values: &[f64], weights: &[f64], share: f64) -> f64 {
    let weight = |i: usize| weights.get(i).copied().unwrap_or(1.0).max(0.0);
    let mut magnitudes: Vec<(f64, f64)> =
        values.iter().enumerate().filter(|(_, v)| v.is_finite()).map(|(i, v)| (v.abs(), weight(i))).collect();
    magnitudes.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted = share * magnitudes.iter().map(|m| m.1).sum::<f64>();
    let mut passed = 0.0;
    for (magnitude, weight) in &magnitudes {
        passed += weight;
        if passed >= wanted {
            return *magnitude;
        }
    }
    magnitudes.last().map_or(0.0, |m| m.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::cool_warm::decoded;

    /// CIELAB lightness.
    fn lightness(color: [u8; 3]) -> f64 {
        let [r, g, b] = color.map(decoded);
        let y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b;
        if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    #[test]
    fn diverging_is_grey_in_the_middle_and_darkens_evenly_to_both_ends() {
        let scale = ColorScale::new(ScaleKind::Diverging, 0.2);
        let [r, g, b] = scale.rgb(0.0).map(i32::from);
        assert!((r - g).abs() <= 2 && (g - b).abs() <= 2 && r > 200, "{r} {g} {b}");
        assert_eq!(scale.rgb(-0.2), [59, 76, 192]);
        assert_eq!(scale.rgb(0.2), [180, 4, 38]);
        for sign in [-1.0, 1.0] {
            let along: Vec<f64> =
                (0..=20).map(|i| lightness(scale.rgb(sign * 0.01 * f64::from(i)))).collect();
            assert!(along.windows(2).all(|w| w[1] < w[0]), "{along:?}");
        }
        let ends = [-0.2, 0.2].map(|v| lightness(scale.rgb(v)));
        assert!((ends[0] - ends[1]).abs() < 1.0, "{ends:?}");
        assert_eq!(scale.rgb(7.0), scale.rgb(0.2));
        assert_eq!(scale.rgb(f64::NAN), MISSING);
    }

    #[test]
    fn sequential_brightens() {
        let scale = ColorScale::new(ScaleKind::Sequential, 3.0);
        let along: Vec<f64> = scale.stops(16).iter().map(|s| lightness(s.1)).collect();
        assert!(along.windows(2).all(|w| w[1] > w[0]), "{along:?}");
        assert_eq!(scale.rgb(-1.0), scale.rgb(0.0));
        assert_eq!(scale.stops(2).iter().map(|s| s.0).collect::<Vec<_>>(), [0.0, 1.0]);
    }

    #[test]
    fn limits_ignore_spikes_and_never_collapse() {
        let mut values: Vec<f64> = (0..1000).map(|i| 0.11 * f64::from(i) / 1000.0).collect();
        values.extend([50.0, f64::NAN, f64::INFINITY]);
        assert_eq!(ColorScale::robust(ScaleKind::Diverging, &values, &[]).limits(), [-0.15, 0.15]);
        let weighted = ColorScale::robust(ScaleKind::Sequential, &[1.0, 40.0], &[1.0, 99.0]);
        assert_eq!(weighted.limits(), [0.0, 40.0]);
        for degenerate in [&[][..], &[0.0, 0.0], &[f64::NAN]] {
            assert_eq!(ColorScale::robust(ScaleKind::Diverging, degenerate, &[]).limits(), [-1.0, 1.0]);
        }
    }

    #[test]
    fn zero_has_the_middle_colour_and_equal_magnitudes_are_equally_strong() {
        for palette in [Palette::CoolWarm, Palette::PurpleOrange] {
            let (whole, lopsided) = (
                ColorScale::new(ScaleKind::Diverging, 0.4).in_colors(palette),
                ColorScale::between(ScaleKind::Diverging, [-0.1, 0.4]).in_colors(palette),
            );
            for value in [-0.1, -0.03, 0.0, 0.2, 0.4, 9.0] {
                assert_eq!(lopsided.rgb(value), whole.rgb(value), "{palette} {value}");
            }
            assert_eq!(lopsided.rgb(-0.3), lopsided.rgb(-0.1));
            let ends = [-0.4, 0.4].map(|value| lightness(whole.rgb(value)));
            assert!(ends.into_iter().all(|end| end + 25.0 < lightness(whole.rgb(0.0))), "{palette} {ends:?}");
        }
        let upper = ColorScale::between(ScaleKind::Sequential, [0.2, 0.6]);
        assert_eq!(upper.rgb(0.4), ColorScale::new(ScaleKind::Sequential, 1.0).rgb(0.5));
    }

    #[test]
    fn sequential_palettes_grow_lighter_all_along() {
        for palette in [Palette::Viridis, Palette::Cividis, Palette::Magma] {
            let scale = ColorScale::new(ScaleKind::Sequential, 1.0).in_colors(palette);
            let steps: Vec<f64> = (0..=20).map(|i| lightness(scale.rgb(f64::from(i) / 20.0))).collect();
            assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{palette} {steps:?}");
        }
    }
}
