//! Warnings as text: each once, with what it is about.

use super::record_name;
use super::width::wrapped;
use surfometry::accuracy::{Flag, FlagCode};
use surfometry::measurement::UNEXPLAINED;
use surfometry::runs::Record;

/// Labels that a warning names before it only counts them.
const SHOWN_LABELS: usize = 12;

/// Each warning once, with the labels it is about. What the table does not show needs no `not-computed`.
pub(crate) fn flags_text(records: &[&Record]) -> String {
    let of_record = |record: &&'_ Record| {
        record.measured.flags.iter().map(|flag| (record_name(record), flag.clone())).collect::<Vec<_>>()
    };
    raised_text(&records.iter().flat_map(of_record).collect::<Vec<_>>(), records.len())
}

/// Flags of some objects, each with the name of the one that it is of: a paragraph a code.
pub(crate) fn raised_text(all: &[(String, Flag)], objects: usize) -> String {
    let mut codes: Vec<FlagCode> = Vec::new();
    for (_, flag) in all {
        if is_shown(flag) && !codes.contains(&flag.code) {
            codes.push(flag.code);
        }
    }
    let paragraph = |code: FlagCode| {
        let raised: Vec<&(String, Flag)> = all.iter().filter(|(_, flag)| flag.code == code).collect();
        let about = if objects == 1 { String::new() } else { format!(" (label {})", shown_labels(&raised)) };
        let same = raised.iter().all(|(_, flag)| flag.message == raised[0].1.message);
        let others = if same { "" } else { "for the first: " };
        wrapped(&format!("{code}{about}: {others}{}", in_words(&raised[0].1)), "  ! ", "    ")
    };
    codes.into_iter().map(paragraph).collect()
}

/// Whether a flag is for people, who see a dash where a number is missing.
pub(crate) fn is_shown(flag: &Flag) -> bool {
    flag.code != FlagCode::NotComputed
}

/// A flag's message, and the option that tells more.
pub(crate) fn in_words(flag: &Flag) -> String {
    let how = if flag.message.ends_with(UNEXPLAINED) { " (--explain)" } else { "" };
    format!("{}{how}", flag.message)
}

fn shown_labels(raised: &[&(String, Flag)]) -> String {
    let labels = raised.iter().map(|(name, _)| name.as_str());
    let shown = labels.take(SHOWN_LABELS).collect::<Vec<_>>().join(", ");
    match raised.len().saturating_sub(SHOWN_LABELS) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
