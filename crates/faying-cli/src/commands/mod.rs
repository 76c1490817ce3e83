//! The command line: parses the arguments, runs a command, writes its summary and document, returns the exit code.

// the error that ends the program is moved once or twice
#![allow(clippy::result_large_err)]

mod arguments;
mod case;
mod check;
mod convert;
mod ended;
mod explain;
mod files;
mod folder;
mod geometries;
mod history;
mod inspect;
mod keep;
mod later;
mod manifest;
mod new;
mod panics;
mod place;
mod results;
mod run;
mod run_report;
mod schema;
mod signals;
mod streams;
mod study;
mod study_axes;
mod summary;
mod timing;
mod watch;
mod written;

use self::arguments::{Arguments, Command, EndsChoice, NormChoice};
use self::ended::{Exit, plain_failure};
use self::streams::Streams;
use self::study::Order;
use crate::Registry;
use crate::case::StudyValues;
use crate::errors::Diagnostic;
use crate::infsup::{Constants, InfSupOptions};
use crate::studies::{Method, Runs};
use clap::error::ErrorKind;
use clap::{Parser, ValueEnum};
use faying::coupling::inf_sup::Norm;
use faying::problem::SlaveEnds;
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// The whole command line of `faying` with the names of `registry`: parses the arguments of the process, runs the command, returns
/// the exit code. A program with names of its own is
///
/// ```no_run
/// let mut registry = faying_cli::Registry::default();
/// // registry.plane.backends.add("mine", ..);
/// let code: std::process::ExitCode = faying_cli::main(registry);
/// ```
pub fn main(registry: Registry) -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    ExitCode::from(u8::try_from(exit_of(&registry, &words)).unwrap_or(70))
}

fn exit_of(registry: &Registry, words: &[OsString]) -> i32 {
    match Arguments::try_parse_from(words) {
        Ok(arguments) => obey(registry, &arguments, words),
        Err(error) => refused(&error, words),
    }
}

fn obey(registry: &Registry, arguments: &Arguments, words: &[OsString]) -> i32 {
    let mut streams = Streams::new(&arguments.common);
    streams.json = streams.json.or_else(|| json_asked(words));
    let ended = panics::caught(&streams, || match place_of_document(arguments, &streams, words) {
        Err(ended) => ended,
        Ok(()) => command(registry, arguments, &streams, words),
    });
    tell(&streams, &ended)
}

/// Checks that the document can be written, before anything else is done.
fn place_of_document(arguments: &Arguments, streams: &Streams, words: &[OsString]) -> Result<(), Exit> {
    let file = streams.json.as_deref();
    if let Some(study) = arguments.command.study() {
        place::beside_results(file, &case::folder(&study.case, &arguments.common, arguments.command.name()))?;
    }
    match &arguments.command {
        Command::Run(run) => place::beside_results(file, &case::out(&run.case, &arguments.common))?,
        Command::Check(check) => place::beside_results(file, &case::out(&check.case, &arguments.common))?,
        Command::New(new) => place::not_over(file, &new::file(new, &arguments.common))?,
        Command::Inspect(inspect) => inspect::check_place(inspect, file)?,
        Command::Convert(convert) => convert::check_place(convert, &arguments.common, file)?,
        _ => {}
    }
    place::document(file, words)
}

