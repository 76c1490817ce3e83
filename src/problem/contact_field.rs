//! Pressure at any point of a contact's slave side: that of its multiplier, or where it has none, that of its method.

use super::contact_fluxes::SideFluxes;
use super::model::{ContactModel, ContactPart, Model, Opposing};
use super::state::StepState;
use super::tie_field::multiplier_at;
use crate::basis::Order;
use crate::contact::{ContactResultants, ContactRows};
use crate::coupling::evaluate::jumps;
use crate::coupling::{Interface, Segments, Side};
use crate::geometry::{ClosestPoint, Geometry, MapTable, Oriented};
use crate::linalg::Vector;
use crate::space::Space;
use std::sync::Arc;

/// Tangential distance to the foot, over the whole, above which the foot lies on the edge of the master: the point faces nothing.
const BESIDE: f64 = 1e-6;

/// lambda of a contact part at a time, as a function of the state.
#[derive(Debug)]
pub struct PressureEvaluator<const S: usize, const N: usize>(Option<WithoutRows<S, N>>);

/// Fluxes at the time, and the search for partners on the master.
#[derive(Debug)]
struct WithoutRows<const S: usize, const N: usize> {
    fluxes: Option<Arc<SideFluxes<S, N>>>,
    master: Option<ClosestPoint<S, N, Oriented<Arc<dyn Space<S, N>>>>>,
}

impl<const S: usize, const N: usize> PressureEvaluator<S, N> {
    /// Creates the evaluator of `part` at time `t`.
    pub fn of(model: &Model<S, N>, contact: &ContactModel<S, N>, part: &ContactPart<S, N>, t: f64) -> Self {
        let master = match &part.against {
            Opposing::Side(master, _) => Some(ClosestPoint::new(master.trace.oriented())),
            Opposing::Rigid(..) => None,
        };
        let fluxes = || contact.method.needs().fluxes.then(|| part.sides().fluxes(model, t));
        Self(part.multiplier.is_none().then(|| WithoutRows { fluxes: fluxes(), master }))
    }

    /// Returns (lambda, gap) at local points of a slave element. The gap is that of a method without multiplier, NaN for multipliers;
    /// without multiplier both are zero where nothing is faced.
    pub fn at(
        &self,
        model: &Model<S, N>,
        contact: &ContactModel<S, N>,
        part: &ContactPart<S, N>,
        state: &StepState<S, N>,
        element: usize,
        xi: &[Vector<S>],
    ) -> Vec<[f64; 2]> {
        if let Some(read) = part.read_through() {
            return multiplier_at(read, &state.lambda[part.rows()], element, xi).into_iter().map(|l| [l, f64::NAN]).collect();
        }
        let mut all = vec![[0.0; 2]; xi.len()];
        let Some(own) = &self.0 else { return all };
        let (mut segments, mut asked) = (Segments::new(), Vec::new());
        let (mut map, mut there) = (MapTable::new(), MapTable::new());
        part.slave.trace.space.map(element, xi, Order::Gradients, &mut map);
        for (q, x) in map.x.iter().enumerate() {
            let (other, eta) = match (&own.master, &part.against) {
                (Some(closest), Opposing::Side(master, _)) => {
                    let outward = part.slave.trace.normal(element, &map.jacobian[q]);
                    let foot = closest.project_opposed(x, &outward, closest.size() * BESIDE);
                    let Some(foot) = foot.filter(|foot| contact.reach.is_none_or(|r| foot.distance <= r)) else { continue };
                    master.trace.space.map(foot.element, &[foot.xi], Order::Gradients, &mut there);
                    let (apart, normal) = (x - there.x[0], master.trace.normal(foot.element, &there.jacobian[0]));
                    if (apart - normal * apart.dot(&normal)).norm() > BESIDE * apart.norm().max(model.size * BESIDE) {
                        continue;
                    }
                    (foot.element, foot.xi)
                }
                _ => (0, Vector::<S>::zeros()),
            };
            segments.push_piece(element, other, [(xi[q], eta, 0.0)]);
            asked.push(q);
        }
        if let Some(values) = contact.values(model, part, own.fluxes.as_deref(), &segments, (&state.u, state.t)) {
            for (k, &point) in values.point.iter().enumerate() {
                all[asked[point]] = [values.lambda[k], values.gap[k]];
            }
        }
        all
    }
}

impl<const S: usize, const N: usize> ContactPart<S, N> {
    /// Pressure, force and moment that the part transmits by the multipliers `lambda` of its rows.
    pub fn transmitted(&self, built: &ContactRows<S, N>, lambda: &[f64]) -> ContactResultants<N> {
        match &self.multiplier {
            Some(psi) => built.transmitted_as_read(&**psi, self.read_through().unwrap_or(&**psi), lambda),
            None => built.transmitted_at_points(&built.row_of_points().unwrap_or_default().iter().map(|&j| lambda[j]).collect::<Vec<_>>()),
        }
    }

    /// Returns the gap of every row \[length\]: lumped over a multiplier function, or at its point; `None` if nothing is faced.
    pub fn gaps(&self, model: &Model<S, N>, built: &ContactRows<S, N>, u: &[f64]) -> Vec<Option<f64>> {
        let Some(row) = built.row_of_points() else { return built.lumped_gap(u) };
        let mut gaps = vec![None; built.offset.len()];
        for (&j, gap) in row.iter().zip(self.point_gaps(model, built, u)) {
            gaps[j] = Some(gap);
        }
        gaps
    }

    /// Returns the gap at every point of the segments \[length\].
    pub fn point_gaps(&self, model: &Model<S, N>, built: &ContactRows<S, N>, u: &[f64]) -> Vec<f64> {
        let side = |trace, field| Side { trace, field, flux: None };
        let interface = Interface {
            slave: side(&self.slave.trace, model.patches[self.slave.patch].field),
            master: match &self.against {
                Opposing::Side(master, _) => Some(side(&master.trace, master.field)),
                Opposing::Rigid(..) => None,
            },
            multiplier: &[],
            segments: &built.segments,
            master_segments: None,
            direction: None,
        };
        built.point_gaps(&jumps(&interface, u), u)
    }
}
