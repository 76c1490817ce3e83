//! Strips of the fast and of the middle direction, which a march holds at once, and windows of the latter, the steps in
//! which a layer goes through it.
//!
//! A strip has functions whose rows it makes, and the elements under them. Rows need the pairs with their neighbours on
//! both sides, so that sums of some functions beside the strip are held too: of the middle direction on both sides, for
//! its pairs are held both ways; of the fast direction only before it, for there the pair (i, j > i) is used for (j, i) too.
//! A pair of which one function belongs to the strip has all its elements there; others are not complete, and not read.
//!
//! A layer goes through a strip of the middle direction in windows: the contracted tiles of a few functions at a time,
//! in a ring, so that they are read again while they are in cache.

use super::axis::Axis;
use std::ops::Range;

/// Functions of one direction whose rows are made by one march.
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
}

impl Strip {
    /// The strip of `rows` with sums of pairs both ways; `None` if no row has an element.
    pub fn both_ways(axis: &Axis, rows: Range<usize>) -> Option<Self> {
        let mut reached = rows.clone().filter(|&i| axis.support[i].1 > 0);
        let first = reached.next()?;
        let last = reached.next_back().unwrap_or(first);
        let elements = axis.support[first].0..axis.support[last].1;
        let points = axis.start[elements.start]..axis.start[elements.end];
        let held = axis.columns[first].0..axis.columns[last].1;
        Some(Self { rows, held, elements, points })
    }

    /// The strip of `rows` with sums of pairs (i, j >= i) only.
    pub fn one_way(axis: &Axis, rows: Range<usize>) -> Option<Self> {
        let strip = Self::both_ways(axis, rows)?;
        Some(Self { held: strip.held.start..strip.rows.end, ..strip })
    }

    /// Elements of function `i` that the strip has.
    #[inline(always)]
    pub fn support(&self, axis: &Axis, i: usize) -> Range<usize> {
        axis.support[i].0.max(self.elements.start)..axis.support[i].1.min(self.elements.end)
    }

    /// Functions j whose pair (i, j) is held both ways: all neighbours of a row, the rows among those of another function.
    pub fn pairs(&self, axis: &Axis, i: usize) -> Range<usize> {
        let (from, to) = axis.columns[i];
        if self.rows.contains(&i) { from..to } else { from.max(self.rows.start)..to.min(self.rows.end) }
    }
}

/// A few functions of a strip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// The functions.
    pub functions: Range<usize>,
    /// Tiles that are contracted before they are summed, counted from the first point of the strip.
    pub tiles: Range<usize>,
}

/// The steps through a strip of the middle direction.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    /// The steps.
    pub steps: Vec<Window>,
    /// Tiles that are held at once.
    pub tiles: usize,
}

impl Windows {
    /// `strip` in windows of `step` functions, with `lanes` points per tile.
    pub fn new(axis: &Axis, strip: &Strip, step: usize, lanes: usize) -> Self {
        let (mut windows, mut done, step) = (Self { steps: Vec::new(), tiles: 0 }, 0, step.max(1));
        for from in strip.held.clone().step_by(step) {
            let functions = from..(from + step).min(strip.held.end);
            let mut reached = functions.clone().map(|i| strip.support(axis, i)).filter(|e| !e.is_empty());
            let Some(first) = reached.next() else { continue };
            let last = reached.next_back().map_or(first.end, |last| last.end);
            let begin = (axis.start[first.start] - strip.points.start) / lanes;
            let end = (axis.start[last] - strip.points.start).div_ceil(lanes).max(done);
            windows.tiles = windows.tiles.max(end - begin.min(done));
            windows.steps.push(Window { functions, tiles: done..end });
            done = end;
        }
        windows
    }

    /// Offsets of the points of `strip` in the ring of tiles, with `tile` vectors per tile and `point` vectors per point.
    pub fn places(&self, strip: &Strip, lanes: usize, tile: usize, point: usize) -> Vec<usize> {
        (0..strip.points.len()).map(|q| q / lanes % self.tiles * tile + q % lanes * point).collect()
    }
}

/// `functions` in strips of `size`, as even as they can be.
pub(super) fn cut(functions: usize, size: usize) -> Vec<Range<usize>> {
    let count = functions.div_ceil(size.max(1)).max(1);
    (0..count).map(|k| k * functions / count..(k + 1) * functions / count).collect()
}
