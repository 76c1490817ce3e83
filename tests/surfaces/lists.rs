//! Lists of sides: a block that is pressed on two blocks side by side, or they on it, across grids that do not match.

use crate::bodies::{Kind, steel, turns};
use faying::problem::{BodyId, Problem};

const PRESSURE: f64 = 1.25e-3;

/// Largest relative error of the pressure, the force and the stress in the middle of all blocks.
fn error(kinds: [Kind; 3], are_slaves: bool) -> f64 {
    let turn = turns()[1];
    // one below, two above, or the other way round; the two have different grids at the seam between them
    let boxes = [([0.0, 0.0, -0.5], [1.0, 0.8, 0.0]), ([0.0; 3], [0.4, 0.8, 0.6]), ([0.4, 0.0, 0.0], [1.0, 0.8, 0.6])];
    let elements = [[3, 2, 1], [1, 3, 1], [2, 1, 1]];
    let mut p = Problem::<2, 3>::new();
    let bodies: [BodyId; 3] = std::array::from_fn(|b| {
        let body = kinds[b].turned_box(boxes[b], &turn, 2, elements[b]);
        let body = kinds[b].add(&mut p, ["below", "left", "right"][b], body, steel());
        for side in ["u0", "v0"] {
            p.fix_normal(body.side(side)).unwrap();
        }
        body
    });
    p.fix_normal(bodies[0].side("w0")).unwrap();
    for body in &bodies[1..] {
        p.pressure(body.side("w1"), PRESSURE).unwrap();
    }
    let (two, one) = ([bodies[1].side("w0"), bodies[2].side("w0")], bodies[0].side("w1"));
    let contact = if are_slaves { p.contact(two, one) } else { p.contact(one, two) };
    let contact = contact.unwrap().id();
    let solution = p.assemble().unwrap().solve(0.0, None).unwrap_or_else(|e| panic!("{kinds:?} {are_slaves}: {e}"));
    let result = solution.contact(contact).unwrap();
    assert!(result.balance < 1e-12 && solution.warnings().is_empty(), "{kinds:?} {are_slaves}: {:?}", solution.warnings());
    let normal = turn.column(2) * if are_slaves { 1.0 } else { -1.0 };
    let mut worst = (result.force - normal * (0.8 * PRESSURE)).norm() / PRESSURE;
    worst = worst.max((result.largest_pressure / PRESSURE - 1.0).abs()).max((result.least_pressure / PRESSURE - 1.0).abs());
    worst = worst.max((result.area - 0.8).abs());
    for (body, x) in bodies.into_iter().zip([[0.41, 0.3, -0.05], [0.35, 0.5, 0.03], [0.45, 0.1, 0.2]]) {
        let at = solution.at(body, &(turn * faying::linalg::Vector::<3>::from(x)).into()).unwrap();
        for (i, row) in [[0, 3, 5], [3, 1, 4], [5, 4, 2]].iter().enumerate() {
            (0..3).for_each(|j| worst = worst.max((at.stress[row[j]] / PRESSURE + normal[i] * normal[j]).abs()));
        }
    }
    worst
}

#[test]
fn lists_of_slave_and_of_master_sides_have_the_uniform_pressure() {
    for kinds in
        [[Kind::Spline; 3], [Kind::Hexahedra, Kind::Spline, Kind::Tetrahedra], [Kind::Tetrahedra, Kind::Hexahedra, Kind::Hexahedra]]
    {
        for are_slaves in [true, false] {
            let error = error(kinds, are_slaves);
            assert!(error < 1e-8, "{kinds:?} {are_slaves}: {error:e}");
        }
    }
}
