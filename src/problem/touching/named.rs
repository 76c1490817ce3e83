//! Couples whose sides are named: whether their facets explain the distance of the sides.

use super::finding::Finding;
use super::lengths::{floor, sag, widest};
use super::paired_sides::PairedSides;
use super::search::Search;
use crate::geometry::Sag;
use crate::problem::model::BodySide;
use crate::space::{Clearance, clearance};
use std::sync::Arc;

/// Search radius of named sides, as a fraction of the facet size.
const NAMED: f64 = 0.25;

impl<const S: usize, const N: usize> Search<'_, S, N> {
    /// Ties a slave side to its masters, which are named; [`Finding::NotExplained`] if faceting does not explain their distance.
    ///
    /// `tolerance`: the largest admissible distance \[length\]; with it no explanation is asked for.
    pub fn tie(&mut self, slave: Arc<BodySide<S, N>>, masters: Vec<Arc<BodySide<S, N>>>, tolerance: Option<f64>) -> PairedSides<S, N> {
        self.compiled.tie(self, slave, masters, tolerance)
    }

    pub(crate) fn tie_named(
        &mut self,
        slave: Arc<BodySide<S, N>>,
        masters: Vec<Arc<BodySide<S, N>>>,
        tolerance: Option<f64>,
    ) -> PairedSides<S, N> {
        let mut couple = PairedSides { slave, masters, tolerance, is_named: true, explained: None };
        if tolerance.is_none() {
            match self.explained(&couple) {
                Ok(within) => couple.explained = within,
                Err(clearance) => {
                    let (slave, masters) = (couple.slave.clone(), couple.masters.clone());
                    self.tell(&[&masters[..], std::slice::from_ref(&slave)].concat());
                    self.findings.push(Finding::NotExplained { slave, masters, clearance });
                }
            }
        }
        self.joined.join(&couple);
        couple
    }

    /// Returns the largest admissible distance of points of named sides if faceting explains their distance; `None` if the maps are exact
    /// or the sides are out of reach.
    ///
    /// # Errors
    /// The distance that faceting does not explain.
    fn explained(&self, couple: &PairedSides<S, N>) -> Result<Option<f64>, Clearance> {
        let all: Vec<Arc<BodySide<S, N>>> = std::iter::once(&couple.slave).chain(&couple.masters).cloned().collect();
        if all.iter().all(|side| self.patches[side.patch].exact_map) {
            // exact sides may be 1e-8 of their size apart; more is reported as an error when they are tied
            return Ok(None);
        }
        let sags: Vec<Sag<S, N>> = all.iter().map(|s| sag(self.patches, s)).collect();
        let floor = floor(&all);
        let masters: Vec<_> = couple.masters.iter().zip(&sags[1..]).map(|(m, s)| (&m.trace, s)).collect();
        let found = clearance((&couple.slave.trace, &sags[0]), &masters, NAMED, floor);
        match found.is_empty() {
            true => Ok(None),
            false if found.touches(floor) => Ok(Some(widest(&sags, floor))),
            false => Err(found),
        }
    }
}
