//! TIFF stacks: a slice a page, or ImageJ's slices behind one page.
//!
//! # References
//! TIFF 6.0 and BigTIFF as the crate `tiff` has them; ImageJ's and OME's descriptions
//! (<https://docs.openmicroscopy.org/ome-model>). World axes are not told: those of the pages are taken, rows
//! growing along y, pages along z.

use super::description::Description;
use super::description::side_file;
use super::page::{Number, Page, colours, error};
use crate::io::assembled::{AssembleVoxels, Assembled, Pieces};
use crate::io::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use crate::io::packed::{Packed, open_file};
use crate::io::timed_file::Timed;
use crate::io::{Format, ReadError};
use crate::volume::Affine;
use encoding_rs::WINDOWS_1252;
use flate2::bufread::ZlibDecoder;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use tiff::decoder::{Decoder, DecodingResult, Limits, ifd::Value};
use tiff::tags::{ByteOrder as StoredOrder, CompressionMethod, PhotometricInterpretation, Tag, Type};
use tiff::{ColorType, TiffError};

/// Bytes of a page, and of one tag, so that damage costs no memory.
const LARGEST_PAGE: usize = 1 << 32;
const LARGEST_TAG: usize = 1 << 26;

type Pages = Decoder<BufReader<Timed>>;

/// Reads the header of a .tif file.
pub(in crate::io) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let packed = Packed::open(path)?;
    if packed.is_packed() {
        return Err(error(
            "compressed as a whole, but its pages are in no order: unpack it with `gunzip` or `bunzip2` first",
        ));
    }
    let mut decoder = decoder(path, &Arc::default())?;
    let page = page_of(path, &mut decoder)?;
    let described = described(&mut decoder)?.or_beside(path)?;
    let start = first_pixel(path, &mut decoder)?;
    let pages = described.in_order(pages(path, &mut decoder)?)?;
    let slices = described.slices.unwrap_or(pages.len());
    let dimensions = three_dimensions(&[page.width, page.height, slices])?;
    let data = match (start, pages.len()) {
        (Some(start), 1) if described.contiguous && slices > 1 && page.bits >= 8 => {
            Voxels::Stored(packed.data(start, Encoding::Raw, order(&decoder))?)
        }
        (_, found) if found != slices => {
            return Err(error(format!(
                "the description says {slices} slices, the file has {found} pages; save the whole stack as one file again"
            )));
        }
        _ => {
            let path = path.to_owned();
            Voxels::Assembled(Assembled(Arc::new(TiffVoxels { path, page, pages })))
        }
    };
    Ok(ImageHeader {
        affine: described.spacing.map(Affine::diagonal),
        stated_spacing: described.spacing,
        unknown_unit: described.unknown_unit,
        ..ImageHeader::new(path, Format::Tiff, dimensions, page.scalar, data)
    })
}

/// The first page of a file that is one slice, and its pixels as voxels.
pub(super) fn read_page(path: &Path) -> Result<(Page, Vec<u8>), ReadError> {
    let mut decoder = decoder(path, &Arc::default())?;
    let page = page_of(path, &mut decoder)?;
    let pixels = pixels(path, &mut decoder, page)?;
    Ok((page, pixels))
}

/// Size and type of a file that is one slice.
pub(super) fn look_at(path: &Path) -> Result<Page, ReadError> {
    let mut decoder = decoder(path, &Arc::default())?;
    if decoder.more_images() {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        return Err(error(format!(
            "{name} holds several pages, where the files of a folder are a slice each: name the file itself"
        )));
    }
    page_of(path, &mut decoder)
}

fn decoder(path: &Path, spent: &Arc<AtomicU64>) -> Result<Pages, ReadError> {
    let (file, bytes) = open_file(path)?;
    let mut limits = Limits::default();
    // A tag is no longer than its file; a page is looked at before it is decoded.
    limits.ifd_value_size = LARGEST_TAG.min(bytes as usize);
    limits.decoding_buffer_size = LARGEST_PAGE;
    limits.intermediate_buffer_size = LARGEST_PAGE;
    let decoder = Decoder::new(BufReader::new(Timed::new(file, spent))).map_err(|e| unreadable(&e))?;
    Ok(decoder.with_limits(limits))
}

