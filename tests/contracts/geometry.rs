//! Shapes, bodies and closest points against lengths, areas and volumes known in closed form.

use faying::basis::{BSpline, Basis, Cell, Elements, LagrangeLine, Order, Rational, ShapeTable};
use faying::geometry::{ClosestPoint, ControlNet, ControlPoints, Geometry, MapTable, Projection, closest_point, shapes};
use faying::linalg::Vector;
use faying::space::{
    BasisKind, Body, Deformed, Field, Locator, Mapping, Mesh, Patch, PatchSpec, SideError, SpecError, field_at, locate, measure,
};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

type Plane = Box<dyn Body<1, 2>>;

/// All kinds of body of one geometry, with names.
fn kinds(net: &ControlNet<2, 2>, elements: [usize; 2], degree: usize) -> Vec<(String, Plane)> {
    let spec = PatchSpec::new(net.clone()).with_elements(elements).with_degree([degree; 2]);
    let mut all: Vec<(String, Plane)> = vec![
        ("b-spline".into(), Box::new(Patch::<1, 2>::try_new(&spec.clone().with_basis(BasisKind::BSpline)).unwrap())),
        ("auto".into(), Box::new(Patch::<1, 2>::try_new(&spec).unwrap())),
        ("c0".into(), Box::new(Patch::<1, 2>::try_new(&spec.clone().with_continuity(0)).unwrap())),
    ];
    for cells in [Cell::Tensor, Cell::Simplex] {
        for mapping in [Mapping::Isoparametric, Mapping::Exact] {
            if cells == Cell::Simplex && degree > 4 {
                continue;
            }
            let spec = spec.clone().with_cells(cells).with_mapping(mapping);
            all.push((format!("{cells:?} {mapping:?}"), Box::new(Mesh::<1, 2>::from_patch(&spec).unwrap())));
        }
    }
    all
}

fn ring() -> ControlNet<2, 2> {
    shapes::annulus_sector([0.3, -0.2], [1.0, 2.0], [0.0, 90.0]).unwrap()
}

fn mirrored(net: &ControlNet<2, 2>) -> ControlNet<2, 2> {
    let mut net = net.clone();
    net.points.iter_mut().for_each(|p| p[0] = -p[0]);
    net
}

/// Geometries with their areas.
fn geometries() -> Vec<(&'static str, ControlNet<2, 2>, f64)> {
    let ring_area = PI / 4.0 * 3.0;
    vec![
        ("rectangle", shapes::rectangle([-1.0, 0.5], [2.0, 1.5]).unwrap(), 3.0),
        ("ring", ring(), ring_area),
        ("left-handed ring", mirrored(&ring()), ring_area),
        ("falling angle", shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [250.0, 10.0]).unwrap(), 3.0 * PI * 240.0 / 360.0),
        ("full ring", shapes::annulus_sector([0.0, 0.0], [0.5, 1.0], [-90.0, 270.0]).unwrap(), 0.75 * PI),
        ("half disc", shapes::disc_sector([1.0, 4.0], 3.0, [180.0, 360.0]).unwrap(), 4.5 * PI),
        ("disc", shapes::disc_sector([0.0, 0.0], 1.0, [0.0, -360.0]).unwrap(), PI),
        ("plate", shapes::plate_with_hole(1.0, 4.0).unwrap(), 16.0 - PI / 4.0),
    ]
}

/// |∮ n ds|, and ∮ x . n ds / 2 = area, over all sides and the sides alone.
fn gauss(body: &dyn Body<1, 2>) -> (f64, f64) {
    let rule = faying::quadrature::gauss_legendre::<f64>(24);
    let mut table = MapTable::new();
    let (mut flux, mut area) = (Vector::<2>::zeros(), 0.0);
    for side in body.sides() {
        let trace = body.trace(&side).unwrap();
        for e in 0..trace.space.num_elements() {
            trace.space.map(e, &rule.points, Order::Gradients, &mut table);
            for q in 0..rule.points.len() {
                let n = trace.normal(e, &table.jacobian[q]) * (table.jacobian[q].norm() * rule.weights[q]);
                flux += n;
                area += 0.5 * table.x[q].dot(&n);
            }
        }
    }
    (flux.norm(), area)
}

