//! A manufactured displacement of a block whose top is curved both ways, of varying stiffness: held (as the solution is) below, tractions on
//! all other faces.

use crate::choices::{Choices, Discretisation};
use crate::exact::{Expr, Solved, elastic};
use crate::setting::{Setting, Shape};
use faying::geometry::ControlNet;
use faying::linalg::Vector;
use faying::physics::Assumption;
use faying::problem::Value;

/// The middle of the top is lifted by 0.4 in its control point.
fn dome() -> ControlNet<3, 3> {
    let places = [0.0, 0.5, 1.0];
    let layer = |heights: [f64; 9]| {
        let at = move |k: usize| Vector::from([places[k % 3], places[k / 3], heights[k]]);
        (0..9).map(at)
    };
    let points = layer([0.0; 9]).chain(layer([0.8, 0.9, 0.8, 0.9, 1.2, 0.9, 0.8, 0.9, 0.8])).collect();
    let quadratic = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    ControlNet::from_knots([2, 2, 1], [quadratic(), quadratic(), vec![0.0, 0.0, 1.0, 1.0]], points, None).unwrap()
}

pub fn said(choices: &Choices) -> Setting<2, 3> {
    let mut s = Setting::new();
    let rubber = elastic::<3>(|[x, y, z]| 10.0 + x + 2.0 * z * y, 0.3, Assumption::Solid);
    let body = s.shape(choices, Shape { by_default: Discretisation::fe(), ..Shape::new("body", dome(), [2, 1, 1]) }, rubber);
    s.exact(Solved(|[x, y, z]: [Expr; 3]| [0.01 * z * (1.0 + y.sin()), 0.02 * z * x, -0.01 * z * (0.3 * x).exp()]));
    for c in 0..3 {
        s.problem.prescribe(body.side("w0"), c, Value::Exact).unwrap();
        for side in ["u0", "u1", "v0", "v1", "w1"] {
            s.problem.traction(body.side(side), c, Value::Exact).unwrap();
        }
    }
    s
}
