//! Curved sides in space held along their normals or their tangents, against the tubes and shells of Lamé.

use crate::bodies::Kind;
use faying::coupling::multiplier::MultiplierError;
use faying::geometry::shapes;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, ErrorKind, Problem};
use faying::space::{Mapping, PatchSpec};
use std::f64::consts::PI;

const YOUNG: f64 = 1.0;
const NU: f64 = 0.3;
/// Inner and outer radius, and the height of tubes.
pub const RADII: [f64; 2] = [1.0, 1.6];
pub const HEIGHT: f64 = 0.5;
pub const PRESSURE: f64 = 0.1;

/// Kinds of bodies, of tubes and of shells, whose octants have a collapsed side that tetrahedra cannot have on an exact map.
pub const BODIES: [(Kind, bool); 5] =
    [(Kind::Nurbs, false), (Kind::Nurbs, true), (Kind::Hexahedra, false), (Kind::Hexahedra, true), (Kind::Tetrahedra, false)];

/// u_r = A r + B / r^m with the pressure inside, m = 1 of tubes in plane strain, 2 of shells; outside free, or u_r = 0.
#[derive(Clone, Copy)]
struct Lame {
    a: f64,
    b: f64,
    is_sphere: bool,
}

impl Lame {
    fn new(is_sphere: bool, in_a_hole: bool) -> Self {
        let power = if is_sphere { 3 } else { 2 };
        let one = Self { a: 0.0, b: 1.0, is_sphere };
        let unit = Self { a: 1.0, b: 0.0, is_sphere };
        let a = if in_a_hole { -1.0 / RADII[1].powi(power) } else { -one.stress(RADII[1]) / unit.stress(RADII[1]) };
        let of_unit = Self { a, b: 1.0, is_sphere };
        let factor = -PRESSURE / of_unit.stress(RADII[0]);
        Self { a: factor * a, b: factor, is_sphere }
    }
    fn displacement(self, r: f64) -> f64 {
        self.a * r + self.b / if self.is_sphere { r * r } else { r }
    }
    /// The radial stress.
    fn stress(self, r: f64) -> f64 {
        if self.is_sphere {
            YOUNG / (1.0 - 2.0 * NU) * self.a - 2.0 * YOUNG / (1.0 + NU) * self.b / r.powi(3)
        } else {
            YOUNG / (1.0 + NU) * (self.a / (1.0 - 2.0 * NU) - self.b / (r * r))
        }
    }
}

/// A quarter of a tube, or an eighth of a shell, with `n` elements in all directions, and its flat sides, its inner and its outer one.
pub fn body(
    p: &mut Problem<2, 3>,
    kind: Kind,
    is_sphere: bool,
    degree: usize,
    n: usize,
) -> (BodyId, &'static [&'static str], [&'static str; 2]) {
    let (net, elements) = match is_sphere {
        true => (shapes::sphere_octant([0.0; 3], RADII).unwrap(), [n, n, n]),
        false => (shapes::annulus_sector([0.0; 2], [RADII[1], RADII[0]], [0.0, 90.0]).unwrap().extrude(HEIGHT), [n, n, 1]),
    };
    let spec = PatchSpec::new(net).with_degree([degree; 3]).with_elements(elements).with_mapping(Mapping::Exact);
    let id = kind.add(p, "body", kind.body(&spec), Hooke::solid(YOUNG, NU).unwrap());
    if is_sphere { (id, &["u0", "u1", "v0"], ["w0", "w1"]) } else { (id, &["u0", "u1", "w0", "w1"], ["v1", "v0"]) }
}

/// Largest error of the displacement over its largest value, error of the radial stress over the pressure in the middle of the wall, and the
/// reaction of the outer side.
fn solved(kind: Kind, is_sphere: bool, in_a_hole: bool, degree: usize, n: usize) -> ([f64; 2], Vec<f64>) {
    let mut p = Problem::<2, 3>::new();
    let (id, planes, [inner, outer]) = body(&mut p, kind, is_sphere, degree, n);
    for side in planes {
        p.fix_normal(id.side(side)).unwrap();
    }
    if in_a_hole {
        p.fix_normal(id.side(outer)).unwrap();
    } else {
        p.fix_tangential(id.side(outer)).unwrap();
    }
    p.pressure(id.side(inner), PRESSURE).unwrap();
    let what = format!("{kind:?}, sphere {is_sphere}, hole {in_a_hole}, degree {degree}");
    let s = p.assemble().unwrap_or_else(|e| panic!("{what}: {e}")).solve(1.0, None).unwrap();
    let balance = s.balance();
    // Lagrange functions on an exact map do not hold rotations
    let moment = balance.moment.iter().filter(|_| kind == Kind::Nurbs);
    assert!(balance.force.iter().chain(moment).all(|f| f.abs() < 1e-10), "{what}: {balance:?}");
    let exact = Lame::new(is_sphere, in_a_hole);
    let direction = if is_sphere { Vector::<3>::new(0.6, 0.48, 0.64) } else { Vector::<3>::new(0.6, 0.8, 0.0) };
    let (mut of_u, mut of_stress) = (0.0_f64, 0.0_f64);
    for r in [1.02, 1.3, 1.55] {
        let x = direction * r + if is_sphere { Vector::zeros() } else { Vector::<3>::z() * 0.2 };
        let at = s.at(id, &x.into()).unwrap();
        of_u = of_u.max((Vector::<3>::from(at.u) - direction * exact.displacement(r)).norm() / exact.displacement(1.0));
        let [xx, yy, zz, xy, yz, xz]: [f64; 6] = at.stress[..6].try_into().unwrap();
        let d = direction;
        let radial =
            xx * d[0] * d[0] + yy * d[1] * d[1] + zz * d[2] * d[2] + 2.0 * (xy * d[0] * d[1] + yz * d[1] * d[2] + xz * d[0] * d[2]);
        of_stress = of_stress.max((radial - exact.stress(r)).abs() / PRESSURE);
    }
    ([of_u, of_stress], s.reaction(id.side(outer)).unwrap())
}

