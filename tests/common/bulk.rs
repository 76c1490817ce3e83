//! One body solved with library calls: Dirichlet projection, loads, reduction, direct solve, errors.

#![allow(clippy::unwrap_used, dead_code)]

use faying::assembly::{Equation, Errors, Prescribed, Reduced, dirichlet, errors, gauss_rules, load, stiffness, trace_load};
use faying::linalg::{Csr, Ldlt, LinearSolver, Matrix, Vector};
use faying::physics::{Material, form};
use faying::space::{Body, Field, Trace, field_at};

/// A field with first and second derivatives: value, gradient, hessian per component.
pub type Jet2<const C: usize, const N: usize> = (Vector<C>, Matrix<C, N>, [Matrix<N, N>; C]);
/// An exact solution.
pub type Exact<'a, const C: usize, const N: usize> = &'a (dyn Fn(&Vector<N>) -> Jet2<C, N> + Sync);
/// A load on a side, from place and outward normal.
pub type SideLoad<'a, const C: usize, const N: usize> = &'a dyn Fn(&Vector<N>, &Vector<N>) -> Vector<C>;

/// What holds and loads a body.
pub struct Problem<'a, const C: usize, const N: usize> {
    pub material: &'a dyn Material<C, N>,
    /// The exact solution: gives the source and the data below.
    pub exact: Exact<'a, C, N>,
    /// (side, component) with the exact value.
    pub held: Vec<(String, usize)>,
    /// (side, component) with value zero.
    pub fixed: Vec<(String, usize)>,
    /// Sides with the exact traction.
    pub pulled: Vec<String>,
    /// Sides with loads.
    pub loaded: Vec<(String, SideLoad<'a, C, N>)>,
    /// Gauss points beyond degree + 1 for matrices and loads.
    pub extra: usize,
    /// Gauss points beyond degree + 1 in norms.
    pub extra_norm: usize,
}

/// A solved body.
pub struct Solved<const C: usize> {
    pub u: Vec<f64>,
    pub reactions: Vec<f64>,
    pub stiffness: Csr<f64>,
    pub errors: Errors,
}

impl<'a, const C: usize, const N: usize> Problem<'a, C, N> {
    pub fn new(material: &'a dyn Material<C, N>, exact: Exact<'a, C, N>) -> Self {
        let (held, fixed, pulled, loaded) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { material, exact, held, fixed, pulled, loaded, extra: 0, extra_norm: 2 }
    }

    /// The exact values on `sides`, the exact traction on all others.
    pub fn held_on<const S: usize>(mut self, body: &dyn Body<S, N>, sides: &[&str]) -> Self {
        for side in body.sides() {
            if sides.contains(&side.as_str()) {
                self.held.extend((0..C).map(|c| (side.clone(), c)));
            } else {
                self.pulled.push(side);
            }
        }
        self
    }

    pub fn solve<const S: usize>(&self, body: &dyn Body<S, N>) -> Solved<C> {
        let space = &**body.space();
        let rules = gauss_rules(space, self.extra);
        let k = stiffness(space, &rules, &form(self.material).unwrap());
        let mut f = load::<C, N, N, _, _, _>(space, &rules, &|x: &Vector<N>| {
            let (_, gradient, hessian) = (self.exact)(x);
            -self.material.divergence(x, &gradient, &hessian)
        });
        for side in &self.pulled {
            let trace = body.trace(side).unwrap();
            let rules = gauss_rules(&*trace.space, self.extra);
            trace_load(&trace, &rules, &|x: &Vector<N>, n: &Vector<N>| self.material.respond(x, &(self.exact)(x).1).stress * n, &mut f);
        }
        for (side, value) in &self.loaded {
            let trace = body.trace(side).unwrap();
            trace_load(&trace, &gauss_rules(&*trace.space, self.extra), *value, &mut f);
        }
        let prescribed = self.prescribed(body);
        let none: [Equation; 0] = [];
        let reduced = Reduced::try_new(&[&k], &f, &prescribed, &none).unwrap();
        let mut v = vec![0.0; reduced.num_free()];
        if !v.is_empty() {
            let mut solver = Ldlt::new();
            solver.prepare(&reduced.stiffness).unwrap();
            solver.solve(&reduced.stiffness, &reduced.load, &mut v).unwrap();
        }
        let u = reduced.expand(&v);
        let reactions = reduced.residual(&[&k], &f, &[], &[], &u);
        let fine = gauss_rules(space, self.extra_norm);
        let errors = errors(space, &fine, &form(self.material).unwrap(), &u, &|x: &Vector<N>| {
            let (value, gradient, _) = (self.exact)(x);
            (value, gradient)
        });
        Solved { u, reactions, stiffness: k, errors }
    }

    fn prescribed<const S: usize>(&self, body: &dyn Body<S, N>) -> Vec<(usize, f64)> {
        let of = |side: &String| body.trace(side).unwrap();
        let held: Vec<(Trace<S, N>, usize)> = self.held.iter().map(|(side, c)| (of(side), *c)).collect();
        let fixed: Vec<(Trace<S, N>, usize)> = self.fixed.iter().map(|(side, c)| (of(side), *c)).collect();
        let exact = self.exact;
        let values: Vec<_> = (0..C).map(|c| move |x: &Vector<N>| exact(x).0[c]).collect();
        let mut conditions: Vec<Prescribed<'_, S, N>> =
            held.iter().map(|(trace, c)| Prescribed { trace, component: *c, value: Some(&values[*c]) }).collect();
        conditions.extend(fixed.iter().map(|(trace, c)| Prescribed { trace, component: *c, value: None }));
        dirichlet(&conditions, Field { first: 0, components: C }, self.extra, &mut Ldlt::new()).unwrap()
    }
}

/// The largest distance of the field from the exact one, and of its stress over the size of the stress, at 3^N points
/// of every element.
pub fn worst<const C: usize, const S: usize, const N: usize>(
    body: &dyn Body<S, N>,
    material: &dyn Material<C, N>,
    u: &[f64],
    exact: Exact<'_, C, N>,
) -> (f64, f64) {
    let space = &**body.space();
    let (mut value, mut stress, mut size) = (0.0f64, 0.0f64, 0.0f64);
    for e in 0..space.num_elements() {
        let points = faying::geometry::cell::grid::<N, f64>(space.cell(e), 2);
        for s in field_at::<C, N, _, _>(space, &Field { first: 0, components: C }, u, e, &points) {
            let (v, g, _) = exact(&s.x);
            let expected = material.respond(&s.x, &g).stress;
            value = value.max((s.value - v).amax());
            stress = stress.max((material.respond(&s.x, &s.gradient).stress - expected).amax());
            size = size.max(expected.amax());
        }
    }
    (value, stress / size)
}

/// Σ of the reactions of the functions on a side, one sum per component.
pub fn reaction<const C: usize, const S: usize, const N: usize>(trace: &Trace<S, N>, r: &[f64]) -> Vector<C> {
    Vector::from_fn(|c, _| trace.dofs.iter().map(|&i| r[C * i + c]).sum())
}
