//! Glued, closed and collapsed patches contracted one after the other, against the plain loop.

use crate::common::plain;
use crate::common::states;
use faying::assembly::{Assembler, Coefficient, Errors, Form, MatrixFree, Pattern, Tangent};
use faying::assembly::{add_stiffness, difference, fields, gauss_rules, load, mass, refill_stiffness, stiffness};
use faying::basis::Basis;
use faying::check;
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Csr, Matrix, Operator, Vector};
use faying::physics::{Hooke, form};
use faying::space::{BasisKind, Body, Dimension, FieldAt, Mesh, MultiPatch, Near, Patch, PatchSpec, Seam, Space, Trace};
use plain::{Plain, apart, largest};
use states::{states_are_those_of_each_element, stresses_are_those_of_each_element};
use std::sync::Arc;

/// Entries may differ by this share of the largest.
const SAME: f64 = 1e-13;
/// Places may differ by this share of the size.
const SAME_PLACE: f64 = 1e-12;

/// A tangent that varies and has no symmetry, or that of an energy.
fn varying<const C: usize, const N: usize>(symmetric: bool) -> Form<'static, C, N> {
    let at = move |x: &Vector<N>| -> Tangent<C, N> {
        let entry = |a: usize, b: usize| {
            let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
            f64::from(u8::from(a == b)) * 6.0 + (1.3 * a as f64 + 2.1 * b as f64).sin() + 0.3 * x[0] * (a as f64 - 0.7 * b as f64).cos()
        };
        std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i * N + j, k * N + l))))
    };
    Form::new(Coefficient::PerPoint(Box::new(at)), symmetric)
}

/// The contraction is the plain loop up to round-off, symmetric to the last bit, the same for any number of threads, when
/// refilled, and added.
fn one_form<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) -> f64 {
    let rules = gauss_rules(space, 0);
    let run =
        |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| stiffness(space, &rules, form));
    let (fast, plain) = (run(1), stiffness(&Plain(space), &rules, form));
    assert!(fast.vals() != plain.vals(), "the contraction is what is tested");
    let most = apart(&fast, &plain);
    assert!(most <= SAME, "apart by {most:e}");
    if form.symmetric {
        for i in 0..fast.num_rows() {
            let (cols, vals) = fast.row(i);
            assert!(cols.zip(vals).all(|(j, v)| v.to_bits() == fast.get(j, i).to_bits()), "symmetric to the last bit, row {i}");
        }
    }
    for threads in [2, 3, 4] {
        assert!(run(threads).vals().iter().zip(fast.vals()).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
    }
    let mut matrix = fast.clone();
    matrix.vals_mut().fill(f64::NAN);
    refill_stiffness(space, &rules, form, &mut matrix);
    assert!(matrix == fast, "refilled: the same bits");
    add_stiffness(&Pattern::new(space), space, &rules, form, &mut matrix);
    let scale = fast.vals().iter().fold(0.0f64, |m, v| m.max(v.abs()));
    assert!(matrix.vals().iter().zip(fast.vals()).all(|(a, b)| (a - 2.0 * b).abs() <= SAME * scale), "added to itself: twice");
    most.max(without_matrix(space, form, &fast))
}

