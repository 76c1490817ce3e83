//! The three discrete cones of contact, and its mixed integration.

use crate::common::coupled;
use coupled::{Bodies, KINDS, Kind};
use faying::assembly::{gauss_rules, trace_load};
use faying::basis::{BSpline, Basis, Order, ShapeTable};
use faying::constraint::{ActiveSet, Condensed, ConstrainedSolution, ConstraintSolver, Direct, SolveError};
use faying::contact::{Cone, ContactError, ContactResultants, ContactRows, Opponent};
use faying::coupling::interface::{MasterSums, MergedCurve, SlaveRule};
use faying::coupling::multiplier::{Ends, MultiplierKind, build};
use faying::coupling::{InterfaceQuadrature, Segments, Side};
use faying::geometry::shapes::annulus_sector;
use faying::geometry::{Geometry, MapTable};
use faying::linalg::Vector;
use faying::physics::{Hooke, form, pressure};
use faying::quadrature::gauss_legendre;
use faying::space::{PatchSpec, Trace};
use faying_cli::case::{Case, ReadOptions};
use faying_cli::errors::Diagnostics;
use faying_cli::{Registry, RunResult};
use rayon::prelude::*;

const YOUNG: f64 = 1.0;
const POISSON: f64 = 0.3;
const CONES: [Cone; 3] = [Cone::Coefficients, Cone::Weights, Cone::Values];

fn hooke() -> Hooke<2> {
    Hooke::plane_strain(YOUNG, POISSON).unwrap()
}

/// How a contact is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    Slave,
    Mixed,
    Merged,
}

struct Pressed {
    solution: ConstrainedSolution,
    lambda: Vec<f64>,
    contact: ContactRows<1, 2>,
    sent: ContactResultants<2>,
}

/// Adds a pressure on a side to the load.
fn press(model: &mut Bodies<2>, body: usize, side: &str, p: impl Fn(&Vector<2>) -> f64 + Sync + Send + 'static) {
    let trace = model.trace(body, side);
    let rules = gauss_rules(&*trace.space, model.extra + 4);
    let field = model.fields[body];
    let load = &mut model.load[field.first..];
    trace_load(&trace, &rules, &pressure(p), load);
}

/// The contact of the slave side of a body with the master side of another one.
fn contact(
    model: &Bodies<2>,
    slave: (usize, &Trace<1, 2>),
    master: (usize, &Trace<1, 2>),
    psi: &dyn Basis<1>,
    (rule, points): (Rule, usize),
    cone: Cone,
    gap: &dyn Fn(&Vector<2>, f64) -> f64,
) -> ContactRows<1, 2> {
    let side = |(body, trace): (usize, _)| Side { trace, field: model.fields[body], flux: None };
    let sides = (&*slave.1.space, &*master.1.space);
    let segments = match rule {
        Rule::Merged => MergedCurve::facing(points, None).segments(sides.0, sides.1),
        _ => SlaveRule::facing(points, None).segments(sides.0, sides.1),
    };
    let built = ContactRows::new(side(slave), Opponent::Master(side(master)), psi, segments.unwrap(), gap, model.unknowns()).unwrap();
    let built = match rule {
        Rule::Mixed => {
            let second = MasterSums::facing(points, None).segments(sides.0, sides.1).unwrap();
            built.with_master_sums(side(slave), side(master), psi, &second, model.unknowns()).unwrap()
        }
        _ => built,
    };
    built.with_cone(cone, psi).unwrap()
}

fn solve(
    model: &Bodies<2>,
    contact: ContactRows<1, 2>,
    psi: &dyn Basis<1>,
    solver: &mut dyn ConstraintSolver,
) -> Result<Pressed, SolveError> {
    let rows = contact.transformed(&contact.rows).into_owned();
    let reaction = contact.reaction.as_ref().map(|b| contact.transformed(b).into_owned());
    let solution = model.solve(&rows, reaction.as_ref(), &contact.transformed_offset(), &contact.kinds(), solver)?;
    let lambda = contact.multipliers(&solution.multipliers);
    let sent = contact.transmitted(psi, &lambda);
    Ok(Pressed { solution, lambda, contact, sent })
}

fn direct() -> ActiveSet<Direct> {
    ActiveSet::new(Direct::new())
}

const GRID: [f64; 5] = [0.0, 0.2, 0.45, 0.8, 1.0];

