//! The smallest separator in a band of vertices.

use super::flow::Network;
use super::graph::Subgraph;
use super::halving::{Coordinate, cost};
use super::parts::index;
use super::parts::{LEFT, RIGHT, SEPARATOR};

/// Half width, as part of all vertices, of the band in which the smallest separator is sought.
const BAND: f64 = 0.1;
/// Half width of the band in separators of the straight cut, for large sets.
const LAYERS: usize = 2;

/// The smallest separator between the lowest and the highest coordinates, by maximum flow through the band between them.
pub(super) fn band_cut(piece: &Subgraph, coordinate: &Coordinate, separator: usize) -> Option<(f64, Vec<u8>)> {
    let t = coordinate.values();
    let n = t.len();
    let mut values = t.to_vec();
    let width = ((BAND * n as f64) as usize).min(LAYERS * separator);
    let low = *values.select_nth_unstable_by(n / 2 - width, f64::total_cmp).1;
    let high = *values.select_nth_unstable_by((n / 2 + width).min(n - 1), f64::total_cmp).1;
    let mut label: Vec<u8> = t
        .iter()
        .map(|&x| {
            if x < low {
                LEFT
            } else if x > high {
                RIGHT
            } else {
                SEPARATOR
            }
        })
        .collect();
    // an edge across the band leaves no separator inside it: both of its ends may be one
    let across = |v: usize| match label[v] {
        LEFT => t[v] + coordinate.reach(piece, v) > high && piece.neighbours(v).iter().any(|&u| label[u as usize] == RIGHT),
        RIGHT => t[v] - coordinate.reach(piece, v) < low && piece.neighbours(v).iter().any(|&u| label[u as usize] == LEFT),
        _ => false,
    };
    let far: Vec<usize> = (0..n).filter(|&v| across(v)).collect();
    // coordinates so unrelated to the edges make the flow expensive without gain
    if far.len() > n / 2 {
        return None;
    }
    far.into_iter().for_each(|v| label[v] = SEPARATOR);
    let band: Vec<usize> = (0..n).filter(|&v| label[v] == SEPARATOR).collect();
    let mut local = vec![u32::MAX; n];
    for (k, &v) in band.iter().enumerate() {
        local[v] = index(k);
    }
    // vertex k is an arc from node 2 k to 2 k + 1, with its weight as capacity
    let (source, sink) = (2 * band.len(), 2 * band.len() + 1);
    let touches = |v: usize, side| piece.neighbours(v).iter().any(|&u| label[u as usize] == side);
    let ends: Vec<[bool; 2]> = band.iter().map(|&v| [touches(v, LEFT), touches(v, RIGHT)]).collect();
    let mut arcs: Vec<(u32, u32, u32)> = Vec::new();
    let mut arc = |from, to, room| arcs.push((index(from), index(to), room));
    for (k, &v) in band.iter().enumerate() {
        arc(2 * k, 2 * k + 1, piece.weight[v]);
        if ends[k][0] {
            arc(source, 2 * k, u32::MAX);
        }
        if ends[k][1] {
            arc(2 * k + 1, sink, u32::MAX);
            continue;
        }
        // no path needs to return to the source's neighbours, nor to continue from the sink's
        for &u in piece.neighbours(v) {
            let to = local[u as usize];
            if to != u32::MAX && !ends[to as usize][0] {
                arc(2 * k + 1, 2 * to as usize, u32::MAX);
            }
        }
    }
    let mut net = Network::new(sink + 1, &arcs);
    net.saturate(source, sink);
    let reached = net.reached(source);
    for (k, &v) in band.iter().enumerate() {
        label[v] = match (reached[2 * k], reached[2 * k + 1]) {
            (_, true) => LEFT,
            (true, false) => SEPARATOR,
            (false, false) => RIGHT,
        };
    }
    Some((cost(piece, &label)?, label))
}
