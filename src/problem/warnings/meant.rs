//! Sides that were probably meant, where those that are named do not face each other.

use crate::problem::model::{BodyModel, BodySide, Model};
use crate::problem::touching::facing;
use crate::space::Trace;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Least share of a side that must face another one for a suggestion.
const SEEN: f64 = 0.25;
/// Sides are suggested if they are closer than this fraction of the distance of the named ones.
const NEARER: f64 = 0.5;

impl<const S: usize, const N: usize> Model<S, N> {
    /// Sides of the bodies of `slave` and of `masters`, by patch and name, that face each other best; `None` if they are no closer than half
    /// the distance of the named ones, which may be right but too far apart.
    pub fn meant_sides(&self, slave: &BodySide<S, N>, masters: &[Arc<BodySide<S, N>>]) -> Option<[(usize, String); 2]> {
        let patches: BTreeSet<usize> = masters.iter().map(|m| m.patch).collect();
        let own = skins(&self.patches[slave.patch]);
        let mut best: Option<(f64, [(usize, String); 2])> = None;
        for (name, trace) in &own {
            for &patch in &patches {
                for (other, opposite) in &skins(&self.patches[patch]) {
                    let Some(apart) = mean_distance(trace, opposite, self.size) else { continue };
                    if best.as_ref().is_none_or(|b| apart < b.0) {
                        best = Some((apart, [(slave.patch, name.clone()), (patch, other.clone())]));
                    }
                }
            }
        }
        let named = masters.iter().filter_map(|m| mean_distance(&slave.trace, &m.trace, self.size)).fold(f64::INFINITY, f64::min);
        best.filter(|b| b.0 < NEARER * named).map(|b| b.1)
    }
}

fn skins<const S: usize, const N: usize>(patch: &BodyModel<S, N>) -> Vec<(String, Trace<S, N>)> {
    patch.body.sides().into_iter().filter_map(|name| Some((name.clone(), patch.body.trace(&name).ok()?))).collect()
}

/// Returns the mean |gap| of the facets of a side that face another; `None` if too few do.
fn mean_distance<const S: usize, const N: usize>(side: &Trace<S, N>, other: &Trace<S, N>, reach: f64) -> Option<f64> {
    facing(side, other, reach).filter(|f| f.share > SEEN).map(|f| f.distance)
}
