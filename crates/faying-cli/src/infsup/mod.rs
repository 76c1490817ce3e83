//! `faying infsup`: inf-sup constants of the slave sides of a case, and a study of them.

mod slave_spaces;

use super::quantities::{Quantity, QuantityKind, undecided};
use super::registry::{Names, Registry};
use super::result::{CheckReport, ProbeReport, RunResult, Status};
use super::run::{MemoryLimit, end_early, too_large};
use super::run_control::RunControl;
use super::shapes::{MakeControlNet, plane_net, solid_net};
use super::studies::{Method, Row, decided};
use crate::case::{Case, Multiplier};
use crate::errors::{Diagnostic, Diagnostics};
use crate::table::{decimals, short};
use faying::coupling::inf_sup::{InfSup, InfSupError, Measure, Norm, Question, ZERO, degree_exponent, inf_sup, slope, verdict};
use faying::linalg::LinearError;
use faying::problem::{InterfaceSide, SlaveEnds};
use faying::space::Trace;
use slave_spaces::{SlaveSpaces, slave_spaces};

/// Options of the inf-sup test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InfSupOptions {
    /// The norms of both spaces.
    pub norm: Norm,
    /// Constraints at the ends of the slave sides.
    pub ends: SlaveEnds,
}

/// Inf-sup constant of one component on one slave side.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// The interface or contact.
    pub name: String,
    /// The slave side.
    pub side: String,
    /// Its patch.
    pub patch: usize,
    /// Component: "x", "y", "u"; "normal" for contacts.
    pub component: &'static str,
    /// Name of the multiplier, with `auto` resolved; `None` if it is given by data.
    pub pairing: Option<String>,
    /// Number of elements of the side.
    pub elements: usize,
    /// Constant measured by the length (area) of the side, with sizes of the spaces.
    pub found: InfSup,
    /// Constant measured in the parameters of the side.
    pub parametric: f64,
}

/// Computes the constants of every slave side and component of `case`, in its order; nothing of the bulk is integrated or solved.
///
/// # Errors
/// All errors of the case, with their source locations; E063 if no side carries a multiplier.
///
/// # Example
/// ```
/// use faying_cli::{Registry, RunControl, infsup::{InfSupOptions, constants}};
/// use faying_cli::Case;
/// # let text = "schema = 1\n[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [8, 2]\n[[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [3, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"x\"\n[[interface]]\nname = \"middle\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\n";
/// let case = Case::parse("demo.toml", text, &Default::default())?; // two boxes, 8 quadratic elements on the slave side
/// let found = constants(&case, &Registry::default(), &InfSupOptions::default(), &RunControl::default())?;
/// assert!((found[0].found.beta - 0.873201).abs() < 1e-6);
/// # Ok::<(), faying_cli::Diagnostics>(())
/// ```
pub fn constants(case: &Case, registry: &Registry, options: &InfSupOptions, watch: &RunControl) -> Result<Vec<Constant>, Diagnostics> {
    match case.model.dimension.value {
        2 => of_sides(case, &registry.plane, plane_net, options, watch),
        _ => of_sides(case, &registry.volume, solid_net, options, watch),
    }
}

fn of_sides<const S: usize, const N: usize>(
    case: &Case,
    names: &Names<S, N>,
    net: MakeControlNet<N>,
    options: &InfSupOptions,
    watch: &RunControl,
) -> Result<Vec<Constant>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    if let Some(fault) = too_large(case, net, MemoryLimit::least(watch.max_memory), true) {
        return Err(fault.into());
    }
    let spaces = slave_spaces(case, names, net, options.ends)?;
    if spaces.is_empty() {
        let fault = Diagnostic::error("E063", "infsup needs an interface or a contact with a multiplier, and the case has none");
        return Err(fault.with_help("add [[interface]] with slave and master").in_file(&case.source.name).into());
    }
    let mut out = Vec::with_capacity(spaces.len());
    for s in &spaces {
        if watch.stop().is_some() {
            break;
        }
        out.push(constant(s, options).map_err(|e| Diagnostics::from(fault(case, s, &e)))?);
    }
    Ok(out)
}

fn constant<const S: usize, const N: usize>(s: &SlaveSpaces<S, N>, options: &InfSupOptions) -> Result<Constant, InfSupError> {
    let space = &*s.spaces.side.trace().space;
    let by = |measure| {
        inf_sup(space, &s.spaces.functions, &*s.spaces.multiplier, &Question { measure, norm: options.norm, ..Question::default() })
    };
    Ok(Constant {
        name: s.name.clone(),
        side: s.spaces.side.label().to_owned(),
        patch: s.spaces.side.body(),
        component: s.component,
        pairing: s.pairing.clone(),
        elements: space.num_elements(),
        found: by(Measure::Physical)?,
        parametric: by(Measure::Parametric(&s.shares))?.beta,
    })
}

