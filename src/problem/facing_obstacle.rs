//! Sides and obstacles that face each other, or do not.

use super::builder::Problem;
use super::handles::ContactId;
use super::obstacle::MovingObstacle;
use crate::basis::Order;
use crate::contact::{Obstacle, opposed};
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use crate::space::Trace;

/// Least share of the facets of a side that must face an obstacle for a suggestion.
const SEEN: f64 = 0.25;
/// Sides deeper in an obstacle than this share of their size are no suggestion.
const DEEP: f64 = 0.1;
/// Share of the facets that look the same way as the obstacle, for a side that is on the wrong side of it.
const WHOLE: f64 = 0.999;
/// Cells of a body that are looked at, whether it lies in an obstacle.
const LOOKS: usize = 100;

/// Reason for which a side faces nothing of an obstacle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TurnedAway {
    /// Another side of the body faces it: its name.
    OtherSide(String),
    /// The side and the obstacle look the same way: the body is on the wrong side of it.
    SameWay,
}

/// View of an obstacle from the centres of the facets of a side.
struct Look {
    /// Share of the facets that face it, by their number.
    share: f64,
    /// Share of those that would face it if their normals were reversed.
    reversed: f64,
    /// Mean gap of those that face it, and of those that would \[length\].
    gap: [f64; 2],
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// The reason, if one is seen, for which a slave side, by its place in the statement, faces nothing of the obstacle of a contact at the
    /// first time.
    pub fn turned_away(&self, contact: ContactId, slave: usize) -> Option<TurnedAway> {
        let (side, target) = self.slave_and_target(contact, slave)?;
        let own = look(side.trace(), &*target);
        if own.share > 0.0 {
            return None;
        }
        let body = &self.bodies[side.body()].body;
        let sides = body.sides().into_iter().filter_map(|name| Some((body.trace(&name).ok()?, name)));
        let meant = sides
            .map(|(trace, name)| (look(&trace, &*target), trace.space.extent().map_or(0.0, |b| b.diagonal()), name))
            .filter(|(look, size, _)| look.share > SEEN && look.gap[0] > -DEEP * size)
            .min_by(|a, b| a.0.gap[0].abs().total_cmp(&b.0.gap[0].abs()));
        match meant {
            Some((_, _, name)) => Some(TurnedAway::OtherSide(name)),
            None => (own.reversed >= WHOLE).then_some(TurnedAway::SameWay),
        }
    }

    /// Whether the body of a slave side, by its place in the statement, lies as a whole in the obstacle of a contact at the first time.
    pub fn is_swallowed(&self, contact: ContactId, slave: usize) -> bool {
        let Some((side, target)) = self.slave_and_target(contact, slave) else { return false };
        let (space, mut map) = (self.bodies[side.body()].body.space(), MapTable::new());
        let inside = |x: &Vector<N>| {
            let hits = around::<N>().filter_map(|n| opposed(&*target, x, &n));
            hits.min_by(|a, b| (x - a.x).norm().total_cmp(&(x - b.x).norm())).is_some_and(|hit| hit.gap < 0.0)
        };
        let cells = space.num_elements();
        (0..cells).step_by(cells.div_ceil(LOOKS).max(1)).all(|e| {
            space.map(e, &[cell::center(space.cell(e))], Order::Values, &mut map);
            inside(&map.x[0])
        })
    }

    /// A slave side of a contact, and its obstacle at the first time.
    fn slave_and_target(
        &self,
        contact: ContactId,
        slave: usize,
    ) -> Option<(std::sync::Arc<super::model::BodySide<S, N>>, Box<dyn Obstacle<S, N>>)> {
        let (side, _) = self.slave_and_masters(contact.into(), slave)?;
        let obstacle: MovingObstacle<S, N> = self.obstacle(contact.into())?;
        Some((side, obstacle.target(self.times[0], None)))
    }
}

/// Whether a side and an obstacle look the same way, the obstacle no farther outside of the side than a tenth of its size: it was turned
/// round.
pub(super) fn is_turned_round<const S: usize, const N: usize>(trace: &Trace<S, N>, target: &dyn Obstacle<S, N>) -> bool {
    let (own, size) = (look(trace, target), trace.space.extent().map_or(0.0, |b| b.diagonal()));
    own.share == 0.0 && own.reversed >= WHOLE && own.gap[1] < DEEP * size
}

fn look<const S: usize, const N: usize>(trace: &Trace<S, N>, target: &dyn Obstacle<S, N>) -> Look {
    let (mut map, facets) = (MapTable::new(), trace.facets.len());
    let (mut count, mut gap) = ([0.0; 2], [0.0; 2]);
    for element in 0..facets {
        trace.space.map(element, &[cell::center(trace.space.cell(element))], Order::Gradients, &mut map);
        let (x, normal) = (map.x[0], trace.normal(element, &map.jacobian[0]));
        let sees = |n: &Vector<N>| opposed(target, &x, n).filter(|hit| hit.gap.is_finite());
        if let Some((way, hit)) = sees(&normal).map(|hit| (0, hit)).or_else(|| sees(&-normal).map(|hit| (1, hit))) {
            count[way] += 1.0;
            gap[way] += hit.gap;
        }
    }
    let [share, reversed] = count.map(|n: f64| n / facets as f64);
    Look { share, reversed, gap: [0, 1].map(|way| if count[way] > 0.0 { gap[way] / count[way] } else { 0.0 }) }
}

/// Unit vectors all around: along the axes, and the diagonals between two or three of them.
fn around<const N: usize>() -> impl Iterator<Item = Vector<N>> {
    let steps = |k: usize| Vector::<N>::from_fn(|i, _| (k / 3usize.pow(i as u32) % 3) as f64 - 1.0);
    (0..3usize.pow(N as u32)).filter_map(move |k| steps(k).try_normalize(0.0))
}
