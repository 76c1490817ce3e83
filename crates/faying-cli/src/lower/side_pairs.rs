//! Side pairs of the case: slaves with their masters, given by name or found by a search for touching sides.

use super::findings::{fault, unjoined, warning};
use super::lower_context::LowerContext;
use super::parts::{Centres, of_slaves, part};
use super::places::Places;
use super::sides::side_fault;
use crate::case::{Case, Contact, SideRef, Tie};
use crate::errors::Diagnostic;
use crate::formula::Formula;
use crate::place::{Located, SourceSpan};
use crate::registry::is_glue;
use crate::result::{GluedSides, TiedSides};
use faying::problem::touching::{PairedSides, Search, Share, TouchError};
use faying::problem::{Contents, Problem, SideView};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::ops::{Deref, Range};
use std::sync::Arc;

/// A couple with its source location in the case.
#[derive(Clone, Debug)]
pub(super) struct PairedSidesAt<const S: usize, const N: usize> {
    pub couple: PairedSides<S, N>,
    pub at: SourceSpan,
}

impl<const S: usize, const N: usize> Deref for PairedSidesAt<S, N> {
    type Target = PairedSides<S, N>;
    fn deref(&self) -> &Self::Target {
        &self.couple
    }
}

/// Side pairs of every interface in the order of the case; those of closed patches and multi-patch files are listed separately.
#[derive(Debug)]
pub(super) struct SidePairs<const S: usize, const N: usize> {
    /// Side pairs of each interface.
    pub ties: Vec<Vec<PairedSidesAt<S, N>>>,
    /// Side pairs glued without an interface: closed patches, files of several patches, groups of one mesh.
    seams: Vec<PairedSidesAt<S, N>>,
    /// Slaves and masters of the contacts, of the slaves the parts that are pressed.
    pressed: Vec<Arc<SideView<S, N>>>,
    /// The sides of boundary blocks but "all-outer".
    pub named: Vec<Arc<SideView<S, N>>>,
    /// The sides of "all-outer" that are joined, with their parts that nothing joins.
    pub joined_outer: HashMap<SideRef, Vec<Arc<SideView<S, N>>>>,
}

impl<const S: usize, const N: usize> SidePairs<S, N> {
    /// Side pairs of interfaces with shared functions, with the name of their interface: `coupling = "glue"`.
    fn glued_by_name<'a>(&'a self, case: &'a Case) -> impl Iterator<Item = (&'a str, &'a PairedSidesAt<S, N>)> {
        let ties = self.ties.iter().zip(&case.interfaces).filter(|(_, tie)| is_glue(&tie.coupling.value));
        ties.flat_map(|(couples, tie)| couples.iter().map(|couple| (tie.name.value.as_str(), couple)))
    }

    /// Side pairs with shared functions: `coupling = "glue"`, closed patches, files.
    pub fn glued<'a>(&'a self, case: &'a Case) -> impl Iterator<Item = &'a PairedSidesAt<S, N>> {
        self.glued_by_name(case).map(|(_, couple)| couple).chain(&self.seams)
    }

    /// The sides that couples join and contacts press.
    pub fn sides(&self) -> impl Iterator<Item = &Arc<SideView<S, N>>> {
        let couples = self.ties.iter().flatten().chain(&self.seams);
        couples.flat_map(|couple| couple.masters.iter().chain([&couple.slave])).chain(&self.pressed)
    }

    /// The sides of "all-outer" that are joined, with the measure of what nothing joins of them.
    pub fn free_measures(&self, contents: &Contents<'_, S, N>) -> HashMap<SideRef, f64> {
        let free = |part: &Arc<SideView<S, N>>| contents.body(part.body()).side_measure(part.trace());
        self.joined_outer.iter().map(|(side, parts)| (side.clone(), parts.iter().map(free).sum())).collect()
    }

    /// Distance and share of every pair of sides glued by an interface; closed patches and seams of files are left out.
    pub fn glued_sides(&self, case: &Case) -> Vec<GluedSides> {
        let of = |(interface, couple): (&str, &PairedSidesAt<S, N>)| {
            let slave = couple.slave.label();
            let tied = |s: Share<S, N>| TiedSides {
                slave: slave.to_owned(),
                master: s.master.label().to_owned(),
                distance: s.distance,
                share: s.share,
            };
            let shares = couple.shares().into_iter();
            shares.map(|s| GluedSides { interface: interface.to_owned(), sides: tied(s) }).collect::<Vec<_>>()
        };
        self.glued_by_name(case).flat_map(of).collect()
    }
}

