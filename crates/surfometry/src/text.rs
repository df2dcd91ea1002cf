//! Characters of names and other texts of files, and lists of them.

use std::borrow::Cow;
use std::fmt::Display;

/// How formulas begin, in one program or another.
#[cfg(feature = "io")]
pub(crate) const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Whether a character turns the direction of the text around it, so that a name could read as another one: the marks,
/// embeddings, overrides and isolates of Unicode's bidirectional algorithm (UAX #9). Letters written from right to left
/// do so without them.
pub fn turns_text(c: char) -> bool {
    matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text without what a terminal takes for commands, which names of files and texts in them may hold.
pub fn plain(text: &str) -> Cow<'_, str> {
    escaped(text, |c| c == '\n' || c == '\t' || is_harmless(c))
}

/// A name, which is to stay in its line.
pub fn one_line(name: &str) -> Cow<'_, str> {
    escaped(name, is_harmless)
}

fn escaped(text: &str, is_kept: impl Fn(char) -> bool) -> Cow<'_, str> {
    if text.chars().all(&is_kept) {
        return text.into();
    }
    let shown = |c: char| if is_kept(c) { c.to_string() } else { c.escape_default().to_string() };
    text.chars().map(shown).collect()
}

/// Neither a command nor what turns the direction of the text around it, so that a name would read as another one.
fn is_harmless(c: char) -> bool {
    !turns_text(c) && !c.is_control()
}

/// How many labels or names of labels are shown of those that there are.
pub(crate) const SHOWN_LABELS: usize = 20;

/// The first `most` of some things, and how many more there are.
pub(crate) fn listed<T: Display>(things: impl ExactSizeIterator<Item = T>, most: usize) -> String {
    let more = things.len().saturating_sub(most);
    let shown = things.take(most).map(|thing| thing.to_string()).collect::<Vec<_>>().join(", ");
    if more == 0 { shown } else { format!("{shown} and {more} more") }
}

/// Names that are suggested.
const SUGGESTED: usize = 3;
/// Likeness (Jaro and Winkler's, 0 to 1) from which a name may have been meant.
const ALIKE: f64 = 0.75;

/// The known names that are most like one that is not known, the likest first.
pub fn nearest<'a>(name: &str, known: &[&'a str]) -> Vec<&'a str> {
    let lower = name.to_lowercase();
    let likeness = |known: &str| {
        let known = known.to_lowercase();
        // A part of a name comes first: `kidney` of `kidney_left`.
        if known.contains(&lower) { 1.0 } else { strsim::jaro_winkler(&lower, &known) }
    };
    let mut alike: Vec<(f64, &str)> = known.iter().map(|&known| (likeness(known), known)).collect();
    alike.retain(|(likeness, _)| *likeness >= ALIKE);
    alike.sort_by(|a, b| b.0.total_cmp(&a.0));
    alike.into_iter().take(SUGGESTED).map(|(_, known)| known).collect()
}

/// A question that goes before what is known instead of a name, as `did you mean ball? `; nothing where no name is like it.
pub fn did_you_mean(name: &str, known: &[&str]) -> String {
    question(&nearest(name, known))
}

/// The same of names that were found.
pub(crate) fn question(names: &[impl Display]) -> String {
    let names: Vec<String> = names.iter().map(ToString::to_string).collect();
    if names.is_empty() { String::new() } else { format!("did you mean {}? ", names.join(" or ")) }
}

/// A number in a sentence, as it is or to four decimals; of hundreds of digits, its power.
pub(crate) fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-4..1e7).contains(&value.abs());
    if plain { format!("{}", (1e4 * value).round() / 1e4) } else { format!("{value:.3e}") }
}

#[cfg(test)]
mod tests {
    use super::{one_line, plain};

    #[test]
    fn names_command_no_terminal() {
        assert_eq!(plain("a\u{1b}[31m\tb\nc"), "a\\u{1b}[31m\tb\nc");
        assert_eq!(plain("a\u{202e}gnp.exe\u{2069}"), "a\\u{202e}gnp.exe\\u{2069}");
        assert_eq!(one_line("a\nb\tc\u{200f}"), "a\\nb\\tc\\u{200f}");
        // Names in other scripts are names.
        assert_eq!(
            one_line("\u{05db}\u{05d1}\u{05d3} \u{809d}\u{81d3} a\u{0308}"),
            "\u{05db}\u{05d1}\u{05d3} \u{809d}\u{81d3} a\u{0308}"
        );
    }
}
