//! What the text beside a TIFF's pixels says of the stack: ImageJ's lines, OME-XML, or a file of nnU-Net.

use super::page::error;
use crate::io::ReadError;
use crate::io::packed::read_text;
use crate::io::text_header::mm_per;
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// More slices than an image may have.
const MOST_SLICES: usize = 1 << 20;

/// Dimensions and lengths, as far as they are told.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Description {
    /// Slices along z.
    pub(super) slices: Option<usize>,
    /// The page of each slice, counted from 0 on; none where they stand in their order.
    pages: Vec<usize>,
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

    /// The pages that the file has, in the order of the slices.
    ///
    /// # Errors
    /// A page that is told and that the file does not have, where there are as many as slices: other numbers of them are for
    /// the caller to refuse.
    pub(super) fn in_order(&self, found: Vec<usize>) -> Result<Vec<usize>, ReadError> {
        if self.pages.len() != found.len() {
            return Ok(found);
        }
        match self.pages.iter().find(|page| found.binary_search(page).is_err()) {
            Some(page) => Err(error(format!(
                "TiffData (OME-XML) puts a slice on page {}, which the file does not have among its {}; export the image again",
                page.saturating_add(1),
                found.len()
            ))),
            None => Ok(self.pages.clone()),
        }
    }

    /// Lengths along x, y, z in the unit of each.
    fn with_lengths(self, lengths: Option<[f64; 3]>, units: [&str; 3]) -> Self {
        if let Some(unknown) = units.into_iter().find(|unit| mm_per(unit).is_none()) {
            return Self { spacing: lengths, unknown_unit: Some(unknown.to_owned()), ..self };
        }
        let mm = units.map(|unit| mm_per(unit).unwrap_or(1.0));
        let spacing = lengths.map(|lengths| std::array::from_fn(|a| lengths[a] * mm[a]));
        Self { spacing, ..self }
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
    // y and z have those of x where none of their own stand there.
    let unit = |key: &str| value(key).filter(|unit| !unit.is_empty());
    let Some(along_x) = unit("unit") else { return Ok(told) };
    let units = [along_x, unit("yunit").unwrap_or(along_x), unit("zunit").unwrap_or(along_x)];
    let is_pixels = |unit: &&str| unit.to_lowercase().starts_with("pixel");
    Ok(if units.iter().any(is_pixels) { told } else { told.with_lengths(lengths, units) })
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
    let slices = size("SizeZ");
    let pages = match slices {
        Some(slices) if slices <= MOST_SLICES => pages_of_slices(&document, pixels, slices)?,
        _ => Vec::new(),
    };
    let told = Description { slices, pages, ..Description::default() };
    let (Some((x, unit_x)), Some((y, unit_y)), Some((z, unit_z))) = (length("X"), length("Y"), length("Z"))
    else {
        return Ok(told);
    };
    Ok(told.with_lengths(Some([x, y, z]), [unit_x, unit_y, unit_z]))
}

/// The page of each slice, as OME-XML's TiffData say it; none where there are no such elements.
fn pages_of_slices(document: &Document, pixels: Node, slices: usize) -> Result<Vec<usize>, ReadError> {
    let blocks: Vec<Node> = pixels.children().filter(|node| node.tag_name().name() == "TiffData").collect();
    refuse_several_files(document, &blocks)?;
    let mut pages = BTreeMap::new();
    for &block in &blocks {
        let [slice, page, count] = block_of(block)?;
        for n in 0..count.min(slices.saturating_sub(slice)) {
            if pages.insert(slice + n, page.saturating_add(n)).is_some() {
                return Err(error(format!(
                    "TiffData (OME-XML) names two pages for slice {}; export the image again",
                    slice + n + 1
                )));
            }
        }
    }
    if blocks.is_empty() || pages.len() == slices {
        return Ok(pages.into_values().collect());
    }
    Err(error(format!(
        "TiffData (OME-XML) names pages for {} of {slices} slices; save the whole stack as one file again",
        pages.len()
    )))
}

