//! The bulk loop, linear forms, projections and the reduction, on maps written down here.

use faying::assembly::{
    Coefficient, Equation, Form, Pattern, Prescribed, Reduced, ReductionError, add_stiffness, dirichlet, errors, gauss_rules, load, mass,
    measure, stiffness, trace_load, trace_springs,
};
use faying::basis::{BSpline, Basis, Cell, Elements, LagrangeLine, Order, Polynomials, ShapeTable, TensorProduct};
use faying::check;
use faying::geometry::{Bounds, Embedding, Geometry, MapTable};
use faying::linalg::{LinearError, LinearSolver, Matrix, Operator, Triplets, Vector};
use faying::physics::{
    Assumption, BodyFlux, Conductor, Elastic, Hooke, Jet, Material, MaterialError, Response, form, stress_at, von_mises,
};
use faying::space::{Field, FunctionSpace, Space, Trace};
use std::sync::Arc;

/// x = A s + b s_1 s_2 .. e_1 on a grid of equal elements, s in the unit cube; `shear` bends it.
#[derive(Clone, Debug)]
struct Bent<const N: usize> {
    elements: [usize; N],
    size: [f64; N],
    shear: f64,
}

impl<const N: usize> Elements for Bent<N> {
    fn num_elements(&self) -> usize {
        self.elements.iter().product()
    }
}

impl<const N: usize> Geometry<N, N> for Bent<N> {
    fn map(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut MapTable<N, N>) {
        table.reset(xi.len(), order);
        for (q, xi) in xi.iter().enumerate() {
            let mut rest = element;
            let s = Vector::<N>::from_fn(|k, _| {
                let e = rest % self.elements[k];
                rest /= self.elements[k];
                (e as f64 + xi[k]) / self.elements[k] as f64
            });
            let all: f64 = s.iter().product();
            table.x[q] = Vector::from_fn(|k, _| self.size[k] * s[k] + self.shear * all);
            if order >= Order::Gradients {
                table.jacobian[q] = Matrix::from_fn(|i, k| {
                    let others: f64 = (0..N).filter(|&l| l != k).map(|l| s[l]).product();
                    ((if i == k { self.size[i] } else { 0.0 }) + self.shear * others) / self.elements[k] as f64
                });
            }
        }
    }
    fn bounds(&self, element: usize) -> Bounds<N> {
        let mut map = MapTable::new();
        let corners: Vec<Vector<N>> = (0..1 << N).map(|c| Vector::from_fn(|k, _| f64::from((c >> k & 1) as u8))).collect();
        self.map(element, &corners, Order::Values, &mut map);
        Bounds::around(&map.x).unwrap()
    }
}

fn splines<const N: usize>(degree: usize, elements: [usize; N], shear: f64) -> FunctionSpace<TensorProduct<N, BSpline>, Bent<N>> {
    let axes = elements.map(|n| BSpline::uniform(degree, n, degree as isize - 1));
    let size = std::array::from_fn(|k| 1.0 + 0.5 * k as f64);
    FunctionSpace { basis: TensorProduct::new(axes), geometry: Bent { elements, size, shear } }
}

fn lagrange<const N: usize>(degree: usize, elements: [usize; N], shear: f64) -> FunctionSpace<TensorProduct<N, LagrangeLine>, Bent<N>> {
    let axes = elements.map(|n| LagrangeLine::new(degree, n));
    let size = std::array::from_fn(|k| 1.0 + 0.5 * k as f64);
    FunctionSpace { basis: TensorProduct::new(axes), geometry: Bent { elements, size, shear } }
}

