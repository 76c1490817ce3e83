//! The search for touching sides: slaves and masters, sides that nearly touch, bodies that overlap; splines and meshes, plane and space.

use faying::geometry::shapes::{annulus_sector, brick};
use faying::physics::Conductor;
use faying::problem::touching::{Finding, PairedSides, Position, Search, TouchError};
use faying::problem::{InterfaceSide, Problem};
use faying::space::{Body, Mesh, Patch, PatchSpec, Trace};
use std::sync::Arc;

/// A box with its number of elements per direction, as a spline or as a mesh.
#[derive(Clone, Copy)]
struct Block<const N: usize> {
    min: [f64; N],
    max: [f64; N],
    elements: usize,
    is_mesh: bool,
}

/// A unit box whose last coordinate begins at `low`, moved by `along` in the first.
fn block<const N: usize>(along: f64, low: f64, elements: usize, is_mesh: bool) -> Block<N> {
    let min = std::array::from_fn(|k| {
        if k + 1 == N {
            low
        } else if k == 0 {
            along
        } else {
            0.0
        }
    });
    Block { min, max: min.map(|x| x + 1.0), elements, is_mesh }
}

/// Lets `ask` search among the blocks.
fn search<const S: usize, const N: usize, R>(blocks: &[Block<N>], ask: impl FnOnce(&mut Search<'_, S, N>) -> R) -> R
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let mut problem = Problem::new();
    for (k, b) in blocks.iter().enumerate() {
        let spec = PatchSpec::new(brick(b.min, b.max).unwrap()).with_degree([1; N]).with_elements([b.elements; N]);
        let body: Arc<dyn Body<S, N>> = match b.is_mesh {
            true => Arc::new(Mesh::from_patch(&spec).unwrap()),
            false => Arc::new(Patch::try_new(&spec).unwrap()),
        };
        problem.body::<1>(&format!("b{k}"), body, Conductor::<N>::try_new(1.0).unwrap()).unwrap();
    }
    problem.look_for_touching(ask)
}

/// Slaves with their masters, by label.
fn names<const S: usize, const N: usize>(couples: &[PairedSides<S, N>]) -> Vec<(&str, Vec<&str>)> {
    couples.iter().map(|c| (c.slave.label(), c.masters.iter().map(|m| m.label()).collect())).collect()
}

/// Bottom and top side.
fn ends(dimension: usize) -> [&'static str; 2] {
    if dimension == 2 { ["v0", "v1"] } else { ["w0", "w1"] }
}

fn touching_boxes<const S: usize, const N: usize>(is_mesh: [bool; 2])
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let [bottom, top] = ends(N);
    let [lower, upper] = [format!("b0.{top}"), format!("b1.{bottom}")];
    // both are covered: the finer one is the slave
    for (elements, slave) in [([4, 2], &lower), ([2, 4], &upper), ([2, 2], &lower)] {
        let blocks = [block(0.0, 0.0, elements[0], is_mesh[0]), block(0.0, 1.0, elements[1], is_mesh[1])];
        search::<S, N, _>(&blocks, |search| {
            let master = if slave == &lower { &upper } else { &lower };
            let found = search.tie_touching(&[0, 1], None).unwrap();
            assert_eq!(names(&found), [(slave.as_str(), vec![master.as_str()])]);
            assert!(!found[0].is_named && found[0].tolerance.is_none() && found[0].explained.unwrap() < 1e-6);
            let share = &found[0].shares()[0];
            assert!((share.share - 1.0).abs() < 1e-12 && share.distance < 1e-12, "{share:?}");
            // what is joined is not found again
            assert!(matches!(search.tie_touching(&[0, 1], None), Err(TouchError::Nothing { nearest: None })));
            search.unjoined(&[], &[], &|_| true);
            assert!(search.findings.is_empty(), "{:?}", search.findings);
        });
    }
    // half of the lower side is covered: the upper one is the slave, though it is coarser
    let mut wide = block(0.0, 0.0, 8, is_mesh[0]);
    wide.max[0] = 2.0;
    let couples = search::<S, N, _>(&[wide, block(0.0, 1.0, 2, is_mesh[1])], |search| search.tie_touching(&[1, 0], None).unwrap());
    assert_eq!(names(&couples), [(upper.as_str(), vec![lower.as_str()])]);
}

