//! Dual multipliers of surfaces: duality over the area, on all cells that have them, in ties and contact.

use crate::bodies::{Kind, steel};
use faying::assembly::gauss_rules;
use faying::basis::{Basis, Order, ShapeTable};
use faying::contact::{HalfPlane, Sphere};
use faying::coupling::multiplier::{MultiplierError, MultiplierKind, build_on_surface};
use faying::geometry::{MapTable, cross, shapes};
use faying::linalg::Vector;
use faying::problem::{ErrorKind, InterfaceError, Problem};
use faying::quadrature::Quadrature;
use faying::space::{PatchSpec, Space, Trace};
use std::sync::Arc;

/// The outer side of an eighth of a ball without its pole, or the bottom of a box.
fn side(kind: Kind, degree: usize, curved: bool) -> Trace<2, 3> {
    let net = match curved {
        true => shapes::annulus_sector([0.0; 2], [1.0, 2.0], [0.0, 80.0]).unwrap().extrude(0.7),
        false => shapes::brick([0.0; 3], [1.0, 0.8, 0.5]).unwrap(),
    };
    let body = kind.body(&PatchSpec::new(net).with_degree([degree; 3]).with_elements([3, 2, 2]));
    body.trace(if curved { "v1" } else { "w0" }).unwrap()
}

/// ∫ psi_j N_i ds and ∫ N_i ds, by a rule of its own, and the largest deviation of the sum of the psi_j from one.
fn products(space: &Arc<dyn Space<2, 3>>, psi: &dyn Basis<2>) -> (Vec<Vec<f64>>, Vec<f64>, f64) {
    let (n, m) = (space.num_functions(), psi.num_functions());
    let (mut all, mut weights, mut off) = (vec![vec![0.0; n]; m], vec![0.0; n], 0.0f64);
    let rules = gauss_rules(&**space, 11);
    let (mut ids, mut own, mut shapes, mut dual, mut map) = (Vec::new(), Vec::new(), ShapeTable::new(), ShapeTable::new(), MapTable::new());
    for e in 0..space.num_elements() {
        let rule = rules.rule(e);
        space.active(e, &mut ids);
        psi.active(e, &mut own);
        space.tabulate(e, &rule.points, Order::Values, &mut shapes);
        psi.tabulate(e, &rule.points, Order::Values, &mut dual);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        for (q, w) in rule.weights.iter().enumerate() {
            let ds = w * cross(&map.jacobian[q]).norm();
            off = off.max((dual.values(q).iter().sum::<f64>() - 1.0).abs());
            for (&i, value) in ids.iter().zip(shapes.values(q)) {
                weights[i] += ds * value;
                own.iter().zip(dual.values(q)).for_each(|(&j, psi)| all[j][i] += ds * value * psi);
            }
        }
    }
    (all, weights, off)
}

#[test]
fn functions_are_dual_over_the_area() {
    for (kind, degrees) in [(Kind::Spline, 1..=3), (Kind::Nurbs, 2..=3), (Kind::Hexahedra, 1..=3), (Kind::Tetrahedra, 1..=1)] {
        for degree in degrees {
            for curved in [false, true] {
                let space = side(kind, degree, curved).space;
                let what = format!("{kind:?} {degree} {curved}");
                let psi = build_on_surface(&space, MultiplierKind::Dual, &|_| false).unwrap_or_else(|e| panic!("{what}: {e}"));
                let (found, weights, off) = products(&space, &*psi);
                let largest = weights.iter().fold(0.0f64, |m, w| m.max(*w));
                assert!(off < 1e-10, "{what}: the sum is off by {off:e}");
                for (j, line) in found.iter().enumerate() {
                    for (i, value) in line.iter().enumerate() {
                        let wanted = if i == j { weights[i] } else { 0.0 };
                        assert!((value - wanted).abs() < 1e-9 * largest, "{what}: {j} {i}: {value} {wanted}");
                    }
                }
            }
        }
    }
}

/// Constrained functions give their multiplier away: the others stay dual to all free functions, and sum to one.
#[test]
fn constrained_functions_keep_the_duality_of_the_free_ones() {
    for (kind, degree) in [(Kind::Spline, 2), (Kind::Hexahedra, 2), (Kind::Tetrahedra, 1)] {
        let space = side(kind, degree, false).space;
        let held = |i: usize| i.is_multiple_of(5);
        let psi = build_on_surface(&space, MultiplierKind::Dual, &held).unwrap();
        let (found, weights, off) = products(&space, &*psi);
        let free: Vec<usize> = (0..space.num_functions()).filter(|&i| !held(i)).collect();
        assert_eq!(psi.num_functions(), free.len());
        assert!(off < 1e-10, "{kind:?}: {off:e}");
        for (j, line) in found.iter().enumerate() {
            for &i in &free {
                let wanted = if free[j] == i { weights[i] } else { 0.0 };
                assert!((line[i] - wanted).abs() < 1e-10, "{kind:?}: {j} {i}: {} {wanted}", line[i]);
            }
        }
    }
}

