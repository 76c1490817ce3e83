//! Test whether two sides touch: their distance against the deviation of their facets from the surface they approximate.
//!
//! A point of a facet is moved out to that surface ([`Sag::bulge`]) and so is its closest point on the other side; g is their distance
//! along the other side's normal, or zero where the facets themselves touch. Points whose normals do not oppose, or that lie beyond the edge of the other side, are skipped.
//! Sides touch if |mean g| <= 0.25 mean sag and |g| <= 2 sag everywhere; distances below a floor count as zero.

use super::{Space, Trace};
use crate::basis::{Cell, Order};
use crate::geometry::{ClosestPoint, MapTable, Sag, cell};
use crate::linalg::{Real, Vector, lit, num};
use std::sync::Arc;

/// The outward normals of touching sides are opposite: their product is below this.
const OPPOSITE: f64 = -0.5;
/// Largest mean distance of touching sides, as a share of the mean sag.
const MEAN: f64 = 0.25;
/// Largest distance of touching sides, as a share of the sag.
const GREATEST: f64 = 2.0;
/// Largest distance of sides that may have been meant to touch, as a multiple of the sag.
const NEARLY: f64 = 3.0;

/// A side prepared for distance queries from other sides.
#[derive(Debug)]
pub struct Skin<'a, const S: usize, const N: usize, T: Real = f64> {
    trace: &'a Trace<S, N, T>,
    sag: &'a Sag<S, N, T>,
    closest: ClosestPoint<S, N, Arc<dyn Space<S, N, T>>, T>,
}

/// A point of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinPoint<const N: usize, T: Real = f64> {
    /// Position on the surface that the facet approximates \[length\].
    pub x: Vector<N, T>,
    /// Position on the facet \[length\].
    pub on_facet: Vector<N, T>,
    /// Outward unit normal of the facet.
    pub normal: Vector<N, T>,
    /// The facet's sag \[length\].
    pub sag: T,
}

/// Distance of a point from a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight<T: Real = f64> {
    /// Distance along the skin's normal \[length\], negative where the sides overlap; zero where the facets touch.
    pub gap: T,
    /// Distance to the closest point of the facets \[length\].
    pub distance: T,
    /// The larger sag of both facets \[length\].
    pub sag: T,
}

impl<'a, const S: usize, const N: usize, T: Real> Skin<'a, S, N, T> {
    /// Builds the skin of `trace`, whose facets deviate by `sag`.
    pub fn new(trace: &'a Trace<S, N, T>, sag: &'a Sag<S, N, T>) -> Self {
        Self { trace, sag, closest: ClosestPoint::new(Arc::clone(&trace.space)) }
    }

    /// Measures the distance of `point` on another side; `None` beyond `reach` or the rim of this side, or if the normals do not oppose.
    pub fn sight(&self, point: &SkinPoint<N, T>, reach: T, floor: T, table: &mut MapTable<S, N, T>) -> Option<Sight<T>> {
        self.seen(point, reach, floor, table).map(|(sight, _)| sight)
    }

    /// [`sight`](Self::sight) with the point of this side that is seen.
    fn seen(&self, point: &SkinPoint<N, T>, reach: T, floor: T, table: &mut MapTable<S, N, T>) -> Option<(Sight<T>, SkinPoint<N, T>)> {
        let foot = self.closest.project_within(&point.x, reach)?;
        if foot.rim && foot.distance > floor {
            return None;
        }
        self.trace.space.map(foot.element, &[foot.xi], Order::Gradients, table);
        let normal = self.trace.normal(foot.element, &table.jacobian[0]);
        if normal.dot(&point.normal) >= lit(OPPOSITE) {
            return None;
        }
        let raised = foot.x + normal * self.sag.bulge(foot.element, self.trace.space.cell(foot.element), &foot.xi);
        let (mut gap, sag) = ((point.x - raised).dot(&normal), self.sag.of_facet(foot.element));
        if gap.abs() > floor && self.closest.project_within(&point.on_facet, floor).is_some() {
            gap = T::zero();
        }
        let seen = SkinPoint { x: raised, on_facet: foot.x, normal, sag };
        Some((Sight { gap, distance: foot.distance, sag: point.sag.max(sag) }, seen))
    }
}

/// Place of a point between the centre and a corner: 0.21 on an edge from 0 to 1.
const BETWEEN: f64 = 0.58;

/// Points of a facet at which its distance is measured: the centre first.
pub fn skin_points<const S: usize, T: Real>(kind: Cell) -> Vec<Vector<S, T>> {
    let mut points = vec![cell::center::<S, T>(if S == 1 { Cell::Tensor } else { kind })];
    points.extend(cell::grid::<S, T>(kind, if S == 1 { 5 } else { 3 }));
    points
}

/// [`skin_points`], and points towards the corners that are no nodes of elements of degrees 1 to 10: a facet whose nodes lie on the surface may
/// leave it between them.
fn between_nodes<const S: usize, T: Real>(kind: Cell) -> Vec<Vector<S, T>> {
    let mut points = skin_points::<S, T>(kind);
    let centre = points[0];
    let corners = cell::corners::<S, T>(if S == 1 { Cell::Tensor } else { kind });
    points.extend(corners.into_iter().map(|corner| centre + (corner - centre) * lit::<T>(BETWEEN)));
    points
}

