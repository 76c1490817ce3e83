//! A rigid obstacle with the shape of a trace.

use super::{Hit, Location, Target};
use crate::basis::Order;
use crate::coupling::interface::MasterCurve;
use crate::geometry::{Geometry, MapTable, unit_normal};
use crate::linalg::{Real, Vector};
use crate::space::{Space, Trace};
use std::sync::Arc;

/// The closest point of a curved side, with the outward normal of the element that owns it.
///
/// Points beyond an end of the side face nothing. At a kink the fan of points whose closest point is the vertex is
/// halved between the two elements, each with its own normal.
#[derive(Debug)]
pub struct Surface<T: Real = f64> {
    master: MasterCurve<Arc<dyn Space<1, 2, T>>, 2, T>,
    outward: Vec<T>,
    reach: Option<T>,
}

impl<T: Real> Surface<T> {
    /// The surface of `trace`; points farther than `reach` face nothing.
    pub fn new(trace: &Trace<1, 2, T>, reach: Option<T>) -> Self {
        Self { master: MasterCurve::new(Arc::clone(&trace.space), T::zero()), outward: trace.outward.clone(), reach }
    }
}

impl<T: Real> Target<1, 2, T> for Surface<T> {
    fn project(&self, x: &Vector<2, T>) -> Option<Hit<1, 2, T>> {
        let place = self.master.place(x).filter(|p| !p.beyond && self.reach.is_none_or(|r| p.distance <= r))?;
        let (mut eta, mut table) = ([Vector::<1, T>::new(place.xi)], MapTable::new());
        self.master.feet(place.element, &[*x], &mut eta, &mut table);
        self.master.geometry().map(place.element, &eta, Order::Gradients, &mut table);
        let normal = unit_normal(&table.jacobian[0], self.outward[place.element]);
        let foot = table.x[0];
        Some(Hit { x: foot, normal, gap: (x - foot).dot(&normal), at: Some(Location { element: place.element, xi: eta[0] }) })
    }
}
