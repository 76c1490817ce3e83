//! The edges of the elements of a surface in space: which elements they join, and which are rims.

use crate::basis::Order;
use crate::geometry::{Bounds, Geometry, MapTable, Tree, cell};
use crate::linalg::Vector;

/// Points nearer than this share of the size of the surface are one.
pub(super) const SAME_PLACE: f64 = 1e-9;

/// An edge of an element, walked counter-clockwise in its local coordinates.
#[derive(Clone, Debug)]
pub(super) struct ElementEdge {
    /// Local coordinates where it begins.
    pub from: Vector<2>,
    /// From there to its end.
    pub along: Vector<2>,
    /// Its middle.
    pub x: Vector<3>,
    /// Derivative along it in the middle.
    pub tangent: Vector<3>,
    /// Whether it is collapsed to a point.
    pub is_point: bool,
    /// The element and its edge that have the same middle, if they are the only ones.
    pub across: Option<(usize, usize)>,
    /// Whether no other edge has its middle, and it is no point.
    pub is_alone: bool,
}

/// The edges of every element in the order of [`cell::faces`]; edges with coincident middles are one.
pub(super) fn edges<G: Geometry<2, 3> + ?Sized>(map: &G) -> Vec<Vec<ElementEdge>> {
    let near = SAME_PLACE * map.extent().map_or(0.0, |b| b.diagonal());
    let mut table = MapTable::new();
    let mut all: Vec<Vec<ElementEdge>> = (0..map.num_elements())
        .map(|element| {
            let kind = map.cell(element);
            let (corners, center) = (cell::corners::<2, f64>(kind), cell::center::<2, f64>(kind));
            let one = |face: cell::Face<2>| {
                let [mut from, mut to] = [corners[face.corners[0]], corners[face.corners[1]]];
                let inward = center - face.center;
                if (to - from).perp(&inward) < 0.0 {
                    std::mem::swap(&mut from, &mut to);
                }
                map.map(element, &[from, face.center, to], Order::Gradients, &mut table);
                let x = table.x[1];
                let is_point = [0, 2].into_iter().all(|k| (table.x[k] - x).norm() <= near);
                let tangent = table.jacobian[1] * (to - from);
                ElementEdge { from, along: to - from, x, tangent, is_point, across: None, is_alone: false }
            };
            cell::faces::<2, f64>(kind).into_iter().map(one).collect()
        })
        .collect();
    let numbers: Vec<(usize, usize)> = all.iter().enumerate().flat_map(|(e, list)| (0..list.len()).map(move |k| (e, k))).collect();
    let at = |n: usize| all[numbers[n].0][numbers[n].1].x;
    let tree = Tree::new((0..numbers.len()).map(|n| Bounds { lo: at(n), hi: at(n) }).collect());
    let meeting: Vec<Vec<usize>> = (0..numbers.len()).map(|n| tree.meeting(&Bounds { lo: at(n), hi: at(n) }.inflated(near))).collect();
    for (n, there) in meeting.into_iter().enumerate() {
        let edge = &mut all[numbers[n].0][numbers[n].1];
        edge.is_alone = there.len() == 1 && !edge.is_point;
        if let ([a, b], false) = (&there[..], edge.is_point) {
            edge.across = Some(numbers[if *a == n { *b } else { *a }]);
        }
    }
    all
}