/// A unit square of two halves of 4 x 2 elements that do not match, sliding on their left; pressed by `p` from above.
fn halves(kinds: [Kind; 2], degree: usize, p: impl Fn(&Vector<2>) -> f64 + Sync + Send + 'static) -> Bodies<2> {
    let [a, b] = kinds;
    let lower = a.rectangle([0.0, 0.0], [1.0, 0.5], degree, [4, 2]);
    let mut net = faying::geometry::shapes::rectangle([0.0, 0.5], [1.0, 1.0]).unwrap();
    if b == Kind::Nurbs {
        net = coupled::weighted(&net, degree.min(2));
    }
    let degree_b = if b == Kind::Triangle { degree.min(4) } else { degree };
    let grid = [GRID.to_vec(), vec![0.0, 0.5, 1.0]];
    let upper = b.body(&PatchSpec::new(net).with_degree([degree_b; 2]).with_breakpoints(grid));
    let extra = a.extra_points().max(b.extra_points());
    let mut model = Bodies::<2>::new(vec![lower, upper], &form(&hooke()).unwrap(), extra);
    model.fix(0, &[("v0", 1), ("u0", 0)], &|_| Vector::<2>::zeros());
    model.fix(1, &[("u0", 0)], &|_| Vector::<2>::zeros());
    press(&mut model, 1, "v1", p);
    model
}

// Seed, test 1, for the cones and for mixed integration: sigma_yy = -1.25e-3 everywhere; the sums over the slave alone miss it.
#[test]
fn a_constant_pressure_passes_for_every_cone_multiplier_backend_and_integration() {
    let p = 1.25e-3;
    let mut cases = Vec::new();
    for a in KINDS {
        for b in KINDS {
            for slave in 0..2 {
                for multiplier in [MultiplierKind::Lowered(0), MultiplierKind::Lowered(2), MultiplierKind::Constant, MultiplierKind::Dual] {
                    for cone in CONES.into_iter().filter(|c| *c != Cone::Values || multiplier != MultiplierKind::Dual) {
                        for rule in [Rule::Merged, Rule::Mixed] {
                            cases.push((a, b, slave, multiplier, cone, rule));
                        }
                    }
                }
            }
        }
    }
    let exact = |x: &Vector<2>| Vector::<2>::new(p * POISSON * (1.0 + POISSON) * x[0], -p * (1.0 - POISSON * POISSON) * x[1]) / YOUNG;
    let failures: Vec<String> = cases
        .par_iter()
        .filter_map(|&(a, b, slave, multiplier, cone, rule)| {
            let model = halves([a, b], 2, move |_| p);
            let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
            let psi = build(&sides[slave].space, multiplier, &[]).unwrap();
            let other = (1 - slave, &sides[1 - slave]);
            let built = contact(&model, (slave, &sides[slave]), other, &*psi, (rule, 3 + model.extra), cone, &|_, g| g);
            let r = solve(&model, built, &*psi, &mut direct()).unwrap();
            let up = if slave == 1 { 1.0 } else { -1.0 };
            let defects = [
                model.error(&r.solution.unknowns, &exact) / p,
                (r.sent.least_pressure - p).abs().max((r.sent.largest_pressure - p).abs()) / p,
                (r.sent.force - Vector::<2>::new(0.0, up * p)).amax() / p,
                (r.sent.area - 1.0).abs(),
            ];
            let iterations = r.solution.active_set.as_ref().unwrap().iterations;
            (defects.iter().any(|d| *d > 1e-10) || iterations > 5)
                .then(|| format!("{a:?} {b:?} slave {slave} {multiplier} {cone:?} {rule:?}: {defects:?}, {iterations} iterations"))
        })
        .collect();
    assert!(failures.is_empty(), "{} failures of {} cases:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

#[test]
fn sums_over_the_slave_alone_miss_the_constant_pressure() {
    let model = halves([Kind::Spline; 2], 2, |_| 1.25e-3);
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    let psi = build(&sides[1].space, MultiplierKind::Auto, &[]).unwrap();
    let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Slave, 3), Cone::Coefficients, &|_, g| g);
    let r = solve(&model, built, &*psi, &mut direct()).unwrap();
    assert!(r.sent.largest_pressure - r.sent.least_pressure > 1e-3 * 1.25e-3);
}

/// x of a dense system, by elimination with pivoting.
fn dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let p = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, p);
        b.swap(k, p);
        for i in k + 1..n {
            let f = a[i][k] / a[k][k];
            let row = a[k].clone();
            a[i].iter_mut().zip(&row).skip(k).for_each(|(x, y)| *x -= f * y);
            b[i] -= f * b[k];
        }
    }
    for k in (0..n).rev() {
        b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    b
}

