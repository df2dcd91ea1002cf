//! Characters of names and other texts of files.

/// Whether a character turns the direction of the text around it, so that a name could read as another one: the marks,
/// embeddings, overrides and isolates of Unicode's bidirectional algorithm (UAX #9). Letters written from right to left
/// do so without them.
pub fn turns_text(c: char) -> bool {
    matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
