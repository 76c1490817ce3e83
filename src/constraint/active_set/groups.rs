//! Groups of neighbouring contact rows, small where a set may change and large elsewhere.
//!
//! The rows of each connected part of the sides are halved by their places again and again. A set of groups is solved, the groups near its
//! edges are halved, and so on until the edges stay: what lies far from an edge acts on it by its resultant alone. The number of groups
//! grows like the logarithm of the number of rows.

use super::super::ConstrainedSystem;
use super::super::scale::row_places;
use crate::coupling::Rows;
use crate::linalg::{Triplets, Union};
use std::ops::Range;

/// Groups at first.
const FIRST: usize = 32;
/// A group is halved where groups in the other state are nearer than this many of its diameters. The edge that is found is off by the
/// square of the reciprocal.
const NEAR: f64 = 8.0;

/// Groups of rows and their states.
#[derive(Debug)]
pub(super) struct Groups {
    /// Rows, those of every group together.
    rows: Vec<usize>,
    /// Places of `rows`.
    places: Vec<[f64; 3]>,
    /// Ranges of `rows`.
    groups: Vec<Range<usize>>,
    /// Whether each group is closed.
    pub closed: Vec<bool>,
}

impl Groups {
    /// The first groups of `rows`, ascending, of a system; closed where most of their rows are, or, if none has most, where one is. `None`
    /// without places.
    pub fn of(system: &ConstrainedSystem<'_, f64>, rows: &[usize], closed: &[bool]) -> Option<Self> {
        let m = system.offset.len();
        let of_rows = row_places(system, m, system.stiffness.size());
        if of_rows.is_empty() {
            return None;
        }
        let part = parts(system, m);
        let mut rows = rows.to_vec();
        rows.sort_by_key(|&j| (part[j], j));
        let largest = rows.len().div_ceil(FIRST);
        let mut groups = Vec::new();
        let ends: Vec<usize> = (1..=rows.len()).filter(|&k| k == rows.len() || part[rows[k - 1]] != part[rows[k]]).collect();
        let mut begin = 0;
        for end in ends {
            bisect(&mut rows[begin..end], &of_rows);
            halve_to(begin..end, largest, &mut groups);
            begin = end;
        }
        let count = |group: &Range<usize>| rows[group.clone()].iter().filter(|&&j| closed[j]).count();
        let mut states: Vec<bool> = groups.iter().map(|group| 2 * count(group) > group.len()).collect();
        if !states.contains(&true) {
            states = groups.iter().map(|group| count(group) > 0).collect();
        }
        let places = rows.iter().map(|&j| of_rows[j]).collect();
        Some(Self { rows, places, groups, closed: states })
    }

    /// The rows of every group.
    pub fn lists(&self) -> Vec<Vec<usize>> {
        self.groups.iter().map(|group| self.rows[group.clone()].to_vec()).collect()
    }

    /// State of every row of a system with `m` rows; rows in no group are open.
    pub fn states(&self, m: usize) -> Vec<bool> {
        let mut all = vec![false; m];
        for (group, &closed) in self.groups.iter().zip(&self.closed) {
            self.rows[group.clone()].iter().for_each(|&j| all[j] = closed);
        }
        all
    }

    /// Halves groups near others in the other state until all are small there; returns whether there were any.
    pub fn refine(&mut self) -> bool {
        let count = self.groups.len();
        while self.halve() {}
        self.groups.len() > count
    }

