//! Wavefront OBJ: places and faces, a line each.

use super::Outcome;
use super::surface::{Surface, corner};
use super::words::{Words, lines, number, shown};

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let mut surface = Surface::default();
    let (mut known, mut before) = (false, Vec::new());
    for line in lines(bytes) {
        // A line that ends in `\` goes on in the next one.
        if let Some(start) = line.rest().strip_suffix(b"\\") {
            before.extend_from_slice(start);
            before.push(b' ');
        } else if before.is_empty() {
            known |= read_line(line, &mut surface)?;
        } else {
            before.extend_from_slice(line.rest());
            known |= read_line(line.with(&before), &mut surface)?;
            before.clear();
        }
    }
    if known { Ok(surface) } else { Err("no line begins as one of a Wavefront file does".to_owned()) }
}

/// Reads a line; whether it is one of the format's.
fn read_line(mut words: Words<'_>, surface: &mut Surface) -> Outcome<bool> {
    let line = words.rest();
    let is_said = |word: &&[u8]| !word.starts_with(b"#");
    match words.next() {
        Some(b"v") => surface.vertices.push(words.place()?),
        Some(b"f" | b"fo") => {
            let count = surface.vertices.len();
            let corner = |word| corner_of(word, count).or_else(|error| words.refuse(error));
            let corners: Vec<u32> = words.clone().take_while(is_said).map(corner).collect::<Outcome<_>>()?;
            surface.polygon(&corners);
        }
        Some(b"mtllib") => {
            let names = words.take_while(is_said);
            surface.beside.extend(names.map(|name| String::from_utf8_lossy(name).into_owned()));
        }
        Some(word @ (b"curv" | b"curv2" | b"surf" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res")) => {
            let word = shown(word);
            return words.refuse(format_args!(
                "free-form surfaces (`{word}`) are not read: turn them into triangles"
            ));
        }
        Some(word) if word.starts_with(b"#") => surface.comment(line)?,
        Some(b"vn" | b"vt" | b"vp" | b"g" | b"o" | b"s" | b"usemtl" | b"l" | b"p") => {}
        _ => return Ok(false),
    }
    Ok(true)
}

/// The vertex of a corner, `7`, `7/1` or `7//3`, counted from 1, or backwards from the last one so far: -1.
fn corner_of(word: &[u8], count: usize) -> Outcome<u32> {
    let first = word.split(|&byte| byte == b'/').next().unwrap_or_default();
    let Some(stated) = number(first) else { return Err(format!("`{}` is no corner", shown(word))) };
    if stated == 0.0 {
        return Err("a face names vertex 0; they are counted from 1".to_owned());
    }
    corner(if stated < 0.0 { count as f64 + stated } else { stated - 1.0 })
}
