//! Ties and contacts whose numbers are poor are told, and those beside them are not.

use crate::bodies::{KINDS, Kind, steel};
use crate::tied::Linear;
use faying::contact::{Augmented, ContactMethod, Lagrange};
use faying::coupling::nitsche::Variant;
use faying::coupling::{Nitsche, Penalty};
use faying::geometry::{shapes, turn_about};
use faying::linalg::{Matrix, Vector};
use faying::problem::{BodyId, Components, ErrorKind, Integration, InterfaceError, Problem, Solution, TieId, Value, Warning};
use faying::space::PatchSpec;
use std::f64::consts::PI;
use std::sync::Arc;

const FIELD: Linear = Linear(Matrix::<3, 3>::new(0.3, -0.2, 0.5, 0.1, -0.4, 0.2, -0.6, 0.3, 0.7));
const OUTER: [&str; 6] = ["u0", "u1", "v0", "v1", "w0", "w1"];

/// Two layers of a hollow sphere's octant, their grids with nothing in common; all other sides follow a linear field.
fn octants(kinds: [Kind; 2], degree: usize, swapped: bool, level: usize) -> (Problem<2, 3>, TieId) {
    let mut p = Problem::<2, 3>::new();
    p.exact(FIELD);
    let [inner, outer] = [0, 1].map(|k| {
        let net = shapes::sphere_octant([0.0; 3], [[1.0, 1.5], [1.5, 2.0]][k]).unwrap();
        let elements = [[4, 4, 3], [3, 3, 2]][k].map(|n| n << level);
        let body = kinds[k].body(&PatchSpec::new(net).with_degree([degree; 3]).with_elements(elements));
        kinds[k].add(&mut p, ["inner", "outer"][k], body, steel())
    });
    for (body, tied) in [(inner, "w1"), (outer, "w0")] {
        // sides that are points or edges of an octant are none
        for side in OUTER.into_iter().filter(|side| *side != tied && *side != "v1") {
            (0..3).for_each(|c| {
                p.prescribe(body.side(side), c, Value::Exact).unwrap();
            });
        }
    }
    let (slave, master) = if swapped { (outer.side("w0"), inner.side("w1")) } else { (inner.side("w1"), outer.side("w0")) };
    let tie = p.tie(slave, master).unwrap().id();
    (p, tie)
}

/// Largest error of the gradient of a body, relative.
fn error(solution: &Solution<2, 3>) -> f64 {
    solution.errors(&FIELD).iter().map(|e| e.error.h1 / e.exact.h1).fold(0.0, f64::max)
}

/// The share of a slave side that a warning says not to be tied.
fn share(warning: &Warning) -> Option<f64> {
    if let Warning::PartUncovered { share, .. } = warning { Some(*share) } else { None }
}

/// The shares of slave sides that are told not to be tied, and the largest relative error of stresses.
fn told(p: &Problem<2, 3>, tie: TieId) -> (Vec<f64>, f64) {
    let mut system = p.assemble().unwrap();
    let shares = system.warnings().iter().filter_map(share).collect::<Vec<f64>>();
    let solution = system.solve(0.0, None).unwrap();
    let area = solution.tie(tie).unwrap().area;
    assert!(area > 0.0 && area < 0.5 * PI * 2.25 + 1e-9, "{area}");
    (shares, error(&solution))
}

#[test]
fn octants_of_coarse_facets_are_tied_and_what_is_lost_is_told() {
    for kinds in [[0, 0], [0, 1], [1, 0], [1, 1]].map(|of: [usize; 2]| of.map(|k| KINDS[2 + k])) {
        for swapped in [false, true] {
            for degree in [1, 2] {
                let (p, tie) = octants(kinds, degree, swapped, 0);
                let (shares, off) = told(&p, tie);
                let most = [0.0, 1e-2, 1e-5][degree];
                assert!(shares.len() == 1 && shares[0] > 1e-6 && shares[0] < most, "{kinds:?} {degree} {swapped}: {shares:?}");
                // tractions turn with the normal, by 30 degrees on a cell: multipliers that do not leave percents
                assert!(off < 0.1, "{kinds:?} {degree} {swapped}: {off:e}");
            }
        }
    }
}