fn command(registry: &Registry, arguments: &Arguments, streams: &Streams, words: &[OsString]) -> Exit {
    let common = &arguments.common;
    let order = |command, tol| Order { registry, command, tol, common, streams, words };
    let runs = |_: Option<&StudyValues>| -> Box<dyn Method + Sync + '_> { Box::new(Runs { registry }) };
    match &arguments.command {
        Command::Run(run) if run.dry => check::dry(registry, run, common, streams),
        Command::Run(run) => run::run(registry, run, common, streams, words),
        Command::Check(check) => check::check(registry, check, &arguments.common, streams),
        Command::New(new) => new::new(new, &arguments.common),
        Command::Compare(compare) => study::study(&study::COMPARE, &runs, &order(&compare.study, compare.tol)),
        Command::Convergence(command) => study::study(&study::CONVERGENCE, &runs, &order(command, None)),
        Command::Quadrature(command) => study::study(&study::QUADRATURE, &runs, &order(command, None)),
        Command::Sweep(command) => study::study(&study::SWEEP, &runs, &order(command, None)),
        Command::Schema(schema) => schema::schema(registry, schema),
        Command::Completions(shell) => written::completions(shell),
        Command::Man => written::man(),
        Command::Explain(code) => explain::explain(code, &registry.case_names()),
        Command::Inspect(inspect) => inspect::inspect(registry, inspect, &arguments.common),
        Command::Convert(convert) => convert::convert(registry, convert, &arguments.common),
        Command::Infsup(command) => {
            let method = |values: Option<&StudyValues>| -> Box<dyn Method + Sync + '_> {
                let word = |of: fn(&StudyValues) -> &Option<String>| values.and_then(|v| of(v).as_deref());
                let norm = command.norm.or_else(|| NormChoice::from_str(word(|v| &v.norm)?, false).ok());
                let ends = command.ends.or_else(|| EndsChoice::from_str(word(|v| &v.ends)?, false).ok());
                let norm = if norm == Some(NormChoice::HHalf) { Norm::HHalf } else { Norm::L2 };
                let ends = match ends.unwrap_or_default() {
                    EndsChoice::Case => SlaveEnds::Stated,
                    EndsChoice::Zero => SlaveEnds::Zero,
                    EndsChoice::Free => SlaveEnds::Free,
                };
                Box::new(Constants { registry, options: InfSupOptions { norm, ends } })
            };
            study::study(&study::INFSUP, &method, &order(&command.study, None))
        }
    }
}

/// Writes the messages, summary and document of a command; returns its exit code, 4 if a stream cannot be written.
fn tell(streams: &Streams, ended: &Exit) -> i32 {
    streams.diagnostics(&ended.diagnostics);
    if let Some((message, help)) = &ended.message {
        let help = help.as_ref().map_or(String::new(), |h| format!("  = help: {h}\n"));
        streams.message(&format!("error: {message}\n{help}"));
    }
    let said = streams.summary(&ended.summary).and_then(|()| streams.document(&ended.document));
    match said {
        Ok(()) => ended.exit,
        Err(e) => {
            streams.message(&Diagnostic::error("E091", format!("writing the answer failed: {e}")).render());
            if matches!(ended.exit, 70 | 130) { ended.exit } else { 4 }
        }
    }
}

/// Help and version go to stdout; invalid arguments are exit 2, with a document if one is requested.
fn refused(error: &clap::Error, words: &[OsString]) -> i32 {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let _ = error.print(); // a closed pipe is no error
        return 0;
    }
    let message = match later::of(error, words) {
        Some(message) => {
            // a failure of stderr cannot be reported anywhere
            let _ = writeln!(std::io::stderr(), "error: {message}\n  = help: `faying --help` lists what is");
            message
        }
        None => {
            let _ = error.print();
            let text = error.render().to_string();
            // clap's first paragraph: what is wrong, and the words that are missing
            let paragraph: Vec<&str> = text.lines().take_while(|line| !line.trim().is_empty()).map(str::trim).collect();
            paragraph.join(" ").trim_start_matches("error: ").to_owned()
        }
    };
    let document = plain_failure("invalid", 2, &message, Some("faying --help"));
    let _ = match json_asked(words).filter(|file| place::document(Some(file), words).is_ok()) {
        None => Ok(()),
        Some(file) if file.as_os_str() == "-" => streams::to_stdout(&document),
        Some(file) => folder::write_whole(&file, document.as_bytes()),
    };
    2
}

/// The file of `--json`, found in arguments that could not be parsed.
fn json_asked(words: &[OsString]) -> Option<PathBuf> {
    words.iter().take_while(|w| *w != "--").find_map(|w| match w.to_str()? {
        "--json" => Some(PathBuf::from("-")),
        word => word.strip_prefix("--json=").map(PathBuf::from),
    })
}
