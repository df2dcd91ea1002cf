//! The cool-warm diverging scale.
//!
//! Moreland's scale (Diverging Color Maps for Scientific Visualization, ISVC 2009) runs from blue over light
//! grey to red along straight lines in Msh, the polar form of CIELAB. No crate carries it; the diverging
//! schemes of `colorous` and `colorgrad` are splines through ColorBrewer's nine or eleven hand-picked
//! colours, whose lightness is not even, and none is as dark at one end as at the other. A formula of some
//! forty lines is also exact at any number of steps.

use libm::{cos, pow, sin, sqrt};
use std::sync::LazyLock;

/// Magnitude, saturation angle, hue angle of the blue end: (59, 76, 192) in sRGB.
const COOL: [f64; 3] = [80.0, 1.08, -1.1];
/// The red end: (180, 4, 38).
const WARM: [f64; 3] = [80.0, 1.08, 0.5];
/// Magnitude of the grey in the middle.
const MIDDLE: f64 = 88.0;
/// CIE XYZ of sRGB's white (D65).
const WHITE: [f64; 3] = [0.95047, 1.0, 1.08883];

/// Steps from the middle to an end that are computed once: colours of 8 bits have fewer.
const STEPS: i32 = 2048;

static TABLE: LazyLock<Vec<[u8; 3]>> =
    LazyLock::new(|| (-STEPS..=STEPS).map(|step| computed(f64::from(step) / f64::from(STEPS))).collect());

/// Colour at a position from -1 (blue) over 0 (grey) to 1 (red), sRGB.
pub(crate) fn cool_warm(position: f64) -> [u8; 3] {
    let step = libm::round(position.clamp(-1.0, 1.0) * f64::from(STEPS)) as i32;
    TABLE[(step + STEPS) as usize]
}

fn computed(position: f64) -> [u8; 3] {
    let end = if position < 0.0 { COOL } else { WARM };
    let grey = [MIDDLE, 0.0, hue_towards_grey(end)];
    let share = position.abs().min(1.0);
    let [magnitude, saturation, hue] = std::array::from_fn(|i| grey[i] + share * (end[i] - grey[i]));
    let chroma = magnitude * sin(saturation);
    from_lab([magnitude * cos(saturation), chroma * cos(hue), chroma * sin(hue)])
}

/// Moreland's `AdjustHue`: hue turns a little toward the grey, so that the path bends like the perceived one.
fn hue_towards_grey([magnitude, saturation, hue]: [f64; 3]) -> f64 {
    let spin = saturation * sqrt(MIDDLE * MIDDLE - magnitude * magnitude) / (magnitude * sin(saturation));
    if hue > -std::f64::consts::FRAC_PI_3 { hue + spin } else { hue - spin }
}

fn from_lab([l, a, b]: [f64; 3]) -> [u8; 3] {
    let y = (l + 16.0) / 116.0;
    let inverse = |t: f64| if t > 6.0 / 29.0 { t * t * t } else { (t - 16.0 / 116.0) * 108.0 / 841.0 };
    let [x, y, z] =
        [WHITE[0] * inverse(y + a / 500.0), WHITE[1] * inverse(y), WHITE[2] * inverse(y - b / 200.0)];
    let linear = [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ];
    linear.map(encoded)
}

/// Linear light half-way between neighbouring 8-bit components.
static BETWEEN: LazyLock<[f64; 255]> =
    LazyLock::new(|| std::array::from_fn(|component| linear((component as f64 + 0.5) / 255.0)));

/// sRGB's transfer function, rounded to 8 bits: a search, for a power takes ten times as long.
pub(crate) fn encoded(linear: f64) -> u8 {
    BETWEEN.partition_point(|&limit| limit <= linear) as u8
}

/// Linear light of an 8-bit sRGB component, 0 to 1.
pub(crate) fn decoded(component: u8) -> f64 {
    linear(f64::from(component) / 255.0)
}

fn linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { pow((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_undoes_decoding() {
        for component in 0..=255 {
            assert_eq!(encoded(decoded(component)), component);
        }
        assert_eq!((encoded(-1.0), encoded(7.0)), (0, 255));
        // IEC 61966-2-1: a fifth of the light is 124 of 255.
        assert_eq!(encoded(0.2), 124);
    }
}
