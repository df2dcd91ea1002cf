//! Words of a text, whatever its encoding and its line ends.

use super::Outcome;

/// The words of a text, separated by white space.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        // UTF-8's byte order mark says nothing.
        Self { rest: text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text), line: 1 }
    }

    /// What was not taken yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Words of another text that stands in the same line.
    pub(super) fn with<'b>(&self, text: &'b [u8]) -> Words<'b> {
        Words { rest: text, line: self.line }
    }

    /// Takes what is left of the line, without its end.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let end =
            self.rest.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(self.rest.len());
        let line = self.take(end);
        self.take(match self.rest {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        });
        self.line += 1;
        line
    }

    /// Takes so many bytes, if they are there.
    pub(super) fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        (count <= self.rest.len()).then(|| self.take(count))
    }

    /// Takes a number.
    pub(super) fn number(&mut self) -> Outcome<f64> {
        let line = self.line;
        let word =
            self.next().ok_or_else(|| format!("the file ends in line {line}, where a number should be"))?;
        number(word).ok_or_else(|| format!("line {}: `{}` is no number", self.line, shown(word)))
    }

    /// Takes a place.
    pub(super) fn place(&mut self) -> Outcome<[f64; 3]> {
        Ok([self.number()?, self.number()?, self.number()?])
    }

    /// Takes a count: of so many things there is a byte each at least, or the text cannot hold them.
    pub(super) fn how_many(&mut self, what: &str) -> Outcome<usize> {
        let number = self.number()?;
        if number < 0.0 || number.fract() != 0.0 || number > self.rest.len() as f64 {
            let bytes = self.rest.len();
            return Err(format!("it claims {number} {what}, which {bytes} bytes cannot hold"));
        }
        Ok(number as usize)
    }

    /// An error that says where it is.
    pub(super) fn refuse<T>(&self, reason: impl std::fmt::Display) -> Outcome<T> {
        Err(format!("line {}: {reason}", self.line))
    }

    fn skip_space(&mut self) {
        let space = self.rest.iter().position(|&byte| !is_space(byte)).unwrap_or(self.rest.len());
        let skipped = self.take(space);
        let line_end = |pair: &&[u8]| pair[0] == b'\n' || (pair[0] == b'\r' && pair.get(1) != Some(&b'\n'));
        let ends = (0..skipped.len()).map(|at| &skipped[at..]).filter(line_end).count();
        self.line += ends;
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        taken
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    /// Takes the next word; at the end, where there is none but padding, `None`.
    fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let end = self.rest.iter().position(|&byte| is_space(byte)).unwrap_or(self.rest.len());
        let word = self.take(end);
        (!word.is_empty()).then_some(word)
    }
}

/// White space, and what programs put behind the end of a text.
fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || matches!(byte, 0 | 0x0b | 0x1a)
}

/// A number as programs write it: also what is none, which C libraries write as `nan` or, on Windows, `1.#QNAN`.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| text.contains(".#").then_some(f64::NAN))
}

/// The start of a word, for messages.
pub(super) fn shown(word: &[u8]) -> String {
    String::from_utf8_lossy(&word[..word.len().min(24)]).into_owned()
}

/// The lines of a text, whatever ends them, each as words that know its number.
pub(super) fn lines(text: &[u8]) -> impl Iterator<Item = Words<'_>> {
    let mut words = Words::new(text);
    std::iter::from_fn(move || {
        let line = words.line;
        (!words.rest.is_empty()).then(|| Words { rest: words.line(), line })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_lines() {
        let mut words = Words::new(b"\xef\xbb\xbfsolid caf\xe9 x\r\n 1e-3\r2 nan 1.#QNAN\n x \0\x1a");
        assert_eq!(words.next(), Some(&b"solid"[..]));
        assert_eq!(words.line(), b" caf\xe9 x");
        assert_eq!((words.number(), words.number()), (Ok(1e-3), Ok(2.0)));
        assert!(words.number().unwrap().is_nan() && words.number().unwrap().is_nan());
        assert_eq!(words.number().unwrap_err(), "line 4: `x` is no number");
        assert_eq!(words.next(), None);
    }

    #[test]
    fn counts_that_a_text_cannot_hold() {
        assert_eq!(Words::new(b"2 1 2").how_many("points"), Ok(2));
        for bad in ["-1 0", "2e9 1 2", "0.5 1", "nan 1"] {
            assert!(Words::new(bad.as_bytes()).how_many("points").is_err());
        }
    }
}
