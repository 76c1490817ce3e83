//! Bodies that lie in each other and that nothing joins.

use super::builder::Builder;
use crate::words::short;
use faying::basis::Order;
use faying::geometry::{ClosestPoint, MapTable, Tree, cell};
use faying::linalg::Vector;
use faying::problem::PatchModel;
use faying::space::Space;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Elements of a patch that are looked at, at most.
const SAMPLES: usize = 200;
/// Points nearer to a body than this share of the size of both are in it.
const INSIDE: f64 = 1e-9;

/// The search for points in a patch.
type Search<const N: usize> = ClosestPoint<N, N, Arc<dyn Space<N, N>>>;

/// Warns of pairs of patches of which one has the middle of an element in the other; `may` says which pairs are looked at.
pub(super) fn warn<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    may: &dyn Fn(usize, usize) -> bool,
) {
    let known: Vec<usize> = (0..patches.len()).filter(|&k| patches[k].extent.is_some()).collect();
    let tree = Tree::new(known.iter().filter_map(|&k| patches[k].extent).collect());
    let mut searches: BTreeMap<usize, Search<N>> = BTreeMap::new();
    for (i, &a) in known.iter().enumerate() {
        for b in tree.meeting(tree.item(i)).into_iter().map(|j| known[j]).filter(|&b| a < b && may(a, b)) {
            for k in [a, b] {
                searches.entry(k).or_insert_with(|| ClosestPoint::new(Arc::clone(patches[k].body.space())));
            }
            let found = inside(&patches[b], &searches[&a]).or_else(|| inside(&patches[a], &searches[&b]));
            let Some(x) = found else { continue };
            let place: Vec<String> = ["x", "y", "z"].iter().zip(x.iter()).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
            let text = format!(
                "patches \"{}\" and \"{}\" overlap (at {}), and nothing joins them",
                patches[a].name,
                patches[b].name,
                place.join(", ")
            );
            let help = "move them apart, join sides that touch by [[interface]], or press them together by [[contact]]";
            let warning = builder.warning("E023", text, builder.case.patches[b].head.at).with_help(help);
            builder.faults.push(warning);
        }
    }
}

/// The middle of an element of a patch that lies in another.
fn inside<const S: usize, const N: usize>(patch: &PatchModel<S, N>, other: &Search<N>) -> Option<Vector<N>> {
    let (space, mut table) = (&**patch.body.space(), MapTable::new());
    let near = other.tree().bounds()?;
    let reach = INSIDE * (other.size() + patch.extent.map_or(0.0, |b| b.diagonal()));
    let boxes = space.all_bounds();
    let met: Vec<usize> = (0..boxes.len()).filter(|&e| near.meets(&boxes[e])).collect();
    met.iter().step_by(met.len().div_ceil(SAMPLES).max(1)).find_map(|&e| {
        space.map(e, &[cell::center::<N, f64>(space.cell(e))], Order::Values, &mut table);
        let x = table.x[0];
        (near.meets(&faying::geometry::Bounds { lo: x, hi: x }) && other.project_within(&x, reach).is_some()).then_some(x)
    })
}
