//! Two rings of different materials that meet on the arc r = 1, tied with grids that do not match.

use crate::choices::{Choices, Discretisation, one_of};
use crate::setting::{Setting, Shape};
use crate::tied::How;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::annulus_sector;
use faying::physics::{Conductor, Hooke, Material};
use faying::problem::{BodyId, Components, Data};
use faying::space::Mapping;

/// The inner ring, the slave, and the outer one.
fn rings<const C: usize, M: Material<C, 2> + Clone + 'static>(choices: &Choices, s: &mut Setting<1, 2>, materials: [M; 2]) -> [BodyId; 2] {
    let [inner, outer] = materials;
    let by_default = Discretisation { mapping: Mapping::Exact, ..Discretisation::default() };
    let ring = |name, radius, elements| {
        let net = annulus_sector([0.0, 0.0], radius, [0.0, 90.0]).unwrap();
        Shape { by_default, ..Shape::new(name, net, elements) }
    };
    let inner = s.shape(choices, ring("inner", [0.5, 1.0], [6, 3]), inner);
    let outer = s.shape(choices, ring("outer", [1.0, 2.0], [4, 3]), outer);
    [inner, outer]
}

fn tie(choices: &Choices, s: &mut Setting<1, 2>, [inner, outer]: [BodyId; 2]) {
    let multiplier = choices.word("interface.arc.multiplier").map_or(MultiplierKind::Auto, |word| word.parse().unwrap());
    let how = match one_of(choices.word("interface.arc.coupling").unwrap_or("mortar"), ["mortar", "nitsche"]) {
        0 => How::mortar(multiplier),
        _ => How::Nitsche,
    };
    s.tie("arc", (inner, "v1"), (outer, "v0"), how);
}

pub fn elasticity(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let materials = [Hooke::plane_strain(10.0, 0.3).unwrap(), Hooke::plane_strain(1.0, 0.35).unwrap()];
    let bodies = rings(choices, &mut s, materials);
    let p = &mut s.problem;
    for body in bodies {
        p.fix(body.side("u0"), Components::Y).unwrap();
        p.fix(body.side("u1"), Components::X).unwrap();
    }
    p.traction(bodies[1].side("v1"), 0, Data::of(|x, _| x[0] / 2.0)).unwrap();
    p.traction(bodies[1].side("v1"), 1, Data::of(|x, _| -(x[1] / 2.0).powi(3) / 4.0)).unwrap();
    tie(choices, &mut s, bodies);
    s
}

pub fn poisson(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let bodies = rings(choices, &mut s, [10.0, 1.0].map(|k| Conductor::<2>::try_new(k).unwrap()));
    let p = &mut s.problem;
    for body in bodies {
        p.source(body, vec![Data::of(|x, _| x[0])]).unwrap();
        p.fix(body.side("u1"), Components::All).unwrap();
    }
    p.traction(bodies[1].side("v1"), 0, Data::of(|x, _| x[0] / 2.0 + (x[0] / 2.0).powi(3))).unwrap();
    tie(choices, &mut s, bodies);
    s
}
