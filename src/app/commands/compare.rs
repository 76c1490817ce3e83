//! `faying compare`: several backends on one case, in one table.

use super::arguments::{Common, CompareArguments, StudyArguments};
use super::case::{self, Loaded};
use super::clock::Clock;
use super::ended::Ended;
use super::folder::{Folder, MANIFEST};
use super::manifest::Manifest;
use super::run::shown;
use super::streams::Streams;
use crate::app::studies::{Axes, Base, Degrees, Study, Vary, html, picture, split};
use crate::app::{Progress, Registry, Watch};
use crate::io::case::StudyValues;
use crate::io::errors::{Diagnostic, Diagnostics};
use std::ffi::OsString;

/// Backends that are compared where none are named.
const BACKENDS: [&str; 2] = ["iga", "fe"];

/// Solves every row and writes the folder.
pub fn compare(registry: &Registry, arguments: &CompareArguments, common: &Common, streams: &Streams, words: &[OsString]) -> Ended {
    let clock = Clock::start(streams);
    let ended = compared(registry, arguments, common, words, &clock).unwrap_or_else(|ended| ended);
    clock.stop();
    ended
}

fn compared(registry: &Registry, arguments: &CompareArguments, common: &Common, words: &[OsString], clock: &Clock) -> Result<Ended, Ended> {
    let hears = clock.clone();
    // phases inside a row are no phases of the study: their seconds are the row's
    let listener = move |news: Progress<'_>| match news {
        Progress::Phase(name) => hears.note(&format!("  {name}")),
        other => hears.hear(other),
    };
    let watch = Watch { listener: Some(Box::new(listener)), ..case::watch(common) };
    clock.note(&format!("faying {} {}", env!("CARGO_PKG_VERSION"), shown(words).join(" ")));
    clock.hear(Progress::Phase("read"));
    let path = case::folder(&arguments.case, common, "compare");
    later(&arguments.study)?;
    let loaded = case::load(&arguments.case, None, common, registry)?;
    let values = loaded.case.studies.iter().find(|s| s.value.name == "compare").map(|s| s.value.clone()).unwrap_or_default();
    let axes = axes(registry, &arguments.study, &values)?;
    let pairs = axes.backends.iter().find(|b| b.contains('+'));
    if let (Some(pair), Some(between)) = (pairs, loaded.case.interfaces.iter().find_map(|t| t.between.as_ref())) {
        let why = format!(
            "backends \"{pair}\" beside `between`, which chooses slave and master while the bodies are built, are not in this version"
        );
        let fault = Diagnostic::error("E019", why).with_help("name slave and master, or compare single backends");
        return Err(Ended::failed(Diagnostics::from(loaded.case.diagnostic(fault, between.at))));
    }
    let wanted: Vec<String> = match arguments.quantity.is_empty() {
        true => values.quantities.clone(),
        false => arguments.quantity.iter().flat_map(|q| split(q)).filter(|q| !q.is_empty()).collect(),
    };
    let tol = arguments.tol.or(values.tol);
    let folder = Folder::claim(&path, &loaded.path, &loaded.inputs[0].sha256, common.force).map_err(Ended::from)?;
    let pool = case::pool(common)?;
    let base = Base { name: &loaded.name, text: &loaded.text, options: loaded.options.clone() };
    let study = pool.install(|| {
        Study::run("compare", &loaded.case, &base, (axes, &wanted, tol), registry, &watch, |k, of, name| {
            clock.hear(Progress::Phase(&format!("row {} of {of}: {name}", k + 1)));
        })
    });
    if let (Some(_), true) = (tol, study.rows.iter().all(|r| r.differences.is_empty()) && watch.stop().is_none()) {
        return Err(super::usage("`--tol` compares rows, and there is one row", Some("name several backends, such as --backends iga,fe")));
    }
    let job = Job { loaded: &loaded, folder: &folder, words, threads: pool.current_num_threads(), clock };
    Ok(job.write(&study))
}

/// Options of studies that this version does not have here.
fn later(study: &StudyArguments) -> Result<(), Ended> {
    let given = [
        ("--pairings", study.pairings.is_some()),
        ("--integration", study.integration.is_some()),
        ("--extra-points", study.extra_points.is_some()),
        ("--resume", study.resume),
    ];
    match given.iter().find(|(_, given)| *given) {
        Some((name, _)) => {
            let help = "studies of this version vary --backends, --degrees, --levels and --vary KEY=v1,v2, such as --vary interface.arc.multiplier=p/p,p/p-2";
            Err(super::usage(&format!("`{name}` is not in this version of `faying compare`"), Some(help)))
        }
        None => Ok(()),
    }
}

