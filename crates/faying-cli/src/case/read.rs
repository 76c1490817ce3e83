//! Reading a case: from a file or a text to a [`Case`], or to all errors.

use super::reader::Reader;
use super::types::Case;
use super::{Changes, Names, axes, set, tree};
use crate::errors::{CaseText, Diagnostic, Diagnostics, nearest};
use crate::formula::Constants;
use crate::place::LineStarts;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Options of reading a case, beside its file.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Texts `a.b=v` of the options `--set`, in their order.
    pub sets: Vec<String>,
    /// `--backend`: replaces the backend of every patch.
    pub backend: Option<String>,
    /// Whether patches may hold keys that only other backends have: studies exchange backends.
    pub any_backend: bool,
    /// Changes by a row of a study, applied after all other options.
    pub changes: Changes,
    /// Known names of backends, couplings, multipliers and constraint solvers.
    pub names: Names,
    /// The folder that paths in the case are relative to; `None`: that of the case file, or the current one for a text.
    pub folder: Option<PathBuf>,
    /// Most bytes that reading a geometry file may take; `None`: no limit.
    pub memory: Option<u64>,
}

impl Case {
    /// Reads a case file without options.
    ///
    /// # Errors
    /// Every error that was found, located; see [`crate::codes`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Diagnostics> {
        Self::read_with(path, &ReadOptions::default())
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// E003 if there is no such file, else as [`Case::parse`].
    pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, Diagnostics> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| Diagnostics::from(not_found(path, &e)))?;
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            let start = String::from_utf8_lossy(&e.as_bytes()[..at]).into_owned();
            let source = CaseText { name: name.clone(), lines: LineStarts::new(&start), sets: Vec::new() };
            let place = source.lines.place(start.len()..start.len());
            let message = format!("the file is not valid TOML: byte {at} is not UTF-8");
            Diagnostics::from(Diagnostic::error("E005", message).with_help("save the file as UTF-8 text").at(&source, place))
        })?;
        let folder = options.folder.clone().or_else(|| path.parent().map(Path::to_owned));
        Self::parse(&name, &text, &ReadOptions { folder, ..options.clone() })
    }

    /// Reads the text of a case; `name` is its name in messages.
    ///
    /// # Errors
    /// Every error that was found, located, in the order of the file.
    pub fn parse(name: &str, text: &str, options: &ReadOptions) -> Result<Self, Diagnostics> {
        // editors of Windows put a mark in front
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = CaseText { name: name.to_owned(), lines: LineStarts::new(text), sets: options.sets.clone() };
        let mut root = tree::parse(&source)?;
        let mut reader = Reader {
            source,
            found: Diagnostics::new(),
            constants: Constants::default(),
            names: Vec::new(),
            known: options.names.clone(),
            dimension: 2,
            components: 2,
            backend: None,
            any_backend: options.any_backend,
            broken: BTreeSet::new(),
            density_broken: false,
            folder: options.folder.clone().unwrap_or_default(),
            memory: options.memory,
            files: Vec::new(),
            opened: Vec::new(),
            from_files: Vec::new(),
            families: Vec::new(),
            joints: Vec::new(),
            meetings: Vec::new(),
        };
        let constants = set::constants(&root);
        for (k, option) in options.sets.iter().enumerate() {
            if let Err(d) = set::apply(&mut root, option, k) {
                reader.found.push(*d);
            }
        }
        set::unused(&root, &constants, &options.sets).into_iter().for_each(|d| reader.found.push(d));
        if let Some(backend) = &options.backend {
            axes::apply(&mut root, &Changes { backend: Some(backend.clone()), ..Changes::default() }, &options.names);
        }
        axes::apply(&mut root, &options.changes, &options.names);
        let case = reader.case(root);
        let mut found = reader.found;
        found.sort();
        if found.has_errors() {
            return Err(found);
        }
        Ok(Self { warnings: found, source: reader.source, ..case })
    }
}

/// E003 for a file that cannot be read, with similar names in its folder.
pub fn not_found(path: &Path, error: &std::io::Error) -> Diagnostic {
    let name = path.display().to_string();
    if error.kind() != std::io::ErrorKind::NotFound {
        return Diagnostic::error("E003", format!("cannot read {name}: {error}")).in_file(name);
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    names.sort();
    let stem = wanted.trim_end_matches(".toml").to_lowercase();
    let mut similar: Vec<String> = nearest(&wanted, names.iter().map(String::as_str)).map(str::to_owned).into_iter().collect();
    for n in &names {
        let close = !stem.is_empty() && n.ends_with(".toml") && n.to_lowercase().contains(&stem);
        if close && !similar.contains(n) && similar.len() < 5 {
            similar.push(n.clone());
        }
    }
    let help = if !folder.is_dir() {
        format!("there is no folder {}", folder.display())
    } else if similar.is_empty() {
        let cases: Vec<&str> = names.iter().map(String::as_str).filter(|n| n.ends_with(".toml")).take(8).collect();
        if cases.is_empty() {
            "no case file is in that folder; `faying new --list` shows samples".to_owned()
        } else {
            format!("case files there: {}", cases.join(", "))
        }
    } else {
        format!("similar names there: {}", similar.join(", "))
    };
    Diagnostic::error("E003", format!("there is no file {name}")).in_file(name).with_help(help)
}