#[test]
fn areas_of_exact_shapes_are_those_of_their_formulas() {
    for (name, net, area) in geometries() {
        for degree in [1, 2, 3] {
            for (kind, body) in kinds(&net, [4, 3], degree) {
                if kind.contains("Isoparametric") {
                    continue;
                }
                let found = measure(&**body.space());
                assert!((found - area).abs() < 1e-12 * area, "{name}, {kind}, degree {degree}: {found} instead of {area}");
            }
        }
    }
}

#[test]
fn gauss_theorem_holds_on_every_kind_of_body() {
    for (name, net, _) in geometries() {
        for degree in 1..=4 {
            for (kind, body) in kinds(&net, [3, 2], degree) {
                let (flux, area) = gauss(&*body);
                let found = measure(&**body.space());
                assert!(
                    flux < 1e-12 * area && (found - area).abs() < 1e-12 * area,
                    "{name}, {kind}, degree {degree}: {flux:e}, {found} against {area}"
                );
            }
        }
    }
}

#[test]
fn lengths_and_volumes_of_exact_shapes_are_those_of_their_formulas() {
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12 * expected, "{found} instead of {expected}");
    let length = |body: &dyn Body<1, 2>, side: &str| measure(&*body.trace(side).unwrap().space);
    for (_, body) in kinds(&ring(), [5, 2], 2).into_iter().filter(|k| !k.0.contains("Iso")) {
        near(length(&*body, "v0"), PI / 2.0);
        near(length(&*body, "top"), PI);
        near(length(&*body, "left"), 1.0);
    }
    let disc = shapes::disc_sector([1.0, 4.0], 3.0, [180.0, 400.0]).unwrap();
    let plate = shapes::plate_with_hole(1.0, 4.0).unwrap();
    for (_, body) in kinds(&disc, [3, 2], 3).into_iter().filter(|k| !k.0.contains("Iso")) {
        near(length(&*body, "v1"), 3.0 * PI * 220.0 / 180.0);
        near(length(&*body, "u1"), 3.0);
        assert_eq!(body.trace("bottom").unwrap_err(), SideError::Collapsed { side: "bottom".into() });
        assert_eq!(body.sides(), ["u0", "u1", "v1"]);
    }
    for (_, body) in kinds(&plate, [4, 2], 2) {
        near(length(&*body, "v1"), 8.0);
        near(length(&*body, "u0"), 3.0);
    }
    // volumes: a box, a ring 1 < r < 2 over 90 degrees of height 0.5, a half cylinder
    let volume = |net: &ControlNet<3, 3>| {
        let patch = Patch::<2, 3>::try_new(&PatchSpec::new(net.clone()).with_elements([2, 1, 2])).unwrap();
        let faces: f64 = patch.sides().iter().map(|s| measure(&*patch.trace(s).unwrap().space)).sum();
        (measure(&**patch.space()), faces)
    };
    let (v, s) = volume(&shapes::brick([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]).unwrap());
    near(v, 6.0);
    near(s, 22.0);
    let (v, s) = volume(&ring().extrude(0.5));
    near(v, 3.0 * PI / 8.0);
    near(s, 2.0 * 3.0 * PI / 4.0 + 0.5 * (1.5 * PI + 2.0));
    let (v, _) = volume(&shapes::disc_sector([0.0, 0.0], 2.0, [0.0, 180.0]).unwrap().extrude(1.5));
    near(v, 3.0 * PI);
}

#[test]
fn points_of_arcs_lie_on_their_circles() {
    for angles in [[0.0, 90.0], [90.0, 0.0], [13.0, 14.0], [-200.0, 159.0], [0.0, 360.0], [45.0, -315.0], [0.0, 90.0000001]] {
        let net = shapes::annulus_sector([2.0, 1.0], [3.0, 5.0], angles).unwrap();
        let arcs = (f64::abs(angles[1] - angles[0]) / 90.0 - 1e-12).ceil() as usize;
        assert_eq!(net.axes[0].breakpoints().len() - 1, arcs, "{angles:?}");
        let patch = Patch::<1, 2>::try_new(&PatchSpec::new(net)).unwrap();
        for (side, radius) in [("v0", 3.0), ("v1", 5.0)] {
            let trace = patch.trace(side).unwrap();
            let mut table = MapTable::new();
            for e in 0..trace.space.num_elements() {
                trace.space.map(e, &[0.0, 0.2, 0.7, 1.0].map(Vector::<1>::new), Order::Values, &mut table);
                assert!(table.x.iter().all(|x| ((x - Vector::<2>::new(2.0, 1.0)).norm() - radius).abs() < 1e-14 * 10.0));
            }
            let last = Vector::<2>::new(2.0 + radius * angles[1].to_radians().cos(), 1.0 + radius * angles[1].to_radians().sin());
            assert!((table.x[3] - last).norm() < 1e-14 * 10.0);
        }
    }
}

