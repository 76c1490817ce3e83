//! Errors of multiplier spaces.

/// Error when a multiplier space does not exist or cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MultiplierError {
    /// The name is not known.
    #[error("unknown multiplier \"{name}\"; known: {known}")]
    Unknown {
        /// The name.
        name: String,
        /// The known names.
        known: &'static str,
    },
    /// The slave side has no such space.
    #[error("there is no multiplier \"{wanted}\" with degree {degree}; this side has {known}")]
    NotHere {
        /// The name or the data given.
        wanted: String,
        /// Degree of the slave side.
        degree: usize,
        /// Multipliers available on this side.
        known: String,
    },
    /// The functions of the slave side have no dual ones.
    #[error("there is no multiplier \"dual\" here: {reason}; this side has {known}")]
    NoDual {
        /// Cause and position.
        reason: String,
        /// Multipliers available on this side.
        known: String,
    },
    /// Dual multipliers on surfaces of revolution, whose weights 2 pi r are not those of the curve.
    #[error("dual multipliers on surfaces of revolution are not in this version")]
    Revolution,
    /// The degree cannot be lowered at an end.
    #[error(
        "the multiplier has degree {degree} on element {element} at the end of the side, too little to be lowered there; refine the side"
    )]
    NothingLeft {
        /// The element at the end.
        element: usize,
        /// Its degree.
        degree: usize,
    },
    /// The degree cannot be lowered at an edge of a surface.
    #[error(
        "the multiplier has degree {degree} across the edge of the side {}, too little to be lowered there; refine the side in that direction",
        edge(*.axis, *.end)
    )]
    NothingLeftAtEdge {
        /// The direction across the edge, 0 or 1.
        axis: usize,
        /// The end of that direction, 0 or 1.
        end: usize,
        /// The degree in that direction.
        degree: usize,
    },
    /// No function is left to which constrained functions of a surface could give their multipliers.
    #[error("every function of the side is constrained, none is left to which the multiplier could be passed on; refine the side")]
    NothingFree,
    /// More multipliers than slave unknowns that can carry them.
    #[error(
        "component {component} has {multipliers} multipliers for {free} free unknowns of the slave side; refine the side or take another multiplier"
    )]
    TooMany {
        /// The component.
        component: usize,
        /// Its number of multiplier functions.
        multipliers: usize,
        /// Its number of unknowns on the slave side that are not prescribed.
        free: usize,
    },
}

/// The place of an edge of a surface, in words.
fn edge(axis: usize, end: usize) -> &'static str {
    match (axis, end) {
        (0, 0) => "where its first direction begins",
        (0, _) => "where its first direction ends",
        (_, 0) => "where its second direction begins",
        _ => "where its second direction ends",
    }
}
