//! W5: two sides that do not match, from the search of partners to both coupling matrices.

use crate::measure::{Time, median, timed};
use crate::run::{Options, own_record};
use faying::basis::{Basis, Order, ShapeTable};
use faying::coupling::interface::{InterfaceQuadrature, MergedCurve, Segments, Tolerance};
use faying::coupling::multiplier::{Ends, MultiplierKind, build};
use faying::coupling::{Coupling, Interface, Mortar, Side};
use faying::geometry::{MapTable, shapes};
use faying::linalg::Csr;
use faying::space::{Body, Field, Mesh, PatchSpec, Trace};
use serde_json::{Value, json};

/// One layer of n Lagrange elements of degree p on a strip of length 1; its side "v1" is above, "v0" below.
pub fn strip(p: usize, n: usize, [low, high]: [f64; 2]) -> Mesh<1, 2> {
    let spec = PatchSpec::new(shapes::rectangle([0.0, low], [1.0, high]).unwrap());
    Mesh::from_patch(&spec.with_degree([p; 2]).with_elements([n, 1])).unwrap()
}

/// Segments, D and -M of scalar fields.
struct Coupled {
    segments: Segments<1>,
    slave: Csr,
    master: Csr,
}

fn couple(slave: &Trace<1, 2>, master: &Trace<1, 2>, multiplier: &dyn Basis<1>, p: usize, unknowns: [usize; 2]) -> (Coupled, [Time; 2]) {
    let rule = MergedCurve::tied(p + 1, Tolerance::Exact);
    let (segments, search) = timed(|| rule.segments(&*slave.space, &*master.space).unwrap());
    let ((slave, master), sums) = timed(|| {
        let side = |trace, first| Side { trace, field: Field { first, components: 1 }, flux: None };
        let interface = Interface {
            slave: side(slave, 0),
            master: Some(side(master, unknowns[0])),
            multiplier: &[multiplier],
            segments: &segments,
            master_segments: None,
            direction: None,
        };
        let rows = Mortar.assemble(&interface, unknowns[0] + unknowns[1]).unwrap().constraint;
        (rows.slave.to_csr(), rows.master.to_csr())
    });
    (Coupled { segments, slave, master }, [search, sums])
}

/// Largest difference of the column sums of M from the integrals of the master's functions by the master's own rule, over the largest
/// of these: the multipliers sum to one, so the sums are those integrals wherever no part of the master is left out or taken twice.
fn column_defect(master: &Trace<1, 2>, m: &Csr, first: usize, p: usize) -> f64 {
    let space = &*master.space;
    let (mut sums, mut own) = (vec![0.0; m.num_cols()], vec![0.0; m.num_cols()]);
    (0..m.num_rows()).for_each(|i| m.row(i).0.zip(m.row(i).1).for_each(|(j, v)| sums[j] -= v));
    let rule = faying::quadrature::gauss_legendre::<f64>(p + 1);
    let (mut shapes, mut map, mut ids) = (ShapeTable::new(), MapTable::<1, 2>::new(), Vec::new());
    for e in 0..space.num_elements() {
        space.active(e, &mut ids);
        space.tabulate(e, &rule.points, Order::Values, &mut shapes);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        for (q, weight) in rule.weights.iter().enumerate() {
            let ds = weight * map.jacobian[q].norm();
            ids.iter().zip(shapes.values(q)).for_each(|(&i, v)| own[first + master.dofs[i]] += ds * v);
        }
    }
    let largest = own.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    sums.iter().zip(&own).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / largest
}

/// Largest defect of ∫ xi^k over the pieces of a slave element, k = 0..3, from 1/(k + 1): a gap or an overlap of pieces shows in one.
fn tiling_defect(slave: &Trace<1, 2>, segments: &Segments<1>) -> f64 {
    let space = &*slave.space;
    let (mut moments, mut map) = (vec![[0.0; 4]; space.num_elements()], MapTable::<1, 2>::new());
    for piece in 0..segments.num_pieces() {
        let (e, points) = (segments.slave[piece], segments.points(piece));
        space.map(e, &segments.slave_xi[points.clone()], Order::Gradients, &mut map);
        for (k, q) in points.enumerate() {
            let width = segments.ds[q] / map.jacobian[k].norm();
            (0..4).for_each(|power| moments[e][power] += width * segments.slave_xi[q][0].powi(power as i32));
        }
    }
    moments.iter().flat_map(|m| m.iter().enumerate()).fold(0.0f64, |worst, (k, m)| worst.max((m - 1.0 / (k as f64 + 1.0)).abs()))
}

/// W5-2d: n slave and 1.5 n master elements of degree p on a straight interface of length 1, continuous linear multipliers.
pub fn straight(name: &str, p: usize, n: usize, options: &Options) -> Value {
    let bodies = [strip(p, n, [0.0, 0.01]), strip(p, n + n / 2, [0.01, 0.02])];
    let unknowns = [0, 1].map(|k: usize| bodies[k].space().num_functions());
    let (slave, master) = (bodies[0].trace("v1").unwrap(), bodies[1].trace("v0").unwrap());
    let linear = MultiplierKind::Uniform { degree: 1, continuity: Some(0), ends: Ends::Auto };
    let multiplier = build(&slave.space, linear, &[false; 2]).unwrap();
    let runs: Vec<_> = (0..=options.reps).map(|_| couple(&slave, &master, &*multiplier, p, unknowns)).collect();
    let phase = |k: usize| median(&runs[1..].iter().map(|r| r.1[k]).collect::<Vec<_>>());
    let (search, sums) = (phase(0), phase(1));
    let coupled = &runs[0].0;
    let square = |m: &Csr| m.vals().iter().map(|v| v * v).sum::<f64>();
    let columns = column_defect(&master, &coupled.master, unknowns[0], p);
    let tiling = tiling_defect(&slave, &coupled.segments);
    own_record(
        name,
        [p, n],
        options,
        json!({
            "dofs": multiplier.num_functions(), "nnz": coupled.slave.num_entries() + coupled.master.num_entries(),
            "assemble_s": search.wall + sums.wall, "assemble_cpu_s": search.cpu + sums.cpu,
            "segments_cpu_s": search.cpu, "matrices_cpu_s": sums.cpu, "pieces": coupled.segments.num_pieces(),
            "error": columns.max(tiling), "error_columns": columns, "error_tiling": tiling,
            "fp_fro": (square(&coupled.slave) + square(&coupled.master)).sqrt(),
        }),
    )
}