/// Product and diagonal without the matrix, loads and norms; returns how far they are apart.
fn without_matrix<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, matrix: &Csr) -> f64 {
    let (rules, plain) = (gauss_rules(space, 0), Plain(space));
    let n = matrix.num_rows();
    let x: Vec<f64> = (0..n).map(|i| (1.7 * i as f64).sin()).collect();
    let (mut expected, mut found) = (vec![0.0; n], vec![f64::NAN; n]);
    matrix.apply(&x, &mut expected);
    let free = MatrixFree::new(space, &rules, form);
    free.apply(&x, &mut found);
    let size = (0..n).map(|i| matrix.row(i).1.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    let apart = |a: &[f64], b: &[f64]| largest(a.iter().zip(b).map(|(a, b)| a - b));
    let size_of = |a: &[f64]| largest(a.iter().copied());
    let mut all = vec![apart(&found, &expected) / size, apart(&free.diagonal(), &matrix.diagonal()) / size_of(&matrix.diagonal())];
    assert_eq!(free.dof_coordinates(), matrix.dof_coordinates());
    let field = |x: &Vector<N>| -> (Vector<C>, Matrix<C, N>) {
        (Vector::repeat((2.0 * x[0] + x[1]).sin()), Matrix::from_fn(|c, j| x[j] - 0.3 * c as f64))
    };
    let force = |x: &Vector<N>| field(x).0;
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let (mut all, mut y) = (load::<C, N, N, _, _, _>(space, &rules, &force), vec![f64::NAN; n]);
            let e = difference(space, &rules, form, &x, &|_, _, x| field(x));
            free.apply(&x, &mut y);
            all.extend(y.iter().chain(&free.diagonal()).chain(&[e.error.l2, e.error.h1, e.error.energy]));
            all
        })
    };
    let one = run(1);
    for threads in [2, 3, 4] {
        assert!(run(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
    }
    let (a, b) = (load::<C, N, N, _, _, _>(space, &rules, &force), load::<C, N, N, _, _, _>(&plain, &rules, &force));
    assert!(a != b, "the contraction is what is tested");
    all.push(apart(&a, &b) / size_of(&b));
    // elements of later patches have numbers of their own
    let other = |e: usize, _: &Vector<N>, x: &Vector<N>| (field(x).0 * (1.0 + 0.1 * e as f64), field(x).1);
    let (a, b) = (difference(space, &rules, form, &x, &other), difference(&plain, &rules, form, &x, &other));
    let numbers = |e: &Errors| [e.error.l2, e.error.h1, e.exact.l2, e.exact.h1, if form.symmetric { e.error.energy } else { 1.0 }];
    all.extend(numbers(&a).iter().zip(numbers(&b)).map(|(a, b)| a / b - 1.0));
    let most = largest(all);
    assert!(most <= SAME, "apart by {most:e}");
    most
}

/// All forms on one space; `apart_places`: whether functions are single products, whose places the plain loop repeats.
fn check<const N: usize>(space: &dyn Space<N, N>, single: bool, steel: &Hooke<N>) -> f64 {
    check::basis(space).unwrap_or_else(|what| panic!("{what}"));
    let most = one_form(space, &Form::<1, N>::laplace())
        .max(one_form(space, &form(steel).unwrap()))
        .max(one_form(space, &varying::<1, N>(false)))
        .max(one_form(space, &varying::<N, N>(true)));
    let rules = gauss_rules(space, 0);
    let (fast, plain) = (mass(space, &rules), mass(&Plain(space), &rules));
    assert!(fast.vals() != plain.vals(), "the contraction is what is tested");
    assert!(apart(&fast, &plain) <= SAME, "mass");
    let size = Operator::dof_coordinates(&plain).iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    if single {
        for (a, b) in Operator::dof_coordinates(&fast).iter().zip(Operator::dof_coordinates(&plain)) {
            assert!((0..3).all(|k| (a[k] - b[k]).abs() <= SAME_PLACE * size), "{a:?} {b:?}");
        }
    }
    assert_eq!(Operator::dof_coordinates(&fast).len(), space.num_functions());
    states_are_those_of_each_element::<1, N>(space, &rules);
    states_are_those_of_each_element::<N, N>(space, &rules);
    stresses_are_those_of_each_element(space, steel);
    most
}

#[test]
#[should_panic(expected = "needs an unknown per component and function")]
fn a_field_with_too_few_unknowns_is_refused() {
    let patch = body::<1, 2>(shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap(), [2, 2], [1, 1], Kind::Nurbs);
    let space = &**patch.space();
    let short = vec![1.0; 2 * space.num_functions() - 1];
    fields(space, &gauss_rules(space, 0), &short, &|_, states: &[FieldAt<2, 2>]| states.len());
}

fn plane() -> Hooke<2> {
    Hooke::<2>::plane_strain(1.0, 0.3).unwrap()
}

fn solid() -> Hooke<3> {
    Hooke::<3>::solid(1.0, 0.3).unwrap()
}

/// What a body is made of.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Splines,
    Nurbs,
    Lagrange,
}

fn body<const S: usize, const N: usize>(net: ControlNet<N, N>, degree: [usize; N], elements: [usize; N], kind: Kind) -> Arc<dyn Body<S, N>>
where
    Trace<S, N>: Dimension<S, N>,
{
    let spec = PatchSpec::new(net).with_degree(degree).with_elements(elements);
    match kind {
        Kind::Splines => Arc::new(Patch::<S, N>::try_new(&spec.with_basis(BasisKind::BSpline)).unwrap()),
        Kind::Nurbs => Arc::new(Patch::<S, N>::try_new(&spec.with_basis(BasisKind::Nurbs)).unwrap()),
        Kind::Lagrange => Arc::new(Mesh::<S, N>::from_patch(&spec).unwrap()),
    }
}

