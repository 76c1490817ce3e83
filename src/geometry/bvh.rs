//! Bounding volume hierarchy: boxes that meet a box, and boxes nearest to a point.

use super::Bounds;
use crate::linalg::{Real, Vector, to_f64};
use std::cell::Cell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Boxes per leaf; fewer make the tree deeper, more make leaves slower.
const LEAF: usize = 4;
thread_local! {
    /// The queue of the last search on this thread.
    static QUEUE: Cell<BinaryHeap<Entry>> = Cell::default();
}

/// A median-split tree over numbered boxes.
///
/// Building sorts nothing but centres and breaks ties by number, so the same boxes give the same tree.
#[derive(Clone, Debug)]
pub struct Tree<const N: usize, T: Real = f64> {
    nodes: Vec<Node<N, T>>,
    items: Vec<usize>,
    boxes: Vec<Bounds<N, T>>,
}

#[derive(Clone, Debug)]
struct Node<const N: usize, T: Real> {
    bounds: Bounds<N, T>,
    /// Range in `items`.
    range: (usize, usize),
    /// Numbers of the two halves; `None` in a leaf.
    halves: Option<(usize, usize)>,
}

/// An entry of the queue of [`Tree::nearest`]: least distance first, then least number.
#[derive(PartialEq)]
struct Entry {
    distance: f64,
    number: usize,
    is_item: bool,
}

impl Eq for Entry {}
impl PartialOrd for Entry {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Entry {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        // a heap pops its largest entry: the order is reversed to pop the nearest
        other.distance.total_cmp(&self.distance).then(other.is_item.cmp(&self.is_item)).then(other.number.cmp(&self.number))
    }
}

impl<const N: usize, T: Real> Tree<N, T> {
    /// Builds the tree over `boxes`; item i is `boxes[i]`.
    pub fn new(boxes: Vec<Bounds<N, T>>) -> Self {
        let mut tree = Self { nodes: Vec::new(), items: (0..boxes.len()).collect(), boxes };
        if !tree.boxes.is_empty() {
            tree.build(0, tree.boxes.len());
        }
        tree
    }

    /// Number of boxes.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Whether there are no boxes.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// The box around all; `None` without boxes.
    pub fn bounds(&self) -> Option<Bounds<N, T>> {
        self.nodes.first().map(|n| n.bounds)
    }

    /// The box of `item`.
    pub fn item(&self, item: usize) -> &Bounds<N, T> {
        &self.boxes[item]
    }

