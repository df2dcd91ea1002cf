//! What labels stand for.

use super::LabelGroup;
use crate::text::turns_text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name and colour of a label, as far as a file tells them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LabelEntry {
    /// Name, not empty.
    pub name: Option<String>,
    /// Colour in sRGB.
    pub colour: Option<[u8; 3]>,
}

/// Names and colours of labels, and names of several labels that are one region.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LabelTable {
    entries: BTreeMap<i64, LabelEntry>,
    /// Labels of a region, in ascending order.
    regions: BTreeMap<String, Vec<i64>>,
}

impl LabelTable {
    /// Whether nothing is told.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty() && self.regions.is_empty()
    }

    /// What is told of a label.
    pub fn get(&self, label: i64) -> Option<&LabelEntry> {
        self.entries.get(&label)
    }

    /// All entries in order of label.
    pub fn iter(&self) -> impl Iterator<Item = (i64, &LabelEntry)> {
        self.entries.iter().map(|(label, entry)| (*label, entry))
    }

    /// The names alone.
    pub fn names(&self) -> BTreeMap<i64, String> {
        let named = |(label, entry): (&i64, &LabelEntry)| Some((*label, entry.name.clone()?));
        self.entries.iter().filter_map(named).collect()
    }

    /// The same with names of several labels that are one region, as nnU-Net's whole tumour is of its parts.
    #[must_use]
    pub fn with_regions(mut self, regions: impl IntoIterator<Item = (String, Vec<i64>)>) -> Self {
        for (name, mut labels) in regions {
            labels.sort_unstable();
            labels.dedup();
            if let Some(name) = tidy(&name) {
                self.regions.insert(name, labels);
            }
        }
        self
    }

    /// The same; what another table says of a label wins.
    #[must_use]
    pub fn overlaid(mut self, over: &Self) -> Self {
        for (label, LabelEntry { name, colour }) in &over.entries {
            let entry = self.entries.entry(*label).or_default();
            entry.name = name.clone().or(entry.name.take());
            entry.colour = colour.or(entry.colour);
        }
        self.regions.extend(over.regions.clone());
        self
    }

    /// What an object is called: a label's name, a region's, or the names of united labels, joined by ` + `; `None`
    /// where one of them has none.
    pub fn name_of(&self, object: &LabelGroup) -> Option<String> {
        let mut labels = object.labels().to_vec();
        labels.sort_unstable();
        if let Some((region, _)) = self.regions.iter().find(|(_, of)| labels.len() > 1 && **of == labels) {
            return Some(region.clone());
        }
        let name = |label: &i64| self.entries.get(label)?.name.clone();
        Some(object.labels().iter().map(name).collect::<Option<Vec<_>>>()?.join(" + "))
    }

    /// The colour of an object, in sRGB: that of its first label which has one.
    pub fn colour_of(&self, object: &LabelGroup) -> Option<[u8; 3]> {
        object.labels().iter().find_map(|label| self.entries.get(label)?.colour)
    }

    /// The objects of a name: a label or a region, in order of label. Where none is written exactly so, those that
    /// only differ in case.
    pub fn called(&self, name: &str) -> Vec<LabelGroup> {
        let exact = self.whose_name(|known| known == name);
        if !exact.is_empty() {
            return exact;
        }
        let lower = name.to_lowercase();
        self.whose_name(|known| known.to_lowercase() == lower)
    }

    fn whose_name(&self, matches: impl Fn(&str) -> bool) -> Vec<LabelGroup> {
        let named = |entry: &LabelEntry| entry.name.as_deref().is_some_and(&matches);
        let labels = self.entries.iter().filter(|(_, entry)| named(entry));
        let regions = self.regions.iter().filter(|(region, _)| matches(region));
        labels
            .map(|(label, _)| LabelGroup::single(*label))
            .chain(regions.map(|(_, labels)| LabelGroup::united(labels.clone())))
            .collect()
    }

    /// All names that [`Self::called`] knows.
    pub fn all_names(&self) -> impl Iterator<Item = &str> {
        let names = self.entries.values().filter_map(|entry| entry.name.as_deref());
        names.chain(self.regions.keys().map(String::as_str))
    }
}

/// The last entry of a label counts. White space around a name is taken off, and control characters are spaces; a name of
/// nothing else is none.
impl FromIterator<(i64, LabelEntry)> for LabelTable {
    fn from_iter<I: IntoIterator<Item = (i64, LabelEntry)>>(entries: I) -> Self {
        let tidied = |(label, LabelEntry { name, colour }): (i64, LabelEntry)| {
            (label, LabelEntry { name: name.as_deref().and_then(tidy), colour })
        };
        Self { entries: entries.into_iter().map(tidied).collect(), regions: BTreeMap::new() }
    }
}

/// Of names without colours.
impl FromIterator<(i64, String)> for LabelTable {
    fn from_iter<I: IntoIterator<Item = (i64, String)>>(names: I) -> Self {
        let entry = |(label, name)| (label, LabelEntry { name: Some(name), colour: None });
        names.into_iter().map(entry).collect()
    }
}

/// A colour as `#rrggbb`.
#[cfg(feature = "io")]
pub(crate) fn hexadecimal([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn tidy(name: &str) -> Option<String> {
    let printable = name.chars().filter(|c| !turns_text(*c)).map(|c| if c.is_control() { ' ' } else { c });
    let printable: String = printable.collect();
    let name = printable.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: &str, colour: Option<[u8; 3]>) -> LabelEntry {
        LabelEntry { name: Some(name.to_owned()), colour }
    }

    fn table() -> LabelTable {
        let entries = [
            (1, entry(" Liver\u{202e}\u{7}", Some([1, 2, 3]))),
            (2, entry("liver", None)),
            (5, entry("Spleen", None)),
        ];
        entries.into_iter().collect::<LabelTable>().with_regions([("organs".to_owned(), vec![5, 1, 5])])
    }

    #[test]
    fn names_are_found_exactly_and_then_in_any_case() {
        let called = |name: &str| table().called(name).iter().map(LabelGroup::to_string).collect::<Vec<_>>();
        assert_eq!(called("liver"), ["2"]);
        assert_eq!(called("LIVER"), ["1", "2"]);
        assert_eq!(called("spleen"), ["5"]);
        assert_eq!(called("Organs"), ["1+5"]);
        assert!(called("live").is_empty());
    }

    #[test]
    fn objects_have_names_of_labels_regions_or_parts() {
        let name = |labels: &[i64]| table().name_of(&LabelGroup::united(labels.to_vec()));
        assert_eq!(name(&[5]).as_deref(), Some("Spleen"));
        assert_eq!(name(&[5, 1]).as_deref(), Some("organs"));
        assert_eq!(name(&[2, 5]).as_deref(), Some("liver + Spleen"));
        assert_eq!(name(&[2, 9]), None);
    }

    #[test]
    fn what_lies_over_a_table_wins_label_by_label() {
        let over = LabelTable::from_iter([(1, entry("hepar", None)), (7, entry("heart", Some([9; 3])))]);
        let both = table().overlaid(&over);
        assert_eq!(both.get(1), Some(&entry("hepar", Some([1, 2, 3]))));
        assert_eq!(both.get(5), Some(&entry("Spleen", None)));
        assert_eq!(both.get(7), Some(&entry("heart", Some([9; 3]))));
    }
}
