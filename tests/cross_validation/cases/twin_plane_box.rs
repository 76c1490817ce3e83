//! A rectangle of varying stiffness under its own weight: pushed and bent by given displacements on its left side, sliding on a bed that
//! sinks linearly, pulled on the right, pressed from above on springs.

use crate::choices::{Choices, Discretisation};
use crate::exact::elastic;
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::rectangle;
use faying::physics::Assumption;
use faying::problem::Data;
use faying::space::Divisions;

/// The assumption that choices name.
pub fn assumption(choices: &Choices) -> Assumption {
    match choices.word("model.assumption") {
        Some("plane-strain") => Assumption::PlaneStrain,
        Some("plane-stress") => Assumption::PlaneStress,
        other => panic!("{other:?}"),
    }
}

pub fn said(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let soil = elastic(|[x, y, _]| 10.0 + 4.0 * x + (2.0 * y).sin(), 0.3, assumption(choices));
    let elements = [Divisions::Breakpoints(vec![0.0, 0.4, 1.0]), Divisions::Total(2)];
    let shape = Shape::new("body", rectangle([0.0, 0.0], [1.0, 1.5]).unwrap(), [1, 1]);
    let body = s.shape(choices, Shape { elements, by_default: Discretisation::fe(), ..shape }, soil);
    let p = &mut s.problem;
    p.source(body, vec![Data::of(|x, _| 0.3 * x[1]), Data::of(|x, _| -1.0 - 0.5 * x[0])]).unwrap();
    p.prescribe(body.side("u0"), 0, Data::of(|x, _| 0.02 - 0.01 * x[1])).unwrap();
    p.prescribe(body.side("u0"), 1, Data::of(|x, _| -0.01 * x[1])).unwrap();
    p.prescribe(body.side("v0"), 1, Data::of(|x, _| -0.03 * x[0])).unwrap();
    p.traction(body.side("u1"), 0, Data::of(|x, _| 1.0 + (0.5 * x[1]).exp())).unwrap();
    p.traction(body.side("u1"), 1, -0.4).unwrap();
    p.pressure(body.side("v1"), Data::of(|x, _| 0.5 + x[0])).unwrap();
    s.problem.spring(body.side("v1"), 0, 2.0).unwrap();
    s.problem.spring(body.side("v1"), 1, Data::of(|x, _| 1.5 + x[0])).unwrap();
    s
}