/// Finds the side pairs of all interfaces; errors go to the context's faults.
///
/// `files` lists the patches that came from one file, with the source location of its name: their touching sides are glued.
pub(super) fn find<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    files: &[(Range<usize>, SourceSpan)],
) -> SidePairs<S, N> {
    let case = context.case;
    let mut of = |tie: &Tie| tie.filter.as_ref().map(|filter| slave_parts(context, problem, places, (tie, filter)));
    let parts: Vec<Option<Vec<Arc<SideView<S, N>>>>> = case.interfaces.iter().map(&mut of).collect();
    let mut of = |contact: &Contact| contact.filter.as_ref().map(|filter| pressed_parts(context, problem, places, (contact, filter)));
    let pressed: Vec<Option<Vec<Arc<SideView<S, N>>>>> = case.contacts.iter().map(&mut of).collect();
    let (ties, seams, pressed, joined_outer) = problem.look_for_touching(|search| {
        let mut finder = Finder { search, context };
        finder.exclude_named();
        let pressed = finder.contacts(pressed);
        let seams = finder.seams(files);
        finder.include_rest();
        let ties = finder.ties(&parts);
        finder.near_sides(&ties);
        finder.unjoined_sides();
        (ties, seams, pressed, finder.joined_outer())
    });
    SidePairs { ties, seams, pressed, named: Vec::new(), joined_outer }
}

/// The search for the sides of a case.
struct Finder<'a, 'b, 'c, 'd, const S: usize, const N: usize> {
    context: &'b mut LowerContext<'c, S, N>,
    search: &'d mut Search<'a, S, N>,
}

impl<const S: usize, const N: usize> Finder<'_, '_, '_, '_, S, N> {
    /// Excludes the side pairs that interfaces and contacts of the case name.
    fn exclude_named(&mut self) {
        named_pairs(self.context.case).for_each(|(a, b, _)| self.search.exclude((a.patch, &a.side), (b.patch, &b.side)));
    }

    /// Lets the search find what interfaces leave of pairs that they name with `where`.
    fn include_rest(&mut self) {
        let case = self.context.case;
        let whole: HashSet<[&SideRef; 2]> =
            named_pairs(case).filter(|(.., is_whole)| *is_whole).flat_map(|(a, b, _)| [[a, b], [b, a]]).collect();
        let rest = named_pairs(case).filter(|(a, b, _)| !whole.contains(&[*a, *b]));
        rest.for_each(|(a, b, _)| self.search.include_rest((a.patch, &a.side), (b.patch, &b.side)));
    }

    /// Marks the sides of contacts between bodies; returns slaves and masters of all contacts. Of the slaves these are the parts `pressed`, if a
    /// contact takes no more.
    fn contacts(&mut self, pressed: Vec<Option<Vec<Arc<SideView<S, N>>>>>) -> Vec<Arc<SideView<S, N>>> {
        let case = self.context.case;
        let mut all = Vec::new();
        for (contact, parts) in case.contacts.iter().zip(pressed) {
            // what is wrong with a side is reported where its contact is built
            let mut found = |list: &[Located<SideRef>]| list.iter().filter_map(|s| self.side(s).ok()).collect::<Vec<_>>();
            let (slaves, masters) = (parts.unwrap_or_else(|| found(&contact.slave)), found(contact.masters()));
            if !masters.is_empty() {
                self.search.contact(&slaves, &masters);
            }
            all.extend(slaves.into_iter().chain(masters));
        }
        all
    }

    fn side(&mut self, wanted: &Located<SideRef>) -> Result<Arc<SideView<S, N>>, Box<Diagnostic>> {
        let (patch, side) = (wanted.value.patch, &wanted.value.side);
        self.search.side(patch, side).map_err(|error| Box::new(side_fault(self.context, &self.search.body(patch), &error, wanted)))
    }

    /// Returns what a step makes, or adds its error to the context's faults.
    fn kept<T>(&mut self, made: Result<T, Box<Diagnostic>>) -> Option<T> {
        made.map_err(|fault| self.context.faults.push(*fault)).ok()
    }

    /// Adds what was found since the last call to the context's faults.
    fn tell(&mut self, at: SourceSpan) {
        for finding in std::mem::take(&mut self.search.findings) {
            let warning = warning(self.context, &finding, at);
            self.context.faults.push(warning);
        }
    }