/// Of a TiffData the first slice, its page, and how many follow each other from there on.
fn block_of(block: Node) -> Result<[usize; 3], ReadError> {
    let number = |key: &str| {
        let Some(text) = block.attribute(key) else { return Ok(None) };
        let number = text.trim().parse::<usize>();
        number.map(Some).map_err(|_| {
            error(format!("TiffData {key}=\"{text}\" (OME-XML), which is no number; export the image again"))
        })
    };
    let page = number("IFD")?;
    // The schema's defaults: the page that is named, or else all. Its older versions call it NumPlanes.
    let count = number("PlaneCount")?.or(number("NumPlanes")?).filter(|count| *count > 0);
    let count = count.unwrap_or(if page.is_some() { 1 } else { usize::MAX });
    Ok([number("FirstZ")?.unwrap_or(0), page.unwrap_or(0), count])
}

/// Refuses pages in other files than the one that says where they are: each file of a set has an identifier.
fn refuse_several_files(document: &Document, blocks: &[Node]) -> Result<(), ReadError> {
    let named = blocks.iter().flat_map(Node::children).filter(|node| node.tag_name().name() == "UUID");
    let files: BTreeSet<&str> = named
        .filter_map(|node| node.text())
        .chain(document.root_element().attribute("UUID"))
        .map(str::trim)
        .collect();
    if files.len() > 1 {
        return Err(error(format!(
            "an image in {} files (OME-XML): save the whole stack as one (in Fiji: open it, File > Save As > Tiff)",
            files.len()
        )));
    }
    Ok(())
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
        // Each axis may have its own.
        let own = format!("{}yunit=cm\nzunit=um\n", text("mm"));
        let found = spacing(&own, [2.0, 4.0]).unwrap();
        assert!(found.iter().zip([0.5, 2.5, 0.0025]).all(|(f, e)| (f - e).abs() < 1e-15), "{found:?}");
        assert_eq!(spacing(&format!("{}zunit=pixel\n", text("mm")), [2.0, 4.0]), None);
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

    #[test]
    fn ome_says_which_page_a_slice_is_on() {
        let told = |blocks: &str| {
            let text =
                format!(r#"<OME UUID="urn:uuid:a"><Image><Pixels SizeZ="4">{blocks}</Pixels></Image></OME>"#);
            Description::of(&text, [None; 2]).map_err(|e| e.to_string())
        };
        let ordered = |blocks: &str| {
            told(blocks).and_then(|told| told.in_order(vec![0, 1, 2, 3]).map_err(|e| e.to_string()))
        };
        for plain in ["", "<TiffData/>", r#"<TiffData IFD="0" PlaneCount="4"/>"#, r#"<TiffData FirstZ="0"/>"#]
        {
            assert_eq!(ordered(plain).unwrap(), [0, 1, 2, 3], "{plain}");
        }
        let swapped = r#"<TiffData FirstZ="2" IFD="0" PlaneCount="2"/><TiffData IFD="2" FirstZ="0" NumPlanes="2"><UUID>urn:uuid:a</UUID></TiffData>"#;
        assert_eq!(ordered(swapped).unwrap(), [2, 3, 0, 1]);
        // A file with fewer pages is refused for that.
        assert_eq!(told(swapped).unwrap().in_order(vec![0, 1]).unwrap(), [0, 1]);
        for (blocks, words) in [
            (r#"<TiffData IFD="0"/>"#, "for 1 of 4 slices"),
            (r#"<TiffData/><TiffData IFD="1" FirstZ="3"/>"#, "two pages for slice 4"),
            (r#"<TiffData IFD="2" PlaneCount="4"/>"#, "page 5"),
            (r#"<TiffData IFD="x"/>"#, "IFD"),
            (r#"<TiffData><UUID FileName="b">urn:uuid:b</UUID></TiffData>"#, "2 files"),
        ] {
            assert!(ordered(blocks).unwrap_err().contains(words), "{blocks}");
        }
    }
}
