//! How wide a person's window is, and texts that fit into it.

use std::sync::LazyLock;
use textwrap::Options;

/// Columns that every table fits into.
const NARROW: usize = 80;
/// Columns beyond which lines are hard to read.
const WIDE: usize = 120;

/// Columns to print into: those of the terminal, or of `COLUMNS`, between 80 and 120; 80 where nobody says.
pub(crate) fn width() -> usize {
    static WIDTH: LazyLock<usize> = LazyLock::new(|| {
        let said = || std::env::var("COLUMNS").ok()?.parse().ok();
        let terminal = terminal_size::terminal_size_of(std::io::stdout()).map(|(width, _)| width.0.into());
        terminal.or_else(said).unwrap_or(NARROW).clamp(NARROW, WIDE)
    });
    *WIDTH
}

/// A text in lines that fit, the first and the others behind what stands before them, which is of one width.
pub(crate) fn wrapped(text: &str, first: &str, others: &str) -> String {
    let options = Options::new(width()).initial_indent(first).subsequent_indent(others).break_words(false);
    textwrap::fill(text, options) + "\n"
}

/// A text of at most some characters: of a longer one the middle is left out, for both ends tell names apart.
pub(crate) fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    let (head, tail) = ((most - 1) / 2, most - 1 - (most - 1) / 2);
    text.chars().take(head).chain(['\u{2026}']).chain(text.chars().skip(count - tail)).collect()
}

#[cfg(test)]
mod tests {
    use super::shortened;

    #[test]
    fn the_middle_goes() {
        assert_eq!(shortened("liver", 5), "liver");
        assert_eq!(shortened("gluteus_maximus_left", 9), "glut\u{2026}left");
    }
}
