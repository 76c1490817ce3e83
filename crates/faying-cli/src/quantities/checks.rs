//! Probes and checks of a case: prepared before the solve, evaluated after it.

use super::evaluate::{Answer, evaluate};
use super::grammar::Reduce;
use super::lines::PreparedLine;
use super::locate::Locators;
use super::prepare::{Prepared, Preparer};
use crate::case::{AskedSteps, Case, Check, Condition, Probe};
use crate::errors::{Diagnostic, Diagnostics};
use crate::formula::Formula;
use crate::lower::LoweredCase;
use crate::place::Located;
use crate::result::{CheckReport, ProbeReport, RunResult};
use crate::text_format::short;
use faying::problem::Solution;
use serde_json::{Value, json};

/// Probes and checks of a case, prepared for evaluation.
#[derive(Debug)]
pub struct Questions<const S: usize, const N: usize> {
    probes: Vec<Prepared<S, N>>,
    lines: Vec<PreparedLine<S, N>>,
    checks: Vec<Prepared<S, N>>,
    /// Quantities in the values of each check: value, rtol, atol.
    values: Vec<[Vec<Prepared<S, N>>; 3]>,
}

/// Reason given for a check on a rate, which has no value in a run.
const NO_STUDY: &str = "a rate is known to studies alone: `faying convergence` or `faying compare` with levels decides this check";

/// Returns the formulas of a condition: bound or value, rtol, atol.
fn formulas(condition: &Condition) -> [Option<&Located<Formula>>; 3] {
    match condition {
        Condition::Below(f) | Condition::Above(f) => [Some(f), None, None],
        Condition::Equals { value, rtol, atol } => [Some(value), rtol.as_ref(), atol.as_ref()],
    }
}

/// Evaluates a quantity on a solution, if there is one.
fn ask<const S: usize, const N: usize>(solution: Option<&Solution<S, N>>, prepared: &Prepared<S, N>, numbers: &Value) -> Answer {
    match (solution, prepared) {
        (Some(solution), _) => evaluate(prepared, solution, numbers),
        (None, Prepared::Study) => Answer::Study,
        (None, _) => Answer::None("nothing was solved".into()),
    }
}