/// Strips at the rim are as wide as the facets are apart, h², times the angle between them, h.
#[test]
fn what_facets_lose_falls_with_the_third_power_of_their_size() {
    for swapped in [false, true] {
        let [coarse, fine] = [0, 1].map(|level| {
            let (p, _) = octants([Kind::Hexahedra; 2], 1, swapped, level);
            let found = p.assemble().unwrap().warnings();
            found.iter().find_map(share).unwrap()
        });
        assert!((6.0..12.0).contains(&(coarse / fine)), "{swapped}: {coarse:e} {fine:e}");
    }
}

#[test]
fn exact_surfaces_lose_nothing() {
    let (p, tie) = octants([Kind::Nurbs; 2], 2, false, 0);
    assert!(told(&p, tie).0.is_empty());
}

/// A slave of 90 degrees on a master of 85: what facets lose at the rim does not hide a strip of a sixth of an element.
#[test]
fn a_master_that_ends_before_its_slave_is_refused() {
    let mut p = Problem::<2, 3>::new();
    let [inner, outer] = [0, 1].map(|k| {
        let net = shapes::annulus_sector([0.0; 2], [[1.0, 1.5], [1.5, 2.0]][k], [0.0, [85.0, 90.0][k]]).unwrap().extrude(1.0);
        let body = Kind::Hexahedra.body(&PatchSpec::new(net).with_degree([1; 3]).with_elements([[4, 1, 2], [3, 1, 3]][k]));
        Kind::Hexahedra.add(&mut p, ["inner", "outer"][k], body, steel())
    });
    p.fix(inner.side("v0"), Components::All).unwrap();
    p.tie(outer.side("v0"), inner.side("v1")).unwrap();
    let refused = p.assemble().expect_err("refused");
    let share = refused.0.iter().find_map(|e| match &e.kind {
        ErrorKind::Interface { error: InterfaceError::Uncovered { share }, .. } => Some(*share),
        _ => None,
    });
    // the last radius of the master on the last chord of the slave, along the normal of the last chord of the master
    let (angle, half) = (10f64.to_radians(), 15f64.to_radians());
    let near = 1.0 - (half.sin() - angle.sin()) / (2.0 * half.sin()) / 3.0;
    assert!((share.unwrap() - near).abs() < 5e-3, "{refused:?} {near}");
}

/// Two boxes that touch in an oblique plane, their grids with nothing in common; all other sides follow a linear field.
fn stacked(degree: usize, coupling: &str, rule: Integration) -> (Solution<2, 3>, TieId) {
    let turn = turn_about(&Vector::<3>::new(1.0, 2.0, 0.5), 40.0).unwrap();
    let mut p = Problem::<2, 3>::new();
    p.exact(FIELD);
    let lower = Kind::Spline.turned_box(([0.0, 0.0, -0.5], [1.0, 0.8, 0.0]), &turn, degree, [3, 2, 1]);
    let upper = Kind::Spline.turned_box(([0.0; 3], [1.0, 0.8, 0.6]), &turn, degree, [2, 3, 1]);
    let [lower, upper] = [("lower", lower), ("upper", upper)].map(|(name, body)| Kind::Spline.add(&mut p, name, body, steel()));
    for (body, tied) in [(lower, "w1"), (upper, "w0")] {
        for side in OUTER.into_iter().filter(|side| *side != tied) {
            (0..3).for_each(|c| {
                p.prescribe(body.side(side), c, Value::Exact).unwrap();
            });
        }
    }
    let tie = p.tie(upper.side("w0"), lower.side("w1")).unwrap().rule(rule);
    let tie = match coupling {
        "nitsche" => tie.coupling(Nitsche { factor: Nitsche::AUTO, variant: Variant::Symmetric }),
        "unsymmetric" => tie.coupling(Nitsche { factor: Nitsche::AUTO, variant: Variant::Unsymmetric }),
        "penalty" => tie.coupling(Penalty::default()),
        _ => tie,
    };
    let tie = tie.id();
    (p.assemble().unwrap().solve(0.0, None).unwrap(), tie)
}

