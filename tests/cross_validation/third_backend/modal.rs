//! A backend from outside: a modal (hierarchical Legendre) basis on a sheared grid with a map of its own.

use faying::basis::{Basis, Cell, Elements, Order, ShapeTable};
use faying::geometry::{Bounds, Embedding, Geometry, MapTable};
use faying::linalg::{Matrix, Vector};
use faying::space::{Body, FunctionSpace, SideError, Space, Trace};
use std::sync::Arc;

/// Vertex functions 1 - x, x and the bubbles (P_k(s) - P_{k-2}(s)) / (2k - 1), s = 2x - 1, k = 2..p, with two derivatives.
fn modes(degree: usize, x: f64) -> Vec<[f64; 3]> {
    let s = 2.0 * x - 1.0;
    // Legendre polynomials and their first derivatives in s
    let (mut p, mut d) = (vec![1.0, s], vec![0.0, 1.0]);
    for k in 2..=degree {
        let kf = k as f64;
        p.push(((2.0 * kf - 1.0) * s * p[k - 1] - (kf - 1.0) * p[k - 2]) / kf);
        d.push(d[k - 2] + (2.0 * kf - 1.0) * p[k - 1]);
    }
    let mut all = vec![[1.0 - x, -1.0, 0.0], [x, 1.0, 0.0]];
    all.extend((2..=degree).map(|k| [(p[k] - p[k - 2]) / (2 * k - 1) as f64, 2.0 * p[k - 1], 4.0 * d[k - 1]]));
    all
}

/// n elements in a row; ids: the vertices, then the bubbles of each element.
#[derive(Clone, Copy, Debug)]
struct Line {
    elements: usize,
    degree: usize,
}

impl Line {
    fn num_functions(self) -> usize {
        self.elements * self.degree + 1
    }
    fn ids(self, e: usize) -> Vec<usize> {
        let bubbles = self.elements + 1 + e * (self.degree - 1);
        [e, e + 1].into_iter().chain(bubbles..bubbles + self.degree - 1).collect()
    }
}

/// Products of modes on a grid of nx x ny elements.
#[derive(Clone, Debug)]
struct ModalBasis {
    lines: [Line; 2],
}

impl Elements for ModalBasis {
    fn num_elements(&self) -> usize {
        self.lines[0].elements * self.lines[1].elements
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        let nx = self.lines[0].elements;
        let (i, j) = (element % nx, element / nx);
        ids.clear();
        ids.extend([(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| (i + a) + (nx + 1) * (j + b)));
    }
}

impl Basis<2> for ModalBasis {
    fn num_functions(&self) -> usize {
        self.lines[0].num_functions() * self.lines[1].num_functions()
    }
    fn degree(&self, _element: usize) -> [usize; 2] {
        self.lines.map(|l| l.degree)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        let nx = self.lines[0].elements;
        let (a, b) = (self.lines[0].ids(element % nx), self.lines[1].ids(element / nx));
        ids.clear();
        for j in b {
            ids.extend(a.iter().map(|i| i + self.lines[0].num_functions() * j));
        }
    }
    fn tabulate(&self, _element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
        let [p, q] = self.lines.map(|l| l.degree);
        table.reset(xi.len(), (p + 1) * (q + 1), order);
        for (k, x) in xi.iter().enumerate() {
            let (a, b) = (modes(p, x[0]), modes(q, x[1]));
            for (j, v) in b.iter().enumerate() {
                for (i, u) in a.iter().enumerate() {
                    let f = i + (p + 1) * j;
                    table.values_mut(k)[f] = u[0] * v[0];
                    if order >= Order::Gradients {
                        table.grads_mut(k)[f] = Vector::<2>::new(u[1] * v[0], u[0] * v[1]);
                    }
                    if order >= Order::Hessians {
                        table.hessians_mut(k)[f] = Matrix::<2, 2>::new(u[2] * v[0], u[1] * v[1], u[1] * v[1], u[0] * v[2]);
                    }
                }
            }
        }
    }
}

/// x = origin + axes (grid coordinate): one affine map for the whole grid.
#[derive(Clone, Debug)]
struct Parallelogram {
    cells: [usize; 2],
    origin: Vector<2>,
    axes: Matrix<2, 2>,
}

impl Elements for Parallelogram {
    fn num_elements(&self) -> usize {
        self.cells[0] * self.cells[1]
    }
}

impl Geometry<2, 2> for Parallelogram {
    fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 2>) {
        let first = Vector::<2>::new((element % self.cells[0]) as f64, (element / self.cells[0]) as f64);
        let size = Matrix::<2, 2>::from_diagonal(&Vector::<2>::new(1.0 / self.cells[0] as f64, 1.0 / self.cells[1] as f64));
        let jacobian = self.axes * size;
        table.reset(xi.len(), order);
        for (q, x) in xi.iter().enumerate() {
            table.x[q] = self.origin + jacobian * (first + x);
            if order >= Order::Gradients {
                table.jacobian[q] = jacobian;
            }
        }
    }
    fn bounds(&self, element: usize) -> Bounds<2> {
        let mut table = MapTable::new();
        self.map(element, &[[0., 0.], [1., 0.], [0., 1.], [1., 1.]].map(Vector::<2>::from), Order::Values, &mut table);
        Bounds::around(&table.x).expect("four corners")
    }
}

/// A parallelogram with a modal basis; sides `west`, `east`, `south`, `north`.
#[derive(Debug)]
pub struct ModalBody {
    space: Arc<dyn Space<2, 2>>,
    cells: [usize; 2],
}

impl ModalBody {
    /// `cells` elements of `degree` on origin + [0,1] axes.x + [0,1] axes.y.
    pub fn new(cells: [usize; 2], degree: usize, origin: [f64; 2], axes: [[f64; 2]; 2]) -> Self {
        let basis = ModalBasis { lines: cells.map(|elements| Line { elements, degree }) };
        let axes = Matrix::<2, 2>::from_columns(&axes.map(Vector::<2>::from));
        let geometry = Parallelogram { cells, origin: origin.into(), axes };
        Self { space: Arc::new(FunctionSpace { basis, geometry }), cells }
    }
}

impl Body<1, 2> for ModalBody {
    fn space(&self) -> &Arc<dyn Space<2, 2>> {
        &self.space
    }
    fn sides(&self) -> Vec<String> {
        ["west", "east", "south", "north"].map(String::from).to_vec()
    }
    fn trace(&self, side: &str) -> Result<Trace<1, 2>, SideError> {
        let [nx, ny] = self.cells;
        let facet = |i: usize, j: usize, origin: [f64; 2], axis: [f64; 2]| Embedding {
            element: i + nx * j,
            origin: origin.into(),
            axes: Matrix::<2, 1>::from_columns(&[Vector::<2>::from(axis)]),
        };
        let facets = match side {
            "west" => (0..ny).map(|j| facet(0, j, [0., 0.], [0., 1.])).collect(),
            "east" => (0..ny).map(|j| facet(nx - 1, j, [1., 0.], [0., 1.])).collect(),
            "south" => (0..nx).map(|i| facet(i, 0, [0., 0.], [1., 0.])).collect(),
            "north" => (0..nx).map(|i| facet(i, ny - 1, [0., 1.], [1., 0.])).collect(),
            _ => return Err(SideError::Unknown { side: side.into(), known: self.sides().join(", ") }),
        };
        Trace::from_facets(&self.space, facets, Cell::Tensor)
    }
}
