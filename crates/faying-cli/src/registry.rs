//! Registry of the names that a case file may use (backends, multipliers, couplings, ...); other crates can add entries.

use crate::case;
use crate::errors::nearest;
use faying::constraint::ConstraintSolver;
use faying::contact::{ContactMethod, Needs, Obstacle};
use faying::coupling::Coupling;
use faying::linalg::Limits;
use faying::problem::{Multiplier, Physics, Rule};
use faying::space::{Body, PatchSpec};
use std::fmt::Debug;
use std::sync::Arc;

/// Error for a name that no entry has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {family} `{name}`; known: {known}{}", .nearest.as_ref().map_or(String::new(), |n| format!("; did you mean `{n}`?")))]
pub struct UnknownName {
    /// Kind of the entries: "backend", "multiplier", ...
    pub family: &'static str,
    /// The unknown name.
    pub name: String,
    /// The known names, separated by commas.
    pub known: String,
    /// The known name that is nearest to it.
    pub nearest: Option<String>,
}

/// Error of a registered function, such as a backend that cannot build a body: a code of the program's errors and a message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Fault {
    /// Code, "E015" unless said otherwise.
    pub code: &'static str,
    /// Message: the problem, its place, the allowed values.
    pub message: String,
    /// Key of the case's block that is wrong, such as "elements" of a patch; may be empty: then the place is
    /// that of the entry's name.
    pub key: &'static str,
}

impl Fault {
    /// A fault with a code.
    pub fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), key: "" }
    }
}

/// Entries by name, in the order they were added.
pub struct Family<F> {
    what: &'static str,
    entries: Vec<(String, F)>,
}

impl<F> Debug for Family<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Family").field("what", &self.what).field("names", &self.names()).finish()
    }
}

impl<F> Family<F> {
    /// A family without entries; `what` names one of them in messages.
    pub fn new(what: &'static str) -> Self {
        Self { what, entries: Vec::new() }
    }

    /// Adds an entry; one of the same name is replaced.
    pub fn add(&mut self, name: &str, make: F) -> &mut Self {
        match self.entries.iter_mut().find(|(known, _)| known == name) {
            Some(entry) => entry.1 = make,
            None => self.entries.push((name.into(), make)),
        }
        self
    }

    /// The entry called `name`.
    ///
    /// # Errors
    /// [`UnknownName`] with the names there are and the nearest one.
    pub fn get(&self, name: &str) -> Result<&F, UnknownName> {
        self.entries.iter().find(|(known, _)| known == name).map(|(_, make)| make).ok_or_else(|| UnknownName {
            family: self.what,
            name: name.into(),
            known: self.names().join(", "),
            nearest: nearest(name, self.names()).map(str::to_owned),
        })
    }

    /// All names.
    pub fn names(&self) -> Vec<&str> {
        self.entries.iter().map(|(name, _)| name.as_str()).collect()
    }
}

/// An entry with keys of its own, which case files give beside its name.
pub struct Keyed<F> {
    /// The keys.
    pub keys: Vec<case::Key>,
    /// The function that makes it.
    pub make: F,
}

impl<F> Debug for Keyed<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Keyed").field("keys", &self.keys).finish_non_exhaustive()
    }
}

impl<F> Family<Keyed<F>> {
    /// Names and keys of all entries.
    fn keys(&self) -> impl Iterator<Item = case::EntryKeys> + '_ {
        self.entries.iter().map(|(name, entry)| case::EntryKeys { name: name.clone(), keys: entry.keys.clone() })
    }

    /// Every entry with what its function makes of the defaults of its keys; `None` where it refuses them, or one has no default.
    fn made<R>(&self) -> Vec<(case::EntryKeys, Option<R>)>
    where
        F: std::ops::Deref<Target: Fn(&case::Given) -> Result<R, Fault>>,
    {
        let make = |entry: &Keyed<F>| {
            let whole = entry.keys.iter().all(|key| !key.is_required());
            whole.then(|| (*entry.make)(&case::Given::of_defaults(&entry.keys)).ok()).flatten()
        };
        self.keys().zip(&self.entries).map(|(keys, (_, entry))| (keys, make(entry))).collect()
    }

    /// Adds an entry with its keys; one of the same name is replaced.
    pub fn add_keyed(&mut self, name: &str, keys: Vec<case::Key>, make: F) -> &mut Self {
        self.add(name, Keyed { keys, make })
    }
}

