//! Elements that are thin beside their neighbours.

use crate::bodies::steel;
use faying::geometry::{shapes, turn_about};
use faying::linalg::Vector;
use faying::problem::{BodyMaterial, BodySpec, Components, Problem};
use faying::space::{Patch, PatchSpec};
use std::sync::Arc;

/// Positions are rounded as large coordinates are, also within elements that are thinner than that by many digits.
#[test]
fn flat_boxes_with_thin_elements_are_tied_whole() {
    let thin = [vec![0.0, 1e-5, 1.0], vec![0.0, 1e-7, 1.0], vec![0.0, 1.0]];
    let others = [
        [vec![0.0, 1e-4, 1.0], vec![0.0, 0.5, 1.0], vec![0.0, 1.0]],
        [vec![0.0, 0.3, 1.0 - 1e-6, 1.0], vec![0.0, 1e-8, 0.4, 1.0], vec![0.0, 1.0]],
    ];
    for other in others {
        for (degrees, axis) in [(0.0, [0.0, 0.0, 1.0]), (20.0, [1.0, 2.0, 3.0]), (77.0, [-2.0, 0.3, 1.0])] {
            let turn = turn_about(&Vector::<3>::from(axis), degrees).unwrap();
            let mut p = Problem::<2, 3>::new();
            let mut add = |name: &str, low: f64, breakpoints: &[Vec<f64>; 3]| {
                let net = shapes::brick([0.0, 0.0, low], [1.0, 1.0, low + 1.0]).unwrap().rotate(&turn);
                let spec = PatchSpec::new(net).with_degree([2; 3]).with_breakpoints(breakpoints.clone());
                let body = Arc::new(Patch::<2, 3>::try_new(&spec).unwrap());
                p.add(BodySpec::new(name, body, BodyMaterial::of(steel()).unwrap())).unwrap()
            };
            let (below, above) = (add("below", -1.0, &other), add("above", 0.0, &thin));
            p.fix(below.side("w0"), Components::All).unwrap();
            p.tie(above.side("w0"), below.side("w1")).unwrap();
            let errors = p.assemble().err();
            assert!(errors.is_none(), "{degrees}: {errors:?}");
        }
    }
}
