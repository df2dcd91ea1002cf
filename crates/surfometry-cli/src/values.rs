//! Values of options, as typed.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use surfometry::Choice;

/// Parses one of the library's named values, and lists them in help and errors.
pub(crate) fn one_of<T: Choice>() -> impl TypedValueParser<Value = T> {
    let values = T::ALL.iter().map(|choice| PossibleValue::new(choice.word()).help(choice.meaning()));
    PossibleValuesParser::new(values).map(|text| T::of_word(&text).expect("the parser let it pass"))
}

/// Two names with a comma between.
pub(crate) fn two_names(text: &str) -> Result<[String; 2], String> {
    let (method, standard) = text.split_once(',').ok_or("write two names with a comma between them")?;
    Ok([method.to_owned(), standard.to_owned()])
}
