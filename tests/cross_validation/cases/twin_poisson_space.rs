//! Heat in space through bodies of varying conductivity: on straight cells with every load, and manufactured on curved ones.

use crate::choices::{Choices, Discretisation};
use crate::exact::{Expr, Solved, conductor};
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::{annulus_sector, brick};
use faying::problem::{Data, Value};
use faying::space::Divisions;

/// Held at a linear temperature on two faces that meet, fed through one, exchanging with its surroundings through another.
pub fn in_a_block(choices: &Choices) -> Setting<2, 3> {
    let mut s = Setting::new();
    let metal = conductor::<3>(|[x, y, z]| 1.0 + x * y + 0.5 * z);
    let elements = [Divisions::Breakpoints(vec![0.0, 0.4, 1.0]), Divisions::Total(1), Divisions::Total(1)];
    let shape = Shape::new("body", brick([0.0; 3], [1.0, 1.5, 0.8]).unwrap(), [1; 3]);
    let body = s.shape(choices, Shape { elements, by_default: Discretisation::fe(), ..shape }, metal);
    let p = &mut s.problem;
    p.source(body, vec![Data::of(|x, _| 1.0 + 4.0 * x[0] * x[1] - x[2] * x[2])]).unwrap();
    for side in ["u0", "v0"] {
        p.prescribe(body.side(side), 0, Data::of(|x, _| 1.0 + 2.0 * x[0] - x[1] + 0.5 * x[2])).unwrap();
    }
    p.traction(body.side("u1"), 0, Data::of(|x, _| x[1] * x[2] - 0.3)).unwrap();
    p.traction(body.side("w1"), 0, 0.2).unwrap();
    s.problem.spring(body.side("w1"), 0, Data::of(|x, _| 1.5 + x[0])).unwrap();
    s
}

/// A thick quarter of a tube: linear data on the two straight ends, fluxes on all other faces.
pub fn in_a_shell(choices: &Choices) -> Setting<2, 3> {
    let mut s = Setting::new();
    let metal = conductor::<3>(|[x, _, z]| 1.0 + 0.3 * x + 0.2 * z);
    let net = annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap().extrude(0.8);
    let body = s.shape(choices, Shape { by_default: Discretisation::fe(), ..Shape::new("body", net, [2, 1, 1]) }, metal);
    s.exact(Solved(|[x, y, z]: [Expr; 3]| [1.0 + 2.0 * x - y + z + x * y * (0.3 * z).exp()]));
    for side in ["u0", "u1"] {
        s.problem.prescribe(body.side(side), 0, Value::Exact).unwrap();
    }
    for side in ["v0", "v1", "w0", "w1"] {
        s.problem.traction(body.side(side), 0, Value::Exact).unwrap();
    }
    s
}
