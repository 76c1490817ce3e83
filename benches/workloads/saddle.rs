//! W7 on saddle points: two tied strips, and the bodies of W6 with every contact row closed, beside the bodies alone.

use crate::contact::{Backend, bodies};
use crate::interface::strip;
use crate::measure::{Time, median, peak_rss_mb, timed};
use crate::run::Options;
use crate::solvers::{System, export};
use faying::assembly::{Prescribed, Reduced, dirichlet, gauss_rules, load, stiffness};
use faying::constraint::{ConstrainedSystem, ConstraintSolver, Direct, RowKind};
use faying::contact::{ContactRows, Opponent};
use faying::coupling::interface::{InterfaceQuadrature, MergedCurve, Tolerance};
use faying::coupling::multiplier::{Ends, MultiplierKind, build};
use faying::coupling::{Coupling, Interface, Mortar, Rows, Side};
use faying::linalg::{Csr, Ldlt, LinearSolver, Triplets, Vector};
use faying::physics::{Conductor, Hooke, Material, form};
use faying::space::{Body, Field, Trace};

/// Saddle points: (name, p, n).
pub const LIST: [(&str, usize, usize); 3] = [("W7-W5-2d", 2, 1000), ("W7-W6-spline", 2, 96), ("W7-W6-lagrange", 2, 96)];

/// Two bodies without their prescribed unknowns, and the rows between them.
struct Saddle {
    stiffness: Csr,
    load: Vec<f64>,
    rows: Rows,
    offset: Vec<f64>,
}

/// One line of JSON; `None` for names that are not in the list.
pub fn record(name: &str, options: &Options) -> Option<serde_json::Value> {
    let &(_, p, n) = LIST.iter().find(|w| w.0 == name)?;
    let (p, n) = (options.p.unwrap_or(p), options.n.unwrap_or(n));
    let saddle = match name {
        "W7-W5-2d" => tied(p, n),
        "W7-W6-spline" => pressed(Backend::Spline, p, n),
        _ => pressed(Backend::Lagrange, p, n),
    };
    if let Some(folder) = &options.export {
        export(&saddle.whole(), folder).expect("the folder can be written to");
    }
    Some(saddle.measured(name, [p, n], options))
}

/// The bodies' matrices and loads of one along the last component, and values of two sides.
fn two<const C: usize>(
    bodies: [&dyn Body<1, 2>; 2],
    held: &[Trace<1, 2>; 2],
    material: &dyn Material<C, 2>,
    value: f64,
) -> (Vec<Csr>, Vec<f64>, Vec<(usize, f64)>) {
    let (mut matrices, mut force, mut prescribed, mut first) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let down = move |_: &Vector<2>| value;
    for (k, body) in bodies.into_iter().enumerate() {
        let space = &**body.space();
        let one = |_: &Vector<2>| Vector::<C>::from_fn(|c, _| f64::from(c + 1 == C));
        force.extend(load::<C, 2, 2, _, _, _>(space, &gauss_rules(space, 0), &one));
        let fixed: Vec<Prescribed<'_, 1, 2>> = (0..C)
            .map(|component| Prescribed {
                trace: &held[k],
                component,
                value: (k == 0 && component + 1 == C).then_some(&down as &(dyn Fn(&Vector<2>) -> f64 + Sync)),
            })
            .collect();
        prescribed.extend(dirichlet(&fixed, Field { first, components: C }, 0, &mut Ldlt::new()).unwrap());
        matrices.push(stiffness(space, &gauss_rules(space, 0), &form(material).unwrap()));
        first = force.len();
    }
    (matrices, force, prescribed)
}

/// The strips of W5-2d under a load of one, their outer sides held, tied by linear multipliers.
fn tied(p: usize, n: usize) -> Saddle {
    let bodies = [strip(p, n, [0.0, 0.01]), strip(p, n + n / 2, [0.01, 0.02])];
    let held = [bodies[0].trace("v0").unwrap(), bodies[1].trace("v1").unwrap()];
    let sides = [bodies[0].trace("v1").unwrap(), bodies[1].trace("v0").unwrap()];
    let (matrices, force, prescribed) = two::<1>([&bodies[0], &bodies[1]], &held, &Conductor::<2>::try_new(1.0).unwrap(), 0.0);
    let linear = MultiplierKind::Uniform { degree: 1, continuity: Some(0), ends: Ends::Auto };
    let multiplier = build(&sides[0].space, linear, &[false; 2]).unwrap();
    let segments = MergedCurve::tied(p + 1, Tolerance::Exact).segments(&*sides[0].space, &*sides[1].space).unwrap();
    let side = |trace, first| Side { trace, field: Field { first, components: 1 }, flux: None };
    let interface = Interface {
        slave: side(&sides[0], 0),
        master: Some(side(&sides[1], matrices[0].num_rows())),
        multiplier: &[&*multiplier],
        segments: &segments,
        master_segments: None,
        direction: None,
    };
    let rows = Mortar.assemble(&interface, force.len()).unwrap().constraint;
    let offset = vec![0.0; rows.slave.rows];
    Saddle::reduced(&matrices, &force, &prescribed, &rows, &offset)
}

