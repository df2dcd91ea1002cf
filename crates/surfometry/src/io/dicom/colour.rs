//! Colours as DICOM has them.

/// sRGB of CIELab in 16 bits a part, as RecommendedDisplayCIELabValue has it (PS3.3 C.10.7.1.1); white is D65, as programs
/// that write it have it (pixelmed, highdicom, dcmqi).
pub(super) fn of_cielab(encoded: [i64; 3]) -> [u8; 3] {
    let part = |n: usize| encoded[n] as f64 / 65535.0;
    let (l, a, b) = (part(0) * 100.0, part(1) * 255.0 - 128.0, part(2) * 255.0 - 128.0);
    // CIE 15: L*a*b* to XYZ.
    let fy = (l + 16.0) / 116.0;
    let inverse = |f: f64| if f > 6.0 / 29.0 { f.powi(3) } else { (f - 4.0 / 29.0) * 108.0 / 841.0 };
    let xyz = [inverse(fy + a / 500.0) * 0.950_47, inverse(fy), inverse(fy - b / 200.0) * 1.088_83];
    // IEC 61966-2-1: XYZ to sRGB.
    let rows = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
    rows.map(|row| {
        let linear: f64 = row.iter().zip(xyz).map(|(m, v)| m * v).sum();
        let encoded =
            if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 };
        (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
    })
}