#[test]
fn numbers_that_make_no_shape_are_errors() {
    assert!(shapes::rectangle([0.0, 0.0], [1.0, 0.0]).unwrap_err().to_string().contains("along axis 1"));
    assert!(shapes::rectangle([0.0, f64::NAN], [1.0, 1.0]).is_err());
    assert!(shapes::annulus_sector([0.0, 0.0], [0.0, 1.0], [0.0, 90.0]).is_err());
    assert!(shapes::annulus_sector([0.0, 0.0], [1.0, 1.0], [0.0, 90.0]).is_err());
    assert!(shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 0.0]).is_err());
    assert!(shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 361.0]).unwrap_err().to_string().contains("361"));
    assert!(shapes::annulus_sector([0.0, 0.0], [1.0, f64::INFINITY], [0.0, 90.0]).is_err());
    assert!(shapes::disc_sector([0.0, 0.0], -1.0, [0.0, 90.0]).is_err());
    assert!(shapes::plate_with_hole(1.0, 1.0).is_err());
    assert!(shapes::plate_with_hole(-1.0, 1.0).is_err());
}

#[test]
fn what_cannot_be_made_of_a_patch_is_a_clear_error() {
    let spec = PatchSpec::new(ring());
    let patch = |s: PatchSpec<2>| Patch::<1, 2>::try_new(&s).map(|_| ()).unwrap_err();
    let mesh = |s: PatchSpec<2>| Mesh::<1, 2>::from_patch(&s).map(|_| ()).unwrap_err();
    // NURBS of degree 1 cannot carry the arc's weights; auto takes B-splines there
    let low = spec.clone().with_degree([1, 1]);
    assert_eq!(patch(low.clone().with_basis(BasisKind::Nurbs)), SpecError::DegreeTooLow { direction: 0, degree: 1, needed: 2 });
    assert!(Patch::<1, 2>::try_new(&low).unwrap().weights().is_none());
    // along the radius the weights are constant: degree 1 is enough there
    assert!(Patch::<1, 2>::try_new(&spec.clone().with_degree([2, 1])).unwrap().weights().is_some());
    assert!(matches!(patch(spec.clone().with_degree([13, 2])), SpecError::Degree { direction: 0, degree: 13, max: 12, .. }));
    assert!(matches!(patch(spec.clone().with_degree([2, 0])), SpecError::Degree { direction: 1, degree: 0, .. }));
    assert!(matches!(mesh(spec.clone().with_degree([9, 2])), SpecError::Degree { max: 8, .. }));
    assert!(matches!(mesh(spec.clone().with_degree([5, 5]).with_cells(Cell::Simplex)), SpecError::Degree { max: 4, .. }));
    assert!(matches!(mesh(spec.clone().with_degree([3, 2]).with_cells(Cell::Simplex)), SpecError::MixedDegree { .. }));
    assert_eq!(patch(spec.clone().with_continuity(2)), SpecError::Continuity { direction: 0, continuity: 2, degree: 2 });
    assert!(matches!(
        patch(spec.clone().with_breakpoints([vec![0.0, 1.5], vec![]])),
        SpecError::BreakpointOutside { direction: 0, index: 1, .. }
    ));
    assert!(matches!(
        patch(spec.clone().with_breakpoints([vec![], vec![0.0, 0.5, 0.5]])),
        SpecError::BreakpointsFall { direction: 1, index: 2, .. }
    ));
    let found = Patch::<1, 2>::try_new(&spec).unwrap().trace("v2").unwrap_err();
    assert_eq!(found.to_string(), "there is no side `v2`; sides are u0, u1, v0, v1");
    // one corner pulled through the opposite side: the map folds over
    let mut net = shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap();
    net.points[3] = Vector::<2>::new(0.2, 0.2);
    for error in [patch(PatchSpec::new(net.clone())), mesh(PatchSpec::new(net.clone()))] {
        let SpecError::Inverted(e) = error else { panic!("{error}") };
        // det = 1 - 0.8 (u + v): -0.6 at the corner itself
        let at = Vector::<3>::from(e.at) - Vector::<3>::new(0.2, 0.2, 0.0);
        assert!((e.least_jacobian + 0.6).abs() < 1e-14 && at.norm() < 1e-14 && e.element == 0, "{e:?}");
    }
}

