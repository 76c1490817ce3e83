//! Ties.

use super::BodySide;
use crate::basis::Basis;
use crate::coupling::consistency::{ConsistencyEstimate, StiffnessEstimate};
use crate::coupling::{Coupling, Rows, Segments};
use crate::linalg::Triplets;
use crate::problem::data::Data;
use crate::problem::function_sums::FunctionSums;
use crate::problem::handles::TieId;
use crate::problem::last_time::LastTime;
use crate::problem::tie_fluxes::Fluxes;
use std::sync::Arc;

/// A slave side paired with one master side.
#[derive(Debug)]
pub struct Pairing<const S: usize, const N: usize> {
    /// The master side.
    pub master: Arc<BodySide<S, N>>,
    /// Common segments of both sides.
    pub segments: Segments<S>,
    /// Second set of segments, for mixed integration.
    pub second: Option<Segments<S>>,
}

/// A slave side of a tied interface.
#[derive(Debug)]
pub struct TiePart<const S: usize, const N: usize> {
    /// Place of the slave side in the statement; pieces of one side have the same.
    pub number: usize,
    /// The side that carries the multiplier.
    pub slave: Arc<BodySide<S, N>>,
    /// One multiplier space per component; empty if the coupling has no rows.
    pub multipliers: Vec<Box<dyn Basis<S>>>,
    /// (p, k) if the multiplier is the unstable pairing p/p-k under another name.
    pub unstable: Option<(usize, usize)>,
    /// Whether the multiplier is the dual one of the side.
    pub is_dual: bool,
    /// The coupling of the sides.
    pub coupling: Arc<dyn Coupling<S, N>>,
    /// The master sides.
    pub pairings: Vec<Pairing<S, N>>,
    /// C in unknowns of the model.
    pub rows: Rows,
    /// B, if it differs from C.
    pub reaction: Option<Rows>,
    /// Per master, the integrals of every row's multiplier function; empty if the rows are not mortar rows.
    pub function_sums: Vec<Vec<FunctionSums<N>>>,
    /// Stiffness that the coupling adds in unknowns of the model, at the first time.
    pub stiffness: Triplets,
    /// Penalty stiffness over the stiffness of the slave unknowns; `None` for exact rows.
    pub penalty: Option<f64>,
    /// Rows of a finer integration, for the consistency error; `None` if the rows are not mortar rows.
    pub finer: Option<ConsistencyEstimate>,
    /// Defect of the stiffness against a finer integration, of couplings without rows.
    pub finer_stiffness: Option<StiffnessEstimate>,
    /// Fluxes of the bodies.
    pub fluxes: LastTime<Fluxes<S, N>>,
    /// First row in the system.
    pub first_row: usize,
    /// Number of rows.
    pub num_rows: usize,
}

/// A tied interface.
#[derive(Debug)]
pub struct TieModel<const S: usize, const N: usize> {
    /// Its handle.
    pub id: TieId,
    /// Its name.
    pub name: String,
    /// One part per slave side.
    pub parts: Vec<TiePart<S, N>>,
    /// Exact multiplier, one function per component; `None`: from the exact solution, if there is one.
    pub exact: Option<Vec<Data>>,
}
