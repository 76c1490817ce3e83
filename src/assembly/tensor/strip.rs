//! Strips and windows of the middle direction: what a march holds at once, and the steps in which a layer goes through it.
//!
//! A strip has functions whose rows it makes. Their rows need the pairs with their neighbours both ways, so it holds sums of
//! some functions beside it too. A layer goes through a strip in windows: the contracted tiles of a few functions at a time,
//! in a ring, so that they are read again while they are in cache.

use super::axis::Axis;
use std::ops::Range;

/// A few functions of a strip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// The functions.
    pub functions: Range<usize>,
    /// Tiles that are contracted before they are summed, counted from the first point of the strip.
    pub tiles: Range<usize>,
}

/// Functions of the middle direction whose rows are made by one march.
#[derive(Clone, Debug)]
pub(super) struct Strip {
    /// Functions whose rows are made.
    pub rows: Range<usize>,
    /// Functions whose sums are held.
    pub held: Range<usize>,
    /// Elements under the rows.
    pub elements: Range<usize>,
    /// Points of these elements.
    pub points: Range<usize>,
    /// The steps through the strip.
    pub windows: Vec<Window>,
    /// Tiles that are held at once.
    pub tiles: usize,
}

impl Strip {
    /// The strip of `rows` in windows of `step` functions, with `lanes` points per tile; `None` where no row has an element.
    pub fn new(axis: &Axis, rows: Range<usize>, step: usize, lanes: usize) -> Option<Self> {
        let mut reached = rows.clone().filter(|&i| axis.support[i].1 > 0);
        let first = reached.next()?;
        let last = reached.next_back().unwrap_or(first);
        let elements = axis.support[first].0..axis.support[last].1;
        let points = axis.start[elements.start]..axis.start[elements.end];
        let held = axis.columns[first].0..axis.columns[last].1;
        let mut strip = Self { rows, held, elements, points, windows: Vec::new(), tiles: 0 };
        let (mut done, step) = (0, step.max(1));
        for from in strip.held.clone().step_by(step) {
            let functions = from..(from + step).min(strip.held.end);
            let mut reached = functions.clone().map(|i| strip.support(axis, i)).filter(|e| !e.is_empty());
            let Some(first) = reached.next() else { continue };
            let last = reached.next_back().map_or(first.end, |last| last.end);
            let begin = (axis.start[first.start] - strip.points.start) / lanes;
            let end = (axis.start[last] - strip.points.start).div_ceil(lanes).max(done);
            strip.tiles = strip.tiles.max(end - begin.min(done));
            strip.windows.push(Window { functions, tiles: done..end });
            done = end;
        }
        Some(strip)
    }

    /// Elements of function `i` that the strip has.
    pub fn support(&self, axis: &Axis, i: usize) -> Range<usize> {
        axis.support[i].0.max(self.elements.start)..axis.support[i].1.min(self.elements.end)
    }

    /// Functions j whose pair (i, j) is held: all neighbours of a row, the rows among those of another function.
    pub fn pairs(&self, axis: &Axis, i: usize) -> Range<usize> {
        let (from, to) = axis.columns[i];
        if self.rows.contains(&i) { from..to } else { from.max(self.rows.start)..to.min(self.rows.end) }
    }

    /// Where the points of the strip lie in the ring of tiles, `tile` vectors apart, `point` vectors per point.
    pub fn places(&self, lanes: usize, tile: usize, point: usize) -> Vec<usize> {
        (0..self.points.len()).map(|q| q / lanes % self.tiles * tile + q % lanes * point).collect()
    }
}

/// `functions` in strips of `size`, as even as they can be.
pub(super) fn cut(functions: usize, size: usize) -> Vec<Range<usize>> {
    let count = functions.div_ceil(size.max(1)).max(1);
    (0..count).map(|k| k * functions / count..(k + 1) * functions / count).collect()
}