fn unreadable(e: &TiffError) -> ReadError {
    error(format!(
        "{e}; copy the file again, or save it as plain TIFF of grey values (in Fiji: File > Save As > Tiff)"
    ))
}

fn order(decoder: &Pages) -> ByteOrder {
    if decoder.byte_order() == StoredOrder::BigEndian { ByteOrder::Big } else { ByteOrder::Little }
}

/// A number that a tag of the page has, which stands for another one where it has none.
fn number(decoder: &mut Pages, tag: Tag, absent: u16) -> Result<u16, ReadError> {
    Ok(decoder.find_tag_unsigned(tag).map_err(|e| unreadable(&e))?.unwrap_or(absent))
}

/// Size and type of the page that the decoder is at.
fn page_of(path: &Path, decoder: &mut Pages) -> Result<Page, ReadError> {
    let compression = number(decoder, Tag::Compression, 1)?;
    if !is_read(compression) {
        return Err(error(format!(
            "compression {compression} is not read; save the stack without, or with LZW, deflate, PackBits or Zstandard"
        )));
    }
    if number(decoder, Tag::FillOrder, 1)? == 2 {
        return Err(error(
            "bits that stand the other way round in their bytes (FillOrder 2), which is not read; `tiffcp -f msb2lsb IN OUT` turns them",
        ));
    }
    let photometric =
        decoder.find_tag_unsigned::<u16>(Tag::PhotometricInterpretation).map_err(|e| unreadable(&e))?;
    if photometric == Some(PhotometricInterpretation::RGBPalette.to_u16()) {
        return Err(colours(path, "palette"));
    }
    let (width, height) = decoder.dimensions().map_err(|e| unreadable(&e))?;
    let bits = match decoder.colortype().map_err(|e| unreadable(&e))? {
        ColorType::Gray(bits) => bits,
        ColorType::Multiband { .. } | ColorType::GrayA(_) => {
            return Err(colours(path, "several values in its"));
        }
        _ => return Err(colours(path, "colour")),
    };
    let format = decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(|e| unreadable(&e))?;
    let number = match format.and_then(|list| list.first().copied()).unwrap_or(1) {
        2 => Number::Signed,
        3 => Number::Float,
        _ => Number::Unsigned,
    };
    let page = Page::of([width as usize, height as usize], bits, number)
        .ok_or_else(|| ReadError::VoxelType(format!("TIFF, {bits} bits, {number:?}")))?;
    if is_turned_for_good(decoder, page)? && !is_plain(decoder)? {
        return Err(error(
            "compressed floats, or numbers with a sign, of which 0 is shown as white (WhiteIsZero), are not read; save the stack without \
             compression, or with 0 as black",
        ));
    }
    Ok(page)
}

/// Whether what is shown as white is 0 of numbers that the decoder does not hand on as they are stored, nor so that they
/// can be turned back: floats it takes from 1, which rounds, those with a sign it refuses.
fn is_turned_for_good(decoder: &mut Pages, page: Page) -> Result<bool, ReadError> {
    Ok(!page.is_unsigned() && is_white_zero(decoder)?)
}

fn is_white_zero(decoder: &mut Pages) -> Result<bool, ReadError> {
    let black = PhotometricInterpretation::BlackIsZero.to_u16();
    let meaning = number(decoder, Tag::PhotometricInterpretation, black)?;
    Ok(meaning == PhotometricInterpretation::WhiteIsZero.to_u16())
}

/// Whether pixels stand in the file as they are, row by row.
fn is_plain(decoder: &mut Pages) -> Result<bool, ReadError> {
    let plain = number(decoder, Tag::Compression, 1)? == 1 && number(decoder, Tag::Predictor, 1)? == 1;
    Ok(plain && decoder.find_tag(Tag::TileOffsets).map_err(|e| unreadable(&e))?.is_none())
}

fn is_read(compression: u16) -> bool {
    let read = [
        CompressionMethod::None,
        CompressionMethod::LZW,
        CompressionMethod::Deflate,
        CompressionMethod::OldDeflate,
        CompressionMethod::PackBits,
        CompressionMethod::ZSTD,
    ];
    read.iter().any(|method| method.to_u16() == compression)
}

