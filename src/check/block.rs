//! Rules of blocks: a run of elements whose functions are products of univariate ones.

use super::points;
use crate::basis::{Basis, Block, Order, ShapeTable, TensorPatch};
use crate::linalg::{Real, Vector, to_f64};
use std::collections::{BTreeMap, BTreeSet};

/// Tolerance of products against the values of the basis, in units of rounding of the largest value.
const SAME: f64 = 1e4;

/// Checks every block of `basis`.
pub(super) fn blocks<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    for e in 0..basis.num_elements() {
        if let Some(block) = basis.structure().block(e)
            && seen.insert(block.first)
        {
            one(basis, &block).map_err(|what| format!("the block of element {e}: {what}"))?;
        }
    }
    Ok(())
}

fn one<const D: usize, T: Real>(basis: &dyn Basis<D, T>, block: &Block<'_, D, T>) -> Result<(), String> {
    let elements = block.axes.map(|a| a.num_elements());
    let functions = block.axes.map(|a| a.num_functions());
    let count: usize = elements.iter().product();
    if block.first + count > basis.num_elements() {
        return Err(format!("it has {count} elements from {} on, the basis only {}", block.first, basis.num_elements()));
    }
    if let Some(weights) = block.weights
        && (weights.len() != functions.iter().product::<usize>() || weights.iter().any(|&w| w <= T::zero()))
    {
        return Err(format!("it has {} weights; it needs one positive weight per function", weights.len()));
    }
    for (k, axis) in block.axes.iter().enumerate() {
        consecutive(*axis).map_err(|what| format!("axis {k}: {what}"))?;
    }
    // a run that is glued to itself has several functions that are one of the basis
    let mut global = BTreeMap::new();
    let (mut ids, mut line_ids) = (Vec::new(), Vec::new());
    let mut table = ShapeTable::new();
    for run in 0..count {
        let e = block.first + run;
        let at: [usize; D] = std::array::from_fn(|k| run / elements[..k].iter().product::<usize>() % elements[k]);
        let same = basis.structure().block(e).is_some_and(|b| b.first == block.first && b.axes.map(|a| a.num_elements()) == elements);
        if !same {
            return Err(format!("element {e} of its run answers another block"));
        }
        let firsts: [(usize, usize); D] = std::array::from_fn(|k| {
            block.axes[k].active(at[k], &mut line_ids);
            (line_ids.first().copied().unwrap_or(0), line_ids.len())
        });
        basis.active(e, &mut ids);
        if ids.len() != firsts.iter().map(|f| f.1).product::<usize>() {
            return Err(format!("element {e} has {} functions, the product of its axes {:?}", ids.len(), firsts.map(|f| f.1)));
        }
        // number of the function within the run
        let number = |a: usize| {
            let (mut rest, mut stride, mut i) = (a, 1, 0);
            for k in 0..D {
                i += stride * (firsts[k].0 + rest % firsts[k].1);
                rest /= firsts[k].1;
                stride *= functions[k];
            }
            i
        };
        for (a, &i) in ids.iter().enumerate() {
            let n = number(a);
            if *global.entry(n).or_insert(i) != i {
                return Err(format!("function {n} of the run is not always the same function of the basis (element {e}, function {i})"));
            }
        }
        for x in points::inside::<D, T>(basis.cell(e), 2) {
            basis.tabulate(e, &[x], Order::Gradients, &mut table);
            let products = products(block, at, &x);
            for (a, &i) in ids.iter().enumerate() {
                agrees(&table, a, products[a].1, products[a].2)
                    .map_err(|apart| format!("function {i} on element {e} is not the product of its axes (apart by {apart:e})"))?;
            }
        }
    }
    Ok(())
}

/// Checks what [`BasisStructure::patches`](crate::basis::BasisStructure::patches) answers: blocks that cover all elements, whose
/// functions sum up to those of the basis.
pub(super) fn patches<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let Some(parts) = basis.structure().patches() else { return Ok(()) };
    let mut next = 0;
    for (k, part) in parts.iter().enumerate() {
        let at = |what: String| format!("patch {k}: {what}");
        if part.block.first != next {
            return Err(at(format!("it starts at element {} instead of {next}", part.block.first)));
        }
        next += part.block.axes.map(|a| a.num_elements()).iter().product::<usize>();
        if next > basis.num_elements() {
            return Err(at(format!("it ends at element {next}, the basis at {}", basis.num_elements())));
        }
        one_patch(basis, part).map_err(at)?;
    }
    match next == basis.num_elements() {
        true => Ok(()),
        false => Err(format!("patches cover {next} elements of {}", basis.num_elements())),
    }
}

