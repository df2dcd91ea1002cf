//! A folder of slices: files of one name but for a number, which says the order.

use super::page::{Page, error};
use super::{png_page, tiff_pages};
use crate::io::assembled::{AssembleVoxels, Assembled, Pieces};
use crate::io::folder::{name_of, visible};
use crate::io::header::{ImageHeader, Voxels, three_dimensions};
use crate::io::{Format, ReadError};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

const ENDINGS: [&str; 3] = [".tif", ".tiff", ".png"];

/// Whether a folder has files that may be slices.
pub(in crate::io) fn holds_slices(folder: &Path) -> bool {
    names(folder).is_ok_and(|names| !names.is_empty())
}

/// Reads what the first slice of a folder says; there is no spacing.
pub(in crate::io) fn read_header(folder: &Path) -> Result<ImageHeader, ReadError> {
    let files: Vec<PathBuf> = in_order(names(folder)?)?.into_iter().map(|name| folder.join(name)).collect();
    let page = look_at(&files[0])?;
    let dimensions = three_dimensions(&[page.width, page.height, files.len()])?;
    let voxels = Voxels::Assembled(Assembled(Arc::new(Slices { files, page })));
    Ok(ImageHeader::new(folder, Format::Tiff, dimensions, page.scalar, voxels))
}

fn names(folder: &Path) -> Result<Vec<String>, ReadError> {
    let is_slice = |name: &String| ENDINGS.iter().any(|ending| name.to_lowercase().ends_with(ending));
    Ok(visible(folder)?.iter().map(|path| name_of(path)).filter(is_slice).collect())
}

/// A name with `0` in the place of each number in front of its ending, and these numbers.
fn taken_apart(name: &str) -> (String, Vec<&str>) {
    let (stem, ending) = name.split_at(name.rfind('.').unwrap_or(name.len()));
    let mut frame = String::new();
    for c in stem.chars() {
        let c = if c.is_ascii_digit() { '0' } else { c };
        if c != '0' || !frame.ends_with('0') {
            frame.push(c);
        }
    }
    let numbers = stem.split(|c: char| !c.is_ascii_digit()).filter(|number| !number.is_empty()).collect();
    (frame + ending, numbers)
}

/// Of each name the number that says the place: the one in which they differ.
fn places(names: &[String]) -> Result<Vec<u64>, ReadError> {
    let apart: Vec<(String, Vec<&str>)> = names.iter().map(|name| taken_apart(name)).collect();
    if let Some(at) = apart.iter().position(|(_, numbers)| numbers.is_empty()) {
        return Err(error(format!(
            "{} has no number in its name, so its place among the slices is not known: rename it, or take it out of the folder",
            names[at]
        )));
    }
    let Some((frame, first)) = apart.first() else { return Ok(Vec::new()) };
    if let Some(at) = apart.iter().position(|(other, _)| other != frame) {
        return Err(of_two_series(&names[0], &names[at]));
    }
    let column = |n: usize| apart.iter().map(move |(_, numbers)| numbers[n]);
    let differing: Vec<usize> =
        (0..first.len()).filter(|&n| column(n).any(|number| number != first[n])).collect();
    let place = match differing[..] {
        // A file alone.
        [] => first.len() - 1,
        [n] => n,
        _ => {
            let ranges: Vec<String> = differing
                .iter()
                .map(|&n| range(frame.split('0').nth(n).unwrap_or_default(), column(n)))
                .collect();
            return Err(error(format!(
                "the slices' names differ in {} numbers ({}), so which of them says the order is not known: put the files of each channel or time \
                 into a folder of its own, or rename them so that the slice's number alone differs",
                ranges.len(),
                ranges.join(", ")
            )));
        }
    };
    let number = |(digits, name): (&str, &String)| {
        digits.parse::<u64>().map_err(|_| {
            error(format!("{name}: {digits} is too large for a slice's number; rename the slices"))
        })
    };
    column(place).zip(names).map(number).collect()
}

/// The least and the largest of some numbers, with the text in front of them.
fn range<'a>(before: &str, numbers: impl Iterator<Item = &'a str> + Clone) -> String {
    let size = |number: &&str| number.parse::<u64>().ok();
    let least = numbers.clone().min_by_key(size).unwrap_or_default();
    let largest = numbers.max_by_key(size).unwrap_or_default();
    format!("{before}{least} to {before}{largest}")
}

fn of_two_series(one: &str, other: &str) -> ReadError {
    error(format!(
        "{one} and {other} are not of one series: put each series of slices into a folder of its own, and take out what is no slice"
    ))
}

