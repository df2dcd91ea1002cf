//! The embeddings that the paper's discussion names, from the study that makes them with other tools.

use crate::Experiment;
use crate::desk::Desk;
use crate::table::Table;
use anyhow::{Context, Result};

pub(crate) const EXPERIMENT: Experiment =
    Experiment { name: "alternatives", title: "Other embeddings that the discussion names", run };

/// What the study found when it was last accepted; `study.py --check` compares.
const STUDY: &str = include_str!("../alternative_embeddings/expected/numbers.csv");
const SHAPES: [&str; 3] = ["ellipsoid 3:2:1.5", "torus 2:1", "schwarz-p"];
/// The study's name, and what the paper calls it.
const EMBEDDINGS: [(&str, &str); 11] = [
    ("blur, 2 voxels", "the paper's"),
    ("corrected blur, 2 voxels", "ours"),
    ("corrected blur, 4 voxels", "ours"),
    ("distance", "signed distance transform"),
    ("blur, reinitialised", "reinitialisation of the embedding"),
    ("dithered, reinitialised", "dithering and reinitialisation"),
    ("anisotropic diffusion, conductance 3", "anisotropic diffusion"),
    ("anisotropic diffusion, conductance 30", "anisotropic diffusion"),
    ("anti-aliasing", "anti-aliasing filter"),
    ("anti-aliasing, blurred by 1 voxel", "anti-aliasing filter"),
    ("cubic B-spline", "non-nearest neighbour interpolation"),
];

fn run(desk: &mut Desk) -> Result<()> {
    desk.say(
        "The paper's discussion names reinitialisation, dithering, anisotropic diffusion, anti-aliasing filters and interpolation as other ways to embed a mask, and shows none. Each makes a field of the same \
         mask, which `--embedding given` measures: R = 15 voxels, rotated and off the grid; V and A in % of the exact shape, χ less the exact one, rms of H and K over the surface in % of 1/R and 1/R²; \
         ellipsoid 3:2:1.5 / torus 2:1 / Schwarz P. What cannot be had is a dash. Only what blurs gives curvature.",
    );
    let mut table = Table::new("embedding | in the paper | V | A | χ | H | K");
    for (name, called) in EMBEDDINGS {
        let mut cells = Vec::new();
        for (column, digits) in
            [("V_percent", 2), ("A_percent", 2), ("chi", 2), ("H_percent", 1), ("K_percent", 1)]
        {
            let mut values = Vec::new();
            for shape in SHAPES {
                let key = format!("{name}.{shape}.{column}");
                let value = desk.number(&key, of_study(&key)?);
                values.push(if value.is_finite() { format!("{value:.digits$}") } else { "–".to_owned() });
            }
            cells.push(values.join(" / "));
        }
        table.row(&format!("{name} | {called} | {}", cells.join(" | ")));
    }
    desk.say(&table.text());
    desk.say("`experiments/alternative_embeddings/README.md` says what follows; `study.py --check` there measures anew.");
    Ok(())
}

fn of_study(key: &str) -> Result<f64> {
    let line = STUDY
        .lines()
        .find_map(|line| line.rsplit_once(',').filter(|(name, _)| name.trim_matches('"') == key));
    let (_, value) = line.with_context(|| format!("the study has no {key}"))?;
    value.parse().with_context(|| format!("{key} is {value}"))
}
