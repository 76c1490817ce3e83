//! W6: two bodies in contact in the plane and in space, from nothing to convergence.

use crate::measure::{Time, median, timed};
use crate::run::{Options, own_record};
use faying::assembly::{Prescribed, Reduced, dirichlet, gauss_rules, stiffness};
use faying::basis::{BSpline, Basis};
use faying::constraint::{ActiveSet, ConstrainedSystem, ConstraintSolver, Direct};
use faying::contact::{ContactRows, Opponent};
use faying::coupling::interface::{InterfaceQuadrature, MergedCurve, MergedSurface};
use faying::coupling::multiplier::{MultiplierKind, build, build_on_surface};
use faying::coupling::{Rows, Side};
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Csr, Ldlt, Operator, Vector};
use faying::physics::{Hooke, form};
use faying::space::{BasisKind, Body, Field, Mesh, Patch, PatchSpec, Space, Trace};
use serde_json::{Value, json};
use std::sync::Arc;

/// What the bodies are made of.
#[derive(Clone, Copy, Debug)]
pub enum Backend {
    /// B-splines of maximal smoothness.
    Spline,
    /// Lagrange quadrilaterals.
    Lagrange,
}

/// Upper body x in [-1, 1], y in [x²/4, 1] with n x n/2 elements; lower body [-1, 1] x [-1, 0] with 5n/4 x 5n/8.
pub fn bodies(backend: Backend, p: usize, n: usize) -> [Box<dyn Body<1, 2>>; 2] {
    let bottom = [[-1.0, 0.25], [0.0, -0.25], [1.0, 0.25]];
    let points = bottom.iter().copied().chain([[-1.0, 1.0], [0.0, 1.0], [1.0, 1.0]]).map(|[x, y]| Vector::<2>::new(x, y)).collect();
    let upper = ControlNet::try_new([BSpline::uniform(2, 1, 1), BSpline::uniform(1, 1, 0)], points, None).unwrap();
    let lower = shapes::rectangle([-1.0, -1.0], [1.0, 0.0]).unwrap();
    let make = |net, elements| -> Box<dyn Body<1, 2>> {
        let spec = PatchSpec::new(net).with_degree([p; 2]).with_elements(elements).with_basis(BasisKind::BSpline);
        match backend {
            Backend::Spline => Box::new(Patch::<1, 2>::try_new(&spec).unwrap()),
            Backend::Lagrange => Box::new(Mesh::<1, 2>::from_patch(&spec).unwrap()),
        }
    };
    [make(upper, [n, n / 2]), make(lower, [5 * n / 4, 5 * n / 8])]
}

/// Upper body x, y in [-1, 1], z in [(x² + y²)/8, 1] with n x n x n/2 elements; lower body [-1, 1]² x [-1, 0] with 5n/4 x 5n/4 x 5n/8.
fn solids(backend: Backend, p: usize, n: usize) -> [Box<dyn Body<2, 3>>; 2] {
    // Coefficients of x² on [-1, 1] in the quadratic Bernstein basis: 1, -1, 1; those of x are -1, 0, 1.
    let square = [1.0, -1.0, 1.0];
    let bottom = (0..9).map(|k| Vector::<3>::new((k % 3) as f64 - 1.0, (k / 3) as f64 - 1.0, (square[k % 3] + square[k / 3]) / 8.0));
    let top = (0..9).map(|k| Vector::<3>::new((k % 3) as f64 - 1.0, (k / 3) as f64 - 1.0, 1.0));
    let directions = [BSpline::uniform(2, 1, 1), BSpline::uniform(2, 1, 1), BSpline::uniform(1, 1, 0)];
    let upper = ControlNet::try_new(directions, bottom.chain(top).collect(), None).unwrap();
    let lower = shapes::brick([-1.0; 3], [1.0, 1.0, 0.0]).unwrap();
    let make = |net, elements| -> Box<dyn Body<2, 3>> {
        let spec = PatchSpec::new(net).with_degree([p; 3]).with_elements(elements).with_basis(BasisKind::BSpline);
        match backend {
            Backend::Spline => Box::new(Patch::<2, 3>::try_new(&spec).unwrap()),
            Backend::Lagrange => Box::new(Mesh::<2, 3>::from_patch(&spec).unwrap()),
        }
    };
    [make(upper, [n, n, n / 2]), make(lower, [5 * n / 4, 5 * n / 4, 5 * n / 8])]
}