fn one_patch<const D: usize, T: Real>(basis: &dyn Basis<D, T>, part: &TensorPatch<'_, D, T>) -> Result<(), String> {
    let block = &part.block;
    let (elements, functions) = (block.axes.map(|a| a.num_elements()), block.axes.map(|a| a.num_functions()));
    let count: usize = functions.iter().product();
    if part.ids.len() != count {
        return Err(format!("it has {} numbers for {count} functions", part.ids.len()));
    }
    if block.weights.is_some_and(|w| w.len() != count || w.iter().any(|&w| w <= T::zero())) {
        return Err(format!("it needs {count} positive weights"));
    }
    for (k, axis) in block.axes.iter().enumerate() {
        consecutive(*axis).map_err(|what| format!("axis {k}: {what}"))?;
    }
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    for run in 0..elements.iter().product() {
        let e = block.first + run;
        let at: [usize; D] = std::array::from_fn(|k| run / elements[..k].iter().product::<usize>() % elements[k]);
        basis.active(e, &mut ids);
        for x in points::inside::<D, T>(basis.cell(e), 2) {
            basis.tabulate(e, &[x], Order::Gradients, &mut table);
            let mut sums: BTreeMap<usize, (f64, [f64; D])> = BTreeMap::new();
            for (n, value, slope) in products(block, at, &x) {
                let sum = sums.entry(part.ids[n]).or_insert((0.0, [0.0; D]));
                sum.0 += value;
                sum.1.iter_mut().zip(slope).for_each(|(s, g)| *s += g);
            }
            if !ids.iter().all(|i| sums.contains_key(i)) || sums.len() != ids.len() {
                return Err(format!("element {e} has the functions {ids:?}, the patch {:?}", sums.keys()));
            }
            for (a, i) in ids.iter().enumerate() {
                agrees(&table, a, sums[i].0, sums[i].1).map_err(|apart| {
                    format!("function {i} on element {e} is not the sum of products with its number (apart by {apart:e})")
                })?;
            }
        }
    }
    Ok(())
}

/// The functions of element `at` of a block at `x`: number within the block, value, derivatives.
fn products<const D: usize, T: Real>(block: &Block<'_, D, T>, at: [usize; D], x: &Vector<D, T>) -> Vec<(usize, f64, [f64; D])> {
    let (mut ids, mut line) = (Vec::new(), ShapeTable::new());
    let mut all = vec![(0, 1.0, [1.0; D])];
    let mut stride = 1;
    for k in 0..D {
        block.axes[k].active(at[k], &mut ids);
        block.axes[k].tabulate(at[k], &[Vector::<1, T>::new(x[k])], Order::Gradients, &mut line);
        let (values, slopes) = (line.values(0), line.grads(0));
        let times = |j: usize, (n, value, mut slope): (usize, f64, [f64; D])| {
            for (d, slope) in slope.iter_mut().enumerate() {
                *slope *= if d == k { to_f64(slopes[j][0]) } else { to_f64(values[j]) };
            }
            (n + stride * ids[j], value * to_f64(values[j]), slope)
        };
        all = (0..ids.len()).flat_map(|j| all.iter().map(move |&p| (j, p))).map(|(j, p)| times(j, p)).collect();
        stride *= block.axes[k].num_functions();
    }
    if let Some(weights) = block.weights {
        let w: Vec<f64> = all.iter().map(|p| to_f64(weights[p.0])).collect();
        let total: f64 = all.iter().zip(&w).map(|(p, w)| p.1 * w).sum();
        let slope: [f64; D] = std::array::from_fn(|d| all.iter().zip(&w).map(|(p, w)| p.2[d] * w).sum());
        for (p, w) in all.iter_mut().zip(&w) {
            for d in 0..D {
                p.2[d] = w * (p.2[d] - p.1 * slope[d] / total) / total;
            }
            p.1 *= w / total;
        }
    }
    all
}

/// Checks the value and the derivatives of local function `a` of a table of one point; the error states the difference.
fn agrees<const D: usize, T: Real>(table: &ShapeTable<D, T>, a: usize, value: f64, slope: [f64; D]) -> Result<(), f64> {
    let scale = 1.0 + slope.iter().fold(0.0f64, |s, g| s.max(g.abs()));
    let apart = (to_f64(table.values(0)[a]) - value).abs();
    let apart = (0..D).fold(apart, |m, d| m.max((to_f64(table.grads(0)[a][d]) - slope[d]).abs() / scale));
    if apart.is_nan() || apart > SAME * to_f64(T::default_epsilon()) { Err(apart) } else { Ok(()) }
}

/// Checks that active ids of an axis are consecutive and never decrease from one element to the next.
fn consecutive<T: Real>(axis: &dyn Basis<1, T>) -> Result<(), String> {
    let (mut ids, mut last) = (Vec::new(), 0);
    for e in 0..axis.num_elements() {
        axis.active(e, &mut ids);
        if ids.windows(2).any(|w| w[1] != w[0] + 1) {
            return Err(format!("the active functions of its element {e} are not consecutive: {ids:?}"));
        }
        if ids.first().is_some_and(|&i| i < last) {
            return Err(format!("the active functions of its element {e} lie before those of element {}", e - 1));
        }
        last = ids.first().copied().unwrap_or(last);
    }
    Ok(())
}
