//! Components of D that enter each component of the contraction along the fastest direction.
//!
//! Directions of local coordinates: 0 is the fastest; 1 in the plane, 2 and 1 in space are the outer ones; index N is
//! the value itself. An outer direction keeps its component; the fastest one and the value share "neither".

use super::fast::{ContractionGroup, SS, SV, VS, VV};
use super::lanes::COMPONENTS_AT_ONCE;
use super::middle;

/// Components of the contraction along the fastest direction in N dimensions: (outer directions + 1)².
pub(super) const fn components(n: usize) -> usize {
    n * n
}

/// The groups of a form; `symmetric`: D_ab = D_ba, `extended`: D has the value as index N.
pub(super) fn groups<const N: usize>(symmetric: bool, extended: bool) -> Vec<ContractionGroup> {
    let outer: &[usize] = if N == 2 { &[1] } else { &[2, 1] };
    let (o, m) = (outer.len(), if extended { N + 1 } else { N });
    let d = |a: usize, b: usize| a * m + b;
    let t = |a: usize, b: usize| a * (o + 1) + b;
    let blank = |mask, count| ContractionGroup { mask, count, from: [[0; COMPONENTS_AT_ONCE]; 4], to: [0; COMPONENTS_AT_ONCE] };
    let pairs: Vec<(usize, usize)> = (0..o).flat_map(|a| (0..o).map(move |b| (a, b))).filter(|&(a, b)| !symmetric || a <= b).collect();
    let mut groups = Vec::new();
    for part in pairs.chunks(COMPONENTS_AT_ONCE) {
        let mut group = blank(VV, part.len());
        for (k, &(a, b)) in part.iter().enumerate() {
            group.from[0][k] = d(outer[a], outer[b]);
            group.to[k] = t(a, b);
        }
        groups.push(group);
    }
    if extended {
        for (k, &a) in outer.iter().enumerate() {
            let (mut row, mut column) = (blank(SV | VV, 1), blank(VS | VV, 1));
            (row.from[1][0], row.from[0][0], row.to[0]) = (d(0, a), d(N, a), t(o, k));
            (column.from[2][0], column.from[0][0], column.to[0]) = (d(a, 0), d(a, N), t(k, o));
            groups.extend([row, column]);
        }
    } else {
        let (mut row, mut column) = (blank(SV, o), blank(VS, o));
        for (k, &a) in outer.iter().enumerate() {
            (row.from[1][k], row.to[k]) = (d(0, a), t(o, k));
            (column.from[2][k], column.to[k]) = (d(a, 0), t(k, o));
        }
        groups.extend([row, column]);
    }
    let mut corner = blank(if extended { VV | SV | VS | SS } else { SS }, 1);
    corner.from[3][0] = d(0, 0);
    if extended {
        (corner.from[2][0], corner.from[1][0], corner.from[0][0]) = (d(N, 0), d(0, N), d(N, N));
    }
    corner.to[0] = t(o, o);
    groups.push(corner);
    groups
}

/// The group of products of values: one component of D, one of the contraction.
pub(super) fn mass() -> Vec<ContractionGroup> {
    vec![ContractionGroup { mask: VV, count: 1, from: [[0; COMPONENTS_AT_ONCE]; 4], to: [0; COMPONENTS_AT_ONCE] }]
}

/// Places of the components for the middle contraction: for a symmetric D (middle, slow) is read at (slow, middle).
pub(super) fn places(symmetric: bool) -> [usize; middle::COMPONENTS] {
    let mut places: [usize; middle::COMPONENTS] = std::array::from_fn(|k| k);
    if symmetric {
        places[3] = places[1];
    }
    places
}
