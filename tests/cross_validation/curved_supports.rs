//! Curved sides held along their normals or their tangents, on both backends, against closed solutions of rings.

use crate::exact::{Expr, Solved};
use faying::assembly::Norms;
use faying::basis::{BSpline, Cell};
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::annulus_sector;
use faying::geometry::{ControlNet, turn};
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, BodyMaterial, BodySpec, Components, Data, ErrorKind, Exact, Problem, Solution};
use faying::space::{Body, Mapping, Mesh, Patch, PatchSpec};
use std::f64::consts::PI;
use std::sync::Arc;

const YOUNG: f64 = 1.0;
const NU: f64 = 0.3;
/// Radii of all rings.
pub const RADII: [f64; 2] = [1.0, 2.0];
const PRESSURE: f64 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Nurbs,
    Quadrilaterals,
    Triangles,
}

pub const KINDS: [Kind; 3] = [Kind::Nurbs, Kind::Quadrilaterals, Kind::Triangles];

impl Kind {
    pub fn body(self, spec: PatchSpec<2>) -> Arc<dyn Body<1, 2>> {
        match self {
            Kind::Nurbs => Arc::new(Patch::try_new(&spec).unwrap()),
            Kind::Quadrilaterals => Arc::new(Mesh::from_patch(&spec.with_mapping(Mapping::Exact)).unwrap()),
            Kind::Triangles => Arc::new(Mesh::from_patch(&spec.with_mapping(Mapping::Exact).with_cells(Cell::Simplex)).unwrap()),
        }
    }

    /// NURBS of a ring have at least degree 2.
    pub fn degrees(self) -> std::ops::RangeInclusive<usize> {
        if self == Kind::Nurbs { 2..=3 } else { 1..=3 }
    }
}

pub fn add(p: &mut Problem<1, 2>, name: &str, body: Arc<dyn Body<1, 2>>) -> BodyId {
    let material = BodyMaterial::of::<2>(Hooke::<2>::plane_strain(YOUNG, NU).unwrap()).unwrap();
    // points enough for the norms of errors
    p.add(BodySpec { extra_points: 3, ..BodySpec::new(name, body, material) }).unwrap()
}

/// The sector of a ring between two angles; u0, u1: its ends, v0, v1: its inner and outer circle.
pub fn sector(p: &mut Problem<1, 2>, name: &str, kind: Kind, degree: usize, angles: [f64; 2], elements: [usize; 2]) -> BodyId {
    let net = annulus_sector([0.0; 2], RADII, angles).unwrap();
    add(p, name, kind.body(PatchSpec::new(net).with_degree([degree; 2]).with_elements(elements)))
}

/// u_r = A r + B / r, u_t = K (r / a² - 1 / r), and its stresses.
#[derive(Clone, Copy)]
struct Ring {
    a: f64,
    b: f64,
    k: f64,
}

impl Ring {
    fn field(self) -> Solved<impl Fn([Expr; 3]) -> [Expr; 2] + Send + Sync + Clone> {
        Solved(move |[x, y, _]: [Expr; 3]| {
            let q = (x * x + y * y).inverse();
            let radial = self.a + self.b * q;
            let around = self.k / RADII[0].powi(2) + -(self.k * q);
            [radial * x - around * y, radial * y + around * x]
        })
    }
    fn radial(self, r: f64) -> f64 {
        self.a * r + self.b / r
    }
    fn radial_stress(self, r: f64) -> f64 {
        YOUNG / (1.0 + NU) * (self.a / (1.0 - 2.0 * NU) - self.b / (r * r))
    }
    fn shear(self, r: f64) -> f64 {
        YOUNG / (1.0 + NU) * self.k / (r * r)
    }
    /// The pressure inside, the outer circle free.
    fn free() -> Self {
        let unit = Ring { a: (1.0 - 2.0 * NU) / RADII[1].powi(2), b: 1.0, k: 0.0 };
        unit.scaled(-PRESSURE / unit.radial_stress(RADII[0]))
    }
    /// The pressure inside, the outer circle in a rigid hole.
    fn in_a_hole() -> Self {
        let unit = Ring { a: -1.0 / RADII[1].powi(2), b: 1.0, k: 0.0 };
        unit.scaled(-PRESSURE / unit.radial_stress(RADII[0]))
    }
    fn scaled(self, factor: f64) -> Self {
        Ring { a: factor * self.a, b: factor * self.b, k: factor * self.k }
    }
}

