//! Loops over the threads of rayon's pool. What a loop does is called by reference, so that the sharing of work is compiled once and not again
//! for every loop, dimension and scalar.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Pieces of a list per thread: enough to even out pieces of unlike cost.
const PIECES_PER_THREAD: usize = 8;

/// Calls `task` once with every number below `count`, in no order.
fn run(count: usize, task: &(dyn Fn(usize) + Sync)) {
    fn halves(range: Range<usize>, task: &(dyn Fn(usize) + Sync)) {
        let middle = range.start + range.len() / 2;
        match range.len() {
            0 => {}
            1 => task(range.start),
            _ => drop(rayon::join(|| halves(range.start..middle, task), || halves(middle..range.end, task))),
        }
    }
    if rayon::current_num_threads() == 1 {
        (0..count).for_each(task);
    } else {
        halves(0..count, task);
    }
}

/// The values of two calls, made at the same time where there are threads.
pub(crate) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    if rayon::current_num_threads() == 1 { (a(), b()) } else { rayon::join(a, b) }
}

fn lock<X>(mutex: &Mutex<X>) -> MutexGuard<'_, X> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls `work` with every item of `tasks`, which should be few and large: threads take them one by one, in their order.
pub(crate) fn for_each<X: Send>(tasks: impl ExactSizeIterator<Item = X> + Send, work: impl Fn(X) + Sync) {
    let count = tasks.len();
    let tasks = Mutex::new(tasks);
    run(count, &|_| {
        let task = lock(&tasks).next();
        task.into_iter().for_each(&work);
    });
}

/// The values of `of` for the items of `tasks`, in their order; as [`for_each`].
pub(crate) fn map_each<X: Send, R: Send>(tasks: impl ExactSizeIterator<Item = X> + Send, of: impl Fn(X) -> R + Sync) -> Vec<R> {
    let found: Vec<Mutex<Option<R>>> = (0..tasks.len()).map(|_| Mutex::new(None)).collect();
    for_each(tasks.zip(&found), |(task, place)| {
        let value = of(task);
        *lock(place) = Some(value);
    });
    let mut all = Vec::with_capacity(found.len());
    for place in found {
        all.extend(place.into_inner().unwrap_or_else(PoisonError::into_inner));
    }
    all
}

/// The values of `of` for 0..count cut into ranges of `size` numbers, in their order.
pub(crate) fn map_ranges<R: Send>(count: usize, size: usize, of: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    map_each((0..count.div_ceil(size)).map(|piece| piece * size..((piece + 1) * size).min(count)), of)
}

/// Number of items of similar cost that make a task, of `count` in all; at least one.
pub(crate) fn piece_size(count: usize) -> usize {
    let threads = rayon::current_num_threads();
    count.div_ceil(if threads == 1 { 1 } else { PIECES_PER_THREAD * threads }).max(1)
}

/// The values of `of` at 0..count, in this order.
pub(crate) fn map<R: Send>(count: usize, of: impl Fn(usize) -> R + Sync) -> Vec<R> {
    map_init(count, || (), |(), k| of(k))
}

/// The values of `of` at 0..count, in this order; `memory` makes what a thread keeps from one call to the next.
pub(crate) fn map_init<W, R: Send>(count: usize, memory: impl Fn() -> W + Sync, of: impl Fn(&mut W, usize) -> R + Sync) -> Vec<R> {
    let pieces = map_ranges(count, piece_size(count), |range| {
        let mut memory = memory();
        range.map(|k| of(&mut memory, k)).collect::<Vec<R>>()
    });
    let mut all = Vec::with_capacity(count);
    pieces.into_iter().for_each(|mut own| all.append(&mut own));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_is_done_once_and_values_keep_their_order() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            for count in [0, 1, 2, 17, 1000] {
                let (squares, mut marks) = pool.install(|| {
                    let mut marks = vec![0usize; count];
                    for_each(marks.iter_mut().enumerate(), |(k, mark)| *mark += k + 1);
                    (map_init(count, Vec::new, |seen: &mut Vec<usize>, k| (seen.push(k), k * k).1), marks)
                });
                assert_eq!(squares, (0..count).map(|k| k * k).collect::<Vec<_>>());
                marks.iter_mut().enumerate().for_each(|(k, mark)| *mark -= k + 1);
                assert_eq!(marks, vec![0; count]);
                assert_eq!(pool.install(|| both(|| count, || map(count, |k| k).len())), (count, count));
            }
        }
    }
}
