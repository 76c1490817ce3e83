//! Every command on studies: its axes, its rows, its folder.

use super::arguments::{Common, StudyCommand};
use super::case;
use super::ended::Exit;
use super::folder::Folder;
use super::results::Results;
use super::run::shown;
use super::streams::Streams;
use super::study_axes;
use super::timing::Clock;
use crate::case::StudyValues;
use crate::errors::{Diagnostic, Diagnostics};
use crate::plot::PlotError;
use crate::studies::{Base, MOST_ROWS, Method, StoredRows, Study, StudyPlan, html, picture, split};
use crate::{Progress, Registry, RunControl};
use std::ffi::OsString;

/// Kind of a study: its command, default axes and requirements.
#[derive(Clone, Copy, Debug)]
pub struct StudyKind {
    /// Name of the command.
    pub command: &'static str,
    /// Backends; empty: as written.
    pub backends: &'static [&'static str],
    /// Number of levels.
    pub levels: usize,
    /// Integrations of interfaces; empty: as written.
    pub integrations: &'static [&'static str],
    /// Extra Gauss points per segment; empty: as written.
    pub extra_points: &'static [usize],
    /// Whether the case must have an interface or a contact (E063).
    pub needs_interface: bool,
    /// Whether a key must vary.
    pub needs_vary: bool,
    /// Whether rows are compared with the first one.
    pub compares: bool,
}

const PLAIN: StudyKind = StudyKind {
    command: "",
    backends: &[],
    levels: 1,
    integrations: &[],
    extra_points: &[],
    needs_interface: false,
    needs_vary: false,
    compares: false,
};

/// `faying compare`.
pub const COMPARE: StudyKind = StudyKind { command: "compare", backends: &["iga", "fe"], compares: true, ..PLAIN };
/// `faying convergence`.
pub const CONVERGENCE: StudyKind = StudyKind { command: "convergence", levels: 5, ..PLAIN };
/// `faying quadrature`.
pub const QUADRATURE: StudyKind = StudyKind {
    command: "quadrature",
    levels: 3,
    integrations: &["merged", "slave", "mixed"],
    extra_points: &[0, 1, 2, 4, 8],
    needs_interface: true,
    ..PLAIN
};
/// `faying infsup`.
pub const INFSUP: StudyKind = StudyKind { command: "infsup", levels: 5, needs_interface: true, ..PLAIN };
/// `faying sweep`.
pub const SWEEP: StudyKind = StudyKind { command: "sweep", needs_vary: true, ..PLAIN };

/// Arguments of a command on studies.
#[derive(Clone, Copy, Debug)]
pub struct Order<'a> {
    /// The registry of names.
    pub registry: &'a Registry,
    /// The case and the axes.
    pub command: &'a StudyCommand,
    /// Largest relative difference from the first row.
    pub tol: Option<f64>,
    /// Options of every command.
    pub common: &'a Common,
    /// Output streams.
    pub streams: &'a Streams,
    /// The words of the command line.
    pub words: &'a [OsString],
}

/// Makes the method of a study from the case's own table of it.
pub type MakeMethod<'a> = dyn Fn(Option<&StudyValues>) -> Box<dyn Method + Sync + 'a> + 'a;

/// Solves every row by the method that `make` makes and writes the folder.
pub fn study<'a>(kind: &StudyKind, make: &MakeMethod<'a>, order: &Order<'_>) -> Exit {
    let clock = Clock::start(order.streams);
    let ended = studied(kind, make, order, &clock).unwrap_or_else(|ended| ended);
    clock.stop();
    ended
}