/// T⁻¹ by other means than the crate's: integrals by 14 points per element, values at the Greville points of B-spline knots.
fn cone_matrix(cone: Cone, psi: &dyn Basis<1>, slave: &Trace<1, 2>, spline: &BSpline) -> Vec<Vec<f64>> {
    let m = psi.num_functions();
    let mut out = vec![vec![0.0; m]; m];
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    match cone {
        Cone::Weights => {
            let rule = gauss_legendre::<f64>(14);
            for e in 0..psi.num_elements() {
                psi.active(e, &mut ids);
                psi.tabulate(e, &rule.points, Order::Values, &mut table);
                slave.space.map(e, &rule.points, Order::Gradients, &mut map);
                for (q, &w) in rule.weights.iter().enumerate() {
                    let ds = w * map.jacobian[q].column(0).norm();
                    for (&j, &a) in ids.iter().zip(table.values(q)) {
                        ids.iter().zip(table.values(q)).for_each(|(&k, &b)| out[j][k] += a * b * ds);
                    }
                }
            }
        }
        Cone::Values => {
            for (j, &t) in spline.greville().iter().enumerate() {
                let (e, xi) = spline.find(t);
                psi.active(e, &mut ids);
                psi.tabulate(e, &[Vector::<1>::new(xi)], Order::Values, &mut table);
                ids.iter().zip(table.values(0)).for_each(|(&k, &v)| out[j][k] = v);
            }
        }
        _ => (0..m).for_each(|j| out[j][j] = 1.0),
    }
    out
}

/// A block lifted over part of its length by a parabola: partial contact.
fn lifted(degree: usize, elements: usize) -> (Bodies<2>, Vec<f64>) {
    let lower = Kind::Spline.rectangle([0.0, 0.0], [1.0, 0.5], degree, [elements - 1, 2]);
    let net = faying::geometry::shapes::rectangle([0.0, 0.5], [1.0, 1.0]).unwrap();
    let breaks: Vec<f64> = (0..=elements).map(|k| (k as f64 / elements as f64).powf(1.2)).collect();
    let grid = [breaks.clone(), vec![0.0, 0.4, 1.0]];
    let upper = Kind::Spline.body(&PatchSpec::new(net).with_degree([degree; 2]).with_breakpoints(grid));
    let mut model = Bodies::<2>::new(vec![lower, upper], &form(&hooke()).unwrap(), 0);
    model.fix(0, &[("v0", 1), ("u0", 0)], &|_| Vector::<2>::zeros());
    model.fix(1, &[("u0", 0), ("v1", 0)], &|_| Vector::<2>::zeros());
    press(&mut model, 1, "v1", |x| 0.01 * (1.0 - 0.5 * x[0]));
    (model, breaks)
}

fn parabola(x: &Vector<2>, g: f64) -> f64 {
    g + 0.02 * x[0] * x[0]
}

#[test]
fn the_end_of_a_partial_contact_is_feasible_and_complementary_in_every_cone() {
    // degree of the bodies, and of the multiplier with its continuity
    for (degree, q, continuity) in [(4, 2, 1), (4, 4, 3), (3, 3, 2), (3, 1, 0)] {
        let (model, breaks) = lifted(degree, 11);
        let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
        let kind = MultiplierKind::Uniform { degree: q, continuity: Some(continuity), ends: Ends::Full };
        let psi = build(&sides[1].space, kind, &[]).unwrap();
        let spline = BSpline::<f64>::from_breakpoints(q, &breaks, &vec![continuity; breaks.len() - 2]);
        let mut areas = Vec::new();
        for cone in CONES {
            let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Merged, degree + 1), cone, &parabola);
            let r = solve(&model, built, &*psi, &mut direct()).unwrap();
            let name = format!("{cone:?}, degree {q} C{continuity}");
            let m = r.lambda.len();
            let matrix = cone_matrix(cone, &*psi, &sides[1], &spline);
            let mu: Vec<f64> = matrix.iter().map(|row| row.iter().zip(&r.lambda).map(|(a, l)| a * l).sum()).collect();
            let scale = mu.iter().fold(0.0f64, |s, v| s.max(v.abs()));
            // r_j = ∫ ψ_j (gap) ds, and the cone's rows Tᵀ r by elimination
            let mut weak = r.contact.offset.clone();
            for &(i, j, v) in r.contact.rows.slave.entries.iter().chain(&r.contact.rows.master.entries) {
                weak[i] += v * r.solution.unknowns[j];
            }
            let transposed: Vec<Vec<f64>> = (0..m).map(|i| (0..m).map(|j| matrix[j][i]).collect()).collect();
            let turned = dense(transposed.clone(), weak);
            let weights = dense(transposed, r.contact.weights.clone());
            let gaps: Vec<f64> = (0..m).map(|j| turned[j] / weights[j]).collect();
            let open = gaps.iter().fold(0.0f64, |s, v| s.max(v.abs()));
            for j in 0..m {
                assert!(mu[j] <= 1e-12 * scale, "{name}: mu_{j} = {:e} of {scale:e}", mu[j]);
                assert!(gaps[j] >= -1e-12 * open, "{name}: gap_{j} = {:e} of {open:e}", gaps[j]);
                assert!((mu[j] * gaps[j]).abs() <= 1e-12 * scale * open, "{name}: product {j}");
                let told = r.contact.lumped_gap(&r.solution.unknowns)[j].unwrap();
                assert!((told - gaps[j]).abs() < 1e-12 * open && (r.solution.multipliers[j] - mu[j]).abs() < 1e-11 * scale, "{name}");
            }
            let (active, all) = (r.solution.active.iter().filter(|&&a| a).count(), m);
            assert!(active > 1 && active < all, "{name}: {active} of {all} are active");
            assert!((r.sent.force[1] - 0.0075).abs() < 1e-10, "{name}: {:?}", r.sent.force);
            areas.push(r.sent.area);
        }
        // one zone to within two elements
        assert!(areas.iter().all(|a| (a - areas[0]).abs() < 0.2), "degree {q}: {areas:?}");
    }
}

