//! Bodies that lie in each other.

use crate::basis::Order;
use crate::geometry::{Bounds, ClosestPoint, MapTable, Tree, cell};
use crate::linalg::Vector;
use crate::problem::model::BodyModel;
use crate::space::Space;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Elements of a body that are looked at, at most.
const SAMPLES: usize = 200;
/// Points nearer to a body than this share of the size of both are in it.
const INSIDE: f64 = 1e-9;

/// The search for points in a body.
type Points<const N: usize> = ClosestPoint<N, N, Arc<dyn Space<N, N>>>;

/// Finds pairs of bodies of which one has the middle of an element in the other, with that point; `may` says which pairs are looked at.
pub(super) fn overlapping<const S: usize, const N: usize>(
    patches: &[BodyModel<S, N>],
    may: &dyn Fn(usize, usize) -> bool,
) -> Vec<([usize; 2], Vector<N>)> {
    let known: Vec<usize> = (0..patches.len()).filter(|&k| patches[k].extent.is_some()).collect();
    let tree = Tree::new(known.iter().filter_map(|&k| patches[k].extent).collect());
    let mut searches: BTreeMap<usize, Points<N>> = BTreeMap::new();
    let mut pairs = Vec::new();
    for (i, &a) in known.iter().enumerate() {
        for b in tree.meeting(tree.item(i)).into_iter().map(|j| known[j]).filter(|&b| a < b && may(a, b)) {
            for k in [a, b] {
                searches.entry(k).or_insert_with(|| ClosestPoint::new(Arc::clone(patches[k].body.space())));
            }
            let found = inside(&patches[b], &searches[&a]).or_else(|| inside(&patches[a], &searches[&b]));
            pairs.extend(found.map(|x| ([a, b], x)));
        }
    }
    pairs
}

/// The middle of an element of a body that lies in another; `None` without one.
fn inside<const S: usize, const N: usize>(patch: &BodyModel<S, N>, other: &Points<N>) -> Option<Vector<N>> {
    let (space, mut table) = (&**patch.body.space(), MapTable::new());
    let near = other.tree().bounds()?;
    let reach = INSIDE * (other.size() + patch.extent.map_or(0.0, |b| b.diagonal()));
    let boxes = space.all_bounds();
    let met: Vec<usize> = (0..boxes.len()).filter(|&e| near.meets(&boxes[e])).collect();
    met.iter().step_by(met.len().div_ceil(SAMPLES).max(1)).find_map(|&e| {
        space.map(e, &[cell::center::<N, f64>(space.cell(e))], Order::Values, &mut table);
        let x = table.x[0];
        (near.meets(&Bounds { lo: x, hi: x }) && other.project_within(&x, reach).is_some()).then_some(x)
    })
}
