//! What the text beside a TIFF's pixels says of the stack: ImageJ's lines, OME-XML, or a file of nnU-Net.

use super::page::error;
use crate::io::ReadError;
use crate::io::packed::read_text;
use crate::io::text_header::mm_per;
use roxmltree::{Document, Node};
use std::path::{Path, PathBuf};

/// Dimensions and lengths, as far as they are told.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Description {
    /// Slices along z.
    pub(super) slices: Option<usize>,
    /// Spacing along x, y, z in the unit that is told, or mm.
    pub(super) spacing: Option<[f64; 3]>,
    /// A unit that is not known.
    pub(super) unknown_unit: Option<String>,
    /// Whether all slices may stand behind one page, as ImageJ writes stacks that are not compressed.
    pub(super) contiguous: bool,
}

impl Description {
    /// Out of the text of the first page; `resolution` is its pixels a unit along x and y.
    pub(super) fn of(text: &str, resolution: [Option<f64>; 2]) -> Result<Self, ReadError> {
        if text.starts_with("ImageJ=") {
            return image_j(text, resolution);
        }
        let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
        if is_xml { ome(text) } else { Ok(Self::default()) }
    }

    /// The spacing of the file's own, else of nnU-Net's file beside it: `{"spacing": [z, y, x]}`, in the order of the
    /// array's axes.
    pub(super) fn or_beside(mut self, image: &Path) -> Result<Self, ReadError> {
        if self.spacing.is_none() {
            self.spacing = beside(image)?;
        }
        Ok(self)
    }

    fn with_lengths(self, lengths: Option<[f64; 3]>, unit: &str) -> Self {
        match mm_per(unit) {
            Some(mm) => Self { spacing: lengths.map(|lengths| lengths.map(|length| length * mm)), ..self },
            None => Self { spacing: lengths, unknown_unit: Some(unit.to_owned()), ..self },
        }
    }
}

fn image_j(text: &str, resolution: [Option<f64>; 2]) -> Result<Description, ReadError> {
    let value =
        |key: &str| text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('=')).map(str::trim);
    let count = |key: &str| value(key).and_then(|text| text.parse::<usize>().ok()).unwrap_or(1);
    let [images, channels, frames] = ["images", "channels", "frames"].map(count);
    if channels > 1 {
        return Err(error(format!(
            "{channels} channels (ImageJ): surfometry measures one 3-D image at a time; in Fiji: Image > Color > Split Channels, and save each"
        )));
    }
    if frames > 1 {
        return Err(error(format!(
            "{frames} frames (ImageJ): where they are slices, set Slices to {frames} and Frames to 1 in Fiji's Image > Properties and save \
             again; where they are times, save each as a stack of its own"
        )));
    }
    // ImageJ leaves out what is 1 there, but a spacing of 1 is also what nobody set: it is asked for.
    let depth = value("spacing").and_then(|text| text.parse::<f64>().ok()).map(f64::abs);
    let lengths = match (resolution, depth) {
        ([Some(x), Some(y)], Some(z)) => Some([1.0 / x, 1.0 / y, z]),
        _ => None,
    };
    let told = Description { slices: Some(images), contiguous: true, ..Description::default() };
    match value("unit").filter(|unit| !unit.is_empty() && !unit.to_lowercase().starts_with("pixel")) {
        Some(unit) => Ok(told.with_lengths(lengths, unit)),
        None => Ok(told),
    }
}

fn ome(text: &str) -> Result<Description, ReadError> {
    let Ok(document) = Document::parse(text) else { return Ok(Description::default()) };
    let images: Vec<Node> =
        document.descendants().filter(|node| node.tag_name().name() == "Pixels").collect();
    let pixels = match images[..] {
        [] => return Ok(Description::default()),
        [pixels] => pixels,
        _ => {
            return Err(error(format!(
                "{} images in one OME-TIFF; save each as a file of its own",
                images.len()
            )));
        }
    };
    let size = |key: &str| pixels.attribute(key).and_then(|text| text.parse::<usize>().ok());
    let (channels, times) = (size("SizeC").unwrap_or(1), size("SizeT").unwrap_or(1));
    if channels.saturating_mul(times) > 1 {
        return Err(error(format!(
            "{channels} channels and {times} times (OME-XML): surfometry measures one 3-D image at a time; save each as a file of its own"
        )));
    }
    let length = |axis: &str| {
        let value = pixels.attribute(format!("PhysicalSize{axis}").as_str())?.parse::<f64>().ok()?;
        // The schema's default.
        Some((value, pixels.attribute(format!("PhysicalSize{axis}Unit").as_str()).unwrap_or("µm")))
    };
    let told = Description { slices: size("SizeZ"), ..Description::default() };
    let (Some((x, unit_x)), Some((y, unit_y)), Some((z, unit_z))) = (length("X"), length("Y"), length("Z"))
    else {
        return Ok(told);
    };
    let Some(mm) = [unit_x, unit_y, unit_z].map(mm_per).into_iter().collect::<Option<Vec<f64>>>() else {
        return Ok(told.with_lengths(Some([x, y, z]), unit_x));
    };
    Ok(told.with_lengths(Some([x * mm[0], y * mm[1], z * mm[2]]), "mm"))
}

