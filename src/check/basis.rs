//! Rules of bases and of the elements they live on.

use super::block::{blocks, patches};
use super::continuation::{continues, leaves_polynomial};
use super::geometry::chosen;
use super::points;
use super::reference::{listed, references};
use crate::basis::{Basis, Cell, Order, Polynomials, ShapeTable};
use crate::linalg::{Matrix, Real, Vector, lit, to_f64};
use crate::quadrature::{Rule, TensorRule, simplex_rule};

/// Tolerance of values that must be equal, in units of rounding of the largest value.
const SAME: f64 = 1e3;
/// Size of the component orthogonal to the other functions, in units of rounding, below which a function counts as dependent.
const DEPENDENT: f64 = 1e2;

/// Checks every rule of [`Basis`] and [`Elements`](crate::basis::Elements) on `basis`:
///
/// - active ids are unique and below `num_functions`, every function is active somewhere, tables have the right size;
/// - values do not depend on the order requested, on the batch, or on previous contents of the table;
/// - derivatives agree with differences, inside the cell and outside it, and second derivatives are symmetric;
/// - outside the cell the element's own functions continue;
/// - the active functions of an element are linearly independent on it;
/// - corners are as many as the cell has, or none;
/// - a list of all functions agrees with the active ones of every element;
/// - elements of one reference cell have the same tables;
/// - blocks are products numbered with the first axis fastest;
/// - patches are blocks that cover all elements, and their functions sum up to those with their numbers;
/// - polynomials have the same elements, are non-negative, sum to one, and are never rational.
///
/// For bases with many elements, tables are checked on some elements, evenly spread; ids and blocks on all.
/// A partition of unity is no rule for every basis: see [`partition_of_unity`] and [`non_negative`].
///
/// # Errors
/// The rule that is broken, and where.
pub fn basis<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    functions(basis)?;
    listed(basis)?;
    references(basis)?;
    blocks(basis)?;
    patches(basis)?;
    polynomials(basis)
}

/// Checks that the functions of `basis` sum to one, inside the cells and beyond.
///
/// # Errors
/// The element and the sum.
pub fn partition_of_unity<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    each_table(basis, points::around, |e, table, q| {
        let sum: f64 = table.values(q).iter().map(|&v| to_f64(v)).sum();
        let size: f64 = table.values(q).iter().map(|&v| to_f64(v).abs()).sum();
        match (sum - 1.0).abs() <= SAME * epsilon::<T>() * size {
            true => Ok(()),
            false => Err(format!("the functions sum to {sum} on element {e}, not to one")),
        }
    })
}

/// Checks that no function of `basis` is negative at points of the cells, corners included.
///
/// # Errors
/// The element and the value.
pub fn non_negative<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let all = |cell| [points::inside(cell, 20), points::corners(cell)].concat();
    each_table(basis, all, |e, table, q| {
        let least = table.values(q).iter().map(|&v| to_f64(v)).fold(0.0, f64::min);
        match least >= -SAME * epsilon::<T>() {
            true => Ok(()),
            false => Err(format!("a function is {least} on element {e}; none may be negative")),
        }
    })
}

fn epsilon<T: Real>() -> f64 {
    to_f64(T::default_epsilon())
}

/// Calls `f(element, table of values, point)` for the points of every element.
fn each_table<const D: usize, T: Real>(
    basis: &dyn Basis<D, T>,
    points: impl Fn(Cell) -> Vec<Vector<D, T>>,
    f: impl Fn(usize, &ShapeTable<D, T>, usize) -> Result<(), String>,
) -> Result<(), String> {
    let mut table = ShapeTable::new();
    for e in chosen(basis.num_elements()) {
        let xi = points(basis.cell(e));
        basis.tabulate(e, &xi, Order::Values, &mut table);
        for q in 0..xi.len() {
            f(e, &table, q)?;
        }
    }
    Ok(())
}

