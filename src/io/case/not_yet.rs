//! What the case file's language knows and this version does not build: E019 at its place.
//!
//! Every entry is already typed; building one means to delete its line here.

use super::reader::Reader;
use super::types::*;
use crate::io::place::Place;

/// Couplings of the contract that integrate over the surfaces of both sides.
const SURFACE_COUPLINGS: &[&str] = &["mortar", "nitsche", "penalty"];

impl Reader {
    fn later(&mut self, at: Place, what: &str, help: &str) {
        self.fault("E019", at, format!("{what} is not in this version"), help);
    }

    /// Reports everything that is not built.
    pub fn not_in_this_version(&mut self, case: &Case) {
        let m = &case.model;
        if m.dimension.value == 3 {
            self.later_surfaces(case);
        }
        for c in &case.contacts {
            self.later_contact(c);
        }
    }

    fn later_surfaces(&mut self, case: &Case) {
        let ties = case.interfaces.iter().filter(|t| SURFACE_COUPLINGS.contains(&t.coupling.value.as_str()));
        for at in ties.map(|t| t.head.at).collect::<Vec<Place>>() {
            let help = "share the unknowns of sides that match by coupling = \"glue\", or take a plane model";
            self.fault("E019", at, "interfaces between surfaces are not in this version", help);
        }
        for c in &case.contacts {
            let help = "take a plane model of the cross-section: contact between lines is there";
            self.fault("E019", c.head.at, "contact between surfaces is not in this version", help);
        }
    }

    fn later_contact(&mut self, c: &Contact) {
        if let (Master::Rigid(o), Method::Nitsche) = (&c.master, c.method.value)
            && let Some(f) = o.force.iter().flatten().next()
        {
            self.later(f.at, "`force` of an obstacle with method = \"nitsche\"", "write method = \"lagrange\", or use move");
        }
    }
}
