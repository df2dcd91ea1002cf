//! Numbers as people read them.

/// What stands for a number that could not be had.
pub(crate) const MISSING: &str = "-";

/// Six significant digits, without an exponent where a reader can do without; a dash for what is not defined.
pub(crate) fn digits(value: f64) -> String {
    significant(value, 6)
}

/// The same of what may be missing.
pub(crate) fn digits_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| MISSING.to_owned(), digits)
}

/// Significant digits of a number; a dash for what is none.
pub(crate) fn significant(value: f64, count: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    if !is_plain(value) {
        return format!("{value:.*e}", (count - 1) as usize);
    }
    let text = format!("{value:.*}", (count - 1 - magnitude(value)).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A value to the second significant digit of its standard error: further digits are noise. All six where there is no error.
pub(crate) fn to_its_error(value: f64, error: Option<f64>) -> String {
    let Some(error) = error.filter(|e| e.is_finite() && *e > 0.0) else { return digits(value) };
    if !value.is_finite() || !is_plain(error) {
        return digits(value);
    }
    let decimals = 1 - magnitude(error);
    if decimals >= 0 {
        return format!("{value:.*}", decimals as usize);
    }
    let unit = 10f64.powi(-decimals);
    // Adding 0 turns -0 into 0.
    format!("{}", (value / unit).round() * unit + 0.0)
}

/// A value and its standard error, as `184380 \u{b1} 230`.
pub(crate) fn with_error(value: Option<f64>, error: Option<f64>) -> String {
    match (value, error) {
        (None, _) => MISSING.to_owned(),
        (Some(value), None) => digits(value),
        (Some(value), Some(error)) => {
            format!("{} \u{b1} {}", to_its_error(value, Some(error)), to_its_error(error, Some(error)))
        }
    }
}

/// So many of something.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// With its sign before a space.
pub(crate) fn signed(value: f64) -> String {
    format!("{}{}", if value < 0.0 { "- " } else { "+ " }, digits(value.abs()))
}

/// An Euler characteristic by Gauss and Bonnet. It is rounded before it is printed, and 0 is added, so that
/// no -0.000 appears.
pub(crate) fn thousandths(chi: Option<f64>) -> String {
    chi.map_or_else(|| MISSING.to_owned(), |chi| format!("{:.3}", (chi * 1000.0).round() / 1000.0 + 0.0))
}

fn magnitude(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// Whether a reader can do without an exponent.
fn is_plain(value: f64) -> bool {
    value == 0.0 || (-5..15).contains(&magnitude(value))
}

#[cfg(test)]
mod tests {
    use super::{digits, with_error};

    #[test]
    fn six_digits() {
        let cases = [
            (184_541.62, "184542"),
            (2.0, "2"),
            (0.034_567_89, "0.0345679"),
            (-1.5e-7, "-1.50000e-7"),
            (0.0, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(digits(value), text);
        }
    }

    #[test]
    fn digits_end_with_the_errors() {
        let cases = [
            (184_380.4, 234.0, "184380 \u{b1} 230"),
            (836.083, 10.2, "836 \u{b1} 10"),
            (0.034_351_9, 0.000_402, "0.03435 \u{b1} 0.00040"),
            (59_217.42, 0.26, "59217.42 \u{b1} 0.26"),
            (-12.5, 340.0, "-10 \u{b1} 340"),
            (1.5e-7, 2e-9, "1.50000e-7 \u{b1} 2.00000e-9"),
        ];
        for (value, error, text) in cases {
            assert_eq!(with_error(Some(value), Some(error)), text);
        }
        assert_eq!(with_error(None, Some(1.0)), "-");
    }
}
