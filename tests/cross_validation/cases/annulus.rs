//! A quarter of a thick ring under a pressure that varies around its bore; whole, and cut along r = 5/2 and tied.

use crate::choices::{Choices, Discretisation};
use crate::setting::{Setting, Shape};
use crate::tied::How;
use faying::geometry::shapes::annulus_sector;
use faying::physics::Hooke;
use faying::problem::{Components, Data};

fn steel() -> Hooke<2> {
    Hooke::plane_strain(1.0, 0.3).unwrap()
}

fn ring(name: &'static str, radius: [f64; 2], elements: [usize; 2]) -> Shape<2> {
    Shape::new(name, annulus_sector([0.0, 0.0], radius, [0.0, 90.0]).unwrap(), elements)
}

fn pressure() -> Data {
    Data::of(|x, _| {
        let theta = x[1].atan2(x[0]);
        1.0 + (2.0 * theta).cos() / 2.0 + (4.0 * theta).cos()
    })
}

pub fn whole(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let body = s.shape(choices, ring("ring", [2.0, 3.0], [4, 2]), steel());
    let p = &mut s.problem;
    p.fix(body.side("u0"), Components::Y).unwrap();
    p.fix(body.side("u1"), Components::X).unwrap();
    p.pressure(body.side("v0"), pressure()).unwrap();
    s
}

pub fn tied(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let inner = s.shape(choices, ring("inner", [2.0, 2.5], [8, 2]), steel());
    let outer = Shape { by_default: Discretisation::fe(), ..ring("outer", [2.5, 3.0], [6, 2]) };
    let outer = s.shape(choices, outer, steel());
    let p = &mut s.problem;
    for body in [inner, outer] {
        p.fix(body.side("u0"), Components::Y).unwrap();
        p.fix(body.side("u1"), Components::X).unwrap();
    }
    p.pressure(inner.side("v0"), pressure()).unwrap();
    let multiplier = choices.word("interface.arc.multiplier").unwrap_or("auto").parse().unwrap();
    s.tie("arc", (inner, "v1"), (outer, "v0"), How::mortar(multiplier));
    s
}
