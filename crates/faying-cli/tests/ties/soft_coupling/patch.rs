//! Linear fields across lines that do not match, for every pair of backends and every variant; the contracts of coupling and flux.

use super::coupled::{Bodies, KINDS, Kind};
use faying::assembly::{Blocks, Reduced};
use faying::check;
use faying::constraint::{ConstrainedSystem, ConstraintSolver, Direct};
use faying::coupling::interface::{MergedCurve, SlaveRule, Tolerance};
use faying::coupling::nitsche::{Nitsche, Variant};
use faying::coupling::{Coupling, CouplingError, Interface, InterfaceQuadrature, Rows, Side};
use faying::geometry::shapes::annulus_sector;
use faying::linalg::{Csr, Matrix, Triplets, Vector};
use faying::physics::{BodyFlux, Conductor, Flux, Hooke, Material, form};
use faying::space::{Field, PatchSpec};
use rayon::prelude::*;
use std::sync::Arc;

const VARIANTS: [Variant; 3] = [Variant::Symmetric, Variant::Unsymmetric, Variant::Incomplete];

#[derive(Clone, Copy, Debug)]
struct Case {
    kinds: [Kind; 2],
    elements: [usize; 2],
    slave: usize,
    degree: usize,
    variant: Variant,
}

/// Errors of the displacement, of lambda against minus the traction, and of the force that crosses; 1 where a contract is broken.
fn tied<const C: usize>(case: &Case, material: Arc<dyn Material<C, 2>>, gradient: Matrix<C, 2>) -> Result<[f64; 3], String> {
    let shift = Vector::<C>::from_fn(|c, _| 0.1 + 0.2 * c as f64);
    let exact = move |x: &Vector<2>| gradient * x + shift;
    let [a, b] = case.kinds;
    let lower = a.rectangle([0.0, 0.0], [1.0, 0.5], case.degree, [case.elements[0], 2]);
    let upper = b.rectangle([0.0, 0.5], [1.0, 1.0], case.degree, [case.elements[1], 2]);
    let extra = a.extra_points().max(b.extra_points());
    let mut model = Bodies::<C>::new(vec![lower, upper], &form(&*material).unwrap(), extra);
    let all =
        |sides: [&'static str; 3]| -> Vec<(&'static str, usize)> { sides.iter().flat_map(|&s| (0..C).map(move |c| (s, c))).collect() };
    model.fix(0, &all(["u0", "u1", "v0"]), &exact);
    model.fix(1, &all(["u0", "u1", "v1"]), &exact);
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    let flux =
        |k: usize| BodyFlux::<C, 1, 2>::new(model.bodies[k].space().clone(), sides[k].clone(), model.fields[k], material.clone()).unwrap();
    let fluxes = [flux(0), flux(1)];
    let (slave, master) = (case.slave, 1 - case.slave);
    let segments =
        MergedCurve::tied(case.degree + 1 + extra, Tolerance::Exact).segments(&*sides[slave].space, &*sides[master].space).unwrap();
    let side = |k: usize| Side { trace: &sides[k], field: model.fields[k], flux: Some(&fluxes[k] as &dyn Flux<1, 2>) };
    let interface = Interface {
        slave: side(slave),
        master: Some(side(master)),
        multiplier: &[],
        segments: &segments,
        master_segments: None,
        direction: None,
    };
    let nitsche = Nitsche { variant: case.variant, ..Nitsche::default() };
    if case.elements == [2, 3] {
        check::coupling(&nitsche, &interface, model.unknowns())?;
        for k in [0, 1] {
            check::flux::<C, 1, 2, f64>(&fluxes[k], &sides[k], &**model.bodies[k].space(), model.fields[k], &*material)?;
        }
    }
    let between = nitsche.assemble(&interface, model.unknowns()).map_err(|e| e.to_string())?.stiffness.to_csr();
    let matrices: Vec<&Csr> = model.matrices.iter().collect();
    let blocks = Blocks { bodies: &matrices, between: Some(&between) };
    let reduced = Reduced::try_new(blocks, &model.load, &model.prescribed, &[]).unwrap();
    let none = Triplets::new(0, reduced.num_free());
    let system = ConstrainedSystem {
        stiffness: &reduced.stiffness,
        load: &reduced.load,
        constraint: &Rows { slave: none.clone(), master: none },
        reaction: None,
        offset: &[],
        kind: &[],
        compliance: &[],
    };
    let solution = Direct::new().solve(&system).map_err(|e| e.to_string())?;
    let direct = solution.method.contains("LU") == (case.variant != Variant::Symmetric);
    let u = reduced.expand(&solution.unknowns);
    let lambda = nitsche.lambda(&interface, &u).map_err(|e| e.to_string())?;
    let normal = Vector::<2>::new(0.0, if slave == 0 { 1.0 } else { -1.0 });
    let traction = material.respond(&Vector::zeros(), &gradient).stress * normal;
    let worst = (0..C).flat_map(|c| lambda[c].iter().map(move |l| (l + traction[c]).abs())).fold(0.0, f64::max);
    // the stiffness pulls on both bodies alike
    let mut pull = vec![0.0; u.len()];
    between.mul(&u, &mut pull);
    let sum = |c: usize| pull.iter().skip(c).step_by(C).sum::<f64>().abs();
    let force = (0..C).map(sum).fold(0.0, f64::max) / pull.iter().map(|f| f.abs()).sum::<f64>();
    Ok([model.error(&u, &exact), worst, if direct { force } else { 1.0 }])
}

