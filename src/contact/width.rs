//! Half the width of a contact zone along one side, or along several sides that follow one another.

use super::Contact;
use super::curves::Curves;
use crate::basis::Elements;
use crate::coupling::interface::Chain;
use crate::geometry::Geometry;
use crate::linalg::{Real, lit};

/// A zone that ends within this share of the side's length of an end of the side ends there.
const AT_SIDE_END: f64 = 1e-9;

/// A slave side with its contact and the points of it that are closed.
#[derive(Clone, Copy, Debug)]
pub struct ClosedSide<'a, const N: usize, T: Real = f64> {
    /// The side.
    pub slave: &'a dyn Geometry<1, N, T>,
    /// Its rows and points.
    pub contact: &'a Contact<1, N, T>,
    /// Whether each point of the segments lies in the closed zone, as in [`super::Transmitted`].
    pub closed: &'a [bool],
}

/// Half the extent of the closed zone along the slave sides; all of it where it ends at an end of the sides, as in half
/// models. Zero where nothing is closed.
///
/// Sides that meet are one curve: a joint between them is no end. Of curves that do not meet the widest zone counts; on a
/// closed curve the zone is what the widest open stretch leaves. The extent is measured along the curve, between the
/// outermost closed points, each with the share of the curve that its weight stands for.
pub fn half_width<const N: usize, T: Real>(sides: &[ClosedSide<'_, N, T>]) -> T {
    let joined = Curves { elements: sides.iter().flat_map(|s| (0..s.slave.num_elements()).map(|e| (s.slave, e))).collect() };
    let chain = Chain::of(&joined);
    // from and to: arc length within the element
    let mut zone: Vec<Option<[T; 2]>> = vec![None; joined.num_elements()];
    // length of every element, by the same points as its pieces where they cover it
    let mut length = chain.lengths.clone();
    let mut base = 0;
    for side in sides {
        let segments = &side.contact.segments;
        for run in segments.runs() {
            let element = base + segments.slave[run.start];
            let mut at = T::zero();
            for piece in run {
                for q in segments.points(piece) {
                    let end = at + segments.ds[q];
                    if side.closed[q] {
                        zone[element] = Some([zone[element].map_or(at, |z| z[0]), end]);
                    }
                    at = end;
                }
            }
            length[element] = length[element].max(at);
        }
        base += side.slave.num_elements();
    }
    let walk = chain.walk();
    let mut widest = T::zero();
    let mut first = 0;
    for k in 0..walk.len() {
        let (element, reversed) = walk[k];
        let next = chain.neighbour(element, usize::from(!reversed)).map(|(e, _)| e);
        if k + 1 < walk.len() && next == Some(walk[k + 1].0) {
            continue;
        }
        let piece = &walk[first..=k];
        let is_loop = chain.neighbour(piece[0].0, usize::from(piece[0].1)).is_some();
        widest = widest.max(of_piece(piece, is_loop, &zone, &length));
        first = k + 1;
    }
    widest
}

/// Half the extent along elements that join, each with whether it is walked backwards.
fn of_piece<T: Real>(walk: &[(usize, bool)], is_loop: bool, zone: &[Option<[T; 2]>], length: &[T]) -> T {
    let (mut start, mut closed) = (T::zero(), Vec::new());
    for &(element, reversed) in walk {
        if let Some([a, b]) = zone[element] {
            let [a, b] = if reversed { [length[element] - b, length[element] - a] } else { [a, b] };
            closed.push([start + a, start + b]);
        }
        start += length[element];
    }
    let (Some(first), Some(last)) = (closed.first(), closed.last()) else { return T::zero() };
    if is_loop {
        let around = start - last[1] + first[0];
        let open = closed.windows(2).fold(around, |m, w| m.max(w[1][0] - w[0][1]));
        return (start - open) * lit(0.5);
    }
    let (margin, extent) = (start * lit(AT_SIDE_END), last[1] - first[0]);
    if first[0] <= margin || last[1] >= start - margin { extent } else { extent * lit(0.5) }
}
