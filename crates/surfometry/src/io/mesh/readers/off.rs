//! OFF, Geomview's object file format: counts, places, faces, a line each. COFF, NOFF and STOFF have colours, normals
//! and texture behind the places.

use super::Outcome;
use super::surface::{Surface, corner};
use super::words::{Words, lines, shown};

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let mut surface = Surface::default();
    lines(bytes).try_for_each(|line| surface.comment(line.rest()))?;
    let mut rows =
        lines(bytes).map(|line| without_comment(&line)).filter(|line| line.clone().next().is_some());
    let mut counts = row(rows.next(), "counts")?;
    // The word in front may be missing, or have a line of its own.
    if counts.clone().number().is_err() {
        check_kind(counts.next().unwrap_or_default())?;
        if counts.clone().next().is_none() {
            counts = row(rows.next(), "counts")?;
        }
        if counts.clone().next() == Some(b"BINARY") {
            return Err("binary OFF is not read: choose the text form".to_owned());
        }
    }
    let (vertices, faces) = (whole(&mut counts)?, whole(&mut counts)?);
    for _ in 0..vertices {
        surface.vertices.push(row(rows.next(), "places")?.place()?);
    }
    for _ in 0..faces {
        let mut line = row(rows.next(), "faces")?;
        let count = whole(&mut line)?;
        let number = |_| line.number().and_then(corner);
        let corners: Vec<u32> = (0..count).map(number).collect::<Outcome<_>>()?;
        surface.polygon(&corners);
    }
    match rows.next() {
        None => Ok(surface),
        Some(line) => line.refuse(format_args!("`{}` stands behind the last face", shown(line.rest()))),
    }
}

fn without_comment<'a>(line: &Words<'a>) -> Words<'a> {
    let text = line.rest();
    let end = text.iter().position(|&byte| byte == b'#').unwrap_or(text.len());
    line.with(&text[..end])
}

/// Refuses the kinds whose lines have other numbers in front.
fn check_kind(word: &[u8]) -> Outcome<()> {
    match word {
        b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" | b"STOFF" | b"STCOFF" | b"STNOFF" | b"STCNOFF" => Ok(()),
        _ if word.ends_with(b"OFF") => {
            Err(format!("{} has places of other than three coordinates", shown(word)))
        }
        _ => Err(format!("it begins with `{}`, not with OFF", shown(word))),
    }
}

fn whole(words: &mut Words<'_>) -> Outcome<usize> {
    let number = words.number()?;
    let possible = number >= 0.0 && number.fract() == 0.0;
    if possible { Ok(number as usize) } else { words.refuse(format_args!("{number} is no count")) }
}

fn row<'a>(line: Option<Words<'a>>, what: &str) -> Outcome<Words<'a>> {
    line.ok_or_else(|| format!("the file ends before all the {what} that should be there"))
}
