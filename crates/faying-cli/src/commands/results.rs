//! The folder of a command that solves something: its files in their order, its manifest, its log.

use super::case::Loaded;
use super::folder::{Folder, MANIFEST};
use super::manifest::Manifest;
use super::run::shown;
use super::timing::Clock;
use crate::Progress;
use crate::errors::{Diagnostic, Diagnostics};
use std::ffi::OsString;

/// Files that every such folder has before `result.json`.
const ALWAYS: [&str; 3] = ["case.effective.toml", "log.txt", MANIFEST];

/// Common data of the files in a folder of results.
#[derive(Debug)]
pub struct Results<'a> {
    /// "run", "compare", ...
    pub command: &'a str,
    /// The case.
    pub loaded: &'a Loaded,
    /// The folder.
    pub folder: &'a Folder,
    /// The words of the command line.
    pub words: &'a [OsString],
    /// Threads that are used.
    pub threads: usize,
    /// Seconds and log.
    pub clock: &'a Clock,
}

impl Results<'_> {
    /// Makes the folder, removes the files of an earlier command and writes the manifest; `own` are the command's own files. Returns the
    /// names of all files but `result.json`, which lists them.
    ///
    /// # Errors
    /// E091 if something cannot be written.
    pub fn open(&self, own: impl IntoIterator<Item = String>) -> Result<Vec<String>, Diagnostic> {
        self.folder.open()?;
        let names: Vec<String> = own.into_iter().chain(ALWAYS.map(str::to_owned)).collect();
        // first of all: the manifest marks the folder as ours even if a later write fails
        self.manifest(&names)?;
        Ok(names)
    }

    /// Writes the files that every folder has, after the command's own files; `result.json` last.
    ///
    /// # Errors
    /// E091 if something cannot be written.
    pub fn close(&self, names: &[String], messages: &Diagnostics, document: &str) -> Result<(), Diagnostic> {
        self.folder.write("case.effective.toml", self.loaded.case.effective_toml().as_bytes())?;
        self.clock.hear(Progress::Phase("done"));
        let log = format!("{}\n{}", self.clock.log(), messages.render());
        self.folder.write("log.txt", format!("{}\n", log.trim_end()).as_bytes())?;
        self.manifest(names)?;
        self.folder.write("result.json", document.as_bytes())
    }

    fn manifest(&self, names: &[String]) -> Result<(), Diagnostic> {
        let manifest = Manifest {
            schema: "faying.manifest/1".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: self.command.to_owned(),
            case: self.loaded.name.clone(),
            case_path: self.loaded.path.clone(),
            options: shown(self.words),
            inputs: self.loaded.inputs.clone(),
            threads: self.threads,
            seconds: self.clock.seconds(),
            files: names.iter().cloned().chain(["result.json".to_owned()]).collect(),
        };
        self.folder.write(MANIFEST, manifest.to_json().as_bytes())
    }
}
