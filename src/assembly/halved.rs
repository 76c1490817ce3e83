//! Integrals by halving: elements are cut where the halves sum up to something else.

use crate::basis::{Cell, Order};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Vector, measure};
use crate::quadrature::{Quadrature, Rule, TensorRule};

/// A sum over a box that is within this share of the sum over its halves is kept.
const SETTLED: f64 = 1e-4;
/// Logarithm to base 2 of the number of boxes into which all elements together may be cut.
const BOXES: f64 = 20.0;
/// Most halvings of an element.
const MOST: usize = 16;

/// Integrals over the elements of a geometry by Gauss rules on boxes that are halved in every direction until the halves of none sum up to
/// something else, for functions that jump inside of elements.
///
/// Every element is halved at least once. Its boxes lie in the unit cube, which is collapsed onto a simplex: xi_k = u_k prod_(j < k) (1 - u_j).
#[derive(Debug)]
pub struct Halved<'a, const D: usize, const N: usize> {
    geometry: &'a dyn Geometry<D, N>,
    rule: Rule<D>,
    least: usize,
    most: usize,
    noise: f64,
}

/// Memory of [`Halved::element`], kept between its calls.
#[derive(Debug)]
pub struct HalvedScratch<const D: usize, const N: usize> {
    points: Vec<Vector<D>>,
    table: MapTable<D, N>,
}

impl<const D: usize, const N: usize> Default for HalvedScratch<D, N> {
    fn default() -> Self {
        Self { points: Vec::new(), table: MapTable::new() }
    }
}

/// A box of an element: its lower corner and the length of its edges.
type Part<const D: usize> = (Vector<D>, f64);

impl<'a, const D: usize, const N: usize> Halved<'a, D, N> {
    /// Integrals with `points` Gauss points per direction of every box; all elements are halved `least` times, at least once, whatever the
    /// halves sum up to, unless that makes too many boxes.
    pub fn new(geometry: &'a dyn Geometry<D, N>, points: usize, least: usize) -> Self {
        let room = BOXES - (geometry.num_elements().max(1) as f64).log2();
        let most = ((room / D as f64).floor().max(1.0) as usize).min(MOST);
        Self { geometry, rule: TensorRule::<D>::gauss([points; D]).rule(0).clone(), least: least.clamp(1, most), most, noise: 0.0 }
    }

    /// Takes boxes whose halves change their sums by at most `noise` for settled: what is round-off in data is not followed.
    #[must_use]
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// ∫ f over an element, f(x, dx/dxi) per measure.
    pub fn element<const K: usize>(
        &self,
        element: usize,
        scratch: &mut HalvedScratch<D, N>,
        f: &dyn Fn(&Vector<N>, &crate::linalg::Matrix<N, D>) -> [f64; K],
    ) -> [f64; K] {
        let whole = (Vector::zeros(), 1.0);
        let sum = self.sum(element, &whole, scratch, f);
        self.of_box(element, &whole, &sum, 0, scratch, f)
    }

    /// The integral over a box, by its halves if they settle it, else by theirs.
    fn of_box<const K: usize>(
        &self,
        element: usize,
        (corner, length): &Part<D>,
        own: &[f64; K],
        depth: usize,
        scratch: &mut HalvedScratch<D, N>,
        f: &dyn Fn(&Vector<N>, &crate::linalg::Matrix<N, D>) -> [f64; K],
    ) -> [f64; K] {
        let half = 0.5 * length;
        let part = |k: usize| (corner + Vector::<D>::from_fn(|d, _| half * (k >> d & 1) as f64), half);
        // at most three directions
        let mut halves = [[0.0; K]; 8];
        let mut total = [0.0; K];
        for (k, sum) in halves.iter_mut().enumerate().take(1 << D) {
            *sum = self.sum(element, &part(k), scratch, f);
            total.iter_mut().zip(&*sum).for_each(|(t, s)| *t += s);
        }
        let size: f64 = halves.iter().flatten().map(|s| s.abs()).sum();
        let change: f64 = total.iter().zip(own).map(|(t, o)| (t - o).abs()).sum();
        let settled = depth + 1 >= self.least && change <= self.noise.max(SETTLED * size);
        if settled || depth + 1 >= self.most || !size.is_finite() {
            return total;
        }
        let mut finer = [0.0; K];
        for (k, sum) in halves.iter().enumerate().take(1 << D) {
            let sum = self.of_box(element, &part(k), sum, depth + 1, scratch, f);
            finer.iter_mut().zip(&sum).for_each(|(t, s)| *t += s);
        }
        finer
    }

