//! Multipliers of ties whose sides are apart by unlike distances from one function to the next, as facets of one curved surface are.
//!
//! With the points x of the slave and y of its partners, ties close the mean of the jump of a linear field u = a x per function psi_j of the
//! multiplier,
//!
//! ```text
//! a g_j,   g_j = ∫ |psi_j| (x - y) ds / ∫ |psi_j| ds.
//! ```
//!
//! A gap that is the same everywhere, or changes evenly, strains the bodies by little. What alternates from one function to the next, twice half of the
//! difference from the mean of the neighbours, has to be closed within the first cells, of the size h along the side and H across. Their
//! mode that alternates with h has the stiffness E (H/h + h/H) / (2 h), and the stress that it takes, as a share of E a, is about
//!
//! ```text
//! share = c rms_j |D D g|_j (H/h + h/H) / (2 h),   (D g)_j = (g_j - mean of g_i) / 2.
//! ```

use super::warning::{Subject, Warning};
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::{MapTable, cell};
use crate::linalg::{Vector, determinant, measure};
use crate::problem::model::{BodySide, Model, TiePart};
use crate::space::Space;
use std::collections::{BTreeSet, HashMap};

/// Share of the stress of linear fields above which the warning is given.
const SHARE: f64 = 0.1;
/// Stress over the root of the mean square, measured on arcs of chords of degree 1 with 4 to 128 elements: 13 to 18.
const STRESS: f64 = 14.0;
/// Stress over the root of the mean square of multipliers that jump between elements, which leave more to the bodies: 4 to 6.
const STRESS_OF_JUMPS: f64 = 5.0;

/// Finds the ties with such sides.
pub(super) fn uneven_gaps<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, tie) in model.ties.iter().enumerate() {
        let worst = tie.parts.iter().filter_map(|part| Some((share(model, part)?, part))).reduce(|a, b| if b.0 > a.0 { b } else { a });
        let told = worst.filter(|(share, _)| *share > SHARE);
        found.extend(told.map(|(share, part)| Warning::UnevenGap { of: Subject::tie(model, k), slave: part.slave.label.clone(), share }));
    }
    found
}

/// Sums of a function of a multiplier.
#[derive(Clone, Copy)]
struct FunctionGap<const N: usize> {
    /// ∫ |psi| ds.
    size: f64,
    /// ∫ |psi| (x - y) ds.
    gap: Vector<N>,
    /// ∫ |psi| (H/h + h/H) / (2 h) ds.
    stiffness: f64,
}

/// The stress that uneven gaps of a part of a tie take over that of linear fields; `None` without a multiplier.
fn share<const S: usize, const N: usize>(model: &Model<S, N>, part: &TiePart<S, N>) -> Option<f64> {
    let psi = &**part.multipliers.first()?;
    let sums = function_gaps(model, part, psi);
    let (jumps, beside) = beside(psi, &*part.slave.trace.space);
    // half of what differs from the neighbours: all of what alternates
    let uneven = |values: Vec<Vector<N>>| -> Vec<Vector<N>> {
        let of = |(value, others): (&Vector<N>, &Vec<usize>)| match others.len() {
            0 => Vector::zeros(),
            n => (value - others.iter().map(|&i| values[i]).sum::<Vector<N>>() / n as f64) / 2.0,
        };
        values.iter().zip(&beside).map(of).collect()
    };
    let gaps = sums.iter().map(|of| if of.size > 0.0 { of.gap / of.size } else { Vector::zeros() }).collect();
    let (mut sum, mut size) = (0.0, 0.0);
    for (of, rest) in sums.iter().zip(uneven(uneven(gaps))).filter(|(of, _)| of.size > 0.0) {
        sum += of.size * (rest.norm() * of.stiffness / of.size).powi(2);
        size += of.size;
    }
    let stress = if jumps { STRESS_OF_JUMPS } else { STRESS };
    (size > 0.0).then(|| stress * (sum / size).sqrt())
}

