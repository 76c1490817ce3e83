//! Multiplier spaces of slave sides.

use super::model::{BodySide, Model};
use super::seam_edges::seam_twins;
use crate::basis::{Basis, Extracted, Order, Polynomials, ShapeTable};
use crate::coupling::multiplier::{MultiplierError, has_triangles, least_degree, numbered_alike, side_ends};
use crate::linalg::Vector;
use crate::space::{Space, Trace};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

/// Makes the multiplier space of one component on a slave side; the closure returns whether a function of the body is constrained in that
/// component.
pub type MakeMultiplier<const S: usize, const N: usize> =
    dyn Fn(&Trace<S, N>, &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<S>>, MultiplierError> + Send + Sync;
/// Dual multipliers of a contact, and the functions by which their pressure is evaluated.
pub type DualBases<const S: usize> = (Box<dyn Basis<S>>, Box<dyn Basis<S>>);
/// Returns, per end of a curve, whether a function that does not vanish there is constrained.
pub(super) fn constrained_ends<const S: usize, const N: usize>(trace: &Trace<S, N>, constrained: &dyn Fn(usize) -> bool) -> Vec<bool> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    side_ends(&*trace.space)
        .iter()
        .map(|end| {
            trace.space.active(end.element, &mut ids);
            trace.space.tabulate(end.element, &[Vector::<S>::repeat(end.at as f64)], Order::Values, &mut table);
            ids.iter().zip(table.values(0)).any(|(&i, value)| value.abs() > NO_VALUE && constrained(trace.dofs[i]))
        })
        .collect()
}

/// The degree of the side and k, if `psi` is the unstable pairing p/p-k of `space` under another name: constants, or polynomials given by
/// degree.
///
/// k = 1 is unstable on every side of tensor cells, k = 3, 5, ... on those of splines with one function per element: continuous
/// functions of degree 3 have bubbles enough for constants. On triangles polynomials that jump from one to the next need the bubbles of
/// each, of degree p - 3; continuous ones are part of the space of the trace.
pub(super) fn unstable_pairing<const S: usize, const N: usize>(space: &dyn Space<S, N>, psi: &dyn Basis<S>) -> Option<(usize, usize)> {
    let basis: &dyn Basis<S> = space;
    let (degree, highest) = (least_degree(basis), (0..psi.num_elements()).flat_map(|e| psi.degree(e)).max()?);
    let lowered = degree.checked_sub(highest)?;
    if has_triangles(basis) {
        let mut ids = Vec::new();
        let mut own = |e: usize| {
            psi.active(e, &mut ids);
            ids.len()
        };
        let jumps = (0..psi.num_elements()).map(&mut own).sum::<usize>() == psi.num_functions();
        return (jumps && lowered < 3).then_some((degree, lowered));
    }
    let smooth = || {
        let grow = |axis: &dyn Basis<1>| axis.num_functions() == axis.num_elements() + axis.degree(0)[0];
        space.structure().block(0).is_some_and(|b| b.axes.iter().all(|axis| grow(*axis)))
    };
    let unstable = lowered == 1 || (lowered % 2 == 1 && smooth());
    let same = space.polynomials(Polynomials::Lowered(lowered)).is_none_or(|named| named.num_functions() == psi.num_functions());
    (unstable && same).then_some((degree, lowered))
}

/// Returns `psi` on a side that is glued to itself: its functions that belong to one function of the trace where the side closes become
/// one. Multipliers of curves with as many functions as the closed trace, or fewer, but for those lost at constrained ends, have no end there and stay as they are, as do those of
/// surfaces of another degree than the trace. A multiplier numbered like the trace, or like its free functions, follows the numbers of the trace;
/// of any other, functions are matched that are the only nonzero ones at a corner of a curve, or that have the same values along an edge of a
/// surface.
pub fn wrapped<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &BodySide<S, N>,
    constrained: &dyn Fn(usize) -> bool,
    psi: Box<dyn Basis<S>>,
) -> Box<dyn Basis<S>> {
    let (space, dofs) = (&*slave.trace.space, &slave.trace.dofs);
    let whole: HashSet<usize> = dofs.iter().map(|&dof| model.function(slave.patch, dof)).collect();
    // what a part across the seam lost at its own ends is no seam that is closed
    let lost = || if S == 1 && highest(&*psi) == highest(space) { lowered_ends(slave, constrained) } else { 0 };
    if whole.len() == dofs.len() || (S == 1 && psi.num_functions() + lost() <= whole.len()) {
        return psi;
    }
    if numbered_alike(&*psi, space) {
        return wrapped_in_order(model, slave, constrained, psi);
    }
    let free: Vec<usize> = (0..dofs.len()).filter(|&i| !constrained(dofs[i])).collect();
    if S > 1 && numbered_as(&*psi, space, &free) {
        return merged(psi, &twins(model, slave, free.into_iter().enumerate().map(|(j, i)| (i, j))));
    }
    let twin = if S == 1 { corner_twins(model, slave, constrained, &*psi) } else { seam_twins(model, slave, &*psi) };
    merged(psi, &twin)
}

