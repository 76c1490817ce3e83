//! Fields along the slave sides of ties and contacts in the plane: lambda, gap, normal, and their values function by function.

use super::arc_length::ArcLength;
use super::contact_along::contact_along;
use super::error::ProblemError;
use super::handles::InterfaceId;
use super::model::BodySide;
use super::solution::Solution;
use super::tie_along::tie_along;
use crate::basis::{Basis, Order, ShapeTable};
use crate::contact::{Obstacle, opposed};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Vector, measure};
use crate::quadrature::Quadrature;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// Numbers at local points of an element of a side, point by point.
pub(super) type Field = Box<dyn Fn(usize, &[Vector<1>]) -> Vec<f64> + Send + Sync>;

/// Fields along a slave side, which keep their solution.
pub struct SideField {
    pub(super) lambda: Field,
    pub(super) gap: Field,
    pub(super) active: Field,
    pub(super) traction: Field,
    pub(super) normal: Field,
    pub(super) degree: usize,
    pub(super) points: Vec<SidePoint>,
}

/// Values of a multiplier's function at its centre, or at a point of integration where there is no multiplier.
#[derive(Clone, Debug, PartialEq)]
pub struct SidePoint {
    /// Arc length along the side \[length\].
    pub s: f64,
    /// The point \[length\].
    pub x: Vector<2>,
    /// lambda, one number per component, of contacts one: coefficients of the function [force/area].
    pub lambda: Vec<f64>,
    /// Gap of a contact; of a tie the jump u_slave - u_master, in elasticity along the outward normal of the master; `None` where nothing
    /// is faced.
    pub gap: Option<f64>,
    /// Whether the row is closed.
    pub active: bool,
}

impl SideField {
    /// lambda at local points of an element [force/area], components point by point; of contacts one, negative where they press.
    pub fn lambda(&self, element: usize, xi: &[Vector<1>]) -> Vec<f64> {
        (self.lambda)(element, xi)
    }

    /// Gap of a contact \[length\]; of a tie the jump u_slave - u_master, in elasticity along the outward normal of the master, positive
    /// where it opens. Zero where nothing is faced.
    pub fn gap(&self, element: usize, xi: &[Vector<1>]) -> Vec<f64> {
        (self.gap)(element, xi)
    }

    /// 1 where a contact is closed, and on ties; else 0.
    pub fn active(&self, element: usize, xi: &[Vector<1>]) -> Vec<f64> {
        (self.active)(element, xi)
    }

    /// Traction on the slave's body [force/area], components point by point: minus lambda, of contacts along the normal of what they face.
    pub fn traction(&self, element: usize, xi: &[Vector<1>]) -> Vec<f64> {
        (self.traction)(element, xi)
    }

    /// Unit normal of the master or obstacle, point by point; minus that of the slave where nothing is faced.
    pub fn normal(&self, element: usize, xi: &[Vector<1>]) -> Vec<f64> {
        (self.normal)(element, xi)
    }

    /// Highest degree of the multiplier, of the side where it has none.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Values at the centres of the multiplier's functions in their order; without a multiplier at the points of integration along the
    /// side.
    pub fn points(&self) -> &[SidePoint] {
        &self.points
    }
}

impl Debug for SideField {
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
        let (of, state) = (of.into(), &self.inner);
        self.multiplier(of)?;
        let model = state.model();
        Ok(match of {
            InterfaceId::Tie(tie) => (side < model.ties[tie.number].parts.len()).then(|| tie_along(state, [tie.number, side])),
            InterfaceId::Contact(contact) => {
                (side < model.contacts[contact.number].parts.len()).then(|| contact_along(state, [contact.number, side]))
            }
        })
    }
}

/// The highest degree of a basis on a curve.
pub(super) fn degree(psi: &dyn Basis<1>) -> usize {
    (0..psi.num_elements()).map(|e| psi.degree(e)[0]).max().unwrap_or(1).max(1)
}

/// The centre of every function along the side: arc length and point.
pub(super) fn centres(side: &BodySide<1, 2>, psi: &dyn Basis<1>) -> Vec<(f64, Vector<2>)> {
    let space = &*side.trace.space;
    let arc = ArcLength::new(space);
    let (mut sums, mut table, mut ids, mut map) = (vec![[0.0; 2]; psi.num_functions()], ShapeTable::new(), Vec::new(), MapTable::new());
    for e in 0..space.num_elements() {
        let rule = side.rules.rule(e);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        psi.active(e, &mut ids);
        psi.tabulate(e, &rule.points, Order::Values, &mut table);
        for (q, &w) in rule.weights.iter().enumerate() {
            let (s, ds) = (arc.of(e, rule.points[q][0]), w * measure(&map.jacobian[q]));
            for (&j, v) in ids.iter().zip(table.values(q)) {
                sums[j][0] += v.abs() * ds * s;
                sums[j][1] += v.abs() * ds;
            }
        }
    }
    sums.iter()
        .map(|[moment, weight]| {
            let s = if *weight > 0.0 { moment / weight } else { 0.0 };
            (s, arc.point(s))
        })
        .collect()
}

/// The normal of the obstacle or master that faces each point of a slave element.
pub(super) fn normals(slave: &Arc<BodySide<1, 2>>, target: Box<dyn Obstacle<1, 2>>) -> Field {
    let slave = Arc::clone(slave);
    Box::new(move |element, xi| {
        let mut map = MapTable::new();
        slave.trace.space.map(element, xi, Order::Gradients, &mut map);
        (0..xi.len())
            .flat_map(|q| {
                // points that face nothing show minus the slave's normal
                let own = slave.trace.normal(element, &map.jacobian[q]);
                let n = opposed(&*target, &map.x[q], &own).map_or(-own, |hit| hit.normal);
                [n[0], n[1]]
            })
            .collect()
    })
}
