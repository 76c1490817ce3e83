//! Least and greatest value of a field over the closed elements of a body.
//!
//! Every element is looked at at its points of integration and at the Gauss-Lobatto points of one degree more, those on its corners,
//! edges and faces among them. From the best points of the elements whose values come near the extreme, by their own range, a search
//! climbs to the top. Where elements meet in a point their values differ; each of them counts.

use super::climb::climb;
use super::model::BodyModel;
use super::physics::{Physics, PointState};
use crate::basis::Cell;
use crate::geometry::cell;
use crate::linalg::Vector;
use crate::parallel;
use crate::quadrature::{Quadrature, gauss_lobatto_nodes};
use crate::space::off_collapsed;

/// Elements whose greatest value is lower than the greatest of all by up to this share of their own range are searched.
const MARGIN: f64 = 0.5;
/// Number of elements that are searched, at most, and places in each from which a search begins, none lower than its best one by more than
/// that share of its range.
const SEARCHED: usize = 16;
const STARTS: usize = 3;
/// Highest degree whose points are taken.
const DEGREE: usize = 6;

/// A value of a field and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme<const N: usize> {
    /// The value.
    pub value: f64,
    /// Its place \[length\].
    pub at: Vector<N>,
}

/// A body with its solution, and the field that is asked for.
struct Asked<'a, const S: usize, const N: usize> {
    patch: &'a BodyModel<S, N>,
    physics: Physics<N>,
    u: &'a [f64],
    field: &'a (dyn Fn(&PointState<N>) -> f64 + Sync),
    /// Whether the field takes derivatives, which have no value where a map collapses.
    derived: bool,
    /// Points of elements by their degree.
    looks: Vec<Look<N>>,
}

impl<const S: usize, const N: usize> BodyModel<S, N> {
    /// The least and the greatest value of `field` in this body over its closed elements, for the unknowns `u` of the model at the time
    /// `t`; `None` if it is not finite everywhere, or there are no elements. `derived`: whether it takes derivatives of u.
    pub fn extremes(&self, u: &[f64], t: f64, derived: bool, field: &(dyn Fn(&PointState<N>) -> f64 + Sync)) -> Option<[Extreme<N>; 2]> {
        let looks = (0..=DEGREE).map(|degree| look(degree.max(1) + 1)).collect();
        let asked = Asked { patch: self, physics: self.physics_at(t), u, field, derived, looks };
        let ranges = asked.ranges()?;
        Some([asked.extreme(&ranges, -1.0)?, asked.extreme(&ranges, 1.0)?])
    }

    /// As [`BodyModel::extremes`], over the points of integration alone.
    pub fn extremes_at_points(&self, u: &[f64], t: f64, field: &(dyn Fn(&PointState<N>) -> f64 + Sync)) -> Option<[Extreme<N>; 2]> {
        let (space, physics) = (&**self.body.space(), self.physics_at(t));
        let of_element = |e: usize| {
            let states = physics.at(space, &self.field, u, e, &self.rules.rule(e).points);
            let all = states.iter().map(|s| Extreme { value: field(s), at: s.x });
            all.fold(None, |found, x| Some(wider(found, [x, x]))).filter(|f: &[Extreme<N>; 2]| f.iter().all(|x| x.value.is_finite()))
        };
        let parts: Vec<Option<[Extreme<N>; 2]>> = parallel::map(space.num_elements(), of_element);
        parts.into_iter().try_fold(None, |found, part| part.map(|p| Some(wider(found, p)))).flatten()
    }
}

/// The least of both and the greatest of both; values that are not finite are kept.
fn wider<const N: usize>(found: Option<[Extreme<N>; 2]>, new: [Extreme<N>; 2]) -> [Extreme<N>; 2] {
    let Some([low, high]) = found else { return new };
    let lower = new[0].value < low.value || new[0].value.is_nan();
    let higher = new[1].value > high.value || new[1].value.is_nan();
    [if lower { new[0] } else { low }, if higher { new[1] } else { high }]
}

/// Points of a cell at which all elements are looked at, in the coordinates of the unit cube, with the distance of neighbours.
struct Look<const N: usize> {
    points: Vec<Vector<N>>,
    apart: f64,
}

