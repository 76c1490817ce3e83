//! Ties and presses any two bodies by library calls alone: the lower one on [0, 1]², the upper one on [0, 1] x [1, 2].

use faying::assembly::{Fixed, Norms, Reduced, dirichlet, errors, gauss_rules, stiffness, trace_load};
use faying::constraint::{ActiveSet, Condensed, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, RowKind};
use faying::contact::{Contact, Opponent};
use faying::coupling::interface::{InterfaceQuadrature, MergedCurve, Tolerance};
use faying::coupling::multiplier::{MultiplierKind, build};
use faying::coupling::{Coupling, Interface, Mortar, Rows, Side};
use faying::linalg::{Csr, Ldlt, Matrix, Vector};
use faying::physics::{Hooke, Material, form};
use faying::space::{Body, Field};

/// A body with the names of its sides in the order left, right, bottom, top.
pub struct Part<'a> {
    pub body: &'a dyn Body<1, 2>,
    pub sides: [&'a str; 4],
}

/// Largest errors of a run: displacement (L2, energy), multiplier; and the iterations of the active set.
#[derive(Debug)]
pub struct Outcome {
    pub displacement: Norms,
    pub multiplier: f64,
    pub iterations: usize,
}

fn steel() -> Hooke<2> {
    Hooke::plane_strain(1.0, 0.3).expect("valid constants")
}

fn degree(body: &dyn Body<1, 2>) -> usize {
    body.space().degree(0)[0]
}

struct System {
    matrices: Vec<Csr>,
    load: Vec<f64>,
    prescribed: Vec<(usize, f64)>,
    fields: [Field; 2],
}

