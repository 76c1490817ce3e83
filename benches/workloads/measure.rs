//! Clocks, medians, peak memory.

use cpu_time::ProcessTime;
use std::time::Instant;

/// Wall time and CPU time of the process (user + system, all threads) \[s\].
#[derive(Clone, Copy, Debug)]
pub struct Time {
    pub wall: f64,
    pub cpu: f64,
}

/// The result of `work` and its time.
pub fn timed<R>(work: impl FnOnce() -> R) -> (R, Time) {
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    let result = work();
    (result, Time { cpu: cpu.elapsed().as_secs_f64(), wall: wall.elapsed().as_secs_f64() })
}

/// Medians of wall and CPU times, each by itself.
pub fn median(times: &[Time]) -> Time {
    let middle = |pick: fn(&Time) -> f64| {
        let mut all: Vec<f64> = times.iter().map(pick).collect();
        all.sort_by(f64::total_cmp);
        0.5 * (all[(all.len() - 1) / 2] + all[all.len() / 2])
    };
    Time { wall: middle(|t| t.wall), cpu: middle(|t| t.cpu) }
}

/// The largest resident memory so far [MB]; none where the system does not tell.
pub fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kb| kb / 1024.0)
}