/// Bodies glued along seams (body, side, body, side).
fn glued<const S: usize, const N: usize>(bodies: Vec<Arc<dyn Body<S, N>>>, seams: &[(usize, &str, usize, &str)]) -> MultiPatch<S, N> {
    let named = bodies.into_iter().enumerate().map(|(k, b)| (format!("p{k}"), b)).collect();
    let seams: Vec<Seam> = seams.iter().map(|&(a, s, b, t)| Seam::new((a, s), (b, t))).collect();
    MultiPatch::try_new(named, &seams, Near::Exact).unwrap()
}

/// A bilinear cell.
fn quad(corners: [[f64; 2]; 4]) -> ControlNet<2, 2> {
    let mut net = shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap();
    net.points.copy_from_slice(&corners.map(Vector::from));
    net
}

#[test]
fn four_patches_around_a_cross_point_turned_and_of_other_degrees_per_direction() {
    for kind in [Kind::Splines, Kind::Lagrange] {
        // corners of a 2 x 2 grid with a crooked middle; the second is turned by 180 degrees, the third by 90
        let (a, b, c) = ([[0.0, 0.0], [1.0, 0.1], [2.1, 0.0]], [[0.1, 1.0], [1.1, 0.9], [2.0, 1.0]], [[0.0, 2.0], [0.9, 2.2], [2.0, 2.0]]);
        let bodies = vec![
            body::<1, 2>(quad([a[0], a[1], b[0], b[1]]), [2, 3], [3, 2], kind),
            body::<1, 2>(quad([b[2], b[1], a[2], a[1]]), [4, 3], [2, 2], kind),
            body::<1, 2>(quad([b[1], c[1], b[0], c[0]]), [1, 2], [4, 3], kind),
            body::<1, 2>(quad([b[1], b[2], c[1], c[2]]), [4, 1], [2, 4], kind),
        ];
        let seams = [(0, "u1", 1, "u1"), (0, "v1", 2, "u0"), (1, "v0", 3, "v0"), (2, "v0", 3, "u0")];
        let whole = glued(bodies, &seams);
        let most = check(&**whole.space(), true, &plane());
        println!("cross point, {kind:?}: apart by {most:.1e} at most");
    }
}

#[test]
fn rings_of_patches_and_rings_closed_on_themselves() {
    let arc = |from: f64, to: f64| shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [from, to]).unwrap();
    for kind in [Kind::Splines, Kind::Nurbs, Kind::Lagrange] {
        let bodies = [[0.0, 120.0], [120.0, 200.0], [200.0, 360.0]].map(|[a, b]| body::<1, 2>(arc(a, b), [2, 3], [3, 2], kind)).to_vec();
        let whole = glued(bodies, &[(0, "u1", 1, "u0"), (1, "u1", 2, "u0"), (2, "u1", 0, "u0")]);
        let most = check(&**whole.space(), true, &plane());
        println!("three arcs, {kind:?}: apart by {most:.1e} at most");
    }
}

/// Numbers that an assembler keeps are used for the functions they belong to, and for no others.
#[test]
fn an_assembler_made_for_other_seams_gives_the_same_bits() {
    let arc = |from: f64, to: f64| shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [from, to]).unwrap();
    let bodies =
        || [[0.0, 120.0], [120.0, 200.0], [200.0, 360.0]].map(|[a, b]| body::<1, 2>(arc(a, b), [2, 3], [3, 2], Kind::Nurbs)).to_vec();
    let closed = glued(bodies(), &[(0, "u1", 1, "u0"), (1, "u1", 2, "u0"), (2, "u1", 0, "u0")]);
    let open = glued(bodies(), &[(0, "u1", 1, "u0"), (1, "u1", 2, "u0")]);
    let elsewhere = glued(bodies(), &[(1, "u1", 2, "u0"), (2, "u1", 0, "u0")]);
    // as many functions with the same numbers, of another degree
    let turned = |degree: usize, n: usize| {
        [[0.0, 120.0], [120.0, 200.0], [200.0, 360.0]].map(|[a, b]| body::<1, 2>(arc(a, b), [2, degree], [3, n], Kind::Nurbs)).to_vec()
    };
    let coarse = glued(turned(2, 3), &[(0, "u1", 1, "u0"), (1, "u1", 2, "u0")]);
    assert_eq!(coarse.space().num_functions(), open.space().num_functions());
    for whole in [&closed, &open, &elsewhere, &coarse] {
        let (space, steel) = (&**whole.space(), plane());
        let form = form(&steel).unwrap();
        let rules = gauss_rules(space, 0);
        let fresh = stiffness(space, &rules, &form);
        for other in [&closed, &open, &elsewhere, &coarse] {
            let kept = Assembler::new(&**other.space(), &gauss_rules(&**other.space(), 0));
            let mut matrix = fresh.clone();
            matrix.vals_mut().fill(f64::NAN);
            kept.refill_stiffness(space, &rules, &form, &mut matrix);
            assert!(matrix == fresh);
        }
    }
}

