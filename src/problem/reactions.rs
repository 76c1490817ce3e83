//! Reactions of supports: forces on the bodies per side, edge and corner.

use super::model::{BodySide, Model, SlidePart};
use super::regions::RegionPart;
use super::resultant::{Resultant, cross};
use super::state::StepState;
use crate::basis::{Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Vector, measure};
use crate::quadrature::Quadrature;
use nalgebra::DMatrix;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Directions whose Gram matrix has an eigenvalue below this share of its largest one are dependent.
const DEPENDENT: f64 = 1e-10;
/// Integrals of a function below this fraction of that of its absolute value are zero: corners of quadratic triangles.
const NO_INTEGRAL: f64 = 1e-9;

/// One direction in which a support holds a function.
#[derive(Clone, Copy, Debug)]
struct Hold<const N: usize> {
    /// The function, as [`Model::function`] numbers it.
    function: usize,
    /// Index of the support.
    support: usize,
    /// Unit vector.
    direction: Vector<N>,
    /// Integral of the function over the side \[area\]; `None` if it is not positive, and for edges and corners.
    weight: Option<f64>,
}

/// The force of a support on its body.
#[derive(Clone, Debug)]
pub struct Reaction<const S: usize, const N: usize> {
    /// The side, edge or corner.
    pub(super) on: RegionPart<S, N>,
    /// The force, one entry per component of the unknown.
    pub force: Vec<f64>,
}

impl<const S: usize, const N: usize> Reaction<S, N> {
    /// Name of the side, edge or corner.
    pub fn label(&self) -> &str {
        self.on.label()
    }
}

/// Computes the reactions per support, and adds them to `outside`, the sum of the external forces.
///
/// The force F at a function is carried along the directions in which supports hold it: axes of prescribed components,
/// normals or tangents of sides that slide, axes along which a side moves as one. Where these are independent, as the
/// sides of an edge or a corner mostly are, the parts follow from F alone. Otherwise F = sum a_h d_h with the least
/// sum a_h^2 / w_h, w_h the integral of the function over the side: sides that hold the same direction share in
/// proportion to w, also those of glued patches, whose forces across seams cancel in the function that stands for all.
/// The shares are equal where an edge or a corner takes part, or an integral is not positive. The force on a curved side that slides is that of
/// its multipliers, - ∫ lambda ds.
pub fn reactions<const S: usize, const N: usize>(
    model: &Model<S, N>,
    state: &StepState<S, N>,
    outside: &mut Resultant,
) -> Vec<Reaction<S, N>> {
    let n = model.components;
    // coefficients of 1 and of the coordinates on held functions: forces and moments in any basis
    let mut one = vec![1.0; model.unknowns / n.max(1)];
    for (i, v) in model.coefficients(&|_| 1.0) {
        one[i] = v;
    }
    let mut place = vec![Vector::<N>::zeros(); one.len()];
    for k in 0..N {
        for (i, v) in model.coefficients(&move |x: &Vector<N>| x[k]) {
            place[i][k] = v;
        }
    }
    let (supports, holds) = holds(model);
    let mut forces = vec![vec![0.0; n]; supports.len()];
    for group in holds.chunk_by(|a, b| a.function == b.function) {
        let i = group[0].function;
        let force = Vector::<N>::from_fn(|c, _| if c < n { state.support[n * i + c] } else { 0.0 });
        for (hold, part) in group.iter().zip(shares(group, &force)) {
            for c in 0..n {
                forces[hold.support][c] += part[c] * one[i];
                outside.force[c] += part[c] * one[i];
            }
            for (sum, m) in outside.moment.iter_mut().zip(cross(&place[i], part.as_slice())) {
                *sum += m;
            }
        }
    }
    let of_slide = |part: &SlidePart<S, N>| {
        let sum = part.force(&state.lambda);
        outside.sum(&sum);
        (RegionPart::Side(part.side().said()), sum.force[..n].to_vec())
    };
    let slides: Vec<_> = model.slides.iter().map(of_slide).collect();
    let mut all: Vec<Reaction<S, N>> = Vec::new();
    for (on, force) in supports.into_iter().zip(forces).chain(slides) {
        match all.iter_mut().find(|known| known.on.is(&on)) {
            Some(known) => known.force.iter_mut().zip(&force).for_each(|(s, f)| *s += f),
            None => all.push(Reaction { on, force }),
        }
    }
    all
}

fn axis<const N: usize>(component: usize) -> Vector<N> {
    Vector::from_fn(|k, _| f64::from(u8::from(k == component)))
}

