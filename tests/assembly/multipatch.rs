//! Bodies glued to one by library calls: contracts, patch tests, one patch against its pieces in any orientation.

use crate::common::bulk;
use bulk::{Jet2, Problem, worst};
use faying::basis::{Basis, Cell, Elements, Extracted, Polynomials};
use faying::check;
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Matrix, Vector};
use faying::physics::Hooke;
use faying::space::{
    Body, Dimension, Field, FunctionSpace, GlueError, Locator, Mesh, MultiPatch, MultiPatchError, Near, Patch, PatchSpec, Seam, SideError,
    Trace, field_at, glue,
};
use std::sync::Arc;

type Named<const S: usize, const N: usize> = Vec<(String, Arc<dyn Body<S, N>>)>;
type Make<const S: usize, const N: usize> = dyn Fn(ControlNet<N, N>) -> Arc<dyn Body<S, N>>;

/// A multilinear net of 2^N corners, first axis fastest.
fn net<const N: usize>(corners: &[Vector<N>]) -> ControlNet<N, N> {
    let mut net = shapes::brick([0.0; N], [1.0; N]).unwrap();
    net.points.copy_from_slice(corners);
    net
}

/// The same corners with axes in the order `order`, those in `flip` turned round.
fn turned<const N: usize>(corners: &[Vector<N>], order: [usize; N], flip: usize) -> Vec<Vector<N>> {
    let old = |c: usize| (0..N).fold(0, |old, k| old | ((c >> k ^ flip >> k) & 1) << order[k]);
    (0..1usize << N).map(|c| corners[old(c)]).collect()
}

/// All orders of N axes.
fn orders<const N: usize>() -> Vec<[usize; N]> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for k in 0..N {
        all = all.into_iter().flat_map(|o| (0..=k).map(move |at| [&o[..at], &[k], &o[at..]].concat())).collect();
    }
    all.into_iter().map(|o| o.try_into().unwrap()).collect()
}

/// The pieces of the multilinear cell `corners` cut in two along the directions in `cut`, each turned by `turn(piece)`.
fn pieces<const N: usize>(corners: &[Vector<N>], cut: usize, turn: impl Fn(usize) -> ([usize; N], usize)) -> Vec<ControlNet<N, N>> {
    let at = |xi: &Vector<N>| {
        (0..1usize << N).fold(Vector::zeros(), |x: Vector<N>, c| {
            x + corners[c] * (0..N).map(|k| if c >> k & 1 == 1 { xi[k] } else { 1.0 - xi[k] }).product::<f64>()
        })
    };
    (0..1usize << N)
        .filter(|piece| piece & !cut == 0)
        .map(|piece| {
            let own: Vec<Vector<N>> = (0..1usize << N)
                .map(|c| {
                    at(&Vector::from_fn(|k, _| {
                        let (p, c) = ((piece >> k & 1) as f64, (c >> k & 1) as f64);
                        if cut >> k & 1 == 1 { (p + c) / 2.0 } else { c }
                    }))
                })
                .collect();
            let (order, flip) = turn(piece);
            net(&turned(&own, order, flip))
        })
        .collect()
}

/// All pairs of sides that can be glued.
fn seams<const S: usize, const N: usize>(bodies: &Named<S, N>) -> Vec<Seam> {
    let sides: Vec<(usize, String)> = bodies.iter().enumerate().flat_map(|(k, b)| b.1.sides().into_iter().map(move |s| (k, s))).collect();
    let traces: Vec<_> = sides.iter().map(|(k, s)| bodies[*k].1.trace(s).unwrap()).collect();
    let mut found = Vec::new();
    for i in 0..sides.len() {
        for j in i + 1..sides.len() {
            if sides[i].0 != sides[j].0 && glue(&traces[i], &[&traces[j]], Near::Exact).is_ok() {
                found.push(Seam { slave: sides[i].clone(), master: sides[j].clone() });
            }
        }
    }
    found
}