impl<const S: usize, const N: usize> Questions<S, N> {
    /// Prepares every probe and check of `case`.
    ///
    /// # Errors
    /// E015, E018, E019, E021, E022, E062 at their places.
    pub fn of(case: &Case, model: &LoweredCase<S, N>, skeleton: &Value) -> Result<Self, Diagnostics> {
        // probes are answered before checks: checks may name them, probes neither probes nor checks
        let answered: Vec<Value> = case.probes.iter().map(|p| json!({ "name": p.name.value, "value": 0.0 })).collect();
        let mut with_probes = skeleton.clone();
        with_probes["probes"] = Value::Array(answered);
        let locators = Locators::new(model);
        let (of_probes, of_checks) = (Preparer::new(case, &locators, skeleton), Preparer::new(case, &locators, &with_probes));
        let mut faults = Diagnostics::new();
        let asked = case.probes.iter().filter_map(|p| p.t.as_ref()).chain(case.checks.iter().filter_map(|c| c.t.as_ref()));
        let asked = asked.chain(case.lines.iter().filter_map(|l| l.t.as_ref()));
        faults.items.extend(asked.filter_map(|t| no_step(case, t)));
        let understand = |preparer: &Preparer<'_, S, N>, faults: &mut Diagnostics, text: &Located<String>, both: bool| {
            preparer.prepare(&text.value, text.at, both).unwrap_or_else(|fault| {
                faults.push(*fault);
                Prepared::Study
            })
        };
        let probes = case.probes.iter().map(|p| understand(&of_probes, &mut faults, &p.quantity, false)).collect();
        let mut lines = Vec::with_capacity(case.lines.len());
        for line in &case.lines {
            match PreparedLine::of(case, line, &locators, skeleton) {
                Ok(found) => lines.push(found),
                Err(found) => faults.extend(found),
            }
        }
        let mut checks = Vec::with_capacity(case.checks.len());
        for c in &case.checks {
            let before = faults.items.len();
            let prepared = understand(&of_checks, &mut faults, &c.quantity, c.over_all.is_some());
            let field = matches!(prepared, Prepared::FunctionSpace(_, _, Reduce::None));
            if let (Some(over), false, true) = (&c.over_all, field, faults.items.len() == before) {
                let message = format!("`over` checks the minimum and maximum of a field, `{}` is one number", c.quantity.value);
                let help = "leave it out, or name a field as a whole such as stress.yy";
                faults.push(Diagnostic::error("E015", message).with_help(help).at(&case.source, over.at));
            }
            checks.push(prepared);
        }
        let mut take = |text: &Located<String>| understand(&of_checks, &mut faults, text, false);
        let values = case
            .checks
            .iter()
            .map(|c| {
                formulas(&c.condition).map(|f| match f {
                    Some(f) => f
                        .value
                        .quantities()
                        .iter()
                        .map(|q| take(&Located::new(q.text.clone(), f.at.inside(q.offset + 1, q.length))))
                        .collect(),
                    None => Vec::new(),
                })
            })
            .collect();
        if faults.has_errors() { Err(faults) } else { Ok(Self { probes, lines, checks, values }) }
    }

    /// Evaluates all probes at the end of a step, those that ask for it into `result`; returns all.
    pub fn probes(
        &self,
        case: &Case,
        step: &Step,
        solution: Option<&Solution<S, N>>,
        result: &mut RunResult,
        told: &mut Told,
    ) -> Vec<ProbeReport> {
        let value = result.numbers();
        let of = |(probe, prepared): (&Probe, &Prepared<S, N>)| {
            let (value, at, reason) = match ask(solution, prepared, &value) {
                Answer::One(v) => (v, None, None),
                Answer::Placed(v, at) | Answer::Range([(v, at), _]) => (v, Some(at), None),
                Answer::None(reason) => (f64::NAN, None, Some(reason)),
                Answer::Study => (f64::NAN, None, Some("only studies answer this quantity".to_string())),
            };
            let patch = match prepared {
                Prepared::At(_, spot) if spot.shared => Some(case.patches[spot.patch].name.value.clone()),
                _ => None,
            };
            ProbeReport { name: probe.name.value.clone(), quantity: probe.quantity.value.clone(), value, at, t: None, patch, reason }
        };
        let all: Vec<ProbeReport> = case.probes.iter().zip(&self.probes).map(of).collect();
        told.probes.resize(all.len(), None);
        for ((probe, now), known) in case.probes.iter().zip(&all).zip(&mut told.probes) {
            *known = Some(match probe.t.as_ref().map(|t| t.value) {
                None => now.clone(),
                Some(AskedSteps::At(t)) if !same(t, step.t) => match known.take() {
                    Some(before) => before,
                    None => ProbeReport {
                        value: f64::NAN,
                        at: None,
                        t: Some(t),
                        patch: None,
                        reason: Some("its step was not reached".to_owned()),
                        ..now.clone()
                    },
                },
                Some(_) => ProbeReport { t: Some(step.t), ..now.clone() },
            });
        }
        result.probes = told.probes.iter().flatten().cloned().collect();
        all
    }

    /// Evaluates the lines that ask for a step on its solution into `result`, beside those of the steps before.
    pub fn lines(&self, case: &Case, step: &Step, solution: &Solution<S, N>, result: &mut RunResult) {
        let known = std::mem::take(&mut result.lines);
        for (line, prepared) in case.lines.iter().zip(&self.lines) {
            let asked = line.t.as_ref().map(|t| t.value);
            if asked.is_some() {
                result.lines.extend(known.iter().filter(|old| old.name == line.name.value).cloned());
            }
            if !matches!(asked, Some(AskedSteps::At(t)) if !same(t, step.t)) {
                result.lines.push(prepared.values(line, asked.map(|_| step.t), solution));
            }
        }
    }

    /// Evaluates the checks that ask for a step.
    pub fn checks(&self, case: &Case, step: &Step, solution: Option<&Solution<S, N>>, result: &RunResult, told: &mut Told) {
        told.checks.resize(case.checks.len(), None);
        let is_due = |check: &Check| match check.t.as_ref().map(|t| t.value) {
            None => step.is_last,
            Some(AskedSteps::All) => true,
            Some(AskedSteps::At(t)) => same(t, step.t),
        };
        let due: Vec<usize> = (0..case.checks.len()).filter(|&k| is_due(&case.checks[k])).collect();
        if due.is_empty() {
            return;
        }
        let numbers = result.numbers();
        for k in due {
            // of all steps the first one at which it failed
            if told.checks[k].as_ref().is_none_or(|before| before.ok) {
                let t = case.checks[k].t.as_ref().map(|_| step.t);
                told.checks[k] = Some(CheckReport { t, ..self.check(&case.checks[k], k, step.t, solution, result, &numbers) });
            }
        }
    }

    /// Enters all checks into `result`, those of steps that were not reached undecided; returns whether every check that was decided passed.
    pub fn close(&self, case: &Case, result: &mut RunResult, told: &mut Told) -> bool {
        let numbers = result.numbers();
        told.checks.resize(case.checks.len(), None);
        let known = std::mem::take(&mut told.checks);
        let all = case.checks.iter().zip(known).enumerate();
        let reports: Vec<CheckReport> =
            all.map(|(k, (check, known))| known.unwrap_or_else(|| self.check(check, k, 1.0, None, result, &numbers))).collect();
        result.checks_expected = reports.len();
        result.checks_skipped = reports.iter().filter(|r| r.skipped).count();
        result.checks_performed = reports.len() - result.checks_skipped;
        let passed = reports.iter().all(|r| r.ok);
        result.checks = reports;
        passed
    }

    /// Evaluates a check, the number `k` of the case, at time `t`.
    fn check(&self, check: &Check, k: usize, t: f64, solution: Option<&Solution<S, N>>, result: &RunResult, value: &Value) -> CheckReport {
        let answered = |prepared: &Prepared<S, N>| ask(solution, prepared, value);
        let mut report = undecided(check);
        let elsewhere = check.backend.as_ref().filter(|b| result.backends.iter().any(|(_, used)| *used != b.value));
        let answer = answered(&self.checks[k]);
        // after a run there is no study that could decide it later
        let later = answer == Answer::Study && result.command != "run";
        if later || elsewhere.is_some() {
            report.skipped = true;
            report.ok = true;
            report.reason = Some(elsewhere.map_or("decided by studies".to_string(), |b| format!("only for backend \"{}\"", b.value)));
            return report;
        }
        let all = found(answer).and_then(|found| Ok((found, numbers(&check.condition, t, &self.values[k], &answered)?)));
        match all {
            Ok((found, numbers)) => decide(&check.condition, found, numbers, &mut report),
            Err(reason) => report.reason = Some(reason),
        }
        report
    }
}

