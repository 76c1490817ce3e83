//! Lesson 9: contact in space. `cargo run --release --example 09_contact_in_space`
//!
//! A rigid box, pressed by a force, on a NURBS block that lies on tetrahedra: two contacts, one with an obstacle that has the shape of a solid
//! and one of two bodies. Without friction both transmit the force, and no more.

use faying::basis::Cell;
use faying::contact::{Augmented, ContactMethod, FacingSurface, Lagrange, body_outline};
use faying::coupling::Nitsche;
use faying::geometry::shapes::brick;
use faying::physics::Hooke;
use faying::problem::{Components, ContactId, Problem, Solution};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::error::Error;
use std::sync::Arc;

/// The force that presses the box.
const FORCE: f64 = 1e-3;

/// The block between the box and the table, the latter by one method.
pub fn pressed(method: Arc<dyn ContactMethod<2, 3>>) -> Result<(Solution<2, 3>, [ContactId; 2]), Box<dyn Error>> {
    let mut p = Problem::<2, 3>::new();
    let steel = || Hooke::solid(1.0, 0.3);
    let table = PatchSpec::new(brick([0.0, 0.0, 0.0], [1.0, 1.0, 0.5])?).with_elements([3, 3, 2]).with_cells(Cell::Simplex);
    let block = PatchSpec::new(brick([0.0, 0.0, 0.5], [1.0, 1.0, 1.0])?).with_elements([4, 4, 2]);
    let table = p.body("table", Mesh::from_patch(&table)?, steel()?)?;
    let block = p.body("block", Patch::try_new(&block)?, steel()?)?;
    p.fix(table.side("w0"), Components::All)?;
    // what slides on the table is held by two symmetry planes
    p.fix_normal(block.side("u0"))?;
    p.fix_normal(block.side("v0"))?;
    // the boundary of a solid is an obstacle: of all its sides that which opposes the block's top
    let punch = Patch::<2, 3>::try_new(&PatchSpec::new(brick([0.25, 0.25, 1.0], [0.75, 0.75, 1.5])?))?;
    let punch = FacingSurface::of_pieces(body_outline(&punch, punch.sides())?);
    let punch = p.contact(block.side("w1"), punch)?.pressed(2, -FORCE).id();
    let table = p.contact(block.side("w0"), table.side("w1"))?.method(method).id();
    Ok((p.assemble()?.solve(1.0, None)?, [punch, table]))
}

/// Solves by three methods, which agree on the forces.
pub fn main() -> Result<(), Box<dyn Error>> {
    let methods: [Arc<dyn ContactMethod<2, 3>>; 3] = [Arc::new(Lagrange), Arc::new(Augmented::default()), Arc::new(Nitsche::default())];
    for method in methods {
        let (solution, [punch, table]) = pressed(method)?;
        let (punch, table) = (solution.contact(punch)?, solution.contact(table)?);
        let depth = punch.displacement.expect("an obstacle moves")[2];
        println!("punch {:.6e} over {:.4}, sinks {depth:.4e}; table {:.6e}", punch.force[2], punch.area, table.force[2]);
        assert!((punch.force[2] + FORCE).abs() < 1e-12 && (table.force[2] - FORCE).abs() < 1e-12 && depth < 0.0);
        // the face of the box is 0.5 x 0.5, and no point is pressed by its other sides
        assert!((punch.area - 0.25).abs() < 1e-12 && punch.force.xy().norm() < 1e-15);
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
