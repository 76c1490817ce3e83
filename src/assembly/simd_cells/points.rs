//! Tables at the points of a rule on a reference cell, and the elements that share them.

use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, to_f64};
use crate::quadrature::Rule;
use std::collections::HashMap;
use std::hash::Hash;

/// Maximum number of kinds of elements with tables.
const KINDS: usize = 32;

/// Key of elements with common tables: reference cells of functions and map, the address of the rule.
pub(super) type Key = (usize, usize, usize);

/// The key of `element`, whose functions have the reference cell `reference`; `None` if its map has none.
pub(super) fn key<const D: usize, T: Real>(reference: usize, map: &dyn Basis<D, T>, element: usize, rule: &Rule<D, T>) -> Option<Key> {
    Some((reference, map.structure().reference(element)?, std::ptr::from_ref(rule).addr()))
}

/// Map from a few keys to data, in order of insertion.
#[derive(Debug)]
pub(super) struct Kinds<K, X> {
    known: HashMap<K, usize>,
    /// Data of each key, in order of insertion.
    pub of: Vec<X>,
    /// Key and place of the last look-up, which the next mostly repeats.
    last: Option<(K, usize)>,
}

impl<K, X> Default for Kinds<K, X> {
    fn default() -> Self {
        Self { known: HashMap::new(), of: Vec::new(), last: None }
    }
}

impl<K: Copy + Eq + Hash, X> Kinds<K, X> {
    /// The place of `key`, with data from `new` on its first look-up; `None` if `new` returns `None`.
    pub fn place(&mut self, key: K, new: impl FnOnce(usize) -> Option<X>) -> Option<usize> {
        if let Some((_, place)) = self.last.filter(|(last, _)| *last == key) {
            return Some(place);
        }
        let place = match self.known.get(&key) {
            Some(&place) => place,
            None => {
                let place = self.of.len();
                self.of.push(new(place)?);
                self.known.insert(key, place);
                place
            }
        };
        self.last = Some((key, place));
        Some(place)
    }
}

/// Elements with common tables, in the order in which they are added.
#[derive(Debug)]
pub(super) struct SameTables<X, M> {
    pub tables: X,
    pub members: Vec<M>,
}

impl<X, M> Kinds<Key, SameTables<X, M>> {
    /// Adds `member` to the group of `key`; `None` if there are too many kinds, or no tables.
    pub fn put(&mut self, key: Key, member: M, tables: impl FnOnce() -> Option<X>) -> Option<()> {
        let new = |k: usize| if k < KINDS { Some(SameTables { tables: tables()?, members: Vec::new() }) } else { None };
        let place = self.place(key, new)?;
        self.of[place].members.push(member);
        Some(())
    }
}

/// Functions, map and rule on a reference cell, `[point * functions + a]` and `[point * nodes + b]`.
#[derive(Debug)]
pub(super) struct PointTables<const D: usize> {
    /// Functions per element.
    pub functions: usize,
    /// Functions of the map per element.
    pub nodes: usize,
    /// Local points, D numbers each.
    pub xi: Vec<f64>,
    pub weights: Vec<f64>,
    pub values: Vec<f64>,
    pub grads: Vec<[f64; D]>,
    pub map_values: Vec<f64>,
    pub map_grads: Vec<[f64; D]>,
}

impl<const D: usize> PointTables<D> {
    /// The tables of `element` for all of its kind; `None` if they are empty.
    pub fn new<T: Real, B: Basis<D, T> + ?Sized>(basis: &B, map: &dyn Basis<D, T>, element: usize, rule: &Rule<D, T>) -> Option<Self> {
        let (mut shapes, mut nodes) = (ShapeTable::new(), ShapeTable::new());
        basis.tabulate(element, &rule.points, Order::Gradients, &mut shapes);
        map.tabulate(element, &rule.points, Order::Gradients, &mut nodes);
        let points = rule.points.len();
        let values = |table: &ShapeTable<D, T>| (0..points).flat_map(|q| table.values(q).to_vec()).map(to_f64).collect();
        let grads = |table: &ShapeTable<D, T>| {
            (0..points).flat_map(|q| table.grads(q).to_vec()).map(|g| std::array::from_fn(|k| to_f64(g[k]))).collect()
        };
        let tables = Self {
            functions: shapes.num_functions(),
            nodes: nodes.num_functions(),
            xi: rule.points.iter().flat_map(|xi| xi.iter().map(|&x| to_f64(x))).collect(),
            weights: rule.weights.iter().map(|&w| to_f64(w)).collect(),
            values: values(&shapes),
            grads: grads(&shapes),
            map_values: values(&nodes),
            map_grads: grads(&nodes),
        };
        (points > 0 && tables.functions > 0 && tables.nodes > 0).then_some(tables)
    }
}
