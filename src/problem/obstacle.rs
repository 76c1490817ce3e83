//! Rigid obstacles: their shape, motion, and the forces that press them.

use super::changing::Changing;
use super::data::{Data, Point};
use crate::contact::{Moved, Obstacle};
use crate::linalg::Vector;

/// A component in which a force presses an obstacle: its translation is an unknown.
#[derive(Clone, Debug)]
pub struct ForceDriven {
    /// The component.
    pub component: usize,
    /// The unknown of the model.
    pub unknown: usize,
    /// The force, a function of t; in the plane per thickness.
    pub force: Data,
}

/// A rigid obstacle: it translates, as prescribed or as forces want.
pub struct MovingObstacle<const S: usize, const N: usize> {
    /// The obstacle without its motion, as a function of time.
    pub at_rest: Changing<Box<dyn Obstacle<S, N>>>,
    /// Prescribed translation per component.
    pub motion: Vec<Option<Data>>,
    /// Components in which forces press it.
    pub pressed: Vec<ForceDriven>,
    /// Whether it changes with the time, forces apart.
    pub changes: bool,
}

impl<const S: usize, const N: usize> std::fmt::Debug for MovingObstacle<S, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ObstacleModel").field("motion", &self.motion).field("pressed", &self.pressed).finish_non_exhaustive()
    }
}

impl<const S: usize, const N: usize> MovingObstacle<S, N> {
    /// Its translation at time `t` \[length\]: prescribed components, and those of `unknowns`; zero without any.
    pub fn displacement(&self, t: f64, unknowns: Option<&[f64]>) -> Vector<N> {
        let mut by =
            Vector::<N>::from_fn(|k, _| self.motion.get(k).and_then(Option::as_ref).map_or(0.0, |f| f.value(&Point::default().at_time(t))));
        for p in &self.pressed {
            by[p.component] += unknowns.and_then(|u| u.get(p.unknown)).copied().unwrap_or(0.0);
        }
        by
    }

    /// The obstacle where it is at time `t`.
    pub fn target(&self, t: f64, unknowns: Option<&[f64]>) -> Box<dyn Obstacle<S, N>> {
        Box::new(Moved { target: (self.at_rest.0)(t), by: self.displacement(t, unknowns) })
    }
}
