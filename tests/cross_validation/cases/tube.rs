//! A quarter of a thick tube under a pressure that varies around it and along it.

use crate::choices::Choices;
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::annulus_sector;
use faying::physics::Hooke;
use faying::problem::{Components, Data};
use std::f64::consts::PI;

pub fn said(choices: &Choices) -> Setting<2, 3> {
    let mut s = Setting::new();
    let net = annulus_sector([0.0, 0.0], [2.0, 3.0], [0.0, 90.0]).unwrap().extrude(2.0);
    let tube = s.shape(choices, Shape::new("tube", net, [4, 2, 2]), Hooke::solid(1.0, 0.3).unwrap());
    let p = &mut s.problem;
    p.fix(tube.side("u0"), Components::Y).unwrap();
    p.fix(tube.side("u1"), Components::X).unwrap();
    p.fix(tube.side("w0"), Components::Z).unwrap();
    p.fix(tube.side("w1"), Components::Z).unwrap();
    let pressure = |x: &[f64; 3], _: f64| (1.0 + (2.0 * x[1].atan2(x[0])).cos() / 2.0) * (1.0 + (PI * x[2] / 2.0).cos());
    p.pressure(tube.side("v0"), Data::of(pressure)).unwrap();
    s
}