/// [L2, H1, energy] of the error over all bodies.
fn errors(s: &Solution<1, 2>, exact: &dyn Exact) -> [f64; 3] {
    let all = s.errors(exact).into_iter().map(|e| e.error).reduce(Norms::hypot).unwrap();
    [all.l2, all.h1, all.energy]
}

/// Forces balance; so do moments where the functions hold rotations, which Lagrange functions on an exact map do not.
fn balanced(s: &Solution<1, 2>, kind: Kind, what: &str) {
    let balance = s.balance();
    let moment = balance.moment.iter().filter(|_| kind == Kind::Nurbs);
    assert!(balance.force.iter().chain(moment).all(|f| f.abs() < 1e-11), "{what}: {balance:?}");
}

/// Errors of `solve` by number of elements fall with the degree.
fn orders(what: &str, degree: usize, solve: impl Fn(usize) -> [f64; 3]) {
    let (coarse, fine) = (solve(8), solve(16));
    let orders: [f64; 3] = std::array::from_fn(|k| (coarse[k] / fine[k]).log2());
    println!("{what}, degree {degree}: errors {fine:?}, orders {orders:?}");
    let p = degree as f64;
    assert!(orders[0] > p + 0.8 && orders[1] > p - 0.15 && orders[2] > p - 0.15, "{what}, degree {degree}: {orders:?}");
}

/// A full ring under pressure, of one patch glued to itself or of four: the tangents of one circle alone hold it.
#[test]
fn the_tangents_of_a_circle_hold_a_ring_under_pressure() {
    let exact = Ring::free();
    for kind in KINDS {
        for degree in kind.degrees() {
            for (patches, side) in [(1, "v1"), (4, "v1"), (4, "v0")] {
                let what = format!("{kind:?}, {patches} patches, {side}");
                orders(&what, degree, |n| {
                    let mut p = Problem::<1, 2>::new();
                    let turn = 360.0 / patches as f64;
                    let bodies: Vec<BodyId> = (0..patches)
                        .map(|k| {
                            let angles = [k as f64 * turn, (k + 1) as f64 * turn];
                            sector(&mut p, &format!("b{k}"), kind, degree, angles, [4 * n / patches, n])
                        })
                        .collect();
                    for k in 0..patches {
                        p.glue(bodies[k].side("u1"), bodies[(k + 1) % patches].side("u0"), None).unwrap();
                        p.fix_tangential(bodies[k].side(side)).unwrap();
                        p.pressure(bodies[k].side("v0"), PRESSURE).unwrap();
                    }
                    let s = p.assemble().unwrap_or_else(|e| panic!("{what}: {e}")).solve(1.0, None).unwrap();
                    balanced(&s, kind, &what);
                    // no force holds it
                    let most = bodies.iter().flat_map(|b| s.reaction(b.side(side)).unwrap()).fold(0.0, |m: f64, f| m.max(f.abs()));
                    assert!(most < 2e-2 * PRESSURE / (n as f64).powi(degree as i32 - 1), "{what}: {most:e}");
                    let at = s.at(bodies[0], &[1.5 * 0.8, 1.5 * 0.6]).unwrap();
                    let (u, found) = (exact.radial(1.5), Vector::<2>::new(at.u[0], at.u[1]));
                    let off = (found - Vector::<2>::new(0.8 * u, 0.6 * u)).norm() / u;
                    assert!(off < 2.0 / (n as f64).powi(degree as i32 + 1), "{what}: {off:e}");
                    errors(&s, &exact.field())
                });
            }
        }
    }
}

