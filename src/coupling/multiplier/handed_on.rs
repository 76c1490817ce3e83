//! Multipliers of constrained functions, given to functions beside them.
//!
//! Let psi be numbered as the functions N of the side. Every constrained function j gives its multiplier to one free function, its heir:
//!
//! ```text
//! psi_i' = psi_i + sum of psi_j over the constrained j whose heir is i
//! ```
//!
//! The heir is the free function with which j shares most elements, of several the one with fewest others, then the least number. Where all
//! functions on the elements of j are constrained (a triangle in a corner), it is the heir of a neighbour. The psi_i' are not negative where
//! the psi_i are not, independent on every element, and sum to one; they hold constants along what is constrained, and all that the psi hold
//! away from it.
//! Source: the idea is that of C. Kim, R. Lazarov, J. Pasciak, P. Vassilevski, SIAM J. Numer. Anal. 39 (2001) 519-538, who give equal
//! shares to all free neighbours; one heir keeps the functions independent on every element.

use super::MultiplierError;
use crate::basis::{Basis, Extracted};
use crate::linalg::Real;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// `psi` without the functions that are `constrained`.
///
/// # Errors
/// [`MultiplierError::NothingFree`] where all functions are constrained that elements join.
pub(super) fn handed_on<T: Real>(psi: Box<dyn Basis<2, T>>, constrained: &[bool]) -> Result<Box<dyn Basis<2, T>>, MultiplierError> {
    let mut heir: Vec<Option<usize>> = constrained.iter().enumerate().map(|(i, &held)| (!held).then_some(i)).collect();
    let beside = neighbours(&*psi, constrained);
    let mut given = vec![0; heir.len()];
    let mut left: Vec<usize> = beside.keys().copied().collect();
    // from the free functions outwards, layer by layer
    while !left.is_empty() {
        let known = heir.clone();
        for &j in &left {
            let of = |(&i, &elements): (&usize, &usize)| Some((known[i]?, elements));
            let own = beside[&j].iter().filter_map(of);
            let chosen = own.max_by_key(|&(i, elements)| (elements, Reverse(given[i]), Reverse(i))).map(|(i, _)| i);
            chosen.iter().for_each(|&i| given[i] += 1);
            heir[j] = chosen;
        }
        let before = left.len();
        left.retain(|&j| heir[j].is_none());
        if left.len() == before {
            return Err(MultiplierError::NothingFree);
        }
    }
    let (mut number, mut functions) = (Vec::with_capacity(heir.len()), 0);
    for &held in constrained {
        number.push(functions);
        functions += usize::from(!held);
    }
    let rows = heir.into_iter().flatten().map(|i| vec![(number[i], T::one())]).collect();
    Ok(Box::new(Extracted::new::<2>(psi, functions, rows)))
}

/// The functions on the elements of every constrained function, but for itself, with the number of common elements.
fn neighbours<T: Real>(psi: &dyn Basis<2, T>, constrained: &[bool]) -> BTreeMap<usize, BTreeMap<usize, usize>> {
    let (mut beside, mut ids) = (BTreeMap::<usize, BTreeMap<usize, usize>>::new(), Vec::new());
    for e in 0..psi.num_elements() {
        psi.active(e, &mut ids);
        for &j in ids.iter().filter(|&&j| constrained[j]) {
            let own = beside.entry(j).or_default();
            ids.iter().filter(|&&i| i != j).for_each(|&i| *own.entry(i).or_default() += 1);
        }
    }
    beside
}
