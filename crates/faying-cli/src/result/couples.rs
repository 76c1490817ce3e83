//! Tied interfaces and contacts.

use super::forces::Moment;
use serde::Serialize;

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
    /// Between surfaces the largest distance of a point from the cell of its master element, in local coordinates: where sides are kinked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outside: Option<f64>,
    /// Between surfaces the number of slave elements that the pieces do not tile though the master does not end there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<usize>,
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
    /// zone ends at an end of the side \[length\]. `None` in space; NaN, with a reason, where the pressure does not tell it. See
    /// [`faying::contact::half_width`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width: Option<f64>,
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
    /// Force of the masters on the slaves, of conduction the flux into them \[force\].
    pub force: Vec<f64>,
    /// Its moment about the origin; zero in conduction [force length].
    pub moment: Moment,
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

/// A slave side and a master side whose functions are shared.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GluedSides {
    /// Name of the interface.
    pub interface: String,
    /// The sides, their distance and the share that is glued.
    #[serde(flatten)]
    pub sides: TiedSides,
}
