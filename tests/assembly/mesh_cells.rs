//! Bodies of meshes as files hold them: triangles, quadrilaterals, tetrahedra, hexahedra, curved and turned at will.

use crate::common::bulk;
use crate::common::cells;
use bulk::{Jet2, Problem, worst};
use cells::{Random, Shapes, bent, boxes, shaken};
use faying::basis::{Cell, Order, Polynomials, ShapeTable};
use faying::check;
use faying::geometry::{MapTable, cell};
use faying::linalg::{Matrix, Vector};
use faying::physics::{Conductor, Hooke, Material};
use faying::space::{Body, Dimension, Mapping, Mesh, MeshCells, MeshError, PatchSpec, SideError, Trace, measure};
use std::collections::HashMap;

fn plane(shapes: Shapes, order: usize, degree: usize, mapping: Mapping) -> Mesh<1, 2> {
    let map: &dyn Fn(&Vector<2>) -> Vector<2> = if order == 1 { &shaken([3, 2], 0.2) } else { &bent };
    Mesh::from_cells(&boxes([3, 2], shapes, order, Some(7), map), degree, mapping).unwrap()
}

fn solid(shapes: Shapes, order: usize, degree: usize, mapping: Mapping) -> Mesh<2, 3> {
    let map: &dyn Fn(&Vector<3>) -> Vector<3> = if order == 1 { &shaken([2, 2, 2], 0.15) } else { &bent };
    Mesh::from_cells(&boxes([2, 2, 2], shapes, order, Some(11), map), degree, mapping).unwrap()
}

#[test]
fn plane_meshes_keep_the_contract_of_bodies() {
    for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
        for (order, degree) in [(1, 1), (1, 4), (2, 2), (3, 3), (4, 4), (2, 3), (3, 1), (4, 2)] {
            for mapping in [Mapping::Isoparametric, Mapping::Exact] {
                let body = plane(shapes, order, degree, mapping);
                let name = format!("{shapes:?}, order {order}, degree {degree}, {mapping:?}");
                check::closed_body(&body).unwrap_or_else(|e| panic!("{name}: {e}"));
                check::basis(&**body.space()).unwrap_or_else(|e| panic!("{name}: {e}"));
                for side in body.sides() {
                    let trace = body.trace(&side).unwrap();
                    check::basis(&*trace.space).unwrap_or_else(|e| panic!("{name}, {side}: {e}"));
                }
            }
        }
    }
    check::closed_body(&plane(Shapes::Tensor, 2, 8, Mapping::Isoparametric)).unwrap();
}

#[test]
fn meshes_in_space_keep_the_contract_of_bodies() {
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        for (order, degree) in [(1, 1), (1, 4), (2, 2), (3, 3), (4, 4), (2, 1)] {
            for mapping in [Mapping::Isoparametric, Mapping::Exact] {
                if mapping == Mapping::Exact && order == degree {
                    continue;
                }
                let body = solid(shapes, order, degree, mapping);
                let name = format!("{shapes:?}, order {order}, degree {degree}, {mapping:?}");
                check::closed_body(&body).unwrap_or_else(|e| panic!("{name}: {e}"));
                if degree <= 3 {
                    check::basis(&**body.space()).unwrap_or_else(|e| panic!("{name}: {e}"));
                    check::basis(&*body.trace("x0").unwrap().space).unwrap_or_else(|e| panic!("{name}: {e}"));
                }
            }
        }
    }
    check::closed_body(&solid(Shapes::Tensor, 1, 5, Mapping::Isoparametric)).unwrap();
}

