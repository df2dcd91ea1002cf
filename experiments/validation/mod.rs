//! "Validation of morphometrics": the distance embedding and the proposed one against established methods on
//! re-binarised masks, laid out as the paper's table; and every method against the original bone, which the
//! paper could not know.

mod measurements;
mod paper;

pub(crate) use measurements::{Row, read_rows};

use crate::Experiment;
use crate::bones::KINDS;
use crate::desk::Desk;
use crate::table::{Table, short};
use anyhow::Result;
use measurements::measure_cohort;
use paper::{PAPER, PaperRow};
use surfometry::pictures::{AgreementChart, AgreementPanel};
use surfometry::statistics::{
    Agreement, BlandAltman, Bootstrap, LinearFit, Paired, Spread, bland_altman, least_squares,
};

pub(crate) const EXPERIMENT: Experiment =
    Experiment { name: "validation", title: "Validation of morphometrics", run };

/// A column of the measurements.
pub(crate) type Value = fn(&Row) -> f64;

const MEASURES: [(&str, Value); 3] =
    [("V (mm³)", |r| r.volume), ("A (mm²)", |r| r.area), ("⟨H⟩ (1/mm)", |r| r.average_mean_curvature)];

/// What stands for the paper's IPL: triangulation of the mask smoothed by 0.8 voxel.
pub(crate) const STANDARD: &str = "triangulation-smoothed on the re-binarised mask";
/// The same, with M by one-sided dilation, as the paper's has it.
const ONE_SIDED: &str = "triangulation-smoothed-one-sided on the re-binarised mask";
/// The standard on the bone's own mask.
const MASK_STANDARD: &str = "triangulation-smoothed";
/// What is compared with it, and what it is called.
const METHODS: [(&str, &str); 5] = [
    ("distance on the re-binarised mask", "Distance transform, re-binarised mask"),
    ("paper", "Proposed method, paper's settings"),
    ("defaults at the paper's sigma", "Our defaults at the paper's sigma"),
    ("defaults on the re-binarised mask", "Our defaults, re-binarised mask, its original surface"),
    (
        "distance to boundary voxels on the re-binarised mask",
        "Distance transform that is zero on boundary voxels (ITK's)",
    ),
];
/// What is compared with the exact bone.
const AGAINST_TRUTH: [(&str, &str); 8] = [
    ("defaults", "Our defaults"),
    ("defaults at the paper's sigma, original", "Our defaults, sigma 2 mm"),
    ("paper", "Proposed method, paper's settings"),
    ("distance", "Distance transform"),
    ("triangulation-smoothed", "Triangulation, smoothed"),
    ("triangulation", "Triangulation"),
    ("crofton-13", "Crofton, 13 directions"),
    ("voxels", "Voxels and their faces"),
];

/// Rows of both methods on the same bones of a kind, as pairs (method, standard).
pub(crate) fn pairs(
    rows: &[Row],
    kind: &str,
    [method, standard]: [&str; 2],
    value: Value,
) -> Vec<(f64, f64)> {
    values(rows, kind, method, value).into_iter().zip(values(rows, kind, standard, value)).collect()
}

/// A method's values of the bones of a kind.
pub(crate) fn values(rows: &[Row], kind: &str, method: &str, value: Value) -> Vec<f64> {
    rows.iter().filter(|r| r.kind == kind && r.method == method).map(value).collect()
}

fn paired(pairs: &[(f64, f64)]) -> Result<Paired> {
    let (method, standard) = pairs.iter().copied().unzip();
    Ok(Paired::new(method, standard)?)
}

/// What the paper prints: the line of the standard on the method, and the differences.
fn line_and_differences(pairs: &[(f64, f64)]) -> Result<(LinearFit, BlandAltman)> {
    let pairs = paired(pairs)?;
    Ok((least_squares(pairs.method(), pairs.standard()), bland_altman(&pairs)))
}

