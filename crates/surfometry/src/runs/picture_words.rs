//! Choices of pictures as they are written, in a command or in a call.

use super::WordError;
use super::words::number;
use crate::pictures::{CameraAngles, SlicePlane, Viewpoint};

/// Units of a picture, 1/96 inch, a millimetre.
const UNITS_PER_MM: f64 = 96.0 / 25.4;
/// Units of a picture an inch.
const UNITS_PER_INCH: f64 = 96.0;
/// Narrowest and widest picture, mm.
const WIDTHS: [f64; 2] = [40.0, 1200.0];

/// Width of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PictureWidth {
    /// On paper, mm.
    Mm(f64),
    /// Pixels of a PNG.
    Pixels(f64),
}

impl PictureWidth {
    /// In CSS pixels, for a picture with so many dots an inch.
    ///
    /// # Errors
    /// [`WordError`] where it is narrower than its text or wider than a poster.
    pub fn units(self, dpi: f64) -> Result<f64, WordError> {
        let units = match self {
            Self::Mm(mm) => UNITS_PER_MM * mm,
            Self::Pixels(pixels) => UNITS_PER_INCH * pixels / dpi,
        };
        let [least, most] = WIDTHS;
        if (least..=most).contains(&(units / UNITS_PER_MM)) {
            return Ok(units);
        }
        let mm = units / UNITS_PER_MM;
        Err(WordError::new(&format!(
            "a picture of {mm:.0} mm (at {dpi} dots an inch) cannot be drawn: its width must lie between {least} and {most} mm"
        )))
    }
}

/// Width of a picture: `85mm`, `1200px`.
///
/// # Errors
/// [`WordError`].
pub fn width(text: &str) -> Result<PictureWidth, WordError> {
    let text = text.trim();
    let (amount, of): (&str, fn(f64) -> PictureWidth) =
        match (text.strip_suffix("mm"), text.strip_suffix("px")) {
            (Some(amount), _) => (amount, PictureWidth::Mm),
            (_, Some(amount)) => (amount, PictureWidth::Pixels),
            _ => {
                return Err(WordError::new(&format!(
                    "`{text}`: write a width in mm or pixels: 85mm, 1200px"
                )));
            }
        };
    super::words::positive(amount).map(of)
}

/// Both ends of a colour scale: `-0.2..0.5`.
///
/// # Errors
/// [`WordError`].
pub fn color_range(text: &str) -> Result<[f64; 2], WordError> {
    let wrong =
        || WordError::new(&format!("`{text}`: write LOW..HIGH, two numbers of which the first is lower"));
    let (low, high) = text.split_once("..").ok_or_else(wrong)?;
    let ends = [number(low)?, number(high)?];
    let [low, high] = ends;
    if low.is_finite() && high.is_finite() && low < high { Ok(ends) } else { Err(wrong()) }
}

/// Where the viewer stands: `AZIMUTH,ELEVATION` or `AZIMUTH,ELEVATION,ROLL`, degrees.
///
/// # Errors
/// [`WordError`].
pub fn camera(text: &str) -> Result<Viewpoint, WordError> {
    let angles = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let (azimuth, elevation, roll) = match angles[..] {
        [azimuth, elevation] => (azimuth, elevation, 0.0),
        [azimuth, elevation, roll] => (azimuth, elevation, roll),
        _ => {
            return Err(WordError::new(&format!(
                "`{text}`: write AZIMUTH,ELEVATION or AZIMUTH,ELEVATION,ROLL in degrees"
            )));
        }
    };
    let known = |angle: f64, most: f64| angle.is_finite() && angle.abs() <= most;
    if known(azimuth, 360.0) && known(elevation, 90.0) && known(roll, 360.0) {
        Ok(Viewpoint::Turned(CameraAngles { azimuth, elevation, roll }))
    } else {
        Err(WordError::new(
            "azimuth and roll must lie between -360 and 360 degrees, elevation between -90 and 90",
        ))
    }
}

/// A slice: `z=40`, `x=centre`; an axis of the image, x the fastest, and the index of a voxel or the object's
/// centroid.
///
/// # Errors
/// [`WordError`].
pub fn slice(text: &str) -> Result<SlicePlane, WordError> {
    let wrong =
        || WordError::new(&format!("`{text}`: write AXIS=N or AXIS=centre, as z=40, with AXIS x, y or z"));
    let (axis, place) = text.split_once('=').ok_or_else(wrong)?;
    let axis =
        ["x", "y", "z"].iter().position(|name| name.eq_ignore_ascii_case(axis.trim())).ok_or_else(wrong)?;
    let index = match place.trim() {
        "centre" | "center" => None,
        index => Some(index.parse().map_err(|_| wrong())?),
    };
    Ok(SlicePlane { axis, index })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_pictures() {
        assert_eq!(width("85mm").unwrap().units(300.0).unwrap(), 85.0 / 25.4 * 96.0);
        assert_eq!(width("1200px").unwrap().units(192.0).unwrap(), 600.0);
        assert!(
            width("10mm").unwrap().units(96.0).unwrap_err().to_string().contains("between 40 and 1200 mm")
        );
        assert_eq!(color_range("-0.2..0.5").unwrap(), [-0.2, 0.5]);
        assert_eq!(slice("z=40").unwrap(), SlicePlane { axis: 2, index: Some(40) });
        assert_eq!(slice("x=centre").unwrap(), SlicePlane { axis: 0, index: None });
        let angles = CameraAngles { azimuth: -30.0, elevation: 20.0, roll: 5.0 };
        assert_eq!(camera("-30,20,5").unwrap(), Viewpoint::Turned(angles));
        for wrong in ["85", "mm", "-1mm", "nanmm"] {
            assert!(width(wrong).is_err(), "{wrong}");
        }
        for wrong in ["1..1", "2..1", "1", "nan..1", "0..inf"] {
            assert!(color_range(wrong).is_err(), "{wrong}");
        }
        for wrong in ["30", "30,100", "1,2,3,4", "nan,0"] {
            assert!(camera(wrong).is_err(), "{wrong}");
        }
        for wrong in ["40", "w=3", "z=middle", "z=1.5"] {
            assert!(slice(wrong).is_err(), "{wrong}");
        }
    }
}
