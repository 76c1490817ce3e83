//! Corners that prescribed sides of several bodies share.

use crate::linalg::Vector;

/// A corner of a prescribed side in which a side of another body is prescribed, too.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedCorner<const N: usize> {
    /// The condition, by its place in the list of the model.
    pub condition: usize,
    /// The function of the model that lives there.
    pub function: usize,
    /// Its value there.
    pub value: f64,
    /// Its place \[length\].
    pub x: Vector<N>,
    /// The corners of other bodies there, by their places in this list.
    pub others: Vec<usize>,
}
