//! Ties of a setting, and lambda at points of their slave sides.

use crate::setting::Setting;
use faying::coupling::Nitsche;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::ClosestPoint;
use faying::linalg::Vector;
use faying::problem::{BodyId, Integration, InterfaceId, Solution, TieId};

/// How sides are tied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum How {
    /// Mortar with a multiplier, integrated by a rule with so many points more.
    Mortar(MultiplierKind, Integration, usize),
    Nitsche,
}

impl How {
    /// Mortar on segments of both sides.
    pub fn mortar(kind: MultiplierKind) -> Self {
        Self::Mortar(kind, Integration::Merged, 0)
    }
}

/// A tie of a side on another.
pub struct Tied {
    pub name: String,
    pub id: TieId,
    /// The slave side.
    pub slave: (BodyId, String),
}

impl Setting<1, 2> {
    /// Ties a side to another.
    pub fn tie(&mut self, name: &str, slave: (BodyId, &str), master: (BodyId, &str), how: How) {
        let tie = self.problem.tie(slave.0.side(slave.1), master.0.side(master.1)).unwrap().named(name);
        match how {
            How::Mortar(kind, rule, extra) => tie.multiplier(kind).rule(rule).extra_points(extra),
            How::Nitsche => tie.coupling(Nitsche::default()),
        };
        self.ties.push(Tied { name: name.into(), id: tie.id(), slave: (slave.0, slave.1.into()) });
    }

    /// lambda of a tie or a contact at a point of its slave side, by components.
    pub fn lambda(&self, solution: &Solution<1, 2>, of: impl Into<InterfaceId>, (body, side): &(BodyId, String), x: &[f64; 2]) -> Vec<f64> {
        let trace = self.member(*body).trace(side);
        let foot = ClosestPoint::new(trace.space).project(&Vector::from(*x)).unwrap();
        let field = solution.lambda(of, 0).unwrap().unwrap();
        field.at(foot.element, &[foot.xi]).into_iter().map(|values| values[0]).collect()
    }
}