#[test]
fn quality_tells_orientation_collapse_and_the_least_jacobian() {
    let patch = |net: ControlNet<2, 2>, n| Patch::<1, 2>::try_new(&PatchSpec::new(net).with_elements(n)).unwrap();
    // 7 x 3 elements of the box (0, 1) x (0, 1/2): 1/7 x 1/6
    let q = patch(shapes::rectangle([0.0, 0.0], [1.0, 0.5]).unwrap(), [7, 3]).quality().clone();
    assert!((q.least_jacobian - 1.0 / 42.0).abs() < 1e-15 && !q.left_handed && q.degenerate.is_empty());
    assert!(patch(ring(), [2, 2]).quality().least_jacobian > 0.0);
    // angle counterclockwise, radius outwards: left-handed
    assert!(patch(ring(), [2, 2]).quality().left_handed);
    assert!(!patch(mirrored(&ring()), [2, 2]).quality().left_handed);
    let disc = patch(shapes::disc_sector([0.0, 0.0], 1.0, [0.0, 90.0]).unwrap(), [3, 2]);
    assert_eq!((disc.quality().degenerate.clone(), disc.collapsed_sides()), (vec![0, 1, 2], vec!["v0".to_string()]));
    assert!(disc.quality().least_jacobian > 0.0);
}

#[test]
fn functions_at_a_collapsed_edge_are_one() {
    let net = shapes::disc_sector([0.0, 0.0], 1.0, [0.0, 90.0]).unwrap();
    let spec = PatchSpec::new(net).with_elements([3, 2]);
    let patch = Patch::<1, 2>::try_new(&spec).unwrap();
    assert_eq!(patch.space().num_functions(), 5 * 4 - 4);
    let mesh = |cells, mapping| Mesh::<1, 2>::from_patch(&spec.clone().with_cells(cells).with_mapping(mapping)).unwrap();
    for mapping in [Mapping::Isoparametric, Mapping::Exact] {
        assert_eq!(mesh(Cell::Tensor, mapping).space().num_functions(), 7 * 5 - 6);
        // the triangles without area go, those on the exact map stay; functions are merged either way
        let triangles = mesh(Cell::Simplex, mapping);
        let dropped = if mapping == Mapping::Isoparametric { 3 } else { 0 };
        assert_eq!(triangles.space().num_elements(), 12 - dropped);
        // a fan has no nodes between the rays of the first row but those of its triangles
        assert_eq!(triangles.space().num_functions(), 7 * 5 - 6 - dropped);
    }
    // the sum of all functions stays one, their gradient zero
    let mut ids = Vec::new();
    let mut table = ShapeTable::new();
    let space = patch.space();
    space.tabulate(0, &[Vector::<2>::new(0.3, 0.2)], Order::Gradients, &mut table);
    space.active(0, &mut ids);
    assert!((table.values(0).iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert!(table.grads(0).iter().sum::<Vector<2>>().norm() < 1e-14);
}

#[test]
fn splines_of_continuity_zero_and_lagrange_on_the_exact_map_are_twins() {
    for (name, net, _) in geometries() {
        for degree in 1..=4 {
            let spec = PatchSpec::new(net.clone()).with_elements([3, 2]).with_degree([degree; 2]).with_mapping(Mapping::Exact);
            let patch = Patch::<1, 2>::try_new(&spec.clone().with_continuity(0).with_basis(BasisKind::BSpline)).unwrap();
            let mesh = Mesh::<1, 2>::from_patch(&spec).unwrap();
            assert_eq!(patch.space().num_functions(), mesh.space().num_functions(), "{name}");
            assert_eq!(patch.space().num_elements(), mesh.space().num_elements(), "{name}");
            let points = [[0.1, 0.2], [0.9, 0.5], [1.0, 0.0]].map(Vector::<2>::from);
            let (mut a, mut b) = (MapTable::new(), MapTable::new());
            for e in 0..patch.space().num_elements() {
                patch.space().map(e, &points, Order::Gradients, &mut a);
                mesh.space().map(e, &points, Order::Gradients, &mut b);
                assert_eq!((&a.x, &a.jacobian), (&b.x, &b.jacobian), "{name}: the same map to the same bits");
            }
            for side in patch.sides() {
                let (a, b) = (patch.trace(&side).unwrap(), mesh.trace(&side).unwrap());
                assert_eq!((a.facets, a.outward, a.dofs.len()), (b.facets, b.outward, b.dofs.len()), "{name}, {side}");
            }
        }
    }
}

#[test]
fn sides_have_aliases_in_plane_and_space() {
    let patch = Patch::<1, 2>::try_new(&PatchSpec::new(ring())).unwrap();
    for (alias, name) in [("left", "u0"), ("right", "u1"), ("bottom", "v0"), ("top", "v1")] {
        assert_eq!(patch.trace(alias).unwrap().facets, patch.trace(name).unwrap().facets);
    }
    assert!(patch.trace("front").is_err() && patch.trace("w0").is_err());
    let patch = Patch::<2, 3>::try_new(&PatchSpec::new(ring().extrude(1.0))).unwrap();
    for (alias, name) in [("left", "u0"), ("right", "u1"), ("front", "v0"), ("back", "v1"), ("bottom", "w0"), ("top", "w1")] {
        assert_eq!(patch.trace(alias).unwrap().facets, patch.trace(name).unwrap().facets);
    }
}

#[test]
fn continuity_is_that_wanted_and_at_knots_of_the_geometry_what_it_has() {
    let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 180.0]).unwrap();
    let spec = PatchSpec::new(net).with_elements([4, 2]).with_degree([3, 2]);
    let axes = Patch::<1, 2>::try_new(&spec).unwrap().axes().clone();
    // breakpoint 2 is the knot between the two arcs
    assert_eq!((1..4).map(|b| axes[0].regularity(b)).collect::<Vec<_>>(), [2, 0, 2]);
    assert_eq!(axes[1].regularity(1), 1);
    let axes = Patch::<1, 2>::try_new(&spec.with_continuity(1)).unwrap().axes().clone();
    assert_eq!((1..4).map(|b| axes[0].regularity(b)).collect::<Vec<_>>(), [1, 0, 1]);
}