fn studied<'a>(kind: &StudyKind, make: &MakeMethod<'a>, order: &Order<'_>, clock: &Clock) -> Result<Exit, Exit> {
    let hears = clock.clone();
    // phases inside a row are no phases of the study: their seconds are the row's
    let listener = move |news: Progress<'_>| match news {
        Progress::Phase(name) => hears.note(&format!("  {name}")),
        other => hears.hear(other),
    };
    let (arguments, common) = (order.command, order.common);
    let watch = RunControl { listener: Some(Box::new(listener)), ..case::watch(common, &case::interrupted()) };
    clock.note(&format!("faying {} {}", env!("CARGO_PKG_VERSION"), shown(order.words).join(" ")));
    clock.hear(Progress::Phase("read"));
    let path = case::folder(&arguments.case, common, kind.command);
    let loaded = case::load_for_study(&arguments.case, common, order.registry)?;
    let values = loaded.case.studies.iter().find(|s| s.value.name == kind.command);
    let axes = study_axes::axes(kind, &arguments.axes, values, &loaded)?;
    let values = values.map(|v| &v.value);
    let made = make(values);
    let method = &*made;
    let quantities: Vec<String> = match arguments.quantity.is_empty() {
        true => values.map_or(Vec::new(), |v| v.quantities.clone()),
        false => arguments.quantity.iter().flat_map(|q| split(q)).filter(|q| !q.is_empty()).collect(),
    };
    let tol = order.tol.or(values.and_then(|v| v.tol)).filter(|_| kind.compares);
    let folder = Folder::claim(&path, &loaded.path, &loaded.inputs[0].sha256, common.force).map_err(Exit::from)?;
    let kept = arguments.axes.resume.then(|| earlier(&folder));
    let plan = StudyPlan {
        command: kind.command,
        written: &loaded.case,
        base: Base { name: &loaded.name, text: &loaded.text, options: loaded.options.clone() },
        registry: order.registry,
        axes,
        quantities: &quantities,
        compares: kind.compares,
        tol,
        kept: kept.as_ref(),
    };
    let specs = plan.rows().map_err(|n| {
        let many = if n == usize::MAX { "more rows than can be counted".to_owned() } else { format!("at least {n} rows") };
        super::ended::usage(
            &format!("the axes span {many}, a study has at most {MOST_ROWS}"),
            Some("name fewer values, or make several studies"),
        )
    })?;
    let pool = case::pool(common)?;
    let study = pool.install(|| {
        plan.solve(&specs, method, &watch, |k, of, name| {
            clock.hear(Progress::Phase(&format!("row {} of {of}: {name}", k + 1)));
        })
    });
    for (k, row) in study.rows.iter().enumerate().filter(|(_, row)| row.kept) {
        clock.add(&format!("row of an earlier study: {}", study.label(k)), row.seconds);
    }
    if let (Some(_), true) = (tol, study.rows.iter().all(|r| r.differences.is_empty()) && watch.stop().is_none()) {
        return Err(super::ended::usage(
            "`--tol` compares rows, and there is one row",
            Some("name several backends, such as --backends iga,fe"),
        ));
    }
    let results =
        Results { command: kind.command, loaded: &loaded, folder: &folder, words: order.words, threads: pool.current_num_threads(), clock };
    Ok(written(&results, &study, kept.as_ref()))
}

/// The file that `--resume` reads.
const ROWS: &str = "rows.json";

/// Rows of the study that wrote the folder; empty if their file is missing or cannot be read.
fn earlier(folder: &Folder) -> StoredRows {
    std::fs::read_to_string(folder.path().join(ROWS)).ok().and_then(|text| StoredRows::read(&text)).unwrap_or_default()
}

/// Writes the folder of a study, unless nothing was begun.
fn written(results: &Results<'_>, study: &Study, kept: Option<&StoredRows>) -> Exit {
    let exit = study.exit();
    let mut diagnostics = study.diagnostics();
    // nothing was begun in any row: no folder
    if study.rows.iter().all(|row| matches!(row.result.exit, 3 | 4 | 6) && row.result.solve.is_none() && !row.kept) {
        return Exit::refused(exit, diagnostics);
    }
    let clock = results.clock;
    clock.hear(Progress::Phase("write"));
    let svg = picture(study);
    let mut files = vec![
        ("study.csv".to_owned(), study.csv()),
        (ROWS.to_owned(), study.stored.clone()),
        ("report.html".to_owned(), html(study, svg.as_deref().ok(), &shown(results.words))),
    ];
    let rows = study.rows.iter().enumerate().filter(|(_, row)| row.solved());
    let lines: Vec<_> = rows.map(|(k, row)| (study.label(k), row.result.lines.as_slice())).collect();
    let case = &results.loaded.case;
    for file in super::files::lines((&case.title.value, &case.units), &lines, true, &mut diagnostics) {
        files.push((file.name, String::from_utf8_lossy(&file.bytes).into_owned()));
    }
    match svg {
        Ok(svg) => files.push(("study.svg".to_owned(), svg)),
        // one row, or none with numbers: the table says it all
        Err(PlotError::Empty(_)) => {}
        Err(why) => diagnostics.push(Diagnostic::warning("E091", format!("`study.svg` was not written: {why}"))),
    }
    match write(results, study, &files, &diagnostics) {
        Ok(document) => {
            let mut summary = study.summary(Some(&results.folder.path().display().to_string()));
            if let Some(kept) = kept {
                summary.push_str(&resumed(study, kept));
            }
            Exit { exit, summary, document, diagnostics, message: None }
        }
        Err(problem) => {
            diagnostics.push(problem);
            let exit = if matches!(exit, 70 | 130) { exit } else { 4 };
            Exit::refused(exit, diagnostics)
        }
    }
}

/// Writes everything, `result.json` last; returns its text.
fn write(results: &Results<'_>, study: &Study, files: &[(String, String)], messages: &Diagnostics) -> Result<String, Diagnostic> {
    let names = results.open(files.iter().map(|(name, _)| name.clone()))?;
    for (name, text) in files {
        results.folder.write(name, text.as_bytes())?;
    }
    let document = study.to_json(&names);
    results.close(&names, messages, &document)?;
    Ok(document)
}

/// Sentence on the rows of the earlier study: kept, solved now, not used.
fn resumed(study: &Study, kept: &StoredRows) -> String {
    let taken = study.rows.iter().filter(|row| row.kept).count();
    let solved = study.rows.len() - taken;
    let others = match kept.len() - taken.min(kept.len()) {
        0 => String::new(),
        1 => "; 1 of them is of another case, option or place on the axes, or was not finished".to_owned(),
        n => format!("; {n} of them are of another case, option or place on the axes, or were not finished"),
    };
    format!("{taken} rows kept of the {} of the earlier study, {solved} solved now{others}\n", kept.len())
}
