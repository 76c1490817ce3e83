//! The quarter annulus, the quarter cylinder, and fields that vanish on their boundaries.

use faying::basis::BSpline;
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Matrix, Vector};
use faying::space::{BasisKind, Patch, PatchSpec};

/// A field with first and second derivatives: value, gradient, Hessian per component.
pub type Jet<const C: usize, const N: usize> = (Vector<C>, Matrix<C, N>, [Matrix<N, N>; C]);

/// B-splines of degree p and maximal smoothness on n x n elements over 1 < r < 2 in x, y > 0.
pub fn annulus(p: usize, n: usize) -> Patch<1, 2> {
    let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap();
    let spec = PatchSpec::new(net).with_degree([p; 2]).with_elements([n; 2]).with_basis(BasisKind::BSpline);
    Patch::try_new(&spec).unwrap()
}

/// The same over that annulus times 0 < z < 1.
pub fn cylinder(p: usize, n: usize) -> Patch<2, 3> {
    let flat = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap();
    let at = |z: f64| flat.points.iter().map(move |x| Vector::<3>::new(x[0], x[1], z));
    let points = at(0.0).chain(at(1.0)).collect();
    let weights = flat.weights.as_ref().map(|w| [w.clone(), w.clone()].concat());
    let [u, v] = flat.axes.clone();
    let net = ControlNet::try_new([u, v, BSpline::uniform(1, 1, 0)], points, weights).unwrap();
    let spec = PatchSpec::new(net).with_degree([p; 3]).with_elements([n; 3]).with_basis(BasisKind::BSpline);
    Patch::try_new(&spec).unwrap()
}

/// w = x y (s - 1)(s - 4), s = x² + y²: value, gradient, Hessian.
pub fn bubble(x: f64, y: f64) -> (f64, [f64; 2], [[f64; 2]; 2]) {
    let s = x * x + y * y;
    let (g, dg) = (s * s - 5.0 * s + 4.0, 2.0 * s - 5.0);
    let mixed = g + 2.0 * s * dg + 8.0 * x * x * y * y;
    (
        x * y * g,
        [y * (g + 2.0 * x * x * dg), x * (g + 2.0 * y * y * dg)],
        [[y * (6.0 * x * dg + 8.0 * x * x * x), mixed], [mixed, x * (6.0 * y * dg + 8.0 * y * y * y)]],
    )
}

/// (w, 0) or w alone in the plane.
pub fn plane_field<const C: usize>(x: &Vector<2>) -> Jet<C, 2> {
    let (w, g, h) = bubble(x[0], x[1]);
    let mut jet: Jet<C, 2> = (Vector::zeros(), Matrix::zeros(), [Matrix::zeros(); C]);
    jet.0[0] = w;
    for k in 0..2 {
        jet.1[(0, k)] = g[k];
        for l in 0..2 {
            jet.2[0][(k, l)] = h[k][l];
        }
    }
    jet
}

/// (w sin(pi z), 0, 0), or its first component alone.
pub fn solid_field<const C: usize>(x: &Vector<3>) -> Jet<C, 3> {
    let (w, g, h) = bubble(x[0], x[1]);
    let pi = std::f64::consts::PI;
    let (s, c) = (pi * x[2]).sin_cos();
    let mut jet: Jet<C, 3> = (Vector::zeros(), Matrix::zeros(), [Matrix::zeros(); C]);
    jet.0[0] = w * s;
    jet.1.set_row(0, &Vector::<3>::new(g[0] * s, g[1] * s, pi * w * c).transpose());
    for k in 0..2 {
        for l in 0..2 {
            jet.2[0][(k, l)] = h[k][l] * s;
        }
        jet.2[0][(k, 2)] = pi * g[k] * c;
        jet.2[0][(2, k)] = pi * g[k] * c;
    }
    jet.2[0][(2, 2)] = -pi * pi * w * s;
    jet
}
