//! Fill-reducing orders of symmetric matrices: geometric nested dissection and the postorder of an elimination tree.
//!
//! A set of vertices is cut in two near the plane through its median; the separator comes last, both halves are cut again.
//! Planes normal to the directions of short edges are tried: the directions of a grid, also if it is rotated or curved.
//! The separator is the rim of one half if a line of the grid runs along the plane, else the smallest vertex cut of a band around it.
//! Vertices at one point are cut as one. Only edges near a plane are examined, as their lengths are bounded.
//! If planes cut far more edges than a level of the graph has vertices, levels are tried too, as for thin cells along a bend.
//! The order depends on the pattern and the coordinates only, not on the number of threads.
//!
//! Sources: George, SIAM J. Numer. Anal. 10 (1973) 345-363; Liu, SIAM J. Matrix Anal. 11 (1990) 134-172.

mod band;
mod cut;
mod flow;
mod frame;
mod graph;
mod halving;
mod leaf;
mod level;
mod parts;
mod tree;

use cut::best_cut;
use graph::{Graph, Subgraph};
use leaf::minimum_degree;
use level::Levels;
use parts::{LEFT, SEPARATOR, index};

pub use tree::{factor_entries, postordered};

/// Sets of at most this many vertices are ordered by minimum degree.
const LEAF: usize = 100;
/// Least number of neighbours of a vertex that may count as connected to a large part of all.
const FEW: usize = 64;
/// Halves of more vertices than this are ordered in parallel.
const PARALLEL: usize = 4096;
/// Number of unknowns at one point above which coordinates say nothing about the pattern.
const CROWD: u32 = 256;

/// Nested dissection of the graph of a symmetric matrix by the coordinates of its unknowns.
///
/// `ptr`, `cols`: rows of the pattern, one triangle or both. Returns `order[new] = old`, or `None` if the coordinates do
/// not separate the unknowns (absent, not finite, too many at one point): use a minimum degree order then.
///
/// # Panics
/// If `ptr` is empty, a column lies beyond the rows, or there are 2^32 unknowns or more.
pub fn nested_dissection(ptr: &[usize], cols: &[usize], places: &[[f64; 3]]) -> Option<Vec<usize>> {
    let n = ptr.len() - 1;
    if places.len() != n || n == 0 || places.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    // unknowns of one node, and the multiplier that acts on it, share a point: one vertex with a weight
    let mut sorted: Vec<([u64; 3], u32)> = places.iter().zip(0..).map(|(x, i)| (x.map(ascending), i)).collect();
    sorted.sort_unstable();
    let mut start = vec![0u32];
    start.extend((1..n).filter(|&k| sorted[k - 1].0 != sorted[k].0).map(index));
    let groups = start.len();
    start.push(index(n));
    if start.windows(2).any(|w| w[1] - w[0] > CROWD) && groups < n.div_ceil(8) {
        return None;
    }
    let sorted: Vec<u32> = sorted.into_iter().map(|(_, i)| i).collect();
    let members = |g: usize| &sorted[start[g] as usize..start[g + 1] as usize];
    let mut group = vec![0u32; n];
    for g in 0..groups {
        members(g).iter().for_each(|&i| group[i as usize] = index(g));
    }
    let graph = Graph::between(ptr, cols, &group, &sorted, &start);
    drop(group);

    // a vertex connected to a large part of all others (e.g. the unknown of a rigid body) would be in every separator
    let bound = (10.0 * (groups as f64).sqrt()).max(FEW as f64) as usize;
    let dense: Vec<bool> = (0..groups).map(|g| graph.neighbours(g).len() > bound).collect();
    let num_dense = dense.iter().filter(|&&d| d).count();
    let keep_dense = num_dense == 0 || 10 * num_dense > groups;
    let weight = start.windows(2).map(|w| w[1] - w[0]).collect();
    let whole = Subgraph::whole(graph, weight, scaled((0..groups).map(|g| places[members(g)[0] as usize]).collect()));
    // groups ascend by their coordinates: the first lies at one end
    let mut order = if keep_dense {
        dissect(&whole, &whole, Levels::width(&whole))
    } else {
        let label: Vec<u8> = dense.iter().map(|&d| if d { SEPARATOR } else { LEFT }).collect();
        let [rest, _] = whole.halves(&label);
        dissect(&rest, &whole, Levels::width(&rest))
    };
    if !keep_dense {
        order.extend((0..groups).filter(|&g| dense[g]).map(index));
    }
    let mut result = Vec::with_capacity(n);
    for g in order {
        result.extend(members(g as usize).iter().map(|&i| i as usize));
    }
    Some(result)
}

/// Order of the ids of a part of `whole`, a body with levels of mean weight `width`: left half, right half, separator.
fn dissect(piece: &Subgraph, whole: &Subgraph, width: f64) -> Vec<u32> {
    let n = piece.ids.len();
    if n <= LEAF {
        return minimum_degree(piece, whole);
    }
    let Some((label, width)) = best_cut(piece, width) else {
        return piece.ids.clone();
    };
    let [left, right] = piece.halves(&label);
    let separator = (0..n).filter(|&v| label[v] == SEPARATOR).map(|v| piece.ids[v]);
    let (mut order, right) = if n > PARALLEL {
        rayon::join(|| dissect(&left, whole, width), || dissect(&right, whole, width))
    } else {
        (dissect(&left, whole, width), dissect(&right, whole, width))
    };
    order.extend(right);
    order.extend(separator);
    order
}

/// Coordinates times the power of two that brings the largest near 1: the same cuts, and squares of distances that
/// neither underflow nor overflow.
fn scaled(mut places: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    let size = places.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    if size > 0.0 {
        // in two steps: the power for the smallest numbers is too large for one
        let exponent = size.log2().floor() as i32;
        let (some, rest) = (2f64.powi(-(exponent / 2)), 2f64.powi(exponent / 2 - exponent));
        places.iter_mut().flatten().for_each(|x| *x = *x * some * rest);
    }
    places
}

/// Order-preserving bits of a finite number; zero without a sign.
fn ascending(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}
