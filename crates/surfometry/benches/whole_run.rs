//! Seconds from a decoded array of labels to numbers:
//! `whole_run MASK.npy SIGMA THICKNESS [load|integrals|measure|surface] [RUNS] [SPACING]`.
//!
//! The array lies in memory as a file's reader leaves it. Prints a JSON object: seconds of the fastest run
//! and of its set-up (labels, mask), V, A, M, chi, plain and compensated, and seconds by stage, summed over
//! threads. `benches/peers/speed.py` runs it in turn with other tools.

use serde_json::json;
use std::time::Instant;
use surfometry::Measurement;
use surfometry::io::{ReadOptions, VoxelStream};
use surfometry::volume::{Grid, LabelImage, Samples, SlabReader};

fn main() {
    // `cargo bench` adds an option of its own.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let [path, sigma, thickness, rest @ ..] = &arguments[..] else {
        println!(
            "usage: whole_run MASK.npy SIGMA THICKNESS [load|integrals|measure|surface] [RUNS] [SPACING]"
        );
        return;
    };
    let number = |text: &String| text.parse::<f64>().expect("a number");
    let measurement = Measurement::default().sigma_mm(number(sigma)).thickness_mm(number(thickness));
    let what = rest.first().map_or("integrals", String::as_str);
    let runs = rest.get(1).map_or(1, |runs| runs.parse().expect("a number of runs"));
    let spacing = rest.get(2).map_or(1.0, number);
    let options = ReadOptions { spacing: Some([spacing; 3]) };
    let mut stream = VoxelStream::open(path.as_ref(), options).expect("a readable mask");
    let mut voxels: Vec<u8> = Vec::with_capacity(stream.grid().voxel_count());
    while let Some(slab) = stream.next_slab().expect("a readable mask") {
        let Samples::U8(part) = slab.samples else { panic!("a mask of bytes") };
        voxels.extend(part);
    }
    if what == "load" {
        println!("{} voxels", voxels.len());
        return;
    }
    let grid = *stream.grid();
    let mut results: Vec<_> = (0..runs).map(|_| run(&measurement, grid, &voxels, what)).collect();
    results.sort_by(|a, b| a.0.total_cmp(&b.0));
    println!("{}", results[0].1);
}

fn run(measurement: &Measurement, grid: Grid, voxels: &[u8], what: &str) -> (f64, serde_json::Value) {
    let start = Instant::now();
    let image = LabelImage::from_voxels(grid, voxels).expect("labels");
    let mask = image.mask(1);
    let setup = start.elapsed().as_secs_f64();
    let object = measurement.prepare(&mask).expect("an object");
    let (seconds, found) = match what {
        "integrals" => {
            let [plain, original] = object.integrals();
            (start.elapsed(), json!({"plain": plain, "original": original}))
        }
        "measure" => {
            let m = object.measure();
            let t = m.timings;
            let stages = json!({
                "embed": t.embed, "derive": t.derive, "integrate": t.integrate, "surface": t.surface, "topology": t.topology,
            });
            (start.elapsed(), json!({"plain": m.blurred.values, "original": m.values, "stages": stages}))
        }
        _ => {
            let surface = object.surface();
            let seconds = start.elapsed();
            (seconds, json!({"triangles": surface.mesh.triangles.len(), "A": surface.mesh.area()}))
        }
    };
    let seconds = seconds.as_secs_f64();
    (seconds, json!({"seconds": seconds, "setup": setup, "found": found}))
}
