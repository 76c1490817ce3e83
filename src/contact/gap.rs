//! Contact of a slave side with a master side or an obstacle as rows and a weighted gap.
//!
//! ```text
//! rows     C_j = ∫ ψ_j (u_slave - u_master) . n ds
//! offset   g_j = ∫ g' ψ_j ds,   g' = the gap formula of the geometric gap g
//! weights  w_j = ∫ ψ_j ds
//! gap_j = (C u + g)_j / w_j     lumped [length], positive is open
//! ```
//!
//! Mixed integration (seed: B*, B) keeps these slave-side sums for the constraint and takes the master part of the reaction from
//! master-side sums.
//!
//! Sign: K u + Cᵀ lambda = f with C u + g >= 0, lambda <= 0; lambda is the normal stress sigma_N \[force/area\].
//! A function whose support faces nothing has weight zero; its row stays open.

use super::cone::Turn;
use super::{AtPoints, Frames, Obstacle};
use crate::basis::Basis;
use crate::constraint::RowKind;
use crate::coupling::mortar::{multiplier_weights, weighted_sums};
use crate::coupling::{Coupling, CouplingError, Interface, Mortar, Rows, Segments, Side};
use crate::linalg::{Real, Vector, lit, to_f64};

/// Relative weight, against the largest one, below which a function faces nothing.
const FACES_NOTHING: f64 = 1e-10;

/// Error in setting up a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The rows could not be assembled.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A multiplier function has a negative mean, so that its sign does not indicate compression.
    #[error("multiplier function {function} has the weight {weight:.3e}; contact needs multipliers with positive means")]
    Weight {
        /// The function.
        function: usize,
        /// Its integral over the contact side.
        weight: f64,
    },
    /// No multiplier has a point that faces the opponent.
    #[error("no part of the slave side faces the master within reach")]
    NoTarget,
    /// The multiplier has no Greville points for cone E.
    #[error("the multiplier has no Greville points, at which cone = \"values\" asks for the sign of the pressure")]
    NoGreville,
    /// A function has a non-positive weight in its cone: open bodies would attract each other.
    #[error("multiplier function {function} has the weight {weight:.3e} in this cone; contact needs positive ones")]
    ConeWeight {
        /// The function.
        function: usize,
        /// Integral of the function of the cone, \[length^S\] for E, a pure number for W.
        weight: f64,
    },
    /// Too many functions for a cone that couples all of them.
    #[error("{functions} multipliers of one side are too many for this cone, which couples all of them; at most {most}")]
    ConeSize {
        /// Functions of the side.
        functions: usize,
        /// The limit.
        most: usize,
    },
    /// The gap formula, or the obstacle, gave no finite number.
    #[error("the gap, by its formula or its obstacle, is no number at {at:?}")]
    Gap {
        /// Coordinates of the point.
        at: [f64; 3],
    },
}

/// Opponent of a contact side: a deformable master or a rigid obstacle.
#[derive(Clone, Copy, Debug)]
pub enum Opponent<'a, const S: usize, const N: usize, T: Real = f64> {
    /// A deformable body; the segments pair both sides.
    Master(Side<'a, S, N, T>),
    /// A rigid obstacle; the segments are points of the slave alone. Points farther than the reach face nothing.
    Rigid(&'a dyn Obstacle<S, N, T>, Option<T>),
}

/// A contact side ready for a constraint solver.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact<const S: usize, const N: usize, T: Real = f64> {
    /// Segments of slave and master; points that face nothing are left out.
    pub segments: Segments<S, T>,
    /// Position, normal and geometric gap per point.
    pub frames: Frames<N, T>,
    /// C, one row per multiplier function.
    pub rows: Rows<T>,
    /// B if it differs from C: mixed integration, Nitsche's method.
    pub reaction: Option<Rows<T>>,
    /// ∫ g' ψ_j ds.
    pub offset: Vec<T>,
    /// ∫ ψ_j ds.
    pub weights: Vec<T>,
    /// g' at every point of the segments.
    pub at_rest: Vec<T>,
    /// Translations of a force-driven obstacle: direction, unknown, and its value at which the gaps were computed.
    pub translations: Vec<(Vector<N, T>, usize, T)>,
    /// Whether the support of ψ_j faces the opponent and ψ_j belongs to the cone.
    pub facing: Vec<bool>,
    /// Data of rows that belong to points instead of multiplier functions (Nitsche's method).
    pub points: Option<AtPoints<T>>,
    /// T of the cone; rows, offset and weights are those of lambda for every T.
    pub(super) turn: Turn<T>,
}