/// Two bodies to be pressed together, and what differs between the plane and space.
struct Pair<const S: usize, const N: usize> {
    bodies: [Box<dyn Body<S, N>>; 2],
    material: Hooke<N>,
    /// Names of a body's lowest and highest side.
    ends: [&'static str; 2],
    rule: Box<dyn InterfaceQuadrature<S, N>>,
    multiplier: fn(&Arc<dyn Space<S, N>>) -> Box<dyn Basis<S>>,
}

/// How a solution went: times of matrices, rows, elimination and iteration; what was found.
struct Run {
    times: [Time; 4],
    iterations: usize,
    active: usize,
    force: f64,
    /// Sum of the vertical forces at the moved side, over the contact force, plus one.
    imbalance: f64,
    free: usize,
    entries: usize,
    trace: f64,
    fro: f64,
}

fn solve<const S: usize, const N: usize>(pair: &Pair<S, N>, sides: &[Trace<S, N>; 2], held: &[Trace<S, N>; 2]) -> Run {
    let (bodies, material) = (&pair.bodies, &pair.material);
    let (matrices, bulk) = timed(|| {
        [0, 1].map(|k: usize| {
            let space = &**bodies[k].space();
            stiffness(space, &gauss_rules(space, 0), &form(material).unwrap())
        })
    });
    let unknowns = matrices[0].num_rows() + matrices[1].num_rows();
    let fields = [0, matrices[0].num_rows()].map(|first| Field { first, components: N });
    let side = |k: usize| Side { trace: &sides[k], field: fields[k], flux: None };
    let ((contact, multiplier), rows) = timed(|| {
        let multiplier = (pair.multiplier)(&sides[0].space);
        let segments = pair.rule.segments(&*sides[0].space, &*sides[1].space).unwrap();
        let contact = ContactRows::new(side(0), Opponent::Master(side(1)), &*multiplier, segments, &|_, g| g, unknowns).unwrap();
        (contact, multiplier)
    });
    let ((reduced, constraint, offset, prescribed), eliminate) = timed(|| {
        let down = |_: &Vector<N>| -0.02;
        let mut prescribed = Vec::new();
        for k in 0..2 {
            let fixed = |component: usize| Prescribed {
                trace: &held[k],
                component,
                value: (k == 0 && component == N - 1).then_some(&down as &(dyn Fn(&Vector<N>) -> f64 + Sync)),
            };
            prescribed.extend(dirichlet(&(0..N).map(fixed).collect::<Vec<_>>(), fields[k], 0, &mut Ldlt::new()).unwrap());
        }
        let reduced = Reduced::try_new(&[&matrices[0], &matrices[1]], &vec![0.0; unknowns], &prescribed, &[]).unwrap();
        let ((slave, a), (master, b)) = (reduced.rows(&contact.rows.slave), reduced.rows(&contact.rows.master));
        let offset: Vec<f64> = contact.offset.iter().zip(a.iter().zip(&b)).map(|(g, (a, b))| g + a + b).collect();
        (reduced, Rows { slave, master }, offset, prescribed)
    });
    let kind = contact.kinds();
    let (solution, iterate) = timed(|| {
        let touching = contact.lumped_gap(&vec![0.0; unknowns]).iter().map(|g| g.is_some_and(|g| g <= 0.0)).collect();
        let system = ConstrainedSystem {
            stiffness: &reduced.stiffness,
            load: &reduced.load,
            constraint: &constraint,
            reaction: None,
            offset: &offset,
            kind: &kind,
            compliance: &[],
        };
        ActiveSet::new(Direct::new()).starting_from(touching).solve(&system).unwrap()
    });
    let transmitted = contact.transmitted(&*multiplier, &solution.multipliers);
    let u = reduced.expand(&solution.unknowns);
    let mut pull = vec![0.0; matrices[0].num_rows()];
    matrices[0].apply(&u[..pull.len()], &mut pull);
    let moved: f64 = prescribed.iter().filter(|(i, _)| *i < pull.len() && i % N == N - 1).map(|(i, _)| pull[*i]).sum();
    let square = |m: &Csr| m.vals().iter().map(|v| v * v).sum::<f64>();
    Run {
        times: [bulk, rows, eliminate, iterate],
        iterations: solution.active_set.as_ref().map_or(0, |a| a.iterations),
        active: solution.active.iter().filter(|a| **a).count(),
        force: transmitted.force[N - 1],
        imbalance: (moved / transmitted.force[N - 1] + 1.0).abs(),
        free: reduced.num_free(),
        entries: reduced.stiffness.num_entries(),
        trace: matrices.iter().flat_map(|m| m.diagonal()).sum(),
        fro: matrices.iter().map(square).sum::<f64>().sqrt(),
    }
}

/// W6: E = 1, nu = 0.3, plane strain; the top moves by (0, -0.02), the bottom is held; the slave is the upper body's lower face.
pub fn two_bodies(name: &str, backend: Backend, p: usize, n: usize, options: &Options) -> Value {
    let pair = Pair {
        bodies: bodies(backend, p, n),
        material: Hooke::plane_strain(1.0, 0.3).unwrap(),
        ends: ["v0", "v1"],
        rule: Box::new(MergedCurve::facing(p + 1, None)),
        multiplier: |side| build(side, MultiplierKind::Auto, &[]).unwrap(),
    };
    pressed(name, &pair, [p, n], options)
}

/// W6-3d: the same of solids; the top moves by (0, 0, -0.02).
pub fn two_solids(name: &str, backend: Backend, p: usize, n: usize, options: &Options) -> Value {
    let pair = Pair {
        bodies: solids(backend, p, n),
        material: Hooke::solid(1.0, 0.3).unwrap(),
        ends: ["w0", "w1"],
        rule: Box::new(MergedSurface::facing(p + 1, None)),
        multiplier: |side| build_on_surface(side, MultiplierKind::Auto, &|_| false).unwrap(),
    };
    pressed(name, &pair, [p, n], options)
}

fn pressed<const S: usize, const N: usize>(name: &str, pair: &Pair<S, N>, pn: [usize; 2], options: &Options) -> Value {
    let [low, high] = pair.ends;
    let [upper, lower] = &pair.bodies;
    let sides = [upper.trace(low).unwrap(), lower.trace(high).unwrap()];
    let held = [upper.trace(high).unwrap(), lower.trace(low).unwrap()];
    let runs: Vec<Run> = (0..=options.reps).map(|_| solve(pair, &sides, &held)).collect();
    let phase = |k: usize| median(&runs[1..].iter().map(|r| r.times[k]).collect::<Vec<_>>());
    let times = [0, 1, 2, 3].map(phase);
    let total = |pick: fn(&Time) -> f64| times.iter().map(pick).sum::<f64>();
    let run = &runs[0];
    own_record(
        name,
        pn,
        options,
        json!({
            "dofs": run.free, "nnz": run.entries, "assemble_s": times[0].wall, "assemble_cpu_s": times[0].cpu,
            "solve_s": total(|t| t.wall), "solve_cpu_s": total(|t| t.cpu), "rows_cpu_s": times[1].cpu, "eliminate_cpu_s": times[2].cpu,
            "iterations": run.iterations, "iteration_cpu_s": times[3].cpu / run.iterations.max(1) as f64, "active": run.active,
            "force": run.force, "error": run.imbalance, "fp_trace": run.trace, "fp_fro": run.fro,
            "notes": "solve: all of it, from the matrices to convergence; error: balance of the moved side with the contact force",
        }),
    )
}
