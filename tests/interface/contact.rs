//! Frictionless contact of curves: constant pressure, Hertz, bodies that lift off.

use crate::common::coupled;
use coupled::{Bodies, KINDS, Kind};
use faying::assembly::{gauss_rules, trace_load};
use faying::basis::Basis;
use faying::constraint::{ActiveSet, Condensed, ConstrainedSolution, ConstraintSolver, Direct};
use faying::contact::{ClosedSide, ContactResultants, ContactRows, HalfPlane, Obstacle, Opponent, SideEnd, Surface, half_width};
use faying::coupling::interface::{MergedCurve, slave_segments};
use faying::coupling::multiplier::{MultiplierKind, build};
use faying::coupling::{InterfaceQuadrature, Side};
use faying::geometry::shapes::{annulus_sector, disc_sector};
use faying::linalg::Vector;
use faying::physics::{Hooke, Material, form, pressure};
use faying::space::{Body, PatchSpec, Trace, field_at};
use rayon::prelude::*;

const YOUNG: f64 = 1.0;
const POISSON: f64 = 0.3;

fn hooke() -> Hooke<2> {
    Hooke::plane_strain(YOUNG, POISSON).unwrap()
}

/// Adds a pressure on a side to the load.
fn press(model: &mut Bodies<2>, body: usize, side: &str, p: f64) {
    let trace = model.trace(body, side);
    let rules = gauss_rules(&*trace.space, model.extra + 1);
    let field = model.fields[body];
    let load = &mut model.load[field.first..];
    trace_load(&trace, &rules, &pressure(move |_: &Vector<2>| p), load);
}

struct Pressed {
    solution: ConstrainedSolution,
    transmitted: ContactResultants<2>,
    contact: ContactRows<1, 2>,
}

/// Solves a model with one contact: slave side against a master side or an obstacle; rows with a gap below `start` are
/// active at first.
fn solve(
    model: &Bodies<2>,
    (slave, side): (usize, &Trace<1, 2>),
    master: Result<(usize, &Trace<1, 2>), &dyn Obstacle<1, 2>>,
    multiplier: &dyn Basis<1>,
    points: usize,
    gap: &dyn Fn(&Vector<2>, f64) -> f64,
    start: f64,
    make: impl FnOnce(Vec<bool>) -> Box<dyn ConstraintSolver>,
) -> Pressed {
    let as_side = |body: usize, trace| Side { trace, field: model.fields[body], flux: None };
    let (segments, opponent) = match master {
        Ok((body, trace)) => {
            let rule = MergedCurve::facing(points, None);
            (rule.segments(&*side.space, &*trace.space).unwrap(), Opponent::Master(as_side(body, trace)))
        }
        Err(target) => (slave_segments(&*side.space, &gauss_rules(&*side.space, points)), Opponent::Rigid(target, None)),
    };
    let contact = ContactRows::new(as_side(slave, side), opponent, multiplier, segments, gap, model.unknowns()).unwrap();
    let at_rest = contact.lumped_gap(&vec![0.0; model.unknowns()]);
    let mut solver = make(at_rest.iter().map(|g| g.is_some_and(|g| g < start)).collect());
    let solution = model.solve(&contact.rows, None, &contact.offset, &contact.kinds(), &mut *solver).unwrap_or_else(|e| panic!("{e}"));
    let transmitted = contact.transmitted(multiplier, &solution.multipliers);
    Pressed { solution, transmitted, contact }
}

fn saddle_point(start: Vec<bool>) -> Box<dyn ConstraintSolver> {
    Box::new(ActiveSet::new(Direct::new()).starting_from(start))
}

fn condensed(start: Vec<bool>) -> Box<dyn ConstraintSolver> {
    Box::new(ActiveSet::new(Condensed::new()).starting_from(start))
}

