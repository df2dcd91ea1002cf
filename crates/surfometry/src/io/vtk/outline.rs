//! The elements of an XML file, without comments and the texts in it: voxels may take gigabytes there, and whatever else
//! somebody packs.

use super::image_data::error;
use crate::io::ReadError;
use crate::io::packed::Packed;
use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Bytes of elements: real files have some thousands. And of all that is looked through for them.
const MOST_KEPT: usize = 1 << 20;
const FURTHEST: u64 = 1 << 31;
const ARRAY: &[u8] = b"<DataArray";
const APPENDED: &[u8] = b"<AppendedData";

/// What is kept of a file.
#[derive(Default)]
pub(super) struct Outline {
    /// All elements up to what is appended.
    pub(super) elements: Vec<u8>,
    /// The text behind an array's tag, where there is one: from which byte of the file on, and how many, by the place of the
    /// tag among the elements.
    pub(super) texts: HashMap<usize, (u64, u64)>,
    /// From which byte of the file on voxels are appended, and whether as base64.
    pub(super) appended: Option<(u64, bool)>,
}

/// Where a scan is.
#[derive(Clone, Copy)]
enum Place {
    /// In a text, since this byte of the file; behind an array's tag at this place among the elements.
    Text { since: u64, array: Option<usize> },
    /// In a tag at this place among the elements, and in quotes of this kind.
    Tag { at: usize, quote: Option<u8> },
    /// In what is left out up to these words, of which the last bytes were read.
    Left { end: &'static [u8], last: [u8; 3] },
    /// Between the tag of what is appended and its mark.
    Appended { base64: bool },
}

impl Place {
    /// How many of the next bytes lead nowhere else: most of a file's.
    fn idle(self, bytes: &[u8]) -> usize {
        let wanted = match self {
            Self::Text { .. } => b'<',
            Self::Left { .. } => b'>',
            Self::Appended { .. } => b'_',
            Self::Tag { .. } => return 0,
        };
        bytes.iter().position(|byte| *byte == wanted).unwrap_or(bytes.len())
    }

    /// Behind such bytes.
    fn behind(self, idle: &[u8]) -> Self {
        let Self::Left { end, mut last } = self else { return self };
        for &byte in &idle[idle.len().saturating_sub(2)..] {
            last = [last[1], last[2], byte];
        }
        Self::Left { end, last }
    }
}

impl Outline {
    /// Reads a file, packed or not, as far as its elements go.
    ///
    /// # Errors
    /// [`ReadError`] for damage, and elements that are no image's.
    pub(super) fn read(path: &Path) -> Result<Self, ReadError> {
        let mut file = BufReader::new(Packed::open(path)?.into_reader()?);
        let (mut outline, mut place) = (Self::default(), Place::Text { since: 0, array: None });
        let mut byte = 0;
        while outline.appended.is_none() {
            let bytes = file.fill_buf().map_err(|e| ReadError::damaged(path, &e))?;
            if bytes.is_empty() {
                break;
            }
            let mut rest = bytes;
            while let Some((&found, behind)) = rest.split_first() {
                let idle = place.idle(rest);
                if idle > 0 {
                    place = place.behind(&rest[..idle]);
                    (rest, byte) = (&rest[idle..], byte + idle as u64);
                } else {
                    place = outline.step(place, found, byte);
                    (rest, byte) = (behind, byte + 1);
                }
            }
            let read = bytes.len();
            file.consume(read);
            if outline.elements.len() > MOST_KEPT || byte > FURTHEST {
                return Err(error(format!(
                    "elements of {} bytes in the first {byte}, which are no image's; export the image again, with appended arrays",
                    outline.elements.len()
                )));
            }
        }
        Ok(outline)
    }

    /// Where the next byte, at this place of the file, leads.
    fn step(&mut self, place: Place, found: u8, byte: u64) -> Place {
        match place {
            Place::Text { since, array } if found == b'<' => {
                if let Some(array) = array.filter(|_| byte > since) {
                    self.texts.insert(array, (since, byte - since));
                }
                self.elements.push(found);
                Place::Tag { at: self.elements.len() - 1, quote: None }
            }
            Place::Tag { at, quote } => self.in_tag(at, quote, found, byte),
            Place::Left { end, last } => {
                let last = [last[1], last[2], found];
                if last.ends_with(end) {
                    Place::Text { since: byte + 1, array: None }
                } else {
                    Place::Left { end, last }
                }
            }
            Place::Appended { base64 } if found == b'_' => {
                self.appended.get_or_insert((byte + 1, base64));
                place
            }
            Place::Text { .. } | Place::Appended { .. } => place,
        }
    }

    fn in_tag(&mut self, at: usize, quote: Option<u8>, found: u8, byte: u64) -> Place {
        self.elements.push(found);
        let tag = &self.elements[at..];
        for (start, end) in [(&b"<!--"[..], &b"-->"[..]), (b"<![CDATA[", b"]]>"), (b"<?", b"?>")] {
            if tag == start {
                self.elements.truncate(at);
                return Place::Left { end, last: [0; 3] };
            }
        }
        let quote = match (quote, found) {
            (None, b'"' | b'\'') => Some(found),
            (Some(open), _) if open == found => None,
            (quote, _) => quote,
        };
        if found != b'>' || quote.is_some() {
            return Place::Tag { at, quote };
        }
        if tag.starts_with(APPENDED) {
            let base64 = tag.windows(6).any(|word| word == b"base64");
            // What is appended is no XML.
            self.elements.truncate(at);
            self.elements.extend(b"</VTKFile>");
            return Place::Appended { base64 };
        }
        let is_array = tag.starts_with(ARRAY) && !tag.ends_with(b"/>");
        Place::Text { since: byte + 1, array: is_array.then_some(at) }
    }
}
