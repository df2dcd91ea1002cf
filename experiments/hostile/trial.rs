//! One file, or one object, and what the library does with it.

use crate::chance::Chance;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use surfometry::Measurement;
use surfometry::comparison::{Table, compare};
use surfometry::inputs::OpenOptions;
use surfometry::io::{ReadOptions, is_mesh, read_labels_with, read_mesh};
use surfometry::measurement::EmbeddingKind;
use surfometry::runs::{Plan, records_of};
use surfometry::statistics::Bootstrap;
use surfometry::volume::{Grid, LabelImage, Mask};

/// How many there were of each outcome.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) accepted: u64,
    pub(crate) refused: u64,
    /// What went wrong, each with the number of its case.
    pub(crate) faults: Vec<String>,
    pub(crate) slowest: Duration,
}

/// Longer than any file of a hundred bytes may take.
const PATIENCE: Duration = Duration::from_secs(20);

/// Ends the program where a case never ends; the case's file then stays where it is.
pub(crate) struct Watchdog(Arc<AtomicU64>);

impl Watchdog {
    pub(crate) fn new() -> Self {
        let begun = Arc::new(AtomicU64::new(0));
        let seen = Arc::clone(&begun);
        std::thread::spawn(move || {
            let mut before = u64::MAX;
            loop {
                std::thread::sleep(PATIENCE);
                let now = seen.load(Ordering::Relaxed);
                if now == before {
                    eprintln!("case {now} has taken more than {PATIENCE:?}: its file is left");
                    std::process::exit(3);
                }
                before = now;
            }
        });
        Self(begun)
    }

    /// Runs a case; its answer says what was refused.
    pub(crate) fn run(&self, case: u64, tally: &mut Tally, work: impl FnOnce() -> Result<(), String>) {
        self.0.store(case, Ordering::Relaxed);
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(work)) {
            Ok(Ok(())) => tally.accepted += 1,
            Ok(Err(message)) if message.starts_with("WRONG") => {
                tally.faults.push(format!("case {case}: {message}"));
            }
            Ok(Err(message)) if message.trim().len() < 12 => {
                tally.faults.push(format!("case {case}: says only `{message}`"));
            }
            Ok(Err(_)) => tally.refused += 1,
            Err(panic) => {
                let text = panic
                    .downcast_ref::<String>()
                    .cloned()
                    .or(panic.downcast_ref::<&str>().map(ToString::to_string));
                tally.faults.push(format!("case {case}: panic: {}", text.unwrap_or_default()));
            }
        }
        tally.slowest = tally.slowest.max(start.elapsed());
    }
}

const SPACING: [f64; 3] = [1.0, 1.5, 0.8];

/// Reads a file of any kind, and, where that is asked, measures what is in it.
pub(crate) fn read(path: &Path, measures: bool) -> Result<(), String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("csv" | "tsv") => {
            let table = Table::read(path).map_err(|e| text(&e))?;
            let names = ["a".to_owned(), "b".to_owned()];
            let bootstrap = Bootstrap { samples: 20, ..Bootstrap::default() };
            compare([&table, &table], names, &[], bootstrap).map(drop).map_err(|e| text(&e))
        }
        _ if is_mesh(path) && !measures => read_mesh(path).map(drop).map_err(|e| text(&e)),
        _ if measures => {
            let known = path.extension().is_some_and(|ending| ending == "npy") || is_mesh(path);
            let open = OpenOptions { spacing: known.then_some(SPACING), ..OpenOptions::default() };
            records_of(&path.to_string_lossy(), &Plan { open, ..Plan::default() })
                .map(drop)
                .map_err(|e| text(&e))
        }
        _ => labels(path).map(drop),
    }
}

/// The labels of a file, with a spacing where it has none.
pub(crate) fn labels(path: &Path) -> Result<LabelImage, String> {
    let spacing = path.extension().is_some_and(|ending| ending == "npy").then_some(SPACING);
    read_labels_with(path, ReadOptions { spacing }).map_err(|error| error.to_string())
}

/// Whether two images are the same, voxel by voxel, where they lie included.
pub(crate) fn same(a: &LabelImage, b: &LabelImage) -> bool {
    let voxels = || (0..a.grid().voxel_count()).map(|n| a.grid().index_of(n));
    a.grid() == b.grid() && voxels().all(|index| a.get(index) == b.get(index))
}

/// An object of up to 12 voxels along an axis, at a spacing and a blur by chance: its numbers are finite.
pub(crate) fn measure(chance: &mut Chance) -> Result<(), String> {
    let size = [(); 3].map(|()| 1 + chance.below(12));
    let finest = 10f64.powf(-6.0 + 9.0 * chance.share());
    let spacing = [(); 3].map(|()| finest * 50f64.powf(chance.share().powi(3)));
    let filled = chance.share();
    let lumps = 1 + chance.below(4);
    let bits: Vec<bool> = (0..12 * 12 * 12).map(|_| chance.share() < filled).collect();
    let grid = Grid::axis_aligned(size, spacing).map_err(|e| e.to_string())?;
    let mask = Mask::from_predicate(grid, |[x, y, z]| bits[(z / lumps * 12 + y / lumps) * 12 + x / lumps]);
    let unit = spacing.iter().product::<f64>().cbrt();
    let kinds = [
        EmbeddingKind::Corrected,
        EmbeddingKind::Recovering,
        EmbeddingKind::Distance,
        EmbeddingKind::DistanceToVoxels,
    ];
    let mut measurement = Measurement::default();
    if chance.below(2) == 0 {
        measurement = measurement.sigma_mm(unit * 0.3 * 100f64.powf(chance.share()));
    }
    if chance.below(2) == 0 {
        measurement = measurement.embedding(*chance.of(&kinds));
    }
    if chance.below(4) == 0 {
        measurement = measurement.thickness_mm(unit * 0.1 * 1000f64.powf(chance.share()));
    }
    if chance.below(8) == 0 {
        measurement = measurement.level(0.01 + 0.98 * chance.share());
    }
    let measured = measurement.run_settled(mask).map_err(|e| e.to_string())?;
    let all =
        [&measured.values, &measured.standard_error, &measured.blurred.values, &measured.blurred.grid_noise];
    let numbers = all.into_iter().flat_map(|v| {
        [
            v.volume_mm3,
            v.surface_area_mm2,
            v.total_mean_curvature_mm,
            v.total_gaussian_curvature,
            v.total_squared_mean_curvature,
        ]
    });
    let odd = numbers.flatten().find(|number| !number.is_finite());
    odd.map_or(Ok(()), |number| Err(format!("WRONG: {number} of {measured:?}")))
}

/// The most memory that this process has had, MB.
pub(crate) fn peak_megabytes() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|text| text.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or_default() / 1024
}
