//! `faying run`: one case from its file to its folder.

use super::arguments::{Common, RunArguments, VtuCells};
use super::case;
use super::ended::{Exit, failure, status};
use super::files::{self, OutputFile};
use super::folder::Folder;
use super::history;
use super::results::Results;
use super::run_report;
use super::streams::Streams;
use super::summary;
use super::timing::Clock;
use crate::errors::{Diagnostic, Diagnostics};
use crate::{Finished, Progress, Registry, RunControl, RunOptions, RunResult, StepOutput};
use faying_files::pvd;
use faying_files::vtu::CellStyle;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The page on a run.
const REPORT: &str = "report.html";

/// Solves a case and writes its folder, with `--watch` again at every change of its files.
pub fn run(registry: &Registry, arguments: &RunArguments, common: &Common, streams: &Streams, words: &[OsString]) -> Exit {
    let interrupted = case::interrupted();
    let once = |files: &mut Vec<PathBuf>| {
        let clock = Clock::start(streams);
        let ended = solved(registry, arguments, common, words, (&clock, &interrupted), files).unwrap_or_else(|ended| ended);
        clock.stop();
        ended
    };
    match arguments.watch {
        false => once(&mut Vec::new()),
        true => super::watch::watch(&arguments.case, streams, &interrupted, &once, &|ended| super::tell(streams, ended)),
    }
}

fn solved(
    registry: &Registry,
    arguments: &RunArguments,
    common: &Common,
    words: &[OsString],
    (clock, interrupted): (&Clock, &Arc<AtomicBool>),
    files: &mut Vec<PathBuf>,
) -> Result<Exit, Exit> {
    let hears = clock.clone();
    let watch = RunControl { listener: Some(Box::new(move |news| hears.hear(news))), ..case::watch(common, interrupted) };
    clock.note(&format!("faying {} {}", env!("CARGO_PKG_VERSION"), shown(words).join(" ")));
    clock.hear(Progress::Phase("read"));
    let path = case::out(&arguments.case, common);
    let loaded = case::load(&arguments.case, arguments.backend.as_deref(), common, registry)?;
    files.extend(loaded.case.files.iter().map(|file| file.path.clone()));
    let folder = Folder::claim(&path, &loaded.path, &loaded.inputs[0].sha256, common.force).map_err(Exit::from)?;
    let keep = arguments.save_reference.as_deref();
    keep.map_or(Ok(()), |file| super::keep::claim(file, &loaded.inputs, common.force)).map_err(Exit::from)?;
    let pool = case::pool(common)?;
    let cells = match arguments.vtu {
        Some(VtuCells::Bezier) => Some(CellStyle::Bezier),
        Some(VtuCells::Lagrange) => Some(CellStyle::Lagrange),
        Some(VtuCells::Linear) => Some(CellStyle::Linear),
        Some(VtuCells::Quadratic) => Some(CellStyle::Quadratic),
        Some(VtuCells::None) | None => None,
    };
    let threads = pool.current_num_threads();
    let results = Results { command: "run", loaded: &loaded, folder: &folder, words, threads, clock };
    let job = Job { results, vtu: arguments.vtu, pictures: !arguments.no_pictures, keep, watch: &watch };
    Ok(pool.install(|| {
        let finished = crate::run::run(&loaded.case, registry, &RunOptions { cells, keep: keep.is_some() }, &watch);
        job.write(finished)
    }))
}

/// Messages of a result on stderr: errors, then warnings.
fn messages(result: &RunResult) -> Diagnostics {
    Diagnostics { items: result.diagnostics.iter().chain(&result.warnings).cloned().collect() }
}

/// The fields of all steps: one file per step and stem, made one after the other, and a collection per stem.
struct Steps {
    outputs: Vec<StepOutput>,
    stems: Vec<String>,
}

impl Steps {
    /// The names of all files.
    fn names(&self) -> impl Iterator<Item = String> {
        let numbered = self.outputs.iter().flat_map(|s| self.stems.iter().map(|stem| files::numbered(stem, s.number)));
        let collections = self.stems.iter().filter(|_| !self.outputs.is_empty()).map(|stem| format!("{stem}.pvd"));
        numbered.chain(collections)
    }

