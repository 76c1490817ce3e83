//! The part of ties and contacts that differs between curves and surfaces.

use super::assembled::System;
use super::builder::Problem;
use super::compiled::{Compiled, Library};
use super::contact_zone::ContactZone;
use super::contact_zone::EndOfZone;
use super::coupled::{Integration, Multiplier, Rule};
use super::error::ProblemErrors;
use super::multipliers::{DualBases, constrained_ends};
use crate::basis::Basis;
use crate::contact::{ClosedSide, NoHalfWidth, half_width};
use crate::coupling::Segments;
use crate::coupling::interface::{
    InterfaceQuadrature, MasterSums, MasterSurfaceSums, MergedCurve, MergedSurface, Partners, SlaveRule, SlaveSurface,
};
use crate::coupling::multiplier::{self, MultiplierError, MultiplierKind};
use crate::space::{Dimension, Trace};

/// Rules and multipliers of slave sides, and what is compiled once per dimension.
pub trait InterfaceSide<const S: usize, const N: usize>: Dimension<S, N> {
    /// The longest functions of problems, which must not be compiled where they are called.
    fn compiled() -> &'static dyn Compiled<S, N>;
    /// The rule on segments of both sides, with that many points per direction of a piece.
    fn merged(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<S, N>>;
    /// The rule on the elements of the slave side.
    fn slave_rule(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<S, N>>;
    /// The rule of integrals over the master side, for mixed integration of contacts.
    fn master_sums(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<S, N>>;

    /// The multiplier of a kind; `constrained`: whether a function of the body is constrained in its component.
    ///
    /// # Errors
    /// [`MultiplierError`] if there is none of this kind.
    fn multiplier(&self, kind: MultiplierKind, constrained: &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<S>>, MultiplierError>;

    /// Dual multipliers over the part of a side that the segments cover, and the functions by which their pressure is read.
    ///
    /// # Errors
    /// [`MultiplierError`] if there are none.
    fn covered_dual(&self, constrained: &dyn Fn(usize) -> bool, faced: &Segments<S>) -> Result<DualBases<S>, MultiplierError>;

    /// A multiplier whose functions on slivers of what the segments cover are given to their neighbours.
    fn without_slivers(&self, psi: Box<dyn Basis<S>>, faced: &Segments<S>) -> Box<dyn Basis<S>>;

    /// Half the extent of the contact zone along slave sides that are one curve or several; `None` on surfaces.
    fn half_width(zones: &[ContactZone<'_, S, N>], side_end: EndOfZone<'_>) -> Option<Result<f64, NoHalfWidth>>;

    /// The system of a problem, without the check of rigid motions; see [`Problem::assemble`].
    ///
    /// # Errors
    /// All that is wrong.
    fn system_of(problem: &Problem<S, N>) -> Result<System<S, N>, ProblemErrors>;
}

impl<const S: usize, const N: usize> Rule<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// The rule of the constraint.
    pub(super) fn first(&self, points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<S, N>> {
        match self {
            Self::Kind(Integration::Merged) => Trace::<S, N>::merged(points, partners),
            Self::Kind(_) => Trace::<S, N>::slave_rule(points, partners),
            Self::Made(make) => make(points, partners),
        }
    }

    pub(super) fn is_mixed(&self) -> bool {
        matches!(self, Self::Kind(Integration::Mixed))
    }
}

impl<const S: usize, const N: usize> Multiplier<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    pub(super) fn make(&self, trace: &Trace<S, N>, constrained: &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<S>>, MultiplierError> {
        match self {
            Self::Kind(kind) => trace.multiplier(*kind, constrained),
            Self::Made(make) => make(trace, constrained),
        }
    }
}

impl InterfaceSide<1, 2> for Trace<1, 2> {
    #[inline(never)]
    fn compiled() -> &'static dyn Compiled<1, 2> {
        &Library
    }
    fn merged(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<1, 2>> {
        Box::new(MergedCurve { points, partners })
    }
    fn slave_rule(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<1, 2>> {
        Box::new(SlaveRule { points, partners })
    }
    fn master_sums(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<1, 2>> {
        Box::new(MasterSums { points, partners })
    }
    fn multiplier(&self, kind: MultiplierKind, constrained: &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<1>>, MultiplierError> {
        multiplier::build(&self.space, kind, &constrained_ends(self, constrained))
    }
    fn covered_dual(&self, constrained: &dyn Fn(usize) -> bool, faced: &Segments<1>) -> Result<DualBases<1>, MultiplierError> {
        let made = multiplier::build_covered(&self.space, &constrained_ends(self, constrained), faced)?;
        Ok((Box::new(made.functions), Box::new(made.reading)))
    }
    fn without_slivers(&self, psi: Box<dyn Basis<1>>, faced: &Segments<1>) -> Box<dyn Basis<1>> {
        multiplier::without_slivers(psi, &*self.space, faced)
    }
    fn half_width(zones: &[ContactZone<'_, 1, 2>], side_end: EndOfZone<'_>) -> Option<Result<f64, NoHalfWidth>> {
        let closed = zones.iter().map(|zone| {
            let sent = &zone.sent;
            ClosedSide { slave: zone.slave, segments: &zone.segments, closed: &sent.closed, pressure: &sent.pressure }
        });
        Some(half_width(&closed.collect::<Vec<_>>(), side_end))
    }
    fn system_of(problem: &Problem<1, 2>) -> Result<System<1, 2>, ProblemErrors> {
        problem.system()
    }
}

impl InterfaceSide<2, 3> for Trace<2, 3> {
    #[inline(never)]
    fn compiled() -> &'static dyn Compiled<2, 3> {
        &Library
    }
    fn merged(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<2, 3>> {
        Box::new(MergedSurface { points, partners })
    }
    fn slave_rule(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<2, 3>> {
        Box::new(SlaveSurface { points, partners })
    }
    fn master_sums(points: usize, partners: Partners) -> Box<dyn InterfaceQuadrature<2, 3>> {
        Box::new(MasterSurfaceSums { points, partners })
    }
    fn multiplier(&self, kind: MultiplierKind, constrained: &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<2>>, MultiplierError> {
        multiplier::build_on_surface(&self.space, kind, &|i| constrained(self.dofs[i]))
    }
    fn covered_dual(&self, constrained: &dyn Fn(usize) -> bool, faced: &Segments<2>) -> Result<DualBases<2>, MultiplierError> {
        let constrained: Vec<bool> = self.dofs.iter().map(|&function| constrained(function)).collect();
        multiplier::dual_on_surface(&self.space, &constrained, faced)
    }
    fn without_slivers(&self, psi: Box<dyn Basis<2>>, faced: &Segments<2>) -> Box<dyn Basis<2>> {
        multiplier::without_slivers(psi, &*self.space, faced)
    }
    fn half_width(_: &[ContactZone<'_, 2, 3>], _: EndOfZone<'_>) -> Option<Result<f64, NoHalfWidth>> {
        None
    }
    fn system_of(problem: &Problem<2, 3>) -> Result<System<2, 3>, ProblemErrors> {
        problem.system()
    }
}
