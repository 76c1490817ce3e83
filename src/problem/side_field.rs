//! Fields along the slave sides of ties and contacts: lambda, gap, normal, and their values function by function.

use super::arc_length::ArcLength;
use super::contact_along::contact_along;
use super::error::ProblemError;
use super::handles::InterfaceId;
use super::model::{BodySide, Opposing};
use super::solution::Solution;
use super::tie_along::tie_along;
use crate::basis::{Basis, Order, ShapeTable};
use crate::contact::{FacingSurface, Obstacle, Surface, opposed};
use crate::geometry::MapTable;
use crate::linalg::{Vector, measure};
use crate::quadrature::Quadrature;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// Numbers at local points of an element of a side, point by point.
pub(super) type Field<const S: usize> = Box<dyn Fn(usize, &[Vector<S>]) -> Vec<f64> + Send + Sync>;

/// Fields along a slave side, which keep their solution.
pub struct SideField<const S: usize = 1, const N: usize = 2> {
    pub(super) lambda: Field<S>,
    pub(super) gap: Field<S>,
    pub(super) active: Field<S>,
    pub(super) traction: Field<S>,
    pub(super) normal: Field<S>,
    pub(super) exact: Option<Field<S>>,
    pub(super) degree: usize,
    pub(super) points: Vec<SidePoint<N>>,
}

/// Values of a multiplier's function at its centre, or at a point of integration where there is no multiplier.
#[derive(Clone, Debug, PartialEq)]
pub struct SidePoint<const N: usize = 2> {
    /// Arc length along a curve \[length\]; `None` on surfaces.
    pub s: Option<f64>,
    /// The point \[length\]; of a function on a surface the mean place, weighted with its absolute value.
    pub x: Vector<N>,
    /// lambda, one number per component, of contacts one: coefficients of the function, of ties whose components have different functions
    /// the values at this point [force/area].
    pub lambda: Vec<f64>,
    /// Gap of a contact; of a tie the jump u_slave - u_master, in elasticity along the outward normal of the master; `None` where nothing
    /// is faced.
    pub gap: Option<f64>,
    /// Whether the row is closed.
    pub active: bool,
}

impl<const S: usize, const N: usize> SideField<S, N> {
    /// lambda at local points of an element [force/area], components point by point; of contacts one, negative where they press.
    pub fn lambda(&self, element: usize, xi: &[Vector<S>]) -> Vec<f64> {
        (self.lambda)(element, xi)
    }

    /// Gap of a contact \[length\]; of a tie the jump u_slave - u_master, in elasticity along the outward normal of the master, positive
    /// where it opens. Zero where nothing is faced.
    pub fn gap(&self, element: usize, xi: &[Vector<S>]) -> Vec<f64> {
        (self.gap)(element, xi)
    }

    /// 1 where a contact is closed, and on ties; else 0.
    pub fn active(&self, element: usize, xi: &[Vector<S>]) -> Vec<f64> {
        (self.active)(element, xi)
    }

    /// Traction on the slave's body [force/area], components point by point: minus lambda, of contacts along the normal of what they face.
    pub fn traction(&self, element: usize, xi: &[Vector<S>]) -> Vec<f64> {
        (self.traction)(element, xi)
    }

    /// Unit normal of the master or obstacle, point by point; minus that of the slave where nothing is faced.
    pub fn normal(&self, element: usize, xi: &[Vector<S>]) -> Vec<f64> {
        (self.normal)(element, xi)
    }

    /// Exact lambda at local points of an element, in the order of [`lambda`](Self::lambda): the own one of the tie or the contact, else that
    /// of the problem's exact solution; `None` without any. NaN where it is open which piece of it the side has.
    pub fn exact(&self, element: usize, xi: &[Vector<S>]) -> Option<Vec<f64>> {
        self.exact.as_ref().map(|exact| exact(element, xi))
    }

    /// Highest degree of the multiplier, of the side where it has none.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Values at the centres of the multiplier's functions in their order; without a multiplier at the points of integration, of curves
    /// along the side.
    pub fn points(&self) -> &[SidePoint<N>] {
        &self.points
    }
}

impl<const S: usize, const N: usize> Debug for SideField<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SideField").field("degree", &self.degree).field("points", &self.points.len()).finish_non_exhaustive()
    }
}

impl Solution<1, 2> {
    /// Fields along the slave side with a number, from 0, of a tie or a contact; `None` if there is no such side.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) as for [`multiplier`](Self::multiplier).
    pub fn along(&self, of: impl Into<InterfaceId>, side: usize) -> Result<Option<SideField>, ProblemError> {
        self.along_curve(of.into(), side)
    }

