//! What curved sides that slide hold where they meet: each other, their own kinks, prescribed values.

use crate::curved_supports::{KINDS, Kind, RADII, add, sector};
use faying::basis::BSpline;
use faying::geometry::ControlNet;
use faying::geometry::shapes::plate_with_hole;
use faying::linalg::Vector;
use faying::problem::{BodyId, Components, Data, ErrorKind, Problem, RegionId, Solution};
use faying::space::PatchSpec;

/// The parts of a side below and above the diagonal.
fn halves(p: &mut Problem<1, 2>, body: BodyId, side: &str) -> [RegionId; 2] {
    let below = p.part(body.side(side), "y < x", &|x| x[1] < x[0]).unwrap().unwrap();
    let above = p.part(body.side(side), "y > x", &|x| x[1] > x[0]).unwrap().unwrap();
    [below, above]
}

fn slide(p: &mut Problem<1, 2>, on: RegionId, along_normal: bool) {
    if along_normal {
        p.fix_normal(on).unwrap()
    } else {
        p.fix_tangential(on).unwrap()
    };
}

/// The displacement at an angle of the outer circle, along its normal and its tangent.
fn on_circle(s: &Solution<1, 2>, body: BodyId, degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let u = s.at(body, &[RADII[1] * cos, RADII[1] * sin]).unwrap().u;
    [u[0] * cos + u[1] * sin, u[1] * cos - u[0] * sin]
}

/// Largest displacement of the inner circle.
fn largest(s: &Solution<1, 2>, body: BodyId) -> f64 {
    let at = |k: usize| {
        let (sin, cos) = (f64::from(k as u32) * 9.0).to_radians().sin_cos();
        let u = s.at(body, &[RADII[0] * cos, RADII[0] * sin]).unwrap().u;
        u[0].hypot(u[1])
    };
    (0..=10).map(at).fold(0.0, f64::max)
}

/// The normals of one part of an arc and the tangents of the next hold both in the point between them.
#[test]
fn normals_and_tangents_of_an_arc_hold_their_common_point() {
    for kind in KINDS {
        for degree in kind.degrees() {
            for first_is_normal in [true, false] {
                let solve = |n: usize| {
                    let mut p = Problem::<1, 2>::new();
                    let ring = sector(&mut p, "ring", kind, degree, [0.0, 90.0], [n, n / 2]);
                    let [below, above] = halves(&mut p, ring, "v1");
                    if first_is_normal {
                        slide(&mut p, below, true);
                        slide(&mut p, above, false);
                    } else {
                        slide(&mut p, above, false);
                        slide(&mut p, below, true);
                    }
                    p.pressure(ring.side("v0"), 1e-3).unwrap();
                    p.traction(ring.side("v0"), 0, 5e-4).unwrap();
                    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                    let size = largest(&s, ring);
                    let [normal, along] = on_circle(&s, ring, 45.0).map(|u| u.abs() / size);
                    // one degree on either side
                    let beside = on_circle(&s, ring, 44.0)[0].abs().max(on_circle(&s, ring, 46.0)[1].abs()) / size;
                    [normal.max(along), beside]
                };
                let (coarse, fine) = (solve(8), solve(16));
                println!("{kind:?}, degree {degree}, normal first {first_is_normal}: {coarse:?} {fine:?}");
                let most = if degree == 1 { 3e-2 } else { 1e-2 };
                assert!(fine.iter().all(|v| *v < most), "{kind:?}, degree {degree}: {fine:?}");
                assert!(fine[0] < 0.5 * coarse[0] || fine[0] < 1e-12, "{kind:?}, degree {degree}: {coarse:?} {fine:?}");
            }
        }
    }
}

/// The shapes of sides with a kink.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Both outer edges of a plate with a hole.
    Square,
    /// Two parabolas that meet at (0.5, 1).
    Parabolas,
    /// A straight line that meets a parabola there, at 22 degrees.
    Line,
}

/// A plate with such an upper side.
fn gable(p: &mut Problem<1, 2>, kind: Kind, shape: Shape, n: usize) -> BodyId {
    let kinked = BSpline::try_new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
    let lower = [0.0, 0.25, 0.5, 0.75, 1.0].map(|x| [x, 0.0]);
    let upper = match shape {
        Shape::Line => [[0.0, 1.0], [0.25, 1.0], [0.5, 1.0], [0.75, 0.9], [1.0, 0.7]],
        _ => [[0.0, 0.8], [0.3, 0.8], [0.5, 1.0], [0.75, 0.95], [1.0, 0.7]],
    };
    let points = lower.into_iter().chain(upper).map(Vector::<2>::from).collect();
    let net = ControlNet::try_new([kinked, BSpline::uniform(1, 1, 0)], points, None).unwrap();
    add(p, "gable", kind.body(PatchSpec::new(net).with_degree([2; 2]).with_elements([n, n / 2])))
}

