//! Progress of a run: a progress line on stderr, seconds per phase, the log.

use super::manifest::PhaseSeconds;
use super::streams::Streams;
use crate::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write as _;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Listener of a run.
#[derive(Clone, Debug)]
pub struct Clock {
    state: Arc<Mutex<State>>,
}

#[derive(Debug)]
struct State {
    begun: Instant,
    phase: Option<(String, Instant)>,
    seconds: Vec<PhaseSeconds>,
    log: String,
    bar: Option<ProgressBar>,
    /// Streams for messages during the run; `None` without `--verbose`.
    verbose: Option<Streams>,
}

impl Clock {
    /// Starts the clock.
    pub fn start(streams: &Streams) -> Self {
        let bar = streams.progress.then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} ({elapsed})") {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(120));
            bar
        });
        let verbose = streams.verbose.then(|| streams.clone());
        Self {
            state: Arc::new(Mutex::new(State {
                begun: Instant::now(),
                phase: None,
                seconds: Vec::new(),
                log: String::new(),
                bar,
                verbose,
            })),
        }
    }

    fn with<R>(&self, act: impl FnOnce(&mut State) -> R) -> R {
        // the state is usable even after a panic of a listener
        act(&mut self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }

    /// Records a progress report.
    pub fn hear(&self, news: Progress<'_>) {
        self.with(|s| match news {
            Progress::Phase(name) => {
                s.end_phase();
                s.phase = Some((name.to_owned(), Instant::now()));
                s.say(name);
            }
            Progress::Step { step, of } => s.say(&format!("step {step} of {of}")),
            Progress::Note(line) => s.tell(line),
            Progress::Iteration { iteration, active, rows } => {
                s.say(&format!("active set, iteration {iteration}: {active} of {rows} rows active"))
            }
        });
    }

    /// Seconds of a phase that an earlier command went through.
    pub fn add(&self, phase: &str, seconds: f64) {
        self.with(|s| s.seconds.push(PhaseSeconds { phase: phase.to_owned(), seconds }));
    }

    /// A line for the log alone.
    pub fn note(&self, line: &str) {
        self.with(|s| s.line(line));
    }

    /// Ends the phase and the progress line.
    pub fn stop(&self) {
        self.with(|s| {
            s.end_phase();
            if let Some(bar) = s.bar.take() {
                bar.finish_and_clear();
            }
        });
    }

    /// Seconds of every phase so far.
    pub fn seconds(&self) -> Vec<PhaseSeconds> {
        self.with(|s| s.seconds.clone())
    }

    /// The text of `log.txt` so far.
    pub fn log(&self) -> String {
        self.with(|s| s.log.clone())
    }
}

impl State {
    fn line(&mut self, line: &str) {
        // writing to a String cannot fail
        let _ = writeln!(self.log, "{:9.3}  {line}", self.begun.elapsed().as_secs_f64());
    }

    fn say(&mut self, line: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(line.to_owned());
        }
        self.tell(line);
    }

    /// Writes a line to the log and, with `--verbose`, to stderr.
    fn tell(&mut self, line: &str) {
        self.line(line);
        if let Some(streams) = &self.verbose {
            let text = format!("{:9.3} s  {line}\n", self.begun.elapsed().as_secs_f64());
            match &self.bar {
                Some(bar) => bar.suspend(|| streams.message(&text)),
                None => streams.message(&text),
            }
        }
    }

    fn end_phase(&mut self) {
        if let Some((phase, begun)) = self.phase.take() {
            let seconds = begun.elapsed().as_secs_f64();
            match self.seconds.iter_mut().find(|p| p.phase == phase) {
                Some(known) => known.seconds += seconds,
                None => self.seconds.push(PhaseSeconds { phase, seconds }),
            }
        }
    }
}
