//! Loads of a model at a time, and their resultant.

use super::data::Point;
use super::integrate::over_side;
use super::model::{Action, Model, PatchModel};
use super::resultant::Resultant;
use crate::linalg::Vector;

fn place<const N: usize>(x: &Vector<N>, t: f64) -> Point {
    Point::new(x.as_slice()).at_time(t)
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The force per volume of a patch at a point; none where there is none at all.
    fn volume_force(&self, patch: &PatchModel<S, N>, t: f64) -> Option<Box<dyn Fn(&Vector<N>, &mut [f64]) + Sync + '_>> {
        if let Some(exact) = &self.exact {
            let physics = patch.physics_at(t);
            return Some(Box::new(move |x: &Vector<N>, out: &mut [f64]| physics.exact_source(&**exact, &place(x, t), x, out)));
        }
        if patch.source.is_empty() && patch.weight.is_none() {
            return None;
        }
        let (source, weight) = (patch.source.clone(), patch.weight.clone());
        Some(Box::new(move |x: &Vector<N>, out: &mut [f64]| {
            let at = place(x, t);
            out.fill(0.0);
            let components = out.len();
            // model and patch list one function per component each
            for (k, f) in source.iter().enumerate() {
                out[k % components] += f.value(&at);
            }
            if let Some((density, gravity)) = &weight {
                let rho = density.value(&at);
                for (o, g) in out.iter_mut().zip(gravity) {
                    *o += rho * g;
                }
            }
        }))
    }

    /// f in all unknowns at time `t`, and the resultants of the loads on each patch, then on the obstacle of each contact.
    pub(super) fn loads(&self, t: f64) -> (Vec<f64>, Vec<Resultant>) {
        let mut load = vec![0.0; self.unknowns];
        let mut totals = vec![Resultant::default(); self.patches.len() + self.contacts.len()];
        let c = self.components;
        for (patch, total) in self.patches.iter().zip(&mut totals) {
            let Some(force) = self.volume_force(patch, t) else { continue };
            let space = &**patch.body.space();
            let (own, resultant) = patch.physics.load(space, &patch.rules, &*force);
            load[patch.range()].copy_from_slice(&own);
            total.sum(&resultant);
        }
        for side_load in &self.loads {
            let (side, patch) = (&side_load.side, &self.patches[side_load.side.patch]);
            let physics = patch.physics_at(t);
            let act = |x: &Vector<N>, n: &Vector<N>, out: &mut [f64]| {
                out.fill(0.0);
                match &side_load.action {
                    Action::Traction(component, f) => out[*component] = f.value(&place(x, t)),
                    Action::Exact(component) => {
                        let exact = self.exact.as_ref().expect("exact data were refused without an exact solution");
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
            };
            physics.side_load(&side.trace, &side.rules, &act, &mut load[patch.range()]);
            let mut value = vec![0.0; c];
            let total = &mut totals[side.patch];
            over_side(side, |_, _, x, n, ds| {
                act(x, n, &mut value);
                total.add(x, &value, ds);
            });
        }
        // forces on obstacles: their moments are carried by the guides, which prevent rotations
        for (contact, total) in self.contacts.iter().zip(&mut totals[self.patches.len()..]) {
            for p in contact.obstacle.iter().flat_map(|o| &o.pressed) {
                let force = p.force.value(&Point::default().at_time(t));
                load[p.unknown] += force;
                total.force[p.component] += force;
            }
        }
        (load, totals)
    }
}
