//! Matrices of cells in lanes against the plain loop: every cell, degree, map and form.

use crate::common::cells;
use crate::common::plain;
use crate::common::states;
use cells::{Random, Shapes, bent, boxes, shaken};
use faying::assembly::{
    Assembler, Coefficient, Form, Pattern, Tangent, add_stiffness, fields, gauss_rules, load, mass, refill_stiffness, stiffness,
};
use faying::basis::{Basis, BasisStructure, Cell, Elements, Order, ShapeTable};
use faying::check;
use faying::geometry::{Bounds, Control, Geometry, MapStructure, MapTable, shapes};
use faying::linalg::{Csr, Ldlt, LinearSolver, Matrix, Operator, Vector};
use faying::quadrature::{PerElement, Quadrature, Rule};
use faying::space::{Body, CellBlock, Dimension, FieldAt, Mapping, Mesh, MeshCells, PatchSpec, Space, Trace};
use plain::{Plain, apart};
use states::states_are_those_of_each_element;
use std::sync::Arc;

/// Entries may differ by this share of the largest.
const SAME: f64 = 1e-13;
/// Places may differ by this share of the size.
const SAME_PLACE: f64 = 1e-12;

/// Numbers between 0 and 1 that look random.
fn noise(k: usize) -> f64 {
    (12.9898 * (k as f64 + 1.0)).sin().mul_add(43758.5453, 0.0).rem_euclid(1.0)
}

/// A tangent without any symmetry, or with that of an energy; some entries are zero.
fn tangent<const C: usize, const N: usize>(x: &Vector<N>, symmetric: bool) -> Tangent<C, N> {
    let entry = |i: usize, j: usize, k: usize, l: usize| {
        let (a, b) = (i * N + j, k * N + l);
        let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
        if (a + b) % 5 == 3 {
            return 0.0;
        }
        f64::from(u8::from(a == b)) * 6.0 + noise(31 * a + b) + 0.3 * x[0] * noise(a + 17 * b)
    };
    std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i, j, k, l))))
}

/// Every kind of coefficient for C components.
fn forms<'a, const C: usize, const N: usize>() -> Vec<Form<'a, C, N>> {
    let origin = Vector::<N>::repeat(0.3);
    let mut all = vec![Form::laplace()];
    for symmetric in [true, false] {
        all.push(Form::new(Coefficient::Constant(tangent(&origin, symmetric)), symmetric));
        all.push(Form::new(Coefficient::PerPoint(Box::new(move |x: &Vector<N>| tangent(x, symmetric))), symmetric));
    }
    all
}

/// The two ways agree; asserts that they are two ways.
fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, form: &Form<'_, C, N>, what: &str) {
    let (fast, plain) = (stiffness(space, rules, form), stiffness(&Plain(space), rules, form));
    assert!(fast.vals() != plain.vals(), "{what}: cells in lanes are what is tested");
    let apart = apart(&fast, &plain);
    assert!(apart <= SAME, "{what}: apart by {apart:e}");
    if form.symmetric {
        for i in 0..fast.num_rows() {
            let (cols, vals) = fast.row(i);
            let same = cols.zip(vals).all(|(j, v)| v.to_bits() == fast.get(j, i).to_bits());
            assert!(same, "{what}: symmetric to the last bit");
        }
    }
    assert_eq!(fast.dof_coordinates().len(), fast.num_rows());
    let size = plain.dof_coordinates().iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    for (a, b) in fast.dof_coordinates().iter().zip(plain.dof_coordinates()) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() <= SAME_PLACE * size), "{what}: {a:?} {b:?}");
    }
}

fn compare_mass<const N: usize>(space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, what: &str) {
    let (fast, plain) = (mass(space, rules), mass(&Plain(space), rules));
    assert!(fast.vals() != plain.vals(), "{what}: cells in lanes are what is tested");
    assert!(apart(&fast, &plain) <= SAME, "{what}: mass");
}

fn all_forms<const N: usize>(space: &dyn Space<N, N>, what: &str) {
    let rules = gauss_rules(space, 0);
    compare_mass(space, &gauss_rules(space, 1), what);
    for form in forms::<1, N>() {
        compare(space, &rules, &form, what);
    }
    for form in forms::<N, N>() {
        compare(space, &rules, &form, what);
    }
    states_are_those_of_each_element::<1, N>(space, &rules);
    states_are_those_of_each_element::<N, N>(space, &rules);
}

