//! Obstacles in space: moved, pressed by a force, said in two ways, and several slave sides on one of them.

use crate::bodies::{KINDS, Kind, steel};
use faying::contact::{Cylinder, FacingSurface, HalfPlane, LevelSet, Obstacle, Sphere, Torus, body_outline};
use faying::geometry::{ControlNet, shapes, turn_about};
use faying::linalg::{Matrix, Vector};
use faying::problem::{Components, ContactId, Data, ErrorKind, InterfaceError, Opponent, Problem, Solution};
use faying::space::{Body, Patch, PatchSpec};
use std::sync::Arc;

type Shape = Arc<dyn Obstacle<2, 3>>;

/// Obstacles below [0, 1] x [0, 1] whose tops are near the origin of z.
fn shapes_below() -> Vec<(&'static str, Shape)> {
    let v = |x, y, z| Vector::<3>::new(x, y, z);
    let bump = |x: &Vector<3>| {
        let (dx, dy) = (x[0] - 0.5, x[1] - 0.45);
        (x[2] + 0.2 * dx * dx + 0.3 * dy * dy, Vector::<3>::new(0.4 * dx, 0.6 * dy, 1.0))
    };
    vec![
        ("half-plane", Arc::new(HalfPlane::try_new(v(0.5, 0.5, 0.0), v(0.02, -0.01, 1.0)).unwrap())),
        ("sphere", Arc::new(Sphere::<3> { center: v(0.45, 0.5, -2.0), radius: 2.0, inside: false })),
        ("cylinder", Arc::new(Cylinder::try_new(v(0.5, 0.4, -1.5), v(1.0, 0.3, 0.0), 1.5).unwrap())),
        ("torus", Arc::new(Torus::try_new(v(0.5, -1.1, -0.8), v(0.0, 0.0, 1.0), 1.6, 0.8).unwrap())),
        ("level set", Arc::new(LevelSet::new(bump))),
        ("box", Arc::new(boundary(&shapes::brick([-0.4, -0.3, -1.0], [1.3, 1.2, 0.0]).unwrap()))),
        (
            "solid",
            Arc::new(boundary(&shapes::sphere_octant([0.0; 3], [1.5, 2.0]).unwrap().rotate(&corner_up()).translate(&v(0.45, 0.5, -2.0)))),
        ),
    ]
}

/// The boundary of a solid of one element.
fn boundary(net: &ControlNet<3, 3>) -> FacingSurface {
    let body = Patch::<2, 3>::try_new(&PatchSpec::new(net.clone())).unwrap();
    FacingSurface::of_pieces(body_outline(&body, body.sides()).unwrap())
}

/// A turn that brings the diagonal of the first octant to the z axis.
fn corner_up() -> Matrix<3, 3> {
    let (diagonal, up) = (Vector::<3>::repeat(1.0).normalize(), Vector::<3>::z());
    turn_about(&diagonal.cross(&up), diagonal.dot(&up).acos().to_degrees()).unwrap()
}

#[test]
fn cylinders_and_tori_keep_the_rules_of_obstacles() {
    let v = |x, y, z| Vector::<3>::new(x, y, z);
    let points = |scale: f64, step: f64| -> Vec<Vector<3>> {
        (0..80).map(|i| Vector::from_fn(|k, _| scale * (step * f64::from(i) + 2.2 * k as f64).sin())).collect()
    };
    let cylinder = Cylinder::try_new(v(0.1, 0.2, 0.0), v(0.2, -0.3, 1.0), 0.8).unwrap();
    faying::check::obstacle::<2, 3, f64>(&cylinder, &points(2.5, 1.3), 1e-12).unwrap();
    let torus = Torus::try_new(v(0.1, -0.2, 0.3), v(0.3, 0.1, 1.0), 1.5, 0.4).unwrap();
    faying::check::obstacle::<2, 3, f64>(&torus, &points(2.2, 1.7), 1e-12).unwrap();
}

/// A block with its top held, its bottom at `z`, above an obstacle that is moved by `by`.
fn block_on(kind: Kind, obstacle: &Shape, z: f64, by: f64) -> (Solution<2, 3>, ContactId) {
    let net = shapes::brick([0.0, 0.0, z], [1.0, 1.0, z + 0.5]).unwrap();
    let body = kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements([4, 4, 2]));
    let mut p = Problem::<2, 3>::new();
    let block = kind.add(&mut p, "block", body, steel());
    p.fix(block.side("w1"), Components::All).unwrap();
    let contact = p.contact(block.side("w0"), Opponent::Obstacle(obstacle.clone())).unwrap();
    if by != 0.0 {
        contact.moved(2, by);
    }
    let contact = contact.id();
    (p.assemble().unwrap().solve(0.0, None).unwrap(), contact)
}

