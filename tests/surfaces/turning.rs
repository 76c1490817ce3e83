//! Elements that are cut for their normals, beside others that are not.

use crate::bodies::{Kind, steel};
use faying::geometry::{shapes, turn_about};
use faying::linalg::Vector;
use faying::problem::{Components, Problem};
use faying::space::PatchSpec;

/// Cells of polynomials have kinks between them: both sides of a kink see it along one mean normal only if they are cut alike.
#[test]
fn regions_do_not_overlap_along_kinks_of_elements_that_are_cut() {
    for (slave, master) in [([3, 3, 1], [2, 2, 1]), ([4, 3, 1], [2, 3, 1]), ([2, 2, 1], [3, 2, 1])] {
        for degree in [2, 3] {
            let mut p = Problem::<2, 3>::new();
            let turn = turn_about(&Vector::<3>::new(1.0, 1.0, 1.0), 240.0).unwrap();
            let [inner, outer] = [0, 1].map(|k| {
                let net = shapes::sphere_octant([0.0; 3], [[0.5, 1.0], [1.0, 1.5]][k]).unwrap();
                let net = if k == 1 { net.rotate(&turn) } else { net };
                let body = Kind::Tetrahedra.body(&PatchSpec::new(net).with_degree([degree; 3]).with_elements([slave, master][k]));
                Kind::Tetrahedra.add(&mut p, ["inner", "outer"][k], body, steel())
            });
            p.fix(inner.side("w0"), Components::All).unwrap();
            p.tie(inner.side("w1"), outer.side("w0")).unwrap();
            let errors = p.assemble().err();
            assert!(errors.is_none(), "{slave:?} {master:?} of degree {degree}: {errors:?}");
        }
    }
}
