//! Statements of a problem against closed solutions, in the plane and in space, on splines and on meshes; errors refer to statements.

use faying::geometry::shapes::{brick, rectangle};
use faying::geometry::turn;
use faying::linalg::Vector;
use faying::physics::{Assumption, Elastic, Hooke, Jet};
use faying::problem::{BodyId, BodyMaterial, BodySpec, Components, Data, ErrorKind, FacetsApart, Problem, Region, Unknown, Value, Warning};
use faying::space::{Body, Mesh, MultiPatch, Near, Patch, PatchSpec, Seam};
use std::sync::Arc;

/// A rectangle with the sides u0 = left, u1 = right, v0 = bottom, v1 = top.
fn plane(lo: [f64; 2], hi: [f64; 2], is_mesh: bool) -> Arc<dyn Body<1, 2>> {
    let spec = PatchSpec::new(rectangle(lo, hi).unwrap()).with_elements([2, 3]);
    if is_mesh { Arc::new(Mesh::from_patch(&spec).unwrap()) } else { Arc::new(Patch::try_new(&spec).unwrap()) }
}

fn solid(lo: [f64; 3], hi: [f64; 3], is_mesh: bool) -> Arc<dyn Body<2, 3>> {
    let spec = PatchSpec::new(brick(lo, hi).unwrap()).with_elements([2, 2, 2]);
    if is_mesh { Arc::new(Mesh::from_patch(&spec).unwrap()) } else { Arc::new(Patch::try_new(&spec).unwrap()) }
}

fn steel(young: f64) -> Hooke<2> {
    Hooke::plane_stress(young, 0.0).unwrap()
}

fn near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-10 * largest), "{found:?}, expected {expected:?}");
}

/// A glued body "x" has a side "y.v0", another body "x.y" a side "v0": both have the label "x.y.v0".
#[test]
fn reactions_of_regions_with_one_label_stay_apart() {
    for second in ["other", "x.y"] {
        let mut p = Problem::<1, 2>::new();
        let parts = vec![("y".to_owned(), plane([0.0, 0.0], [1.0, 1.0], false)), ("z".to_owned(), plane([0.0, 1.0], [1.0, 2.0], false))];
        let glued = MultiPatch::try_new(parts, &[Seam::new((0, "v1"), (1, "v0"))], Near::Exact).unwrap();
        let a = p.body("x", glued, steel(1.0)).unwrap();
        let b = p.body(second, plane([5.0, 0.0], [6.0, 1.0], true), steel(1.0)).unwrap();
        p.fix(a.side("y.v0"), Components::All).unwrap();
        p.traction(a.side("z.v1"), 1, -1.0).unwrap();
        p.fix(b.side("v0"), Components::All).unwrap();
        p.traction(b.side("v1"), 1, -10.0).unwrap();
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        near(&s.reaction(a.side("y.v0")).unwrap(), &[0.0, 1.0]);
        near(&s.reaction(b.side("v0")).unwrap(), &[0.0, 10.0]);
    }
}

/// Two bars side by side, of moduli 1 and 3, height 2 and width 1: a rigid top moves by F h / (E1 + E3).
#[test]
fn a_rigid_side_moves_as_one_and_a_force_is_spread_over_a_union() {
    for is_mesh in [false, true] {
        let bars = || {
            let mut p = Problem::<1, 2>::new();
            let soft = p.body("soft", plane([0.0, 0.0], [1.0, 2.0], is_mesh), steel(1.0)).unwrap();
            let hard = p.body("hard", plane([2.0, 0.0], [3.0, 2.0], !is_mesh), steel(3.0)).unwrap();
            for b in [soft, hard] {
                p.fix(b.side("v0"), Components::Y).unwrap();
                p.fix(b.side("u0"), Components::X).unwrap();
            }
            (p, soft, hard)
        };
        let (mut p, soft, hard) = bars();
        let tops = p.union([Region::from(soft.side("v1")), hard.side("v1").into()]).unwrap();
        p.rigid(tops, 1, -8.0).unwrap();
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        for (body, x) in [(soft, 0.3), (hard, 2.9)] {
            near(&s.at(body, &[x, 2.0]).unwrap().u[..2], &[0.0, -8.0 * 2.0 / 4.0]);
        }
        near(&s.reaction(soft.side("v0")).unwrap(), &[0.0, 2.0]);
        near(&s.reaction(hard.side("v0")).unwrap(), &[0.0, 6.0]);
        // spread evenly over both: half of it on each
        let (mut p, soft, hard) = bars();
        let tops = p.union([soft.side("v1").into(), Region::from(hard.side("v1"))]).unwrap();
        p.force(tops, 1, -8.0).unwrap();
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        near(&s.reaction(soft.side("v0")).unwrap(), &[0.0, 4.0]);
        near(&s.at(hard, &[2.5, 2.0]).unwrap().u[..2], &[0.0, -4.0 * 2.0 / 3.0]);
    }
}