fn plane(counts: [usize; 2], shapes: Shapes, order: usize, degree: usize, mapping: Mapping) -> Mesh<1, 2> {
    let map: &dyn Fn(&Vector<2>) -> Vector<2> = if order == 1 { &shaken(counts, 0.2) } else { &bent };
    Mesh::from_cells(&boxes(counts, shapes, order, Some(7), map), degree, mapping).unwrap()
}

fn solid(counts: [usize; 3], shapes: Shapes, order: usize, degree: usize, mapping: Mapping) -> Mesh<2, 3> {
    let map: &dyn Fn(&Vector<3>) -> Vector<3> = if order == 1 { &shaken(counts, 0.15) } else { &bent };
    Mesh::from_cells(&boxes(counts, shapes, order, Some(11), map), degree, mapping).unwrap()
}

#[test]
fn plane_cells_equal_the_plain_loop() {
    for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
        for degree in 1..=4 {
            for (order, mapping) in [(1, Mapping::Exact), (1, Mapping::Isoparametric), (2, Mapping::Exact), (3, Mapping::Isoparametric)] {
                let body = plane([5, 3], shapes, order, degree, mapping);
                all_forms(&**body.space(), &format!("{shapes:?}, order {order}, degree {degree}, {mapping:?}"));
            }
        }
    }
}

#[test]
fn solid_cells_equal_the_plain_loop() {
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        for degree in 1..=3 {
            for (order, mapping) in [(1, Mapping::Exact), (2, Mapping::Exact), (2, Mapping::Isoparametric)] {
                let body = solid([3, 1, 1], shapes, order, degree, mapping);
                all_forms(&**body.space(), &format!("{shapes:?}, order {order}, degree {degree}, {mapping:?}"));
            }
        }
        let body = solid([2, 1, 1], shapes, 1, 4, Mapping::Exact);
        compare::<1, 3>(&**body.space(), &gauss_rules(&**body.space(), 0), &Form::laplace(), "degree 4");
    }
}

#[test]
fn simplices_of_patches_equal_the_plain_loop() {
    let spec =
        PatchSpec::new(shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap()).with_degree([2; 2]).with_elements([3, 4]);
    let body = Mesh::<1, 2>::from_patch(&spec.with_cells(Cell::Simplex)).unwrap();
    all_forms(&**body.space(), "triangles of a patch");
}

#[test]
fn meshes_of_one_cell_and_rules_that_differ_equal_the_plain_loop() {
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        let body = plane([1, 1], shapes, 2, 2, Mapping::Exact);
        all_forms(&**body.space(), "one box");
    }
    // two rules, cell about cell
    let body = plane([5, 4], Shapes::Mixed, 1, 2, Mapping::Exact);
    let space = &**body.space();
    let rules = [0, 1].map(|extra| gauss_rules(space, extra));
    let all: Vec<Arc<dyn Quadrature<2>>> = rules.iter().flat_map(|r| r.rules().to_vec()).collect();
    let which = (0..space.num_elements()).map(|e| rules[0].which()[e] + if e % 3 == 0 { rules[0].rules().len() } else { 0 }).collect();
    let mixed = PerElement::new(all, which);
    compare::<1, 2>(space, &mixed, &Form::laplace(), "two rules");
    states_are_those_of_each_element::<2, 2>(space, &mixed);
    // a rule of its own for every cell has nothing in common: the plain loop
    #[derive(Debug)]
    struct Own(Vec<Rule<2>>);
    impl Quadrature<2> for Own {
        fn rule(&self, element: usize) -> &Rule<2> {
            &self.0[element]
        }
    }
    let body = plane([8, 5], Shapes::Tensor, 1, 1, Mapping::Exact);
    let space = &**body.space();
    let rules = gauss_rules(space, 0);
    let own = Own((0..space.num_elements()).map(|e| rules.rule(e).clone()).collect());
    let laplace = Form::<1, 2>::laplace();
    assert_eq!(stiffness(space, &own, &laplace).vals(), stiffness(&Plain(space), &own, &laplace).vals());
}

