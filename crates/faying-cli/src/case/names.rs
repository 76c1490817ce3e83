//! Names that a case may use for backends, couplings, multipliers, constraint solvers, materials and obstacles.

use super::key::Key;

/// Known names; a registry adds its own to these.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    /// `backend`.
    pub backends: Vec<String>,
    /// `coupling` of interfaces.
    pub couplings: Vec<String>,
    /// Names of `couplings` that make no rows, and so have no multiplier.
    pub rowless: Vec<String>,
    /// `multiplier`, beside `p/p-k` for every k.
    pub multipliers: Vec<String>,
    /// `integration` of interfaces and contacts.
    pub integrations: Vec<String>,
    /// `constraint` of the solver.
    pub constraints: Vec<String>,
    /// `law` of materials, beside those of the language.
    pub laws: Vec<EntryKeys>,
    /// `kind` of obstacles, beside those of the language.
    pub obstacles: Vec<EntryKeys>,
}

/// Name of an entry of the registry, and its keys.
#[derive(Clone, Debug, PartialEq)]
pub struct EntryKeys {
    /// The name.
    pub name: String,
    /// The keys.
    pub keys: Vec<Key>,
}

impl Default for Names {
    /// The names of the case file's language, implemented or not.
    fn default() -> Self {
        let list = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
        Self {
            backends: list(&["iga", "fe"]),
            couplings: list(&["mortar", "nitsche", "penalty", "glue"]),
            rowless: list(&["nitsche"]),
            multipliers: list(&["auto", "p/p", "p/p-1", "p/p-2", "constant", "dual"]),
            integrations: list(&["merged", "segments", "slave", "mixed"]),
            constraints: list(&["auto", "saddle-point", "condensed", "schur", "uzawa"]),
            laws: Vec::new(),
            obstacles: Vec::new(),
        }
    }
}

impl Names {
    /// Whether `name` is a multiplier: one of the list, or `p/p-k` with k from 1 to 12.
    pub fn has_multiplier(&self, name: &str) -> bool {
        let lowered = name.strip_prefix("p/p-").and_then(|k| k.parse::<usize>().ok());
        lowered.is_some_and(|k| (1..=12).contains(&k)) || self.multipliers.iter().any(|known| known == name)
    }

    /// Whether an interface of this `coupling` has a multiplier; glued sides share their unknowns instead.
    pub fn has_rows(&self, coupling: &str) -> bool {
        coupling != "glue" && self.rowless.iter().all(|name| name != coupling)
    }

    /// Adds names that are not known yet.
    pub fn add(list: &mut Vec<String>, names: impl IntoIterator<Item = impl Into<String>>) {
        for name in names {
            let name = name.into();
            if !list.contains(&name) {
                list.push(name);
            }
        }
    }
}
