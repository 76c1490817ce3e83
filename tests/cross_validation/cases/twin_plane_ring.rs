//! A quarter of a ring of varying stiffness under a pressure inside that varies along the arc; outside it is pulled and bedded on springs
//! in x, and displaced in y by a linear function, which isoparametric cells hold exactly.

use super::twin_plane_box::assumption;
use crate::choices::{Choices, Discretisation};
use crate::exact::elastic;
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::annulus_sector;
use faying::problem::{Components, Data};

pub fn said(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let rubber = elastic(|[x, y, _]| 10.0 + x + y * y, 0.4, assumption(choices));
    let shape = Shape::new("body", annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap(), [3, 2]);
    let body = s.shape(choices, Shape { by_default: Discretisation::fe(), ..shape }, rubber);
    let p = &mut s.problem;
    p.fix(body.side("u0"), Components::Y).unwrap();
    p.fix(body.side("u1"), Components::X).unwrap();
    p.pressure(body.side("v0"), Data::of(|x, _| 1.0 + x[0] * x[1])).unwrap();
    p.prescribe(body.side("v1"), 1, Data::of(|x, _| -0.05 * x[1])).unwrap();
    p.traction(body.side("v1"), 0, Data::of(|x, _| 0.1 * x[1])).unwrap();
    s.problem.spring(body.side("v1"), 0, Data::of(|x, _| 1.0 + x[1])).unwrap();
    s
}
