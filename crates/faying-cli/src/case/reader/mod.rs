//! Typed reading of values: every getter reports errors at their place, and reading continues.

mod block;
mod entries;
mod formulas;
mod scalars;
mod sections;

pub(in crate::case) use crate::case::key::Uses;
pub(in crate::case) use block::Block;
pub(in crate::case) use scalars::{LONGEST_NAME, Sign};

use crate::case::family::{Family, FromFile};
use crate::case::files::{FileRead, Opened};
use crate::case::names::Names;
use crate::case::tree::Node;
use crate::case::types::{Joint, Meeting};
use crate::errors::{CaseText, Diagnostic, Diagnostics};
use crate::formula::Constants;
use crate::place::{Located, SourceSpan};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Errors beyond this many are not kept.
const KEPT: usize = 500;

/// State of reading a case.
#[derive(Debug)]
pub(in crate::case) struct Reader {
    pub source: CaseText,
    pub found: Diagnostics,
    pub constants: Constants,
    /// Names of blocks, which may hold `-` in formulas of checks.
    pub names: Vec<String>,
    /// Names of entries of the registry.
    pub known: Names,
    pub dimension: usize,
    pub components: usize,
    /// Backend of [discretization].
    pub backend: Option<Located<String>>,
    /// Whether patches may hold keys that only other backends have.
    pub any_backend: bool,
    /// Keys and lists with errors, such as `exact` or `patch`: references to them are not reported again.
    pub broken: BTreeSet<String>,
    /// Whether a density is given but could not be read.
    pub density_broken: bool,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// Most bytes that reading a file may take.
    pub memory: Option<u64>,
    /// Files read so far.
    pub files: Vec<FileRead>,
    /// Geometry files opened so far.
    pub opened: Vec<Opened>,
    /// One entry per patch, until patches are expanded.
    pub from_files: Vec<Option<FromFile>>,
    /// Names of all patches of a file.
    pub families: Vec<Family>,
    /// Pairs of sides with common facets of a mesh file.
    pub joints: Vec<Joint>,
    /// Points that patches of a mesh file share.
    pub meetings: Vec<Meeting>,
}

impl Reader {
    pub fn push(&mut self, at: SourceSpan, diagnostic: Diagnostic) {
        if self.found.items.len() < KEPT {
            let located = diagnostic.at(&self.source, at);
            self.found.push(located);
        }
    }

    pub fn fault(&mut self, code: &'static str, at: SourceSpan, message: impl Into<String>, help: impl Into<String>) {
        let help = help.into();
        let d = Diagnostic::error(code, message);
        self.push(at, if help.is_empty() { d } else { d.with_help(help) });
    }

    pub fn wrong_type(&mut self, node: &Node, what: &str, expected: &str, help: impl Into<String>) {
        // names of blocks are quoted already
        let what = what.trim_matches('`');
        self.fault("E014", node.at, format!("`{what}` must be {expected}, found {}", node.describe()), help);
    }
}