/// One side with a kink is held as its parts on both sides of it.
#[test]
fn a_side_with_a_kink_is_held_as_its_parts() {
    for kind in KINDS {
        for (shape, along_normal) in [Shape::Square, Shape::Parabolas, Shape::Line].into_iter().flat_map(|s| [(s, true), (s, false)]) {
            let straight = shape == Shape::Square;
            let solve = |n: usize, split: bool| {
                let mut p = Problem::<1, 2>::new();
                let (body, corner) = if straight {
                    let net = plate_with_hole(1.0, 4.0).unwrap();
                    (add(&mut p, "plate", kind.body(PatchSpec::new(net).with_degree([2; 2]).with_elements([n, n / 2]))), [4.0, 4.0])
                } else {
                    (gable(&mut p, kind, shape, n), [0.5, 1.0])
                };
                let inner = if straight { "u0" } else { "v0" };
                // the rest of the motions
                p.fix(body.side(inner), Components::Y).unwrap();
                if straight {
                    p.fix(body.side("u1"), Components::X).unwrap();
                }
                let parts = if split && straight {
                    halves(&mut p, body, "v1").to_vec()
                } else if split {
                    let left = p.part(body.side("v1"), "x < 0.5", &|x| x[0] < 0.5).unwrap().unwrap();
                    vec![left, p.part(body.side("v1"), "x > 0.5", &|x| x[0] > 0.5).unwrap().unwrap()]
                } else {
                    vec![p.region(body.side("v1")).unwrap()]
                };
                parts.iter().for_each(|&part| slide(&mut p, part, along_normal));
                let loaded = if straight { "v0" } else { "u1" };
                p.traction(body.side(loaded), 0, 0.1).unwrap();
                p.traction(body.side(loaded), 1, 0.05).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                let u = s.at(body, &corner).unwrap().u;
                let mut force = vec![0.0; 2];
                for part in parts {
                    force.iter_mut().zip(s.reaction(part).unwrap()).for_each(|(sum, f)| *sum += f);
                }
                let balance = s.balance().force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
                (s.coefficients(body).unwrap().to_vec(), u[0].hypot(u[1]), force, balance)
            };
            let what = format!("{kind:?}, {shape:?}, normal {along_normal}");
            let ((whole, corner, force, balance), (parts, _, of_parts, _)) = (solve(8, false), solve(8, true));
            let size = parts.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{what}: apart {:e}, corner {corner:e} of {size:e}", apart(&whole, &parts));
            assert!(
                size > 1e-3 && apart(&whole, &parts) < 1e-11 * size && apart(&force, &of_parts) < 1e-12,
                "{what}: {force:?} {of_parts:?}"
            );
            assert!(balance < 1e-12, "{what}: {balance:e}");
            if straight {
                assert!(corner < 1e-13 * size, "{what}: {corner:e}");
            } else {
                let fine = solve(16, false).1;
                assert!(corner < 1e-2 * size && fine < 0.5 * corner, "{what}: {corner:e} {fine:e} of {size:e}");
            }
        }
    }
}

/// A displacement of an edge by components.
type Moved = [Data; 2];

/// A quarter of a ring from `angle` on: its outer arc is held, and its first straight edge is moved.
fn moved(kind: Kind, angle: f64, along_normal: bool, by: Moved) -> Result<f64, Vec<ErrorKind>> {
    let mut p = Problem::<1, 2>::new();
    p.times(&[0.5, 1.0]);
    let ring = sector(&mut p, "ring", kind, 2, [angle, angle + 90.0], [8, 4]);
    let [x, y] = by;
    let first = p.prescribe(ring.side("u0"), 0, x).unwrap();
    let second = p.prescribe(ring.side("u0"), 1, y).unwrap();
    let slide = if along_normal { p.fix_normal(ring.side("v1")).unwrap() } else { p.fix_tangential(ring.side("v1")).unwrap() };
    match p.assemble() {
        Ok(mut system) => {
            let half = system.solve(0.5, None).unwrap();
            let s = system.solve(1.0, Some(&half)).unwrap();
            let (sin, cos) = (angle + 20.0).to_radians().sin_cos();
            let u = s.at(ring, &[RADII[1] * cos, RADII[1] * sin]).unwrap().u;
            Ok(if along_normal { u[0] * cos + u[1] * sin } else { u[1] * cos - u[0] * sin })
        }
        Err(errors) => {
            for error in &errors.0 {
                assert_eq!(error.of.last(), Some(&slide), "{errors}");
                assert!(error.of[..error.of.len() - 1].iter().all(|of| [first, second].contains(of)), "{errors}");
                assert_eq!(error.names()[..2], ["ring.v1", "ring.u0"]);
            }
            Err(errors.0.into_iter().map(|e| e.kind).collect())
        }
    }
}

