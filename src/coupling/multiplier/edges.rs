//! Surfaces that are a product of two directions, and the edges at which their multipliers are lowered.

use super::side_ends;
use crate::basis::{Basis, Extracted, Order, Polynomials, ShapeTable, TensorProduct};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit, to_f64};
use std::borrow::Cow;
use std::collections::HashMap;

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

/// A side whose functions are products of those of two directions, the first one fastest; along an edge that is a pole they are one function.
pub(super) struct Grid<'a, T: Real> {
    axes: [&'a dyn Basis<1, T>; 2],
    /// The function of the side that every product is part of.
    ids: Cow<'a, [usize]>,
    /// Per direction the functions that do not vanish at its beginning and at its end; none where it is closed.
    at_end: [[Vec<usize>; 2]; 2],
    /// Whether the edges `[direction][end]` are poles.
    poles: [[bool; 2]; 2],
}

impl<'a, T: Real> Grid<'a, T> {
    /// The directions of a side; `None` if its functions are no such products, or joined in another way.
    pub fn of(basis: &'a dyn Basis<2, T>) -> Option<Self> {
        let structure = basis.structure();
        let (block, ids) = match structure.patches().as_deref() {
            Some([patch]) => (patch.block, patch.ids.clone()),
            Some(_) => return None,
            None => (structure.block(0)?, (0..basis.num_functions()).collect()),
        };
        let count = |of: fn(&dyn Basis<1, T>) -> usize| block.axes.iter().map(|axis| of(*axis)).product::<usize>();
        let whole = block.first == 0 && count(|axis| axis.num_elements()) == basis.num_elements();
        if !whole || count(|axis| axis.num_functions()) != ids.len() {
            return None;
        }
        let mut grid = Self { axes: block.axes, ids, at_end: block.axes.map(at_ends), poles: [[false; 2]; 2] };
        for (k, end) in ALL {
            grid.poles[k][end] = grid.is_pole(k, end);
        }
        (numbers(grid.axes, grid.poles)?.1 == basis.num_functions()).then_some(grid)
    }

    /// Whether all products at an end of direction `k` are one function.
    fn is_pole(&self, k: usize, end: usize) -> bool {
        let [at] = self.at_end[k][end][..] else { return false };
        let n = self.axes[1 - k].num_functions();
        n > 1 && (1..n).all(|other| self.function(k, at, other) == self.function(k, at, 0))
    }

    /// The product of `axes`, which are those of the side, lowered at `edges`. What is one function of the side is one function here, but for
    /// poles among the `edges`.
    pub fn product(&self, axes: [Box<dyn Basis<1, T>>; 2], edges: [[bool; 2]; 2]) -> Option<Box<dyn Basis<2, T>>> {
        let mut poles = self.poles;
        ALL.into_iter().for_each(|(k, end)| poles[k][end] &= !edges[k][end]);
        let (numbers, functions) = numbers(axes.each_ref().map(|axis| &**axis), poles)?;
        let product = TensorProduct::new(axes);
        Some(if functions == numbers.len() {
            Box::new(product)
        } else {
            Box::new(Extracted::new::<2>(product, functions, numbers.into_iter().map(|k| vec![(k, T::one())]).collect()))
        })
    }

    /// The polynomials of both directions.
    pub fn polynomials(&self, wanted: Polynomials) -> Option<[Box<dyn Basis<1, T>>; 2]> {
        let [first, second] = self.axes.map(|axis| axis.polynomials(wanted));
        Some([first?, second?])
    }

    /// All edges `[direction][end]`: a closed direction has none.
    pub fn edges(&self) -> [[bool; 2]; 2] {
        self.at_end.each_ref().map(|ends| ends.each_ref().map(|at| !at.is_empty()))
    }

