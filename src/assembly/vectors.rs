//! Vectors of unknowns as sums over elements, for any space.

use super::scratch::Scratch;
use crate::linalg::{Real, Vector};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Elements of one task, and tasks whose results are held at a time.
const ELEMENTS_PER_TASK: usize = 64;
const TASKS_AT_ONCE: usize = 64;

/// Ids and values of the functions of some elements, and what the kernel returns for each element.
type Part<const C: usize, T, R> = (Vec<usize>, Vec<Vector<C, T>>, Vec<R>);

/// Adds the element vectors of `kernel`, C numbers per function, to `y`, elements ascending; returns its results in that order.
pub(super) fn add_elements<const C: usize, const N: usize, T, S, Q, R>(
    space: &S,
    quadrature: &Q,
    kernel: impl Fn(&mut Scratch<N, N, T>, &mut [Vector<C, T>]) -> R + Sync,
    y: &mut [T],
) -> Vec<R>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
    R: Send,
{
    let elements: Vec<usize> = (0..space.num_elements()).collect();
    let mut results = Vec::with_capacity(elements.len());
    for block in elements.chunks(ELEMENTS_PER_TASK * TASKS_AT_ONCE) {
        let parts: Vec<Part<C, T, R>> = parallel::map_ranges(block.len(), ELEMENTS_PER_TASK, |chunk| {
            let chunk = &block[chunk];
            let mut scratch = Scratch::<N, N, T>::default();
            let (mut ids, mut values, mut results) = (Vec::new(), Vec::new(), Vec::with_capacity(chunk.len()));
            for &e in chunk {
                scratch.gradients(space, e, quadrature.rule(e));
                let first = ids.len();
                ids.extend_from_slice(&scratch.ids);
                values.resize(ids.len(), Vector::zeros());
                results.push(kernel(&mut scratch, &mut values[first..]));
            }
            (ids, values, results)
        });
        for (ids, values, own) in parts {
            for (&i, value) in ids.iter().zip(&values) {
                for c in 0..C {
                    y[C * i + c] += value[c];
                }
            }
            results.extend(own);
        }
    }
    results
}
