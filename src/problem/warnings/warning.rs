//! Warnings as data.

use crate::problem::model::Model;
use crate::problem::{Beyond, FacetsApart, Inexact, Statement};

/// A kind of part of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SubjectKind {
    /// A body, in the order in which they were said.
    Body,
    /// A tie, as bodies.
    Tie,
    /// A contact, as bodies.
    Contact,
}

/// A body, tie or contact of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Its kind.
    pub kind: SubjectKind,
    /// Its place in the model's list of its kind.
    pub number: usize,
    /// Its name.
    pub name: String,
}

impl Subject {
    /// A body of a model.
    pub(super) fn body<const S: usize, const N: usize>(model: &Model<S, N>, number: usize) -> Self {
        Self { kind: SubjectKind::Body, number, name: model.patches[number].name.clone() }
    }

    /// A tie of a model.
    pub(super) fn tie<const S: usize, const N: usize>(model: &Model<S, N>, number: usize) -> Self {
        Self { kind: SubjectKind::Tie, number, name: model.ties[number].name.clone() }
    }

    /// A contact of a model.
    pub(super) fn contact<const S: usize, const N: usize>(model: &Model<S, N>, number: usize) -> Self {
        Self { kind: SubjectKind::Contact, number, name: model.contacts[number].name.clone() }
    }
}

