//! Which labels to measure, and which to unite.

use super::{LabelImage, VolumeError};
use crate::text::{SHOWN_LABELS, listed};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Labels that are measured as one object.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct LabelGroup(Vec<i64>);

impl LabelGroup {
    /// A group of one label.
    pub fn single(label: i64) -> Self {
        Self(vec![label])
    }

    /// A group of several.
    pub(crate) fn united(labels: Vec<i64>) -> Self {
        Self(labels)
    }

    /// Whether it is the same labels, in whatever order.
    pub fn is_same(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.0.iter().all(|label| other.0.contains(label))
    }

    /// Whether it is one of some objects.
    pub fn is_among(&self, objects: &[Self]) -> bool {
        objects.iter().any(|object| self.is_same(object))
    }

    /// The labels.
    pub fn labels(&self) -> &[i64] {
        &self.0
    }
}

impl fmt::Display for LabelGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = self.0.iter().map(i64::to_string).collect();
        f.write_str(&parts.join("+"))
    }
}

/// A number for one label, a string such as `"1+2"` for united ones.
impl Serialize for LabelGroup {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0[..] {
            [label] => serializer.serialize_i64(label),
            _ => serializer.collect_str(self),
        }
    }
}

impl<'de> Deserialize<'de> for LabelGroup {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            One(i64),
            United(String),
        }
        match Written::deserialize(deserializer)? {
            Written::One(label) => Ok(Self::single(label)),
            Written::United(text) => match text.parse() {
                Ok(LabelSelection::Groups(groups)) if groups.len() == 1 => Ok(groups[0].clone()),
                _ => Err(serde::de::Error::custom(ParseSelectionError(text))),
            },
        }
    }
}

/// The labels of an image to measure: all of them, or a list of groups.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum LabelSelection {
    /// Each label that occurs, on its own.
    #[default]
    All,
    /// These, in this order.
    Groups(Vec<LabelGroup>),
}

impl LabelSelection {
    /// The groups to measure in an image.
    ///
    /// # Errors
    /// [`VolumeError::NoForeground`], [`VolumeError::GreyValues`] of what are no labels, unless some are named, or
    /// [`VolumeError::NoSuchLabel`] for one that does not occur.
    pub fn resolve(&self, image: &LabelImage) -> Result<Vec<LabelGroup>, VolumeError> {
        self.find(image)?.all()
    }

    /// The groups to measure in an image, and those that do not occur.
    pub(crate) fn find(&self, image: &LabelImage) -> Result<Found, VolumeError> {
        if *self == Self::All && image.is_grey() {
            return Err(VolumeError::GreyValues { labels: image.summaries().len() });
        }
        self.find_among(image.summaries().iter().map(|s| s.label))
    }

    /// A label that two of the groups have, with those.
    pub fn shared(&self) -> Option<(i64, [LabelGroup; 2])> {
        let Self::Groups(groups) = self else { return None };
        let pairs = (0..groups.len()).flat_map(|a| groups[a + 1..].iter().map(move |b| (&groups[a], b)));
        pairs.into_iter().find_map(|(a, b)| {
            let shared = a.0.iter().find(|label| b.0.contains(label))?;
            Some((*shared, [a.clone(), b.clone()]))
        })
    }

    /// The groups to measure among the labels that occur, background left out, and those of which a label does not. An error
    /// where all are such.
    pub(crate) fn find_among(&self, present: impl Iterator<Item = i64>) -> Result<Found, VolumeError> {
        let mut present: Vec<i64> = present.collect();
        present.sort_unstable();
        let groups = match self {
            _ if present.is_empty() => return Err(VolumeError::NoForeground),
            Self::All => {
                let groups = present.into_iter().map(LabelGroup::single).collect();
                return Ok(Found { groups, missing: Vec::new() });
            }
            Self::Groups(groups) => groups,
        };
        let mut found = Found::default();
        for group in groups {
            match group.labels().iter().find(|label| present.binary_search(label).is_err()) {
                None => found.groups.push(group.clone()),
                Some(&missing) => {
                    let present = listed(present.iter(), SHOWN_LABELS);
                    found.missing.push(VolumeError::NoSuchLabel { missing, present });
                }
            }
        }
        match found.missing.first() {
            Some(first) if found.groups.is_empty() => Err(first.clone()),
            _ => Ok(found),
        }
    }
}

/// What there is of a selection.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// The groups of which every label occurs.
    pub(crate) groups: Vec<LabelGroup>,
    /// [`VolumeError::NoSuchLabel`] for each of the others.
    pub(crate) missing: Vec<VolumeError>,
}

impl Found {
    /// The groups, where none is missing.
    pub(crate) fn all(self) -> Result<Vec<LabelGroup>, VolumeError> {
        self.missing.into_iter().next().map_or(Ok(self.groups), Err)
    }
}

/// A label selection that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "`{0}` is no label selection; write `all`, `1`, `1,2` (two objects) or `1+2` (one object of two labels); 0 is background"
)]
pub struct ParseSelectionError(String);

impl FromStr for LabelSelection {
    type Err = ParseSelectionError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "all" {
            return Ok(Self::All);
        }
        let label = |part: &str| part.trim().parse::<i64>().ok().filter(|&l| l != 0);
        let group = |part: &str| {
            part.split('+').map(label).collect::<Option<Vec<_>>>().map(without_repeats).map(LabelGroup)
        };
        let groups = text.split(',').map(group).collect::<Option<Vec<_>>>();
        groups.map(without_repeats).map(Self::Groups).ok_or_else(|| ParseSelectionError(text.to_owned()))
    }
}

/// The first of each, in order.
pub(crate) fn without_repeats<T: PartialEq>(items: Vec<T>) -> Vec<T> {
    items.into_iter().fold(Vec::new(), |mut unique, item| {
        if !unique.contains(&item) {
            unique.push(item);
        }
        unique
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_lists_and_unions() {
        let groups = |text: &str| match text.parse().unwrap() {
            LabelSelection::Groups(groups) => groups.iter().map(LabelGroup::to_string).collect::<Vec<_>>(),
            LabelSelection::All => vec!["all".into()],
        };
        assert_eq!(groups("all"), ["all"]);
        assert_eq!(groups("3"), ["3"]);
        assert_eq!(groups("3,-4"), ["3", "-4"]);
        assert_eq!(groups("1+2, 5"), ["1+2", "5"]);
        assert_eq!(groups("1,2+2,1"), ["1", "2"]);
        for bad in ["", "0", "a", "1,,2", "1+", "1.5"] {
            assert!(bad.parse::<LabelSelection>().is_err(), "{bad}");
        }
    }
}
