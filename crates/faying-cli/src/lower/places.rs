//! Places of the statements of a problem in the text of its case.

use crate::formula::Formula;
use crate::place::{Located, SourceSpan};
use faying::problem::{BodyId, Statement};
use std::collections::HashMap;

/// Origin of a statement.
#[derive(Clone, Debug, Default)]
pub struct Said {
    /// Place in the case.
    pub at: SourceSpan,
    /// The `[[boundary]]`, `[[interface]]` or `[[contact]]` block.
    pub block: Option<usize>,
    /// Places of its slave sides.
    pub slaves: Vec<SourceSpan>,
    /// Name of its data in messages: "the traction".
    pub what: &'static str,
    /// Its formulas, one per component, or one.
    pub formulas: Vec<Located<Formula>>,
}

/// Origins of all statements.
#[derive(Clone, Debug, Default)]
pub struct Places {
    said: HashMap<Statement, Said>,
    /// The bodies of the patches, in their order.
    pub bodies: Vec<BodyId>,
}

impl Places {
    /// Keeps the origin of a statement.
    pub(super) fn keep(&mut self, statement: Statement, said: Said) {
        self.said.insert(statement, said);
    }

    /// The origin of a statement.
    pub fn said(&self, statement: Statement) -> Option<&Said> {
        self.said.get(&statement)
    }

    /// Place of a statement.
    pub fn at(&self, statement: Statement) -> SourceSpan {
        self.said.get(&statement).map(|s| s.at).unwrap_or_default()
    }

    /// The patch of a body.
    pub fn patch(&self, statement: Statement) -> Option<usize> {
        self.bodies.iter().position(|b| Statement::from(*b) == statement)
    }
}
