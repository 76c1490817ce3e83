//! Patches whose functions are products, of every kind, and their copies that hide it: what the suites of `assembly::sum_factorization` share.
#![allow(dead_code, clippy::unwrap_used)]

#[allow(unused_imports)]
pub use super::plain::{Plain, apart, largest};

use faying::assembly::{Coefficient, Form, Tangent};
use faying::basis::{BSpline, Basis, Elements, LagrangeLine, Order, Rational, Refined, TensorProduct};
use faying::geometry::{Bounds, ControlPoints, Geometry, MapTable};
use faying::linalg::{Matrix, Vector};

pub type Line = Box<dyn Basis<1>>;

/// Hides the product structure of the map alone.
#[derive(Debug)]
pub struct Anyhow<G>(pub G);
impl<G: Elements> Elements for Anyhow<G> {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
}
impl<const N: usize, G: Geometry<N, N>> Geometry<N, N> for Anyhow<G> {
    fn map(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut MapTable<N, N>) {
        self.0.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N> {
        self.0.bounds(element)
    }
}

/// Numbers between 0 and 1 that look random.
pub fn noise(k: usize) -> f64 {
    (12.9898 * (k as f64 + 1.0)).sin().mul_add(43758.5453, 0.0).rem_euclid(1.0)
}

/// Graded elements.
pub fn breakpoints(elements: usize) -> Vec<f64> {
    (0..=elements).map(|k| (k as f64 / elements as f64).powf(1.4)).collect()
}

/// Graded splines whose knots are simple, double and p-fold (C^0) in turn.
pub fn spline(degree: usize, elements: usize) -> Line {
    let p = degree as isize;
    let continuity: Vec<isize> = (1..elements).map(|k| [p - 1, (p - 2).max(0), 0][k % 3]).collect();
    Box::new(BSpline::from_breakpoints(degree, &breakpoints(elements), &continuity))
}

/// Graded splines of maximal smoothness.
pub fn smooth(degree: usize, elements: usize) -> Line {
    Box::new(BSpline::from_breakpoints(degree, &breakpoints(elements), &vec![degree as isize - 1; elements - 1]))
}

pub fn lagrange(degree: usize, elements: usize) -> Line {
    Box::new(LagrangeLine::new(degree, elements))
}

/// A bent box: the net of `axes` at its own grid, moved a little; as many points as functions.
pub fn net<const N: usize>(axes: &[Line; N]) -> Vec<Vector<N>> {
    let counts = axes.each_ref().map(|a| a.num_functions());
    (0..counts.iter().product())
        .map(|i| {
            let at: [f64; N] =
                std::array::from_fn(|k| (i / counts[..k].iter().product::<usize>() % counts[k]) as f64 / (counts[k] - 1) as f64);
            let size = counts.iter().max().copied().unwrap_or(1) as f64;
            Vector::from_fn(|k, _| (1.0 + 0.5 * k as f64) * at[k] + 0.15 / size * noise(N * i + k) + 0.1 * at[(k + 1) % N] * at[k])
        })
        .collect()
}

pub fn weights(functions: usize) -> Vec<f64> {
    (0..functions).map(|i| 0.7 + 0.6 * noise(7 * i)).collect()
}

/// A coarse axis on the fine elements: two quadratic spans.
pub fn coarse(elements: usize) -> Line {
    let inner = BSpline::<f64>::uniform(2, 2, 1);
    let cells = (0..elements).map(|e| {
        let (t0, t1) = (e as f64 / elements as f64, (e + 1) as f64 / elements as f64);
        let element = usize::from(t0 + t1 > 1.0);
        (element, 2.0 * t0 - element as f64, 2.0 * (t1 - t0))
    });
    Box::new(Refined::new(inner, cells.collect()))
}

/// All maps of a space with `axes`: isoparametric, coarse, rational, and one without structure.
pub fn maps<const N: usize>(axes: impl Fn() -> [Line; N]) -> Vec<Box<dyn Geometry<N, N>>> {
    let counts = axes().each_ref().map(|a| a.num_elements());
    let rough = || counts.map(|n| coarse(n + n % 2));
    let mut all: Vec<Box<dyn Geometry<N, N>>> = Vec::new();
    all.push(Box::new(ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    if counts.iter().all(|n| n % 2 == 0) {
        all.push(Box::new(ControlPoints { basis: TensorProduct::new(rough()), points: net(&rough()) }));
        let product = TensorProduct::new(rough());
        let w = weights(product.num_functions());
        all.push(Box::new(ControlPoints { basis: Rational::new::<N>(product, w), points: net(&rough()) }));
    }
    all.push(Box::new(Anyhow(ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) })));
    all
}

/// A tangent without any symmetry, or with that of an energy.
pub fn tangent<const C: usize, const N: usize>(x: &Vector<N>, symmetric: bool) -> Tangent<C, N> {
    let entry = |i: usize, j: usize, k: usize, l: usize| {
        let (a, b) = (i * N + j, k * N + l);
        let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
        f64::from(u8::from(a == b)) * 6.0 + noise(31 * a + b) + 0.3 * x[0] * noise(a + 17 * b)
    };
    std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i, j, k, l))))
}

/// Every kind of coefficient for C components.
pub fn forms<'a, const C: usize, const N: usize>() -> Vec<Form<'a, C, N>> {
    let origin = Vector::<N>::repeat(0.3);
    let mut all = vec![Form::laplace()];
    for symmetric in [true, false] {
        all.push(Form::new(Coefficient::Constant(tangent(&origin, symmetric)), symmetric));
        all.push(Form::new(Coefficient::PerPoint(Box::new(move |x: &Vector<N>| tangent(x, symmetric))), symmetric));
    }
    all
}