/// The plain formula on dense matrices.
fn dense<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) -> Vec<Vec<f64>> {
    let n = C * space.num_functions();
    let mut out = vec![vec![0.0; n]; n];
    let rules = gauss_rules(space, 0);
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    for e in 0..space.num_elements() {
        let rule = faying::quadrature::Quadrature::rule(&rules, e);
        space.active(e, &mut ids);
        space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
        for q in 0..rule.points.len() {
            let dx = rule.weights[q] * faying::linalg::determinant(&map.jacobian[q]).abs();
            let inv = faying::linalg::inverse(&map.jacobian[q]).unwrap().transpose();
            let grads: Vec<Vector<N>> = shapes.grads(q).iter().map(|g| inv * g).collect();
            let tangent = form.coefficient.at(&map.x[q], &Matrix::zeros());
            for (a, &i) in ids.iter().enumerate() {
                for (b, &j) in ids.iter().enumerate() {
                    for c in 0..C {
                        for d in 0..C {
                            for l in 0..N {
                                for m in 0..N {
                                    out[C * i + c][C * j + d] += dx * grads[a][l] * tangent[d][m][(c, l)] * grads[b][m];
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    out
}

fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) {
    let (k, expected) = (stiffness(space, &gauss_rules(space, 0), form), dense(space, form));
    let scale = expected.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    for (i, row) in expected.iter().enumerate() {
        assert!(k.row(i).0.is_sorted_by(|a, b| a < b), "columns ascend");
        for (j, &value) in row.iter().enumerate() {
            assert!((k.get(i, j) - value).abs() <= 2e-14 * scale, "entry {i} {j}: {} expected {value}", k.get(i, j));
            if form.symmetric {
                assert_eq!(k.get(i, j).to_bits(), k.get(j, i).to_bits(), "symmetric to the last bit");
            }
        }
    }
}

#[test]
fn the_bulk_loop_equals_the_plain_formula_for_all_kinds_of_coefficients() {
    let steel = Hooke::<2>::plane_strain(2.0, 0.3).unwrap();
    let brick = Hooke::<3>::solid(2.0, 0.3).unwrap();
    let varying = Form::<2, 2>::new(
        Coefficient::PerPoint(Box::new(|x| steel.respond(x, &Matrix::zeros()).tangent.map(|r| r.map(|t| t * (1.0 + x[0]))))),
        true,
    );
    // no symmetry at all
    let skew = |x: &Vector<2>| -> [[Matrix<2, 2>; 2]; 2] {
        std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| 1.0 + (i + 2 * j + 3 * k + 7 * l) as f64 + x[1])))
    };
    for degree in [1, 3] {
        let (s, f) = (splines::<2>(degree, [3, 2], 0.2), lagrange::<2>(degree, [2, 3], 0.2));
        for space in [&s as &dyn Space<2, 2>, &f] {
            compare::<1, 2>(space, &Form::laplace());
            compare(space, &form(&steel).unwrap());
            compare(space, &varying);
            compare(space, &Form::new(Coefficient::Constant(skew(&Vector::zeros())), false));
            compare(space, &Form::new(Coefficient::PerPoint(Box::new(skew)), false));
        }
    }
    compare(&splines::<3>(2, [2, 1, 2], 0.1), &form(&brick).unwrap());
    compare::<1, 3>(&lagrange::<3>(2, [1, 2, 1], 0.1), &Form::laplace());
}

/// Hides the product structure, so that the pattern comes from the neighbours.
#[derive(Debug)]
struct Plain<X>(X);
impl<X: Elements> Elements for Plain<X> {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.0.cell(element)
    }
}
impl<const D: usize, X: Basis<D>> Basis<D> for Plain<X> {
    fn num_functions(&self) -> usize {
        self.0.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.0.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D>], order: Order, table: &mut ShapeTable<D>) {
        self.0.tabulate(element, xi, order, table);
    }
    fn polynomials(&self, _wanted: Polynomials) -> Option<Box<dyn Basis<D>>> {
        None
    }
}

#[test]
fn the_closed_pattern_of_a_block_equals_the_pattern_of_its_neighbours() {
    let repeated = BSpline::<f64>::try_new(2, vec![0.0, 0.0, 0.0, 0.2, 0.5, 0.5, 0.9, 0.9, 0.9, 1.0, 1.0, 1.0]).unwrap();
    let basis = TensorProduct::new([repeated, BSpline::uniform(2, 3, 0)]);
    assert!(basis.structure().block(0).is_some(), "the closed form is what is tested");
    let (product, plain) = (Pattern::new(&basis), Pattern::new(&Plain(&basis)));
    for i in 0..basis.num_functions() {
        assert_eq!(product.row(i), plain.row(i));
    }
    let (a, b) = (product.csr::<f64>(3), plain.csr::<f64>(3));
    assert_eq!(a.pattern(), b.pattern());
}

#[test]
fn matrices_and_errors_have_the_same_bits_for_any_number_of_threads() {
    let space = splines::<2>(3, [21, 18], 0.3);
    let rules = gauss_rules(&space, 0);
    let material = Hooke::<2>::plane_stress(1.0, 0.3).unwrap();
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let k = stiffness(&space, &rules, &form(&material).unwrap());
            let f = load(&space, &rules, &|x: &Vector<2>| Vector::<2>::new(x[0].sin(), x[1]));
            let e = errors(&space, &rules, &form(&material).unwrap(), &f, &|x: &Vector<2>| (*x, Matrix::identity()));
            (k, f, e)
        })
    };
    let (k1, f1, e1) = run(1);
    for threads in [2, 3, 7] {
        let (k, f, e) = run(threads);
        assert!(k.vals().iter().zip(k1.vals()).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!((k.pattern(), k.dof_coordinates()), (k1.pattern(), k1.dof_coordinates()));
        assert_eq!((f, e), (f1.clone(), e1));
    }
}