#[test]
fn a_patch_closed_on_itself_has_pairs_of_functions_that_meet_twice() {
    let ring = || shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 360.0]).unwrap();
    for (kind, elements) in [(Kind::Nurbs, [4, 3]), (Kind::Splines, [6, 2]), (Kind::Lagrange, [5, 2])] {
        let whole = glued(vec![body::<1, 2>(ring(), [2, 2], elements, kind)], &[(0, "u0", 0, "u1")]);
        let space = &**whole.space();
        let most = one_form(space, &Form::<1, 2>::laplace())
            .max(one_form(space, &form(&plane()).unwrap()))
            .max(one_form(space, &varying::<2, 2>(false)));
        let rules = gauss_rules(space, 0);
        assert!(apart(&mass(space, &rules), &mass(&Plain(space), &rules)) <= SAME);
        println!("closed ring, {kind:?}: apart by {most:.1e} at most");
    }
}

#[test]
fn collapsed_edges_in_the_plane_and_in_space() {
    for kind in [Kind::Nurbs, Kind::Lagrange] {
        let disc = body::<1, 2>(shapes::disc_sector([0.0, 0.0], 1.0, [0.0, 90.0]).unwrap(), [2, 3], [3, 2], kind);
        assert!(
            disc.space().structure().block(0).is_none() && disc.space().structure().patches().is_some(),
            "sums of products are what is tested"
        );
        let most = check(&**disc.space(), false, &plane());
        println!("disc, {kind:?}: apart by {most:.1e} at most");
        let ball = body::<2, 3>(shapes::sphere_octant([0.0; 3], [1.0, 2.0]).unwrap(), [2, 2, 2], [2, 2, 2], kind);
        assert!(ball.space().structure().patches().is_some());
        let most = check(&**ball.space(), false, &solid());
        println!("octant, {kind:?}: apart by {most:.1e} at most");
    }
    // sectors around their common tip
    let sector = |from: f64| shapes::disc_sector([0.0, 0.0], 1.0, [from, from + 90.0]).unwrap();
    let bodies = [0.0, 90.0, 180.0].map(|from| body::<1, 2>(sector(from), [2, 2], [2, 2], Kind::Nurbs)).to_vec();
    let whole = glued(bodies, &[(0, "u1", 1, "u0"), (1, "u1", 2, "u0")]);
    check(&**whole.space(), false, &plane());
}

#[test]
fn bricks_around_an_edge() {
    let brick = |x: [f64; 2]| shapes::brick([x[0], x[1], 0.0], [x[0] + 1.0, x[1] + 1.0, 1.0]).unwrap();
    for kind in [Kind::Splines, Kind::Lagrange] {
        let bodies = vec![
            body::<2, 3>(brick([0.0, 0.0]), [2, 1, 3], [2, 2, 2], kind),
            body::<2, 3>(brick([1.0, 0.0]), [3, 1, 3], [2, 2, 2], kind),
            body::<2, 3>(brick([0.0, 1.0]), [2, 2, 3], [2, 3, 2], kind),
            body::<2, 3>(brick([1.0, 1.0]), [3, 2, 3], [2, 3, 2], kind),
        ];
        let whole = glued(bodies, &[(0, "u1", 1, "u0"), (0, "v1", 2, "v0"), (1, "v1", 3, "v0"), (2, "u1", 3, "u0")]);
        let most = check(&**whole.space(), true, &solid());
        println!("bricks, {kind:?}: apart by {most:.1e} at most");
    }
}

#[test]
fn bricks_wide_enough_for_several_strips() {
    // 60 x 38 x 4 functions of degree 2 each: more sums than one strip of the middle direction holds
    let brick = |z: f64| shapes::brick([0.0, 0.0, z], [3.0, 2.0, z + 0.2]).unwrap();
    let bodies = [0.0, 0.2].map(|z| body::<2, 3>(brick(z), [2, 2, 2], [58, 36, 2], Kind::Splines)).to_vec();
    let whole = glued(bodies, &[(0, "w1", 1, "w0")]);
    let most = one_form(&**whole.space(), &Form::<1, 3>::laplace()).max(one_form(&**whole.space(), &varying::<1, 3>(false)));
    println!("wide bricks: apart by {most:.1e} at most");
}