#[test]
fn refilled_and_added_matrices_are_the_fresh_one() {
    fn check<const C: usize, const N: usize>(space: &dyn Space<N, N>) {
        let rules = gauss_rules(space, 0);
        let (pattern, kept) = (Pattern::new(space), Assembler::new(space, &rules));
        for form in forms::<C, N>() {
            let fresh = stiffness(space, &rules, &form);
            let mut matrix = fresh.clone();
            for keeps in [false, true] {
                matrix.vals_mut().fill(f64::NAN);
                match keeps {
                    true => kept.refill_stiffness(space, &rules, &form, &mut matrix),
                    false => refill_stiffness(space, &rules, &form, &mut matrix),
                }
                assert!(matrix == fresh, "refilled: the same bits");
            }
            add_stiffness(&pattern, space, &rules, &form, &mut matrix);
            matrix.vals_mut().iter_mut().for_each(|v| *v *= 0.5);
            assert!(apart(&matrix, &fresh) < SAME, "added to itself: twice");
        }
    }
    check::<1, 2>(&**plane([4, 3], Shapes::Mixed, 2, 2, Mapping::Exact).space());
    check::<2, 2>(&**plane([4, 3], Shapes::Mixed, 1, 3, Mapping::Exact).space());
    check::<3, 3>(&**solid([2, 2, 1], Shapes::Tensor, 1, 1, Mapping::Exact).space());
}

#[test]
fn cells_have_the_same_bits_for_any_number_of_threads() {
    fn bits<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) {
        let rules = gauss_rules(space, 0);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (stiffness(space, &rules, form), mass(space, &rules)))
        };
        let one = run(1);
        for threads in [2, 3, 4, 7] {
            let k = run(threads);
            let same = |a: &Csr, b: &Csr| a == b && a.vals().iter().zip(b.vals()).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same(&k.0, &one.0) && same(&k.1, &one.1), "{threads} threads");
        }
    }
    let body = plane([17, 13], Shapes::Mixed, 2, 2, Mapping::Exact);
    bits::<1, 2>(&**body.space(), &Form::laplace());
    for form in forms::<2, 2>() {
        bits(&**body.space(), &form);
    }
    bits::<3, 3>(&**solid([5, 4, 3], Shapes::Simplex, 1, 2, Mapping::Exact).space(), &forms().swap_remove(1));
    bits::<1, 3>(&**solid([5, 4, 3], Shapes::Tensor, 1, 2, Mapping::Exact).space(), &Form::laplace());
    // more threads than functions
    bits::<1, 2>(&**plane([1, 1], Shapes::Simplex, 1, 1, Mapping::Exact).space(), &Form::laplace());
}

#[test]
fn collapsed_cells_give_what_is_not_finite() {
    // a triangle bent so far that its Jacobian vanishes at a point of the rule is refused by meshes; a space from outside may have it
    #[derive(Debug)]
    struct Flat<'a>(&'a dyn Space<2, 2>, Vec<Vector<2>>);
    impl Elements for Flat<'_> {
        fn num_elements(&self) -> usize {
            self.0.num_elements()
        }
        fn cell(&self, element: usize) -> Cell {
            self.0.cell(element)
        }
    }
    impl Basis<2> for Flat<'_> {
        fn num_functions(&self) -> usize {
            self.0.num_functions()
        }
        fn degree(&self, element: usize) -> [usize; 2] {
            self.0.degree(element)
        }
        fn active(&self, element: usize, ids: &mut Vec<usize>) {
            self.0.active(element, ids);
        }
        fn tabulate(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
            self.0.tabulate(element, xi, order, table);
        }
        fn structure(&self) -> &dyn BasisStructure<2> {
            self
        }
    }
    impl BasisStructure<2> for Flat<'_> {
        fn reference(&self, element: usize) -> Option<usize> {
            self.0.structure().reference(element)
        }
    }
    impl Geometry<2, 2> for Flat<'_> {
        fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 2>) {
            self.0.map(element, xi, order, table);
        }
        fn bounds(&self, element: usize) -> Bounds<2> {
            self.0.bounds(element)
        }
        fn map_structure(&self) -> &dyn MapStructure<2, 2> {
            self
        }
    }
    impl MapStructure<2, 2> for Flat<'_> {
        fn control(&self) -> Option<Control<'_, 2, 2>> {
            self.0.map_structure().control().map(|c| Control { points: &self.1, ..c })
        }
    }
    impl Space<2, 2> for Flat<'_> {}
    let body = plane([2, 2], Shapes::Simplex, 1, 1, Mapping::Exact);
    let space = &**body.space();
    let points: Vec<Vector<2>> = space.map_structure().control().unwrap().points.iter().map(|x| Vector::<2>::new(x[0], 0.0)).collect();
    let k = stiffness(&Flat(space, points.clone()), &gauss_rules(space, 0), &Form::<1, 2>::laplace());
    assert!(k.vals().iter().any(|v| !v.is_finite()));
    let flat =
        fields::<1, 2, f64, _, _, _>(&Flat(space, points), &gauss_rules(space, 0), &[], &|_, states: &[FieldAt<1, 2>]| states.to_vec());
    assert!(flat.iter().flatten().all(|s| s.gradient == Matrix::<1, 2>::zeros()), "an empty field is zero whatever the map");
}

