//! Colours as DICOM has them.

/// sRGB of CIELab (D50) in 16 bits a part, as RecommendedDisplayCIELabValue has it (PS3.3 C.10.7.1.1).
pub(super) fn of_cielab(encoded: [i64; 3]) -> [u8; 3] {
    let part = |n: usize| encoded[n] as f64 / 65535.0;
    let (l, a, b) = (part(0) * 100.0, part(1) * 255.0 - 128.0, part(2) * 255.0 - 128.0);
    // CIE 15: L*a*b* to XYZ.
    let fy = (l + 16.0) / 116.0;
    let inverse = |f: f64| if f > 6.0 / 29.0 { f.powi(3) } else { (f - 4.0 / 29.0) * 108.0 / 841.0 };
    let white = [0.964_22, 1.0, 0.825_21];
    let xyz =
        [inverse(fy + a / 500.0) * white[0], inverse(fy) * white[1], inverse(fy - b / 200.0) * white[2]];
    // XYZ (D50) to linear sRGB (D65), with Bradford's adaptation.
    let rows = [
        [3.134_187_2, -1.617_209_1, -0.490_694_1],
        [-0.978_749_3, 1.916_130_2, 0.033_433_4],
        [0.071_964_0, -0.228_992_1, 1.405_754_0],
    ];
    rows.map(|row| {
        let linear: f64 = row.iter().zip(xyz).map(|(m, v)| m * v).sum();
        let encoded =
            if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 };
        (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
    })
}
