//! What this machine could do at best, on all threads: bytes a second read from memory, single-precision
//! operations a second. JSON.

use fearless_simd::{Level, dispatch, f32x16, prelude::*};
use rayon::prelude::*;
use serde_json::json;
use std::hint::black_box;
use std::time::Instant;

/// Bytes that are read: far more than caches hold.
const BYTES: usize = 1 << 28;
/// Multiplications with additions a sum.
const STEPS: usize = 1 << 22;
/// Independent sums, so that none waits for its own.
const SUMS: usize = 12;

fn main() {
    let threads = rayon::current_num_threads();
    let array = vec![1u64; BYTES / 8];
    let bandwidth = fastest(|| {
        let sum = |part: &[u64]| dispatch!(Level::new(), _simd => part.iter().fold(0u64, |sum, value| sum.wrapping_add(*value)));
        black_box(array.par_chunks(BYTES / 8 / threads).map(sum).sum::<u64>());
        BYTES as f64
    });
    let operations = fastest(|| {
        (0..threads).into_par_iter().for_each(|_| {
            dispatch!(Level::new(), simd => multiply_add(simd));
        });
        (threads * SUMS * STEPS * 16 * 2) as f64
    });
    println!("{}", json!({"threads": threads, "bytes_a_second": bandwidth, "flops": operations}));
}

#[inline(always)]
fn multiply_add<S: Simd>(simd: S) {
    let mut sums = [f32x16::splat(simd, black_box(1.0)); SUMS];
    let (factor, term) = (f32x16::splat(simd, black_box(0.999)), f32x16::splat(simd, black_box(1e-3)));
    for _ in 0..STEPS {
        for sum in &mut sums {
            *sum = sum.mul_add(factor, term);
        }
    }
    black_box(sums);
}

/// The largest rate of five tries.
fn fastest(work: impl Fn() -> f64) -> f64 {
    let rate = |_| {
        let start = Instant::now();
        work() / start.elapsed().as_secs_f64()
    };
    (0..5).map(rate).fold(0.0, f64::max)
}
