//! Points in which patches of one mesh meet without a common facet: they share the function of that point.

use super::meshes::point_of;
use crate::case::Case;
use faying::basis::{Order, ShapeTable};
use faying::geometry::{Bounds, MapTable, Tree};
use faying::linalg::Vector;
use faying::problem::PatchModel;
use std::collections::BTreeMap;

/// Distance within which a corner of an element is a point of the file, as a fraction of the element size.
const AT_THE_POINT: f64 = 1e-6;
/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

/// Functions (patch, function) of patches of one mesh that are one, with their point.
pub(super) fn found<const S: usize, const N: usize>(case: &Case, patches: &[PatchModel<S, N>]) -> Vec<(Vec<(usize, usize)>, Vector<N>)> {
    let mut wanted: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (m, meeting) in case.meetings.iter().enumerate() {
        meeting.patches.iter().for_each(|k| wanted.entry(*k).or_default().push(m));
    }
    let mut found: Vec<(Vec<(usize, usize)>, Vector<N>)> = vec![(Vec::new(), Vector::zeros()); case.meetings.len()];
    for (&k, meetings) in &wanted {
        let places: Vec<(usize, Vector<N>)> =
            meetings.iter().filter_map(|&m| Some((m, point_of::<N>(&case.patches[k], case.meetings[m].point)?))).collect();
        for (m, function, x) in functions_at(&patches[k], &places) {
            found[m].0.push((k, function));
            found[m].1 = x;
        }
    }
    found
}

/// Returns (key, function, position) of the functions whose node is one of `places`; one pass over the elements.
fn functions_at<const S: usize, const N: usize>(patch: &PatchModel<S, N>, places: &[(usize, Vector<N>)]) -> Vec<(usize, usize, Vector<N>)> {
    let space = &**patch.body.space();
    let tree = Tree::new(places.iter().map(|(_, x)| Bounds { lo: *x, hi: *x }).collect());
    let corners: Vec<Vector<N>> = (0..1usize << N).map(|k| Vector::from_fn(|d, _| f64::from(u8::from(k >> d & 1 == 1)))).collect();
    let (mut map, mut table, mut ids) = (MapTable::new(), ShapeTable::new(), Vec::new());
    let mut function: BTreeMap<usize, usize> = BTreeMap::new();
    for element in 0..space.num_elements() {
        let simplex = space.cell(element) == faying::basis::Cell::Simplex;
        let own = corners.iter().filter(|c| !simplex || c.sum() <= 1.0);
        let near = space.bounds(element);
        let reach = near.diagonal() * AT_THE_POINT;
        if tree.meeting(&near.inflated(reach)).is_empty() {
            continue;
        }
        for corner in own {
            let at = std::slice::from_ref(corner);
            space.map(element, at, Order::Values, &mut map);
            for place in tree.meeting(&Bounds { lo: map.x[0], hi: map.x[0] }.inflated(reach)) {
                space.active(element, &mut ids);
                space.tabulate(element, at, Order::Values, &mut table);
                let mut there = ids.iter().zip(table.values(0)).filter(|(_, v)| v.abs() > NO_VALUE).map(|(i, _)| *i);
                if let (Some(i), None) = (there.next(), there.next()) {
                    function.entry(place).or_insert(i);
                }
            }
        }
    }
    function.into_iter().map(|(place, i)| (places[place].0, i, places[place].1)).collect()
}