/// A quarter, half or all of a ring in a rigid hole without friction; a quarter of two tied parts, and one that is held on half of its arc and
/// loaded by the hole's pressure on the other.
#[test]
fn the_normals_of_a_circle_are_a_rigid_hole() {
    let (exact, [_, outer]) = (Ring::in_a_hole(), RADII);
    for kind in KINDS {
        for degree in kind.degrees() {
            for angle in [90.0, 180.0] {
                let what = format!("{kind:?}, {angle} degrees");
                orders(&what, degree, |n| {
                    let mut p = Problem::<1, 2>::new();
                    let ring = sector(&mut p, "ring", kind, degree, [0.0, angle], [n * angle as usize / 90, n]);
                    p.fix(ring.side("u0"), Components::Y).unwrap();
                    p.fix(ring.side("u1"), if angle == 90.0 { Components::X } else { Components::Y }).unwrap();
                    p.fix_normal(ring.side("v1")).unwrap();
                    p.pressure(ring.side("v0"), PRESSURE).unwrap();
                    let s = p.assemble().unwrap_or_else(|e| panic!("{what}: {e}")).solve(1.0, None).unwrap();
                    balanced(&s, kind, &what);
                    // ∫ sigma_r n ds over the arc
                    let wanted = exact.radial_stress(outer) * outer;
                    let wanted = if angle == 90.0 { [wanted, wanted] } else { [0.0, 2.0 * wanted] };
                    let found = s.reaction(ring.side("v1")).unwrap();
                    let off = (0..2).map(|k| (found[k] - wanted[k]).abs()).fold(0.0, f64::max) / wanted[1].abs();
                    println!("{what}, degree {degree}, n = {n}: reaction off by {off:e}");
                    assert!(off < 4.0 / (n as f64).powi(degree as i32 + 1), "{what}: {found:?}, {wanted:?}");
                    errors(&s, &exact.field())
                });
            }
            orders(&format!("{kind:?}, tied"), degree, |n| {
                let mut p = Problem::<1, 2>::new();
                let a = sector(&mut p, "a", kind, degree, [0.0, 40.0], [n, n]);
                let b = sector(&mut p, "b", kind, degree, [40.0, 90.0], [n + n / 2, n + n / 2]);
                // of the full degree, so that the support decides the order and not the tie
                p.tie(a.side("u1"), b.side("u0")).unwrap().multiplier(MultiplierKind::Lowered(0));
                p.fix(a.side("u0"), Components::Y).unwrap();
                p.fix(b.side("u1"), Components::X).unwrap();
                for body in [a, b] {
                    p.fix_normal(body.side("v1")).unwrap();
                    p.pressure(body.side("v0"), PRESSURE).unwrap();
                }
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                balanced(&s, kind, "tied");
                errors(&s, &exact.field())
            });
            orders(&format!("{kind:?}, held on half"), degree, |n| {
                let mut p = Problem::<1, 2>::new();
                let ring = sector(&mut p, "ring", kind, degree, [0.0, 90.0], [n, n]);
                p.fix(ring.side("u0"), Components::Y).unwrap();
                p.fix(ring.side("u1"), Components::X).unwrap();
                let held = p.part(ring.side("v1"), "y < x", &|x| x[1] < x[0]).unwrap().unwrap();
                let free = p.part(ring.side("v1"), "y > x", &|x| x[1] > x[0]).unwrap().unwrap();
                p.fix_normal(held).unwrap();
                p.pressure(free, -exact.radial_stress(outer)).unwrap();
                p.pressure(ring.side("v0"), PRESSURE).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                balanced(&s, kind, "held on half");
                errors(&s, &exact.field())
            });
        }
    }
}

