//! Report on the multiplier spaces of interfaces and contacts.

use crate::case::{self, Case};
use crate::result::{MultiplierReport, RunResult};
use faying::basis::Basis;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::Geometry;
use faying::problem::{Contents, InterfaceView};
use faying::space::Trace;

/// The degree of the polynomials of a side that a multiplier holds; of surfaces it is not known.
pub type Reproduction<const S: usize, const N: usize> = fn(&dyn Geometry<S, N>, &dyn Basis<S>) -> Option<usize>;

/// Fills in the multipliers of every interface and contact that has some.
pub fn describe<const S: usize, const N: usize>(
    case: &Case,
    contents: &Contents<'_, S, N>,
    reproduction: Option<Reproduction<S, N>>,
    result: &mut RunResult,
) {
    let one = |slave: &Trace<S, N>, words: &case::Multiplier, spaces: &[&dyn Basis<S>]| described(slave, words, spaces, reproduction);
    let of = |of: &InterfaceView<'_, S, N>, words: &case::Multiplier| {
        let sides = of.sides().into_iter().filter(|side| !side.multipliers().is_empty());
        together(sides.map(|side| one(side.side().trace(), words, &side.multipliers())))
    };
    for tie in contents.ties() {
        let Some(words) = case.interfaces.iter().find(|c| c.name.value == tie.name()) else { continue };
        if let Some(report) = result.interface.get_mut(tie.name()) {
            report.multiplier = of(&tie, &words.multiplier.value);
        }
    }
    for contact in contents.contacts() {
        let Some(words) = case.contacts.iter().find(|c| c.name.value == contact.name()) else { continue };
        if let Some(report) = result.contact.get_mut(contact.name()) {
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

/// Describes the multipliers of one slave side, one space per component, that the case calls by a name.
fn described<const S: usize, const N: usize>(
    slave: &Trace<S, N>,
    words: &case::Multiplier,
    spaces: &[&dyn Basis<S>],
    reproduction: Option<Reproduction<S, N>>,
) -> MultiplierReport {
    let space = &*slave.space;
    let name = match words {
        case::Multiplier::Named(word) => match word.parse::<MultiplierKind>() {
            Ok(kind @ MultiplierKind::Auto) => kind.resolved(space as &dyn Basis<S>).to_string(),
            _ => word.clone(),
        },
        _ => "data".into(),
    };
    let degrees = spaces.iter().flat_map(|psi| (0..psi.num_elements()).flat_map(|e| psi.degree(e)));
    let held: Option<Vec<usize>> = spaces.iter().map(|psi| reproduction?(space, *psi)).collect();
    MultiplierReport {
        name,
        degree: degrees.max().unwrap_or(0),
        functions: spaces.iter().map(|psi| psi.num_functions()).sum(),
        reproduction: held.and_then(|all| all.into_iter().min()),
    }
}
