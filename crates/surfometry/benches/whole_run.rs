//! Seconds from a decoded array of labels to numbers: `whole_run MASK.npy SIGMA THICKNESS [integrals|measure|surface] [RUNS]`.
//!
//! The array lies in memory as a file's reader leaves it; the spacing is 1. Prints the seconds of each run, then V, A, M, chi.
//! `benches/peers/speed.py` runs it in turn with other tools.

use std::time::Instant;
use surfometry::Measurement;
use surfometry::io::VoxelStream;
use surfometry::volume::{Grid, LabelImage, Slab, SlabReader, VolumeError};

/// Slabs that lie in memory.
struct InMemory {
    grid: Grid,
    slabs: std::vec::IntoIter<Slab>,
}

impl SlabReader for InMemory {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        Ok(self.slabs.next())
    }
}

fn main() {
    // `cargo bench` adds an option of its own.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let [path, sigma, thickness, rest @ ..] = &arguments[..] else {
        println!("usage: whole_run MASK.npy SIGMA THICKNESS [integrals|measure|surface] [RUNS]");
        return;
    };
    let number = |text: &String| text.parse::<f64>().expect("a number");
    let measurement = Measurement::default().sigma_mm(number(sigma)).thickness_mm(number(thickness));
    let what = rest.first().map_or("integrals", String::as_str);
    let runs = rest.get(1).map_or(1, |runs| runs.parse().expect("a number of runs"));
    let options = surfometry::io::ReadOptions { spacing: Some([1.0; 3]) };
    let mut stream = VoxelStream::open(path.as_ref(), options).expect("a readable mask");
    let mut slabs = Vec::new();
    while let Some(slab) = stream.next_slab().expect("a readable mask") {
        slabs.push(slab);
    }
    for _ in 0..runs {
        let mut reader = InMemory { grid: *stream.grid(), slabs: slabs.clone().into_iter() };
        let start = Instant::now();
        let image = LabelImage::from_slabs(&mut reader).expect("labels");
        let mask = image.mask(1);
        let setup = start.elapsed().as_secs_f64();
        let stopped;
        let object = measurement.prepare(&mask).expect("an object");
        let result = match what {
            "integrals" => {
                let i = object.integrals().expect("a surface");
                stopped = start.elapsed();
                [i.volume, i.surface.area, i.surface.mean, i.surface.gaussian / std::f64::consts::TAU]
            }
            "measure" => {
                let m = object.measure().plain;
                stopped = start.elapsed();
                [m.volume_mm3, m.surface_area_mm2, m.total_mean_curvature_mm, m.euler_characteristic]
                    .map(Option::unwrap_or_default)
            }
            _ => {
                let surface = object.surface();
                stopped = start.elapsed();
                let counts = [surface.vertices.len(), surface.mesh.triangles.len()].map(|n| n as f64);
                [surface.mesh.volume(), surface.mesh.area(), counts[0], counts[1]]
            }
        };
        println!("{} {setup} {result:?}", stopped.as_secs_f64());
    }
}
