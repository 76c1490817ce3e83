//! Prescribed values: one L2 projection over all sides of a body that have data, with values known beforehand held fixed.

use super::gauss_rules;
use super::rim::{self, Pinned};
use crate::basis::{Order, ShapeTable};
use crate::geometry::{MapTable, cell};
use crate::linalg::{LinearError, LinearSolver, Real, Triplets, Vector, lit, measure, to_f64};
use crate::quadrature::Quadrature;
use crate::space::{Field, Trace};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Debug;

/// A component prescribed on a side.
#[derive(Clone, Copy)]
pub struct Prescribed<'a, const S: usize, const N: usize, T: Real = f64> {
    /// The side.
    pub trace: &'a Trace<S, N, T>,
    /// The component.
    pub component: usize,
    /// Its value at a physical point; `None` is exactly zero, imposed before any projection.
    pub value: Option<&'a (dyn Fn(&Vector<N, T>) -> T + Sync)>,
}

impl<const S: usize, const N: usize, T: Real> Debug for Prescribed<'_, S, N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Fixed").field("trace", self.trace).field("component", &self.component).finish_non_exhaustive()
    }
}

/// Error of prescribing values.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DirichletError {
    /// Two conditions prescribe different values at a common point.
    #[error(
        "component {component} is prescribed twice at {at:?}: {first_value:e} by condition {first} and {second_value:e} by condition {second}; \
         make the values equal or drop one"
    )]
    Conflict {
        /// The component.
        component: usize,
        /// Position of the first condition in the list.
        first: usize,
        /// Position of the second condition in the list.
        second: usize,
        /// Coordinates of the point \[length\], zero beyond the dimension.
        at: [f64; 3],
        /// Value of the first.
        first_value: f64,
        /// Value of the second.
        second_value: f64,
    },
    /// Solving with the mass matrix of the sides failed.
    #[error("projecting the prescribed values of component {component} failed: {source}")]
    Projection {
        /// The component.
        component: usize,
        /// Error of the linear solver.
        source: LinearError,
    },
}

/// Values that differ by less than this, relative to the largest of the field, are equal.
pub(super) const EQUAL_VALUES: f64 = 1e-9;
/// Points closer than this, relative to the extent of the sides, coincide.
const SAME_PLACE: f64 = 1e-9;

