//! Lengths of objects, as they are written.

use super::label_words::{GroupWords, parts};
use super::words::{WordError, positive};
use std::str::FromStr;

/// A length in mm, or the automatic one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// What suits the spacing.
    Auto,
    /// So many mm.
    Mm(f64),
}

impl Length {
    /// In mm; `None` for the automatic one.
    pub fn mm(self) -> Option<f64> {
        match self {
            Self::Auto => None,
            Self::Mm(mm) => Some(mm),
        }
    }
}

impl FromStr for Length {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        if text == "auto" { Ok(Self::Auto) } else { positive(text).map(Self::Mm) }
    }
}

/// A length for all objects, lengths of labels of their own, or both.
///
/// ```
/// use surfometry::runs::{Length, Lengths};
/// let lengths: Lengths = "2,20=1.5,20+21=auto".parse()?;
/// assert_eq!((lengths.of_all, lengths.of_labels.len()), (Some(Length::Mm(2.0)), 2));
/// # Ok::<(), surfometry::runs::WordError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lengths {
    /// That of all objects that have none of their own; `None` where nothing was said.
    pub of_all: Option<Length>,
    /// Those of labels, or of labels that are united, by number or by name.
    pub of_labels: Vec<(GroupWords, Length)>,
}

impl Lengths {
    /// Whether anything was said.
    pub fn is_empty(&self) -> bool {
        self.of_all.is_none() && self.of_labels.is_empty()
    }

    /// Whether some object has a length that does not follow the spacing, or may have.
    pub fn is_explicit(&self) -> bool {
        matches!(self.of_all, Some(Length::Mm(_))) || !self.of_labels.is_empty()
    }

    pub(super) fn own(&self) -> Vec<(GroupWords, Option<f64>)> {
        self.of_labels.iter().map(|(label, length)| (label.clone(), length.mm())).collect()
    }
}

impl FromStr for Lengths {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        let mut lengths = Self::default();
        for part in parts(text, ',') {
            let [label, mm] = parts(part, '=')[..] else {
                if lengths.of_all.is_some() {
                    return Err(WordError(
                        "one length is for all labels; write the others as LABEL=MM, and decimals with a point".to_owned(),
                    ));
                }
                lengths.of_all = Some(part.parse()?);
                continue;
            };
            let label: GroupWords = label
                .parse()
                .map_err(|error| WordError(format!("{error}; name one label, or united ones as 1+2")))?;
            if lengths.of_labels.iter().any(|(known, _)| known.is_same(&label)) {
                return Err(WordError(format!("label {label} has two lengths")));
            }
            lengths.of_labels.push((label, mm.parse()?));
        }
        Ok(lengths)
    }
}
