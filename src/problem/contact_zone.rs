//! The zone of a contact, and its extent.

use crate::contact::{ContactResultants, NoHalfWidth, SideEnd};
use crate::coupling::Segments;
use crate::geometry::Geometry;
use std::borrow::Cow;

/// A slave side of a contact with its rows, and what these transmit.
#[derive(Debug)]
pub struct ContactZone<'a, const S: usize, const N: usize> {
    /// The side.
    pub slave: &'a dyn Geometry<S, N>,
    /// Its pieces and points, with weights along the curve or the surface.
    pub segments: Cow<'a, Segments<S>>,
    /// Pressure and closed points.
    pub sent: ContactResultants<N>,
}

/// The behaviour of a zone at an end of a slave side: number of the zone, element of the side, and local coordinate there.
pub type EndOfZone<'a> = &'a dyn Fn(usize, usize, f64) -> SideEnd;

/// Half the extent of zones.
pub(super) type HalfWidth<const S: usize, const N: usize> = fn(&[ContactZone<'_, S, N>], EndOfZone<'_>) -> Option<Result<f64, NoHalfWidth>>;
