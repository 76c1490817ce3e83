//! lambda of Nitsche's method between bodies whose materials change with the time.

use faying::coupling::Nitsche;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyMaterial, BodySpec, Components, Data, InterfaceId, Physics, Problem, Solution};
use faying::space::{Patch, PatchSpec};
use std::sync::Arc;

/// Two blocks under a load that grows along x, joined by Nitsche's method; `moduli` are those of the lower and the upper one.
fn blocks(is_tied: bool, moduli: [fn(f64) -> f64; 2]) -> (Problem<1, 2>, InterfaceId) {
    let mut p = Problem::<1, 2>::new();
    p.times(&[0.0, 1.0]);
    let [lower, upper] = [0, 1].map(|b| {
        let y = 0.5 * f64::from(u8::from(b == 1));
        let spec = PatchSpec::new(rectangle([0.0, y], [1.0, y + 0.5]).unwrap()).with_degree([2; 2]).with_elements([3 + b, 2]);
        let hooke = move |t: f64| Physics::new::<2>(Hooke::plane_strain(moduli[b](t), 0.3).unwrap()).unwrap();
        let body = Arc::new(Patch::try_new(&spec).unwrap());
        p.add(BodySpec::new(["lower", "upper"][b], body, BodyMaterial::changing(hooke))).unwrap()
    });
    p.fix(lower.side("v0"), Components::All).unwrap();
    p.fix(upper.side("v1"), Components::One(0)).unwrap();
    p.pressure(upper.side("v1"), Data::of(|x, _| 1e-3 * (1.0 + x[0]))).unwrap();
    let id = match is_tied {
        true => p.tie(lower.side("v1"), upper.side("v0")).unwrap().coupling(Nitsche::default()).id().into(),
        false => p.contact(lower.side("v1"), upper.side("v0")).unwrap().method(Nitsche::default()).id().into(),
    };
    (p, id)
}

/// lambda in the middle and near the ends of every element of the slave.
fn lambda(solution: &Solution<1, 2>, id: InterfaceId) -> Vec<f64> {
    let field = solution.lambda(id, 0).unwrap().unwrap();
    let xi = [0.1, 0.5, 0.9].map(Vector::<1>::new);
    (0..3).flat_map(|element| field.at(element, &xi)).flatten().collect()
}

#[test]
fn lambda_at_points_of_a_solution_is_that_of_its_own_time() {
    for is_tied in [true, false] {
        let (p, id) = blocks(is_tied, [|t| 1.0 + 99.0 * t, |t| 5.0 - 4.0 * t]);
        let mut system = p.assemble().unwrap();
        let first = system.solve(0.0, None).unwrap();
        let last = system.solve(1.0, Some(&first)).unwrap();
        // in an order in which each follows the other
        let found = [&last, &first, &last, &first].map(|solution| lambda(solution, id));
        assert!(found[0] == found[2] && found[1] == found[3], "tied: {is_tied}");
        for (found, moduli) in [(&found[1], [(|_| 1.0) as fn(f64) -> f64, |_| 5.0]), (&found[0], [|_| 100.0, |_| 1.0])] {
            let (p, id) = blocks(is_tied, moduli);
            let alone = lambda(&p.assemble().unwrap().solve(0.0, None).unwrap(), id);
            let worst = found.iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-12 && alone.iter().any(|l| l.abs() > 1e-3), "tied: {is_tied}: {worst:e} {alone:?}");
        }
    }
}
