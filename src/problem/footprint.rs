//! The points of ties and contacts on the sides of the bodies at a time.

use super::contact_part::faced;
use super::handles::InterfaceId;
use super::model::{BodySide, ContactModel, ContactPart, Model, Opposing, TiePart};
use crate::basis::Order;
use crate::coupling::Segments;
use crate::geometry::{Bounds, Geometry, MapTable};
use crate::linalg::Vector;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Sum of the shares of an element that two interfaces cover, above which they have points in common.
const COMMON: f64 = 1.1;

/// A point of a side: place and outward normal.
pub(super) type SidePlace<const N: usize> = (Vector<N>, Vector<N>);

/// The points of an interface on the side of a body, by the elements of the side.
pub(super) struct Footprint<'a, const S: usize, const N: usize> {
    pub side: &'a BodySide<S, N>,
    points: BTreeMap<usize, Vec<SidePlace<N>>>,
    /// Share of every element that the points stand for, and a box around them in its local coordinates.
    covered: BTreeMap<usize, (f64, Bounds<S>)>,
    /// Elements of the side with points, by the elements of the body that they belong to.
    of_body: HashMap<usize, Vec<usize>>,
}

impl<'a, const S: usize, const N: usize> Footprint<'a, S, N> {
    /// The points of lists of segments on the slave or on the master; `own` gives an element's number on `side` if it is one of it.
    fn new<'b>(
        side: &'a BodySide<S, N>,
        lists: impl IntoIterator<Item = &'b Segments<S>>,
        is_master: bool,
        own: &dyn Fn(usize) -> Option<usize>,
    ) -> Self {
        let (trace, mut map) = (&side.trace, MapTable::new());
        let (mut all, mut covered) = (BTreeMap::<usize, Vec<SidePlace<N>>>::new(), BTreeMap::<usize, (f64, Bounds<S>)>::new());
        for segments in lists {
            let (elements, xi) = if is_master { (&segments.master, &segments.master_xi) } else { (&segments.slave, &segments.slave_xi) };
            for piece in 0..segments.num_pieces() {
                let Some(element) = own(elements[piece]) else { continue };
                let points = segments.points(piece);
                trace.space.map(element, &xi[points.clone()], Order::Gradients, &mut map);
                let places = map.x.iter().zip(&map.jacobian).map(|(x, j)| (*x, trace.normal(element, j)));
                all.entry(element).or_default().extend(places);
                let Some(around) = Bounds::around(&xi[points.clone()]) else { continue };
                let own = covered.entry(element).or_insert((0.0, around));
                *own = (own.0 + segments.ds[points].iter().sum::<f64>(), own.1.union(&around));
            }
        }
        for (&element, (share, _)) in &mut covered {
            *share /= side.measure_of(element, &mut map);
        }
        let mut of_body: HashMap<usize, Vec<usize>> = HashMap::new();
        all.keys().for_each(|&e| of_body.entry(trace.facets[e].element).or_default().push(e));
        Self { side, points: all, covered, of_body }
    }

    /// Whether both have points in common: they stand for more than an element, and their boxes in it overlap. Shares of a master by the points of
    /// its slave are not exact, and neither are boxes of parts that are none.
    pub fn meets(&self, other: &Footprint<'_, S, N>) -> bool {
        self.facets_of(other.side).any(|[e, f]| {
            let [Some((a, own)), Some((b, theirs))] = [self.covered.get(&e), other.covered.get(&f)] else { return false };
            a.min(1.0) + b.min(1.0) > COMMON && own.meets(theirs)
        })
    }

    /// Pairs of elements, of this side and of `other`, that are the same facet.
    pub fn facets_of(&self, other: &BodySide<S, N>) -> impl Iterator<Item = [usize; 2]> {
        let facets = if self.side.patch == other.patch { &other.trace.facets[..] } else { &[] };
        facets.iter().enumerate().filter_map(|(o, facet)| {
            let e = self.of_body.get(&facet.element)?.iter().find(|&&e| self.side.trace.facets[e] == *facet)?;
            Some([*e, o])
        })
    }

    /// The elements that are of `other`, too.
    pub fn elements_of(&self, other: &BodySide<S, N>) -> BTreeSet<usize> {
        self.facets_of(other).map(|[e, _]| e).collect()
    }

    /// The points that are of `other`, too.
    pub fn places_of(&self, other: &BodySide<S, N>) -> impl Iterator<Item = &SidePlace<N>> {
        self.facets_of(other).flat_map(|[e, _]| &self.points[&e])
    }
}