/// A doubt about a problem or its solution, which is solved all the same.
///
/// Places are positions in space, one coordinate per dimension \[length\]; shares and errors are relative, free of units.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Prescribed values of two bodies that are tied differ by more than 1e-9 of the largest in a corner that they share: the multiplier
    /// has to carry the jump.
    CornerValues {
        /// The two supports.
        of: [Statement; 2],
        /// Labels of their sides.
        sides: [String; 2],
        /// The component.
        component: usize,
        /// Its values by both.
        values: [f64; 2],
        /// The corner.
        x: Vec<f64>,
        /// The first time at which they differ.
        t: f64,
    },
    /// A contact overlaps at the first time by more than half the thickness of a body along the normal, at more than half of the area that
    /// overlaps: the wrong sides may face each other.
    Overlap {
        /// The contact.
        of: Subject,
        /// Label of the slave side.
        slave: String,
        /// Labels of the master sides; none against an obstacle.
        masters: Vec<String>,
        /// The greatest depth \[length\].
        depth: f64,
        /// Its place.
        x: Vec<f64>,
        /// Whether the gap formula makes it that deep, not the place of the sides.
        by_formula: bool,
        /// Sides of both bodies, by body and name, that face each other at less than half the distance of the named ones.
        meant: Option<[(usize, String); 2]>,
    },
    /// The functions of a multiplier hold less of the rigid motions of bodies than its points would.
    TooFewFunctions {
        /// The tie or contact.
        of: Subject,
        /// Label of the slave side.
        slave: String,
        /// The body of the slave side.
        slave_body: Subject,
        /// Number of functions, of a tie per component.
        functions: usize,
        /// The body that can move.
        body: Subject,
        /// Its motions in words.
        motions: Vec<String>,
    },
    /// Cells whose longest edge is more than 1e8 times their least height: rounding is of the size of their stiffness.
    ThinCells {
        /// The body.
        of: Subject,
        /// The largest aspect.
        aspect: f64,
        /// The largest aspect without a warning.
        allowed: f64,
        /// The first element that has the largest.
        element: usize,
        /// Its middle.
        x: Vec<f64>,
    },
    /// Gauss points that miss more than 1e-3 of the stress of linear fields on a cell of a rational map.
    PatchTest {
        /// The body.
        of: Subject,
        /// The element with the largest defect.
        element: usize,
        /// Its middle.
        x: Vec<f64>,
        /// The defect sqrt( Σ_i |F_i - F*_i|² / K_ii ) / sqrt(V).
        missed: f64,
        /// The least number of more points per direction with which the defect is below 1e-4, and the defect then.
        enough: Option<(usize, f64)>,
    },
    /// A part of a tied slave side meets no master: facets that stand for one surface end beside each other. Nothing ties it.
    PartUncovered {
        /// The tie.
        of: Subject,
        /// Label of the slave side.
        slave: String,
        /// The share of the slave side that is not tied.
        share: f64,
    },
    /// Facets of sides that nearly fit leave the surface that they stand for by h > 0.1 mean |g|, where max |g| < 10 h: facets decide what
    /// touches.
    Facets {
        /// The contact.
        of: Subject,
        /// h, the sum of the greatest deviations of both sides \[length\].
        sag: f64,
        /// mean |g| \[length\].
        gap: f64,
    },
    /// Dual multipliers that hold constants only on a side of degree 3 or more: errors of u fall as at degree 2, those of lambda with order 1.
    DualConstants {
        /// The tie or contact.
        of: Subject,
        /// Label of the slave side.
        slave: String,
        /// The degree of the slave side.
        degree: usize,
    },
    /// Mixed integration of multipliers that jump or kink inside of the master's elements: errors of u may fall with a lower order than that
    /// of the slave side.
    MixedMultiplier {
        /// The tie or contact.
        of: Subject,
        /// Label of the slave side.
        slave: String,
        /// The degree of the slave side.
        degree: usize,
        /// The degree of the multiplier.
        multiplier: usize,
        /// The order with which errors of u may fall.
        order: usize,
    },
    /// A multiplier runs round an edge of its slave side: tractions jump there, and it does not hold those of a constant stress.
    RoundKink {
        /// The tie or contact.
        of: Subject,
        /// Label of the slave side.
        slave: String,
    },
    /// Sides of a tie are apart by unlike distances from one function of its multiplier to the next, which strains the cells beside it.
    UnevenGap {
        /// The tie.
        of: Subject,
        /// Label of the slave side.
        slave: String,
        /// The stress that this takes over that of linear fields, root of the mean square.
        share: f64,
    },
    /// A rigid motion that springs alone hold, with less than 1e-5 of the stiffness of the bodies that move.
    HardlyHeld {
        /// The body that moves most.
        of: Subject,
        /// Its motion in words.
        motions: Vec<String>,
        /// Stiffness of the springs over that of the bodies.
        share: f64,
    },
    /// The flux of the exact solution jumps inside of a body or across a tie by more than 1e-3 of its largest: the source that follows from
    /// it lacks the jump.
    FluxJump {
        /// The body or the tie.
        of: Subject,
        /// The place of the largest jump.
        x: Vec<f64>,
        /// The jump over the largest flux.
        share: f64,
    },
    /// Sides whose facets do not explain their distance.
    FacetsApart(FacetsApart),
    /// An integral of a load, of springs, of prescribed values or of a modulus that is wrong by more than 1e-3.
    Inexact(Inexact),
    /// The [consistency error](crate::coupling::consistency) of an interface is above 1e-2: its forces may be wrong by as much.
    Integration {
        /// The tie or contact.
        of: Subject,
        /// The consistency error.
        error: f64,
    },
    /// Forces of mixed integration on both bodies differ, and springs that alone take the difference let the bodies move by it.
    Unbalanced {
        /// The tie or contact.
        of: Subject,
        /// The motion of the bodies \[unit of u\].
        moved: f64,
    },
    /// Pieces of the exact solution meet so near to a slave side that it is open which one is its own: lambda has no error there.
    LeftOpen {
        /// The tie or contact.
        of: Subject,
    },
    /// A contact slides along a curved surface so far that its gap along the normal at rest is wrong by more than 0.1 of what is closed.
    Sliding {
        /// The contact.
        of: Subject,
        /// The mean distance neglected over the closing distance.
        error: f64,
    },
    /// The condition number κ of the system lets rounding be wrong by κ ε / 2 > 1e-6 of the solution, ε the rounding of a double.
    Rounding {
        /// The body of the largest modulus.
        of: Subject,
        /// The body of the least modulus.
        soft: Subject,
        /// The largest modulus over the least.
        contrast: f64,
        /// κ.
        condition: f64,
        /// κ ε / 2.
        error: f64,
    },
    /// Fewer than 4 functions of the slave lie across a contact zone in a direction in which it ends within the side; other numbers in half
    /// models and from an axis of revolution on.
    CoarseZone {
        /// The contact.
        of: Subject,
        /// Number of functions that are closed.
        closed: usize,
        /// On surfaces the number of functions across the zone, from their second moments, in the direction in which it is least; where the
        /// opponent ends within the functions that carry the zone, from their number and the share of them that faces it. `None` of other
        /// zones of curves, and where none is closed.
        across: Option<f64>,
        /// The least number without a warning, across the zone where that is given.
        least: usize,
    },
    /// Slave elements of a contact of which the pieces of integration cover not all, or a part twice, though the opponent faces all of them,
    /// and their gap is not beyond what the largest displacements close: kinked facets across gaps. What is lost carries no pressure.
    LostParts {
        /// The contact.
        of: Subject,
        /// Number of these elements.
        elements: usize,
        /// A place in the first of them.
        x: [f64; 3],
    },
    /// A tie over a gap loses a moment of more than 1e-3 of its force times half the size of the slave side.
    LostMoment {
        /// The tie.
        of: Subject,
        /// The largest distance of its sides \[length\].
        apart: f64,
        /// The moment [force length].
        moment: f64,
        /// The moment over the force times half the size.
        share: f64,
    },
    /// A penalty that lets bodies of a contact sink into each other, or sides of a tie come apart in the mean over every function of the
    /// multiplier, by more than 1e-2 of the smaller body's size, or 0.1 of the largest displacement of these bodies.
    SoftPenalty {
        /// The tie or contact.
        of: Subject,
        /// The depth of a contact, the mean distance of a tie \[length\].
        apart: f64,
        /// Size of the smaller body \[length\].
        size: f64,
        /// The largest component of the displacement of these bodies \[length\].
        moved: f64,
    },
    /// Sides of a tie that come apart between the functions of its multiplier, where no row holds them, by more than 0.1 of the largest
    /// displacement of its bodies: the slave's elements are too coarse.
    CoarseTie {
        /// The tie.
        of: Subject,
        /// Root mean square of the jump that rows do not see \[length\].
        apart: f64,
        /// The largest component of the displacement of these bodies \[length\].
        moved: f64,
    },
    /// Pressures of a contact at points, lambda = sigma + γ g, of which γ g is more than 0.15 of the largest: the bodies' stress says otherwise.
    GapPressure {
        /// The contact.
        of: Subject,
        /// The pressure where this part is largest \[force/area\].
        pressure: f64,
        /// The part -γ g of it; the rest is the normal stress of the bodies \[force/area\].
        from_gap: f64,
        /// The gap g there \[length\].
        gap: f64,
        /// The point.
        x: Vec<f64>,
    },
    /// Facets of sides that points see as waves: flattening them takes more than 0.15 of the largest pressure of a contact.
    WavyFacets {
        /// The contact.
        of: Subject,
        /// Height of the waves, the sum of the greatest deviations of both sides \[length\].
        height: f64,
        /// The pressure that flattens them \[force/area\].
        wave: f64,
        /// The largest pressure \[force/area\].
        pressure: f64,
    },
    /// A contact whose cone holds means or single points alone pulls at others with more than 0.2 of its largest pressure.
    Tension {
        /// The contact.
        of: Subject,
        /// The least pressure, negative \[force/area\].
        least: f64,
        /// The largest pressure \[force/area\].
        largest: f64,
    },
    /// A part of a contact's slave side is held inside of what it faces, deeper than a tenth of the largest displacement.
    HeldWithin {
        /// The contact.
        of: Subject,
        /// The largest depth at a point of the integration \[length\].
        depth: f64,
        /// The point.
        x: Vec<f64>,
    },
    /// A contact closes gaps or overlaps at rest that facets do not explain.
    Adjusted {
        /// The contact.
        of: Subject,
        /// Mean distance of the surfaces that is closed \[length\].
        mean: f64,
        /// The part of it that facets explain \[length\].
        explained: f64,
    },
    /// Functions of degree 1 with a material that hardly changes its volume: the body is too stiff.
    Locking {
        /// The body.
        of: Subject,
        /// Stiffness against a change of volume over that against one of shape.
        ratio: f64,
    },
    /// Prescribed values that the functions of a side hold badly.
    CoarseValues {
        /// The statement.
        of: Statement,
        /// Label of the side.
        side: String,
        /// The component.
        component: usize,
        /// The time at which they are held worst.
        t: f64,
        /// |g - g_h| / |g| of the values g and what the functions have of them, in L2 over the side.
        error: f64,
    },
    /// Strains or rotations beyond 0.1 in more than 1e-2 of a body: small kinematics do not hold.
    Kinematics {
        /// The body.
        of: Subject,
        /// Strains, where they are too large.
        strain: Option<Beyond>,
        /// Rotations \[radians\], where they are too large.
        rotation: Option<Beyond>,
        /// The largest strain and rotation of small kinematics.
        allowed: f64,
    },
}

