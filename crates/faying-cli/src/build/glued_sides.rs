//! Distances and shares of the sides that `coupling = "glue"` joins.

use super::couple::{Couple, Couples};
use crate::case::Case;
use crate::registry::is_glue;
use crate::result::{GluedSides, TiedSides};
use faying::basis::Order;
use faying::geometry::{ClosestPoint, MapTable};
use faying::space::skin_points;
use std::sync::Arc;

/// Search radius of points on glued sides, as a fraction of their facet's size.
const REACH: f64 = 0.25;

/// Returns distance and share of every pair of sides glued by an interface of the case; closed patches and seams of files are left out.
pub(super) fn of<const S: usize, const N: usize>(case: &Case, couples: &Couples<S, N>) -> Vec<GluedSides> {
    let interfaces = case.interfaces.iter().zip(&couples.ties).filter(|(tie, _)| is_glue(&tie.coupling.value));
    let pairs = interfaces.flat_map(|(tie, list)| list.iter().map(|couple| (tie.name.value.clone(), couple)));
    pairs
        .flat_map(|(interface, couple)| pairs_of(couple).into_iter().map(move |sides| GluedSides { interface: interface.clone(), sides }))
        .collect()
}

/// Computes, per master of a slave, the greatest distance of the points that are nearest to this master, and their share of the slave.
fn pairs_of<const S: usize, const N: usize>(couple: &Couple<S, N>) -> Vec<TiedSides> {
    let slave = &couple.slave.trace.space;
    let closest: Vec<_> = couple.masters.iter().map(|m| ClosestPoint::new(Arc::clone(&m.trace.space))).collect();
    let label = |k: usize| TiedSides { slave: couple.slave.label.clone(), master: couple.masters[k].label.clone(), ..TiedSides::default() };
    let mut sides: Vec<TiedSides> = (0..closest.len()).map(label).collect();
    let mut whole = 0.0;
    let mut table = MapTable::new();
    for (facet, bounds) in slave.all_bounds().iter().enumerate() {
        let points = skin_points(slave.cell(facet));
        let weight = bounds.diagonal().powi(S as i32) / points.len() as f64;
        slave.map(facet, &points, Order::Values, &mut table);
        for x in &table.x {
            whole += weight;
            let feet = closest.iter().enumerate().filter_map(|(k, c)| Some((k, c.project_within(x, bounds.diagonal() * REACH)?.distance)));
            if let Some((k, distance)) = feet.min_by(|a, b| a.1.total_cmp(&b.1)) {
                sides[k].distance = sides[k].distance.max(distance);
                sides[k].share += weight;
            }
        }
    }
    sides.iter_mut().for_each(|s| s.share /= whole);
    sides.retain(|s| s.share > 0.0);
    sides
}
