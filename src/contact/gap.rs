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
//! A function whose support faces nothing, ∫ |ψ_j| ds = 0, has a row that stays open.

use super::cone::ConeTransform;
use super::{ContactKinematics, Obstacle};
use crate::basis::Basis;
use crate::constraint::RowKind;
use crate::coupling::mortar::{multiplier_magnitudes, multiplier_weights, weighted_sums};
use crate::coupling::{Coupling, CouplingError, Interface, Mortar, Rows, Segments, Side};
use crate::linalg::{Real, Triplets, Vector, lit, to_f64};

/// ∫ |ψ_j|, against the largest one, below which a function faces nothing; the mean of a function against its own, below which it has none.
const FACES_NOTHING: f64 = 1e-10;

/// Error in setting up a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The rows could not be assembled.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A multiplier function has a negative mean or none, so that its sign does not indicate compression.
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
    /// Rows of multiplier functions without multiplier.
    #[error("the rows of this method are those of multiplier functions, and there is no multiplier")]
    NoMultiplier,
    /// Rows of a method that do not fit together.
    #[error("the rows of the method of contact are not sound: {0}")]
    Rows(String),
    /// The gap formula, or the obstacle, gave no finite number.
    #[error("{} at {at:?}", if geometric.is_finite() { "the formula of the gap gives no finite number" } else { "the obstacle has no finite gap" })]
    Gap {
        /// Coordinates of the point.
        at: [f64; 3],
        /// The geometric gap there \[length\]; where it is no number the obstacle has none.
        geometric: f64,
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

/// The opponent if it has a body, the segments of the points that face it, and their frames.
pub(super) type OpposingSegments<'a, const S: usize, const N: usize, T> =
    (Option<Side<'a, S, N, T>>, Segments<S, T>, ContactKinematics<N, T>);

impl<'a, const S: usize, const N: usize, T: Real> Opponent<'a, S, N, T> {
    /// The points of `segments` of `slave` that face it, with their frames.
    pub(super) fn faced_by(
        self,
        slave: Side<'_, S, N, T>,
        segments: &Segments<S, T>,
    ) -> Result<OpposingSegments<'a, S, N, T>, ContactError> {
        Ok(match self {
            Opponent::Master(master) => {
                let (segments, frames) = ContactKinematics::against_master(slave.trace, master.trace, segments)?;
                (Some(master), segments, frames)
            }
            Opponent::Rigid(target, reach) => {
                let (segments, frames) = ContactKinematics::against_obstacle(slave.trace, target, segments, reach)?;
                (None, segments, frames)
            }
        })
    }
}

/// g' at every point.
pub(super) fn wanted<const N: usize, T: Real>(
    frames: &ContactKinematics<N, T>,
    gap: &dyn Fn(&Vector<N, T>, T) -> T,
) -> Result<Vec<T>, ContactError> {
    let wanted: Vec<T> = frames.x.iter().zip(&frames.gap).map(|(x, &g)| gap(x, g)).collect();
    match wanted.iter().position(|g| !g.is_finite()) {
        None => Ok(wanted),
        Some(q) => Err(ContactError::Gap {
            at: std::array::from_fn(|k| if k < N { to_f64(frames.x[q][k]) } else { 0.0 }),
            geometric: to_f64(frames.gap[q]),
        }),
    }
}

/// Multiplier functions or points, to which the rows of a contact belong.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowsAt {
    /// Multiplier functions, one row each.
    Functions,
    /// Points.
    Points {
        /// Row of every point of the segments; points that face nothing have a row as well.
        row: Vec<usize>,
    },
}

/// Rows of a contact side, ready for a constraint solver.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRows<const S: usize, const N: usize, T: Real = f64> {
    /// Segments of slave and master; points that face nothing are left out.
    pub segments: Segments<S, T>,
    /// Position, normal and geometric gap per point.
    pub frames: ContactKinematics<N, T>,
    /// C, one row per multiplier function, or per point.
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
    /// Functions or points to which the rows belong.
    pub at: RowsAt,
    /// Gap over lambda of every row that holds by itself; empty: all are exact. The method of the contact may choose others.
    pub compliance: Vec<T>,
    /// Matrix in all unknowns that is added to the stiffness; `None`: nothing is.
    pub stiffness: Option<Triplets<T>>,
    /// T of the cone; rows, offset and weights are those of lambda for every T.
    pub(super) turn: ConeTransform<T>,
}

