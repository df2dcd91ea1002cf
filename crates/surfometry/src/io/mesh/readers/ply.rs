//! PLY (Turk, "The PLY Polygon File Format", 1994): a header that says which elements follow and what each has.

use super::super::super::header::ByteOrder;
use super::Outcome;
use super::numbers::number;
use super::surface::{Surface, corner};
use super::words::{Words, shown};
use crate::volume::ScalarType;

const AXES: [&[u8]; 3] = [b"x", b"y", b"z"];
const CORNERS: [&[u8]; 2] = [b"vertex_indices", b"vertex_index"];

/// A kind of elements.
struct Element<'a> {
    name: &'a [u8],
    count: usize,
    properties: Vec<Property<'a>>,
}

struct Property<'a> {
    name: &'a [u8],
    /// Of a list: the type of its length.
    length: Option<ScalarType>,
    scalar: ScalarType,
}

/// How the elements are stored.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Binary(ByteOrder),
}

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let (mut surface, mut words) = (Surface::default(), Words::new(bytes));
    let (form, elements) = header(&mut words, &mut surface)?;
    let mut payload = Payload { form, words };
    for element in &elements {
        match element.name {
            b"vertex" => vertices(element, &mut payload, &mut surface)?,
            b"face" => faces(element, &mut payload, |corners| surface.polygon(corners))?,
            b"tristrips" => faces(element, &mut payload, |corners| {
                corners.split(|&corner| corner == RESTART).for_each(|strip| surface.strip(strip));
            })?,
            _ if element.count > 0 && element.carries_faces() => return Err(element.unread()),
            _ => payload.elements(element, |_| Ok(()))?,
        }
    }
    // What is left of a text are words that nobody asked for, white space apart.
    let behind = payload.words.rest();
    let padding = behind.iter().take_while(|byte| **byte == 0 || byte.is_ascii_whitespace()).count();
    surface.surplus = (behind.len() - padding) as u64;
    Ok(surface)
}

/// What ends a strip among strips: -1 in the file.
const RESTART: u32 = u32::MAX;

fn header<'a>(words: &mut Words<'a>, surface: &mut Surface) -> Outcome<(Form, Vec<Element<'a>>)> {
    if words.line().trim_ascii() != b"ply" {
        return Err("it does not begin with `ply`".to_owned());
    }
    let (mut form, mut elements) = (None, Vec::<Element<'a>>::new());
    loop {
        if words.rest().is_empty() {
            return words.refuse("the file ends within the header");
        }
        let line = words.line();
        let mut parts = Words::new(line);
        match parts.next() {
            Some(b"format") => form = Some(form_of(parts.next().unwrap_or_default())?),
            Some(b"comment" | b"obj_info") => note(parts.rest(), surface)?,
            Some(b"element") => elements.push(element(&mut parts, line)?),
            Some(b"property") => {
                let Some(last) = elements.last_mut() else { return words.refuse("a property of no element") };
                last.properties.push(property(&mut parts).ok_or_else(|| unknown(line))?);
            }
            Some(b"end_header") => return Ok((form.ok_or("its header names no format")?, elements)),
            None => {}
            Some(_) => return Err(unknown(line)),
        }
    }
}

/// A comment may name the axes, or a picture that is laid over the faces.
fn note(text: &[u8], surface: &mut Surface) -> Outcome<()> {
    if let Some(name) = text.trim_ascii().strip_prefix(b"TextureFile ") {
        surface.beside.push(String::from_utf8_lossy(name.trim_ascii()).into_owned());
    }
    surface.comment(text)
}

fn unknown(line: &[u8]) -> String {
    format!("its header has a line `{}`, which says nothing known", shown(line))
}

fn form_of(word: &[u8]) -> Outcome<Form> {
    match word {
        b"ascii" => Ok(Form::Text),
        b"binary_little_endian" => Ok(Form::Binary(ByteOrder::Little)),
        b"binary_big_endian" => Ok(Form::Binary(ByteOrder::Big)),
        _ => Err(format!("format `{}` is not known", shown(word))),
    }
}

fn element<'a>(parts: &mut Words<'a>, line: &[u8]) -> Outcome<Element<'a>> {
    let name = parts.next();
    let count = parts.next().and_then(|word| str::from_utf8(word).ok()?.parse().ok());
    match (name, count) {
        (Some(name), Some(count)) => Ok(Element { name, count, properties: Vec::new() }),
        _ => Err(unknown(line)),
    }
}

fn property<'a>(parts: &mut Words<'a>) -> Option<Property<'a>> {
    let first = parts.next()?;
    let (length, first) = match first {
        b"list" => (Some(scalar(parts.next()?)?), parts.next()?),
        _ => (None, first),
    };
    Some(Property { length, scalar: scalar(first)?, name: parts.next()? })
}

fn scalar(name: &[u8]) -> Option<ScalarType> {
    Some(match name {
        b"char" | b"int8" => ScalarType::I8,
        b"uchar" | b"uint8" => ScalarType::U8,
        b"short" | b"int16" => ScalarType::I16,
        b"ushort" | b"uint16" => ScalarType::U16,
        b"int" | b"int32" => ScalarType::I32,
        b"uint" | b"uint32" => ScalarType::U32,
        b"int64" => ScalarType::I64,
        b"uint64" => ScalarType::U64,
        b"float" | b"float32" => ScalarType::F32,
        b"double" | b"float64" => ScalarType::F64,
        _ => return None,
    })
}

