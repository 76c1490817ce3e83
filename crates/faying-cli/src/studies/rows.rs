//! One row of a study: its changes of the case, and its results.

use super::method::Method;
use crate::case::{Case, Changes, Ends, Master, Multiplier, ReadOptions};
use crate::errors::{Diagnostics, Severity};
use crate::registry::Registry;
use crate::result::{RunResult, Status};
use crate::run_control::RunControl;
use indexmap::IndexMap;
use serde_json::Value;
use std::fmt::Write as _;

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
    /// All errors of the case, with their places.
    pub fn read(&self, spec: &Spec) -> Result<Case, Diagnostics> {
        let mut options = self.options.clone();
        options.sets.extend(spec.vary.iter().map(|(key, value)| format!("{key}={value}")));
        let quantities = [options.changes.quantities, spec.changes.quantities.clone()].concat();
        options.changes = Changes { quantities, ..spec.changes.clone() };
        Case::parse(self.name, self.text, &options)
    }
}

/// Whether each patch carries multipliers, on a slave side of an interface or a contact. If the case leaves the choice of slave and
/// master open, the bodies are built to find it; for a case that cannot be built the named slave sides count.
pub fn slaves(case: &Case, registry: &Registry) -> Vec<bool> {
    let chosen = case.interfaces.iter().any(|t| t.between.is_some());
    if let Some(Ok(found)) = chosen.then(|| crate::run::slave_patches(case, registry)) {
        return found;
    }
    let sides = case.interfaces.iter().flat_map(|t| &t.slave).chain(case.contacts.iter().flat_map(|c| &c.slave));
    let mut slave = vec![false; case.patches.len()];
    sides.for_each(|side| slave[side.patch] = true);
    slave
}

/// Position of a row on the axes of its study.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spec {
    /// The backend, `SLAVE+MASTER`; `None`: as written.
    pub backend: Option<String>,
    /// Position on the axis of degrees.
    pub degree: usize,
    /// Halvings of every element.
    pub level: usize,
    /// Key and value of every varied key.
    pub vary: Vec<(String, String)>,
    /// The changes of the case.
    pub changes: Changes,
}

impl Spec {
    /// Name of the row in the table: its backend, or "as written".
    pub fn name(&self) -> &str {
        self.backend.as_deref().unwrap_or("as written")
    }

    /// Whether both rows are on one line of the picture: they differ in the level alone.
    pub fn same_line(&self, other: &Self) -> bool {
        self.degree == other.degree && self.vary == other.vary && self.backend == other.backend && self.coupling() == other.coupling()
    }

    /// Changes along the sides: multiplier, integration, points.
    fn coupling(&self) -> (&Option<String>, &Option<String>, Option<usize>) {
        (&self.changes.pairing, &self.changes.integration, self.changes.extra_points)
    }

    /// Label of the row: backend, then its other changes, "iga, degree 2, p/p, slave, 4 points more, let.a = 1".
    pub fn label(&self, degree: &str) -> String {
        let mut text = self.name().to_owned();
        let (pairing, integration, points) = self.coupling();
        // writing to a String cannot fail
        if !degree.is_empty() {
            let _ = write!(text, ", degree {degree}");
        }
        for word in pairing.iter().chain(integration) {
            let _ = write!(text, ", {word}");
        }
        if let Some(n) = points {
            let _ = write!(text, ", {}", points_more(n));
        }
        for (key, value) in &self.vary {
            let _ = write!(text, ", {key} = {value}");
        }
        text
    }
}

/// Words for additional points: "4 points more".
pub(super) fn points_more(n: usize) -> String {
    if n == 1 { "1 point more".to_owned() } else { format!("{n} points more") }
}

/// A row with its results, solved or failed.
#[derive(Clone, Debug)]
pub struct Row {
    /// Position on the axes.
    pub spec: Spec,
    /// Its numbers.
    pub result: RunResult,
    /// Degree of the patches: "2", "3x2", "2+1"; the requested one if the case could not be read.
    pub degree: String,
    /// Multiplier of the interfaces and contacts as given in the case; empty without one.
    pub pairing: String,
    /// Their integration.
    pub integration: String,
    /// Extra Gauss points per segment.
    pub extra_points: String,
    /// Observed rates of convergence from the level before, by quantity.
    pub rates: IndexMap<String, f64>,
    /// Relative differences from the first row, by quantity; not finite if a value is missing.
    pub differences: IndexMap<String, f64>,
    /// The result as JSON, before the study adds to it.
    pub document: Value,
    /// The interface or contact of `beta`.
    pub interface: Option<String>,
    /// The inf-sup constant, in studies that compute it.
    pub beta: Option<f64>,
    /// The inf-sup constant measured in the parameter of the side.
    pub parametric: Option<f64>,
    /// Fitted slope of log beta against log h over the finest levels.
    pub slope: Option<f64>,
    /// Verdict from all levels together: "stable", "unstable", "undecided".
    pub verdict: Option<String>,
    /// Wall-clock seconds that it took.
    pub seconds: f64,
    /// Whether an earlier study solved it.
    pub kept: bool,
}

