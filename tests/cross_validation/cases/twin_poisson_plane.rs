//! Heat in the plane through bodies of varying conductivity: on straight cells with every load, and manufactured on curved ones.

use crate::choices::{Choices, Discretisation};
use crate::exact::{Expr, Solved, conductor};
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::{annulus_sector, rectangle};
use faying::problem::{Data, Value};
use faying::space::Divisions;

/// Held at a linear temperature on two sides that meet, fed through a third, exchanging with its surroundings through the fourth.
pub fn on_a_box(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let metal = conductor::<2>(|[x, y, _]| 1.0 + x * y + 0.5 * x.sin());
    let elements = [Divisions::Breakpoints(vec![0.0, 0.4, 1.0]), Divisions::Total(2)];
    let shape = Shape::new("body", rectangle([0.0, 0.0], [1.0, 1.5]).unwrap(), [1, 1]);
    let body = s.shape(choices, Shape { elements, by_default: Discretisation::fe(), ..shape }, metal);
    let p = &mut s.problem;
    p.source(body, vec![Data::of(|x, _| 1.0 + 4.0 * x[0] * x[1].exp())]).unwrap();
    for side in ["u0", "v0"] {
        p.prescribe(body.side(side), 0, Data::of(|x, _| 1.0 + 2.0 * x[0] - x[1])).unwrap();
    }
    p.traction(body.side("u1"), 0, Data::of(|x, _| (2.0 * x[1]).sin() - 0.3)).unwrap();
    p.traction(body.side("v1"), 0, 0.2).unwrap();
    s.problem.spring(body.side("v1"), 0, Data::of(|x, _| 1.5 + x[0])).unwrap();
    s
}

/// Linear data on the two straight sides, so that projection and interpolation agree, and fluxes on the arcs.
pub fn on_a_ring(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let metal = conductor::<2>(|[x, y, _]| 1.0 + 0.3 * x + 0.2 * y * y);
    let shape = Shape::new("body", annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap(), [3, 2]);
    let body = s.shape(choices, Shape { by_default: Discretisation::fe(), ..shape }, metal);
    s.exact(Solved(|[x, y, _]: [Expr; 3]| [1.0 + 2.0 * x - y + x * y * (0.5 * x).exp()]));
    for side in ["u0", "u1"] {
        s.problem.prescribe(body.side(side), 0, Value::Exact).unwrap();
    }
    for side in ["v0", "v1"] {
        s.problem.traction(body.side(side), 0, Value::Exact).unwrap();
    }
    s
}
