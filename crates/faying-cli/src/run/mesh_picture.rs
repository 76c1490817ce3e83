//! A picture of the mesh that is solved.

use crate::case::Case;
use crate::lower::LoweredCase;
use crate::plot::faces::{FacePlot, Polygon};
use faying::linalg::Vector;
use faying::space::Space;

/// Appends the faces of the part with a number.
type AddFaces<const N: usize> = fn(&dyn Space<N, N>, usize, &mut Vec<Polygon>);

/// The bodies of a case with its supports and loads at the last time, without names of sides.
pub fn of<const S: usize, const N: usize>(case: &Case, built: &LoweredCase<S, N>, title: &str, add: AddFaces<N>) -> FacePlot {
    let (contents, end) = (built.system.contents(), case.steps.value.last().copied().unwrap_or(1.0));
    let marks = super::marks::of(case, &contents, end, &|_, _, _| Vector::zeros());
    let mut plot = FacePlot { title: title.to_owned(), marks, ..FacePlot::default() };
    for (k, body) in contents.bodies().enumerate() {
        plot.parts.push(body.name().to_owned());
        add(&**body.space(), k, &mut plot.faces);
    }
    plot
}
