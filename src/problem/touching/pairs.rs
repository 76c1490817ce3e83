//! Pairs of touching sides among bodies.

use super::finding::{Finding, TouchError};
use super::joined_sides::disjoint;
use super::lengths::{floor, sag, thickness, widest};
use super::oriented::oriented;
use super::paired_sides::PairedSides;
use super::search::Search;
use super::touching_sides::{Touching, touching_sides};
use crate::geometry::Sag;
use std::collections::BTreeSet;

/// Sides farther apart than this share of the thickness of the thinner body are not nearly together, however coarse their facets are.
const SEPARATE: f64 = 0.1;

impl<const S: usize, const N: usize> Search<'_, S, N> {
    /// Joins the touching sides of `bodies`, which share their functions; bodies of one of the sets `parted` are not joined to each other.
    ///
    /// # Errors
    /// [`TouchError::Side`], [`TouchError::Beyond`].
    pub fn glue_touching(&mut self, bodies: &[usize], parted: &[BTreeSet<usize>]) -> Result<Vec<PairedSides<S, N>>, TouchError<S, N>> {
        self.compiled.touching(self, bodies, None, &|a, b| parted.iter().any(|set| set.contains(&a) && set.contains(&b)))
    }

    /// Ties the touching sides of `bodies`, as slaves with masters, without the pairs that are joined or excluded, every facet once. Among
    /// sides that touch one another the slaves are those that are fully covered, or else the finer ones. [`Finding::NotTied`] of sides that
    /// nearly touch.
    ///
    /// `tolerance`: largest distance of the centres of facets \[length\], without any other condition. `None`: sides touch if the sag of
    /// their facets explains their distance.
    ///
    /// # Errors
    /// [`TouchError`].
    pub fn tie_touching(&mut self, bodies: &[usize], tolerance: Option<f64>) -> Result<Vec<PairedSides<S, N>>, TouchError<S, N>> {
        let found = self.compiled.touching(self, bodies, tolerance, &|_, _| false)?;
        if found.is_empty() {
            let nearest = self.nearest(bodies);
            if let Some(pair) = &nearest {
                self.tell(&pair.sides);
            }
            return Err(TouchError::Nothing { nearest });
        }
        Ok(found)
    }

    pub(crate) fn touching(
        &mut self,
        bodies: &[usize],
        tolerance: Option<f64>,
        apart: &dyn Fn(usize, usize) -> bool,
    ) -> Result<Vec<PairedSides<S, N>>, TouchError<S, N>> {
        let mut candidates = Vec::new();
        for &patch in bodies {
            for side in self.patches[patch].body.sides() {
                let side = self.side(patch, &side).map_err(|error| TouchError::Side { patch, side, error })?;
                candidates.extend(self.candidates(&side));
            }
        }
        let all: Vec<_> = candidates.iter().map(|c| c.side.clone()).collect();
        let left_out = |a: usize, b: usize| {
            let [p, q] = [a, b].map(|k| all[k].patch);
            p == q || apart(p, q) || self.joined.hold(&candidates[a], &candidates[b])
        };
        let sags: Vec<Sag<S, N>> = all.iter().map(|s| sag(self.patches, s)).collect();
        let floor = floor(&all);
        let Touching { mut shares, touched, ends_beyond, near } = touching_sides(&all, tolerance, &sags, floor, &left_out);
        for (sides, clearance) in near {
            // facets as coarse as this explain nothing
            let sides = sides.map(|k| all[k].clone());
            let thin = sides.each_ref().map(|side| thickness(self.patches, side));
            if clearance.mean() <= SEPARATE * thin[0].min(thin[1]) {
                self.tell(&sides);
                self.findings.push(Finding::NotTied { sides, clearance });
            }
        }
        disjoint(&all, &mut shares, &touched).map_err(|sides| {
            let sides = sides.map(|k| all[k].clone());
            self.tell(&sides);
            TouchError::Beyond { sides }
        })?;
        let explained = Some(widest(&sags, floor));
        let couple = |(slave, masters): (usize, Vec<usize>)| {
            let masters = masters.into_iter().map(|m| all[m].clone()).collect();
            PairedSides { slave: all[slave].clone(), masters, tolerance, is_named: false, explained }
        };
        let couples: Vec<_> = oriented(&all, &shares, &ends_beyond).into_iter().map(couple).collect();
        couples.iter().for_each(|couple| self.joined.join(couple));
        Ok(couples)
    }
}
