//! Helpers for formats whose header is text.

use super::ReadError;
use super::header::read_start;
use std::path::{Path, PathBuf};

/// Longer than any real header; bounds what is read from a file that is none.
const LONGEST: u64 = 1 << 20;

/// The start of a file, split into lines that can be walked with byte positions.
pub(crate) struct Lines {
    bytes: Vec<u8>,
    position: usize,
}

impl Lines {
    pub(crate) fn of(path: &Path) -> Result<Self, ReadError> {
        Ok(Self { bytes: read_start(path, LONGEST)?, position: 0 })
    }

    /// Bytes consumed by the lines so far.
    pub(crate) fn position(&self) -> u64 {
        self.position as u64
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

/// mm in a unit of length; `None` for an unknown one.
pub(crate) fn mm_per(unit: &str) -> Option<f64> {
    match unit {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" | "???" | "?" => Some(1.0),
        "um" | "µm" | "μm" | "micron" | "microns" | "micrometer" | "micrometers" => Some(1e-3),
        "nm" | "nanometer" | "nanometers" => Some(1e-6),
        "cm" | "centimeter" | "centimeters" => Some(10.0),
        "m" | "meter" | "meters" => Some(1000.0),
        _ => None,
    }
}

/// A data file named in a header, relative to it.
pub(crate) fn beside(header: &Path, name: &str) -> PathBuf {
    header.parent().unwrap_or(Path::new("")).join(name)
}
