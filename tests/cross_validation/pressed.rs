//! Contacts beside what their answers are computed from: rows, multipliers and pressures on the same points.

use crate::choices::{Choices, one_of};
use crate::setting::{Member, Setting};
use crate::tied::{combined, points_of};
use faying::assembly::gauss_rules;
use faying::basis::Basis;
use faying::contact::{ClosedSide, Cone, ContactAt, ContactMethod, ContactRows, Frames, Obstacle, Opponent, Transmitted, half_width};
use faying::coupling::interface::{MergedCurve, Partners, slave_segments};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::{InterfaceQuadrature, Nitsche, Segments};
use faying::geometry::{ClosestPoint, Geometry, MapTable};
use faying::linalg::Vector;
use faying::physics::Flux;
use faying::problem::{BodyId, ContactId, Data, InterfaceSide, Point, Solution};
use faying::space::Trace;
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
pub struct Pressed<const S: usize, const N: usize> {
    pub name: String,
    pub id: ContactId,
    slave: (BodyId, String),
    faced: Faced,
    method: Method,
    gap: Data,
}

impl Setting<1, 2> {
    /// Presses a side of a half model on what it faces.
    pub fn press(&mut self, name: &str, slave: (BodyId, &str), faced: Faced, gap: Data, method: Method) {
        let on = slave.0.side(slave.1);
        let contact = match &faced {
            Faced::Side(body, side) => self.problem.contact(on, body.side(side)),
            Faced::Obstacle(obstacle) => self.problem.contact(on, faying::problem::Opponent::Obstacle(Arc::clone(obstacle))),
        };
        let contact = contact.unwrap().named(name).gap(gap.clone()).symmetry();
        match method {
            Method::Lagrange(kind, cone) => contact.multiplier(kind).cone(cone),
            Method::Penalty(factor) => contact.method(faying::coupling::Penalty { factor }),
            Method::Augmented => contact.method(faying::contact::Augmented::default()),
            Method::Nitsche => contact.method(Nitsche::default()),
        };
        let id = contact.id();
        self.contacts.push(Pressed { name: name.into(), id, slave: (slave.0, slave.1.into()), faced, method, gap });
    }
}

/// The sides of a contact.
struct Sides<'a> {
    slave: (&'a Member<1, 2>, Trace<1, 2>, Box<dyn Flux<1, 2>>),
    master: Option<(&'a Member<1, 2>, Trace<1, 2>, Box<dyn Flux<1, 2>>)>,
}

/// A contact in a state.
pub struct InState<'a> {
    pressed: &'a Pressed<1, 2>,
    sides: Sides<'a>,
    rows: ContactRows<1, 2>,
    /// Functions of the multiplier, and those by which its pressure is read; none at points.
    spaces: Option<(Box<dyn Basis<1>>, Box<dyn Basis<1>>)>,
    lambda: Vec<f64>,
    unknowns: Vec<f64>,
}

