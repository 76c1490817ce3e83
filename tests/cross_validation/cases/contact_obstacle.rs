//! A block is pressed on a rigid hill: contact in the middle, open beside it.

use crate::choices::Choices;
use crate::pressed::{Faced, method};
use crate::setting::{Setting, Shape};
use faying::contact::LevelSet;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{Components, Data};
use std::sync::Arc;

/// The hill is y = -C x².
const C: f64 = 0.05;

pub fn said(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let net = rectangle([0.0, 0.0], [1.0, 0.5]).unwrap();
    let block = s.shape(choices, Shape::new("block", net, [8, 4]), Hooke::plane_strain(1.0, 0.3).unwrap());
    s.problem.fix(block.side("u0"), Components::X).unwrap();
    s.problem.prescribe(block.side("v1"), 1, -choices.number("let.d", 0.02)).unwrap();
    let hill = |x: &Vector<2>| (x[1] + C * x[0] * x[0], Vector::from([2.0 * C * x[0], 1.0]));
    let hill = LevelSet::try_along(hill, Vector::from([0.0, 1.0])).unwrap();
    s.press("hill", (block, "v0"), Faced::Obstacle(Arc::new(hill)), Data::gap(), method(choices, "contact.hill"));
    s
}