/// The highest degree of the elements.
fn highest<const S: usize>(basis: &dyn Basis<S>) -> usize {
    (0..basis.num_elements()).flat_map(|e| basis.degree(e)).max().unwrap_or(0)
}

/// The number of constrained ends of a curve.
fn lowered_ends<const S: usize, const N: usize>(slave: &BodySide<S, N>, constrained: &dyn Fn(usize) -> bool) -> usize {
    constrained_ends(&slave.trace, constrained).into_iter().filter(|is_constrained| *is_constrained).count()
}

/// Multipliers whose numbers have the order of the functions of the trace, with those of functions joined where the side is glued to itself:
/// on an element where every function of the trace has one they are known.
pub fn wrapped_in_order<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &BodySide<S, N>,
    constrained: &dyn Fn(usize) -> bool,
    psi: Box<dyn Basis<S>>,
) -> Box<dyn Basis<S>> {
    let (space, dofs) = (&*slave.trace.space, &slave.trace.dofs);
    let (mut ids, mut own) = (Vec::new(), Vec::new());
    let mut of: BTreeMap<usize, usize> = BTreeMap::new();
    for element in 0..space.num_elements() {
        space.active(element, &mut ids);
        psi.active(element, &mut own);
        if ids.len() == own.len() {
            ids.sort_unstable();
            own.sort_unstable();
            of.extend(ids.iter().copied().zip(own.iter().copied()));
        }
    }
    merged(psi, &twins(model, slave, of.into_iter().filter(|(i, _)| !constrained(dofs[*i]))))
}

/// The multipliers whose place another one takes, and that one: of functions of the trace that are one function of the model. Pairs of a function
/// and its multiplier.
fn twins<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &BodySide<S, N>,
    of: impl Iterator<Item = (usize, usize)>,
) -> BTreeMap<usize, usize> {
    let mut first: HashMap<usize, usize> = HashMap::new();
    let pairs = of.map(|(i, j)| (j, *first.entry(model.function(slave.patch, slave.trace.dofs[i])).or_insert(j)));
    pairs.filter(|(j, one)| j != one).collect()
}

/// Whether `psi` has a function for each of the `free` ones of the trace, in their order: multipliers of other functions may have been given to it,
/// so that it has all elements of its function, and others.
fn numbered_as<const S: usize, const N: usize>(psi: &dyn Basis<S>, space: &dyn Space<S, N>, free: &[usize]) -> bool {
    let number: HashMap<usize, usize> = free.iter().enumerate().map(|(j, &i)| (i, j)).collect();
    let (mut ids, mut own) = (Vec::new(), Vec::new());
    psi.num_functions() == free.len()
        && (0..space.num_elements()).all(|element| {
            space.active(element, &mut ids);
            psi.active(element, &mut own);
            own.len() <= ids.len() && ids.iter().filter_map(|i| number.get(i)).all(|j| own.contains(j))
        })
}

/// The functions of `psi`, of which those that have a twin are added to it.
fn merged<const S: usize>(psi: Box<dyn Basis<S>>, twin: &BTreeMap<usize, usize>) -> Box<dyn Basis<S>> {
    if twin.is_empty() {
        return psi;
    }
    let mut next = 0;
    let mut number = vec![0; psi.num_functions()];
    for (j, n) in number.iter_mut().enumerate() {
        if !twin.contains_key(&j) {
            *n = next;
            next += 1;
        }
    }
    // where a surface closes in both directions, corners are joined twice
    let root = |j: usize| std::iter::successors(Some(j), |j| twin.get(j).copied()).last().unwrap_or(j);
    let rows = (0..number.len()).map(|j| vec![(number[root(j)], 1.0)]).collect();
    Box::new(Extracted::new::<S>(psi, next, rows))
}

/// The function that takes the place of another one, if both are the only nonzero ones where the ends of a curve are glued.
fn corner_twins<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &BodySide<S, N>,
    constrained: &dyn Fn(usize) -> bool,
    psi: &dyn Basis<S>,
) -> BTreeMap<usize, usize> {
    let space = &*slave.trace.space;
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    let mut alone = |basis: &dyn Basis<S>, element: usize, corner: &Vector<S>| {
        basis.active(element, &mut ids);
        basis.tabulate(element, std::slice::from_ref(corner), Order::Values, &mut table);
        let mut there = ids.iter().zip(table.values(0)).filter(|(_, value)| value.abs() > NO_VALUE).map(|(&i, _)| i);
        there.next().filter(|_| there.next().is_none())
    };
    // the multiplier of a function of the model, if both are the only nonzero ones at an end
    let mut first: HashMap<usize, usize> = HashMap::new();
    let mut twin = BTreeMap::new();
    for element in 0..space.num_elements() {
        for end in [0.0, 1.0] {
            let corner = Vector::<S>::repeat(end);
            let Some(i) = alone(&space, element, &corner).filter(|&i| !constrained(slave.trace.dofs[i])) else { continue };
            let Some(j) = alone(psi, element, &corner) else { continue };
            let one = *first.entry(model.function(slave.patch, slave.trace.dofs[i])).or_insert(j);
            if one != j {
                twin.insert(j, one);
            }
        }
    }
    twin
}
