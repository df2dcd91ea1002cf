//! What is done to voxels before anything is measured of them, and what came of it.

use crate::accuracy::{Flag, FlagCode};
use crate::volume::LabelGroup;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::str::FromStr;
use thiserror::Error;

/// What is done to voxels before anything is measured of them: in this order, a step where it is asked for.
///
/// ```
/// use surfometry::inputs::{OpenOptions, Preparation, open};
/// use surfometry::volume::LabelImage;
/// let preparation = Preparation { fill_cavities: true, ..Preparation::default() };
/// let source = open("phantom:shell?radius=10&inner=4", &OpenOptions { preparation, ..OpenOptions::default() })?;
/// let filled = LabelImage::from_slabs(&mut source.slabs()?)?;
/// let ball = open("phantom:ball?radius=10", &OpenOptions::default())?;
/// let ball = LabelImage::from_slabs(&mut ball.slabs()?)?;
/// assert_eq!(filled.mask(1).voxels(), ball.mask(1).voxels());
/// # Ok::<(), surfometry::inputs::InputError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Preparation {
    /// Grey values that are the object, label 1; all others are background.
    pub threshold: Option<Threshold>,
    /// Of each label the largest 26-connected piece is left, of equal ones the one that begins first.
    pub largest_component: bool,
    /// Background that a label encloses, so that no 6-connected way leads out of the image, becomes that label; where several
    /// do, the innermost.
    pub fill_cavities: bool,
}

impl Preparation {
    /// Whether nothing is done.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether more is done than can be while slices go by.
    pub(super) fn needs_all(&self) -> bool {
        self.largest_component || self.fill_cavities
    }
}

/// A range of grey values, both ends inside; an end that is left out has no bound. In words `LOW..HIGH`, `LOW..` or
/// `..HIGH`.
///
/// ```
/// use surfometry::inputs::Threshold;
/// let bone: Threshold = "226..".parse()?;
/// assert!(bone.contains(226.0) && !bone.contains(225.9) && !bone.contains(f64::NAN));
/// # Ok::<(), surfometry::inputs::ThresholdError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Threshold {
    low: Option<f64>,
    high: Option<f64>,
}

/// Why words are no range of grey values.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "`{0}`: write LOW..HIGH, LOW.. or ..HIGH: the grey values that are the object, both ends inside, the lower one first, decimals with a point"
)]
pub struct ThresholdError(String);

impl Threshold {
    /// With ends that voxels of single precision can have: the nearest ones.
    pub(super) fn in_single_precision(self) -> Self {
        let nearest = |end: Option<f64>| end.map(|end| f64::from(end as f32));
        Self { low: nearest(self.low), high: nearest(self.high) }
    }

    /// Whether a value lies in the range; what is not a number lies in none.
    pub fn contains(&self, value: f64) -> bool {
        !value.is_nan()
            && self.low.is_none_or(|low| value >= low)
            && self.high.is_none_or(|high| value <= high)
    }
}

impl FromStr for Threshold {
    type Err = ThresholdError;

    fn from_str(text: &str) -> Result<Self, ThresholdError> {
        let wrong = || ThresholdError(text.to_owned());
        let (low, high) = text.split_once("..").ok_or_else(wrong)?;
        let end = |text: &str| match text.trim() {
            "" => Ok(None),
            text => text.parse().ok().filter(|value: &f64| value.is_finite()).map(Some).ok_or_else(wrong),
        };
        let (low, high) = (end(low)?, end(high)?);
        let bounded = low.is_some() || high.is_some();
        let ascending = low.zip(high).is_none_or(|(low, high)| low <= high);
        if bounded && ascending { Ok(Self { low, high }) } else { Err(wrong()) }
    }
}

/// What the preparation of an image changed, label by label.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Preparations {
    pub(super) asked: Preparation,
    pub(super) changes: BTreeMap<i64, Changes>,
}

/// What was done to an object before it was measured.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PreparedObject {
    /// What was asked.
    #[serde(flatten)]
    pub asked: Preparation,
    /// What it changed.
    #[serde(flatten)]
    pub changes: Changes,
}

/// What filling and leaving out changed of an object; of united labels, in sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Changes {
    /// Pieces beside the largest that were left out.
    pub dropped_pieces: u64,
    /// Their voxels.
    pub dropped_voxels: u64,
    /// Voxels of cavities that were filled.
    pub filled_voxels: u64,
}

impl Preparations {
    /// Of an object; of a field, which has no label, of all.
    pub fn of(&self, label: Option<&LabelGroup>) -> PreparedObject {
        let is_member = |known: i64| label.is_none_or(|group| group.labels().contains(&known));
        let members = self.changes.iter().filter(|(known, _)| is_member(**known));
        let changes = members.fold(Changes::default(), |sum, (_, more)| sum.plus(more));
        PreparedObject { asked: self.asked, changes }
    }

    /// Whether every voxel has the label that the input has.
    pub(super) fn changed_nothing(&self) -> bool {
        self.asked.threshold.is_none() && self.of(None).changes == Changes::default()
    }
}

impl Changes {
    fn plus(self, other: &Self) -> Self {
        Self {
            dropped_pieces: self.dropped_pieces + other.dropped_pieces,
            dropped_voxels: self.dropped_voxels + other.dropped_voxels,
            filled_voxels: self.filled_voxels + other.filled_voxels,
        }
    }
}

impl PreparedObject {
    /// What was changed, in words.
    pub(crate) fn flags(&self) -> impl Iterator<Item = Flag> + use<> {
        let Changes { dropped_pieces, dropped_voxels, filled_voxels } = self.changes;
        let dropped = (dropped_pieces > 0).then(|| {
            let message = format!("{dropped_voxels} voxels in {dropped_pieces} pieces beside the largest were left out, as asked");
            Flag::new(FlagCode::PiecesDropped, message)
        });
        let filled = (filled_voxels > 0).then(|| {
            let message = format!(
                "{filled_voxels} voxels of enclosed cavities were filled, as asked: they count as the object"
            );
            Flag::new(FlagCode::CavitiesFilled, message)
        });
        dropped.into_iter().chain(filled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_in_words() {
        let holds = |text: &str, value: f64| text.parse::<Threshold>().unwrap().contains(value);
        for (text, inside, outside) in [
            ("226..", vec![226.0, 3000.0, f64::INFINITY], vec![225.999, f64::NAN, f64::NEG_INFINITY]),
            ("..-500", vec![-500.0, -1024.0], vec![-499.5, 0.0]),
            ("-1e3..0.5", vec![-1000.0, 0.0, 0.5], vec![0.6, -1001.0]),
            (" 3 .. 3 ", vec![3.0], vec![2.9, 3.1]),
        ] {
            assert!(inside.iter().all(|&value| holds(text, value)), "{text}");
            assert!(!outside.iter().any(|&value| holds(text, value)), "{text}");
        }
        for wrong in ["", "..", "3", "3..1", "a..b", "nan..2", "1..inf", "1:2", "1..2..3"] {
            let error = wrong.parse::<Threshold>().unwrap_err().to_string();
            assert!(error.contains("LOW..HIGH"), "{error}");
        }
    }
}
