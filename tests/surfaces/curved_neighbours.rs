//! What curved sides in space that slide hold where they meet: each other, their own kinks, prescribed values, loads along their tangents.

use crate::bodies::{Kind, steel};
use crate::curved_supports::{BODIES, HEIGHT, PRESSURE, RADII, body};
use faying::basis::BSpline;
use faying::geometry::{ControlNet, shapes, turn_about};
use faying::linalg::Vector;
use faying::problem::{BodyId, Components, Data, ErrorKind, Problem, RegionId};
use faying::space::{Mapping, PatchSpec};

const SOLIDS: [Kind; 3] = [Kind::Nurbs, Kind::Hexahedra, Kind::Tetrahedra];

fn slide(p: &mut Problem<2, 3>, on: RegionId, along_normal: bool) {
    if along_normal {
        p.fix_normal(on).unwrap()
    } else {
        p.fix_tangential(on).unwrap()
    };
}

/// Parts of a side where x + `along` y is below and above a value.
fn halves(p: &mut Problem<2, 3>, body: BodyId, side: &str, along: f64, at: f64) -> [RegionId; 2] {
    let below = p.part(body.side(side), "below", &|x| x[0] + along * x[1] < at).unwrap().unwrap();
    [below, p.part(body.side(side), "above", &|x| x[0] + along * x[1] > at).unwrap().unwrap()]
}

/// A tube whose mantle is held along its normals in one part and along its tangents in the next.
#[test]
fn normals_and_tangents_of_a_mantle_hold_their_common_line() {
    for kind in SOLIDS {
        for first in [true, false] {
            let mut p = Problem::<2, 3>::new();
            let (id, _, [inner, outer]) = body(&mut p, kind, false, 2, 8);
            p.fix_normal(id.side("w0")).unwrap();
            p.fix_normal(id.side("w1")).unwrap();
            let [above, below] = halves(&mut p, id, outer, -1.0, 0.0);
            slide(&mut p, if first { below } else { above }, first);
            slide(&mut p, if first { above } else { below }, !first);
            p.pressure(id.side(inner), PRESSURE).unwrap();
            p.traction(id.side(inner), 0, 0.5 * PRESSURE).unwrap();
            let s = p.assemble().unwrap().solve(1.0, None).unwrap();
            let at = |r: f64, degrees: f64, z: f64| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let u = s.at(id, &[r * cos, r * sin, z]).unwrap().u;
                [u[0] * cos + u[1] * sin, u[1] * cos - u[0] * sin, u[2]]
            };
            let size = (0..=9).map(|k| Vector::<3>::from(at(RADII[0], f64::from(k) * 10.0, 0.2)).norm()).fold(0.0, f64::max);
            for z in [0.0, 0.2, HEIGHT] {
                let (there, beside) = (Vector::<3>::from(at(RADII[1], 45.0, z)).norm() / size, at(RADII[1], 44.0, z)[0].abs() / size);
                println!("{kind:?}, normal first {first}, z = {z}: {there:e}, {beside:e} of {size:e}");
                // on triangles the ends of the line, whose z is held beside, hand their rows on
                let most = if kind == Kind::Tetrahedra { 5e-2 } else { 2e-2 };
                assert!(there < most && beside < 5e-3, "{kind:?}, normal first {first}, z = {z}: {there:e}, {beside:e}");
            }
        }
    }
}