#[test]
fn values_at_the_end_of_an_arc_agree_with_what_it_holds() {
    const BY: f64 = 1e-3;
    for kind in KINDS {
        for angle in [0.0, 30.0, -75.0] {
            let (sin, cos) = f64::to_radians(angle).sin_cos();
            // along the edge, and across it
            let constant =
                |normal: f64, across: f64| -> Moved { [(normal * cos - across * sin).into(), (normal * sin + across * cos).into()] };
            for along_normal in [true, false] {
                let turned = |normal: f64, across: f64| if along_normal { constant(normal, across) } else { constant(across, normal) };
                let what = format!("{kind:?}, {angle} degrees, normal {along_normal}");
                for by in [turned(BY, 0.0), turned(BY, BY), turned(1e-3 * BY, BY)] {
                    let found = moved(kind, angle, along_normal, by).unwrap_err();
                    assert!(matches!(found[..], [ErrorKind::Contradiction { changes: false, .. }]), "{what}: {found:?}");
                }
                // the defect is what is prescribed along the direction that is held
                let [ErrorKind::Contradiction { defect, .. }] = moved(kind, angle, along_normal, turned(BY, 2.0 * BY)).unwrap_err()[..]
                else {
                    panic!("{what}")
                };
                assert!((defect / BY - 1.0).abs() < 1e-9, "{what}: {defect:e}");
                // values that agree in the corner alone, by formulas too
                let vanishing = |x: &[f64]| BY * (RADII[1] - x[0].hypot(x[1]));
                let by_formula: Moved = if along_normal {
                    [Data::of(move |x, _| vanishing(x) * cos), Data::of(move |x, _| vanishing(x) * sin)]
                } else {
                    [Data::of(move |x, _| -vanishing(x) * sin), Data::of(move |x, _| vanishing(x) * cos)]
                };
                let stretch = move |x: &[f64], k: usize| if along_normal { [-x[1], x[0]][k] } else { x[k] };
                let by_place: Moved = [Data::of(move |x, _| BY * stretch(x, 0)), Data::of(move |x, _| BY * stretch(x, 1))];
                for by in [turned(0.0, BY), turned(0.0, 0.0), by_formula, by_place] {
                    let beside = moved(kind, angle, along_normal, by).unwrap_or_else(|e| panic!("{what}: {e:?}"));
                    assert!(beside.abs() < 2e-2 * BY, "{what}: {beside:e}");
                }
                // at the second time
                let late = |f: f64| Data::of(move |_, t| if t > 0.7 { f } else { 0.0 });
                let by = if along_normal { [late(BY * cos), late(BY * sin)] } else { [late(-BY * sin), late(BY * cos)] };
                let found = moved(kind, angle, along_normal, by).unwrap_err();
                assert!(matches!(found[..], [ErrorKind::Contradiction { changes: true, t: 1.0, .. }]), "{what}: {found:?}");
            }
        }
    }
}

/// One component in a corner whose normal is oblique leaves the other one to the arc.
#[test]
fn one_component_and_an_oblique_normal_hold_a_corner() {
    const BY: f64 = 1e-3;
    for kind in KINDS {
        for angle in [20.0_f64, 70.0] {
            let mut p = Problem::<1, 2>::new();
            let ring = sector(&mut p, "ring", kind, 2, [angle, angle + 90.0], [16, 8]);
            p.prescribe(ring.side("u0"), 0, BY).unwrap();
            p.fix(ring.side("u1"), Components::All).unwrap();
            p.fix_normal(ring.side("v1")).unwrap();
            let s = p.assemble().unwrap().solve(1.0, None).unwrap();
            let (sin, cos) = angle.to_radians().sin_cos();
            let u = s.at(ring, &[RADII[1] * cos, RADII[1] * sin]).unwrap().u;
            let normal = u[0] * cos + u[1] * sin;
            println!("{kind:?}, {angle} degrees: {normal:e}, {u:?}");
            assert!((u[0] - BY).abs() < 1e-12 && normal.abs() < 1e-2 * BY, "{kind:?}, {angle} degrees: {u:?}, {normal:e}");
        }
    }
}
