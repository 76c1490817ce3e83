//! A backend from outside: another body's functions in another order and of another size, some of them negative.

use faying::basis::{Basis, Cell, Elements, Order, ShapeTable};
use faying::linalg::Vector;
use faying::space::{Body, FunctionSpace, SideError, Space, Trace};
use std::sync::Arc;

/// Function `order[i]` is `scale[i]` times the inner function i.
#[derive(Debug)]
struct Scrambled {
    inner: Arc<dyn Space<2, 2>>,
    order: Vec<usize>,
    scale: Vec<f64>,
}

impl Elements for Scrambled {
    fn num_elements(&self) -> usize {
        self.inner.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.inner.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.inner.corners(element, ids);
    }
}

impl Basis<2> for Scrambled {
    fn num_functions(&self) -> usize {
        self.inner.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; 2] {
        self.inner.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.inner.active(element, ids);
        ids.iter_mut().for_each(|i| *i = self.order[*i]);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
        self.inner.tabulate(element, xi, order, table);
        let mut ids = Vec::new();
        self.inner.active(element, &mut ids);
        for q in 0..xi.len() {
            for (a, &i) in ids.iter().enumerate() {
                table.values_mut(q)[a] *= self.scale[i];
                if order >= Order::Gradients {
                    table.grads_mut(q)[a] *= self.scale[i];
                }
                if order >= Order::Hessians {
                    table.hessians_mut(q)[a] *= self.scale[i];
                }
            }
        }
    }
}

/// A body whose functions are scrambled; its sides are those of the body inside.
#[derive(Debug)]
pub struct ScrambledBody {
    space: Arc<dyn Space<2, 2>>,
    inner: Box<dyn Body<1, 2>>,
}

impl ScrambledBody {
    /// Scrambles `inner`.
    pub fn new(inner: Box<dyn Body<1, 2>>) -> Self {
        let n = inner.space().num_functions();
        let stride = (n / 2..).find(|s| s % 2 == 1 && gcd(*s, n) == 1).expect("a number prime to n");
        let order = (0..n).map(|i| (i * stride + 3) % n).collect();
        let scale = (0..n).map(|i| if i % 3 == 1 { -1.5 } else { 0.4 + (i % 5) as f64 }).collect();
        let space = Arc::clone(inner.space());
        let basis = Scrambled { inner: Arc::clone(&space), order, scale };
        Self { space: Arc::new(FunctionSpace { basis, geometry: space }), inner }
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

impl Body<1, 2> for ScrambledBody {
    fn space(&self) -> &Arc<dyn Space<2, 2>> {
        &self.space
    }
    fn sides(&self) -> Vec<String> {
        self.inner.sides()
    }
    fn trace(&self, side: &str) -> Result<Trace<1, 2>, SideError> {
        Trace::from_facets(&self.space, self.inner.trace(side)?.facets, Cell::Tensor)
    }
}