/// Makes a material at a time from the values of its keys: see [`Physics::new`] for the number of components.
pub type MakeMaterial<const N: usize> = Arc<dyn Fn(&case::Given, f64) -> Result<Physics<N>, Fault> + Send + Sync>;
/// An obstacle without its motion, as a function of time.
pub type ObstacleAtTime<const S: usize, const N: usize> = Box<dyn Fn(f64) -> Box<dyn Obstacle<S, N>> + Send + Sync>;
/// Makes an obstacle, which is a function of the time, from the values of its keys.
pub type MakeObstacle<const S: usize, const N: usize> = Box<dyn Fn(&case::Given) -> Result<ObstacleAtTime<S, N>, Fault> + Send + Sync>;
/// Makes a body of a patch.
pub type MakeBody<const S: usize, const N: usize> = Box<dyn Fn(&PatchSpec<N>) -> Result<Box<dyn Body<S, N>>, Fault> + Send + Sync>;
/// Makes a coupling from the values of its keys.
pub type MakeCoupling<const S: usize, const N: usize> = Box<dyn Fn(&case::Given) -> Result<Box<dyn Coupling<S, N>>, Fault> + Send + Sync>;
/// Makes a method of contact from the values of its keys.
pub type MakeMethod<const S: usize, const N: usize> =
    Box<dyn Fn(&case::Given) -> Result<Arc<dyn ContactMethod<S, N>>, Fault> + Send + Sync>;
/// Options of a constraint solver.
#[derive(Clone, Debug)]
pub struct SolverOptions {
    /// Solver of linear systems: direct or iterative.
    pub linear: case::Linear,
    /// Stopping criteria of iterations; cancellation is that of the run.
    pub limits: Limits,
}

impl SolverOptions {
    /// Whether linear systems are solved by iterations.
    pub fn is_iterative(&self) -> bool {
        self.linear == case::Linear::Iterative
    }
}

/// Makes a solver of constrained systems, or returns a [`Fault`] if the options do not go together.
pub type MakeSolver = Box<dyn Fn(&SolverOptions) -> Result<Box<dyn ConstraintSolver>, Fault> + Send + Sync>;

/// The names for bodies in N dimensions with sides in S = N - 1.
#[derive(Debug)]
pub struct Names<const S: usize, const N: usize> {
    /// Bodies of patches.
    pub backends: Family<MakeBody<S, N>>,
    /// Multiplier spaces.
    pub multipliers: Family<Multiplier<S, N>>,
    /// Couplings of interfaces.
    pub couplings: Family<Keyed<MakeCoupling<S, N>>>,
    /// Methods of contact; one of the same name as in the other dimension has the same keys and needs.
    pub methods: Family<Keyed<MakeMethod<S, N>>>,
    /// Integrations of interfaces and contacts.
    pub integrations: Family<Rule<S, N>>,
    /// Laws of materials beside those of the language, of as many components as the physics of a case.
    pub materials: Family<Keyed<MakeMaterial<N>>>,
    /// Obstacles beside those of the language; one of the same name as in the other dimension has the same keys.
    pub obstacles: Family<Keyed<MakeObstacle<S, N>>>,
    /// Obstacles with the shape of a geometry, if available in this dimension.
    pub shaped: Shaped<S, N>,
}

/// Makes the obstacle that has the shape of a geometry.
pub type MakeShaped<const S: usize, const N: usize> = fn(&case::Geometry) -> Result<Arc<dyn Obstacle<S, N>>, Fault>;

/// Function that makes obstacles with the shape of a geometry, if available.
#[derive(Debug)]
pub struct Shaped<const S: usize, const N: usize>(pub Option<MakeShaped<S, N>>);

impl<const S: usize, const N: usize> Names<S, N> {
    /// Creates empty families.
    pub fn empty() -> Self {
        Self {
            backends: Family::new("backend"),
            multipliers: Family::new("multiplier"),
            couplings: Family::new("coupling"),
            methods: Family::new("method"),
            integrations: Family::new("integration"),
            materials: Family::new("law"),
            obstacles: Family::new("obstacle"),
            shaped: Shaped(None),
        }
    }
}