fn run(desk: &mut Desk) -> Result<()> {
    let rows = measure_cohort(desk)?;
    desk.say(
        "As in the paper, a bone is embedded (sigma 2 mm, t 2.5 mm), measured, and re-binarised below zero; established methods measure the re-binarised mask, so that the object is the same, and \
         the distance embedding is made of it. The paper's standard, SCANCO's IPL, is not public: in its place stands the triangulation of the mask smoothed by 0.8 voxel, and M by its central \
         rate of change of area. Regression is of the standard on the method, as in the paper; bias is method minus standard (the paper prints the reverse: its figures are turned round here). The p-value is of \
         the slope of difference on mean, as in the paper.",
    );
    for (method, title) in METHODS {
        against_standard(desk, &rows, [method, title])?;
    }
    charts(desk, &rows)?;
    proportional_bias(desk, &rows)?;
    against_truth(desk, &rows);
    claims(desk, &rows)
}

fn against_standard(desk: &mut Desk, rows: &[Row], [method, title]: [&str; 2]) -> Result<()> {
    desk.say(&format!("**{title}**"));
    let mut table = Table::new(
        "bone | measure | method | standard | slope (95 % CI) | intercept (95 % CI) | R² | bias (95 % LoA) | bias | p",
    );
    for kind in KINDS {
        for (measure, value) in MEASURES {
            let pairs = pairs(rows, kind, [method, STANDARD], value);
            let (line, b) = line_and_differences(&pairs)?;
            let (of_method, of_standard): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            let key = |what: &str| format!("{method}.{kind}.{measure}.{what}");
            desk.number(key("bias_percent"), b.bias_percent);
            desk.number(key("r_squared"), line.r_squared);
            desk.number(key("slope"), line.slope.value);
            desk.number(key("intercept"), line.intercept.value);
            let p = desk.number(key("proportional_p"), b.proportional.slope_p_value);
            let spread = |values: &[f64]| {
                let Spread { mean, deviation } = Spread::of(values);
                format!("{} ± {}", short(mean), short(deviation))
            };
            table.row(&format!(
                "{kind} | {measure} | {} | {} | {:.4} ({:.4}, {:.4}) | {} ({}, {}) | {:.4} | {} ({}, {}) | {:+.2} % | {}",
                spread(&of_method),
                spread(&of_standard),
                line.slope.value,
                line.slope.interval[0],
                line.slope.interval[1],
                short(line.intercept.value),
                short(line.intercept.interval[0]),
                short(line.intercept.interval[1]),
                line.r_squared,
                short(b.bias.value),
                short(b.limits[0].value),
                short(b.limits[1].value),
                b.bias_percent,
                p_value(p),
            ));
            if let Some(row) = PAPER.iter().find(|r| (r.method, r.kind, r.measure) == (method, kind, measure))
            {
                table.row(&paper_line(row));
            }
        }
    }
    desk.say(&table.text());
    Ok(())
}

fn paper_line(row: &PaperRow) -> String {
    let [low, high] = row.limits;
    format!(
        "| *paper* | *{}* | *{}* | *{}* | *{}* | *{:.3}* | *{} ({}, {})* | *{:+.2} %* | *{}*",
        row.method_spread,
        row.standard_spread,
        row.slope,
        row.intercept,
        row.r_squared,
        short(-row.bias),
        short(-high),
        short(-low),
        -100.0 * row.bias / row.standard_mean,
        row.p,
    )
}

fn p_value(p: f64) -> String {
    if p < 1e-4 { "< 0.0001".to_owned() } else { format!("{p:.4}") }
}

fn charts(desk: &mut Desk, rows: &[Row]) -> Result<()> {
    for ((method, title), called) in METHODS.iter().zip(["distance", "paper", "defaults"]) {
        let mut figures = Vec::new();
        for kind in KINDS {
            let of_measures: Vec<(&str, Vec<(f64, f64)>)> = MEASURES
                .iter()
                .map(|(name, value)| (*name, pairs(rows, kind, [method, STANDARD], *value)))
                .collect();
            let agreements: Vec<Agreement> = of_measures
                .iter()
                .map(|(_, pairs)| Ok(Agreement::of(&paired(pairs)?, Bootstrap::default())))
                .collect::<Result<_>>()?;
            let panels: Vec<AgreementPanel> = of_measures
                .iter()
                .zip(&agreements)
                .map(|((name, pairs), agreement)| AgreementPanel { name, pairs, objects: &[], agreement })
                .collect();
            let method = format!("{kind}, {called}");
            let chart = AgreementChart { method: &method, standard: "standard", panels: &panels };
            figures.push((format!("{called}-{kind}"), chart.figure()));
        }
        desk.figures(&figures, &format!("{title}: regression and Bland-Altman plots, as the paper's."))?;
    }
    Ok(())
}

