//! Bytes that stand in XML as base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::io::{self, BufRead, BufReader, Read};

/// Bytes of text that are looked at together.
const AT_ONCE: usize = 1 << 16;

/// Bytes of base64, which may have padding where a part of it ends, and white space; it ends where XML goes on.
pub(super) struct Base64Text<R> {
    text: BufReader<R>,
    /// Digits that do not make whole bytes yet.
    begun: Vec<u8>,
    bytes: io::Cursor<Vec<u8>>,
    ended: bool,
}

impl<R: Read> Base64Text<R> {
    pub(super) fn new(text: R) -> Self {
        let text = BufReader::with_capacity(AT_ONCE, text);
        Self { text, begun: Vec::new(), bytes: io::Cursor::default(), ended: false }
    }

    /// Decodes the next digits that are whole.
    fn decode(&mut self) -> io::Result<()> {
        let text = self.text.fill_buf()?;
        let read = text.len();
        let digits = text.iter().copied().take_while(|&b| b != b'<').filter(|b| !b.is_ascii_whitespace());
        self.ended = read == 0 || text.contains(&b'<');
        self.begun.extend(digits);
        self.text.consume(read);
        let whole = if self.ended { self.begun.len() } else { self.begun.len() / 4 * 4 };
        let rest = self.begun.split_off(whole);
        let digits = std::mem::replace(&mut self.begun, rest);
        self.bytes = io::Cursor::new(
            from_base64(&digits)
                .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidData, "text that is no base64"))?,
        );
        Ok(())
    }
}

impl<R: Read> Read for Base64Text<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.bytes.read(buffer)?;
            if read > 0 || buffer.is_empty() || self.ended {
                return Ok(read);
            }
            self.decode()?;
        }
    }
}

/// Bytes of whole digits without white space; padding ends a part, and another may follow.
pub(super) fn from_base64(mut digits: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3);
    while !digits.is_empty() {
        let padding = digits.iter().position(|&b| b == b'=');
        let end = padding.map_or(digits.len(), |at| (at / 4 + 1) * 4).min(digits.len());
        bytes.extend(STANDARD.decode(&digits[..end]).ok()?);
        digits = &digits[end..];
    }
    Some(bytes)
}
