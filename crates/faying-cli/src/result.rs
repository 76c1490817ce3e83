//! Results of a run: the public, serialisable content of `result.json`.

use super::named::Named;
use crate::errors::Diagnostic;
use faying::problem::Forecast;
use serde::Serialize;

/// Status of a finished command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Status {
    /// Done, every check passed.
    Ok,
    /// Done, a check failed.
    CheckFailed,
    /// The case is wrong.
    Invalid,
    /// A file could not be read or written.
    IoFailed,
    /// An iteration did not settle.
    NotConverged,
    /// A system has no unique solution.
    Singular,
    /// A number is infinite or not a number.
    NotFinite,
    /// A limit of memory or time was reached.
    Limit,
    /// The user stopped the run.
    Interrupted,
    /// A bug.
    Internal,
}

impl Status {
    /// The exit code that belongs to the status.
    pub fn exit(self) -> i32 {
        match self {
            Self::Ok => 0,
            Self::CheckFailed => 1,
            Self::Invalid => 3,
            Self::IoFailed => 4,
            Self::NotConverged | Self::Singular | Self::NotFinite => 5,
            Self::Limit => 6,
            Self::Internal => 70,
            Self::Interrupted => 130,
        }
    }
}

/// Numbers of unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Unknowns {
    /// Coefficients of all bodies, prescribed ones included.
    pub primal: usize,
    /// Rows of all tied interfaces and contacts.
    pub multipliers: usize,
}

/// Size and quality of the bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GeometryReport {
    /// Area (volume in 3D) of each patch [length^N].
    pub measure: Named<f64>,
    /// Least determinant dx/dxi of the maps from unit cells over all Gauss points, signed by the patch [length^N].
    pub least_jacobian: f64,
    /// Gauss points per direction of the bulk integrals of each patch, the most of its elements; of triangles and tetrahedra one
    /// number, the points of their rule. More than degree + 1 where the map is curved in space, see
    /// [`points_of_curved_cells`](faying::assembly::points_of_curved_cells).
    pub points: Named<Vec<usize>>,
    /// Elements of all patches.
    pub elements: usize,
    /// Largest diameter of an element \[length\].
    pub h: f64,
    /// Sides that `coupling = "glue"` joins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub glued: Vec<GluedSides>,
}

/// A slave side and a master side whose functions are shared.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GluedSides {
    /// Name of the interface.
    pub interface: String,
    /// The sides, their distance and the share that is glued.
    #[serde(flatten)]
    pub sides: TiedSides,
}

/// The active set iteration.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ActiveSetSummary {
    /// Linear systems solved.
    pub iterations: usize,
    /// Active rows in each of them.
    pub history: Vec<usize>,
    /// Number of active rows, or groups of rows, in each set that the rows alone decided before, without the unknowns.
    pub sets: Vec<usize>,
    /// Rows that violate the contact conditions after each of them.
    pub wrong: Vec<usize>,
    /// Sign cases after each of them, all contacts together: rows lambda <0, =0, >0; columns gap =0, >0, <0.
    pub sign_cases: Vec<[usize; 9]>,
    /// States that were visited twice.
    pub cycles: usize,
    /// The iteration whose state the numbers and the files show, from 1: the last one where it settled, else the one that violates
    /// the contact conditions least; 0 where no system was solved.
    pub best: usize,
    /// Events beside regular steps: cycles, steps that were not taken in full.
    pub notes: Vec<String>,
    /// Multiplier updates of the surrounding augmented Lagrangian iteration, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub updates: Option<usize>,
}

