//! Labels as they are written: by number or by name.

use super::words::WordError;
use crate::volume::{LabelGroup, LabelSelection, without_repeats};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A label, or labels that are one object.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum LabelWord {
    /// By number; not 0, which is background.
    Number(i64),
    /// By name, of a label or a region.
    Name(String),
}

/// What is united to one object.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct GroupWords(pub(super) Vec<LabelWord>);

/// Which objects of an image are meant: all, or a list, each a label or united ones, by number or by name.
///
/// ```
/// use surfometry::runs::SelectionWords;
/// let words: SelectionWords = "2,liver+3,'heart, left'".parse()?; // `20-24` is each of five labels
/// assert_eq!(words.to_string(), "2,liver+3,'heart, left'");
/// # Ok::<(), surfometry::runs::WordError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum SelectionWords {
    /// Each object that there is.
    #[default]
    All,
    /// These, in this order.
    Groups(Vec<GroupWords>),
}

impl GroupWords {
    /// Whether it is the same words, in whatever order.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.0.iter().all(|word| other.0.contains(word))
    }

    /// The labels, where none is called by name.
    pub(super) fn numbers(&self) -> Option<LabelGroup> {
        let number = |word: &LabelWord| match word {
            LabelWord::Number(label) => Some(*label),
            LabelWord::Name(_) => None,
        };
        self.0.iter().map(number).collect::<Option<_>>().map(LabelGroup::united)
    }
}

impl SelectionWords {
    /// These and others; all where either is.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Groups(these), Self::Groups(others)) => {
                Self::Groups(without_repeats([these, others].concat()))
            }
            _ => Self::All,
        }
    }

    /// The labels, where none is called by name.
    pub(super) fn numbers(&self) -> Option<LabelSelection> {
        match self {
            Self::All => Some(LabelSelection::All),
            Self::Groups(groups) => {
                groups.iter().map(GroupWords::numbers).collect::<Option<_>>().map(LabelSelection::Groups)
            }
        }
    }
}

impl From<LabelGroup> for GroupWords {
    fn from(group: LabelGroup) -> Self {
        Self(group.labels().iter().copied().map(LabelWord::Number).collect())
    }
}

impl From<LabelSelection> for SelectionWords {
    fn from(selection: LabelSelection) -> Self {
        match selection {
            LabelSelection::All => Self::All,
            LabelSelection::Groups(groups) => Self::Groups(groups.into_iter().map(Into::into).collect()),
        }
    }
}

/// As it is written: names in quotes where they need them.
impl fmt::Display for LabelWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(label) => label.fmt(f),
            Self::Name(name) if name.contains([',', '+', '=', '"', '\'']) || is_no_name(name) => {
                let quote = if name.contains('\'') { '"' } else { '\'' };
                write!(f, "{quote}{name}{quote}")
            }
            Self::Name(name) => f.write_str(name),
        }
    }
}

impl fmt::Display for GroupWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.iter().map(ToString::to_string).collect::<Vec<_>>().join("+"))
    }
}

impl fmt::Display for SelectionWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::Groups(groups) => {
                f.write_str(&groups.iter().map(ToString::to_string).collect::<Vec<_>>().join(","))
            }
        }
    }
}

impl FromStr for SelectionWords {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        if text == "all" {
            return Ok(Self::All);
        }
        let mut groups = Vec::new();
        for part in parts(text, ',') {
            match range(part) {
                Some((first, last)) if first < last && last - first < MOST_OF_A_RANGE => {
                    groups.extend((first..=last).map(|label| LabelGroup::single(label).into()));
                }
                Some(_) => {
                    return Err(WordError(format!(
                        "`{part}` is no range of labels: write the lower one first, and at most {MOST_OF_A_RANGE}"
                    )));
                }
                None => groups.push(part.parse()?),
            }
        }
        Ok(Self::Groups(without_repeats(groups)))
    }
}

/// Labels of a range: more are a slip, for each that does not occur is told.
const MOST_OF_A_RANGE: i64 = 10_000;

/// Labels from one to another, as `20-24`.
fn range(word: &str) -> Option<(i64, i64)> {
    let (first, last) = word.trim().split_once('-')?;
    let label = |text: &str| {
        text.bytes()
            .all(|byte| byte.is_ascii_digit())
            .then(|| text.parse().ok())
            .flatten()
            .filter(|&label| label > 0)
    };
    Some((label(first)?, label(last)?))
}

impl FromStr for GroupWords {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        let words = parts(text, '+').into_iter().map(str::parse).collect::<Result<Vec<_>, _>>()?;
        Ok(Self(without_repeats(words)))
    }
}