/// A slave side with what it faces.
pub(super) struct Joint<'a, const S: usize, const N: usize> {
    /// The tie or contact.
    pub id: InterfaceId,
    /// Its name.
    pub name: &'a str,
    /// Place of the slave side in the statement.
    pub number: usize,
    /// Whether its method takes fluxes for what crosses.
    pub by_fluxes: bool,
    /// The slave side, then what it faces; against an obstacle the slave side alone.
    pub sides: Vec<Footprint<'a, S, N>>,
    /// The elements that face each other: of the slave side, the number of the other side in `sides`, and the element there; none against an
    /// obstacle.
    pub pairs: BTreeSet<(usize, usize, usize)>,
}

/// The footprints of a slave side and what it faces, and which elements face each other.
type Footprints<'a, const S: usize, const N: usize> = (Vec<Footprint<'a, S, N>>, BTreeSet<(usize, usize, usize)>);

impl<const S: usize, const N: usize> Joint<'_, S, N> {
    pub fn is_tie(&self) -> bool {
        matches!(self.id, InterfaceId::Tie(_))
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// All ties and contacts, with what obstacles that move face at time `t`.
    pub(super) fn joints_at(&self, t: f64) -> Vec<Joint<'_, S, N>> {
        let ties = self.ties.iter().flat_map(|tie| {
            tie.parts.iter().enumerate().map(|(number, part)| {
                let (sides, pairs) = of_tie(part);
                Joint { id: tie.id.into(), name: &tie.name, number, by_fluxes: part.coupling.needs_fluxes(), sides, pairs }
            })
        });
        let contacts = self.contacts.iter().flat_map(|contact| {
            contact.parts.iter().map(move |part| {
                let ((sides, pairs), by_fluxes) = (of_contact(contact, part, t), contact.method.needs().fluxes);
                Joint { id: contact.id.into(), name: &contact.name, number: part.number, by_fluxes, sides, pairs }
            })
        });
        ties.chain(contacts).collect()
    }
}

fn of_tie<const S: usize, const N: usize>(part: &TiePart<S, N>) -> Footprints<'_, S, N> {
    let slave = Footprint::new(&part.slave, part.pairings.iter().map(|pairing| &pairing.segments), false, &Some);
    let masters = part.pairings.iter().map(|pairing| Footprint::new(&pairing.master, [&pairing.segments], true, &Some));
    let pairs = part.pairings.iter().enumerate().flat_map(|(k, pairing)| {
        let segments = &pairing.segments;
        segments.slave.iter().zip(&segments.master).map(move |(&slave, &master)| (slave, k + 1, master))
    });
    let pairs = pairs.collect();
    (std::iter::once(slave).chain(masters).collect(), pairs)
}

fn of_contact<'a, const S: usize, const N: usize>(
    contact: &ContactModel<S, N>,
    part: &'a ContactPart<S, N>,
    t: f64,
) -> Footprints<'a, S, N> {
    let moved = match &part.against {
        Opposing::Rigid(obstacle, ..) if obstacle.changes => Some(faced(&part.slave, &part.against, contact.reach, t)),
        _ => None,
    };
    let segments = moved.as_ref().unwrap_or(&part.first.segments);
    let (mut sides, mut pairs) = (vec![Footprint::new(&part.slave, [segments], false, &Some)], BTreeSet::new());
    if let Opposing::Side(..) = part.against {
        let mut first = 0;
        for master in &part.masters {
            let (from, to) = (first, first + master.trace.facets.len());
            first = to;
            let own = |e: usize| (from..to).contains(&e).then(|| e - from);
            let faced = segments.slave.iter().zip(&segments.master);
            pairs.extend(faced.filter_map(|(&slave, &master)| Some((slave, sides.len(), own(master)?))));
            sides.push(Footprint::new(master, [segments], true, &own));
        }
    }
    (sides, pairs)
}
