//! Slave sides with their masters.

use crate::basis::Order;
use crate::geometry::{ClosestPoint, MapTable};
use crate::problem::model::BodySide;
use crate::space::skin_points;
use std::sync::Arc;

/// Search radius of points of the slave, as a fraction of their facet's size.
const REACH: f64 = 0.25;

/// A slave side with its masters.
#[derive(Clone, Debug)]
pub struct PairedSides<const S: usize, const N: usize> {
    /// The side that carries the multiplier.
    pub slave: Arc<BodySide<S, N>>,
    /// The sides that it is joined to.
    pub masters: Vec<Arc<BodySide<S, N>>>,
    /// Largest admissible distance of the sides, if given \[length\].
    pub tolerance: Option<f64>,
    /// Whether slave and masters are named, so that they are meant to be tied.
    pub is_named: bool,
    /// Largest admissible distance of points, if faceting explains the distance of the sides \[length\].
    pub explained: Option<f64>,
}

/// The part of a slave that is nearest to one of its masters.
#[derive(Clone, Debug)]
pub struct Share<const S: usize, const N: usize> {
    /// The master.
    pub master: Arc<BodySide<S, N>>,
    /// Greatest distance of its points from the master \[length\].
    pub distance: f64,
    /// Its share of the slave.
    pub share: f64,
}

impl<const S: usize, const N: usize> PairedSides<S, N> {
    /// Computes the share of every master, by sampled points of the slave; masters without one are left out.
    pub fn shares(&self) -> Vec<Share<S, N>> {
        let slave = &self.slave.trace.space;
        let closest: Vec<_> = self.masters.iter().map(|m| ClosestPoint::new(Arc::clone(&m.trace.space))).collect();
        let mut shares: Vec<_> = self.masters.iter().map(|m| Share { master: m.clone(), distance: 0.0, share: 0.0 }).collect();
        let mut whole = 0.0;
        let mut table = MapTable::new();
        for (facet, bounds) in slave.all_bounds().iter().enumerate() {
            let points = skin_points(slave.cell(facet));
            let weight = bounds.diagonal().powi(S as i32) / points.len() as f64;
            slave.map(facet, &points, Order::Values, &mut table);
            for x in &table.x {
                whole += weight;
                let reach = bounds.diagonal() * REACH;
                let feet = closest.iter().enumerate().filter_map(|(k, c)| Some((k, c.project_within(x, reach)?.distance)));
                if let Some((k, distance)) = feet.min_by(|a, b| a.1.total_cmp(&b.1)) {
                    shares[k].distance = shares[k].distance.max(distance);
                    shares[k].share += weight;
                }
            }
        }
        shares.iter_mut().for_each(|s| s.share /= whole);
        shares.retain(|s| s.share > 0.0);
        shares
    }
}