/// The largest jump of a field with random coefficients, and of the map, over all facets inside; and their number.
fn jumps<const S: usize, const N: usize>(body: &Mesh<S, N>) -> (f64, f64, usize)
where
    Trace<S, N>: Dimension<S, N>,
{
    let space = &**body.space();
    let mut random = Random(3);
    let u: Vec<f64> = (0..space.num_functions()).map(|_| random.next()).collect();
    let mut known: HashMap<Vec<usize>, (usize, HashMap<usize, Vector<N>>)> = HashMap::new();
    let (mut jump, mut gap, mut count) = (0.0f64, 0.0f64, 0);
    let (mut ids, mut shapes, mut map, mut active) = (Vec::new(), ShapeTable::new(), MapTable::new(), Vec::new());
    let mut at = |e: usize, xi: Vector<N>| {
        space.active(e, &mut active);
        space.evaluate(e, &[xi], Order::Values, &mut shapes, &mut map);
        (active.iter().zip(shapes.values(0)).map(|(&i, n)| u[i] * n).sum::<f64>(), map.x[0])
    };
    for e in 0..space.num_elements() {
        let kind = space.cell(e);
        space.corners(e, &mut ids);
        let places = cell::corners::<N, f64>(kind);
        for face in cell::faces::<N, f64>(kind) {
            let here: HashMap<usize, Vector<N>> = face.corners.iter().map(|&c| (ids[c], places[c])).collect();
            let mut key: Vec<usize> = here.keys().copied().collect();
            key.sort_unstable();
            let Some((other, there)) = known.insert(key.clone(), (e, here.clone())) else { continue };
            count += 1;
            // affine in three corners that are no diagonal; four corners are a bilinear square, affine in its reference
            let next = |c: usize| key.iter().copied().filter(move |&d| d != c);
            let (first, a, b) = if key.len() == 4 {
                let beside = |c: usize| next(key[0]).filter(|d| (here[&key[0]] - here[d]).norm() < 1.1).nth(c).unwrap();
                (key[0], beside(0), beside(1))
            } else {
                (key[0], key[1], key[key.len() - 1])
            };
            for (s, t) in [(0.17, 0.31), (0.4, 0.05), (0.61, 0.22)] {
                let lift = |c: &HashMap<usize, Vector<N>>| {
                    c[&first] + (c[&a] - c[&first]) * s + (c[&b] - c[&first]) * if a == b { 0.0 } else { t }
                };
                let ((v, x), (w, y)) = (at(e, lift(&here)), at(other, lift(&there)));
                jump = jump.max((v - w).abs());
                gap = gap.max((x - y).norm());
            }
        }
    }
    (jump, gap, count)
}

#[test]
fn fields_are_continuous_however_the_cells_list_their_corners() {
    for seed in 0..6 {
        for degree in 1..=4 {
            for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
                for order in [1, 3] {
                    let cells = boxes([3, 3], shapes, order, Some(seed), &bent);
                    let (jump, gap, facets) = jumps(&Mesh::<1, 2>::from_cells(&cells, degree, Mapping::Isoparametric).unwrap());
                    assert!(jump < 1e-13 && gap < 1e-13 && facets >= 12, "{shapes:?}, {degree}: {jump:e} {gap:e}");
                    if shapes == Shapes::Mixed {
                        continue;
                    }
                    let cells = boxes([2, 2, 2], shapes, order, Some(seed), &bent);
                    let (jump, gap, facets) = jumps(&Mesh::<2, 3>::from_cells(&cells, degree, Mapping::Exact).unwrap());
                    assert!(jump < 1e-13 && gap < 1e-13 && facets >= 12, "{shapes:?}, {degree} in space: {jump:e} {gap:e}");
                }
            }
        }
    }
    let cells = boxes([2, 2, 2], Shapes::Tensor, 2, Some(5), &bent);
    let (jump, gap, _) = jumps(&Mesh::<2, 3>::from_cells(&cells, 6, Mapping::Isoparametric).unwrap());
    assert!(jump < 1e-13 && gap < 1e-13, "{jump:e} {gap:e}");
}

/// (a . x + 1/2)^p in every component, with another a for each.
fn power<const C: usize, const N: usize>(p: i32) -> impl Fn(&Vector<N>) -> Jet2<C, N> + Sync {
    move |x| {
        let a = |c: usize| Vector::<N>::from_fn(|k, _| 0.5 - 0.3 * ((c + 2 * k) as f64));
        let s = |c: usize| a(c).dot(x) + 0.5;
        let p_ = f64::from(p);
        let second = |c: usize| if p < 2 { 0.0 } else { p_ * (p_ - 1.0) * s(c).powi(p - 2) };
        (
            Vector::from_fn(|c, _| s(c).powi(p)),
            Matrix::from_fn(|c, k| p_ * s(c).powi(p - 1) * a(c)[k]),
            std::array::from_fn(|c| a(c) * a(c).transpose() * second(c)),
        )
    }
}

