//! Content of a picture of fields.

use crate::marks::{Mark, RigidPicture};

/// Content of the picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct FieldPlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// Label of the colour bar.
    pub label: &'a str,
    /// Name of a field of every part.
    pub field: &'a str,
    /// Component of it; `None`: the root of the sum of their squares.
    pub component: Option<usize>,
    /// Least and largest value that the colours and the heading show; `None`: those of the points of the picture.
    pub range: Option<[f64; 2]>,
    /// Unit of lengths; empty: none is shown.
    pub length: &'a str,
    /// Factor of the displacements, a field of every part, by which the bodies are moved; 0: at rest.
    pub moved: f64,
    /// Supports and loads.
    pub marks: &'a [Mark],
    /// Rigid obstacles.
    pub obstacles: &'a [RigidPicture],
}
