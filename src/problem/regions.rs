//! The regions of a problem by their numbers, and the sides of its bodies, each made once.

use super::model::{BodyModel, BodyRim, BodySide};
use crate::assembly::{Rim, measure};
use crate::geometry::circumference;
use crate::space::SideError;
use std::collections::HashMap;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// Names of the sides of a body in messages and results, in place of those of the body.
pub type SideNames = Arc<dyn Fn(&str) -> String + Send + Sync>;

/// A piece of a region.
#[derive(Clone, Debug)]
pub(super) enum RegionPart<const S: usize, const N: usize> {
    /// A side or a part of one.
    Side(Arc<BodySide<S, N>>),
    /// An edge or a corner, or points, edges or faces of a mesh that have a name.
    Rim(Arc<BodyRim<N>>),
}

impl<const S: usize, const N: usize> RegionPart<S, N> {
    pub fn label(&self) -> &str {
        match self {
            Self::Side(side) => &side.label,
            Self::Rim(rim) => &rim.label,
        }
    }

    /// Area or length of a side, an edge or a face \[length^dimension\]; number of corners.
    pub fn measure(&self) -> f64 {
        match self {
            Self::Side(side) => measure(&*side.trace.space, &side.rules),
            Self::Rim(rim) => rim.rim.weight.iter().sum(),
        }
    }

    /// The piece of a body of revolution: forces along edges have the weight 2 pi r ds, as those on sides.
    #[must_use]
    pub fn revolved(self) -> Self {
        match self {
            Self::Rim(rim) if rim.rim.dimension == 1 => {
                let mut around = (*rim).clone();
                around.rim.weight.iter_mut().zip(&around.rim.x).for_each(|(w, x)| *w *= circumference(x));
                Self::Rim(Arc::new(around))
            }
            other => other,
        }
    }

    /// Whether both are one piece.
    pub fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Side(a), Self::Side(b)) => Arc::ptr_eq(a, b),
            (Self::Rim(a), Self::Rim(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// The regions of a problem.
#[derive(Clone)]
pub struct Regions<const S: usize, const N: usize> {
    list: Vec<Vec<RegionPart<S, N>>>,
    sides: HashMap<(usize, String), usize>,
    pub(super) rims: HashMap<(usize, String), usize>,
    /// Per body.
    names: Vec<Option<SideNames>>,
}

impl<const S: usize, const N: usize> Debug for Regions<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.list.iter().flatten().map(RegionPart::label)).finish()
    }
}

impl<const S: usize, const N: usize> Default for Regions<S, N> {
    fn default() -> Self {
        Self { list: Vec::new(), sides: HashMap::new(), rims: HashMap::new(), names: Vec::new() }
    }
}

impl<const S: usize, const N: usize> Regions<S, N> {
    /// Adds a body, the next in its list, with the names of its sides.
    pub(super) fn add_body(&mut self, names: Option<SideNames>) {
        self.names.push(names);
    }

    pub(super) fn add(&mut self, pieces: Vec<RegionPart<S, N>>) -> usize {
        self.list.push(pieces);
        self.list.len() - 1
    }

    pub(super) fn pieces(&self, number: usize) -> &[RegionPart<S, N>] {
        &self.list[number]
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// The region of a side, if it was made.
    pub(super) fn known(&self, body: usize, side: &str) -> Option<usize> {
        self.sides.get(&(body, side.to_owned())).copied()
    }

    /// The region of a side, or of points, edges or faces that have a name.
    pub(super) fn number(&mut self, bodies: &[BodyModel<S, N>], body: usize, side: &str) -> Result<usize, SideError> {
        if let Some(known) = self.known(body, side) {
            return Ok(known);
        }
        let label = match &self.names[body] {
            Some(name) => format!("{}.{}", bodies[body].name, name(side)),
            None => format!("{}.{side}", bodies[body].name),
        };
        let made = match (BodySide::new(&bodies[body], body, side, label.clone()), bodies[body].body.submesh(side)) {
            (Ok(made), _) => RegionPart::Side(Arc::new(made)),
            (Err(_), Some(submesh)) => {
                let rim = Rim::of_submesh(&**bodies[body].body.space(), &submesh, bodies[body].extra_points);
                RegionPart::Rim(Arc::new(BodyRim { patch: body, name: side.to_owned(), label, rim }))
            }
            (Err(error), None) => return Err(error),
        };
        let number = self.add(vec![made]);
        self.sides.insert((body, side.to_owned()), number);
        Ok(number)
    }

    /// A side of one of `bodies`, by their numbers.
    ///
    /// # Errors
    /// [`SideError`] of the body.
    pub fn side(&mut self, bodies: &[BodyModel<S, N>], body: usize, side: &str) -> Result<Arc<BodySide<S, N>>, SideError> {
        let number = self.number(bodies, body, side)?;
        match &self.list[number][..] {
            [RegionPart::Side(side)] => Ok(side.clone()),
            _ => {
                let body = &bodies[body].body;
                let unknown = || SideError::Unknown { side: side.to_owned(), known: body.sides().join(", ") };
                Err(body.trace(side).err().unwrap_or_else(unknown))
            }
        }
    }
}
