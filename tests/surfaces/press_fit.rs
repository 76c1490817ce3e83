//! Press fits of concentric tubes and shells of two materials against the formulas of Lamé.

use crate::bodies::{Kind, Solid};
use faying::geometry::shapes;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, ContactId, Data, Problem, Solution};
use faying::space::PatchSpec;

/// Inner, middle and outer radius.
const RADII: [f64; 3] = [0.6, 1.0, 1.5];
const YOUNG: [f64; 2] = [1.0, 2.0];
const POISSON: [f64; 2] = [0.3, 0.25];
/// The inner body is larger at the middle radius than the hole of the outer one by this; all is linear in it. Facets leave the circle by up to
/// 2e-5, which is a gap.
const INTERFERENCE: f64 = 0.05;

/// Radial displacement at radius `r` under the pressure 1 at the middle one, of the inner or the outer body: spheres, or tubes in plane strain.
///
/// Tubes: u = A r + B / r with sigma_r = E / (1 + nu) (A / (1 - 2 nu) - B / r²);
/// spheres: u = A r + B / r² with sigma_r = E / (1 - 2 nu) A - 2 E / (1 + nu) B / r³.
fn displacement(body: usize, is_sphere: bool, r: f64) -> f64 {
    let (young, poisson) = (YOUNG[body], POISSON[body]);
    let (free, middle) = (RADII[2 * body], RADII[1]);
    let power = if is_sphere { 3 } else { 2 };
    let (of_a, of_b) = match is_sphere {
        true => (young / (1.0 - 2.0 * poisson), 2.0 * young / (1.0 + poisson)),
        false => (young / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (1.0 + poisson)),
    };
    // sigma_r is zero at the free radius and -1 at the middle one
    let b = 1.0 / (of_b * (1.0 / middle.powi(power) - 1.0 / free.powi(power)));
    let a = of_b * b / (of_a * free.powi(power));
    a * r + b / r.powi(power - 1)
}

/// That at the middle radius.
fn compliance(body: usize, is_sphere: bool) -> f64 {
    displacement(body, is_sphere, RADII[1])
}

/// The pressure that takes the interference.
fn pressure(is_sphere: bool) -> f64 {
    INTERFERENCE / (compliance(1, is_sphere) - compliance(0, is_sphere))
}

#[test]
fn the_formulas_hold_the_equations_of_thin_and_solid_bodies() {
    // a thick ring without hole is the textbook's disc: u = -p r (1 + nu) (1 - 2 nu) / E of a solid cylinder
    let solid = |body: usize| (1.0 + POISSON[body]) * (1.0 - 2.0 * POISSON[body]) / YOUNG[body];
    assert!(compliance(0, false) < -solid(0) && compliance(1, false) > 0.0);
    // an infinite body around a spherical hole: u = p r (1 + nu) / (2 E) is less than that of a shell
    assert!(compliance(1, true) > (1.0 + POISSON[1]) / (2.0 * YOUNG[1]) && compliance(0, true) < 0.0);
    // the textbook's formula of tubes, E' = E / (1 - nu²), nu' = nu / (1 - nu)
    for body in 0..2 {
        let (young, poisson) = (YOUNG[body] / (1.0 - POISSON[body].powi(2)), POISSON[body] / (1.0 - POISSON[body]));
        let (b, c) = (RADII[1].powi(2), RADII[2 * body].powi(2));
        let wanted = if body == 1 { ((c + b) / (c - b) + poisson) / young } else { -((b + c) / (b - c) - poisson) / young };
        assert!((compliance(body, false) / wanted - 1.0).abs() < 1e-14, "{body}");
    }
}

/// A quarter of a tube, or an eighth of a shell; elements around, along (of a shell towards the pole), and through.
fn body(kind: Kind, number: usize, is_sphere: bool, elements: [usize; 3]) -> Solid {
    let radii = [RADII[number], RADII[number + 1]];
    if is_sphere {
        let net = shapes::sphere_octant([0.0; 3], radii).unwrap();
        return kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements(elements));
    }
    let [around, along, through] = elements;
    // counter-clockwise with growing radius is left-handed in the plane
    let net = shapes::annulus_sector([0.0; 2], [radii[1], radii[0]], [0.0, 90.0]).unwrap().extrude(0.5);
    kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements([around, through, along]))
}