    fn build(&mut self, lo: usize, hi: usize) -> usize {
        let bounds = self.items[lo + 1..hi].iter().fold(self.boxes[self.items[lo]], |b, &i| b.union(&self.boxes[i]));
        let number = self.nodes.len();
        self.nodes.push(Node { bounds, range: (lo, hi), halves: None });
        if hi - lo > LEAF {
            let centers: Vec<Vector<N, T>> = self.items[lo..hi].iter().map(|&i| self.boxes[i].center()).collect();
            let spread = Bounds::around(&centers).map_or_else(Vector::zeros, |b| b.hi - b.lo);
            let axis = (0..N).fold(0, |best, k| if spread[k] > spread[best] { k } else { best });
            let mid = (hi - lo) / 2;
            let boxes = &self.boxes;
            let key = |i: usize| to_f64(boxes[i].lo[axis] + boxes[i].hi[axis]);
            self.items[lo..hi].select_nth_unstable_by(mid, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
            let left = self.build(lo, lo + mid);
            let right = self.build(lo + mid, hi);
            self.nodes[number].halves = Some((left, right));
        }
        number
    }

    /// Values per node: `join` of those of the items below it; of an item `of_item`.
    pub(crate) fn gathered<S: Copy>(&self, of_item: impl Fn(usize) -> S, join: impl Fn(S, S) -> S) -> Vec<S> {
        let mut of_node: Vec<Option<S>> = vec![None; self.nodes.len()];
        // halves have larger numbers than their node
        for (number, node) in self.nodes.iter().enumerate().rev() {
            of_node[number] = match node.halves {
                Some((a, b)) => of_node[a].zip(of_node[b]).map(|(a, b)| join(a, b)),
                None => self.items[node.range.0..node.range.1].iter().map(|&i| of_item(i)).reduce(&join),
            };
        }
        of_node.into_iter().flatten().collect()
    }

    /// The box of a node.
    pub(crate) fn node(&self, number: usize) -> &Bounds<N, T> {
        &self.nodes[number].bounds
    }

    /// Items whose boxes meet `query`, in increasing order.
    pub fn meeting(&self, query: &Bounds<N, T>) -> Vec<usize> {
        let mut found = Vec::new();
        // halves of a path: their numbers of items fall by two
        let (mut stack, mut open) = ([0usize; usize::BITS as usize + 1], usize::from(!self.nodes.is_empty()));
        while open > 0 {
            open -= 1;
            let node = &self.nodes[stack[open]];
            if !node.bounds.meets(query) {
                continue;
            }
            match node.halves {
                Some((a, b)) => {
                    (stack[open], stack[open + 1]) = (a, b);
                    open += 2;
                }
                None => found.extend(self.items[node.range.0..node.range.1].iter().copied().filter(|&i| self.boxes[i].meets(query))),
            }
        }
        found.sort_unstable();
        found
    }

    /// Visits items by growing distance of their boxes to `x`, as long as that distance is below `reach`.
    ///
    /// `visit(item)` returns the new reach: the distance of the best item so far.
    pub fn nearest(&self, x: &Vector<N, T>, reach: T, visit: impl FnMut(usize) -> T) {
        self.nearest_among(x, reach, |_, _| true, visit);
    }

    /// Visits items as [`Tree::nearest`] does, of nodes (numbers of [`Tree::gathered`]) and items that `keep(number, is_item)` keeps.
    pub(crate) fn nearest_among(&self, x: &Vector<N, T>, reach: T, keep: impl Fn(usize, bool) -> bool, mut visit: impl FnMut(usize) -> T) {
        let mut reach = to_f64(reach);
        let mut queue = QUEUE.take();
        queue.clear();
        if let Some(root) = self.nodes.first() {
            queue.push(Entry { distance: to_f64(root.bounds.distance(x)), number: 0, is_item: false });
        }
        while let Some(next) = queue.pop() {
            if next.distance > reach {
                break;
            }
            if next.is_item {
                reach = reach.min(to_f64(visit(next.number)));
                continue;
            }
            let node = &self.nodes[next.number];
            match node.halves {
                Some((a, b)) => {
                    for number in [a, b].into_iter().filter(|&n| keep(n, false)) {
                        let distance = to_f64(self.nodes[number].bounds.distance(x));
                        if distance <= reach {
                            queue.push(Entry { distance, number, is_item: false });
                        }
                    }
                }
                None => {
                    for &number in self.items[node.range.0..node.range.1].iter().filter(|&&i| keep(i, true)) {
                        let distance = to_f64(self.boxes[number].distance(x));
                        if distance <= reach {
                            queue.push(Entry { distance, number, is_item: true });
                        }
                    }
                }
            }
        }
        QUEUE.set(queue);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(n: usize) -> Vec<Bounds<2>> {
        (0..n)
            .map(|i| {
                let c = Vector::<2>::new((i as f64 * 1.3).sin() * 5.0, (i as f64 * 0.7).cos() * 3.0);
                Bounds { lo: c.add_scalar(-0.1), hi: c.add_scalar(0.2 + 0.01 * (i % 7) as f64) }
            })
            .collect()
    }

    #[test]
    fn meeting_and_nearest_agree_with_a_search_of_all_boxes() {
        for n in [0, 1, 4, 5, 33, 400] {
            let all = boxes(n);
            let tree = Tree::new(all.clone());
            assert_eq!((tree.len(), tree.is_empty()), (n, n == 0));
            for k in 0..40 {
                let x = Vector::<2>::new((k as f64 * 0.9).cos() * 6.0, (k as f64 * 1.9).sin() * 4.0);
                let query = Bounds { lo: x, hi: x.add_scalar(0.5) };
                let expected: Vec<usize> = (0..n).filter(|&i| all[i].meets(&query)).collect();
                assert_eq!(tree.meeting(&query), expected);
                let least = all.iter().map(|b| b.distance(&x)).fold(f64::INFINITY, f64::min);
                let mut best = f64::INFINITY;
                tree.nearest(&x, f64::INFINITY, |i| {
                    best = best.min(all[i].distance(&x));
                    best
                });
                assert_eq!(best, least);
            }
        }
    }

    #[test]
    fn equal_boxes_are_split_without_end() {
        let tree = Tree::new(vec![Bounds { lo: Vector::<3>::zeros(), hi: Vector::zeros() }; 100]);
        let mut seen = 0;
        tree.nearest(&Vector::zeros(), f64::INFINITY, |_| {
            seen += 1;
            0.0
        });
        assert_eq!(seen, 100);
    }
}
