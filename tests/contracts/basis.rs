//! Bases pass their checkers, and bases with an error in them do not.

use faying::basis::{
    BSpline, Basis, BasisStructure, BernsteinSimplex, Block, Cell, Elements, Extracted, LagrangeLine, LagrangeSimplex, Order, Polynomials,
    Rational, Refined, ShapeTable, TensorProduct, simplex_nodes, simplex_numbering,
};
use faying::check;
use faying::linalg::{Real, Vector, lit};

/// All rules, and a partition of unity.
#[track_caller]
fn passes<const D: usize, T: Real>(basis: &dyn Basis<D, T>) {
    check::basis(basis).unwrap();
    check::partition_of_unity(basis).unwrap();
}

/// Splines of `degree`: one element, smooth and rough uniform ones, and a graded one with every multiplicity.
fn splines<T: Real>(degree: usize) -> Vec<BSpline<T>> {
    let mut all = vec![BSpline::uniform(degree, 1, 0)];
    for continuity in [-1, 0, degree as isize - 1] {
        all.push(BSpline::uniform(degree, 5, continuity));
    }
    let n = degree + 3;
    let breakpoints: Vec<T> = (0..n).map(|k| lit((1.3 * k as f64).exp() * 0.01 - 3.0)).collect();
    let continuity: Vec<isize> = (0..n as isize - 2).map(|k| degree as isize - 1 - k).collect();
    all.push(BSpline::from_breakpoints(degree, &breakpoints, &continuity));
    all
}

fn weights<T: Real>(n: usize) -> Vec<T> {
    (0..n).map(|i| lit(1.0 + 0.2 * (1.7 * i as f64).sin())).collect()
}

#[test]
fn splines_of_any_degree_on_any_knots_keep_the_contract() {
    for degree in 0..=8 {
        for spline in splines::<f64>(degree) {
            passes(&spline);
            check::non_negative(&spline).unwrap();
        }
    }
}

#[test]
fn rational_splines_keep_the_contract_in_one_to_three_parameters() {
    for degree in 1..=5 {
        for spline in splines::<f64>(degree) {
            passes(&Rational::<_>::new(spline.clone(), weights(spline.num_functions())));
        }
    }
    let plane = TensorProduct::<2, _>::new([splines::<f64>(2).remove(4), splines(3).remove(3)]);
    passes(&plane);
    passes(&Rational::<_>::new(plane.clone(), weights(plane.num_functions())));
    let solid = TensorProduct::<3, _>::new([BSpline::<f64>::uniform(2, 2, 1), BSpline::uniform(1, 2, 0), BSpline::uniform(3, 2, 0)]);
    passes(&solid);
    passes(&Rational::<_>::new(solid.clone(), weights(solid.num_functions())));
}

#[test]
fn lagrange_cells_keep_the_contract_up_to_degree_eight() {
    for degree in 1..=8 {
        passes(&LagrangeLine::<f64>::new(degree, 3));
        passes(&TensorProduct::<2, _>::new([LagrangeLine::<f64>::new(degree, 2), LagrangeLine::new(9 - degree, 1)]));
    }
    for degree in 1..=3 {
        passes(&TensorProduct::<3, _>::new([(); 3].map(|()| LagrangeLine::<f64>::new(degree, 1))));
    }
    let long = TensorProduct::<3, _>::new([LagrangeLine::<f64>::new(8, 1), LagrangeLine::new(1, 2), LagrangeLine::new(2, 1)]);
    check::partition_of_unity(&long).unwrap();
}

/// Vertices of a square cut in two triangles and of a cube cut in six tetrahedra about a diagonal.
const TRIANGLES: [usize; 6] = [0, 1, 3, 0, 3, 2];
const TETRAHEDRA: [usize; 24] = [0, 1, 3, 7, 0, 1, 5, 7, 0, 2, 3, 7, 0, 2, 6, 7, 0, 4, 5, 7, 0, 4, 6, 7];

#[test]
fn simplices_keep_the_contract_up_to_degree_four() {
    for degree in 1..=4 {
        let triangles = LagrangeSimplex::<2>::on_corners(degree, TRIANGLES.to_vec());
        assert_eq!(triangles.num_functions(), (degree + 1) * (degree + 1));
        passes(&triangles);
        let tetrahedra = LagrangeSimplex::<3>::on_corners(degree, TETRAHEDRA.to_vec());
        assert_eq!(tetrahedra.num_functions(), (degree + 1).pow(3));
        passes(&tetrahedra);
        for continuous in [true, false] {
            passes(&BernsteinSimplex::<2>::new(degree, TRIANGLES.to_vec(), continuous));
            passes(&BernsteinSimplex::<3>::new(degree, TETRAHEDRA.to_vec(), continuous));
        }
        let (functions, ids) = simplex_numbering::<2>(degree, &TRIANGLES);
        let same = LagrangeSimplex::<2>::new(degree, functions, ids);
        assert_eq!(same.connectivity(), triangles.connectivity());
        passes(&same);
    }
    passes(&LagrangeSimplex::<2>::on_corners(6, TRIANGLES.to_vec()));
    passes(&BernsteinSimplex::<2>::new(0, TRIANGLES.to_vec(), false));
}

