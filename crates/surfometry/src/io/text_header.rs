//! Helpers for formats whose header is text.

use super::ReadError;
use super::packed::Packed;
use std::path::{Path, PathBuf};

/// Longer than any real header; bounds what is read from a file that is none.
const LONGEST: u64 = 1 << 20;

/// The start of a file, split into lines that can be walked with byte positions.
pub(crate) struct Lines {
    file: Packed,
    bytes: Vec<u8>,
    position: usize,
}

impl Lines {
    pub(crate) fn of(path: &Path) -> Result<Self, ReadError> {
        let file = Packed::open(path)?;
        let (bytes, _) = file.start(LONGEST)?;
        Ok(Self { file, bytes, position: 0 })
    }

    /// Bytes consumed by the lines so far.
    pub(crate) fn position(&self) -> u64 {
        self.position as u64
    }

    /// The file, whose lines were read.
    pub(crate) fn into_file(self) -> Packed {
        self.file
    }
}

impl Iterator for Lines {
    type Item = String;

    /// The next line without its end; `None` where no line end follows.
    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.position..];
        let end = match rest.iter().position(|&b| b == b'\n') {
            Some(end) => end,
            // A detached header may lack the last line's end.
            None if !rest.is_empty() && (self.bytes.len() as u64) < LONGEST => rest.len(),
            None => return None,
        };
        let line = String::from_utf8_lossy(&rest[..end]).trim_end_matches('\r').to_owned();
        self.position = (self.position + end + 1).min(self.bytes.len());
        Some(line)
    }
}

/// Numbers separated by white space.
pub(crate) fn numbers<T: std::str::FromStr>(text: &str) -> Option<Vec<T>> {
    text.split_whitespace().map(|t| t.parse().ok()).collect()
}

/// mm in a unit of length, in whatever case; `None` for an unknown one. No name is mm.
pub(crate) fn mm_per(unit: &str) -> Option<f64> {
    let name = unit.trim().to_lowercase().replace("metre", "meter");
    // Words have a plural; `s` and `ms` are times.
    let singular = if name.len() > 4 { name.strip_suffix('s').unwrap_or(&name) } else { &name };
    match singular {
        "" | "mm" | "millimeter" | "???" | "?" => Some(1.0),
        "um" | "µm" | "μm" | "micron" | "micrometer" | "\\u00b5m" => Some(1e-3),
        "nm" | "nanometer" => Some(1e-6),
        "å" | "angstrom" => Some(1e-7),
        "cm" | "centimeter" => Some(10.0),
        "m" | "meter" => Some(1000.0),
        "in" | "inch" | "inche" => Some(25.4),
        _ => None,
    }
}

/// A data file named in a header, relative to it.
pub(crate) fn beside(header: &Path, name: &str) -> PathBuf {
    header.parent().unwrap_or(Path::new("")).join(name)
}