fn glued<const S: usize, const N: usize>(nets: Vec<ControlNet<N, N>>, make: &Make<S, N>) -> MultiPatch<S, N> {
    let bodies: Named<S, N> = nets.into_iter().enumerate().map(|(k, n)| (format!("p{k}"), make(n))).collect();
    let seams = seams(&bodies);
    MultiPatch::try_new(bodies, &seams, Near::Exact).unwrap()
}

fn iga<const S: usize, const N: usize>(degree: usize, elements: usize, continuity: usize) -> Box<Make<S, N>>
where
    Trace<S, N>: Dimension<S, N>,
{
    Box::new(move |net| {
        let spec = PatchSpec::new(net).with_degree([degree; N]).with_elements([elements; N]).with_continuity(continuity);
        Arc::new(Patch::<S, N>::try_new(&spec).unwrap())
    })
}

fn fe<const S: usize, const N: usize>(degree: usize, elements: usize, cells: Cell) -> Box<Make<S, N>>
where
    Trace<S, N>: Dimension<S, N>,
{
    Box::new(move |net| {
        let spec = PatchSpec::new(net).with_degree([degree; N]).with_elements([elements; N]).with_cells(cells);
        Arc::new(Mesh::<S, N>::from_patch(&spec).unwrap())
    })
}

fn quad() -> Vec<Vector<2>> {
    [[0.0, 0.1], [2.0, -0.2], [0.3, 1.5], [1.8, 1.1]].map(Vector::from).to_vec()
}

fn hexahedron() -> Vec<Vector<3>> {
    let c = [
        [0.0, 0.0, 0.0],
        [1.2, 0.1, 0.0],
        [-0.1, 1.0, 0.1],
        [1.0, 0.9, 0.0],
        [0.1, 0.0, 1.1],
        [1.0, 0.2, 0.9],
        [0.0, 1.1, 1.0],
        [1.1, 1.0, 1.2],
    ];
    c.map(Vector::from).to_vec()
}

/// A smooth field that no polynomial space holds.
fn wave<const N: usize>(x: &Vector<N>) -> Jet2<N, N> {
    let k = Vector::<N>::from_fn(|i, _| 0.7 + 0.4 * i as f64);
    let (s, c) = k.dot(x).sin_cos();
    let a = Vector::<N>::from_fn(|i, _| 0.1 * (1.0 + i as f64));
    let hessian = std::array::from_fn(|i| -(k * k.transpose()) * (a[i] * s));
    (a * s, a * k.transpose() * c, hessian)
}

fn linear<const N: usize>(x: &Vector<N>) -> Jet2<N, N> {
    let g = Matrix::<N, N>::from_fn(|i, j| 0.1 * (i as f64 + 1.0) - 0.05 * j as f64 + 0.2 * f64::from(u8::from(i == j)));
    (g * x + Vector::repeat(0.3), g, std::array::from_fn(|_| Matrix::zeros()))
}

fn at<const S: usize, const N: usize>(body: &dyn Body<S, N>, u: &[f64], x: &Vector<N>) -> Vector<N> {
    let space = &**body.space();
    let found = Locator::new(space).locate(x).unwrap();
    field_at::<N, N, _, _>(space, &Field { first: 0, components: N }, u, found.element, &[found.xi])[0].value
}

/// Places inside the multilinear cell.
fn places<const N: usize>(corners: &[Vector<N>]) -> Vec<Vector<N>> {
    let xis = [0.11, 0.37, 0.5, 0.83];
    (0..4usize)
        .map(|q| {
            (0..1usize << N).fold(Vector::zeros(), |x: Vector<N>, c| {
                x + corners[c]
                    * (0..N)
                        .map(|k| {
                            let t = xis[(q + k) % 4];
                            if c >> k & 1 == 1 { t } else { 1.0 - t }
                        })
                        .product::<f64>()
            })
        })
        .collect()
}

