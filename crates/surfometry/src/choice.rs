//! Named values that a front end offers: one list, with one name and one sentence each, for options,
//! arguments and records.

use thiserror::Error;

/// One of a few values that have names.
///
/// ```
/// use surfometry::Choice;
/// use surfometry::measurement::EmbeddingKind;
/// let words: Vec<&str> = EmbeddingKind::ALL.iter().map(|kind| kind.word()).collect();
/// assert!(words.contains(&"gaussian") && "gaussian".parse() == Ok(EmbeddingKind::Gaussian));
/// ```
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// What is chosen, as `embedding`.
    const WHAT: &'static str;
    /// All of them, in the order in which they are offered.
    const ALL: &'static [Self];

    /// The name in options, arguments and records.
    fn word(self) -> &'static str;

    /// What it is, for people.
    fn meaning(self) -> &'static str;

    /// The one of a name, in capital or small letters.
    ///
    /// # Errors
    /// [`UnknownChoice`], which lists those that there are.
    fn of_word(text: &str) -> Result<Self, UnknownChoice> {
        let known = || Self::ALL.iter().map(|choice| choice.word()).collect::<Vec<_>>().join(", ");
        let found = Self::ALL.iter().copied().find(|choice| choice.word().eq_ignore_ascii_case(text.trim()));
        found.ok_or_else(|| UnknownChoice { what: Self::WHAT, text: text.to_owned(), known: known() })
    }
}

/// A name that nothing has.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is no {what} {text:?}; take one of {known}")]
pub struct UnknownChoice {
    /// What was to be chosen.
    pub what: &'static str,
    /// The name.
    pub text: String,
    /// Those that there are.
    pub known: String,
}

/// Gives an enum its names: [`Choice`], and by it `FromStr`, `Display`, `Serialize` and `Deserialize`.
macro_rules! choices {
    ($type:ident, $what:literal: { $($variant:ident = $word:literal: $meaning:literal,)+ }) => {
        impl $crate::Choice for $type {
            const WHAT: &'static str = $what;
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }

            fn meaning(self) -> &'static str {
                match self {
                    $(Self::$variant => $meaning,)+
                }
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::UnknownChoice;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                $crate::Choice::of_word(text)
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad($crate::Choice::word(*self))
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str($crate::Choice::word(*self))
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = <std::borrow::Cow<'de, str> as serde::Deserialize>::deserialize(deserializer)?;
                $crate::Choice::of_word(&text).map_err(serde::de::Error::custom)
            }
        }
    };
}
pub(crate) use choices;
