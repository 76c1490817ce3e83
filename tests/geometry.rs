//! Shapes, bodies and closest points against lengths, areas and volumes known in closed form.

use faying::basis::{Cell, Order};

use faying::geometry::{ControlNet, MapTable, shapes};
use faying::linalg::Vector;
use faying::space::{BasisKind, Body, Mapping, Mesh, Patch, PatchSpec, measure};

use std::f64::consts::PI;

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
