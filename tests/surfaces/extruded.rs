//! Contact in the plane, with an obstacle and of two bodies, extruded by one layer of elements: pressures and displacements are those of the plane.

use faying::basis::BSpline;
use faying::contact::{Augmented, ContactMethod, Cylinder, Lagrange, Sphere};
use faying::coupling::Penalty;
use faying::geometry::{ControlNet, shapes};
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, ContactId, Data, Problem, Solution};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::sync::Arc;

const HEIGHT: f64 = 0.3;
const SAME: f64 = 1e-9;
/// Gauss points beyond the default: partners across gaps are not polynomials.
const EXTRA: usize = 6;

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

    let area = plane.contact(contact).unwrap().area;
    assert!(area > 0.0 && area < 0.9, "{what}: the zone is a part of the side");
    same(&what, (&plane, contact), (&space, pressed));
    for [x, y] in [[0.1, 0.1], [0.4, 0.0], [0.9, 0.45], [0.33, 0.21]] {
        same_displacement(&what, (&plane, block), (&space, solid), [x, y]);
    }
}

/// Forces, pressures, gaps and multipliers of a contact in the plane and in space.
fn same(what: &str, (plane, contact): (&Solution<1, 2>, ContactId), (space, pressed): (&Solution<2, 3>, ContactId)) {
    let (a, b) = (plane.contact(contact).unwrap(), space.contact(pressed).unwrap());
    let (largest, force) = (a.largest_pressure, a.force.norm() * HEIGHT);
    assert!(largest > 0.0, "{what}");
    for (name, a, b, scale) in [
        ("force x", a.force[0] * HEIGHT, b.force[0], force),
        ("force y", a.force[1] * HEIGHT, b.force[1], force),
        ("force z", 0.0, b.force[2], force),
        ("moment", a.moment[2] * HEIGHT, b.moment[2], force),
        ("area", a.area * HEIGHT, b.area, HEIGHT),
        ("pressure", a.largest_pressure, b.largest_pressure, largest),
        ("gap", a.least_gap, b.least_gap, 1e-3),
    ] {
        assert!((a - b).abs() < SAME * scale, "{what}: {name} {a} {b}");
    }
    let (lambda, deep) = (plane.lambda(contact, 0).unwrap().unwrap(), space.lambda(pressed, 0).unwrap().unwrap());
    for e in 0..8 {
        for x in [0.1, 0.5, 0.77] {
            let (a, b) = (lambda.at(e, &[Vector::<1>::new(x)])[0][0], deep.at(e, &[Vector::<2>::new(x, 0.3)])[0][0]);
            assert!((a - b).abs() < SAME * largest, "{what}: lambda in element {e} at {x}: {a} {b}");
        }
    }
    // the sets of closed rows: functions of space are those of the plane, several along z for each
    let sets = [
        plane.along(contact, 0).unwrap().unwrap().points().iter().map(|p| (p.x[0], p.active)).collect::<Vec<_>>(),
        space.along(pressed, 0).unwrap().unwrap().points().iter().map(|p| (p.x[0], p.active)).collect(),
    ];
    for (x, active) in &sets[1] {
        let twin =
            sets[0].iter().find(|(at, _)| (at - x).abs() < 1e-3).unwrap_or_else(|| panic!("{what}: no function of the plane at {x}"));
        assert_eq!(*active, twin.1, "{what}: the function at {x}");
    }
}

fn same_displacement(what: &str, (plane, flat): (&Solution<1, 2>, BodyId), (space, solid): (&Solution<2, 3>, BodyId), [x, y]: [f64; 2]) {
    let (a, b) = (plane.at(flat, &[x, y]).unwrap(), space.at(solid, &[x, y, 0.2]).unwrap());
    let apart = (0..3).map(|k| (a.u[k] - b.u[k]).abs()).fold(0.0, f64::max);
    assert!(apart < SAME * 0.01, "{what}: u at {x} {y}: {apart:e}");
}

/// A rectangle whose lower side is y = bend (x - 0.45)² + tilt x, exact with degree 2.
fn arched([bend, tilt]: [f64; 2], [low, high]: [f64; 2]) -> ControlNet<2, 2> {
    let squares = [0.45 * 0.45, 0.45 * (0.45 - 1.0), 0.55 * 0.55];
    let mut points = Vec::new();
    for k in 0..2 {
        for (i, x) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            points.push(Vector::<2>::new(x, if k == 0 { low + bend * squares[i] + tilt * x } else { high }));
        }
    }
    ControlNet::<2, 2>::try_new([BSpline::uniform(2, 1, 1), BSpline::uniform(1, 1, 0)], points, None).unwrap()
}