fn fault<const S: usize, const N: usize>(case: &Case, s: &SlaveSpaces<S, N>, error: &InfSupError) -> Diagnostic {
    let code = match error {
        InfSupError::Elements { .. } | InfSupError::Empty => "E064",
        InfSupError::Linear(LinearError::Memory) => "E081",
        InfSupError::NotSettled { .. } => "E074",
        _ => "E072",
    };
    Diagnostic::error(code, format!("\"{}\" on `{}`: {error}", s.name, s.spaces.side.label())).in_file(&case.source.name)
}

/// The rows of `infsup`: one per interface or contact, its smallest constant over sides and components.
#[derive(Clone, Copy, Debug)]
pub struct Constants<'a> {
    /// The names of the case.
    pub registry: &'a Registry,
    /// Options of the inf-sup test.
    pub options: InfSupOptions,
}

impl Method for Constants<'_> {
    fn solve(&self, mut row: Row, case: &Case, watch: &RunControl) -> Vec<Row> {
        row.result.backends = case.patches.iter().map(|p| (p.name.value.clone(), p.discretization.backend.value.clone())).collect();
        row.result.checks_expected = case.checks.len();
        let found = match constants(case, self.registry, &self.options, watch) {
            Ok(found) => found,
            Err(faults) => {
                row.refuse(faults);
                return vec![row];
            }
        };
        let mut names: Vec<&str> = found.iter().map(|c| c.name.as_str()).collect();
        names.dedup();
        if names.is_empty() {
            end_early(&mut row.result, watch);
            return vec![row];
        }
        let of = |name: &&str| {
            let own: Vec<&Constant> = found.iter().filter(|c| c.name == *name).collect();
            let mut row = row.clone();
            fill(&mut row, case, &own);
            end_early(&mut row.result, watch);
            row
        };
        names.iter().map(of).collect()
    }

    fn judge(&self, rows: &mut [Row], _case: &Case) {
        for line in lines(rows) {
            let points: Vec<(f64, f64)> = line.iter().filter_map(|&k| point(&rows[k])).collect();
            if points.is_empty() {
                continue;
            }
            let (word, slope) = (verdict(&points).to_string(), slope(&points));
            for (k, &at) in line.iter().enumerate() {
                let before = k.checked_sub(1).and_then(|j| point(&rows[line[j]]));
                let row = &mut rows[at];
                let Some((h, beta)) = point(row) else { continue };
                (row.verdict, row.slope) = (Some(word.clone()), slope);
                if let Some((coarse, first)) = before.filter(|b| b.1 > ZERO && beta > ZERO && b.0 > h) {
                    row.rates.insert("beta".into(), (first / beta).ln() / (coarse / h).ln());
                }
            }
        }
    }

    fn notes(&self, rows: &[Row]) -> Vec<String> {
        let mut notes = Vec::new();
        let lines = lines(rows);
        for line in &lines {
            let Some(last) = line.iter().rev().map(|&k| &rows[k]).find(|row| row.verdict.is_some()) else { continue };
            let slope = last.slope.map_or(String::new(), |s| format!(", slope {} in h", decimals(s, 2)));
            let beta = last.beta.filter(|b| *b > ZERO).map_or("0".to_owned(), |b| short(b, 6));
            notes.push(format!("{}: beta {beta} on level {}{slope}: {}", label(last, true), last.spec.level, word(last)));
        }
        notes.extend(exponents(rows, &lines));
        notes
    }

    fn options(&self) -> String {
        format!("{:?} {:?}", self.options.norm, self.options.ends)
    }

    fn answers_quantities(&self) -> bool {
        false
    }
}

fn word(row: &Row) -> &str {
    row.verdict.as_deref().unwrap_or_default()
}

/// Label of a line of rows: case, degree (if `with_degree`), pairing, interface, varied keys.
fn label(row: &Row, with_degree: bool) -> String {
    let mut parts = vec![row.spec.name().to_owned()];
    if with_degree && !row.degree.is_empty() {
        parts.push(format!("degree {}", row.degree));
    }
    parts.push(row.pairing.clone());
    parts.extend(row.interface.clone());
    parts.extend(row.spec.vary.iter().map(|(key, value)| format!("{key} = {value}")));
    parts.retain(|part| !part.is_empty());
    parts.join(", ")
}

/// Returns the positions of rows that differ in the level alone, per interface, from coarse to fine.
fn lines(rows: &[Row]) -> Vec<Vec<usize>> {
    let mut lines: Vec<Vec<usize>> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        // rows of several interfaces alternate within the levels of one line
        let recent = lines.iter_mut().rev().take_while(|line| rows[line[0]].spec.same_line(&row.spec));
        match recent.into_iter().find(|line| rows[line[0]].interface == row.interface) {
            Some(line) => line.push(k),
            None => lines.push(vec![k]),
        }
    }
    lines
}