/// `cells` with points and cells in another order, and the new number of every point.
fn shuffled<const N: usize>(cells: &MeshCells<N>, seed: u64) -> (MeshCells<N>, Vec<usize>) {
    let mut random = Random(seed);
    let mut order = |n: usize| -> Vec<usize> {
        let mut keyed: Vec<(u64, usize)> = (0..n).map(|i| (random.below(1 << 30) as u64, i)).collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|k| k.1).collect()
    };
    let points = order(cells.points.len());
    let mut new = vec![0; points.len()];
    points.iter().enumerate().for_each(|(k, &p)| new[p] = k);
    let blocks = cells
        .blocks
        .iter()
        .map(|b| {
            let each = nodes_per_cell::<N>(b);
            let nodes = order(b.nodes.len() / each).into_iter().flat_map(|c| b.nodes[c * each..(c + 1) * each].to_vec());
            CellBlock { nodes: nodes.map(|p| new[p]).collect(), ..b.clone() }
        })
        .collect();
    let mut tags = cells.tags.clone();
    for corner in tags.iter_mut().flat_map(|t| t.corners.as_flattened_mut()).filter(|c| **c != usize::MAX) {
        *corner = new[*corner];
    }
    (MeshCells { points: points.iter().map(|&p| cells.points[p]).collect(), blocks, tags }, new)
}

/// Nodes per cell of a block.
fn nodes_per_cell<const N: usize>(block: &CellBlock) -> usize {
    match block.cell {
        Cell::Simplex => (1..=N).fold(1, |c, k| c * (block.order + k) / k),
        _ => (block.order + 1).pow(N as u32),
    }
}

/// The solution of -lap u + u = f at the points of a mesh, none where no node is.
fn at_points<const S: usize, const N: usize>(body: &Mesh<S, N>, points: usize) -> Vec<Option<f64>>
where
    Trace<S, N>: Dimension<S, N>,
{
    let space = &**body.space();
    let rules = gauss_rules(space, 0);
    let mut k = stiffness(space, &rules, &Form::<1, N>::laplace());
    k.vals_mut().iter_mut().zip(mass(space, &rules).vals()).for_each(|(k, m)| *k += m);
    let f = load::<1, N, N, _, _, _>(space, &rules, &|x: &Vector<N>| Vector::<1>::new(1.0 + x[0] * x[1]));
    let mut u = vec![0.0; f.len()];
    let mut solver = Ldlt::new();
    solver.prepare(&k).unwrap();
    solver.solve(&k, &f, &mut u).unwrap();
    (0..points).map(|p| body.function_at(p).map(|i| u[i])).collect()
}

#[test]
fn meshes_in_any_order_have_one_solution_at_their_own_points() {
    fn check<const S: usize, const N: usize>(cells: &MeshCells<N>, degree: usize)
    where
        Trace<S, N>: Dimension<S, N>,
    {
        let (other, new) = shuffled(cells, 5);
        let [one, two] = [cells, &other].map(|m| Mesh::<S, N>::from_cells(m, degree, Mapping::Exact).unwrap());
        let (u, v) = (at_points(&one, new.len()), at_points(&two, new.len()));
        let size = u.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        for (p, &q) in new.iter().enumerate() {
            assert_eq!(one.vertex(p), two.vertex(q), "point {p} is where its owner says");
            match (u[p], v[q]) {
                (Some(a), Some(b)) => assert!((a - b).abs() <= 1e-11 * size, "point {p}: {a} {b}"),
                (a, b) => assert_eq!(a, b, "point {p}"),
            }
        }
        // the elements keep the order of the cells: nodes of the map are where the cells say
        let mut map = MapTable::new();
        for (mesh, cells) in [(&one, cells), (&two, &other)] {
            let each = nodes_per_cell::<N>(&cells.blocks[0]);
            for (e, nodes) in cells.blocks[0].nodes.chunks_exact(each).enumerate() {
                mesh.space().map(e, &[Vector::zeros()], Order::Values, &mut map);
                assert!((map.x[0] - cells.points[nodes[0]]).norm() < 1e-12, "cell {e}");
            }
        }
    }
    check::<1, 2>(&boxes([7, 6], Shapes::Mixed, 2, None, &bent), 2);
    check::<1, 2>(&boxes([7, 6], Shapes::Simplex, 1, None, &shaken([7, 6], 0.2)), 3);
    check::<2, 3>(&boxes([3, 3, 2], Shapes::Simplex, 1, None, &shaken([3, 3, 2], 0.1)), 2);
    check::<2, 3>(&boxes([3, 3, 2], Shapes::Tensor, 2, None, &bent), 2);
}