#[test]
fn four_quarters_are_one_patch_in_every_orientation() {
    let steel = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    let all = orders::<2>();
    for degree in 1..=3 {
        let makers: [(Box<Make<1, 2>>, Box<Make<1, 2>>); 2] =
            [(iga(degree, 4, 0), iga(degree, 2, 0)), (fe(degree, 4, Cell::Tensor), fe(degree, 2, Cell::Tensor))];
        for (whole, part) in makers {
            let one = whole(net(&quad()));
            let solved = Problem::new(&steel, &wave::<2>).held_on(&*one, &["u0", "v1"]).solve(&*one);
            for step in [0, 1, 3, 5] {
                let body = glued(pieces(&quad(), 3, |p| (all[(p * step) % 2], (p * step) % 4)), &*part);
                assert_eq!(body.space().num_functions(), one.space().num_functions());
                check::closed_body(&body).unwrap();
                // all sides have the exact value or traction: hold those on the same part of the boundary
                let on = |side: &String| {
                    let trace = body.trace(side).unwrap();
                    let mut map = faying::geometry::MapTable::new();
                    trace.space.map(0, &[Vector::<1>::new(0.5)], faying::basis::Order::Values, &mut map);
                    ["u0", "v1"]
                        .iter()
                        .any(|s| faying::geometry::closest_point(&*one.trace(s).unwrap().space, &map.x[0]).unwrap().distance < 1e-9)
                };
                let held: Vec<String> = body.sides().into_iter().filter(on).collect();
                let held: Vec<&str> = held.iter().map(String::as_str).collect();
                let pieces = Problem::new(&steel, &wave::<2>).held_on(&body, &held).solve(&body);
                assert!(
                    (solved.errors.error.l2 - pieces.errors.error.l2).abs() <= 1e-12,
                    "{:e} {:e}",
                    solved.errors.error.l2,
                    pieces.errors.error.l2
                );
                for x in places(&quad()) {
                    let d = (at(&*one, &solved.u, &x) - at(&body, &pieces.u, &x)).norm();
                    assert!(d <= 1e-12, "degree {degree}, step {step}: {d:e}");
                }
            }
        }
    }
}

#[test]
fn two_and_eight_boxes_are_one_box_in_random_orientations() {
    let steel = Hooke::<3>::solid(1.0, 0.3).unwrap();
    let all = orders::<3>();
    let corners = hexahedron();
    let makers: [(Box<Make<2, 3>>, Box<Make<2, 3>>); 2] = [(iga(2, 2, 0), iga(2, 1, 0)), (fe(2, 2, Cell::Tensor), fe(2, 1, Cell::Tensor))];
    for (whole, part) in makers {
        let one = whole(net(&corners));
        let sides = one.sides();
        let names: Vec<&str> = sides.iter().map(String::as_str).collect();
        let solved = Problem::new(&steel, &wave::<3>).held_on(&*one, &names).solve(&*one);
        for seed in [1usize, 2] {
            let body = glued(pieces(&corners, 7, |p| (all[(5 * p + seed * 7) % 6], (3 * p * seed + seed) % 8)), &*part);
            assert_eq!(body.space().num_functions(), one.space().num_functions(), "seed {seed}");
            assert_eq!(body.sides().len(), 24);
            if seed == 1 {
                check::closed_body(&body).unwrap();
            }
            let sides = body.sides();
            let names: Vec<&str> = sides.iter().map(String::as_str).collect();
            let pieces = Problem::new(&steel, &wave::<3>).held_on(&body, &names).solve(&body);
            for x in places(&corners) {
                let d = (at(&*one, &solved.u, &x) - at(&body, &pieces.u, &x)).norm();
                assert!(d <= 1e-10, "seed {seed}: {d:e}");
            }
        }
    }
    // the second of two boxes in all 48 positions: every one of the eight orientations of the common face
    let make = iga::<2, 3>(2, 2, 1);
    let cut = |turn: ([usize; 3], usize)| pieces(&corners, 1, move |p| if p == 0 { ([0, 1, 2], 0) } else { turn });
    for order in &all {
        for flip in 0..8 {
            let body = glued(cut((*order, flip)), &*make);
            // 4 functions per direction, one face shared
            assert_eq!(body.space().num_functions(), 2 * 64 - 16, "{order:?} {flip}");
        }
    }
}

