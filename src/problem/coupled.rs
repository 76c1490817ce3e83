//! Ties and contacts of a problem as their author states them.

use super::changing::Changing;
use super::data::Data;
use super::handles::{ContactId, SideOf, Sides, TieId};
use super::model::BodySide;
use super::multipliers::MakeMultiplier;
use super::start::Start;
use crate::basis::Basis;
use crate::contact::{Cone, ContactMethod, Obstacle};
use crate::coupling::Coupling;
use crate::coupling::interface::{InterfaceQuadrature, Partners};
use crate::coupling::multiplier::{MultiplierError, MultiplierKind};
use crate::space::Trace;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// Quadrature of integrals over an interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Integration {
    /// Segments of both sides.
    #[default]
    Merged,
    /// The elements of the slave side.
    Slave,
    /// The elements of the slave side for the constraint, those of the master side for the reaction.
    Mixed,
}

/// Makes an integration of interfaces with that many points per direction of a piece.
pub type MakeIntegration<const S: usize, const N: usize> = dyn Fn(usize, Partners) -> Box<dyn InterfaceQuadrature<S, N>> + Send + Sync;

/// An integration: one of the library, or that of a function.
#[derive(Clone)]
pub enum Rule<const S: usize, const N: usize> {
    /// One of the library.
    Kind(Integration),
    /// Made by a function.
    Made(Arc<MakeIntegration<S, N>>),
}

impl<const S: usize, const N: usize> From<Integration> for Rule<S, N> {
    fn from(kind: Integration) -> Self {
        Self::Kind(kind)
    }
}

impl<const S: usize, const N: usize> Debug for Rule<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Kind(kind) => Debug::fmt(kind, f),
            Self::Made(_) => f.write_str("Made"),
        }
    }
}

impl<const S: usize, const N: usize> Rule<S, N> {
    /// The integration of a function of the number of points per direction of a piece and the partners.
    pub fn of(make: impl Fn(usize, Partners) -> Box<dyn InterfaceQuadrature<S, N>> + Send + Sync + 'static) -> Self {
        Self::Made(Arc::new(make))
    }
}

/// A multiplier: one of a kind, or that of a function.
#[derive(Clone)]
pub enum Multiplier<const S: usize, const N: usize> {
    /// One of the library.
    Kind(MultiplierKind),
    /// Made by a function of the slave side, see [`MakeMultiplier`].
    Made(Arc<MakeMultiplier<S, N>>),
}

impl<const S: usize, const N: usize> From<MultiplierKind> for Multiplier<S, N> {
    fn from(kind: MultiplierKind) -> Self {
        Self::Kind(kind)
    }
}

impl<const S: usize, const N: usize> Debug for Multiplier<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Kind(kind) => Debug::fmt(kind, f),
            Self::Made(_) => f.write_str("Made"),
        }
    }
}

impl<const S: usize, const N: usize> Multiplier<S, N> {
    /// The multiplier of a function of the slave side; its argument says whether a function of the body is constrained.
    pub fn of(
        make: impl Fn(&Trace<S, N>, &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<S>>, MultiplierError> + Send + Sync + 'static,
    ) -> Self {
        Self::Made(Arc::new(make))
    }

    pub(super) fn is_dual(&self) -> bool {
        matches!(self, Self::Kind(MultiplierKind::Dual))
    }

    /// Whether it is lowered at constrained ends of `side`.
    pub(super) fn lowers_ends(&self, side: &BodySide<S, N>) -> bool {
        match self {
            Self::Kind(kind) => kind.lowers_ends::<S, f64>(&*side.trace.space),
            Self::Made(_) => true,
        }
    }

    /// Whether it may be an unstable pairing under another name.
    pub(super) fn is_nameless(&self) -> bool {
        matches!(self, Self::Kind(MultiplierKind::Constant | MultiplierKind::Uniform { .. }))
    }
}

/// A tie or a contact of a problem: choices that both have, and those of its own `K`.
#[derive(Clone, Debug)]
pub struct Coupled<const S: usize, const N: usize, K> {
    problem: u64,
    number: usize,
    pub(super) name: String,
    pub(super) multiplier: Multiplier<S, N>,
    pub(super) rule: Rule<S, N>,
    pub(super) extra_points: usize,
    pub(super) exact: Vec<Data>,
    pub(super) own: K,
}

/// A tie of a problem: slave sides on one or several master sides.
pub type Tie<const S: usize = 1, const N: usize = 2> = Coupled<S, N, TieOptions<S, N>>;
/// A contact of a problem: slave sides and what they face.
pub type Contact<const S: usize = 1, const N: usize = 2> = Coupled<S, N, ContactOptions<S, N>>;

impl<const S: usize, const N: usize, K> Coupled<S, N, K> {
    pub(super) fn new(problem: u64, number: usize, name: String, own: K) -> Self {
        let (multiplier, rule) = (MultiplierKind::Auto.into(), Integration::default().into());
        Self { problem, number, name, multiplier, rule, extra_points: 0, exact: Vec::new(), own }
    }

