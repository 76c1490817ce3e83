//! Prescribed values of bodies that are tied, where they jump in a common corner.

use super::warning::Warning;
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use crate::problem::model::Model;

/// Values that differ by less than this share of the largest are equal.
const EQUAL_VALUES: f64 = 1e-9;

impl<const S: usize, const N: usize> Model<S, N> {
    /// [`Warning::CornerValues`] of every two conditions of bodies that are tied, if they differ at one of `times`.
    pub fn corner_values(&self, times: &[f64]) -> Vec<Warning> {
        let tied = |a: usize, b: usize| {
            let parts = self.ties.iter().flat_map(|t| &t.parts);
            let mut pairs = parts.flat_map(|p| p.pairings.iter().map(|m| (p.slave.patch, m.master.patch)));
            pairs.any(|(s, m)| (s, m) == (a, b) || (s, m) == (b, a))
        };
        let pairs: Vec<(usize, usize)> = (0..self.corners.len())
            .flat_map(|a| self.corners[a].others.iter().map(move |&b| (a, b)))
            .filter(|&(a, b)| a < b && tied(self.patch_of_corner(a), self.patch_of_corner(b)))
            .collect();
        if pairs.is_empty() {
            return Vec::new();
        }
        let (mut told, mut found) = (vec![false; pairs.len()], Vec::new());
        for &t in times {
            let value = |k: usize, x: &Vector<N>| self.value_of(k, x, t);
            let largest = (0..self.conditions.len()).map(|k| largest(self, k, &|x| value(k, x))).fold(0.0, f64::max);
            for (&(a, b), told) in pairs.iter().zip(&mut told).filter(|(_, told)| !**told) {
                let (x, conditions) = (self.corners[a].x, [a, b].map(|k| self.corners[k].condition));
                // both values at one point, so that a small distance of the bodies is not taken for a jump
                let values = conditions.map(|k| value(k, &x));
                let jump = values[0] - values[1];
                if jump.abs() <= EQUAL_VALUES * largest.max(values[0].abs()) || !jump.is_finite() {
                    continue;
                }
                *told = true;
                found.push(Warning::CornerValues {
                    of: conditions.map(|k| self.conditions[k].of),
                    sides: conditions.map(|k| self.conditions[k].side.label.clone()),
                    component: self.conditions[conditions[0]].component,
                    values,
                    x: x.as_slice().to_vec(),
                    t,
                });
            }
        }
        found
    }
}

/// Returns the largest absolute value of a condition at the corners of its elements.
fn largest<const S: usize, const N: usize>(model: &Model<S, N>, condition: usize, value: &dyn Fn(&Vector<N>) -> f64) -> f64 {
    let space = &*model.conditions[condition].side.trace.space;
    let (mut largest, mut map) = (0.0_f64, MapTable::new());
    for e in 0..space.num_elements() {
        space.map(e, &cell::corners::<S, f64>(space.cell(e)), Order::Values, &mut map);
        largest = map.x.iter().map(|x| value(x).abs()).filter(|v| v.is_finite()).fold(largest, f64::max);
    }
    largest
}