/// (unknown, value) of all `conditions` on sides of one body, ascending by unknown.
///
/// Per component one L2 projection over the union of its sides, so that data in the space of the sides is met exactly,
/// corners included. Sides without a value stay zero exactly: their functions are prescribed before the rest is projected.
/// Rules have degree + 1 + `extra_points` points.
///
/// # Errors
/// [`DirichletError::Conflict`] if sides that share a function prescribe different values in a common corner;
/// [`DirichletError::Projection`] if `solver` fails.
pub fn dirichlet<const S: usize, const N: usize, T: Real>(
    conditions: &[Prescribed<'_, S, N, T>],
    field: Field,
    extra_points: usize,
    solver: &mut dyn LinearSolver<T>,
) -> Result<Vec<(usize, T)>, DirichletError> {
    dirichlet_with(conditions, &[], &[], field, extra_points, solver)
}

/// Computes [`dirichlet`] with data on edges and in corners too: they determine the functions that no side prescribes, edges
/// first, by one L2 projection each. `held` lists (unknown, value) known beforehand, which are held fixed in the projections.
///
/// # Errors
/// As [`dirichlet`]; positions in errors count on from the conditions through `pinned`.
pub fn dirichlet_with<const S: usize, const N: usize, T: Real>(
    conditions: &[Prescribed<'_, S, N, T>],
    pinned: &[Pinned<'_, N, T>],
    held: &[(usize, T)],
    field: Field,
    extra_points: usize,
    solver: &mut dyn LinearSolver<T>,
) -> Result<Vec<(usize, T)>, DirichletError> {
    let mut values = Vec::new();
    let largest = largest_value(conditions, pinned);
    for component in 0..field.components {
        let mine: Vec<(usize, Prescribed<'_, S, N, T>)> =
            conditions.iter().copied().enumerate().filter(|(_, f)| f.component == component).collect();
        if mine.iter().any(|(_, f)| f.value.is_some()) {
            conflicts(component, &mine, largest)?;
        }
        let pins: Vec<(usize, Pinned<'_, N, T>)> =
            pinned.iter().copied().enumerate().filter(|(_, p)| p.component == component).map(|(k, p)| (conditions.len() + k, p)).collect();
        rim::conflicts(component, &mine, &pins, largest)?;
        let own = held.iter().map(|&(i, value)| (i - field.first, value)).filter(|(i, _)| i % field.components == component);
        let own: Vec<(usize, T)> = own.map(|(i, value)| (i / field.components, value)).collect();
        let mut found = project(&mine, &own, extra_points, solver).map_err(|source| DirichletError::Projection { component, source })?;
        if !pins.is_empty() {
            found.sort_by_key(|f| f.0);
            rim::project(&pins, &mut found, solver).map_err(|source| DirichletError::Projection { component, source })?;
        }
        values.extend(found.into_iter().map(|(i, value)| (field.unknown(i, component), value)));
    }
    values.sort_by_key(|v| v.0);
    Ok(values)
}

/// The projection of one component on the union of its sides: (function of the body, coefficient), each function once.
fn project<const S: usize, const N: usize, T: Real>(
    conditions: &[(usize, Prescribed<'_, S, N, T>)],
    held: &[(usize, T)],
    extra_points: usize,
    solver: &mut dyn LinearSolver<T>,
) -> Result<Vec<(usize, T)>, LinearError> {
    let moments: Vec<Option<Moments<T>>> = conditions.iter().map(|(_, f)| f.value.map(|v| Moments::of(f.trace, v, extra_points))).collect();
    // zero values come before all others
    let mut known: BTreeMap<usize, T> = held.iter().copied().collect();
    for ((_, f), _) in conditions.iter().zip(&moments).filter(|(_, m)| m.is_none()) {
        known.extend(f.trace.dofs.iter().map(|&dof| (dof, T::zero())));
    }
    let mut functions: Vec<usize> =
        conditions.iter().flat_map(|(_, f)| f.trace.dofs.iter().copied()).filter(|dof| !known.contains_key(dof)).collect();
    functions.sort_unstable();
    functions.dedup();
    let mut matrix = Triplets::new(functions.len(), functions.len());
    let mut rhs = vec![T::zero(); functions.len()];
    for ((_, f), moments) in conditions.iter().zip(&moments) {
        let Some(moments) = moments else { continue };
        let number: Vec<Option<usize>> = f.trace.dofs.iter().map(|dof| functions.binary_search(dof).ok()).collect();
        for &(i, j, value) in &moments.mass {
            match (number[i], number[j]) {
                (Some(i), Some(j)) => matrix.push(i, j, value),
                (Some(i), None) => rhs[i] -= value * known[&f.trace.dofs[j]],
                _ => {}
            }
        }
        for (&i, &value) in number.iter().zip(&moments.data) {
            if let Some(i) = i {
                rhs[i] += value;
            }
        }
    }
    let mut solution = vec![T::zero(); functions.len()];
    if rhs.iter().any(|&r| r != T::zero()) {
        let matrix = matrix.to_csr();
        solver.prepare(&matrix)?;
        solver.solve(&matrix, &rhs, &mut solution)?;
    }
    Ok(functions.into_iter().zip(solution).chain(known).collect())
}

/// A corner of a side: a corner of exactly one of its elements, at which exactly one function does not vanish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideCorner<const N: usize, T: Real = f64> {
    /// The function of the body.
    pub function: usize,
    /// Its value there, 1 unless functions are scaled.
    pub value: T,
    /// Position \[length\].
    pub x: Vector<N, T>,
    /// The longest distance to another corner of its element \[length\].
    pub extent: T,
}

/// Functions with less than this value at a corner count as zero there.
const NO_VALUE: f64 = 1e-10;

/// The corners of a side, in the order of its elements: the two ends of a curve that does not close, the four vertices of a side of tensor
/// cells. Points shared by several elements do not count.
pub fn side_corners<const S: usize, const N: usize, T: Real>(trace: &Trace<S, N, T>) -> Vec<SideCorner<N, T>> {
    let space = &*trace.space;
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let (mut all, mut count): (Vec<SideCorner<N, T>>, HashMap<usize, usize>) = (Vec::new(), HashMap::new());
    for e in 0..space.num_elements() {
        space.active(e, &mut ids);
        let corners = cell::corners::<S, T>(space.cell(e));
        space.evaluate(e, &corners, Order::Values, &mut shapes, &mut map);
        for q in 0..corners.len() {
            let mut alive = ids.iter().zip(shapes.values(q)).filter(|(_, v)| v.abs() > lit(NO_VALUE));
            let (Some((&i, &value)), None) = (alive.next(), alive.next()) else { continue };
            let function = trace.dofs[i];
            *count.entry(function).or_default() += 1;
            let extent = map.x.iter().fold(T::zero(), |m, x| m.max((x - map.x[q]).norm()));
            all.push(SideCorner { function, value, x: map.x[q], extent });
        }
    }
    all.retain(|c| count[&c.function] == 1);
    all
}

/// Products of the functions of a side with each other and with the data.
struct Moments<T> {
    /// (i, j, ∫ N_i N_j ds), one per element.
    mass: Vec<(usize, usize, T)>,
    /// ∫ value N_i ds.
    data: Vec<T>,
}

impl<T: Real> Moments<T> {
    fn of<const S: usize, const N: usize>(trace: &Trace<S, N, T>, value: &dyn Fn(&Vector<N, T>) -> T, extra_points: usize) -> Self {
        let space = &*trace.space;
        let rules = gauss_rules(space, extra_points);
        let (mut mass, mut data) = (Vec::new(), vec![T::zero(); space.num_functions()]);
        let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
        for e in 0..space.num_elements() {
            let rule = rules.rule(e);
            space.active(e, &mut ids);
            space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
            let ds: Vec<T> = rule.weights.iter().zip(&map.jacobian).map(|(&w, j)| w * measure(j)).collect();
            for (a, &i) in ids.iter().enumerate() {
                for (b, &j) in ids.iter().enumerate() {
                    mass.push((
                        i,
                        j,
                        ds.iter().enumerate().fold(T::zero(), |s, (q, &w)| s + w * shapes.values(q)[a] * shapes.values(q)[b]),
                    ));
                }
            }
            for (q, &w) in ds.iter().enumerate() {
                let value = value(&map.x[q]);
                for (&i, &n) in ids.iter().zip(shapes.values(q)) {
                    data[i] += value * w * n;
                }
            }
        }
        Self { mass, data }
    }
}

/// The largest value of any component in the corners of elements and at the points of edges and corners: the scale of components that
/// are zero up to rounding, as for data along inclined directions.
fn largest_value<const S: usize, const N: usize, T: Real>(conditions: &[Prescribed<'_, S, N, T>], pinned: &[Pinned<'_, N, T>]) -> T {
    let (mut largest, mut map) = (T::zero(), MapTable::new());
    for f in conditions {
        let (Some(value), space) = (f.value, &*f.trace.space) else { continue };
        for e in 0..space.num_elements() {
            space.map(e, &cell::corners::<S, T>(space.cell(e)), Order::Values, &mut map);
            largest = map.x.iter().fold(largest, |m, x| m.max(value(x).abs()));
        }
    }
    pinned.iter().flat_map(|p| p.rim.x.iter().map(|x| p.at(x).abs())).fold(largest, |m, v| m.max(v))
}

/// Compares the data of different sides in the corners of their elements that coincide and share a function.
fn conflicts<const S: usize, const N: usize, T: Real>(
    component: usize,
    conditions: &[(usize, Prescribed<'_, S, N, T>)],
    largest: T,
) -> Result<(), DirichletError> {
    struct Corner<const N: usize, T: Real> {
        condition: usize,
        x: Vector<N, T>,
        value: T,
    }
    // data can conflict only at functions shared by several sides
    let mut sides_of: HashMap<usize, usize> = HashMap::new();
    for (_, f) in conditions {
        for &dof in &f.trace.dofs {
            *sides_of.entry(dof).or_default() += 1;
        }
    }
    let mut at: HashMap<usize, Vec<Corner<N, T>>> = HashMap::new();
    let (mut lo, mut hi) = (Vector::<N, T>::repeat(lit(f64::MAX)), Vector::<N, T>::repeat(lit(f64::MIN)));
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    for (k, f) in conditions {
        let space = &*f.trace.space;
        for e in 0..space.num_elements() {
            space.active(e, &mut ids);
            let corners = cell::corners::<S, T>(space.cell(e));
            space.evaluate(e, &corners, Order::Values, &mut shapes, &mut map);
            for q in 0..corners.len() {
                let x = map.x[q];
                lo = lo.zip_map(&x, |a, b| a.min(b));
                hi = hi.zip_map(&x, |a, b| a.max(b));
                let value = f.value.map_or_else(T::zero, |value| value(&x));
                for (&i, &n) in ids.iter().zip(shapes.values(q)) {
                    let dof = f.trace.dofs[i];
                    if n.abs() > lit(EQUAL_VALUES) && sides_of[&dof] > 1 {
                        at.entry(dof).or_default().push(Corner { condition: *k, x, value });
                    }
                }
            }
        }
    }
    let (near, equal) = ((hi - lo).norm() * lit(SAME_PLACE), largest * lit(EQUAL_VALUES));
    let mut shared: Vec<&usize> = at.keys().collect();
    shared.sort_unstable();
    for dof in shared {
        let corners = &at[dof];
        for (i, a) in corners.iter().enumerate() {
            for b in &corners[i + 1..] {
                if a.condition != b.condition && (a.x - b.x).norm() <= near && (a.value - b.value).abs() > equal {
                    return Err(DirichletError::Conflict {
                        component,
                        first: a.condition,
                        second: b.condition,
                        at: std::array::from_fn(|k| if k < N { to_f64(a.x[k]) } else { 0.0 }),
                        first_value: to_f64(a.value),
                        second_value: to_f64(b.value),
                    });
                }
            }
        }
    }
    Ok(())
}

/// Unit normals that differ by less than this are equal.
const SAME_NORMAL: f64 = 1e-9;

/// The outward unit normal of a planar side; `None` if it varies or is undefined at a point.
pub fn planar_normal<const S: usize, const N: usize, T: Real>(trace: &Trace<S, N, T>) -> Option<Vector<N, T>> {
    let space = &*trace.space;
    let rules = gauss_rules(space, 0);
    let (mut map, mut normal) = (MapTable::new(), None);
    for e in 0..space.num_elements() {
        space.map(e, &rules.rule(e).points, Order::Gradients, &mut map);
        for (jacobian, x) in map.jacobian.iter().zip(&map.x) {
            let here = trace.normal(e, jacobian);
            let there = *normal.get_or_insert(here);
            let distance: T = (here - there).norm();
            // far from the origin positions are rounded, and directions by that over the element
            let rounding = T::default_epsilon() * lit(64.0) * x.norm() / jacobian.norm();
            // a side that degenerates to a point has no normal there
            if distance > lit::<T>(SAME_NORMAL) + rounding || here.norm() < lit(0.5) {
                return None;
            }
        }
    }
    normal
}
