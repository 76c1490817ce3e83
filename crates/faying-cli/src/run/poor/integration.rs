//! Warning E065 if the integration of an interface is inexact, by [`faying::coupling::consistency`].

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::result::RunResult;
use crate::words::percent;

/// Consistency error above which the warning is given.
const INEXACT: f64 = 1e-2;

/// Returns one warning for every tie and every contact whose integration is inexact.
pub fn warnings(case: &Case, result: &RunResult) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (name, report) in result.interface.iter().filter(|(_, report)| report.consistency > INEXACT) {
        if let Some(tie) = case.interfaces.iter().find(|t| t.name.value == *name) {
            found.push(warning(case, "interface", name, report.consistency, &tie.integration));
        }
    }
    for (name, report) in result.contact.iter().filter(|(_, report)| report.consistency > INEXACT) {
        if let Some(contact) = case.contacts.iter().find(|c| c.name.value == *name) {
            found.push(warning(case, "contact", name, report.consistency, &contact.integration));
        }
    }
    found
}

fn warning(case: &Case, kind: &str, name: &str, error: f64, rule: &Located<String>) -> Diagnostic {
    let text = format!(
        "the integration of {kind} \"{name}\" is inexact: its consistency error is {} % of what it integrates, forces may be off by as much",
        percent(error)
    );
    let help = match rule.value.as_str() {
        "slave" => "write integration = \"merged\"; or raise `extra_points`, or exchange slave and master: the finer side as slave",
        "mixed" => "write integration = \"merged\"; or raise `extra_points`; mixed integration goes with p/p",
        _ => "raise `extra_points`, or refine the sides: they are curved",
    };
    Diagnostic::warning("E065", text).at(&case.source, rule.at).with_help(help)
}