/// Largest error of a field that the body holds, with exact values on three sides and tractions on the others.
fn error_of<const C: usize, const S: usize, const N: usize>(body: &Mesh<S, N>, material: &dyn Material<C, N>, p: i32, extra: usize) -> f64
where
    Trace<S, N>: Dimension<S, N>,
{
    let exact = power::<C, N>(p);
    let mut problem = Problem::new(material, &exact).held_on(body, &["x0", "y1", "z0"]);
    problem.extra = extra;
    let solved = problem.solve(body);
    worst::<C, S, N>(body, material, &solved.u, &exact).0
}

#[test]
fn linear_fields_pass_the_patch_test_on_straight_meshes_in_space() {
    let (conductor, steel) = (Conductor::<3>::try_new(2.0).unwrap(), Hooke::<3>::solid(1.0, 0.3).unwrap());
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        for degree in 1..=3 {
            let body = solid(shapes, 1, degree, Mapping::Isoparametric);
            let errors = [error_of::<1, 2, 3>(&body, &conductor, 1, 0), error_of::<3, 2, 3>(&body, &steel, 1, 0)];
            println!("patch test, {shapes:?}, degree {degree}: {:.1e} {:.1e}", errors[0], errors[1]);
            assert!(errors.iter().all(|e| *e < 1e-11), "{shapes:?}, {degree}: {errors:?}");
        }
    }
}

#[test]
fn linear_fields_pass_the_patch_test_on_curved_meshes() {
    let (conductor, steel) = (Conductor::<3>::try_new(2.0).unwrap(), Hooke::<3>::solid(1.0, 0.3).unwrap());
    for (shapes, degree, extra) in [(Shapes::Tensor, 3, 1), (Shapes::Tensor, 2, 1), (Shapes::Simplex, 2, 1), (Shapes::Simplex, 3, 1)] {
        let body = solid(shapes, degree, degree, Mapping::Isoparametric);
        let errors = [error_of::<1, 2, 3>(&body, &conductor, 1, extra), error_of::<3, 2, 3>(&body, &steel, 1, extra)];
        println!("curved patch test, {shapes:?}, degree {degree}: {:.1e} {:.1e}", errors[0], errors[1]);
        assert!(errors.iter().all(|e| *e < 1e-11), "{shapes:?}, {degree}: {errors:?}");
    }
}

#[test]
fn straight_cells_reproduce_polynomials_of_their_degree() {
    let conductor = Conductor::<3>::try_new(1.0).unwrap();
    let plane_conductor = Conductor::<2>::try_new(1.0).unwrap();
    for degree in 1..=4 {
        let p = degree as i32;
        // any triangle is affine; quadrilaterals only where boxes are sheared
        for (shapes, by) in [(Shapes::Tensor, 0.0), (Shapes::Simplex, 0.2), (Shapes::Mixed, 0.0)] {
            let body = Mesh::<1, 2>::from_cells(&boxes([3, 2], shapes, 1, Some(9), &shaken([3, 2], by)), degree, Mapping::Exact).unwrap();
            let error = error_of::<1, 1, 2>(&body, &plane_conductor, p, 0);
            assert!(error < 1e-11, "{shapes:?}, {degree}: {error:e}");
            if shapes != Shapes::Mixed {
                let cells = boxes([2, 1, 2], shapes, 1, Some(9), &shaken([2, 1, 2], by));
                let error = error_of::<1, 2, 3>(&Mesh::from_cells(&cells, degree, Mapping::Exact).unwrap(), &conductor, p, 0);
                assert!(error < 1e-11, "{shapes:?}, {degree} in space: {error:e}");
            }
        }
    }
}

