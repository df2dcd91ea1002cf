//! Memory follows the object's padded box: at most 12 bytes a voxel of it, beside what tiles need.

mod common;

use common::{phantom, poses};
use peak_alloc::PeakAlloc;
use surfometry::Measurement;
use surfometry::measurement::EmbeddingKind;
use surfometry::phantoms::{MinimalSurface, Periodic};

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

/// Fields of the tiles in work, two threads: they do not grow with the object.
const TILES: usize = 48 << 20;

#[test]
fn at_most_twelve_bytes_a_voxel() {
    let shape = Periodic { surface: MinimalSurface::SchwarzP, period: 100.0, size: 230.0 };
    let mask = phantom(shape, poses()[0], [1.0; 3]).labels().unwrap().mask(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for measurement in [
        Measurement::default(),
        Measurement::paper(),
        Measurement::default().sigma_mm(10.0).thickness_mm(5.0),
        Measurement::default().embedding(EmbeddingKind::Distance),
    ] {
        PEAK.reset_peak_usage();
        let before = PEAK.current_usage();
        pool.install(|| measurement.run(&mask)).unwrap();
        let used = PEAK.peak_usage() - before;
        let voxels = mask.bounds().grown([10; 3]).voxels();
        println!(
            "{:.1} MB for {voxels} voxels: {:.2} bytes a voxel",
            used as f64 / 1e6,
            used as f64 / voxels as f64
        );
        assert!(used < TILES && used < 12 * voxels, "{used} bytes for {voxels} voxels");
    }
}
