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

/// A name's last number, and what stands before and behind it.
fn numbered(name: &str) -> Option<(u64, (String, String))> {
    let stem_end = name.rfind('.')?;
    let end = name[..stem_end].rfind(|c: char| c.is_ascii_digit())? + 1;
    let begin = name[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + name[at..].chars().next().map_or(1, char::len_utf8));
    Some((name[begin..end].parse().ok()?, (name[..begin].to_owned(), name[end..].to_owned())))
}

/// By their numbers, which count up one by one, or by any step that stays the same.
fn in_order(names: Vec<String>) -> Result<Vec<String>, ReadError> {
    let mut slices = Vec::new();
    for name in names {
        let number = numbered(&name).ok_or_else(|| {
            error(format!("{name} has no number in its name, so its place among the slices is not known: rename it, or take it out of the folder"))
        })?;
        slices.push((number, name));
    }
    slices.sort();
    let told = |which: usize| slices.get(which).map_or("", |(_, name)| name.as_str());
    if let Some(at) =
        slices.windows(2).position(|pair| pair[0].0.1 != pair[1].0.1 || pair[0].0.0 == pair[1].0.0)
    {
        return Err(error(format!(
            "{} and {} are not of one series: put each series of slices into a folder of its own",
            told(at),
            told(at + 1)
        )));
    }
    let step = |pair: &[((u64, _), String)]| pair[1].0.0 - pair[0].0.0;
    let usual = slices.windows(2).map(step).min().unwrap_or(1);
    if let Some(at) = slices.windows(2).position(|pair| step(pair) != usual) {
        return Err(error(format!(
            "no slice between {} and {}, where the others count by {usual}: put what is missing there; without it all behind it would lie in the wrong place",
            told(at),
            told(at + 1)
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
}