impl<const S: usize, const N: usize, T: Real> ContactRows<S, N, T> {
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
        let (master, segments, frames) = opponent.faced_by(slave, &segments)?;
        let wanted = wanted(&frames, gap)?;
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
        let magnitudes = multiplier_magnitudes(multiplier, &segments);
        let threshold = magnitudes.iter().fold(T::zero(), |m, &w| m.max(w)) * lit(FACES_NOTHING);
        let facing: Vec<bool> = magnitudes.iter().map(|&w| w > threshold).collect();
        // a function that faces the opponent and has no mean is one whose sign says nothing, not one that stays open
        if let Some(function) = (0..weights.len()).find(|&j| facing[j] && weights[j] <= magnitudes[j] * lit(FACES_NOTHING)) {
            return Err(ContactError::Weight { function, weight: to_f64(weights[function]) });
        }
        Ok(Self::exact((segments, frames, wanted), RowsAt::Functions, rows, (offset, weights, facing)))
    }

    /// Exact rows without reaction of their own, translations and turn.
    fn exact(
        (segments, frames, at_rest): (Segments<S, T>, ContactKinematics<N, T>, Vec<T>),
        at: RowsAt,
        rows: Rows<T>,
        (offset, weights, facing): (Vec<T>, Vec<T>, Vec<bool>),
    ) -> Self {
        let (translations, compliance, turn) = (Vec::new(), Vec::new(), ConeTransform::identity());
        let (reaction, stiffness) = (None, None);
        Self { segments, frames, rows, reaction, offset, weights, at_rest, translations, facing, at, compliance, stiffness, turn }
    }

    /// Rows at points: one per point that faces the opponent or not.
    ///
    /// `segments`, `frames`, `at_rest`: the points that face something, their frames and their gaps g'; `row`: the row of each of them;
    /// `rows`, `offset`, `weights`, `facing`: C, g, w and whether the point faces something, one per row. See [`ContactRows::reaction`],
    /// [`ContactRows::compliance`] and [`ContactRows::stiffness`] for what may be added.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn at_points(
        (segments, frames, at_rest): (Segments<S, T>, ContactKinematics<N, T>, Vec<T>),
        row: Vec<usize>,
        rows: Rows<T>,
        (offset, weights, facing): (Vec<T>, Vec<T>, Vec<bool>),
    ) -> Self {
        assert!(row.len() == segments.ds.len() && at_rest.len() == row.len(), "{} rows of {} points", row.len(), segments.ds.len());
        assert!(weights.len() == offset.len() && facing.len() == offset.len(), "{} weights of {} rows", weights.len(), offset.len());
        Self::exact((segments, frames, at_rest), RowsAt::Points { row }, rows, (offset, weights, facing))
    }

    /// Checks that all parts have the same number of rows: that of `functions` of a multiplier, or, without one, rows at points.
    ///
    /// # Errors
    /// [`ContactError::Rows`].
    pub(crate) fn sound(&self, functions: Option<usize>, unknowns: usize) -> Result<(), ContactError> {
        let wrong = |what: String| Err(ContactError::Rows(what));
        let (m, points) = (self.offset.len(), self.segments.ds.len());
        match (functions, self.row_of_points()) {
            (Some(n), None) if n != m => return wrong(format!("{m} rows for {n} multiplier functions")),
            (Some(_), Some(_)) => return wrong("rows at points, though the method asked for a multiplier".into()),
            (None, None) => return wrong("rows of multiplier functions, though the method asked for no multiplier".into()),
            (None, Some(row)) if row.len() != points => return wrong(format!("rows of {} points, the segments have {points}", row.len())),
            (None, Some(row)) => {
                if let Some(j) = row.iter().find(|j| **j >= m) {
                    return wrong(format!("a point belongs to row {j} of {m}"));
                }
            }
            (Some(_), None) => {}
        }
        let parts = [&self.rows].into_iter().chain(&self.reaction).flat_map(|rows| [&rows.slave, &rows.master]);
        if let Some(part) = parts.clone().find(|part| (part.rows, part.cols) != (m, unknowns)) {
            return wrong(format!("a part of {} x {} entries; there are {m} rows and {unknowns} unknowns", part.rows, part.cols));
        }
        if let Some(e) = parts.flat_map(|part| &part.entries).find(|e| e.0 >= m || e.1 >= unknowns || !e.2.is_finite()) {
            return wrong(format!("the entry {e:?} of {m} rows and {unknowns} unknowns"));
        }
        let short = |of: usize, may_be_empty: bool| of != m && !(may_be_empty && of == 0);
        if short(self.weights.len(), false) || short(self.facing.len(), false) || short(self.compliance.len(), true) {
            return wrong(format!(
                "{m} offsets, {} weights, {} flags, {} compliances",
                self.weights.len(),
                self.facing.len(),
                self.compliance.len()
            ));
        }
        let numbers = [("offset", &self.offset), ("weight", &self.weights), ("compliance", &self.compliance)];
        for (name, values) in numbers {
            if let Some(j) = values.iter().position(|v| !v.is_finite()) {
                return wrong(format!("the {name} {:?} of row {j}", values[j]));
            }
        }
        Ok(())
    }

    /// Row of every point of the segments, where rows belong to points.
    pub fn row_of_points(&self) -> Option<&[usize]> {
        match &self.at {
            RowsAt::Points { row } => Some(row),
            RowsAt::Functions => None,
        }
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
        let (second, frames) = ContactKinematics::against_master(slave.trace, master.trace, second)?;
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
        let (gap, weights) = (self.turn.transposed(gap), self.transformed_weights());
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
