//! Rows of curved sides that slide on rigid motions.

use super::model::{Model, SlidePart};
use super::rigid::{RigidForm, RigidModes, RigidRow};
use super::rigid_bodies::RigidBodies;
use super::rigid_rows::add;

/// The rows of a curved side that slides on rigid motions, as means over each function.
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
    forms.into_iter().filter(|(_, size)| *size > 0.0).map(mean).collect()
}
