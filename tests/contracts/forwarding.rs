//! Pointers forward every method: a type that overrides all of them answers the same through `&`, `Box` and `Arc`.

use faying::basis::{BSpline, Basis, BasisStructure, Block, Cell, Elements, Order, Polynomials, ShapeTable};
use faying::linalg::Vector;
use faying::quadrature::{Quadrature, Rule, TensorRule};
use std::sync::Arc;

/// No method keeps its default.
#[derive(Clone, Debug)]
struct Odd(BSpline);

impl Elements for Odd {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
    fn cell(&self, _element: usize) -> Cell {
        Cell::Simplex
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.corners(element, ids);
    }
}

impl Basis<1> for Odd {
    fn num_functions(&self) -> usize {
        self.0.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; 1] {
        Basis::degree(&self.0, element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut ShapeTable<1>) {
        self.0.tabulate(element, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<1> {
        self
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<1>>> {
        self.0.polynomials(wanted)
    }
}
impl BasisStructure<1> for Odd {
    fn block(&self, element: usize) -> Option<Block<'_, 1>> {
        self.0.structure().block(element)
    }
}

impl Quadrature<1> for Odd {
    fn rule(&self, _element: usize) -> &Rule<1> {
        static RULE: std::sync::OnceLock<Rule<1>> = std::sync::OnceLock::new();
        RULE.get_or_init(|| TensorRule::<1>::gauss([3]).rule(0).clone())
    }
    fn axes(&self, _element: usize) -> Option<[&dyn Quadrature<1>; 1]> {
        Some([self])
    }
}

fn same<B: Basis<1> + Quadrature<1>>(pointer: B) {
    let direct = Odd(BSpline::uniform(2, 3, 1));
    let (mut a, mut b) = (Vec::new(), Vec::new());
    assert_eq!((pointer.num_elements(), pointer.cell(0), pointer.num_functions(), pointer.degree(1)), (3, Cell::Simplex, 5, [2]));
    pointer.corners(2, &mut a);
    assert_eq!(a, [2, 3]);
    pointer.active(1, &mut a);
    direct.active(1, &mut b);
    assert_eq!(a, b);
    let (mut s, mut t) = (ShapeTable::new(), ShapeTable::new());
    pointer.tabulate(1, &[Vector::<1>::new(0.3)], Order::Hessians, &mut s);
    direct.tabulate(1, &[Vector::<1>::new(0.3)], Order::Hessians, &mut t);
    assert_eq!((s.values(0), s.grads(0), s.hessians(0)), (t.values(0), t.grads(0), t.hessians(0)));
    assert!(pointer.structure().block(0).is_some());
    assert_eq!(pointer.polynomials(Polynomials::Lowered(1)).map(|p| p.num_functions()), Some(4));
    assert_eq!(pointer.rule(0).weights.len(), 3);
    assert!(pointer.axes(0).is_some());
}

#[test]
fn pointers_forward_every_method_of_bases_and_quadratures() {
    let odd = Odd(BSpline::uniform(2, 3, 1));
    same(odd.clone());
    same(&odd);
    same(Box::new(odd.clone()));
    same(Arc::new(odd.clone()));
    same(Box::new(Arc::new(&odd)));
}
