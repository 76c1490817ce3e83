//! Levels of a graph: steps along edges from one end of it.

use super::graph::Piece;
use super::index;

/// Levels of all vertices from one far away from `start`, and their number; a part without edges to the others follows behind them.
pub(super) fn levels(piece: &Piece, start: usize) -> (Vec<f64>, usize) {
    // the vertex met last is far from any other
    let (_, far, _) = search(piece, start);
    let (level, _, many) = search(piece, far);
    (level, many)
}

/// Levels from `start`, the vertex of the first part met last, and the number of levels.
fn search(piece: &Piece, start: usize) -> (Vec<f64>, usize, usize) {
    let n = piece.ids.len();
    let (mut level, mut queue) = (vec![f64::NAN; n], Vec::with_capacity(n));
    let (mut first, mut unmet, mut last, mut far) = (0.0, 0, 0.0, None);
    let mut next = Some(start);
    while let Some(root) = next {
        let mut head = queue.len();
        level[root] = first;
        queue.push(index(root));
        while let Some(&v) = queue.get(head) {
            head += 1;
            last = level[v as usize];
            for &u in piece.neighbours(v as usize) {
                if level[u as usize].is_nan() {
                    level[u as usize] = last + 1.0;
                    queue.push(u);
                }
            }
        }
        far = far.or(queue.last().copied());
        // parts are not neighbours, nor are their levels
        first = last + 2.0;
        unmet += level[unmet..].iter().take_while(|l| !l.is_nan()).count();
        next = (unmet < n).then_some(unmet);
    }
    (level, far.map_or(start, |v| v as usize), last as usize + 1)
}
