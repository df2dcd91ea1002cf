//! A figure as PDF.
//!
//! The crates that turn SVG into PDF (`svg2pdf`, `krilla-svg`) each bring another version of `usvg` than `resvg`
//! has here. What a figure is made of is little: plain paths, text in one font, images that are PNG already,
//! whose compressed rows a PDF takes as they are.

use pdf_writer::types::{LineCapStyle, Predictor};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use resvg::tiny_skia::{PathSegment, Transform};
use resvg::usvg::{Color, Group, Image, ImageKind, LineCap, Node, Paint, Path, Text, Tree};

use super::error::PictureError;
use super::pdf_font::{PdfFont, compressed};

/// Points a CSS pixel.
const POINTS: f32 = 0.75;
const FONT: Name = Name(b"F");

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const INFO: Ref = Ref::new(5);
/// The font's objects, then the images'.
const FIRST_FREE: i32 = 6;

/// A page of the figure's size.
struct Sheet<'a> {
    content: Content,
    font: PdfFont<'a>,
    /// Files of its images.
    images: Vec<&'a [u8]>,
}

/// A PDF of one page.
pub(super) fn to_pdf(tree: &Tree, font: &[u8], title: &str) -> Result<Vec<u8>, PictureError> {
    let size = tree.size();
    let mut sheet = Sheet { content: Content::new(), font: PdfFont::new(font)?, images: Vec::new() };
    // Rows of a PDF count upward.
    sheet.content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, POINTS * size.height()]);
    sheet.group(tree.root());

    let mut pdf = Pdf::new();
    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    pdf.document_info(INFO).title(TextStr(title)).creator(TextStr(super::object_pictures::PROGRAM));
    let after_font = sheet.font.write(&mut pdf, Ref::new(FIRST_FREE))?;
    let ids: Vec<Ref> = (0..).map(|n| Ref::new(after_font.get() + n)).take(sheet.images.len()).collect();
    let mut page = pdf.page(PAGE);
    page.parent(PAGES).contents(CONTENT);
    page.media_box(Rect::new(0.0, 0.0, POINTS * size.width(), POINTS * size.height()));
    let mut resources = page.resources();
    resources.fonts().pair(FONT, Ref::new(FIRST_FREE));
    let mut images = resources.x_objects();
    for (number, id) in ids.iter().enumerate() {
        images.pair(Name(image_name(number).as_bytes()), *id);
    }
    images.finish();
    resources.finish();
    page.finish();
    for (file, id) in sheet.images.iter().zip(ids) {
        write_image(&mut pdf, id, file)?;
    }
    let content = compressed(&sheet.content.finish());
    pdf.stream(CONTENT, &content).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

fn image_name(number: usize) -> String {
    format!("I{number}")
}

impl<'a> Sheet<'a> {
    fn group(&mut self, group: &'a Group) {
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group),
                Node::Path(path) => self.path(path),
                Node::Image(image) => self.image(image),
                Node::Text(text) => self.text(text),
            }
        }
    }

    fn path(&mut self, path: &Path) {
        self.content.save_state().transform(numbers(path.abs_transform()));
        let fill = path.fill().and_then(|fill| color(fill.paint()));
        let stroke = path.stroke().and_then(|stroke| Some((stroke, color(stroke.paint())?)));
        if let Some([r, g, b]) = fill {
            self.content.set_fill_rgb(r, g, b);
        }
        if let Some((stroke, [r, g, b])) = stroke {
            self.content.set_stroke_rgb(r, g, b).set_line_width(stroke.width().get());
            if stroke.linecap() == LineCap::Round {
                self.content.set_line_cap(LineCapStyle::RoundCap);
            }
            if let Some(dashes) = stroke.dasharray() {
                self.content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
            }
        }
        self.outline(path);
        match (fill, stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
        self.content.restore_state();
    }

    fn outline(&mut self, path: &Path) {
        let content = &mut self.content;
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(p) => content.move_to(p.x, p.y),
                // No figure has such curves other than letters, which are text.
                PathSegment::LineTo(p) | PathSegment::QuadTo(_, p) => content.line_to(p.x, p.y),
                PathSegment::CubicTo(a, b, p) => content.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y),
                PathSegment::Close => content.close_path(),
            };
        }
    }

    fn image(&mut self, image: &'a Image) {
        let ImageKind::PNG(file) = image.kind() else { return };
        let name = image_name(self.images.len());
        self.images.push(file);
        let size = image.size();
        // An image fills the unit square, its first row at the top.
        let place = image.abs_transform().pre_concat(Transform::from_row(
            size.width(),
            0.0,
            0.0,
            -size.height(),
            0.0,
            size.height(),
        ));
        self.content.save_state().transform(numbers(place));
        self.content.x_object(Name(name.as_bytes())).restore_state();
    }

    fn text(&mut self, text: &Text) {
        for span in text.layouted() {
            let Some([r, g, b]) = span.fill.as_ref().and_then(|fill| color(fill.paint())) else { continue };
            self.content.save_state().transform(numbers(text.abs_transform()));
            self.content.set_fill_rgb(r, g, b).begin_text().set_font(FONT, 1.0);
            let em = self.font.units_per_em();
            for glyph in &span.positioned_glyphs {
                let code = self.font.code(glyph.id.0 as u16, &glyph.text);
                let place = glyph.outline_transform().pre_concat(Transform::from_scale(em, em));
                self.content.set_text_matrix(numbers(place)).show(Str(&code.to_be_bytes()));
            }
            self.content.end_text().restore_state();
        }
    }
}

fn numbers(t: Transform) -> [f32; 6] {
    [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty]
}

/// A plain colour; figures have no others.
fn color(paint: &Paint) -> Option<[f32; 3]> {
    match paint {
        Paint::Color(Color { red, green, blue }) => Some([*red, *green, *blue].map(|c| f32::from(c) / 255.0)),
        _ => None,
    }
}

/// A PNG file of opaque pixels, whose rows are those of a PDF.
fn write_image(pdf: &mut Pdf, id: Ref, file: &[u8]) -> Result<(), PictureError> {
    let unlike = || PictureError::Pdf("an image in it is not of opaque pixels");
    let reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().map_err(|_| unlike())?;
    let info = reader.info();
    if info.color_type != png::ColorType::Rgb || info.bit_depth != png::BitDepth::Eight || info.interlaced {
        return Err(unlike());
    }
    let rows: Vec<u8> =
        chunks(file).filter(|(name, _)| name == b"IDAT").flat_map(|(_, data)| data).copied().collect();
    let [width, height] = [info.width, info.height].map(|n| n as i32);
    let mut image = pdf.image_xobject(id, &rows);
    image.width(width).height(height).bits_per_component(8).color_space().device_rgb();
    image.filter(Filter::FlateDecode);
    image.decode_parms().predictor(Predictor::PngOptimum).colors(3).columns(width);
    Ok(())
}

/// Names and data of a PNG file's chunks.
fn chunks(file: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = file.get(8..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (length, after) = rest.split_first_chunk()?;
        let (name, after) = after.split_first_chunk()?;
        let (data, after) = after.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        rest = after.get(4..)?;
        Some((*name, data))
    })
}
