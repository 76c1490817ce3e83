//! Corners in which prescribed sides of several bodies meet.
//!
//! Two bodies that are tied side by side, both prescribed beside the interface, meet in its end. Projecting the data body by body gives two
//! values there that differ by the error of the projections, O(h^(p+1)), and the multiplier, which carries that jump, loses accuracy: at
//! degree 4 its error is ten times as large as with one value. Therefore corners come first: both bodies take the value of the data in
//! the point, and each side is projected with its ends held.

use super::Builder;
use super::boundary::component_name;
use super::model::{Model, Value};
use super::ties::short;
use super::values::{time_text, times};
use crate::formula::Point;
use faying::assembly::side_corners;
use faying::basis::Order;
use faying::geometry::{MapTable, cell};
use faying::linalg::Vector;
use faying::space::Trace;

/// Corners closer than this fraction of their element sizes coincide.
const SAME_PLACE: f64 = 1e-3;
/// Relative difference below which prescribed values are equal.
const EQUAL_VALUES: f64 = 1e-9;

/// Corner of a prescribed side that it shares with a prescribed side of another body.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedCorner<const N: usize> {
    /// Index of the condition in the list of the model.
    pub condition: usize,
    /// Function of the model that is not zero at the corner.
    pub function: usize,
    /// Value of the function at the corner.
    pub value: f64,
    /// Position \[length\].
    pub x: Vector<N>,
    /// Indices in this list of the corners of other bodies at the same point.
    pub others: Vec<usize>,
}

/// Returns the shared corners of all conditions, in their order; `in_model` gives the trace of a condition in functions of the model.
pub(super) fn shared<const S: usize, const N: usize>(model: &Model<S, N>, in_model: &dyn Fn(usize) -> Trace<S, N>) -> Vec<SharedCorner<N>> {
    let body = |condition: usize| model.glued.body(model.conditions[condition].side.patch);
    let Some(first) = (!model.conditions.is_empty()).then(|| body(0)) else { return Vec::new() };
    if (0..model.conditions.len()).all(|c| body(c) == first) {
        return Vec::new();
    }
    let mut all = Vec::new();
    for k in 0..model.conditions.len() {
        let of = side_corners(&in_model(k)).into_iter();
        all.extend(of.map(|c| (c.extent, SharedCorner { condition: k, function: c.function, value: c.value, x: c.x, others: Vec::new() })));
    }
    // sweep along the first axis: only neighbours are compared
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| all[a].1.x[0].total_cmp(&all[b].1.x[0]).then(a.cmp(&b)));
    let longest = all.iter().map(|c| c.0).fold(0.0, f64::max) * SAME_PLACE;
    let component = |c: usize| model.conditions[c].component;
    let mut met: Vec<Vec<usize>> = vec![Vec::new(); all.len()];
    for (place, &a) in order.iter().enumerate() {
        for &b in &order[place + 1..] {
            let ((reach_a, at_a), (reach_b, at_b)) = (&all[a], &all[b]);
            if at_b.x[0] - at_a.x[0] > longest {
                break;
            }
            let apart = (at_a.x - at_b.x).norm() > SAME_PLACE * reach_a.min(*reach_b);
            if !apart && body(at_a.condition) != body(at_b.condition) && component(at_a.condition) == component(at_b.condition) {
                met[a].push(b);
                met[b].push(a);
            }
        }
    }
    let kept: Vec<usize> = (0..all.len()).filter(|&k| !met[k].is_empty()).collect();
    let number = |k: &usize| kept.binary_search(k).expect("whoever is met meets");
    let with_others = |&k: &usize| SharedCorner { others: met[k].iter().map(number).collect(), ..all[k].1.clone() };
    kept.iter().map(with_others).collect()
}

/// Warns (E052) if the data of two tied bodies differ at a common corner, at one of the times of the case.
pub(super) fn jumps<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Model<S, N>) {
    let tied = |a: usize, b: usize| {
        let parts = model.ties.iter().flat_map(|t| &t.parts);
        parts.flat_map(|p| p.pairings.iter().map(|m| (p.slave.patch, m.master.patch))).any(|(s, m)| (s, m) == (a, b) || (s, m) == (b, a))
    };
    let pairs: Vec<(usize, usize)> = (0..model.corners.len())
        .flat_map(|a| model.corners[a].others.iter().map(move |&b| (a, b)))
        .filter(|&(a, b)| a < b && tied(model.patch_of_corner(a), model.patch_of_corner(b)))
        .collect();
    if pairs.is_empty() {
        return;
    }
    let changes = builder.case.steps.value.len() > 1;
    let mut told = vec![false; pairs.len()];
    for &t in times(builder.case, changes) {
        let value = |k: usize, x: &Vector<N>| model.value_of(k, x, t);
        let largest = (0..model.conditions.len()).map(|k| largest(model, k, &|x| value(k, x))).fold(0.0, f64::max);
        for (&(a, b), told) in pairs.iter().zip(&mut told).filter(|(_, told)| !**told) {
            let (a, b) = (&model.corners[a], &model.corners[b]);
            // both values at one point, so that a small distance of the bodies is not taken for a jump
            let (of_a, of_b) = (value(a.condition, &a.x), value(b.condition, &a.x));
            if (of_a - of_b).abs() <= EQUAL_VALUES * largest.max(of_a.abs()) || !(of_a - of_b).is_finite() {
                continue;
            }
            *told = true;
            let (one, other) = (&model.conditions[a.condition], &model.conditions[b.condition]);
            let place: Vec<String> = a.x.iter().map(|x| format!("{x}")).collect();
            let text = format!(
                "component {} is prescribed as {} on `{}` and as {} on `{}` at their common point ({}{}), where the bodies are tied: \
                 the multiplier has to carry the jump",
                component_name(one.component, model.components),
                short(of_a),
                one.side.label,
                short(of_b),
                other.side.label,
                place.join(", "),
                time_text(changes, t)
            );
            let warning = builder.warning("E052", text, other.at).with_help("make the values equal there, or prescribe one of them");
            builder.faults.push(warning);
        }
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

impl<const S: usize, const N: usize> Model<S, N> {
    fn patch_of_corner(&self, corner: usize) -> usize {
        self.conditions[self.corners[corner].condition].side.patch
    }

    /// Value that a condition prescribes at the point `x` and time `t`.
    fn value_of(&self, condition: usize, x: &Vector<N>, t: f64) -> f64 {
        let (condition, at) = (&self.conditions[condition], Point::new(x.as_slice()).at_time(t));
        match &condition.value {
            Value::Zero => 0.0,
            Value::Exact => self.exact.as_ref().map_or(0.0, |exact| exact.value(condition.component, &at)),
            Value::Formula(f) => f.value(&at),
        }
    }
}