/// Returns all supports, and the directions they hold, ascending by function.
fn holds<const S: usize, const N: usize>(model: &Model<S, N>) -> (Vec<RegionPart<S, N>>, Vec<Hold<N>>) {
    let (mut supports, mut all) = (Vec::new(), Vec::new());
    for side in &model.supports {
        let support = supports.len();
        supports.push(RegionPart::Side(side.said()));
        let conditions = model.conditions.iter().filter(|d| Arc::ptr_eq(&d.side, side) && !model.is_symmetry(d)).map(|d| axis(d.component));
        let held = model.held.iter().filter(|h| Arc::ptr_eq(&h.side, side)).map(|h| h.direction);
        let directions: Vec<Vector<N>> = conditions.chain(held).collect();
        for (function, weight) in integrals(model, side) {
            all.extend(directions.iter().map(|&direction| Hold { function, support, direction, weight }));
        }
    }
    for pin in &model.pins {
        let support = supports.len();
        supports.push(RegionPart::Rim(pin.rim.clone()));
        let mut functions: Vec<usize> = pin.rim.rim.functions().iter().map(|&i| model.function(pin.rim.patch, i)).collect();
        functions.sort_unstable();
        functions.dedup();
        all.extend(functions.into_iter().map(|function| Hold { function, support, direction: axis(pin.component), weight: None }));
    }
    all.sort_by_key(|h| h.function);
    (supports, all)
}

/// Returns (function, its integral over the side \[area\]), ascending; `None` if it is not positive.
fn integrals<const S: usize, const N: usize>(model: &Model<S, N>, side: &BodySide<S, N>) -> Vec<(usize, Option<f64>)> {
    let space = &*side.trace.space;
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let mut sums: BTreeMap<usize, (f64, f64)> = side.trace.dofs.iter().map(|&i| (model.function(side.patch, i), (0.0, 0.0))).collect();
    for e in 0..space.num_elements() {
        let rule = side.rules.rule(e);
        space.active(e, &mut ids);
        space.evaluate(e, &rule.points, Order::Gradients, &mut table, &mut map);
        for (q, &w) in rule.weights.iter().enumerate() {
            let ds = w * measure(&map.jacobian[q]);
            for (&i, v) in ids.iter().zip(table.values(q)) {
                let sum = sums.entry(model.function(side.patch, side.trace.dofs[i])).or_default();
                sum.0 += v * ds;
                sum.1 += (v * ds).abs();
            }
        }
    }
    sums.into_iter().map(|(i, (sum, amount))| (i, (sum > NO_INTEGRAL * amount).then_some(sum))).collect()
}

/// Returns the parts of `force` that the holds of one function carry, in their order.
fn shares<const N: usize>(holds: &[Hold<N>], force: &Vector<N>) -> Vec<Vector<N>> {
    let equal = vec![1.0; holds.len()];
    // independent directions determine the parts: equal weights are the best conditioned
    let given: Option<Vec<f64>> = holds.iter().map(|h| h.weight).collect();
    let weights = match given {
        Some(weights) if solved(holds, &equal, force).1 < holds.len() => {
            let total: f64 = weights.iter().sum();
            weights.iter().map(|w| w / total).collect()
        }
        _ => equal,
    };
    let (mu, _) = solved(holds, &weights, force);
    holds.iter().zip(&weights).map(|(h, w)| h.direction * (w * h.direction.dot(&mu))).collect()
}

/// mu of least norm with (sum w d dᵀ) mu = `force` in the span of the directions, and the number of independent ones.
fn solved<const N: usize>(holds: &[Hold<N>], weights: &[f64], force: &Vector<N>) -> (Vector<N>, usize) {
    let mut gram = [[0.0; N]; N];
    for (h, w) in holds.iter().zip(weights) {
        for i in 0..N {
            for j in 0..N {
                gram[i][j] += w * h.direction[i] * h.direction[j];
            }
        }
    }
    let mut mu = Vector::<N>::zeros();
    let mut rank = 0;
    // most supports hold axes: no round-off there
    if (0..N).all(|i| (0..N).all(|j| i == j || gram[i][j] == 0.0)) {
        for c in (0..N).filter(|&c| gram[c][c] > 0.0) {
            mu[c] = force[c] / gram[c][c];
            rank += 1;
        }
        return (mu, rank);
    }
    let eigen = DMatrix::from_fn(N, N, |i, j| gram[i][j]).symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    for (value, v) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > DEPENDENT * largest {
            let part = (0..N).map(|k| v[k] * force[k]).sum::<f64>() / value;
            mu += Vector::<N>::from_fn(|k, _| v[k] * part);
            rank += 1;
        }
    }
    (mu, rank)
}
