//! Ties and contacts of a problem as their author states them.

use super::data::Data;
use super::handles::{SideOf, Sides};
use super::model::{Formulation, SideModel};
use super::multipliers::{MakeMultiplier, curve_multiplier};
use super::start::Start;
use super::tie_part::{InterfaceRules, MakeIntegration};
use crate::basis::Basis;
use crate::contact::{Cone, Obstacle};
use crate::coupling::interface::{InterfaceQuadrature, MasterSums, MergedCurve, Partners, SlaveRule};
use crate::coupling::multiplier::{MultiplierError, MultiplierKind};
use crate::coupling::{Coupling, Mortar, Penalty};
use crate::space::Trace;
use std::fmt::Debug;
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

impl Integration {
    fn rules(self, extra_points: usize, contact: bool) -> InterfaceRules<'static, 1, 2> {
        let merged: &MakeIntegration<'static, 1, 2> = &|points, partners| Box::new(MergedCurve { points, partners });
        let slave: &MakeIntegration<'static, 1, 2> = &|points, partners| Box::new(SlaveRule { points, partners });
        let sums: &MakeIntegration<'static, 1, 2> = &|points, partners: Partners| Box::new(MasterSums { points, partners });
        InterfaceRules {
            rule: if self == Self::Merged { merged } else { slave },
            second: (self == Self::Mixed).then_some(if contact { sums } else { slave }),
            finer: Some(merged),
            extra_points,
        }
    }
}

/// An integration: one of the library, or that of a function.
#[derive(Clone)]
pub(super) enum Rule {
    Kind(Integration),
    Made(Arc<MakeIntegration<'static, 1, 2>>),
}

impl Debug for Rule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Kind(kind) => Debug::fmt(kind, f),
            Self::Made(_) => f.write_str("Made"),
        }
    }
}

impl Rule {
    /// The rules of a tie, or of a contact.
    pub(super) fn rules(&self, extra_points: usize, contact: bool) -> InterfaceRules<'_, 1, 2> {
        match self {
            Self::Kind(kind) => kind.rules(extra_points, contact),
            Self::Made(make) => InterfaceRules { rule: &**make, ..Integration::Merged.rules(extra_points, contact) },
        }
    }
}

/// A multiplier: one of a kind, or that of a function.
#[derive(Clone)]
pub(super) enum Multiplier {
    Kind(MultiplierKind),
    Made(Arc<MakeMultiplier<'static, 1, 2>>),
}

impl Debug for Multiplier {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Kind(kind) => Debug::fmt(kind, f),
            Self::Made(_) => f.write_str("Made"),
        }
    }
}

impl Multiplier {
    pub(super) fn make(&self, trace: &Trace<1, 2>, constrained: &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<1>>, MultiplierError> {
        match self {
            Self::Kind(kind) => curve_multiplier(*kind, trace, constrained),
            Self::Made(make) => make(trace, constrained),
        }
    }
}

/// The choices that ties and contacts share.
macro_rules! setters {
    () => {
        /// Names it; by default "slave side - opponent".
        pub fn named(&mut self, name: &str) -> &mut Self {
            name.clone_into(&mut self.name);
            self
        }

        /// Takes a multiplier of a kind; by default [`MultiplierKind::Auto`].
        pub fn multiplier(&mut self, kind: MultiplierKind) -> &mut Self {
            self.multiplier = Multiplier::Kind(kind);
            self
        }

        /// Takes a multiplier from a function of the slave side; see [`MakeMultiplier`].
        pub fn multiplier_of(
            &mut self,
            make: impl Fn(&Trace<1, 2>, &dyn Fn(usize) -> bool) -> Result<Box<dyn Basis<1>>, MultiplierError> + Send + Sync + 'static,
        ) -> &mut Self {
            self.multiplier = Multiplier::Made(Arc::new(make));
            self
        }

        /// Sets the integration; by default over segments of both sides.
        pub fn integration(&mut self, integration: Integration) -> &mut Self {
            self.integration = Rule::Kind(integration);
            self
        }

        /// Takes the integration from a function of the number of points per piece and the partners; see [`MakeIntegration`].
        pub fn integration_of(
            &mut self,
            make: impl Fn(usize, Partners) -> Box<dyn InterfaceQuadrature<1, 2>> + Send + Sync + 'static,
        ) -> &mut Self {
            self.integration = Rule::Made(Arc::new(make));
            self
        }

        /// Adds quadrature points per segment.
        pub fn extra_points(&mut self, points: usize) -> &mut Self {
            self.extra_points = points;
            self
        }
    };
}

/// Makes the coupling of a tie each time the problem is assembled.
type MakeCoupling = Arc<dyn Fn() -> Box<dyn Coupling<1, 2>> + Send + Sync>;

/// A tie of a problem: a slave side on one or several master sides.
#[derive(Clone)]
pub struct Tie {
    pub(super) name: String,
    pub(super) slave: Arc<SideModel<1, 2>>,
    pub(super) masters: Vec<Arc<SideModel<1, 2>>>,
    pub(super) multiplier: Multiplier,
    pub(super) coupling: MakeCoupling,
    pub(super) mortar_rows: bool,
    pub(super) integration: Rule,
    pub(super) extra_points: usize,
    pub(super) tolerance: Option<f64>,
}

impl Debug for Tie {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tie").field("name", &self.name).field("slave", &self.slave.label).finish_non_exhaustive()
    }
}

