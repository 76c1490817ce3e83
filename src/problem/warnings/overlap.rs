//! Contacts that overlap by more than half the thickness of a body: wrong sides face each other.

use super::warning::{Subject, SubjectKind, Warning};
use crate::basis::Order;
use crate::geometry::{ClosestPoint, MapTable, cell};
use crate::linalg::Vector;
use crate::problem::model::{ContactModel, ContactPart, Model, Opposing};
use crate::space::{Space, Trace};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Tolerance of the point-in-body test, as a fraction of the depth.
const INSIDE: f64 = 1e-3;
/// Depths, in multiples of the overlap, at which the body is tested.
const DEPTHS: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Share of the overlapping area beyond which an overlap deeper than half the thickness is told.
const TOO_DEEP: f64 = 0.5;
/// Normals with less than this along an axis are perpendicular to it.
const PERPENDICULAR: f64 = 1e-9;

/// The patches of a body, to ask whether a point is in it.
type Parts<const N: usize> = Vec<ClosestPoint<N, N, Arc<dyn Space<N, N>>>>;

impl<const S: usize, const N: usize> Model<S, N> {
    /// [`Warning::Overlap`] of a contact, number `number` of this model, at time `t`: the first part that overlaps too deep, by the place of
    /// its sides or of its obstacle, or by the gap that its formula gives.
    pub fn overlap(&self, number: usize, contact: &ContactModel<S, N>, t: f64) -> Option<Warning> {
        contact.parts.iter().find_map(|part| {
            let (depth, x, by_formula) = self.deepest(contact, part, t)?;
            let meant = if by_formula { None } else { self.meant_sides(&part.slave, &part.masters) };
            Some(Warning::Overlap {
                of: Subject { kind: SubjectKind::Contact, number, name: contact.name.clone() },
                slave: part.slave.label.clone(),
                masters: part.masters.iter().map(|side| side.label.clone()).collect(),
                depth,
                x: x.as_slice().to_vec(),
                by_formula,
                meant,
            })
        })
    }

    /// Depth and place of the deepest overlap of a part, if it is too deep, and whether the formula of the gap makes it so.
    fn deepest(&self, contact: &ContactModel<S, N>, part: &ContactPart<S, N>, t: f64) -> Option<(f64, Vector<N>, bool)> {
        // what an obstacle does later is a motion
        let then = part.changes.then(|| contact.at(self, part, t).ok()).flatten();
        let first = then.as_ref().unwrap_or(&part.first);
        let (segments, frames) = (&first.segments, &first.frames);
        let pressed = |n: &Vector<N>| contact.obstacle.iter().flat_map(|o| &o.pressed).any(|p| n[p.component].abs() > PERPENDICULAR);
        let mut groups: Option<Vec<Parts<N>>> = None;
        let (mut overlapping, mut deep, mut worst) = (0.0, 0.0, (0.0, Vector::<N>::zeros(), false));
        for piece in 0..segments.num_pieces() {
            let e = segments.slave[piece];
            for q in segments.points(piece) {
                let (gap, normal) = (frames.gap[q], frames.normal[q]);
                let depth = -gap.min(first.at_rest[q]);
                // a force moves its obstacle out of the body
                if depth <= 0.0 || pressed(&normal) {
                    continue;
                }
                overlapping += segments.ds[q];
                let mut sides = vec![(&part.slave.trace, part.slave.patch_of(e), e, frames.x[q], normal)];
                if let Opposing::Side(master, _) = &part.against {
                    let f = segments.master[piece];
                    sides.push((&master.trace, master.patch_of(f), f, frames.x[q] - normal * gap, -normal));
                }
                // most fits are less deep than the element behind the side
                if sides.iter().all(|(trace, patch, element, ..)| 2.0 * depth <= element_depth(self, trace, *patch, *element, &normal)) {
                    continue;
                }
                let groups = groups.get_or_insert_with(|| {
                    let masters: Vec<usize> = part.masters.iter().map(|m| m.patch).collect();
                    vec![body(self, &[part.slave.patch]), body(self, &masters)]
                });
                let thin = sides.iter().zip(&*groups).any(|((.., x, inward), group)| {
                    DEPTHS.iter().any(|d| {
                        let at = x + inward * (depth * (d - INSIDE));
                        !group.iter().any(|c| c.project_within(&at, depth * INSIDE + self.size * 1e-12).is_some())
                    })
                });
                if thin {
                    deep += segments.ds[q];
                    if depth > worst.0 {
                        worst = (depth, frames.x[q], depth > -gap);
                    }
                }
            }
        }
        (deep > TOO_DEEP * overlapping).then_some(worst)
    }
}

/// Depth of the element behind a facet: twice the distance between the centres of facet and cell along `normal`.
fn element_depth<const S: usize, const N: usize>(
    model: &Model<S, N>,
    trace: &Trace<S, N>,
    patch: usize,
    element: usize,
    normal: &Vector<N>,
) -> f64 {
    let space = model.patches[patch].body.space();
    let facet = &trace.facets[element];
    let mut table = MapTable::new();
    let points = [facet.lift(&cell::center(trace.space.cell(element))), cell::center(space.cell(facet.element))];
    space.map(facet.element, &points, Order::Values, &mut table);
    2.0 * (table.x[0] - table.x[1]).dot(normal).abs()
}

/// Returns the patches that form one body with `patches`: glued to them, or tied.
fn body<const S: usize, const N: usize>(model: &Model<S, N>, patches: &[usize]) -> Parts<N> {
    let mut members: BTreeSet<usize> = patches.iter().copied().collect();
    loop {
        let before = members.len();
        let roots: BTreeSet<usize> = members.iter().map(|&k| model.glued.body(k)).collect();
        members.extend((0..model.patches.len()).filter(|&k| roots.contains(&model.glued.body(k))));
        for part in model.ties.iter().flat_map(|t| &t.parts) {
            let sides: Vec<usize> = part.pairings.iter().map(|p| p.master.patch).chain([part.slave.patch]).collect();
            if sides.iter().any(|k| members.contains(k)) {
                members.extend(sides);
            }
        }
        if members.len() == before {
            return members.into_iter().map(|k| ClosestPoint::new(Arc::clone(model.patches[k].body.space()))).collect();
        }
    }
}
