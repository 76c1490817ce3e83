//! Coordinates of the unknowns of a patch: the mean of x over the points, weighted by the squared function.

use super::axis::AxisTable;
use super::map::{self, ElementScratch, Map, MapTile, numbers};
use super::tensor_field::{Curves, Tile};
use super::{Patch, Patches};
use crate::parallel;
use pulp::{NullaryFnOnce, Simd, bytemuck};

/// Sums of a plane of points, contracted with squared functions: `[function][x.., 1]`, times 1 / W².
type Contracted = Vec<f64>;

struct Planes<'a, 'p, const N: usize> {
    patch: &'a Patch<'p>,
}

impl<const N: usize> pulp::WithSimd for Planes<'_, '_, N> {
    type Output = Vec<Contracted>;
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Contracted> {
        if S::IS_SCALAR {
            return Vec::new();
        }
        let axes = &self.patch.axes;
        let owners = [axes[1].owners(), axes[N - 1].owners()];
        let tasks = if N == 3 { axes[2].points() } else { axes[1].points().div_ceil(S::F64_LANES) };
        // in the plane one contraction serves all tiles
        let all = (N == 2).then(|| Contraction::of::<N>(self.patch, (0, 0)));
        let planes: Vec<Vec<Contracted>> = parallel::map(tasks, |k| planes::<S, N>(simd, self.patch, &owners, k, all.as_ref()));
        planes.into_iter().flatten().collect()
    }
}

/// The nets of map and weights without all but the second direction.
#[derive(Default)]
struct Contraction {
    map: Curves,
    weight: Curves,
}

impl Contraction {
    /// At a point with its element of the third direction.
    fn of<const N: usize>(patch: &Patch<'_>, slow: (usize, usize)) -> Self {
        let (mut all, mut scratch) = (Self::default(), Vec::new());
        let [fast, second] = [0, 1].map(|k| 0..patch.axes[k].elements());
        if let Map::TensorField(net) = &patch.map {
            net.curves::<N>(slow, [&fast, &second], &mut all.map, &mut scratch);
        }
        if let Some((net, _)) = &patch.weight {
            net.curves::<N>(slow, [&fast, &second], &mut all.weight, &mut scratch);
        }
        all
    }
}

/// In space the plane of slow point `k`; in the plane, with the contraction of `all`, the lines of the points of tile `k`.
fn planes<S: Simd, const N: usize>(
    simd: S,
    patch: &Patch<'_>,
    owners: &[Vec<usize>; 2],
    k: usize,
    all: Option<&Contraction>,
) -> Vec<Contracted> {
    let (axes, lanes) = (&patch.axes, S::F64_LANES);
    let (q0, q1) = (axes[0].points(), axes[1].points());
    let slow = if N == 3 { (k, owners[1][k]) } else { (0, 0) };
    let elements = 0..axes[0].elements();
    let (from, to) = if N == 3 { (0, q1) } else { (k * lanes, ((k + 1) * lanes).min(q1)) };
    let own;
    let curves = match all {
        Some(all) => all,
        None => {
            own = Contraction::of::<N>(patch, slow);
            &own
        }
    };
    let mut geo = vec![simd.splat_f64s(0.0); q0 * numbers(N)];
    let (mut tile, mut element) = (Tile::default(), ElementScratch::new(&patch.map));
    let mut grid = vec![0.0; (to - from) * q0 * (N + 1)];
    for first in (from..to).step_by(lanes) {
        let here: Vec<(usize, usize)> = (first..first + lanes).map(|q| q.min(to - 1)).map(|q| (q, owners[0][q])).collect();
        let place = MapTile { along: [elements.start, elements.end], lanes: &here, slow };
        match &patch.map {
            Map::TensorField(net) => {
                net.tile(simd, &here, &mut tile);
                simd.vectorize(Positions::<'_, S, N> { simd, net, axes, place, curves: &curves.map, tile: &tile, out: &mut geo });
            }
            Map::Elements(..) => map::fill_elements::<S, N>(simd, axes, place, &mut element, &mut geo),
        }
        let mut squares = vec![1.0; q0 * lanes];
        if let Some((net, _)) = &patch.weight {
            net.tile(simd, &here, &mut tile);
            for q in 0..q0 {
                let w = net.at::<S, N, 1>(simd, q, &curves.weight, &tile).0;
                let w: &[f64] = bytemuck::cast_slice(&w);
                squares[q * lanes..][..lanes].iter_mut().zip(w).for_each(|(s, w)| *s = 1.0 / (w * w));
            }
        }
        let geo: &[f64] = bytemuck::cast_slice(&geo);
        for lane in 0..lanes.min(to - first) {
            for q in 0..q0 {
                let out = &mut grid[((first + lane - from) * q0 + q) * (N + 1)..][..N + 1];
                let square = squares[q * lanes + lane];
                for c in 0..N {
                    out[c] = geo[(q * numbers(N) + c) * lanes + lane] * square;
                }
                out[N] = square;
            }
        }
    }
    let width = axes[0].functions * (N + 1);
    let rows: Vec<Contracted> = grid.chunks_exact(q0 * (N + 1)).map(|line| contracted(&axes[0], line, N + 1)).collect();
    if N == 2 { rows } else { vec![contracted(&axes[1], &rows.concat(), width)] }
}

/// sum_q N_i(q)² values[q][..] for all functions of an axis.
fn contracted(axis: &AxisTable, values: &[f64], width: usize) -> Contracted {
    let mut out = vec![0.0; axis.functions * width];
    for e in 0..axis.elements() {
        for q in axis.start[e]..axis.start[e + 1] {
            for a in 0..axis.active {
                let square = axis.values[q * axis.active + a].powi(2);
                let to = &mut out[(axis.first[e] + a) * width..][..width];
                to.iter_mut().zip(&values[q * width..][..width]).for_each(|(to, v)| *to += square * v);
            }
        }
    }
    out
}

struct Positions<'a, S: Simd, const N: usize> {
    simd: S,
    net: &'a super::TensorField,
    axes: &'a [AxisTable],
    place: MapTile<'a>,
    curves: &'a Curves,
    tile: &'a Tile<S::f64s>,
    out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Positions<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        map::fill_net::<S, N>(self.simd, self.net, self.axes, self.place, self.curves, self.tile, self.out);
    }
}

