//! Report on the multiplier spaces of interfaces and contacts.

use crate::case::{self, Case};
use crate::result::{MultiplierReport, RunResult};
use faying::basis::Basis;
use faying::coupling::multiplier::{MultiplierKind, reproduction};
use faying::problem::{Contents, InterfaceView};
use faying::space::Trace;

/// Describes the multipliers of one slave side, one space per component, that the case calls by a name.
pub type Describe<const S: usize, const N: usize> = fn(&Trace<S, N>, &case::Multiplier, &[&dyn Basis<S>]) -> MultiplierReport;

/// Fills in the multipliers of every interface and contact that has some.
pub fn describe<const S: usize, const N: usize>(case: &Case, contents: &Contents<'_, S, N>, one: Describe<S, N>, result: &mut RunResult) {
    let of = |of: &InterfaceView<'_, S, N>, words: &case::Multiplier| {
        let sides = of.sides().into_iter().filter(|side| !side.multipliers().is_empty());
        together(sides.map(|side| one(side.side().trace(), words, &side.multipliers())))
    };
    for tie in contents.ties() {
        let Some(words) = case.interfaces.iter().find(|c| c.name.value == tie.name()) else { continue };
        if let Some((_, report)) = result.interface.0.iter_mut().find(|(name, _)| name == tie.name()) {
            report.multiplier = of(&tie, &words.multiplier.value);
        }
    }
    for contact in contents.contacts() {
        let Some(words) = case.contacts.iter().find(|c| c.name.value == contact.name()) else { continue };
        if let Some((_, report)) = result.contact.0.iter_mut().find(|(name, _)| name == contact.name()) {
            report.multiplier = of(&contact, &words.multiplier.value);
        }
    }
}

/// Merges the reports of all slave sides of an interface; `None` without any functions.
fn together(parts: impl Iterator<Item = MultiplierReport>) -> Option<MultiplierReport> {
    parts.filter(|p| p.functions > 0).reduce(|a, b| MultiplierReport {
        name: a.name,
        degree: a.degree.max(b.degree),
        functions: a.functions + b.functions,
        reproduction: a.reproduction.zip(b.reproduction).map(|(a, b)| a.min(b)),
    })
}

/// The description of multipliers on a curve.
pub fn on_curves(slave: &Trace<1, 2>, words: &case::Multiplier, spaces: &[&dyn Basis<1>]) -> MultiplierReport {
    let space = &*slave.space;
    let name = match words {
        case::Multiplier::Named(word) => match word.parse::<MultiplierKind>() {
            Ok(kind @ MultiplierKind::Auto) => kind.resolved(space as &dyn Basis<1>).to_string(),
            _ => word.clone(),
        },
        _ => "data".into(),
    };
    let degrees = spaces.iter().flat_map(|psi| (0..psi.num_elements()).map(|e| psi.degree(e)[0]));
    let held: Option<Vec<usize>> = spaces.iter().map(|psi| reproduction(space, *psi)).collect();
    MultiplierReport {
        name,
        degree: degrees.max().unwrap_or(0),
        functions: spaces.iter().map(|psi| psi.num_functions()).sum(),
        reproduction: held.and_then(|all| all.into_iter().min()),
    }
}
