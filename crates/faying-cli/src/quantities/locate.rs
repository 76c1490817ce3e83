//! Elements of a model's patches by points.

use crate::lower::LoweredCase;
use faying::geometry::{Bounds, Embedded, Embedding, closest_point};
use faying::linalg::{Matrix, Vector};
use faying::problem::Contents;
use faying::space::{Locator, Space};
use std::cell::OnceCell;
use std::sync::Arc;

/// Point in a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot<const N: usize> {
    /// The patch.
    pub patch: usize,
    /// Whether other patches contain it, too, and none was asked for.
    pub shared: bool,
    /// Whether it is the nearest point of the body to one outside of it.
    pub moved: bool,
    /// Elements that contain the point, with local coordinates: several on common edges.
    pub elements: Vec<(usize, Vector<N>)>,
}

/// Finds elements of the patches of a model by points; the search structure of a patch is built when first used.
#[derive(Debug)]
pub struct Locators<'a, const S: usize, const N: usize> {
    built: &'a LoweredCase<S, N>,
    each: Vec<OnceCell<Locator<N, Arc<dyn Space<N, N>>>>>,
}

impl<'a, const S: usize, const N: usize> Locators<'a, S, N> {
    /// For the bodies of `built`.
    pub fn new(built: &'a LoweredCase<S, N>) -> Self {
        Self { built, each: built.system.contents().bodies().map(|_| OnceCell::new()).collect() }
    }

    /// Bodies, ties and contacts.
    pub fn contents(&self) -> Contents<'a, S, N> {
        self.built.system.contents()
    }

    /// Whether there is a stored run to compare with.
    pub fn has_reference(&self) -> bool {
        self.built.reference.is_some()
    }

    /// Locator of a patch, built at the first call.
    pub fn of(&self, patch: usize) -> &Locator<N, Arc<dyn Space<N, N>>> {
        self.each[patch].get_or_init(|| Locator::new(self.contents().body(patch).space().clone()))
    }

    /// Returns all elements of a patch that contain the point `x`, which was found in `element` at `xi`.
    pub fn around(&self, patch: usize, element: usize, xi: Vector<N>, x: &Vector<N>) -> Vec<(usize, Vector<N>)> {
        let space = self.contents().body(patch).space();
        let tree = self.of(patch).closest().tree();
        let mut all = vec![(element, xi)];
        // no element is larger than the patch
        let reach = 1e-9 * tree.bounds().map_or(0.0, |b| b.diagonal());
        let mut candidates = tree.meeting(&Bounds { lo: *x, hi: *x }.inflated(2.0 * reach));
        candidates.sort_unstable();
        for e in candidates.into_iter().filter(|&e| e != element) {
            let bounds = tree.item(e);
            let near = 1e-9 * bounds.diagonal();
            if bounds.distance(x) > near {
                continue;
            }
            let whole = Embedding { element: e, origin: Vector::zeros(), axes: Matrix::<N, N>::identity() };
            let alone = Embedded::new(space.clone(), vec![whole], space.cell(e));
            if let Some(p) = closest_point(&alone, x)
                && p.distance <= near
            {
                all.push((e, p.xi));
            }
        }
        all.sort_by_key(|(e, _)| *e);
        all
    }
}
