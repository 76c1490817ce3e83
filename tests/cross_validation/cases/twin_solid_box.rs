//! A block of varying stiffness under its own weight: displaced linearly on its left face, sliding on a bed that sinks linearly, pulled on
//! the right, pressed from above on springs.

use crate::choices::{Choices, Discretisation};
use crate::exact::elastic;
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::brick;
use faying::physics::Assumption;
use faying::problem::Data;
use faying::space::Divisions;

pub fn said(choices: &Choices) -> Setting<2, 3> {
    let mut s = Setting::new();
    let soil = elastic::<3>(|[x, y, z]| 10.0 + 4.0 * x + y * z, 0.3, Assumption::Solid);
    let elements = [Divisions::Breakpoints(vec![0.0, 0.4, 1.0]), Divisions::Total(1), Divisions::Total(1)];
    let shape = Shape::new("body", brick([0.0; 3], [1.0, 1.5, 0.8]).unwrap(), [1; 3]);
    let body = s.shape(choices, Shape { elements, by_default: Discretisation::fe(), ..shape }, soil);
    let p = &mut s.problem;
    p.source(body, vec![Data::of(|x, _| 0.3 * x[1]), 0.1.into(), Data::of(|x, _| -1.0 - 0.5 * x[0])]).unwrap();
    p.prescribe(body.side("u0"), 0, Data::of(|x, _| 0.02 - 0.01 * x[1])).unwrap();
    p.prescribe(body.side("u0"), 1, Data::of(|x, _| 0.01 * x[2])).unwrap();
    p.prescribe(body.side("u0"), 2, Data::of(|x, _| -0.01 * x[1])).unwrap();
    p.prescribe(body.side("w0"), 2, Data::of(|x, _| -0.01 * x[1] - 0.02 * x[0])).unwrap();
    p.traction(body.side("u1"), 0, Data::of(|x, _| 1.0 + x[1] * x[2])).unwrap();
    p.traction(body.side("u1"), 1, -0.4).unwrap();
    p.traction(body.side("u1"), 2, 0.2).unwrap();
    p.pressure(body.side("w1"), Data::of(|x, _| 0.5 + x[0])).unwrap();
    s.problem.spring(body.side("w1"), 0, 2.0).unwrap();
    s.problem.spring(body.side("w1"), 2, Data::of(|x, _| 1.5 + x[0])).unwrap();
    s
}
