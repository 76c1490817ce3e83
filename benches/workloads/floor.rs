//! What the machine can do: the rates that bound assembly from below.

use crate::measure::{Time, timed};
use crate::run::Options;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use serde_json::{Value, json};
use std::hint::black_box;

/// Numbers in the arrays that are copied and touched: 256 MB, beyond every cache.
const LONG: usize = 32 << 20;
/// Size of the matrices that are multiplied.
const SIDE: usize = 1024;

/// The least CPU time of `reps` and one runs.
fn least(reps: usize, mut work: impl FnMut() -> Time) -> f64 {
    (0..=reps).map(|_| work().cpu).fold(f64::INFINITY, f64::min)
}

/// Copy of memory in use (bytes read and written), first touch of new memory (bytes written) \[GB/s\], and product of dense matrices
/// \[GFlop/s, one product and one sum each\]: one thread, best of the repetitions.
pub fn record(options: &Options) -> Value {
    let bytes = 8.0 * LONG as f64;
    let from = vec![1.5f64; LONG];
    let mut to = vec![0.5f64; LONG];
    let copy = least(options.reps, || timed(|| black_box(&mut to).copy_from_slice(black_box(&from))).1);
    drop((from, to));
    let touch = least(options.reps, || {
        let (fresh, time) = timed(|| black_box(vec![1.5f64; LONG]));
        drop(fresh);
        time
    });
    let (a, b) = (Mat::from_fn(SIDE, SIDE, |i, j| (i + 2 * j) as f64), Mat::from_fn(SIDE, SIDE, |i, j| (3 * i + j) as f64));
    let mut c = Mat::zeros(SIDE, SIDE);
    let product =
        least(options.reps, || timed(|| matmul(black_box(&mut c), Accum::Replace, black_box(&a), black_box(&b), 1.0, Par::Seq)).1);
    json!({
        "workload": "floor", "copy_gb_s": 2e-9 * bytes / copy, "first_touch_gb_s": 1e-9 * bytes / touch,
        "fma_gflop_s": 2e-9 * (SIDE as f64).powi(3) / product, "reps": options.reps,
    })
}