/// The bodies of W6, the upper one moved by (0, -0.02).
fn pressed(backend: Backend, p: usize, n: usize) -> Saddle {
    let bodies = bodies(backend, p, n);
    let held = [bodies[0].trace("v1").unwrap(), bodies[1].trace("v0").unwrap()];
    let sides = [bodies[0].trace("v0").unwrap(), bodies[1].trace("v1").unwrap()];
    let hooke = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    let (matrices, force, prescribed) = two::<2>([&*bodies[0], &*bodies[1]], &held, &hooke, -0.02);
    let multiplier = build(&sides[0].space, MultiplierKind::Auto, &[]).unwrap();
    let segments = MergedCurve::facing(p + 1, None).segments(&*sides[0].space, &*sides[1].space).unwrap();
    let fields = [0, matrices[0].num_rows()].map(|first| Field { first, components: 2 });
    let side = |k: usize| Side { trace: &sides[k], field: fields[k], flux: None };
    let contact = ContactRows::new(side(0), Opponent::Master(side(1)), &*multiplier, segments, &|_, g| g, force.len()).unwrap();
    Saddle::reduced(&matrices, &force, &prescribed, &contact.rows, &contact.offset)
}

impl Saddle {
    fn reduced(matrices: &[Csr], force: &[f64], prescribed: &[(usize, f64)], rows: &Rows, offset: &[f64]) -> Self {
        let reduced = Reduced::try_new(&[&matrices[0], &matrices[1]], force, prescribed, &[]).unwrap();
        let ((slave, a), (master, b)) = (reduced.rows(&rows.slave), reduced.rows(&rows.master));
        let offset = offset.iter().zip(a.iter().zip(&b)).map(|(g, (a, b))| g + a + b).collect();
        Self { stiffness: reduced.stiffness, load: reduced.load, rows: Rows { slave, master }, offset }
    }

    /// [K Cᵀ; C 0] with a stored zero diagonal, and its right-hand side.
    fn whole(&self) -> System {
        let (n, m) = (self.load.len(), self.offset.len());
        let mut all = Triplets::new(n + m, n + m);
        for i in 0..n {
            let (cols, vals) = self.stiffness.row(i);
            cols.zip(vals).for_each(|(j, &v)| all.push(i, j, v));
        }
        for &(i, j, v) in self.rows.slave.entries.iter().chain(&self.rows.master.entries) {
            all.push(n + i, j, v);
            all.push(j, n + i, v);
        }
        (n..n + m).for_each(|i| all.push(i, i, 0.0));
        let load = self.load.iter().copied().chain(self.offset.iter().map(|g| -g)).collect();
        System { matrix: all.to_csr(), load }
    }

    fn measured(&self, name: &str, [p, n]: [usize; 2], options: &Options) -> serde_json::Value {
        let (kind, mut next) = (vec![RowKind::Equal; self.offset.len()], self.stiffness.clone());
        next.vals_mut().iter_mut().for_each(|v| *v *= 1.5);
        let system = |stiffness| ConstrainedSystem {
            stiffness,
            load: &self.load,
            constraint: &self.rows,
            reaction: None,
            offset: &self.offset,
            kind: &kind,
            compliance: &[],
        };
        let (mut times, mut x, mut entries) = (Vec::new(), vec![0.0; self.load.len()], [0; 2]);
        let (mut residual, mut condition) = (0.0, None);
        for _ in 0..options.reps {
            let (mut bodies, mut whole) = (Ldlt::new(), Direct::new());
            let alone = |solver: &mut Ldlt, matrix: &Csr, x: &mut [f64]| {
                timed(|| {
                    solver.prepare(matrix).unwrap();
                    solver.solve(matrix, &self.load, x).unwrap();
                })
                .1
            };
            let first = [alone(&mut bodies, &self.stiffness, &mut x), timed(|| whole.solve(&system(&self.stiffness)).unwrap()).1];
            let again = alone(&mut bodies, &next, &mut x);
            let (solution, time) = timed(|| whole.solve(&system(&next)).unwrap());
            assert_eq!(whole.num_symbolic_factorizations(), 1);
            times.push([first[0], first[1], again, time]);
            (residual, condition) = (solution.residual, solution.condition);
            entries = [bodies.factor_entries(), whole.factor_entries()];
        }
        let cpu = |k: usize| median(&times.iter().map(|t: &[Time; 4]| t[k]).collect::<Vec<_>>()).cpu;
        serde_json::json!({
            "peer": "faying", "version": env!("CARGO_PKG_VERSION"), "workload": name, "p": p, "n": n,
            "dofs": self.load.len(), "multipliers": self.offset.len(), "nnz": self.stiffness.num_entries(),
            "threads": options.threads, "reps": options.reps, "total_cpu_s": cpu(1), "refactor_s": cpu(3),
            "bodies_total_cpu_s": cpu(0), "bodies_refactor_s": cpu(2), "residual": residual, "condition": condition,
            "factor_entries": entries[1], "bodies_factor_entries": entries[0], "peak_rss_mb": peak_rss_mb(),
            "notes": "seconds of CPU from the matrices to the solution; refactor: other numbers, known pattern; bodies: without the rows",
        })
    }
}