    /// Halves the groups near others in the other state once; returns whether there were any.
    fn halve(&mut self) -> bool {
        let balls: Vec<([f64; 3], f64)> = self.groups.iter().map(|group| ball(&self.places[group.clone()])).collect();
        let near = |a: usize, b: usize| {
            let ((x, r), (y, s)) = (&balls[a], &balls[b]);
            // rows in one place have no diameter; the ball about the places leaves out half a row at either end
            let count = self.groups[a].len() as f64;
            *r == 0.0 || distance(x, y) - r - s <= NEAR * 2.0 * r * count / (count - 1.0)
        };
        let count = self.groups.len();
        let split: Vec<bool> =
            (0..count).map(|a| self.groups[a].len() > 1 && (0..count).any(|b| self.closed[a] != self.closed[b] && near(a, b))).collect();
        let (mut groups, mut closed) = (Vec::with_capacity(2 * count), Vec::with_capacity(2 * count));
        for (a, group) in std::mem::take(&mut self.groups).into_iter().enumerate() {
            let middle = group.start + group.len() / 2;
            let own = if split[a] { vec![group.start..middle, middle..group.end] } else { vec![group] };
            closed.extend(own.iter().map(|_| self.closed[a]));
            groups.extend(own);
        }
        (self.groups, self.closed) = (groups, closed);
        split.contains(&true)
    }
}

/// Rows, offsets and compliances of a system summed over groups.
#[derive(Debug)]
pub(super) struct Summed {
    pub rows: Rows,
    pub offset: Vec<f64>,
    pub compliance: Vec<f64>,
}

impl Summed {
    pub fn of(system: &ConstrainedSystem<'_, f64>, groups: &[Vec<usize>]) -> Self {
        let mut number = vec![None; system.offset.len()];
        for (g, group) in groups.iter().enumerate() {
            group.iter().for_each(|&j| number[j] = Some(g));
        }
        let summed = |t: &Triplets| {
            let entries = t.entries.iter().filter_map(|&(j, i, v)| number[j].map(|g| (g, i, v))).collect();
            Triplets { entries, ..Triplets::new(groups.len(), system.stiffness.size()) }
        };
        let sums = |of: &[f64]| groups.iter().map(|group| group.iter().map(|&j| of.get(j).copied().unwrap_or(0.0)).sum()).collect();
        Self {
            rows: Rows { slave: summed(&system.constraint.slave), master: summed(&system.constraint.master) },
            offset: sums(system.offset),
            compliance: sums(system.compliance),
        }
    }
}

/// A number for every row, the same for rows of sides that are connected by unknowns of the slave.
fn parts(system: &ConstrainedSystem<'_, f64>, m: usize) -> Vec<usize> {
    let mut trees = Union::new(m);
    let mut first = vec![usize::MAX; system.stiffness.size()];
    for &(j, i, _) in &system.constraint.slave.entries {
        if first[i] == usize::MAX {
            first[i] = j;
        }
        trees.unite(first[i], j);
    }
    (0..m).map(|j| trees.root(j)).collect()
}

/// Sorts rows so that halves of every half lie together.
fn bisect(rows: &mut [usize], places: &[[f64; 3]]) {
    if rows.len() < 2 {
        return;
    }
    let extent = |k: usize| {
        let (least, most) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &j| (a.min(places[j][k]), b.max(places[j][k])));
        most - least
    };
    let axis = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b)).then(b.cmp(&a))).expect("three axes");
    rows.sort_by(|&a, &b| places[a][axis].total_cmp(&places[b][axis]).then(a.cmp(&b)));
    let (left, right) = rows.split_at_mut(rows.len() / 2);
    bisect(left, places);
    bisect(right, places);
}

/// Halves a range until its parts have at most `largest` rows.
fn halve_to(range: Range<usize>, largest: usize, parts: &mut Vec<Range<usize>>) {
    if range.len() <= largest {
        parts.push(range);
        return;
    }
    let middle = range.start + range.len() / 2;
    halve_to(range.start..middle, largest, parts);
    halve_to(middle..range.end, largest, parts);
}

/// A ball about the mean of places that contains them.
fn ball(places: &[[f64; 3]]) -> ([f64; 3], f64) {
    let middle: [f64; 3] = std::array::from_fn(|k| places.iter().map(|x| x[k]).sum::<f64>() / places.len() as f64);
    (middle, places.iter().fold(0.0, |r: f64, x| r.max(distance(x, &middle))))
}

fn distance(x: &[f64; 3], y: &[f64; 3]) -> f64 {
    x.iter().zip(y).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
