//! Points of bodies, found by one tree per body.

use super::model::BodyModel;
use crate::space::{Locator, Space};
use std::fmt::{Debug, Formatter};
use std::sync::{Arc, OnceLock};

/// One tree per body, built when a point of the body is first asked for.
pub(super) struct BodyLocators<const N: usize>(Vec<OnceLock<Locator<N, Arc<dyn Space<N, N>>>>>);

impl<const N: usize> Debug for BodyLocators<N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "BodyLocators({})", self.0.len())
    }
}

impl<const N: usize> BodyLocators<N> {
    /// Places in that many bodies.
    pub fn new(bodies: usize) -> Self {
        Self((0..bodies).map(|_| OnceLock::new()).collect())
    }

    /// The tree of a body.
    pub fn of<const S: usize>(&self, patch: &BodyModel<S, N>) -> &Locator<N, Arc<dyn Space<N, N>>> {
        let tree = &self.0[patch.id.number];
        tree.get().unwrap_or_else(|| {
            // built before the lock is taken: a thread that builds in parallel may be given another point of the same body meanwhile
            let built = Locator::new(Arc::clone(patch.body.space()));
            tree.get_or_init(|| built)
        })
    }
}
