//! Bodies that move as rigid bodies: parts of patches, glued ones as one, and obstacles that forces press.

use super::model::{BodySide, ContactPart, Model, Opposing};
use super::rigid::{RemainingMotions, RigidModes};
use crate::contact::ContactRows;
use crate::geometry::Bounds;
use crate::linalg::Vector;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The unit vector of a component.
pub fn unit<const N: usize>(component: usize) -> Vector<N> {
    Vector::from_fn(|k, _| f64::from(u8::from(k == component)))
}

/// The bodies of a model: the parts of patches that share no functions, glued ones as one, by their first patches; behind them obstacles
/// that forces press, by their contacts.
#[derive(Debug)]
pub struct RigidBodies {
    /// First patch of every body.
    pub(super) first: Vec<usize>,
    pub(super) pressed: Vec<usize>,
    /// Number of the first part of every patch.
    start: Vec<usize>,
    /// The body of every part.
    body: Vec<usize>,
    /// Whether a body holds a patch in part only.
    partial: Vec<bool>,
}

impl RigidBodies {
    /// The bodies of a model.
    pub fn of<const S: usize, const N: usize>(model: &Model<S, N>) -> Self {
        let mut start = vec![0];
        start.extend(model.patches.iter().scan(0, |sum, p| {
            *sum += p.parts.count();
            Some(*sum)
        }));
        let count = start.pop().unwrap_or(0);
        let mut root: Vec<usize> = (0..count).collect();
        let broken: BTreeSet<usize> =
            (0..model.patches.len()).filter(|&k| model.patches[k].parts.count() > 1).map(|k| model.glued.body(k)).collect();
        for k in (0..model.patches.len()).filter(|&k| !broken.contains(&model.glued.body(k))) {
            root[start[k]] = start[model.glued.body(k)];
        }
        if !broken.is_empty() {
            for [a, b] in common_parts(model, &start, &broken) {
                let (a, b) = (root[a], root[b]);
                root.iter_mut().filter(|r| **r == a.max(b)).for_each(|r| *r = a.min(b));
            }
        }
        let roots: Vec<usize> = (0..count).filter(|&i| root[i] == i).collect();
        let body: Vec<usize> = root.iter().map(|r| roots.binary_search(r).expect("a root is its own")).collect();
        let patch_of = |part: usize| start.partition_point(|&s| s <= part) - 1;
        let mut partial = vec![false; roots.len()];
        for k in 0..model.patches.len() {
            let own = &body[start[k]..start[k] + model.patches[k].parts.count()];
            if own.iter().any(|b| *b != own[0]) {
                own.iter().for_each(|&b| partial[b] = true);
            }
        }
        let first = roots.into_iter().map(patch_of).collect();
        let pressed = (0..model.contacts.len()).filter(|&k| model.contacts[k].is_pressed()).collect();
        Self { first, pressed, start, body, partial }
    }

    /// The body of a patch, of its first part if it has several.
    pub fn of_patch(&self, patch: usize) -> usize {
        self.body[self.start[patch]]
    }

    /// The body of an element of a patch.
    pub fn of_element<const S: usize, const N: usize>(&self, model: &Model<S, N>, patch: usize, element: usize) -> usize {
        self.body[self.start[patch] + model.patches[patch].parts.of_element(element)]
    }

    /// The body of a function of a patch.
    pub(super) fn of_function<const S: usize, const N: usize>(&self, model: &Model<S, N>, patch: usize, function: usize) -> usize {
        self.body[self.start[patch] + model.patches[patch].parts.of_function(function)]
    }

    /// The body behind a facet of a side.
    pub fn of_facet<const S: usize, const N: usize>(&self, model: &Model<S, N>, side: &BodySide<S, N>, facet: usize) -> usize {
        self.of_element(model, side.patch_of(facet), side.trace.facets[facet].element)
    }

    /// Whether no body holds a patch in part only.
    pub(super) fn are_whole(&self) -> bool {
        !self.partial.contains(&true)
    }

    /// The unknowns of a body.
    pub(super) fn unknowns<const S: usize, const N: usize>(&self, model: &Model<S, N>, body: usize) -> Vec<Range<usize>> {
        let mut all: Vec<Range<usize>> = Vec::new();
        for (k, patch) in model.patches.iter().enumerate() {
            let parts = self.start[k]..self.start[k] + patch.parts.count();
            if self.body[parts.clone()].iter().all(|b| *b == body) {
                all.push(patch.range());
            } else if self.body[parts].contains(&body) {
                let c = patch.field.components;
                let own = (0..patch.body.space().num_functions()).filter(|&i| self.of_function(model, k, i) == body);
                for at in own.map(|i| patch.field.first + c * i) {
                    match all.last_mut().filter(|r| r.end == at) {
                        Some(range) => range.end += c,
                        None => all.push(at..at + c),
                    }
                }
            }
        }
        all
    }

    /// The obstacle of a contact, where forces press it.
    pub(super) fn of_obstacle(&self, contact: usize) -> Option<usize> {
        self.pressed.binary_search(&contact).ok().map(|k| self.first.len() + k)
    }