/// A square turned by 30 degrees slides along its bottom and is pulled along it: a bar, u = s t.
#[test]
fn sliding_along_an_inclined_side_leaves_its_tangent_free() {
    let (s, c) = (30.0_f64.to_radians().sin(), 30.0_f64.to_radians().cos());
    for along_normal in [true, false] {
        let spec = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap().rotate(&turn(30.0))).with_elements([2, 2]);
        let mut p = Problem::<1, 2>::new();
        let a = p.body("a", Patch::try_new(&spec).unwrap(), steel(2.0)).unwrap();
        if along_normal {
            p.fix_normal(a.side("v0")).unwrap();
            p.fix_normal(a.side("u0")).unwrap();
        } else {
            // tangent of the left side is the normal of the bottom: with two sides the square turns about their corner
            p.fix_tangential(a.side("u0")).unwrap();
            p.fix_tangential(a.side("v0")).unwrap();
            assert!(matches!(p.assemble().unwrap_err().0[0].kind, ErrorKind::Motions(_)));
            p.fix_tangential(a.side("u1")).unwrap();
        }
        p.traction(a.side("u1"), 0, c).unwrap();
        p.traction(a.side("u1"), 1, s).unwrap();
        let solution = p.assemble().unwrap().solve(1.0, None).unwrap();
        if along_normal {
            near(&solution.at(a, &[0.7 * c - 0.4 * s, 0.7 * s + 0.4 * c]).unwrap().u[..2], &[0.35 * c, 0.35 * s]);
            near(&solution.reaction(a.side("u0")).unwrap(), &[-c, -s]);
            near(&solution.reaction(a.side("v0")).unwrap(), &[0.0, 0.0]);
        } else {
            let sum: Vec<f64> = (0..2).map(|k| ["u0", "v0", "u1"].iter().map(|n| solution.reaction(a.side(n)).unwrap()[k]).sum()).collect();
            near(&sum, &[-c, -s]);
        }
    }
}

/// The weight of a hanging bar, and of two sources that add up, is carried by the support.
#[test]
fn weights_and_sources_add_up() {
    for is_mesh in [false, true] {
        let mut p = Problem::<2, 3>::new();
        let bar = p.body("bar", solid([0.0; 3], [1.0, 2.0, 3.0], is_mesh), Hooke::solid(1.0, 0.0).unwrap()).unwrap();
        p.fix(bar.side("w1"), Components::All).unwrap();
        p.gravity(bar, Data::of(|x, _| 1.0 + x[2]), [0.0, 0.0, -2.0]).unwrap();
        for _ in 0..2 {
            p.source(bar, vec![0.5.into(), 0.0.into(), 0.0.into()]).unwrap();
        }
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        // ∫ (1 + z) dz over 3 = 7.5, times 2 by 1 and 2
        near(&s.reaction(bar.side("w1")).unwrap(), &[-6.0, 0.0, 30.0]);
    }
}