/// The axes of the command line, those of the case's `[study.compare]` where it is silent.
fn axes(registry: &Registry, study: &StudyArguments, values: &StudyValues) -> Result<Axes, Ended> {
    let wrong = |option: &str, why: String| super::usage(&format!("{option}: {why}"), None);
    let backends: Vec<String> = match &study.backends {
        Some(text) => split(text).into_iter().filter(|b| !b.is_empty()).collect(),
        None if !values.backends.is_empty() => values.backends.clone(),
        None => BACKENDS.map(str::to_owned).to_vec(),
    };
    for backend in &backends {
        let (slave, master) = backend.split_once('+').unwrap_or((backend, backend));
        for name in [slave, master] {
            case::known_backend(registry, name, "--backends")?;
        }
    }
    if let Some(twice) = backends.iter().enumerate().find_map(|(k, name)| backends[..k].contains(name).then_some(name)) {
        return Err(wrong("--backends", format!("`{twice}` is named twice")));
    }
    if backends.is_empty() {
        return Err(wrong("--backends", "no backend is named".to_owned()));
    }
    let mut degrees = Degrees::default();
    for text in if study.degrees.is_empty() { &values.degrees } else { &study.degrees } {
        degrees.add(text).map_err(|e| wrong("--degrees", e))?;
    }
    for (name, _) in &degrees.of {
        case::known_backend(registry, name, "--degrees")?;
    }
    let vary: Result<Vec<Vary>, String> =
        if study.vary.is_empty() { &values.vary } else { &study.vary }.iter().map(|t| Vary::parse(t)).collect();
    let levels = study.levels.map(usize::from).or(values.levels).unwrap_or(1);
    Ok(Axes { backends, as_written: true, degrees, levels, vary: vary.map_err(|e| wrong("--vary", e))? })
}

/// What the files of a study need to know.
struct Job<'a> {
    loaded: &'a Loaded,
    folder: &'a Folder,
    words: &'a [OsString],
    threads: usize,
    clock: &'a Clock,
}

impl Job<'_> {
    fn write(&self, study: &Study) -> Ended {
        let exit = study.exit();
        let mut diagnostics = study.diagnostics();
        // nothing was begun in any row: no folder
        if study.rows.iter().all(|row| matches!(row.result.exit, 3 | 4 | 6) && row.result.solve.is_none()) {
            return Ended::refused(exit, diagnostics);
        }
        self.clock.hear(Progress::Phase("write"));
        let svg = picture(study);
        let mut files = vec![("study.csv", study.csv()), ("report.html", html(study, svg.as_deref().ok()))];
        match svg {
            Ok(svg) => files.push(("study.svg", svg)),
            Err(why) => diagnostics.push(Diagnostic::warning("E091", format!("`study.svg` was not written: {why}"))),
        }
        let mut names: Vec<String> = files.iter().map(|(name, _)| (*name).to_owned()).collect();
        names.extend(["case.effective.toml", "log.txt", MANIFEST].map(str::to_owned));
        let document = study.to_json(&names);
        names.push("result.json".to_owned());
        if let Err(problem) = self.files(&files, &names, &document, &diagnostics) {
            diagnostics.push(problem);
            let exit = if matches!(exit, 70 | 130) { exit } else { 4 };
            return Ended::refused(exit, diagnostics);
        }
        let summary = study.summary(Some(&self.folder.path().display().to_string()));
        Ended { exit, summary, document, diagnostics, message: None }
    }

    /// Writes everything, `result.json` last.
    fn files(&self, files: &[(&str, String)], names: &[String], document: &str, diagnostics: &Diagnostics) -> Result<(), Diagnostic> {
        let folder = self.folder;
        folder.open()?;
        // first of all: whatever stops this, the folder stays known as ours
        folder.write(MANIFEST, self.manifest(names).as_bytes())?;
        for (name, text) in files {
            folder.write(name, text.as_bytes())?;
        }
        folder.write("case.effective.toml", self.loaded.case.effective_toml().as_bytes())?;
        self.clock.hear(Progress::Phase("done"));
        let log = format!("{}\n{}", self.clock.log(), diagnostics.render());
        folder.write("log.txt", format!("{}\n", log.trim_end()).as_bytes())?;
        folder.write(MANIFEST, self.manifest(names).as_bytes())?;
        folder.write("result.json", document.as_bytes())
    }

    fn manifest(&self, names: &[String]) -> String {
        let manifest = Manifest {
            schema: "faying.manifest/1".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: "compare".to_owned(),
            case: self.loaded.name.clone(),
            case_path: self.loaded.path.clone(),
            options: shown(self.words),
            inputs: self.loaded.inputs.clone(),
            threads: self.threads,
            seconds: self.clock.seconds(),
            files: names.to_vec(),
        };
        manifest.to_json()
    }
}
