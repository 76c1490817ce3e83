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
//!
//! At a pole a function has the support of all the functions beside it together: a multiplier that got it whole would be n times as wide as
//! the function of its own, and the inf-sup constant would fall like n^(-1/2). There every element has its own part of psi_j and its own heir.
//! Source: the idea is that of C. Kim, R. Lazarov, J. Pasciak, P. Vassilevski, SIAM J. Numer. Anal. 39 (2001) 519-538, who give equal
//! shares to all free neighbours; one heir keeps the functions independent on every element.

use super::MultiplierError;
use crate::basis::{Basis, Cell, Elements, Extracted, Order, ShapeTable};
use crate::linalg::{Real, Vector};
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Most elements around a vertex at which a function is given to one heir: a regular triangulation has six.
const AROUND: usize = 6;

/// `psi` without the functions that are `constrained`.
///
/// # Errors
/// [`MultiplierError::NothingFree`] where all functions are constrained that elements join.
pub(super) fn handed_on<T: Real>(psi: Box<dyn Basis<2, T>>, constrained: &[bool]) -> Result<Box<dyn Basis<2, T>>, MultiplierError> {
    let own = Divided::wide(&*psi, constrained);
    if own.is_empty() {
        return to_heirs(psi, constrained);
    }
    let mut constrained = constrained.to_vec();
    constrained.resize(psi.num_functions() + own.len(), true);
    to_heirs(Box::new(Divided { of: psi, own, functions: constrained.len() }), &constrained)
}

/// A basis of which some functions are divided into their parts on single elements.
#[derive(Debug)]
struct Divided<T: Real> {
    of: Box<dyn Basis<2, T>>,
    /// The number of the part of a function on an element; the first part of each keeps the number of the function.
    own: BTreeMap<(usize, usize), usize>,
    functions: usize,
}

impl<T: Real> Divided<T> {
    /// The parts of the constrained functions of `psi` with more than [`AROUND`] elements around a vertex, but for their first ones.
    fn wide(psi: &dyn Basis<2, T>, constrained: &[bool]) -> BTreeMap<(usize, usize), usize> {
        let (mut elements, mut ids) = (BTreeMap::<usize, Vec<usize>>::new(), Vec::new());
        for e in 0..psi.num_elements() {
            psi.active(e, &mut ids);
            ids.iter().filter(|&&j| constrained[j]).for_each(|&j| elements.entry(j).or_default().push(e));
        }
        // splines of degree p have (p + 1)^2 elements without a pole
        let most = |e: usize| AROUND.max(psi.degree(e).iter().map(|p| p + 1).product());
        let wide = elements.into_iter().filter(|(_, all)| all.len() > all.iter().map(|&e| most(e)).max().unwrap_or(0));
        let parts = wide.flat_map(|(j, all)| all.into_iter().skip(1).map(move |e| (e, j)));
        parts.enumerate().map(|(k, part)| (part, psi.num_functions() + k)).collect()
    }
}

impl<T: Real> Elements for Divided<T> {
    fn num_elements(&self) -> usize {
        self.of.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.of.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.of.corners(element, ids);
    }
}

impl<T: Real> Basis<2, T> for Divided<T> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, element: usize) -> [usize; 2] {
        self.of.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.of.active(element, ids);
        for j in ids {
            *j = self.own.get(&(element, *j)).copied().unwrap_or(*j);
        }
    }
    fn tabulate(&self, element: usize, xi: &[Vector<2, T>], order: Order, table: &mut ShapeTable<2, T>) {
        self.of.tabulate(element, xi, order, table);
    }
}

/// `psi` without the `constrained` functions, each of them given to an heir.
fn to_heirs<T: Real>(psi: Box<dyn Basis<2, T>>, constrained: &[bool]) -> Result<Box<dyn Basis<2, T>>, MultiplierError> {
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