fn fitted(kinds: [Kind; 2], is_sphere: bool, swapped: bool) -> (Solution<2, 3>, [BodyId; 2], ContactId) {
    let elements = [[6, 5, 2], [8, 7, 3]];
    let mut p = Problem::<2, 3>::new();
    let bodies: [BodyId; 2] = std::array::from_fn(|b| {
        let body = body(kinds[b], b, is_sphere, elements[b]);
        let material = Hooke::solid(YOUNG[b], POISSON[b]).unwrap();
        let body = kinds[b].add(&mut p, ["inner", "outer"][b], body, material);
        let planes: &[&str] = if is_sphere { &["u0", "u1", "v0"] } else { &["u0", "u1", "w0", "w1"] };
        planes.iter().for_each(|side| {
            p.fix_normal(body.side(side)).unwrap();
        });
        body
    });
    // v falls with the radius in tubes, w grows with it in shells
    let [from_in, from_out] = if is_sphere { ["w1", "w0"] } else { ["v0", "v1"] };
    let mut sides = [bodies[1].side(from_out), bodies[0].side(from_in)];
    if swapped {
        sides.reverse();
    }
    let contact = p.contact(sides[0], sides[1]).unwrap().gap(Data::of_gap(|_, _, g| g - INTERFERENCE)).id();
    let mut system = p.assemble().unwrap_or_else(|e| panic!("{kinds:?} sphere {is_sphere} swapped {swapped}: {e}"));
    (system.solve(0.0, None).unwrap(), bodies, contact)
}

/// Force and pressures of the interface, and displacements at radii.
fn check(kinds: [Kind; 2], is_sphere: bool, swapped: bool) {
    let what = format!("{kinds:?}, sphere {is_sphere}, swapped {swapped}");
    let (solution, bodies, contact) = fitted(kinds, is_sphere, swapped);
    let (result, wanted) = (solution.contact(contact).unwrap(), pressure(is_sphere));
    // the sum of n p over a quarter of a cylinder, and over an octant
    let [per_axis, area] = if is_sphere {
        let quarter = std::f64::consts::PI / 4.0;
        [quarter, 2.0 * quarter]
    } else {
        [0.5, 0.25 * std::f64::consts::PI]
    };
    let sign = if swapped { -1.0 } else { 1.0 };
    let square = if is_sphere { RADII[1].powi(2) } else { RADII[1] };
    let force = Vector::<3>::new(1.0, 1.0, if is_sphere { 1.0 } else { 0.0 }) * (sign * wanted * per_axis * square);
    let mut errors = vec![
        ("force", (result.force - force).norm() / force.norm()),
        ("area", (result.area / (area * square) - 1.0).abs()),
        ("mean", (result.force.norm() / force.norm() - 1.0).abs()),
        ("largest", (result.largest_pressure / wanted - 1.0).abs()),
        ("least", (result.least_pressure / wanted - 1.0).abs()),
    ];
    let direction = if is_sphere { Vector::<3>::new(0.6, 0.48, 0.64) } else { Vector::<3>::new(0.6, 0.8, 0.0) };
    for b in 0..2 {
        let r = [0.97, 1.03][b] * RADII[1];
        let x = direction * r + if is_sphere { Vector::zeros() } else { Vector::<3>::z() * 0.2 };
        let u = Vector::<3>::from(solution.at(bodies[b], &x.into()).unwrap().u);
        let exact = direction * (displacement(b, is_sphere, r) * wanted);
        errors.push((["u inner", "u outer"][b], (u - exact).norm() / exact.norm()));
    }
    println!("{what}: {errors:?}");
    assert!(result.balance < 1e-12, "{what}: {:e}", result.balance);
    // the gaps of facets, of either side, are waves of the pressure at points
    let at_points = if kinds == [Kind::Nurbs; 2] { 1e-3 } else { 1e-2 };
    let bound = |name: &str| if ["largest", "least"].contains(&name) { at_points } else { 1e-3 };
    assert!(errors.iter().all(|(name, error)| *error < bound(name)), "{what}: {errors:?}");
}

#[test]
fn tubes_pressed_into_each_other_are_those_of_lame() {
    for kinds in [[Kind::Nurbs; 2], [Kind::Hexahedra; 2], [Kind::Nurbs, Kind::Hexahedra]] {
        for swapped in [false, true] {
            check(kinds, false, swapped);
        }
    }
}

/// Octants whose sides end in one pole, which is no function's place of its own.
#[test]
fn shells_pressed_into_each_other_are_those_of_lame() {
    for swapped in [false, true] {
        check([Kind::Nurbs; 2], true, swapped);
    }
}