    /// The first patch of a body; of an obstacle the number of patches and that of its contact.
    pub fn number<const S: usize, const N: usize>(&self, model: &Model<S, N>, body: usize) -> usize {
        self.first.get(body).copied().unwrap_or_else(|| model.patches.len() + self.pressed[body - self.first.len()])
    }

    /// Names a free body by its patch or obstacle, and a part of a patch by its middle.
    pub(super) fn numbered<const S: usize, const N: usize>(
        &self,
        model: &Model<S, N>,
        modes: &RigidModes<N>,
        free: RemainingMotions,
    ) -> RemainingMotions {
        let middle = self.partial.get(free.body).is_some_and(|p| *p).then(|| {
            let center = modes.frames[free.body].0;
            std::array::from_fn(|k| if k < N { center[k] } else { 0.0 })
        });
        RemainingMotions { body: self.number(model, free.body), middle, ..free }
    }

    /// The modes of the bodies, each about its own middle; of obstacles about that of the model.
    pub(super) fn modes<const S: usize, const N: usize>(&self, model: &Model<S, N>) -> RigidModes<N> {
        let mut boxes: Vec<Option<Bounds<N>>> = vec![None; self.first.len()];
        let mut add = |body: usize, own: Option<Bounds<N>>| {
            let whole = &mut boxes[body];
            *whole = [whole.take(), own].into_iter().flatten().reduce(|a, b| a.union(&b));
        };
        for (k, patch) in model.patches.iter().enumerate() {
            if patch.parts.count() == 1 {
                add(self.of_patch(k), patch.extent);
                continue;
            }
            for (e, own) in patch.body.space().all_bounds().into_iter().enumerate() {
                add(self.of_element(model, k, e), Some(own));
            }
        }
        let around = (model.center, model.size);
        let frame = |b: Option<Bounds<N>>| b.map_or(around, |b| (b.center(), b.diagonal())).1.max(f64::MIN_POSITIVE);
        let frames = boxes.into_iter().map(|b| (b.map_or(model.center, |b| b.center()), frame(b)));
        RigidModes { components: model.components, frames: frames.chain(self.pressed.iter().map(|_| around)).collect() }
    }
}

/// Pairs of parts of glued patches that share functions in more than a point, for bodies in `broken`; N functions are a facet.
fn common_parts<const S: usize, const N: usize>(model: &Model<S, N>, start: &[usize], broken: &BTreeSet<usize>) -> Vec<[usize; 2]> {
    let functions = model.unknowns / model.components.max(1);
    let mut part_of = vec![usize::MAX; functions];
    let mut list: Vec<(usize, usize)> = Vec::new();
    for (k, patch) in model.patches.iter().enumerate().filter(|(k, _)| broken.contains(&model.glued.body(*k))) {
        let first = patch.field.first / model.components.max(1);
        for i in 0..patch.body.space().num_functions() {
            let part = start[k] + patch.parts.of_function(i);
            part_of[first + i] = part;
            list.push((model.function(k, i), part));
        }
    }
    list.sort_unstable();
    list.dedup();
    let mut shared: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let mut pairs = |parts: &[usize]| {
        for (n, &a) in parts.iter().enumerate() {
            parts[n + 1..].iter().filter(|b| **b != a).for_each(|&b| *shared.entry([a.min(b), a.max(b)]).or_default() += 1);
        }
    };
    for run in list.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        pairs(&run.iter().map(|r| r.1).collect::<Vec<_>>());
    }
    for (a, terms) in model.glued.combined() {
        let mut parts: Vec<usize> = terms.iter().map(|t| t.0).chain([*a]).map(|i| part_of[i]).filter(|p| *p != usize::MAX).collect();
        parts.sort_unstable();
        parts.dedup();
        pairs(&parts);
    }
    shared.into_iter().filter(|(_, count)| *count >= N).map(|(pair, _)| pair).collect()
}

/// Places where a contact point acts on its bodies: (body, sign, place); the partner is the foot point, rotations act on it.
pub(super) fn contact_terms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    bodies: &RigidBodies,
    contact_number: usize,
    part: &ContactPart<S, N>,
    contact: &ContactRows<S, N>,
    q: usize,
) -> Vec<(usize, f64, Vector<N>)> {
    let (frames, segments) = (&contact.frames, &contact.segments);
    let x = frames.x[q];
    let piece = segments.start.partition_point(|&s| s <= q) - 1;
    let mut terms = vec![(bodies.of_facet(model, &part.slave, segments.slave[piece]), 1.0, x)];
    if let Opposing::Side(master, _) = &part.against {
        let foot = x - frames.normal[q] * frames.gap[q];
        terms.push((bodies.of_facet(model, master, segments.master[piece]), -1.0, foot));
    }
    if let Some(obstacle) = bodies.of_obstacle(contact_number) {
        terms.push((obstacle, -1.0, x));
    }
    terms
}
