//! Sides of ties and contacts by fluxes that carry something else as well.
//!
//! Nitsche's method takes the stress of a side for what crosses the interface. Where the side has a load t, springs k, a support or another
//! interface with the pressure p in the same points, the stress is
//!
//! ```text
//! sigma n = lambda + t - k u + reaction + p n
//! ```
//!
//! and the method would be wrong by the rest of it, on every mesh. Of contacts only the part along the normal counts. Components in which
//! all sides of an interface are held do no harm: nothing moves there.

use super::data::Point;
use super::interface_error::{Carried, InterfaceError};
use super::model::{BodySide, ContactPart, Model, Opposing, TiePart};
use crate::basis::Order;
use crate::coupling::Segments;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Vector, measure};
use crate::quadrature::Quadrature;
use std::collections::{BTreeMap, HashMap};

/// Sum of the shares of an element that two interfaces cover, above which they have points in common.
const COMMON: f64 = 1.1;
/// Components of a unit vector below this count as zero.
const PERPENDICULAR: f64 = 1e-9;

/// A point of a side: place and outward normal.
type SidePlace<const N: usize> = (Vector<N>, Vector<N>);

/// The points of an interface on the side of a body, by the elements of the side.
struct Footprint<'a, const S: usize, const N: usize> {
    side: &'a BodySide<S, N>,
    points: BTreeMap<usize, Vec<SidePlace<N>>>,
    /// Share of every element that the points stand for.
    share: BTreeMap<usize, f64>,
}

impl<'a, const S: usize, const N: usize> Footprint<'a, S, N> {
    fn of(side: &'a BodySide<S, N>) -> Self {
        Self { side, points: BTreeMap::new(), share: BTreeMap::new() }
    }

    /// Adds the points of `segments` on the slave or on the master, `own` the number of an element on the side if it is one of it.
    fn add(&mut self, model: &Model<S, N>, segments: &Segments<S>, is_master: bool, own: &dyn Fn(usize) -> Option<usize>) {
        let (trace, mut map) = (&self.side.trace, MapTable::new());
        let (elements, xi) = if is_master { (&segments.master, &segments.master_xi) } else { (&segments.slave, &segments.slave_xi) };
        for piece in 0..segments.num_pieces() {
            let Some(element) = own(elements[piece]) else { continue };
            let points = segments.points(piece);
            trace.space.map(element, &xi[points.clone()], Order::Gradients, &mut map);
            let places = map.x.iter().zip(&map.jacobian).map(|(x, j)| (*x, trace.normal(element, j)));
            self.points.entry(element).or_default().extend(places);
            *self.share.entry(element).or_default() += map.x.iter().zip(points).map(|(x, q)| segments.ds[q] / model.around(x)).sum::<f64>();
        }
    }

    /// Measures of what is covered, as shares of the elements.
    fn shares(mut self) -> Self {
        let mut map = MapTable::new();
        for (&element, share) in &mut self.share {
            let rule = self.side.rules.rule(element);
            self.side.trace.space.map(element, &rule.points, Order::Gradients, &mut map);
            *share /= rule.weights.iter().zip(&map.jacobian).map(|(w, j)| w * measure(j)).sum::<f64>();
        }
        self
    }

    /// Pairs of elements, of this side and of `other`, that are the same facet.
    fn facets_of(&self, other: &BodySide<S, N>) -> Vec<[usize; 2]> {
        if self.side.patch != other.patch {
            return Vec::new();
        }
        let mut of: HashMap<usize, Vec<usize>> = HashMap::new();
        other.trace.facets.iter().enumerate().for_each(|(e, facet)| of.entry(facet.element).or_default().push(e));
        let same = |e: usize| {
            let facet = &self.side.trace.facets[e];
            of.get(&facet.element)?.iter().copied().find(|&o| other.trace.facets[o] == *facet).map(|o| [e, o])
        };
        self.points.keys().filter_map(|&e| same(e)).collect()
    }