#[test]
fn tubes_and_shells_in_a_rigid_hole_are_those_of_lame() {
    for (kind, is_sphere) in BODIES {
        let exact = Lame::new(is_sphere, true);
        let (coarse, _) = solved(kind, is_sphere, true, 2, 2);
        let (fine, force) = solved(kind, is_sphere, true, 2, 4);
        let area = if is_sphere { PI / 4.0 * RADII[1].powi(2) } else { HEIGHT * RADII[1] };
        let wanted = exact.stress(RADII[1]) * area;
        let axes = if is_sphere { 3 } else { 2 };
        let off = (0..axes).map(|k| (force[k] / wanted - 1.0).abs()).fold(0.0, f64::max);
        println!("{kind:?}, sphere {is_sphere}: {coarse:?} {fine:?}, force off by {off:e}");
        assert!(fine[0] < 2e-3 && fine[1] < 2e-2 && off < 2e-3, "{kind:?}, sphere {is_sphere}: {fine:?} {off:e}");
        assert!(fine[0] < 0.3 * coarse[0] && fine[1] < 0.6 * coarse[1], "{kind:?}, sphere {is_sphere}: {coarse:?} {fine:?}");
    }
}

#[test]
fn tangents_of_tubes_and_shells_leave_their_radius_free() {
    for (kind, is_sphere) in BODIES {
        let (coarse, _) = solved(kind, is_sphere, false, 2, 2);
        let (fine, force) = solved(kind, is_sphere, false, 2, 4);
        let most = force.iter().fold(0.0_f64, |m, f| m.max(f.abs())) / PRESSURE;
        println!("{kind:?}, sphere {is_sphere}: {coarse:?} {fine:?}, force {most:e}");
        assert!(fine[0] < 2e-3 && fine[1] < 2e-2 && most < 2e-2, "{kind:?}, sphere {is_sphere}: {fine:?} {most:e}");
        assert!(fine[0] < 0.3 * coarse[0] && fine[1] < 0.6 * coarse[1], "{kind:?}, sphere {is_sphere}: {coarse:?} {fine:?}");
    }
}

/// A tube in a rigid hole can turn and move along its axis; held along its tangents it cannot move.
#[test]
fn what_curved_sides_leave_to_a_tube() {
    let motions = |along_normal: bool| {
        let mut p = Problem::<2, 3>::new();
        let (id, _, [_, outer]) = body(&mut p, Kind::Nurbs, false, 2, 2);
        if along_normal {
            p.fix_normal(id.side(outer)).unwrap()
        } else {
            p.fix_tangential(id.side(outer)).unwrap()
        };
        p.assemble().err().map_or(Vec::new(), |e| e.0.into_iter().map(|e| e.kind).collect::<Vec<_>>())
    };
    let free = motions(true);
    let [ErrorKind::Motions(list)] = &free[..] else { panic!("{free:?}") };
    assert!(list[0].contains("translation z") && list[0].contains("rotation"), "{list:?}");
    assert_eq!(motions(false), []);
}

/// One element of degree 1 along the axis, held at both of its ends, has no degree left.
#[test]
fn a_surface_of_too_few_elements_is_refused() {
    let mut p = Problem::<2, 3>::new();
    let (id, planes, [_, outer]) = body(&mut p, Kind::Hexahedra, false, 1, 4);
    for side in planes {
        p.fix_normal(id.side(side)).unwrap();
    }
    p.fix_tangential(id.side(outer)).unwrap();
    let errors = p.assemble().unwrap_err().0;
    assert!(matches!(errors[0].kind, ErrorKind::Slide(MultiplierError::NothingLeftAtEdge { .. })), "{errors:?}");
    let mut q = Problem::<2, 3>::new();
    let (id, _, [_, outer]) = body(&mut q, Kind::Hexahedra, false, 2, 2);
    q.fix(id.side(outer), Components::Z).unwrap();
    q.fix_normal(id.side(outer)).unwrap();
    assert_eq!(q.assemble().unwrap_err().0[0].kind, ErrorKind::SlideBeside);
}