/// By their numbers, which count up one by one, or by any step that stays the same.
fn in_order(names: Vec<String>) -> Result<Vec<String>, ReadError> {
    let mut slices: Vec<(u64, String)> = places(&names)?.into_iter().zip(names).collect();
    slices.sort();
    if let Some(twice) = slices.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(of_two_series(&twice[0].1, &twice[1].1));
    }
    let step = |pair: &[(u64, String)]| pair[1].0 - pair[0].0;
    let usual = slices.windows(2).map(step).min().unwrap_or(1);
    if let Some(gap) = slices.windows(2).find(|pair| step(pair) != usual) {
        return Err(error(format!(
            "no slice between {} and {}, where the others count by {usual}: put what is missing there; without it all behind it would lie in the wrong place",
            gap[0].1, gap[1].1
        )));
    }
    Ok(slices.into_iter().map(|(_, name)| name).collect())
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
}

fn look_at(path: &Path) -> Result<Page, ReadError> {
    if is_png(path) { png_page::look_at(path) } else { tiff_pages::look_at(path) }
}

fn read_page(path: &Path) -> Result<(Page, Vec<u8>), ReadError> {
    if is_png(path) { png_page::read_page(path) } else { tiff_pages::read_page(path) }
}

/// Slices in their order.
#[derive(Debug)]
struct Slices {
    files: Vec<PathBuf>,
    page: Page,
}

impl AssembleVoxels for Slices {
    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let (first, mut files) = (self.page, self.files.clone().into_iter());
        Ok(Box::new(Pieces::new(move || {
            let Some(file) = files.next() else { return Ok(None) };
            let (page, voxels) = read_page(&file)?;
            page.expect_same(&first, &file.display())?;
            Ok(Some(voxels))
        })))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ordered(names: &[&str]) -> Result<Vec<String>, String> {
        in_order(names.iter().map(ToString::to_string).collect()).map_err(|e| e.to_string())
    }

    #[test]
    fn numbers_say_the_order() {
        assert_eq!(ordered(&["s10.tif", "s9.tif", "s11.tif"]).unwrap(), ["s9.tif", "s10.tif", "s11.tif"]);
        assert_eq!(ordered(&["b2_0003é.png", "b2_0001é.png", "b2_0005é.png"]).unwrap()[0], "b2_0001é.png");
        let gap = ordered(&["s1.tif", "s2.tif", "s4.tif", "s5.tif"]).unwrap_err();
        assert!(gap.contains("between s2.tif and s4.tif"), "{gap}");
        for mixed in [["a1.tif", "b2.tif"], ["a1.tif", "a1.png"], ["a01.tif", "a1.tif"]] {
            assert!(ordered(&mixed).unwrap_err().contains("not of one series"), "{mixed:?}");
        }
        assert!(ordered(&["a.tif", "a1.tif"]).unwrap_err().contains("a.tif has no number"));
    }

    #[test]
    fn the_one_number_that_differs_is_the_slices() {
        let leica = ["A3_z9_ch00.tif", "A3_z10_ch00.tif", "A3_z11_ch00.tif"];
        assert_eq!(ordered(&leica).unwrap(), leica);
        assert_eq!(ordered(&["s2_seg2.png", "s1_seg2.png"]).unwrap(), ["s1_seg2.png", "s2_seg2.png"]);
        // What stays the same may be longer than any number of a slice.
        let long = "20240131235959123456789";
        let names = [format!("{long}-2.tif"), format!("{long}-1.tif")];
        assert_eq!(ordered(&[&names[0], &names[1]]).unwrap(), [&names[1], &names[0]].map(String::clone));
        let gap = ordered(&["z1_ch0.tif", "z2_ch0.tif", "z4_ch0.tif"]).unwrap_err();
        assert!(gap.contains("between z2_ch0.tif and z4_ch0.tif"), "{gap}");
        assert!(ordered(&["z01_ch0.tif", "z1_ch0.tif"]).unwrap_err().contains("not of one series"));
        assert!(ordered(&[&format!("s{long}.tif"), "s1.tif"]).unwrap_err().contains("too large"));
    }

    #[test]
    fn several_numbers_that_differ_are_named() {
        let channels = ordered(&["A3_z9_ch0.tif", "A3_z10_ch0.tif", "A3_z9_ch1.tif", "A3_z10_ch1.tif"]);
        let said = channels.unwrap_err();
        assert!(said.contains("in 2 numbers (_z9 to _z10, _ch0 to _ch1)"), "{said}");
        assert!(said.contains("each channel"), "{said}");
        let decimals = ordered(&["s0.0.tif", "s0.5.tif", "s1.0.tif"]).unwrap_err();
        assert!(decimals.contains("(s0 to s1, .0 to .5)") && decimals.contains("rename"), "{decimals}");
        let first = ordered(&["1-1.tif", "2-2.tif"]).unwrap_err();
        assert!(first.contains("(1 to 2, -1 to -2)"), "{first}");
    }
}