#[test]
fn where_everything_is_active_all_cones_have_one_solution() {
    let model = halves([Kind::Spline, Kind::Nurbs], 4, |x| 0.01 * (1.0 + 0.3 * (2.0 * x[0]).sin()));
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    let psi = build(&sides[1].space, MultiplierKind::Lowered(2), &[]).unwrap();
    let answers = CONES.map(|cone| {
        let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Merged, 8), cone, &|_, g| g);
        solve(&model, built, &*psi, &mut direct()).unwrap()
    });
    for r in &answers {
        assert!(r.solution.active.iter().all(|&a| a));
        let far = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(far(&r.lambda, &answers[0].lambda) < 1e-12 && far(&r.solution.unknowns, &answers[0].solution.unknowns) < 1e-12);
    }
}

#[test]
fn cones_of_constants_are_one_and_values_of_degree_one_are_coefficients() {
    let (model, _) = lifted(3, 11);
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    for (kind, same) in [(MultiplierKind::Constant, &CONES[..]), (MultiplierKind::Lowered(2), &[Cone::Coefficients, Cone::Values][..])] {
        let psi = build(&sides[1].space, kind, &[]).unwrap();
        let answers: Vec<Pressed> = same
            .iter()
            .map(|&cone| {
                let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Merged, 4), cone, &parabola);
                solve(&model, built, &*psi, &mut direct()).unwrap()
            })
            .collect();
        for r in &answers[1..] {
            assert_eq!(r.solution.active, answers[0].solution.active);
            let far = r.lambda.iter().zip(&answers[0].lambda).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(far < 1e-12, "{kind}: {far:e}");
        }
    }
}

// Contained cones: coefficients <= 0 are values <= 0 and integrals <= 0, and not the other way round.
#[test]
fn the_cone_of_coefficients_lies_in_both_others() {
    let (model, _) = lifted(4, 6);
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    let psi = build(&sides[1].space, MultiplierKind::Lowered(2), &[]).unwrap();
    let of = |cone| contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Merged, 5), cone, &parabola);
    let m = psi.num_functions();
    for cone in [Cone::Weights, Cone::Values] {
        let built = of(cone);
        for j in 0..m {
            let unit = |s: f64| (0..m).map(|k| if k == j { s } else { 0.0 }).collect::<Vec<_>>();
            assert!(built.in_cone(&unit(-1.0)).iter().all(|&v| v <= 1e-15));
            // and back: T of a unit vector has both signs inside the side
            let lambda = built.multipliers(&unit(-1.0));
            assert!(j == 0 || j == m - 1 || lambda.iter().any(|&v| v > 0.0), "{cone:?} {j}");
            let again = built.in_cone(&lambda);
            assert!(again.iter().zip(unit(-1.0)).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
}

// A slave that overhangs its master: functions beyond it are open, the others make one cone, and the force is what is applied.
#[test]
fn sides_that_face_each_other_in_part_have_every_cone() {
    for kind in KINDS {
        let lower = kind.rectangle([0.0, 0.0], [1.0, 0.5], 2, [5, 2]);
        let upper = Kind::Spline.rectangle([0.0, 0.5], [1.57, 1.0], 4, [9, 2]);
        let mut model = Bodies::<2>::new(vec![lower, upper], &form(&hooke()).unwrap(), kind.extra_points());
        model.fix(0, &[("v0", 0), ("v0", 1)], &|_| Vector::<2>::zeros());
        model.fix(1, &[("u0", 0), ("v1", 1)], &|x| Vector::<2>::new(0.0, if x[1] > 0.9 { -1e-3 } else { 0.0 }));
        let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
        let psi = build(&sides[1].space, MultiplierKind::Lowered(2), &[]).unwrap();
        let mut forces = Vec::new();
        for cone in CONES {
            let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Merged, 8), cone, &|_, g| g);
            assert!(built.transformed_weights().iter().zip(&built.facing).all(|(&w, &f)| (w > 0.0) == f), "{kind:?} {cone:?}");
            let r = solve(&model, built, &*psi, &mut direct()).unwrap();
            assert!((r.contact.segments.report.covered - 1.0).abs() < 1e-12);
            assert!(!r.contact.facing[r.lambda.len() - 1] && r.lambda[r.lambda.len() - 1] == 0.0);
            let mu = &r.solution.multipliers;
            let scale = mu.iter().fold(0.0f64, |s, v| s.max(v.abs()));
            assert!(mu.iter().all(|&v| v <= 1e-12 * scale));
            forces.push(r.sent.force[1]);
        }
        println!("{kind:?}: forces {forces:?}");
        // cones differ at the rim alone, where the pressure is singular
        assert!(forces.iter().all(|f| (f / forces[0] - 1.0).abs() < 0.02), "{kind:?}: {forces:?}");
    }
}

