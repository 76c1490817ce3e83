//! Three squares around a corner of 270 degrees, glued or tied: a plate with a square hole, and Poisson with u = 0 at the notch.

use crate::choices::{Choices, one_of};
use crate::setting::{Setting, Shape};
use faying::coupling::Nitsche;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::rectangle;
use faying::physics::{Conductor, Hooke, Material};
use faying::problem::{BodyId, Components};

/// The squares below the corner's, at the corner, and on its right.
fn squares<const C: usize>(choices: &Choices, s: &mut Setting<1, 2>, material: impl Material<C, 2> + Clone + 'static) -> [BodyId; 3] {
    let bodies = [("lower", [-1.0, -1.0]), ("corner", [-1.0, 0.0]), ("right", [0.0, 0.0])].map(|(name, low)| {
        let net = rectangle(low, low.map(|x| x + 1.0)).unwrap();
        s.shape(choices, Shape::new(name, net, [4, 4]), material.clone())
    });
    let multiplier = choices.word("interface.cuts.multiplier").map_or(MultiplierKind::Auto, |word| word.parse().unwrap());
    match one_of(choices.word("interface.cuts.coupling").unwrap_or("glue"), ["glue", "mortar", "nitsche"]) {
        0 => {
            s.problem.glue_touching(&bodies, None).unwrap();
        }
        1 => {
            s.problem.tie_touching(&bodies, None).unwrap().multiplier(multiplier);
        }
        _ => {
            s.problem.tie_touching(&bodies, None).unwrap().coupling(Nitsche::default());
        }
    }
    bodies
}

pub fn elasticity(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let [lower, corner, right] = squares(choices, &mut s, Hooke::plane_strain(1.0, 0.3).unwrap());
    let p = &mut s.problem;
    p.fix(right.side("u1"), Components::X).unwrap();
    p.fix(lower.side("v0"), Components::Y).unwrap();
    for body in [lower, corner] {
        p.traction(body.side("u0"), 0, -1.0).unwrap();
    }
    s
}

pub fn poisson(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let all = squares(choices, &mut s, Conductor::<2>::try_new(1.0).unwrap());
    let p = &mut s.problem;
    for body in all {
        p.source(body, vec![1.0.into()]).unwrap();
    }
    let [lower, corner, right] = all;
    for side in [corner.side("v1"), right.side("v1"), lower.side("u1"), right.side("v0")] {
        p.fix(side, Components::All).unwrap();
    }
    s
}
