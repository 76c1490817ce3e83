//! Surfaces given by formulas, on cells of any shape, and what their segments are tested by.

use faying::basis::{Basis, Cell, Elements, Order, ShapeTable, Topology, Unstructured};
use faying::coupling::{CouplingError, InterfaceQuadrature, Segments};
use faying::geometry::{Bounds, Geometry, MapTable};
use faying::linalg::{Matrix, Vector, measure};
use faying::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use faying::space::FunctionSpace;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// A surface over the unit square: position, first derivatives by a and b, second ones by aa, ab, bb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Plane,
    /// z = height sin(pi a) sin(pi b).
    Wave(f64),
    /// Part of a cylinder of this radius: this angle by the height 1.
    Cylinder(f64, f64),
    /// Part of a sphere of this radius: longitudes and latitudes of this range around the equator.
    Sphere(f64, f64),
    /// Part of a sphere about its pole: longitudes of 90 degrees, the angle from the pole up to the second number; b = 1 is the pole.
    Cap(f64, f64),
    /// Flat ring between these radii, a disc where the inner one is 0.
    Ring([f64; 2]),
    /// Part of a torus of these radii: angles around its axis and its tube.
    Torus([f64; 2], f64),
}

type Jet = [Vector<3>; 6];

impl Shape {
    pub fn at(self, a: f64, b: f64) -> Jet {
        let v = |x: f64, y: f64, z: f64| Vector::<3>::new(x, y, z);
        match self {
            Self::Plane => [v(a, b, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0)],
            Self::Wave(h) => {
                let ((sa, ca), (sb, cb)) = ((PI * a).sin_cos(), (PI * b).sin_cos());
                let (h1, h2) = (h * PI, h * PI * PI);
                [
                    v(a, b, h * sa * sb),
                    v(1.0, 0.0, h1 * ca * sb),
                    v(0.0, 1.0, h1 * sa * cb),
                    v(0.0, 0.0, -h2 * sa * sb),
                    v(0.0, 0.0, h2 * ca * cb),
                    v(0.0, 0.0, -h2 * sa * sb),
                ]
            }
            Self::Cylinder(r, range) => {
                let (s, c) = ((a - 0.5) * range).sin_cos();
                let zero = v(0.0, 0.0, 0.0);
                let (d, dd) = (v(r * range * c, 0.0, -r * range * s), v(-r * range * range * s, 0.0, -r * range * range * c));
                [v(r * s, b, r * c), d, v(0.0, 1.0, 0.0), dd, zero, zero]
            }
            Self::Sphere(r, range) => {
                let ((s, c), (t, u)) = (((a - 0.5) * range).sin_cos(), ((b - 0.5) * range).sin_cos());
                let (k, l) = (r * range, r * range * range);
                [
                    v(r * u * s, r * t, r * u * c),
                    v(k * u * c, 0.0, -k * u * s),
                    v(-k * t * s, k * u, -k * t * c),
                    v(-l * u * s, 0.0, -l * u * c),
                    v(-l * t * c, 0.0, l * t * s),
                    v(-l * u * s, -l * t, -l * u * c),
                ]
            }
            Self::Cap(r, range) => {
                let (h, k) = (PI / 2.0, -range);
                let ((s, c), (t, u)) = ((a * h).sin_cos(), ((1.0 - b) * range).sin_cos());
                [
                    v(t * c, t * s, u) * r,
                    v(-t * s, t * c, 0.0) * (r * h),
                    v(u * c, u * s, -t) * (r * k),
                    v(-t * c, -t * s, 0.0) * (r * h * h),
                    v(-u * s, u * c, 0.0) * (r * h * k),
                    v(-t * c, -t * s, -u) * (r * k * k),
                ]
            }
            Self::Ring([inner, outer]) => {
                let (k, width) = (2.0 * PI, outer - inner);
                let (r, (s, c)) = (inner + width * b, (k * a).sin_cos());
                [
                    v(r * c, r * s, 0.0),
                    v(-r * k * s, r * k * c, 0.0),
                    v(width * c, width * s, 0.0),
                    v(-r * k * k * c, -r * k * k * s, 0.0),
                    v(-width * k * s, width * k * c, 0.0),
                    v(0.0, 0.0, 0.0),
                ]
            }
            Self::Torus([big, small], range) => {
                let ((s, c), (t, u)) = (((a - 0.5) * range).sin_cos(), ((b - 0.5) * range).sin_cos());
                let (p, dp, ddp) = (big + small * u, -small * t * range, -small * u * range * range);
                let k = range;
                [
                    v(p * s, small * t, p * c),
                    v(p * k * c, 0.0, -p * k * s),
                    v(dp * s, small * u * k, dp * c),
                    v(-p * k * k * s, 0.0, -p * k * k * c),
                    v(dp * k * c, 0.0, -dp * k * s),
                    v(ddp * s, -small * t * k * k, ddp * c),
                ]
            }
        }
    }
}

