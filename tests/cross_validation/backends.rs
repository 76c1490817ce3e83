//! Twins: C^0 B-splines of degree p on the exact map span the same space as Lagrange functions of degree p on it.
//!
//! So every problem has the same discrete solution on both backends: displacement to 1e-10, tied to 1e-9, in contact to
//! 1e-8 with equal active sets, all relative. The multipliers are the same splines on both sides: equal coefficients.

use crate::choices::{Choices, Discretisation};
use crate::exact::{Expr, Solved, conductor};
use crate::setting::{Setting, Shape};
use faying::contact::{HalfPlane, Sphere};
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::ControlNet;
use faying::geometry::shapes::{annulus_sector, brick, plate_with_hole, rectangle, sphere_octant};
use faying::linalg::Vector;
use faying::physics::{Hooke, Material};
use faying::problem::{Components, ContactId, Data, Exact, InterfaceId, InterfaceSide, Opponent, Solution, Value};
use faying::space::{BasisKind, Body, Mapping, Trace};

/// Where bodies are moved to.
const MOVED: [f64; 2] = [5.0, -7.0];

/// The two discretisations of one space.
fn twins(degree: usize) -> [Discretisation; 2] {
    let splines = Discretisation { continuity: Some(0), basis: BasisKind::BSpline, degree, ..Discretisation::default() };
    let elements = Discretisation { mapping: Mapping::Exact, degree, ..Discretisation::fe() };
    [splines, elements]
}

/// The body of a net in a discretisation.
fn shape<const N: usize>(name: &'static str, net: &ControlNet<N, N>, elements: [usize; N], by_default: Discretisation) -> Shape<N> {
    Shape { by_default, ..Shape::new(name, net.clone(), elements) }
}

/// What one twin finds: values in all bodies, coefficients of multipliers, and which of them act.
struct Found {
    values: Vec<f64>,
    multipliers: Vec<f64>,
    active: Vec<bool>,
}

/// Values at points inside every element, body after body.
fn values<const S: usize, const N: usize>(setting: &Setting<S, N>, solution: &Solution<S, N>) -> Vec<f64> {
    const INSIDE: [[f64; 3]; 4] = [[0.1, 0.2, 0.6], [0.5, 0.5, 0.5], [0.9, 0.3, 0.2], [0.35, 0.85, 0.9]];
    let xi: [[f64; N]; 4] = INSIDE.map(|x| std::array::from_fn(|k| x[k]));
    let mut all = Vec::new();
    for body in &setting.bodies {
        for element in 0..body.body.space().num_elements() {
            let states = solution.in_element(body.id, element, &xi).unwrap();
            all.extend(states.iter().flat_map(|s| s.u[..body.components].to_vec()));
        }
    }
    all
}

fn found<const S: usize, const N: usize>(setting: &Setting<S, N>, solution: &Solution<S, N>, of: Option<InterfaceId>) -> Found {
    let multipliers = of.map_or_else(Vec::new, |of| solution.multiplier(of).unwrap());
    // rows that are open have no multiplier
    let active: Vec<bool> = multipliers.iter().map(|l| *l != 0.0).collect();
    if let Some(InterfaceId::Contact(contact)) = of {
        let count = active.iter().filter(|closed| **closed).count();
        assert_eq!(count, solution.contact(contact).unwrap().active, "closed rows");
    }
    Found { values: values(setting, solution), multipliers, active }
}

/// Largest difference relative to the largest value.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / scale
}

/// Compares what both twins found.
fn compare(what: &str, [a, b]: &[Found; 2], tolerance: f64) {
    let d = difference(&a.values, &b.values);
    assert!(d <= tolerance, "{what}: displacements differ by {d:e}");
    assert_eq!(a.active, b.active, "{what}: active sets differ");
    if !a.multipliers.is_empty() {
        let d = difference(&a.multipliers, &b.multipliers);
        assert!(d <= tolerance, "{what}: multipliers differ by {d:e}");
    }
}

