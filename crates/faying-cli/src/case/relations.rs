//! Checks between blocks: sides used twice, two conditions on one component, data marked "exact".

use std::collections::{BTreeMap, HashSet};

use super::boundary::{Read, component};
use super::part::FilePart;
use super::reader::Reader;
use super::sides::{show, sides_of};
use super::types::*;
use crate::errors::Diagnostic;
use crate::formula::Formula;
use crate::place::{Located, Origin, SourceSpan};

fn line(at: SourceSpan) -> String {
    at.in_file().map_or("in an option".to_owned(), |(l, _)| format!("on line {l}"))
}

// unused sides; of a mesh its tags and the facets without a tag
fn rest(patches: &mut [Patch], used: &HashSet<SideRef>, dimension: usize) -> Vec<SideRef> {
    let mut out = Vec::new();
    for (patch, p) in patches.iter_mut().enumerate() {
        let sides: Vec<String> = if p.geometry.shape.mesh_part().is_some() {
            let own: Vec<&str> = used.iter().filter(|s| s.patch == patch).map(|s| s.side.as_str()).collect();
            outer_of(p, &own)
        } else {
            sides_of(&p.geometry.shape, dimension).into_iter().map(str::to_owned).collect()
        };
        out.extend(sides.into_iter().map(|side| SideRef { patch, side }).filter(|s| !used.contains(s)));
    }
    out
}

impl Reader {
    /// Checks that a side is slave once, and never its own master, and that two sides are coupled once, in one direction (E026).
    pub fn slaves(&mut self, interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) {
        let mut first: BTreeMap<(usize, &str), (SourceSpan, bool)> = BTreeMap::new();
        let ties = interfaces.iter().map(|t| ("interface", &t.name.value, &t.slave[..], &t.master[..], t.filter.is_some()));
        let all: Vec<_> =
            ties.chain(contacts.iter().map(|c| ("contact", &c.name.value, &c.slave[..], c.masters(), c.filter.is_some()))).collect();
        for (k, &(kind, name, slave, master, _)) in all.iter().enumerate() {
            for &(other_kind, other, other_slave, other_master, _) in &all[..k] {
                let twice = slave.iter().find_map(|s| {
                    let before = other_slave.iter().find(|o| master.contains(o) && other_master.contains(s))?;
                    Some((s, before))
                });
                let Some((s, before)) = twice else { continue };
                let message = format!(
                    "`{}` and `{}` are coupled twice, with slave and master exchanged: {other_kind} {other:?} {} and {kind} {name:?} {}",
                    show(before, patches),
                    show(s, patches),
                    line(before.at),
                    line(s.at)
                );
                self.fault("E026", s.at, message, "two sides are coupled once: drop one of the two blocks");
            }
        }
        for (_, _, slave, master, is_part) in all {
            for s in slave {
                let name = show(s, patches);
                if master.contains(s) {
                    self.fault("E026", s.at, format!("`{name}` is its own master"), "name the side on the other body as master");
                }
                match first.get(&(s.patch, s.side.as_str())) {
                    // parts with common facets are found where they are built
                    Some((_, true)) if is_part => {}
                    Some((at, _)) => {
                        let message = format!("`{name}` is slave twice: {} and {}", line(*at), line(s.at));
                        self.fault(
                            "E026",
                            s.at,
                            message,
                            "a side carries one multiplier: cut it, by `where`, a patch or a group of the mesh per partner, or exchange slave and master",
                        );
                    }
                    None => {
                        first.insert((s.patch, &s.side), (s.at, is_part));
                    }
                }
            }
        }
    }

    /// Warns of a `max_iterations` below that of another contact: all contacts settle together, and the largest counts.
    pub fn iterations(&mut self, contacts: &[Contact]) {
        let limit = |c: &Contact| c.active_set.max_iterations.value;
        let Some(most) = contacts.iter().map(limit).max() else { return };
        let Some(largest) = contacts.iter().find(|c| limit(c) == most) else { return };
        let by_default = if largest.active_set.max_iterations.at.origin == Origin::Default { ", its default" } else { "" };
        for c in contacts.iter().filter(|c| limit(c) < most && c.active_set.max_iterations.at.origin != Origin::Default) {
            let message = format!(
                "max_iterations = {} of contact {:?} has no effect: all contacts settle together, and the largest counts, {most} of {:?}{by_default}",
                limit(c),
                c.name.value,
                largest.name.value
            );
            let warning = Diagnostic::warning("E015", message).with_help("write the same max_iterations in every contact");
            self.push(c.active_set.max_iterations.at, warning);
        }
    }

