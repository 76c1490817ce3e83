//! Construction of a tied slave side: multipliers, segments and rows.

use super::coupled::{Tie, TiePair};
use super::coverage::SlaveCoverage;
use super::fixed::Eliminated;
use super::interface_error::InterfaceError;
use super::interface_side::InterfaceSide;
use super::last_time::LastTime;
use super::model::{BodySide, Model, Pairing, TiePart};
use super::multipliers::{unstable_pairing, wrapped};
use super::rigid_rows::function_sums;
use super::system::{append, empty};
use crate::basis::{Basis, Elements};
use crate::coupling::consistency::ConsistencyEstimate;
use crate::coupling::interface::{Partners, Tolerance};
use crate::coupling::multiplier::{MultiplierError, check_counts};
use crate::coupling::{CouplingError, Interface, Segments, Side};
use crate::linalg::Triplets;
use crate::space::Trace;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Points per segment of the finer rule beyond those of the rule whose consistency error it estimates.
const FINER_POINTS: usize = 2;

/// Points per direction of a piece of two sides.
pub(super) fn points_of<const S: usize, const N: usize>(slave: &BodySide<S, N>, master: &BodySide<S, N>, extra_points: usize) -> usize {
    slave.degree().max(master.degree()) + 1 + extra_points
}

/// Segments for checking the rows: finer ones, `partners` as far as the caller has checked them.
pub(super) fn finer_segments<const S: usize, const N: usize>(
    slave: &BodySide<S, N>,
    master: &BodySide<S, N>,
    points: usize,
    partners: Partners,
) -> Option<Segments<S>>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let (own, other) = (slave.trace.oriented(), master.trace.oriented());
    let segments = Trace::<S, N>::merged(points + FINER_POINTS, partners).segments(&own, &other).ok()?;
    segments.well_formed(own.num_elements(), other.num_elements()).ok().map(|()| segments)
}

/// Multipliers of the components, and the unstable pairing p/p-k (p, k) that they are under another name.
type TieMultipliers<const S: usize> = (Vec<Box<dyn Basis<S>>>, Option<(usize, usize)>);

/// The masters of a slave side with their segments, and finer segments.
type Paired<const S: usize, const N: usize> = (Vec<Pairing<S, N>>, Vec<Segments<S>>);

/// Number of sides of tied interfaces, and of curved sides that slide, on which each function of a body lies.
#[derive(Debug, Default)]
pub struct TieCounts(HashMap<usize, usize>);

