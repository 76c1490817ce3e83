//! The picture of inf-sup constants: beta against the size of the elements of the slave side.

use super::study::Study;
use crate::coupling::inf_sup::ZERO;
use crate::io::plot::{PlotError, StudyLine, StudyPlot, study};

/// Constants that are zero are drawn at this part of the smallest that is not.
const BELOW: f64 = 0.1;

/// `study.svg` of a study with constants.
///
/// # Errors
/// [`PlotError::Empty`] where no row has one.
pub(super) fn picture(all: &Study) -> Result<String, PlotError> {
    let positive = || all.rows.iter().filter_map(|row| row.beta).filter(|beta| *beta > ZERO);
    let floor = BELOW * positive().fold(1.0, f64::min);
    let mut zero = false;
    let mut lines = Vec::new();
    for line in all.lines() {
        let first = &all.rows[line[0]];
        // the name of the pair stands in the label already where it varies
        let pairing = if first.spec.changes.pairing.is_some() { String::new() } else { format!(", {}", first.pairing) };
        let verdict = line.iter().find_map(|&k| all.rows[k].verdict.as_deref()).map_or(String::new(), |v| format!(": {v}"));
        let mut points = Vec::new();
        for row in line.iter().map(|&k| &all.rows[k]) {
            let Some(beta) = row.beta else { continue };
            zero |= beta <= ZERO;
            points.push((row.result.geometry.h, if beta > ZERO { beta } else { floor }));
        }
        if !points.is_empty() {
            lines.push(StudyLine { name: format!("{}{pairing}{verdict}", all.line(line[0])), points, rate: None });
        }
    }
    let title = if all.title.is_empty() { &all.case } else { &all.title };
    let y = if zero { "beta (zeros are drawn at the bottom)" } else { "beta" };
    study(&StudyPlot { title, x: "h of the slave side", y, lines: &lines })
}