    /// Resolves "all-outer": the sides that are in no other block and are not glued to another one.
    pub fn outer(
        &mut self,
        read: Vec<Read>,
        interfaces: &[Tie],
        contacts: &[Contact],
        joints: &[Joint],
        patches: &mut [Patch],
    ) -> Vec<Boundary> {
        let mut used: HashSet<SideRef> = read.iter().flat_map(|r| r.boundary.on.iter().map(|s| s.value.clone())).collect();
        used.extend(interfaces.iter().flat_map(|t| t.slave.iter().chain(&t.master)).map(|s| s.value.clone()));
        used.extend(contacts.iter().flat_map(|c| c.slave.iter().chain(c.masters())).map(|s| s.value.clone()));
        used.extend(joints.iter().flat_map(|j| j.sides.iter().cloned()));
        let mut seen: Option<SourceSpan> = None;
        let mut out = Vec::with_capacity(read.len());
        for r in read {
            let mut boundary = r.boundary;
            if let Some(at) = r.all_outer {
                match seen {
                    None => boundary.on = rest(patches, &used, self.dimension).into_iter().map(|s| Located::new(s, at)).collect(),
                    Some(before) => {
                        let message = format!("\"all-outer\" stands in two blocks: {} and {}", line(before), line(at));
                        self.fault("E052", at, message, "put both conditions into one block");
                    }
                }
                if seen.is_none() && boundary.on.is_empty() && !patches.is_empty() {
                    self.push(at, Diagnostic::warning("E021", "\"all-outer\" is no side: every side stands in another block"));
                }
                seen = Some(at);
            }
            out.push(boundary);
        }
        out
    }

    /// Checks that each component of a side is prescribed once, or loaded (E052).
    pub fn conditions(&mut self, boundaries: &[Boundary], patches: &[Patch], n: usize) {
        // per side and component: prescribed first, and the first load
        let mut prescribed: BTreeMap<(usize, &str, usize), SourceSpan> = BTreeMap::new();
        let mut loaded: BTreeMap<(usize, &str, usize), SourceSpan> = BTreeMap::new();
        let clash = |r: &mut Self, s: &SideRef, k: usize, at: SourceSpan, before: SourceSpan, what: [&str; 2]| {
            let message = format!(
                "`{}` has two conditions for component {}: {} {}, {} {}",
                show(s, patches),
                component(n, k),
                what[0],
                line(before),
                what[1],
                line(at)
            );
            r.fault("E052", at, message, "each component of a side is prescribed once, or loaded");
        };
        // a part of a side is compared when its facets are known
        let whole: Vec<&Boundary> = boundaries.iter().filter(|b| b.filter.is_none()).collect();
        for b in &whole {
            for s in &b.on {
                for (k, d) in b.dirichlet.iter().enumerate() {
                    let Some(d) = d else { continue };
                    let key = (s.patch, s.side.as_str(), k);
                    match prescribed.get(&key) {
                        Some(before) => clash(self, s, k, d.at, *before, ["prescribed", "and again"]),
                        None => {
                            prescribed.insert(key, d.at);
                        }
                    }
                }
            }
        }
        for b in &whole {
            for s in &b.on {
                for k in 0..n {
                    // a zero load is no condition
                    let some = |f: &Option<Located<Formula>>| f.as_ref().filter(|f| f.value.as_constant() != Some(0.0)).map(|f| f.at);
                    let traction =
                        b.traction[k].as_ref().filter(|t| !matches!(&t.value, Datum::Formula(f) if f.as_constant() == Some(0.0)));
                    let loads = [traction.map(|t| t.at), some(&b.force[k]), some(&b.spring[k]), b.rigid_force[k].as_ref().map(|f| f.at)];
                    let key = (s.patch, s.side.as_str(), k);
                    for at in loads.into_iter().flatten() {
                        loaded.insert(key, at);
                        if let Some(before) = prescribed.get(&key) {
                            clash(self, s, k, at, *before, ["prescribed", "loaded"]);
                        }
                    }
                }
                // pressure acts along the normal: a conflict where nothing is free
                let all: Option<Vec<SourceSpan>> = (0..n).map(|k| prescribed.get(&(s.patch, s.side.as_str(), k)).copied()).collect();
                if let (Some(p), Some(all)) = (&b.pressure, all) {
                    clash(self, s, n - 1, p.at, all[n - 1], ["prescribed", "loaded"]);
                }
            }
        }
    }