fn function_gaps<const S: usize, const N: usize>(model: &Model<S, N>, part: &TiePart<S, N>, psi: &dyn Basis<S>) -> Vec<FunctionGap<N>> {
    let slave = &*part.slave.trace.space;
    let mut sums = vec![FunctionGap { size: 0.0, gap: Vector::zeros(), stiffness: 0.0 }; psi.num_functions()];
    let (mut ids, mut shapes, mut own, mut other) = (Vec::new(), ShapeTable::new(), MapTable::new(), MapTable::new());
    let stiffness: Vec<f64> = (0..slave.num_elements()).map(|e| stiffness(model, &part.slave, e)).collect();
    for pairing in &part.pairings {
        let s = &pairing.segments;
        for piece in 0..s.num_pieces() {
            let (element, points) = (s.slave[piece], s.points(piece));
            slave.map(element, &s.slave_xi[points.clone()], Order::Values, &mut own);
            pairing.master.trace.space.map(s.master[piece], &s.master_xi[points.clone()], Order::Values, &mut other);
            psi.active(element, &mut ids);
            psi.tabulate(element, &s.slave_xi[points.clone()], Order::Values, &mut shapes);
            for (i, q) in points.enumerate() {
                for (&j, value) in ids.iter().zip(shapes.values(i)) {
                    let weight = value.abs() * s.ds[q];
                    sums[j].size += weight;
                    sums[j].gap += (own.x[i] - other.x[i]) * weight;
                    sums[j].stiffness += stiffness[element] * weight;
                }
            }
        }
    }
    sums
}

/// Whether all functions have one element alone, and the functions beside each: those on its elements, or where all have one alone those on
/// elements that share a function of the side with it.
fn beside<const S: usize, const N: usize>(psi: &dyn Basis<S>, side: &dyn Space<S, N>) -> (bool, Vec<Vec<usize>>) {
    let of = |basis: &dyn Basis<S>| -> Vec<Vec<usize>> {
        let active = |e: usize| {
            let mut ids = Vec::new();
            basis.active(e, &mut ids);
            ids
        };
        (0..basis.num_elements()).map(active).collect()
    };
    let own = of(psi);
    let jumps = own.iter().map(Vec::len).sum::<usize>() == psi.num_functions();
    // elements with a function in common
    let mut common: HashMap<usize, Vec<usize>> = HashMap::new();
    let links = if jumps { of(side) } else { own.clone() };
    links.iter().enumerate().for_each(|(e, ids)| ids.iter().for_each(|&i| common.entry(i).or_default().push(e)));
    let mut beside = vec![BTreeSet::new(); psi.num_functions()];
    for (e, ids) in links.iter().enumerate() {
        let near: BTreeSet<usize> = if jumps { ids.iter().flat_map(|i| &common[i]).copied().collect() } else { BTreeSet::from([e]) };
        own[e].iter().for_each(|&j| beside[j].extend(near.iter().flat_map(|&other| &own[other])));
    }
    (jumps, beside.into_iter().enumerate().map(|(j, others)| others.into_iter().filter(|&i| i != j).collect()).collect())
}

/// (H/h + h/H) / (2 h) of the cell behind an element of a side [1/length].
fn stiffness<const S: usize, const N: usize>(model: &Model<S, N>, side: &BodySide<S, N>, element: usize) -> f64 {
    let (space, facet) = (&side.trace.space, &side.trace.facets[element]);
    let center = cell::center::<S, f64>(space.cell(element));
    let (mut own, mut body) = (MapTable::new(), MapTable::new());
    space.map(element, &[center], Order::Gradients, &mut own);
    model.patches[side.patch_of(element)].body.space().map(facet.element, &[facet.lift(&center)], Order::Gradients, &mut body);
    let area = measure(&own.jacobian[0]);
    let (along, across) = (area.powf(1.0 / S as f64), determinant(&body.jacobian[0]).abs() / area);
    (across / along + along / across) / (2.0 * along)
}