impl<const S: usize, const N: usize, T: Real> Contact<S, N, T> {
    /// Assembles rows, offsets and weights of `slave` against `opponent` in a system of `unknowns` unknowns.
    ///
    /// `segments`: of both sides ([`crate::coupling::interface::MergedCurve`]) or of the slave alone
    /// ([`crate::coupling::interface::slave_segments`]); `gap(x, g)`: the gap formula at the slave point x with the
    /// geometric gap g.
    ///
    /// # Errors
    /// [`ContactError`] if rows cannot be assembled, or a multiplier has no sign.
    pub fn new(
        slave: Side<'_, S, N, T>,
        opponent: Opponent<'_, S, N, T>,
        multiplier: &dyn Basis<S, T>,
        segments: Segments<S, T>,
        gap: &dyn Fn(&Vector<N, T>, T) -> T,
        unknowns: usize,
    ) -> Result<Self, ContactError> {
        let (master, segments, frames) = match opponent {
            Opponent::Master(master) => {
                let (segments, frames) = Frames::against_master(slave.trace, master.trace, &segments)?;
                (Some(master), segments, frames)
            }
            Opponent::Rigid(target, reach) => {
                let (segments, frames) = Frames::against_obstacle(slave.trace, target, &segments, reach)?;
                (None, segments, frames)
            }
        };
        let wanted: Vec<T> = frames.x.iter().zip(&frames.gap).map(|(x, &g)| gap(x, g)).collect();
        if let Some(q) = wanted.iter().position(|g| !g.is_finite()) {
            return Err(ContactError::Gap { at: std::array::from_fn(|k| if k < N { to_f64(frames.x[q][k]) } else { 0.0 }) });
        }
        let interface = Interface {
            slave,
            master,
            multiplier: &[multiplier],
            segments: &segments,
            master_segments: None,
            direction: Some(&frames.normal),
        };
        let rows = Mortar.assemble(&interface, unknowns)?.constraint;
        let offset = weighted_sums(multiplier, &segments, |q| wanted[q]);
        let weights = multiplier_weights(multiplier, &segments);
        let largest = weights.iter().fold(T::zero(), |m, w| m.max(w.abs()));
        let threshold = largest * lit(FACES_NOTHING);
        if let Some(function) = weights.iter().position(|&w| w < -threshold) {
            return Err(ContactError::Weight { function, weight: to_f64(weights[function]) });
        }
        let facing = weights.iter().map(|&w| w > threshold).collect();
        let (at_rest, translations) = (wanted, Vec::new());
        let turn = Turn::identity();
        Ok(Self { segments, frames, rows, reaction: None, offset, weights, at_rest, translations, facing, points: None, turn })
    }

    /// Integrates the master part of the reaction by other points: B = [D, -M'] with C = [D, -M] (mixed integration).
    ///
    /// `second`: the master's own points ([`crate::coupling::interface::MasterSums`]); rows are along the master's normal there. `slave`,
    /// `master` and `multiplier` are those of the rows.
    ///
    /// # Errors
    /// [`ContactError::Coupling`] if the master has no tangent.
    pub fn with_master_sums(
        mut self,
        slave: Side<'_, S, N, T>,
        master: Side<'_, S, N, T>,
        multiplier: &dyn Basis<S, T>,
        second: &Segments<S, T>,
        unknowns: usize,
    ) -> Result<Self, ContactError> {
        let (second, frames) = Frames::against_master(slave.trace, master.trace, second)?;
        let interface = Interface {
            slave,
            master: Some(master),
            multiplier: &[multiplier],
            segments: &second,
            master_segments: None,
            direction: Some(&frames.normal),
        };
        let sums = Mortar.assemble(&interface, unknowns)?.constraint;
        self.reaction = Some(Rows { slave: self.rows.slave.clone(), master: sums.master });
        Ok(self)
    }

    /// Kind of every row: contact, or open if it faces nothing.
    pub fn kinds(&self) -> Vec<RowKind> {
        self.facing.iter().map(|&f| if f { RowKind::Contact } else { RowKind::Open }).collect()
    }

    /// Gap of the cone (Tᵀ(C u + g))_j / (Tᵀ w)_j, one per multiplier function \[length\]; `None` if the function faces nothing.
    ///
    /// For the cone of coefficients this is the lumped gap (C u + g)_j / w_j. For rows at points it is P / γ, which decides their status
    /// and is no distance.
    pub fn lumped_gap(&self, unknowns: &[T]) -> Vec<Option<T>> {
        let mut gap = self.offset.clone();
        for part in [&self.rows.slave, &self.rows.master] {
            for &(row, col, value) in &part.entries {
                gap[row] += value * unknowns[col];
            }
        }
        let (gap, weights) = (self.turn.transposed(gap), self.turned_weights());
        (0..gap.len()).map(|j| self.facing[j].then(|| gap[j] / weights[j])).collect()
    }

    /// g' + \[u\] . n at every point of the segments \[length\], from `jump[component][point]` of u_slave - u_master
    /// ([`crate::coupling::evaluate::jumps`]) and the `unknowns` with translations of the obstacle.
    pub fn point_gaps(&self, jump: &[Vec<T>], unknowns: &[T]) -> Vec<T> {
        let gap = |(q, n): (usize, &Vector<N, T>)| {
            let opened = (0..N).fold(self.at_rest[q], |g, c| g + jump[c][q] * n[c]);
            self.translations.iter().fold(opened, |g, (e, unknown, at)| g - n.dot(e) * (unknowns[*unknown] - *at))
        };
        self.frames.normal.iter().enumerate().map(gap).collect()
    }
}
