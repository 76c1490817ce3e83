//! Elements cut into parts of which the normals turn little, equally on both sides of a kink.

use super::facets::{Facets, angle};
use super::polygon::Polygon;
use super::skeleton::Skeleton;
use crate::basis::Order;
use crate::geometry::{MapTable, unit_normal};
use crate::linalg::{Matrix, Union, Vector};

/// Largest turn of the normals along a direction of a facet \[rad\].
const TURN: f64 = std::f64::consts::FRAC_PI_3;

/// Numbers of parts along the sides of an element.
pub(super) type PartCounts = [usize; 4];

/// Numbers of parts into which the element of facet `whole`, which is all of it, is cut for its normals.
pub(super) fn counts(facets: &Facets<'_>, whole: usize, table: &mut MapTable<2, 3>) -> PartCounts {
    const LINES: usize = 5;
    let polygon = facets.list[whole].polygon;
    // lines a little inside: normals vanish at poles
    let at = |i: usize, j: usize| {
        let t = |k: usize| 0.01 + 0.98 * k as f64 / (LINES - 1) as f64;
        match polygon {
            Polygon::Square => Vector::<2>::new(t(i), t(j)),
            Polygon::Triangle => Vector::<2>::new(t(i) * (1.0 - t(j)), t(j)),
        }
    };
    let points: Vec<Vector<2>> = (0..LINES * LINES).map(|q| at(q % LINES, q / LINES)).collect();
    facets.at(whole, &points, Order::Gradients, table);
    let normals: Vec<Vector<3>> = table.jacobian.iter().map(|j| unit_normal(j, 1.0)).collect();
    let turn = |line: &dyn Fn(usize) -> usize| (1..LINES).map(|k| angle(&normals[line(k - 1)], &normals[line(k)])).sum::<f64>();
    let count = |of: &dyn Fn(usize, usize) -> usize| {
        let most = (0..LINES).map(|l| turn(&|k| of(l, k))).fold(0.0, f64::max);
        ((most / TURN - 1e-6).ceil() as usize).clamp(1, 64)
    };
    let (nu, nv) = (count(&|l, k| l * LINES + k), count(&|l, k| k * LINES + l));
    match polygon {
        Polygon::Square => [nu, nv, nu, nv],
        Polygon::Triangle => [nu.max(nv); 4],
    }
}

/// Origins and axes of the parts with these numbers along the sides.
pub(super) fn cut(polygon: Polygon, counts: &PartCounts) -> Vec<(Vector<2>, Matrix<2, 2>)> {
    let mut out = Vec::new();
    match polygon {
        Polygon::Square => {
            let [nu, nv, ..] = *counts;
            let (du, dv) = (1.0 / nu as f64, 1.0 / nv as f64);
            for (i, j) in (0..nu * nv).map(|q| ((q % nu) as f64, (q / nu) as f64)) {
                out.push((Vector::<2>::new(i * du, j * dv), Matrix::<2, 2>::new(du, 0.0, 0.0, dv)));
            }
        }
        Polygon::Triangle if counts[1..3].iter().any(|n| *n != counts[0]) => return fan(counts),
        Polygon::Triangle => {
            let n = counts[0];
            let d = 1.0 / n as f64;
            for (i, j) in (0..n * n).map(|q| (q % n, q / n)).filter(|&(i, j)| i + j < n) {
                let (x, y) = (i as f64 * d, j as f64 * d);
                out.push((Vector::<2>::new(x, y), Matrix::<2, 2>::new(d, 0.0, 0.0, d)));
                if i + j + 1 < n {
                    out.push((Vector::<2>::new(x + d, y + d), Matrix::<2, 2>::new(-d, 0.0, 0.0, -d)));
                }
            }
        }
    }
    out
}

/// Parts of a triangle whose sides are cut unequally: triangles between the parts of its sides and its centre.
fn fan(counts: &PartCounts) -> Vec<(Vector<2>, Matrix<2, 2>)> {
    let (polygon, mut out) = (Polygon::Triangle, Vec::new());
    for (k, &n) in counts.iter().enumerate().take(polygon.sides()) {
        for i in 0..n {
            let [a, b] = [i, i + 1].map(|j| polygon.on_side(k, j as f64 / n as f64));
            out.push((a, Matrix::from_columns(&[b - a, polygon.center() - a])));
        }
    }
    out
}

/// Numbers of parts of elements, one facet each, that are equal on both sides of every kink.
///
/// Both sides of an edge see it along one mean normal only where they have it in common. Sides that face each other in a square have one
/// number, and so have all sides of a triangle that is cut for its normals.
pub(super) fn evened(whole: &Facets<'_>, counts: &[PartCounts]) -> Vec<PartCounts> {
    let skeleton = Skeleton::new(whole);
    let mut sets = Union::new(4 * counts.len());
    for (f, own) in counts.iter().enumerate() {
        if whole.list[f].pole || whole.list[f].polygon == Polygon::Square {
            (0..2).for_each(|k| sets.unite(4 * f + k, 4 * f + k + 2));
        } else if own[0] > 1 {
            (1..3).for_each(|k| sets.unite(4 * f, 4 * f + k));
        }
    }
    for edge in skeleton.edges.iter().filter(|edge| !edge.smooth) {
        if let [a, b] = edge.at().iter().map(|&(f, k)| 4 * f + whole.list[f].side_of_element(k)).collect::<Vec<_>>()[..] {
            sets.unite(a, b);
        }
    }
    let (class, classes) = sets.numbers();
    let mut most = vec![1; classes];
    for (side, &set) in class.iter().enumerate() {
        most[set] = most[set].max(counts[side / 4][side % 4]);
    }
    (0..counts.len()).map(|f| std::array::from_fn(|k| most[class[4 * f + k]])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_an_element_have_its_area_whatever_the_numbers_along_its_sides() {
        for (polygon, counts) in [
            (Polygon::Square, [3, 2, 3, 2]),
            (Polygon::Triangle, [2; 4]),
            (Polygon::Triangle, [3; 4]),
            (Polygon::Triangle, [1, 2, 1, 1]),
            (Polygon::Triangle, [2, 3, 4, 1]),
        ] {
            let of_cell = polygon.area();
            let area: f64 = cut(polygon, &counts).iter().map(|(_, axes)| axes.determinant() * of_cell).sum();
            assert!((area - of_cell).abs() < 1e-15, "{polygon:?} {counts:?}: {area}");
        }
    }
}