    /// Side pairs of closed patches, of files with several patches, and of groups of one mesh, which share the functions of common facets.
    fn seams(&mut self, files: &[(Range<usize>, SourceSpan)]) -> Vec<PairedSidesAt<S, N>> {
        let case = self.context.case;
        let mut seams = Vec::new();
        for (patch, closed) in case.patches.iter().enumerate().filter_map(|(k, p)| Some((k, p.closed.as_ref()?))) {
            let couple = self.ring(patch, closed);
            seams.extend(self.kept(couple));
        }
        // patches listed by an interface are not glued by their file
        let lists = case.interfaces.iter().filter_map(|t| t.between.as_ref()).filter(|b| !is_all(b));
        let lists: Vec<BTreeSet<usize>> = lists.filter_map(|b| Some(self.bodies(b).ok()?.into_iter().collect())).collect();
        for (range, at) in files {
            let found = self.search.glue_touching(&range.clone().collect::<Vec<_>>(), &lists);
            seams.extend(self.located(found, "", *at));
        }
        for joint in &case.joints {
            let couple = self.glue(&joint.sides, joint.at);
            seams.extend(self.kept(couple));
        }
        seams
    }

    /// Side pair of a closed patch: for `closed = "u"` the slave u1 with the master u0, and so on.
    fn ring(&mut self, patch: usize, closed: &Located<String>) -> Result<PairedSidesAt<S, N>, Box<Diagnostic>> {
        let directions = &["u", "v", "w"][..N];
        let axis = closed.value.as_str();
        if !directions.contains(&axis) {
            let text = format!("`closed` must be one of {}, found {axis:?}", directions.join(", "));
            return Err(Box::new(self.context.error("E015", text, closed.at)));
        }
        self.glue(&[1, 0].map(|end| SideRef { patch, side: format!("{axis}{end}") }), closed.at)
    }

    fn glue(&mut self, [slave, master]: &[SideRef; 2], at: SourceSpan) -> Result<PairedSidesAt<S, N>, Box<Diagnostic>> {
        let slave = self.side(&Located::new(slave.clone(), at))?;
        let master = self.side(&Located::new(master.clone(), at))?;
        Ok(PairedSidesAt { couple: self.search.glue(slave, master), at })
    }

    /// Adds the source location to the couples of a search, and what it found and its error to the context's faults.
    fn located(
        &mut self,
        found: Result<Vec<PairedSides<S, N>>, TouchError<S, N>>,
        interface: &str,
        at: SourceSpan,
    ) -> Vec<PairedSidesAt<S, N>> {
        self.tell(at);
        let found = found.map_err(|error| Box::new(fault(self.context, self.search, &error, interface, at)));
        self.kept(found).unwrap_or_default().into_iter().map(|couple| PairedSidesAt { couple, at }).collect()
    }

    /// Side pairs of the interfaces: those with named sides first, then those of lists of patches, then of "all".
    fn ties(&mut self, parts: &[Option<Vec<Arc<SideView<S, N>>>>]) -> Vec<Vec<PairedSidesAt<S, N>>> {
        let case = self.context.case;
        let mut ties = vec![Vec::new(); case.interfaces.len()];
        let rank = |tie: &Tie| tie.between.as_ref().map_or(0, |b| if is_all(b) { 2 } else { 1 });
        let mut order: Vec<usize> = (0..ties.len()).collect();
        order.sort_by_key(|&k| rank(&case.interfaces[k]));
        for k in order {
            let tie = &case.interfaces[k];
            ties[k] = match &tie.between {
                None => self.named(tie, parts[k].as_deref()),
                Some(between) => self.between(tie, between),
            };
        }
        ties
    }

    /// Returns the side pairs of an interface whose slaves and masters are named; `parts` of the slaves, if it takes no more.
    fn named(&mut self, tie: &Tie, parts: Option<&[Arc<SideView<S, N>>]>) -> Vec<PairedSidesAt<S, N>> {
        let slaves = match parts {
            Some(parts) => parts.iter().cloned().zip(tie.slave.iter().map(|side| side.at)).collect(),
            None => self.list(&tie.slave),
        };
        let masters: Vec<_> = self.list(&tie.master).into_iter().map(|(side, _)| side).collect();
        let couple = |(slave, at)| {
            let couple = self.search.tie(slave, masters.clone(), tie.tolerance.value);
            self.tell(at);
            PairedSidesAt { couple, at }
        };
        slaves.into_iter().map(couple).collect()
    }

    fn list(&mut self, wanted: &[Located<SideRef>]) -> Vec<(Arc<SideView<S, N>>, SourceSpan)> {
        let found = |wanted: &Located<SideRef>| {
            let side = self.side(wanted);
            Some((self.kept(side)?, wanted.at))
        };
        wanted.iter().filter_map(found).collect()
    }

    /// Returns the touching sides of the patches of an interface.
    fn between(&mut self, tie: &Tie, between: &Located<Vec<String>>) -> Vec<PairedSidesAt<S, N>> {
        let bodies = self.bodies(between);
        let Some(bodies) = self.kept(bodies) else { return Vec::new() };
        let found = self.search.tie_touching(&bodies, tie.tolerance.value);
        self.located(found, &tie.name.value, between.at)
    }