/// Solves a problem of one body with an exact solution on both backends: its values on some sides, its tractions on the others.
fn one_body<const C: usize, const S: usize, const N: usize>(
    what: &str,
    net: &ControlNet<N, N>,
    elements: [usize; N],
    degree: usize,
    material: &(impl Material<C, N> + Clone + 'static),
    exact: &(impl Exact + Clone + 'static),
    [held, loaded]: [&[&str]; 2],
    solve: impl Fn(&Setting<S, N>) -> Solution<S, N>,
) where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let both = twins(degree).map(|twin| {
        let mut s = Setting::<S, N>::new();
        let body = s.shape(&Choices::of(&[]), shape("b", net, elements, twin), material.clone());
        s.exact(exact.clone());
        for c in 0..C {
            for side in held {
                s.problem.prescribe(body.side(side), c, Value::Exact).unwrap();
            }
            for side in loaded {
                s.problem.traction(body.side(side), c, Value::Exact).unwrap();
            }
        }
        let solution = solve(&s);
        found(&s, &solution, None)
    });
    compare(&format!("{what} p={degree}"), &both, 1e-10);
}

#[test]
fn one_body_has_the_same_solution_on_both_backends() {
    let mut pairs = 0;
    let shapes = [
        ("box", rectangle([0.0, 0.0], [1.0, 0.6]).unwrap(), [3, 2]),
        ("ring", annulus_sector([0.0, 0.0], [1.0, 2.0], [10.0, 100.0]).unwrap(), [4, 3]),
        ("plate", plate_with_hole(0.5, 2.0).unwrap(), [4, 3]),
        ("ring, mirrored", annulus_sector([0.0, 0.0], [1.0, 2.0], [100.0, 10.0]).unwrap(), [4, 3]),
        ("ring, moved", annulus_sector(MOVED, [1.0, 2.0], [10.0, 100.0]).unwrap(), [4, 3]),
    ];
    let (sides, solve): ([&[&str]; 2], _) = ([&["u0", "u1", "v1"], &["v0"]], |s: &Setting<1, 2>| crate::cases::solved(&s.problem));
    for p in 1..=4 {
        for (name, net, elements) in &shapes {
            let scalar = Solved(|[x, y, _]: [Expr; 3]| [(x + 2.0 * y).sin()]);
            let k = conductor::<2>(|[x, _, _]| 1.0 + 0.2 * x);
            one_body(&format!("{name}, heat"), net, *elements, p, &k, &scalar, sides, solve);
            let vector = Solved(|[x, y, _]: [Expr; 3]| [(x + 2.0 * y).sin(), x * y.cos()]);
            let steel = Hooke::plane_strain(3.0, 0.3).unwrap();
            one_body(&format!("{name}, elastic"), net, *elements, p, &steel, &vector, sides, solve);
            pairs += 2;
        }
    }
    assert_eq!(pairs, 40);
}

#[test]
fn one_solid_has_the_same_solution_on_both_backends() {
    let mut pairs = 0;
    let shapes = [
        ("box", brick([0.0; 3], [1.0, 0.6, 0.8]).unwrap(), [3, 2, 2]),
        ("ring", annulus_sector([0.0, 0.0], [1.0, 2.0], [10.0, 100.0]).unwrap().extrude(0.7), [4, 2, 2]),
        ("shell", sphere_octant([0.0; 3], [1.0, 2.0]).unwrap(), [2, 2, 2]),
    ];
    let sides: [&[&str]; 2] = [&["u0", "u1", "w1"], &["v0", "w0"]];
    let solve = |s: &Setting<2, 3>| crate::cases::solved_in_space(&s.problem);
    for p in 1..=3 {
        for (name, net, elements) in &shapes {
            let scalar = Solved(|[x, y, z]: [Expr; 3]| [(x + 2.0 * y - z).sin()]);
            let k = conductor::<3>(|[x, _, z]| 1.0 + 0.2 * x * z);
            one_body(&format!("{name}, heat"), net, *elements, p, &k, &scalar, sides, solve);
            let vector = Solved(|[x, y, z]: [Expr; 3]| [(x + 2.0 * y).sin(), x * z.cos(), y * z]);
            one_body(&format!("{name}, elastic"), net, *elements, p, &Hooke::solid(3.0, 0.3).unwrap(), &vector, sides, solve);
            pairs += 2;
        }
    }
    assert_eq!(pairs, 18);
}

#[test]
fn tied_bodies_have_the_same_solution_and_multipliers_on_both_backends() {
    let mut pairs = 0;
    let rings = |angles| [[1.0, 1.5], [1.5, 2.0]].map(|radius| annulus_sector([0.0, 0.0], radius, angles).unwrap());
    let boxes = [[0.0, 0.5], [0.5, 1.0]].map(|[low, high]| rectangle([0.0, low], [1.0, high]).unwrap());
    // supports of u0 and u1
    let shapes = [
        ("boxes", boxes, [Components::Y, Components::X]),
        ("rings", rings([0.0, 90.0]), [Components::Y, Components::X]),
        ("rings, mirrored", rings([90.0, 0.0]), [Components::X, Components::Y]),
        ("rings, moved", rings([0.0, 90.0]).map(|net| net.translate(&MOVED.into())), [Components::Y, Components::X]),
    ];
    let steel = || Hooke::plane_strain(1.0, 0.3).unwrap();
    for p in 1..=4 {
        for lowered in [0, 2] {
            if p == 1 && lowered == 2 {
                continue;
            }
            for (name, [lower, upper], supports) in &shapes {
                let both = twins(p).map(|twin| {
                    let (mut s, none) = (Setting::<1, 2>::new(), Choices::of(&[]));
                    let a = s.shape(&none, shape("a", lower, [5, 3], twin), steel());
                    let b = s.shape(&none, shape("b", upper, [4, 2], twin), steel());
                    for body in [a, b] {
                        s.problem.fix(body.side("u0"), supports[0]).unwrap();
                        s.problem.fix(body.side("u1"), supports[1]).unwrap();
                    }
                    s.problem.pressure(a.side("v0"), Data::of(|x, _| 1.0 + 0.3 * x[0])).unwrap();
                    let tie = s.problem.tie(a.side("v1"), b.side("v0")).unwrap().multiplier(MultiplierKind::Lowered(lowered)).id();
                    let solution = crate::cases::solved(&s.problem);
                    found(&s, &solution, Some(tie.into()))
                });
                assert!(!both[0].multipliers.is_empty());
                compare(&format!("{name} p={p} p/p-{lowered}"), &both, 1e-9);
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 28);
}

/// Compares both backends in contact; `say` adds supports, loads and the contact. A part of the side is open, a part closed.
fn pressed(what: &str, net: &ControlNet<2, 2>, elements: [usize; 2], p: usize, say: impl Fn(&mut Setting<1, 2>) -> ContactId) {
    let both = twins(p).map(|twin| {
        let mut s = Setting::<1, 2>::new();
        s.shape(&Choices::of(&[]), shape("b", net, elements, twin), Hooke::plane_strain(1.0, 0.3).unwrap());
        let contact = say(&mut s);
        let solution = crate::cases::solved(&s.problem);
        found(&s, &solution, Some(contact.into()))
    });
    let active = &both[0].active;
    assert!(active.contains(&true) && active.contains(&false), "{what} p={p}: a part of the side is open, a part closed");
    compare(&format!("{what} p={p}"), &both, 1e-8);
}

#[test]
fn a_disc_on_a_plane_has_the_same_solution_and_active_set_on_both_backends() {
    // as it is, and mirrored in its parameters
    for (angles, [middle, top]) in [([-90.0, 0.0], ["u0", "u1"]), ([0.0, -90.0], ["u1", "u0"])] {
        let net = annulus_sector([0.0, 1.0], [0.3, 1.0], angles).unwrap();
        for p in 1..=4 {
            pressed("plane", &net, [10, 4], p, |s| {
                let body = s.bodies[0].id;
                s.problem.fix(body.side(middle), Components::X).unwrap();
                s.problem.prescribe(body.side(top), 1, -0.02).unwrap();
                let plane = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
                s.problem.contact(body.side("v1"), plane).unwrap().id()
            });
        }
    }
}

#[test]
fn a_circle_pressed_into_a_box_has_the_same_solution_and_active_set_on_both_backends() {
    let net = rectangle([-1.0, -1.0], [1.0, 0.0]).unwrap();
    for p in 1..=4 {
        pressed("circle", &net, [11, 4], p, |s| {
            let body = s.bodies[0].id;
            s.problem.fix(body.side("v0"), Components::All).unwrap();
            let circle = Sphere { center: Vector::from([0.1, 0.97]), radius: 1.0, inside: false };
            s.problem.contact(body.side("v1"), Opponent::from(circle)).unwrap().id()
        });
    }
}