/// A change of the parameters of the unit square that keeps its boundary:
/// a = c + w sin(pi c) sin(pi d), b = d - w sin(pi c) sin(2 pi d).
fn warp(w: f64, c: f64, d: f64) -> [Vector<2>; 6] {
    let v = |x: f64, y: f64| Vector::<2>::new(x, y);
    let ((s, k), (t, u), (t2, u2)) = ((PI * c).sin_cos(), (PI * d).sin_cos(), (2.0 * PI * d).sin_cos());
    let (w1, w2) = (w * PI, w * PI * PI);
    [
        v(c + w * s * t, d - w * s * t2),
        v(1.0 + w1 * k * t, -w1 * k * t2),
        v(w1 * s * u, 1.0 - 2.0 * w1 * s * u2),
        v(-w2 * s * t, w2 * s * t2),
        v(w2 * k * u, -2.0 * w2 * k * u2),
        v(-w2 * s * t, 4.0 * w2 * s * t2),
    ]
}

/// A side: cells in the parameters of a shape, which is warped, moved, and replaced by facets of a degree if that is not zero.
#[derive(Clone, Debug)]
pub struct Patch {
    pub shape: Shape,
    /// Vertices in the unit square, and cells by their vertices in the order of [`Elements::corners`].
    pub points: Vec<[f64; 2]>,
    pub topology: Arc<Topology<2>>,
    pub warp: f64,
    /// x -> turn x + shift.
    pub turn: Matrix<3, 3>,
    pub shift: Vector<3>,
    pub facet_degree: usize,
    pub outward: Option<f64>,
    /// Heights of the vertices of flat facets, in place of those of the shape.
    pub heights: Option<Vec<f64>>,
    /// Functions and nodes of the facets of every element, made when they are first asked for.
    nodal: OnceLock<Vec<(Arc<Unstructured<2>>, Vec<Vector<3>>)>>,
}

impl Patch {
    /// n x m quadrilaterals of a rectangle of parameters, or twice as many triangles; `at` places its points.
    pub fn grid(shape: Shape, [n, m]: [usize; 2], triangles: bool, at: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        let mut points = Vec::new();
        for j in 0..=m {
            for i in 0..=n {
                points.push(at(i as f64 / n as f64, j as f64 / m as f64));
            }
        }
        let mut cells = Vec::new();
        for (i, j) in (0..n * m).map(|q| (q % n, q / n)) {
            let a = j * (n + 1) + i;
            let [a, b, c, d] = [a, a + 1, a + n + 1, a + n + 2];
            match (triangles, (i + j) % 2) {
                (false, _) => cells.push((Cell::Tensor, vec![a, b, c, d])),
                (true, 0) => cells.extend([(Cell::Simplex, vec![a, b, c]), (Cell::Simplex, vec![d, c, b])]),
                (true, _) => cells.extend([(Cell::Simplex, vec![b, d, a]), (Cell::Simplex, vec![c, a, d])]),
            }
        }
        Self::of(shape, points, &cells)
    }

    pub fn of(shape: Shape, points: Vec<[f64; 2]>, cells: &[(Cell, Vec<usize>)]) -> Self {
        let corners = cells.iter().flat_map(|(_, ids)| ids.iter().copied()).collect();
        let topology = Arc::new(Topology::new(cells.iter().map(|c| c.0).collect(), corners));
        Self {
            shape,
            points,
            topology,
            warp: 0.0,
            turn: Matrix::identity(),
            shift: Vector::zeros(),
            facet_degree: 0,
            outward: None,
            heights: None,
            nodal: OnceLock::new(),
        }
    }

