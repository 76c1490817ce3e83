//! Facets and points that patches of one mesh share and that no interface or contact separates.

use super::reader::Reader;
use super::types::*;
use crate::place::Located;
use std::collections::BTreeSet;

impl Reader {
    /// Joints of patches that no interface or contact names as a pair: those that are kept, and those separated by a list of `between`.
    pub fn kept_joints(&mut self, interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) -> [Vec<Joint>; 2] {
        let parted = Parted::of(interfaces, contacts, patches);
        let joints = std::mem::take(&mut self.joints);
        let pair = |j: &Joint| [j.sides[0].patch, j.sides[1].patch];
        let (kept, parted) = joints.into_iter().filter(|j| !parted.named(pair(j))).partition(|j| !parted.listed(pair(j)));
        [kept, parted]
    }

    /// Shared points of patches of which no two are separated: an interface that meets others in a point keeps its ends.
    pub fn kept_meetings(&mut self, interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) -> Vec<Meeting> {
        let parted = Parted::of(interfaces, contacts, patches);
        let mut meetings = std::mem::take(&mut self.meetings);
        meetings.retain(|m| {
            let pairs = m.patches.iter().enumerate().flat_map(|(k, a)| m.patches[..k].iter().map(move |b| [*a, *b]));
            !pairs.into_iter().any(|pair| parted.named(pair) || parted.listed(pair))
        });
        // inner nodes of an edge are not points of the file
        let mut seen: BTreeSet<&[usize]> = BTreeSet::new();
        let inner = |k: &usize| patches[*k].refine.value > 0 || patches[*k].discretization.degree.value.iter().any(|p| *p > 1);
        let edge = meetings.iter().find(|m| self.dimension == 3 && !seen.insert(&m.patches) && m.patches.iter().any(inner)).cloned();
        if let Some(m) = edge {
            let names: Vec<String> = m.patches.iter().map(|k| format!("{:?}", patches[*k].name.value)).collect();
            let message = format!(
                "patches {} of one mesh meet in an edge without a common facet there, which is joined in this version at degree 1 without `refine` alone",
                names.join(", ")
            );
            self.fault("E019", m.at, message, "read them as one group, or name the pair in an interface");
        }
        meetings
    }
}

/// Pairs of patches that interfaces and contacts separate.
struct Parted {
    named: BTreeSet<[usize; 2]>,
    lists: Vec<BTreeSet<usize>>,
}

impl Parted {
    fn of(interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) -> Self {
        let mut named = BTreeSet::new();
        let mut pair = |slave: &[Located<SideRef>], master: &[Located<SideRef>]| {
            for s in slave {
                for m in master {
                    named.insert([s.patch.min(m.patch), s.patch.max(m.patch)]);
                }
            }
        };
        for t in interfaces {
            pair(&t.slave, &t.master);
        }
        for c in contacts {
            pair(&c.slave, c.masters());
        }
        let number = |name: &String| patches.iter().position(|p| p.name.value == *name);
        let lists = interfaces.iter().filter_map(|t| t.between.as_ref()).map(|b| b.value.iter().filter_map(number).collect()).collect();
        Self { named, lists }
    }

    /// Whether an interface or a contact names sides of both.
    fn named(&self, [a, b]: [usize; 2]) -> bool {
        self.named.contains(&[a.min(b), a.max(b)])
    }

    /// Whether a list of `between` holds both.
    fn listed(&self, [a, b]: [usize; 2]) -> bool {
        self.lists.iter().any(|l| l.contains(&a) && l.contains(&b))
    }
}