#[test]
fn refilling_a_pattern_gives_the_bits_of_a_fresh_matrix() {
    let space = splines::<2>(2, [5, 4], 0.1);
    let rules = gauss_rules(&space, 0);
    let pattern = Pattern::new(&space);
    let mut k = pattern.csr::<f64>(1);
    add_stiffness::<1, 2, _, _, _>(&pattern, &space, &rules, &Form::laplace(), &mut k);
    let fresh = stiffness::<1, 2, _, _, _>(&space, &rules, &Form::laplace());
    assert_eq!(k.vals(), fresh.vals());
}

#[test]
fn the_mass_matrix_sums_to_the_area_and_linear_loads_to_their_integral() {
    // x = (s + b s t, 1.5 t + b s t): area 1.5 + b / 2 + 1.5 b / 2
    let b = 0.2;
    let space = splines::<2>(2, [3, 4], b);
    let rules = gauss_rules(&space, 0);
    let area = 1.5 + 1.25 * b;
    let m = mass(&space, &rules);
    let mut ones = vec![0.0; m.num_rows()];
    m.mul(&vec![1.0; m.num_rows()], &mut ones);
    assert!((ones.iter().sum::<f64>() - area).abs() < 1e-14);
    assert!((measure(&space, &rules) - area).abs() < 1e-14);
    let f = load(&space, &rules, &|_: &Vector<2>| Vector::<2>::new(1.0, -2.0));
    assert!((f.iter().step_by(2).sum::<f64>() - area).abs() < 1e-14);
    assert!((f.iter().skip(1).step_by(2).sum::<f64>() + 2.0 * area).abs() < 1e-14);
}

/// Gaussian elimination, enough for the few unknowns here.
#[derive(Debug, Default)]
struct Dense;
impl LinearSolver for Dense {
    fn prepare(&mut self, _: &dyn Operator) -> Result<(), LinearError> {
        Ok(())
    }
    fn solve(&self, a: &dyn Operator, b: &[f64], x: &mut [f64]) -> Result<usize, LinearError> {
        let n = a.size();
        let a = a.csr().ok_or(LinearError::NoMatrix)?;
        let a = nalgebra::DMatrix::from_fn(n, n, |i, j| a.get(i, j));
        let solution = a.lu().solve(&nalgebra::DVector::from_column_slice(b)).ok_or(LinearError::Singular { residual: 1.0 })?;
        x.copy_from_slice(solution.as_slice());
        Ok(1)
    }
}

