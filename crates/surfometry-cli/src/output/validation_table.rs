//! The zoo's errors as a table for people.

use super::Layout;
use surfometry::integrals::Globals;
use surfometry::validation::{PoseErrors, Rivalry, Summary};

const COLUMNS: [&str; 15] = [
    "shape",
    "R",
    "ratio",
    "V blurred",
    "A blurred",
    "M blurred",
    "V",
    "A",
    "M",
    "95 %",
    "chi",
    "local H",
    "K",
    "place",
    "95 % H K",
];

pub(crate) fn validation_table(summaries: &[Summary]) -> String {
    let mut layout = Layout::new(&COLUMNS);
    for s in summaries {
        let percent = |v: f64| format!("{v:+.3}");
        let short =
            |v: Option<f64>, digits: usize| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"));
        let name = if s.tuned { s.shape.to_owned() } else { format!("{} *", s.shape) };
        let (p, c) = (&s.worst_blurred, &s.worst_original);
        layout.row(vec![
            name,
            format!("{}", s.resolution),
            format!("{}", s.ratio),
            percent(p.volume),
            percent(p.area),
            percent(p.total_mean_curvature),
            percent(c.volume),
            percent(c.area),
            percent(c.total_mean_curvature),
            short(s.coverage, 0),
            format!("{:+.3}{}", s.worst_euler_characteristic, if s.wrong_meshes > 0 { " !" } else { "" }),
            short(s.mean_curvature, 1),
            short(s.gaussian_curvature, 1),
            short(s.position_voxels, 3),
            s.local_coverage.map_or_else(|| "-".to_owned(), |[h, k]| format!("{h:.0} {k:.0}")),
        ]);
    }
    layout.text()
        + "\nR: 1 / rms of the larger principal curvature, in units of the largest spacing; ratio: largest over smallest spacing; * the scale of local \
           curvature and its bars were not tuned on such shapes; the constants of the integrals' errors were set on poses 0 to 7 of all.\nV, A, M: the largest error over the poses, in % of the exact value, of the blurred and of the original object; \
           95 %: share of the original object's values within 1.96 standard errors.\nchi: the largest error of Gauss-Bonnet; ! where the mesh's differs. local H, K: rms error at \
           the vertices in % of 1/R and 1/R^2; place: rms distance from the exact surface in voxels; 95 % H K: share of the surface within the error bars.\n"
}

/// Another program's errors beside ours.
pub(crate) fn rivalry_table(rivalries: &[Rivalry]) -> String {
    let mut layout = Layout::new(&[
        "shape", "R", "ratio", "poses", "V theirs", "ours", "A theirs", "ours", "M theirs", "ours",
    ]);
    for r in rivalries {
        let cell = |spread: &PoseErrors, part: fn(&Globals) -> f64| {
            format!("{:+.2}, {:.2}", part(&spread.bias), part(&spread.rms))
        };
        let both = |part: fn(&Globals) -> f64| [cell(&r.theirs, part), cell(&r.ours, part)];
        let mut row = vec![
            r.shape.to_owned(),
            format!("{}", r.resolution),
            format!("{}", r.ratio),
            r.cases.to_string(),
        ];
        row.extend([both(|g| g.volume), both(|g| g.area), both(|g| g.total_mean_curvature)].concat());
        layout.row(row);
    }
    layout.text()
        + "\nBias and rms over poses of the errors of V, A and M, in % of the exact value; NaN where there is no value.\n"
}