    /// The Gauss rule on a box.
    fn sum<const K: usize>(
        &self,
        element: usize,
        (corner, length): &Part<D>,
        HalvedScratch { points, table }: &mut HalvedScratch<D, N>,
        f: &dyn Fn(&Vector<N>, &crate::linalg::Matrix<N, D>) -> [f64; K],
    ) -> [f64; K] {
        let simplex = D > 1 && self.geometry.cell(element) == Cell::Simplex;
        points.clear();
        points.extend(self.rule.points.iter().map(|p| {
            let mut x = corner + p * *length;
            let mut left = 1.0;
            for k in (0..D).filter(|_| simplex) {
                let u = x[k];
                x[k] = u * left;
                left *= 1.0 - u;
            }
            x
        }));
        self.geometry.map(element, points, Order::Gradients, table);
        let mut total = [0.0; K];
        for ((p, w), (x, j)) in self.rule.points.iter().zip(&self.rule.weights).zip(table.x.iter().zip(&table.jacobian)) {
            // (1 - u_k) once per direction behind k
            let collapsed: f64 =
                if simplex { (0..D).map(|k| (1.0 - (corner[k] + length * p[k])).powi((D - 1 - k) as i32)).product() } else { 1.0 };
            let ds = w * length.powi(D as i32) * collapsed * measure(j);
            total.iter_mut().zip(f(x, j)).for_each(|(t, v)| *t += v * ds);
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{ControlNet, shapes};
    use crate::space::{Body, Mesh, Patch, PatchSpec};

    fn over<const D: usize, const N: usize>(geometry: &dyn Geometry<D, N>, f: &dyn Fn(&Vector<N>) -> f64) -> f64 {
        let (halved, mut scratch) = (Halved::new(geometry, 3, 2), HalvedScratch::default());
        (0..geometry.num_elements()).map(|e| halved.element(e, &mut scratch, &|x, _| [f(x)])[0]).sum()
    }

    /// Measures of what a line or a plane cuts off, and polynomials without a jump.
    #[test]
    fn jumps_inside_of_elements_are_found() {
        let square: ControlNet<2, 2> = shapes::rectangle([0.0, 0.0], [2.0, 1.0]).unwrap();
        let spec = PatchSpec::new(square).with_elements([3, 2]);
        let patch = Patch::<1, 2>::try_new(&spec).unwrap();
        for cell in [Cell::Tensor, Cell::Simplex] {
            let mut spec = spec.clone();
            spec.cells = cell;
            let mesh = Mesh::<1, 2>::from_patch(&spec).unwrap();
            for space in [mesh.space(), patch.space()] {
                for cut in [0.1, 0.97, 1.3] {
                    let area = over::<2, 2>(&**space, &|x| f64::from(u8::from(x[0] < cut)));
                    assert!((area - cut).abs() < 2e-3, "{cell:?} {cut}: {area}");
                    let below = over::<2, 2>(&**space, &|x| f64::from(u8::from(x[0] + x[1] < cut)));
                    let exact = 0.5 * cut * cut - 0.5 * (cut - 1.0).max(0.0).powi(2);
                    assert!((below - exact).abs() < 2e-3, "{cell:?} {cut}: {below}, {exact}");
                }
                let smooth = over::<2, 2>(&**space, &|x| x[0].powi(3) * x[1]);
                assert!((smooth - 2.0).abs() < 1e-12, "{cell:?}: {smooth}");
            }
            let side = mesh.trace("v1").unwrap();
            let length = over::<1, 2>(&*side.space, &|x| f64::from(u8::from(x[0] < 0.97)));
            assert!((length - 0.97).abs() < 1e-4, "{cell:?}: {length}");
        }
    }
}