impl TieCounts {
    /// Counts the functions of a side.
    pub fn add<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, side: &BodySide<S, N>) {
        let mut functions: Vec<usize> = side.trace.dofs.iter().map(|&dof| model.function(side.patch, dof)).collect();
        functions.sort_unstable();
        functions.dedup();
        for function in functions {
            *self.0.entry(function).or_default() += 1;
        }
    }

    /// Number of these sides that contain `function` of `patch`, or one that is glued to it.
    pub fn count<const S: usize, const N: usize>(&self, model: &Model<S, N>, patch: usize, function: usize) -> usize {
        self.0.get(&model.function(patch, function)).copied().unwrap_or(0)
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether conditions prescribe `side` in one of `components` itself, or, with `by_equations`, equations hold it.
    pub fn is_supported(&self, side: &BodySide<S, N>, components: &[usize], by_equations: bool) -> bool {
        let own = |s: &BodySide<S, N>| s.patch == side.patch && s.side == side.side;
        self.conditions.iter().any(|c| own(&c.side) && components.contains(&c.component))
            || (by_equations && self.supports.iter().any(|s| own(s)))
    }

    /// Builds a tied slave side at time `t`; its rows are not counted among those of the model yet.
    ///
    /// # Errors
    /// [`InterfaceError`] for sides that do not meet, and for multipliers that do not exist or are too many.
    pub(super) fn tie_part(
        &self,
        tie: &Tie<S, N>,
        pair: &TiePair<S, N>,
        t: f64,
        fixed: &Eliminated,
        members: &TieCounts,
    ) -> Result<TiePart<S, N>, InterfaceError>
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let (slave, coupling) = (&pair.slave, &tie.own.coupling);
        let (multipliers, unstable) =
            if coupling.has_rows() { self.tie_multipliers(tie, slave, fixed, members)? } else { (Vec::new(), None) };
        let (pairings, finer) = self.pairings(tie, pair)?;
        let mut part = TiePart {
            number: 0,
            slave: slave.clone(),
            multipliers,
            unstable,
            is_dual: coupling.has_rows() && tie.multiplier.is_dual(),
            coupling: Arc::clone(coupling),
            pairings,
            rows: empty(0, self.unknowns),
            reaction: None,
            function_sums: Vec::new(),
            stiffness: Triplets::new(self.unknowns, self.unknowns),
            penalty: None,
            finer: None,
            finer_stiffness: None,
            fluxes: LastTime::default(),
            first_row: self.rows,
            num_rows: 0,
        };
        let (mut reaction, mut differs) = (empty(0, self.unknowns), false);
        let fluxes = part.fluxes(self, t);
        for k in 0..part.pairings.len() {
            let blocks = part.blocks(&*part.coupling, self, k, &fluxes).map_err(InterfaceError::Coupling)?;
            differs |= blocks.reaction.is_some();
            append(&mut reaction, blocks.reaction.as_ref().unwrap_or(&blocks.constraint), 0);
            append(&mut part.rows, &blocks.constraint, 0);
            part.stiffness.append_below(&blocks.stiffness, 0);
            part.penalty = blocks.penalty.or(part.penalty);
        }
        if part.rows.slave.entries.is_empty() && part.rows.master.entries.is_empty() && !part.stiffness.entries.is_empty() {
            part.multipliers.clear();
        }
        part.reaction = differs.then_some(reaction);
        if coupling.rows_are_mortar() {
            part.function_sums = function_sums(self, &part);
            part.finer = if finer.len() == part.pairings.len() { self.finer_tie(&part, &finer) } else { None };
        } else if !coupling.has_rows() && finer.len() == part.pairings.len() {
            part.finer_stiffness = part.finer_stiffness(self, &fluxes, &finer);
        }
        part.num_rows = part.multipliers.iter().map(|m| m.num_functions()).sum();
        Ok(part)
    }

    /// The segments of a slave side against each of its masters, and finer ones.
    fn pairings(&self, tie: &Tie<S, N>, pair: &TiePair<S, N>) -> Result<Paired<S, N>, InterfaceError>
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let TiePair { slave, masters, .. } = pair;
        let mut pairings: Vec<Pairing<S, N>> = Vec::new();
        let mut finer: Vec<Segments<S>> = Vec::new();
        let mut missed: Option<CouplingError> = None;
        for master in masters {
            let tolerance = self.tolerance(slave, master, tie.own.tolerance, pair.explained);
            match self.segments(tie, slave, master, tolerance) {
                Ok((segments, second)) => {
                    pairings.push(Pairing { master: master.clone(), segments, second });
                    // the distance has been checked
                    let points = points_of(slave, master, tie.extra_points);
                    let found = finer_segments(slave, master, points, Partners::Touching(Tolerance::Given(f64::INFINITY)));
                    finer.extend(found.map(|segments| self.revolved(segments, slave)));
                }
                Err(e @ CouplingError::Rule(_)) => return Err(InterfaceError::Segments(e)),
                Err(e) => missed = Some(e),
            }
        }
        while let Some(k) = self.master_of_neighbour(slave, &pairings) {
            if finer.len() == pairings.len() {
                finer.remove(k);
            }
            pairings.remove(k);
        }
        let coverage = SlaveCoverage::of(slave, &pairings);
        // a master that is apart is none of this slave where others cover it: the sides of a corner, stated as lists
        let is_none = |e: &CouplingError| match e {
            CouplingError::NothingFaces => true,
            CouplingError::Apart { .. } => coverage.is_whole(),
            _ => false,
        };
        if let Some(error) = missed.filter(|e| pairings.is_empty() || !is_none(e)) {
            return Err(InterfaceError::Apart(error));
        }
        match self.facets_explain(slave, &pairings, &coverage) {
            [false, _] => Err(InterfaceError::Uncovered { share: coverage.covered() }),
            [_, false] => Err(InterfaceError::Doubled { share: coverage.doubled() }),
            _ => Ok((pairings, finer)),
        }
    }

    /// One multiplier per component, and the unstable pairing that it is under another name.
    fn tie_multipliers(
        &self,
        tie: &Tie<S, N>,
        slave: &BodySide<S, N>,
        fixed: &Eliminated,
        members: &TieCounts,
    ) -> Result<TieMultipliers<S>, InterfaceError>
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let field = self.patches[slave.patch].field;
        // ends are constrained per component
        let (mut multipliers, mut unstable) = (Vec::with_capacity(self.components), None);
        for c in 0..self.components {
            let by_equations = !self.equations.is_empty();
            if slave.trace.dofs.iter().all(|&function| fixed.is(field.unknown(function, c))) && self.is_supported(slave, &[c], by_equations)
            {
                return Err(InterfaceError::Held { components: vec![c], by_equations });
            }
            let constrained = |function: usize| fixed.is(field.unknown(function, c)) || members.count(self, slave.patch, function) > 1;
            let component = Some(c).filter(|_| self.components > 1);
            if tie.multiplier.is_dual() && self.is_revolved() {
                return Err(InterfaceError::Multiplier { component, error: MultiplierError::Revolution });
            }
            let psi = tie.multiplier.make(&slave.trace, &constrained).map_err(|error| InterfaceError::Multiplier { component, error })?;
            let psi = wrapped(self, slave, &constrained, psi);
            if c == 0 && tie.multiplier.is_nameless() {
                unstable = unstable_pairing(&*slave.trace.space, &*psi);
            }
            multipliers.push(psi);
        }
        // functions that are glued to each other count once
        let mut known = HashSet::new();
        let twins: HashSet<usize> = slave.trace.dofs.iter().copied().filter(|&f| !known.insert(self.function(slave.patch, f))).collect();
        let counted = |function: usize, c: usize| fixed.is(field.unknown(function, c)) || twins.contains(&function);
        let borrowed: Vec<&dyn Basis<S>> = multipliers.iter().map(|m| &**m).collect();
        check_counts(&slave.trace, self.components, &borrowed, &counted).map_err(InterfaceError::Counts)?;
        Ok((multipliers, unstable))
    }

    /// Largest distance of tied points of two sides.
    fn tolerance(&self, slave: &BodySide<S, N>, master: &BodySide<S, N>, given: Option<f64>, explained: Option<f64>) -> Tolerance {
        match given {
            Some(distance) => Tolerance::Given(distance),
            None if self.patches[slave.patch].exact_map && self.patches[master.patch].exact_map => Tolerance::Exact,
            None => explained.map_or(Tolerance::Local, Tolerance::Given),
        }
    }

    /// Segments of the constraint, and those of the reaction for mixed integration.
    fn segments(
        &self,
        tie: &Tie<S, N>,
        slave: &BodySide<S, N>,
        master: &BodySide<S, N>,
        tolerance: Tolerance,
    ) -> Result<(Segments<S>, Option<Segments<S>>), CouplingError>
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let points = points_of(slave, master, tie.extra_points);
        let (own, other) = (&*slave.trace.space, &*master.trace.space);
        let first = tie.rule.first(points, Partners::Touching(tolerance)).segments(own, other)?.verified(own, other)?;
        first.touching(own, other, tolerance)?;
        let first = self.revolved(first, slave);
        if !tie.rule.is_mixed() {
            return Ok((first, None));
        }
        // a master may be longer than its slave
        let along_master = Trace::<S, N>::slave_rule(points, Partners::Near(tolerance)).segments(other, own)?;
        along_master.well_formed(other.num_elements(), own.num_elements())?;
        Ok((first, Some(self.revolved(along_master.swapped(), slave))))
    }

    /// Rows on finer segments, one list per master, against which the consistency error is estimated.
    fn finer_tie(&self, part: &TiePart<S, N>, finer: &[Segments<S>]) -> Option<ConsistencyEstimate> {
        let borrowed: Vec<&dyn Basis<S>> = part.multipliers.iter().map(|m| &**m).collect();
        let side = |side: &'_ BodySide<S, N>| self.patches[side.patch].field;
        let interfaces: Vec<Interface<'_, S, N>> = part
            .pairings
            .iter()
            .zip(finer)
            .map(|(pairing, segments)| Interface {
                slave: Side { trace: &part.slave.trace, field: side(&part.slave), flux: None },
                master: Some(Side { trace: &pairing.master.trace, field: side(&pairing.master), flux: None }),
                multiplier: &borrowed,
                segments,
                master_segments: None,
                direction: None,
            })
            .collect();
        ConsistencyEstimate::try_new(&interfaces, self.unknowns).ok()
    }
}