/// The unit ball's octant would need collapsed cells; a box bent to a quarter of a ring has the measure (r1² - r0²) pi / 4.
fn ring<const N: usize>(u: &Vector<N>) -> Vector<N> {
    let (r, a) = (1.0 + u[0], std::f64::consts::FRAC_PI_2 * u[1]);
    Vector::from_fn(|k, _| [r * a.cos(), r * a.sin(), u[N - 1]][k])
}

#[test]
fn volumes_and_sides_of_curved_meshes_converge_to_those_of_the_shape() {
    let exact = 0.75 * std::f64::consts::PI;
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        for order in 1..=4 {
            let of = |n: usize| {
                let body = Mesh::<2, 3>::from_cells(&boxes([2, n, 1], shapes, order, Some(1), &ring), order, Mapping::Exact).unwrap();
                let outer = measure(&*body.trace("x1").unwrap().space);
                ((measure(&**body.space()) - exact).abs(), (outer - std::f64::consts::PI).abs())
            };
            let (coarse, fine) = (of(3), of(6));
            let rate = (coarse.0 / fine.0).log2();
            println!("ring, {shapes:?}, order {order}: volume off by {:.1e}, rate {rate:.1}, outer side by {:.1e}", fine.0, fine.1);
            assert!(rate > order as f64 + 0.9 && fine.1 < coarse.1, "{shapes:?}, {order}: {rate}");
        }
    }
}

#[test]
fn what_no_tag_holds_is_the_side_untagged() {
    let mut cells = boxes([3, 2], Shapes::Mixed, 1, None, &|u: &Vector<2>| *u);
    cells.tags.retain(|t| t.name == "x0");
    let body = Mesh::<1, 2>::from_cells(&cells, 2, Mapping::Isoparametric).unwrap();
    assert_eq!((body.sides(), body.untagged()), (vec!["x0".into(), "untagged".into()], Some("untagged")));
    assert!((measure(&*body.trace("untagged").unwrap().space) - 3.0).abs() < 1e-14);
    cells.tags[0].name = "untagged".into();
    let body = Mesh::<1, 2>::from_cells(&cells, 2, Mapping::Isoparametric).unwrap();
    assert_eq!(body.sides(), ["untagged", "untagged_"]);
    assert!((measure(&*body.trace("untagged").unwrap().space) - 1.0).abs() < 1e-14);
    check::closed_body(&body).unwrap();
}

#[test]
fn a_tag_inside_the_mesh_is_no_side() {
    let mut cells = boxes([2, 1], Shapes::Tensor, 1, None, &|u: &Vector<2>| *u);
    let at = |x: f64, y: f64| cells.points.iter().position(|p| (p - Vector::<2>::new(x, y)).norm() < 1e-12).unwrap();
    let middle = [at(0.5, 1.0), at(0.5, 0.0), usize::MAX, usize::MAX];
    cells.tags.push(faying::space::FacetTag { name: "middle".into(), corners: vec![middle] });
    let body = Mesh::<1, 2>::from_cells(&cells, 1, Mapping::Isoparametric).unwrap();
    assert!(!body.sides().contains(&"middle".to_string()));
    assert_eq!(body.trace("middle").unwrap_err(), SideError::Interior { facet: 0 });
    check::closed_body(&body).unwrap();
}

#[test]
fn sides_of_plane_meshes_run_around_the_body_and_answer_multipliers() {
    for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
        let body = plane(shapes, 3, 3, Mapping::Isoparametric);
        for side in body.sides() {
            let trace = body.trace(&side).unwrap();
            let n = trace.space.num_elements();
            assert!(trace.outward.iter().all(|s| *s == 1.0), "the body is on the left");
            for lowered in 0..=3 {
                let psi = trace.space.polynomials(Polynomials::Lowered(lowered)).unwrap();
                assert_eq!(psi.num_functions(), if lowered == 0 { 3 * n + 1 } else { (4 - lowered) * n });
            }
            assert_eq!(trace.space.polynomials(Polynomials::Uniform { degree: 2, continuity: 1 }).unwrap().num_functions(), n + 2);
        }
        // all of the boundary as one side: a closed curve
        let mut cells = boxes([3, 2], shapes, 3, Some(7), &bent);
        cells.tags.clear();
        let body = Mesh::<1, 2>::from_cells(&cells, 3, Mapping::Isoparametric).unwrap();
        let trace = body.trace("untagged").unwrap();
        let n = trace.space.num_elements();
        assert_eq!((n, trace.space.num_functions()), (10, 30));
        assert_eq!(trace.space.polynomials(Polynomials::Lowered(0)).unwrap().num_functions(), 3 * n);
        assert_eq!(trace.space.polynomials(Polynomials::Lowered(2)).unwrap().num_functions(), 2 * n);
        assert!(faying::coupling::multiplier::side_ends(&*trace.space).is_empty());
        check::closed_body(&body).unwrap();
    }
}

