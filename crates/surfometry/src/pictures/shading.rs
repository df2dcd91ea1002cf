//! How bright a surface is by the way it faces.

/// Light that reaches every place. High, so that colours stay comparable with the colour bar.
const AMBIENT: f32 = 0.42;
/// Light from the viewer.
const HEAD: f32 = 0.40;
/// Light from above.
const KEY: f32 = 0.26;
/// Where that comes from: right, up, toward the viewer. In the middle plane, so that left and right look
/// alike.
const KEY_DIRECTION: [f32; 3] = [0.0, 0.6, 0.8];

/// Share of the light that a place sends to the viewer; its normal in components along right, up and toward
/// the viewer, of any length. Diffuse only (a highlight would bleach the colour), in linear light, so that
/// hue stays; never above 1, so that nothing is brighter than on the colour bar.
pub(crate) fn brightness([x, y, z]: [f32; 3]) -> f32 {
    let length = libm::sqrtf(x * x + y * y + z * z);
    if length.is_nan() || length == 0.0 {
        return 1.0;
    }
    let key = (x * KEY_DIRECTION[0] + y * KEY_DIRECTION[1] + z * KEY_DIRECTION[2]) / length;
    (AMBIENT + HEAD * (z / length).max(0.0) + KEY * key.max(0.0)).min(1.0)
}

/// Light that a place keeps that sees nothing of the sky.
const DEEPEST: f32 = 0.3;

/// Share of the light that is left to a place by the share of the sky that it sees.
pub(crate) fn dimmed(open: f32) -> f32 {
    DEEPEST + (1.0 - DEEPEST) * open.clamp(0.0, 1.0)
}
