//! Multipliers of contact sides that are held along the normal in part.
//!
//! ```text
//! share_j = sum over held functions i of |∫ ψ_j N_i ds| over the same sum of all functions of the side
//! ```
//!
//! Beside a held part, a function of share above one half has hardly a displacement to act on: its pressure goes to the neighbour with which
//! it shares most of the displacements that are free, as where an end is lowered. Functions of share one have no free displacement of the
//! slave: their rows are those of the opponent alone.

use super::model::BodySide;
use crate::assembly::gauss_rules;
use crate::basis::{Basis, Extracted, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::measure;
use crate::quadrature::Quadrature;
use std::collections::BTreeMap;

/// Share above which a function gives its pressure away.
const MOST: f64 = 0.5;
/// Shares that differ from one by less are one.
const WHOLLY: f64 = 1e-10;

/// Functions that carry the pressure of each function where a side is held in part.
#[derive(Debug)]
pub(super) struct HeldPart {
    /// The function that gets the pressure of each one: itself unless it gives it away.
    heir: Vec<usize>,
    /// Whether each function has no free displacement.
    wholly: Vec<bool>,
}

impl HeldPart {
    /// Shares and heirs of the functions of `psi` on `slave`; `held`: whether a function of the body cannot move along the normal.
    pub fn of<const S: usize, const N: usize>(slave: &BodySide<S, N>, psi: &dyn Basis<S>, held: &dyn Fn(usize) -> bool) -> Self {
        let products = products(slave, psi);
        let is_held: Vec<bool> = slave.trace.dofs.iter().map(|&f| held(f)).collect();
        let share = |own: &BTreeMap<usize, f64>| {
            let all: f64 = own.values().map(|v| v.abs()).sum();
            let fixed: f64 = own.iter().filter(|(i, _)| is_held[**i]).map(|(_, v)| v.abs()).sum();
            if all > 0.0 { fixed / all } else { 0.0 }
        };
        let shares: Vec<f64> = products.iter().map(share).collect();
        let wholly: Vec<bool> = shares.iter().map(|&s| s >= 1.0 - WHOLLY).collect();
        // functions of psi that share a free function of the side
        let mut through: Vec<Vec<usize>> = vec![Vec::new(); is_held.len()];
        for (j, own) in products.iter().enumerate() {
            own.keys().filter(|i| !is_held[**i]).for_each(|&i| through[i].push(j));
        }
        let nearest = |j: usize| {
            let mut common: BTreeMap<usize, f64> = BTreeMap::new();
            for (&i, v) in products[j].iter().filter(|(i, _)| !is_held[**i]) {
                for &k in through[i].iter().filter(|&&k| shares[k] <= MOST) {
                    *common.entry(k).or_default() += (v * products[k][&i]).abs();
                }
            }
            common.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
        };
        let heir = (0..shares.len()).map(|j| if shares[j] > MOST && !wholly[j] { nearest(j).unwrap_or(j) } else { j }).collect();
        Self { heir, wholly }
    }

    /// Number of functions with a free displacement of the slave, once pressures are given away.
    pub fn free(&self) -> usize {
        (0..self.heir.len()).filter(|&j| self.heir[j] == j && !self.wholly[j]).count()
    }

    /// `psi` with the pressures given away.
    pub fn given<const S: usize>(&self, psi: Box<dyn Basis<S>>) -> Box<dyn Basis<S>> {
        let (mut number, mut functions) = (Vec::with_capacity(self.heir.len()), 0);
        for (j, &heir) in self.heir.iter().enumerate() {
            number.push(functions);
            functions += usize::from(heir == j);
        }
        if functions == self.heir.len() {
            return psi;
        }
        let rows = self.heir.iter().map(|&heir| vec![(number[heir], 1.0)]).collect();
        Box::new(Extracted::new::<S>(psi, functions, rows))
    }
}

/// ∫ ψ_j N_i ds, a list by i for every j.
fn products<const S: usize, const N: usize>(slave: &BodySide<S, N>, psi: &dyn Basis<S>) -> Vec<BTreeMap<usize, f64>> {
    let space = &*slave.trace.space;
    let rules = gauss_rules(space, 0);
    let (mut own, mut others, mut map) = (ShapeTable::new(), ShapeTable::new(), MapTable::new());
    let (mut ids, mut functions) = (Vec::new(), Vec::new());
    let mut all = vec![BTreeMap::new(); psi.num_functions()];
    for e in 0..space.num_elements() {
        let rule = rules.rule(e);
        space.active(e, &mut ids);
        psi.active(e, &mut functions);
        space.tabulate(e, &rule.points, Order::Values, &mut own);
        psi.tabulate(e, &rule.points, Order::Values, &mut others);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        for (q, w) in rule.weights.iter().enumerate() {
            let ds = w * measure(&map.jacobian[q]);
            for (&j, psi) in functions.iter().zip(others.values(q)) {
                for (&i, n) in ids.iter().zip(own.values(q)) {
                    *all[j].entry(i).or_insert(0.0) += psi * n * ds;
                }
            }
        }
    }
    all
}
