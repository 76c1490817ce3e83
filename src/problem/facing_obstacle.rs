//! Sides and obstacles that face each other, or do not.

use super::builder::Problem;
use super::handles::ContactId;
use super::obstacle::ObstacleModel;
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
    /// Mean gap of those that face it \[length\].
    gap: f64,
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
            .filter(|(look, size, _)| look.share > SEEN && look.gap > -DEEP * size)
            .min_by(|a, b| a.0.gap.abs().total_cmp(&b.0.gap.abs()));
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
            let hits = around::<N>().into_iter().filter_map(|n| opposed(&*target, x, &n));
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
    ) -> Option<(std::sync::Arc<super::model::SideModel<S, N>>, Box<dyn Obstacle<S, N>>)> {
        let (side, _) = self.slave_and_masters(contact.into(), slave)?;
        let obstacle: ObstacleModel<S, N> = self.obstacle(contact.into())?;
        Some((side, obstacle.target(self.times[0], None)))
    }
}

fn look<const S: usize, const N: usize>(trace: &Trace<S, N>, target: &dyn Obstacle<S, N>) -> Look {
    let (mut map, facets) = (MapTable::new(), trace.facets.len());
    let (mut faced, mut reversed, mut gap) = (0.0, 0.0, 0.0);
    for element in 0..facets {
        trace.space.map(element, &[cell::center(trace.space.cell(element))], Order::Gradients, &mut map);
        let (x, normal) = (map.x[0], trace.normal(element, &map.jacobian[0]));
        let sees = |n: &Vector<N>| opposed(target, &x, n).filter(|hit| hit.gap.is_finite());
        match sees(&normal) {
            Some(hit) => {
                faced += 1.0;
                gap += hit.gap;
            }
            None => reversed += f64::from(u8::from(sees(&-normal).is_some())),
        }
    }
    Look { share: faced / facets as f64, reversed: reversed / facets as f64, gap: if faced > 0.0 { gap / faced } else { 0.0 } }
}

/// Unit vectors all around in the plane of the first two axes.
fn around<const N: usize>() -> [Vector<N>; 8] {
    std::array::from_fn(|k| {
        let (s, c) = (std::f64::consts::FRAC_PI_4 * k as f64).sin_cos();
        Vector::from_fn(|i, _| [c, s].get(i).copied().unwrap_or(0.0))
    })
}