impl<const S: usize, const N: usize> Asked<'_, S, N> {
    /// Values at points of an element, given on the unit cube.
    fn values(&self, element: usize, cube: &[Vector<N>]) -> Vec<(f64, Vector<N>)> {
        let space = &**self.patch.body.space();
        let kind = space.cell(element);
        let xi = cube.iter().map(|a| onto(kind, a));
        let xi: Vec<Vector<N>> = if self.derived { off_collapsed(space, element, xi) } else { xi.collect() };
        let states = self.physics.at(space, &self.patch.field, self.u, element, &xi);
        states.iter().map(|s| ((self.field)(s), s.x)).collect()
    }

    /// Places and values of an element.
    fn look(&self, element: usize, look: &Look<N>) -> (Vec<Vector<N>>, Vec<f64>) {
        let kind = self.patch.body.space().cell(element);
        let rule = self.patch.rules.rule(element);
        let cube: Vec<Vector<N>> = rule.points.iter().map(|xi| from(kind, xi)).chain(look.points.iter().copied()).collect();
        let values = self.values(element, &cube).into_iter().map(|v| v.0).collect();
        (cube, values)
    }

    /// The points at which elements of a degree are looked at.
    fn points(&self, element: usize) -> &Look<N> {
        &self.looks[self.patch.body.space().degree(element).into_iter().max().unwrap_or(1).min(DEGREE)]
    }

    /// Least and greatest value of every element at its points; `None` if one is not finite.
    fn ranges(&self) -> Option<Vec<[f64; 2]>> {
        let of_element = |e: usize| {
            let (_, values) = self.look(e, self.points(e));
            let ends = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
            values.iter().all(|v| v.is_finite()).then_some(ends)
        };
        parallel::map(self.patch.body.space().num_elements(), of_element).into_iter().collect()
    }

    /// The greatest value of `sign` times the field, for the `ranges` of the elements.
    fn extreme(&self, ranges: &[[f64; 2]], sign: f64) -> Option<Extreme<N>> {
        let high = |e: usize| if sign > 0.0 { ranges[e][1] } else { -ranges[e][0] };
        let greatest = (0..ranges.len()).map(high).fold(f64::NEG_INFINITY, f64::max);
        let is_near = |e: &usize| high(*e) + MARGIN * (ranges[*e][1] - ranges[*e][0]) >= greatest;
        let mut near: Vec<usize> = (0..ranges.len()).filter(is_near).collect();
        // the highest first; equal ones in their order
        near.sort_by(|&a, &b| high(b).total_cmp(&high(a)).then(a.cmp(&b)));
        near.truncate(SEARCHED);
        let tops: Vec<Extreme<N>> = parallel::map(near.len(), |k| self.top(near[k], self.points(near[k]), sign));
        let best = tops.into_iter().reduce(|a, b| if b.value > a.value { b } else { a })?;
        Some(Extreme { value: sign * best.value, ..best })
    }

    /// The greatest value of `sign` times the field in an element.
    fn top(&self, element: usize, look: &Look<N>, sign: f64) -> Extreme<N> {
        let (cube, values) = self.look(element, look);
        let mut order: Vec<usize> = (0..cube.len()).collect();
        order.sort_by(|&a, &b| (sign * values[b]).total_cmp(&(sign * values[a])).then(a.cmp(&b)));
        let lowest = sign * values[order[0]] - MARGIN * (values[order[0]] - values[order[order.len() - 1]]).abs();
        let mut starts: Vec<usize> = Vec::new();
        for k in order.into_iter().filter(|&k| sign * values[k] >= lowest) {
            if starts.len() < STARTS && starts.iter().all(|&s| (cube[s] - cube[k]).amax() > 1.5 * look.apart) {
                starts.push(k);
            }
        }
        let mut f = |points: &[Vector<N>]| self.values(element, points).into_iter().map(|v| sign * v.0).collect::<Vec<f64>>();
        let tops = starts.into_iter().map(|k| climb(&mut f, (cube[k], sign * values[k]), look.apart));
        let (place, value) = tops.reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap_or((Vector::zeros(), f64::NEG_INFINITY));
        let at = self.values(element, &[place])[0].1;
        Extreme { value, at }
    }
}

/// The products of the Gauss-Lobatto nodes of a degree.
fn look<const N: usize>(degree: usize) -> Look<N> {
    let line = gauss_lobatto_nodes::<f64>(degree);
    let apart = line.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    Look { points: cell::spread(Cell::Tensor, &line), apart }
}

/// The point of a cell for one of the unit cube: on a simplex xi_k = a_k prod_{j < k} (1 - a_j).
fn onto<const N: usize>(kind: Cell, cube: &Vector<N>) -> Vector<N> {
    if kind == Cell::Tensor {
        return *cube;
    }
    let mut rest = 1.0;
    Vector::from_fn(|k, _| {
        let xi = cube[k] * rest;
        rest *= 1.0 - cube[k];
        xi
    })
}

/// The point of the unit cube for one inside a cell.
fn from<const N: usize>(kind: Cell, xi: &Vector<N>) -> Vector<N> {
    if kind == Cell::Tensor {
        return *xi;
    }
    let mut rest = 1.0;
    Vector::from_fn(|k, _| {
        let a: f64 = if rest > 0.0 { xi[k] / rest } else { 0.0 };
        rest -= xi[k];
        a.clamp(0.0, 1.0)
    })
}