/// The least distance over a dense set of points of a curve, and how far it may be off.
fn brute_force(curve: &dyn Geometry<1, 2>, p: &Vector<2>) -> f64 {
    let points: Vec<Vector<1>> = (0..=2000).map(|i| Vector::<1>::new(i as f64 / 2000.0)).collect();
    let mut table = MapTable::new();
    (0..curve.num_elements())
        .map(|e| {
            curve.map(e, &points, Order::Values, &mut table);
            table.x.iter().map(|x| (x - p).norm()).fold(f64::INFINITY, f64::min)
        })
        .fold(f64::INFINITY, f64::min)
}

/// A curve on which the closest point is looked for.
fn curve(kind: usize, seed: u64) -> Box<dyn Geometry<1, 2>> {
    let noise = |i: usize| ((seed as f64 * 0.618 + 1.3) * (i as f64 + 1.0) * 12.9898).sin();
    match kind {
        0 => {
            let sweep = 20.0 + 340.0 * noise(1).abs();
            let net = shapes::annulus_sector([noise(2), noise(3)], [1.0, 2.0], [90.0 * noise(4), 90.0 * noise(4) + sweep]).unwrap();
            let patch = Patch::<1, 2>::try_new(&PatchSpec::new(net).with_elements([7, 1])).unwrap();
            Box::new(patch.trace("v1").unwrap().space)
        }
        1 => {
            let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 360.0]).unwrap();
            let mesh = Mesh::<1, 2>::from_patch(&PatchSpec::new(net).with_elements([5, 1]).with_cells(Cell::Simplex)).unwrap();
            Box::new(mesh.trace("v0").unwrap().space)
        }
        2 => {
            // wiggles and loops
            let spline = BSpline::uniform(2 + seed as usize % 4, 6, 1);
            let points =
                (0..spline.num_functions()).map(|i| Vector::<2>::new(0.4 * i as f64 + noise(2 * i), 2.0 * noise(2 * i + 1))).collect();
            Box::new(ControlPoints { basis: spline, points })
        }
        3 => {
            let line = LagrangeLine::<f64>::new(1 + seed as usize % 5, 4);
            let points = (0..line.num_functions()).map(|i| Vector::<2>::new(0.5 * i as f64, noise(i))).collect();
            Box::new(ControlPoints { basis: line, points })
        }
        _ => {
            let spline = BSpline::uniform(3, 5, 2);
            let n = spline.num_functions();
            let points = (0..n).map(|i| Vector::<2>::new(i as f64, 3.0 * noise(i))).collect();
            let weights = (0..n).map(|i| 1.0 + 0.9 * noise(i + 50)).collect();
            Box::new(ControlPoints { basis: Rational::new::<1>(spline, weights), points })
        }
    }
}

