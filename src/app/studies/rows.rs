//! One row of a study: which changes it makes to the case, and what came out.

use crate::app::named::Named;
use crate::app::registry::Registry;
use crate::app::result::{RunResult, Status};
use crate::app::watch::Watch;
use crate::io::case::{Case, Changes, Integration, Master, Multiplier, ReadOptions};
use crate::io::errors::{Diagnostics, Severity};

/// The case of a study before a row changes it.
#[derive(Clone, Debug)]
pub struct Base<'a> {
    /// Its name in messages.
    pub name: &'a str,
    /// Its text.
    pub text: &'a str,
    /// `--set` and the known names.
    pub options: ReadOptions,
}

impl Base<'_> {
    /// The case of a row.
    ///
    /// # Errors
    /// What is wrong with it, located.
    pub fn read(&self, spec: &Spec) -> Result<Case, Diagnostics> {
        let mut options = self.options.clone();
        options.sets.extend(spec.vary.iter().map(|(key, value)| format!("{key}={value}")));
        let quantities = [options.changes.quantities, spec.changes.quantities.clone()].concat();
        options.changes = Changes { quantities, ..spec.changes.clone() };
        Case::parse(self.name, self.text, &options)
    }
}

/// Which patches carry multipliers: those with a slave side of an interface or a contact.
pub fn slaves(case: &Case) -> Vec<bool> {
    let sides = case.interfaces.iter().flat_map(|t| &t.slave).chain(case.contacts.iter().flat_map(|c| &c.slave));
    let mut slave = vec![false; case.patches.len()];
    sides.for_each(|side| slave[side.patch] = true);
    slave
}

/// Where a row stands on the axes of its study.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spec {
    /// The backend, `SLAVE+MASTER`; none: as written.
    pub backend: Option<String>,
    /// Position on the axis of degrees.
    pub degree: usize,
    /// Halvings of every element.
    pub level: usize,
    /// Key and value of every varied key.
    pub vary: Vec<(String, String)>,
    /// What this changes in the case.
    pub changes: Changes,
}

impl Spec {
    /// What the table calls the row.
    pub fn name(&self) -> &str {
        self.backend.as_deref().unwrap_or("as written")
    }

    /// Whether both are rows of one line of the picture: they differ in the level alone.
    pub fn same_line(&self, other: &Self) -> bool {
        self.backend == other.backend && self.degree == other.degree && self.vary == other.vary
    }
}

/// A row that was solved, or could not be.
#[derive(Clone, Debug)]
pub struct Row {
    /// Where it stands.
    pub spec: Spec,
    /// Its numbers.
    pub result: RunResult,
    /// Degree of the patches: "2", "3x2", "2+1"; of a row whose case could not be read that which was asked for.
    pub degree: String,
    /// Multiplier of the interfaces and contacts as the case says it; empty without one.
    pub pairing: String,
    /// Their integration.
    pub integration: String,
    /// Their points beyond the default.
    pub extra_points: String,
    /// Observed rates of convergence from the level before, by quantity.
    pub rates: Named<f64>,
    /// Relative differences from the first row, by quantity; not finite where a value is missing.
    pub differences: Named<f64>,
}

impl Row {
    /// Reads and solves a row.
    pub fn solve(command: &str, spec: &Spec, base: &Base<'_>, registry: &Registry, watch: &Watch) -> Self {
        let mut row = Self {
            spec: spec.clone(),
            result: RunResult::new(command, base.name),
            degree: String::new(),
            pairing: String::new(),
            integration: String::new(),
            extra_points: String::new(),
            rates: Named::default(),
            differences: Named::default(),
        };
        match base.read(spec) {
            Ok(case) => {
                row.describe(&case);
                row.result = crate::app::run::numbers(command, &case, registry, watch);
            }
            Err(faults) => {
                row.foresee(base);
                let result = &mut row.result;
                result.status = if faults.exit() == 4 { Status::IoFailed } else { Status::Invalid };
                result.exit = result.status.exit();
                for d in faults.items {
                    let list = if d.severity == Severity::Error { &mut result.diagnostics } else { &mut result.warnings };
                    list.push(d);
                }
            }
        }
        row
    }

    // what the row would have been: the case as written with its keys, the degrees that the study gives
    fn foresee(&mut self, base: &Base<'_>) {
        let (spec, changes) = (&self.spec, &self.spec.changes);
        let written = base.read(&Spec { vary: spec.vary.clone(), ..Spec::default() }).ok();
        let given = match (changes.degree, changes.degrees.as_slice()) {
            (Some(p), _) => Some(p.to_string()),
            (None, []) => None,
            (None, list) => Some(joined(list.iter().map(|(_, p)| p.to_string()))),
        };
        if let Some(case) = &written {
            self.describe(case);
        }
        if let Some(degree) = given {
            self.degree = degree;
        }
    }

    /// The code of the error that stopped the row; none where nothing did.
    pub fn code(&self) -> Option<&str> {
        self.result.diagnostics.first().map(|d| d.code)
    }

    fn describe(&mut self, case: &Case) {
        let degree = |p: &Vec<usize>| {
            let words: Vec<String> = p.iter().map(usize::to_string).collect();
            if p.iter().all(|q| *q == p[0]) { words[0].clone() } else { words.join("x") }
        };
        self.degree = joined(case.patches.iter().map(|p| degree(&p.discretization.degree)));
        let multipliers = case.interfaces.iter().map(|t| &t.multiplier.value).chain(case.contacts.iter().map(|c| &c.multiplier.value));
        self.pairing = joined(multipliers.map(|m| match m {
            Multiplier::Named(name) => name.clone(),
            Multiplier::Data { degree, continuity, .. } => {
                let regularity = continuity.map_or(String::new(), |k| format!(", C^{k}"));
                format!("degree {degree}{regularity}")
            }
        }));
        let rules = case.interfaces.iter().map(|t| t.integration.value).chain(case.contacts.iter().map(|c| c.integration.value));
        self.integration = joined(rules.map(|rule| match rule {
            Integration::Merged => "merged".to_owned(),
            Integration::Slave => "slave".to_owned(),
            Integration::Mixed => "mixed".to_owned(),
        }));
        let extra = case.interfaces.iter().map(|t| t.extra_points.value).chain(case.contacts.iter().map(|c| c.extra_points.value));
        self.extra_points = joined(extra.map(|n| n.to_string()));
    }

    /// Whether there is a solution with numbers.
    pub fn solved(&self) -> bool {
        self.result.solved
    }

    /// Unknowns of all kinds.
    pub fn unknowns(&self) -> usize {
        self.result.unknowns.primal + self.result.unknowns.multipliers
    }
}

/// Different words in the order of their first appearance, joined by "+".
fn joined(words: impl Iterator<Item = String>) -> String {
    let mut different: Vec<String> = Vec::new();
    words.for_each(|w| {
        if !different.contains(&w) {
            different.push(w);
        }
    });
    different.join("+")
}

/// Names of the contacts of a case that press on something.
pub(super) fn contact_names(case: &Case) -> Vec<String> {
    let pressing = |m: &Master| !matches!(m, Master::Sides(sides) if sides.is_empty());
    case.contacts.iter().filter(|c| pressing(&c.master)).map(|c| c.name.value.clone()).collect()
}