/// Checks everything but blocks and polynomials.
fn functions<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let mut lives = vec![false; basis.num_functions()];
    let (mut ids, mut corner_ids, mut warm) = (Vec::new(), Vec::new(), ShapeTable::new());
    let looked_at = chosen(basis.num_elements());
    for e in 0..basis.num_elements() {
        let at = |what: String| format!("element {e}: {what}");
        basis.active(e, &mut ids);
        for (a, &i) in ids.iter().enumerate() {
            if i >= lives.len() {
                return Err(at(format!("function {i} is active, but there are only {}", lives.len())));
            }
            if ids[..a].contains(&i) {
                return Err(at(format!("function {i} is listed twice")));
            }
            lives[i] = true;
        }
        basis.corners(e, &mut corner_ids);
        let expected = if basis.cell(e) == Cell::Simplex { D + 1 } else { 1 << D };
        if !corner_ids.is_empty() && corner_ids.len() != expected {
            return Err(at(format!("{} corners; the cell has {expected}", corner_ids.len())));
        }
        if !looked_at.contains(&e) {
            continue;
        }
        tables(basis, e, ids.len(), &mut warm).map_err(at)?;
        derivatives(basis, e, &mut warm).map_err(at)?;
        continues(basis, e, &mut warm).map_err(at)?;
        independent(basis, e, &ids, &mut warm).map_err(at)?;
    }
    match lives.iter().position(|&l| !l) {
        Some(i) => Err(format!("function {i} is active on no element")),
        None => Ok(()),
    }
}

/// Largest absolute value of a table.
pub(super) fn largest<const D: usize, T: Real>(table: &ShapeTable<D, T>) -> f64 {
    (0..table.num_points()).flat_map(|q| table.values(q)).map(|&v| to_f64(v).abs()).fold(0.0, f64::max)
}

/// Checks that tables have the right size, and values depend on nothing but the point.
fn tables<const D: usize, T: Real>(basis: &dyn Basis<D, T>, e: usize, functions: usize, warm: &mut ShapeTable<D, T>) -> Result<(), String> {
    let xi = points::inside::<D, T>(basis.cell(e), 5);
    basis.tabulate(e, &[], Order::Hessians, warm);
    if warm.num_points() != 0 {
        return Err("the table of no points is not empty".into());
    }
    let mut fresh = ShapeTable::new();
    basis.tabulate(e, &xi, Order::Hessians, &mut fresh);
    if (fresh.num_functions(), fresh.num_points(), fresh.order()) != (functions, xi.len(), Order::Hessians) {
        return Err(format!(
            "the table has {} functions and {} points up to {:?}; {functions}, {} and Hessians are right",
            fresh.num_functions(),
            fresh.num_points(),
            fresh.order(),
            xi.len()
        ));
    }
    let allowed = SAME * epsilon::<T>() * largest(&fresh);
    for order in [Order::Hessians, Order::Values] {
        for q in 0..xi.len() {
            basis.tabulate(e, &xi[q..=q], order, warm);
            let apart = warm.values(0).iter().zip(fresh.values(q)).map(|(&a, &b)| to_f64((a - b).abs())).fold(0.0, f64::max);
            if warm.num_functions() != functions || apart.is_nan() || apart > allowed {
                return Err(format!("values change by {apart:e} with the batch, the order or the table's past"));
            }
        }
    }
    Ok(())
}

/// Checks derivatives against fourth-order differences, inside and around the cell.
fn derivatives<const D: usize, T: Real>(basis: &dyn Basis<D, T>, e: usize, table: &mut ShapeTable<D, T>) -> Result<(), String> {
    let step = lit::<T>(epsilon::<T>().powf(0.2));
    let (two, eight, twelve) = (lit::<T>(2.0), lit::<T>(8.0), lit::<T>(12.0));
    for x in points::around::<D, T>(basis.cell(e)) {
        for k in 0..D {
            let mut along = Vector::<D, T>::zeros();
            along[k] = step;
            basis.tabulate(e, &[x - along * two, x - along, x + along, x + along * two, x], Order::Hessians, table);
            let mut size = [0.0f64; 3];
            for a in 0..table.num_functions() {
                size[0] = size[0].max(to_f64(table.values(4)[a].abs()));
                size[1] = size[1].max(to_f64(table.grads(4)[a].amax()));
                size[2] = size[2].max(to_f64(table.hessians(4)[a].amax()));
            }
            let allowed = [epsilon::<T>().powf(0.4) * (size[0] + size[1]), epsilon::<T>().powf(0.4) * (size[1] + size[2])];
            for a in 0..table.num_functions() {
                let slope = |v: [T; 4]| (v[0] - v[3] + (v[2] - v[1]) * eight) / (twelve * step);
                let first = slope([0, 1, 2, 3].map(|q| table.values(q)[a])) - table.grads(4)[a][k];
                let wrong = |found: T, allowed: f64| to_f64(found).is_nan() || to_f64(found.abs()) > allowed;
                if wrong(first, allowed[0]) {
                    return Err(format!("derivative {k} of local function {a} misses the difference by {:e}", to_f64(first)));
                }
                let hessian: Matrix<D, D, T> = table.hessians(4)[a];
                for l in 0..D {
                    let second = slope([0, 1, 2, 3].map(|q| table.grads(q)[a][l])) - hessian[(l, k)];
                    if wrong(second, allowed[1]) || wrong(hessian[(k, l)] - hessian[(l, k)], allowed[1]) {
                        return Err(format!("second derivative ({l}, {k}) of local function {a} misses the difference"));
                    }
                }
            }
        }
    }
    Ok(())
}

