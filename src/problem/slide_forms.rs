//! Rows of curved sides that slide on rigid motions.

use super::model::{Model, SlidePart};
use super::rigid::{RigidForm, RigidModes, RigidRow};
use super::rigid_bodies::RigidBodies;
use super::rigid_rows::add;
use nalgebra::DMatrix;

/// Share of the motion that a side holds most below which facets hold a motion by their irregularity: of circles it is a sixth of the difference
/// of neighbouring facets over the radius, and less for higher degrees.
const IRREGULAR: f64 = 0.02;

/// The rows of a curved side that slides on rigid motions, as means over each function. Facets that stand for a circle hold its rotation by
/// their irregularity alone: what they hold so little counts as free.
pub(super) fn slide_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    part: &SlidePart<S, N>,
) -> Vec<RigidForm> {
    let mut forms = vec![(RigidForm::new(), 0.0); part.num_rows()];
    part.visit(|at, row, d| {
        let body = bodies.of_facet(model, part.side(), at.element);
        let (form, size) = &mut forms[row];
        *size += d.norm();
        for (body, own) in modes.form(&RigidRow { terms: vec![(body, 1.0, at.x)], direction: *d }) {
            add(form, body, &own, 1.0);
        }
    });
    let mean = |(mut form, size): (RigidForm, f64)| {
        form.iter_mut().flat_map(|term| &mut term.1).for_each(|v| *v /= size);
        form
    };
    let forms: Vec<RigidForm> = forms.into_iter().filter(|(_, size)| *size > 0.0).map(mean).collect();
    if model.patches[part.side().patch].exact_map { forms } else { without_irregularity(forms, modes.modes()) }
}

/// Forms of one body that hold what `forms` hold, but for motions with less than [`IRREGULAR`] of the largest; all where they are of several
/// bodies. `modes`: number of modes of a body.
fn without_irregularity(forms: Vec<RigidForm>, modes: usize) -> Vec<RigidForm> {
    let Some(body) = forms.iter().flatten().next().map(|term| term.0).filter(|b| forms.iter().flatten().all(|t| t.0 == *b)) else {
        return forms;
    };
    let mut gram = DMatrix::<f64>::zeros(modes, modes);
    for (_, own) in forms.iter().flatten() {
        gram += DMatrix::from_fn(modes, modes, |i, j| own[i] * own[j] / forms.len() as f64);
    }
    let eigen = gram.symmetric_eigen();
    let least = IRREGULAR * IRREGULAR * eigen.eigenvalues.max();
    let kept = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()).filter(|(value, _)| **value > least);
    kept.map(|(value, v)| vec![(body, std::array::from_fn(|k| if k < modes { value.sqrt() * v[k] } else { 0.0 }))]).collect()
}
