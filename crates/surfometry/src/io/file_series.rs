//! Voxels in many files, as headers of MetaImage and NRRD may name them: as a list, or a pattern with a number.

use super::ReadError;
use super::assembled::{AssembleVoxels, Assembled, Pieces};
use super::encoding;
use super::header::{ByteOrder, DataOffset, Encoding, OpenedFile, VoxelData, Voxels};
use super::text_header::{Lines, beside};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// More than any stack has; bounds what a pattern may count to.
const MOST_FILES: usize = 1 << 20;

/// Files with the same number of slices each, in their order.
#[derive(Debug)]
pub(super) struct FileSeries {
    pub(super) files: Vec<PathBuf>,
    pub(super) encoding: Encoding,
    pub(super) offset: DataOffset,
    pub(super) order: ByteOrder,
    /// Bytes of a voxel.
    pub(super) width: usize,
}

impl FileSeries {
    /// The voxels of an image of so many columns, rows and slices; what is wrong with the number of files.
    pub(super) fn voxels(
        self,
        [width, height, slices]: [usize; 3],
        voxel_bytes: usize,
    ) -> Result<Voxels, String> {
        let files = self.files.len();
        if files == 0 || !slices.is_multiple_of(files) {
            return Err(format!("{files} data files for {slices} slices; name one a slice"));
        }
        let numbers = [slices / files, width, height, voxel_bytes].map(|n| n as u64);
        let each = numbers.iter().try_fold(1_u64, |bytes, &n| bytes.checked_mul(n));
        let each = each.ok_or_else(|| {
            format!(
                "{width} x {height} x {slices} voxels are more bytes than can be counted; correct the sizes"
            )
        })?;
        Ok(Voxels::Assembled(Assembled(Arc::new(Series { of: Arc::new(self), each }))))
    }

    /// A file's bytes, little-endian.
    fn read(&self, path: &Path, each: u64, spent: &Arc<AtomicU64>) -> Result<Vec<u8>, ReadError> {
        let (encoding, offset, order) = (self.encoding, self.offset, self.order);
        let opened = OpenedFile::default();
        let data = VoxelData { path: path.to_owned(), opened, encoding, offset, order, scaling: None };
        let mut stored = encoding::open(&data, each, spent).map_err(|e| ReadError::damaged(path, &e))?;
        let damaged = |e: &dyn std::fmt::Display| ReadError::damaged(path, &e.to_string());
        let mut bytes = Vec::new();
        stored.by_ref().take(each).read_to_end(&mut bytes).map_err(|e| damaged(&e))?;
        let behind = std::io::copy(&mut stored.take(each), &mut std::io::sink()).map_err(|e| damaged(&e))?;
        if bytes.len() as u64 != each || behind > 0 {
            let found = bytes.len() as u64 + behind;
            return Err(damaged(&format!("{found} bytes or more, where its slices take {each}")));
        }
        Ok(self.order.to_little(bytes, self.width))
    }
}

#[derive(Debug)]
struct Series {
    of: Arc<FileSeries>,
    /// Bytes of a file's voxels.
    each: u64,
}

impl AssembleVoxels for Series {
    fn files(&self) -> Vec<PathBuf> {
        self.of.files.clone()
    }

    fn open(&self, spent: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let (of, each, spent) = (Arc::clone(&self.of), self.each, Arc::clone(spent));
        let mut number = 0;
        Ok(Box::new(Pieces::new(move || {
            let Some(path) = of.files.get(number) else { return Ok(None) };
            number += 1;
            of.read(path, each, &spent).map(Some)
        })))
    }
}

/// Where a header names several files, their paths: a list in the lines behind, or a pattern. `None` where it names one.
///
/// # Errors
/// What is wrong with the pattern.
pub(super) fn files_named(
    header: &Path,
    text: &str,
    lines: &mut Lines,
) -> Option<Result<Vec<PathBuf>, &'static str>> {
    if text.split_whitespace().next() == Some("LIST") {
        let names = lines.map(|line| line.trim().to_owned()).filter(|line| !line.is_empty());
        return Some(Ok(names.map(|name| beside(header, &name)).collect()));
    }
    let wrong = "is no pattern with first, last and step; name the files in a LIST";
    text.contains('%').then(|| of_pattern(header, text).ok_or(wrong))
}

/// The files that a pattern stands for: `slice%03d.raw first last step`; `None` where it is none.
fn of_pattern(header: &Path, text: &str) -> Option<Vec<PathBuf>> {
    let mut words = text.split_whitespace();
    let pattern = words.next()?;
    let mut next = || words.next().map_or(Some(1), |word| word.parse::<i64>().ok());
    let (first, last, step) = (next()?, next()?, next()?);
    let count = last.checked_sub(first)?.checked_div(step)?;
    let count = usize::try_from(count).ok().filter(|count| *count < MOST_FILES)?;
    (0..=count as i64).map(|i| Some(beside(header, &numbered(pattern, first + i * step)?))).collect()
}

/// `%d`, `%i` or `%u`, with a width or not, of C.
fn numbered(pattern: &str, number: i64) -> Option<String> {
    let (before, rest) = pattern.split_once('%')?;
    let end = rest.find(['d', 'i', 'u'])?;
    let (width, after) = (&rest[..end], &rest[end + 1..]);
    let padded = match width.strip_prefix('0') {
        Some(width) if !width.is_empty() => {
            format!("{number:0width$}", width = width.parse().ok().filter(|w| *w < 64)?)
        }
        _ => format!(
            "{number:width$}",
            width = if width.is_empty() { 0 } else { width.parse().ok().filter(|w: &usize| *w < 64)? }
        ),
    };
    Some(format!("{before}{padded}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_those_of_c() {
        let names = |text: &str| {
            let files = of_pattern(Path::new("h.mhd"), text)?;
            Some(files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>())
        };
        assert_eq!(names("s%03d.raw 9 11 1").unwrap(), ["s009.raw", "s010.raw", "s011.raw"]);
        assert_eq!(names("s%d.raw 1 5 2").unwrap(), ["s1.raw", "s3.raw", "s5.raw"]);
        assert_eq!(names("s%i.raw 3 1 -1").unwrap(), ["s3.raw", "s2.raw", "s1.raw"]);
        for wrong in
            ["s%03d.raw 1 5 0", "s%s.raw 1 5 1", "s%99d.raw 1 5 1", "s%d.raw 1 99999999 1", "s%d.raw a 5"]
        {
            assert_eq!(names(wrong), None, "{wrong}");
        }
    }
}
