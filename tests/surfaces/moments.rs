//! The balance of moments: reactions act at the places that the basis gives to its functions, so that it holds as far as the basis has
//! rotations: to rounding on isoparametric cells, to the error of their interpolation where cells keep the exact map.

use faying::geometry::shapes;
use faying::physics::Hooke;
use faying::problem::{Components, Problem, Resultant};
use faying::space::{Mapping, Mesh, PatchSpec};

const NET_OUT_OF_BALANCE: f64 = 1e-12;

/// The largest part of a resultant's force and moment.
fn size(of: &Resultant) -> [f64; 2] {
    [of.force, of.moment].map(|v| v.iter().fold(0.0f64, |m, x| m.max(x.abs())))
}

/// Force and moment that are out of balance in a quarter of a ring, far from the origin, held at one end and pulled at the other.
fn ring(degree: usize, n: usize, mapping: Mapping) -> [f64; 2] {
    let net = shapes::annulus_sector([20.0, 3.0], [1.0, 2.0], [30.0, 120.0]).unwrap();
    let spec = PatchSpec::new(net).with_degree([degree; 2]).with_elements([n; 2]).with_mapping(mapping);
    let mut p = Problem::<1, 2>::new();
    let body = p.body("ring", Mesh::<1, 2>::from_patch(&spec).unwrap(), Hooke::plane_strain(1e3, 0.3).unwrap()).unwrap();
    p.fix(body.side("u0"), Components::All).unwrap();
    (0..2).for_each(|c| {
        p.traction(body.side("u1"), c, [1.0, 2.0][c]).unwrap();
    });
    size(&p.assemble().unwrap().solve(0.0, None).unwrap().balance())
}

/// The same of the extruded ring.
fn solid(degree: usize, n: usize, mapping: Mapping) -> [f64; 2] {
    let net = shapes::annulus_sector([20.0, 3.0], [1.0, 2.0], [30.0, 120.0]).unwrap().extrude(0.5);
    let spec = PatchSpec::new(net).with_degree([degree; 3]).with_elements([n, n, 1]).with_mapping(mapping);
    let mut p = Problem::<2, 3>::new();
    let body = p.body("ring", Mesh::<2, 3>::from_patch(&spec).unwrap(), Hooke::solid(1e3, 0.3).unwrap()).unwrap();
    p.fix(body.side("u0"), Components::All).unwrap();
    (0..3).for_each(|c| {
        p.traction(body.side("u1"), c, [1.0, 2.0, 0.5][c]).unwrap();
    });
    size(&p.assemble().unwrap().solve(0.0, None).unwrap().balance())
}

#[test]
fn moments_balance_as_far_as_the_basis_has_rotations() {
    for (what, of) in [("plane", ring as fn(usize, usize, Mapping) -> [f64; 2]), ("space", solid)] {
        for degree in 2..=3 {
            // about the origin, 20 away: arms of forces of about one
            let [force, moment] = of(degree, 3, Mapping::Isoparametric);
            assert!(force < NET_OUT_OF_BALANCE && moment < 60.0 * NET_OUT_OF_BALANCE, "{what} {degree}: {force:e} {moment:e}");
            let [coarse, fine] = [3, 6].map(|n| of(degree, n, Mapping::Exact));
            assert!(coarse[0].max(fine[0]) < NET_OUT_OF_BALANCE, "{what} {degree}: {coarse:?} {fine:?}");
            let rate = (coarse[1] / fine[1]).log2();
            assert!(fine[1] > 1e-9 && fine[1] < 1e-2 && rate > degree as f64 + 0.5, "{what} {degree}: {coarse:?} {fine:?}, rate {rate}");
        }
    }
}
