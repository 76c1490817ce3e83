//! Multiplier spaces of slave sides.

use super::model::{Model, SideModel};
use crate::basis::{Basis, Extracted, Order, ShapeTable};
use crate::coupling::Segments;
use crate::coupling::multiplier::{self, MultiplierError, MultiplierKind, side_ends};
use crate::linalg::Vector;
use crate::space::Trace;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

/// Makes the multiplier space of one component on a slave side; the closure returns whether a function of the body is constrained in that
/// component.
pub type MakeMultiplier<'a, const S: usize, const N: usize> =
    dyn Fn(&Trace<S, N>, &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<S>>, MultiplierError> + Send + Sync + 'a;
/// Dual multipliers of a contact, and the functions by which their pressure is evaluated.
pub type DualPair<const S: usize> = (Box<dyn Basis<S>>, Box<dyn Basis<S>>);
/// Makes dual multipliers over the part of a slave side that the segments cover; the closure is that of [`MakeMultiplier`].
pub type MakeCovered<const S: usize, const N: usize> =
    fn(&Trace<S, N>, &dyn Fn(usize) -> bool, &Segments<S>) -> Result<DualPair<S>, MultiplierError>;
/// Gives functions of a multiplier that live on slivers of what the segments cover to their neighbours.
pub type CutMultiplier<const S: usize, const N: usize> = fn(Box<dyn Basis<S>>, &Trace<S, N>, &Segments<S>) -> Box<dyn Basis<S>>;

/// The multiplier `kind` on a curve; an end is constrained if a function that does not vanish there is.
///
/// # Errors
/// [`MultiplierError`] if there is none of this kind.
pub fn curve_multiplier<const N: usize>(
    kind: MultiplierKind,
    trace: &Trace<1, N>,
    constrained: &dyn Fn(usize) -> bool,
) -> Result<Box<dyn Basis<1>>, MultiplierError> {
    multiplier::build(&trace.space, kind, &constrained_ends(trace, constrained))
}

/// Dual multipliers of a contact on a curve, see [`MakeCovered`].
///
/// # Errors
/// [`MultiplierError`] if there are none.
pub fn covered_dual<const N: usize>(
    trace: &Trace<1, N>,
    constrained: &dyn Fn(usize) -> bool,
    segments: &Segments<1>,
) -> Result<DualPair<1>, MultiplierError> {
    let made = multiplier::build_covered(&trace.space, &constrained_ends(trace, constrained), segments)?;
    Ok((Box::new(made.functions), Box::new(made.reading)))
}

/// Returns, per end of a curve, whether a function that does not vanish there is constrained.
fn constrained_ends<const N: usize>(trace: &Trace<1, N>, constrained: &dyn Fn(usize) -> bool) -> Vec<bool> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    side_ends(&*trace.space)
        .iter()
        .map(|end| {
            trace.space.active(end.element, &mut ids);
            trace.space.tabulate(end.element, &[Vector::<1>::new(end.at as f64)], Order::Values, &mut table);
            ids.iter().zip(table.values(0)).any(|(&i, value)| value.abs() > NO_VALUE && constrained(trace.dofs[i]))
        })
        .collect()
}

/// Returns `psi` on a side that is glued to itself: its functions that belong to one function of the trace where the side closes become
/// one. Multipliers with as many functions as the closed trace, or fewer, have no end there and stay as they are. A multiplier numbered
/// like the trace follows the numbers of the trace; of any other, functions that are the only nonzero ones at a corner are matched.
pub fn wrapped<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &SideModel<S, N>,
    constrained: &dyn Fn(usize) -> bool,
    psi: Box<dyn Basis<S>>,
) -> Box<dyn Basis<S>> {
    let space = &*slave.trace.space;
    let whole: HashSet<usize> = slave.trace.dofs.iter().map(|&dof| model.function(slave.patch, dof)).collect();
    if whole.len() == slave.trace.dofs.len() || psi.num_functions() <= whole.len() {
        return psi;
    }
    let (mut ids, mut others, mut table) = (Vec::new(), Vec::new(), ShapeTable::new());
    let numbered_alike = psi.num_functions() == space.num_functions()
        && (0..space.num_elements()).all(|element| {
            space.active(element, &mut ids);
            psi.active(element, &mut others);
            ids == others
        });
    let mut alone = |basis: &dyn Basis<S>, element: usize, corner: &Vector<S>| {
        basis.active(element, &mut ids);
        basis.tabulate(element, std::slice::from_ref(corner), Order::Values, &mut table);
        let mut there = ids.iter().zip(table.values(0)).filter(|(_, value)| value.abs() > NO_VALUE).map(|(&i, _)| i);
        there.next().filter(|_| there.next().is_none())
    };
    // the multiplier of a function of the model, if both are the only nonzero ones at a corner
    let mut first: HashMap<usize, usize> = HashMap::new();
    let mut twin: BTreeMap<usize, usize> = BTreeMap::new();
    for element in 0..space.num_elements() {
        for k in 0..1usize << S {
            let corner = Vector::<S>::from_fn(|d, _| f64::from(u8::from(k >> d & 1 == 1)));
            let Some(i) = alone(&space, element, &corner).filter(|&i| !constrained(slave.trace.dofs[i])) else { continue };
            let Some(j) = Some(i).filter(|_| numbered_alike).or_else(|| alone(&*psi, element, &corner)) else { continue };
            let one = *first.entry(model.function(slave.patch, slave.trace.dofs[i])).or_insert(j);
            if one != j {
                twin.insert(j, one);
            }
        }
    }
    let mut next = 0;
    let mut number = vec![0; psi.num_functions()];
    for (j, n) in number.iter_mut().enumerate() {
        if !twin.contains_key(&j) {
            *n = next;
            next += 1;
        }
    }
    let rows = (0..number.len()).map(|j| vec![(number[*twin.get(&j).unwrap_or(&j)], 1.0)]).collect();
    if twin.is_empty() { psi } else { Box::new(Extracted::new::<S>(psi, next, rows)) }
}
