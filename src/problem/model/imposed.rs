//! Supports and loads.

use super::{BodyRim, BodySide};
use crate::assembly::Equation;
use crate::linalg::Vector;
use crate::problem::data::{Data, Point};
use crate::problem::handles::Statement;
use std::sync::Arc;

/// A prescribed value.
#[derive(Clone, Debug)]
pub enum Value {
    /// Zero.
    Zero,
    /// The exact solution.
    Exact,
    /// A function.
    Data(Data),
}

impl From<Data> for Value {
    fn from(data: Data) -> Self {
        if data.as_constant() == Some(0.0) { Self::Zero } else { Self::Data(data) }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Data::from(value).into()
    }
}

/// A component prescribed on a side.
#[derive(Clone, Debug)]
pub struct Condition<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The side.
    pub side: Arc<BodySide<S, N>>,
    /// The component.
    pub component: usize,
    /// Its value.
    pub value: Value,
}

/// A component prescribed on an edge or in a corner.
#[derive(Clone, Debug)]
pub struct PointCondition<const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The edge or the corner.
    pub rim: Arc<BodyRim<N>>,
    /// The component.
    pub component: usize,
    /// Its value.
    pub value: Value,
}

/// A load per point of a side.
#[derive(Clone, Debug)]
pub enum Action {
    /// Component of the traction [force/area], or k du/dn.
    Traction(usize, Data),
    /// Component of the traction of the exact solution.
    Exact(usize),
    /// Pressure along minus the outward normal.
    Pressure(Data),
    /// Component of a resultant, spread evenly \[force\].
    Force(usize, Data, f64),
}

/// A load on a side.
#[derive(Clone, Debug)]
pub struct SideLoad<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The first statement of its name; loads of one are summed in results.
    pub group: Statement,
    /// Name of the load in results.
    pub name: String,
    /// The side.
    pub side: Arc<BodySide<S, N>>,
    /// The load.
    pub action: Action,
}

/// A component of a force on an edge or in a corner.
#[derive(Clone, Debug)]
pub struct PointLoad<const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The first statement of its name; loads of one are summed in results.
    pub group: Statement,
    /// Name of the load in results.
    pub name: String,
    /// The edge or the corner.
    pub rim: Arc<BodyRim<N>>,
    /// The component.
    pub component: usize,
    /// The resultant of the statement \[force\].
    pub force: Data,
    /// Length of all edges of the statement, or number of its corners, over which the resultant is spread evenly.
    pub measure: f64,
}

impl<const N: usize> PointLoad<N> {
    /// Visits the points with their forces per length, or forces, at time `t`: position, value, weight, and the functions there.
    pub fn visit(&self, t: f64, mut act: impl FnMut(&Vector<N>, f64, f64, &[(usize, f64)])) {
        let rim = &self.rim.rim;
        for ((x, &weight), shapes) in rim.x.iter().zip(&rim.weight).zip(&rim.shapes) {
            act(x, self.force.value(&Point::new(x.as_slice()).at_time(t)) / self.measure, weight, shapes);
        }
    }
}

/// An equation between unknowns.
#[derive(Clone, Debug)]
pub struct SaidEquation {
    /// The statement.
    pub of: Statement,
    /// The equation.
    pub equation: Equation,
}

/// A side whose functions equations hold along a direction.
#[derive(Clone, Debug)]
pub struct HeldSide<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The side.
    pub side: Arc<BodySide<S, N>>,
    /// The normal, a tangent, or the axis along which the side moves as one.
    pub direction: Vector<N>,
}

/// Sides that move as one in a component, driven by a resultant.
#[derive(Clone, Debug)]
pub struct RigidSides<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The sides.
    pub sides: Vec<Arc<BodySide<S, N>>>,
    /// The component that all their points have in common.
    pub component: usize,
}

/// Springs between a body, everywhere in it, and the ground.
#[derive(Clone, Debug)]
pub struct Foundation {
    /// The statement.
    pub of: Statement,
    /// The body.
    pub body: usize,
    /// The component.
    pub component: usize,
    /// Force/volume per length.
    pub stiffness: Data,
}

/// Springs between a side and the ground.
#[derive(Clone, Debug)]
pub struct SideSpring<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// Name of the springs in messages.
    pub name: String,
    /// The side.
    pub side: Arc<BodySide<S, N>>,
    /// The component.
    pub component: usize,
    /// Force/area per length.
    pub stiffness: Data,
}