    pub fn warped(mut self, w: f64) -> Self {
        self.warp = w;
        self
    }

    pub fn facets(mut self, degree: usize) -> Self {
        self.facet_degree = degree;
        self
    }

    /// Moves the vertices inside of the unit square by up to `by`, alike for one `seed`.
    pub fn shaken(mut self, by: f64, seed: u64) -> Self {
        let mut random = Random(seed);
        for p in &mut self.points {
            let inside = p.iter().all(|v| *v > 1e-9 && *v < 1.0 - 1e-9);
            let moved = [0, 1].map(|k| p[k] + by * random.between(-1.0, 1.0));
            *p = if inside { moved } else { *p };
        }
        self
    }

    /// The same surface in space, turned about an axis and shifted.
    pub fn moved(mut self, angle: f64, shift: [f64; 3]) -> Self {
        let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::new(0.3, -0.5, 0.8));
        let turn = nalgebra::Rotation3::from_axis_angle(&axis, angle);
        self.turn = *turn.matrix();
        self.shift = Vector::from(shift);
        self
    }

    /// Continuous Lagrange functions on it.
    pub fn space(&self, degree: usize) -> FunctionSpace<Unstructured<2>, Patch> {
        FunctionSpace { basis: Unstructured::lagrange(degree, Arc::clone(&self.topology)), geometry: self.clone() }
    }

    /// Parameters of a local point, with derivatives by the local coordinates.
    fn parameters(&self, element: usize, xi: &Vector<2>) -> [Vector<2>; 6] {
        let ids = self.topology.corners(element);
        let at = |k: usize| Vector::<2>::from(self.points[ids[k]]);
        let zero = Vector::<2>::zeros();
        let (x, d1, d2, d12) = match self.topology.cell(element) {
            Cell::Simplex => (at(0) + (at(1) - at(0)) * xi[0] + (at(2) - at(0)) * xi[1], at(1) - at(0), at(2) - at(0), zero),
            Cell::Tensor => {
                let mixed = at(3) - at(2) - at(1) + at(0);
                let (e1, e2) = (at(1) - at(0), at(2) - at(0));
                (at(0) + e1 * xi[0] + e2 * xi[1] + mixed * (xi[0] * xi[1]), e1 + mixed * xi[1], e2 + mixed * xi[0], mixed)
            }
        };
        chain(&warp(self.warp, x[0], x[1]), &[d1, d2, zero, d12, zero])
    }

    fn exact(&self, element: usize, xi: &Vector<2>) -> Jet {
        let [p, d1, d2, d11, d12, d22] = self.parameters(element, xi);
        let jet = chain(&self.shape.at(p[0], p[1]), &[d1, d2, d11, d12, d22]);
        let mut out = jet.map(|v| self.turn * v);
        out[0] += self.shift;
        out
    }
}

/// Derivatives of f(p(xi)) from those of f by p (value, 1, 2, 11, 12, 22) and of p by xi (1, 2, 11, 12, 22).
fn chain<const N: usize>(f: &[Vector<N>; 6], p: &[Vector<2>; 5]) -> [Vector<N>; 6] {
    let first = |d: &Vector<2>| f[1] * d[0] + f[2] * d[1];
    let second = |d: &Vector<2>, e: &Vector<2>, dd: &Vector<2>| {
        f[3] * (d[0] * e[0]) + f[4] * (d[0] * e[1] + d[1] * e[0]) + f[5] * (d[1] * e[1]) + first(dd)
    };
    [f[0], first(&p[0]), first(&p[1]), second(&p[0], &p[0], &p[2]), second(&p[0], &p[1], &p[3]), second(&p[1], &p[1], &p[4])]
}

impl Elements for Patch {
    fn num_elements(&self) -> usize {
        self.topology.num_cells()
    }
    fn cell(&self, element: usize) -> Cell {
        self.topology.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(self.topology.corners(element));
    }
}

