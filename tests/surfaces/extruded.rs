//! Contact in the plane, extruded by one layer of elements: pressures and displacements are those of the plane.

use faying::contact::{Augmented, ContactMethod, Cylinder, Lagrange, Sphere};
use faying::coupling::Penalty;
use faying::geometry::shapes;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{Components, Problem};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::sync::Arc;

const HEIGHT: f64 = 0.3;
const SAME: f64 = 1e-9;

/// Method of the plane and that of space.
type Methods = (Arc<dyn ContactMethod<1, 2>>, Arc<dyn ContactMethod<2, 3>>);

fn compare(degree: usize, mesh: bool, what: &str, methods: Methods) {
    let what = format!("{what}, degree {degree}, mesh {mesh}");
    let net = shapes::rectangle([0.0, 0.0], [1.0, 0.5]).unwrap();
    let flat = PatchSpec::new(net.clone()).with_degree([degree; 2]).with_elements([8, 3]);
    let deep = PatchSpec::new(net.extrude(HEIGHT)).with_degree([degree; 3]).with_elements([8, 3, 1]);
    let flat: Arc<dyn Body<1, 2>> =
        if mesh { Arc::new(Mesh::<1, 2>::from_patch(&flat).unwrap()) } else { Arc::new(Patch::<1, 2>::try_new(&flat).unwrap()) };
    let deep: Arc<dyn Body<2, 3>> =
        if mesh { Arc::new(Mesh::<2, 3>::from_patch(&deep).unwrap()) } else { Arc::new(Patch::<2, 3>::try_new(&deep).unwrap()) };

    let mut p = Problem::<1, 2>::new();
    let block = p.body("block", flat, Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap();
    p.fix(block.side("v1"), Components::One(0)).unwrap();
    p.prescribe(block.side("v1"), 1, -0.01).unwrap();
    let circle = Sphere::<2> { center: Vector::<2>::new(0.4, -1.5), radius: 1.5, inside: false };
    let contact = p.contact(block.side("v0"), circle).unwrap().method(methods.0).id();
    let plane = p.assemble().unwrap().solve(0.0, None).unwrap();

    let mut p = Problem::<2, 3>::new();
    let solid = p.body("block", deep, Hooke::solid(1.0, 0.3).unwrap()).unwrap();
    p.fix(solid.side("w0"), Components::One(2)).unwrap();
    p.fix(solid.side("w1"), Components::One(2)).unwrap();
    p.fix(solid.side("v1"), Components::One(0)).unwrap();
    p.prescribe(solid.side("v1"), 1, -0.01).unwrap();
    let cylinder = Cylinder::try_new(Vector::<3>::new(0.4, -1.5, 0.0), Vector::<3>::z(), 1.5).unwrap();
    let pressed = p.contact(solid.side("v0"), cylinder).unwrap().method(methods.1).id();
    let space = p.assemble().unwrap().solve(0.0, None).unwrap();

    let (a, b) = (plane.contact(contact).unwrap(), space.contact(pressed).unwrap());
    let largest = a.largest_pressure;
    assert!(largest > 0.0 && a.area < 0.9, "{what}: the zone is a part of the side");
    for (name, a, b) in [
        ("force x", a.force[0] * HEIGHT, b.force[0]),
        ("force y", a.force[1] * HEIGHT, b.force[1]),
        ("area", a.area * HEIGHT, b.area),
        ("moment", a.moment[2] * HEIGHT, b.moment[2]),
        ("pressure", a.largest_pressure, b.largest_pressure),
        ("gap", a.least_gap, b.least_gap),
    ] {
        assert!((a - b).abs() < SAME * a.abs().max(1e-3), "{what}: {name} {a} {b}");
    }
    assert!(b.force[2].abs() < SAME * b.force[1], "{what}");
    let (lambda, deep) = (plane.lambda(contact, 0).unwrap().unwrap(), space.lambda(pressed, 0).unwrap().unwrap());
    for e in 0..8 {
        for x in [0.1, 0.5, 0.77] {
            let (a, b) = (lambda.at(e, &[Vector::<1>::new(x)])[0][0], deep.at(e, &[Vector::<2>::new(x, 0.3)])[0][0]);
            assert!((a - b).abs() < SAME * largest, "{what}: lambda in element {e} at {x}: {a} {b}");
        }
    }
    for [x, y] in [[0.1, 0.1], [0.4, 0.0], [0.9, 0.45], [0.33, 0.21]] {
        let (a, b) = (plane.at(block, &[x, y]).unwrap(), space.at(solid, &[x, y, 0.2]).unwrap());
        let apart = (0..3).map(|k| (a.u[k] - b.u[k]).abs()).fold(0.0, f64::max);
        assert!(apart < SAME * 0.01, "{what}: u at {x} {y}: {apart:e}");
    }
}

#[test]
fn a_plane_contact_extruded_is_that_of_the_plane() {
    for degree in 1..=3 {
        for mesh in [false, true] {
            compare(degree, mesh, "lagrange", (Arc::new(Lagrange), Arc::new(Lagrange)));
        }
    }
}

/// Nitsche's method is not among them: its stabilisation comes from the elements, which are others.
#[test]
fn every_method_of_multipliers_extruded_is_that_of_the_plane() {
    for mesh in [false, true] {
        compare(2, mesh, "augmented", (Arc::new(Augmented::default()), Arc::new(Augmented::default())));
        compare(2, mesh, "penalty", (Arc::new(Penalty { factor: 1e12 }), Arc::new(Penalty { factor: 1e12 })));
    }
}
