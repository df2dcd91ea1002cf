//! A comparison as text.

use super::{Layout, counted, digits};
use std::collections::BTreeMap;
use surfometry::comparison::{Comparison, EulerAgreement, RowsTold};
use surfometry::statistics::{Agreement, ConfusionMatrix, Estimate, RareClasses};

pub(crate) fn comparison_text(comparison: &Comparison) -> String {
    let Comparison { method, standard, matched, .. } = comparison;
    let mut parts = vec![format!("{method} against {standard}: {}\n", counted(*matched, "object"))];
    let tables = [(method, &comparison.method_rows), (standard, &comparison.standard_rows)];
    parts.extend(tables.map(|(name, rows)| told_text(name, rows, *matched)));
    parts.extend(comparison.doubts.iter().map(|doubt| format!("  {doubt}\n")));
    for measure in &comparison.measures {
        parts.push(format!("\n{}", column(&measure.column, &measure.standard_column)));
        if measure.left_out > 0 {
            parts.push(format!(" ({} without a value)", counted(measure.left_out, "object")));
        }
        parts.push("\n".to_owned());
        parts.extend(
            measure.agreement.as_ref().map(|agreement| agreement_text(agreement, [method, standard])),
        );
        parts.extend(measure.problem.as_ref().map(|problem| format!("  {problem}\n")));
    }
    parts.extend(comparison.euler.iter().map(euler_text));
    parts.push(
        "\nbias: method minus standard; in brackets: 95 % intervals; proportional bias: slope of the differences on the means of both.\n".to_owned(),
    );
    parts.concat()
}

/// What a table says of the rows of the objects that are compared; nothing where it says nothing.
fn told_text(name: &str, rows: &RowsTold, objects: usize) -> String {
    let list = |counts: &BTreeMap<String, usize>| {
        counts.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ")
    };
    let surfaces = match rows.surfaces.len() {
        0 => None,
        1 => rows.surfaces.keys().next().map(|surface| format!("the {surface} surface")),
        _ => Some(format!("surfaces: {}", list(&rows.surfaces))),
    };
    let flags = rows.flagged.map(|flagged| {
        let which = if flagged == 0 { String::new() } else { format!(" ({})", list(&rows.flags)) };
        format!("{flagged} of {objects} carry flags{which}")
    });
    let failed = (rows.failed > 0).then(|| format!("{} rows more are of inputs that failed", rows.failed));
    let told: Vec<String> = surfaces.into_iter().chain(flags).chain(failed).collect();
    if told.is_empty() { String::new() } else { format!("  {name}: {}\n", told.join("; ")) }
}

fn column(method: &str, standard: &str) -> String {
    if method == standard { method.to_owned() } else { format!("{method} : {standard}") }
}

fn agreement_text(a: &Agreement, [method, standard]: [&String; 2]) -> String {
    let spread =
        |s: surfometry::statistics::Spread| format!("{} \u{b1} {}", digits(s.mean), digits(s.deviation));
    let b = &a.bland_altman;
    let rows = [
        (method.as_str(), spread(a.method)),
        (standard.as_str(), spread(a.standard)),
        ("slope", estimate(&a.regression.slope)),
        ("intercept", estimate(&a.regression.intercept)),
        ("R\u{b2}", digits(a.regression.r_squared)),
        (
            "bias",
            format!("{}, {} %, p {}", estimate(&b.bias), digits(b.bias_percent), p_value(b.bias_p_value)),
        ),
        ("limits of agreement", format!("{} to {}", digits(b.limits[0].value), digits(b.limits[1].value))),
        (
            "proportional bias",
            format!("{}, p {}", estimate(&b.proportional.slope), p_value(b.proportional.slope_p_value)),
        ),
        ("concordance", estimate(&a.concordance)),
        ("ICC, agreement", estimate(&a.intraclass.agreement)),
    ];
    rows.map(|(name, value)| format!("  {name:<20} {value}\n")).concat()
}

fn estimate(e: &Estimate) -> String {
    let [value, low, high] = [e.value, e.interval[0], e.interval[1]].map(digits);
    format!("{value} ({low}, {high})")
}

fn p_value(p: f64) -> String {
    if p.is_nan() {
        "\u{2013}".to_owned()
    } else if p < 1e-4 {
        "< 0.0001".to_owned()
    } else {
        format!("{p:.4}")
    }
}

fn euler_text(euler: &EulerAgreement) -> String {
    let matrices = [("even numbers", &euler.even), ("whole numbers, as in the paper", &euler.integer)];
    let matrices = matrices.map(|(name, matrix)| {
        let share = 100.0 * matrix.accuracy();
        format!("  rounded to {name}: the same in {share:.1} % of {}\n", euler.values.len())
            + &confusion_text(matrix)
    });
    format!("\n{}\n{}", column(&euler.column, &euler.standard_column), matrices.concat())
}

/// Rows are the standard's classes, columns the method's; what is left out has a line below.
fn confusion_text(matrix: &ConfusionMatrix) -> String {
    let classes: Vec<String> = matrix.classes.iter().map(ToString::to_string).collect();
    let mut columns = vec!["standard \\ method"];
    columns.extend(classes.iter().map(String::as_str));
    let mut layout = Layout::new(&columns);
    for (class, counts) in classes.iter().zip(&matrix.counts) {
        let mut row = vec![class.clone()];
        row.extend(counts.iter().map(ToString::to_string));
        layout.row(row);
    }
    layout.text() + &matrix.rare.as_ref().map_or_else(String::new, rare_text)
}

fn rare_text(rare: &RareClasses) -> String {
    format!(
        "  {} rarer classes are not shown: {} objects are in one by either, {} in the same one by both\n",
        rare.classes, rare.pairs, rare.same
    )
}
