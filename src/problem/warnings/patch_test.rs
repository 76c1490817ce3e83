//! Gauss points of a patch that do not integrate linear fields on its rational cells.
//!
//! A linear field u = a . x has the forces F_i a with F_i = ∫ ∇N_i dx = ∫ cof(J) ∇̂N_i dξ. For polynomial maps the integrand is a
//! polynomial, which the rules integrate exactly ([`crate::assembly::points_of_curved_cells`]); for rational maps it is not. Per element,
//! with F by the rule and F* by one of many more points, the defect is
//!
//! ```text
//! e = sqrt( Σ_i |F_i - F*_i|² / K_ii ) / sqrt(V),   K_ii = ∫ |∇N_i|² dx,  V the volume:
//! ```
//!
//! the size of the stress that balances the defect, relative to that of the field. Nearly straight cells are not examined: the defect falls
//! with the angle they span to the power 2p + 2.

use super::warning::{Subject, Warning};
use crate::assembly::element_rule;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::{MapTable, cell};
use crate::linalg::{Vector, determinant, inverse};
use crate::parallel;
use crate::problem::model::{BodyModel, Model};
use crate::quadrature::{Quadrature, Rule};
use crate::space::Space;
use std::sync::Arc;

/// Defect above which the warning is given.
const MISSED: f64 = 1e-3;
/// Defect below which a number of extra points is advised.
const GOOD: f64 = 1e-4;
/// Distance of a cell's centre from the mean of its corners over its size, below which it is nearly straight: thin rings in arcs of 2
/// degrees.
const STRAIGHT: f64 = 4e-3;
/// Points per direction of the reference beyond those of the rule.
const BEYOND: usize = 10;
/// Points per direction of the first reference, whose defects select the elements to be examined: those above [`GOOD`].
const FIRST_LOOK: usize = 3;
/// Largest number of elements that are examined: the most bent ones.
const LOOKED_AT: usize = 128;

/// Finds the patches with such cells.
pub(super) fn patch_test<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let of = |k: usize| {
        // other maps are polynomials
        let patch = Some(&model.patches[k]).filter(|p| p.exact_map)?;
        let space = &**patch.body.space();
        let own_rule = |e: usize| patch.rules_of_map().rule(e).clone();
        let mut bent = defects(space, &most_bent(space), FIRST_LOOK, &own_rule);
        bent.retain(|d| d.1 > GOOD);
        let bent: Vec<usize> = bent.into_iter().map(|d| d.0).collect();
        let (element, missed) = worst(space, &bent, &own_rule).filter(|w| w.1 > MISSED)?;
        let mut table = MapTable::new();
        space.map(element, &[cell::center::<N, f64>(space.cell(element))], Order::Values, &mut table);
        let x = table.x[0].as_slice().to_vec();
        Some(Warning::PatchTest { of: Subject::body(model, k), element, x, missed, enough: enough(patch, &bent) })
    };
    (0..model.patches.len()).filter_map(of).collect()
}

/// Returns the least number of more points with which the defect is small, and the defect that is left.
fn enough<const S: usize, const N: usize>(patch: &BodyModel<S, N>, bent: &[usize]) -> Option<(usize, f64)> {
    let space = &**patch.body.space();
    // added to the points of the case and of curved cells
    let more = |e: usize, k: usize| element_rule(space, e, patch.extra_points + k).rule(0).clone();
    (1..BEYOND).find_map(|k| worst(space, bent, &|e| more(e, k)).filter(|w| w.1 <= GOOD).map(|w| (k, w.1)))
}