#[test]
fn points_of_the_mesh_know_their_function() {
    let cells = boxes([2, 2, 2], Shapes::Simplex, 2, Some(4), &bent);
    let body = Mesh::<2, 3>::from_cells(&cells, 2, Mapping::Isoparametric).unwrap();
    // degree 2 has a node at every point: the field x_0 has the points as coefficients
    let mut u = vec![f64::NAN; body.space().num_functions()];
    (0..cells.points.len()).for_each(|p| u[body.function_at(p).unwrap()] = cells.points[p][0]);
    let field = faying::space::Field { first: 0, components: 1 };
    let locator = faying::space::Locator::new(body.space().clone());
    for p in 0..cells.points.len() {
        assert_eq!(body.vertex(p), Some(cells.points[p]));
        let found = locator.locate(&cells.points[p]).unwrap();
        let value = faying::space::field_at::<1, 3, _, _>(&**body.space(), &field, &u, found.element, &[found.xi])[0].value[0];
        assert!((value - cells.points[p][0]).abs() < 1e-10 && found.distance < 1e-10);
    }
    assert_eq!(body.function_at(cells.points.len()), None);
    // degree 1: corners only
    let linear = Mesh::<2, 3>::from_cells(&cells, 1, Mapping::Isoparametric).unwrap();
    assert_eq!((0..cells.points.len()).filter(|&p| linear.function_at(p).is_some()).count(), 27);
}

#[test]
fn broken_meshes_are_refused_with_the_place() {
    let square = || boxes([2, 2], Shapes::Simplex, 1, None, &|u: &Vector<2>| *u);
    let try_ = |cells: &MeshCells<2>| Mesh::<1, 2>::from_cells(cells, 2, Mapping::Isoparametric).unwrap_err();
    assert_eq!(try_(&MeshCells::default()), MeshError::Empty { dimension: 2 });
    let mut m = square();
    m.blocks[0].nodes.pop();
    assert!(matches!(try_(&m), MeshError::Nodes { block: 0, each: 3, .. }));
    let mut m = square();
    m.blocks[0].nodes[4] = 1 << 60;
    assert!(matches!(try_(&m), MeshError::NoPoint { cell: 1, .. }));
    let mut m = square();
    m.points[3][1] = f64::NAN;
    assert!(matches!(try_(&m), MeshError::NotFinite { point: 3 }));
    let mut m = square();
    m.blocks[0].nodes[4] = m.blocks[0].nodes[3];
    assert!(matches!(try_(&m), MeshError::Collapsed { cell: 1, .. }));
    let mut m = square();
    let first = m.blocks[0].nodes[..3].to_vec();
    m.blocks[0].nodes.extend(first);
    assert!(matches!(try_(&m), MeshError::Folded { cells: [0, 8], .. } | MeshError::Branched { .. }), "{}", try_(&m));
    let mut m = square();
    m.tags[0].corners[0][0] = 8;
    assert!(matches!(try_(&m), MeshError::NoFacet { facet: 0, .. }));
    let mut m = square();
    m.tags[1].corners.clear();
    assert!(matches!(try_(&m), MeshError::EmptyTag { .. }));
    let mut m = square();
    m.blocks[0].order = 5;
    assert!(matches!(try_(&m), MeshError::Order { order: 5, max: 4 }));
    assert!(matches!(Mesh::<1, 2>::from_cells(&square(), 5, Mapping::Exact), Err(MeshError::Degree { degree: 5, max: 4, .. })));
    assert!(matches!(Mesh::<1, 2>::from_cells(&square(), 0, Mapping::Exact), Err(MeshError::Degree { degree: 0, .. })));
    let quads = boxes([2, 2], Shapes::Tensor, 1, None, &|u: &Vector<2>| *u);
    assert!(Mesh::<1, 2>::from_cells(&quads, 8, Mapping::Exact).is_ok());
    assert!(matches!(Mesh::<1, 2>::from_cells(&quads, 9, Mapping::Exact), Err(MeshError::Degree { max: 8, .. })));
    // the middle point pulled out through a corner folds the mesh
    for (mut m, all_listed_alike) in [(quads, true), (square(), false)] {
        let middle = m.points.iter().position(|p| (p - Vector::<2>::new(0.5, 0.5)).norm() < 1e-12).unwrap();
        m.points[middle] = Vector::<2>::new(1.4, 1.3);
        let error = try_(&m);
        // triangles are listed left-handed by turns here: which of the two is wrong is not known
        assert!(matches!(error, MeshError::Inverted(_)) || !all_listed_alike && matches!(error, MeshError::Folded { .. }), "{error}");
    }
    // a node of one curved edge pulled across the cell
    let mut m = boxes([2, 2], Shapes::Tensor, 2, None, &|u: &Vector<2>| *u);
    let node = m.points.iter().position(|p| (p - Vector::<2>::new(0.25, 0.0)).norm() < 1e-12).unwrap();
    m.points[node][1] = 0.4;
    let Err(MeshError::Inverted(inverted)) = Mesh::<1, 2>::from_cells(&m, 2, Mapping::Exact) else { panic!("not refused") };
    assert_eq!((inverted.element, inverted.least_jacobian < 0.0), (0, true));
}