/// Whether the functions of a backend are smooth across knots; `false` for added backends.
pub(super) fn is_spline(backend: &str) -> bool {
    backend == "iga"
}

/// Name of the constraint solver for a keyword of the case: "auto" is "saddle-point".
pub(super) fn solver_name(word: &str) -> &str {
    match word {
        "auto" => "saddle-point",
        other => other,
    }
}

/// Whether a coupling shares functions instead of tying two sides by rows.
pub(super) fn is_glue(coupling: &str) -> bool {
    coupling == "glue"
}

/// Every coupling of a family, and whether it makes rows.
fn asked<const S: usize, const N: usize>(couplings: &Family<Keyed<MakeCoupling<S, N>>>) -> Vec<(String, bool)> {
    // one that is not made of its defaults has rows until it says otherwise
    couplings.made().into_iter().map(|(entry, made)| (entry.name, made.is_none_or(|coupling| coupling.has_rows()))).collect()
}

/// Every method of contact of a family, and what it needs.
fn methods<const S: usize, const N: usize>(methods: &Family<Keyed<MakeMethod<S, N>>>) -> Vec<case::MethodEntry> {
    let needs = |made: Option<Arc<dyn ContactMethod<S, N>>>| made.map_or(Needs::FUNCTIONS, |method| method.needs());
    methods.made().into_iter().map(|(entry, made)| case::MethodEntry { entry, needs: needs(made) }).collect()
}

/// All names a case file may use.
#[derive(Debug)]
pub struct Registry {
    /// Names of cases in the plane.
    pub plane: Names<1, 2>,
    /// Names of cases in space.
    pub volume: Names<2, 3>,
    /// Solvers of constrained systems.
    pub solvers: Family<MakeSolver>,
}

impl Registry {
    /// The names a case may use: those of the contract and all entries; for
    /// [`ReadOptions::names`](crate::case::ReadOptions::names).
    pub fn case_names(&self) -> case::Names {
        let mut names = case::Names::default();
        let more = |list: &mut Vec<case::EntryKeys>, entries: &mut dyn Iterator<Item = case::EntryKeys>| {
            for entry in entries {
                if list.iter().all(|known| known.name != entry.name) {
                    list.push(entry);
                }
            }
        };
        for backends in [self.plane.backends.names(), self.volume.backends.names()] {
            case::Names::add(&mut names.backends, backends);
        }
        for couplings in [self.plane.couplings.names(), self.volume.couplings.names()] {
            case::Names::add(&mut names.couplings, couplings);
        }
        let asked = [asked(&self.plane.couplings), asked(&self.volume.couplings)].concat();
        names.rowless.retain(|name| asked.iter().all(|(known, _)| known != name));
        case::Names::add(&mut names.rowless, asked.into_iter().filter(|(_, has_rows)| !has_rows).map(|(name, _)| name));
        // an entry takes the place of one of the language; those of the plane come last, and count
        for entry in self.volume.couplings.keys().chain(self.plane.couplings.keys()) {
            match names.coupling_keys.iter_mut().find(|known| known.name == entry.name) {
                Some(known) => *known = entry,
                None => names.coupling_keys.push(entry),
            }
        }
        for method in methods(&self.volume.methods).into_iter().chain(methods(&self.plane.methods)) {
            match names.methods.iter_mut().find(|known| known.entry.name == method.entry.name) {
                Some(known) => *known = method,
                None => names.methods.push(method),
            }
        }
        for multipliers in [self.plane.multipliers.names(), self.volume.multipliers.names()] {
            case::Names::add(&mut names.multipliers, multipliers);
        }
        for rules in [self.plane.integrations.names(), self.volume.integrations.names()] {
            case::Names::add(&mut names.integrations, rules);
        }
        case::Names::add(&mut names.constraints, self.solvers.names());
        more(&mut names.laws, &mut self.plane.materials.keys().chain(self.volume.materials.keys()));
        more(&mut names.obstacles, &mut self.plane.obstacles.keys().chain(self.volume.obstacles.keys()));
        names
    }
}