impl Element<'_> {
    fn place_of(&self, name: &[u8]) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name)
    }

    /// Bytes that one takes at least: of a list, those of its length; of a text, a digit each and what ends it, which
    /// the last line may lack.
    fn least_bytes(&self, form: Form) -> u64 {
        let stored = |property: &Property<'_>| property.length.unwrap_or(property.scalar).bytes() as u64;
        match form {
            Form::Text => (2 * self.properties.len() as u64).saturating_sub(1).max(1),
            Form::Binary(_) => self.properties.iter().map(stored).sum(),
        }
    }

    /// Whether its name or its properties say that it is made of vertices, as faces are: then it may not be left out.
    fn carries_faces(&self) -> bool {
        let name = String::from_utf8_lossy(self.name).to_ascii_lowercase();
        let shapes = ["face", "tri", "quad", "poly", "strip", "fan", "tet", "hex", "cell", "grid"];
        let is_face = shapes.iter().any(|shape| name.contains(shape)) && !name.contains("texture");
        is_face || CORNERS.iter().any(|name| self.place_of(name).is_some())
    }

    fn unread(&self) -> String {
        let (name, count) = (shown(self.name), self.count);
        format!(
            "its {count} elements `{name}` are not read, only `face` and `tristrips`: turn them into triangles"
        )
    }
}

/// What follows the header.
struct Payload<'a> {
    form: Form,
    words: Words<'a>,
}

/// An element's numbers: one of a scalar property, and of a list all.
type Values = [Vec<f64>];

impl Payload<'_> {
    /// Hands on all elements of a kind, one after the other.
    fn elements(&mut self, kind: &Element<'_>, mut found: impl FnMut(&Values) -> Outcome<()>) -> Outcome<()> {
        let (least, left) = (kind.least_bytes(self.form), self.words.rest().len());
        if least.saturating_mul(kind.count as u64) > left as u64 + 1 {
            let (name, count) = (shown(kind.name), kind.count);
            return Err(format!(
                "the header claims {count} elements `{name}` of {least} bytes or more, and {left} bytes are left"
            ));
        }
        let mut values = vec![Vec::new(); kind.properties.len()];
        // Elements without properties take no room.
        let count = if kind.properties.is_empty() { 0 } else { kind.count };
        for number in 0..count {
            self.element(kind, &mut values)
                .and_then(|()| found(&values))
                .map_err(|error| format!("{} {number}, counted from 0: {error}", shown(kind.name)))?;
        }
        Ok(())
    }

    fn element(&mut self, kind: &Element<'_>, values: &mut Values) -> Outcome<()> {
        for (property, values) in kind.properties.iter().zip(values) {
            values.clear();
            let count = match property.length {
                Some(length) => self.length(length)?,
                None => 1,
            };
            for _ in 0..count {
                values.push(self.number(property.scalar)?);
            }
        }
        Ok(())
    }

    fn length(&mut self, scalar: ScalarType) -> Outcome<usize> {
        let length = self.number(scalar)?;
        let possible = length >= 0.0 && length.fract() == 0.0 && length <= self.words.rest().len() as f64;
        if possible { Ok(length as usize) } else { Err(format!("a list cannot have {length} entries")) }
    }

    fn number(&mut self, scalar: ScalarType) -> Outcome<f64> {
        match self.form {
            Form::Text => self.words.number(),
            Form::Binary(order) => {
                let bytes = self.words.bytes(scalar.bytes()).ok_or("the file ends within it")?;
                Ok(number(scalar, order, bytes))
            }
        }
    }
}

fn vertices(kind: &Element<'_>, payload: &mut Payload<'_>, surface: &mut Surface) -> Outcome<()> {
    if !surface.vertices.is_empty() {
        return Err("it has several elements `vertex`".to_owned());
    }
    let [Some(x), Some(y), Some(z)] = AXES.map(|axis| kind.place_of(axis)) else {
        return Err("a vertex has no x, y and z".to_owned());
    };
    payload.elements(kind, |values| {
        let coordinate = |at: usize| values[at].first().copied().unwrap_or(f64::NAN);
        surface.vertices.push([x, y, z].map(coordinate));
        Ok(())
    })
}

fn faces(kind: &Element<'_>, payload: &mut Payload<'_>, mut found: impl FnMut(&[u32])) -> Outcome<()> {
    let Some(at) = CORNERS.iter().find_map(|name| kind.place_of(name)) else {
        return Err(format!("a {} has no vertex_indices", shown(kind.name)));
    };
    let mut corners = Vec::new();
    let strips = kind.name == b"tristrips";
    payload.elements(kind, |values| {
        corners.clear();
        for &number in &values[at] {
            corners.push(if strips && number == -1.0 { RESTART } else { corner(number)? });
        }
        found(&corners);
        Ok(())
    })
}