#[test]
fn of_two_boxes_that_touch_the_covered_or_finer_side_is_the_slave() {
    for is_mesh in [[false, false], [false, true], [true, true]] {
        touching_boxes::<1, 2>(is_mesh);
        touching_boxes::<2, 3>(is_mesh);
    }
}

#[test]
fn one_slave_lies_on_two_masters_and_pairs_that_are_excluded_are_left_out() {
    let mut upper = block::<2>(0.0, 1.0, 8, false);
    upper.max[0] = 2.0;
    let blocks = [block(0.0, 0.0, 2, false), block(1.0, 0.0, 2, true), upper];
    search::<1, 2, _>(&blocks, |search| {
        let found = search.tie_touching(&[0, 1], None).unwrap();
        assert_eq!(names(&found), [("b0.u1", vec!["b1.u0"])]);
        let found = search.tie_touching(&[0, 1, 2], None).unwrap();
        assert_eq!(names(&found), [("b2.v0", vec!["b0.v1", "b1.v1"])]);
        let shares: Vec<f64> = found[0].shares().iter().map(|s| s.share).collect();
        // points on the border belong to one of both
        assert!((shares[0] + shares[1] - 1.0).abs() < 1e-12 && (shares[0] - 0.5).abs() < 0.05, "{shares:?}");
    });
    search::<1, 2, _>(&blocks, |search| {
        search.exclude((2, "v0"), (1, "v1"));
        let parted = [[0, 1].into_iter().collect()];
        assert_eq!(names(&search.glue_touching(&[0, 1, 2], &parted).unwrap()), [("b0.v1", vec!["b2.v0"])]);
    });
}

fn near_boxes<const S: usize, const N: usize>(is_mesh: bool)
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let gap = 0.9e-3 / 4.0;
    let blocks = [block(0.0, 0.0, 4, is_mesh), block(0.0, 1.0 + gap, 4, is_mesh), block(1.0, 0.0, 4, is_mesh)];
    search::<S, N, _>(&blocks, |search| {
        // flat facets explain no distance
        let error = search.tie_touching(&[0, 1], None).unwrap_err();
        let TouchError::Nothing { nearest: Some(pair) } = &error else { panic!("{error}") };
        assert!((pair.facing.distance - gap).abs() < 1e-9 && (pair.facing.gap - gap).abs() < 1e-9 && pair.facing.share == 1.0);
        let [bottom, top] = ends(N);
        assert_eq!(pair.sides.each_ref().map(|s| (s.body(), s.name())), [(0, top), (1, bottom)]);
        // near enough to be told at once, and then no more
        assert!(matches!(&search.findings[..], [Finding::NotTied { clearance, .. }] if (clearance.mean() - gap).abs() < 1e-9));
        search.findings.clear();
        search.nearly_touching(&[0, 1]);
        search.unjoined(&[], &[], &|_| true);
        assert!(matches!(&search.findings[..], [Finding::Unjoined { position: Position::Touch, .. }]), "{:?}", search.findings);
        assert_eq!(search.findings[0].patches(), [0, 2]);
        // a tolerance ties them
        assert_eq!(search.tie_touching(&[0, 1], Some(2.0 * gap)).unwrap()[0].tolerance, Some(2.0 * gap));
    });
    // a list that ties other sides tells of these
    let far = [block(0.0, 0.0, 4, is_mesh), block(0.0, 1.0 + 0.01, 4, is_mesh), block(1.0, 0.0, 4, is_mesh)];
    search::<S, N, _>(&far, |search| {
        assert_eq!(search.tie_touching(&[0, 1, 2], None).unwrap().len(), 1);
        search.nearly_touching(&[0, 1, 2]);
        assert!(
            matches!(&search.findings[..], [Finding::Near(pair)] if (pair.facing.distance - 0.01).abs() < 1e-9),
            "{:?}",
            search.findings
        );
        search.unjoined(&[], &[], &|_| true);
        assert_eq!(search.findings.len(), 1);
    });
}