/// A cube held at its bottom face along z, on two edges beside it: u = -z/10 under a pressure of 1/10 on part of the top twice as large
/// in sum; the part and the rest of a face are the face.
#[test]
fn parts_edges_and_corners_are_regions() {
    for is_mesh in [false, true] {
        let mut p = Problem::<2, 3>::new();
        let cube = p.body("cube", solid([0.0; 3], [1.0; 3], is_mesh), Hooke::solid(1.0, 0.3).unwrap()).unwrap();
        p.fix(cube.side("w0"), Components::Z).unwrap();
        let edge = p.meeting(&[cube.side("u0"), cube.side("w0")]).unwrap();
        let corner = p.meeting(&[cube.side("u0"), cube.side("v0"), cube.side("w0")]).unwrap();
        assert_eq!(edge, p.meeting(&[cube.side("u0"), cube.side("w0")]).unwrap());
        p.fix(edge, Components::X).unwrap();
        p.prescribe(corner, 1, 0.0).unwrap();
        let left = p.part(cube.side("w1"), "x < 1/2", &|x: &Vector<3>| x[0] < 0.5).unwrap().unwrap();
        let right = p.part(cube.side("w1"), "x > 1/2", &|x: &Vector<3>| x[0] > 0.5).unwrap().unwrap();
        assert!(p.part(cube.side("w1"), "x > 2", &|x: &Vector<3>| x[0] > 2.0).unwrap().is_none());
        p.pressure(left, 0.1).unwrap();
        p.force(right, 2, -0.05).unwrap();
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        near(&s.at(cube, &[0.5, 0.25, 1.0]).unwrap().u, &[0.015, 0.0075, -0.1]);
        near(&s.reaction(cube.side("w0")).unwrap(), &[0.0, 0.0, 0.1]);
        near(&s.reaction(edge).unwrap(), &[0.0; 3]);
        let error = p.pressure(edge, 1.0).unwrap_err();
        assert_eq!((&error.kind, error.names()), (&ErrorKind::NotASide, &["cube.u0w0".to_owned()][..]));
        assert_eq!(p.meeting(&[cube.side("u0"), cube.side("u1")]).unwrap_err().kind, ErrorKind::NoRegion);
        assert_eq!(p.meeting(&[cube.side("u0")]).unwrap_err().kind, ErrorKind::NoRegion);
    }
}

/// Squares that share a side are one rectangle; an equation and a shared corner bind what is left.
#[test]
fn glued_sides_shared_points_and_equations_bind() {
    let pulled = |join: &dyn Fn(&mut Problem<1, 2>, BodyId, BodyId)| {
        let mut p = Problem::<1, 2>::new();
        let a = p.body("a", plane([0.0, 0.0], [1.0, 1.0], true), steel(1.0)).unwrap();
        let b = p.body("b", plane([0.0, 1.0], [1.0, 2.0], true), steel(1.0)).unwrap();
        p.fix(a.side("v0"), Components::All).unwrap();
        p.fix(b.side("u0"), Components::X).unwrap();
        join(&mut p, a, b);
        p.traction(b.side("v1"), 1, 0.1).unwrap();
        let s = p.assemble().map_err(|e| e.0[0].kind.clone())?.solve(1.0, None).unwrap();
        Ok::<_, ErrorKind>((s.at(b, &[0.5, 2.0]).unwrap().u[1], s.at(a, &[1.0, 1.0]).unwrap().u[1] - s.at(b, &[1.0, 1.0]).unwrap().u[1]))
    };
    let (top, jump) = pulled(&|p, a, b| {
        p.glue(b.side("v0"), a.side("v1"), None).unwrap();
    })
    .unwrap();
    assert!((top - 0.2).abs() < 1e-12 && jump == 0.0, "{top}, {jump}");
    // functions of the corners (1, 1): the last of the first row of b, the last of all of a
    let of_a = plane([0.0, 0.0], [1.0, 1.0], true).space().num_functions() - 1;
    let of_b = (0..of_a + 1).find(|&k| corner(k)).unwrap();
    let (_, jump) = pulled(&|p, a, b| {
        p.share(&[(a, of_a), (b, of_b)], [1.0, 1.0]).unwrap();
    })
    .unwrap();
    assert!(jump.abs() < 1e-12, "{jump}");
    let (_, jump) = pulled(&|p, a, b| {
        p.fix(b.side("v0"), Components::Y).unwrap();
        let unknown = |body, function| Unknown { body, function, component: 1 };
        p.equation(&[(unknown(a, of_a), 1.0), (unknown(b, of_b), -1.0)], 0.05).unwrap();
    })
    .unwrap();
    assert!((jump - 0.05).abs() < 1e-12, "{jump}");
    assert!(matches!(pulled(&|_, _, _| ()), Err(ErrorKind::Motions(_))));
}

