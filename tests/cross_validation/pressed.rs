//! Contacts of a setting.

use crate::choices::{Choices, one_of};
use crate::setting::Setting;
use faying::contact::{Augmented, Cone, Obstacle};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::{Nitsche, Penalty};
use faying::problem::{BodyId, ContactId, Data, Opponent};
use std::sync::Arc;

/// How bodies are kept apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    Lagrange(MultiplierKind, Cone),
    /// Soft rows of the multiplier by default.
    Penalty(f64),
    Augmented,
    Nitsche,
}

/// What a slave side faces.
pub enum Faced {
    Side(BodyId, String),
    Obstacle(Arc<dyn Obstacle<1, 2>>),
}

/// A contact of a side, of a half model.
pub struct Pressed {
    pub name: String,
    pub id: ContactId,
    /// The slave side.
    pub slave: (BodyId, String),
}

impl Setting<1, 2> {
    /// Presses a side of a half model on what it faces.
    pub fn press(&mut self, name: &str, slave: (BodyId, &str), faced: Faced, gap: Data, method: Method) {
        let on = slave.0.side(slave.1);
        let contact = match &faced {
            Faced::Side(body, side) => self.problem.contact(on, body.side(side)),
            Faced::Obstacle(obstacle) => self.problem.contact(on, Opponent::Obstacle(Arc::clone(obstacle))),
        };
        let contact = contact.unwrap().named(name).gap(gap).symmetry();
        match method {
            Method::Lagrange(kind, cone) => contact.multiplier(kind).cone(cone),
            Method::Penalty(factor) => contact.method(Penalty { factor }),
            Method::Augmented => contact.method(Augmented::default()),
            Method::Nitsche => contact.method(Nitsche::default()),
        };
        let id = contact.id();
        self.contacts.push(Pressed { name: name.into(), id, slave: (slave.0, slave.1.into()) });
    }
}

/// The method that choices name for a contact: `PATH.method`, `PATH.multiplier`, `PATH.cone`, `PATH.factor`.
pub fn method(choices: &Choices, path: &str) -> Method {
    let word = |key: &str| choices.word(&format!("{path}.{key}"));
    let kind = word("multiplier").map_or(MultiplierKind::Auto, |w| w.parse().unwrap());
    let cones = [Cone::Coefficients, Cone::Weights, Cone::Values];
    let cone = word("cone").map_or(Cone::Coefficients, |w| cones[one_of(w, ["coefficients", "weights", "values"])]);
    match one_of(word("method").unwrap_or("lagrange"), ["lagrange", "penalty", "augmented", "nitsche"]) {
        0 => Method::Lagrange(kind, cone),
        1 => Method::Penalty(choices.number(&format!("{path}.factor"), 0.0)),
        2 => Method::Augmented,
        _ => Method::Nitsche,
    }
}
