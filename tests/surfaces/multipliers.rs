//! Multiplier spaces on surfaces: how many functions they have, what they keep, and their inf-sup constants.

use crate::bodies::{Kind, Solid};
use crate::cells::{Shapes, bent, boxes};
use faying::basis::{Basis, Order, ShapeTable};
use faying::check;
use faying::coupling::inf_sup::{Question, inf_sup};
use faying::coupling::multiplier::{Ends, MultiplierError, MultiplierKind, build, build_on_surface, has_triangles};
use faying::geometry::{cell, shapes};
use faying::linalg::Vector;
use faying::space::{Body, Mapping, Mesh, Patch, PatchSpec, Space, Trace};
use std::collections::HashMap;
use std::sync::Arc;

type Surface = Arc<dyn Space<2, 3>>;

/// The bottom of [0, 1] x [0, width] x [0, 1].
fn bottom(kind: Kind, degree: usize, elements: [usize; 2], width: f64) -> Trace<2, 3> {
    let net = shapes::brick([0.0; 3], [1.0, width, 1.0]).unwrap();
    let body = kind.body(&PatchSpec::new(net).with_degree([degree; 3]).with_elements([elements[0], elements[1], 1]));
    body.trace("w0").unwrap()
}

/// Whether each function of a side does not vanish on its rim: on edges of one element.
fn rim(space: &dyn Space<2, 3>) -> Vec<bool> {
    let (mut ids, mut corners, mut table) = (Vec::new(), Vec::new(), ShapeTable::new());
    let mut owners: HashMap<[usize; 2], Vec<(usize, Vector<2>)>> = HashMap::new();
    for e in 0..space.num_elements() {
        space.corners(e, &mut corners);
        for face in cell::faces::<2, f64>(space.cell(e)) {
            let mut key = [corners[face.corners[0]], corners[face.corners[1]]];
            key.sort_unstable();
            let ends = face.corners.iter().map(|&c| cell::corners::<2, f64>(space.cell(e))[c]).collect::<Vec<_>>();
            // a point that no function of the edge vanishes at
            owners.entry(key).or_default().push((e, ends[0] * 0.37 + ends[1] * 0.63));
        }
    }
    let mut rim = vec![false; space.num_functions()];
    for (e, xi) in owners.into_values().filter(|own| own.len() == 1).flatten() {
        space.active(e, &mut ids);
        space.tabulate(e, &[xi], Order::Values, &mut table);
        ids.iter().zip(table.values(0)).filter(|(_, v)| v.abs() > 1e-10).for_each(|(&i, _)| rim[i] = true);
    }
    rim
}

/// The inf-sup constant in L2, traces zero on the rim or free.
fn beta(space: &Surface, kind: MultiplierKind, zero: bool) -> f64 {
    let held = if zero { rim(&**space) } else { vec![false; space.num_functions()] };
    let psi = build_on_surface(space, kind, &|i| held[i]).unwrap();
    let mut next = 0..;
    let functions: Vec<Option<usize>> = held.iter().map(|&held| if held { None } else { next.next() }).collect();
    inf_sup(&**space, &functions, &*psi, &Question::default()).unwrap().beta
}

fn beta_of_curve(kind: Kind, degree: usize, n: usize, multiplier: MultiplierKind, zero: bool) -> f64 {
    let net = shapes::rectangle([0.0; 2], [1.0; 2]).unwrap();
    let spec = PatchSpec::new(net).with_degree([degree; 2]).with_elements([n, 1]);
    let body: Box<dyn Body<1, 2>> = match kind {
        Kind::Spline => Box::new(Patch::<1, 2>::try_new(&spec).unwrap()),
        _ => Box::new(Mesh::<1, 2>::from_patch(&spec).unwrap()),
    };
    let space = body.trace("v0").unwrap().space;
    let psi = build(&space, multiplier, &[zero; 2]).unwrap();
    let (n, mut next) = (space.num_functions(), 0..);
    let functions: Vec<Option<usize>> = (0..n).map(|i| if zero && (i == 0 || i + 1 == n) { None } else { next.next() }).collect();
    inf_sup(&*space, &functions, &*psi, &Question::default()).unwrap().beta
}