/// What the first page's text says.
fn described(decoder: &mut Pages) -> Result<Description, ReadError> {
    let resolution = [Tag::XResolution, Tag::YResolution].map(|tag| {
        let value = decoder.find_tag(tag).ok().flatten()?;
        let Value::Rational(pixels, units) = value else { return None };
        (pixels > 0 && units > 0).then(|| f64::from(pixels) / f64::from(units))
    });
    Description::of(&description(decoder).unwrap_or_default(), resolution)
}

/// The first page's text, up to a zero. It is UTF-8, or else Latin-1, as old versions of ImageJ write `µm`.
fn description(decoder: &mut Pages) -> Option<String> {
    let mut tags = decoder.image_ifd();
    let entry = tags.find_entry(Tag::ImageDescription).filter(|entry| entry.field_type() == Type::ASCII)?;
    let size = usize::try_from(entry.count()).ok().filter(|size| *size <= LARGEST_TAG)?;
    let mut bytes = vec![0; size];
    tags.find_tag_bytes(Tag::ImageDescription, &mut bytes, 0).ok()??;
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(size);
    bytes.truncate(end);
    Some(String::from_utf8(bytes).unwrap_or_else(|e| WINDOWS_1252.decode(e.as_bytes()).0.into_owned()))
}

/// Where the first page's pixels begin, where they are not compressed.
fn first_pixel(path: &Path, decoder: &mut Pages) -> Result<Option<u64>, ReadError> {
    if decoder.find_tag_unsigned::<u16>(Tag::Compression).ok().flatten().unwrap_or(1) != 1 {
        return Ok(None);
    }
    let offsets = decoder.find_tag_unsigned_vec::<u64>(Tag::StripOffsets);
    Ok(offsets.map_err(|e| ReadError::damaged(path, &e))?.and_then(|offsets| offsets.first().copied()))
}

/// The numbers of the pages that are slices: not those that show one again, smaller.
fn pages(path: &Path, decoder: &mut Pages) -> Result<Vec<usize>, ReadError> {
    const REDUCED: u32 = 1;
    let mut pages = Vec::new();
    for number in 0.. {
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).ok().flatten().unwrap_or(0);
        if kind & REDUCED == 0 {
            pages.push(number);
        }
        if !decoder.more_images() {
            break;
        }
        decoder.next_image().map_err(|e| ReadError::damaged(path, &e))?;
    }
    Ok(pages)
}

/// A page's voxels, little-endian.
fn pixels(path: &Path, decoder: &mut Pages, page: Page) -> Result<Vec<u8>, ReadError> {
    let damaged = |e: TiffError| ReadError::damaged(path, &e);
    check_stored(path, decoder, page)?;
    if is_turned_for_good(decoder, page)? {
        let voxels = order(decoder).to_little(strips(path, decoder, page)?, page.scalar.bytes());
        return whole(path, page, voxels);
    }
    let mut stored = match decoder.read_image().map_err(damaged)? {
        DecodingResult::U8(v) => v,
        DecodingResult::I8(v) => v.into_iter().map(i8::cast_unsigned).collect(),
        DecodingResult::U16(v) => v.into_iter().flat_map(u16::to_le_bytes).collect(),
        DecodingResult::I16(v) => v.into_iter().flat_map(i16::to_le_bytes).collect(),
        DecodingResult::U32(v) => v.into_iter().flat_map(u32::to_le_bytes).collect(),
        DecodingResult::I32(v) => v.into_iter().flat_map(i32::to_le_bytes).collect(),
        DecodingResult::U64(v) => v.into_iter().flat_map(u64::to_le_bytes).collect(),
        DecodingResult::I64(v) => v.into_iter().flat_map(i64::to_le_bytes).collect(),
        DecodingResult::F32(v) => v.into_iter().flat_map(f32::to_le_bytes).collect(),
        DecodingResult::F64(v) => v.into_iter().flat_map(f64::to_le_bytes).collect(),
        DecodingResult::F16(_) => return Err(ReadError::VoxelType("TIFF, 16 bits, Float".into())),
    };
    // Labels are the numbers that are stored, whichever of them is shown as white; the decoder turns them round.
    if is_white_zero(decoder)? {
        stored = stored.into_iter().map(|byte| !byte).collect();
    }
    whole(path, page, page.unpacked(stored))
}

