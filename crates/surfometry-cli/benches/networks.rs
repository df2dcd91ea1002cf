//! How the whole command grows with an object's surface:
//! `cargo bench -p surfometry-cli --bench networks [-- OPTION OF MEASURE...]`.
//!
//! Networks like trabecular bone (smoothed noise above a threshold), a gyroid and white noise are written as
//! .nii.gz once, and `surfometry measure` is run on each, file in, table out. A row has the seconds on the
//! clock, those that `--timings` adds up over threads, the clock's over what these make on all threads, and
//! the peak of memory. SURFOMETRY names another program to run.

use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use surfometry::io::write_labels;
use surfometry::volume::{Grid, LabelImage};

fn main() {
    // `cargo bench` adds an option of its own.
    let options: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    println!("{:>14} {:>12} {:>8} {:>9} {:>6} {:>9}", "", "voxels", "s", "stages s", "ratio", "peak MiB");
    let networks = [128, 256, 384, 512].map(|n| (format!("network-{n}"), n, network as fn(usize) -> Vec<u8>));
    let others = [("gyroid-256", 256, gyroid as fn(usize) -> Vec<u8>), ("noise-192", 192, white_noise)];
    for (name, n, voxels) in
        networks.into_iter().chain(others.map(|(name, n, voxels)| (name.to_owned(), n, voxels)))
    {
        measure(&file(&name, n, voxels), &options);
    }
}

/// The file of a shape, written where it is not there yet.
fn file(name: &str, n: usize, voxels: fn(usize) -> Vec<u8>) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.nii.gz"));
    if !path.exists() {
        let grid = Grid::axis_aligned([n; 3], [1.0; 3]).expect("a grid");
        let image = LabelImage::from_voxels(grid, &voxels(n)).expect("labels");
        write_labels(&path, &image).expect("a file");
    }
    path
}

fn measure(path: &Path, options: &[String]) {
    let program = std::env::var("SURFOMETRY").unwrap_or_else(|_| env!("CARGO_BIN_EXE_surfometry").to_owned());
    let start = Instant::now();
    let mut command = Command::new(program);
    command.args(["measure", "--timings", "--verbose"]).args(options).arg(path);
    let output = command.output().expect("the program runs");
    let seconds = start.elapsed().as_secs_f64();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let after = |words: &str| said.split_once(words).map_or("", |(_, rest)| rest);
    let numbers = |text: &str| -> Vec<f64> {
        text.lines().next().unwrap_or("").split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
    };
    let stages: f64 = numbers(after("seconds: ")).iter().sum();
    let peak = numbers(after("peak memory so far "))[0];
    let voxels = table_voxels(&String::from_utf8_lossy(&output.stdout));
    let ratio = seconds * rayon::current_num_threads() as f64 / stages;
    let name = path.file_name().map(|name| name.to_string_lossy().replace(".nii.gz", "")).unwrap_or_default();
    println!("{name:>14} {voxels:>12} {seconds:>8.2} {stages:>9.2} {ratio:>6.2} {peak:>9.0}");
    println!("{:>14} {}", "", after("seconds: ").lines().next().unwrap_or(""));
}

/// The number of the object's voxels, whose volume is 1 mm3.
fn table_voxels(table: &str) -> String {
    let row = table.lines().find(|line| line.trim_start().starts_with("voxels ")).unwrap_or_default();
    row.split_whitespace().nth(1).unwrap_or("-").to_owned()
}

/// A number of its own for each place, in 0..1.
fn chance(place: usize) -> f32 {
    let mut bits = (place as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    (bits >> 40) as f32 / (1u32 << 24) as f32
}

/// The highest 22 % of noise that boxes of 5 voxels smooth three times along each axis, almost a Gaussian of
/// 2.4 voxels.
fn network(n: usize) -> Vec<u8> {
    let mut values: Vec<f32> = (0..n.pow(3)).into_par_iter().map(chance).collect();
    for _ in 0..3 {
        for stride in [1, n, n * n] {
            values = smoothed(&values, n, stride);
        }
    }
    let mut sample: Vec<f32> = values.iter().copied().step_by(61).collect();
    let place = sample.len() * 78 / 100;
    let (_, &mut threshold, _) = sample.select_nth_unstable_by(place, f32::total_cmp);
    values.par_iter().map(|&value| u8::from(value > threshold)).collect()
}

/// Means of 5 values along an axis of a periodic image.
fn smoothed(values: &[f32], n: usize, stride: usize) -> Vec<f32> {
    let mean = |place: usize| {
        let along = place / stride % n;
        let first = place - along * stride;
        let sum: f32 = (n - 2..=n + 2).map(|step| values[first + (along + step) % n * stride]).sum();
        sum / 5.0
    };
    (0..values.len()).into_par_iter().map(mean).collect()
}

fn gyroid(n: usize) -> Vec<u8> {
    let turn = std::f64::consts::TAU / 32.0;
    let inside = |place: usize| {
        let [x, y, z] = [place % n, place / n % n, place / n / n].map(|v| v as f64 * turn);
        u8::from(x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos() > 0.0)
    };
    (0..n.pow(3)).into_par_iter().map(inside).collect()
}

fn white_noise(n: usize) -> Vec<u8> {
    (0..n.pow(3)).into_par_iter().map(|place| u8::from(chance(place) < 0.5)).collect()
}
