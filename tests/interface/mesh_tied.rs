//! Meshes as files hold them, tied to one another with every multiplier: sides of a file are sides like any other.

use crate::common::cells;
use crate::common::coupled;
use cells::{Shapes, boxes, shaken};
use coupled::Bodies;
use faying::basis::Basis;
use faying::constraint::{Direct, RowKind};
use faying::coupling::interface::{MergedCurve, Tolerance};
use faying::coupling::multiplier::{MultiplierKind, check_counts};
use faying::coupling::{Coupling, Interface, InterfaceQuadrature, Mortar, Side};
use faying::linalg::{Matrix, Vector};
use faying::physics::{Conductor, Hooke, Material, form};
use faying::space::{Body, Mapping, Mesh};

/// Largest error of a linear field on two bodies of meshes that meet on an inclined line; `slave` is 0 below, 1 above.
fn error_of<const C: usize>(material: &dyn Material<C, 2>, shapes: [Shapes; 2], degree: usize, kind: MultiplierKind, slave: usize) -> f64 {
    // the upper box continues the shear of the lower one
    let above = |u: &Vector<2>| Vector::<2>::new(u[0] + 0.1 * (u[1] + 1.0), u[1] + 1.0 + 0.1 * u[0]);
    let meshes = [boxes([3, 2], shapes[0], 1, Some(3), &shaken([3, 2], 0.2)), boxes([4, 3], shapes[1], 1, Some(4), &above)];
    let bodies = meshes.iter().map(|m| -> Box<dyn Body<1, 2>> { Box::new(Mesh::from_cells(m, degree, Mapping::Isoparametric).unwrap()) });
    let form = form(material).unwrap();
    let mut model = Bodies::<C>::new(bodies.collect(), &form, 0);
    let gradient = Matrix::<C, 2>::from_fn(|c, k| 0.3 - 0.4 * (c + 2 * k) as f64);
    let exact = move |x: &Vector<2>| gradient * x + Vector::<C>::repeat(0.2);
    let held = |sides: [&'static str; 3]| -> Vec<_> { sides.into_iter().flat_map(|s| (0..C).map(move |c| (s, c))).collect() };
    model.fix(0, &held(["x0", "x1", "y0"]), &exact);
    model.fix(1, &held(["x0", "x1", "y1"]), &exact);
    let sides = [model.trace(0, "y1"), model.trace(1, "y0")];
    let master = 1 - slave;
    let psi = model.multipliers(slave, &sides[slave], kind);
    let psi: Vec<&dyn Basis<1>> = psi.iter().map(|p| &**p).collect();
    check_counts(&sides[slave], C, &psi, &|function, c| model.is_fixed(slave, function, c)).unwrap();
    let segments = MergedCurve::tied(degree + 1, Tolerance::Exact).segments(&*sides[slave].space, &*sides[master].space).unwrap();
    // ends at thirds and at quarters make six pieces
    assert_eq!(segments.slave.len(), 6);
    let side = |k: usize| Side { trace: &sides[k], field: model.fields[k], flux: None };
    let interface = Interface {
        slave: side(slave),
        master: Some(side(master)),
        multiplier: &psi,
        segments: &segments,
        master_segments: None,
        direction: None,
    };
    let rows = Mortar.assemble(&interface, model.unknowns()).unwrap().constraint;
    let n = rows.slave.rows;
    let solution = model.solve(&rows, None, &vec![0.0; n], &vec![RowKind::Equal; n], &mut Direct::new()).unwrap();
    model.error(&solution.unknowns, &exact)
}

#[test]
fn meshes_of_all_shapes_are_tied_with_all_multipliers() {
    let (conductor, steel) = (Conductor::<2>::try_new(2.0).unwrap(), Hooke::<2>::plane_strain(1.0, 0.3).unwrap());
    for shapes in [[Shapes::Mixed, Shapes::Simplex], [Shapes::Simplex, Shapes::Tensor]] {
        for (degree, kinds) in [(1, vec![0]), (2, vec![0, 2]), (3, vec![0, 2]), (4, vec![0, 2, 4])] {
            for kind in kinds.into_iter().map(MultiplierKind::Lowered) {
                for slave in [0, 1] {
                    let errors =
                        [error_of::<1>(&conductor, shapes, degree, kind, slave), error_of::<2>(&steel, shapes, degree, kind, slave)];
                    assert!(errors.iter().all(|e| *e < 1e-11), "{shapes:?}, {degree}, {kind}, slave {slave}: {errors:?}");
                }
            }
        }
    }
}