/// Where nnU-Net says the spacing of an image.
pub(super) fn side_file(image: &Path) -> PathBuf {
    image.with_extension("json")
}

fn beside(image: &Path) -> Result<Option<[f64; 3]>, ReadError> {
    let path = side_file(image);
    if !path.exists() {
        return Ok(None);
    }
    let Ok(text) = read_text(&path)? else { return Ok(None) };
    let Ok(document) = serde_json::from_str::<serde_json::Value>(&text) else { return Ok(None) };
    let Some(spacing) = document.get("spacing") else { return Ok(None) };
    match serde_json::from_value::<[f64; 3]>(spacing.clone()) {
        Ok([z, y, x]) => Ok(Some([x, y, z])),
        Err(_) => Err(error(format!(
            "the .json file beside the image says spacing {spacing}, which is not three numbers [z, y, x] in mm; correct it, or say the spacing"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spacing(text: &str, resolution: [f64; 2]) -> Option<[f64; 3]> {
        Description::of(text, resolution.map(Some)).unwrap().spacing
    }

    #[test]
    fn image_j_tells_lengths_where_it_knows_them() {
        let text =
            |unit: &str| format!("ImageJ=1.54f\nimages=9\nslices=9\nunit={unit}\nspacing=2.5\nloop=false\n");
        for unit in ["mm", "millimeter"] {
            assert_eq!(spacing(&text(unit), [2.0, 4.0]), Some([0.5, 0.25, 2.5]));
        }
        for unit in ["micron", "um", "µm", "\\u00B5m"] {
            let found = spacing(&text(unit), [2.0, 4.0]).unwrap();
            assert!(
                found.iter().zip([0.0005, 0.00025, 0.0025]).all(|(f, e)| (f - e).abs() < 1e-15),
                "{unit}"
            );
        }
        // Pixels are no length; no unit is none; no spacing of slices is none.
        assert_eq!(spacing(&text("pixel"), [2.0, 4.0]), None);
        assert_eq!(spacing("ImageJ=1.54f\nimages=9\nspacing=2.5\n", [2.0, 4.0]), None);
        assert_eq!(spacing("ImageJ=1.54f\nimages=9\nunit=mm\n", [2.0, 4.0]), None);
        let cubit = Description::of(&text("cubit"), [Some(2.0), Some(4.0)]).unwrap();
        assert_eq!((cubit.unknown_unit.as_deref(), cubit.slices), (Some("cubit"), Some(9)));
        for axis in ["channels=3", "frames=9"] {
            let said =
                Description::of(&format!("ImageJ=1\nimages=9\n{axis}\n"), [None; 2]).unwrap_err().to_string();
            assert!(said.contains("in Fiji") || said.contains("Fiji's"), "{said}");
        }
    }

    #[test]
    fn ome_has_a_unit_an_axis() {
        let text = |pixels: &str| {
            format!(
                r#"<?xml version="1.0"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image><Pixels {pixels}/></Image></OME>"#
            )
        };
        let lengths = r#"PhysicalSizeX="500" PhysicalSizeY="0.75" PhysicalSizeYUnit="mm" PhysicalSizeZ="2000000" PhysicalSizeZUnit="nm""#;
        let told = Description::of(&text(&format!(r#"SizeZ="6" SizeC="1" SizeT="1" {lengths}"#)), [None; 2])
            .unwrap();
        assert_eq!(told.slices, Some(6));
        assert!(told.spacing.unwrap().iter().zip([0.5, 0.75, 2.0]).all(|(f, e)| (f - e).abs() < 1e-12));
        let flat =
            Description::of(&text(r#"SizeZ="6" PhysicalSizeX="1" PhysicalSizeY="1""#), [None; 2]).unwrap();
        assert_eq!(flat.spacing, None);
        let several =
            Description::of(&text(r#"SizeZ="6" SizeC="2" SizeT="3""#), [None; 2]).unwrap_err().to_string();
        assert!(several.contains("2 channels and 3 times"), "{several}");
    }
}