/// `fixed(part, side)`: which components of a side take the exact values; the sides left get the exact traction.
fn assemble(
    parts: &[Part<'_>; 2],
    grad: &Matrix<2, 2>,
    shift: [f64; 2],
    contact: [usize; 2],
    fixed: impl Fn(usize, usize) -> Vec<usize>,
) -> System {
    let material = steel();
    let sigma = material.respond(&Vector::<2>::zeros(), grad).stress;
    let first = [0, 2 * parts[0].body.space().num_functions()];
    let fields = first.map(|first| Field { first, components: 2 });
    let (mut matrices, mut load, mut prescribed) = (Vec::new(), Vec::new(), Vec::new());
    for (b, part) in parts.iter().enumerate() {
        let space = &**part.body.space();
        matrices.push(stiffness(space, &gauss_rules(space, 0), &form(&material).expect("a linear law")));
        let mut own = vec![0.0; 2 * space.num_functions()];
        let traces: Vec<_> = part.sides.iter().map(|s| part.body.trace(s).expect("a side")).collect();
        let exact = [0, 1].map(|c| move |x: &Vector<2>| (grad * x)[c] + shift[b] * c as f64);
        let mut conditions = Vec::new();
        for (k, trace) in traces.iter().enumerate().filter(|&(k, _)| k != contact[b]) {
            let components = fixed(b, k);
            // the components that are not fixed carry the exact traction
            trace_load::<2, 1, 2, _, _>(
                trace,
                &gauss_rules(&*trace.space, 0),
                &|_: &Vector<2>, n: &Vector<2>| Vector::<2>::from_fn(|c, _| if components.contains(&c) { 0.0 } else { (sigma * n)[c] }),
                &mut own,
            );
            conditions.extend(components.into_iter().map(|component| Fixed { trace, component, value: Some(&exact[component]) }));
        }
        prescribed.extend(dirichlet(&conditions, fields[b], 0, &mut Ldlt::new()).expect("compatible data"));
        load.extend(own);
    }
    System { matrices, load, prescribed, fields }
}

fn solve(
    system: &System,
    rows: &Rows,
    offset: &[f64],
    kind: &[RowKind],
    solver: &mut dyn ConstraintSolver,
) -> (Vec<f64>, ConstrainedSolution) {
    let matrices: Vec<&Csr> = system.matrices.iter().collect();
    let reduced = Reduced::try_new(&matrices, &system.load, &system.prescribed, &[]).expect("no contradiction");
    let ((slave, from_slave), (master, from_master)) = (reduced.rows(&rows.slave), reduced.rows(&rows.master));
    let offset: Vec<f64> = (0..offset.len()).map(|i| offset[i] + from_slave[i] + from_master[i]).collect();
    let constraint = Rows { slave, master };
    let problem = ConstrainedSystem {
        stiffness: &reduced.stiffness,
        load: &reduced.load,
        constraint: &constraint,
        reaction: None,
        offset: &offset,
        kind,
        compliance: &[],
    };
    let solution = solver.solve(&problem).expect("a solution");
    (reduced.expand(&solution.unknowns), solution)
}

fn displacement_errors(parts: &[Part<'_>; 2], fields: [Field; 2], u: &[f64], grad: &Matrix<2, 2>, shift: [f64; 2]) -> Norms {
    let material = steel();
    let per_body = [0, 1].map(|b| {
        let space = &**parts[b].body.space();
        let own = &u[fields[b].first..fields[b].first + 2 * space.num_functions()];
        let exact = |x: &Vector<2>| (grad * x + Vector::<2>::new(0.0, shift[b]), *grad);
        errors(space, &gauss_rules(space, 1), &form(&material).expect("a linear law"), own, &exact).error
    });
    per_body[0].hypot(per_body[1])
}

/// Ties the top of the lower body to the bottom of the upper one under a linear field; `slave` is 0 (lower) or 1.
pub fn tied_patch(parts: &[Part<'_>; 2], slave: usize, multiplier: MultiplierKind, condensed: bool) -> Outcome {
    let grad = Matrix::<2, 2>::new(0.3, -0.2, 0.5, 0.1);
    let interface_side = [3, 2];
    // bottom and top take the exact values, left and right the exact traction: the ends of the interface stay free
    let system = assemble(parts, &grad, [0.0; 2], interface_side, |_, side| if side >= 2 { vec![0, 1] } else { vec![] });
    let traces = [0, 1].map(|b| parts[b].body.trace(parts[b].sides[interface_side[b]]).expect("a side"));
    let master = 1 - slave;
    let psi = build(&traces[slave].space, multiplier, &[]).expect("a multiplier");
    let points = degree(parts[0].body).max(degree(parts[1].body)) + 1;
    let segments =
        MergedCurve::tied(points, Tolerance::Exact).segments(&*traces[slave].space, &*traces[master].space).expect("the sides touch");
    let side = |b: usize| Side { trace: &traces[b], field: system.fields[b], flux: None };
    let interface = Interface {
        slave: side(slave),
        master: Some(side(master)),
        multiplier: &[&*psi],
        segments: &segments,
        master_segments: None,
        direction: None,
    };
    let rows = Mortar.assemble(&interface, system.load.len()).expect("rows").constraint;
    let n = rows.slave.rows;
    let mut solver: Box<dyn ConstraintSolver> = if condensed { Box::new(Condensed::new()) } else { Box::new(Direct::new()) };
    let (u, solution) = solve(&system, &rows, &vec![0.0; n], &vec![RowKind::Equal; n], &mut solver);

    // lambda = -sigma n of the slave: compared as a function, since the multipliers need not sum to one
    let outward = if slave == 0 { 1.0 } else { -1.0 };
    let expected = -steel().respond(&Vector::<2>::zeros(), &grad).stress * Vector::<2>::new(0.0, outward);
    let mut worst = 0.0_f64;
    let (mut table, mut ids) = (faying::basis::ShapeTable::new(), Vec::new());
    for element in 0..psi.num_elements() {
        psi.tabulate(element, &[Vector::<1>::new(0.3)], faying::basis::Order::Values, &mut table);
        psi.active(element, &mut ids);
        for c in 0..2 {
            let lambda: f64 = ids.iter().zip(table.values(0)).map(|(&j, v)| solution.multipliers[c * psi.num_functions() + j] * v).sum();
            worst = worst.max((lambda - expected[c]).abs());
        }
    }
    Outcome { displacement: displacement_errors(parts, system.fields, &u, &grad, [0.0; 2]), multiplier: worst, iterations: 1 }
}

/// Presses the upper body, slave, on the lower one by sigma_yy = -1.25e-3; `gap` open at first.
pub fn contact_patch(parts: &[Part<'_>; 2], slave: usize, condensed: bool) -> Outcome {
    let (young, nu, p) = (1.0, 0.3, 1.25e-3);
    // plane strain, sigma_yy = -p, sigma_xx = 0
    let grad = Matrix::<2, 2>::from_diagonal(&Vector::<2>::new(p * nu * (1.0 + nu) / young, -p * (1.0 - nu * nu) / young));
    let interface_side = [3, 2];
    // symmetry on the left, support at the bottom; pressure (the exact traction) on top, the right side free
    let system = assemble(parts, &grad, [0.0; 2], interface_side, |b, side| match (b, side) {
        (_, 0) => vec![0],
        (0, 2) => vec![1],
        _ => vec![],
    });
    let traces = [0, 1].map(|b| parts[b].body.trace(parts[b].sides[interface_side[b]]).expect("a side"));
    let master = 1 - slave;
    let psi = build(&traces[slave].space, MultiplierKind::Constant, &[]).expect("a multiplier");
    let points = degree(parts[0].body).max(degree(parts[1].body)) + 1;
    let segments = MergedCurve::facing(points, None).segments(&*traces[slave].space, &*traces[master].space).expect("the sides face");
    let side = |b: usize| Side { trace: &traces[b], field: system.fields[b], flux: None };
    let contact =
        Contact::new(side(slave), Opponent::Master(side(master)), &*psi, segments, &|_, g| g, system.load.len()).expect("a contact");
    let kinds = contact.kinds();
    let inner: Box<dyn ConstraintSolver> = if condensed { Box::new(Condensed::new()) } else { Box::new(Direct::new()) };
    let (u, solution) = solve(&system, &contact.rows, &contact.offset, &kinds, &mut ActiveSet::new(inner));
    let worst = solution.multipliers.iter().map(|l| (l + p).abs()).fold(0.0, f64::max);
    let iterations = solution.active_set.as_ref().map_or(0, |a| a.iterations);
    Outcome { displacement: displacement_errors(parts, system.fields, &u, &grad, [0.0; 2]), multiplier: worst, iterations }
}
