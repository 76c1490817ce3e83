//! Cook's membrane: a tapered panel, clamped on the left and sheared on the right; whole, and in four patches graded to its corners.

use crate::choices::{Choices, Discretisation, one_of};
use crate::setting::{Setting, Shape};
use faying::geometry::ControlNet;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::Components;
use faying::space::Grading;

fn panel(corners: [[f64; 2]; 4]) -> ControlNet<2, 2> {
    let knots = || vec![0.0, 0.0, 1.0, 1.0];
    ControlNet::from_knots([1, 1], [knots(), knots()], corners.map(Vector::from).to_vec(), Some(vec![1.0; 4])).unwrap()
}

fn rubber(choices: &Choices) -> Hooke<2> {
    let poisson = choices.number("material.rubber.poisson", 1.0 / 3.0);
    match one_of(choices.word("model.assumption").unwrap_or("plane-stress"), ["plane-stress", "plane-strain"]) {
        0 => Hooke::plane_stress(1.0, poisson),
        _ => Hooke::plane_strain(1.0, poisson),
    }
    .unwrap()
}

pub fn whole(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let net = panel([[0.0, 0.0], [48.0, 44.0], [0.0, 44.0], [48.0, 60.0]]);
    let body = s.shape(choices, Shape::new("panel", net, [4, 4]), rubber(choices));
    s.problem.fix(body.side("u0"), Components::All).unwrap();
    s.problem.traction(body.side("u1"), 1, 1.0 / 16.0).unwrap();
    s
}

pub fn graded(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let ratio = choices.number("let.first", 1e-2);
    let bodies = [
        ("low-left", [[0.0, 0.0], [24.0, 22.0], [0.0, 22.0], [24.0, 37.0]], [0.0, 0.0]),
        ("low-right", [[24.0, 22.0], [48.0, 44.0], [24.0, 37.0], [48.0, 52.0]], [1.0, 0.0]),
        ("high-left", [[0.0, 22.0], [24.0, 37.0], [0.0, 44.0], [24.0, 52.0]], [0.0, 1.0]),
        ("high-right", [[24.0, 37.0], [48.0, 52.0], [24.0, 52.0], [48.0, 60.0]], [1.0, 1.0]),
    ]
    .map(|(name, corners, toward)| {
        let grading = toward.map(|toward| Some(Grading { toward, ratio }));
        let by_default = Discretisation { degree: 3, ..Discretisation::default() };
        s.shape(choices, Shape { grading, by_default, ..Shape::new(name, panel(corners), [8, 8]) }, rubber(choices))
    });
    s.problem.glue_touching(&bodies, None).unwrap();
    for [left, right] in [[bodies[0], bodies[1]], [bodies[2], bodies[3]]] {
        s.problem.fix(left.side("u0"), Components::All).unwrap();
        s.problem.traction(right.side("u1"), 1, 1.0 / 16.0).unwrap();
    }
    s
}
