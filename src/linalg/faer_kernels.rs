//! Memory that dense products take beside their operands, found out before they take it.
//!
//! On x86-64 the first product of a thread maps twice the caches of the last level, those of all cores together, and touches as much as
//! its operands fill. Where the address space is limited that may be all of it, and the library ends the program.

use super::LinearError;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use std::cell::Cell;
use std::hint::black_box;
use std::path::Path;
use std::sync::OnceLock;

/// Bytes that have to be left beside: vectors, results, files.
const BESIDE: usize = 16 << 20;
/// Least caches of the last level that are counted with, and what they are taken for where the system does not say them \[bytes\].
const LEAST: usize = 2 << 20;
const UNKNOWN: usize = 128 << 20;
/// Rows and columns of a product that takes the memory.
const SMALL: usize = 64;

thread_local! {
    /// Whether this thread has the memory.
    static HELD: Cell<bool> = const { Cell::new(false) };
}

/// Takes the memory of dense products for this thread, unless it has it.
///
/// # Errors
/// [`LinearError::Memory`] where there is none.
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

/// Bytes that the first product of a thread maps, at most.
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

/// Bytes of the caches of the last level of all processors below `folder`; four times the inner ones where these are larger.
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

    /// Address space of this process in bytes, where the system says it.
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