/// Two quarter rings that meet at radius 1.5 with elements that do not match, inner and outer, pressed by p.
fn rings(
    kinds: [Kind; 2],
    elements: [usize; 2],
    degree: usize,
    p: impl Fn(&Vector<2>) -> f64 + Clone + Sync + Send + 'static,
) -> Bodies<2> {
    let part = |kind: Kind, radius: [f64; 2], n: usize| {
        let net = annulus_sector([0.0, 0.0], radius, [0.0, 90.0]).unwrap();
        kind.body(&PatchSpec::new(net).with_degree([degree; 2]).with_elements([n, 2]))
    };
    let bodies = vec![part(kinds[0], [1.0, 1.5], elements[0]), part(kinds[1], [1.5, 2.0], elements[1])];
    let mut model = Bodies::<2>::new(bodies, &form(&hooke()).unwrap(), 4);
    for body in 0..2 {
        model.fix(body, &[("u0", 1), ("u1", 0)], &|_| Vector::<2>::zeros());
    }
    press(&mut model, 0, "v0", p.clone());
    press(&mut model, 1, "v1", p);
    model
}

// A hydrostatic state: exact maps have it with every cone, up to the quadrature of rational functions.
#[test]
fn a_hydrostatic_state_crosses_an_arc_in_every_cone_and_mixed() {
    let p = 0.01;
    let exact = |x: &Vector<2>| x * (-p * (1.0 + POISSON) * (1.0 - 2.0 * POISSON) / YOUNG);
    for slave in 0..2 {
        let model = rings([Kind::Nurbs; 2], [5, 4], 3, move |_| p);
        let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
        let psi = build(&sides[slave].space, MultiplierKind::Lowered(0), &[false, false]).unwrap();
        for cone in CONES {
            for rule in [Rule::Merged, Rule::Mixed] {
                let built = contact(&model, (slave, &sides[slave]), (1 - slave, &sides[1 - slave]), &*psi, (rule, 11), cone, &|_, g| g);
                let r = solve(&model, built, &*psi, &mut direct()).unwrap();
                let error = model.error(&r.solution.unknowns, &exact) / p;
                assert!(error < 1e-8, "slave {slave} {cone:?} {rule:?}: {error:e}");
                assert!((r.sent.least_pressure / p - 1.0).abs() < 1e-7 && (r.sent.largest_pressure / p - 1.0).abs() < 1e-7);
            }
        }
    }
}

/// Largest difference of the master blocks of B and C, as a share of the largest entry.
fn difference(a: &ContactRows<1, 2>, b: &ContactRows<1, 2>) -> f64 {
    let (a, b) = (a.reaction.as_ref().unwrap_or(&a.rows).master.to_csr(), b.rows.master.to_csr());
    let (mut worst, mut top) = (0.0f64, 0.0f64);
    for i in 0..b.num_rows() {
        for j in a.row(i).0.chain(b.row(i).0) {
            worst = worst.max((a.get(i, j) - b.get(i, j)).abs());
            top = top.max(b.get(i, j).abs());
        }
    }
    worst / top
}