/// Whether a function of the upper square is one in its corner (1, 1).
fn corner(function: usize) -> bool {
    let body = plane([0.0, 1.0], [1.0, 2.0], true);
    let space = &**body.space();
    let (mut ids, mut table, mut map) = (Vec::new(), faying::basis::ShapeTable::new(), faying::geometry::MapTable::new());
    (0..space.num_elements()).any(|e| {
        space.active(e, &mut ids);
        space.evaluate(e, &[Vector::<2>::new(1.0, 0.0)], faying::basis::Order::Values, &mut table, &mut map);
        let here = (map.x[0] - Vector::<2>::new(1.0, 1.0)).norm() < 1e-12;
        here && ids.iter().zip(table.values(0)).any(|(&i, v)| i == function && (v - 1.0).abs() < 1e-12)
    })
}

/// All errors come at once, each with its statements.
#[test]
fn errors_refer_to_statements() {
    let mut p = Problem::<1, 2>::new();
    let varying = Hooke::varying(
        |x: &Vector<2>| Elastic::Young { young: Jet::constant(1.0 - x[0]), poisson: Jet::constant(0.3) },
        Assumption::PlaneStrain,
    );
    let weak = BodySpec::new("weak", plane([0.0, 0.0], [2.0, 1.0], true), BodyMaterial::of(varying).unwrap());
    let weak = p.add(weak).unwrap();
    let sound = p.body("sound", plane([3.0, 0.0], [4.0, 1.0], false), steel(1.0)).unwrap();
    p.times(&[0.0, 0.5, 1.0]);
    let first = p.fix(sound.side("v0"), Components::All).unwrap();
    let second = p.prescribe(sound.side("v0"), 1, 0.1).unwrap();
    let push = p.traction(sound.side("v1"), 0, Data::of(|_, t| 1.0 / (t - 0.5))).unwrap();
    p.name(push, "push");
    let exact = p.prescribe(weak.side("v0"), 0, Value::Exact).unwrap();
    let seam = p.glue(weak.side("u1"), sound.side("u0"), None).unwrap();
    let error = p.assemble().unwrap_err();
    let of = |wanted: &dyn Fn(&ErrorKind) -> bool| {
        let found: Vec<_> = error.0.iter().filter(|e| wanted(&e.kind)).collect();
        assert_eq!(found.len(), 1, "{error}");
        found[0].of.clone()
    };
    assert_eq!(of(&|k| matches!(k, ErrorKind::OutOfLimits { x, .. } if x[0] >= 1.0)), vec![weak.into()]);
    assert_eq!(of(&|k| *k == ErrorKind::Twice { component: 1 }), vec![first, second]);
    assert_eq!(of(&|k| matches!(k, ErrorKind::NotFinite { t, component: 0, .. } if *t == 0.5)), vec![push]);
    assert_eq!(of(&|k| *k == ErrorKind::NoExact), vec![exact]);
    assert_eq!(of(&|k| matches!(k, ErrorKind::Glue(_))), vec![seam]);
    assert_eq!(error.0.len(), 5, "{error}");
    // values that contradict each other in a corner
    let mut p = Problem::<1, 2>::new();
    let a = p.body("a", plane([0.0, 0.0], [1.0, 1.0], false), steel(1.0)).unwrap();
    let one = p.fix(a.side("v0"), Components::All).unwrap();
    let other = p.prescribe(a.side("u0"), 0, 0.3).unwrap();
    let error = p.assemble().unwrap_err().0.remove(0);
    assert!(matches!(error.kind, ErrorKind::Prescribed { .. }) && error.of == [one, other], "{error}");
}

