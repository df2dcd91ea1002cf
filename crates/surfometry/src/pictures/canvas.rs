//! Parts of an SVG document.
//!
//! Written by hand: rectangles, lines, texts and embedded rasters need no document model. Nothing has an id,
//! so that several figures can stand in one HTML page.

use std::fmt::Write;

use super::error::PictureError;
use super::figure::Figure;
use super::raster::Raster;

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

/// Width that a text may take.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    LETTER * size * text.chars().count() as f64
}

/// Lines no wider than a width, broken at spaces (but at none that holds words together), and within words where a word is wider (file names).
pub(crate) fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    let letters = ((width / (LETTER * size)) as usize).max(1);
    let mut lines: Vec<String> = Vec::new();
    let breaks = |c: char| c.is_whitespace() && c != '\u{a0}';
    for word in text.split(breaks).filter(|word| !word.is_empty()) {
        let characters: Vec<char> = word.chars().collect();
        for piece in characters.chunks(letters) {
            match lines.last_mut() {
                Some(line) if line.chars().count() + 1 + piece.len() <= letters => {
                    line.push(' ');
                    line.extend(piece);
                }
                _ => lines.push(piece.iter().collect()),
            }
        }
    }
    lines
}

fn listed(points: &[[f64; 2]]) -> String {
    points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
}

/// Text as XML's character data, also in attributes; characters that XML 1.0 has no place for are left out.
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
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}