    /// The edges `[direction][end]` on which functions are constrained.
    ///
    /// One constrained function within an edge is enough, or that of a pole. A constrained corner alone stands for the shorter one of its two edges.
    pub fn constrained_edges<const N: usize>(&self, side: &dyn Geometry<2, N, T>, constrained: &dyn Fn(usize) -> bool) -> [[bool; 2]; 2] {
        let mut edges = [[false; 2]; 2];
        for (k, end) in ALL {
            let on = |other: usize| self.at_end[k][end].iter().any(|&at| constrained(self.function(k, at, other)));
            edges[k][end] = self.within(k).any(on) || self.poles[k][end] && on(0);
        }
        let corner = |ends: [usize; 2]| {
            self.at_end[0][ends[0]].iter().any(|&i| self.at_end[1][ends[1]].iter().any(|&j| constrained(self.function(0, i, j))))
        };
        let alone = |ends: [usize; 2], edges: &[[bool; 2]; 2]| corner(ends) && !edges[0][ends[0]] && !edges[1][ends[1]];
        // edges without functions of their own are held by both of their corners
        for (k, end) in ALL.into_iter().filter(|&(k, _)| self.within(k).next().is_none()) {
            let ends = |other: usize| if k == 0 { [end, other] } else { [other, end] };
            edges[k][end] |= [0, 1].into_iter().all(|other| alone(ends(other), &edges));
        }
        for ends in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            if alone(ends, &edges) {
                let shorter = usize::from(self.length(side, 1, ends[1]) < self.length(side, 0, ends[0]));
                edges[shorter][ends[shorter]] = true;
            }
        }
        edges
    }

    /// The side's function that holds the product of function `at` of direction `k` and function `other` of the other one.
    fn function(&self, k: usize, at: usize, other: usize) -> usize {
        let [i, j] = if k == 0 { [at, other] } else { [other, at] };
        self.ids[i + self.axes[0].num_functions() * j]
    }

    /// Functions along the edges at the ends of direction `k` that vanish at the corners.
    fn within(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        let at_corners = &self.at_end[1 - k];
        (0..self.axes[1 - k].num_functions()).filter(move |i| !at_corners.iter().any(|at| at.contains(i)))
    }

    /// Length of the edge at an end of direction `k`, by chords of half elements.
    fn length<const N: usize>(&self, side: &dyn Geometry<2, N, T>, k: usize, end: usize) -> f64 {
        let last = if end == 0 { 0 } else { self.axes[k].num_elements() - 1 };
        let xi = [0.0, 0.5, 1.0].map(|t| {
            let mut xi = Vector::<2, T>::repeat(lit(t));
            xi[k] = lit(end as f64);
            xi
        });
        let mut map = MapTable::new();
        let mut chords = |along: usize| {
            let [i, j] = if k == 0 { [last, along] } else { [along, last] };
            side.map(i + self.axes[0].num_elements() * j, &xi, Order::Values, &mut map);
            map.x.windows(2).map(|x| to_f64((x[1] - x[0]).norm())).sum::<f64>()
        };
        (0..self.axes[1 - k].num_elements()).map(&mut chords).sum()
    }
}

/// Both ends of both directions.
pub(super) const ALL: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];

/// Numbers of the products of `axes` if those along each of `poles` are one function, and their count.
fn numbers<T: Real>(axes: [&dyn Basis<1, T>; 2], poles: [[bool; 2]; 2]) -> Option<(Vec<usize>, usize)> {
    let mut at = Vec::new();
    for (k, end) in ALL.into_iter().filter(|&(k, end)| poles[k][end]) {
        let [function] = at_ends(axes[k])[end][..] else { return None };
        at.push((k, function));
    }
    let mut first = HashMap::new();
    let mut number = |mut place: [usize; 2]| {
        for &(k, function) in &at {
            if place[k] == function {
                place[1 - k] = 0;
            }
        }
        let next = first.len();
        *first.entry(place).or_insert(next)
    };
    let [m, n] = axes.map(|axis| axis.num_functions());
    let numbers = (0..m * n).map(|product| number([product % m, product / m])).collect();
    Some((numbers, first.len()))
}

/// The functions that do not vanish at the beginning and at the end of an axis.
fn at_ends<T: Real>(axis: &dyn Basis<1, T>) -> [Vec<usize>; 2] {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    let mut found = [Vec::new(), Vec::new()];
    let ends = side_ends(axis);
    for (found, end) in found.iter_mut().zip(ends.iter().filter(|_| ends.len() == 2)) {
        axis.active(end.element, &mut ids);
        axis.tabulate(end.element, &[Vector::<1, T>::new(lit(end.at as f64))], Order::Values, &mut table);
        found.extend(ids.iter().zip(table.values(0)).filter(|(_, v)| to_f64(v.abs()) > NO_VALUE).map(|(&i, _)| i));
    }
    found
}
