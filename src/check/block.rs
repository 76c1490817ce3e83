//! Rules of blocks: a run of elements whose functions are products of univariate ones.

use super::points;
use crate::basis::{Basis, Block, Order, ShapeTable};
use crate::linalg::{Real, Vector, to_f64};
use std::collections::{BTreeMap, BTreeSet};

/// A product may differ from the basis' own value by this many roundings of the largest value.
const SAME: f64 = 1e4;

/// Checks every block of `basis`.
pub(super) fn blocks<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    for e in 0..basis.num_elements() {
        if let Some(block) = basis.block(e)
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
    let (mut global, mut local) = (BTreeMap::new(), BTreeMap::new());
    let (mut ids, mut line_ids) = (Vec::new(), Vec::new());
    let (mut table, mut line) = (ShapeTable::new(), ShapeTable::new());
    for run in 0..count {
        let e = block.first + run;
        let at: [usize; D] = std::array::from_fn(|k| run / elements[..k].iter().product::<usize>() % elements[k]);
        let same = basis.block(e).is_some_and(|b| b.first == block.first && b.axes.map(|a| a.num_elements()) == elements);
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
            if *global.entry(n).or_insert(i) != i || *local.entry(i).or_insert(n) != n {
                return Err(format!("function {n} of the run is not always the same function of the basis (element {e}, function {i})"));
            }
        }
        for x in points::inside::<D, T>(basis.cell(e), 2) {
            basis.tabulate(e, &[x], Order::Gradients, &mut table);
            let mut values = vec![1.0; ids.len()];
            let mut slopes = vec![[1.0; D]; ids.len()];
            for k in 0..D {
                block.axes[k].tabulate(at[k], &[Vector::<1, T>::new(x[k])], Order::Gradients, &mut line);
                for a in 0..ids.len() {
                    let j = a / firsts[..k].iter().map(|f| f.1).product::<usize>() % firsts[k].1;
                    values[a] *= to_f64(line.values(0)[j]);
                    for (d, slope) in slopes[a].iter_mut().enumerate() {
                        *slope *= if d == k { to_f64(line.grads(0)[j][0]) } else { to_f64(line.values(0)[j]) };
                    }
                }
            }
            if let Some(weights) = block.weights {
                let w: Vec<f64> = (0..ids.len()).map(|a| to_f64(weights[number(a)])).collect();
                let total: f64 = values.iter().zip(&w).map(|(v, w)| v * w).sum();
                for d in 0..D {
                    let dtotal: f64 = slopes.iter().zip(&w).map(|(s, w)| s[d] * w).sum();
                    for a in 0..ids.len() {
                        slopes[a][d] = w[a] * (slopes[a][d] - values[a] * dtotal / total) / total;
                    }
                }
                values.iter_mut().zip(&w).for_each(|(v, w)| *v *= w / total);
            }
            for (a, &i) in ids.iter().enumerate() {
                let apart = (to_f64(table.values(0)[a]) - values[a]).abs();
                let scale = 1.0 + slopes[a].iter().fold(0.0f64, |s, g| s.max(g.abs()));
                let apart = (0..D).fold(apart, |m, d| m.max((to_f64(table.grads(0)[a][d]) - slopes[a][d]).abs() / scale));
                if apart.is_nan() || apart > SAME * to_f64(T::default_epsilon()) {
                    return Err(format!("function {i} on element {e} is not the product of its axes (apart by {apart:e})"));
                }
            }
        }
    }
    Ok(())
}

/// Active ids of an axis are consecutive and never fall from one element to the next.
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