    /// Names it in messages and in the texts of results; by default its sides are its name.
    pub fn named(&mut self, name: &str) -> &mut Self {
        self.name = name.into();
        self
    }

    /// Sets the space of the multiplier; by default that of [`MultiplierKind::Auto`].
    pub fn multiplier(&mut self, multiplier: impl Into<Multiplier<S, N>>) -> &mut Self {
        self.multiplier = multiplier.into();
        self
    }

    /// Sets the quadrature of its integrals; by default segments of both sides.
    pub fn rule(&mut self, rule: impl Into<Rule<S, N>>) -> &mut Self {
        self.rule = rule.into();
        self
    }

    /// Adds quadrature points per direction of a piece.
    pub fn extra_points(&mut self, points: usize) -> &mut Self {
        self.extra_points = points;
        self
    }

    /// Sets the exact multiplier \[force/area\]: of a tie one function per component, of a contact the pressure.
    pub fn exact(&mut self, lambda: Vec<Data>) -> &mut Self {
        self.exact = lambda;
        self
    }
}

/// A slave side of a tie with its masters.
#[derive(Clone, Debug)]
pub struct TiePair<const S: usize, const N: usize> {
    /// The slave side.
    pub slave: Arc<BodySide<S, N>>,
    /// Its masters.
    pub masters: Vec<Arc<BodySide<S, N>>>,
    /// Largest distance of tied points of facets, if the facets explain it \[length\].
    pub explained: Option<f64>,
    /// Whether that distance is to be found when the problem is assembled.
    pub is_asked: bool,
}

/// Choices of a tie.
#[derive(Clone)]
pub struct TieOptions<const S: usize, const N: usize> {
    pub(super) pairs: Vec<TiePair<S, N>>,
    pub(super) coupling: Arc<dyn Coupling<S, N>>,
    pub(super) tolerance: Option<f64>,
}

impl<const S: usize, const N: usize> Debug for TieOptions<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.pairs.iter().map(|p| &p.slave.label)).finish()
    }
}

impl<const S: usize, const N: usize> Coupled<S, N, TieOptions<S, N>> {
    /// Its handle.
    pub fn id(&self) -> TieId {
        TieId { problem: self.problem, number: self.number }
    }

    /// Sets the coupling; by default the mortar method.
    pub fn coupling(&mut self, coupling: impl Coupling<S, N> + 'static) -> &mut Self {
        self.own.coupling = Arc::new(coupling);
        self
    }

    /// Ties points up to this distance apart \[length\].
    pub fn tolerance(&mut self, distance: f64) -> &mut Self {
        self.own.tolerance = Some(distance);
        self
    }
}

/// Opponent of the slave sides of a contact.
#[derive(Clone, Debug)]
pub enum Opponent<'a, const S: usize, const N: usize> {
    /// Sides of bodies.
    Sides(Sides<'a>),
    /// A rigid obstacle.
    Obstacle(Arc<dyn Obstacle<S, N>>),
    /// A rigid obstacle that is a function of time.
    Changing(ChangingObstacle<S, N>),
}

/// A rigid obstacle as a function of time.
pub type ChangingObstacle<const S: usize, const N: usize> = Changing<Box<dyn Obstacle<S, N>>>;

impl<'a, const S: usize, const N: usize> From<SideOf<'a>> for Opponent<'a, S, N> {
    fn from(side: SideOf<'a>) -> Self {
        Self::Sides(side.into())
    }
}

impl<'a, const S: usize, const N: usize> From<Sides<'a>> for Opponent<'a, S, N> {
    fn from(sides: Sides<'a>) -> Self {
        Self::Sides(sides)
    }
}