#[test]
fn constants_of_tensor_sides_are_the_products_of_those_of_their_directions() {
    for kind in [Kind::Spline, Kind::Hexahedra] {
        for (degree, multiplier) in [(1, 0), (2, 0), (2, 2), (3, 0), (3, 2), (4, 2)] {
            let multiplier = MultiplierKind::Lowered(multiplier);
            for zero in [true, false] {
                let space = bottom(kind, degree, [5, 4], 1.0).space;
                let product: f64 = [5, 4].map(|n| beta_of_curve(kind, degree, n, multiplier, zero)).iter().product();
                let found = beta(&space, multiplier, zero);
                assert!((found - product).abs() < 1e-9, "{kind:?} {degree} {multiplier:?} {zero}: {found} for {product}");
                assert!(found > 0.2, "{kind:?} {degree} {multiplier:?} {zero}: {found}");
            }
        }
    }
}

#[test]
fn constants_of_auto_do_not_fall_under_refinement() {
    for (kind, degree) in [(Kind::Spline, 1), (Kind::Spline, 2), (Kind::Hexahedra, 2), (Kind::Tetrahedra, 1), (Kind::Tetrahedra, 2)] {
        for zero in [true, false] {
            let found: Vec<f64> = [4, 8, 16].map(|n| beta(&bottom(kind, degree, [n, n], 1.0).space, MultiplierKind::Auto, zero)).to_vec();
            assert!(found[2] > 0.9 * found[1] && found[2] > 0.2, "{kind:?} {degree} zero on the rim {zero}: {found:?}");
        }
    }
}

/// Constants of triangles of one diagonal, traces zero on the rim: continuous polynomials are stable, those that jump are not.
#[test]
fn continuous_multipliers_on_triangles_are_stable() {
    for (degree, lowered, least) in [(2, 1, 0.19), (3, 2, 0.6), (4, 2, 0.45), (3, 1, 0.08)] {
        let found = [2, 4, 8].map(|n| beta(&bottom(Kind::Tetrahedra, degree, [n, n], 1.0).space, MultiplierKind::Lowered(lowered), true));
        assert!(found.iter().all(|&b| b > least), "{degree} / {}: {found:?}", degree - lowered);
    }
    let found = [4, 8, 12].map(|n| beta(&bottom(Kind::Tetrahedra, 2, [n, n], 1.0).space, MultiplierKind::Auto, true));
    assert!(found.iter().all(|&b| (b - 0.209).abs() < 2e-3), "{found:?}");
    let jumps = MultiplierKind::Uniform { degree: 0, continuity: Some(-1), ends: Ends::Full };
    assert!(beta(&bottom(Kind::Tetrahedra, 2, [8, 8], 1.0).space, jumps, true) < 1e-6);
}

#[test]
fn auto_is_stable_for_the_cells_of_the_side() {
    let auto = |kind, degree| MultiplierKind::Auto.resolved(&*bottom(kind, degree, [2, 2], 1.0).space).to_string();
    for kind in [Kind::Spline, Kind::Nurbs, Kind::Hexahedra] {
        assert_eq!([1, 2, 3].map(|p| auto(kind, p)), ["p/p", "p/p-2", "p/p-2"], "{kind:?}");
    }
    assert_eq!([1, 2, 3, 4].map(|p| auto(Kind::Tetrahedra, p)), ["p/p", "p/p-1", "p/p-2", "p/p-2"]);
    let triangles = bottom(Kind::Tetrahedra, 3, [2, 2], 1.0).space;
    assert!(has_triangles(&*triangles) && !MultiplierKind::Lowered(1).is_unstable_on(&*triangles));
    assert!(MultiplierKind::Lowered(1).is_unstable_on(&*bottom(Kind::Hexahedra, 3, [2, 2], 1.0).space));
}