#[test]
fn a_linear_field_passes_through_seams_of_every_backend() {
    let steel = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    let turn = |p: usize| ([[0, 1], [1, 0]][p % 2], p);
    let bodies: Vec<MultiPatch<1, 2>> = (1..=3)
        .flat_map(|p| [iga(p, 3, p - 1), iga(p, 3, 0), fe(p, 3, Cell::Tensor)])
        .map(|make| glued(pieces(&quad(), 3, turn), &*make))
        .chain([1, 2, 3].map(|p| glued(pieces(&quad(), 3, |_| ([0, 1], 0)), &*fe(p, 3, Cell::Simplex))))
        .collect();
    for body in &bodies {
        let solved = Problem::new(&steel, &linear::<2>).held_on(body, &["p0.u0", "p0.v0"]).solve(body);
        let (value, stress) = worst(body, &steel, &solved.u, &linear::<2>);
        assert!(value <= 1e-11 && stress <= 1e-10, "{value:e} {stress:e}");
    }
}

#[test]
fn splines_of_degree_one_are_glued_to_triangles() {
    let steel = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    let halves = |degree: usize| -> Result<MultiPatch<1, 2>, MultiPatchError> {
        let mut nets = pieces(&quad(), 1, |p| if p == 1 { ([1, 0], 1) } else { ([0, 1], 0) }).into_iter();
        let bodies: Named<1, 2> = vec![
            ("splines".into(), iga(degree, 3, 0)(nets.next().unwrap())),
            ("triangles".into(), fe(degree, 3, Cell::Simplex)(nets.next().unwrap())),
        ];
        let seam = ["u0", "u1", "v0", "v1"]
            .iter()
            .find_map(|s| glue(&bodies[0].1.trace("u1").unwrap(), &[&bodies[1].1.trace(s).unwrap()], Near::Exact).ok().map(|_| *s));
        MultiPatch::try_new(bodies, &[Seam::new((0, "u1"), (1, seam.unwrap()))], Near::Exact)
    };
    let body = halves(1).unwrap();
    check::closed_body(&body).unwrap();
    let solved = Problem::new(&steel, &linear::<2>).held_on(&body, &["splines.u0"]).solve(&body);
    assert!(worst(&body, &steel, &solved.u, &linear::<2>).0 <= 1e-11);
    // Bernstein and Lagrange functions span the same, function by function they differ
    assert_eq!(halves(2).unwrap_err(), MultiPatchError::Combined { seam: 0 });
}

#[test]
fn a_ring_is_glued_to_itself_and_keeps_its_sides() {
    let ring = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 360.0]).unwrap();
    for elements in [4, 5] {
        let spec = PatchSpec::new(ring.clone()).with_elements([elements, 2]);
        for body in
            [Arc::new(Patch::<1, 2>::try_new(&spec).unwrap()) as Arc<dyn Body<1, 2>>, Arc::new(Mesh::<1, 2>::from_patch(&spec).unwrap())]
        {
            let (all, seam) = (body.space().num_functions(), body.trace("u0").unwrap().dofs.len());
            let body = MultiPatch::try_new(vec![("r".into(), body)], &[Seam::new((0, "u0"), (0, "u1"))], Near::Exact).unwrap();
            assert_eq!(body.sides(), ["r.v0", "r.v1"]);
            assert_eq!(body.space().num_functions(), all - seam);
            check::closed_body(&body).unwrap();
            assert!(matches!(body.trace("r.u0"), Err(SideError::Interior { .. })));
            assert!(matches!(body.trace("s.u0"), Err(SideError::Unknown { .. })));
        }
    }
}