#[test]
fn hexahedra_and_tetrahedra_do_not_share_faces() {
    // a cube, and beside it on x = 1 two tetrahedra
    let hexahedra = boxes([1, 1, 1], Shapes::Tensor, 1, None, &|u: &Vector<3>| *u);
    let mut m = hexahedra.clone();
    m.tags.clear();
    let at = |m: &MeshCells<3>, x: [f64; 3]| m.points.iter().position(|p| (p - Vector::<3>::from(x)).norm() < 1e-12).unwrap();
    let corners = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]].map(|x| at(&m, x));
    m.points.push(Vector::<3>::new(2.0, 0.2, 0.2));
    let nodes = [corners.to_vec(), vec![m.points.len() - 1]].concat();
    m.blocks.push(faying::space::CellBlock { cell: Cell::Simplex, order: 1, nodes });
    assert!(matches!(Mesh::<2, 3>::from_cells(&m, 1, Mapping::Exact), Err(MeshError::Mismatch { cells: [1, 0], .. })));
    // apart they make one body of two shapes
    let shift = m.points.len();
    let apart: Vec<Vector<3>> = m.blocks[1].nodes.iter().map(|&p| m.points[p] + Vector::<3>::new(1.0, 0.0, 0.0)).collect();
    m.points.extend(apart);
    m.blocks[1].nodes = (shift..shift + 4).collect();
    let body = Mesh::<2, 3>::from_cells(&m, 3, Mapping::Exact).unwrap();
    check::closed_body(&body).unwrap();
    assert!((measure(&**body.space()) - 1.0 - 1.0 / 6.0).abs() < 1e-14);
    assert_eq!(body.trace("untagged").unwrap().space.num_elements(), 10);
}

#[test]
fn neighbours_that_disagree_on_their_edge_are_refused() {
    let mut m = boxes([2, 1], Shapes::Tensor, 2, None, &|u: &Vector<2>| *u);
    // the second cell gets a middle node of its own on the common edge
    let edge = m.points.iter().position(|p| (p - Vector::<2>::new(0.5, 0.5)).norm() < 1e-12).unwrap();
    m.points.push(m.points[edge] + Vector::<2>::new(0.01, 0.0));
    let last = m.points.len() - 1;
    let second = &mut m.blocks[0].nodes[9..];
    second.iter_mut().filter(|p| **p == edge).for_each(|p| *p = last);
    let Err(MeshError::Torn { cell: 1, distance, .. }) = Mesh::<1, 2>::from_cells(&m, 2, Mapping::Exact) else { panic!("not refused") };
    assert!((distance - 0.01).abs() < 1e-12);
}

