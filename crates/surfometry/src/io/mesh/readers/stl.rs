//! STL, text (solids of facets, each between `outer loop` and `endloop`) and binary (80 bytes, the number of
//! triangles, 50 bytes each). Which one a file is cannot be told by its first word: many a binary file begins with
//! `solid`. Several solids, one behind the other, are one mesh.

use super::Outcome;
use super::surface::Surface;
use super::words::{Words, shown};
use std::collections::HashMap;

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    if first_solid(bytes).is_none_or(|solid| solid.end() != bytes.len()) && is_text(bytes) {
        text(bytes)
    } else {
        binary(bytes)
    }
}

/// Whether it begins as a text does and has no zero in its middle, as binary numbers have.
fn is_text(bytes: &[u8]) -> bool {
    let begins = |word| Words::new(bytes).next().is_some_and(|first| first.eq_ignore_ascii_case(word));
    let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    (begins(b"solid") || begins(b"facet")) && !bytes[..end].contains(&0)
}

/// Triangles of which each has corners of its own; those at one place become one vertex.
#[derive(Default)]
struct Loose {
    surface: Surface,
    numbers: HashMap<[u64; 3], u32>,
}

impl Loose {
    fn vertex(&mut self, place: [f64; 3]) -> u32 {
        let vertices = &mut self.surface.vertices;
        // Adding 0 makes -0 the same as 0.
        *self.numbers.entry(place.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
            vertices.push(place);
            vertices.len() as u32 - 1
        })
    }

    fn facet(&mut self, corners: &[[f64; 3]]) {
        let corners: Vec<u32> = corners.iter().map(|&place| self.vertex(place)).collect();
        self.surface.polygon(&corners);
    }
}

fn text(bytes: &[u8]) -> Outcome<Surface> {
    let (mut loose, mut words) = (Loose::default(), Words::new(bytes));
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => loose.surface.comment(words.line())?,
            // The solid's name again, which may be any words.
            b"endsolid" => drop(words.line()),
            b"facet" => loose.facet(&facet(&mut words)?),
            _ => return words.refuse(format_args!("`{}` stands where a facet should begin", shown(word))),
        }
    }
    Ok(loose.surface)
}

/// The corners of a facet, whose normal, which may be anything, is left.
fn facet(words: &mut Words<'_>) -> Outcome<Vec<[f64; 3]>> {
    let mut corners = Vec::with_capacity(3);
    let mut normal = 0..4;
    loop {
        let Some(word) = words.next() else { return words.refuse("the file ends within a facet") };
        match word.to_ascii_lowercase().as_slice() {
            b"outer" | b"loop" | b"endloop" => {}
            b"vertex" => corners.push(words.place()?),
            b"endfacet" if corners.len() > 2 => return Ok(corners),
            b"endfacet" => return words.refuse(format_args!("a facet has {} corners", corners.len())),
            _ if corners.is_empty() && normal.next().is_some() => {}
            _ => return words.refuse(format_args!("`{}` stands within a facet", shown(word))),
        }
    }
}

/// A solid in binary form.
struct Solid<'a> {
    title: &'a [u8],
    triangles: &'a [[u8; TRIANGLE]],
}

impl Solid<'_> {
    /// How many bytes it has.
    fn end(&self) -> usize {
        HEADER + self.triangles.len() * TRIANGLE
    }
}

/// The solid that bytes begin with, if all of it is there.
fn first_solid(bytes: &[u8]) -> Option<Solid<'_>> {
    let (header, rest) = bytes.split_first_chunk::<HEADER>()?;
    let count = claimed(header) as usize;
    let triangles = rest.as_chunks().0.get(..count)?;
    Some(Solid { title: &header[..80], triangles })
}

fn claimed(header: &[u8; HEADER]) -> u32 {
    u32::from_le_bytes([header[80], header[81], header[82], header[83]])
}

fn binary(bytes: &[u8]) -> Outcome<Surface> {
    let mut loose = Loose::default();
    let mut rest = bytes;
    while let Some(solid) = first_solid(rest).filter(|solid| !solid.triangles.is_empty()) {
        loose.take(&solid)?;
        rest = &rest[solid.end()..];
    }
    if rest.len() == bytes.len() {
        loose.take(&by_length(bytes)?)?;
        rest = &[];
    }
    let padding = rest.iter().rev().take_while(|byte| **byte == 0 || byte.is_ascii_whitespace()).count();
    loose.surface.surplus = (rest.len() - padding) as u64;
    Ok(loose.surface)
}

/// A file's only solid where its header does not know how many triangles it has: who writes while triangles come puts 0
/// there, or all ones.
fn by_length(bytes: &[u8]) -> Outcome<Solid<'_>> {
    let Some((header, rest)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(format!(
            "{} bytes, which begin as no text does, are too few for a binary file",
            bytes.len()
        ));
    };
    let (count, (triangles, odd)) = (claimed(header), rest.as_chunks());
    let unknown = (count == 0 || (count == u32::MAX && !triangles.is_empty())) && odd.is_empty();
    if unknown {
        return Ok(Solid { title: &header[..80], triangles });
    }
    let needed = HEADER as u64 + u64::from(count) * TRIANGLE as u64;
    Err(format!(
        "its header counts {count} triangles, which take {needed} bytes, and the file has {}: it was cut off, or is no STL",
        bytes.len()
    ))
}

impl Loose {
    fn take(&mut self, solid: &Solid<'_>) -> Outcome<()> {
        self.surface.comment(solid.title)?;
        for triangle in solid.triangles {
            let corners = triangle[12..48].as_chunks::<4>().0;
            let single = |n: usize| f64::from(f32::from_le_bytes(corners[n]));
            let place = |n: usize| [single(3 * n), single(3 * n + 1), single(3 * n + 2)];
            self.facet(&[place(0), place(1), place(2)]);
        }
        Ok(())
    }
}