/// Moves the points `xi` of a facet onto the surface that it approximates.
pub fn raised<const S: usize, const N: usize, T: Real>(
    trace: &Trace<S, N, T>,
    sag: &Sag<S, N, T>,
    facet: usize,
    xi: &[Vector<S, T>],
    table: &mut MapTable<S, N, T>,
) -> Vec<SkinPoint<N, T>> {
    let kind = trace.space.cell(facet);
    trace.space.map(facet, xi, Order::Gradients, table);
    let point = |(q, xi): (usize, &Vector<S, T>)| {
        let normal = trace.normal(facet, &table.jacobian[q]);
        let on_facet = table.x[q];
        SkinPoint { x: on_facet + normal * sag.bulge(facet, kind, xi), on_facet, normal, sag: sag.of_facet(facet) }
    };
    xi.iter().enumerate().map(point).collect()
}

/// Accumulated distances of two sides: weighted mean and maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clearance<T: Real = f64> {
    gap: T,
    sag: T,
    weight: T,
    /// Greatest distance \[length\].
    pub greatest: T,
    /// Greatest |g| over the sag there, where g is above the floor.
    ratio: T,
}

impl<T: Real> Clearance<T> {
    /// Creates an empty accumulator.
    pub fn new() -> Self {
        Self { gap: T::zero(), sag: T::zero(), weight: T::zero(), greatest: T::zero(), ratio: T::zero() }
    }

    /// Adds a distance with its weight \[length^S\]; the ratio to the sag counts above `floor` only.
    pub fn see(&mut self, sight: &Sight<T>, weight: T, floor: T) {
        let size = sight.gap.abs();
        self.gap += sight.gap * weight;
        self.sag += sight.sag * weight;
        self.weight += weight;
        self.greatest = self.greatest.max(size);
        if size > floor {
            let most = T::max_value().unwrap_or_else(T::one);
            self.ratio = self.ratio.max(if sight.sag > T::zero() { size / sight.sag } else { most });
        }
    }

    /// Adds the distances of `other`.
    pub fn join(&mut self, other: &Self) {
        self.gap += other.gap;
        self.sag += other.sag;
        self.weight += other.weight;
        self.greatest = self.greatest.max(other.greatest);
        self.ratio = self.ratio.max(other.ratio);
    }

    /// Whether no distance was added.
    pub fn is_empty(&self) -> bool {
        self.weight <= T::zero()
    }

    /// |mean distance| \[length\].
    pub fn mean(&self) -> T {
        if self.is_empty() { T::zero() } else { (self.gap / self.weight).abs() }
    }

    /// Largest mean distance of touching sides, 0.25 mean sag \[length\].
    pub fn allowed(&self) -> T {
        if self.is_empty() { T::zero() } else { self.sag / self.weight * lit(MEAN) }
    }

    /// Whether the sides touch: |mean g| <= 0.25 mean sag (or `floor`), and |g| <= 2 sag wherever |g| > `floor`.
    pub fn touches(&self, floor: T) -> bool {
        !self.is_empty() && self.mean() <= self.allowed().max(floor) && self.ratio <= lit(GREATEST)
    }
}

impl<T: Real> Sight<T> {
    /// Whether this point lies on the other side: |g| <= 2 sag, or `floor` if that is larger.
    pub fn touches(&self, floor: T) -> bool {
        self.gap.abs() <= (self.sag * lit(GREATEST)).max(floor)
    }

    /// Whether the sides may have been meant to touch here: |g| <= 3 sag, or `close` if that is larger.
    pub fn nearly(&self, close: T) -> bool {
        self.gap.abs() <= (self.sag * lit(NEARLY)).max(close)
    }
}

/// Measures the distances of `slave` to the nearest of `masters` and back, at points within `share` times the size of their facets. Points of a
/// master count where no other master is nearer to what they see of the slave.
///
/// Each side comes with the sag of its facets, zero ([`Sag::none`]) if it counts as exact.
pub fn clearance<const S: usize, const N: usize, T: Real>(
    slave: (&Trace<S, N, T>, &Sag<S, N, T>),
    masters: &[(&Trace<S, N, T>, &Sag<S, N, T>)],
    share: T,
    floor: T,
) -> Clearance<T> {
    let mut all = Clearance::new();
    let mut table = MapTable::new();
    let own = Skin::new(slave.0, slave.1);
    let others: Vec<Skin<'_, S, N, T>> = masters.iter().map(|(t, s)| Skin::new(t, s)).collect();
    let mut look = |from: (&Trace<S, N, T>, &Sag<S, N, T>), at: &[&Skin<'_, S, N, T>], rivals: &[&Skin<'_, S, N, T>]| {
        let boxes = from.0.space.all_bounds();
        for (f, bounds) in boxes.iter().enumerate() {
            let reach = (bounds.diagonal() * share).max(floor);
            let points = raised(from.0, from.1, f, &between_nodes(from.0.space.cell(f)), &mut table);
            let weight = bounds.diagonal().powi(S as i32) / num(points.len());
            for point in &points {
                let seen = at.iter().filter_map(|skin| skin.seen(point, reach, floor, &mut table));
                let nearest = seen.reduce(|a, b| if b.0.gap.abs() < a.0.gap.abs() { b } else { a });
                let Some((sight, foot)) = nearest else { continue };
                let own = sight.gap.abs();
                let nearer = |rival: &&Skin<'_, S, N, T>| rival.sight(&foot, own, floor, &mut table).is_some_and(|s| s.gap.abs() < own);
                if own <= floor || !rivals.iter().any(nearer) {
                    all.see(&sight, weight, floor);
                }
            }
        }
    };
    look(slave, &others.iter().collect::<Vec<_>>(), &[]);
    for (k, master) in masters.iter().enumerate() {
        let rivals: Vec<_> = others.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, skin)| skin).collect();
        look(*master, &[&own], &rivals);
    }
    all
}
