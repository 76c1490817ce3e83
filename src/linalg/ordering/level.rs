//! Level structure of a graph: steps along edges from one end, one connected part after the other.

use super::graph::Subgraph;
use super::parts::index;
use super::parts::{LEFT, RIGHT};

/// Levels of the vertices of a set.
pub(super) struct Levels {
    /// Level of every vertex: the levels of each connected part follow those of the previous one, with one left out in between.
    pub level: Vec<f64>,
    /// Mean weight of the levels of the heaviest part.
    pub width: f64,
    /// The last level of every part, and the weight of all up to there.
    parts: Vec<(f64, u64)>,
}

impl Levels {
    /// Levels from the vertex farthest away from `start`.
    pub(super) fn of(piece: &Subgraph, start: usize) -> Self {
        search(piece, search(piece, start).1).0
    }

    /// Mean weight of the levels of the heaviest part, counted from the first vertex.
    pub(super) fn width(piece: &Subgraph) -> f64 {
        search(piece, 0).0.width
    }

    /// Labels of two halves made of whole parts; `None` if there is only one.
    pub(super) fn parted(&self) -> Option<Vec<u8>> {
        let (&(_, all), others) = self.parts.split_last()?;
        let fits = others.partition_point(|&(_, weight)| 2 * weight < all);
        let end = others.get(fits).or(others.last())?.0;
        Some(self.level.iter().map(|&l| if l <= end { LEFT } else { RIGHT }).collect())
    }
}

/// Levels from `start`, and the vertex of its part met last.
fn search(piece: &Subgraph, start: usize) -> (Levels, usize) {
    let n = piece.ids.len();
    let (mut level, mut queue, mut far) = (vec![f64::NAN; n], Vec::with_capacity(n), start);
    let (mut first, mut weight, mut parts, mut heaviest, mut width) = (0.0, 0, Vec::new(), 0, 0.0);
    let (mut unmet, mut next) = (0, (n > 0).then_some(start));
    while let Some(root) = next {
        let (mut head, mut last, mut own) = (queue.len(), first, 0);
        level[root] = first;
        queue.push(index(root));
        while let Some(&v) = queue.get(head) {
            head += 1;
            last = level[v as usize];
            own += u64::from(piece.weight[v as usize]);
            for &u in piece.neighbours(v as usize) {
                if level[u as usize].is_nan() {
                    level[u as usize] = last + 1.0;
                    queue.push(u);
                }
            }
        }
        if parts.is_empty() {
            far = queue[head - 1] as usize;
        }
        if own > heaviest {
            (heaviest, width) = (own, own as f64 / (last - first + 1.0));
        }
        weight += own;
        parts.push((last, weight));
        // parts are not neighbours, nor are their levels
        first = last + 2.0;
        unmet += level[unmet..].iter().take_while(|l| !l.is_nan()).count();
        next = (unmet < n).then_some(unmet);
    }
    (Levels { level, width, parts }, far)
}