/// Within a piece of this curve the distance to one of its points has two minima, beside a place where the curve almost stops.
#[test]
fn minima_beside_a_place_where_the_curve_almost_stops_are_all_looked_at() {
    let curve = curve(2, 87);
    let mut table = MapTable::new();
    curve.map(3, &[Vector::<1>::new(0.7909364202178917)], Order::Values, &mut table);
    assert!(closest_point(&*curve, &table.x[0]).unwrap().distance <= 1e-14);
}

proptest! {
    #![proptest_config(crate::random::inputs(400))]

    /// Closest points are never farther than brute force plus 1e-9 of the size, and the distance is that of the point.
    #[test]
    fn closest_points_are_never_farther_than_brute_force(kind in 0usize..5, seed in 0u64..1000, x in -1.0f64..2.0, y in -1.5f64..1.5) {
        let curve = curve(kind, seed);
        let closest = ClosestPoint::<1, 2, _>::new(&*curve);
        let center = closest.tree().bounds().unwrap().center();
        let p = center + Vector::<2>::new(x - 0.5, y) * closest.size();
        let found: Projection<1, 2> = closest.project(&p).unwrap();
        prop_assert!(found.distance <= brute_force(&*curve, &p) + 1e-9 * closest.size());
        prop_assert!((0.0..=1.0).contains(&found.xi[0]));
        let mut table = MapTable::new();
        curve.map(found.element, &[found.xi], Order::Gradients, &mut table);
        prop_assert!((table.x[0] - found.x).norm() <= 1e-14 * closest.size());
        prop_assert!(((p - found.x).norm() - found.distance).abs() <= 1e-15 * closest.size().max(found.distance));
        // off the ends of an element the line to the point is at right angles to the curve
        if found.xi[0] > 0.0 && found.xi[0] < 1.0 {
            let t = table.jacobian[0].column(0).normalize();
            prop_assert!((p - found.x).dot(&t).abs() <= 1e-7 * closest.size() && !found.rim);
        }
        prop_assert_eq!(closest.project_within(&p, found.distance * 0.999), None);
        prop_assert_eq!(closest.project_within(&p, found.distance * 1.001 + 1e-12), Some(found));
    }

    /// Points on the curve are found on it.
    #[test]
    fn points_of_a_curve_are_their_own_closest_points(kind in 0usize..5, seed in 0u64..200, t in 0.0f64..1.0) {
        let curve = curve(kind, seed);
        let mut table = MapTable::new();
        curve.map(seed as usize % curve.num_elements(), &[Vector::<1>::new(t)], Order::Values, &mut table);
        let found = closest_point(&*curve, &table.x[0]).unwrap();
        prop_assert!(found.distance <= 1e-12 * 10.0, "{}", found.distance);
    }

    /// The point of an element is located in it, or in a neighbour at the same place.
    #[test]
    fn physical_points_are_located(which in 0usize..8, kind in 0usize..7, degree in 1usize..4, e in 0usize..1000, u in 0.0f64..1.0, v in 0.0f64..1.0) {
        let (_, net, _) = geometries().swap_remove(which);
        let (name, body) = kinds(&net, [4, 3], degree).swap_remove(kind);
        let space = body.space();
        let e = e % space.num_elements();
        let xi = Vector::<2>::new(u, if space.cell(e) == Cell::Simplex { v * (1.0 - u) } else { v });
        let mut table = MapTable::new();
        space.map(e, &[xi], Order::Values, &mut table);
        let found = Locator::new(&**space).locate(&table.x[0]).unwrap();
        prop_assert!((found.x - table.x[0]).norm() <= 1e-12 && found.distance <= 1e-12, "{}: {}", name, found.distance);
        // the full ring meets itself, and collapsed edges have no unique coordinates
        if found.element == e && !name.contains("disc") {
            space.map(e, &[found.xi], Order::Values, &mut table);
            prop_assert!((table.x[0] - found.x).norm() <= 1e-13);
        }
    }
}