    /// Writes all files; what cannot be drawn is a warning, and missing from its collection.
    fn write(&self, folder: &Folder, warnings: &mut Vec<Diagnostic>) -> Result<(), Diagnostic> {
        let mut written: Vec<Vec<(f64, String)>> = vec![Vec::new(); self.stems.len()];
        for step in &self.outputs {
            for (k, made) in files::vtus(&(step.make)()).enumerate() {
                let name = files::numbered(&self.stems[k], step.number);
                match made {
                    Ok(bytes) => {
                        folder.write(&name, &bytes)?;
                        written[k].push((step.t, name));
                    }
                    Err(why) => warnings.push(Diagnostic::warning("E091", format!("`{name}` was not written: {why}"))),
                }
            }
        }
        for (stem, list) in self.stems.iter().zip(&written).filter(|_| !self.outputs.is_empty()) {
            let text = pvd::collection(list.iter().map(|(t, name)| (*t, name.as_str())));
            folder.write(&format!("{stem}.pvd"), text.as_bytes())?;
        }
        Ok(())
    }
}

/// The words after the program's name.
pub(super) fn shown(words: &[OsString]) -> Vec<String> {
    words.iter().skip(1).map(|w| w.to_string_lossy().into_owned()).collect()
}

/// Data for writing the files of a run.
struct Job<'a> {
    results: Results<'a>,
    vtu: Option<VtuCells>,
    pictures: bool,
    keep: Option<&'a Path>,
    watch: &'a RunControl,
}

impl Job<'_> {
    fn write(&self, finished: Finished) -> Exit {
        let Finished { mut result, output, steps, stored } = finished;
        // refused before anything began: no folder
        if result.exit == 3 || (matches!(result.exit, 4 | 6) && output.is_none() && result.solve.is_none()) {
            return Exit::refused(result.exit, messages(&result));
        }
        self.results.clock.hear(Progress::Phase("draw"));
        let mut trouble = Diagnostics::new();
        let with_vtu = self.vtu != Some(VtuCells::None);
        let stems = output.as_ref().map(files::stems).unwrap_or_default();
        // steps have files of their own
        let alone = with_vtu && !self.results.loaded.case.has_steps();
        let drawn = output.as_ref().filter(|_| self.pictures);
        let history = drawn.and_then(|output| files::active_set(&output.title, &result, &mut trouble));
        let mut shown = output.map(|output| files::of(&output, alone, self.pictures, &mut trouble)).unwrap_or_default();
        shown.extend(history);
        let case = &self.results.loaded.case;
        shown.extend(files::lines((&case.title.value, &case.units), &[(String::new(), &result.lines)], self.pictures, &mut trouble));
        if !result.steps.is_empty() {
            shown.push(OutputFile { name: "history.csv".to_owned(), bytes: history::csv(&result).into_bytes() });
        }
        let steps = Steps { outputs: if with_vtu { steps } else { Vec::new() }, stems };
        result.warnings.extend(trouble.items);
        let kept = self.keep.zip(stored.as_ref()).map_or(Ok(()), |(file, run)| super::keep::write(file, run));
        match kept.and_then(|()| self.files(&mut result, &shown, &steps)) {
            Ok(document) => {
                let summary = summary::of(&result, Some(&self.results.folder.path().display().to_string()));
                Exit { exit: result.exit, summary, document, diagnostics: messages(&result), message: None }
            }
            Err(problem) => {
                let mut diagnostics = messages(&result);
                diagnostics.push(problem);
                // 130 and 70 come before 4
                let exit = if matches!(result.exit, 70 | 130) { result.exit } else { 4 };
                let document = failure(status(exit), exit, diagnostics.to_json());
                Exit { exit, document, diagnostics, ..Exit::default() }
            }
        }
    }

    /// Writes everything, `result.json` last; returns its text.
    fn files(&self, result: &mut RunResult, shown: &[OutputFile], steps: &Steps) -> Result<String, Diagnostic> {
        let folder = self.results.folder;
        self.results.clock.hear(Progress::Phase("write"));
        let own = shown.iter().map(|f| f.name.clone()).chain(steps.names()).chain([REPORT.to_owned()]);
        let names = self.results.open(own)?;
        result.files.clone_from(&names);
        steps.write(folder, &mut result.warnings)?;
        // drawing takes its time, too
        crate::run::end_early(result, self.watch);
        for file in shown {
            folder.write(&file.name, &file.bytes)?;
        }
        let page = run_report::html(result, self.results.loaded, shown, &messages(result), &self::shown(self.results.words));
        folder.write(REPORT, page.as_bytes())?;
        let document = result.to_json();
        self.results.close(&names, &messages(result), &document)?;
        Ok(document)
    }
}