/// A full ring that is clamped inside and turned by a shear on its outer circle, which stays round.
#[test]
fn a_ring_turns_in_a_rigid_hole() {
    let exact = Ring { a: 0.0, b: 0.0, k: 0.1 };
    let tau = exact.shear(RADII[1]);
    for kind in KINDS {
        for degree in kind.degrees() {
            orders(&format!("{kind:?}, turned"), degree, |n| {
                let mut p = Problem::<1, 2>::new();
                let ring = sector(&mut p, "ring", kind, degree, [0.0, 360.0], [2 * n, n]);
                p.glue(ring.side("u0"), ring.side("u1"), None).unwrap();
                p.fix(ring.side("v0"), Components::All).unwrap();
                p.fix_normal(ring.side("v1")).unwrap();
                p.traction(ring.side("v1"), 0, Data::of(move |x, _| -tau * x[1] / x[0].hypot(x[1]))).unwrap();
                p.traction(ring.side("v1"), 1, Data::of(move |x, _| tau * x[0] / x[0].hypot(x[1]))).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                balanced(&s, kind, "turned");
                errors(&s, &exact.field())
            });
        }
    }
}

/// What is left to a ring whose circles are held.
#[test]
fn a_ring_in_a_hole_can_still_turn() {
    for kind in KINDS {
        let whole = |say: &dyn Fn(&mut Problem<1, 2>, BodyId)| {
            let mut p = Problem::<1, 2>::new();
            let ring = sector(&mut p, "ring", kind, 2, [0.0, 360.0], [8, 2]);
            p.glue(ring.side("u0"), ring.side("u1"), None).unwrap();
            say(&mut p, ring);
            p.assemble().err().map_or(Vec::new(), |e| e.0.into_iter().map(|e| e.kind).collect::<Vec<_>>())
        };
        let normals = whole(&|p, ring| {
            p.fix_normal(ring.side("v1")).unwrap();
        });
        assert!(matches!(&normals[..], [ErrorKind::Motions(list)] if list[0].contains("rotation about (0, 0)")), "{kind:?}: {normals:?}");
        let both = whole(&|p, ring| {
            p.fix_normal(ring.side("v1")).unwrap();
            p.fix_normal(ring.side("v0")).unwrap();
        });
        assert!(matches!(&both[..], [ErrorKind::Motions(_)]), "{kind:?}: {both:?}");
        let tangents = whole(&|p, ring| {
            p.fix_tangential(ring.side("v1")).unwrap();
        });
        assert_eq!(tangents, []);
        // each facet is held once
        let twice = whole(&|p, ring| {
            p.fix_normal(ring.side("v1")).unwrap();
            p.fix_tangential(ring.side("v1")).unwrap();
        });
        assert_eq!(twice, [ErrorKind::SlideBeside], "{kind:?}");
        let beside = whole(&|p, ring| {
            p.fix(ring.side("v1"), Components::X).unwrap();
            p.fix_normal(ring.side("v1")).unwrap();
        });
        assert_eq!(beside, [ErrorKind::SlideBeside], "{kind:?}");
    }
}

/// Normals of facets are those of a circle to the order of their degree only.
#[test]
fn facets_that_stand_for_a_circle_are_refused() {
    for cells in [Cell::Tensor, Cell::Simplex] {
        for degree in 1..=3 {
            let mut p = Problem::<1, 2>::new();
            let net = annulus_sector([0.0; 2], RADII, [0.0, 90.0]).unwrap();
            let spec = PatchSpec::new(net).with_degree([degree; 2]).with_elements([4, 2]).with_cells(cells);
            let ring = add(&mut p, "ring", Arc::new(Mesh::from_patch(&spec).unwrap()));
            assert_eq!(p.fix_normal(ring.side("v1")).unwrap_err().kind, ErrorKind::Faceted, "{cells:?}, degree {degree}");
            assert_eq!(p.fix_tangential(ring.side("v0")).unwrap_err().kind, ErrorKind::Faceted, "{cells:?}, degree {degree}");
            p.fix_normal(ring.side("u0")).unwrap();
        }
    }
}

