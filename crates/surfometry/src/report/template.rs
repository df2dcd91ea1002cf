//! From the context to the page.

use super::page_data::page_json;
use super::viewer::program;
use super::{ComparisonPage, Report};
use crate::pictures::significant;
use crate::text::turns_text;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use minijinja::value::{Serde, Value};
use minijinja::{Environment, Error, ErrorKind, context};
use sha2::{Digest, Sha256};
use std::fmt::Write;

const PAGE: &str = include_str!("report.html");
const COMPARISON: &str = include_str!("comparison.html");
const STYLE: &str = include_str!("page.css");
const VIEWER_STYLE: &str = include_str!("viewer/viewer.css");

/// The page of a report.
///
/// # Errors
/// None that data can cause: the template is tested.
pub fn render(report: &Report) -> Result<String, Error> {
    let data = page_json(report).map_err(|error| {
        Error::new(ErrorKind::BadSerialization, "the report's numbers").with_source(error)
    })?;
    let (script, style) = (program(), format!("{STYLE}{VIEWER_STYLE}"));
    let scenes: Vec<Option<&str>> = report.objects.iter().map(|object| object.scene.as_deref()).collect();
    let page = context! {
        title => &report.title,
        version => report.provenance.version,
        script_hash => hash(&script),
        style_hash => hash(&style),
        scenes => Value::from(Serde(&scenes)),
        script, style, data,
    };
    let page = environment()?.template_from_named_str("report.html", PAGE)?.render(page)?;
    Ok(in_one_direction(page))
}

/// A page in which characters that make names read as others are told by their numbers, in markup, script data and
/// what is downloaded alike.
fn in_one_direction(page: String) -> String {
    if !page.contains(turns_text) {
        return page;
    }
    let mut shown = String::with_capacity(page.len());
    for c in page.chars() {
        if turns_text(c) {
            let _ = write!(shown, "[U+{:04X}]", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    shown
}

/// What a content security policy knows a script or style by.
fn hash(text: &str) -> String {
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// The page of a comparison.
///
/// # Errors
/// None that data can cause: the template is tested.
pub fn render_comparison(page: &ComparisonPage) -> Result<String, Error> {
    let page = context! { page => Value::from(Serde(page)) };
    let page = environment()?.template_from_named_str("comparison.html", COMPARISON)?.render(page)?;
    Ok(in_one_direction(page))
}

fn environment() -> Result<Environment<'static>, Error> {
    let mut environment = Environment::new();
    environment.add_filter("digits", digits);
    environment.add_filter("thousandths", thousandths);
    environment.add_filter("p_value", p_value);
    environment.add_template("page.css", STYLE)?;
    Ok(environment)
}

/// As journals print it: nothing below 0.0001.
fn p_value(value: &Value) -> String {
    let text = |p: f64| if p < 1e-4 { "< 0.0001".to_owned() } else { significant(p, 2) };
    f64::try_from(value.clone()).ok().filter(|p| p.is_finite()).map_or_else(|| "–".to_owned(), text)
}

/// Three decimals, as a number that is to be read as a whole one wants; a dash for null.
fn thousandths(value: &Value) -> String {
    // Adding 0 turns -0 into 0.
    let rounded = |number: f64| (number * 1000.0).round() / 1000.0 + 0.0;
    f64::try_from(value.clone())
        .map_or_else(|_| "–".to_owned(), |number| minus(&format!("{:.3}", rounded(number))))
}

/// A hyphen made a minus.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}

/// Significant digits, six unless told; a dash for null.
fn digits(value: &Value, count: Option<i32>) -> String {
    let Ok(number) = f64::try_from(value.clone()) else { return "–".to_owned() };
    if number == 0.0 {
        return "0".to_owned();
    }
    if !number.is_finite() {
        return "–".to_owned();
    }
    let magnitude = number.abs().log10().floor() as i32;
    let count = count.unwrap_or(6);
    if !(-5..12).contains(&magnitude) {
        return minus(&format!("{number:.*e}", (count - 1) as usize));
    }
    minus(&significant(number, count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Provenance;
    use crate::runs::Failure;

    #[test]
    fn text_is_escaped_and_only_the_program_may_run() {
        let failure = Failure::new("<script>alert(1)</script>\u{202e}.nii", &"<!-- no such file");
        let report = Report {
            title: "a & b <u>".to_owned(),
            objects: Vec::new(),
            failures: vec![failure],
            provenance: Provenance::new("surfometry report '<i>'".to_owned(), Vec::new()),
        };
        let page = render(&report).unwrap();
        assert!(!page.contains("<script>alert") && !page.contains("<u>") && !page.contains("<i>"));
        assert!(page.contains("<title>a &amp; b &lt;u&gt;</title>") && !page.contains("<!-- no"));
        assert!(page.contains("[U+202E].nii") && !page.contains('\u{202e}'));
        // The data and the program; nothing ends them early.
        assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (2, 2));
        let policy = "default-src 'none'; script-src 'sha256-";
        assert!(page.contains(policy) && page.len() < 130_000, "{}", page.len());
        // The policy's hashes are those of the elements' texts as they stand.
        let inside = |tag: &str| {
            let start = page.find(&format!("<{tag}>")).unwrap() + tag.len() + 2;
            &page[start..start + page[start..].find(&format!("</{tag}>")).unwrap()]
        };
        assert!(["script", "style"].iter().all(|tag| page.contains(&hash(inside(tag)))));
    }

    #[test]
    fn numbers_keep_their_digits() {
        let text = |v: f64| digits(&Value::from(v), None);
        assert_eq!(text(184_572.6), "184573");
        assert_eq!(text(0.034_567_89), "0.0345679");
        assert_eq!(text(-2.0), "−2");
        assert_eq!(thousandths(&Value::from(-0.000_2)), "0.000");
        assert_eq!(thousandths(&Value::from(-217.7118)), "−217.712");
        assert_eq!(digits(&Value::from(()), None), "–");
    }
}
