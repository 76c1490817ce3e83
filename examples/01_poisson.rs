//! Lesson 1: Poisson's equation on a quarter of a ring. `cargo run --release --example 01_poisson`

use faying::geometry::shapes::annulus_sector;
use faying::physics::Conductor;
use faying::problem::{Components, Problem};
use faying::space::{Patch, PatchSpec};

/// -lap u = 0 between radii 1 and 2, u = 0 inside and 1 outside: u = ln r / ln 2.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut p = Problem::<1, 2>::new();
    let ring = PatchSpec::new(annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0])?).with_elements([8, 8]);
    let ring = p.body("ring", Patch::try_new(&ring)?, Conductor::try_new(1.0)?)?;
    p.fix(ring.side("v0"), Components::All)?;
    p.prescribe(ring.side("v1"), 0, 1.0)?;
    let u = p.assemble()?.solve(1.0, None)?.at(ring, &[0.9, 1.2])?.u[0];
    println!("u = {u:.6}, exact {:.6}", 1.5f64.log2());
    assert!((u - 1.5f64.log2()).abs() < 1e-5);
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
