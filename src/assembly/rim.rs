//! Values prescribed along edges and in corners of bodies, and at points, edges and faces of their elements.
//!
//! The functions of an edge or a corner are those that all its sides share, those of points, edges and faces do not vanish there. Data on an edge are projected (L2) along it, data
//! in a corner are one value. Sides take precedence over edges; corners determine the functions that are left.

use super::dirichlet::{DirichletError, EQUAL_VALUES, Prescribed};
use super::rules::rule;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::{Embedding, MapTable, cell};
use crate::linalg::{LinearError, LinearSolver, Matrix, Real, Triplets, Vector, lit, measure, to_f64};
use crate::quadrature::{Quadrature, gauss_legendre};
use crate::space::{Space, Submesh, Trace};
use std::fmt::Debug;

/// Functions with less than this value at a point count as zero there.
const NO_VALUE: f64 = 1e-10;

/// Points of an edge or a corner, or of points, edges or faces of elements, with the functions of the body that do not vanish there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rim<const N: usize, T: Real = f64> {
    /// 2 for faces, 1 for an edge, 0 for a corner.
    pub dimension: usize,
    /// Positions \[length\].
    pub x: Vec<Vector<N, T>>,
    /// Weight of each: ds along an edge \[length\], dA on a face \[area\], 1 in a corner; 0 at the ends of edges and the corners of faces,
    /// where values are only compared.
    pub weight: Vec<T>,
    /// (function, value) of those that do not vanish, per point.
    pub shapes: Vec<Vec<(usize, T)>>,
}

impl<const N: usize, T: Real> Rim<N, T> {
    /// Builds the edge or corner common to `side` and all of `others`: with one other side an edge of a body in space or a corner
    /// of one in the plane, with two a corner in space. Empty if they share no functions along an edge or in a corner.
    ///
    /// # Panics
    /// Unless the number of `others` is S or S - 1, at least 1.
    pub fn shared<const S: usize>(side: &Trace<S, N, T>, others: &[&Trace<S, N, T>], extra_points: usize) -> Self {
        assert!(!others.is_empty() && others.len() <= S && S - others.len() <= 1, "sides of a corner or an edge");
        let sorted: Vec<Vec<usize>> = others
            .iter()
            .map(|t| {
                let mut dofs = t.dofs.clone();
                dofs.sort_unstable();
                dofs
            })
            .collect();
        let of_all = |f: &(usize, T)| sorted.iter().all(|dofs| dofs.binary_search(&f.0).is_ok());
        let mut rim = Self { dimension: S - others.len(), x: Vec::new(), weight: Vec::new(), shapes: Vec::new() };
        let (space, mut ids, mut table, mut map) = (&*side.space, Vec::new(), ShapeTable::new(), MapTable::new());
        for e in 0..space.num_elements() {
            space.active(e, &mut ids);
            let corners = cell::corners::<S, T>(space.cell(e));
            let points = |line: Option<(usize, usize)>| -> (Vec<Vector<S, T>>, Vec<T>, Vector<S, T>) {
                let Some((a, b)) = line else { return (corners.clone(), vec![T::one(); corners.len()], Vector::zeros()) };
                let degree = space.degree(e).into_iter().max().unwrap_or(1);
                let rule = gauss_legendre::<T>(degree + 1 + extra_points);
                let along = corners[b] - corners[a];
                let inside = rule.points.iter().map(|t| corners[a] + along * t[0]);
                let xi = [corners[a], corners[b]].into_iter().chain(inside).collect();
                (xi, [T::zero(); 2].into_iter().chain(rule.weights.iter().copied()).collect(), along)
            };
            let lines: Vec<Option<(usize, usize)>> = match rim.dimension {
                0 => vec![None],
                _ => cell::faces::<S, T>(space.cell(e)).iter().map(|f| Some((f.corners[0], f.corners[f.corners.len() - 1]))).collect(),
            };
            for line in lines {
                let (xi, weights, along) = points(line);
                space.evaluate(e, &xi, Order::Gradients, &mut table, &mut map);
                let alive = |q: usize| -> Vec<(usize, T)> {
                    let all = ids.iter().zip(table.values(q)).filter(|(_, v)| v.abs() > lit(NO_VALUE));
                    all.map(|(&i, &v)| (side.dofs[i], v)).collect()
                };
                let shapes: Vec<Vec<(usize, T)>> = (0..xi.len()).map(alive).collect();
                if rim.dimension == 1 && !shapes.iter().flatten().all(of_all) {
                    continue;
                }
                for (q, list) in shapes.into_iter().enumerate() {
                    // one corner of several elements counts once
                    if rim.dimension == 0 && (!list.iter().all(of_all) || rim.shapes.contains(&list)) {
                        continue;
                    }
                    let stretch = if rim.dimension == 0 { T::one() } else { (map.jacobian[q] * along).norm() };
                    rim.x.push(map.x[q]);
                    rim.weight.push(weights[q] * stretch);
                    rim.shapes.push(list);
                }
            }
        }
        rim
    }