#[test]
fn a_moved_obstacle_is_the_body_moved_the_other_way() {
    for kind in KINDS {
        for (name, obstacle) in shapes_below() {
            let [(a, id), (b, other)] = [block_on(kind, &obstacle, 0.0, 0.02), block_on(kind, &obstacle, -0.02, 0.0)];
            let (found, wanted) = (a.contact(id).unwrap(), b.contact(other).unwrap());
            assert!(wanted.force[2] > 0.0 && wanted.active > 0, "{kind:?} {name}");
            assert!((found.force - wanted.force).norm() < 1e-11 * wanted.force.norm(), "{kind:?} {name}");
            let (one, two) = (a.multiplier(id).unwrap(), b.multiplier(other).unwrap());
            let apart = one.iter().zip(&two).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-10 * wanted.largest_pressure, "{kind:?} {name}: {apart:e}");
            assert_eq!(found.displacement.unwrap(), Vector::<3>::new(0.0, 0.0, 0.02));
            // what the obstacle does and what the supports do are in balance
            let net = Vector::<3>::from(a.balance().force);
            assert!(net.norm() < 1e-12 * found.force.norm(), "{kind:?} {name}: {net:?}");
        }
    }
}

/// A sphere, and the level sets of its distance and of its square.
#[test]
fn a_sphere_is_its_level_sets() {
    let center = Vector::<3>::new(0.45, 0.5, -2.0);
    let sphere: Shape = Arc::new(Sphere::<3> { center, radius: 2.0, inside: false });
    let distance: Shape = Arc::new(LevelSet::new(move |x: &Vector<3>| {
        let d = x - center;
        (d.norm() - 2.0, d / d.norm())
    }));
    let square: Shape = Arc::new(LevelSet::new(move |x: &Vector<3>| {
        let d = x - center;
        (d.norm_squared() - 4.0, d * 2.0)
    }));
    let (wanted, id) = block_on(Kind::Spline, &sphere, -0.02, 0.0);
    let largest = wanted.contact(id).unwrap().largest_pressure;
    for other in [distance, square] {
        let (found, other) = block_on(Kind::Spline, &other, -0.02, 0.0);
        let pairs = found.multiplier(other).unwrap().into_iter().zip(wanted.multiplier(id).unwrap());
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9 * largest, "{apart:e}");
    }
}

#[test]
fn an_obstacle_pressed_by_a_force_transmits_it() {
    for kind in KINDS {
        for (name, obstacle) in shapes_below() {
            let mut p = Problem::<2, 3>::new();
            let body = kind.turned_box(([0.0; 3], [1.0, 1.0, 0.5]), &Matrix::identity(), 2, [4, 4, 2]);
            let block = kind.add(&mut p, "block", body, steel());
            p.fix(block.side("w1"), Components::All).unwrap();
            let contact = p.contact(block.side("w0"), Opponent::Obstacle(obstacle)).unwrap().pressed(2, 3e-3).id();
            let solution = p.assemble().unwrap().solve(0.0, None).unwrap_or_else(|e| panic!("{kind:?} {name}: {e}"));
            let found = solution.contact(contact).unwrap();
            assert!((found.force[2] - 3e-3).abs() < 1e-11 * 3e-3, "{kind:?} {name}: {}", found.force[2]);
            let reaction = solution.reaction(block.side("w1")).unwrap();
            assert!((reaction[2] + 3e-3).abs() < 1e-11 * 3e-3, "{kind:?} {name}: {reaction:?}");
        }
    }
}

