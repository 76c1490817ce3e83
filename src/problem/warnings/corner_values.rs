//! Prescribed values of bodies that are tied, on sides and in corners, where they jump in a common corner.

use super::warning::Warning;
use crate::assembly::side_corners;
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use crate::problem::Statement;
use crate::problem::corner_search::SAME_PLACE;
use crate::problem::model::{Condition, Model, PointCondition, Value};

/// Values that differ by less than this share of the largest are equal.
const EQUAL_VALUES: f64 = 1e-9;

/// A prescribed component in a corner of a body.
#[derive(Clone, Copy)]
struct Held<'a, const N: usize> {
    of: Statement,
    patch: usize,
    label: &'a str,
    component: usize,
    value: &'a Value,
    x: Vector<N>,
}

impl<'a, const N: usize> Held<'a, N> {
    fn on_side<const S: usize>(condition: &'a Condition<S, N>, x: Vector<N>) -> Self {
        let Condition { of, side, component, value } = condition;
        Self { of: *of, patch: side.patch, label: &side.label, component: *component, value, x }
    }

    fn in_corner(pin: &'a PointCondition<N>, x: Vector<N>) -> Self {
        let PointCondition { of, rim, component, value } = pin;
        Self { of: *of, patch: rim.patch, label: &rim.label, component: *component, value, x }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// [`Warning::CornerValues`] of every two conditions of bodies that are tied, if they differ at one of `times`.
    pub fn corner_values(&self, times: &[f64]) -> Vec<Warning> {
        let of_corner = |k: usize| Held::on_side(&self.conditions[self.corners[k].condition], self.corners[k].x);
        let met = (0..self.corners.len()).flat_map(|a| self.corners[a].others.iter().map(move |&b| (a, b))).filter(|(a, b)| a < b);
        let mut pairs: Vec<[Held<'_, N>; 2]> = met.map(|(a, b)| [of_corner(a), of_corner(b)]).collect();
        pairs.extend(self.pinned_pairs());
        pairs.retain(|[a, b]| self.are_tied(a.patch, b.patch));
        if pairs.is_empty() {
            return Vec::new();
        }
        let (mut told, mut found) = (vec![false; pairs.len()], Vec::new());
        for &t in times {
            let largest = self
                .conditions
                .iter()
                .map(|c| largest(c, &|x| self.value_at(&c.value, (c.side.patch, c.component), x, t)))
                .fold(0.0, f64::max);
            for ([a, b], told) in pairs.iter().zip(&mut told).filter(|(_, told)| !**told) {
                // both values at one point, so that a small distance of the bodies is not taken for a jump
                let values = [a, b].map(|held| self.value_at(held.value, (held.patch, held.component), &a.x, t));
                let jump = values[0] - values[1];
                if jump.abs() <= EQUAL_VALUES * largest.max(values[0].abs()) || !jump.is_finite() {
                    continue;
                }
                *told = true;
                found.push(Warning::CornerValues {
                    of: [a.of, b.of],
                    sides: [a.label.to_owned(), b.label.to_owned()],
                    component: a.component,
                    values,
                    x: a.x.as_slice().to_vec(),
                    t,
                });
            }
        }
        found
    }

    /// Whether a tie joins two patches.
    fn are_tied(&self, a: usize, b: usize) -> bool {
        let parts = self.ties.iter().flat_map(|t| &t.parts);
        let mut pairs = parts.flat_map(|p| p.pairings.iter().map(|m| (p.slave.patch, m.master.patch)));
        pairs.any(|(s, m)| (s, m) == (a, b) || (s, m) == (b, a))
    }

    /// Corners that are prescribed by themselves, each with what is prescribed there on another patch.
    fn pinned_pairs(&self) -> Vec<[Held<'_, N>; 2]> {
        let pins = self.pins.iter().filter(|pin| pin.rim.rim.dimension == 0);
        let pins: Vec<Held<'_, N>> = pins.flat_map(|pin| pin.rim.rim.x.iter().map(|x| Held::in_corner(pin, *x))).collect();
        if pins.is_empty() {
            return Vec::new();
        }
        let reach = |patch: usize| SAME_PLACE * self.patches[patch].extent.map_or(0.0, |bounds| bounds.diagonal());
        let on_sides: Vec<(Held<'_, N>, f64)> = self
            .conditions
            .iter()
            .flat_map(|c| side_corners(&c.side.trace).into_iter().map(move |k| (Held::on_side(c, k.x), SAME_PLACE * k.extent)))
            .collect();
        let mut pairs = Vec::new();
        for (k, pin) in pins.iter().enumerate() {
            let meets = |other: &Held<'_, N>, reach: f64| {
                other.patch != pin.patch && other.component == pin.component && (other.x - pin.x).norm() <= reach
            };
            pairs.extend(on_sides.iter().filter(|(side, reach)| meets(side, *reach)).map(|(side, _)| [*side, *pin]));
            let later = pins[k + 1..].iter().filter(|other| meets(other, SAME_PLACE * reach(pin.patch).min(reach(other.patch))));
            pairs.extend(later.map(|other| [*pin, *other]));
        }
        pairs
    }
}

/// Returns the largest absolute value of a condition at the corners of its elements.
fn largest<const S: usize, const N: usize>(condition: &Condition<S, N>, value: &dyn Fn(&Vector<N>) -> f64) -> f64 {
    let space = &*condition.side.trace.space;
    let (mut largest, mut map) = (0.0_f64, MapTable::new());
    for e in 0..space.num_elements() {
        space.map(e, &cell::corners::<S, f64>(space.cell(e)), Order::Values, &mut map);
        largest = map.x.iter().map(|x| value(x).abs()).filter(|v| v.is_finite()).fold(largest, f64::max);
    }
    largest
}