/// sin(1.3 x + 0.4) e^(y / 2) cos(0.9 z).
fn smooth(x: &Vector<3>) -> Jet2<1, 3> {
    let (s, c) = (1.3 * x[0] + 0.4).sin_cos();
    let e = (0.5 * x[1]).exp();
    let (t, d) = (0.9 * x[2]).sin_cos();
    let lines = [[s, 1.3 * c, -1.69 * s], [e, 0.5 * e, 0.25 * e], [d, -0.9 * t, -0.81 * d]];
    let product = |order: [usize; 3]| (0..3).map(|k| lines[k][order[k]]).product::<f64>();
    let unit = |k: usize, l: usize| std::array::from_fn(|m| usize::from(m == k) + usize::from(m == l));
    let gradient = Matrix::from_fn(|_, k| product(unit(k, 3)));
    (Vector::<1>::new(product([0; 3])), gradient, [Matrix::from_fn(|k, l| product(unit(k, l)))])
}

#[test]
fn orders_in_space_are_p_plus_1_in_l2_and_p_in_h1_on_hexahedra_and_tetrahedra() {
    let conductor = Conductor::<3>::try_new(1.5).unwrap();
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        for (degree, counts) in [(1, [6, 12]), (2, [4, 8]), (3, [3, 6])] {
            let errors = counts.map(|n| {
                let cells = boxes([n; 3], shapes, degree, Some(8), &bent);
                let body = Mesh::<2, 3>::from_cells(&cells, degree, Mapping::Isoparametric).unwrap();
                Problem::new(&conductor, &smooth).held_on(&body, &["x0", "y1", "z0"]).solve(&body).errors.error
            });
            let order = |a: f64, b: f64| (a / b).log2();
            let (l2, h1) = (order(errors[0].l2, errors[1].l2), order(errors[0].h1, errors[1].h1));
            println!("{shapes:?}, p = {degree}: L2 {:.2e} order {l2:.2}, H1 {:.2e} order {h1:.2}", errors[1].l2, errors[1].h1);
            let p = degree as f64;
            assert!(l2 > p + 0.9 && h1 > p - 0.1, "{shapes:?}, p = {degree}: {l2} {h1}");
        }
    }
}

