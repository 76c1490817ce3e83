//! Lesson 3: a NURBS body pressed on a mesh and on a wall, by three methods. `cargo run --release --example 03_contact`

use faying::contact::{Augmented, ContactMethod, HalfPlane, Lagrange};
use faying::coupling::Nitsche;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{Components, ContactId, Data, Problem, Solution};
use faying::space::{Mesh, Patch, PatchSpec};
use std::sync::Arc;

/// The upper body pressed on the lower one (the table) and on the wall x = 1 beside it, by one method.
pub fn pressed(method: Arc<dyn ContactMethod<1, 2>>) -> Result<(Solution<1, 2>, [ContactId; 2]), Box<dyn std::error::Error>> {
    let mut p = Problem::<1, 2>::new();
    let steel = || Hooke::plane_strain(1.0, 0.3);
    let lower = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 0.5])?).with_elements([7, 3]);
    let upper = PatchSpec::new(rectangle([0.0, 0.5], [1.0, 1.0])?).with_elements([9, 4]);
    let lower = p.body("lower", Mesh::from_patch(&lower)?, steel()?)?;
    let upper = p.body("upper", Patch::try_new(&upper)?, steel()?)?;
    p.fix(lower.side("v0"), Components::All)?;
    p.traction(upper.side("v1"), 1, Data::of(|x, _| -1e-3 * (1.0 - 1.3 * x[0])))?;
    p.traction(upper.side("u0"), 0, 1e-4)?;
    let table = p.contact(upper.side("v0"), lower.side("v1"))?.method(Arc::clone(&method)).id();
    let wall = HalfPlane::try_new(Vector::from([1.0, 0.0]), Vector::from([-1.0, 0.0])).expect("a normal of length 1");
    let wall = p.contact(upper.side("u1"), wall)?.method(method).id();
    Ok((p.assemble()?.solve(1.0, None)?, [table, wall]))
}

/// Solves by three methods, which agree on the forces.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let methods: [Arc<dyn ContactMethod<1, 2>>; 3] = [Arc::new(Lagrange), Arc::new(Augmented::default()), Arc::new(Nitsche::default())];
    for method in methods {
        let (solution, [table, wall]) = pressed(method)?;
        let (table, wall) = (solution.contact(table)?, solution.contact(wall)?);
        println!("table {:.6e}, wall {:.6e}, largest pressure {:.4e}", table.force[1], wall.force[0], table.largest_pressure);
        assert!((table.force[1] - 3.5e-4).abs() < 1e-12 && (wall.force[0] + 5e-5).abs() < 1e-12);
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
