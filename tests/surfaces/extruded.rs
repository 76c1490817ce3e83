//! Contact in the plane, with an obstacle and of two bodies, extruded by one layer of elements: pressures and displacements are those of the plane.

use faying::basis::{BSpline, Order};
use faying::contact::{Augmented, ContactMethod, Cylinder, Lagrange, Sphere};
use faying::coupling::interface::{MasterSums, MasterSurfaceSums, SlaveRule, SlaveSurface};
use faying::coupling::{InterfaceQuadrature, Penalty, Segments};
use faying::geometry::{ControlNet, Geometry, MapTable, shapes};
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, ContactId, Data, Integration, Problem, Solution};
use faying::quadrature::gauss_legendre;
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
#[derive(Clone, Copy, Debug)]
struct Two {
    bend: f64,
    mesh: [bool; 2],
    swapped: bool,
    rule: Integration,
}

/// A body in the plane, and in space.
type Twin = (Arc<dyn Body<1, 2>>, Arc<dyn Body<2, 3>>);

impl Two {
    /// Fully and partly closed, of splines and finite elements, either one the slave.
    fn all(rule: Integration) -> impl Iterator<Item = Self> {
        let meshes = [[false, false], [false, true], [true, false]];
        let pairs = meshes.into_iter().flat_map(|mesh| [false, true].map(|swapped| (mesh, swapped)));
        [0.0, 0.05].into_iter().flat_map(move |bend| pairs.clone().map(move |(mesh, swapped)| Self { bend, mesh, swapped, rule }))
    }

    /// Body 0 is the lower one, in space of so many layers; the master is longer than the slave, or as long.
    fn body(&self, b: usize, layers: usize) -> Twin {
        let net = if b == 0 { arched([0.0, 0.0], [-0.5, 0.0]) } else { arched([self.bend, 0.0], [0.0, 0.5]) };
        let [n, m] = if (b == 0) == self.swapped { [8, 3] } else { [5, 2] };
        let flat = PatchSpec::new(net.clone()).with_degree([2; 2]).with_elements([n, m]);
        let deep = PatchSpec::new(net.extrude(HEIGHT)).with_degree([2; 3]).with_elements([n, m, layers]);
        match self.mesh[b] {
            true => (Arc::new(Mesh::<1, 2>::from_patch(&flat).unwrap()), Arc::new(Mesh::<2, 3>::from_patch(&deep).unwrap())),
            false => (Arc::new(Patch::<1, 2>::try_new(&flat).unwrap()), Arc::new(Patch::<2, 3>::try_new(&deep).unwrap())),
        }
    }

