//! Files of lines: `line_NAME.csv` and `line_NAME.svg`, of one run or of the rows of a study beside each other.

use crate::case::Units;
use crate::plot::{Axis, PlotError, StudyGroup, StudyLine, StudyPanel, StudyPlot, study};
use crate::result::LineReport;
use crate::table::{csv_field, exact};
use crate::text_format::coordinates;

/// The values of one line in several runs, each with its label; one without a label stands alone.
pub(crate) type Runs<'a> = Vec<(String, &'a LineReport)>;

/// The lines of runs by their names, in the order of the first; runs whose points differ from those of the first are left out.
pub(crate) fn by_name<'a>(runs: &[(String, &'a [LineReport])]) -> Vec<Runs<'a>> {
    let Some((_, first)) = runs.iter().find(|(_, lines)| !lines.is_empty()) else { return Vec::new() };
    let same = |a: &LineReport, b: &LineReport| a.name == b.name && a.x == b.x && a.quantities == b.quantities;
    let of = |line: &'a LineReport| {
        runs.iter().filter_map(|(label, lines)| Some((label.clone(), lines.iter().find(|other| same(line, other))?))).collect()
    };
    first.iter().map(of).collect()
}

/// The text of `line_NAME.csv`: s, x, y, z, and every field of every run; empty where a point is in no body.
pub(crate) fn csv(runs: &Runs<'_>) -> String {
    let Some((_, line)) = runs.first() else { return String::new() };
    let axes = ["x", "y", "z"].iter().take(line.x.first().map_or(0, Vec::len)).map(|a| (*a).to_owned());
    let mut head: Vec<String> = std::iter::once("s".to_owned()).chain(axes).collect();
    for (label, line) in runs {
        head.extend(line.quantities.iter().map(|q| csv_field(&if label.is_empty() { q.clone() } else { format!("{label}: {q}") })));
    }
    let mut text = head.join(",") + "\n";
    for k in 0..line.s.len() {
        let values = runs.iter().flat_map(|(_, line)| line.values.iter().map(|field| exact(field[k])));
        let cells: Vec<String> = std::iter::once(exact(line.s[k])).chain(line.x[k].iter().map(|x| exact(*x))).chain(values).collect();
        text += &(cells.join(",") + "\n");
    }
    text
}

/// `line_NAME.svg`: a panel per field.
///
/// # Errors
/// [`PlotError::Empty`] where no point has a value.
pub(crate) fn svg(title: &str, units: &Units, runs: &Runs<'_>) -> Result<String, PlotError> {
    let Some((_, line)) = runs.first() else { return Err(PlotError::Empty(title.to_owned())) };
    let start = line.x.first().map_or(String::new(), |x| coordinates(x));
    let x = format!("distance from ({start}){}", crate::plot::in_unit(&units.length));
    let panel = |(k, quantity): (usize, &String)| StudyPanel {
        x: x.clone(),
        x_axis: Axis::Linear,
        y: quantity.clone(),
        bare: true,
        points: runs.iter().map(|(_, line)| line.s.iter().copied().zip(line.values[k].iter().copied()).collect()).collect(),
        ..StudyPanel::default()
    };
    let panels = line.quantities.iter().enumerate().map(panel).collect();
    let named = |(label, line): &(String, &LineReport)| StudyLine {
        name: if label.is_empty() { line.name.clone() } else { label.clone() },
        mark: 0,
        rate: None,
    };
    let group = StudyGroup { lines: runs.iter().map(named).collect(), panels };
    let title = if title.is_empty() { line.name.clone() } else { format!("{title}: {}", line.name) };
    study(&StudyPlot { title: &title, groups: &[group] })
}
