//! Warning E065 if a penalty lets bodies sink into each other, or come apart, by more than a hundredth of their size.

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::result::RunResult;
use crate::words::{percent, short};
use faying::problem::{Formulation, Model, TieModel};

/// Share of the smaller body's size that bodies may sink.
const DEEP: f64 = 1e-2;

/// Returns at most one warning per contact and per interface.
pub fn warnings<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, result: &RunResult) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let size =
        |patches: &[usize]| patches.iter().filter_map(|&k| model.patches[k].extent).map(|b| b.diagonal()).fold(f64::INFINITY, f64::min);
    for (contact, block) in model.contacts.iter().zip(&case.contacts) {
        let Some(report) = result.contact.get(&contact.name).filter(|_| matches!(contact.formulation, Formulation::Penalty { .. })) else {
            continue;
        };
        let patches: Vec<usize> = contact.parts.iter().flat_map(|p| p.masters.iter().chain([&p.slave])).map(|s| s.patch).collect();
        let (depth, size) = (-report.gap.min, size(&patches));
        if depth > DEEP * size {
            let text = format!(
                "the penalty of contact \"{}\" is soft: bodies sink into each other by {}, {} % of their size {}",
                contact.name,
                short(depth),
                percent(depth / size),
                short(size)
            );
            let help = "raise `factor`, or write method = \"lagrange\" or \"augmented\"";
            found.push(Diagnostic::warning("E065", text).at(&case.source, block.head.at).with_help(help));
        }
    }
    let soft = |tie: &&TieModel<S, N>| model.components == N && tie.parts.iter().any(|p| p.penalty.is_some());
    for tie in model.ties.iter().filter(soft) {
        let Some(report) = result.interface.get(&tie.name) else { continue };
        let Some(block) = case.interfaces.iter().find(|i| i.name.value == tie.name) else { continue };
        let patches: Vec<usize> = tie.parts.iter().flat_map(|p| p.pairings.iter().map(|m| m.master.patch).chain([p.slave.patch])).collect();
        let (jump, size) = (report.jump.l2 / report.segments.measure.sqrt(), size(&patches));
        if jump > DEEP * size {
            let text = format!(
                "the penalty of interface \"{}\" is soft: its sides come apart by {} in the mean, {} % of the size {} of a body",
                tie.name,
                short(jump),
                percent(jump / size),
                short(size)
            );
            let help = "raise `factor`, or write coupling = \"mortar\"";
            found.push(Diagnostic::warning("E065", text).at(&case.source, block.head.at).with_help(help));
        }
    }
    found
}
