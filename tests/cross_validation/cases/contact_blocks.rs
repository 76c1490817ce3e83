//! Two blocks of different moduli, the upper one pressed on the lower one: contact in the middle, open beside it.

use crate::answers::side;
use crate::choices::Choices;
use crate::pressed::{Faced, method};
use crate::setting::{Setting, Shape};
use faying::geometry::shapes::rectangle;
use faying::physics::Hooke;
use faying::problem::{Components, Data};

/// The gap before anything moves is C x².
const C: f64 = 0.05;

pub fn said(choices: &Choices) -> Setting<1, 2> {
    let mut s = Setting::new();
    let block = |name, low, high, elements| Shape::new(name, rectangle(low, high).unwrap(), elements);
    let stiff = Hooke::plane_strain(1.0, 0.3).unwrap();
    let upper = s.shape(choices, block("upper", [0.0, 0.0], [1.0, 0.5], [8, 4]), stiff);
    let soft = Hooke::plane_strain(0.5, 0.2).unwrap();
    let lower = s.shape(choices, block("lower", [0.0, -0.75], [1.5, 0.0], [11, 6]), soft);
    let p = &mut s.problem;
    p.fix(upper.side("u0"), Components::X).unwrap();
    p.fix(lower.side("u0"), Components::X).unwrap();
    p.fix(lower.side("v0"), Components::Y).unwrap();
    p.pressure(upper.side("v1"), choices.number("let.q", 0.0026)).unwrap();
    let of = |key: &str, default: &str| {
        let (body, name) =
            choices.word(key).unwrap_or(default).to_owned().split_once('.').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
        (s.named(&body).id, side::<2>(&name).to_owned())
    };
    let (slave, master) = (of("contact.pad.slave", "upper.bottom"), of("contact.pad.master", "lower.top"));
    let gap = Data::of_gap(|x, _, g| g + C * x[0] * x[0]);
    s.press("pad", (slave.0, &slave.1), Faced::Side(master.0, master.1), gap, method(choices, "contact.pad"));
    s
}
