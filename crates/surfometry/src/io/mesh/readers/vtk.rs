//! VTK's legacy format ("VTK File Formats", docs.vtk.org), versions up to 5.1: poly data as text, or binary with the
//! most significant byte first.

use super::super::super::header::ByteOrder;
use super::Outcome;
use super::numbers::{numbers, places};
use super::surface::{Surface, corner};
use super::unpack::beginning;
use super::vtp::cells_of;
use super::words::{Words, shown};
use crate::volume::ScalarType;
use std::path::Path;

/// Longer than what stands in front of the word that says what a file holds.
const START: u64 = 1024;

/// Whether a file says that it holds cells, and not an image.
pub(super) fn is_surface(path: &Path) -> bool {
    let start = beginning(path, START);
    let cells = [&b"POLYDATA"[..], b"UNSTRUCTURED_GRID"];
    Legacy::new(&start).is_ok_and(|(_, dataset)| cells.contains(&dataset.to_ascii_uppercase().as_slice()))
}

/// A file behind the lines that say what it is.
struct Legacy<'a> {
    words: Words<'a>,
    binary: bool,
    title: &'a [u8],
}

/// Numbers and their type as keywords name it; `None` of texts.
type Type = Option<ScalarType>;

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let (mut file, dataset) = Legacy::new(bytes)?;
    if !dataset.eq_ignore_ascii_case(b"POLYDATA") {
        return Err(format!("it holds `{}`, not POLYDATA: extract its surface", shown(dataset)));
    }
    let mut surface = Surface::default();
    surface.comment(file.title)?;
    while let Some(word) = file.words.next() {
        match word.to_ascii_uppercase().as_slice() {
            b"POINTS" => {
                let count = file.words.how_many("points")?;
                let kind = file.kind()?;
                surface.vertices.extend(places(&file.numbers(count.saturating_mul(3), kind)?)?);
            }
            b"POLYGONS" => file.cells(|corners| surface.polygon(corners))?,
            b"TRIANGLE_STRIPS" => file.cells(|corners| surface.strip(corners))?,
            b"VERTICES" | b"LINES" => file.cells(|_| ())?,
            b"FIELD" => {
                if let Some(letters) = file.field()? {
                    surface.comment(&[b"SPACE=", letters.as_slice()].concat())?;
                }
            }
            b"METADATA" => file.skip_metadata(),
            // What follows are values of the points and cells.
            b"POINT_DATA" | b"CELL_DATA" => break,
            _ => {
                return file.words.refuse(format_args!("`{}` stands where a part should begin", shown(word)));
            }
        }
    }
    Ok(surface)
}

impl<'a> Legacy<'a> {
    fn new(bytes: &'a [u8]) -> Outcome<(Self, &'a [u8])> {
        let mut words = Words::new(bytes);
        if !words.line().trim_ascii_start().starts_with(b"# vtk DataFile Version") {
            return Err("it does not begin with `# vtk DataFile Version`".to_owned());
        }
        let title = words.line();
        let binary = match words.next().unwrap_or_default().to_ascii_uppercase().as_slice() {
            b"BINARY" => true,
            b"ASCII" => false,
            other => return words.refuse(format_args!("`{}` is neither ASCII nor BINARY", shown(other))),
        };
        match words.next() {
            Some(word) if word.eq_ignore_ascii_case(b"DATASET") => {}
            other => {
                return words.refuse(format_args!("`{}` is not DATASET", shown(other.unwrap_or_default())));
            }
        }
        let dataset = words.next().unwrap_or_default();
        Ok((Self { words, binary, title }, dataset))
    }

    /// The type of numbers.
    fn kind(&mut self) -> Outcome<Type> {
        let word = self.words.next().unwrap_or_default().to_ascii_lowercase();
        Ok(Some(match word.as_slice() {
            b"char" | b"vtktypeint8" | b"signed_char" => ScalarType::I8,
            b"unsigned_char" | b"vtktypeuint8" => ScalarType::U8,
            b"short" | b"vtktypeint16" => ScalarType::I16,
            b"unsigned_short" | b"vtktypeuint16" => ScalarType::U16,
            // Files keep these numbers in 32 bits, whatever the program has.
            b"int" | b"vtkidtype" | b"vtktypeint32" => ScalarType::I32,
            b"unsigned_int" | b"vtktypeuint32" => ScalarType::U32,
            b"long" | b"vtktypeint64" => ScalarType::I64,
            b"unsigned_long" | b"vtktypeuint64" => ScalarType::U64,
            b"float" | b"vtktypefloat32" => ScalarType::F32,
            b"double" | b"vtktypefloat64" => ScalarType::F64,
            b"string" | b"vtkstring" => return Ok(None),
            other => return self.words.refuse(format_args!("type `{}` is not known", shown(other))),
        }))
    }