#[test]
fn the_middle_of_a_circle_is_as_far_from_all_of_it() {
    let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 360.0]).unwrap();
    let patch = Patch::<1, 2>::try_new(&PatchSpec::new(net).with_elements([8, 1])).unwrap();
    let trace = patch.trace("v0").unwrap();
    let found: Projection<1, 2> = closest_point(&*trace.space, &Vector::<2>::zeros()).unwrap();
    assert!((found.distance - 1.0).abs() < 1e-15 && !found.rim);
    let nothing: Option<Projection<1, 2>> = closest_point(&*trace.space, &Vector::<2>::new(f64::NAN, 0.0));
    assert_eq!(nothing, None);
}

#[test]
fn a_foot_at_the_end_is_the_rim_only_for_points_beyond_it() {
    let patch = Patch::<1, 2>::try_new(&PatchSpec::new(shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([4, 1])).unwrap();
    let trace = patch.trace("top").unwrap();
    let closest = ClosestPoint::<1, 2, _>::new(&*trace.space);
    let foot = |x, y| closest.project(&Vector::<2>::new(x, y)).unwrap();
    for (x, y, rim) in [(0.25, 2.0, false), (1.0, 1.5, false), (1.2, 1.5, true), (-1e-6, 0.7, true), (1.0, 1.0, false), (1.5, 1.0, true)] {
        let found = foot(x, y);
        assert_eq!(found.rim, rim, "({x}, {y})");
        assert_eq!(found.x, Vector::<2>::new(f64::clamp(x, 0.0, 1.0), 1.0));
    }
    // a closed ring has no rim
    let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 360.0]).unwrap();
    let mesh = Mesh::<1, 2>::from_patch(&PatchSpec::new(net).with_elements([8, 1])).unwrap();
    let outer = mesh.trace("v1").unwrap();
    let found: Projection<1, 2> = closest_point(&*outer.space, &Vector::<2>::new(3.0, 0.1)).unwrap();
    assert!(!found.rim);
}

#[test]
fn closest_points_of_surfaces_are_those_of_a_sphere_like_patch() {
    // the outer face of a quarter cylinder of radius 2: closest points are radial, or on its rims
    let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap().extrude(1.0);
    let patch = Patch::<2, 3>::try_new(&PatchSpec::new(net).with_elements([3, 1, 2])).unwrap();
    let face = patch.trace("v1").unwrap();
    let closest = ClosestPoint::<2, 3, _>::new(&*face.space);
    for i in 0..60 {
        let (a, r, z) = (0.01 + 1.55 * (i as f64 / 60.0), 0.4 + 0.07 * i as f64, -0.5 + 0.033 * i as f64);
        let found = closest.project(&Vector::<3>::new(r * a.cos(), r * a.sin(), z)).unwrap();
        let to = z.clamp(0.0, 1.0);
        let distance = ((r - 2.0).powi(2) + (z - to).powi(2)).sqrt();
        assert!((found.distance - distance).abs() < 1e-12, "{i}: {} instead of {distance}", found.distance);
        assert_eq!(found.rim, !(0.0..=1.0).contains(&z), "{i}");
    }
}