/// A step of a run.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Its time.
    pub t: f64,
    /// Whether it is the last one.
    pub is_last: bool,
}

/// Answers to probes and checks over the steps so far.
#[derive(Clone, Debug, Default)]
pub struct Told {
    probes: Vec<Option<ProbeReport>>,
    checks: Vec<Option<CheckReport>>,
}

/// Whether two times are one.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// E015 for a time that is none of the case's steps.
fn no_step(case: &Case, t: &Located<AskedSteps>) -> Option<Diagnostic> {
    const MOST: usize = 8;
    let AskedSteps::At(time) = t.value else { return None };
    let times = &case.steps.value;
    if times.iter().any(|own| same(*own, time)) {
        return None;
    }
    let mut list: Vec<String> = times.iter().take(MOST).map(|t| short(*t)).collect();
    if times.len() > MOST {
        list.push(format!("... ({} in all)", times.len()));
    }
    let text = match case.has_steps() {
        true => format!("there is no step at t = {}; steps end at t = {}", short(time), list.join(", ")),
        false => format!("there is no step at t = {}: without [steps] there is one, at t = 1", short(time)),
    };
    Some(Diagnostic::error("E015", text).with_help("write one of these times, or add it to `t` of [steps]").at(&case.source, t.at))
}

/// A value, and its place if it is an extreme.
type Found = (f64, Option<Vec<f64>>);

/// The report of a check before it is decided.
pub(crate) fn undecided(check: &Check) -> CheckReport {
    CheckReport {
        name: check.name.value.clone(),
        quantity: check.quantity.value.clone(),
        value: f64::NAN,
        at: None,
        t: None,
        expected: f64::NAN,
        ok: false,
        relation: match check.condition {
            Condition::Below(_) => "below",
            Condition::Above(_) => "above",
            Condition::Equals { .. } => "equals",
        }
        .into(),
        reason: None,
        skipped: false,
    }
}

/// The values that a check holds to its condition, or the reason why there are none.
fn found(answer: Answer) -> Result<Vec<Found>, String> {
    match answer {
        Answer::One(v) => Ok(vec![(v, None)]),
        Answer::Placed(v, at) => Ok(vec![(v, Some(at))]),
        Answer::Range(ends) => Ok(ends.map(|(v, at)| (v, Some(at))).to_vec()),
        Answer::None(reason) => Err(reason),
        Answer::Study => Err(NO_STUDY.to_string()),
    }
}

/// Bound or value, rtol and atol of a condition at time `t`, zero where it has none; `quantities`: those named by each.
fn numbers<const S: usize, const N: usize>(
    condition: &Condition,
    t: f64,
    quantities: &[Vec<Prepared<S, N>>; 3],
    answered: &dyn Fn(&Prepared<S, N>) -> Answer,
) -> Result<[f64; 3], String> {
    let mut numbers = [0.0; 3];
    for ((number, formula), quantities) in numbers.iter_mut().zip(formulas(condition)).zip(quantities) {
        let Some(f) = formula else { continue };
        let values: Result<Vec<f64>, String> = quantities
            .iter()
            .map(|p| match answered(p) {
                Answer::One(v) | Answer::Placed(v, _) => Ok(v),
                Answer::None(reason) => Err(reason),
                _ => Err("a value of a check is one number".to_string()),
            })
            .collect();
        *number = f.value.value_with(t, &values?);
        if !number.is_finite() {
            return Err(format!("`{}` is not finite", f.value.text()));
        }
    }
    Ok(numbers)
}

/// Decides a check by the values found; the worst one is reported.
fn decide(condition: &Condition, values: Vec<Found>, [expected, rtol, atol]: [f64; 3], report: &mut CheckReport) {
    // how far a value is on the wrong side
    let excess = |v: f64| match condition {
        Condition::Below(_) => v - expected,
        Condition::Above(_) => expected - v,
        Condition::Equals { .. } => (v - expected).abs(),
    };
    let passes = |v: f64| match condition {
        Condition::Below(_) => v < expected,
        Condition::Above(_) => v > expected,
        Condition::Equals { .. } => (v - expected).abs() <= atol + rtol * expected.abs(),
    };
    report.ok = values.iter().all(|(v, _)| passes(*v));
    let worst = values.into_iter().reduce(|worst, v| if excess(v.0) > excess(worst.0) { v } else { worst });
    (report.value, report.at) = worst.unwrap_or((f64::NAN, None));
    report.expected = expected;
}