    /// The patches that `between` names.
    fn bodies(&self, between: &Located<Vec<String>>) -> Result<Vec<usize>, Box<Diagnostic>> {
        if is_all(between) {
            return Ok((0..self.context.case.patches.len()).collect());
        }
        let unknown = |name: &str| Box::new(self.context.error("E021", format!("there is no patch {name:?}"), between.at));
        between
            .value
            .iter()
            .map(|name| self.context.case.patches.iter().position(|p| p.name.value == *name).ok_or_else(|| unknown(name)))
            .collect()
    }

    /// Warns of sides that `between` leaves apart though they are near for the size of their facets.
    fn near_sides(&mut self, ties: &[Vec<PairedSidesAt<S, N>>]) {
        let case = self.context.case;
        for (tie, found) in case.interfaces.iter().zip(ties) {
            let Some(between) = tie.between.as_ref().filter(|_| tie.tolerance.value.is_none() && !found.is_empty()) else { continue };
            if let Ok(bodies) = self.bodies(between) {
                self.search.nearly_touching(&bodies);
                self.tell(between.at);
            }
        }
    }

    /// The sides of "all-outer" that are joined, with their parts that nothing joins.
    fn joined_outer(&mut self) -> HashMap<SideRef, Vec<Arc<SideView<S, N>>>> {
        let all = self.context.case.boundaries.iter().filter(|block| block.all_outer).flat_map(|block| &block.on);
        let joined = |wanted: &Located<SideRef>| {
            let side = self.side(wanted).ok()?;
            let free = self.search.free_parts(&side);
            let is_free = matches!(&free[..], [part] if Arc::ptr_eq(part, &side));
            (!is_free).then(|| (wanted.value.clone(), free))
        };
        all.filter_map(joined).collect()
    }

    /// Warns of sides and patches that nothing joins; sides that a boundary block names are meant to be open.
    fn unjoined_sides(&mut self) {
        let case = self.context.case;
        let pairs = case.contacts.iter().flat_map(|contact| {
            contact.slave.iter().flat_map(move |a| contact.masters().iter().map(move |b| [a.value.patch, b.value.patch]))
        });
        let named = case.boundaries.iter().filter(|b| !b.all_outer).flat_map(|b| &b.on);
        // edges, corners and what is wrong are seen where the block is built
        let outer: Vec<_> = named.filter_map(|side| self.side(side).ok()).collect();
        let spline = |patch: usize| case.patches[patch].geometry.shape.mesh_part().is_none();
        self.search.unjoined(&pairs.collect::<Vec<_>>(), &outer, &spline);
        let found = std::mem::take(&mut self.search.findings);
        unjoined(self.context, &found);
    }
}

/// The parts of the slave sides that the `where` of an interface keeps; errors go to the context's faults.
fn slave_parts<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    (tie, filter): (&Tie, &Located<Formula>),
) -> Vec<Arc<SideView<S, N>>> {
    match of_slaves(context, problem, places, &tie.slave, (&tie.name.value, filter)) {
        Ok(regions) => regions.into_iter().flat_map(|region| problem.sides_of(region).unwrap_or_default()).collect(),
        Err(faults) => {
            context.faults.items.extend(faults);
            Vec::new()
        }
    }
}

/// The parts of the slave sides that the `where` of a contact keeps; what is wrong with it is reported where the contact is built.
fn pressed_parts<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    (contact, filter): (&Contact, &Located<Formula>),
) -> Vec<Arc<SideView<S, N>>> {
    let part = |wanted| {
        let region = part(context, problem, places, wanted, filter, &mut Centres::default()).ok().flatten()?;
        problem.sides_of(region).ok()
    };
    contact.slave.iter().filter_map(part).flatten().collect()
}

/// The pairs of sides that interfaces and contacts name, and whether nothing else may join them: interfaces join no more than what their `where`
/// keeps, contacts say what of a pair may meet.
fn named_pairs(case: &Case) -> impl Iterator<Item = (&SideRef, &SideRef, bool)> {
    let ties = case.interfaces.iter().map(|t| (&t.slave[..], &t.master[..], t.filter.is_none()));
    let contacts = case.contacts.iter().map(|contact| (&contact.slave[..], contact.masters(), true));
    ties.chain(contacts)
        .flat_map(|(slaves, masters, whole)| slaves.iter().flat_map(move |a| masters.iter().map(move |b| (&a.value, &b.value, whole))))
}

fn is_all(between: &Located<Vec<String>>) -> bool {
    matches!(&between.value[..], [word] if word == "all")
}
