//! Pieces of a side between its kinks: lines of elements, or corners in the plane, where the normal jumps.

use super::builder::Problem;
use super::model::BodySide;
use crate::assembly::planar_normal;
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use crate::space::{Trace, Union};
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
    let mut trees = Union::new(space.num_elements());
    // the last element at a corner or an edge, with the normal there
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
            trees.unite(e, other);
        }
    }
    if !has_kinks {
        return vec![(0..space.num_elements()).collect()];
    }
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    let mut number = HashMap::new();
    for e in 0..space.num_elements() {
        let k = *number.entry(trees.root(e)).or_insert_with(|| {
            pieces.push(Vec::new());
            pieces.len() - 1
        });
        pieces[k].push(e);
    }
    pieces
}