/// What the paper calls so, and what it is.
fn proportional_bias(desk: &mut Desk, rows: &[Row]) -> Result<()> {
    let mut table = Table::new(
        "area | width of the limits over the mean | half of it | slope of difference on mean | paper's \"proportional bias\"",
    );
    let printed = [["-5.0 %", "-3.1 %"], ["0.6 %", "0.8 %"]];
    for ((method, title), printed) in METHODS.into_iter().zip(printed) {
        for (kind, printed) in KINDS.into_iter().zip(printed) {
            let (_, b) = line_and_differences(&pairs(rows, kind, [method, STANDARD], MEASURES[1].1))?;
            let slope = 100.0 * b.proportional.slope.value;
            desk.number(format!("{method}.{kind}.area_slope_of_difference_percent"), slope);
            table.row(&format!(
                "{kind}, {title} | {:.2} % | {:.2} % | {slope:+.2} % | {printed}",
                b.limits_width_percent,
                0.5 * b.limits_width_percent
            ));
        }
    }
    desk.say(
        "The paper prints, as proportional bias of the area, the difference of the limits of agreement over the average: a spread, not a slope. From its table the femur's is (1379 - 410) / 19200 = 5.0 % \
         for the distance transform and (168 - 60) / 18700 = 0.6 % for the proposed method. Ours, and the slope that the word stands for:",
    );
    desk.say(&table.text());
    Ok(())
}

fn against_truth(desk: &mut Desk, rows: &[Row]) {
    let mut table = Table::new("against the exact bone: bias, sd of differences | | V | A | ⟨H⟩");
    for (method, title) in AGAINST_TRUTH {
        for kind in KINDS {
            let mut cells = Vec::new();
            for (measure, value) in MEASURES {
                let pairs = pairs(rows, kind, [method, "exact"], value);
                if pairs.iter().any(|pair| !pair.0.is_finite()) {
                    cells.push("–".to_owned());
                    continue;
                }
                let ratios: Vec<f64> = pairs.iter().map(|(m, s)| 100.0 * (m / s - 1.0)).collect();
                let Spread { mean, deviation } = Spread::of(&ratios);
                desk.number(format!("truth.{method}.{kind}.{measure}.bias_percent"), mean);
                desk.number(format!("truth.{method}.{kind}.{measure}.sd_percent"), deviation);
                cells.push(format!("{mean:+.2} ± {deviation:.2} %"));
            }
            table.row(&format!("{title} | {kind} | {}", cells.join(" | ")));
        }
    }
    desk.say(
        "Against the *original* bone, which the paper could not know. The masks carry the slices' jitter, so no method can be exact. Agreement on a re-binarised mask says that two methods measure \
         the same blurred object alike; it does not say that either tells the bone: the blur's own shrinkage is the larger part, and it is what compensation takes off.",
    );
    desk.say(&table.text());
}

