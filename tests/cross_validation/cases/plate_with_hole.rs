//! A quarter of a square plate with a round hole, pulled along x; whole, and cut along r = 5/4 and tied.

use crate::choices::{Choices, Discretisation};
use crate::setting::{Setting, Shape};
use crate::tied::How;
use faying::geometry::shapes;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data};

fn plate() -> Hooke<2> {
    Hooke::plane_stress(1.0, 0.3).unwrap()
}

/// Pulls the edge x = 3/2; v1 is both edges.
fn pull(s: &mut Setting<1, 2>, body: BodyId) {
    s.problem.traction(body.side("v1"), 0, Data::of(|x, _| if x[0] > x[1] { 1.0 } else { 0.0 })).unwrap();
}

pub fn whole(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let body = s.shape(choices, Shape::new("plate", shapes::plate_with_hole(1.0, 1.5).unwrap(), [8, 4]), plate());
    s.problem.fix(body.side("u0"), Components::Y).unwrap();
    s.problem.fix(body.side("u1"), Components::X).unwrap();
    pull(&mut s, body);
    s
}

pub fn tied(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let ring = shapes::annulus_sector([0.0, 0.0], [1.0, 1.25], [0.0, 90.0]).unwrap();
    let inner = s.shape(choices, Shape::new("inner", ring, [8, 2]), plate());
    let outer = Shape::new("outer", shapes::plate_with_hole(1.25, 1.5).unwrap(), [6, 2]);
    let outer = s.shape(choices, Shape { by_default: Discretisation::fe(), ..outer }, plate());
    for body in [inner, outer] {
        s.problem.fix(body.side("u0"), Components::Y).unwrap();
        s.problem.fix(body.side("u1"), Components::X).unwrap();
    }
    pull(&mut s, outer);
    let multiplier = choices.word("interface.circle.multiplier").unwrap_or("auto").parse().unwrap();
    s.tie("circle", (inner, "v1"), (outer, "v0"), How::mortar(multiplier));
    s
}
