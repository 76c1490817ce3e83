//! Warns where prescribed values of bodies that are tied jump in a common corner.

use super::builder::Builder;
use super::built::Built;
use super::values::{time_text, times};
use crate::words::component_name;
use crate::words::short;
use faying::basis::Order;
use faying::geometry::{MapTable, cell};
use faying::linalg::Vector;
use faying::problem::Model;

/// Values that differ by less than this share of the largest are equal.
const EQUAL_VALUES: f64 = 1e-9;

/// E052 as a warning where the data of two bodies that are tied differ in a common corner, at a time of the case.
pub(super) fn jumps<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Built<S, N>) {
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
            let warning = builder
                .warning("E052", text, model.sources.of(b.condition))
                .with_help("make the values equal there, or prescribe one of them");
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
