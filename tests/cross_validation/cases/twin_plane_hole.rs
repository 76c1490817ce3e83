//! A manufactured displacement of a quarter plate with a hole, of varying stiffness: symmetric supports with the shear that belongs to it,
//! tractions on all other sides.

use super::twin_plane_box::assumption;
use crate::choices::{Choices, Discretisation};
use crate::exact::{Solved, elastic};
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::plate_with_hole;
use faying::problem::{Components, Value};

pub fn said(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let plate = elastic(|[x, y, _]| 10.0 + x + 0.5 * x * y, 0.3, assumption(choices));
    let shape = Shape::new("body", plate_with_hole(1.0, 2.5).unwrap(), [4, 2]);
    let body = s.shape(choices, Shape { by_default: Discretisation::fe(), ..shape }, plate);
    s.exact(Solved(|[x, y, _]: [crate::exact::Expr; 3]| [0.01 * x * (1.0 + y.sin()), -0.01 * y * (0.5 * x).cos()]));
    let p = &mut s.problem;
    p.fix(body.side("u0"), Components::Y).unwrap();
    p.traction(body.side("u0"), 0, Value::Exact).unwrap();
    p.prescribe(body.side("u1"), 0, Value::Exact).unwrap();
    p.traction(body.side("u1"), 1, Value::Exact).unwrap();
    for side in [body.side("v0"), body.side("v1")] {
        p.traction(side, 0, Value::Exact).unwrap();
        p.traction(side, 1, Value::Exact).unwrap();
    }
    s
}