/// A unit square of two halves, pressed with 1.25e-3 from above; grids of 4 x 2 elements that do not match.
fn halves(kinds: [Kind; 2], degree: usize) -> Bodies<2> {
    let [a, b] = kinds;
    let lower = a.rectangle([0.0, 0.0], [1.0, 0.5], degree, [4, 2]);
    let mut net = faying::geometry::shapes::rectangle([0.0, 0.5], [1.0, 1.0]).unwrap();
    if b == Kind::Nurbs {
        net = coupled::weighted(&net, degree.min(2));
    }
    let grid = [vec![0.0, 0.2, 0.45, 0.8, 1.0], vec![0.0, 0.5, 1.0]];
    let upper = b.body(&PatchSpec::new(net).with_degree([degree; 2]).with_breakpoints(grid));
    let extra = a.extra_points().max(b.extra_points());
    let mut model = Bodies::<2>::new(vec![lower, upper], &form(&hooke()).unwrap(), extra);
    model.fix(0, &[("v0", 1), ("u0", 0)], &|_| Vector::<2>::zeros());
    model.fix(1, &[("u0", 0)], &|_| Vector::<2>::zeros());
    press(&mut model, 1, "v1", 1.25e-3);
    model
}

// Seed, test 1: sigma_yy = -1.25e-3 everywhere, P2-P2; issue: 1e-10, at most 5 iterations, both solvers.
#[test]
fn a_constant_pressure_passes_a_grid_that_does_not_match_for_all_pairs() {
    let p = 1.25e-3;
    let mut cases = Vec::new();
    for a in KINDS {
        for b in KINDS {
            for slave in 0..2 {
                for multiplier in [MultiplierKind::Lowered(0), MultiplierKind::Auto, MultiplierKind::Dual] {
                    cases.push((a, b, slave, multiplier));
                }
            }
        }
    }
    let material = hooke();
    // plane strain under uniaxial stress
    let exact = |x: &Vector<2>| Vector::<2>::new(p * POISSON * (1.0 + POISSON) * x[0], -p * (1.0 - POISSON * POISSON) * x[1]) / YOUNG;
    let failures: Vec<String> = cases
        .par_iter()
        .flat_map_iter(|&(a, b, slave, multiplier)| {
            let model = halves([a, b], 2);
            let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
            let psi = build(&sides[slave].space, multiplier, &[]).unwrap();
            let other = (1 - slave, &sides[1 - slave]);
            let mut failures = Vec::new();
            let mut answers = Vec::new();
            for make in [saddle_point, condensed] {
                let points = 3 + model.extra;
                let r = solve(&model, (slave, &sides[slave]), Ok(other), &*psi, points, &|_, g| g, f64::INFINITY, make);
                let stress = model.bodies.iter().zip(&model.fields).fold(0.0f64, |worst, (body, field)| {
                    let space = body.space();
                    (0..space.num_elements()).fold(worst, |worst, e| {
                        field_at::<2, 2, f64, _>(
                            &**space,
                            field,
                            &r.solution.unknowns,
                            e,
                            &[Vector::<2>::new(0.3, 0.2), Vector::<2>::new(0.0, 1.0)],
                        )
                        .iter()
                        .map(|s| (material.respond(&s.x, &s.gradient).stress[(1, 1)] + p).abs())
                        .fold(worst, f64::max)
                    })
                });
                let t = &r.transmitted;
                let up = if slave == 1 { 1.0 } else { -1.0 };
                let defects = [
                    model.error(&r.solution.unknowns, &exact) / p,
                    stress / p,
                    (t.least_pressure - p).abs().max((t.largest_pressure - p).abs()) / p,
                    (t.force - Vector::<2>::new(0.0, up * p)).amax() / p,
                    (t.moment[2] - up * 0.5 * p).abs() / p,
                    (t.area - 1.0).abs(),
                ];
                let iterations = r.solution.active_set.as_ref().unwrap().iterations;
                if defects.iter().any(|d| *d > 1e-10) || iterations > 5 {
                    failures.push(format!("{a:?} {b:?} slave {slave} {multiplier}: {defects:?} in {iterations} iterations"));
                }
                answers.push(r.solution);
            }
            let differ = answers[0].unknowns.iter().zip(&answers[1].unknowns).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            if differ > 1e-9 * p || answers[0].active != answers[1].active {
                failures.push(format!("{a:?} {b:?} slave {slave} {multiplier}: solvers differ by {differ:e}"));
            }
            failures
        })
        .collect();
    assert!(failures.is_empty(), "{} failures of {} cases:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

#[test]
fn a_press_fit_and_a_rigid_side_give_the_same_state_as_the_master() {
    // the upper half on a rigid copy of the lower side, with an interference of 1e-3: u_y shifts as a whole
    for kind in KINDS {
        let model = {
            let upper = kind.rectangle([0.0, 0.5], [1.0, 1.0], 2, [4, 2]);
            let mut model = Bodies::<2>::new(vec![upper], &form(&hooke()).unwrap(), kind.extra_points());
            model.fix(0, &[("u0", 0)], &|_| Vector::<2>::zeros());
            press(&mut model, 0, "v1", 2e-3);
            model
        };
        let side = model.trace(0, "v0");
        let psi = build(&side.space, MultiplierKind::Auto, &[]).unwrap();
        let floor = Kind::Spline.rectangle([-1.0, 0.0], [2.0, 0.5], 2, [5, 1]).trace("v1").unwrap();
        let targets: [Box<dyn Obstacle<1, 2>>; 2] = [
            Box::new(HalfPlane::try_new(Vector::<2>::new(0.3, 0.5), Vector::<2>::new(0.0, 4.0)).unwrap()),
            Box::new(Surface::new(&floor, None)),
        ];
        for target in &targets {
            faying::check::obstacle(&**target, &[Vector::<2>::new(0.2, 0.6), Vector::<2>::new(0.7, 0.4)], 1e-12).unwrap();
            let r = solve(&model, (0, &side), Err(&**target), &*psi, 3, &|_, g| g - 1e-3, f64::INFINITY, saddle_point);
            assert!((r.transmitted.force - Vector::<2>::new(0.0, 2e-3)).amax() < 1e-12, "{kind:?}: {:?}", r.transmitted.force);
            let exact = |x: &Vector<2>| {
                let p = 2e-3 / YOUNG;
                Vector::<2>::new(p * POISSON * (1.0 + POISSON) * x[0], 1e-3 - p * (1.0 - POISSON * POISSON) * (x[1] - 0.5))
            };
            assert!(model.error(&r.solution.unknowns, &exact) < 1e-12, "{kind:?}");
            let gaps = r.contact.lumped_gap(&r.solution.unknowns);
            assert!(gaps.iter().all(|g| g.is_some_and(|g| g.abs() < 1e-12)));
        }
    }
}

fn side_of<'a>(side: &'a Trace<1, 2>, r: &'a Pressed) -> ClosedSide<'a, 2> {
    ClosedSide { slave: &*side.space, segments: &r.contact.segments, closed: &r.transmitted.closed, pressure: &r.transmitted.pressure }
}

/// Sizes `first`, `count` of them, then growing by `ratio` up to `end`; from 0.
fn graded(first: f64, count: usize, ratio: f64, end: f64) -> Vec<f64> {
    let mut at = vec![0.0];
    let mut size = first;
    while at[at.len() - 1] + 1.4 * size < end {
        let next = at[at.len() - 1] + size;
        at.push(next);
        if at.len() > count {
            size *= ratio;
        }
    }
    at.push(end);
    at
}

// Hertz, line contact with a rigid plane: a = sqrt(4 F R (1 - nu^2) / (pi E)), p0 = 2 F / (pi a); benchmarks section 4.
#[test]
fn a_half_cylinder_on_a_rigid_plane_has_the_pressure_of_hertz() {
    let (radius, a) = (1.0, 0.02);
    let force = a * a * std::f64::consts::PI * YOUNG / (4.0 * radius * (1.0 - POISSON * POISSON));
    let p0 = 2.0 * force / (std::f64::consts::PI * a);
    let size = a / 8.0;
    // half model: the quarter disc beside the symmetry plane x = 0; the arc's parameter runs sqrt(2) faster than its angle there
    let net = disc_sector([0.0, radius], radius, [-90.0, 0.0]).unwrap();
    let along = graded(size / 2f64.sqrt(), 14, 1.35, 1.0);
    let inward: Vec<f64> = graded(size, 6, 1.35, 1.0).iter().rev().map(|v| 1.0 - v).collect();
    let spec = PatchSpec::new(net).with_degree([2, 2]).with_breakpoints([along, inward]);
    for (name, kind) in [("iga", Kind::Nurbs), ("fe", Kind::Tensor)] {
        for multiplier in [MultiplierKind::Auto, MultiplierKind::Lowered(0)] {
            let mut model = Bodies::<2>::new(vec![kind.body(&spec)], &form(&hooke()).unwrap(), 1);
            model.fix(0, &[("u0", 0)], &|_| Vector::<2>::zeros());
            press(&mut model, 0, "u1", 0.5 * force / radius);
            let side = model.trace(0, "v1");
            let psi = build(&side.space, multiplier, &[false, false]).unwrap();
            let plane = HalfPlane::try_new(Vector::<2>::zeros(), Vector::<2>::new(0.0, 1.0)).unwrap();
            // a set that is far too large is peeled one element per iteration: start from twice the gap at the zone's rim
            let r = solve(&model, (0, &side), Err(&plane), &*psi, 2, &|_, g| g, a * a / radius, saddle_point);
            let width = half_width(&[side_of(&side, &r)], &|_, _, _| SideEnd::Mirrored).unwrap();
            let report = r.solution.active_set.as_ref().unwrap();
            println!(
                "{name} {multiplier}: p0 {:.5} of {p0:.5}, a {width:.5} of {a}, {} unknowns, {} iterations",
                r.transmitted.largest_pressure,
                model.unknowns(),
                report.iterations
            );
            assert!(
                (r.transmitted.largest_pressure / p0 - 1.0).abs() < 0.01,
                "{name} {multiplier}: p0 {} of {p0}",
                r.transmitted.largest_pressure
            );
            assert!((width - a).abs() <= size, "{name} {multiplier}: a {width} of {a}, elements of {size}");
            assert!((r.transmitted.force[1] / (0.5 * force) - 1.0).abs() < 1e-9);
        }
    }
}

// Benchmarks, section 3: a hydrostatic contact state across a curved interface is exact up to quadrature.
#[test]
fn a_hydrostatic_state_crosses_an_arc_that_does_not_match() {
    let p = 0.01;
    let part = |radius: [f64; 2], elements: [usize; 2], degree: usize| {
        let net = annulus_sector([0.0, 0.0], radius, [0.0, 90.0]).unwrap();
        Kind::Nurbs.body(&PatchSpec::new(net).with_degree([degree; 2]).with_elements(elements))
    };
    for degree in [2, 3] {
        for slave in 0..2 {
            let bodies = vec![part([1.0, 1.5], [5, 2], degree), part([1.5, 2.0], [4, 2], degree)];
            let mut model = Bodies::<2>::new(bodies, &form(&hooke()).unwrap(), 6);
            for body in 0..2 {
                model.fix(body, &[("u0", 1), ("u1", 0)], &|_| Vector::<2>::zeros());
            }
            press(&mut model, 0, "v0", p);
            press(&mut model, 1, "v1", p);
            let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
            let psi = build(&sides[slave].space, MultiplierKind::Auto, &[]).unwrap();
            let other = (1 - slave, &sides[1 - slave]);
            let r = solve(&model, (slave, &sides[slave]), Ok(other), &*psi, degree + 8, &|_, g| g, f64::INFINITY, saddle_point);
            // plane strain, sigma = -p I in the plane: u = -p (1 + nu)(1 - 2 nu) / E x
            let exact = |x: &Vector<2>| x * (-p * (1.0 + POISSON) * (1.0 - 2.0 * POISSON) / YOUNG);
            assert!(
                model.error(&r.solution.unknowns, &exact) < 1e-9 * p,
                "degree {degree}: {:e}",
                model.error(&r.solution.unknowns, &exact)
            );
            let t = &r.transmitted;
            assert!((t.least_pressure / p - 1.0).abs() < 1e-8 && (t.largest_pressure / p - 1.0).abs() < 1e-8);
            // the resultant of a pressure on a quarter circle is p r in both directions, away from the centre for the outer body
            let out = if slave == 1 { 1.0 } else { -1.0 };
            assert!((t.force - Vector::<2>::new(1.5 * p * out, 1.5 * p * out)).amax() < 1e-9 * p, "{:?}", t.force);
            assert!((t.area - 0.75 * std::f64::consts::PI).abs() < 1e-9);
        }
    }
}

// A stamp with a step in its gap: only the touching half carries; signs and complementarity of every row.
#[test]
fn a_stepped_gap_stays_open_where_nothing_reaches() {
    for kinds in [[Kind::Spline, Kind::Triangle], [Kind::Tensor, Kind::Nurbs], [Kind::Nurbs, Kind::Spline]] {
        let mut model = halves(kinds, 2);
        model.fix(1, &[("v1", 0)], &|_| Vector::<2>::zeros());
        let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
        let psi = build(&sides[1].space, MultiplierKind::Auto, &[]).unwrap();
        let gap = |x: &Vector<2>, g: f64| if x[0] > 0.45 { g + 1.0 } else { g };
        let mut answers = Vec::new();
        for make in [saddle_point, condensed] {
            let r = solve(&model, (1, &sides[1]), Ok((0, &sides[0])), &*psi, 6, &gap, f64::INFINITY, make);
            assert!((r.transmitted.force[1] - 1.25e-3).abs() < 1e-12);
            let gaps = r.contact.lumped_gap(&r.solution.unknowns);
            for (j, gap) in gaps.iter().enumerate() {
                let (gap, lambda) = (gap.unwrap(), r.solution.multipliers[j]);
                assert!(lambda <= 0.0 && gap > -1e-12, "{kinds:?}, row {j}: lambda {lambda:e}, gap {gap:e}");
                assert!((lambda * gap).abs() < 1e-15 && r.solution.active[j] == (lambda < 0.0));
            }
            assert!(r.transmitted.area < 0.46 && r.transmitted.area > 0.1);
            answers.push(r.solution);
        }
        assert_eq!(answers[0].active, answers[1].active);
        let differ = answers[0].unknowns.iter().zip(&answers[1].unknowns).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(differ < 1e-11, "{kinds:?}: {differ:e}");
    }
}

// Points beyond the master's ends carry nothing; functions that face nothing stay open.
#[test]
fn what_overhangs_the_master_carries_no_pressure() {
    for kind in KINDS {
        let lower = kind.rectangle([0.0, 0.0], [1.0, 0.5], 2, [5, 2]);
        let upper = Kind::Spline.rectangle([0.0, 0.5], [2.0, 1.0], 2, [8, 2]);
        let mut model = Bodies::<2>::new(vec![lower, upper], &form(&hooke()).unwrap(), kind.extra_points());
        model.fix(0, &[("v0", 0), ("v0", 1)], &|_| Vector::<2>::zeros());
        model.fix(1, &[("u0", 0), ("v1", 1)], &|x| Vector::<2>::new(0.0, if x[1] > 0.9 { -1e-3 } else { 0.0 }));
        let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
        let psi = build(&sides[1].space, MultiplierKind::Auto, &[]).unwrap();
        let r = solve(&model, (1, &sides[1]), Ok((0, &sides[0])), &*psi, 6, &|_, g| g, f64::INFINITY, saddle_point);
        assert!((r.contact.segments.report.covered - 1.0).abs() < 1e-12);
        // constants on elements of 1/4: the first four face the master
        assert_eq!(r.contact.facing, [true, true, true, true, false, false, false, false]);
        assert!(r.solution.multipliers[4..].iter().all(|&l| l == 0.0) && r.solution.multipliers[..4].iter().all(|&l| l < 0.0));
        assert!((r.transmitted.area - 1.0).abs() < 1e-12);
    }
}
