//! SidesByVertices of the patches of a NURBS mesh: which are one, and which have the numbers of boundary elements.

use super::super::budget::Budget;
use super::super::sides::SIDES;
use super::super::text::broken;
use super::super::{FileError, Label, PatchSide};
use super::cells::{self, Cell};
use std::collections::{BTreeMap, HashMap};

/// SidesByVertices by their vertices in rising order.
pub(super) type SidesByVertices = HashMap<[u32; 4], Vec<(u32, u8)>>;

/// Vertices of a side in rising order.
fn side_key(patch: &Cell, dimension: usize, side: usize) -> [u32; 4] {
    let mut key = [cells::NONE; 4];
    let (d, end) = (side / 2, side % 2);
    let all = (0..1usize << dimension).filter(|bits| (bits >> d) & 1 == end);
    for (slot, bits) in key.iter_mut().zip(all) {
        *slot = patch.corner(bits);
    }
    key.sort_unstable();
    key
}

/// The sides of all patches.
pub(super) fn sides_of(patches: &[Cell], dimension: usize, budget: &mut Budget) -> Result<SidesByVertices, FileError> {
    budget.items(patches.len() * 2 * dimension, 4 * size_of::<([u32; 4], Vec<(u32, u8)>)>() + 4 * size_of::<(u32, u8)>())?;
    budget.items(patches.len() * 2 * dimension, 2 * size_of::<PatchSide>())?;
    let mut sides = SidesByVertices::new();
    for (k, patch) in patches.iter().enumerate() {
        for side in 0..2 * dimension {
            sides.entry(side_key(patch, dimension, side)).or_default().push((k as u32, side as u8));
        }
    }
    Ok(sides)
}

fn named(&(patch, side): &(u32, u8)) -> PatchSide {
    PatchSide { patch: patch as usize, side: SIDES[side as usize].to_string() }
}

/// SidesByVertices with the same vertices, in the order of the patches.
pub(super) fn joints_of(patches: &[Cell], dimension: usize, sides: &SidesByVertices) -> Vec<[PatchSide; 2]> {
    let mut joints = Vec::new();
    for (k, patch) in patches.iter().enumerate() {
        for side in 0..2 * dimension {
            let all = &sides[&side_key(patch, dimension, side)];
            let first = all[0];
            if first != (k as u32, side as u8) {
                joints.push([named(&first), named(&(k as u32, side as u8))]);
            }
        }
    }
    joints
}

/// SidesByVertices under the numbers of the boundary elements.
pub(super) fn labels_of(boundary: &[Cell], dimension: usize, sides: &SidesByVertices) -> Result<Vec<Label>, FileError> {
    let mut labels: BTreeMap<i64, Vec<PatchSide>> = BTreeMap::new();
    for cell in boundary {
        let mut key = [cells::NONE; 4];
        let corners = cell.corners();
        let found = (cell.shape.dimension() + 1 == dimension).then(|| {
            for (slot, v) in key.iter_mut().zip(corners) {
                *slot = *v;
            }
            key.sort_unstable();
            sides.get(&key)
        });
        let all = found.flatten().ok_or_else(|| broken(cell.line, "a boundary element is no side of a patch"))?;
        labels.entry(cell.attribute).or_default().extend(all.iter().map(named));
    }
    Ok(labels.into_iter().map(|(number, sides)| Label { name: number.to_string(), sides }).collect())
}
