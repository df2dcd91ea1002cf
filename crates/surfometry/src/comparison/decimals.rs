//! Whether `1.234` is one or a thousand: what the other numbers of a table say of its decimal sign.

use super::TableError;
use super::variants::AT;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// A cell of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// The line in it, from 1.
    pub line: u64,
    /// The column.
    pub column: String,
    /// What stands there.
    pub text: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, line, column, text } = self;
        write!(f, "{}: line {line} has `{text}` in column `{column}`", path.display())
    }
}

/// The signs in a column's numbers, each with the first cell that has it.
#[derive(Debug, Clone, PartialEq, Default)]
struct ColumnSigns {
    comma: Option<Place>,
    point: Option<Place>,
    /// A cell with signs between thousands.
    grouped: Option<Place>,
    /// A cell shows that the sign, whichever it is, is no sign between thousands.
    settled: bool,
    /// A cell is no number at all.
    text: bool,
}

/// The signs in the numbers of files with one separator.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Decimals(BTreeMap<String, ColumnSigns>);

impl Decimals {
    /// Takes a cell of a column that holds no names.
    pub(super) fn see(&mut self, path: &Path, line: u64, column: &str, text: &str) {
        let signs = match self.0.get_mut(column) {
            Some(signs) => signs,
            None => self.0.entry(column.to_owned()).or_default(),
        };
        let Some(shape) = Shape::of(text) else {
            signs.text = true;
            return;
        };
        let place =
            || Place { path: path.to_owned(), line, column: column.to_owned(), text: text.to_owned() };
        let first = |found: &mut Option<Place>, is_one: bool| {
            if is_one && found.is_none() {
                *found = Some(place());
            }
        };
        first(&mut signs.comma, shape.last == Some(','));
        first(&mut signs.point, shape.last == Some('.'));
        first(&mut signs.grouped, shape.grouped);
        signs.settled |= shape.settled;
    }

    /// Refuses a column whose numbers cannot be told from others a thousand times as large.
    ///
    /// # Errors
    /// [`TableError::MixedDecimals`], [`TableError::Thousands`].
    pub(super) fn check(&self, column: &str) -> Result<(), TableError> {
        let Some(signs) = self.signs(column) else { return Ok(()) };
        if let Some(place) = &signs.grouped {
            return Err(TableError::Thousands { place: place.clone() });
        }
        let [mut comma, mut point] = [signs.comma.as_ref(), signs.point.as_ref()];
        if !signs.settled && comma.is_some() != point.is_some() {
            comma = comma.or_else(|| self.sure(|others| others.comma.as_ref()));
            point = point.or_else(|| self.sure(|others| others.point.as_ref()));
        }
        match (comma, point) {
            (Some(comma), Some(point)) => {
                let [comma, point] = [comma, point].map(|place| Box::new(place.clone()));
                Err(TableError::MixedDecimals { comma, point })
            }
            _ => Ok(()),
        }
    }

    /// A cell of a column whose numbers may all be meant a thousand times as large, and nothing tells.
    pub(super) fn doubt<'a>(&'a self, column: &str) -> Option<&'a Place> {
        let signs = self.signs(column).filter(|signs| !signs.settled)?;
        let alone =
            |place: &'a Option<Place>, sure: Option<&Place>| place.as_ref().filter(|_| sure.is_none());
        let comma = alone(&signs.comma, self.sure(|others| others.comma.as_ref()));
        comma.or_else(|| alone(&signs.point, self.sure(|others| others.point.as_ref())))
    }

    /// The signs of a column, or of the one of which it has a method's values.
    fn signs(&self, column: &str) -> Option<&ColumnSigns> {
        self.0.get(column).or_else(|| self.0.get(column.rsplit_once(AT)?.0))
    }

    /// A cell of another column of numbers whose sign is certain.
    fn sure<'a>(&'a self, sign: impl Fn(&'a ColumnSigns) -> Option<&'a Place>) -> Option<&'a Place> {
        self.0.values().filter(|signs| signs.settled && !signs.text).find_map(sign)
    }
}

/// The signs in a number.
struct Shape {
    last: Option<char>,
    grouped: bool,
    settled: bool,
}

impl Shape {
    /// `None` of what is no number of any country, as words and dates are.
    fn of(text: &str) -> Option<Self> {
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        exponent.parse::<i32>().ok()?;
        let scientific = mantissa != text;
        let unsigned = mantissa.strip_prefix(['+', '-']).unwrap_or(mantissa);
        let parts: Vec<&str> = unsigned.split([',', '.']).collect();
        let signs: Vec<char> = unsigned.chars().filter(|c| !c.is_ascii_digit()).collect();
        let is_number = signs.iter().all(|sign| [',', '.'].contains(sign)) && parts.concat() != "";
        let last = signs.last().copied();
        let thousands = !parts[0].is_empty() && parts[0].len() <= 3 && !parts[0].starts_with('0');
        let middle = parts.iter().skip(1).take(signs.len().saturating_sub(1));
        let same = |signs: &[char]| signs.windows(2).all(|pair| pair[0] == pair[1]);
        let three = |part: &str| part.len() == 3;
        match signs.len() {
            _ if !is_number => None,
            0 => Some(Self { last, grouped: false, settled: parts[0].len() > 3 }),
            1 => Some(Self { last, grouped: false, settled: scientific || !(thousands && three(parts[1])) }),
            n => {
                let grouped = thousands
                    && middle.copied().all(three)
                    && same(&signs[..n - 1])
                    && (signs[n - 2] != signs[n - 1] || three(parts[n]));
                grouped.then_some(Self { last, grouped, settled: true })
            }
        }
    }
}