/// The outer side of an extruded plate with a hole, or a roof of two parabolic sheets: held as its parts on both sides of the kink.
#[test]
fn a_surface_with_a_kink_is_held_as_its_parts() {
    for kind in SOLIDS {
        for (straight, along_normal) in [(true, true), (true, false), (false, true)] {
            let solve = |split: bool| {
                let mut p = Problem::<2, 3>::new();
                let net = if straight { shapes::plate_with_hole(1.0, 2.0).unwrap() } else { gable() };
                let spec = PatchSpec::new(net.extrude(HEIGHT)).with_degree([2; 3]).with_elements([4, 2, 2]).with_mapping(Mapping::Exact);
                let id = kind.add(&mut p, "body", kind.body(&spec), steel());
                p.fix_normal(id.side("w0")).unwrap();
                if straight {
                    p.fix_normal(id.side("u0")).unwrap();
                } else {
                    p.fix(id.side("v0"), Components::All).unwrap();
                }
                let parts = match (split, straight) {
                    (true, true) => halves(&mut p, id, "v1", -1.0, 0.0).to_vec(),
                    (true, false) => halves(&mut p, id, "v1", 0.0, 0.5).to_vec(),
                    _ => vec![p.region(id.side("v1")).unwrap()],
                };
                parts.iter().for_each(|&part| slide(&mut p, part, along_normal));
                p.traction(id.side(if straight { "v0" } else { "u1" }), 0, 0.1).unwrap();
                p.traction(id.side("w1"), 2, 0.05).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                let corner = if straight { [2.0, 2.0, 0.3] } else { [0.5, 1.0, 0.3] };
                let u = s.at(id, &corner).unwrap().u;
                let mut force = vec![0.0; 3];
                for part in parts {
                    force.iter_mut().zip(s.reaction(part).unwrap()).for_each(|(sum, f)| *sum += f);
                }
                (s.coefficients(id).unwrap().to_vec(), u, force)
            };
            let what = format!("{kind:?}, straight {straight}, normal {along_normal}");
            let ((whole, corner, force), (parts, _, of_parts)) = (solve(false), solve(true));
            let size = parts.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{what}: apart {:e}, corner {corner:?} of {size:e}", apart(&whole, &parts));
            assert!(
                size > 1e-3 && apart(&whole, &parts) < 1e-10 * size && apart(&force, &of_parts) < 1e-11,
                "{what}: {force:?} {of_parts:?}"
            );
            let most = if straight { 1e-12 } else { 2e-2 };
            assert!(corner[0].hypot(corner[1]) < most * size, "{what}: {corner:?}");
            assert!(along_normal || corner[2].abs() < most * size, "{what}: {corner:?}");
        }
    }
}

/// Two parabolas that meet in a kink at (0.5, 1), over the unit interval.
fn gable() -> ControlNet<2, 2> {
    let kinked = BSpline::try_new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
    let lower = [0.0, 0.25, 0.5, 0.75, 1.0].map(|x| [x, 0.0]);
    let upper = [[0.0, 0.8], [0.3, 0.8], [0.5, 1.0], [0.75, 0.95], [1.0, 0.7]];
    let points = lower.into_iter().chain(upper).map(Vector::<2>::from).collect();
    ControlNet::try_new([kinked, BSpline::uniform(1, 1, 0)], points, None).unwrap()
}

/// Values along the edge of a flat side that the curved side beside it holds.
#[test]
fn values_along_an_edge_agree_with_what_a_curved_side_holds() {
    const BY: f64 = 1e-3;
    for (kind, is_sphere) in BODIES {
        // values of components on a flat side, and whether the normals, or the tangents, of the curved one contradict them
        let zero = || Data::from(0.0);
        let turned = [Data::of(|x, _| -BY * x[1]), Data::of(|x, _| BY * x[0]), zero()];
        let stretched = [Data::of(|x, _| BY * x[0]), Data::of(|x, _| BY * x[1]), Data::of(|x, _| BY * x[2])];
        let outside: [Data; 3] = std::array::from_fn(|k| {
            let factor = [1.0, 0.7, 0.3][k];
            Data::of(move |x, _| factor * BY * (x[0].hypot(x[1]).hypot(if is_sphere { x[2] } else { 0.0 }) - RADII[1]))
        });
        let cases: [(&str, [Data; 3], [bool; 2]); 5] = [
            ("u0", [BY.into(), zero(), zero()], [true, is_sphere]),
            ("u0", turned, [false, true]),
            ("u0", stretched, [true, !is_sphere]),
            ("u0", outside, [false, false]),
            (if is_sphere { "v0" } else { "w0" }, [zero(), zero(), BY.into()], [false, true]),
        ];
        for (side, values, contradicts) in cases {
            for along_normal in [true, false] {
                let mut p = Problem::<2, 3>::new();
                let (id, _, [_, outer]) = body(&mut p, kind, is_sphere, 2, 2);
                let mut said = Vec::new();
                for (k, value) in values.iter().enumerate() {
                    said.push(p.prescribe(id.side(side), k, value.clone()).unwrap());
                }
                let slide = if along_normal { p.fix_normal(id.side(outer)).unwrap() } else { p.fix_tangential(id.side(outer)).unwrap() };
                let what = format!("{kind:?}, sphere {is_sphere}, {side}, normal {along_normal}");
                let errors = p.assemble().err().map_or(Vec::new(), |e| e.0);
                if contradicts[usize::from(!along_normal)] {
                    assert!(matches!(errors[..], [ref e] if matches!(e.kind, ErrorKind::Contradiction { .. })), "{what}: {errors:?}");
                    assert_eq!(errors[0].of.last(), Some(&slide), "{what}: {errors:?}");
                    assert!(
                        errors[0].of.len() > 1 && errors[0].of.iter().all(|of| *of == slide || said.contains(of)),
                        "{what}: {errors:?}"
                    );
                } else {
                    assert_eq!(errors, [], "{what}");
                }
            }
        }
    }
}