/// Two bodies, the upper one pushed down at its top by a displacement that varies; the slave is the upper one unless `swapped`.
struct Two {
    bend: f64,
    mesh: [bool; 2],
    swapped: bool,
}

impl Two {
    fn compare(&self, what: &str) {
        let what = format!("{what}, bend {}, meshes {:?}, swapped {}", self.bend, self.mesh, self.swapped);
        // the master is longer than the slave, or as long
        let nets = [arched([0.0, 0.0], [-0.5, 0.0]), arched([self.bend, 0.0], [0.0, 0.5])];
        let elements = [[5, 2], [8, 3]];
        let elements = if self.swapped { [[8, 3], [5, 2]] } else { elements };
        let young = [1.0, 2.5];
        let down = || Data::of(|x, _| -0.01 - 0.002 * x[0]);

        let mut p = Problem::<1, 2>::new();
        let flat: [BodyId; 2] = std::array::from_fn(|b| {
            let spec = PatchSpec::new(nets[b].clone()).with_degree([2; 2]).with_elements(elements[b]);
            let body: Arc<dyn Body<1, 2>> = match self.mesh[b] {
                true => Arc::new(Mesh::<1, 2>::from_patch(&spec).unwrap()),
                false => Arc::new(Patch::<1, 2>::try_new(&spec).unwrap()),
            };
            p.body(["lower", "upper"][b], body, Hooke::plane_strain(young[b], 0.3).unwrap()).unwrap()
        });
        p.fix(flat[0].side("v0"), Components::All).unwrap();
        p.fix(flat[1].side("v1"), Components::One(0)).unwrap();
        p.prescribe(flat[1].side("v1"), 1, down()).unwrap();
        let mut sides = [flat[1].side("v0"), flat[0].side("v1")];
        if self.swapped {
            sides.reverse();
        }
        let contact = p.contact(sides[0], sides[1]).unwrap().extra_points(EXTRA).id();
        let plane = p.assemble().unwrap().solve(0.0, None).unwrap();

        let mut p = Problem::<2, 3>::new();
        let deep: [BodyId; 2] = std::array::from_fn(|b| {
            let [n, m] = elements[b];
            let spec = PatchSpec::new(nets[b].extrude(HEIGHT)).with_degree([2; 3]).with_elements([n, m, 1]);
            let body: Arc<dyn Body<2, 3>> = match self.mesh[b] {
                true => Arc::new(Mesh::<2, 3>::from_patch(&spec).unwrap()),
                false => Arc::new(Patch::<2, 3>::try_new(&spec).unwrap()),
            };
            let body = p.body(["lower", "upper"][b], body, Hooke::solid(young[b], 0.3).unwrap()).unwrap();
            p.fix(body.side("w0"), Components::One(2)).unwrap();
            p.fix(body.side("w1"), Components::One(2)).unwrap();
            body
        });
        p.fix(deep[0].side("v0"), Components::All).unwrap();
        p.fix(deep[1].side("v1"), Components::One(0)).unwrap();
        p.prescribe(deep[1].side("v1"), 1, down()).unwrap();
        let mut sides = [deep[1].side("v0"), deep[0].side("v1")];
        if self.swapped {
            sides.reverse();
        }
        let pressed = p.contact(sides[0], sides[1]).unwrap().extra_points(EXTRA).id();
        let space = p.assemble().unwrap().solve(0.0, None).unwrap();

        let area = plane.contact(contact).unwrap().area;
        assert!(area > 0.0 && (self.bend == 0.0 || area < 0.9), "{what}: {area}");
        same(&what, (&plane, contact), (&space, pressed));
        for (b, points) in [[[0.1, -0.4], [0.4, -0.02], [0.9, -0.2]], [[0.1, 0.45], [0.45, 0.1], [0.9, 0.3]]].into_iter().enumerate() {
            points.iter().for_each(|&x| same_displacement(&what, (&plane, flat[b]), (&space, deep[b]), x));
        }
    }
}

#[test]
fn two_bodies_in_contact_extruded_are_those_of_the_plane() {
    for (what, bend) in [("full contact", 0.0), ("partial contact", 0.05)] {
        for mesh in [[false, false], [false, true], [true, false]] {
            for swapped in [false, true] {
                Two { bend, mesh, swapped }.compare(what);
            }
        }
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
