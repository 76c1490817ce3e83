//! Warning E017 where `exact` leaves open which of its pieces a slave side has: errors of lambda have no value there.

use crate::build::Built;
use crate::case::Case;
use crate::errors::Diagnostic;
use crate::result::RunResult;
use crate::run::errors::left_open;

/// Returns one warning per tie and contact, and puts the reason beside the errors without value.
pub fn warnings<const S: usize, const N: usize>(case: &Case, model: &Built<S, N>, result: &mut RunResult) -> Vec<Diagnostic> {
    let Some(given) = &case.model.exact else { return Vec::new() };
    let names = left_open(model, &result.errors);
    let why =
        |name: &String| format!("pieces of `exact` meet so near to the slave side of \"{name}\" that it is open which one is its own");
    result.errors_reason = (!names.is_empty()).then(|| names.iter().map(why).collect::<Vec<_>>().join("; "));
    let told = |name: &String| {
        let help =
            "take more elements along the side, mapping = \"exact\" or backend = \"iga\", or give lambda as `exact` of the interface";
        let text = format!("{}: error.{name}.lambda.L2 has no value", why(name));
        Diagnostic::warning("E017", text).at(&case.source, given.at).with_help(help)
    };
    names.iter().map(told).collect()
}
