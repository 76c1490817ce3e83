//! Fluxes of the bodies at the sides of a tie, for couplings that add stiffness.

use super::bounded_flux::BoundedFlux;
use super::model::{BodySide, Model, Pairing, TiePart};
use crate::basis::Basis;
use crate::coupling::consistency::StiffnessEstimate;
use crate::coupling::{Coupling, CouplingBlocks, CouplingError, Interface, Segments, Side};
use crate::linalg::{Csr, Triplets};
use std::sync::Arc;

/// The fluxes through both sides of a tied part at a time.
#[derive(Debug)]
pub struct Fluxes<const S: usize, const N: usize> {
    slave: BoundedFlux<S, N>,
    masters: Vec<BoundedFlux<S, N>>,
}

impl<const S: usize, const N: usize> TiePart<S, N> {
    /// The fluxes of the bodies at time `t`, with their bounds if the coupling needs them.
    pub fn fluxes(&self, model: &Model<S, N>, t: f64) -> Arc<Fluxes<S, N>> {
        let t = if self.materials_change(model) { t } else { 0.0 };
        self.fluxes.at(t, || {
            let of = |side: &BodySide<S, N>| model.flux(side, t);
            if !self.coupling.needs_fluxes() {
                let masters = self.pairings.iter().map(|p| BoundedFlux::unbounded(of(&p.master)));
                return Fluxes { slave: BoundedFlux::unbounded(of(&self.slave)), masters: masters.collect() };
            }
            let elements: Vec<usize> = self.pairings.iter().flat_map(|p| p.segments.slave.iter().copied()).collect();
            let field = |side: &BodySide<S, N>| model.patches[side.patch].field;
            let master = |p: &Pairing<S, N>| BoundedFlux::of_master(of(&p.master), &p.master, field(&p.master), &p.segments);
            Fluxes {
                slave: BoundedFlux::of_slave(of(&self.slave), &self.slave, field(&self.slave), &elements),
                masters: self.pairings.iter().map(master).collect(),
            }
        })
    }

    /// Whether a material of the bodies changes with the time.
    fn materials_change(&self, model: &Model<S, N>) -> bool {
        let sides = self.pairings.iter().map(|p| &p.master).chain([&self.slave]);
        sides.map(|s| s.patch).any(|k| model.patches[k].changing.is_some())
    }

    /// Returns the interface with master `k` for couplings, on its own segments or on others.
    fn interface<'a>(
        &'a self,
        model: &Model<S, N>,
        k: usize,
        fluxes: &'a Fluxes<S, N>,
        multiplier: &'a [&'a dyn Basis<S>],
        segments: Option<&'a Segments<S>>,
    ) -> Interface<'a, S, N> {
        let pairing = &self.pairings[k];
        let side = |side: &'a BodySide<S, N>, flux: &'a BoundedFlux<S, N>| Side {
            trace: &side.trace,
            field: model.patches[side.patch].field,
            flux: Some(flux),
        };
        Interface {
            slave: side(&self.slave, &fluxes.slave),
            master: Some(side(&pairing.master, &fluxes.masters[k])),
            multiplier,
            segments: segments.unwrap_or(&pairing.segments),
            master_segments: pairing.second.as_ref().filter(|_| segments.is_none()),
            direction: None,
        }
    }

    /// Rows or stiffness of the coupling for the slave and master `k`.
    ///
    /// # Errors
    /// [`CouplingError`] of the coupling.
    pub fn blocks(
        &self,
        coupling: &dyn Coupling<S, N>,
        model: &Model<S, N>,
        k: usize,
        fluxes: &Fluxes<S, N>,
    ) -> Result<CouplingBlocks, CouplingError> {
        let multiplier: Vec<&dyn Basis<S>> = self.multipliers.iter().map(|m| &**m).collect();
        coupling.assemble(&self.interface(model, k, fluxes, &multiplier, None), model.unknowns)
    }

    /// Estimate of the consistency error of a coupling without rows, on `finer` segments, one list per master; `None` where it has none there.
    pub(super) fn finer_stiffness(&self, model: &Model<S, N>, fluxes: &Fluxes<S, N>, finer: &[Segments<S>]) -> Option<StiffnessEstimate> {
        let interfaces: Vec<_> = finer.iter().enumerate().map(|(k, list)| self.interface(model, k, fluxes, &[], Some(list))).collect();
        StiffnessEstimate::try_new(&*self.coupling, &self.stiffness, &interfaces).ok()
    }

    /// lambda at points of `segments` (those of the tie where none are given) against master `k`, where there is no multiplier:
    /// `[component][point]`. Not a number where the coupling cannot say.
    pub(super) fn numerical_flux(
        &self,
        model: &Model<S, N>,
        k: usize,
        fluxes: &Fluxes<S, N>,
        segments: Option<&Segments<S>>,
        u: &[f64],
    ) -> Vec<Vec<f64>> {
        let interface = self.interface(model, k, fluxes, &[], segments);
        let points = interface.segments.ds.len();
        self.coupling.lambda(&interface, u).unwrap_or_else(|_| vec![vec![f64::NAN; points]; model.components])
    }

    /// Whether the stiffness depends on materials that change with the time.
    pub fn changes(&self, model: &Model<S, N>) -> bool {
        !self.stiffness.entries.is_empty() && self.materials_change(model)
    }

    /// Assembles the stiffness between the bodies at time `t`.
    ///
    /// # Errors
    /// [`CouplingError`] where the coupling has none at that time.
    pub fn stiffness_at(&self, model: &Model<S, N>, t: f64) -> Result<Triplets, CouplingError> {
        let mut sum = Triplets::new(model.unknowns, model.unknowns);
        let fluxes = self.fluxes(model, t);
        for k in 0..self.pairings.len() {
            sum.append_below(&self.blocks(&*self.coupling, model, k, &fluxes)?.stiffness, 0);
        }
        Ok(sum)
    }
}

/// The sum of the stiffness of all ties as one matrix in all unknowns; none where no tie adds any. Entries are in the order of the
/// ties, so the pattern is the same at every time.
pub(super) fn between<'a, const S: usize, const N: usize>(model: &Model<S, N>, parts: impl Iterator<Item = &'a Triplets>) -> Option<Csr> {
    let mut all = Triplets::new(model.unknowns, model.unknowns);
    for part in parts {
        all.append_below(part, 0);
    }
    (!all.entries.is_empty()).then(|| all.to_csr())
}
