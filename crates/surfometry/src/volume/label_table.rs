//! What labels stand for.

use std::collections::BTreeMap;

/// Name and colour of a label, as far as a file tells them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LabelEntry {
    /// Name, not empty.
    pub name: Option<String>,
    /// Colour in sRGB.
    pub colour: Option<[u8; 3]>,
}

/// Names and colours of labels.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LabelTable(BTreeMap<i64, LabelEntry>);

impl LabelTable {
    /// Whether nothing is told.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What is told of a label.
    pub fn get(&self, label: i64) -> Option<&LabelEntry> {
        self.0.get(&label)
    }

    /// All entries in order of label.
    pub fn iter(&self) -> impl Iterator<Item = (i64, &LabelEntry)> {
        self.0.iter().map(|(label, entry)| (*label, entry))
    }

    /// The names alone.
    pub fn names(&self) -> BTreeMap<i64, String> {
        let named = |(label, entry): (&i64, &LabelEntry)| Some((*label, entry.name.clone()?));
        self.0.iter().filter_map(named).collect()
    }
}

/// The last entry of a label counts. White space around a name is taken off; a name of nothing else is none.
impl FromIterator<(i64, LabelEntry)> for LabelTable {
    fn from_iter<I: IntoIterator<Item = (i64, LabelEntry)>>(entries: I) -> Self {
        let tidy = |(label, LabelEntry { name, colour }): (i64, LabelEntry)| {
            let name = name.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty());
            (label, LabelEntry { name, colour })
        };
        Self(entries.into_iter().map(tidy).collect())
    }
}
