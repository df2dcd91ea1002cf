//! Memory that does not follow the image: a file of its own, because the peak is the process'.

use surfometry::Measurement;
use surfometry::phantoms::{MinimalSurface, Periodic, Shape};
use surfometry::volume::{Grid, LabelSelection, Samples, Slab, SlabReader, VolumeError};

/// The slices of a periodic shape that goes on and on, made as they are asked for.
struct Endless {
    grid: Grid,
    shape: Periodic,
    next: usize,
}

impl SlabReader for Endless {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        let [nx, ny, nz] = self.grid.dimensions();
        if self.next == nz {
            return Ok(None);
        }
        let range = self.next..(self.next + 16).min(nz);
        self.next = range.end;
        let index = range.clone().flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let inside = index.map(|i| u8::from(self.shape.value(i.map(|v| v as f64 - 32.0)) < 0.0)).collect();
        Ok(Some(Slab { slices: range, samples: Samples::U8(inside) }))
    }
}

#[global_allocator]
static PEAK: peak_alloc::PeakAlloc = peak_alloc::PeakAlloc;

/// Four times the slices, the same memory.
#[test]
fn memory_does_not_follow_the_image() {
    let peak = |slices: usize| {
        let grid = Grid::axis_aligned([64, 64, slices], [1.0; 3]).unwrap();
        let shape = Periodic { surface: MinimalSurface::Gyroid, period: 24.0, size: 1e6 };
        let mut reader = Endless { grid, shape, next: 0 };
        PEAK.reset_peak_usage();
        let before = PEAK.current_usage();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let m = Measurement::default().sigma_mm(2.0);
        let streamed = pool.install(|| m.run_slabs(&mut reader, &LabelSelection::All, |_| {})).unwrap();
        assert!(streamed.results[0].1.topology.handles > slices as i64 / 10);
        PEAK.peak_usage() - before
    };
    let (short, long) = (peak(700), peak(2800));
    println!("{:.1} MB for 700 slices, {:.1} MB for 2800", short as f64 / 1e6, long as f64 / 1e6);
    assert!((long as f64) < 1.15 * short as f64, "{short} {long}");
}