#[test]
fn the_trace_of_a_triangle_is_the_lagrange_basis_of_the_interval() {
    for degree in 1..=4 {
        let triangle = LagrangeSimplex::<2>::on_corners(degree, vec![0, 1, 2]);
        let line = LagrangeLine::<f64>::new(degree, 1);
        let (mut table, mut line_table) = (ShapeTable::new(), ShapeTable::new());
        for s in [0.0, 0.13, 0.5, 0.81, 1.0] {
            line.tabulate(0, &[Vector::<1>::new(s)], Order::Values, &mut line_table);
            for (from, to) in
                [([0., 0.], [1., 0.]), ([0., 0.], [0., 1.]), ([1., 0.], [0., 1.])].map(|(a, b)| (Vector::from(a), Vector::from(b)))
            {
                triangle.tabulate(0, &[from + (to - from) * s], Order::Values, &mut table);
                for (a, node) in simplex_nodes::<2, f64>(degree).iter().enumerate() {
                    let along = (node - from).dot(&(to - from)) / (to - from).norm_squared();
                    let on_edge = (node - from - (to - from) * along).norm() < 1e-12;
                    let expected = line.nodes().iter().position(|x| on_edge && (x - along).abs() < 1e-12);
                    let expected = expected.map_or(0.0, |i| line_table.values(0)[i]);
                    assert!((table.values(0)[a] - expected).abs() < 1e-14, "degree {degree}, node {a}");
                }
            }
        }
    }
}

#[test]
fn refined_and_extracted_bases_keep_the_contract() {
    let coarse = BSpline::<f64>::try_new(2, vec![0., 0., 0., 1., 1., 3., 3., 3.]).unwrap();
    let cells = vec![(0, 0.0, 0.5), (0, 0.5, 0.5), (1, 0.0, 0.3), (1, 0.3, 0.7)];
    let fine = Refined::new(coarse.clone(), cells.clone());
    passes(&fine);
    assert!(fine.structure().block(0).is_some());
    let twice = Refined::new(fine.clone(), (0..4).flat_map(|e| [(e, 0.0, 0.25), (e, 0.25, 0.75)]).collect());
    passes(&twice);
    passes(&TensorProduct::<2, _>::new([twice.clone(), twice]));
    let (mut ids, backwards) = (vec![7], Refined::new(coarse.clone(), cells.into_iter().rev().collect()));
    backwards.corners(0, &mut ids);
    assert!(ids.is_empty() && backwards.structure().block(0).is_none());
    passes(&backwards);
    // the hat functions of two elements, made of Bernstein polynomials; degree 1 stays of degree 1
    let bernstein = BSpline::<f64>::uniform(1, 2, -1);
    let hats = Extracted::<_>::new(bernstein, 3, vec![vec![(0, 1.0)], vec![(1, 1.0)], vec![(1, 1.0)], vec![(2, 1.0)]]);
    passes(&hats);
    let mixed =
        Extracted::<_>::new(coarse, 5, vec![vec![(4, 1.0)], vec![(2, -0.5), (4, 1.0)], vec![(0, 1.0)], vec![(1, 2.0)], vec![(3, 1.0)]]);
    check::basis(&mixed).unwrap();
    assert!(check::partition_of_unity(&mixed).unwrap_err().contains("not to one"));
    assert!(check::non_negative(&mixed).unwrap_err().contains("none may be negative"));
}

#[test]
fn boxed_axes_keep_the_contract() {
    let axes: [Box<dyn Basis<1>>; 2] = [Box::new(BSpline::uniform(3, 2, 1)), Box::new(LagrangeLine::new(2, 3))];
    let mixed = TensorProduct::<2, _>::new(axes);
    assert!(mixed.structure().block(0).is_some());
    passes(&mixed);
    let rational = Rational::<_>::new(BSpline::<f64>::uniform(2, 2, 1), weights(4));
    let product = TensorProduct::<2, _>::new([rational.clone(), rational]);
    assert!(product.structure().block(0).is_none()); // a product of quotients is no block
    passes(&product);
}

#[test]
fn bases_work_in_single_precision() {
    for degree in 1..=3 {
        for spline in splines::<f32>(degree) {
            check::basis(&spline).unwrap();
        }
        check::basis(&LagrangeLine::<f32>::new(degree, 2)).unwrap();
        check::basis(&LagrangeSimplex::<2, f32>::on_corners(degree, TRIANGLES.to_vec())).unwrap();
    }
    let plane = TensorProduct::<2, _, f32>::new([BSpline::uniform(2, 2, 1), BSpline::uniform(1, 2, 0)]);
    check::basis(&Rational::<_, f32>::new(plane.clone(), weights(plane.num_functions()))).unwrap();
}

/// A spline with one error.
#[derive(Debug)]
struct Broken {
    spline: BSpline,
    error: &'static str,
}

impl Elements for Broken {
    fn num_elements(&self) -> usize {
        self.spline.num_elements()
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.spline.corners(element, ids);
        if self.error == "corners" {
            ids.push(0);
        }
    }
}

