//! The font of a PDF: those of its letters that are used.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Name, Pdf, Rect, Ref, Str};
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::{GlyphMetrics, Metrics};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use std::collections::BTreeMap;
use std::io::Write;
use subsetter::GlyphRemapper;

use super::error::PictureError;

/// As readers name a subset: six letters, a plus sign, the font.
const NAME: Name = Name(b"SURFOM+DejaVuSans");
const IDENTITY: SystemInfo =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
const REFUSED: PictureError = PictureError::Pdf("its font cannot be read");

/// A font and what was used of it.
pub(super) struct PdfFont<'a> {
    data: &'a [u8],
    metrics: Metrics,
    advances: GlyphMetrics<'a>,
    used: GlyphRemapper,
    /// What each code stands for.
    texts: BTreeMap<u16, String>,
}

impl<'a> PdfFont<'a> {
    pub(super) fn new(data: &'a [u8]) -> Result<Self, PictureError> {
        let font = FontRef::new(data).map_err(|_| REFUSED)?;
        let (size, location) = (Size::unscaled(), LocationRef::default());
        Ok(Self {
            data,
            metrics: font.metrics(size, location),
            advances: font.glyph_metrics(size, location),
            used: GlyphRemapper::new(),
            texts: BTreeMap::new(),
        })
    }

    pub(super) fn units_per_em(&self) -> f32 {
        f32::from(self.metrics.units_per_em)
    }

    /// The code of a letter, which is used from now on.
    pub(super) fn code(&mut self, glyph: u16, text: &str) -> u16 {
        let code = self.used.remap(glyph);
        self.texts.entry(code).or_insert_with(|| text.to_owned());
        code
    }

    /// Writes it as objects from `first` on, which is the font itself; the first that is free again.
    pub(super) fn write(&self, pdf: &mut Pdf, first: Ref) -> Result<Ref, PictureError> {
        let [cid, descriptor, file, unicode, free] = [1, 2, 3, 4, 5].map(|n| Ref::new(first.get() + n));
        let per_mille = 1000.0 / self.units_per_em();
        pdf.type0_font(first)
            .base_font(NAME)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(unicode);
        let mut letters = pdf.cid_font(cid);
        letters.subtype(CidFontType::Type2).base_font(NAME).system_info(IDENTITY).font_descriptor(descriptor);
        letters.cid_to_gid_map_predefined(Name(b"Identity"));
        let advance = |glyph: u16| self.advances.advance_width(GlyphId::from(glyph)).unwrap_or_default();
        letters.widths().consecutive(0, self.used.remapped_gids().map(|glyph| per_mille * advance(glyph)));
        drop(letters);
        let Metrics { bounds, ascent, descent, cap_height, .. } = self.metrics;
        let bounds = bounds.unwrap_or_default();
        pdf.font_descriptor(descriptor)
            .name(NAME)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(
                per_mille * bounds.x_min,
                per_mille * bounds.y_min,
                per_mille * bounds.x_max,
                per_mille * bounds.y_max,
            ))
            .italic_angle(0.0)
            .ascent(per_mille * ascent)
            .descent(per_mille * descent)
            .cap_height(per_mille * cap_height.unwrap_or(ascent))
            .stem_v(80.0)
            .font_file2(file);
        let subset = subsetter::subset(self.data, 0, &self.used).map_err(|_| REFUSED)?;
        pdf.stream(file, &compressed(&subset))
            .filter(Filter::FlateDecode)
            .pair(Name(b"Length1"), subset.len() as i32);
        let mut map = UnicodeCmap::new(Name(b"Surfometry-UTF16"), IDENTITY);
        for (code, text) in &self.texts {
            map.pair_with_multiple(*code, text.chars());
        }
        pdf.cmap(unicode, &compressed(&map.finish())).filter(Filter::FlateDecode);
        Ok(free)
    }
}

/// As `FlateDecode` reads it.
pub(super) fn compressed(data: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
    // A vector takes everything.
    let _ = encoder.write_all(data);
    encoder.finish().unwrap_or_default()
}