/// The slave's own points do not see the kinks of the master's functions: every coupling tells by how much, and merged integration has no
/// such error.
#[test]
fn slave_points_that_spoil_linear_fields_are_told_with_every_coupling() {
    for coupling in ["mortar", "nitsche", "unsymmetric", "penalty"] {
        for degree in [1, 2] {
            let (own, tie) = stacked(degree, coupling, Integration::Slave);
            let is_told = own.warnings().iter().any(|w| matches!(w, Warning::Integration { .. }));
            let (off, found) = (error(&own), own.tie(tie).unwrap().consistency);
            assert!(off > 1e-3 && is_told && found > 0.5 * off && found < 20.0 * off, "{coupling} {degree}: {found:e} of {off:e}");
            let (merged, tie) = stacked(degree, coupling, Integration::Merged);
            let (off, found) = (error(&merged), merged.tie(tie).unwrap().consistency);
            assert!(found < 1e-11 && off < 1e-8 && merged.warnings().is_empty(), "{coupling} {degree}: {found:e} of {off:e}");
        }
    }
}

/// A hollow ball on a wide block, whose elements reach to 60 degrees off the ball's normals and beyond.
#[test]
fn slanted_elements_of_a_coarse_side_lose_no_part() {
    for (ball, n, width) in [([3, 3, 1], 3, 2.0), ([4, 4, 1], 5, 2.0), ([3, 3, 1], 3, 1.0)] {
        let mut p = Problem::<2, 3>::new();
        let down = turn_about(&Vector::<3>::x(), -90.0).unwrap();
        let net = shapes::sphere_octant([0.0; 3], [0.5, 1.0]).unwrap().rotate(&down).translate(&Vector::<3>::z());
        let body = Kind::Nurbs.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements(ball));
        let ball = Kind::Nurbs.add(&mut p, "ball", body, steel());
        let block = Kind::Spline.turned_box(([0.0, 0.0, -1.0], [width, width, 0.0]), &Matrix::identity(), 2, [n, n, 1]);
        let block = Kind::Spline.add(&mut p, "block", block, steel());
        p.fix(block.side("w0"), Components::All).unwrap();
        for side in [block.side("u0"), block.side("v0"), ball.side("u1"), ball.side("v0")] {
            p.fix_normal(side).unwrap();
        }
        p.prescribe(ball.side("u0"), 2, -0.05).unwrap();
        let contact = p.contact(block.side("w1"), ball.side("w1")).unwrap().symmetry().id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        let found = solution.warnings();
        assert!(!found.iter().any(|w| matches!(w, Warning::LostParts { .. })), "{n} {width}: {found:?}");
        // elements of which all is within 60 degrees of the ball's normal: x² + y² <= 3
        let (covered, size) = (solution.contact(contact).unwrap().measure, width / n as f64);
        let opposed = |(i, j): &(usize, usize)| ((i + 1).pow(2) + (j + 1).pow(2)) as f64 * size * size <= 3.0;
        let least = (0..n * n).map(|q| (q % n, q / n)).filter(opposed).count() as f64 * size * size;
        assert!(covered > least - 1e-9, "{n} {width}: {covered} of {least}");
    }
}

/// Blocks that touch and slide along each other without pressure: what rounding leaves is no area, and no zone that is too coarse.
#[test]
fn nothing_presses_where_bodies_only_slide() {
    let methods: [Arc<dyn ContactMethod<2, 3>>; 4] = [
        Arc::new(Lagrange),
        Arc::new(Augmented::default()),
        Arc::new(Penalty::default()),
        Arc::new(Nitsche { factor: Nitsche::AUTO, variant: Variant::Symmetric }),
    ];
    for method in methods {
        let mut p = Problem::<2, 3>::new();
        let mut block = |name: &str, [low, high]: [f64; 2], elements: [usize; 3]| {
            let body = Kind::Spline.turned_box(([0.0, 0.0, low], [1.0, 1.0, high]), &Matrix::identity(), 2, elements);
            Kind::Spline.add(&mut p, name, body, steel())
        };
        let [lower, upper]: [BodyId; 2] = [block("lower", [0.0, 0.5], [4, 4, 2]), block("upper", [0.5, 1.0], [3, 3, 2])];
        p.fix(lower.side("w0"), Components::All).unwrap();
        for (c, value) in [0.1, 0.03, 0.0].into_iter().enumerate() {
            p.prescribe(upper.side("w1"), c, value).unwrap();
        }
        let what = format!("{method:?}");
        let contact = p.contact(upper.side("w0"), lower.side("w1")).unwrap().method(method).id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        let found = solution.contact(contact).unwrap();
        assert!(found.area == 0.0 && found.largest_pressure.abs() < 1e-13, "{what}: {found:?}");
        assert!(solution.warnings().is_empty(), "{what}: {:?}", solution.warnings());
    }
}
