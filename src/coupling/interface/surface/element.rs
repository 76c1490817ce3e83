//! One slave element: its facets, their regions, and the points of these with their partners.

use super::super::Partners;
use super::super::slave_pieces::{Point, SlavePieces};
use super::cell_rule::{WeightedPoints, fill};
use super::chart::Chart;
use super::facets::{Facet, Facets};
use super::nearby::{TurningPart, all_parts, any_near, any_turns, parts};
use super::numbers::ByNumber;
use super::owner::{Foot, MasterSurface};
use super::piece::{EdgePiece, LineRule};
use super::polygon::Polygon;
use super::regions::{Region, Regions, are_apart, regions};
use super::skeleton::Skeleton;
use super::slave::Own;
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Bounds, Geometry, MapTable, cross, opposes, unit_normal};
use crate::linalg::Vector;
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};

/// Deviation of the sum of regions from the facet that is rounding.
const TILES: f64 = 1e-9;
/// Entries of the map between two cells, over its largest, below which their axes are parallel.
const ALIGNED: f64 = 1e-9;
/// Most Gauss points per direction.
const MOST_POINTS: usize = 16;
/// Cuttings in four of a facet whose regions do not tile it.
const AGAIN: usize = 4;
/// Share of the extent of a facet by which its box is inflated in the search.
const SLACK: f64 = 0.15;
/// Share of a facet, about its centre, on which a grid tells whether it is faced: at its sides the closest point may be a rim.
const INSIDE: f64 = 0.999;
/// Facets of a slave part that tell whether it faces a part of the master.
const TOLD_BY: usize = 200;

/// Both sides and their rules.
pub(super) struct Sides<'a> {
    pub slave: Facets<'a>,
    pub skeleton: Skeleton,
    pub master: MasterSurface<'a>,
    pub partners: Partners,
    pub points: usize,
    /// Sizes of the slave, and of the larger side.
    pub sizes: [f64; 2],
    /// Gauss rules on [0, 1] by their number of points.
    pub lines: Vec<LineRule>,
    own: [Rule<2>; 2],
    /// +1 where the walked normals of a slave part and a master part point to the same side.
    same: ByNumber<(usize, usize), f64>,
    /// Boxes of the slave's elements.
    boxes: Vec<Bounds<3>>,
    /// Parts of the master's facets, if facets of a side turn much.
    parts: Vec<Vec<TurningPart>>,
}

/// Scratch memory of a thread from one element to the next: points of a region in the chart and in space, their weights, normals and feet.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    at: Vec<Vector<2>>,
    x: Vec<Vector<3>>,
    ds: Vec<f64>,
    normals: Vec<Vector<3>>,
    feet: Vec<Foot>,
    pub table: MapTable<2, 3>,
}

/// A facet of the slave in work: where it lies, and what its chart is oriented by.
struct Work<'w, 'a> {
    facets: &'w Facets<'a>,
    facet: usize,
    /// The facet of the slave's skeleton of which it is a part.
    whole: usize,
}

impl<'a> Sides<'a> {
    pub fn new(
        slave: &'a dyn Geometry<2, 3>,
        master: &'a dyn Geometry<2, 3>,
        partners: Partners,
        points: usize,
    ) -> Result<Self, CouplingError> {
        let size = |map: &dyn Geometry<2, 3>| map.extent().map_or(0.0, |b| b.diagonal());
        let slave_size = size(slave);
        let sizes = [slave_size, slave_size.max(size(master))];
        let of_slave = || Facets::new(slave).map(|facets| (Skeleton::new(&facets), facets, slave.all_bounds()));
        let (of_slave, of_master) = parallel::both(of_slave, || MasterSurface::new(master));
        let (skeleton, facets, boxes) = of_slave?;
        let own = [TensorRule::<2>::gauss([points + 4; 2]).rule(0).clone(), simplex_rule(2 * points + 7)];
        let lines = (0..=MOST_POINTS.max(2 * points + 3)).map(|n| LineRule::new(n.max(1))).collect();
        let master = of_master?;
        let parts = if any_turns(&facets) || any_turns(&master.facets) { all_parts(&master.facets) } else { Vec::new() };
        let same = ByNumber::default();
        let mut sides = Self { slave: facets, skeleton, master, partners, points, sizes, lines, own, same, boxes, parts };
        sides.orient();
        Ok(sides)
    }