    fn compare(&self) {
        let what = format!("{self:?}");
        let bodies = [0, 1].map(|b| self.body(b, 1));
        let young = [1.0, 2.5];
        let down = || Data::of(|x, _| -0.01 - 0.002 * x[0]);

        let mut p = Problem::<1, 2>::new();
        let flat: [BodyId; 2] = std::array::from_fn(|b| {
            let steel = Hooke::plane_strain(young[b], 0.3).unwrap();
            p.body(["lower", "upper"][b], bodies[b].0.clone(), steel).unwrap()
        });
        p.fix(flat[0].side("v0"), Components::All).unwrap();
        p.fix(flat[1].side("v1"), Components::One(0)).unwrap();
        p.prescribe(flat[1].side("v1"), 1, down()).unwrap();
        let mut sides = [flat[1].side("v0"), flat[0].side("v1")];
        if self.swapped {
            sides.reverse();
        }
        let contact = p.contact(sides[0], sides[1]).unwrap().rule(self.rule).extra_points(EXTRA).id();
        let plane = p.assemble().unwrap().solve(0.0, None).unwrap();

        let mut p = Problem::<2, 3>::new();
        let deep: [BodyId; 2] = std::array::from_fn(|b| {
            let steel = Hooke::solid(young[b], 0.3).unwrap();
            let body = p.body(["lower", "upper"][b], bodies[b].1.clone(), steel).unwrap();
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
        let pressed = p.contact(sides[0], sides[1]).unwrap().rule(self.rule).extra_points(EXTRA).id();
        let space = p.assemble().unwrap().solve(0.0, None).unwrap();

        let area = plane.contact(contact).unwrap().area;
        assert!(area > 0.0 && (self.bend == 0.0 || area < 0.9), "{what}: {area}");
        same(&what, (&plane, contact), (&space, pressed));
        for (b, points) in [[[0.1, -0.4], [0.4, -0.02], [0.9, -0.2]], [[0.1, 0.45], [0.45, 0.1], [0.9, 0.3]]].into_iter().enumerate() {
            points.iter().for_each(|&x| same_displacement(&what, (&plane, flat[b]), (&space, deep[b]), x));
        }
    }

    /// Points of the rule in the plane and in space: x and y of slave and master, and the weight; those of space for each of the Gauss points
    /// along the layers of the side whose points they are, over their weight there.
    fn points(&self, n: usize, layers: [usize; 2]) -> (Vec<[f64; 5]>, Vec<Vec<[f64; 5]>>) {
        let slave = usize::from(!self.swapped);
        let sides = [(slave, layers[0]), (1 - slave, layers[1])].map(|(b, layers)| (self.body(b, layers), ["v1", "v0"][b]));
        let is_mixed = matches!(self.rule, Integration::Mixed);
        let [slave, master] = sides.each_ref().map(|((flat, _), name)| flat.trace(name).unwrap().oriented());
        let flat = match is_mixed {
            true => MasterSums::facing(n, None).segments(&slave, &master),
            false => SlaveRule::facing(n, None).segments(&slave, &master),
        };
        let plane = listed(&flat.unwrap(), &slave, &master).into_iter().map(|(x, y, ds)| [x[0], x[1], y[0], y[1], ds]).collect();
        let [slave, master] = sides.each_ref().map(|((_, deep), name)| deep.trace(name).unwrap().oriented());
        let deep = match is_mixed {
            true => MasterSurfaceSums::facing(n, None).segments(&slave, &master),
            false => SlaveSurface::facing(n, None).segments(&slave, &master),
        };
        let (gauss, height) = (gauss_legendre::<f64>(n), HEIGHT / layers[usize::from(is_mixed)] as f64);
        let mut along = vec![Vec::new(); n * layers[usize::from(is_mixed)]];
        for (x, y, ds) in listed(&deep.unwrap(), &slave, &master) {
            let k = (0..along.len()).find(|&k| ((k / n) as f64 + gauss.points[k % n][0] - x[2] / height).abs() < SAME);
            let k = k.unwrap_or_else(|| panic!("{self:?}: {x:?}"));
            along[k].push([x[0], x[1], y[0], y[1], ds / (gauss.weights[k % n] * height)]);
        }
        (plane, along)
    }
}

/// Pairs of points of segments with their weights.
fn listed<const D: usize, const N: usize>(
    segments: &Segments<D>,
    slave: &dyn Geometry<D, N>,
    master: &dyn Geometry<D, N>,
) -> Vec<(Vector<N>, Vector<N>, f64)> {
    let (mut own, mut other, mut out) = (MapTable::new(), MapTable::new(), Vec::new());
    for piece in 0..segments.num_pieces() {
        for q in segments.points(piece) {
            slave.map(segments.slave[piece], &[segments.slave_xi[q]], Order::Values, &mut own);
            master.map(segments.master[piece], &[segments.master_xi[q]], Order::Values, &mut other);
            out.push((own.x[0], other.x[0], segments.ds[q]));
        }
    }
    out
}

#[test]
fn two_bodies_in_contact_extruded_are_those_of_the_plane() {
    Two::all(Integration::Merged).for_each(|two| two.compare());
}

/// Points of the slave for the gap, of the master for its forces: those of the plane, times those along the layer; also where the normals of a
/// bent master point beyond the end of the slave, and its points lie on ends of slave elements.
#[test]
fn mixed_and_slave_integration_extruded_are_those_of_the_plane() {
    for rule in [Integration::Mixed, Integration::Slave] {
        Two::all(rule).for_each(|two| two.compare());
    }
}

/// Every pair of points of the plane stands at every Gauss point along the layers, also where several layers end beside an element of the other side.
#[test]
fn points_of_either_side_extruded_are_those_of_the_plane() {
    let order = |a: &[f64; 5], b: &[f64; 5]| (a[2] / SAME).round().total_cmp(&(b[2] / SAME).round()).then(a[4].total_cmp(&b[4]));
    let mut failures = Vec::new();
    for (rule, n) in [Integration::Mixed, Integration::Slave].into_iter().flat_map(|rule| [3, 4, 9].map(|n| (rule, n))) {
        for (two, layers) in Two::all(rule).flat_map(|two| [[1, 1], [3, 2], [3, 4]].map(|layers| (two, layers))) {
            let (mut plane, along) = two.points(n, layers);
            plane.sort_by(order);
            for (k, mut found) in along.into_iter().enumerate() {
                found.sort_by(order);
                let apart = plane.iter().flatten().zip(found.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                if plane.len() != found.len() || apart > SAME {
                    let counts = [plane.len(), found.len()];
                    failures.push(format!("{two:?} {n} points, layers {layers:?}, point {k}: {counts:?}, {apart:e}"));
                    break;
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
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
