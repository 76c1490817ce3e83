//! A map asked at the same points of many elements: functions of a reference cell are tabulated once.

use super::{Control, Geometry, MapTable, combine};
use crate::basis::{Order, ShapeTable};
use crate::linalg::{Real, Vector};

/// Tables kept at most: more reference cells have nothing in common.
const KEPT: usize = 64;

/// A geometry with the tables of its map at sets of points, one per reference cell and set.
#[derive(Debug)]
pub(crate) struct Sampler<'a, const D: usize, const N: usize, T: Real, G: ?Sized> {
    geometry: &'a G,
    control: Option<Control<'a, D, N, T>>,
    order: Order,
    kept: Vec<(Key, ShapeTable<D, T>)>,
    ids: Vec<usize>,
}

/// Reference cell and set of points.
type Key = (usize, usize);

impl<'a, const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized> Sampler<'a, D, N, T, G> {
    /// Maps of `geometry` up to `order`.
    pub fn new(geometry: &'a G, order: Order) -> Self {
        Self { geometry, control: geometry.control(), order, kept: Vec::new(), ids: Vec::new() }
    }

    /// What [`Geometry::map`] says at `xi`, the points that the caller numbers `set`: the same for all calls with that number.
    pub fn map(&mut self, element: usize, set: usize, xi: &[Vector<D, T>], table: &mut MapTable<D, N, T>) {
        match self.known(element, set, xi) {
            Some((control, k)) => {
                control.basis.active(element, &mut self.ids);
                combine(control.points, &self.ids, &self.kept[k].1, xi.len(), self.order, table);
            }
            None => self.geometry.map(element, xi, self.order, table),
        }
    }

    /// Functions and points of the map, and which of the tables is that of `element`; `None` where tables differ from element to element.
    fn known(&mut self, element: usize, set: usize, xi: &[Vector<D, T>]) -> Option<(Control<'a, D, N, T>, usize)> {
        let control = self.control?;
        let key = (control.basis.reference(element)?, set);
        if let Some(k) = self.kept.iter().position(|(known, _)| *known == key) {
            return Some((control, k));
        }
        if self.kept.len() == KEPT {
            return None;
        }
        let mut shapes = ShapeTable::new();
        control.basis.tabulate(element, xi, self.order, &mut shapes);
        self.kept.push((key, shapes));
        Some((control, self.kept.len() - 1))
    }
}
