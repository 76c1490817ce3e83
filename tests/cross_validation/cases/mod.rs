//! The problems of the documents, said by calls of `Problem`; the case files of reference/dolfinx/cases have the same names.

mod annulus;
mod contact_blocks;
mod contact_obstacle;
mod cook;
mod interface;
mod lshape;
mod plate_with_hole;
mod tube;
mod twin_plane_box;
mod twin_plane_gmsh;
mod twin_plane_hole;
mod twin_plane_ring;
mod twin_poisson_plane;
mod twin_poisson_space;
mod twin_solid_box;
mod twin_solid_dome;
mod twin_solid_tube;

use crate::answers::Answers;
use crate::choices::Choices;
use crate::setting::Setting;
use faying::problem::{Problem, Solution};

/// A problem of the plane or of space.
pub enum Said {
    Plane(Setting<1, 2>),
    Space(Setting<2, 3>),
}

/// Says the problem of a case with choices.
pub fn said(case: &str, choices: &[String]) -> Said {
    let choices = Choices::of(choices);
    let plane: fn(&Choices) -> Setting<1, 2> = match case {
        "annulus" => annulus::whole,
        "annulus-tied" => annulus::tied,
        "contact-blocks" => contact_blocks::said,
        "contact-obstacle" => contact_obstacle::said,
        "cook" => cook::whole,
        "cook-graded" => cook::graded,
        "interface-elasticity" => interface::elasticity,
        "interface-poisson" => interface::poisson,
        "lshape-elasticity" => lshape::elasticity,
        "lshape-poisson" => lshape::poisson,
        "plate-with-hole" => plate_with_hole::whole,
        "plate-with-hole-tied" => plate_with_hole::tied,
        "twin-plane-box" => twin_plane_box::said,
        "twin-plane-gmsh" => twin_plane_gmsh::said,
        "twin-plane-hole" => twin_plane_hole::said,
        "twin-plane-ring" => twin_plane_ring::said,
        "twin-poisson-box" => twin_poisson_plane::on_a_box,
        "twin-poisson-ring" => twin_poisson_plane::on_a_ring,
        _ => return Said::Space(in_space(case, &choices)),
    };
    let said = plane(&choices);
    choices.all_were_asked();
    Said::Plane(said)
}

fn in_space(case: &str, choices: &Choices) -> Setting<2, 3> {
    let said = match case {
        "tube" => tube::said(choices),
        "twin-poisson-block" => twin_poisson_space::in_a_block(choices),
        "twin-poisson-shell" => twin_poisson_space::in_a_shell(choices),
        "twin-solid-box" => twin_solid_box::said(choices),
        "twin-solid-dome" => twin_solid_dome::said(choices),
        "twin-solid-tube" => twin_solid_tube::said(choices),
        _ => panic!("no case {case}"),
    };
    choices.all_were_asked();
    said
}

/// The values of quantities of a case with choices.
pub fn values(case: &str, choices: &[String], quantities: &[String]) -> Vec<f64> {
    match said(case, choices) {
        Said::Plane(setting) => setting.values(&solved(&setting.problem), quantities),
        Said::Space(setting) => setting.values(&solved_in_space(&setting.problem), quantities),
    }
}

/// The solution of a problem of the plane.
pub fn solved(problem: &Problem<1, 2>) -> Solution<1, 2> {
    problem.assemble().unwrap_or_else(|e| panic!("{e}")).solve(1.0, None).unwrap()
}

/// The solution of a problem in space.
pub fn solved_in_space(problem: &Problem<2, 3>) -> Solution<2, 3> {
    problem.assemble().unwrap_or_else(|e| panic!("{e}")).solve(1.0, None).unwrap()
}