#[test]
fn sides_that_are_apart_by_less_than_a_thousandth_of_a_facet_are_told_and_not_tied() {
    for is_mesh in [false, true] {
        near_boxes::<1, 2>(is_mesh);
        near_boxes::<2, 3>(is_mesh);
    }
}

fn overlapping_boxes<const S: usize, const N: usize>(is_mesh: bool)
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let [bottom, top] = ends(N);
    let found = |blocks: &[Block<N>], contacts: &[[usize; 2]], outer: Option<(usize, &str)>| {
        search::<S, N, _>(blocks, |search| {
            let outer: Vec<_> = outer.into_iter().map(|(k, name)| search.side(k, name).unwrap()).collect();
            search.unjoined(contacts, &outer, &|_| true);
            std::mem::take(&mut search.findings)
        })
    };
    // by half of their height: no side is near another one
    let deep = [block(0.25, 0.0, 4, is_mesh), block(0.0, 0.5, 4, is_mesh)];
    let list = found(&deep, &[], None);
    let [Finding::Overlap { patches: [0, 1], x }] = &list[..] else { panic!("{list:?}") };
    assert!((0.25..=1.0).contains(&x[0]) && (0.5..=1.0).contains(&x[N - 1]), "{x}");
    assert!(found(&deep, &[[1, 0]], None).is_empty());
    // by a hundredth: the sides are told, unless one of them is meant to be open
    let press = [block(0.25, 0.0, 4, is_mesh), block(0.0, 0.99, 4, is_mesh)];
    let list = found(&press, &[], None);
    let [Finding::Unjoined { sides: [a, b], position: Position::Overlap(depth) }] = &list[..] else { panic!("{list:?}") };
    assert!(a.name() == top && b.name() == bottom && (depth - 0.01).abs() < 1e-9);
    assert!(found(&press, &[], Some((0, top))).is_empty());
}

#[test]
fn bodies_that_overlap_are_told_unless_a_contact_or_an_open_side_says_so() {
    for is_mesh in [false, true] {
        overlapping_boxes::<1, 2>(is_mesh);
        overlapping_boxes::<2, 3>(is_mesh);
    }
}

#[test]
fn named_sides_are_tied_and_told_if_nothing_explains_their_distance() {
    let tie = |body: &dyn Fn(f64, usize) -> Arc<dyn Body<1, 2>>, gap: f64| {
        let mut problem = Problem::<1, 2>::new();
        for (name, low, n) in [("inner", 0.0, 4), ("outer", 1.0 + gap, 6)] {
            problem.body::<1>(name, body(low, n), Conductor::<2>::try_new(1.0).unwrap()).unwrap();
        }
        problem.look_for_touching(|search| {
            let (slave, master) = (search.side(1, "v0").unwrap(), search.side(0, "v1").unwrap());
            let greatest = search.sag(&slave).greatest();
            let couple = search.tie(slave, vec![master], None);
            (couple, greatest, std::mem::take(&mut search.findings))
        })
    };
    // an annulus of chords, whose inner ring ends where the outer one begins
    let chords = |low: f64, n: usize| -> Arc<dyn Body<1, 2>> {
        let net = annulus_sector([0.0; 2], [1.0 + low, 2.0 + low], [0.0, 90.0]).unwrap();
        Arc::new(Mesh::from_patch(&PatchSpec::new(net).with_degree([1; 2]).with_elements([n; 2])).unwrap())
    };
    let (couple, greatest, findings) = tie(&chords, 0.0);
    assert!(couple.is_named && couple.explained.unwrap() >= 4.0 * greatest && greatest > 0.0 && findings.is_empty(), "{findings:?}");
    let (couple, _, findings) = tie(&chords, 0.1);
    assert!(couple.explained.is_none());
    assert!(matches!(&findings[..], [Finding::NotExplained { clearance, .. }] if clearance.mean() > clearance.allowed()), "{findings:?}");
}