    /// The points that are of `other`, too.
    fn places_of(&self, other: &BodySide<S, N>) -> impl Iterator<Item = &SidePlace<N>> {
        self.facets_of(other).into_iter().flat_map(|[e, _]| &self.points[&e])
    }
}

/// A slave side with what it faces.
struct Joint<'a, const S: usize, const N: usize> {
    /// Whether it is of a tie, its number among ties or contacts, and that of the slave side.
    of: (bool, usize, usize),
    name: &'a str,
    /// Whether its method takes fluxes for what crosses.
    by_fluxes: bool,
    sides: Vec<Footprint<'a, S, N>>,
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Slave sides of ties and contacts by fluxes, one of whose sides carries something else at one of the `times`: whether it is of a tie, the
    /// numbers of tie or contact and slave, and the error.
    pub(super) fn carried(&self, times: &[f64]) -> Vec<((bool, usize, usize), InterfaceError)> {
        let ties = self.ties.iter().any(|tie| tie.parts.iter().any(|part| part.coupling.needs_fluxes()));
        if !ties && !self.contacts.iter().any(|contact| contact.method.needs().fluxes) {
            return Vec::new();
        }
        let joints = self.joints();
        let found = joints.iter().filter(|joint| joint.by_fluxes).filter_map(|joint| {
            let own =
                joint.sides.iter().find_map(|side| Some((side, self.load(joint, side, times).or_else(|| self.support(joint, side))?)));
            let other = || joints.iter().filter(|o| o.of.0 != joint.of.0 || o.of.1 != joint.of.1).find_map(|other| common(joint, other));
            let (side, carried) = own.or_else(other)?;
            Some((joint.of, InterfaceError::Carries { side: side.side.label.clone(), carried }))
        });
        found.collect()
    }

    /// All ties and contacts.
    fn joints(&self) -> Vec<Joint<'_, S, N>> {
        let mut all = Vec::new();
        for (k, tie) in self.ties.iter().enumerate() {
            for (p, part) in tie.parts.iter().enumerate() {
                let by_fluxes = part.coupling.needs_fluxes();
                all.push(Joint { of: (true, k, p), name: &tie.name, by_fluxes, sides: self.of_tie(part) });
            }
        }
        for (k, contact) in self.contacts.iter().enumerate() {
            for part in &contact.parts {
                let by_fluxes = contact.method.needs().fluxes;
                all.push(Joint { of: (false, k, part.number), name: &contact.name, by_fluxes, sides: self.of_contact(part) });
            }
        }
        all
    }

    fn of_tie<'a>(&self, part: &'a TiePart<S, N>) -> Vec<Footprint<'a, S, N>> {
        let mut slave = Footprint::of(&part.slave);
        let masters = part.pairings.iter().map(|pairing| {
            slave.add(self, &pairing.segments, false, &Some);
            let mut master = Footprint::of(&pairing.master);
            master.add(self, &pairing.segments, true, &Some);
            master
        });
        let masters: Vec<_> = masters.collect();
        std::iter::once(slave).chain(masters).map(Footprint::shares).collect()
    }

    fn of_contact<'a>(&self, part: &'a ContactPart<S, N>) -> Vec<Footprint<'a, S, N>> {
        let segments = &part.first.segments;
        let mut slave = Footprint::of(&part.slave);
        slave.add(self, segments, false, &Some);
        let mut sides = vec![slave];
        if let Opposing::Side(..) = part.against {
            let mut first = 0;
            for master in &part.masters {
                let (from, to) = (first, first + master.trace.facets.len());
                first = to;
                let mut footprint = Footprint::of(master);
                footprint.add(self, segments, true, &|e| (from..to).contains(&e).then(|| e - from));
                sides.push(footprint);
            }
        }
        sides.into_iter().map(Footprint::shares).collect()
    }

    /// A load, or springs, at the points of a side of `joint`.
    fn load(&self, joint: &Joint<'_, S, N>, side: &Footprint<'_, S, N>, times: &[f64]) -> Option<Carried> {
        let counts = |force: &[f64], n: &Vector<N>| match joint.of.0 {
            true => force.iter().any(|f| *f != 0.0),
            false => {
                force.iter().zip(n.iter()).map(|(f, n)| f * n).sum::<f64>().abs()
                    > PERPENDICULAR * force.iter().map(|f| f.abs()).sum::<f64>()
            }
        };
        let mut force = vec![0.0; self.components];
        for load in self.loads.iter().filter(|load| load.side.patch == side.side.patch) {
            let mut acts = |t: f64, (x, n): &SidePlace<N>| {
                self.side_force(load, &self.patches[load.side.patch].physics_at(t), t, x, n, &mut force);
                counts(&force, n)
            };
            if side.places_of(&load.side).any(|place| times.iter().any(|&t| acts(t, place))) {
                return Some(Carried::Load(load.name.clone()));
            }
        }
        for spring in self.springs.iter().filter(|spring| spring.side.patch == side.side.patch) {
            let stiffness = |t: f64, x: &Vector<N>| spring.stiffness.value(&Point::new(x.as_slice()).at_time(t));
            let acts = |t: f64, (x, n): &SidePlace<N>| {
                let mut force = vec![0.0; self.components];
                force[spring.component] = stiffness(t, x);
                counts(&force, n)
            };
            if side.places_of(&spring.side).any(|place| times.iter().any(|&t| acts(t, place))) {
                return Some(Carried::Spring(spring.name.clone()));
            }
        }
        None
    }

    /// A support at the points of a side of `joint`, in a direction in which not all its sides are held.
    fn support(&self, joint: &Joint<'_, S, N>, side: &Footprint<'_, S, N>) -> Option<Carried> {
        let held: Vec<Vec<Vector<N>>> = joint.sides.iter().map(|other| self.held_along(other, joint.of.0)).collect();
        let own = self.held_along(side, joint.of.0);
        // of a contact with an obstacle there is one side, and nothing to move against
        let everywhere = |d: &Vector<N>| held.len() > 1 && held.iter().all(|list| list.iter().any(|o| (o - d).norm() < PERPENDICULAR));
        own.iter().any(|d| !everywhere(d)).then_some(Carried::Support)
    }

    /// Directions in which supports hold points of the side; of a contact those that have a part along the normal.
    fn held_along(&self, side: &Footprint<'_, S, N>, is_tie: bool) -> Vec<Vector<N>> {
        let unit = |c: usize| Vector::<N>::from_fn(|k, _| if k == c { 1.0 } else { 0.0 });
        let mut held: Vec<Vector<N>> = Vec::new();
        let mut add = |of: &BodySide<S, N>, d: &dyn Fn(&Vector<N>) -> Vector<N>| {
            let found = side.places_of(of).map(|(_, n)| (d(n), n)).find(|(d, n)| is_tie || d.dot(n).abs() > PERPENDICULAR);
            held.extend(found.map(|(d, _)| d));
        };
        for c in self.conditions.iter() {
            add(&c.side, &|_| unit(c.component));
        }
        for h in &self.held {
            add(&h.side, &|_| h.direction);
        }
        for r in &self.rigid_sides {
            r.sides.iter().for_each(|of| add(of, &|_| unit(r.component)));
        }
        for slide in &self.slides {
            // tangents count in ties alone
            add(slide.side(), &|n| if slide.along_normal() { *n } else { Vector::zeros() });
        }
        held
    }
}

/// A side of `joint` that has points in common with another interface.
fn common<'a, const S: usize, const N: usize>(
    joint: &'a Joint<'a, S, N>,
    other: &Joint<'_, S, N>,
) -> Option<(&'a Footprint<'a, S, N>, Carried)> {
    let meets = |a: &Footprint<'_, S, N>, b: &Footprint<'_, S, N>| {
        a.facets_of(b.side).iter().any(|[e, f]| a.share[e] + b.share.get(f).unwrap_or(&0.0) > COMMON)
    };
    let side = joint.sides.iter().find(|a| other.sides.iter().any(|b| meets(a, b)))?;
    Some((side, Carried::Interface(other.name.to_owned())))
}
