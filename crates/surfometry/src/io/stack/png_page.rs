//! One slice in a PNG file.

use super::page::{Number, Page, colours, error};
use crate::io::ReadError;
use crate::io::packed::open_file;
use png::{ColorType, Decoder, Limits, Reader, Transformations};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

type Pixels = Reader<BufReader<File>>;

fn reader(path: &Path) -> Result<(Page, Pixels), ReadError> {
    let (file, _) = open_file(path)?;
    let mut decoder = Decoder::new_with_limits(BufReader::new(file), Limits { bytes: 1 << 30 });
    // Pixels as they are stored: of a palette the numbers, which are the labels.
    decoder.set_transformations(Transformations::IDENTITY);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let reader =
        decoder.read_info().map_err(|e| error(format!("{name}: {e}; copy or export the slice again")))?;
    let info = reader.info();
    let kind = match info.color_type {
        ColorType::Grayscale | ColorType::Indexed => None,
        ColorType::GrayscaleAlpha => Some("grey and transparent"),
        ColorType::Rgb | ColorType::Rgba => Some("colour"),
    };
    if let Some(kind) = kind {
        return Err(colours(path, kind));
    }
    let size = [info.width as usize, info.height as usize];
    let page = Page::of(size, info.bit_depth as u8, Number::Unsigned)
        .ok_or_else(|| ReadError::VoxelType(format!("PNG, {} bits", info.bit_depth as u8)))?;
    Ok((page, reader))
}

/// Size and type.
pub(super) fn look_at(path: &Path) -> Result<Page, ReadError> {
    Ok(reader(path)?.0)
}

/// Size, type and pixels as voxels.
pub(super) fn read_page(path: &Path) -> Result<(Page, Vec<u8>), ReadError> {
    let (page, mut reader) = reader(path)?;
    let damaged = |e: &dyn std::fmt::Display| ReadError::damaged(path, &e.to_string());
    let mut stored = vec![0; reader.output_buffer_size().ok_or_else(|| damaged(&"a picture too large"))?];
    reader.next_frame(&mut stored).map_err(|e| damaged(&e))?;
    // To the end, where checksums are.
    reader.finish().map_err(|e| damaged(&e))?;
    if page.bits == 16 {
        // PNG is big-endian.
        stored.as_chunks_mut::<2>().0.iter_mut().for_each(|pair| pair.swap(0, 1));
    }
    Ok((page, page.unpacked(stored)))
}
