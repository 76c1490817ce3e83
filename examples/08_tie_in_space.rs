//! Lesson 8: an unlike pair in space. `cargo run --release --example 08_tie_in_space`
//!
//! A NURBS pipe from r = 1 to 1.5 in one of tetrahedra up to r = 2, tied along the cylinder between them, grids that do not match: a quarter
//! of the height 1. Between the temperatures 0 and ln 2 of both ends -lap u = 0 has the solution u = ln r, and the heat pi/2 flows through
//! every cylinder.

use faying::basis::Cell;
use faying::coupling::Nitsche;
use faying::geometry::shapes::annulus_sector;
use faying::physics::Conductor;
use faying::problem::{Problem, TieResult};
use faying::space::{Mesh, Patch, PatchSpec};
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LN_2};

/// Ties both layers by Mortar rows or by Nitsche's method; returns what passes the seam, and the largest error of u at some points.
pub fn tied(by_nitsche: bool) -> Result<(TieResult, f64), Box<dyn Error>> {
    let layer = |radii, elements| -> Result<PatchSpec<3>, Box<dyn Error>> {
        Ok(PatchSpec::new(annulus_sector([0.0; 2], radii, [0.0, 90.0])?.extrude(1.0)).with_elements(elements))
    };
    let mut p = Problem::<2, 3>::new();
    let inner = p.body("inner", Patch::try_new(&layer([1.0, 1.5], [6, 3, 3])?)?, Conductor::try_new(1.0)?)?;
    let outer = Mesh::from_patch(&layer([1.5, 2.0], [5, 3, 2])?.with_cells(Cell::Simplex))?;
    let outer = p.body("outer", outer, Conductor::try_new(1.0)?)?;
    p.prescribe(inner.side("v0"), 0, 0.0)?;
    p.prescribe(outer.side("v1"), 0, LN_2)?;
    let seam = p.tie(inner.side("v1"), outer.side("v0"))?;
    if by_nitsche {
        seam.coupling(Nitsche::default());
    }
    let seam = seam.id();
    let solution = p.assemble()?.solve(1.0, None)?;
    let mut worst = 0.0_f64;
    for (body, r) in [(inner, 1.2), (inner, 1.45), (outer, 1.6), (outer, 1.9)] {
        for (angle, z) in [(0.3_f64, 0.2), (FRAC_PI_4, 0.5), (1.4, 0.9)] {
            let found = solution.at(body, &[r * angle.cos(), r * angle.sin(), z])?.u[0];
            worst = worst.max((found - r.ln()).abs());
        }
    }
    Ok((solution.tie(seam)?, worst))
}

/// Both ways meet ln r and the heat.
pub fn main() -> Result<(), Box<dyn Error>> {
    for (name, by_nitsche) in [("mortar", false), ("nitsche", true)] {
        let (seam, error) = tied(by_nitsche)?;
        println!("{name:>7}: heat {:.6}, area {:.6}, {} pieces, error of u {error:.1e}", seam.force[0], seam.area, seam.pieces);
        assert!((seam.force[0].abs() / FRAC_PI_2 - 1.0).abs() < 5e-3 && (seam.area / (1.5 * FRAC_PI_2) - 1.0).abs() < 1e-6);
        assert!(error < 2e-3);
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