/// ∫ f ds over the slave by master sums.
fn integral(segments: &Segments<1>, slave: &dyn Geometry<1, 2>, f: impl Fn(&Vector<2>) -> f64) -> f64 {
    let mut map = MapTable::new();
    let mut sum = 0.0;
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        slave.map(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut map);
        sum += points.zip(&map.x).map(|(q, x)| segments.ds[q] * f(x)).sum::<f64>();
    }
    sum
}

// The measure follows from the closest point, curvature included: across clearances, between circles that are not concentric, against
// polygons with kinks, where the fans of the vertices have their share.
#[test]
fn master_sums_integrate_over_the_slave_across_a_clearance() {
    let ring = |kind: Kind, center: [f64; 2], radius: [f64; 2], angles: [f64; 2], n: usize, degree: usize| {
        kind.body(&PatchSpec::new(annulus_sector(center, radius, angles).unwrap()).with_degree([degree; 2]).with_elements([n, 1]))
    };
    let slave = ring(Kind::Nurbs, [0.0, 0.0], [0.5, 1.0], [20.0, 70.0], 3, 2).trace("v1").unwrap();
    let length = 50.0_f64.to_radians();
    // ∫ x ds = sin(70°) - sin(20°)
    let first = 70.0_f64.to_radians().sin() - 20.0_f64.to_radians().sin();
    for (name, kind, center, degree, limit) in [
        ("concentric", Kind::Nurbs, [0.0, 0.0], 2, 1e-12),
        ("shifted", Kind::Nurbs, [0.03, -0.02], 2, 1e-10),
        ("polygon", Kind::Tensor, [0.0, 0.0], 1, 1e-10),
        ("shifted polygon", Kind::Tensor, [0.03, -0.02], 1, 1e-10),
        ("triangles", Kind::Triangle, [0.03, -0.02], 2, 1e-10),
    ] {
        let master = ring(kind, center, [1.15, 1.5], [0.0, 90.0], 7, degree).trace("v0").unwrap();
        let found = MasterSums::facing(12, None).segments(&*slave.space, &*master.space).unwrap();
        let errors = [integral(&found, &*slave.space, |_| 1.0) - length, integral(&found, &*slave.space, |x| x[0]) - first];
        println!("{name}: {errors:?}");
        assert!(errors.iter().all(|e| e.abs() < limit), "{name}: {errors:?}");
        assert!((found.report.covered - length).abs() < limit);
        // reach: farther points face nothing
        let near = MasterSums::facing(12, Some(0.1)).segments(&*slave.space, &*master.space).unwrap();
        assert_eq!(near.num_pieces(), 0, "{name}");
    }
}

// The seed's three integrations have one limit: master blocks approach those of merged segments with h and with points.
#[test]
fn master_blocks_of_all_integrations_have_one_limit() {
    for kinds in [[Kind::Nurbs, Kind::Nurbs], [Kind::Tensor, Kind::Nurbs], [Kind::Nurbs, Kind::Tensor], [Kind::Spline, Kind::Triangle]] {
        let kinds_of = |k: Kind| if k == Kind::Spline { Kind::Nurbs } else { k };
        let at = |n: usize, points: usize, rule: Rule| {
            let model = rings(kinds.map(kinds_of), [5 * n, 4 * n], 2, |_| 0.01);
            let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
            let psi = build(&sides[1].space, MultiplierKind::Lowered(0), &[false, false]).unwrap();
            let of = |rule, points| contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (rule, points), Cone::Coefficients, &|_, g| g);
            difference(&of(rule, points), &of(Rule::Merged, 12))
        };
        for rule in [Rule::Slave, Rule::Mixed] {
            let found = [3, 6, 12, 24].map(|points| at(1, points, rule));
            println!("{kinds:?} {rule:?}: {found:?}");
            // slave sums: normals of polygons jump between the points, so eight times the points give first order, with noise
            let share = if rule == Rule::Mixed { 0.05 } else { 0.2 };
            assert!(found[3] < share * found[0], "{kinds:?} {rule:?}: {found:?}");
        }
    }
}