/// What is claimed, with what came out.
fn claims(desk: &mut Desk, rows: &[Row]) -> Result<()> {
    let mut table = Table::new("claim | femurs | vertebrae");
    let mut add = |claim: &str, of: &mut dyn FnMut(&str) -> Result<String>| -> Result<()> {
        let cells = KINDS.map(of).into_iter().collect::<Result<Vec<_>>>()?;
        table.row(&format!("{claim} | {}", cells.join(" | ")));
        Ok(())
    };
    let area: Value = MEASURES[1].1;
    add("distance embedding's area above the proposed one", &mut |kind| {
        let pairs = pairs(rows, kind, ["distance on the re-binarised mask", "paper"], area);
        let above = pairs.iter().filter(|(distance, proposed)| distance > proposed).count();
        desk.number(format!("claim.{kind}.distance_area_above"), above as f64);
        Ok(format!("{above} of {}", pairs.len()))
    })?;
    add("proposed area within 1.5 % of the standard: worst bone", &mut |kind| {
        let off = pairs(rows, kind, ["paper", STANDARD], area)
            .into_iter()
            .map(|(m, s)| 100.0 * (m / s - 1.0).abs());
        Ok(format!(
            "{:.2} %",
            desk.number(format!("claim.{kind}.worst_area_percent"), off.fold(0.0, f64::max))
        ))
    })?;
    add("R² ≥ 0.999 of V and A, ≥ 0.99 of ⟨H⟩", &mut |kind| {
        let squares = MEASURES.map(|(_, value)| {
            Ok(line_and_differences(&pairs(rows, kind, ["paper", STANDARD], value))?.0.r_squared)
        });
        let squares: Vec<f64> = squares.into_iter().collect::<Result<_>>()?;
        Ok(squares.iter().map(|r| format!("{r:.4}")).collect::<Vec<_>>().join(", "))
    })?;
    add("our defaults at the same sigma at least as good: bias of V, A, ⟨H⟩; R²", &mut |kind| {
        let (mut bias, mut square) = (0, 0);
        for (_, value) in MEASURES {
            let of = |method| line_and_differences(&pairs(rows, kind, [method, STANDARD], value));
            let ((our_line, ours), (line, theirs)) = (of("defaults at the paper's sigma")?, of("paper")?);
            bias += u8::from(ours.bias.value.abs() <= theirs.bias.value.abs());
            square += u8::from(our_line.r_squared >= line.r_squared - 1e-5);
        }
        desk.number(format!("claim.{kind}.bias_at_least_as_good"), f64::from(bias));
        desk.number(format!("claim.{kind}.r_squared_at_least_as_good"), f64::from(square));
        Ok(format!("{bias} of 3; {square} of 3"))
    })?;
    desk.say(&table.text());
    disagreements(desk, rows)
}

/// What does not agree, with the numbers that say why.
fn disagreements(desk: &mut Desk, rows: &[Row]) -> Result<()> {
    let mut table = Table::new("bias of ⟨H⟩, paper's settings, against | femurs | vertebrae");
    for (standard, title) in [
        (STANDARD, "the standard here: central dilation"),
        (ONE_SIDED, "one-sided dilation, as the paper's standard has it"),
    ] {
        let cells = KINDS.map(|kind| -> Result<String> {
            let (_, b) = line_and_differences(&pairs(rows, kind, ["paper", standard], MEASURES[2].1))?;
            Ok(format!(
                "{:+.2} %",
                desk.number(format!("paper.{kind}.bias_of_mean_curvature.{title}"), b.bias_percent)
            ))
        });
        table.row(&format!("{title} | {}", cells.into_iter().collect::<Result<Vec<_>>>()?.join(" | ")));
    }
    table.row("*paper* | *-0.00 %* | *+0.79 %*");
    desk.say(&table.text());
    let short_by = |desk: &mut Desk, kind: &str, value: Value| {
        let pairs = pairs(rows, kind, [MASK_STANDARD, "exact"], value);
        let mean = pairs.iter().map(|(m, s)| 100.0 * (m / s - 1.0)).sum::<f64>() / pairs.len() as f64;
        desk.number(format!("disagreement.{kind}.standard_percent"), mean)
    };
    let volumes = KINDS.map(|kind| short_by(desk, kind, MEASURES[0].1));
    desk.say(&format!(
        "What does not agree: the sign of the small bias of V. In the paper the proposed V is 0.4 to 0.5 % *below* the standard, here above. IPL's triangulation is not known in detail; ours is of a \
         mask blurred by 0.8 voxel, which takes {:.2} % of the femurs' volume itself and {:.2} % of the vertebrae's. Of ⟨H⟩ the table above has both forms of dilation: with the paper's, \
         one-sided one, which is too large where a surface has edges and steps, what is left is as small as the paper's. Of V of the vertebrae our defaults have a square that is not as good, in the fifth \
         digit: our t follows the spacing, and the plain V carries 0.033 t² M, which compensation takes off. The distance embedding's ⟨H⟩ agrees less here than in the paper (R² in the first table).",
        -volumes[0], -volumes[1],
    ));
    Ok(())
}
