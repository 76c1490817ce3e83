//! The numbers that functions of patches have in a basis, checked.

use crate::basis::{Basis, TensorPatch};
use crate::linalg::Real;

/// The patches of `basis`, or the one block that covers it; `None` where they do not cover all elements, or where the basis
/// numbers its functions in another way than they say.
///
/// What patches say is trusted by everything that follows, so it is checked on elements that reach every function.
pub(in crate::assembly) fn patches<const N: usize, T: Real, B: Basis<N, T> + ?Sized>(basis: &B) -> Option<Vec<TensorPatch<'_, N, T>>> {
    let (elements, functions) = (basis.num_elements(), basis.num_functions());
    if elements == 0 || u32::try_from(functions).is_err() {
        return None;
    }
    let parts = match basis.structure().patches() {
        Some(parts) => parts,
        None => {
            let block = basis.structure().block(0)?;
            let ids = (0..block.axes.iter().map(|a| a.num_functions()).product()).collect();
            vec![TensorPatch { block, ids }]
        }
    };
    let mut next = 0;
    for part in &parts {
        let counts = part.block.axes.map(|a| a.num_elements());
        if part.block.first != next || next + counts.iter().product::<usize>() > elements || !agrees(basis, part) {
            return None;
        }
        next += counts.iter().product::<usize>();
    }
    (next == elements).then_some(parts)
}

/// Whether `ids` are all functions in their order.
pub(in crate::assembly) fn is_whole(ids: &[usize], functions: usize) -> bool {
    ids.len() == functions && ids.iter().enumerate().all(|(i, &id)| i == id)
}

/// Whether the elements of a patch have the functions that its numbers say.
fn agrees<const N: usize, T: Real, B: Basis<N, T> + ?Sized>(basis: &B, part: &TensorPatch<'_, N, T>) -> bool {
    let (elements, functions) = (part.block.axes.map(|a| a.num_elements()), part.block.axes.map(|a| a.num_functions()));
    if part.ids.len() != functions.iter().product::<usize>() || part.ids.iter().any(|&id| id >= basis.num_functions()) {
        return false;
    }
    let mut ids = Vec::new();
    // (element, its first and last function) along every axis
    let reach = part.block.axes.map(|axis| {
        let (mut chosen, mut reached) = (Vec::new(), 0);
        let mut last = None;
        for e in 0..axis.num_elements() {
            axis.active(e, &mut ids);
            let (Some(&from), Some(&to)) = (ids.first(), ids.last()) else { continue };
            if from > reached {
                chosen.extend(last.take());
            }
            reached = chosen.last().map_or(0, |&(_, _, to): &(usize, usize, usize)| to + 1);
            last = Some((e, from, to));
        }
        chosen.extend(last);
        chosen
    });
    let (mut own, mut lines) = (Vec::new(), [0; N]);
    for chosen in 0..reach.iter().map(Vec::len).product() {
        let mut rest = chosen;
        for k in 0..N {
            lines[k] = rest % reach[k].len();
            rest /= reach[k].len();
        }
        let at: [(usize, usize, usize); N] = std::array::from_fn(|k| reach[k][lines[k]]);
        let element = (0..N).rev().fold(0, |e, k| e * elements[k] + at[k].0);
        own.clear();
        let widths = at.map(|(_, from, to)| to + 1 - from);
        for mut rest in 0..widths.iter().product() {
            let (mut id, mut stride) = (0, 1);
            for k in 0..N {
                id += stride * (at[k].1 + rest % widths[k]);
                (rest, stride) = (rest / widths[k], stride * functions[k]);
            }
            own.push(id);
        }
        if own.iter().any(|&i| i >= part.ids.len()) {
            return false;
        }
        own.iter_mut().for_each(|i| *i = part.ids[*i]);
        basis.active(part.block.first + element, &mut ids);
        ids.sort_unstable();
        own.sort_unstable();
        own.dedup();
        if own != ids {
            return false;
        }
    }
    true
}