/// The sides v = 0 (first) and u = 0 (second) of a tensor space, as curves of their own.
fn two_sides(degree: usize, elements: [usize; 2]) -> [Trace<1, 2>; 2] {
    #[derive(Clone, Debug)]
    struct Line(usize, Vector<2>);
    impl Elements for Line {
        fn num_elements(&self) -> usize {
            self.0
        }
    }
    impl Geometry<1, 2> for Line {
        fn map(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut MapTable<1, 2>) {
            table.reset(xi.len(), order);
            for (q, xi) in xi.iter().enumerate() {
                table.x[q] = self.1 * ((element as f64 + xi[0]) / self.0 as f64);
                if order >= Order::Gradients {
                    table.jacobian[q] = self.1 / self.0 as f64;
                }
            }
        }
        fn bounds(&self, _: usize) -> Bounds<2> {
            Bounds { lo: Vector::zeros(), hi: self.1 }
        }
    }
    let axis = |n| BSpline::uniform(degree, n, degree as isize - 1);
    let n = axis(elements[0]).num_functions();
    let facet = |element, along: usize| Embedding {
        element,
        origin: Vector::<2>::zeros(),
        axes: Matrix::<2, 1>::from_fn(|i, _| if i == along { 1.0 } else { 0.0 }),
    };
    let bottom = FunctionSpace { basis: axis(elements[0]), geometry: Line(elements[0], Vector::<2>::new(1.0, 0.0)) };
    let left = FunctionSpace { basis: axis(elements[1]), geometry: Line(elements[1], Vector::<2>::new(0.0, 1.5)) };
    let m = left.num_functions();
    [
        Trace {
            space: Arc::new(bottom),
            dofs: (0..n).collect(),
            facets: (0..elements[0]).map(|e| facet(e, 0)).collect(),
            outward: vec![1.0; elements[0]],
        },
        Trace {
            space: Arc::new(left),
            dofs: (0..m).map(|j| j * n).collect(),
            facets: (0..elements[1]).map(|e| facet(e * elements[0], 1)).collect(),
            outward: vec![-1.0; elements[1]],
        },
    ]
}

#[test]
fn one_projection_over_two_sides_meets_data_of_the_space_and_its_corner() {
    // quadratic data on quadratic splines, u_0 on both sides, u_1 zero on the second only
    for degree in [2, 3] {
        let [bottom, left] = two_sides(degree, [4, 3]);
        let data = |x: &Vector<2>| 1.0 + 2.0 * x[0] - x[0] * x[0] + 0.5 * x[1] * x[1];
        let conditions = [
            Prescribed { trace: &bottom, component: 0, value: Some(&data) },
            Prescribed { trace: &left, component: 0, value: Some(&data) },
            Prescribed { trace: &left, component: 1, value: None },
        ];
        let found = dirichlet(&conditions, Field { first: 100, components: 2 }, 0, &mut Dense).unwrap();
        assert!(found.windows(2).all(|w| w[0].0 < w[1].0));
        let value = |unknown: usize| found.iter().find(|f| f.0 == unknown).map(|f| f.1);
        for trace in [&bottom, &left] {
            let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
            for e in 0..trace.space.num_elements() {
                trace.space.active(e, &mut ids);
                trace.space.evaluate(e, &[Vector::<1>::new(0.3), Vector::<1>::new(1.0)], Order::Values, &mut shapes, &mut map);
                for q in 0..2 {
                    let u: f64 = ids.iter().zip(shapes.values(q)).map(|(&i, n)| n * value(100 + 2 * trace.dofs[i]).unwrap()).sum();
                    assert!((u - data(&map.x[q])).abs() < 1e-13, "{u}");
                }
            }
        }
        assert!(left.dofs.iter().all(|&d| value(101 + 2 * d) == Some(0.0)));
        assert_eq!(value(101 + 2), None);
    }
}

#[test]
fn a_side_without_a_value_stays_zero_beside_data_that_is_not_in_the_space() {
    let [bottom, left] = two_sides(2, [4, 3]);
    let data = |x: &Vector<2>| (9.0 * x[0]).sin();
    let conditions =
        [Prescribed { trace: &bottom, component: 0, value: Some(&data) }, Prescribed { trace: &left, component: 0, value: None }];
    let found = dirichlet(&conditions, Field { first: 0, components: 1 }, 0, &mut Dense).unwrap();
    assert_eq!(found.len(), bottom.dofs.len() + left.dofs.len() - 1, "every function once");
    assert!(found.iter().filter(|f| left.dofs.contains(&f.0)).all(|f| f.1 == 0.0));
    // zero given as a value takes part in the projection instead
    let zero = |_: &Vector<2>| 0.0;
    let joint = [conditions[0], Prescribed { trace: &left, component: 0, value: Some(&zero) }];
    let joint = dirichlet(&joint, Field { first: 0, components: 1 }, 0, &mut Dense).unwrap();
    assert!(joint.iter().any(|f| left.dofs.contains(&f.0) && f.1 != 0.0));
}

