//! Common data of all build steps.

use crate::case::Case;
use crate::errors::{Diagnostic, Diagnostics};
use crate::place::SourceSpan;
use crate::registry::Names;

/// Common data of all build steps: the case, the registered names, and the diagnostics found so far.
#[derive(Debug)]
pub(crate) struct LowerContext<'a, const S: usize, const N: usize> {
    pub case: &'a Case,
    pub names: &'a Names<S, N>,
    pub faults: Diagnostics,
}

/// Help text for elements that fold over (E041).
const INVERTED: &str = "move the points around it apart; `faying inspect` lists such elements and draws them with --svg";

impl<const S: usize, const N: usize> LowerContext<'_, S, N> {
    /// Creates an error at a source location of the case.
    pub fn error(&self, code: &'static str, message: impl Into<String>, at: SourceSpan) -> Diagnostic {
        let error = Diagnostic::error(code, message).at(&self.case.source, at);
        if code == "E041" { error.with_help(INVERTED) } else { error }
    }

    /// Creates a warning at a source location of the case.
    pub fn warning(&self, code: &'static str, message: impl Into<String>, at: SourceSpan) -> Diagnostic {
        Diagnostic::warning(code, message).at(&self.case.source, at)
    }

    /// Returns the diagnostics so far as `Err` if there is an error among them.
    pub fn stop(&mut self) -> Result<(), Diagnostics> {
        if self.faults.has_errors() { Err(std::mem::take(&mut self.faults)) } else { Ok(()) }
    }
}