impl<'a, const K: usize, const S: usize, const N: usize> From<[SideOf<'a>; K]> for Opponent<'a, S, N> {
    fn from(sides: [SideOf<'a>; K]) -> Self {
        Self::Sides(sides.into())
    }
}

impl<'a, const S: usize, const N: usize> From<Vec<SideOf<'a>>> for Opponent<'a, S, N> {
    fn from(sides: Vec<SideOf<'a>>) -> Self {
        Self::Sides(sides.into())
    }
}

impl<O: Obstacle<S, N> + 'static, const S: usize, const N: usize> From<O> for Opponent<'_, S, N> {
    fn from(obstacle: O) -> Self {
        Self::Obstacle(Arc::new(obstacle))
    }
}

impl<const S: usize, const N: usize> From<ChangingObstacle<S, N>> for Opponent<'_, S, N> {
    fn from(obstacle: ChangingObstacle<S, N>) -> Self {
        Self::Changing(obstacle)
    }
}

/// The opponent of a contact of a problem.
#[derive(Clone, Debug)]
pub(super) enum StatedOpponent<const S: usize, const N: usize> {
    Sides(Vec<Arc<BodySide<S, N>>>),
    Obstacle { at_rest: ChangingObstacle<S, N>, changes: bool },
}

/// Choices of a contact.
#[derive(Clone, Debug)]
pub struct ContactOptions<const S: usize, const N: usize> {
    pub(super) slaves: Vec<Arc<BodySide<S, N>>>,
    pub(super) faced: StatedOpponent<S, N>,
    pub(super) method: Arc<dyn ContactMethod<S, N>>,
    pub(super) cone: Cone,
    pub(super) gap: Data,
    pub(super) reach: Option<f64>,
    pub(super) start: Start,
    pub(super) symmetry: bool,
    pub(super) adjust: bool,
    pub(super) motion: Vec<(usize, Data)>,
    pub(super) forces: Vec<(usize, Data)>,
}

impl<const S: usize, const N: usize> Coupled<S, N, ContactOptions<S, N>> {
    /// Its handle.
    pub fn id(&self) -> ContactId {
        ContactId { problem: self.problem, number: self.number }
    }

    /// The sides that it faces, none of an obstacle.
    pub(super) fn masters(&self) -> &[Arc<BodySide<S, N>>] {
        if let StatedOpponent::Sides(masters) = &self.own.faced { masters } else { &[] }
    }

    /// Sets the method; by default Lagrange multipliers.
    pub fn method(&mut self, method: impl ContactMethod<S, N> + 'static) -> &mut Self {
        self.own.method = Arc::new(method);
        self
    }

    /// Sets the cone of admissible multipliers; by default coefficients without a sign change.
    pub fn cone(&mut self, cone: Cone) -> &mut Self {
        self.own.cone = cone;
        self
    }

    /// Replaces the distance of the sides by a function of position, time and this distance, see [`Data::of_gap`].
    pub fn gap(&mut self, gap: impl Into<Data>) -> &mut Self {
        self.own.gap = gap.into();
        self
    }

    /// Limits the distance of partners \[length\].
    pub fn reach(&mut self, reach: f64) -> &mut Self {
        self.own.reach = Some(reach);
        self
    }

    /// Sets the first guess of the closed rows.
    pub fn start(&mut self, start: Start) -> &mut Self {
        self.own.start = start;
        self
    }

    /// Says that a zone that ends at the end of the side goes on beyond it: half models.
    pub fn symmetry(&mut self) -> &mut Self {
        self.own.symmetry = true;
        self
    }

    /// Closes gaps and overlaps at rest that facets explain: those of up to twice the distance of the facets of both sides from the surfaces
    /// for which they stand, and of rounding. The formula of the gap is that of what is left.
    pub fn adjust(&mut self) -> &mut Self {
        self.own.adjust = true;
        self
    }

    /// Translates the obstacle in a coordinate, a function of time \[length\].
    pub fn moved(&mut self, component: usize, by: impl Into<Data>) -> &mut Self {
        self.own.motion.push((component, by.into()));
        self
    }

    /// Presses the obstacle by a force in a coordinate, a function of time: its translation is an unknown.
    pub fn pressed(&mut self, component: usize, force: impl Into<Data>) -> &mut Self {
        self.own.forces.push((component, force.into()));
        self
    }
}
