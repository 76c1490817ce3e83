//! W5-3d: segments of two surfaces that do not match, from the search of partners to the points.

use crate::measure::{median, timed};
use crate::run::{Options, own_record};
use faying::basis::{Basis, Cell, Elements, Order, ShapeTable, Topology, Unstructured};
use faying::coupling::interface::{InterfaceQuadrature, MergedSurface, Segments, Tolerance};
use faying::geometry::{ControlPoints, Geometry, MapTable, cell};
use faying::linalg::{Vector, measure};
use faying::quadrature::{Rule, simplex_rule};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::sync::Arc;

type Surface = ControlPoints<Unstructured<2>, 3>;

/// n x n cells of degree p on the unit square, two triangles each or one quadrilateral, their nodes moved by `place`.
fn surface(kind: Cell, p: usize, n: usize, place: impl Fn(f64, f64) -> Vector<3>) -> Surface {
    let (mut cells, mut corners) = (Vec::new(), Vec::new());
    for (i, j) in (0..n * n).map(|q| (q % n, q / n)) {
        let a = j * (n + 1) + i;
        let [a, b, c, d] = [a, a + 1, a + n + 1, a + n + 2];
        match kind {
            Cell::Tensor => corners.extend([a, b, c, d]),
            Cell::Simplex => corners.extend([a, b, c, d, c, b]),
        }
        cells.extend(std::iter::repeat_n(kind, if kind == Cell::Tensor { 1 } else { 2 }));
    }
    let at = |v: usize| Vector::<2>::new((v % (n + 1)) as f64 / n as f64, (v / (n + 1)) as f64 / n as f64);
    let basis = Unstructured::lagrange(p, Arc::new(Topology::new(cells, corners)));
    let mut points = vec![Vector::zeros(); Basis::<2>::num_functions(&basis)];
    let (mut shapes, mut ids) = (ShapeTable::new(), Vec::new());
    let lattice: Vec<Vector<2>> = cell::grid::<2, f64>(Cell::Tensor, p + 1);
    for e in 0..basis.num_elements() {
        let corner: Vec<Vector<2>> = basis.topology().corners(e).iter().map(|&v| at(v)).collect();
        basis.active(e, &mut ids);
        for xi in lattice.iter().filter(|xi| kind == Cell::Tensor || xi.sum() < 1.0 + 1e-9) {
            basis.tabulate(e, &[*xi], Order::Values, &mut shapes);
            let node = shapes.values(0).iter().position(|v| (v - 1.0).abs() < 1e-12).expect("nodes of degree 1 and 2 are equidistant");
            let x = corner[0] + (corner[1] - corner[0]) * xi[0] + (corner[2] - corner[0]) * xi[1];
            points[ids[node]] = place(x[0], x[1]);
        }
    }
    ControlPoints { basis, points }
}

/// The rule of a side's own cells, exact to rounding here.
fn own_rule(kind: Cell) -> Rule<2> {
    match kind {
        Cell::Tensor => faying::quadrature::Quadrature::rule(&faying::quadrature::TensorRule::<2>::gauss([8; 2]), 0).clone(),
        Cell::Simplex => simplex_rule(15),
    }
}

/// Largest difference of sums of the master's functions over the points from their integrals by the master's own rule, over the largest.
fn column_defect(master: &Surface, segments: &Segments<2>) -> f64 {
    let n = Basis::<2>::num_functions(master);
    let (mut sums, mut own) = (vec![0.0; n], vec![0.0; n]);
    let (mut shapes, mut map, mut ids) = (ShapeTable::new(), MapTable::new(), Vec::new());
    let mut add = |e: usize, xi: &[Vector<2>], ds: &dyn Fn(usize) -> f64, into: &mut [f64]| {
        master.active(e, &mut ids);
        master.tabulate(e, xi, Order::Values, &mut shapes);
        (0..xi.len()).for_each(|q| ids.iter().zip(shapes.values(q)).for_each(|(&i, v)| into[i] += ds(q) * v));
    };
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        add(segments.master[piece], &segments.master_xi[points.clone()], &|q| segments.ds[points.start + q], &mut sums);
    }
    for e in 0..master.num_elements() {
        let rule = own_rule(master.cell(e));
        master.map(e, &rule.points, Order::Gradients, &mut map);
        add(e, &rule.points, &|q| measure(&map.jacobian[q]) * rule.weights[q], &mut own);
    }
    let largest = own.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    sums.iter().zip(&own).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / largest
}

/// Largest defect of the local area of a slave element that the pieces cover.
fn tiling_defect(slave: &Surface, segments: &Segments<2>) -> f64 {
    let (mut sums, mut map) = (vec![0.0; slave.num_elements()], MapTable::new());
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        slave.map(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Gradients, &mut map);
        points.enumerate().for_each(|(k, q)| sums[segments.slave[piece]] += segments.ds[q] / measure(&map.jacobian[k]));
    }
    let whole = |e: usize| if slave.cell(e) == Cell::Tensor { 1.0 } else { 0.5 };
    sums.iter().enumerate().fold(0.0f64, |m, (e, s)| m.max((s / whole(e) - 1.0).abs()))
}

/// W5-3d-p1: triangles on the unit square, n x n x 2 against 1.5 times as many each way, whose nodes are moved; W5-3d-q2: the same
/// with quadratic quadrilaterals on the graph z = 0.05 sin(pi x) sin(pi y).
pub fn pair(name: &str, n: usize, options: &Options) -> Value {
    let (kind, p, height) = if name == "W5-3d-p1" { (Cell::Simplex, 1, 0.0) } else { (Cell::Tensor, 2, 0.05) };
    let graph = |x: f64, y: f64| Vector::<3>::new(x, y, height * (PI * x).sin() * (PI * y).sin());
    let slave = surface(kind, p, n, graph);
    let master = surface(kind, p, n + n / 2, |x, y| {
        let s = 0.03 * (2.0 * PI * x).sin() * (2.0 * PI * y).sin();
        graph(x + s, y + s)
    });
    let rule = MergedSurface::tied(p + 1, Tolerance::Local);
    let runs: Vec<_> = (0..=options.reps).map(|_| timed(|| rule.segments(&slave, &master).unwrap())).collect();
    let time = median(&runs[1..].iter().map(|r| r.1).collect::<Vec<_>>());
    let segments = &runs[0].0;
    let (columns, tiling) = (column_defect(&master, segments), tiling_defect(&slave, segments));
    own_record(
        name,
        [p, n],
        options,
        json!({
            "segments_s": time.wall, "segments_cpu_s": time.cpu, "pieces": segments.num_pieces(), "points": segments.ds.len(),
            "us_per_piece": 1e6 * time.cpu / segments.num_pieces() as f64, "distance": segments.report.distance,
            "error_columns": columns, "error_tiling": tiling,
        }),
    )
}