fn run<const C: usize>(material: Arc<dyn Material<C, 2>>, gradient: Matrix<C, 2>, elements: &[[usize; 2]]) {
    let mut cases = Vec::new();
    for (a, b) in KINDS.into_iter().flat_map(|a| KINDS.map(|b| (a, b))) {
        for (degree, (slave, variant)) in (1..=4).flat_map(|p| [0, 1].into_iter().flat_map(move |s| VARIANTS.map(|v| (p, (s, v))))) {
            cases.extend(elements.iter().map(|&elements| Case { kinds: [a, b], elements, slave, degree, variant }));
        }
    }
    let failures: Vec<String> = cases
        .par_iter()
        .filter_map(|case| match tied(case, material.clone(), gradient) {
            Ok([u, lambda, force]) if u < 1e-10 && lambda < 1e-9 && force < 1e-12 => None,
            other => Some(format!("{case:?}: {other:?}")),
        })
        .collect();
    assert!(failures.is_empty(), "{} of {} cases fail:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

#[test]
fn nitsche_reproduces_a_linear_displacement_for_all_pairs_and_variants() {
    run(Arc::new(Hooke::<2>::plane_strain(1.0, 0.3).unwrap()), Matrix::<2, 2>::new(0.3, -0.2, 0.5, 0.4), &[[2, 3]]);
}

#[test]
fn nitsche_reproduces_a_linear_temperature_for_all_pairs_and_variants() {
    run(Arc::new(Conductor::<2>::try_new(2.0).unwrap()), Matrix::<1, 2>::new(0.3, -0.2), &[[2, 3], [5, 16]]);
}

// Knots of low continuity and curved sides with rational maps keep the contracts, too.
#[test]
fn fluxes_and_couplings_of_curved_sides_and_repeated_knots_keep_their_contracts() {
    let hooke: Arc<dyn Material<2, 2>> = Arc::new(Hooke::<2>::plane_stress(3.0, 0.25).unwrap());
    for (kind, continuity) in [(Kind::Nurbs, 0), (Kind::Nurbs, 1), (Kind::Tensor, 0), (Kind::Triangle, 0)] {
        let net = |r: [f64; 2]| annulus_sector([0.0, 0.0], r, [0.0, 90.0]).unwrap();
        let spec = |r: [f64; 2], n: [usize; 2]| PatchSpec::new(net(r)).with_degree([3; 2]).with_continuity(continuity).with_elements(n);
        let body = kind.body(&spec([1.0, 2.0], [3, 1]));
        let space = body.space();
        let field = Field { first: 0, components: 2 };
        for side in ["v0", "v1", "u0"] {
            let trace = body.trace(side).unwrap();
            let flux = BodyFlux::<2, 1, 2>::new(space.clone(), trace.clone(), field, hooke.clone()).unwrap();
            check::flux::<2, 1, 2, f64>(&flux, &trace, &**space, field, &*hooke).unwrap_or_else(|e| panic!("{kind:?} {side}: {e}"));
        }
    }
}

// One square of one element of degree 1, k = 2, side y = 1: the flux is that of u = y, d = k² / k, and of u = (x - 1/2) (c + y), where
// c makes the energy least.
#[test]
fn the_stabilisation_is_the_eigenvalue_found_by_hand() {
    let body = Kind::Spline.rectangle([0.0, 0.0], [1.0, 1.0], 1, [1, 1]);
    let conductor: Arc<dyn Material<1, 2>> = Arc::new(Conductor::<2>::try_new(2.0).unwrap());
    let flux =
        BodyFlux::<1, 1, 2>::new(body.space().clone(), body.trace("v1").unwrap(), Field { first: 0, components: 1 }, conductor).unwrap();
    let found = Flux::<1, 2>::stabilisation(&flux, 0);
    // ∫ flux² = k² / 12, energy k (c² + c + 1/3 + 1/12), c = -1/2
    let odd = 2.0 / 12.0 / (0.25 - 0.5 + 1.0 / 3.0 + 1.0 / 12.0);
    assert!((found - f64::max(2.0, odd)).abs() < 1e-8, "{found}");
}

#[test]
fn interfaces_that_nitsche_cannot_couple_are_refused_in_words() {
    let bodies = [0.0, 0.5].map(|y| Kind::Spline.rectangle([0.0, y], [1.0, y + 0.5], 2, [2, 2]));
    let sides = [bodies[0].trace("v1").unwrap(), bodies[1].trace("v0").unwrap()];
    let fields = [Field { first: 0, components: 1 }, Field { first: bodies[0].space().num_functions(), components: 1 }];
    let conductor: Arc<dyn Material<1, 2>> = Arc::new(Conductor::<2>::try_new(1.0).unwrap());
    let fluxes =
        [0, 1].map(|k: usize| BodyFlux::<1, 1, 2>::new(bodies[k].space().clone(), sides[k].clone(), fields[k], conductor.clone()).unwrap());
    let segments = SlaveRule::tied(3, Tolerance::Exact).segments(&*sides[0].space, &*sides[1].space).unwrap();
    let side = |k: usize| Side { trace: &sides[k], field: fields[k], flux: Some(&fluxes[k] as &dyn Flux<1, 2>) };
    let good =
        Interface { slave: side(0), master: Some(side(1)), multiplier: &[], segments: &segments, master_segments: None, direction: None };
    let fails = |nitsche: Nitsche, interface: &Interface<'_, 1, 2>, part: &str| match nitsche.assemble(interface, 100) {
        Err(CouplingError::Missing(text)) => assert!(text.contains(part), "{text}"),
        other => panic!("{other:?}"),
    };
    let unknowns = 2 * bodies[0].space().num_functions();
    assert!(Nitsche::default().assemble(&good, unknowns).is_ok());
    fails(Nitsche::default(), &Interface { master_segments: Some(&segments), ..good }, "mixed integration has no meaning");
    fails(Nitsche::default(), &Interface { slave: Side { flux: None, ..side(0) }, ..good }, "fluxes of both bodies");
    let normals = vec![Vector::<2>::new(0.0, 1.0); segments.ds.len()];
    fails(Nitsche::default(), &Interface { direction: Some(&normals), ..good }, "direction");
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        fails(Nitsche { factor, ..Nitsche::default() }, &good, "must be positive");
    }
    for variant in [Variant::Symmetric, Variant::Incomplete] {
        fails(Nitsche { factor: 0.5, variant }, &good, "stable for factors from 1 on");
    }
    assert!(Nitsche { factor: 1e-6, variant: Variant::Unsymmetric }.assemble(&good, unknowns).is_ok());
    // against a rigid, immovable side the slave is held by its own bound
    let alone = Nitsche::default().assemble(&Interface { master: None, ..good }, unknowns).unwrap().stiffness;
    assert!(alone.to_csr().is_symmetric(1e-12) && alone.entries.iter().all(|e| e.0 < fields[1].first));
}