/// Degree 2 on 4 x 3 elements: 6 x 5 functions, the shorter edges along the second direction.
#[test]
fn p_over_p_is_lowered_along_whole_edges() {
    let space = bottom(Kind::Spline, 2, [4, 3], 0.5).space;
    let count = |held: &[usize]| build_on_surface(&space, MultiplierKind::Lowered(0), &|i| held.contains(&i)).unwrap().num_functions();
    let (u0, u1, v0): (Vec<usize>, Vec<usize>, Vec<usize>) =
        ((0..5).map(|j| 6 * j).collect(), (0..5).map(|j| 6 * j + 5).collect(), (0..6).collect());
    let both = |a: &[usize], b: &[usize]| [a, b].concat();
    for (held, functions) in [
        (vec![], 6 * 5),
        (u0.clone(), 5 * 5),
        (both(&u0, &u1), 4 * 5),
        (both(&u0, &v0), 5 * 4),
        // a part of an edge is the whole of it
        (vec![12], 5 * 5),
        (vec![2, 3], 6 * 4),
        // a corner alone lowers the shorter of its edges: that of length 0.5 along the second direction
        (vec![0], 5 * 5),
        (vec![5, 24], 4 * 5),
        // functions inside lower nothing
        (vec![14], 6 * 5),
    ] {
        assert_eq!(count(&held), functions, "{held:?}");
    }
    let ends = |ends| MultiplierKind::Uniform { degree: 2, continuity: None, ends };
    let made = |kind| build_on_surface(&space, kind, &|i| u0.contains(&i)).unwrap().num_functions();
    assert_eq!([Ends::Auto, Ends::Full, Ends::Lowered].map(|e| made(ends(e))), [5 * 5, 6 * 5, 4 * 3]);
    assert_eq!(made(MultiplierKind::Lowered(2)), 4 * 3);
    let small = bottom(Kind::Spline, 1, [1, 3], 0.5).space;
    let error = build_on_surface(&small, MultiplierKind::Lowered(0), &|_| true).expect_err("nothing is left");
    assert_eq!(error, MultiplierError::NothingLeftAtEdge { axis: 0, end: 1, degree: 1 });
    assert!(error.to_string().contains("where its first direction ends"), "{error}");
}

/// An octant of degree 2 on 4 x 3 elements: 6 functions along every parallel, of which 4 rows and the pole.
#[test]
fn an_edge_that_is_a_pole_is_lowered_with_its_function() {
    for kind in [Kind::Nurbs, Kind::Hexahedra] {
        let octant = shapes::sphere_octant([0.0; 3], [1.0, 2.0]).unwrap();
        let body = kind.body(&PatchSpec::new(octant).with_degree([2; 3]).with_elements([4, 3, 1]));
        let space = body.trace("w1").unwrap().space;
        let [m, n] = if kind == Kind::Nurbs { [6, 5] } else { [9, 7] };
        assert_eq!(space.num_functions(), m * (n - 1) + 1, "{kind:?}");
        // on all elements of a parallel there is no function but that of the pole
        let active = |e: usize| {
            let mut ids = Vec::new();
            space.active(e, &mut ids);
            ids
        };
        let of_all = |row: usize| active(4 * row).into_iter().filter(move |i| (1..4).all(|e| active(4 * row + e).contains(i)));
        let poles: Vec<usize> = (0..3).flat_map(of_all).collect();
        let [pole] = poles[..] else { panic!("{kind:?}: {poles:?}") };
        let meridian: Vec<usize> = (0..n - 1).map(|j| m * j).collect();
        assert!(!meridian.contains(&pole), "{kind:?}");
        let count = |held: &dyn Fn(usize) -> bool| {
            let psi = build_on_surface(&space, MultiplierKind::Lowered(0), held).unwrap();
            keeps_the_rules(&*psi, true, &format!("{kind:?}"));
            psi.num_functions()
        };
        assert_eq!(count(&|_| false), m * (n - 1) + 1, "{kind:?}");
        // as many as functions are left
        assert_eq!(count(&|i| i == pole), m * (n - 1), "{kind:?}");
        assert_eq!(count(&|i| i == pole || meridian.contains(&i)), (m - 1) * (n - 1), "{kind:?}");
        assert_eq!(count(&|i| meridian.contains(&i)), (m - 1) * (n - 1) + 1, "{kind:?}");
    }
}

/// Values and sums of a multiplier as its users need them; the derivatives of functions that are constant on an element, as in the corner
/// of a side that is held, are round-off, which the rules of a basis do not allow.
fn keeps_the_rules(psi: &dyn Basis<2>, held: bool, what: &str) {
    if !held {
        check::basis::<2, f64>(psi).unwrap_or_else(|e| panic!("{what}: {e}"));
    }
    check::non_negative::<2, f64>(psi).unwrap_or_else(|e| panic!("{what}: {e}"));
    check::partition_of_unity::<2, f64>(psi).unwrap_or_else(|e| panic!("{what}: {e}"));
}

