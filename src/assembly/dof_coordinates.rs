//! Representative coordinates of the unknowns, for orderings, coarse grids and partitions.

use super::pattern::Pattern;
use super::simd_cells::means;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Real, to_f64};
use crate::parallel;
use crate::quadrature::{Quadrature, TensorRule, simplex_rule};
use crate::space::Space;

/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 64;

/// One point per unknown: the mean of x over two Gauss points per direction, weighted by the squared function.
///
/// A cheap approximation: within a fraction of the element for inner Lagrange nodes, about the middle of the support for
/// splines.
pub fn dof_coordinates<const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized>(
    space: &S,
    pattern: &Pattern,
    components: usize,
) -> Vec<[f64; 3]> {
    if let Some(places) = means(space, pattern, components) {
        return places;
    }
    let parts: Vec<Vec<[f64; 4]>> = parallel::map_ranges(pattern.num_elements(), ELEMENTS_PER_TASK, |chunk| {
        let (mut shapes, mut map) = (ShapeTable::new(), MapTable::new());
        let (tensor, simplex) = (TensorRule::gauss([2; D]), simplex_rule::<D, T>(2));
        let mut out = Vec::new();
        for e in chunk {
            let points = match space.cell(e) {
                Cell::Tensor => &tensor.rule(e).points,
                Cell::Simplex => &simplex.points,
            };
            space.evaluate(e, points, Order::Values, &mut shapes, &mut map);
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
    });
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