/// The linear algebra of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SolveReport {
    /// Reason why the iteration ended: converged, cycling, iterations, rigid motion left, infeasible load, stopped, singular, not-finite.
    pub reason: String,
    /// Solution method: "saddle-point, direct".
    pub linear: String,
    /// Relative residual of the true system.
    pub residual: f64,
    /// Condition number of the scaled system to a factor of a few: bound on the growth of relative errors of the load; `None` if no
    /// factorisation provides it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub condition: Option<f64>,
    /// Iterations of the linear algebra, summed over the active set; 0 for factorisations alone.
    pub iterations: usize,
    /// Number of factorisations of whole systems.
    pub factors: usize,
    /// The active set iteration, where there is contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_set: Option<ActiveSetSummary>,
}

/// Least and largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Extremes {
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

/// Gaps between the sides of a contact \[length\], negative where they overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Gaps {
    /// Least gap in the variables of the cone, an average (lumped for coefficients); at the points for Nitsche's method.
    pub min: f64,
    /// Least gap at the points of integration.
    pub least: f64,
}

/// Violation of the contact conditions, each zero where they hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Kkt {
    /// Largest tension, max(lambda_j, 0) [force/area].
    pub lambda: f64,
    /// Largest penetration, max(-gap_j, 0), of the gap of the cone, lumped for coefficients \[length\].
    pub gap: f64,
    /// Largest |lambda_j gap_j|.
    pub product: f64,
}

/// Pieces of an interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SegmentsReport {
    /// Number of pieces.
    pub count: usize,
    /// Their measure on the slave side [length^(N-1)].
    pub measure: f64,
}

/// A moment about the origin: one number in the plane, three in space.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Moment {
    /// About z [force length].
    Plane(f64),
    /// About x, y, z [force length].
    Space(Vec<f64>),
}

impl Default for Moment {
    fn default() -> Self {
        Self::Plane(0.0)
    }
}

/// The multiplier space of an interface or a contact, all its slave sides and components together.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MultiplierReport {
    /// Its name, for `auto` that chosen on the first slave side; "data" if the case gives a degree.
    pub name: String,
    /// Highest degree of an element.
    pub degree: usize,
    /// Number of functions.
    pub functions: usize,
    /// Highest degree of which all polynomials along every slave side lie in the space of every component; see
    /// [`reproduction`](faying::coupling::multiplier::reproduction()); `None` if not even the constants do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reproduction: Option<usize>,
}

/// One contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ContactReport {
    /// Resultant force of the master on the slave \[force\].
    pub force: Vec<f64>,
    /// Its moment about the origin [force length].
    pub moment: Moment,
    /// Translation of a rigid obstacle, prescribed or found \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Vec<f64>>,
    /// Measure of the zone that carries pressure [length^(N-1)].
    pub area: f64,
    /// Extremes of the pressure -lambda at the points of integration [force/area].
    pub pressure: Extremes,
    /// Least gaps, of the cone and at points.
    pub gap: Gaps,
    /// Active multipliers: closed rows of the cone ([`faying::contact::Cone`]); coefficients, integrals or values below zero.
    pub active: usize,
    /// Violation of the contact conditions in the variables of the cone.
    pub kkt: Kkt,
    /// Rows lambda <0, =0, >0; columns gap =0, >0, <0.
    pub sign_cases: [usize; 9],
    /// Pieces that face the master.
    pub segments: SegmentsReport,
    /// Half the extent of the zone along the slave, an arc length found to a fraction of an element; with `symmetry` all of it where the
    /// zone ends at an end of the side \[length\]. In the plane alone. NaN, with a reason, where the pressure does not tell it. See
    /// [`faying::contact::half_width`].
    pub half_width: f64,
    /// Reason for a missing half width.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Linear systems solved by the active set.
    pub iterations: usize,
    /// Estimate of the integration's consistency error on this solution, as of interfaces; zero against an obstacle.
    pub consistency: f64,
    /// Sum of the forces on slave and master, relative to their size: round-off unless the integration is mixed; zero against an
    /// obstacle.
    pub balance: f64,
    /// Its multiplier space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier: Option<MultiplierReport>,
}

/// Size of a multiplier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Norm {
    /// L2 norm over the slave side.
    pub norm: f64,
}