#[test]
fn tetrahedra_of_patches_fill_the_patch_and_its_sides() {
    use faying::geometry::shapes;
    let disc = shapes::disc_sector([0.0, 0.0], 1.0, [0.0, 180.0]).unwrap().extrude(2.0);
    for degree in 1..=4 {
        let of = |n: usize| {
            let spec = PatchSpec::new(disc.clone()).with_elements([2 * n, n, 1]).with_cells(Cell::Simplex).with_degree([degree; 3]);
            let body = Mesh::<2, 3>::from_patch(&spec).unwrap();
            // three of six tetrahedra are left at the axis
            assert_eq!(body.space().num_elements(), 2 * n * (6 * (n - 1) + 3));
            let side = |name: &str| measure(&*body.trace(name).unwrap().space);
            assert_eq!(body.trace("v1").unwrap().space.num_elements(), 4 * n);
            // the flat sides are as long as the radius
            assert!((side("u0") - 2.0).abs() < 1e-13 && (side("u1") - 2.0).abs() < 1e-13);
            assert!((side("w0") - side("w1")).abs() < 1e-13);
            let pi = std::f64::consts::PI;
            [measure(&**body.space()) - pi, side("v1") - 2.0 * pi, side("w0") - pi / 2.0].map(f64::abs)
        };
        let (coarse, fine) = (of(4), of(8));
        println!(
            "half cylinder in tetrahedra, degree {degree}: volume, mantle and base off by {:.1e} {:.1e} {:.1e}",
            fine[0], fine[1], fine[2]
        );
        for k in 0..3 {
            let rate = (coarse[k] / fine[k]).log2();
            assert!(rate > degree as f64 + 0.9, "degree {degree}, {k}: rate {rate}");
        }
    }
    // straight and exact maps have the measure itself
    let ring = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap().extrude(0.5);
    let spec = PatchSpec::new(ring).with_elements([2, 1, 1]).with_cells(Cell::Simplex).with_mapping(Mapping::Exact);
    let body = Mesh::<2, 3>::from_patch(&spec).unwrap();
    assert!((measure(&**body.space()) - 0.375 * std::f64::consts::PI).abs() < 1e-12);
    assert!((measure(&*body.trace("v1").unwrap().space) - 0.5 * std::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn tetrahedra_of_patches_have_the_orders_of_their_degree() {
    use faying::geometry::shapes;
    let conductor = Conductor::<3>::try_new(1.5).unwrap();
    let net = shapes::annulus_sector([0.0, 0.0], [1.0, 1.6], [0.0, 40.0]).unwrap().extrude(0.6);
    for mapping in [Mapping::Isoparametric, Mapping::Exact] {
        for (degree, counts) in [(1, [4, 8]), (2, [4, 8]), (3, [3, 6])] {
            if mapping == Mapping::Exact && degree == 3 {
                continue; // slow: the exact map is rational
            }
            let errors = counts.map(|n| {
                let spec = PatchSpec::new(net.clone()).with_elements([n; 3]).with_cells(Cell::Simplex).with_degree([degree; 3]);
                let body = Mesh::<2, 3>::from_patch(&spec.with_mapping(mapping)).unwrap();
                Problem::new(&conductor, &smooth).held_on(&body, &["u0", "v1", "w0"]).solve(&body).errors.error
            });
            let order = |a: f64, b: f64| (a / b).log2();
            let (l2, h1) = (order(errors[0].l2, errors[1].l2), order(errors[0].h1, errors[1].h1));
            println!("patch in tetrahedra, {mapping:?}, p = {degree}: L2 order {l2:.2}, H1 order {h1:.2}");
            let p = degree as f64;
            assert!(l2 > p + 0.9 && h1 > p - 0.1, "{mapping:?}, p = {degree}: {l2} {h1}");
        }
    }
}

// one number per straight simplex: the same as D! times its size from its corners
#[test]
fn quality_and_size_of_straight_simplices_are_those_of_their_corners() {
    let body = solid(Shapes::Simplex, 1, 1, Mapping::Isoparametric);
    let space = &**body.space();
    let mut table = MapTable::<3, 3>::new();
    let determinants: Vec<f64> = (0..space.num_elements())
        .map(|e| {
            assert!(space.map_structure().is_affine(e));
            space.map(e, &cell::corners::<3, f64>(space.cell(e)), Order::Values, &mut table);
            let x = &table.x;
            (x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[3] - x[0]))
        })
        .collect();
    let (first, least) = determinants.iter().enumerate().fold((0, f64::INFINITY), |m, (e, d)| if *d < m.1 { (e, *d) } else { m });
    let found = body.quality();
    assert!((found.least_jacobian - least).abs() < 1e-12 * least, "{} against {least}", found.least_jacobian);
    // another element is as good where rounding decides
    assert!((determinants[found.element] - least).abs() < 1e-12 * least, "{} against {first}", found.element);
    let volume = determinants.iter().sum::<f64>() / 6.0;
    assert!((measure::<3, 3, f64, _>(space) - volume).abs() < 1e-13 * volume);
    // curved cells, and degrees above one, are not known to be straight
    assert!(!solid(Shapes::Simplex, 2, 2, Mapping::Isoparametric).space().map_structure().is_affine(0));
    assert!(!solid(Shapes::Tensor, 1, 1, Mapping::Isoparametric).space().map_structure().is_affine(0));
    assert!(solid(Shapes::Simplex, 1, 3, Mapping::Exact).space().map_structure().is_affine(0));
}