/// Loads along the axis of a tube act on the support of its tangents alone.
#[test]
fn loads_along_the_tangents_of_a_tube_are_carried_by_their_support_alone() {
    let turn = turn_about(&Vector::<3>::new(1.0, 0.5, -0.2), 40.0).unwrap();
    for kind in SOLIDS {
        for turned in [false, true] {
            let refused = |along_normal: bool, say: &dyn Fn(&mut Problem<2, 3>, BodyId, Vector<3>)| {
                let mut p = Problem::<2, 3>::new();
                let net = shapes::annulus_sector([0.0; 2], [RADII[1], RADII[0]], [0.0, 90.0]).unwrap().extrude(HEIGHT);
                let net = if turned { net.rotate(&turn) } else { net };
                let spec = PatchSpec::new(net).with_degree([2; 3]).with_elements([2, 2, 1]).with_mapping(Mapping::Exact);
                let id = kind.add(&mut p, "body", kind.body(&spec), steel());
                p.fix(id.side("v1"), Components::All).unwrap();
                if along_normal {
                    p.fix_normal(id.side("v0")).unwrap()
                } else {
                    p.fix_tangential(id.side("v0")).unwrap()
                };
                say(&mut p, id, if turned { turn * Vector::<3>::z() } else { Vector::<3>::z() });
                p.assemble().err().map_or(Vec::new(), |e| e.0.into_iter().map(|e| e.kind).collect::<Vec<_>>())
            };
            let pull = |p: &mut Problem<2, 3>, id: BodyId, d: Vector<3>| {
                (0..3).filter(|&k| d[k] != 0.0).for_each(|k| {
                    p.traction(id.side("v0"), k, PRESSURE * d[k]).unwrap();
                });
            };
            let along: &dyn Fn(&mut Problem<2, 3>, BodyId, Vector<3>) = &|p, id, axis| pull(p, id, axis);
            let found = refused(false, along);
            assert!(!found.is_empty() && found.iter().all(|e| *e == ErrorKind::HeldAlong), "{kind:?}, turned {turned}: {found:?}");
            assert_eq!(refused(true, along), [], "{kind:?}, turned {turned}");
            let across: &dyn Fn(&mut Problem<2, 3>, BodyId, Vector<3>) =
                &|p, id, axis| pull(p, id, axis.cross(&Vector::<3>::new(0.3, 0.8, 0.5)));
            assert_eq!(refused(false, across), [], "{kind:?}, turned {turned}");
            let pressed: &dyn Fn(&mut Problem<2, 3>, BodyId, Vector<3>) = &|p, id, _| {
                p.pressure(id.side("v0"), PRESSURE).unwrap();
            };
            assert_eq!(refused(false, pressed), [], "{kind:?}, turned {turned}");
        }
    }
}