    fn along_curve(&self, of: InterfaceId, side: usize) -> Result<Option<SideField>, ProblemError> {
        self.multiplier(of)?;
        let (state, model) = (&self.inner, self.inner.model());
        Ok(match of {
            InterfaceId::Tie(tie) => model.ties[tie.number]
                .parts
                .get(side)
                .map(|part| tie_along(state, [tie.number, side], Some(&ArcLength::of_side(&part.slave)))),
            InterfaceId::Contact(contact) => model.contacts[contact.number].parts.get(side).map(|part| {
                let faced = || -> Box<dyn Obstacle<1, 2>> {
                    match &part.against {
                        Opposing::Side(master, _) => Box::new(Surface::new(&master.trace, None)),
                        Opposing::Rigid(obstacle, ..) => obstacle.target(state.state().t, Some(&state.state().u)),
                    }
                };
                contact_along(state, [contact.number, side], &faced, Some(&ArcLength::of_side(&part.slave)))
            }),
        })
    }
}

impl Solution<2, 3> {
    /// Fields on the slave side with a number, from 0, of a tie or a contact; `None` if there is no such side.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) as for [`multiplier`](Self::multiplier).
    pub fn along(&self, of: impl Into<InterfaceId>, side: usize) -> Result<Option<SideField<2, 3>>, ProblemError> {
        self.on_surface(of.into(), side)
    }

    fn on_surface(&self, of: InterfaceId, side: usize) -> Result<Option<SideField<2, 3>>, ProblemError> {
        self.multiplier(of)?;
        let state = &self.inner;
        let contact = match of {
            InterfaceId::Contact(contact) => contact,
            InterfaceId::Tie(tie) => {
                let there = side < state.model().ties[tie.number].parts.len();
                return Ok(there.then(|| tie_along(state, [tie.number, side], None)));
            }
        };
        let Some(part) = state.model().contacts[contact.number].parts.get(side) else { return Ok(None) };
        let faced = || -> Box<dyn Obstacle<2, 3>> {
            match &part.against {
                Opposing::Side(master, _) => Box::new(FacingSurface::new(&master.trace)),
                Opposing::Rigid(obstacle, ..) => obstacle.target(state.state().t, Some(&state.state().u)),
            }
        };
        Ok(Some(contact_along(state, [contact.number, side], &faced, None)))
    }
}

/// The highest degree of a basis.
pub(super) fn degree<const S: usize>(psi: &dyn Basis<S>) -> usize {
    (0..psi.num_elements()).flat_map(|e| psi.degree(e)).max().unwrap_or(1).max(1)
}

/// The centre of every function: its arc length on curves, and the point there; on surfaces the mean place.
pub(super) fn centres<const S: usize, const N: usize>(
    side: &BodySide<S, N>,
    psi: &dyn Basis<S>,
    arc: Option<&ArcLength<'_, N>>,
) -> Vec<(Option<f64>, Vector<N>)> {
    let space = &*side.trace.space;
    let (mut table, mut ids, mut map) = (ShapeTable::new(), Vec::new(), MapTable::new());
    // integrals of |psi|, |psi| s and |psi| x
    let mut sums = vec![(0.0, 0.0, Vector::<N>::zeros()); psi.num_functions()];
    for e in 0..space.num_elements() {
        let rule = side.rules.rule(e);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        psi.active(e, &mut ids);
        psi.tabulate(e, &rule.points, Order::Values, &mut table);
        for (q, &w) in rule.weights.iter().enumerate() {
            let (s, ds) = (arc.map_or(0.0, |arc| arc.of(e, rule.points[q][0])), w * measure(&map.jacobian[q]));
            for (&j, v) in ids.iter().zip(table.values(q)) {
                let (weight, moment, place) = &mut sums[j];
                *moment += v.abs() * ds * s;
                *weight += v.abs() * ds;
                *place += map.x[q] * (v.abs() * ds);
            }
        }
    }
    let centre = |(weight, moment, place): &(f64, f64, Vector<N>)| match arc {
        Some(arc) => {
            let s = if *weight > 0.0 { moment / weight } else { 0.0 };
            (Some(s), arc.point(s))
        }
        None => (None, place / if *weight > 0.0 { *weight } else { 1.0 }),
    };
    sums.iter().map(centre).collect()
}

/// The normal of the obstacle or master that faces each point of a slave element.
pub(super) fn normals<const S: usize, const N: usize>(slave: &Arc<BodySide<S, N>>, target: Box<dyn Obstacle<S, N>>) -> Field<S> {
    let slave = Arc::clone(slave);
    Box::new(move |element, xi| {
        let mut map = MapTable::new();
        let normals = slave.trace.normals(element, xi, &mut map);
        (0..xi.len())
            .flat_map(|q| {
                // points that face nothing show minus the slave's normal
                let own = normals[q];
                opposed(&*target, &map.x[q], &own).map_or(-own, |hit| hit.normal).into_iter().copied().collect::<Vec<_>>()
            })
            .collect()
    })
}
