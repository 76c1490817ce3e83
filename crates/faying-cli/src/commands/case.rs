//! Reading the case that a command names: a file or stdin.

use super::arguments::Common;
use super::ended::Exit;
use super::manifest::Input;
use super::signals;
use crate::case::{Case, ReadOptions, not_found};
use crate::errors::Diagnostic;
use crate::run::most_threads;
use crate::{Registry, RunControl};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// A case with the data of its file.
#[derive(Debug)]
pub struct Loaded {
    /// The case.
    pub case: Case,
    /// Its name in messages and results.
    pub name: String,
    /// Its absolute path, "-" for stdin.
    pub path: String,
    /// Files that were read: the case first, then the files it names.
    pub inputs: Vec<Input>,
    /// The text of the case.
    pub text: String,
    /// Options of reading it, for reading it again.
    pub options: ReadOptions,
}

/// Longest case that is read, in bytes: thousands of times a long one.
const LONGEST: u64 = 16 << 20;

/// All bytes of a case; `None` if there are more than [`LONGEST`].
fn bounded(from: impl std::io::Read) -> std::io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    from.take(LONGEST + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= LONGEST).then_some(bytes))
}

fn too_long(name: &str) -> Exit {
    let message = format!("{name} is longer than {} MiB, the longest case that is read", LONGEST >> 20);
    Diagnostic::error("E081", message).with_help("give a case file, a TOML text of some lines").in_file(name).into()
}

/// The folder of results of the case at `path`: that of `--out`, else after the name of the file.
pub fn out(path: &Path, common: &Common) -> PathBuf {
    folder(path, common, "out")
}

/// The folder that a command writes, CASE.`end`: that of `--out`, else after the name of the file.
pub fn folder(path: &Path, common: &Common, end: &str) -> PathBuf {
    let stem = || match path.file_stem() {
        _ if path.as_os_str() == "-" => "stdin".to_owned(),
        Some(stem) => stem.to_string_lossy().into_owned(),
        None => "case".to_owned(),
    };
    common.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.{end}", stem())))
}

/// Reads the case at `path`, with the names of `registry` and the changes of the options.
pub fn load(path: &Path, backend: Option<&str>, common: &Common, registry: &Registry) -> Result<Loaded, Exit> {
    load_as(path, (backend, false), common, registry)
}

/// Reads the case of a study, whose patches may hold keys that only other backends have.
pub fn load_for_study(path: &Path, common: &Common, registry: &Registry) -> Result<Loaded, Exit> {
    load_as(path, (None, true), common, registry)
}

fn load_as(path: &Path, (backend, any_backend): (Option<&str>, bool), common: &Common, registry: &Registry) -> Result<Loaded, Exit> {
    if let Some(name) = backend {
        known_backend(registry, name, "--backend")?;
    }
    let folder = (path.as_os_str() != "-").then(|| path.parent().map(Path::to_owned)).flatten();
    let options = ReadOptions {
        sets: common.set.clone(),
        backend: backend.map(str::to_owned),
        any_backend,
        names: registry.case_names(),
        folder,
        memory: crate::run::memory_for_files(common.max_memory),
        ..ReadOptions::default()
    };
    if path.as_os_str() == "-" {
        let read = bounded(std::io::stdin().lock());
        let bytes = read.map_err(|e| Exit::from(Diagnostic::error("E003", format!("stdin cannot be read: {e}"))))?;
        let bytes = bytes.ok_or_else(|| too_long("stdin"))?;
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            let message = format!("stdin is not valid TOML: byte {} is not UTF-8", e.valid_up_to());
            Exit::from(Diagnostic::error("E005", message).in_file("stdin"))
        })?;
        let case = Case::parse("stdin", text, &options).map_err(Exit::failed)?;
        let inputs = inputs(Input::new("-", &bytes), &case);
        return Ok(Loaded { case, name: "stdin".to_owned(), path: "-".to_owned(), inputs, text: text.to_owned(), options });
    }
    let name = path.display().to_string();
    // checked before opening: opening a pipe waits for a writer; files below /dev are open already, or are bounded below
    let special = std::fs::metadata(path).is_ok_and(|known| !known.is_file() && !known.is_dir());
    if special && !path.starts_with("/dev") {
        let message = format!("cannot read {name}: it is no regular file");
        return Err(Diagnostic::error("E003", message).in_file(name).with_help("write - for a case on stdin").into());
    }
    let read = std::fs::File::open(path).and_then(bounded);
    let bytes = read.map_err(|e| Exit::from(not_found(path, &e)))?.ok_or_else(|| too_long(&name))?;
    let case = match std::str::from_utf8(&bytes) {
        Ok(text) => Case::parse(&name, text, &options),
        Err(_) => Case::read_with(path, &options), // reports where the text is not UTF-8
    };
    let case = case.map_err(Exit::failed)?;
    let absolute = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let inputs = inputs(Input::new(name.clone(), &bytes), &case);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    Ok(Loaded { case, path: absolute.display().to_string(), inputs, name, text, options })
}

/// The case and the files that it names.
fn inputs(case_file: Input, case: &Case) -> Vec<Input> {
    let others = case.files.iter().map(|f| Input { file: f.name.clone(), bytes: f.bytes, sha256: f.sha256.clone() });
    std::iter::once(case_file).chain(others).collect()
}

/// Whether the registry has the backend that an option names.
pub fn known_backend(registry: &Registry, name: &str, option: &str) -> Result<(), Exit> {
    let known = registry.volume.backends.get(name).map(|_| ());
    known.or_else(|_| registry.plane.backends.get(name).map(|_| ())).map_err(|e| super::ended::usage(&format!("{option}: {e}"), None))
}

/// A flag that requests to end set; see [`signals::listen`].
pub fn interrupted() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    signals::listen(&flag);
    flag
}

/// The limits of the options, counted from now, and the flag of [`interrupted`].
pub fn watch(common: &Common, interrupted: &Arc<AtomicBool>) -> RunControl {
    let interrupted = Arc::clone(interrupted);
    let deadline = common.time_limit.map(|seconds| (Instant::now() + Duration::from_secs_f64(seconds), seconds));
    RunControl { interrupted, deadline, max_memory: common.max_memory, listener: None }
}

/// The threads of the options, as many of them as the limits of the process leave room for.
///
/// # Errors
/// E081 if not even one can be started.
pub fn pool(common: &Common) -> Result<rayon::ThreadPool, Exit> {
    let wanted = common.threads.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let mut threads = wanted.min(most_threads());
    loop {
        match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => return Ok(pool),
            Err(_) if threads > 1 => threads /= 2,
            Err(e) => {
                let fault = Diagnostic::error("E081", format!("no thread can be started: {e}"));
                return Err(fault.with_help("raise the limits of the process on memory (ulimit -v) and processes (ulimit -u)").into());
            }
        }
    }
}