impl Row {
    /// A row before it is solved.
    pub fn begun(command: &str, spec: &Spec, base: &Base<'_>) -> Self {
        Self {
            spec: spec.clone(),
            result: RunResult::new(command, base.name),
            degree: String::new(),
            pairing: String::new(),
            integration: String::new(),
            extra_points: String::new(),
            rates: IndexMap::default(),
            differences: IndexMap::default(),
            document: Value::Null,
            interface: None,
            beta: None,
            parametric: None,
            slope: None,
            verdict: None,
            seconds: 0.0,
            kept: false,
        }
    }

    /// Solves the row by `method` if `case` could be read; returns several rows if the method has several results.
    pub(super) fn solved_by(
        mut self,
        method: &dyn Method,
        case: Result<&Case, Diagnostics>,
        base: &Base<'_>,
        watch: &RunControl,
    ) -> Vec<Self> {
        let begun = std::time::Instant::now();
        let mut rows = match case {
            Ok(case) => {
                self.describe(case);
                method.solve(self, case, watch)
            }
            Err(faults) => {
                self.foresee(base);
                self.refuse(faults);
                vec![self]
            }
        };
        let seconds = begun.elapsed().as_secs_f64() / rows.len().max(1) as f64;
        for row in &mut rows {
            row.document = row.result.to_value();
            row.seconds = seconds;
        }
        rows
    }

    /// Marks the checks as skipped: they are decided by the row of the case as written, those on rates later.
    pub(super) fn leave_checks(&mut self) {
        let result = &mut self.result;
        for check in result.checks.iter_mut().filter(|check| !check.skipped) {
            (check.skipped, check.ok) = (true, true);
            (check.value, check.expected) = (f64::NAN, f64::NAN);
            check.reason = Some("decided on the case as written".to_owned());
        }
        result.checks_skipped = result.checks.len();
        result.checks_performed = 0;
        if result.status == Status::CheckFailed {
            result.status = Status::Ok;
            result.exit = result.status.exit();
        }
        self.document = self.result.to_value();
    }

    /// Marks the row as failed with the errors and warnings `faults`.
    pub fn refuse(&mut self, faults: Diagnostics) {
        let result = &mut self.result;
        result.status = match faults.exit() {
            4 => Status::IoFailed,
            5 => Status::Singular,
            6 => Status::Limit,
            _ => Status::Invalid,
        };
        result.exit = result.status.exit();
        for d in faults.items {
            let list = if d.severity == Severity::Error { &mut result.diagnostics } else { &mut result.warnings };
            list.push(d);
        }
    }

    // description of a row that cannot be read: the case as written with its keys, the degrees and the coupling of the study
    fn foresee(&mut self, base: &Base<'_>) {
        let changes = self.spec.changes.clone();
        let written = base.read(&Spec { vary: self.spec.vary.clone(), ..Spec::default() }).ok();
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
        let points = changes.extra_points.map(|n| n.to_string());
        for (word, given) in
            [(&mut self.pairing, &changes.pairing), (&mut self.integration, &changes.integration), (&mut self.extra_points, &points)]
        {
            if let Some(given) = given {
                word.clone_from(given);
            }
        }
    }

    /// The code of the error that stopped the row; `None` without an error.
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
            Multiplier::Data { degree, continuity, ends } => {
                let regularity = continuity.map_or(String::new(), |k| format!(", C^{k}"));
                let ends = match ends {
                    Ends::Auto => "",
                    Ends::Full => ", full ends",
                    Ends::Lowered => ", lowered ends",
                };
                format!("degree {degree}{regularity}{ends}")
            }
        }));
        let rules = case.interfaces.iter().map(|t| &t.integration.value).chain(case.contacts.iter().map(|c| &c.integration.value));
        self.integration = joined(rules.cloned());
        let extra = case.interfaces.iter().map(|t| t.extra_points.value).chain(case.contacts.iter().map(|c| c.extra_points.value));
        self.extra_points = joined(extra.map(|n| n.to_string()));
    }

    /// Whether there is a solution with numbers.
    pub fn solved(&self) -> bool {
        self.result.solved
    }

    /// Number of unknowns, multipliers included.
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

/// Names of the contacts of a case that have a master.
pub(super) fn contact_names(case: &Case) -> Vec<String> {
    let pressing = |m: &Master| !matches!(m, Master::Sides(sides) if sides.is_empty());
    case.contacts.iter().filter(|c| pressing(&c.master)).map(|c| c.name.value.clone()).collect()
}
