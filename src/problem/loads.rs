//! Loads of a model at a time, and their resultant.

use super::data::Point;
use super::handles::Statement;
use super::integrate::over_side;
use super::model::{Action, BodyModel, Model, SideLoad};
use super::physics::Physics;
use super::resultant::Resultant;
use crate::linalg::Vector;

/// A load and what it sums up to.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadSum {
    /// The first statement of the load, or the body whose volume it acts on.
    pub of: Statement,
    /// Its name: that of the load, or of a patch with `.body_force`, in problems of one component `.source`.
    pub name: String,
    /// The patch whose volume it acts on; `None` for loads on sides.
    pub patch: Option<usize>,
    /// Force and moment about the origin; of a source or a flux its sum is the first component of the force.
    pub resultant: Resultant,
}

/// The loads of a model at a time.
#[derive(Debug)]
pub(super) struct Loads {
    /// f in all unknowns.
    pub vector: Vec<f64>,
    /// Resultants on each patch, then on the obstacle of each contact.
    pub totals: Vec<Resultant>,
    /// The resultant of every load.
    pub sums: Vec<LoadSum>,
}

fn place<const N: usize>(x: &Vector<N>, t: f64) -> Point {
    Point::new(x.as_slice()).at_time(t)
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The force per volume of a patch at a point; none where there is none at all.
    pub(super) fn volume_force<'a>(&self, patch: &'a BodyModel<S, N>, t: f64) -> Option<Box<dyn Fn(&Vector<N>, &mut [f64]) + Sync + 'a>> {
        if let Some(exact) = &patch.exact {
            let physics = patch.physics_at(t);
            let is_revolved = patch.is_revolved();
            return Some(Box::new(move |x: &Vector<N>, out: &mut [f64]| physics.exact_source(&**exact, &place(x, t), x, is_revolved, out)));
        }
        if patch.source.is_empty() && patch.weights.is_empty() {
            return None;
        }
        let (source, weights) = (patch.source.clone(), patch.weights.clone());
        Some(Box::new(move |x: &Vector<N>, out: &mut [f64]| {
            let at = place(x, t);
            out.fill(0.0);
            let components = out.len();
            // model and patch list one function per component each
            for (k, f) in source.iter().enumerate() {
                out[k % components] += f.value(&at);
            }
            for (density, gravity) in &weights {
                let rho = density.value(&at);
                for (o, g) in out.iter_mut().zip(gravity.iter()) {
                    *o += rho * g;
                }
            }
        }))
    }

    /// The force per area of a load at a point of its side with the outward normal `n`, one entry per component.
    pub(super) fn side_force(&self, load: &SideLoad<S, N>, physics: &Physics<N>, t: f64, x: &Vector<N>, n: &Vector<N>, out: &mut [f64]) {
        out.fill(0.0);
        match &load.action {
            Action::Traction(component, f) => out[*component] = f.value(&place(x, t)),
            Action::Exact(component) => {
                let exact = self.patches[load.side.patch].exact.as_ref().expect("exact data were refused without an exact solution");
                let mut traction = vec![0.0; out.len()];
                physics.exact_traction(&**exact, &place(x, t), x, n, &mut traction);
                out[*component] = traction[*component];
            }
            Action::Pressure(p) => {
                let p = p.value(&place(x, t));
                for (o, n) in out.iter_mut().zip(n.iter()) {
                    *o = -p * n;
                }
            }
            Action::Force(component, f, area) => out[*component] = f.value(&place(x, t)) / area,
        }
    }

    /// The loads at time `t`.
    pub(super) fn loads(&self, t: f64) -> Loads {
        let mut load = vec![0.0; self.unknowns];
        let mut totals = vec![Resultant::default(); self.patches.len() + self.contacts.len()];
        let mut sums = self.no_loads();
        let c = self.components;
        let mut next = 0;
        for (patch, total) in self.patches.iter().zip(&mut totals) {
            let Some(force) = self.volume_force(patch, t) else { continue };
            let space = &**patch.body.space();
            let (own, resultant) = patch.physics.load(space, &patch.rules, &*force);
            load[patch.range()].copy_from_slice(&own);
            total.sum(&resultant);
            sums[next].resultant = resultant;
            next += 1;
        }
        for side_load in &self.loads {
            let (side, patch) = (&side_load.side, &self.patches[side_load.side.patch]);
            let physics = patch.physics_at(t);
            let act = |x: &Vector<N>, n: &Vector<N>, out: &mut [f64]| self.side_force(side_load, &physics, t, x, n, out);
            physics.side_load(&side.trace, &side.rules, &act, &mut load[patch.range()]);
            let mut value = vec![0.0; c];
            let mut own = Resultant::default();
            over_side(side, |_, _, x, n, ds| {
                act(x, n, &mut value);
                totals[side.patch].add(x, &value, ds);
                own.add(x, &value, ds);
            });
            let sum = sums.iter_mut().find(|s| s.of == side_load.group).expect("every load has a sum");
            sum.resultant.sum(&own);
        }
        for point_load in &self.point_loads {
            let patch = &self.patches[point_load.rim.patch];
            let mut value = vec![0.0; c];
            let mut own = Resultant::default();
            point_load.visit(t, |x, force, weight, shapes| {
                shapes.iter().for_each(|&(function, n)| load[patch.field.unknown(function, point_load.component)] += force * weight * n);
                value[point_load.component] = force;
                own.add(x, &value, weight);
            });
            totals[point_load.rim.patch].sum(&own);
            sums.iter_mut().find(|s| s.of == point_load.group).expect("every load has a sum").resultant.sum(&own);
        }
        // forces on obstacles: their moments are carried by the guides, which prevent rotations
        for (contact, total) in self.contacts.iter().zip(&mut totals[self.patches.len()..]) {
            for p in contact.obstacle.iter().flat_map(|o| &o.pressed) {
                let force = p.force.value(&Point::default().at_time(t));
                load[p.unknown] += force;
                total.force[p.component] += force;
            }
        }
        totals.iter_mut().chain(sums.iter_mut().map(|s| &mut s.resultant)).for_each(|r| *r = self.in_space(*r));
        Loads { vector: load, totals, sums }
    }

    /// All loads with the resultant zero: those of the bodies' volumes, of sides, then of edges and corners, each name once.
    pub fn no_loads(&self) -> Vec<LoadSum> {
        let kind = if self.components == 1 { "source" } else { "body_force" };
        let loaded = |p: &BodyModel<S, N>| p.exact.is_some() || !p.source.is_empty() || !p.weights.is_empty();
        let volumes = self.patches.iter().enumerate().filter(|(_, p)| loaded(p));
        let sum = |of, name: String, patch| LoadSum { of, name, patch, resultant: Resultant::default() };
        let mut all: Vec<LoadSum> = volumes.map(|(k, p)| sum(p.id.into(), format!("{}.{kind}", p.name), Some(k))).collect();
        let of_sides = self.loads.iter().map(|load| (load.group, &load.name));
        for (group, name) in of_sides.chain(self.point_loads.iter().map(|load| (load.group, &load.name))) {
            if !all.iter().any(|s| s.of == group) {
                all.push(sum(group, name.clone(), None));
            }
        }
        all
    }

    /// The resultant of every load at time `t`, as the rules of the problem integrate it.
    pub fn load_sums(&self, t: f64) -> Vec<LoadSum> {
        self.loads(t).sums
    }
}