#[test]
fn a_point_off_the_body_moves_to_it_within_a_quarter_of_an_element() {
    let patch = Patch::<1, 2>::try_new(&PatchSpec::new(shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([4, 4])).unwrap();
    let locator = Locator::new(&**patch.space());
    let found = locator.locate(&Vector::<2>::new(0.3, 1.05)).unwrap();
    assert_eq!((found.x, found.element), (Vector::<2>::new(0.3, 1.0), 13));
    assert!((found.distance - 0.05).abs() < 1e-14);
    let outside = locator.locate(&Vector::<2>::new(0.3, 1.2)).unwrap_err();
    assert!((outside.distance - 0.2).abs() < 1e-12);
    assert!(locate(&**patch.space(), &Vector::<2>::new(0.3, 1.2)).is_none());
    assert_eq!(locate(&**patch.space(), &Vector::<2>::new(0.3, 0.6)).map(|f| f.0), Some(9));
    assert!(locator.locate(&Vector::<2>::new(f64::NAN, 0.0)).unwrap_err().distance.is_infinite());
}

#[test]
fn points_of_volumes_are_located() {
    let net = ring().extrude(0.5);
    let patch = Patch::<2, 3>::try_new(&PatchSpec::new(net).with_elements([2, 2, 2])).unwrap();
    let locator = Locator::new(&**patch.space());
    let mut table = MapTable::new();
    for e in 0..8 {
        patch.space().map(e, &[Vector::<3>::new(0.2, 0.9, 0.4)], Order::Values, &mut table);
        let found = locator.locate(&table.x[0]).unwrap();
        assert_eq!(found.element, e);
        assert!((found.xi - Vector::<3>::new(0.2, 0.9, 0.4)).norm() < 1e-12);
    }
}

#[test]
fn fields_have_the_values_and_gradients_of_their_functions() {
    // isoparametric spaces carry linear fields: u = (x + 2 y, 3 y)
    for (name, net, _) in geometries() {
        for cells in [Cell::Tensor, Cell::Simplex] {
            let mesh = Mesh::<1, 2>::from_patch(&PatchSpec::new(net.clone()).with_elements([3, 2]).with_cells(cells)).unwrap();
            let space = mesh.space();
            let field = Field { first: 3, components: 2 };
            let mut u = vec![0.0; 3 + 2 * space.num_functions()];
            let (mut table, mut ids) = (MapTable::new(), Vec::new());
            let nodes: Vec<Vector<2>> = match cells {
                Cell::Simplex => faying::basis::simplex_nodes::<2, f64>(2),
                _ => (0..9).map(|a| Vector::<2>::new((a % 3) as f64 / 2.0, (a / 3) as f64 / 2.0)).collect(),
            };
            for e in 0..space.num_elements() {
                space.active(e, &mut ids);
                space.map(e, &nodes, Order::Values, &mut table);
                // merged functions are tabulated once: find each by its value at the node
                let mut shapes = ShapeTable::new();
                space.tabulate(e, &nodes, Order::Values, &mut shapes);
                for (q, x) in table.x.iter().enumerate() {
                    let a = shapes.values(q).iter().position(|n| (n - 1.0).abs() < 1e-12).unwrap();
                    u[field.unknown(ids[a], 0)] = x[0] + 2.0 * x[1];
                    u[field.unknown(ids[a], 1)] = 3.0 * x[1];
                }
            }
            for e in 0..space.num_elements() {
                let at = field_at::<2, 2, f64, _>(&**space, &field, &u, e, &[Vector::<2>::new(0.3, 0.4)])[0];
                let x = at.x;
                assert!((at.value - Vector::<2>::new(x[0] + 2.0 * x[1], 3.0 * x[1])).norm() < 1e-12, "{name}, {cells:?}");
                assert!((at.gradient - faying::linalg::Matrix::<2, 2>::new(1.0, 2.0, 0.0, 3.0)).norm() < 1e-11, "{name}, {cells:?}");
            }
        }
    }
}

#[test]
fn a_deformed_side_is_the_side_moved() {
    let mesh = Mesh::<1, 2>::from_patch(&PatchSpec::new(ring()).with_elements([4, 2])).unwrap();
    let trace = mesh.trace("v1").unwrap();
    let u = vec![Vector::<2>::new(0.25, -0.5); trace.dofs.len()];
    let moved = trace.with_space(Arc::new(Deformed { space: trace.space.clone(), u }));
    let (mut a, mut b) = (MapTable::new(), MapTable::new());
    trace.space.map(1, &[Vector::<1>::new(0.3)], Order::Gradients, &mut a);
    moved.space.map(1, &[Vector::<1>::new(0.3)], Order::Gradients, &mut b);
    assert!((b.x[0] - a.x[0] - Vector::<2>::new(0.25, -0.5)).norm() < 1e-15);
    assert!((moved.normal(1, &b.jacobian[0]) - trace.normal(1, &a.jacobian[0])).norm() < 1e-14);
    // out of a ring's outer side is away from its centre
    assert!(trace.normal(1, &a.jacobian[0]).dot(&(a.x[0] - Vector::<2>::new(0.3, -0.2))) > 1.99);
}