    /// So many numbers, which begin in the next line.
    fn numbers(&mut self, count: usize, kind: Type) -> Outcome<Vec<f64>> {
        let Some(scalar) = kind else { return self.words.refuse("texts stand where numbers should be") };
        if self.binary {
            self.words.line();
            let left = self.words.rest().len();
            let bytes = self.words.bytes(count.saturating_mul(scalar.bytes()));
            let bytes =
                bytes.ok_or_else(|| format!("it claims {count} numbers, which {left} bytes cannot hold"))?;
            Ok(numbers(scalar, ByteOrder::Big, bytes))
        } else {
            (0..count).map(|_| self.words.number()).collect()
        }
    }

    /// Cells: how many corners each has and which; since version 5 where each begins, and all corners.
    fn cells(&mut self, mut found: impl FnMut(&[u32])) -> Outcome<()> {
        let (cells, size) = (self.words.how_many("cells")?, self.words.how_many("corners")?);
        if self.words.clone().next() == Some(b"OFFSETS") {
            let mut part = |count| {
                self.words.next();
                let kind = self.kind()?;
                self.numbers(count, kind)
            };
            let (offsets, corners) = (part(cells)?, part(size)?);
            // The first one is where the first cell begins.
            return cells_of(offsets.get(1..).unwrap_or_default(), &corners, 0.0, found);
        }
        let list = self.numbers(size, Some(ScalarType::I32))?;
        let mut rest = list.as_slice();
        for _ in 0..cells {
            let cell =
                rest.split_first().and_then(|(&count, behind)| behind.split_at_checked(count as usize));
            let Some((cell, behind)) = cell else {
                return self.words.refuse("its cells are longer than it says");
            };
            let corners: Vec<u32> = cell.iter().map(|&number| corner(number)).collect::<Outcome<_>>()?;
            found(&corners);
            rest = behind;
        }
        if rest.is_empty() { Ok(()) } else { self.words.refuse("its cells are shorter than it says") }
    }

    /// Passes over arrays that belong to the whole; what the one says that names the axes, as 3D Slicer does.
    fn field(&mut self) -> Outcome<Option<Vec<u8>>> {
        let mut space = None;
        self.words.next();
        for _ in 0..self.words.how_many("arrays")? {
            if self.words.clone().next() == Some(b"METADATA") {
                self.words.next();
                self.skip_metadata();
            }
            let name = self.words.next().unwrap_or_default();
            let (components, rows) = (self.words.how_many("components")?, self.words.how_many("rows")?);
            let count = components.saturating_mul(rows);
            match self.kind()? {
                None => {
                    let first = self.texts(count)?;
                    if name == b"SPACE" {
                        space = first;
                    }
                }
                kind => drop(self.numbers(count, kind)?),
            }
        }
        Ok(space)
    }

    /// Passes over texts: lines, or each behind its length, whose first two bits say how many bytes it has. The first one.
    fn texts(&mut self, count: usize) -> Outcome<Option<Vec<u8>>> {
        let mut first = None;
        let cut = "the file ends within a text";
        self.words.line();
        for _ in 0..count {
            if self.words.rest().is_empty() {
                return Err(cut.to_owned());
            }
            if !self.binary {
                let text = self.words.line().trim_ascii().to_vec();
                first.get_or_insert(text);
                continue;
            }
            let width = match self.words.rest().first().map(|first| first >> 6) {
                Some(3) => 1,
                Some(2) => 2,
                Some(1) => 4,
                _ => 8,
            };
            let length = self.words.bytes(width).ok_or(cut)?;
            let length = length.iter().fold(0, |all, &byte| (all << 8) | u64::from(byte));
            let text = self.words.bytes((length & !(3 << (8 * width - 2))) as usize).ok_or(cut)?;
            first.get_or_insert(text.to_vec());
        }
        Ok(first)
    }

    /// Passes over names of components and the like, which an empty line ends.
    fn skip_metadata(&mut self) {
        self.words.line();
        while !self.words.rest().is_empty() && !self.words.line().trim_ascii().is_empty() {}
    }
}