impl Patches<'_> {
    /// A point per unknown of a field of `components` components; these patches have two points per direction.
    ///
    /// A function that is a sum of several of a patch gets the mean weighted by the sum of their squares.
    pub fn mean_coordinates(&self, components: usize) -> Vec<[f64; 3]> {
        let parts = self.patches.iter().map(Patch::place_sums);
        let sums = match &self.glue {
            None => parts.flatten().collect(),
            Some(glue) => {
                let mut all = vec![[0.0; 4]; glue.functions];
                for (&id, own) in glue.ids.iter().zip(parts.flatten()) {
                    all[id as usize].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                }
                all
            }
        };
        let mut places = Vec::with_capacity(components * sums.len());
        for sum in sums {
            let total = if sum[3] > 0.0 { sum[3] } else { 1.0 };
            places.extend(std::iter::repeat_n([sum[0] / total, sum[1] / total, sum[2] / total], components));
        }
        places
    }
}

impl Patch<'_> {
    /// Integrals of x and 1, weighted by the squared function, up to the size of elements: every one counts the same.
    fn place_sums(&self) -> Vec<[f64; 4]> {
        let (n, arch) = (self.axes.len(), self.arch);
        let planes = if n == 2 { arch.dispatch(Planes::<2> { patch: self }) } else { arch.dispatch(Planes::<3> { patch: self }) };
        let slow = &self.axes[n - 1];
        let owners = slow.owners();
        let rows: Vec<Contracted> = parallel::map(slow.functions, |i| {
            let mut sum = vec![0.0; planes.first().map_or(0, Vec::len)];
            let (from, to) = slow.support[i];
            for q in slow.start[from]..slow.start[to] {
                let square = slow.values[q * slow.active + i - slow.first[owners[q]]].powi(2);
                sum.iter_mut().zip(&planes[q]).for_each(|(s, v)| *s += square * v);
            }
            sum
        });
        let scale = |i: usize| self.weight.as_ref().map_or(1.0, |(_, weights)| weights[i] * weights[i]);
        let sums = rows.iter().flat_map(|row| row.chunks_exact(n + 1)).enumerate();
        sums.map(|(i, sum)| std::array::from_fn(|k| scale(i) * if k == 3 { sum[n] } else { sum[..n].get(k).copied().unwrap_or(0.0) }))
            .collect()
    }
}