impl Warning {
    /// The body, tie or contact that it is about, if it is one.
    pub fn subject(&self) -> Option<&Subject> {
        match self {
            Self::Overlap { of, .. }
            | Self::TooFewFunctions { of, .. }
            | Self::ThinCells { of, .. }
            | Self::PatchTest { of, .. }
            | Self::PartUncovered { of, .. }
            | Self::Facets { of, .. }
            | Self::DualConstants { of, .. }
            | Self::MixedMultiplier { of, .. }
            | Self::RoundKink { of, .. }
            | Self::UnevenGap { of, .. }
            | Self::HardlyHeld { of, .. }
            | Self::FluxJump { of, .. }
            | Self::Adjusted { of, .. }
            | Self::Locking { of, .. }
            | Self::Integration { of, .. }
            | Self::Unbalanced { of, .. }
            | Self::LeftOpen { of }
            | Self::Sliding { of, .. }
            | Self::Rounding { of, .. }
            | Self::CoarseZone { of, .. }
            | Self::LostMoment { of, .. }
            | Self::LostParts { of, .. }
            | Self::SoftPenalty { of, .. }
            | Self::CoarseTie { of, .. }
            | Self::GapPressure { of, .. }
            | Self::WavyFacets { of, .. }
            | Self::Tension { of, .. }
            | Self::HeldWithin { of, .. }
            | Self::Kinematics { of, .. } => Some(of),
            Self::CornerValues { .. } | Self::FacetsApart(_) | Self::Inexact(_) | Self::CoarseValues { .. } => None,
        }
    }

    /// Whether both are of one kind and about one body, tie or contact, whatever their figures are.
    pub fn repeats(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other) && self.subject().is_some() && self.subject() == other.subject()
    }
}
