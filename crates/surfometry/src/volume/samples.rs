//! Voxel values as a file stores them.

use std::collections::TryReserveError;

/// A voxel type that a file can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum ScalarType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl ScalarType {
    /// Bytes a voxel.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Name as NumPy writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }
}

/// A run of voxels in their stored type, x fastest.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub enum Samples {
    U8(Vec<u8>),
    I8(Vec<i8>),
    U16(Vec<u16>),
    I16(Vec<i16>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    U64(Vec<u64>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Runs an expression with the typed vector of a [`Samples`], whatever its type.
macro_rules! for_samples {
    ($samples:expr, $values:ident => $body:expr) => {
        match $samples {
            $crate::volume::Samples::U8($values) => $body,
            $crate::volume::Samples::I8($values) => $body,
            $crate::volume::Samples::U16($values) => $body,
            $crate::volume::Samples::I16($values) => $body,
            $crate::volume::Samples::U32($values) => $body,
            $crate::volume::Samples::I32($values) => $body,
            $crate::volume::Samples::U64($values) => $body,
            $crate::volume::Samples::I64($values) => $body,
            $crate::volume::Samples::F32($values) => $body,
            $crate::volume::Samples::F64($values) => $body,
        }
    };
}
pub(crate) use for_samples;

impl Samples {
    /// Number of voxels.
    pub fn len(&self) -> usize {
        for_samples!(self, values => values.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every `count`th value, from the `first` on: one of layers that alternate.
    #[cfg(feature = "io")]
    pub(crate) fn every(&self, count: usize, first: usize) -> Self {
        macro_rules! every {
            ($($kind:ident),*) => {
                match self {
                    $(Self::$kind(values) => Self::$kind(values.iter().skip(first).step_by(count).copied().collect()),)*
                }
            };
        }
        every!(U8, I8, U16, I16, U32, I32, U64, I64, F32, F64)
    }

    /// Every value times `slope` plus `intercept`.
    ///
    /// # Errors
    /// Where memory does not suffice.
    pub fn scaled(&self, slope: f64, intercept: f64) -> Result<Self, TryReserveError> {
        let scaled =
            for_samples!(self, values => collected(values.iter().map(|v| v.to_f64() * slope + intercept)))?;
        Ok(Self::F64(scaled))
    }
}

/// All values of an iterator, or that memory does not suffice: an image's slice may be larger than a machine.
pub(crate) fn collected<T>(values: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>, TryReserveError> {
    let mut all = Vec::new();
    all.try_reserve_exact(values.len())?;
    all.extend(values);
    Ok(all)
}

/// How far from a whole number a float may be and still be a label: scale factors stored in f32 leave 1e-5.
const WHOLE_TOLERANCE: f64 = 1e-4;

/// The first f64 beyond the range of i64.
const TWO_TO_63: f64 = 9_223_372_036_854_775_808.0;

/// A voxel value that can be a label or a field value.
pub trait Scalar: Copy + PartialEq + Send + Sync {
    /// The value, rounded to f64 where 64-bit integers need it.
    fn to_f64(self) -> f64;

    /// The value as a label: `None` where it is not whole or does not fit.
    fn to_label(self) -> Option<i64>;
}

macro_rules! integer_scalar {
    ($($type:ty),*) => { $(
        impl Scalar for $type {
            fn to_f64(self) -> f64 {
                self as f64
            }
            fn to_label(self) -> Option<i64> {
                i64::try_from(self).ok()
            }
        }
    )* };
}
#[allow(clippy::cast_lossless)]
mod integers {
    use super::Scalar;
    integer_scalar!(u8, i8, u16, i16, u32, i32, u64, i64);
}

macro_rules! float_scalar {
    ($($type:ty),*) => { $(
        impl Scalar for $type {
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn to_label(self) -> Option<i64> {
                let value = f64::from(self);
                let whole = value.round();
                // Comparisons with NaN are false.
                ((value - whole).abs() <= WHOLE_TOLERANCE && whole.abs() < TWO_TO_63)
                    .then_some(whole as i64)
            }
        }
    )* };
}
float_scalar!(f32, f64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_whole_and_fit() {
        assert_eq!(255.000_01_f64.to_label(), Some(255));
        assert_eq!(0.5_f32.to_label(), None);
        assert_eq!(f64::NAN.to_label(), None);
        assert_eq!(f64::INFINITY.to_label(), None);
        assert_eq!(u64::MAX.to_label(), None);
        assert_eq!((-3_i8).to_label(), Some(-3));
    }
}