    /// Finds the parts that face each other in one orientation, by the nearest pair of normals.
    fn orient(&mut self) {
        let stride = self.slave.list.len().div_ceil(TOLD_BY).max(1);
        let mut nearest: ByNumber<(usize, usize), (f64, f64)> = ByNumber::default();
        let mut table = MapTable::new();
        for s in (0..self.slave.list.len()).step_by(stride) {
            let center = self.slave.list[s].polygon.center();
            self.slave.at(s, &[center], Order::Gradients, &mut table);
            let (x, own) = (table.x[0], unit_normal(&table.jacobian[0], self.skeleton.sign[s]));
            let Some(hit) = self.master.nearest(&x) else { continue };
            self.master.facets.map.map(hit.element, &[hit.xi], Order::Gradients, &mut table);
            let f = self.master.facets.start[hit.element];
            let along = own.dot(&unit_normal(&table.jacobian[0], self.master.skeleton.sign[f]));
            // slanted pairs tell little
            let key = hit.distance + (1.0 - along.abs()) * self.sizes[1];
            let pair = nearest.entry((self.skeleton.part[s], self.master.skeleton.part[f])).or_insert((f64::INFINITY, 1.0));
            if key < pair.0 {
                *pair = (key, along.signum());
            }
        }
        self.same = nearest.into_iter().map(|(parts, (_, sign))| (parts, sign)).collect();
    }

    /// +1 where a slave facet and a master facet face each other with their own orientations alike, -1 with opposite ones.
    pub fn sign(&self, s: usize, f: usize) -> f64 {
        let (own, other) = (&self.slave.list[s], &self.master.facets.list[f]);
        let outward = self.partners.outward(self.slave.map, own.element).zip(self.master.facets.map.outward(other.element));
        if let Some((a, b)) = outward {
            return -a * b;
        }
        let (skeleton, parts) = (&self.master.skeleton, (self.skeleton.part[s], self.master.skeleton.part[f]));
        match self.same.get(&parts) {
            Some(same) => same * self.skeleton.sign[s] * skeleton.sign[f],
            None => own.normal.dot(&other.normal).signum(),
        }
    }

    /// Integrates one element.
    pub fn element(&self, element: usize, scratch: &mut Scratch) -> SlavePieces<2, f64> {
        let mut part = SlavePieces::new(element);
        let (mut whole, mut lost, mut share) = (true, false, 0.0);
        let range = self.slave.of(element);
        let count = range.len() as f64;
        for s in range {
            let work = Work { facets: &self.slave, facet: s, whole: s };
            let done = self.facet(&work, AGAIN, &mut part, scratch);
            whole &= (done.share - 1.0).abs() <= TILES;
            lost |= done.lost;
            share += done.share / count;
        }
        let mut measure = || {
            let rule = |s: usize| &self.own[usize::from(self.slave.list[s].polygon == Polygon::Triangle)];
            self.slave.of(element).map(|s| self.slave.measure(s, rule(s), &mut scratch.table)).sum()
        };
        part.whole = whole && !lost;
        part.measure = if part.whole { part.covered } else { measure() };
        part.lost = lost.then_some(share);
        part
    }