#[test]
fn unequal_values_in_a_common_corner_are_reported_with_place_and_values() {
    let [bottom, left] = two_sides(2, [4, 3]);
    let (one, two) = (|_: &Vector<2>| 1.0, |_: &Vector<2>| 2.0);
    let field = Field { first: 0, components: 1 };
    let conditions =
        [Prescribed { trace: &bottom, component: 0, value: Some(&one) }, Prescribed { trace: &left, component: 0, value: Some(&two) }];
    let text = dirichlet(&conditions, field, 0, &mut Dense).unwrap_err().to_string();
    assert!(text.contains("[0.0, 0.0, 0.0]") && text.contains("1e0 by condition 0 and 2e0 by condition 1"), "{text}");
    let zero = [Prescribed { trace: &bottom, component: 0, value: None }, Prescribed { trace: &left, component: 0, value: Some(&two) }];
    assert!(dirichlet(&zero, field, 0, &mut Dense).is_err());
}

#[test]
fn side_loads_and_springs_act_along_the_outward_normal() {
    let [bottom, left] = two_sides(2, [4, 3]);
    let space = splines::<2>(2, [4, 3], 0.0);
    let mut f = vec![0.0; 2 * space.num_functions()];
    let pressure = faying::physics::pressure(|_: &Vector<2>| 3.0);
    trace_load(&bottom, &gauss_rules(&*bottom.space, 0), &pressure, &mut f);
    trace_load(&left, &gauss_rules(&*left.space, 0), &pressure, &mut f);
    // along minus the outward normal: bottom (length 1) pushed up, left (length 1.5) pushed right
    assert!((f.iter().step_by(2).sum::<f64>() - 4.5).abs() < 1e-14);
    assert!((f.iter().skip(1).step_by(2).sum::<f64>() - 3.0).abs() < 1e-14);
    let mut k = Pattern::new(&space).csr::<f64>(2);
    trace_springs(&left, &gauss_rules(&*left.space, 0), &|_, n: &Vector<2>| n * n.transpose() * 10.0, &mut k);
    assert!((k.vals().iter().sum::<f64>() - 15.0).abs() < 1e-13);
}

#[test]
fn the_reduced_system_solves_the_full_one_with_bound_and_prescribed_unknowns() {
    let space = splines::<2>(2, [3, 2], 0.1);
    let material = Hooke::<2>::plane_strain(1.0, 0.2).unwrap();
    let k = stiffness(&space, &gauss_rules(&space, 0), &form(&material).unwrap());
    let n = k.num_rows();
    let load: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
    // two equal bodies; rows 0..8 held, 9 follows 10 and 11, the first unknowns of the second body move as one
    let mut prescribed: Vec<(usize, f64)> = (0..8).map(|i| (i, 0.1 * i as f64)).collect();
    prescribed.extend((n + 20..n + 28).map(|i| (i, -0.2)));
    let equations = [
        Equation { terms: vec![(9, 2.0), (10, -1.0), (11, 0.5)], value: 0.3 },
        Equation { terms: vec![(n, 1.0), (n + 2, -1.0)], value: 0.0 },
        Equation { terms: vec![(n, 1.0), (n + 4, -1.0)], value: 0.0 },
        // follows from the two above
        Equation { terms: vec![(n + 4, 1.0), (n + 2, -1.0)], value: 0.0 },
        // names prescribed ones only in part
        Equation { terms: vec![(3, 1.0), (12, 1.0)], value: 1.0 },
    ];
    let reduced = Reduced::try_new(&[&k, &k], &load, &prescribed, &equations).unwrap();
    assert_eq!(reduced.num_free(), 2 * n - 16 - 4);
    assert_eq!(reduced.stiffness.dof_coordinates().len(), reduced.num_free());
    let mut v = vec![0.0; reduced.num_free()];
    Dense.solve(&reduced.stiffness, &reduced.load, &mut v).unwrap();
    let u = reduced.expand(&v);
    assert_eq!(reduced.restrict(&u), v);
    for e in &equations {
        assert!((e.terms.iter().map(|t| t.1 * u[t.0]).sum::<f64>() - e.value).abs() < 1e-14);
    }
    assert!(prescribed.iter().all(|p| u[p.0] == p.1));
    let r = reduced.residual(&[&k, &k], &load, &[], &[], &u);
    let bound = [9, n, n + 2, n + 4, 10, 11, 12];
    for i in reduced.free().iter().filter(|i| !bound.contains(i)) {
        assert!(r[*i].abs() < 1e-12, "row {i}: {}", r[*i]);
    }
    // unknowns that move as one share their residual
    assert!((r[n] + r[n + 2] + r[n + 4]).abs() < 1e-12);
    // rows: C u + g = (C P) v + (g + C u0)
    let mut c = Triplets::new(2, 2 * n);
    for (i, j) in [(0, 3), (0, 9), (1, n + 2), (1, n + 23), (1, 15)] {
        c.push(i, j, 1.0 + j as f64);
    }
    let (rows, offset) = reduced.rows(&c);
    let (mut full, mut short) = (vec![0.0; 2], vec![0.0; 2]);
    c.to_csr().mul(&u, &mut full);
    rows.to_csr().mul(&v, &mut short);
    assert!(full.iter().zip(short.iter().zip(&offset)).all(|(f, (s, g))| (f - s - g).abs() < 1e-12));
    // B lambda enters the residual with its full rows
    let with = reduced.residual(&[&k, &k], &load, &[&c], &[2.0, 0.0], &u);
    assert!((with[3] - r[3] - 8.0).abs() < 1e-12);
    let wrong = [Equation { terms: vec![(0, 1.0), (1, 1.0)], value: 5.0 }];
    let error = Reduced::try_new(&[&k, &k], &load, &prescribed, &wrong).unwrap_err();
    assert!(matches!(error, ReductionError::Contradiction { equation: 0, .. }));
    assert!(matches!(Reduced::try_new(&[&k], &load, &[], &[]).unwrap_err(), ReductionError::Shape { .. }));
    assert!(matches!(Reduced::try_new(&[&k], &load[..n], &[(n, 0.0)], &[]).unwrap_err(), ReductionError::Shape { .. }));
}

