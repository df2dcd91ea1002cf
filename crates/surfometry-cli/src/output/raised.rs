//! Warnings as text: each once, with what it is about.

use super::record_name;
use super::width::wrapped;
use surfometry::accuracy::{Flag, FlagCode};
use surfometry::measurement::UNEXPLAINED;
use surfometry::runs::Record;

/// Labels that a warning names before it only counts them.
const SHOWN_LABELS: usize = 12;

/// The option of `measure` that tells where topology changed.
pub(crate) const EXPLAIN: &str = "--explain";

/// The flags of some objects by code, in the order in which they were first raised.
#[derive(Default)]
pub(crate) struct RaisedFlags(Vec<Raised>);

/// A code that some objects have.
pub(crate) struct Raised {
    pub(crate) code: FlagCode,
    /// How many have it.
    pub(crate) objects: usize,
    /// Of the first ones.
    names: Vec<String>,
    /// The first one's message, and whether all have it.
    message: String,
    same: bool,
}

impl RaisedFlags {
    /// Adds a flag of an object; the number of its code.
    pub(crate) fn add(&mut self, name: &str, flag: &Flag) -> usize {
        let known = self.0.iter().position(|raised| raised.code == flag.code);
        let number = known.unwrap_or_else(|| {
            self.0.push(Raised::first(flag));
            self.0.len() - 1
        });
        let raised = &mut self.0[number];
        raised.objects += 1;
        raised.same &= raised.message == flag.message;
        if raised.names.len() < SHOWN_LABELS {
            raised.names.push(name.to_owned());
        }
        number
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Raised> {
        self.0.iter()
    }
}

impl Raised {
    fn first(flag: &Flag) -> Self {
        Self { code: flag.code, objects: 0, names: Vec::new(), message: flag.message.clone(), same: true }
    }

    /// The message, whose it is, and what tells more.
    pub(crate) fn in_words(&self, explain: &str) -> String {
        let others = if self.same { "" } else { "for the first: " };
        let how = if self.message.ends_with(UNEXPLAINED) { format!(" ({explain})") } else { String::new() };
        format!("{others}{}{how}", self.message)
    }

    fn labels(&self) -> String {
        let shown = self.names.join(", ");
        match self.objects - self.names.len() {
            0 => shown,
            more => format!("{shown} and {more} more"),
        }
    }
}

/// Each warning of a measurement once, with the labels it is about.
pub(crate) fn flags_text(records: &[&Record]) -> String {
    paragraphs(&flags_of(records), records.len(), EXPLAIN)
}

/// The same of a map's objects.
pub(crate) fn map_flags_text(records: &[&Record]) -> String {
    raised_text(&flags_of(records), records.len())
}

fn flags_of(records: &[&Record]) -> Vec<(String, Flag)> {
    let of_record = |record: &&Record| {
        record.measured.flags.iter().map(|flag| (record_name(record), flag.clone())).collect::<Vec<_>>()
    };
    records.iter().flat_map(of_record).collect()
}

/// Flags of some objects, each with the name of the one that it is of: a paragraph a code. Where no standard errors are shown,
/// none is missing.
pub(crate) fn raised_text(all: &[(String, Flag)], objects: usize) -> String {
    let shown: Vec<_> = all.iter().filter(|(_, flag)| flag.code != FlagCode::NotComputed).cloned().collect();
    paragraphs(&shown, objects, "surfometry measure FILE --embedding gaussian --explain")
}

fn paragraphs(all: &[(String, Flag)], objects: usize, explain: &str) -> String {
    let mut flags = RaisedFlags::default();
    for (name, flag) in all {
        flags.add(name, flag);
    }
    let paragraph = |raised: &Raised| {
        let about = if objects == 1 { String::new() } else { format!(" (label {})", raised.labels()) };
        wrapped(&format!("{}{about}: {}", raised.code, raised.in_words(explain)), "  ! ", "    ")
    };
    flags.iter().map(paragraph).collect()
}
