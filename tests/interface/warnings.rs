//! Warnings about problems that are said in Rust, and about their solutions.

use faying::geometry::shapes::rectangle;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data, Problem, SubjectKind, System, Warning};
use faying::space::{Patch, PatchSpec};

fn block(p: &mut Problem<1, 2>, name: &str, low: [f64; 2], high: [f64; 2]) -> BodyId {
    let spec = PatchSpec::new(rectangle(low, high).unwrap()).with_degree([2, 2]).with_elements([4, 2]);
    p.body(name, Patch::try_new(&spec).unwrap(), Hooke::<2>::plane_strain(1e3, 0.3).unwrap()).unwrap()
}

/// A block of unit width on another one, apart by `gap`.
fn stack(p: &mut Problem<1, 2>, gap: f64) -> [BodyId; 2] {
    let lower = block(p, "lower", [0.0, 0.0], [1.0, 0.5]);
    let upper = block(p, "upper", [0.0, 0.5 + gap], [1.0, 1.0 + gap]);
    p.fix(lower.side("v0"), Components::All).unwrap();
    [lower, upper]
}

/// Two tied blocks under a shear traction.
fn sheared(gap: f64, traction: f64) -> System<1, 2> {
    let mut p = Problem::new();
    let [lower, upper] = stack(&mut p, gap);
    p.tie(upper.side("v0"), lower.side("v1")).unwrap().named("seam").tolerance(0.1);
    p.traction(upper.side("v1"), 0, traction).unwrap();
    p.assemble().unwrap()
}

#[test]
fn sound_problems_are_not_warned_of() {
    let mut tied = sheared(0.0, 1.0);
    assert_eq!(tied.warnings(), []);
    assert_eq!(tied.solve(1.0, None).unwrap().warnings(), []);
    let mut p = Problem::new();
    let [lower, upper] = stack(&mut p, 0.0);
    p.fix(upper.side("u0"), Components::One(0)).unwrap();
    p.contact(upper.side("v0"), lower.side("v1")).unwrap();
    p.pressure(upper.side("v1"), 1.0).unwrap();
    let mut pressed = p.assemble().unwrap();
    assert_eq!(pressed.warnings(), []);
    assert_eq!(pressed.solve(1.0, None).unwrap().warnings(), []);
}

#[test]
fn a_tie_over_a_gap_loses_a_moment_and_large_strains_are_told() {
    let mut system = sheared(0.05, 200.0);
    assert_eq!(system.warnings(), []);
    let found = system.solve(1.0, None).unwrap().warnings();
    // equal and opposite forces of 200 on sides that are 0.05 apart
    let Some(lost @ Warning::LostMoment { of, apart, moment, .. }) = found.first() else { panic!("{found:?}") };
    assert_eq!((of.kind, of.number, of.name.as_str()), (SubjectKind::Tie, 0, "seam"));
    assert!((apart - 0.05).abs() < 1e-12 && (moment - 10.0).abs() < 1e-6, "{apart} {moment}");
    assert!(lost.to_string().starts_with("tie \"seam\" loses the moment 10"), "{lost}");
    let strains: Vec<_> = found[1..].iter().map(|w| matches!(w, Warning::Kinematics { strain: Some(s), .. } if s.largest > 0.1)).collect();
    assert_eq!(strains, [true, true], "{found:?}");
    assert!(found[1].to_string().starts_with("body \"lower\" deforms too far"), "{}", found[1]);
    assert!(found[1].repeats(&found[1]) && !found[1].repeats(&found[2]) && !found[0].repeats(&found[1]));
}

#[test]
fn a_punch_deeper_than_half_a_body_is_told() {
    let mut p = Problem::new();
    let plate = block(&mut p, "plate", [0.0, 0.0], [1.0, 0.1]);
    let punch = block(&mut p, "punch", [0.3, 0.02], [0.7, 1.0]);
    p.fix(plate.side("v0"), Components::All).unwrap();
    p.fix(punch.side("v1"), Components::All).unwrap();
    p.contact(punch.side("v0"), plate.side("v1")).unwrap().named("press");
    let found = p.assemble().unwrap().warnings();
    let [told @ Warning::Overlap { of, depth, slave, masters, by_formula: false, .. }] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((of.kind, of.number, slave.as_str()), (SubjectKind::Contact, 0, "punch.v0"));
    assert_eq!(masters.as_slice(), ["plate.v1"]);
    assert!((depth - 0.08).abs() < 1e-9, "{depth}");
    assert!(told.to_string().contains("punch.v0 lies 0.08 deep"), "{told}");
}

#[test]
fn soft_springs_and_loads_that_jump_inside_of_elements_are_told() {
    let mut p = Problem::new();
    let body = block(&mut p, "block", [0.0, 0.0], [1.0, 0.5]);
    p.fix(body.side("v0"), Components::One(1)).unwrap();
    p.spring(body.side("v0"), 0, 1e-6).unwrap();
    p.traction(body.side("v1"), 1, Data::of(|x, _| if x[0] < 0.3 { 1.0 } else { 0.0 })).unwrap();
    let found = p.assemble().unwrap().warnings();
    let [Warning::HardlyHeld { of, motions, share }, Warning::Inexact(load)] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((of.name.as_str(), motions.as_slice()), ("block", ["translation x".to_owned()].as_slice()));
    assert!(*share < 1e-8 && load.error > 1e-2, "{share} {}", load.error);
}