#[test]
fn norms_of_a_linear_field_are_its_integrals() {
    // u = x on a unit square scaled to 1 x 1.5: |u|² = 1/3 1.5, |grad u|² = 1.5, energy k 1.5
    let space = splines::<2>(1, [2, 2], 0.0);
    let k = Conductor::<2>::try_new(4.0).unwrap();
    let e = errors(&space, &gauss_rules(&space, 1), &form(&k).unwrap(), &[], &|x: &Vector<2>| {
        (Vector::<1>::new(x[0]), Matrix::<1, 2>::new(1.0, 0.0))
    });
    for (found, expected) in [(e.exact.l2, 0.5f64), (e.exact.h1, 1.5), (e.exact.energy, 6.0)] {
        assert!((found - expected.sqrt()).abs() < 1e-14);
    }
    assert_eq!(e.error, e.exact);
    assert!((e.hypot(e).error.h1 - 3f64.sqrt()).abs() < 1e-14);
}

#[test]
fn a_field_that_is_no_number_somewhere_has_no_error_of_zero() {
    let space = splines::<2>(1, [2, 2], 0.0);
    let k = Conductor::<2>::try_new(4.0).unwrap();
    let exact = |x: &Vector<2>| (Vector::<1>::new((x[0] - 0.5).sqrt()), Matrix::<1, 2>::zeros());
    let e = errors(&space, &gauss_rules(&space, 1), &form(&k).unwrap(), &[], &exact);
    assert!(e.error.l2.is_nan() && e.exact.l2.is_nan(), "{e:?}");
    assert_eq!([e.error.h1, e.error.energy], [0.0; 2]);
}

/// Conductivity and elastic constants that vary in the plane.
fn varying() -> (Conductor<2>, Hooke<2>, Hooke<2>) {
    let k = Conductor::varying(|x: &Vector<2>| Jet::new(2.0 + x[0] * x[1], Vector::<2>::new(x[1], x[0])));
    let law = |x: &Vector<2>| Elastic::Young {
        young: Jet::new(3.0 + x[0] + x[1] * x[1], Vector::<2>::new(1.0, 2.0 * x[1])),
        poisson: Jet::new(0.3 - 0.1 * x[1], Vector::<2>::new(0.0, -0.1)),
    };
    (k, Hooke::varying(law, Assumption::PlaneStrain), Hooke::varying(law, Assumption::PlaneStress))
}