impl Pressed<1, 2> {
    fn opponent<'a>(&'a self, sides: &'a Sides<'_>) -> Opponent<'a, 1, 2> {
        match (&self.faced, &sides.master) {
            (Faced::Obstacle(obstacle), _) => Opponent::Rigid(&**obstacle, None),
            (_, Some((member, trace, flux))) => Opponent::Master(member.side(trace, Some(&**flux))),
            _ => panic!("{}: no opponent", self.name),
        }
    }

    fn gap(&self, x: &Vector<2>, g: f64) -> f64 {
        self.gap.value(&Point::new(x.as_slice()).with_gap(g))
    }

    /// The contact in a solution.
    pub fn in_state<'a>(&'a self, setting: &'a Setting<1, 2>, solution: &Solution<1, 2>) -> InState<'a> {
        let of = |body: BodyId, side: &str| {
            let member = setting.member(body);
            let trace = member.trace(side);
            let flux = member.flux(&trace);
            (member, trace, flux)
        };
        let slave = of(self.slave.0, &self.slave.1);
        let master = match &self.faced {
            Faced::Side(body, side) => Some(of(*body, side)),
            Faced::Obstacle(_) => None,
        };
        let sides = Sides { slave, master };
        let trace = &sides.slave.1;
        let segments = match &sides.master {
            None => slave_segments(&*trace.space, &gauss_rules(&*trace.space, 0)),
            Some((_, other, _)) => {
                let rule = MergedCurve { points: points_of([trace, other], 0), partners: Partners::Facing { reach: None } };
                rule.segments(&trace.oriented(), &other.oriented()).unwrap()
            }
        };
        let side = sides.slave.0.side(trace, Some(&*sides.slave.2));
        let (gap, opponent) = (|x: &Vector<2>, g: f64| self.gap(x, g), self.opponent(&sides));
        let (lambda, unknowns) = (solution.multiplier(self.id).unwrap(), setting.unknowns(solution));
        let (rows, spaces) = if self.method == Method::Nitsche {
            (ContactRows::nitsche(&Nitsche::default(), side, opponent, &segments, &gap, unknowns.len()).unwrap(), None)
        } else {
            let (kind, cone) = match self.method {
                Method::Lagrange(kind, cone) => (kind, cone),
                _ => (MultiplierKind::Auto, Cone::Coefficients),
            };
            let spaces = self.spaces(&sides, kind, &segments);
            assert_eq!(spaces.0.num_functions(), lambda.len(), "{}: space of the multiplier", self.name);
            let rows = ContactRows::new(side, opponent, &*spaces.0, segments, &gap, unknowns.len()).unwrap();
            (rows.with_cone(cone, &*spaces.0).unwrap(), Some(spaces))
        };
        InState { pressed: self, sides, rows, spaces, lambda, unknowns }
    }

    /// The multiplier of a kind, of a side that may move along the normal everywhere, and the functions by which it is read.
    fn spaces(&self, sides: &Sides<'_>, kind: MultiplierKind, segments: &Segments<1>) -> (Box<dyn Basis<1>>, Box<dyn Basis<1>>) {
        let (trace, free) = (&sides.slave.1, |_: usize| false);
        let (facing, _) = match (&self.faced, &sides.master) {
            (Faced::Obstacle(obstacle), _) => Frames::against_obstacle(trace, &**obstacle, segments, None).unwrap(),
            (_, Some((_, other, _))) => Frames::against_master(trace, other, segments).unwrap(),
            _ => panic!("{}: no opponent", self.name),
        };
        if kind == MultiplierKind::Dual {
            return trace.covered_dual(&free, &facing).unwrap();
        }
        let faced = if sides.master.is_some() { segments } else { &facing };
        let make = || trace.without_slivers(trace.multiplier(kind, &free).unwrap(), faced);
        (make(), make())
    }
}

impl InState<'_> {
    /// Force, moment, pressures and zone by the rows.
    pub fn transmitted(&self) -> Transmitted<2> {
        match &self.spaces {
            Some((functions, reading)) => self.rows.transmitted_as_read(&**functions, &**reading, &self.lambda),
            None => {
                self.rows.transmitted_at_points(&self.rows.row_of_points().unwrap().iter().map(|&j| self.lambda[j]).collect::<Vec<_>>())
            }
        }
    }

    /// Half the width of the zone of the whole model; not a number where the pressure does not tell its end, as on coarse sides.
    pub fn half_width(&self) -> f64 {
        let sent = self.transmitted();
        let slave = &*self.sides.slave.1.space;
        let side = ClosedSide { slave, contact: &self.rows, closed: &sent.closed, pressure: &sent.pressure };
        half_width(&[side], true).unwrap_or(f64::NAN)
    }

    /// The pressure at a point of the slave side.
    pub fn pressure(&self, x: &[f64; 2]) -> f64 {
        let (member, trace, flux) = &self.sides.slave;
        let foot = ClosestPoint::new(trace.space.clone()).project(&Vector::from(*x)).unwrap();
        if let Some((_, reading)) = &self.spaces {
            return -combined(&**reading, &self.lambda, foot.element, &[foot.xi])[0];
        }
        let mut map = MapTable::new();
        trace.space.map(foot.element, &[foot.xi], faying::basis::Order::Gradients, &mut map);
        let (mut segments, mut partner) = (Segments::new(), (0, Vector::<1>::zeros()));
        if let Some((_, other, _)) = &self.sides.master {
            let (closest, outward) = (ClosestPoint::new(other.oriented()), trace.normal(foot.element, &map.jacobian[0]));
            let found = closest.project_opposed(&map.x[0], &outward, closest.size() * 1e-6).unwrap();
            partner = (found.element, found.xi);
        }
        segments.push_piece(foot.element, partner.0, [(foot.xi, partner.1, 1.0)]);
        let (gap, side) = (|x: &Vector<2>, g: f64| self.pressed.gap(x, g), member.side(trace, Some(&**flux)));
        let opponent = self.pressed.opponent(&self.sides);
        let at = ContactAt::new(side, opponent, &segments, None, &gap, self.unknowns.len());
        let values = Nitsche::default().values(&at, &self.unknowns).unwrap().unwrap();
        values.lambda.first().map_or(0.0, |l| -l)
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