#[test]
fn numbers_of_neighbours_are_near_each_other_whatever_the_order_of_the_mesh() {
    // the mean distance of two functions that share a cell
    let distance = |cells: &MeshCells<2>| {
        let pattern = Pattern::new(&**Mesh::<1, 2>::from_cells(cells, 2, Mapping::Exact).unwrap().space());
        let n = pattern.num_functions();
        let sum: usize = (0..n).map(|i| pattern.row(i).iter().map(|&j| i.abs_diff(j as usize)).sum::<usize>()).sum();
        (sum as f64 / pattern.ptr()[n] as f64, n as f64)
    };
    let cells = boxes([40, 40], Shapes::Simplex, 1, None, &|x: &Vector<2>| *x);
    let ((own, n), (other, _)) = (distance(&cells), distance(&shuffled(&cells, 3).0));
    // random numbers are n / 3 apart, those of a row of cells and the next 4 * 40
    assert!(own < 0.05 * n && other < 0.05 * n, "{own} {other} of {n}");
}

#[test]
fn tables_and_maps_that_differ_from_what_is_promised_are_found() {
    /// All cells name one reference cell.
    #[derive(Debug)]
    struct Lies<X>(X, bool);
    impl<X: Elements> Elements for Lies<X> {
        fn num_elements(&self) -> usize {
            self.0.num_elements()
        }
        fn cell(&self, element: usize) -> Cell {
            self.0.cell(element)
        }
        fn corners(&self, element: usize, ids: &mut Vec<usize>) {
            self.0.corners(element, ids);
        }
    }
    impl<X: Basis<2>> Basis<2> for Lies<X> {
        fn num_functions(&self) -> usize {
            self.0.num_functions()
        }
        fn degree(&self, element: usize) -> [usize; 2] {
            self.0.degree(element)
        }
        fn active(&self, element: usize, ids: &mut Vec<usize>) {
            self.0.active(element, ids);
        }
        fn tabulate(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
            self.0.tabulate(element, xi, order, table);
        }
        fn structure(&self) -> &dyn BasisStructure<2> {
            self
        }
    }
    impl<X: Basis<2>> BasisStructure<2> for Lies<X> {
        fn reference(&self, element: usize) -> Option<usize> {
            if self.1 { Some(0) } else { self.0.structure().reference(element) }
        }
    }
    impl<X: Geometry<2, 2>> Geometry<2, 2> for Lies<X> {
        fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 2>) {
            self.0.map(element, xi, order, table);
            table.x.iter_mut().for_each(|x| x[0] += 1.0);
        }
        fn bounds(&self, element: usize) -> Bounds<2> {
            let own = self.0.bounds(element);
            Bounds { lo: own.lo + Vector::<2>::new(1.0, 0.0), hi: own.hi + Vector::<2>::new(1.0, 0.0) }
        }
        fn map_structure(&self) -> &dyn MapStructure<2, 2> {
            self
        }
    }
    impl<X: Geometry<2, 2>> MapStructure<2, 2> for Lies<X> {
        fn control(&self) -> Option<Control<'_, 2, 2>> {
            if self.1 { self.0.map_structure().control() } else { None }
        }
    }
    let body = plane([3, 3], Shapes::Mixed, 1, 1, Mapping::Exact);
    let space = body.space();
    check::basis(&Lies(space.clone(), false)).unwrap();
    assert!(check::basis(&Lies(space.clone(), true)).unwrap_err().contains("reference cell"));
    check::geometry(&Lies(space.clone(), false)).unwrap();
    assert!(check::geometry(&Lies(space.clone(), true)).unwrap_err().contains("another map"));
}