#[test]
fn materials_keep_the_rules_of_materials() {
    let places = [Vector::<2>::new(0.1, 0.2), Vector::<2>::new(0.7, -0.3), Vector::<2>::new(-0.5, 0.4)];
    let (k, strain, stress) = varying();
    check::material(&Conductor::<2>::try_new(3.0).unwrap(), &places, 0.1).unwrap();
    check::material(&k, &places, 0.1).unwrap();
    for plane in [Hooke::<2>::plane_strain(210e3, 0.3).unwrap(), Hooke::plane_stress(210e3, 0.5).unwrap(), strain, stress] {
        check::material(&plane, &places, 1e-3).unwrap();
        check::material(&plane as &dyn Material<2, 2>, &places, 1e-3).unwrap();
    }
    let lame = Hooke::<2>::try_new(Elastic::Lame { lambda: 1.0, mu: 2.0 }, Assumption::PlaneStress).unwrap();
    check::material(&lame, &places, 1e-3).unwrap();
    check::material(&Hooke::<3>::solid(1.0, 0.3).unwrap(), &[Vector::<3>::zeros(), Vector::<3>::repeat(1.0)], 1e-3).unwrap();
    check::material(&Hooke::<2, f32>::plane_strain(1.0, 0.3).unwrap(), &[Vector::<2, f32>::zeros()], 0.1).unwrap();
}