// Pressure of a wave: slave, mixed and merged give states whose distance falls with the elements.
#[test]
fn slave_mixed_and_merged_integration_converge_to_one_state() {
    let run = |kinds: [Kind; 2], n: usize, rule: Rule| {
        let model = rings(kinds, [5 * n, 4 * n], 2, |x| 0.01 * (1.0 + 0.5 * (3.0 * x[0]).sin()));
        let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
        let psi = build(&sides[1].space, MultiplierKind::Lowered(0), &[false, false]).unwrap();
        let points = if rule == Rule::Merged { 8 } else { 3 };
        let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (rule, points), Cone::Coefficients, &|_, g| g);
        let r = solve(&model, built, &*psi, &mut direct()).unwrap();
        (r.solution.unknowns, r.sent.force)
    };
    for kinds in [[Kind::Nurbs, Kind::Nurbs], [Kind::Tensor, Kind::Nurbs]] {
        for rule in [Rule::Slave, Rule::Mixed] {
            let far = [1, 2, 4].map(|n| {
                let (a, b) = (run(kinds, n, rule).0, run(kinds, n, Rule::Merged).0);
                let top = b.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                a.iter().zip(&b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / top
            });
            println!("{kinds:?} {rule:?}: {far:?}");
            // at p + 1 points: slave sums lose orders, mixed ones keep second order at least; both tend to the same state
            let (share, least) = if rule == Rule::Mixed { (0.1, 1e-4) } else { (0.5, 1e-2) };
            assert!(far[2] < share * far[0] && far[2] < least, "{kinds:?} {rule:?}: {far:?}");
        }
    }
}

#[test]
fn solvers_that_need_symmetry_refuse_mixed_contact() {
    let model = halves([Kind::Spline; 2], 2, |_| 1.25e-3);
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    let psi = build(&sides[1].space, MultiplierKind::Auto, &[]).unwrap();
    let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Mixed, 3), Cone::Coefficients, &|_, g| g);
    let answer = solve(&model, built, &*psi, &mut ActiveSet::new(Condensed::new()));
    assert!(matches!(answer, Err(SolveError::NotSymmetric)));
}

/// A case of the program with two blocks; `contact` and `rest` are appended.
fn case(contact: &str, rest: &str) -> Result<RunResult, Diagnostics> {
    let text = format!(
        "schema = 1\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = 4\n\
         [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"lower\"\ngeometry = {{ kind = \"box\", min = [0.0, 0.0], max = [2.0, 0.5] }}\nelements = [7, 2]\n\
         [[patch]]\nname = \"upper\"\ngeometry = {{ kind = \"box\", min = [0.0, 0.5], max = [1.0, 1.0] }}\nelements = [5, 2]\n\
         [[patch]]\nname = \"other\"\ngeometry = {{ kind = \"box\", min = [1.2, 0.5], max = [2.0, 1.0] }}\nelements = [4, 2]\n\
         [[boundary]]\non = [\"lower.bottom\"]\nfix = [\"x\", \"y\"]\n\
         [[boundary]]\non = [\"upper.top\", \"other.top\"]\ndirichlet = {{ x = \"0\", y = \"-0.01*t\" }}\n\
         [[contact]]\nname = \"pad\"\nslave = [\"upper.bottom\", \"other.bottom\"]\nmaster = \"lower.top\"\ngap = \"g + 0.02*(x - 0.8)^2\"\n{contact}\n{rest}"
    );
    Case::parse("a.toml", &text, &ReadOptions::default())?.run(&Registry::default())
}

fn faults(contact: &str, rest: &str) -> Vec<(String, String)> {
    let list = match case(contact, rest) {
        Ok(result) => result.diagnostics,
        Err(found) => found.items,
    };
    list.iter().map(|d| (d.code.to_string(), d.message.clone())).collect()
}

#[test]
fn a_case_has_every_cone_on_lists_of_sides_and_over_steps() {
    let mut forces = Vec::new();
    for cone in ["coefficients", "weights", "values"] {
        for integration in ["merged", "slave", "mixed"] {
            let words = format!("cone = \"{cone}\"\nintegration = \"{integration}\"");
            let result = case(&words, "[steps]\nt = [0.3, 0.6, 1.0]").unwrap();
            assert_eq!((result.exit, result.steps.len()), (0, 3), "{cone} {integration}: {:?}", result.diagnostics);
            let (_, pad) = result.contact.iter().next().unwrap();
            let scale = pad.pressure.max;
            assert!(pad.kkt.gap <= 1e-12 && pad.kkt.lambda <= 1e-12 * scale, "{cone} {integration}: {:?}", pad.kkt);
            assert!(pad.kkt.product <= 1e-12 * scale, "{cone} {integration}: {:?}", pad.kkt);
            assert!(integration == "mixed" || pad.balance < 1e-12, "{cone} {integration}: {}", pad.balance);
            assert!(integration == "merged" || pad.consistency > 1e-12, "{cone} {integration}: {}", pad.consistency);
            assert!(integration != "merged" || pad.consistency < 1e-12, "{cone}: {}", pad.consistency);
            assert!(pad.active > 0 && pad.active < 13, "{cone} {integration}: {}", pad.active);
            println!("{cone} {integration}: {:?} {} {:e} {:e}", pad.force, pad.active, pad.balance, pad.consistency);
            forces.push(pad.force[1]);
        }
    }
    assert!(forces.iter().all(|f| (f / forces[0] - 1.0).abs() < 0.03), "{forces:?}");
}