/// The integrals of the functions of vertices vanish on triangles of degree 2.
#[test]
fn triangles_of_degree_2_have_none() {
    let space = side(Kind::Tetrahedra, 2, false).space;
    match build_on_surface(&space, MultiplierKind::Dual, &|_| false) {
        Err(MultiplierError::NoDual { reason, known }) => {
            assert!(reason.contains("lumped weight"), "{reason}");
            assert_eq!(known, "p/p, p/p-1, constant");
        }
        other => panic!("{:?}", other.map(|psi| psi.num_functions())),
    }
}

/// A block on a plane under a uniform pressure, and one on a ball, by dual multipliers: the pressure that p/p has in the mean.
#[test]
fn contact_by_dual_multipliers_transmits_the_load() {
    let pressed = |kind: Kind, degree: usize, dual: bool, ball: bool| {
        let net = shapes::brick([0.0, 0.0, if ball { -0.02 } else { 0.0 }], [1.0, 1.0, 0.5]).unwrap();
        let mut p = Problem::<2, 3>::new();
        let body = kind.body(&PatchSpec::new(net).with_degree([degree; 3]).with_elements([4, 4, 2]));
        let block = kind.add(&mut p, "block", body, steel());
        for side in ["u0", "v0"] {
            p.fix_normal(block.side(side)).unwrap();
        }
        p.pressure(block.side("w1"), 1e-3).unwrap();
        let multiplier = if dual { MultiplierKind::Dual } else { MultiplierKind::Auto };
        let contact = match ball {
            true => {
                let center = Vector::<3>::new(0.45, 0.5, -2.0);
                p.contact(block.side("w0"), Sphere::<3> { center, radius: 2.0, inside: false }).unwrap().multiplier(multiplier).id()
            }
            false => {
                let plane = HalfPlane::try_new(Vector::<3>::zeros(), Vector::<3>::z()).unwrap();
                p.contact(block.side("w0"), plane).unwrap().multiplier(multiplier).id()
            }
        };
        p.assemble().unwrap().solve(0.0, None).unwrap().contact(contact).unwrap()
    };
    for (kind, degree) in [(Kind::Spline, 2), (Kind::Hexahedra, 1), (Kind::Hexahedra, 2), (Kind::Tetrahedra, 1)] {
        let flat = pressed(kind, degree, true, false);
        assert!((flat.force[2] - 1e-3).abs() < 1e-14, "{kind:?} {degree}: {:?}", flat.force);
        assert!((flat.largest_pressure - 1e-3).abs() < 1e-13 && (flat.least_pressure - 1e-3).abs() < 1e-13, "{kind:?} {degree}");
        let [a, b] = [true, false].map(|dual| pressed(kind, degree, dual, true).force);
        assert!((a[2] / b[2] - 1.0).abs() < 1e-3 && a[2] > 9e-4, "{kind:?} {degree}: {a:?} {b:?}");
    }
}

/// A punch that ends inside of elements.
#[test]
fn elements_that_face_their_opponent_in_part_are_refused() {
    let net = shapes::brick([0.0; 3], [1.0, 1.0, 0.5]).unwrap();
    let mut p = Problem::<2, 3>::new();
    let body = Kind::Spline.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements([4, 4, 2]));
    let block = Kind::Spline.add(&mut p, "block", body, steel());
    p.fix(block.side("w1"), faying::problem::Components::All).unwrap();
    let ball = Sphere::<3> { center: Vector::<3>::new(0.5, 0.5, -0.29), radius: 0.3, inside: false };
    p.contact(block.side("w0"), ball).unwrap().multiplier(MultiplierKind::Dual);
    let error = p.assemble().expect_err("in part").0.remove(0);
    let ErrorKind::Interface { error: InterfaceError::Multiplier { error: MultiplierError::NoDual { reason, .. }, .. }, .. } = &error.kind
    else {
        panic!("{error:?}")
    };
    assert!(reason.contains("in part"), "{reason}");
}