#[test]
fn the_material_checker_finds_a_wrong_tangent_stress_at_rest_and_a_rotation() {
    #[derive(Debug)]
    struct Wrong(usize);
    impl Material<2, 2> for Wrong {
        fn respond(&self, x: &Vector<2>, grad_u: &Matrix<2, 2>) -> Response<2, 2> {
            let steel = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
            let mut r = steel.respond(x, grad_u);
            match self.0 {
                0 => r.tangent[0][1][(0, 1)] *= 1.001,
                1 => r.stress[(0, 0)] += 1e-3,
                _ => {
                    // k grad u by component: symmetric, but rotations give stress
                    r.stress = *grad_u;
                    r.tangent =
                        std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| f64::from(u8::from((i, j) == (k, l))))));
                }
            }
            r
        }
        fn modulus(&self, _: &Vector<2>) -> f64 {
            1.0
        }
        fn is_linear(&self) -> bool {
            true
        }
    }
    for (kind, words) in [(0, "not the derivative"), (1, "stress at rest"), (2, "rotation")] {
        let text = check::material(&Wrong(kind), &[Vector::<2>::zeros()], 1e-2).unwrap_err();
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn a_material_that_is_not_linear_has_no_form_and_no_flux() {
    /// A conductor whose conductivity grows with the slope, k = 1 + |grad u|²: right in all its answers.
    #[derive(Debug)]
    struct Growing;
    impl Material<1, 2> for Growing {
        fn respond(&self, _: &Vector<2>, grad_u: &Matrix<1, 2>) -> Response<1, 2> {
            let k = 1.0 + grad_u.norm_squared();
            let entry = |j: usize| Matrix::<1, 2>::from_fn(|_, l| k * f64::from(u8::from(j == l)) + 2.0 * grad_u[j] * grad_u[l]);
            Response { stress: grad_u * k, tangent: [std::array::from_fn(entry)] }
        }
        fn modulus(&self, _: &Vector<2>) -> f64 {
            1.0
        }
        fn is_homogeneous(&self) -> bool {
            true
        }
    }
    check::material(&Growing, &[Vector::<2>::new(0.3, 0.1)], 0.5).unwrap();
    let text = form(&Growing).unwrap_err().to_string();
    assert!(text.starts_with("Growing is not linear: its tangent at rest is another law"), "{text}");
    let dynamic: Arc<dyn Material<1, 2>> = Arc::new(Growing);
    assert_eq!(form(&*dynamic).unwrap_err().material, "Growing");
    let space: Arc<dyn Space<2, 2>> = Arc::new(splines::<2>(1, [2, 2], 0.0));
    let [trace, _] = two_sides(1, [2, 2]);
    assert_eq!(BodyFlux::new(space, trace, Field { first: 0, components: 1 }, dynamic).unwrap_err().material, "Growing");
}

#[test]
fn the_flux_of_a_body_is_its_stress_times_the_normal_and_bounded_by_its_energy() {
    let field = Field { first: 7, components: 2 };
    let (k, strain, _) = varying();
    let strain: Arc<dyn Material<2, 2>> = Arc::new(strain);
    let k: Arc<dyn Material<1, 2>> = Arc::new(k);
    for degree in [1, 2, 3] {
        let space: Arc<dyn Space<2, 2>> = Arc::new(splines::<2>(degree, [4, 3], 0.0));
        for trace in two_sides(degree, [4, 3]) {
            let flux = BodyFlux::new(space.clone(), trace.clone(), field, strain.clone()).unwrap();
            check::flux(&flux, &trace, &*space, field, &*strain).unwrap();
            let scalar = Field { first: 0, components: 1 };
            let flux = BodyFlux::new(space.clone(), trace.clone(), scalar, k.clone()).unwrap();
            check::flux(&flux, &trace, &*space, scalar, &*k).unwrap();
            // a flux seen through the wrong normal is found
            let mut turned = trace.clone();
            turned.outward.iter_mut().for_each(|o| *o = -*o);
            assert!(check::flux(&flux, &turned, &*space, scalar, &*k).unwrap_err().contains("the stress gives"));
        }
    }
}

#[test]
fn elastic_constants_outside_their_limits_are_refused_with_the_limits() {
    let text = |r: Result<Hooke<2>, MaterialError>| r.unwrap_err().to_string();
    assert_eq!(text(Hooke::plane_strain(1.0, 0.5)), "poisson = 0.5 makes plane strain singular; allowed are -1 < poisson < 0.5");
    assert_eq!(text(Hooke::plane_strain(0.0, 0.3)), "young = 0 is not allowed; it must be positive");
    assert_eq!(text(Hooke::plane_stress(1.0, 0.6)), "poisson = 0.6 is not allowed; allowed are -1 < poisson <= 0.5");
    assert!(text(Hooke::plane_strain(1.0, -1.0)).contains("singular"));
    assert!(text(Hooke::plane_strain(f64::NAN, 0.3)).contains("must be positive"));
    assert!(text(Hooke::plane_strain(1.0, f64::NAN)).contains("poisson = NaN"));
    let lame = |lambda, mu| Hooke::<2>::try_new(Elastic::Lame { lambda, mu }, Assumption::PlaneStrain);
    assert!(text(lame(-1.0, 1.0)).contains("lambda must be above -0.6666666666666666"));
    assert!(text(lame(1.0, -1.0)).contains("mu = -1"));
    assert!(Conductor::<2>::try_new(-2.0).unwrap_err().to_string().contains("conductivity = -2"));
    assert!(Hooke::plane_stress(1.0, 0.5).is_ok());
}

#[test]
fn plane_models_have_their_stress_out_of_the_plane() {
    // uniaxial strain eps: plane strain zz = nu (xx + yy), plane stress zz = 0; von Mises of a uniaxial stress is itself
    let space = splines::<2>(2, [2, 2], 0.1);
    let rest = vec![0.0; 2 * space.num_functions()];
    let (e, nu) = (2.0, 0.3);
    let strain = Hooke::<2>::plane_strain(e, nu).unwrap();
    let grad = Matrix::<2, 2>::new(1e-3, 2e-3, 5e-3, -4e-3);
    let s = strain.spatial_stress(&Vector::zeros(), &grad);
    assert!((s[2] - nu * (s[0] + s[1])).abs() < 1e-17);
    assert!((s[0] - (s[1] * nu + s[2] * nu) - e * 1e-3).abs() < 1e-17, "eps_xx = (xx - nu (yy + zz)) / E");
    assert!((s[3] - e / (2.0 * (1.0 + nu)) * 7e-3).abs() < 1e-17 && s[4] == 0.0 && s[5] == 0.0);
    let stress = Hooke::<2>::plane_stress(e, nu).unwrap();
    let t = stress.spatial_stress(&Vector::zeros(), &grad);
    assert!(t[2] == 0.0 && (t[0] - nu * t[1] - e * 1e-3).abs() < 1e-17);
    assert_eq!(stress_at(&space, &stress, &rest, 0, &[Vector::<2>::repeat(0.5)])[0].spatial, [0.0; 6]);
    assert_eq!(von_mises(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0);
    assert!((von_mises(&[0.0, 0.0, 0.0, 1.0, 2.0, 2.0]) - 27f64.sqrt()).abs() < 1e-15);
    assert_eq!(von_mises::<f64>(&[3.0; 6]), von_mises(&[0.0, 0.0, 0.0, 3.0, 3.0, 3.0]), "pressure does not matter");
}
