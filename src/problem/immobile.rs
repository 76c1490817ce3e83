//! Functions of contact sides that cannot move along the normals.

use super::contact_part::SlaveOf;
use super::directions::{directions, slides};
use super::model::{BodySide, Model, Opposing};
use crate::linalg::Vector;
use std::collections::{HashMap, HashSet};

/// Components of a unit vector below this count as zero.
const PERPENDICULAR: f64 = 1e-9;

/// The functions of a body that cannot move along the normals at a side of it.
pub(super) struct Immobile<'a, const N: usize> {
    /// Whether an unknown (function of the body, component) is prescribed.
    taken: &'a dyn Fn(usize, usize) -> bool,
    /// Directions along which functions are held by conditions between components.
    slides: Vec<(usize, Vector<N>)>,
    /// Per time, the normal of every function where it is largest at corners of elements.
    corners: Vec<HashMap<usize, Vector<N>>>,
    /// Per time, the normal of every function where it is largest at points inside of elements, for functions that vanish at corners.
    inner: Vec<HashMap<usize, Vector<N>>>,
    is_surface: bool,
}

impl<const N: usize> Immobile<'_, N> {
    /// Whether function `f` is held where it is largest; of surfaces functions that vanish at all corners count, and lie on a held edge.
    pub fn is(&self, f: usize) -> bool {
        self.held(&self.corners, f) || self.is_surface && !self.corners.iter().any(|list| list.contains_key(&f)) && self.inside(f)
    }

    /// Whether function `f` is held where it is largest inside of elements.
    pub fn inside(&self, f: usize) -> bool {
        self.held(&self.inner, f)
    }

    /// Components in which some normal has a part.
    pub fn components(&self) -> Vec<usize> {
        (0..N).filter(|&c| self.inner.iter().flat_map(|list| list.values()).any(|n| n[c].abs() >= PERPENDICULAR)).collect()
    }

    /// Whether conditions between components hold some function.
    pub fn by_equations(&self) -> bool {
        !self.slides.is_empty()
    }

    /// The normals of a moving obstacle change: a function that cannot move at one of the times is held.
    fn held(&self, list: &[HashMap<usize, Vector<N>>], f: usize) -> bool {
        let along = |n: &Vector<N>| {
            (0..N).all(|c| n[c].abs() < PERPENDICULAR || (self.taken)(f, c))
                || self.slides.iter().any(|(g, d)| *g == f && (n - d * n.dot(d)).norm() < PERPENDICULAR)
        };
        list.iter().filter_map(|n| n.get(&f)).any(along)
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The functions of a slave side that cannot move along the normals of its opponent at `times`.
    pub(super) fn immobile<'a>(&self, setup: &SlaveOf<'a, S, N>, against: &Opposing<S, N>, times: &[f64]) -> Immobile<'a, N> {
        self.immobile_at(setup.slave, Some(against), times, setup.taken)
    }

    fn immobile_at<'a>(
        &self,
        side: &BodySide<S, N>,
        against: Option<&Opposing<S, N>>,
        times: &[f64],
        taken: &'a dyn Fn(usize, usize) -> bool,
    ) -> Immobile<'a, N> {
        let normals = |n: usize| times.iter().map(|&t| directions(side, against, t, n)).collect();
        let (corners, inner) = (normals(2), normals(side.degree() + 2));
        Immobile { taken, slides: slides(self, side), corners, inner, is_surface: S > 1 }
    }

    /// Functions of the model on a slave side, and on what it faces, that supports hold along the normals at time `t`; none where the slave has
    /// none.
    pub(super) fn held_functions(&self, setup: &SlaveOf<'_, S, N>, against: &Opposing<S, N>, t: f64) -> HashSet<usize> {
        let of = |side: &BodySide<S, N>, against: Option<&Opposing<S, N>>| -> Vec<usize> {
            let field = self.patches[side.patch].field;
            let taken = |f: usize, c: usize| (setup.fixed)(field.unknown(f, c));
            let slides = slides(self, side);
            if slides.is_empty() && !side.trace.dofs.iter().any(|&f| (0..N).any(|c| taken(f, c))) {
                return Vec::new();
            }
            let immobile = self.immobile_at(side, against, &[t], &taken);
            side.trace.dofs.iter().filter(|&&f| immobile.is(f)).map(|&f| self.function(side.patch, f)).collect()
        };
        let mut held: HashSet<usize> = of(setup.slave, Some(against)).into_iter().collect();
        if !held.is_empty() {
            held.extend(setup.masters.iter().flat_map(|master| of(master, None)));
        }
        held
    }
}