    /// Builds the points of a submesh of a body with the space `space`: of edges and faces their corners and Gauss points, degree + 1 +
    /// `extra_points` per direction.
    pub fn of_submesh(space: &dyn Space<N, N, T>, submesh: &Submesh<N, T>, extra_points: usize) -> Self {
        let mut rim = Self { dimension: submesh.dimension, x: Vec::new(), weight: Vec::new(), shapes: Vec::new() };
        for (element, corners) in &submesh.cells {
            match submesh.dimension {
                0 => rim.add(space, *element, corners, &|_| T::one()),
                1 => rim.add_cell::<1>(space, *element, corners, extra_points),
                _ => rim.add_cell::<2>(space, *element, corners, extra_points),
            }
        }
        rim
    }

    /// Adds the corners of an edge or a face of an element, with weight 0, and its Gauss points.
    fn add_cell<const D: usize>(&mut self, space: &dyn Space<N, N, T>, element: usize, corners: &[Vector<N, T>], extra_points: usize) {
        let kind = if D == 2 && corners.len() == 3 { Cell::Simplex } else { Cell::Tensor };
        let axes = Matrix::<N, D, T>::from_fn(|k, s| (corners[if kind == Cell::Tensor { 1 << s } else { s + 1 }] - corners[0])[k]);
        let embedding = Embedding { element, origin: corners[0], axes };
        let degree = space.degree(element).into_iter().max().unwrap_or(1);
        let rules = rule::<D, T>(kind, [degree; D], [extra_points; D]);
        let rule = rules.rule(0);
        self.add(space, element, corners, &|_| T::zero());
        let inside: Vec<Vector<N, T>> = rule.points.iter().map(|xi| embedding.lift(xi)).collect();
        let first = self.weight.len();
        self.add(space, element, &inside, &|jacobian| measure(&(jacobian * axes)));
        self.weight[first..].iter_mut().zip(&rule.weights).for_each(|(w, v)| *w *= *v);
    }

    /// Adds points of an element, each with the weight that `weight` makes of the Jacobian of the map there.
    fn add(&mut self, space: &dyn Space<N, N, T>, element: usize, xi: &[Vector<N, T>], weight: &dyn Fn(&Matrix<N, N, T>) -> T) {
        let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
        space.active(element, &mut ids);
        space.evaluate(element, xi, Order::Gradients, &mut table, &mut map);
        for q in 0..xi.len() {
            let all = ids.iter().zip(table.values(q)).filter(|(_, v)| v.abs() > lit(NO_VALUE));
            self.x.push(map.x[q]);
            self.weight.push(weight(&map.jacobian[q]));
            self.shapes.push(all.map(|(&i, &v)| (i, v)).collect());
        }
    }

    /// The functions of the body that do not vanish here, ascending.
    pub fn functions(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.shapes.iter().flatten().map(|f| f.0).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// A component prescribed on an edge, in a corner, or at points, edges or faces of elements.
#[derive(Clone, Copy)]
pub struct Pinned<'a, const N: usize, T: Real = f64> {
    /// The place.
    pub rim: &'a Rim<N, T>,
    /// The component.
    pub component: usize,
    /// Its value at a physical point; `None` is exactly zero, imposed before any projection.
    pub value: Option<&'a (dyn Fn(&Vector<N, T>) -> T + Sync)>,
}

impl<const N: usize, T: Real> Debug for Pinned<'_, N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pinned").field("rim", self.rim).field("component", &self.component).finish_non_exhaustive()
    }
}

impl<const N: usize, T: Real> Pinned<'_, N, T> {
    pub(super) fn at(&self, x: &Vector<N, T>) -> T {
        self.value.map_or_else(T::zero, |value| value(x))
    }
}