/// L2 norm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct L2 {
    /// L2 norm over the slave side.
    #[serde(rename = "L2")]
    pub l2: f64,
}

/// One tied interface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct InterfaceReport {
    /// Norm of the multiplier.
    pub lambda: Norm,
    /// Norm of u_slave - u_master.
    pub jump: L2,
    /// Pieces seen from both sides.
    pub segments: SegmentsReport,
    /// Largest distance of partner points \[length\].
    pub distance: f64,
    /// Share of the slave sides that is tied.
    pub share: f64,
    /// Pairs of tied sides.
    pub sides: Vec<TiedSides>,
    /// Estimate of the integration's consistency error on this solution, free of units: what the constraint and the
    /// equilibrium miss of the integrals ([`faying::coupling::consistency`]); zero up to round-off where the integration is
    /// exact, and where the coupling has no mortar rows.
    pub consistency: f64,
    /// Largest difference of the forces on both sides, relative to the sum of their sizes: zero by action and reaction.
    pub balance: f64,
    /// Its multiplier space, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier: Option<MultiplierReport>,
}

/// A slave side and a master side that are tied.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TiedSides {
    /// The side that carries the multiplier.
    pub slave: String,
    /// The other.
    pub master: String,
    /// Largest distance of partner points \[length\].
    pub distance: f64,
    /// Share of the slave side that is tied to this master.
    pub share: f64,
}

/// Sum of all forces and moments on the model, zero in equilibrium.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Balance {
    /// Loads + reactions + forces of obstacles \[force\].
    pub force: Vec<f64>,
    /// Their moment about the origin [force length]; elasticity only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<Moment>,
}

/// Resultant of a load, by the rules of integration of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LoadReport {
    /// The force; of a flux or a source its sum alone \[force\].
    pub force: Vec<f64>,
    /// Its moment about the origin [force length]; elasticity only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<Moment>,
}

/// Result of a probe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeReport {
    /// Its name.
    pub name: String,
    /// Its quantity, as written.
    pub quantity: String,
    /// Its value; `null` in the file where it is not finite.
    pub value: f64,
    /// Place of an extreme \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// Reason for a missing value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// Its name.
    pub name: String,
    /// Its quantity, as written.
    pub quantity: String,
    /// The value found; the worse one if both extremes are checked.
    pub value: f64,
    /// Place of an extreme \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// The expected value, or the bound.
    pub expected: f64,
    /// Whether it passed.
    pub ok: bool,
    /// Relation that is checked: "below", "above", "equals".
    pub relation: String,
    /// Reason for a missing value or a skipped check.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Whether it was left to another command or backend and does not count.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub skipped: bool,
}

/// One step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepReport {
    /// Its time.
    pub t: f64,
    /// Status of the step; checks are decided by the last step alone.
    pub status: Status,
    /// The probes at its end.
    pub probes: Vec<ProbeReport>,
    /// The contacts at its end.
    pub contact: Named<ContactReport>,
}

/// Predicted size of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Prediction {
    /// Entries of the stiffness.
    pub entries: u64,
    /// Entries of its factor, within a factor of about 1.5.
    pub factor: u64,
    /// Peak memory in bytes.
    pub memory: u64,
}

impl From<Forecast> for Prediction {
    fn from(forecast: Forecast) -> Self {
        Self { entries: forecast.entries, factor: forecast.factor, memory: forecast.memory }
    }
}