#[test]
fn an_obstacle_that_moves_turns_its_rows_anew_in_every_cone() {
    let text = |cone: &str| {
        format!(
            "schema = 1\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = 4\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"block\"\ngeometry = {{ kind = \"box\", min = [0.0, 0.0], max = [2.0, 0.5] }}\nelements = [14, 3]\n\
             [[boundary]]\non = \"block.bottom\"\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"ball\"\nslave = \"block.top\"\ncone = \"{cone}\"\n\
             rigid = {{ kind = \"sphere\", center = [0.7, 1.5], radius = 1.0, move = {{ x = \"0.5*t\", y = \"-0.02\" }} }}\n\
             [steps]\nt = [0.0, 0.5, 1.0]\n"
        )
    };
    for cone in ["coefficients", "weights", "values"] {
        let result = Case::parse("a.toml", &text(cone), &ReadOptions::default()).unwrap().run(&Registry::default()).unwrap();
        assert_eq!((result.exit, result.steps.len()), (0, 3), "{cone}: {:?}", result.diagnostics);
        let forces: Vec<f64> = result.steps.iter().map(|s| s.contact.iter().next().unwrap().1.force[1]).collect();
        assert!(forces.iter().all(|f| *f < -1e-3), "{cone}: {forces:?}");
        for step in &result.steps {
            let (_, ball) = step.contact.iter().next().unwrap();
            assert!(ball.kkt.gap <= 1e-12 && ball.kkt.product <= 1e-12 * ball.pressure.max, "{cone}: {:?}", ball.kkt);
        }
    }
}

#[test]
fn the_remedy_of_a_cone_of_values_is_a_multiplier_that_exists() {
    for (degree, word) in [(1, "such as p/p"), (2, "such as p/p-2"), (3, "such as p/p-2")] {
        let text = |multiplier: &str| {
            format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = {degree}\n\
                 [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                 [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [4, 3]\n\
                 [[boundary]]\non = \"a.top\"\ndirichlet = {{ x = 0, y = -0.01 }}\n\
                 [[contact]]\nname = \"c\"\nslave = \"a.bottom\"\ncone = \"values\"\nmultiplier = \"{multiplier}\"\n\
                 rigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n"
            )
        };
        let solve = |text: &str| Case::parse("a.toml", text, &ReadOptions::default()).and_then(|case| case.run(&Registry::default()));
        let found = solve(&text("dual")).expect_err("dual functions have no Greville points");
        let fault = found.items.iter().find(|d| d.code == "E064").unwrap_or_else(|| panic!("{found}"));
        let help = fault.help.clone().unwrap_or_default();
        assert!(help.ends_with(word), "degree {degree}: {help}");
        let offered = help.rsplit(' ').next().unwrap_or_default();
        assert_eq!(solve(&text(offered)).unwrap_or_else(|d| panic!("{d}")).exit, 0, "degree {degree}: {offered}");
    }
}

#[test]
fn what_a_cone_or_mixed_integration_cannot_have_is_refused_with_its_place() {
    let of = |code: &str, found: Vec<(String, String)>, words: &str| {
        assert!(found.iter().any(|(c, m)| c == code && m.contains(words)), "{found:?}");
    };
    of("E064", faults("cone = \"values\"\nmultiplier = \"dual\"", ""), "no Greville points");
    for solver in ["condensed", "schur", "uzawa"] {
        let rest = format!("[solver]\nconstraint = \"{solver}\"\n");
        of("E015", faults("integration = \"mixed\"", &rest), "integration = \"mixed\" of contact \"pad\" makes one that is not");
    }
}

// Newton-Cotes rules have negative weights from degree 8 on: a gap that is open everywhere would count as closed there.
#[test]
fn values_of_pieces_of_degree_eight_are_refused_and_their_weights_are_not() {
    let (model, _) = lifted(3, 5);
    let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
    for (degree, good) in [(7, true), (8, false)] {
        let kind = MultiplierKind::Uniform { degree, continuity: Some(-1), ends: Ends::Full };
        let psi = build(&sides[1].space, kind, &[]).unwrap();
        let built = contact(&model, (1, &sides[1]), (0, &sides[0]), &*psi, (Rule::Merged, 9), Cone::Weights, &parabola);
        let answer = built.with_cone(Cone::Values, &*psi);
        assert_eq!(answer.is_ok(), good, "degree {degree}");
        assert!(good || matches!(answer, Err(ContactError::ConeWeight { weight, .. }) if weight < 0.0));
    }
}
