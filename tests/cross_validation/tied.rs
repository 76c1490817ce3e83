//! Ties beside what their answers are computed from: multiplier spaces, sides and couplings.

use crate::setting::{Member, Setting};
use faying::basis::{Basis, Order, ShapeTable};
use faying::coupling::interface::{MergedCurve, Partners, SlaveRule, Tolerance};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::{Coupling, Interface, InterfaceQuadrature, Mortar, Nitsche, Segments};
use faying::geometry::{ClosestPoint, Geometry, MapTable};
use faying::linalg::Vector;
use faying::problem::{BodyId, Integration, InterfaceSide, Multiplier, Solution, TieId};
use faying::space::Trace;
use std::sync::{Arc, Mutex};

/// Multiplier spaces, one per component, in the order in which the problem asked for them.
pub type Kept<const S: usize> = Arc<Mutex<Vec<Box<dyn Basis<S>>>>>;

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
pub struct Tied<const S: usize, const N: usize> {
    pub name: String,
    pub id: TieId,
    pub slave: (BodyId, String),
    pub master: (BodyId, String),
    pub how: How,
    spaces: Kept<S>,
}

/// A multiplier of a kind, and where its spaces are kept.
pub fn kept(kind: MultiplierKind) -> (Multiplier<1, 2>, Kept<1>) {
    let spaces = Kept::default();
    let into = Arc::clone(&spaces);
    let make = move |trace: &Trace<1, 2>, constrained: &dyn Fn(usize) -> bool| {
        into.lock().unwrap().push(trace.multiplier(kind, constrained)?);
        trace.multiplier(kind, constrained)
    };
    (Multiplier::of(make), spaces)
}

/// Values of `coefficients` of functions at local points of an element.
pub fn combined(basis: &dyn Basis<1>, coefficients: &[f64], element: usize, xi: &[Vector<1>]) -> Vec<f64> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    basis.active(element, &mut ids);
    basis.tabulate(element, xi, Order::Values, &mut table);
    (0..xi.len()).map(|q| ids.iter().zip(table.values(q)).map(|(&j, v)| coefficients[j] * v).sum()).collect()
}

/// Points per piece of two sides: degree + 1 of the higher one, and `extra`.
pub fn points_of(sides: [&Trace<1, 2>; 2], extra: usize) -> usize {
    let degree = |t: &Trace<1, 2>| (0..t.space.num_elements()).map(|e| t.space.degree(e)[0]).max().unwrap();
    degree(sides[0]).max(degree(sides[1])) + 1 + extra
}

impl Setting<1, 2> {
    /// Ties a side to another.
    pub fn tie(&mut self, name: &str, slave: (BodyId, &str), master: (BodyId, &str), how: How) {
        let tie = self.problem.tie(slave.0.side(slave.1), master.0.side(master.1)).unwrap().named(name);
        let (id, mut spaces) = (tie.id(), Kept::default());
        match how {
            How::Mortar(kind, rule, extra) => {
                let (multiplier, kept) = kept(kind);
                spaces = kept;
                tie.multiplier(multiplier).rule(rule).extra_points(extra);
            }
            How::Nitsche => {
                tie.coupling(Nitsche::default());
            }
        }
        let own = |(body, side): (BodyId, &str)| (body, side.to_owned());
        self.ties.push(Tied { name: name.into(), id, slave: own(slave), master: own(master), how, spaces });
    }
}

/// Both sides of a tie.
struct Both<'a> {
    members: [&'a Member<1, 2>; 2],
    traces: [Trace<1, 2>; 2],
}

