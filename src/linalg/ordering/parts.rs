//! Sides of a cut, and numbers of vertices.

/// Labels of a cut.
pub(super) const LEFT: u8 = 0;
pub(super) const RIGHT: u8 = 1;
pub(super) const SEPARATOR: u8 = 2;

/// A number of an unknown in 32 bits.
pub(super) fn index(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 unknowns")
}