#[test]
fn the_trace_of_a_list_of_sides_is_one_curve_with_multipliers_of_each_side() {
    let body = glued(pieces(&quad(), 3, |_| ([0, 1], 0)), &*iga(2, 3, 1));
    let trace = body.trace_of(&["p0.v0", "p1.v0"]).unwrap();
    // 5 functions each, one shared
    assert_eq!((trace.space.num_elements(), trace.space.num_functions(), trace.dofs.len()), (6, 9, 9));
    check::space(&*trace.space).unwrap();
    let length = faying::space::measure::<1, 2, f64, _>(&*trace.space);
    assert!((length - (quad()[1] - quad()[0]).norm()).abs() <= 1e-13);
    // p/p-2: one constant per element, discontinuous anyway; p/p-1 is C^0 within each side only
    assert_eq!(trace.space.polynomials(Polynomials::Lowered(2)).unwrap().num_functions(), 6);
    let linear = trace.space.polynomials(Polynomials::Lowered(1)).unwrap();
    assert_eq!(linear.num_functions(), 8);
    check::basis(&*linear).unwrap();
    assert!(matches!(body.trace_of(&["p0.v0", "p0.u1"]), Err(SideError::Interior { .. })));
}

#[test]
fn functions_of_any_sign_and_order_find_their_partners() {
    let make = iga::<1, 2>(3, 4, 2);
    let (left, right) =
        (make(net(&pieces(&quad(), 1, |_| ([0, 1], 0))[0].points)), make(net(&pieces(&quad(), 1, |_| ([0, 1], 2))[1].points)));
    let (a, b) = (left.trace("u1").unwrap(), right.trace("u0").unwrap());
    let plain = glue(&a, &[&b], Near::Exact).unwrap();
    let n = a.space.num_functions();
    let sign = |i: usize| if i % 3 == 1 { -1.0 } else { 1.0 + i as f64 };
    let place = |i: usize| (i * 2 + 3) % n;
    let basis = Extracted::new::<1>(a.space.clone(), n, (0..n).map(|i| vec![(place(i), sign(i))]).collect());
    let mut strange = a.with_space(Arc::new(FunctionSpace { basis, geometry: a.space.clone() }));
    for i in 0..n {
        strange.dofs[place(i)] = 100 + i;
    }
    let rows = glue(&strange, &[&b], Near::Exact).unwrap();
    assert_eq!((plain.len(), rows.len()), (n, n));
    for row in rows {
        let i = row.function - 100;
        let expected = plain.iter().find(|r| r.function == a.dofs[i]).unwrap();
        // sign N has the coefficient 1/sign of that of N
        assert_eq!(row.terms.len(), 1);
        assert_eq!(row.terms[0].0, expected.terms[0].0);
        assert!((row.terms[0].1 - 1.0 / sign(i)).abs() <= 1e-12);
    }
}

#[test]
fn sides_that_do_not_fit_are_refused_with_the_reason() {
    let at = |x: f64, degree: usize, elements: usize, continuity: usize| {
        let corners = [[x, 0.0], [x + 1.0, 0.0], [x, 1.0], [x + 1.0, 1.0]].map(Vector::from);
        iga::<1, 2>(degree, elements, continuity)(net(&corners)).trace("u0").unwrap()
    };
    let slave = at(0.0, 2, 4, 1);
    let failed = |master| glue(&slave, &[&master], Near::Exact).unwrap_err();
    assert!(matches!(failed(at(0.25, 2, 4, 1)), GlueError::Apart { distance, .. } if (distance - 0.25).abs() < 1e-12));
    assert!(matches!(failed(at(0.0, 2, 5, 1)), GlueError::Grids { element: 0, .. }));
    assert!(matches!(failed(at(0.0, 3, 4, 2)), GlueError::Functions { difference, .. } if difference.contains("degree 2 against 3")));
    assert!(matches!(failed(at(0.0, 2, 4, 0)), GlueError::Functions { difference, .. } if difference.contains("continuity")));
    assert!(glue(&slave, &[&at(0.25, 2, 4, 1)], Near::Given(0.3)).is_ok());
}
