//! Functions of bodies by their nodes.

use super::contents::BodyView;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::{Bounds, MapTable, Tree};
use crate::linalg::Vector;
use std::collections::BTreeMap;

/// Distance within which a corner of an element is a place, as a fraction of the element's size.
const AT_THE_PLACE: f64 = 1e-6;
/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

impl<const S: usize, const N: usize> BodyView<'_, S, N> {
    /// Functions that alone do not vanish at corners of elements which are one of `places` \[length\]: (number of the place, function),
    /// ascending; places without one are left out. One pass over the elements.
    pub fn functions_at(&self, places: &[Vector<N>]) -> Vec<(usize, usize)> {
        let space = &**self.space();
        let tree = Tree::new(places.iter().map(|x| Bounds { lo: *x, hi: *x }).collect());
        let corners: Vec<Vector<N>> = (0..1usize << N).map(|k| Vector::from_fn(|d, _| f64::from(u8::from(k >> d & 1 == 1)))).collect();
        let (mut map, mut table, mut ids) = (MapTable::new(), ShapeTable::new(), Vec::new());
        let mut function: BTreeMap<usize, usize> = BTreeMap::new();
        for element in 0..space.num_elements() {
            let simplex = space.cell(element) == Cell::Simplex;
            let own = corners.iter().filter(|c| !simplex || c.sum() <= 1.0);
            let near = space.bounds(element);
            let reach = near.diagonal() * AT_THE_PLACE;
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
        function.into_iter().collect()
    }
}
