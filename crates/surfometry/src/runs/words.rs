//! Choices as they are written, in a command or in a call: one vocabulary for all front ends.

use crate::measurement::{CurvatureScale, Padding};
use crate::volume::Spacing;
use thiserror::Error;

/// A word that does not say what was asked for.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct WordError(pub(super) String);

impl WordError {
    pub(super) fn new(text: &str) -> Self {
        Self(text.to_owned())
    }
}

/// Any number.
///
/// # Errors
/// [`WordError`].
pub fn number(text: &str) -> Result<f64, WordError> {
    text.trim()
        .parse()
        .map_err(|_| WordError(format!("`{text}` is not a number, such as 1.5, without a unit")))
}

/// A length, a radius: positive and finite.
///
/// # Errors
/// [`WordError`].
pub fn positive(text: &str) -> Result<f64, WordError> {
    let value = number(text)?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(WordError::new("it must be positive and finite"))
    }
}

/// A level: between 0 and 1.
///
/// # Errors
/// [`WordError`].
pub fn fraction(text: &str) -> Result<f64, WordError> {
    let value = number(text)?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err(WordError::new("it must lie between 0 and 1")) }
}

/// A scale of local curvature: mm, `auto`, `local` or `object`.
///
/// # Errors
/// [`WordError`].
pub fn curvature_scale(text: &str) -> Result<CurvatureScale, WordError> {
    match text {
        "auto" => Ok(CurvatureScale::Auto),
        "local" => Ok(CurvatureScale::Local),
        "object" => Ok(CurvatureScale::Object),
        _ => positive(text).map(CurvatureScale::Mm),
    }
}

/// What lies beyond a given field: a number in its units, or `auto`.
///
/// # Errors
/// [`WordError`].
pub fn padding(text: &str) -> Result<Padding, WordError> {
    if text == "auto" { Ok(Padding::Highest) } else { positive(text).map(Padding::Constant) }
}

/// Three spacings in mm, fastest axis first: `0.5,0.5,2`.
///
/// # Errors
/// [`WordError`].
pub fn spacing(text: &str) -> Result<Spacing, WordError> {
    let parts = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let mm: [f64; 3] = parts
        .try_into()
        .map_err(|_| WordError::new("write three numbers, X,Y,Z in mm, fastest axis first"))?;
    Spacing::new(mm).map_err(|error| WordError(error.to_string()))
}