/// Two blocks side by side on one plane, their sides in one list: the force is that of both.
#[test]
fn a_list_of_slave_sides_presses_on_one_obstacle() {
    let mut p = Problem::<2, 3>::new();
    let one = |p: &mut Problem<2, 3>, kind: Kind, name: &str, x: f64| {
        let net = shapes::brick([x, 0.0, 0.0], [x + 1.0, 1.0, 0.5]).unwrap();
        let body = kind.add(p, name, kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements([3, 2, 2])), steel());
        for side in ["u0", "v0"] {
            p.fix_normal(body.side(side)).unwrap();
        }
        p.pressure(body.side("w1"), 1e-3).unwrap();
        body
    };
    let (a, b) = (one(&mut p, Kind::Spline, "a", 0.0), one(&mut p, Kind::Tetrahedra, "b", 2.0));
    let plane = HalfPlane::try_new(Vector::<3>::zeros(), Vector::<3>::z()).unwrap();
    let contact = p.contact([a.side("w0"), b.side("w0")], plane).unwrap().id();
    let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
    let found = solution.contact(contact).unwrap();
    assert!((found.force[2] - 2e-3).abs() < 1e-14 && (found.area - 2.0).abs() < 1e-12);
    assert!((found.least_pressure - 1e-3).abs() < 1e-14 && (found.largest_pressure - 1e-3).abs() < 1e-14);
}

/// The gap of a formula: a press fit of 1e-3 between a block whose top is held and a plane that touches it.
#[test]
fn a_formula_of_the_gap_and_steps_of_time_move_the_plane() {
    let mut p = Problem::<2, 3>::new();
    let body = Kind::Hexahedra.turned_box(([0.0; 3], [1.0, 1.0, 0.5]), &Matrix::identity(), 1, [2, 2, 2]);
    let block = Kind::Hexahedra.add(&mut p, "block", body, faying::physics::Hooke::solid(1.0, 0.0).unwrap());
    p.fix(block.side("w1"), Components::All).unwrap();
    let plane = HalfPlane::try_new(Vector::<3>::zeros(), Vector::<3>::z()).unwrap();
    let contact = p.contact(block.side("w0"), plane).unwrap().gap(Data::of_gap(|_, t, g| g - 1e-3 * t)).id();
    p.times(&[0.5, 1.0]);
    let mut system = p.assemble().unwrap();
    let mut before = None;
    for t in [0.5, 1.0] {
        let solution = system.solve(t, before.as_ref()).unwrap();
        let found = solution.contact(contact).unwrap();
        // nu = 0: the pressure is E times the shortening over the height
        assert!((found.largest_pressure - 2e-3 * t).abs() < 1e-14 && (found.force[2] - 2e-3 * t).abs() < 1e-14, "{t}: {found:?}");
        before = Some(solution);
    }
}

/// Points beyond the reach, and those that look past a ball, face nothing.
#[test]
fn reach_and_direction_limit_what_is_faced() {
    let problem = |reach: Option<f64>, center: [f64; 3], radius: f64| {
        let mut p = Problem::<2, 3>::new();
        let body = Kind::Spline.turned_box(([0.0; 3], [1.0, 1.0, 0.5]), &Matrix::identity(), 2, [8, 8, 2]);
        let block = Kind::Spline.add(&mut p, "block", body, steel());
        p.fix(block.side("w1"), Components::All).unwrap();
        let ball = Sphere::<3> { center: Vector::<3>::from(center), radius, inside: false };
        let contact = p.contact(block.side("w0"), ball).unwrap();
        if let Some(reach) = reach {
            contact.reach(reach);
        }
        let contact = contact.moved(2, 0.05).id();
        (p, contact)
    };
    let solved = |p: &Problem<2, 3>, contact| p.assemble().unwrap().solve(0.0, None).unwrap().contact(contact).unwrap();
    // a ball of radius 0.3 below the middle: 60 degrees end at a distance of 0.3 tan 60 from the axis
    let (p, contact) = problem(None, [0.5, 0.5, -0.3], 0.3);
    let small = solved(&p, contact);
    let (p, contact) = problem(Some(0.12), [0.5, 0.5, -0.3], 0.3);
    let near = solved(&p, contact);
    assert!(near.measure < small.measure && near.measure > 0.0, "{} {}", near.measure, small.measure);
    let apart = (near.force - small.force).norm();
    assert!(small.active > 0 && apart < 1e-9 * small.force.norm(), "what is far carries nothing: {apart:e} of {}", small.force);
    let refused = problem(Some(1e-3), [0.5, 0.5, -5.0], 0.3).0.assemble().expect_err("too far").0.remove(0);
    assert!(matches!(refused.kind, ErrorKind::Interface { error: InterfaceError::NothingFaces, .. }), "{refused:?}");
}