impl Geometry<2, 3> for Patch {
    fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 3>) {
        table.reset(xi.len(), order);
        let made = || {
            let basis = [4, 3].map(|n| Unstructured::lagrange(self.facet_degree, one_cell(n)));
            let [square, triangle] = basis.map(Arc::new);
            (0..self.num_elements()).map(|e| self.nodal(e, if self.cell(e) == Cell::Tensor { &square } else { &triangle })).collect()
        };
        let facet = (self.facet_degree > 0).then(|| &self.nodal.get_or_init(made)[element]);
        for (q, xi) in xi.iter().enumerate() {
            let [x, d1, d2, d11, d12, d22] = match facet {
                None => self.exact(element, xi),
                Some((basis, nodes)) => interpolated(basis, nodes, xi),
            };
            table.x[q] = x;
            if order >= Order::Gradients {
                table.jacobian[q] = Matrix::from_columns(&[d1, d2]);
            }
            if order >= Order::Hessians {
                for c in 0..3 {
                    table.hessian[q][c] = Matrix::<2, 2>::new(d11[c], d12[c], d12[c], d22[c]);
                }
            }
        }
    }

    fn bounds(&self, element: usize) -> Bounds<3> {
        let mut table = MapTable::new();
        let points: Vec<Vector<2>> = faying::geometry::cell::grid(self.cell(element), 9);
        self.map(element, &points, Order::Values, &mut table);
        let around = Bounds::around(&table.x).unwrap();
        around.inflated(0.05 * around.diagonal())
    }

    fn outward(&self, _element: usize) -> Option<f64> {
        self.outward
    }
}

impl Patch {
    /// The functions of one cell and the points of the surface at their nodes.
    fn nodal(&self, element: usize, basis: &Arc<Unstructured<2>>) -> (Arc<Unstructured<2>>, Vec<Vector<3>>) {
        let kind = self.cell(element);
        let (p, mut nodes) = (self.facet_degree, vec![Vector::<3>::zeros(); Basis::<2>::num_functions(&**basis)]);
        // nodes by solving: the points where the functions are one and zero are those of an equidistant lattice for p = 1, 2
        assert!(p <= 2, "facets of degree 1 and 2");
        let (mut table, mut active) = (ShapeTable::new(), Vec::new());
        basis.active(0, &mut active);
        let lattice: Vec<Vector<2>> = faying::geometry::cell::grid::<2, f64>(Cell::Tensor, p + 1);
        let inside = lattice.iter().filter(|x| kind == Cell::Tensor || x.sum() <= 1.0 + 1e-12);
        for x in inside {
            basis.tabulate(0, &[*x], Order::Values, &mut table);
            let k = table.values(0).iter().position(|v| (v - 1.0).abs() < 1e-12).expect("a node");
            nodes[active[k]] = self.exact(element, x)[0];
            if let Some(heights) = &self.heights {
                let corners = faying::geometry::cell::corners::<2, f64>(kind);
                let corner = corners.iter().position(|c| (c - x).amax() < 1e-12).expect("facets of degree 1");
                nodes[active[k]][2] = heights[self.topology.corners(element)[corner]];
            }
        }
        (Arc::clone(basis), nodes)
    }
}

/// One cell with this number of corners.
fn one_cell(corners: usize) -> Arc<Topology<2>> {
    let kind = if corners == 4 { Cell::Tensor } else { Cell::Simplex };
    Arc::new(Topology::new(vec![kind], (0..corners).collect()))
}

fn interpolated(basis: &Unstructured<2>, nodes: &[Vector<3>], xi: &Vector<2>) -> Jet {
    let (mut table, mut active) = (ShapeTable::new(), Vec::new());
    basis.active(0, &mut active);
    basis.tabulate(0, &[*xi], Order::Hessians, &mut table);
    let mut out = [Vector::<3>::zeros(); 6];
    for (k, &i) in active.iter().enumerate() {
        let (n, g, h) = (table.values(0)[k], table.grads(0)[k], table.hessians(0)[k]);
        for (sum, f) in out.iter_mut().zip([n, g[0], g[1], h[(0, 0)], h[(0, 1)], h[(1, 1)]]) {
            *sum += nodes[i] * f;
        }
    }
    out
}