/// All voxels of a page.
fn whole(path: &Path, page: Page, voxels: Vec<u8>) -> Result<Vec<u8>, ReadError> {
    if voxels.len() == page.bytes() {
        Ok(voxels)
    } else {
        Err(ReadError::damaged(path, &"a page without all its pixels"))
    }
}

/// The bytes of a page that is not compressed, as they are stored.
fn strips(path: &Path, decoder: &mut Pages, page: Page) -> Result<Vec<u8>, ReadError> {
    let [offsets, sizes] = [Tag::StripOffsets, Tag::StripByteCounts].map(|tag| {
        let list = decoder.find_tag_unsigned_vec::<u64>(tag);
        list.map(Option::unwrap_or_default).map_err(|e| ReadError::damaged(path, &e))
    });
    let (file, mut stored) = (decoder.inner(), Vec::new());
    for (offset, size) in offsets?.into_iter().zip(sizes?) {
        let left = (page.bytes() - stored.len()) as u64;
        file.seek(SeekFrom::Start(offset)).map_err(|e| ReadError::io(path, e))?;
        file.take(size.min(left)).read_to_end(&mut stored).map_err(|e| ReadError::io(path, e))?;
    }
    Ok(stored)
}

/// Whether what is stored of a page can be its pixels, and, of deflated ones, has their checksums: the decoder stops
/// in front of them.
fn check_stored(path: &Path, decoder: &mut Pages, page: Page) -> Result<(), ReadError> {
    /// More than any of the methods makes of a byte.
    const MOST_A_BYTE: u64 = 1 << 16;
    let damaged = |e: TiffError| ReadError::damaged(path, &e);
    let mut list = |tags: [Tag; 2]| -> Result<Vec<u64>, ReadError> {
        let [strips, tiles] = tags.map(|tag| decoder.find_tag_unsigned_vec::<u64>(tag));
        Ok(strips.map_err(damaged)?.or(tiles.map_err(damaged)?).unwrap_or_default())
    };
    let sizes = list([Tag::StripByteCounts, Tag::TileByteCounts])?;
    let offsets = list([Tag::StripOffsets, Tag::TileOffsets])?;
    let compression = decoder.find_tag_unsigned::<u16>(Tag::Compression).map_err(damaged)?.unwrap_or(1);
    let file = decoder.inner();
    let end = file.seek(SeekFrom::End(0)).map_err(|e| ReadError::io(path, e))?;
    let stored: u64 = sizes.iter().fold(0, |sum, &size| sum.saturating_add(size.min(end)));
    if (page.width * page.height) as u64 > stored.saturating_mul(MOST_A_BYTE) || sizes.len() != offsets.len()
    {
        return Err(ReadError::damaged(
            path,
            &format!("{stored} bytes cannot be a page of {} x {} pixels", page.width, page.height),
        ));
    }
    let deflated = [CompressionMethod::Deflate, CompressionMethod::OldDeflate];
    if deflated.iter().any(|method| method.to_u16() == compression) {
        for (&offset, &size) in offsets.iter().zip(&sizes) {
            file.seek(SeekFrom::Start(offset)).map_err(|e| ReadError::io(path, e))?;
            let mut chunk = ZlibDecoder::new(file.take(size));
            io::copy(&mut chunk, &mut io::sink()).map_err(|e| ReadError::damaged(path, &e))?;
        }
    }
    Ok(())
}

/// Where the voxels of a stack of pages are.
#[derive(Debug)]
struct TiffVoxels {
    path: PathBuf,
    /// What every page is like.
    page: Page,
    pages: Vec<usize>,
}

impl AssembleVoxels for TiffVoxels {
    fn files(&self) -> Vec<PathBuf> {
        let side = side_file(&self.path);
        [self.path.clone()].into_iter().chain(side.is_file().then_some(side)).collect()
    }

    fn open(&self, spent: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let mut decoder = decoder(&self.path, spent)?;
        let (path, first, mut pages) = (self.path.clone(), self.page, self.pages.clone().into_iter());
        Ok(Box::new(Pieces::new(move || {
            let Some(number) = pages.next() else { return Ok(None) };
            decoder.seek_to_image(number).map_err(|e| ReadError::damaged(&path, &e))?;
            let page = page_of(&path, &mut decoder)?;
            page.expect_same(&first, &format!("page {}", number + 1))?;
            pixels(&path, &mut decoder, page).map(Some)
        })))
    }
}