/// Elements whose map is bent, at most [`LOOKED_AT`], ascending.
fn most_bent<const N: usize>(space: &dyn Space<N, N>) -> Vec<usize> {
    let grids = [Cell::Tensor, Cell::Simplex].map(|kind| {
        let mut points = cell::corners::<N, f64>(kind);
        points.push(cell::center::<N, f64>(kind));
        points
    });
    let bend = |table: &mut MapTable<N, N>, e: usize| {
        if space.map_structure().is_affine(e) {
            return (0.0, e);
        }
        let points = &grids[usize::from(space.cell(e) == Cell::Simplex)];
        space.map(e, points, Order::Values, table);
        let (center, corners) = table.x.split_last().expect("a cell has corners and a centre");
        let mean: Vector<N> = corners.iter().sum::<Vector<N>>() / corners.len() as f64;
        let size = corners.iter().map(|x| (x - mean).norm()).fold(0.0, f64::max);
        ((center - mean).norm() / (2.0 * size), e)
    };
    let mut bent: Vec<(f64, usize)> = parallel::map_init(space.num_elements(), MapTable::new, bend);
    bent.retain(|b| b.0 > STRAIGHT);
    bent.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    bent.truncate(LOOKED_AT);
    let mut elements: Vec<usize> = bent.into_iter().map(|b| b.1).collect();
    elements.sort_unstable();
    elements
}

/// Returns the first element with the largest defect among `elements`, and this defect.
fn worst<const N: usize>(space: &dyn Space<N, N>, elements: &[usize], rule: &(dyn Fn(usize) -> Rule<N> + Sync)) -> Option<(usize, f64)> {
    defects(space, elements, BEYOND, rule).into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a })
}

/// Returns `elements` with their defects against rules of `beyond` more points per direction.
fn defects<const N: usize>(
    space: &dyn Space<N, N>,
    elements: &[usize],
    beyond: usize,
    rule: &(dyn Fn(usize) -> Rule<N> + Sync),
) -> Vec<(usize, f64)> {
    let of = |(tables, reference): &mut (Tables<N>, Option<Reference<N>>), k: usize| {
        let e = elements[k];
        let rule = rule(e);
        let per_direction = (rule.points.len() as f64).powf(1.0 / N as f64).round() as usize;
        let least = space.degree(e).into_iter().max().unwrap_or(1) + 1;
        let key = (space.cell(e), space.degree(e), per_direction.saturating_sub(least) + beyond);
        // most elements have that of the one before
        let reference = match reference.take() {
            Some(known) if known.0 == key => reference.insert(known),
            _ => reference.insert((key, element_rule(space, e, key.2))),
        };
        (e, defect(space, e, &rule, reference.1.rule(0), tables))
    };
    parallel::map_init(elements.len(), Default::default, of)
}

/// Functions and map of an element.
type Tables<const N: usize> = (ShapeTable<N>, MapTable<N, N>);
/// Cell, degree and extra points of an element with the rule that they have.
type Reference<const N: usize> = ((Cell, [usize; N], usize), Arc<dyn Quadrature<N>>);

/// Defect e of an element (module docs).
fn defect<const N: usize>(space: &dyn Space<N, N>, element: usize, rule: &Rule<N>, reference: &Rule<N>, tables: &mut Tables<N>) -> f64 {
    let (forces, _, _) = integrals(space, element, rule, tables);
    let (exact, stiffness, volume) = integrals(space, element, reference, tables);
    let squares = forces.iter().zip(&exact).zip(&stiffness).filter(|(_, k)| **k > 0.0).map(|((f, g), k)| (f - g).norm_squared() / k);
    (squares.sum::<f64>() / volume).sqrt()
}

/// F_i, K_ii and V by a rule.
fn integrals<const N: usize>(
    space: &dyn Space<N, N>,
    element: usize,
    rule: &Rule<N>,
    (shapes, map): &mut Tables<N>,
) -> (Vec<Vector<N>>, Vec<f64>, f64) {
    space.evaluate(element, &rule.points, Order::Gradients, shapes, map);
    let count = shapes.grads(0).len();
    let (mut forces, mut stiffness, mut volume) = (vec![Vector::<N>::zeros(); count], vec![0.0; count], 0.0);
    for (q, &w) in rule.weights.iter().enumerate() {
        let det = determinant(&map.jacobian[q]).abs();
        // no point of a Gauss rule lies on a collapsed edge
        let Some(inverse) = inverse(&map.jacobian[q]) else { continue };
        volume += w * det;
        let inverse = inverse.transpose();
        for (i, gradient) in shapes.grads(q).iter().enumerate() {
            let gradient = inverse * gradient;
            forces[i] += gradient * (w * det);
            stiffness[i] += gradient.norm_squared() * w * det;
        }
    }
    (forces, stiffness, volume)
}