/// Adds the values of `pinned`, all of one component, to `found` (ascending by function), which holds those of the sides.
pub(super) fn project<const N: usize, T: Real>(
    pinned: &[(usize, Pinned<'_, N, T>)],
    found: &mut Vec<(usize, T)>,
    solver: &mut dyn LinearSolver<T>,
) -> Result<(), LinearError> {
    for dimension in [2, 1, 0] {
        let mine: Vec<&Pinned<'_, N, T>> = pinned.iter().map(|p| &p.1).filter(|p| p.rim.dimension == dimension).collect();
        for p in mine.iter().filter(|p| p.value.is_none()) {
            let known = std::mem::take(found);
            let new = p.rim.functions().into_iter().filter(|f| known.binary_search_by_key(f, |k| k.0).is_err()).map(|f| (f, T::zero()));
            *found = known.iter().copied().chain(new).collect();
            found.sort_by_key(|f| f.0);
        }
        let known = |f: usize| found.binary_search_by_key(&f, |k| k.0).ok().map(|k| found[k].1);
        let mut free: Vec<usize> = mine.iter().flat_map(|p| p.rim.functions()).filter(|&f| known(f).is_none()).collect();
        free.sort_unstable();
        free.dedup();
        if free.is_empty() {
            continue;
        }
        let mut matrix = Triplets::new(free.len(), free.len());
        let mut rhs = vec![T::zero(); free.len()];
        for p in &mine {
            for ((x, &w), shapes) in p.rim.x.iter().zip(&p.rim.weight).zip(&p.rim.shapes).filter(|((_, w), _)| **w > T::zero()) {
                let rest = shapes.iter().fold(p.at(x), |s, &(f, n)| s - known(f).map_or_else(T::zero, |c| c * n));
                let mine = || shapes.iter().filter_map(|&(f, n)| free.binary_search(&f).ok().map(|i| (i, n)));
                for (i, a) in mine() {
                    rhs[i] += w * rest * a;
                    for (j, b) in mine() {
                        matrix.push(i, j, w * a * b);
                    }
                }
            }
        }
        let matrix = matrix.to_csr();
        let mut solution = vec![T::zero(); free.len()];
        solver.prepare(&matrix)?;
        solver.solve(&matrix, &rhs, &mut solution)?;
        found.extend(free.into_iter().zip(solution));
        found.sort_by_key(|f| f.0);
    }
    Ok(())
}

/// Compares data of edges and corners with that of sides, edges and corners that hold all functions of one of its points.
pub(super) fn conflicts<const S: usize, const N: usize, T: Real>(
    component: usize,
    sides: &[(usize, Prescribed<'_, S, N, T>)],
    pinned: &[(usize, Pinned<'_, N, T>)],
    largest: T,
) -> Result<(), DirichletError> {
    let sorted = |mut list: Vec<usize>| {
        list.sort_unstable();
        list
    };
    let mut others: Vec<(usize, Vec<usize>, Option<&(dyn Fn(&Vector<N, T>) -> T + Sync)>)> = Vec::new();
    others.extend(sides.iter().map(|(k, f)| (*k, sorted(f.trace.dofs.clone()), f.value)));
    others.extend(pinned.iter().map(|(k, p)| (*k, p.rim.functions(), p.value)));
    for (k, p) in pinned {
        for (first, functions, value) in others.iter().filter(|o| o.0 < *k) {
            // corners and the ends of edges: between them both are projected
            let compared = (0..p.rim.x.len()).filter(|&q| p.rim.dimension == 0 || p.rim.weight[q] == T::zero());
            for q in compared.filter(|&q| p.rim.shapes[q].iter().all(|(f, _)| functions.binary_search(f).is_ok())) {
                let x = p.rim.x[q];
                let (a, b) = (value.map_or_else(T::zero, |value| value(&x)), p.at(&x));
                if (a - b).abs() > lit::<T>(EQUAL_VALUES) * largest.max(a.abs()) {
                    return Err(DirichletError::Conflict {
                        component,
                        first: *first,
                        second: *k,
                        at: std::array::from_fn(|i| if i < N { to_f64(x[i]) } else { 0.0 }),
                        first_value: to_f64(a),
                        second_value: to_f64(b),
                    });
                }
            }
        }
    }
    Ok(())
}
