//! Multipliers of a surface that is glued to itself: functions with the same values along both sides of the seam are one.

use super::model::{BodySide, Model};
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use std::collections::{BTreeMap, HashMap};

/// Function values below this count as zero, and values that differ by less are the same.
const NO_VALUE: f64 = 1e-10;

/// An edge of an element: the element and its ends, in the element and in space.
#[derive(Clone, Copy)]
struct Edge<const S: usize, const N: usize> {
    element: usize,
    xi: [Vector<S>; 2],
    x: [Vector<N>; 2],
}

/// The function of `psi` that takes the place of another one, on the edges along which the side is glued to itself. Elements on which the
/// degree is not that of the trace have nothing to join.
pub(super) fn seam_twins<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &BodySide<S, N>,
    psi: &dyn Basis<S>,
) -> BTreeMap<usize, usize> {
    let (space, dofs) = (&*slave.trace.space, &slave.trace.dofs);
    let mut count: HashMap<usize, usize> = HashMap::new();
    dofs.iter().for_each(|&dof| *count.entry(model.function(slave.patch, dof)).or_default() += 1);
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let mut known: HashMap<Vec<usize>, Edge<S, N>> = HashMap::new();
    let mut twin = BTreeMap::new();
    for element in (0..space.num_elements()).filter(|&e| psi.degree(e) == space.degree(e)) {
        let corners = cell::corners::<S, f64>(space.cell(element));
        space.active(element, &mut ids);
        for face in cell::faces::<S, f64>(space.cell(element)).iter().filter(|face| face.corners.len() == 2) {
            // functions of the model along the edge, all of which are there twice
            space.tabulate(element, &[face.center], Order::Values, &mut table);
            let there = ids.iter().zip(table.values(0)).filter(|(_, v)| v.abs() > NO_VALUE);
            let mut functions: Vec<usize> = there.map(|(&i, _)| model.function(slave.patch, dofs[i])).collect();
            if functions.is_empty() || functions.iter().any(|f| count[f] < 2) {
                continue;
            }
            functions.sort_unstable();
            let xi = [corners[face.corners[0]], corners[face.corners[1]]];
            space.map(element, &xi, Order::Values, &mut map);
            let edge = Edge { element, xi, x: [map.x[0], map.x[1]] };
            match known.get(&functions) {
                // the lesser number stays
                Some(other) => twin.extend(same_values(psi, other, &edge).into_iter().map(|(j, one)| (j.max(one), j.min(one)))),
                None => {
                    known.insert(functions, edge);
                }
            }
        }
    }
    twin
}

/// Pairs (function on `second`, function on `first`) with the same values along both edges, which lie in the same place.
fn same_values<const S: usize, const N: usize>(psi: &dyn Basis<S>, first: &Edge<S, N>, second: &Edge<S, N>) -> Vec<(usize, usize)> {
    let runs_back = (first.x[0] - second.x[0]).norm() > (first.x[0] - second.x[1]).norm();
    let points = psi.degree(first.element).into_iter().max().unwrap_or(0) + 1;
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    let mut values = |edge: &Edge<S, N>, back: bool| -> Vec<(usize, Vec<f64>)> {
        let at = |k: usize| {
            let t = k as f64 / points as f64;
            let t = if back { 1.0 - t } else { t };
            edge.xi[0] * (1.0 - t) + edge.xi[1] * t
        };
        psi.active(edge.element, &mut ids);
        psi.tabulate(edge.element, &(0..=points).map(at).collect::<Vec<_>>(), Order::Values, &mut table);
        let own = ids.iter().enumerate().map(|(a, &j)| (j, (0..=points).map(|q| table.values(q)[a]).collect::<Vec<f64>>()));
        own.filter(|(_, values)| values.iter().any(|v| v.abs() > NO_VALUE)).collect()
    };
    let (here, there) = (values(first, false), values(second, runs_back));
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < NO_VALUE);
    let partner = |(j, own): &(usize, Vec<f64>)| Some((*j, here.iter().find(|(_, other)| same(own, other))?.0));
    there.iter().filter_map(partner).filter(|(j, one)| j != one).collect()
}
