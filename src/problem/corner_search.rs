//! Corners in which prescribed sides of several bodies meet.
//!
//! Two bodies that are tied side by side, both prescribed beside the interface, meet in its end. Projecting the data body by body gives
//! two values there that differ by the error of the projections, O(h^(p+1)), and the multiplier, which carries that jump, loses
//! accuracy: at p = 4 its error is ten times as large as with one value. So corners come first: both bodies take the value of the data in
//! the point, and each side is projected with its ends held.

use super::corners::SharedCorner;
use super::data::Point;
use super::model::{Model, Value};
use crate::assembly::side_corners;
use crate::linalg::Vector;
use crate::space::Trace;

/// Corners nearer than this share of their elements are one.
pub(super) const SAME_PLACE: f64 = 1e-3;

/// The shared corners of all conditions, in their order; `in_model` gives the trace of a condition in functions of the model.
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
    // neighbours along the first axis are looked at, no others
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

impl<const S: usize, const N: usize> Model<S, N> {
    /// The value prescribed on a patch, of a component in a point at time `t`.
    pub fn value_at(&self, value: &Value, (patch, component): (usize, usize), x: &Vector<N>, t: f64) -> f64 {
        let at = Point::new(x.as_slice()).at_time(t);
        match value {
            Value::Zero => 0.0,
            Value::Exact => self.patches[patch].exact.as_ref().map_or(0.0, |exact| exact.value(component, &at)),
            Value::Data(f) => f.value(&at),
        }
    }
}
