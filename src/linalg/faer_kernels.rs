//! Check that the scratch memory of dense products is available before the library allocates it.
//!
//! On x86-64 the first product of a thread maps twice the size of all last-level caches together, and touches as much of it as its
//! operands fill. In a limited address space this allocation may fail, and the library aborts the program.

use super::LinearError;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use std::cell::Cell;
use std::hint::black_box;
use std::path::Path;
use std::sync::OnceLock;

/// Bytes that have to stay free besides: vectors, results, files.
const BESIDE: usize = 16 << 20;
/// Least assumed size of the last-level caches, and the size assumed if the system does not report them \[bytes\].
const LEAST: usize = 2 << 20;
const UNKNOWN: usize = 128 << 20;
/// Rows and columns of a product that triggers the allocation.
const SMALL: usize = 64;

thread_local! {
    /// Whether this thread has allocated the memory.
    static HELD: Cell<bool> = const { Cell::new(false) };
}

/// Allocates the scratch memory of dense products for this thread, unless done before.
///
/// # Errors
/// [`LinearError::Memory`] if there is not enough.
pub(super) fn take() -> Result<(), LinearError> {
    if HELD.get() {
        return Ok(());
    }
    let mut trial = Vec::<u8>::new();
    trial.try_reserve_exact(scratch() + BESIDE).map_err(|_| LinearError::Memory)?;
    drop(black_box(trial));
    let (a, mut c) = (vec![0.0; SMALL * SMALL], vec![0.0; SMALL * SMALL]);
    let a = MatRef::from_column_major_slice(&a, SMALL, SMALL);
    matmul(MatMut::from_column_major_slice_mut(&mut c, SMALL, SMALL), Accum::Replace, a, a, 1.0, Par::Seq);
    black_box(c);
    HELD.set(true);
    Ok(())
}

/// Largest number of bytes that the first product of a thread maps.
fn scratch() -> usize {
    static BYTES: OnceLock<usize> = OnceLock::new();
    *BYTES.get_or_init(|| {
        if cfg!(target_arch = "x86_64") {
            2 * caches(Path::new("/sys/devices/system/cpu")).map_or(UNKNOWN, |all| all.max(LEAST)).next_multiple_of(4096)
        } else {
            0
        }
    })
}

/// Bytes of the last-level caches of all processors below `folder`, or four times the inner ones if that is larger.
fn caches(folder: &Path) -> Option<usize> {
    let (mut processors, mut shares, mut inner) = (0, 0, 0);
    for processor in std::fs::read_dir(folder).ok()?.flatten() {
        let Ok(indices) = std::fs::read_dir(processor.path().join("cache")) else { continue };
        processors += 1;
        for index in indices.flatten() {
            let entry = |name: &str| std::fs::read_to_string(index.path().join(name)).ok();
            let Some((level, size)) = entry("level").zip(entry("size").as_deref().and_then(size)) else { continue };
            if level.trim() == "3" {
                shares = shares.max(size / entry("shared_cpu_list").map_or(1, |list| count(&list)).max(1));
            } else {
                inner = inner.max(size);
            }
        }
    }
    (processors > 0).then(|| (processors * shares).max(4 * inner))
}

/// Bytes of a text such as "512K".
fn size(text: &str) -> Option<usize> {
    let text = text.trim();
    let unit = match text.chars().last()? {
        'K' => 10,
        'M' => 20,
        'G' => 30,
        _ => 0,
    };
    text.trim_end_matches(['K', 'M', 'G']).parse::<usize>().ok()?.checked_mul(1 << unit)
}

/// Numbers in a list such as "0-3,8,10-11".
fn count(list: &str) -> usize {
    let number = |text: &str| text.trim().parse::<usize>().ok();
    let of = |item: &str| match item.split_once('-') {
        Some((first, last)) => number(last).zip(number(first)).map_or(0, |(last, first)| (last + 1).saturating_sub(first)),
        None => usize::from(number(item).is_some()),
    };
    list.split(',').map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_lists_of_processors_are_read() {
        assert_eq!(
            [size("32K\n"), size("32768K"), size("1G"), size("64"), size("x")].map(|s| s.unwrap_or(0)),
            [32 << 10, 32 << 20, 1 << 30, 64, 0]
        );
        assert_eq!([count("0-1\n"), count("0-3,8,10-11"), count("")], [2, 7, 0]);
    }

    /// Address space of this process in bytes, if the system reports it.
    #[cfg(target_os = "linux")]
    fn mapped() -> usize {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|l| l.strip_prefix("VmSize:")).unwrap();
        line.split_whitespace().next().unwrap().parse::<usize>().unwrap() << 10
    }

    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    #[test]
    fn a_thread_takes_no_more_than_is_tried_and_takes_it_once() {
        let (before, limit) = (mapped(), scratch() + BESIDE);
        std::thread::spawn(move || {
            take().unwrap();
            let held = mapped();
            assert!(held - before < limit + (70 << 20), "{held} - {before} against {limit}: beside the heap of a thread");
            let n = 300;
            let (a, mut c) = (vec![1.0; n * n], vec![0.0; n * n]);
            let a = MatRef::from_column_major_slice(&a, n, n);
            matmul(MatMut::from_column_major_slice_mut(&mut c, n, n), Accum::Replace, a, a, 1.0, Par::Seq);
            assert!(c.iter().all(|&v| v == n as f64) && mapped() - held < 40 << 20);
        })
        .join()
        .unwrap();
    }
}