impl Tie {
    pub(super) fn new(name: String, slave: Arc<SideModel<1, 2>>, masters: Vec<Arc<SideModel<1, 2>>>) -> Self {
        Self {
            name,
            slave,
            masters,
            multiplier: Multiplier::Kind(MultiplierKind::Auto),
            coupling: Arc::new(|| Box::new(Mortar)),
            mortar_rows: true,
            integration: Rule::Kind(Integration::default()),
            extra_points: 0,
            tolerance: None,
        }
    }

    setters!();

    /// Couples by the mortar method, softened by a penalty with this factor.
    pub fn penalty(&mut self, factor: f64) -> &mut Self {
        self.coupling = Arc::new(move || Box::new(Penalty { factor }));
        self.mortar_rows = true;
        self
    }

    /// Takes any other coupling than mortar and penalty, such as Nitsche's method.
    pub fn coupling(&mut self, coupling: impl Coupling<1, 2> + Clone + 'static) -> &mut Self {
        self.coupling = Arc::new(move || Box::new(coupling.clone()));
        self.mortar_rows = false;
        self
    }

    /// Ties points up to this distance apart \[length\].
    pub fn tolerance(&mut self, distance: f64) -> &mut Self {
        self.tolerance = Some(distance);
        self
    }
}

/// Opponent of the slave side of a contact.
#[derive(Clone, Debug)]
pub enum Opposite<'a> {
    /// Sides of bodies.
    Sides(Sides<'a>),
    /// A rigid obstacle.
    Obstacle(Arc<dyn Obstacle<1, 2>>),
}

impl<'a> From<SideOf<'a>> for Opposite<'a> {
    fn from(side: SideOf<'a>) -> Self {
        Self::Sides(side.into())
    }
}

impl<'a, const K: usize> From<[SideOf<'a>; K]> for Opposite<'a> {
    fn from(sides: [SideOf<'a>; K]) -> Self {
        Self::Sides(sides.into())
    }
}

impl<'a> From<Vec<SideOf<'a>>> for Opposite<'a> {
    fn from(sides: Vec<SideOf<'a>>) -> Self {
        Self::Sides(sides.into())
    }
}

impl<O: Obstacle<1, 2> + 'static> From<O> for Opposite<'_> {
    fn from(obstacle: O) -> Self {
        Self::Obstacle(Arc::new(obstacle))
    }
}

/// The opponent of a contact of a problem.
#[derive(Clone, Debug)]
pub(super) enum Faced {
    Sides(Vec<Arc<SideModel<1, 2>>>),
    Obstacle(Arc<dyn Obstacle<1, 2>>),
}

/// A contact of a problem: a slave side and what it faces.
#[derive(Clone, Debug)]
pub struct ContactOf {
    pub(super) name: String,
    pub(super) slave: Arc<SideModel<1, 2>>,
    pub(super) faced: Faced,
    pub(super) multiplier: Multiplier,
    pub(super) formulation: Formulation,
    pub(super) cone: Cone,
    pub(super) integration: Rule,
    pub(super) extra_points: usize,
    pub(super) gap: Data,
    pub(super) reach: Option<f64>,
    pub(super) start: Start,
    pub(super) symmetry: bool,
    pub(super) motion: Vec<(usize, Data)>,
    pub(super) forces: Vec<(usize, Data)>,
}

impl ContactOf {
    pub(super) fn new(name: String, slave: Arc<SideModel<1, 2>>, faced: Faced) -> Self {
        Self {
            name,
            slave,
            faced,
            multiplier: Multiplier::Kind(MultiplierKind::Auto),
            formulation: Formulation::Lagrange,
            cone: Cone::Coefficients,
            integration: Rule::Kind(Integration::default()),
            extra_points: 0,
            gap: Data::gap(),
            reach: None,
            start: Start::default(),
            symmetry: false,
            motion: Vec::new(),
            forces: Vec::new(),
        }
    }

    setters!();

    /// Sets the method; by default Lagrange multipliers.
    pub fn method(&mut self, method: Formulation) -> &mut Self {
        self.formulation = method;
        self
    }

    /// Sets the cone of admissible multipliers; by default coefficients without a sign change.
    pub fn cone(&mut self, cone: Cone) -> &mut Self {
        self.cone = cone;
        self
    }

    /// Replaces the distance of the sides by a function of position, time and this distance, see [`Data::of_gap`].
    pub fn gap(&mut self, gap: impl Into<Data>) -> &mut Self {
        self.gap = gap.into();
        self
    }

    /// Limits the distance of partners \[length\].
    pub fn reach(&mut self, reach: f64) -> &mut Self {
        self.reach = Some(reach);
        self
    }

    /// Sets the first guess of the closed rows.
    pub fn start(&mut self, start: Start) -> &mut Self {
        self.start = start;
        self
    }

    /// Says that a zone that ends at the end of the side goes on beyond it: half models.
    pub fn symmetry(&mut self) -> &mut Self {
        self.symmetry = true;
        self
    }

    /// Translates the obstacle in a coordinate, a function of time \[length\].
    pub fn moved(&mut self, component: usize, by: impl Into<Data>) -> &mut Self {
        self.motion.push((component, by.into()));
        self
    }

    /// Presses the obstacle by a force in a coordinate, a function of time: its translation is an unknown.
    pub fn pressed(&mut self, component: usize, force: impl Into<Data>) -> &mut Self {
        self.forces.push((component, force.into()));
        self
    }
}