#[test]
fn all_kinds_on_all_cells_are_positive_and_sum_to_one() {
    let octant = shapes::sphere_octant([0.0; 3], [1.0, 2.0]).unwrap();
    let octant =
        |kind: Kind, p| kind.body(&PatchSpec::new(octant.clone()).with_degree([p; 3]).with_elements([3, 3, 1])).trace("w1").unwrap();
    let from_cells = |shapes, p| -> Solid {
        Arc::new(Mesh::<2, 3>::from_cells(&boxes([3, 2, 1], shapes, 1, Some(7), &bent), p, Mapping::Isoparametric).unwrap())
    };
    let mut sides = Vec::new();
    for p in 1..=3 {
        for kind in [Kind::Spline, Kind::Nurbs, Kind::Hexahedra, Kind::Tetrahedra] {
            sides.push((format!("{kind:?} {p}"), bottom(kind, p, [3, 2], 1.0).space));
        }
        if p > 1 {
            sides.push((format!("octant of NURBS {p}"), octant(Kind::Nurbs, p).space));
        }
        sides.push((format!("octant of hexahedra {p}"), octant(Kind::Hexahedra, p).space));
        for shapes in [Shapes::Tensor, Shapes::Simplex] {
            sides.push((format!("mesh of {shapes:?} {p}"), from_cells(shapes, p).trace("z0").unwrap().space));
        }
    }
    for (name, space) in &sides {
        let rim = rim(&**space);
        let inner = rim.iter().filter(|held| !**held).count();
        for kind in [MultiplierKind::Auto, MultiplierKind::Lowered(0), MultiplierKind::Constant] {
            for held in [false, true].into_iter().filter(|held| !held || inner > 0) {
                let psi = build_on_surface(space, kind, &|i| held && rim[i]).unwrap_or_else(|e| panic!("{name} {kind}: {e}"));
                keeps_the_rules(&*psi, held, &format!("{name} {kind} held {held}"));
                if kind == MultiplierKind::Lowered(0) {
                    let most = if held { inner } else { rim.len() };
                    assert!(psi.num_functions() <= most, "{name} held {held}: {} functions for {most}", psi.num_functions());
                }
            }
        }
    }
}

/// On cells that are no grid what is held gives its multiplier to its neighbours; a side without free functions has none.
#[test]
fn multipliers_of_held_functions_are_passed_on() {
    let space = bottom(Kind::Tetrahedra, 1, [4, 4], 1.0).space;
    let held = rim(&*space);
    let psi = build_on_surface(&space, MultiplierKind::Lowered(0), &|i| held[i]).unwrap();
    assert_eq!(psi.num_functions(), 9);
    let error = build_on_surface(&space, MultiplierKind::Lowered(0), &|_| true).expect_err("all are held");
    assert_eq!(error, MultiplierError::NothingFree);
    let found = [4, 8, 16].map(|n| beta(&bottom(Kind::Tetrahedra, 1, [n, n], 1.0).space, MultiplierKind::Lowered(0), true));
    assert!(found[2] > 0.9 * found[1] && found[2] > 0.2, "{found:?}");
}

/// A function of a pole has the elements of all functions around it; they share what it gives when it is held.
#[test]
fn multipliers_around_held_poles_are_stable() {
    for (kind, degree) in [Kind::Spline, Kind::Hexahedra, Kind::Tetrahedra].into_iter().flat_map(|kind| [1, 2].map(|p| (kind, p))) {
        let found = [4, 8, 16, 32].map(|n| {
            let net = shapes::sphere_octant([0.0; 3], [0.5, 1.0]).unwrap();
            let body = kind.body(&PatchSpec::new(net).with_degree([degree; 3]).with_elements([n, n, 1]));
            let space = body.trace("w1").unwrap().space;
            let held = rim(&*space);
            let psi = build_on_surface(&space, MultiplierKind::Lowered(0), &|i| held[i]).unwrap();
            keeps_the_rules(&*psi, true, &format!("{kind:?} {degree} {n}"));
            beta(&space, MultiplierKind::Lowered(0), true)
        });
        println!("{kind:?} of degree {degree}: {found:?}");
        assert!(found[3] > 0.9 * found[2] && found[3] > 0.2, "{kind:?} of degree {degree}: {found:?}");
    }
}
