//! A thick quarter of a tube cut along its symmetry planes, under a pressure inside that varies, held below, twisted above, bedded on
//! springs outside.

use crate::choices::{Choices, Discretisation};
use crate::exact::elastic;
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::annulus_sector;
use faying::physics::Assumption;
use faying::problem::{Components, Data};

pub fn said(choices: &Choices) -> Setting<2, 3> {
    let mut s = Setting::new();
    let rubber = elastic::<3>(|[x, _, z]| 10.0 + x + 2.0 * z, 0.4, Assumption::Solid);
    let net = annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap().extrude(0.8);
    let body = s.shape(choices, Shape { by_default: Discretisation::fe(), ..Shape::new("body", net, [2, 1, 1]) }, rubber);
    let p = &mut s.problem;
    p.source(body, vec![0.0.into(), Data::of(|x, _| 0.2 * x[0]), (-0.5).into()]).unwrap();
    p.fix(body.side("u0"), Components::Y).unwrap();
    p.fix(body.side("u1"), Components::X).unwrap();
    p.fix(body.side("w0"), Components::Z).unwrap();
    p.pressure(body.side("v0"), Data::of(|x, _| 1.0 + x[0] * x[1])).unwrap();
    p.traction(body.side("w1"), 0, Data::of(|x, _| -0.3 * x[1])).unwrap();
    p.traction(body.side("w1"), 1, Data::of(|x, _| 0.3 * x[0])).unwrap();
    p.traction(body.side("w1"), 2, 0.1).unwrap();
    s.problem.spring(body.side("v1"), 0, Data::of(|x, _| 1.0 + x[1])).unwrap();
    s.problem.spring(body.side("v1"), 1, 0.5).unwrap();
    s.problem.spring(body.side("v1"), 2, 0.3).unwrap();
    s
}
