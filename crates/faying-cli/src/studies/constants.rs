//! Inf-sup constants in the picture: beta against the size of the elements of the slave side.

use super::picture::mark;
use super::study::Study;
use crate::plot::{StudyGroup, StudyLine, StudyPanel};
use faying::coupling::inf_sup::ZERO;

/// Zero constants are drawn at this share of the smallest positive one.
const BELOW: f64 = 0.1;

/// A line per pair and side, with its verdict.
pub(super) fn group(all: &Study) -> StudyGroup {
    let positive = || all.rows.iter().filter_map(|row| row.beta).filter(|beta| *beta > ZERO);
    let floor = BELOW * positive().fold(1.0, f64::min);
    let mut zero = false;
    let (mut lines, mut points) = (Vec::new(), Vec::new());
    for line in all.lines() {
        let first = &all.rows[line[0]];
        // the label has the name of the pair already if it varies
        let pairing = if first.spec.changes.pairing.is_some() { String::new() } else { format!(", {}", first.pairing) };
        let verdict = line.iter().find_map(|&k| all.rows[k].verdict.as_deref()).map_or(String::new(), |v| format!(": {v}"));
        let mut found = Vec::new();
        for row in line.iter().map(|&k| &all.rows[k]) {
            let Some(beta) = row.beta else { continue };
            zero |= beta <= ZERO;
            found.push((row.result.geometry.h, if beta > ZERO { beta } else { floor }));
        }
        if !found.is_empty() {
            lines.push(StudyLine { name: format!("{}{pairing}{verdict}", all.line(line[0])), mark: mark(all, line[0]), rate: None });
            points.push(found);
        }
    }
    let y = if zero { "beta (zeros are drawn at the bottom)" } else { "beta" }.to_owned();
    let panel = StudyPanel { x: "h of the slave side".into(), y, y_log: true, slopes: !zero, points, ..StudyPanel::default() };
    StudyGroup { lines, panels: vec![panel] }
}
