//! Meshes of boxes as data: any shape, order, map, and any order of the corners in each cell.

#![allow(clippy::unwrap_used, dead_code)]

use faying::basis::Cell;
use faying::geometry::cell;
use faying::linalg::Vector;
use faying::space::{CellBlock, FacetTag, MeshCells};
use std::collections::{BTreeMap, HashMap};

/// Which cells a box is cut into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shapes {
    Tensor,
    Simplex,
    /// Boxes by turns; in the plane only.
    Mixed,
}

/// Numbers from 0 to 1, always the same.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize % n
    }
}

/// The multi-indices of a cell's nodes, first axis fastest.
pub fn lattice<const N: usize>(cell: Cell, order: usize) -> Vec<[usize; N]> {
    (0..(order + 1).pow(N as u32))
        .map(|mut a| {
            std::array::from_fn(|_| {
                let i = a % (order + 1);
                a /= order + 1;
                i
            })
        })
        .filter(|i: &[usize; N]| cell == Cell::Tensor || i.iter().sum::<usize>() <= order)
        .collect()
}

/// All orders of 0 .. n.
pub fn orders(n: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![Vec::new()];
    }
    let shorter = orders(n - 1);
    shorter.iter().flat_map(|o| (0..n).map(|at| [&o[..at], &[n - 1], &o[at..]].concat())).collect()
}

/// The box [0, 1]^N of `counts` boxes cut into `shapes` of geometry `order`, carried by `map`. Cells list their corners as `random` has it,
/// where it is there. Sides x0, x1, y0, ... are tags.
pub fn boxes<const N: usize>(
    counts: [usize; N],
    shapes: Shapes,
    order: usize,
    random: Option<u64>,
    map: &dyn Fn(&Vector<N>) -> Vector<N>,
) -> MeshCells<N> {
    let mut random = random.map(Random);
    let mut mesh = MeshCells::<N>::default();
    let mut known: HashMap<[i64; 3], usize> = HashMap::new();
    let mut blocks: BTreeMap<bool, Vec<usize>> = BTreeMap::new();
    let mut tags: BTreeMap<String, Vec<[usize; 4]>> = BTreeMap::new();
    let mut point = |mesh: &mut MeshCells<N>, u: &Vector<N>| {
        let key = std::array::from_fn(|k| if k < N { (u[k] * 1e9).round() as i64 } else { 0 });
        *known.entry(key).or_insert_with(|| {
            mesh.points.push(map(u));
            mesh.points.len() - 1
        })
    };
    for b in 0..counts.iter().product() {
        let mut rest = b;
        let at: [usize; N] = counts.map(|n| {
            let i = rest % n;
            rest /= n;
            i
        });
        let corner = |bits: usize| Vector::<N>::from_fn(|k, _| (at[k] + (bits >> k & 1)) as f64 / counts[k] as f64);
        let simplex = shapes == Shapes::Simplex || shapes == Shapes::Mixed && at.iter().sum::<usize>() % 2 == 1;
        let mut cells: Vec<Vec<Vector<N>>> = Vec::new();
        if simplex {
            for path in orders(N) {
                let mut bits = 0;
                let steps = path.iter().map(|k| {
                    bits |= 1 << k;
                    bits
                });
                cells.push(std::iter::once(0).chain(steps).map(corner).collect());
            }
        } else {
            cells.push((0..1 << N).map(corner).collect());
        }
        for mut corners in cells {
            if let Some(random) = &mut random {
                shuffle(&mut corners, simplex, random);
            }
            let kind = if simplex { Cell::Simplex } else { Cell::Tensor };
            let axes: Vec<Vector<N>> = (0..N).map(|k| corners[if simplex { k + 1 } else { 1 << k }] - corners[0]).collect();
            for i in lattice::<N>(kind, order) {
                let u = (0..N).fold(corners[0], |u, k| u + axes[k] * (i[k] as f64 / order as f64));
                let p = point(&mut mesh, &u);
                blocks.entry(simplex).or_default().push(p);
            }
            for face in cell::faces::<N, f64>(kind) {
                for k in 0..N {
                    for end in 0..2 {
                        if face.corners.iter().all(|&c| (corners[c][k] - end as f64).abs() < 1e-9) {
                            let mut ids = [usize::MAX; 4];
                            face.corners.iter().enumerate().for_each(|(a, &c)| ids[a] = point(&mut mesh, &corners[c]));
                            tags.entry(format!("{}{end}", ["x", "y", "z"][k])).or_default().push(ids);
                        }
                    }
                }
            }
        }
    }
    let kind = |simplex| if simplex { Cell::Simplex } else { Cell::Tensor };
    mesh.blocks = blocks.into_iter().map(|(simplex, nodes)| CellBlock { cell: kind(simplex), order, nodes }).collect();
    mesh.tags = tags.into_iter().map(|(name, corners)| FacetTag { name, corners }).collect();
    mesh
}

/// Lists the corners of a cell as seen after a turn or a reflection.
fn shuffle<const N: usize>(corners: &mut [Vector<N>], simplex: bool, random: &mut Random) {
    let old = corners.to_vec();
    if simplex {
        let all = orders(N + 1);
        let order = &all[random.below(all.len())];
        (0..=N).for_each(|c| corners[c] = old[order[c]]);
    } else {
        let all = orders(N);
        let (axes, flips) = (&all[random.below(all.len())], random.below(1 << N));
        for (c, place) in corners.iter_mut().enumerate() {
            *place = old[flips ^ (0..N).filter(|&k| c >> k & 1 == 1).map(|k| 1 << axes[k]).sum::<usize>()];
        }
    }
}

/// A shear and a shift of the inner corners of boxes that keeps straight cells straight where it is used with order 1.
pub fn shaken<const N: usize>(counts: [usize; N], by: f64) -> impl Fn(&Vector<N>) -> Vector<N> {
    move |u| {
        let inside = (0..N).all(|k| u[k] > 1e-9 && u[k] < 1.0 - 1e-9);
        let seed = (0..N).map(|k| (u[k] * 1e4 + 17.0 * k as f64).sin()).sum::<f64>();
        let shift = |k: usize| if inside { by * (43.7 * seed + k as f64).sin() / counts[k] as f64 } else { 0.0 };
        Vector::from_fn(|k, _| u[k] + shift(k) + 0.1 * u[(k + 1) % N])
    }
}

/// A smooth map with bent sides.
pub fn bent<const N: usize>(u: &Vector<N>) -> Vector<N> {
    Vector::from_fn(|k, _| u[k] + 0.08 * (2.0 * u[(k + 1) % N] + 0.7 * k as f64).sin() * (1.0 + u[k]))
}
