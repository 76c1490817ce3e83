//! Files of lines: `line_NAME.csv` and `line_NAME.svg`, of one run or of the rows of a study beside each other.

use crate::case::Units;
use crate::plot::{Axis, PlotError, StudyGroup, StudyLine, StudyPanel, StudyPlot, study};
use crate::quantities::{Quantity, QuantityKind};
use crate::result::LineReport;
use crate::table::{csv_field, exact};
use crate::text_format::{coordinates, short};

/// The values of one line in several runs, each with its label; one without a label stands alone.
pub(crate) type Runs<'a> = Vec<(String, &'a LineReport)>;

/// The lines of runs by their names, in the order of the first; runs whose points differ from those of the first are left out. Steps of one
/// line stand beside each other, each with its time.
pub(crate) fn by_name<'a>(runs: &[(String, &'a [LineReport])]) -> Vec<Runs<'a>> {
    let Some((_, first)) = runs.iter().find(|(_, lines)| !lines.is_empty()) else { return Vec::new() };
    let same = |a: &LineReport, b: &LineReport| a.name == b.name && a.x == b.x && a.quantities == b.quantities;
    let of = |line: &'a LineReport| {
        let all = runs.iter().flat_map(|(label, lines)| lines.iter().filter(|other| same(line, other)).map(move |own| (label, own)));
        let all: Vec<(&String, &LineReport)> = all.collect();
        let with_step = |(label, own): &(&String, &'a LineReport)| {
            let t = own.t.map(|t| format!("t = {}", short(t)));
            let words = [Some((*label).clone()).filter(|label| !label.is_empty()), t].into_iter().flatten();
            (words.collect::<Vec<_>>().join(", "), *own)
        };
        all.iter().map(with_step).collect()
    };
    let is_new = |k: &usize| first[..*k].iter().all(|before| before.name != first[*k].name);
    (0..first.len()).filter(is_new).map(|k| of(&first[k])).collect()
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

/// The unit of a field in brackets: " [MPa]"; nothing where it has none or the case names none.
fn unit(quantity: &str, units: &Units) -> String {
    match Quantity::parse(quantity).map(|quantity| quantity.kind) {
        Ok(QuantityKind::Field { field, .. }) => crate::plot::in_unit(&field.unit(units)),
        _ => String::new(),
    }
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
        y: quantity.clone() + &unit(quantity, units),
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