impl Basis<1> for Broken {
    fn num_functions(&self) -> usize {
        self.spline.num_functions() + usize::from(self.error == "idle") - usize::from(self.error == "many")
    }
    fn degree(&self, element: usize) -> [usize; 1] {
        Basis::degree(&self.spline, element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.spline.active(element, ids);
        match self.error {
            "twice" => ids[1] = ids[0],
            "falling" => ids.reverse(),
            _ => {}
        }
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut ShapeTable<1>) {
        let inside: Vec<Vector<1>> = xi.iter().map(|x| x.map(|x| x.clamp(0.0, 1.0))).collect();
        match self.error {
            "clamped" => self.spline.tabulate(element, &inside, order, table),
            "neighbour" => {
                // evaluates in the element the point falls into: the usual mistake
                self.spline.tabulate(element, xi, order, table);
                if element + 1 < self.num_elements() {
                    let mut next = ShapeTable::new();
                    let shifted: Vec<Vector<1>> = xi.iter().map(|x| x.map(|x| x - 1.0)).collect();
                    self.spline.tabulate(element + 1, &shifted, order, &mut next);
                    for q in (0..xi.len()).filter(|&q| xi[q][0] > 1.0) {
                        for a in 0..table.num_functions() {
                            let moved = a.checked_sub(1);
                            table.values_mut(q)[a] = moved.map_or(0.0, |b| next.values(q)[b]);
                            if order >= Order::Gradients {
                                table.grads_mut(q)[a] = moved.map_or(Vector::zeros(), |b| next.grads(q)[b]);
                            }
                            if order >= Order::Hessians {
                                table.hessians_mut(q)[a] = moved.map_or(Vector::zeros(), |b| next.hessians(q)[b]);
                            }
                        }
                    }
                }
            }
            "dependent" => {
                self.spline.tabulate(element, xi, order, table);
                for q in 0..xi.len() {
                    table.values_mut(q)[1] = 2.0 * table.values(q)[0];
                    if order >= Order::Gradients {
                        table.grads_mut(q)[1] = table.grads(q)[0] * 2.0;
                    }
                    if order >= Order::Hessians {
                        table.hessians_mut(q)[1] = table.hessians(q)[0] * 2.0;
                    }
                }
            }
            _ => self.spline.tabulate(element, xi, order, table),
        }
        for q in 0..xi.len() {
            match self.error {
                "gradient" if order >= Order::Gradients => table.grads_mut(q)[2] *= 1.001,
                "hessian" if order >= Order::Hessians => table.hessians_mut(q)[1] *= 1.001,
                "order" if order == Order::Values => table.values_mut(q)[0] += 1e-9,
                _ => {}
            }
        }
    }
    fn structure(&self) -> &dyn BasisStructure<1> {
        self
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<1>>> {
        match self.error {
            "rational" => {
                let spline = self.spline.made_of(wanted)?;
                let n = spline.num_functions();
                Some(Box::new(Rational::<_>::new(spline, weights(n))))
            }
            "elements" => BSpline::uniform(3, 2, 2).polynomials(wanted),
            "degree" => self.spline.polynomials(Polynomials::Lowered(1)),
            "sign" => Some(Box::new(LagrangeLine::new(3, self.num_elements()))),
            _ => self.spline.polynomials(wanted),
        }
    }
}
impl BasisStructure<1> for Broken {
    fn block(&self, _element: usize) -> Option<Block<'_, 1>> {
        match self.error {
            "block" => Some(Block { first: 1, axes: [self], weights: None }),
            _ => Some(Block { first: 0, axes: [self], weights: None }),
        }
    }
}

#[test]
fn errors_put_in_on_purpose_are_found() {
    let broken = |error| Broken { spline: BSpline::uniform(3, 4, 2), error };
    check::basis(&broken("none")).unwrap();
    for (error, expected) in [
        ("corners", "corners"),
        ("idle", "active on no element"),
        ("many", "there are only"),
        ("twice", "listed twice"),
        ("falling", "not consecutive"),
        ("clamped", "misses the difference"),
        ("neighbour", "leaves its own continuation"),
        ("dependent", "depends on the other"),
        ("gradient", "derivative 0 of local function 2"),
        ("hessian", "second derivative (0, 0) of local function 1"),
        ("order", "values change"),
        ("block", "the block of element 0"),
        ("rational", "no polynomial"),
        ("elements", "2 elements instead of 4"),
        ("degree", "has degree [2] instead of [3]"),
        ("sign", "none may be negative"),
    ] {
        let found = check::basis(&broken(error)).expect_err(error);
        assert!(found.contains(expected), "{error}: {found}");
    }
}

#[test]
fn cells_and_corners_are_those_of_a_grid() {
    let plane = TensorProduct::<2, _>::new([BSpline::<f64>::uniform(2, 3, 1), BSpline::uniform(1, 2, 0)]);
    let mut ids = Vec::new();
    plane.corners(4, &mut ids); // element (1, 1) of 3 x 2
    assert_eq!((plane.cell(4), ids.as_slice()), (Cell::Tensor, [5, 6, 9, 10].as_slice()));
    assert_eq!(plane.split(4), [1, 1]);
}