    /// Checks gravity: it needs densities (E013) and must not be given beside `exact` (E015).
    pub fn weight(&mut self, model: &Model, materials: &[Material], patches: &[Patch]) {
        let all = model
            .gravity
            .iter()
            .map(|g| (g, patches))
            .chain(patches.iter().filter_map(|p| Some((p.gravity.as_ref()?, std::slice::from_ref(p)))));
        for (gravity, patches) in all {
            if patches.iter().any(|p| p.exact.as_ref().or(model.exact.as_ref()).is_some()) {
                self.fault(
                    "E015",
                    gravity.at,
                    "`gravity` does not stand beside `exact`",
                    "the body force follows from `exact`; leave one of them out",
                );
            }
            let is_revolved = model.assumption.value == faying::physics::Assumption::Axisymmetric;
            if is_revolved && gravity.value.first().is_some_and(|radial| *radial != 0.0) {
                let message = "`gravity` along the radius is none: it points the same way everywhere";
                self.fault("E015", gravity.at, message, "write gravity = [0, -9.81], along the axis; body_force may be radial");
            }
            let bare = patches.iter().filter_map(|p| materials.get(p.material.value)).find(|m| m.density.is_none());
            if let (Some(m), false) = (bare, self.density_broken) {
                let message = format!("`gravity` needs a density, material {:?} has none", m.name.value);
                self.fault("E013", gravity.at, message, "write density = 7.8e-9 in the material");
            }
        }
    }

    /// Reports forces of obstacles that a method cannot take.
    pub fn pressed_obstacles(&mut self, case: &Case) {
        for c in case.contacts.iter().filter(|c| !c.needs.pressed) {
            let Master::Rigid(obstacle) = &c.master else { continue };
            let Some(f) = obstacle.force.iter().flatten().next() else { continue };
            let message = format!("`force` of an obstacle with method = {:?} is not in this version", c.method.value);
            self.fault("E019", f.at, message, "write method = \"lagrange\", or use move");
        }
    }

    /// Checks that data marked "exact" have `exact` in the model or in their patches (E062).
    pub fn exact_data(&mut self, boundaries: &[Boundary], model: &Model, patches: &[Patch]) {
        if model.exact.is_some() || self.broken.contains("exact") {
            return;
        }
        let has_own = |b: &&Boundary| b.on.iter().all(|side| patches.get(side.value.patch).is_some_and(|p| p.exact.is_some()));
        for b in boundaries.iter().filter(|b| !has_own(b)) {
            let data = b.dirichlet.iter().chain(&b.traction).flatten();
            let first = data.filter(|d| d.value == Datum::Exact).map(|d| d.at).next();
            if let Some(at) = first {
                let n = model.components();
                let example = if n == 1 { "exact = { u = \"x*y\" }" } else { "exact = { u = [\"x*y\", \"0\"] }" };
                self.fault("E062", at, "data marked \"exact\" need `exact` in [model]", format!("write {example}"));
            }
        }
    }
}

/// The sides that cover the boundary of a patch of mesh cells, except `used` ones.
fn outer_of(patch: &mut Patch, used: &[&str]) -> Vec<String> {
    match patch.geometry.value.shape.value.part_mut() {
        Some(FilePart::Plane(p)) => p.outer(used),
        Some(FilePart::Space(p)) => p.outer(used),
        _ => Vec::new(),
    }
}