    /// Integrates a facet; one that its regions do not tile is cut in four.
    fn facet(&self, work: &Work<'_, 'a>, again: usize, part: &mut SlavePieces<2, f64>, scratch: &mut Scratch) -> Done {
        let candidates = self.candidates(work, &mut scratch.table);
        let rounding = candidates.iter().map(|&(f, _)| self.master.facets.list[f].rounding).fold(0.0, f64::max);
        let mut chart = Chart::new(work.facets, work.facet, rounding);
        let cell = chart.polygon.area();
        let mut found = regions(&mut chart, &self.master, &candidates, &mut scratch.table);
        // what is rounding in a facet is four times as much in a quarter of it
        let rest = TILES * 4f64.powi((AGAIN - again) as i32);
        if found.share(cell) > 1.0 + rest {
            self.confirm(&mut chart, &mut found);
        }
        let filled: Vec<WeightedPoints> = found.list.iter().map(|region| self.points(work, region)).collect();
        let share = filled.iter().flatten().map(|p| p.1).sum::<f64>() / cell;
        let tiles = (share - 1.0).abs() <= rest && (found.share(cell) - share).abs() <= rest;
        let may_be_open = |chart: &mut Chart<'_>| match self.partners.touch() {
            true => found.has_rim || found.list.is_empty() && !self.touches(chart),
            false => found.has_rim || !self.is_faced(work, chart),
        };
        let is_lost = !tiles && (share > 1.0 + rest || !may_be_open(&mut chart));
        if is_lost
            && again > 0
            && let Some(quarters) = work.facets.quarters(work.facet)
        {
            let mut all = Done { share: 0.0, lost: false };
            for facet in 0..quarters.list.len() {
                let work = Work { facets: &quarters, facet, whole: work.whole };
                let done = self.facet(&work, again - 1, part, scratch);
                all = Done { share: all.share + 0.25 * done.share, lost: all.lost | done.lost };
            }
            return all;
        }
        let mut done = Done { share: 0.0, lost: is_lost };
        for (region, points) in found.list.iter().zip(&filled) {
            if self.pair(work, &mut chart, region, points, part, scratch) {
                done.share += points.iter().map(|p| p.1).sum::<f64>() / cell;
            }
        }
        // regions that tile it, of which some found no partners
        let dropped = !self.partners.touch() && tiles && share - done.share > rest;
        done.lost |= dropped && self.is_faced(work, &mut chart);
        done
    }

    /// Gauss points per direction that integrate products of functions of two affine cells, and of each with itself, on a region with straight
    /// sides.
    ///
    /// Functions of degree p of a triangle have total degree p, those of a tensor cell 2 p. On a sector of a region a product of total degree d
    /// has the degree d + 1 along the rays, so that d / 2 + 1 points are exact; on rectangles along both cells the degree is 2 p per
    /// direction, and p + 1 are.
    fn exact_points(&self, own: &Facet, other: &Facet, chain: &[EdgePiece]) -> usize {
        let is_triangle = [own, other].map(|facet| facet.polygon == Polygon::Triangle);
        let are_aligned = || {
            let turn = own.back * other.jacobian;
            let (along, across) = (turn.diagonal().amax(), turn[(0, 1)].abs().max(turn[(1, 0)].abs()));
            along.min(across) <= ALIGNED * along.max(across)
        };
        // rounding may leave a corner within a side, with which the region is no rectangle to `fill`
        let is_rectangle =
            || chain.len() == 4 && chain.iter().map(|piece| piece.to() - piece.from()).all(|d| d.amin() <= ALIGNED * d.amax());
        let is_product = is_triangle == [false; 2] && are_aligned() && is_rectangle();
        if is_triangle == [true; 2] || is_product { self.points } else { 2 * self.points - 1 }
    }

    /// Points and weights of a region in the chart.
    fn points(&self, work: &Work<'_, 'a>, region: &Region) -> WeightedPoints {
        let (own, other) = (&work.facets.list[work.facet], &self.master.facets.list[region.facet]);
        let is_straight = own.affine && other.affine && !region.chain.iter().any(EdgePiece::is_curve);
        let n = if is_straight { self.exact_points(own, other, &region.chain) } else { (self.points + 3).max(5) };
        let own_pole = own.pole.then(|| own.polygon.corner(2));
        let poles: Vec<Vector<2>> = own_pole.into_iter().chain(region.pole).collect();
        let mut points = Vec::with_capacity(region.chain.len() * n * n);
        fill(&region.chain, &poles, &self.lines[n], &mut points);
        points
    }

    /// Master facets that may hold partners of a slave element.
    pub fn near(&self, element: usize, table: &mut MapTable<2, 3>) -> Vec<usize> {
        let of = |s: usize| self.candidates(&Work { facets: &self.slave, facet: s, whole: s }, table);
        self.slave.of(element).flat_map(of).map(|(f, _)| f).collect()
    }

    /// Master facets that may hold partners of a slave facet, with their [`sign`](Self::sign).
    fn candidates(&self, work: &Work<'_, 'a>, table: &mut MapTable<2, 3>) -> Vec<(usize, f64)> {
        let own = &work.facets.list[work.facet];
        let bounds = match work.facets.is_whole(work.facet) {
            true => self.boxes[own.element],
            false => work.facets.bounds(work.facet, table),
        };
        let extent = bounds.diagonal();
        let (allowed, _) = self.partners.allowed(self.sizes[1], self.sizes[0], [extent; 2]);
        let margin = if self.partners.touch() && allowed.is_finite() { allowed } else { self.reach(work, allowed, table) };
        let around = margin + SLACK * extent;
        // sides that touch do so in every part; elsewhere the distance to the partners was looked at in some points
        let reach = if self.partners.touch() { margin } else { around };
        let found = self.master.candidates(&bounds.inflated(around));
        let signed = found.into_iter().map(|f| (f, self.sign(work.whole, f)));
        let cone_of = |facets: &Facets<'_>, f: usize| (facets.list[f].normal, facets.list[f].cone);
        let (normal, cone) = cone_of(work.facets, work.facet);
        let parts = if self.parts.is_empty() { Vec::new() } else { parts(work.facets, work.facet, table) };
        let may_face = |&(f, sign): &(usize, f64)| {
            let other = cone_of(&self.master.facets, f);
            !are_apart((&normal, cone), (&other.0, other.1), sign) && (parts.is_empty() || any_near(&parts, &self.parts[f], reach, sign))
        };
        signed.filter(may_face).collect()
    }

    /// Largest distance of partners of a facet: that at its corners and centre, but not beyond what is allowed.
    fn reach(&self, work: &Work<'_, 'a>, allowed: f64, table: &mut MapTable<2, 3>) -> f64 {
        let polygon = work.facets.list[work.facet].polygon;
        let mut points: Vec<Vector<2>> = (0..polygon.sides()).map(|k| polygon.corner(k)).collect();
        points.push(polygon.center());
        work.facets.at(work.facet, &points, Order::Values, table);
        let far = table.x.iter().filter_map(|x| self.master.nearest(x)).map(|hit| hit.distance).fold(0.0, f64::max);
        far.min(allowed)
    }

    /// Whether the middle of a facet of touching sides has a partner.
    fn touches(&self, chart: &mut Chart<'_>) -> bool {
        let center = chart.polygon.center();
        let x = chart.eval(&[center]).x[0];
        let (allowed, _) = self.partners.allowed(self.sizes[1], self.sizes[0], [0.0; 2]);
        self.master.project(&x).is_some_and(|hit| !hit.rim && hit.distance <= allowed)
    }

    /// Whether every point of a grid in a facet has a partner: a closest point that is no rim, within reach, on a facet that opposes it.
    fn is_faced(&self, work: &Work<'_, 'a>, chart: &mut Chart<'_>) -> bool {
        let element = work.facets.list[work.facet].element;
        let outward = self.partners.outward(self.slave.map, element);
        let (allowed, _) = self.partners.allowed(self.sizes[1], self.sizes[0], [0.0; 2]);
        let mut table = MapTable::new();
        let (facets, center, mut grid) = (&self.master.facets, chart.polygon.center(), chart.polygon.grid(5));
        grid.iter_mut().for_each(|at| *at = center + (*at - center) * INSIDE);
        let here = chart.eval(&grid);
        here.x.iter().zip(&here.jacobian).all(|(x, jacobian)| {
            let Some(hit) = self.master.project(x).filter(|hit| !hit.rim && hit.distance <= allowed) else { return false };
            let Some(own) = outward.map(|a| unit_normal(jacobian, a)) else { return true };
            self.master.holding(&hit, &mut table).into_iter().any(|(f, eta)| {
                facets.at(f, &[eta], Order::Gradients, &mut table);
                facets.map.outward(facets.list[f].element).is_none_or(|b| opposes(&own, &unit_normal(&table.jacobian[0], b)))
            })
        })
    }

    /// Drops regions of which the closest point does not say that they face their facet.
    fn confirm(&self, chart: &mut Chart<'_>, found: &mut Regions) {
        found.list.retain(|region| {
            let middle = region.chain.iter().fold(Vector::zeros(), |s: Vector<2>, piece| s + piece.from()) / region.chain.len() as f64;
            let x = chart.eval(&[middle]).x[0];
            self.master.owns(region.facet, &x)
        });
    }

    /// Appends the points of a region with their feet; false where it is not paired.
    fn pair(
        &self,
        work: &Work<'_, 'a>,
        chart: &mut Chart<'_>,
        region: &Region,
        points: &WeightedPoints,
        part: &mut SlavePieces<2, f64>,
        scratch: &mut Scratch,
    ) -> bool {
        if points.is_empty() {
            return false;
        }
        let (own, other) = (&work.facets.list[work.facet], &self.master.facets.list[region.facet]);
        let Scratch { at, x, ds, normals, feet, table } = scratch;
        at.clear();
        at.extend(points.iter().map(|p| p.0));
        let here = chart.eval(at);
        x.clone_from(&here.x);
        normals.clear();
        normals.extend(here.jacobian.iter().map(cross));
        ds.clear();
        ds.extend(normals.iter().zip(points).map(|(n, p)| n.norm() * p.1));
        let measure: f64 = ds.iter().sum();
        let center = x.iter().zip(ds.iter()).fold(Vector::zeros(), |s: Vector<3>, (x, w)| s + x * *w) / measure.max(f64::MIN_POSITIVE);
        self.master.feet(region.facet, &center, x, feet, table);
        if !self.faces(own.element, other.element, &normals[0], region.facet, &feet[0], table) {
            return false;
        }
        // far from the master feet on one continued facet may end: each point takes the facet of its own closest point
        if !self.partners.touch() && feet.iter().any(|foot| !foot.found) {
            let point = |q: usize| Own { x: x[q], normal: normals[q], xi: own.local(&at[q]), ds: ds[q] };
            return self.closest(own.size, (0..x.len()).map(point), part, table);
        }
        let lengths = [own.size, other.size];
        let (allowed, _) = self.partners.allowed(self.sizes[1], self.sizes[0], lengths);
        let distance = |q: usize| (x[q] - feet[q].x).norm();
        let mean = (0..x.len()).map(|q| distance(q) * ds[q]).sum::<f64>() / measure.max(f64::MIN_POSITIVE);
        let is_far = match self.partners {
            Partners::Touching(_) => false,
            Partners::Near(_) => (0..x.len()).any(|q| distance(q) > allowed),
            Partners::Facing { .. } => mean > allowed,
        };
        if is_far {
            return false;
        }
        part.covered += measure;
        for (q, x) in x.iter().enumerate() {
            part.see(x, distance(q), allowed);
        }
        let list: Vec<Point<2, f64>> = (0..x.len()).map(|q| (own.local(&at[q]), other.local(&feet[q].eta), ds[q])).collect();
        part.pieces.push((other.element, list));
        true
    }

    /// Whether a facet opposes the slave's normal, where sides in contact have outward signs.
    fn faces(&self, own: usize, other: usize, normal: &Vector<3>, f: usize, foot: &Foot, table: &mut MapTable<2, 3>) -> bool {
        let Some((a, b)) = self.partners.outward(self.slave.map, own).zip(self.master.facets.map.outward(other)) else { return true };
        self.master.facets.at(f, &[foot.eta], Order::Gradients, table);
        opposes(&(normal * (a / normal.norm().max(f64::MIN_POSITIVE))), &unit_normal(&table.jacobian[0], b))
    }
}

/// Coverage of a facet: the share that has points, and whether a part is lost.
#[derive(Clone, Copy)]
struct Done {
    share: f64,
    lost: bool,
}
