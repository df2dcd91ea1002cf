//! Parts of an SVG document.
//!
//! Written by hand: rectangles, lines, texts and embedded rasters need no document model. Nothing has an id,
//! so that several figures can stand in one HTML page.

use std::fmt::Write;

use super::error::PictureError;
use super::figure::Figure;
use super::raster::Raster;
use crate::text::turns_text;

/// Fonts in order: the one that [`Figure::to_png`] carries, then what resembles it.
pub(crate) const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// Text and axes.
pub(crate) const INK: &str = "#222222";
/// What should step back.
pub(crate) const FAINT: &str = "#666666";
/// Rules and frames of axes.
pub(crate) const RULE: &str = "#bbbbbb";

/// Sizes of text in pixels of 1/96 inch.
pub(crate) const TITLE: f64 = 16.0;
pub(crate) const LABEL: f64 = 13.0;
pub(crate) const SMALL: f64 = 11.5;

/// Mean width of a letter of the font, in units of its size; on the large side.
const LETTER: f64 = 0.6;

/// Where a text's position is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
    /// Its middle, turned to read upward.
    MiddleUpward,
}

/// Elements drawn so far.
#[derive(Debug, Default)]
pub(crate) struct Canvas {
    body: String,
}

impl Canvas {
    /// A line of text, its baseline at the position.
    pub(crate) fn text(&mut self, [x, y]: [f64; 2], size: f64, color: &str, anchor: Anchor, text: &str) {
        let (name, turn) = match anchor {
            Anchor::Start => ("start", String::new()),
            Anchor::Middle => ("middle", String::new()),
            Anchor::End => ("end", String::new()),
            Anchor::MiddleUpward => ("middle", format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"")),
        };
        self.element(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" fill=\"{color}\" text-anchor=\"{name}\"{turn}>{}</text>",
            escaped(text)
        ));
    }

    /// As [`Canvas::text`], the position half-way up its letters.
    pub(crate) fn centered_text(
        &mut self,
        [x, y]: [f64; 2],
        size: f64,
        color: &str,
        anchor: Anchor,
        text: &str,
    ) {
        self.text([x, y + 0.36 * size], size, color, anchor, text);
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], color: &str, width: f64) {
        self.polyline(&[from, to], color, width, "");
    }

    /// A line through points; dashes as SVG has them (`"4 3"`), none if empty.
    pub(crate) fn polyline(&mut self, points: &[[f64; 2]], color: &str, width: f64, dashes: &str) {
        let dashes =
            if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
        self.element(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"{dashes}/>",
            listed(points)
        ));
    }

    /// Separate line segments, as one element.
    pub(crate) fn segments(
        &mut self,
        segments: impl Iterator<Item = [[f64; 2]; 2]>,
        color: &str,
        width: f64,
    ) {
        let mut path = String::new();
        for [[ax, ay], [bx, by]] in segments {
            let _ = write!(path, "M{ax:.2} {ay:.2}L{bx:.2} {by:.2}");
        }
        if !path.is_empty() {
            self.element(format_args!(
                "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
            ));
        }
    }

    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], fill: &str) {
        self.element(format_args!("<polygon points=\"{}\" fill=\"{fill}\"/>", listed(points)));
    }

    /// A filled rectangle: x, y, width, height.
    pub(crate) fn rect(&mut self, [x, y, width, height]: [f64; 4], fill: &str) {
        self.element(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{fill}\"/>"
        ));
    }

    /// The outline of a rectangle.
    pub(crate) fn outline(&mut self, [x, y, width, height]: [f64; 4], color: &str, stroke: f64) {
        self.element(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"none\" \
             stroke=\"{color}\" stroke-width=\"{stroke}\"/>"
        ));
    }

    /// Pixels stretched over a rectangle.
    pub(crate) fn image(
        &mut self,
        [x, y, width, height]: [f64; 4],
        raster: &Raster,
    ) -> Result<(), PictureError> {
        self.element(format_args!(
            "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" \
             preserveAspectRatio=\"none\" href=\"{}\"/>",
            raster.to_data_uri()?
        ));
        Ok(())
    }

    /// The document, on white. Its title is what a screen reader says.
    pub(crate) fn finish(self, size: [f64; 2], title: &str) -> Figure {
        self.finish_at(size, None, title)
    }

    /// The same, printed at a width of its own where one is given.
    pub(crate) fn finish_at(self, size: [f64; 2], printed: Option<f64>, title: &str) -> Figure {
        let [drawn_width, drawn_height] = size.map(libm::ceil);
        let width = printed.unwrap_or(drawn_width);
        let height = drawn_height * (width / drawn_width);
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {drawn_width} {drawn_height}\" font-family=\"{FONTS}\" role=\"img\">\n<title>{}</title>\n\
             <rect width=\"{drawn_width}\" height=\"{drawn_height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escaped(title),
            self.body
        );
        Figure { svg, title: title.to_owned(), width, height }
    }

    fn element(&mut self, element: std::fmt::Arguments) {
        let _ = writeln!(self.body, "{element}");
    }
}

/// Width of a letter in font sizes: most are narrower than [`LETTER`] in any common font, some are wider.
fn letter_width(c: char) -> f64 {
    match c {
        'M' | 'W' | 'm' | 'w' | '@' | '%' | '\u{2014}' => 1.0,
        // Chinese, Japanese and Korean, and pictures.
        '\u{1100}'..='\u{115f}' | '\u{2e80}'..='\u{d7ff}' | '\u{f900}'..='\u{faff}' | '\u{ff00}'.. => 1.05,
        c if c.is_uppercase() => 0.78,
        _ => LETTER,
    }
}

/// Width that a text may take.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    size * text.chars().map(letter_width).sum::<f64>()
}

/// Lines no wider than a width, broken at spaces (but at none that holds words together), and within words where a word is wider (file names).
pub(crate) fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    let fits = |text: &str| text_width(text, size) <= width;
    let mut lines: Vec<String> = Vec::new();
    let breaks = |c: char| c.is_whitespace() && c != '\u{a0}';
    for word in text.split(breaks).filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if fits(&format!("{line} {word}")) => {
                line.push(' ');
                line.push_str(word);
                continue;
            }
            _ => lines.push(String::new()),
        }
        for c in word.chars() {
            match lines.last_mut() {
                Some(line) if line.is_empty() || fits(&format!("{line}{c}")) => line.push(c),
                _ => lines.push(c.to_string()),
            }
        }
    }
    lines
}

fn listed(points: &[[f64; 2]]) -> String {
    points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
}

/// Text as XML's character data, also in attributes; characters that XML 1.0 has no place for are left out, and those that
/// make a name read as another one.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' | '\r' => out.push(' '),
            c if c.is_control() || turns_text(c) || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_within_their_width() {
        let name = "W".repeat(40) + &"mandible_".repeat(9) + &"\u{9aa8}".repeat(30);
        for text in [name.as_str(), "a few words, of which none is longer than a line"] {
            let lines = wrapped(text, TITLE, 300.0);
            assert!(
                lines.len() > 1 && lines.iter().all(|line| text_width(line, TITLE) <= 300.0),
                "{lines:?}"
            );
            assert_eq!(lines.concat().replace(' ', ""), text.replace(' ', ""));
        }
    }
}