impl Tied<1, 2> {
    fn both<'a>(&self, setting: &'a Setting<1, 2>) -> Both<'a> {
        let members = [setting.member(self.slave.0), setting.member(self.master.0)];
        Both { members, traces: [members[0].trace(&self.slave.1), members[1].trace(&self.master.1)] }
    }

    /// lambda at a point of the slave side.
    pub fn lambda(&self, setting: &Setting<1, 2>, solution: &Solution<1, 2>, x: &[f64; 2]) -> Vec<f64> {
        let Both { members, traces } = self.both(setting);
        let x = Vector::from(*x);
        let foot = ClosestPoint::new(traces[0].space.clone()).project(&x).unwrap();
        if self.how != How::Nitsche {
            return self.components(solution, foot.element, &[foot.xi]).into_iter().map(|values| values[0]).collect();
        }
        let mut map = MapTable::new();
        traces[0].space.map(foot.element, &[foot.xi], Order::Values, &mut map);
        let partner = ClosestPoint::new(traces[1].space.clone()).project(&map.x[0]).unwrap();
        let mut segments = Segments::new();
        segments.push_piece(foot.element, partner.element, [(foot.xi, partner.xi, 1.0)]);
        let fluxes = [0, 1].map(|k| members[k].flux(&traces[k]));
        let interface = Interface {
            slave: members[0].side(&traces[0], Some(&*fluxes[0])),
            master: Some(members[1].side(&traces[1], Some(&*fluxes[1]))),
            multiplier: &[],
            segments: &segments,
            master_segments: None,
            direction: None,
        };
        let lambda = Nitsche::default().lambda(&interface, &setting.unknowns(solution)).unwrap();
        lambda.into_iter().map(|values| values[0]).collect()
    }

    /// The multiplier at local points of a slave element: `[component][point]`.
    fn components(&self, solution: &Solution<1, 2>, element: usize, xi: &[Vector<1>]) -> Vec<Vec<f64>> {
        let (all, spaces) = (solution.multiplier(self.id).unwrap(), self.spaces.lock().unwrap());
        let count = |s: &dyn Basis<1>| s.num_functions();
        assert_eq!(all.len(), spaces.iter().map(|s| count(&**s)).sum::<usize>(), "{}: spaces of the multiplier", self.name);
        let mut first = 0;
        let one = |s: &Box<dyn Basis<1>>| {
            let own = &all[first..first + s.num_functions()];
            first += s.num_functions();
            combined(&**s, own, element, xi)
        };
        spaces.iter().map(one).collect()
    }

    /// The pieces on which it is integrated.
    fn segments(&self, both: &Both<'_>, rule: Integration, extra: usize) -> Segments<1> {
        let (points, partners) = (points_of([&both.traces[0], &both.traces[1]], extra), Partners::Touching(Tolerance::Exact));
        let [slave, master] = [0, 1].map(|k| both.traces[k].oriented());
        match rule {
            Integration::Merged => MergedCurve { points, partners }.segments(&slave, &master),
            _ => SlaveRule { points, partners }.segments(&slave, &master),
        }
        .unwrap()
    }

    /// The L2 norm of lambda - `exact(x, n)`, with the outward normal n of the slave, of one component.
    pub fn lambda_error(&self, setting: &Setting<1, 2>, solution: &Solution<1, 2>, exact: impl Fn(&Vector<2>, &Vector<2>) -> f64) -> f64 {
        let How::Mortar(_, rule, extra) = self.how else { panic!("{}: no multiplier", self.name) };
        let both = self.both(setting);
        let s = self.segments(&both, rule, extra);
        let (trace, mut map, mut sum) = (&both.traces[0], MapTable::new(), 0.0);
        for piece in 0..s.num_pieces() {
            let (element, points) = (s.slave[piece], s.points(piece));
            let xi = &s.slave_xi[points.clone()];
            trace.space.map(element, xi, Order::Gradients, &mut map);
            let found = &self.components(solution, element, xi)[0];
            for (k, q) in points.enumerate() {
                sum += s.ds[q] * (found[k] - exact(&map.x[k], &trace.normal(element, &map.jacobian[k]))).powi(2);
            }
        }
        sum.sqrt()
    }

    /// The sum of the forces of the multiplier on both bodies as a share of all of them: zero if action is reaction.
    pub fn balance(&self, setting: &Setting<1, 2>, solution: &Solution<1, 2>) -> f64 {
        let How::Mortar(_, rule, extra) = self.how else { panic!("{}: no multiplier", self.name) };
        let both = self.both(setting);
        let (segments, spaces) = (self.segments(&both, rule, extra), self.spaces.lock().unwrap());
        let multiplier: Vec<&dyn Basis<1>> = spaces.iter().map(|s| &**s).collect();
        let interface = Interface {
            slave: both.members[0].side(&both.traces[0], None),
            master: Some(both.members[1].side(&both.traces[1], None)),
            multiplier: &multiplier,
            segments: &segments,
            master_segments: None,
            direction: None,
        };
        let rows = Mortar.assemble(&interface, setting.num_unknowns()).unwrap().constraint;
        let lambda = solution.multiplier(self.id).unwrap();
        let (mut sums, mut size) = (vec![0.0; multiplier.len()], 0.0);
        for (member, part) in both.members.iter().zip([&rows.slave, &rows.master]) {
            for &(i, unknown, value) in &part.entries {
                let force = value * lambda[i];
                sums[(unknown - member.field.first) % member.field.components] += force;
                size += force.abs();
            }
        }
        sums.iter().fold(0.0, |m: f64, s| m.max(s.abs())) / size
    }
}