/// What is measured of segments.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Largest deviation of sum ds / |J| from the cell, relative, over slave elements that the report calls whole.
    pub tiling: f64,
    /// Number of slave elements that are not whole.
    pub open: usize,
    /// Largest error of columns of D, sum over points of N_i ds against the slave's own rule, on whole elements only.
    pub slave: f64,
    /// Largest error of columns of M, relative to the largest one.
    pub master: f64,
    /// Largest distance of partners.
    pub distance: f64,
    pub outside: f64,
    pub pieces: usize,
    /// Elements of which a part that faces the master is lost.
    pub lost: usize,
}

/// Rules that integrate a side's own functions to rounding.
pub fn own_rule(cell: Cell) -> Rule<2> {
    match cell {
        Cell::Tensor => TensorRule::<2>::gauss([24; 2]).rule(0).clone(),
        Cell::Simplex => simplex_rule(40),
    }
}

/// Sums of functions over points: by the segments and by the side's own rule times `weight(x)`.
fn columns(segments: &Segments<2>, space: &FunctionSpace<Unstructured<2>, Patch>, slave: bool, weight: &dyn Fn(&Vector<3>) -> f64) -> f64 {
    let n = Basis::<2>::num_functions(space);
    let (mut found, mut expected, mut ids) = (vec![0.0; n], vec![0.0; n], Vec::new());
    let (mut shapes, mut map) = (ShapeTable::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        let (element, xi) = match slave {
            true => (segments.slave[piece], &segments.slave_xi),
            false => (segments.master[piece], &segments.master_xi),
        };
        let points = segments.points(piece);
        space.active(element, &mut ids);
        space.tabulate(element, &xi[points.clone()], Order::Values, &mut shapes);
        for (k, q) in points.enumerate() {
            ids.iter().zip(shapes.values(k)).for_each(|(&i, v)| found[i] += v * segments.ds[q]);
        }
    }
    for element in 0..space.num_elements() {
        let rule = own_rule(space.cell(element));
        space.active(element, &mut ids);
        space.tabulate(element, &rule.points, Order::Values, &mut shapes);
        space.map(element, &rule.points, Order::Gradients, &mut map);
        for (q, (j, w)) in map.jacobian.iter().zip(&rule.weights).enumerate() {
            let ds = measure(j) * w * weight(&map.x[q]);
            ids.iter().zip(shapes.values(q)).for_each(|(&i, v)| expected[i] += v * ds);
        }
    }
    let largest = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// Measures the segments of `rule`; `stretch(x)`: measure of the slave over that of the master at a point of the master.
pub fn measured(
    rule: &dyn InterfaceQuadrature<2, 3>,
    [slave, master]: [&Patch; 2],
    degree: usize,
    stretch: &dyn Fn(&Vector<3>) -> f64,
) -> Result<Measured, CouplingError> {
    let segments = rule.segments(slave, master)?;
    segments.well_formed(slave.num_elements(), master.num_elements())?;
    let report = &segments.report;
    let mut sums = vec![0.0; slave.num_elements()];
    let mut table = MapTable::new();
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        slave.map(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Gradients, &mut table);
        for (k, q) in points.enumerate() {
            sums[segments.slave[piece]] += segments.ds[q] / measure(&table.jacobian[k]);
        }
    }
    let (mut tiling, mut open) = (0.0f64, 0);
    for (element, sum) in sums.iter().enumerate() {
        let cell = if slave.cell(element) == Cell::Tensor { 1.0 } else { 0.5 };
        if report.share[element] == 1.0 { tiling = tiling.max((sum / cell - 1.0).abs()) } else { open += 1 }
    }
    let slave_columns = if open == 0 { columns(&segments, &slave.space(degree), true, &|_| 1.0) } else { f64::NAN };
    Ok(Measured {
        tiling,
        open,
        slave: slave_columns,
        master: columns(&segments, &master.space(degree), false, stretch),
        distance: report.distance,
        outside: report.outside,
        pieces: report.pieces,
        lost: report.lost.len(),
    })
}

/// Numbers of a multiplicative generator, alike on all machines.
pub struct Random(pub u64);

impl Random {
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        lo + (hi - lo) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.between(0.0, n as f64) as usize).min(n - 1)
    }
}

/// No change of measure between the sides.
pub fn one(_: &Vector<3>) -> f64 {
    1.0
}