/// Checks linear independence of the active functions on the element: Gram-Schmidt on their values at quadrature points.
fn independent<const D: usize, T: Real>(
    basis: &dyn Basis<D, T>,
    e: usize,
    ids: &[usize],
    table: &mut ShapeTable<D, T>,
) -> Result<(), String> {
    let degree = basis.degree(e);
    let rule: Rule<D, T> = match basis.cell(e) {
        Cell::Simplex => simplex_rule(2 * degree.iter().max().copied().unwrap_or(0)),
        Cell::Tensor => {
            use crate::quadrature::Quadrature;
            TensorRule::gauss(degree.map(|p| p + 1)).rule(0).clone()
        }
    };
    if ids.len() > rule.points.len() {
        return Err(format!("{} functions are more than polynomials of degree {degree:?} allow", ids.len()));
    }
    basis.tabulate(e, &rule.points, Order::Values, table);
    let mut directions: Vec<Vec<f64>> = Vec::new();
    for (a, &i) in ids.iter().enumerate() {
        let mut v: Vec<f64> = rule.weights.iter().enumerate().map(|(q, &w)| to_f64(table.values(q)[a]) * to_f64(w).sqrt()).collect();
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let full = norm(&v);
        for _ in 0..2 {
            for d in &directions {
                let share: f64 = v.iter().zip(d).map(|(x, y)| x * y).sum();
                v.iter_mut().zip(d).for_each(|(x, y)| *x -= share * y);
            }
        }
        let rest = norm(&v);
        if rest.is_nan() || rest <= DEPENDENT * epsilon::<T>() * full {
            return Err(format!("function {i} vanishes or depends on the other active functions"));
        }
        v.iter_mut().for_each(|x| *x /= rest);
        directions.push(v);
    }
    Ok(())
}

/// Checks [`Basis::polynomials`] for all degrees up to the basis' own.
fn polynomials<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let most = (0..basis.num_elements()).flat_map(|e| basis.degree(e)).max().unwrap_or(0);
    // the roughest, continuous, and the smoothest of every degree
    let kinds = |p: isize| [Some(-1), (p >= 1).then_some(0), (p >= 2).then_some(p - 1)];
    let uniform = (0..=most)
        .flat_map(|degree| kinds(degree as isize).into_iter().flatten().map(move |continuity| Polynomials::Uniform { degree, continuity }));
    for wanted in (0..=most).map(Polynomials::Lowered).chain(uniform) {
        if let Some(found) = basis.polynomials(wanted) {
            multiplier(basis, &*found, wanted).map_err(|what| format!("polynomials {wanted:?}: {what}"))?;
        }
    }
    Ok(())
}

fn multiplier<const D: usize, T: Real>(basis: &dyn Basis<D, T>, found: &dyn Basis<D, T>, wanted: Polynomials) -> Result<(), String> {
    if found.num_elements() != basis.num_elements() {
        return Err(format!("{} elements instead of {}", found.num_elements(), basis.num_elements()));
    }
    let (mut own, mut other, mut table) = (Vec::new(), Vec::new(), ShapeTable::new());
    let looked_at = chosen(basis.num_elements());
    for e in 0..basis.num_elements() {
        if found.cell(e) != basis.cell(e) {
            return Err(format!("element {e} has another cell"));
        }
        basis.corners(e, &mut own);
        found.corners(e, &mut other);
        if !own.is_empty() && !other.is_empty() && own != other {
            return Err(format!("element {e} has the corners {other:?} instead of {own:?}"));
        }
        let degree = basis.degree(e).map(|p| match wanted {
            Polynomials::Lowered(k) => p.saturating_sub(k),
            Polynomials::Uniform { degree, .. } => degree,
        });
        if found.degree(e) != degree {
            return Err(format!("element {e} has degree {:?} instead of {degree:?}", found.degree(e)));
        }
        if !looked_at.contains(&e) {
            continue;
        }
        for k in 0..D {
            let apart = leaves_polynomial(found, e, k, degree[k] + 1, &mut table);
            if apart.is_nan() || apart > epsilon::<T>().powf(0.6) {
                return Err(format!("a function on element {e} is no polynomial of degree {} in direction {k}", degree[k]));
            }
        }
    }
    functions(found)?;
    blocks(found)?;
    partition_of_unity(found)?;
    non_negative(found)
}