/// A block on two others: the sides that touch are found, glued or tied, and one hears of those that nearly do.
#[test]
fn sides_that_touch_are_found() {
    for (is_mesh, is_glued) in [(false, false), (true, false), (true, true)] {
        let mut p = Problem::<1, 2>::new();
        let block = |p: &mut Problem<1, 2>, name: &str, x: [f64; 2], y: [f64; 2]| {
            p.body(name, plane([x[0], y[0]], [x[1], y[1]], is_mesh), steel(1.0)).unwrap()
        };
        let left = block(&mut p, "left", [0.0, 1.0], [0.0, 1.0]);
        let top = block(&mut p, "top", [0.0, 1.0], [1.0, 2.0]);
        let far = block(&mut p, "far", [5.0, 6.0], [0.0, 1.0]);
        p.fix(left.side("v0"), Components::All).unwrap();
        p.fix(far.side("v0"), Components::All).unwrap();
        p.traction(top.side("v1"), 1, 1.0).unwrap();
        let error = p.tie_touching(&[left, far], None).unwrap_err();
        assert!(matches!(error.kind, ErrorKind::NothingTouches { distance: Some(d) } if (d - 4.0).abs() < 1e-12), "{error}");
        assert_eq!(error.names(), ["left.u1", "far.u0"]);
        if is_glued {
            p.glue_touching(&[left, top, far], None).unwrap();
        } else {
            let tie = p.tie_touching(&[left, top, far], None).unwrap().named("found").id();
            assert_eq!(p.pairs(tie).unwrap(), [("left.v1", vec!["top.v0"])]);
        }
        assert!(p.is_coupled(top.side("v0")).unwrap() && !p.is_coupled(far.side("v1")).unwrap());
        // what is joined is not found again
        assert!(matches!(p.tie_touching(&[left, top], None).unwrap_err().kind, ErrorKind::NothingTouches { .. }));
        let mut system = p.assemble().unwrap();
        assert_eq!(system.warnings(), []);
        let s = system.solve(1.0, None).unwrap();
        near(&s.at(top, &[0.4, 2.0]).unwrap().u[..2], &[0.0, 2.0]);
    }
}

/// Named arcs of chords: as far apart as their facets explain they are tied in silence, farther with a warning.
#[test]
fn facets_of_named_sides_explain_their_distance_or_one_hears_of_it() {
    let warned = |gap: f64| {
        let mut p = Problem::<1, 2>::new();
        let ring = |a: f64, b: f64, n: usize| {
            let net = faying::geometry::shapes::annulus_sector([0.0; 2], [a, b], [0.0, 90.0]).unwrap();
            Mesh::<1, 2>::from_patch(&PatchSpec::new(net).with_degree([1, 1]).with_elements([n, 2])).unwrap()
        };
        let inner = p.body("inner", ring(1.0, 2.0, 4), steel(1.0)).unwrap();
        let outer = p.body("outer", ring(2.0 + gap, 3.0, 6), steel(1.0)).unwrap();
        p.fix(inner.side("v0"), Components::All).unwrap();
        p.pressure(outer.side("v1"), 0.1).unwrap();
        p.tie(inner.side("v1"), outer.side("v0")).unwrap();
        let system = p.assemble().ok()?;
        let found = system.warnings().iter().filter(|w| matches!(w, Warning::FacetsApart(FacetsApart { is_tied: true, .. }))).count();
        Some(found)
    };
    assert_eq!([0.0, 0.005, 0.02, 0.06, 0.3].map(warned), [Some(0), Some(0), Some(1), Some(1), None]);
}
