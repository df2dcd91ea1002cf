//! Round numbers for axes.

/// Where an axis is marked, and how many decimals that takes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) values: Vec<f64>,
    decimals: usize,
}

impl Ticks {
    /// Multiples of a round step within limits: near `count` of them, and on the limits themselves where that
    /// can be had.
    pub(crate) fn new([low, high]: [f64; 2], count: usize) -> Self {
        let span = high - low;
        if !(span.is_finite() && span > 0.0) {
            return Self { values: vec![low], decimals: 3 };
        }
        let decade = libm::floor(libm::log10(span / count.max(1) as f64)) as i32;
        let steps = (decade..=decade + 1)
            .flat_map(|e| [1.0, 2.0, 2.5, 5.0].map(|m| round_decimal(m * libm::pow(10.0, f64::from(e)))));
        let cost = |step: f64| {
            let on_limits = [low, high].iter().all(|v| is_multiple(*v, step));
            (span / step - count as f64).abs() + if on_limits { 0.0 } else { 2.0 }
        };
        let step = steps.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(span);
        let (first, last) = (libm::ceil(low / step - 1e-9) as i64, libm::floor(high / step + 1e-9) as i64);
        Self { values: (first..=last).map(|i| i as f64 * step).collect(), decimals: decimals_of(step) }
    }

    /// 1, 2 and 5 times powers of ten within positive limits; where these are fewer than three, equal steps.
    pub(crate) fn on_log([low, high]: [f64; 2]) -> Self {
        let (first, last) = (libm::floor(libm::log10(low)) as i32, libm::ceil(libm::log10(high)) as i32);
        let decades = (first..=last).map(|e| libm::pow(10.0, f64::from(e)));
        let values = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|m| round_decimal(m * decade)));
        let within = |v: &f64| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(v);
        let values: Vec<f64> = values.filter(within).collect();
        if values.len() < 3 {
            return Self::new([low, high], 5);
        }
        Self { values, decimals: usize::try_from(-first).unwrap_or(0) }
    }

    /// Text of a value on this axis.
    pub(crate) fn label(&self, value: f64) -> String {
        let largest = self.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        if value != 0.0 && (self.decimals > 4 || largest >= 1e6) {
            return scientific(value);
        }
        signed(&format!("{:.*}", self.decimals, if value == 0.0 { 0.0 } else { value }))
    }
}

/// With three significant digits, trailing zeros dropped.
pub(crate) fn short(value: f64) -> String {
    if !value.is_finite() {
        return "undefined".to_owned();
    }
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return scientific(value);
    }
    signed(&significant(value, 3))
}

/// With so many significant digits, trailing zeros dropped, and no exponent.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = digits - 1 - libm::floor(libm::log10(value.abs())) as i32;
    let text = format!("{value:.*}", decimals.max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is not below a positive value.
pub(crate) fn round_up(value: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(value)));
    let mantissa = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
        .into_iter()
        .find(|m| value <= m * decade * (1.0 + 1e-9));
    round_decimal(mantissa.unwrap_or(10.0) * decade)
}

/// The largest of 1, 2, 5 times a power of ten that does not exceed a positive value.
pub(crate) fn round_down(value: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(value)));
    let mantissa = [5.0, 2.0].into_iter().find(|m| m * decade <= value * (1.0 + 1e-9));
    round_decimal(mantissa.unwrap_or(1.0) * decade)
}

/// The double nearest to the decimal number that was meant.
fn round_decimal(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

fn is_multiple(value: f64, step: f64) -> bool {
    let count = value / step;
    (count - libm::round(count)).abs() < 1e-6
}

fn decimals_of(step: f64) -> usize {
    let in_units = |decimals: i32| step * libm::pow(10.0, f64::from(decimals));
    (0..12).find(|&d| in_units(d) > 0.5 && is_multiple(in_units(d), 1.0)).unwrap_or(12) as usize
}

/// A true minus sign, as wide as a plus.
fn signed(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    format!("{}\u{b7}10{}", signed(mantissa), superscript(exponent))
}

/// Digits and minus raised, as characters.
fn superscript(text: &str) -> String {
    let raised = |c: char| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        '0' | '4'..='9' => char::from_u32(0x2070 + (c as u32 - '0' as u32)).unwrap_or(c),
        other => other,
    };
    text.chars().map(raised).collect()
}

/// `1/mm^2` as it is printed: mm⁻². Other text is left as it is.
pub(crate) fn typeset_unit(unit: &str) -> String {
    let (base, negative) = unit.strip_prefix("1/").map_or((unit, false), |rest| (rest, true));
    let (base, power) = base.split_once('^').unwrap_or((base, ""));
    let is_plain = base.chars().all(char::is_alphabetic) && power.chars().all(|c| c.is_ascii_digit());
    match (is_plain, negative, power) {
        (false, ..) => unit.to_owned(),
        (true, true, "") => format!("{base}{}", superscript("-1")),
        (true, true, _) => format!("{base}{}", superscript(&format!("-{power}"))),
        (true, false, _) => format!("{base}{}", superscript(power)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_meet_the_limits() {
        for limit in [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 0.15, 3e-4, 8e5] {
            let ticks = Ticks::new([-limit, limit], 5);
            assert!((4..=9).contains(&ticks.values.len()), "{limit} {ticks:?}");
            assert!((ticks.values[0] + limit).abs() < 1e-9 * limit, "{limit} {ticks:?}");
            assert!(ticks.values.contains(&0.0));
        }
        let ticks = Ticks::new([0.0, 0.15], 4);
        assert_eq!(
            ticks.values.iter().map(|v| ticks.label(*v)).collect::<Vec<_>>(),
            ["0.00", "0.05", "0.10", "0.15"]
        );
        assert_eq!(Ticks::new([1.0, 1.0], 5).values, [1.0]);
    }

    #[test]
    fn an_axis_of_ratios_is_marked_also_within_a_decade() {
        assert_eq!(Ticks::on_log([0.1, 10.0]).values, [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]);
        assert!(Ticks::on_log([1.1, 1.9]).values.len() >= 4);
    }

    #[test]
    fn numbers_as_printed() {
        assert_eq!(Ticks::new([-1.0, 1.0], 4).label(-0.5), "\u{2212}0.5");
        assert_eq!(Ticks::new([0.0, 2e-5], 4).label(1e-5), "1·10⁻⁵");
        // A step of less than a millionth is no multiple of 1.
        assert_eq!(Ticks::new([-1e-9, 1e-9], 4).label(5e-10), "5·10⁻¹⁰");
        assert_eq!(
            [short(0.051_23), short(1234.5), short(-2.0), short(0.0)],
            ["0.0512", "1234", "\u{2212}2", "0"]
        );
        assert_eq!(short(f64::NAN), "undefined");
        assert_eq!([round_up(0.11), round_up(0.8), round_up(9.1)], [0.15, 0.8, 10.0]);
        assert_eq!([round_down(23.0), round_down(0.6), round_down(1.0)], [20.0, 0.5, 1.0]);
        assert_eq!(["1/mm", "1/mm^2", "mm^3", "", "%"].map(typeset_unit), ["mm⁻¹", "mm⁻²", "mm³", "", "%"]);
    }
}
