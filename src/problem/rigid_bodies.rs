//! Bodies that move as rigid bodies: patches, glued ones as one, and obstacles that forces press.

use super::model::{Against, ContactPart, Model};
use super::rigid::RigidModes;
use crate::contact::Contact;
use crate::geometry::Bounds;
use crate::linalg::Vector;

/// The unit vector of a component.
pub fn unit<const N: usize>(component: usize) -> Vector<N> {
    Vector::from_fn(|k, _| f64::from(u8::from(k == component)))
}

/// The bodies of a model: patches, glued ones as one, each by its first; behind them obstacles that forces press, by their contacts.
#[derive(Debug)]
pub struct RigidBodies {
    pub(super) first: Vec<usize>,
    pub(super) pressed: Vec<usize>,
}

impl RigidBodies {
    /// The bodies of a model.
    pub fn of<const S: usize, const N: usize>(model: &Model<S, N>) -> Self {
        let mut first: Vec<usize> = (0..model.patches.len()).filter(|&k| model.glued.body(k) == k).collect();
        first.sort_unstable();
        let pressed = (0..model.contacts.len()).filter(|&k| model.contacts[k].is_pressed()).collect();
        Self { first, pressed }
    }

    /// The body of a patch.
    pub fn of_patch<const S: usize, const N: usize>(&self, model: &Model<S, N>, patch: usize) -> usize {
        self.first.binary_search(&model.glued.body(patch)).expect("every patch is part of a body")
    }

    /// The obstacle of a contact, where forces press it.
    pub(super) fn of_obstacle(&self, contact: usize) -> Option<usize> {
        self.pressed.binary_search(&contact).ok().map(|k| self.first.len() + k)
    }

    /// The first patch of a body; of an obstacle the number of patches and that of its contact.
    pub fn number<const S: usize, const N: usize>(&self, model: &Model<S, N>, body: usize) -> usize {
        self.first.get(body).copied().unwrap_or_else(|| model.patches.len() + self.pressed[body - self.first.len()])
    }

    /// The modes of the bodies, each about its own middle; of obstacles about that of the model.
    pub(super) fn modes<const S: usize, const N: usize>(&self, model: &Model<S, N>) -> RigidModes<N> {
        let mut boxes: Vec<Option<Bounds<N>>> = vec![None; self.first.len()];
        for (k, patch) in model.patches.iter().enumerate() {
            let whole = &mut boxes[self.of_patch(model, k)];
            *whole = [whole.take(), patch.extent].into_iter().flatten().reduce(|a, b| a.union(&b));
        }
        let around = (model.center, model.size);
        let frame = |b: Option<Bounds<N>>| b.map_or(around, |b| (b.center(), b.diagonal())).1.max(f64::MIN_POSITIVE);
        let frames = boxes.into_iter().map(|b| (b.map_or(model.center, |b| b.center()), frame(b)));
        RigidModes { components: model.components, frames: frames.chain(self.pressed.iter().map(|_| around)).collect() }
    }
}

/// Places where a contact point acts on its bodies: (body, sign, place); the partner is the foot point, rotations act on it.
pub(super) fn contact_terms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    bodies: &RigidBodies,
    contact_number: usize,
    part: &ContactPart<S, N>,
    contact: &Contact<S, N>,
    q: usize,
) -> Vec<(usize, f64, Vector<N>)> {
    let (frames, segments) = (&contact.frames, &contact.segments);
    let x = frames.x[q];
    let mut terms = vec![(bodies.of_patch(model, part.slave.patch), 1.0, x)];
    if let Against::Side(master, _) = &part.against {
        let foot = x - frames.normal[q] * frames.gap[q];
        let piece = segments.start.partition_point(|&s| s <= q) - 1;
        terms.push((bodies.of_patch(model, master.patch_of(segments.master[piece])), -1.0, foot));
    }
    if let Some(obstacle) = bodies.of_obstacle(contact_number) {
        terms.push((obstacle, -1.0, x));
    }
    terms
}