impl FromStr for LabelWord {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        let word = text.trim();
        let slip = || {
            WordError(format!(
                "`{text}` is no label; write `all`, `1`, `1,2` (two objects), `1-5` (five), `1+2` (one object of two labels) or names, as \
                 `liver,spleen`; a name with a comma, a plus or an equals sign, or of digits alone, stands in quotes; 0 is background"
            ))
        };
        if word.starts_with(['\'', '"']) {
            return unquoted(word).map(|name| Self::Name(name.to_owned())).ok_or_else(slip);
        }
        if let Some(meant) = as_written_here(word) {
            return Err(WordError(format!(
                "`{text}` is no label: write {meant}; a name like that stands in quotes"
            )));
        }
        match word.parse() {
            Ok(label) if label != 0 => Ok(Self::Number(label)),
            _ if is_no_name(word) => Err(slip()),
            _ => Ok(Self::Name(word.to_owned())),
        }
    }
}

/// What would be taken for something else, or for a slip.
fn is_no_name(word: &str) -> bool {
    word.trim() != word
        || word.is_empty()
        || word == "all"
        || word.parse::<f64>().is_ok()
        || range(word).is_some()
        || as_written_here(word).is_some()
}

/// How numbers are written that other signs than ours stand between, as `20:22`, `20..22` or `20 21`.
fn as_written_here(word: &str) -> Option<String> {
    let is_number = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let ends = [":", "..", "\u{2013}"].into_iter().find_map(|sign| word.split_once(sign));
    if let Some((first, last)) = ends.filter(|(first, last)| is_number(first) && is_number(last)) {
        return Some(format!("`{first}-{last}` (each from {first} to {last}) or `{first},{last}` (two)"));
    }
    let parts: Vec<&str> = word.split([' ', ';']).filter(|part| !part.is_empty()).collect();
    (parts.len() > 1 && parts.iter().all(is_number)).then(|| format!("`{}`", parts.join(",")))
}

/// The parts between separators that are not in quotes; an apostrophe within a name is none.
pub(super) fn parts(text: &str, separator: char) -> Vec<&str> {
    let (mut quote, mut begins, mut start, mut found) = (None, true, 0, Vec::new());
    for (at, c) in text.char_indices() {
        if quote.is_none() && c == separator {
            found.push(&text[start..at]);
            start = at + c.len_utf8();
        }
        quote = match quote {
            None if begins && matches!(c, '\'' | '"') => Some(c),
            Some(open) if c == open => None,
            other => other,
        };
        begins = matches!(c, ',' | '+' | '=') || begins && c.is_whitespace();
    }
    found.push(&text[start..]);
    found
}

fn unquoted(word: &str) -> Option<&str> {
    let quote = word.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    word[1..].strip_suffix(quote).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<Vec<String>> {
        let word = |word: &LabelWord| match word {
            LabelWord::Number(label) => format!("#{label}"),
            LabelWord::Name(name) => name.clone(),
        };
        match text.parse().unwrap() {
            SelectionWords::All => vec![],
            SelectionWords::Groups(groups) => {
                groups.iter().map(|group| group.0.iter().map(word).collect()).collect()
            }
        }
    }

    #[test]
    fn numbers_and_names_mix() {
        assert_eq!(read("1,liver+-3, left kidney"), [vec!["#1"], vec!["liver", "#-3"], vec!["left kidney"]]);
        assert_eq!(read("'a,b'+\"c+d\",'7'"), [vec!["a,b", "c+d"], vec!["7"]]);
        assert_eq!(read("Crohn's,2"), [vec!["Crohn's"], vec!["#2"]]);
        assert_eq!(read("1,1,x+x"), [vec!["#1"], vec!["x"]]);
        assert_eq!(read("2-4,3,'5-6',L1-3"), [vec!["#2"], vec!["#3"], vec!["#4"], vec!["5-6"], vec!["L1-3"]]);
        assert!(read("all").is_empty());
        for slip in ["", "0", "1,,2", "1+", "1.5", "''", "liver,", "3-1", "2-2", "1-90000", "1-3+7"] {
            assert!(slip.parse::<SelectionWords>().is_err(), "{slip}");
        }
        for (slip, meant) in
            [("20:22", "`20-22`"), ("20..22", "`20-22`"), ("20 21", "`20,21`"), ("1;2 ; 3", "`1,2,3`")]
        {
            let told = slip.parse::<SelectionWords>().unwrap_err().to_string();
            assert!(told.contains(meant), "{slip}: {told}");
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        for text in
            ["all", "1,2+3", "liver,'a,b'", "\"Crohn's, old\"", "'12'+'all'", "'x=2'", "'20:22'", "T12:L1"]
        {
            let words: SelectionWords = text.parse().unwrap();
            assert_eq!(words.to_string(), text);
            assert_eq!(words.to_string().parse::<SelectionWords>().unwrap(), words);
        }
    }
}