/// A turned block on a base that is bent by a millionth slides as on a straight one.
#[test]
fn a_side_that_is_hardly_bent_slides_as_a_straight_one() {
    for along_normal in [true, false] {
        for kind in [Kind::Nurbs, Kind::Quadrilaterals] {
            let solve = |bent: f64| {
                let axis = |degree: usize| BSpline::uniform(degree, 1, 0);
                let points = vec![[0.0, 0.0], [0.5, -bent], [1.0, 0.0], [0.0, 1.0], [0.5, 1.0], [1.0, 1.0]];
                let net = ControlNet::try_new([axis(2), axis(1)], points.into_iter().map(Vector::<2>::from).collect(), None).unwrap();
                let mut p = Problem::<1, 2>::new();
                let a = add(&mut p, "a", kind.body(PatchSpec::new(net.rotate(&turn(30.0))).with_degree([2; 2]).with_elements([3, 3])));
                if along_normal {
                    p.fix_normal(a.side("v0")).unwrap();
                } else {
                    p.fix_tangential(a.side("v0")).unwrap();
                }
                // the upper side: the ends of the lower one are free in both ways
                p.fix(a.side("v1"), Components::All).unwrap();
                p.traction(a.side("u1"), 0, Data::of(|x, _| 0.1 * x[1])).unwrap();
                p.traction(a.side("u0"), 1, 0.05).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                let mut all = s.coefficients(a).unwrap().to_vec();
                all.extend(s.reaction(a.side("v0")).unwrap());
                all
            };
            let (straight, bent) = (solve(0.0), solve(1e-6));
            let size = straight.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let apart = straight.iter().zip(&bent).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{kind:?}, normal {along_normal}: {apart:e} of {size:e}");
            assert!(apart > 0.0 && apart < 1e-4 * size, "{kind:?}, normal {along_normal}: {apart:e} of {size:e}");
        }
    }
}

/// A body of revolution in a conical, rounded or spherical seat: a sphere of r > 1 under pressure in a rigid shell moves as that of Lamé.
#[test]
fn a_hollow_sphere_of_revolution_in_a_rigid_shell_is_that_of_lame() {
    // u = B (1 / r² - r / b³), sigma_r = E / (1 - 2 nu) A - 2 E / (1 + nu) B / r³
    let [inner, outer] = RADII;
    let stress = |b: f64, r: f64| -YOUNG / (1.0 - 2.0 * NU) * b / outer.powi(3) - 2.0 * YOUNG / (1.0 + NU) * b / r.powi(3);
    let b = -PRESSURE / stress(1.0, inner);
    let displacement = |r: f64| b / (r * r) - b * r / outer.powi(3);
    for kind in [Kind::Nurbs, Kind::Quadrilaterals] {
        for degree in 2..=3 {
            let solve = |n: usize| {
                let mut p = Problem::axisymmetric();
                let net = annulus_sector([0.0; 2], RADII, [0.0, 90.0]).unwrap();
                let body = kind.body(PatchSpec::new(net).with_degree([degree; 2]).with_elements([n, n]));
                let material = BodyMaterial::of::<2>(Hooke::axisymmetric(YOUNG, NU).unwrap()).unwrap();
                let a = p.add(BodySpec { extra_points: 2, ..BodySpec::new("shell", body, material) }).unwrap();
                p.fix(a.side("u0"), Components::Y).unwrap();
                p.fix_normal(a.side("v1")).unwrap();
                p.pressure(a.side("v0"), PRESSURE).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                balanced(&s, kind, "revolved");
                let wanted = stress(b, outer) * PI * outer * outer;
                let force = (s.reaction(a.side("v1")).unwrap()[1] / wanted - 1.0).abs();
                let at = [1.0, 1.3, 1.7].map(|r| {
                    let x = [0.6 * r, 0.8 * r];
                    let u = s.at(a, &x).unwrap().u;
                    (u[0] - 0.6 * displacement(r)).hypot(u[1] - 0.8 * displacement(r)) / displacement(inner)
                });
                [force, at.into_iter().fold(0.0, f64::max)]
            };
            let (coarse, fine) = (solve(4), solve(8));
            println!("{kind:?}, degree {degree}: {coarse:?} {fine:?}");
            let p = degree as i32;
            assert!(fine[0] < 0.2 / 8f64.powi(p + 1) && fine[1] < 1.0 / 8f64.powi(p + 1), "{kind:?}, degree {degree}: {fine:?}");
            assert!(fine.iter().zip(&coarse).all(|(f, c)| f < c));
        }
    }
}
