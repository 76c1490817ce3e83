//! Pieces of a side between its kinks: lines of elements, or corners in the plane, where the normal jumps.

use super::builder::Problem;
use super::model::BodySide;
use crate::assembly::planar_normal;
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use crate::space::Trace;
use std::collections::HashMap;
use std::sync::Arc;

/// Distance of unit normals from which on they are those of a kink: 0.6 degrees.
pub(super) const KINK: f64 = 1e-2;

/// Normals are compared this share of the way from the common corner or edge to the centres of both elements, since maps may be singular there.
const INSIDE: f64 = 1e-6;

impl<const S: usize, const N: usize> Problem<S, N> {
    /// The pieces of a side between its kinks; the side itself if it has none, or cells of several shapes.
    pub(super) fn pieces_between_kinks(&self, side: &Arc<BodySide<S, N>>) -> Vec<Arc<BodySide<S, N>>> {
        let space = &*side.trace.space;
        let alike = (0..space.num_elements()).all(|e| space.cell(e) == space.cell(0));
        if !alike || planar_normal(&side.trace).is_some() {
            return vec![side.clone()];
        }
        let pieces = smooth_pieces(&side.trace);
        if pieces.len() == 1 {
            return vec![side.clone()];
        }
        let piece = |elements: &Vec<usize>| {
            let trace = self.compiled.part(&side.trace, elements, space.cell(0));
            let own = BodySide::of_trace(&self.bodies[side.patch], side.patch, &side.side, side.label.clone(), trace);
            Arc::new(BodySide { whole: Some(side.said()), ..own })
        };
        pieces.iter().map(piece).collect()
    }
}

/// The elements of every piece of a side within which the normal does not jump, ascending.
fn smooth_pieces<const S: usize, const N: usize>(trace: &Trace<S, N>) -> Vec<Vec<usize>> {
    let space = &*trace.space;
    let (mut ids, mut map) = (Vec::new(), MapTable::new());
    // an element before each one in its piece, itself for the first; the last element at a corner or an edge, with the normal there
    let mut first: Vec<usize> = (0..space.num_elements()).collect();
    let mut joints: HashMap<Vec<usize>, (usize, Vector<N>)> = HashMap::new();
    let mut has_kinks = false;
    for e in 0..space.num_elements() {
        let (kind, center) = (space.cell(e), cell::center::<S, f64>(space.cell(e)));
        space.corners(e, &mut ids);
        for face in cell::faces::<S, f64>(kind) {
            let mut corners: Vec<usize> = face.corners.iter().map(|&c| ids[c]).collect();
            corners.sort_unstable();
            space.map(e, &[face.center + (center - face.center) * INSIDE], Order::Gradients, &mut map);
            let normal = trace.normal(e, &map.jacobian[0]);
            let Some((other, there)) = joints.insert(corners, (e, normal)) else { continue };
            // where there is no normal there is no kink
            if (normal - there).norm() > KINK {
                has_kinks = true;
                continue;
            }
            let [a, b] = [root(&mut first, e), root(&mut first, other)];
            first[a.max(b)] = a.min(b);
        }
    }
    if !has_kinks {
        return vec![(0..first.len()).collect()];
    }
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    let mut number = HashMap::new();
    for e in 0..first.len() {
        let k = *number.entry(root(&mut first, e)).or_insert_with(|| {
            pieces.push(Vec::new());
            pieces.len() - 1
        });
        pieces[k].push(e);
    }
    pieces
}

/// The first element of the piece of `element`.
fn root(first: &mut [usize], mut element: usize) -> usize {
    while first[element] != element {
        first[element] = first[first[element]];
        element = first[element];
    }
    element
}