/// (h, beta) of a row.
fn point(row: &Row) -> Option<(f64, f64)> {
    row.beta.map(|beta| (row.result.geometry.h, beta))
}

/// Notes such as "beta ~ p^-0.4 (degrees 2 to 4)" for rows that differ in the degree alone, by their finest levels.
fn exponents(rows: &[Row], lines: &[Vec<usize>]) -> Vec<String> {
    let mut groups: Vec<(&Row, Vec<(f64, f64)>)> = Vec::new();
    for line in lines {
        let Some(last) = line.iter().rev().map(|&k| &rows[k]).find(|row| row.beta.is_some()) else { continue };
        let (Some(beta), Ok(degree)) = (last.beta.filter(|b| *b > ZERO), last.degree.parse::<f64>()) else { continue };
        let same = |other: &Row| label(other, false) == label(last, false) && other.spec.level == last.spec.level;
        match groups.iter_mut().find(|(first, _)| same(first)) {
            Some((_, points)) => points.push((degree, beta)),
            None => groups.push((last, vec![(degree, beta)])),
        }
    }
    let sentence = |(first, points): &(&Row, Vec<(f64, f64)>)| {
        let a = degree_exponent(points)?;
        let degrees: Vec<String> = points.iter().map(|p| p.0.to_string()).collect();
        Some(format!("{}: beta ~ p^{a:.2} fitted to degrees {} on level {}", label(first, false), degrees.join(", "), first.spec.level))
    };
    groups.iter().filter_map(sentence).collect()
}

/// Fills a row with the constants of one interface or contact.
fn fill(row: &mut Row, case: &Case, own: &[&Constant]) {
    let smallest = |of: &dyn Fn(&Constant) -> f64| own.iter().copied().min_by(|a, b| of(a).total_cmp(&of(b)));
    let (Some(worst), Some(parametric)) = (smallest(&|c| c.found.beta), smallest(&|c| c.parametric)) else { return };
    row.interface = Some(worst.name.clone());
    (row.beta, row.parametric) = (Some(worst.found.beta), Some(parametric.parametric));
    let result = &mut row.result;
    result.backend.clone_from(&case.patches[worst.patch].discretization.backend.value);
    (result.unknowns.primal, result.unknowns.multipliers) = (worst.found.functions, worst.found.multipliers);
    result.geometry.elements = worst.elements;
    result.geometry.h = own.iter().map(|c| c.found.h).fold(0.0, f64::max);
    let written = case
        .interfaces
        .iter()
        .map(|t| (&t.name.value, &t.multiplier.value))
        .chain(case.contacts.iter().map(|c| (&c.name.value, &c.multiplier.value)))
        .find(|(name, _)| **name == worst.name);
    let written = written.and_then(|(_, m)| if let Multiplier::Named(word) = m { Some(word.clone()) } else { None });
    if let Some(pairing) = &worst.pairing {
        row.pairing.clone_from(pairing);
    }
    let names: Vec<&str> = worst.pairing.iter().chain(&written).map(String::as_str).collect();
    answer(result, case, &names, worst.found.beta);
}

/// Answers probes and checks on `infsup.PAIRING.beta` where the pairing is one of `names`; all others are left to a run.
fn answer(result: &mut RunResult, case: &Case, names: &[&str], beta: f64) {
    let mine =
        |text: &str| matches!(Quantity::parse(text).map(|q| q.kind), Ok(QuantityKind::Beta(pairing)) if names.contains(&pairing.as_str()));
    for probe in case.probes.iter().filter(|p| mine(&p.quantity.value)) {
        let (name, quantity) = (probe.name.value.clone(), probe.quantity.value.clone());
        result.probes.push(ProbeReport { name, quantity, value: beta, at: None, t: None, patch: None, reason: None });
    }
    let numbers = result.numbers();
    for check in &case.checks {
        let reason = Some("not a constant of this pair".to_owned());
        let mut report = CheckReport { ok: true, reason, skipped: true, ..undecided(check) };
        let elsewhere = check.backend.as_ref().is_some_and(|b| result.backends.iter().any(|(_, used)| *used != b.value));
        if mine(&check.quantity.value) && !elsewhere {
            decided(&mut report, Some(beta), &check.condition, &numbers, "beta");
        }
        result.checks.push(report);
    }
    result.checks_skipped = result.checks.iter().filter(|c| c.skipped).count();
    result.checks_performed = result.checks.len() - result.checks_skipped;
    if result.checks.iter().any(|c| !c.ok) && result.status == Status::Ok {
        result.status = Status::CheckFailed;
        result.exit = result.status.exit();
    }
}
