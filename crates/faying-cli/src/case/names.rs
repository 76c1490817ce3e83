//! Names that a case may use for backends, couplings, multipliers, constraint solvers, materials and obstacles.

use super::key::{Key, KeyKind, Special};
use faying::contact::Needs;

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
    /// Keys of couplings.
    pub coupling_keys: Vec<EntryKeys>,
    /// `method` of contacts.
    pub methods: Vec<MethodEntry>,
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

/// A method of contact: its name, its keys, what it needs of the sides.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodEntry {
    /// Name and keys.
    pub entry: EntryKeys,
    /// Its needs.
    pub needs: Needs,
}

/// A family of the registry whose entries the value of a key names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EntryFamily {
    Backends,
    Couplings,
    Methods,
    Integrations,
    Constraints,
    Laws,
}

/// `factor` of penalties and of Nitsche's method.
fn factor() -> Key {
    Key::new("factor", KeyKind::Auto, "multiplies modulus/h").default("\"auto\"")
}

/// `variant` of Nitsche's method.
fn variant() -> Key {
    Key::new("variant", KeyKind::Word(&["symmetric", "unsymmetric", "incomplete"]), "variant of Nitsche's method").default("\"symmetric\"")
}

/// Keys of the couplings of the language.
pub(crate) fn built_in_couplings() -> Vec<EntryKeys> {
    let of = |name: &str, keys: Vec<Key>| EntryKeys { name: name.to_owned(), keys };
    vec![of("penalty", vec![factor()]), of("nitsche", vec![factor(), variant()])]
}

/// The methods of contact of the language, the default first.
pub(crate) fn built_in_methods() -> Vec<MethodEntry> {
    let of = |name: &str, keys: Vec<Key>, needs: Needs| MethodEntry { entry: EntryKeys { name: name.to_owned(), keys }, needs };
    let tolerance = "relative error of the multipliers at which the iteration ends; `reach` limits the distance of the sides";
    let tolerance = Key::new("tolerance", KeyKind::Auto, tolerance).default("\"auto\"");
    vec![
        of("lagrange", Vec::new(), Needs::FUNCTIONS),
        of("penalty", vec![factor()], Needs::FUNCTIONS),
        of("augmented", vec![tolerance, factor()], Needs::FUNCTIONS),
        of("nitsche", vec![factor(), variant()], Needs::FLUXES),
    ]
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
            coupling_keys: built_in_couplings(),
            methods: built_in_methods(),
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

    /// The names of a family.
    pub(super) fn words(&self, family: EntryFamily) -> Vec<&str> {
        fn all(names: &[String]) -> Vec<&str> {
            names.iter().map(String::as_str).collect()
        }
        match family {
            EntryFamily::Backends => all(&self.backends),
            EntryFamily::Couplings => all(&self.couplings),
            EntryFamily::Methods => self.methods.iter().map(|m| m.entry.name.as_str()).collect(),
            EntryFamily::Integrations => all(&self.integrations),
            EntryFamily::Constraints => all(&self.constraints),
            EntryFamily::Laws => std::iter::once("hooke").chain(self.laws.iter().map(|law| law.name.as_str())).collect(),
        }
    }

    /// Entries of a family that have keys.
    pub(super) fn entries(&self, family: EntryFamily) -> Vec<&EntryKeys> {
        match family {
            EntryFamily::Couplings => self.coupling_keys.iter().collect(),
            EntryFamily::Methods => self.methods.iter().map(|m| &m.entry).collect(),
            EntryFamily::Laws => self.laws.iter().collect(),
            EntryFamily::Backends | EntryFamily::Integrations | EntryFamily::Constraints => Vec::new(),
        }
    }

    /// The keys of a block, and behind a key that names an entry those of all entries of its family, each once.
    pub(super) fn extended(&self, block: &[Key]) -> Vec<Key> {
        let mut all: Vec<Key> = Vec::new();
        for key in block {
            if all.iter().any(|known| known.name == key.name) {
                continue;
            }
            all.push(key.clone());
            let Some(Special::Entry(family)) = key.special() else { continue };
            for own in self.entries(*family).into_iter().flat_map(|entry| &entry.keys) {
                if block.iter().chain(&all).all(|known| known.name != own.name || known.is_later()) {
                    all.push(own.clone());
                }
            }
        }
        all
    }

    /// The entries that bring a key to an extended block: `method = "penalty"`; none for the block's own keys.
    pub(super) fn owners(&self, block: &[Key], key: &Key) -> Vec<String> {
        let families = block.iter().filter_map(|row| match row.special() {
            Some(Special::Entry(family)) => Some((row.name, *family)),
            _ => None,
        });
        let of = |(what, family): (&'static str, EntryFamily)| {
            let entries = self.entries(family).into_iter().filter(|e| e.keys.contains(key));
            entries.map(move |e| format!("{what} = {:?}", e.name)).collect::<Vec<_>>()
        };
        families.flat_map(of).collect()
    }

    /// Keys of the methods of contact.
    pub(super) fn method_keys(&self) -> Vec<EntryKeys> {
        self.methods.iter().map(|m| m.entry.clone()).collect()
    }

    /// Needs of a method of contact; those of the default for a word that is none.
    pub fn needs(&self, method: &str) -> Needs {
        self.methods.iter().find(|m| m.entry.name == method).map_or(Needs::FUNCTIONS, |m| m.needs)
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
