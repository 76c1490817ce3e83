//! W4: finite elements on the unit square and cube, as meshes of cells without any grid.

use crate::bodies::Jet;
use crate::run::{Options, Record, whole};
use faying::basis::Cell;
use faying::linalg::{Matrix, Vector};
use faying::physics::{Conductor, Hooke, Material};
use faying::space::{CellBlock, Dimension, Mapping, Mesh, MeshCells, Trace};
use std::f64::consts::PI;

/// Largest n at which W4c is solved.
const SOLVED: usize = 16;

/// Straight cells on the unit box, n per direction; simplices cut every square or cube along the diagonal from its lowest to its highest
/// corner, into 2 or 6.
pub fn cells<const N: usize>(cell: Cell, n: usize) -> MeshCells<N> {
    let count = |m: usize| m.pow(N as u32);
    let split = |mut i: usize, m: usize| -> [usize; N] {
        std::array::from_fn(|_| {
            let k = i % m;
            i /= m;
            k
        })
    };
    let points = (0..count(n + 1)).map(|i| Vector::<N>::from(split(i, n + 1).map(|k| k as f64 / n as f64))).collect();
    let point = |at: &[usize; N]| at.iter().rev().fold(0, |p, &k| p * (n + 1) + k);
    let mut nodes = Vec::new();
    for box_ in (0..count(n)).map(|e| split(e, n)) {
        match cell {
            Cell::Simplex => {
                for mut order in permutations::<N>() {
                    let (mut at, mut path) = (box_, vec![point(&box_)]);
                    for k in &mut order {
                        at[*k] += 1;
                        path.push(point(&at));
                    }
                    nodes.extend(path);
                }
            }
            _ => nodes.extend((0..1usize << N).map(|c| point(&std::array::from_fn(|k| box_[k] + (c >> k & 1))))),
        }
    }
    MeshCells { points, blocks: vec![CellBlock { cell, order: 1, nodes }], tags: Vec::new() }
}

/// The same mesh with points and cells in random order.
fn shuffled<const N: usize>(mut mesh: MeshCells<N>) -> MeshCells<N> {
    let mut state = 1u64;
    let mut order = |n: usize| {
        let mut next = |_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            state >> 33
        };
        let mut keyed: Vec<(u64, usize)> = (0..n).map(|i| (next(i), i)).collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|k| k.1).collect::<Vec<usize>>()
    };
    let points = order(mesh.points.len());
    let mut number = vec![0; points.len()];
    points.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    mesh.points = points.iter().map(|&old| mesh.points[old]).collect();
    for block in &mut mesh.blocks {
        let each = if block.cell == Cell::Simplex { N + 1 } else { 1 << N };
        let cells = order(block.nodes.len() / each).into_iter();
        block.nodes = cells.flat_map(|c| block.nodes[c * each..(c + 1) * each].iter().map(|&p| number[p]).collect::<Vec<_>>()).collect();
    }
    mesh
}

/// The same mesh with its points moved along the diagonal inside the box: no cell is a parallelepiped.
fn moved<const N: usize>(mut mesh: MeshCells<N>) -> MeshCells<N> {
    for x in &mut mesh.points {
        *x += Vector::repeat(0.1 * x.iter().map(|x| (PI * x).sin()).product::<f64>());
    }
    mesh
}

/// All orders of the axes.
fn permutations<const N: usize>() -> Vec<[usize; N]> {
    let all = (0..N.pow(N as u32)).map(|i| -> [usize; N] { std::array::from_fn(|k| i / N.pow(k as u32) % N) });
    all.filter(|order| (0..N).all(|k| order.contains(&k))).collect()
}

/// (w, 0, ..), w the product of sin(pi x_k).
fn wave<const C: usize, const N: usize>(x: &Vector<N>) -> Jet<C, N> {
    let sines: [(f64, f64); N] = std::array::from_fn(|k| (PI * x[k]).sin_cos());
    // the product with the functions of some directions exchanged for their derivatives
    let product = |order: [usize; N]| -> f64 {
        (0..N)
            .map(|k| match order[k] {
                0 => sines[k].0,
                1 => PI * sines[k].1,
                _ => -PI * PI * sines[k].0,
            })
            .product()
    };
    let mut jet: Jet<C, N> = (Vector::zeros(), Matrix::zeros(), [Matrix::zeros(); C]);
    jet.0[0] = product([0; N]);
    for k in 0..N {
        let once = |l: usize| usize::from(l == k);
        jet.1[(0, k)] = product(std::array::from_fn(once));
        for l in 0..N {
            jet.2[0][(k, l)] = product(std::array::from_fn(|m| once(m) + usize::from(m == l)));
        }
    }
    jet
}

fn solved<const C: usize, const S: usize, const N: usize>(
    name: &str,
    [p, n]: [usize; 2],
    cell: Cell,
    material: &dyn Material<C, N>,
    options: &Options,
) -> Record
where
    Trace<S, N>: Dimension<S, N>,
{
    let body = |n| {
        let mesh = match name.split_once('-').map(|n| n.1) {
            Some("random") => shuffled(cells(cell, n)),
            Some("moved") => moved(cells(cell, n)),
            _ => cells(cell, n),
        };
        Mesh::<S, N>::from_cells(&mesh, p, Mapping::Exact).unwrap()
    };
    let wave = wave::<C, N> as fn(&Vector<N>) -> Jet<C, N>;
    if name != "W4c" || n <= SOLVED {
        return whole(name, [p, n], &body(n), material, wave, true, options).0;
    }
    let mut record = whole(name, [p, n], &body(n), material, wave, false, options).0;
    if options.solve {
        record.solved_as(&whole(name, [p, SOLVED], &body(SOLVED), material, wave, true, options).0);
    }
    record
}

/// The number of cells per direction that a workload of this family is defined with.
pub fn default_n(name: &str) -> usize {
    match name {
        "W4c" => 30,
        "W4d" | "W4d-random" | "W4d-moved" | "W4f" => 24,
        _ => 256,
    }
}

/// W4a to W4f, W4a and W4d in random order as `W4a-random` and `W4d-random`, W4b and W4d with cells of other shapes as `W4b-moved` and
/// `W4d-moved`; `None` for another name.
pub fn record(name: &str, p: usize, n: usize, options: &Options) -> Option<Record> {
    let (flat, solid) = (Conductor::<2>::try_new(1.0).unwrap(), Conductor::<3>::try_new(1.0).unwrap());
    Some(match name {
        "W4a" | "W4a-random" => solved::<1, 1, 2>(name, [p, n], Cell::Simplex, &flat, options),
        "W4b" | "W4b-moved" => solved::<1, 1, 2>(name, [p, n], Cell::Tensor, &flat, options),
        "W4c" => solved::<1, 2, 3>(name, [p, n], Cell::Simplex, &solid, options),
        "W4d" | "W4d-random" | "W4d-moved" => solved::<1, 2, 3>(name, [p, n], Cell::Tensor, &solid, options),
        "W4e" => solved::<2, 1, 2>(name, [p, n], Cell::Simplex, &Hooke::<2>::plane_strain(1.0, 0.3).unwrap(), options),
        "W4f" => solved::<3, 2, 3>(name, [p, n], Cell::Tensor, &Hooke::<3>::solid(1.0, 0.3).unwrap(), options),
        _ => return None,
    })
}
