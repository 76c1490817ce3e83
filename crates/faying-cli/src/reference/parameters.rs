//! Elements of a body by the parameters of its patch: lookup between two grids of a patch without a search.

use faying::basis::Order;
use faying::geometry::MapTable;
use faying::linalg::Vector;
use faying::space::Space;

/// Equal points of two grids differ by at most this fraction of an element: the round-off of one map.
const SAME: f64 = 1e-9;

/// Breakpoints of a grid per direction; elements are numbered with the first direction fastest.
#[derive(Clone, Debug)]
pub struct Parameters<const N: usize>(pub [Vec<f64>; N]);

impl<const N: usize> Parameters<N> {
    /// Number of elements in a direction.
    pub fn count(&self, direction: usize) -> usize {
        self.0[direction].len() - 1
    }

    /// The parameters of a local point of an element.
    pub fn at(&self, element: usize, xi: &Vector<N>) -> Vector<N> {
        let mut rest = element;
        Vector::from_fn(|k, _| {
            let n = self.count(k);
            let e = rest % n;
            rest /= n;
            self.0[k][e] + xi[k] * (self.0[k][e + 1] - self.0[k][e])
        })
    }

    /// The element with these parameters and the local point in it; parameters outside belong to the nearest element.
    pub fn find(&self, parameters: &Vector<N>) -> (usize, Vector<N>) {
        let (mut element, mut stride, mut xi) = (0, 1, Vector::zeros());
        for (k, list) in self.0.iter().enumerate() {
            let e = list.partition_point(|t| *t <= parameters[k]).clamp(1, self.count(k)) - 1;
            element += stride * e;
            stride *= self.count(k);
            xi[k] = ((parameters[k] - list[e]) / (list[e + 1] - list[e])).clamp(0.0, 1.0);
        }
        (element, xi)
    }

    /// Whether equal parameters are equal points of two bodies of the same patch: their elements are numbered like their grids, and their
    /// maps are the same. Checked at two points of every element of `own`.
    pub fn agree(own: (&Self, &dyn Space<N, N>), other: (&Self, &dyn Space<N, N>)) -> bool {
        let whole = |g: &Self, s: &dyn Space<N, N>| (0..N).map(|k| g.count(k)).product::<usize>() == s.num_elements();
        if !whole(own.0, own.1) || !whole(other.0, other.1) {
            return false;
        }
        let probes = [Vector::from_fn(|k, _| 0.2 + 0.15 * k as f64), Vector::from_fn(|k, _| 0.9 - 0.2 * k as f64)];
        let (mut here, mut there) = (MapTable::new(), MapTable::new());
        (0..own.1.num_elements()).all(|e| {
            own.1.map(e, &probes, Order::Values, &mut here);
            probes.iter().zip(&here.x).all(|(xi, x)| {
                let (k, eta) = other.0.find(&own.0.at(e, xi));
                other.1.map(k, &[eta], Order::Values, &mut there);
                (there.x[0] - x).norm() <= SAME * own.1.bounds(e).diagonal().min(other.1.bounds(k).diagonal())
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_keeps_its_parameters_from_grid_to_grid() {
        let coarse = Parameters([vec![0.0, 0.4, 1.0], vec![0.0, 2.0]]);
        let fine = Parameters([vec![0.0, 0.2, 0.4, 0.7, 1.0], vec![0.0, 0.5, 2.0]]);
        let (e, xi) = fine.find(&coarse.at(1, &Vector::<2>::new(0.75, 0.1)));
        // u = 0.4 + 0.75 0.6 = 0.85 in [0.7, 1], v = 0.2 in [0, 0.5]
        assert_eq!(e, 3);
        assert!((xi - Vector::<2>::new(0.5, 0.4)).norm() < 1e-14);
        assert_eq!(fine.find(&Vector::<2>::new(1.0, 2.0)), (7, Vector::<2>::new(1.0, 1.0)));
    }
}
