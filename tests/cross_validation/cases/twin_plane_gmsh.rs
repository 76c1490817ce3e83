//! A quarter plate with a hole on curved triangles from Gmsh (order 2), pulled to the right and pressed in the hole.

use super::twin_plane_box::assumption;
use crate::choices::Choices;
use crate::document::root;
use crate::setting::Setting;
use faying::physics::{Assumption, Hooke};
use faying::problem::Components;
use faying::space::{Mapping, Mesh};
use faying_files::{Contents, Limits, read};
use std::sync::Arc;

pub fn said(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let assumed = choices.word("model.assumption").map_or(Assumption::PlaneStress, |_| assumption(choices));
    let steel = Hooke::try_new(faying::physics::Elastic::Young { young: 210.0, poisson: 0.3 }, assumed).unwrap();
    let file = read(&root().join("examples/cases/iga-fe-plate.msh"), &Limits::default()).unwrap();
    let Contents::Mesh(file) = file else { panic!("a mesh") };
    let cells = file.cells::<2>(Some("plate")).unwrap();
    let mesh = Mesh::<1, 2>::from_cells(&cells, choices.number("discretization.degree", 2.0) as usize, Mapping::Isoparametric).unwrap();
    let extra_points = choices.number("discretization.extra_points", 6.0) as usize;
    let body = s.body("body", Arc::new(mesh), extra_points, steel);
    let p = &mut s.problem;
    p.fix(body.side("x axis"), Components::Y).unwrap();
    p.fix(body.side("y axis"), Components::X).unwrap();
    p.traction(body.side("right"), 0, 1.0).unwrap();
    p.pressure(body.side("arc"), 0.5).unwrap();
    s
}
