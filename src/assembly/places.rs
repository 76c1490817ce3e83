//! Where unknowns live: orderings, coarse grids and partitions ask for it.

use super::pattern::Pattern;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Real, Vector, num, to_f64};
use crate::space::Space;
use rayon::prelude::*;

/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 64;

/// A point per unknown: the mean of x over a grid of degree + 1 points per direction, weighted by the squared function.
///
/// Lagrange functions get their node to within a fraction of the element, splines the middle of their support.
pub fn places<const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized>(
    space: &S,
    pattern: &Pattern,
    components: usize,
) -> Vec<[f64; 3]> {
    let elements: Vec<usize> = (0..pattern.num_elements()).collect();
    let parts: Vec<Vec<[f64; 4]>> = elements
        .par_chunks(ELEMENTS_PER_TASK)
        .map(|chunk| {
            let (mut shapes, mut map) = (ShapeTable::new(), MapTable::new());
            let (mut points, mut kind) = (Vec::new(), None);
            let mut out = Vec::new();
            for &e in chunk {
                let wanted = (space.cell(e), space.degree(e));
                if kind != Some(wanted) {
                    kind = Some(wanted);
                    points = grid::<D, T>(wanted.0, wanted.1);
                }
                space.evaluate(e, &points, Order::Values, &mut shapes, &mut map);
                let first = out.len();
                out.resize(first + pattern.ids(e).len(), [0.0; 4]);
                for q in 0..points.len() {
                    for (sum, &value) in out[first..].iter_mut().zip(shapes.values(q)) {
                        let w = to_f64(value * value);
                        for k in 0..N.min(3) {
                            sum[k] += w * to_f64(map.x[q][k]);
                        }
                        sum[3] += w;
                    }
                }
            }
            out
        })
        .collect();
    let mut sums = vec![[0.0; 4]; pattern.num_functions()];
    let terms = parts.iter().flatten();
    let ids = (0..pattern.num_elements()).flat_map(|e| pattern.ids(e));
    for (&i, term) in ids.zip(terms) {
        for k in 0..4 {
            sums[i as usize][k] += term[k];
        }
    }
    let mut places = Vec::with_capacity(components * sums.len());
    for s in &sums {
        let w = if s[3] > 0.0 { s[3] } else { 1.0 };
        places.extend(std::iter::repeat_n([s[0] / w, s[1] / w, s[2] / w], components));
    }
    places
}

/// Equally spaced points of a cell, its ends included.
pub(crate) fn grid<const D: usize, T: Real>(cell: Cell, degree: [usize; D]) -> Vec<Vector<D, T>> {
    let mut points = Vec::new();
    let mut index = [0usize; D];
    loop {
        let inside = cell == Cell::Tensor || index.iter().sum::<usize>() <= degree[0];
        if inside {
            points.push(Vector::from_fn(|k, _| if degree[k] == 0 { num::<T>(1) / num(2) } else { num::<T>(index[k]) / num(degree[k]) }));
        }
        let mut k = 0;
        while k < D {
            index[k] += 1;
            if index[k] <= degree[k] {
                break;
            }
            index[k] = 0;
            k += 1;
        }
        if k == D {
            return points;
        }
    }
}