/// The content of `result.json`.
///
/// A number that is not finite is `null` in the file, with a `reason` beside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RunResult {
    /// "faying.result/1".
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// "run" or "check".
    pub command: String,
    /// Status of the command.
    pub status: Status,
    /// Whether there is a solution; without one the numbers that need it are zero here, and `null` or absent in the file.
    #[serde(skip)]
    pub solved: bool,
    /// The exit code.
    pub exit: i32,
    /// The case file's name.
    pub case: String,
    /// The backend, or slave+master where they differ, or "mixed".
    pub backend: String,
    /// The backend of every patch.
    pub backends: Named<String>,
    /// Numbers of unknowns.
    pub unknowns: Unknowns,
    /// Size and quality of the bodies.
    pub geometry: GeometryReport,
    /// The linear algebra.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solve: Option<SolveReport>,
    /// Predicted size and memory of a run: `check` alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<Prediction>,
    /// Time of the numbers below: that of the last step with a state; `None` without steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
    /// Every contact by name.
    pub contact: Named<ContactReport>,
    /// Every tied interface by name.
    pub interface: Named<InterfaceReport>,
    /// Reaction force on the body from the support of every side with Dirichlet data \[force\]; a corner's share is split equally
    /// among the sides that hold it.
    pub reactions: Named<Vec<f64>>,
    /// Resultant of the loads of every boundary block, by its name, and of what loads the volume of a patch: `PATCH.body_force` with the
    /// weight, `PATCH.source`.
    pub loads: Named<LoadReport>,
    /// Sum of all forces.
    pub balance: Balance,
    /// 1/2 a(u, u).
    pub energy: f64,
    /// Every error that can be measured, by its quantity.
    pub errors: Named<f64>,
    /// Reason for errors without value, where there is another than that they are not finite.
    #[serde(skip)]
    pub errors_reason: Option<String>,
    /// Probes in the order of the case.
    pub probes: Vec<ProbeReport>,
    /// Checks in the order of the case.
    pub checks: Vec<CheckReport>,
    /// Checks that were decided.
    pub checks_performed: usize,
    /// Checks in the case.
    pub checks_expected: usize,
    /// Checks that were left to another command or backend.
    pub checks_skipped: usize,
    /// Every step, where the case has some.
    pub steps: Vec<StepReport>,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    /// Errors.
    pub diagnostics: Vec<Diagnostic>,
    /// Files written beside this one.
    pub files: Vec<String>,
}

impl RunResult {
    /// An empty result of `command` on the case file `case`.
    pub fn new(command: &str, case: &str) -> Self {
        Self {
            schema: "faying.result/1".into(),
            version: env!("CARGO_PKG_VERSION").into(),
            command: command.into(),
            status: Status::Ok,
            solved: false,
            exit: 0,
            case: case.into(),
            backend: String::new(),
            backends: Named::default(),
            unknowns: Unknowns::default(),
            geometry: GeometryReport::default(),
            solve: None,
            predicted: None,
            t: None,
            contact: Named::default(),
            interface: Named::default(),
            reactions: Named::default(),
            loads: Named::default(),
            balance: Balance::default(),
            energy: 0.0,
            errors: Named::default(),
            errors_reason: None,
            probes: Vec::new(),
            checks: Vec::new(),
            checks_performed: 0,
            checks_expected: 0,
            checks_skipped: 0,
            steps: Vec::new(),
            warnings: Vec::new(),
            diagnostics: Vec::new(),
            files: Vec::new(),
        }
    }

    /// The result as a JSON value, numbers that are not finite or were not computed as `null` with a `reason` beside them.
    pub fn to_value(&self) -> serde_json::Value {
        let mut value = self.numbers();
        if !self.solved {
            super::unsolved::forget(&mut value, &self.command, !self.backends.is_empty());
        }
        value
    }

    /// Every number of the result under its name, computed or not.
    pub(super) fn numbers(&self) -> serde_json::Value {
        let mut value = serde_json::to_value(self).expect("a result has string keys and plain values only");
        if let Some(reason) = &self.errors_reason {
            value["errors"]["reason"] = reason.as_str().into();
        }
        super::json::add_reasons(&mut value);
        value
    }

    /// The text of `result.json`: one line per top-level field, 17 significant digits.
    pub fn to_json(&self) -> String {
        super::json::text(&self.to_value())
    }
}
