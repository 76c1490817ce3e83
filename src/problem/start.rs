//! Choices of the first guess of closed contact rows.

/// First guess of the active set of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// The quarter of the rows with the least gap at rest, at least one per body that contact alone holds.
    #[default]
    Auto,
    /// Every row closed.
    All,
    /// Every row open.
    None,
    /// Rows of initial gap <= 0 closed.
    Gap,
    /// Pseudo-random.
    Seed(u64),
}
