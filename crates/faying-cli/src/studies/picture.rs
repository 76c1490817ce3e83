//! The picture of a study: choice of its lines and panels.

use super::constants;
use super::quantities::Asked;
use super::rows::{Row, Spec, points_more};
use super::study::Study;
use crate::plot::{Axis, MOST_LINES, PlotError, StudyGroup, StudyLine, StudyPanel, StudyPlot, study};

/// Relative differences below this are drawn on it: round-off.
const FLOOR: f64 = 1e-17;
/// Most errors or quantities that a group shows.
const MOST_PANELS: usize = 6;
/// Values further apart than this factor are shown on a logarithmic axis.
const WIDE: f64 = 30.0;

/// Rows that make one line, by its name.
pub(super) type NamedLine = (String, Vec<usize>);

/// `study.svg`.
///
/// # Errors
/// [`PlotError::Empty`] where no row has a number.
pub fn picture(s: &Study) -> Result<String, PlotError> {
    let mut groups = if s.rows.iter().any(|row| row.beta.is_some()) {
        vec![constants::group(s)]
    } else if s.command == "quadrature" {
        let finest = vec![over_points(s)];
        if s.axes.levels > 1 { finest.into_iter().chain([over_levels(s)]).collect() } else { finest }
    } else if s.axes.levels > 1 {
        vec![over_levels(s)]
    } else if s.command == "sweep" {
        vec![over_values(s)]
    } else {
        vec![over_unknowns(s)]
    };
    let hidden = groups.iter().map(|g| g.lines.len().saturating_sub(MOST_LINES)).max().unwrap_or(0);
    let title = if s.title.is_empty() { &s.case } else { &s.title };
    let title = if hidden > 0 { format!("{title} (first {MOST_LINES} lines, {hidden} more in the table)") } else { title.clone() };
    for group in &mut groups {
        group.panels.truncate(MOST_PANELS);
    }
    study(&StudyPlot { title: &title, groups: &groups })
}

/// Rows by the name of their line, in the order in which the names appear.
pub(super) fn grouped(s: &Study, rows: impl Iterator<Item = usize>, name: impl Fn(&Row) -> String) -> Vec<NamedLine> {
    let mut lines: Vec<NamedLine> = Vec::new();
    let mut places = std::collections::BTreeMap::new();
    for k in rows {
        let name = name(&s.rows[k]);
        let at = *places.entry(name.clone()).or_insert(lines.len());
        if at == lines.len() {
            lines.push((name, Vec::new()));
        }
        lines[at].1.push(k);
    }
    lines
}

/// The rows of the finest level.
pub(super) fn finest(s: &Study) -> impl Iterator<Item = usize> + '_ {
    (0..s.rows.len()).filter(|k| s.rows[*k].spec.level + 1 == s.axes.levels.max(1))
}

/// Rows that differ in the points of interfaces alone.
pub(super) fn lines_over_points(s: &Study) -> Vec<NamedLine> {
    grouped(s, finest(s), |row| {
        let mut spec = row.spec.clone();
        spec.changes.extra_points = None;
        spec.label(&row.degree)
    })
}

/// Rows that differ in the value of the first key alone.
pub(super) fn lines_over_values(s: &Study) -> Vec<NamedLine> {
    grouped(s, finest(s), |row| {
        let vary = row.spec.vary.iter().skip(1).cloned().collect();
        // the first key may be the degree
        let degree = if row.spec.changes.degree.is_some() { row.degree.as_str() } else { "" };
        Spec { vary, ..row.spec.clone() }.label(degree)
    })
}

/// Errors of the table, the main one first.
pub(super) fn errors_in_order(s: &Study) -> Vec<String> {
    let mut errors = s.shown_errors();
    if let Some(at) = s.main_error().and_then(|main| errors.iter().position(|e| *e == main)) {
        errors[..=at].rotate_right(1);
    }
    errors
}

/// Compared quantities that are not in `errors`.
pub(super) fn others<'a>(s: &'a Study, errors: &[String]) -> Vec<&'a Asked> {
    s.asked.iter().filter(|a| a.compared && !errors.contains(&a.quantity)).collect()
}

/// Points of lines: x and y of their rows, rows without numbers left out.
fn points(s: &Study, lines: &[NamedLine], x: &dyn Fn(&Row) -> f64, y: &dyn Fn(usize) -> f64) -> Vec<Vec<(f64, f64)>> {
    let point = |k: &usize| (x(&s.rows[*k]), y(*k));
    lines.iter().map(|(_, rows)| rows.iter().map(point).filter(|p| p.0.is_finite() && p.1.is_finite()).collect()).collect()
}

/// The value of an error in row `k`.
fn error<'a>(s: &'a Study, name: &'a str) -> impl Fn(usize) -> f64 + 'a {
    move |k| s.rows[k].result.errors.get(name).copied().filter(|_| s.rows[k].solved()).unwrap_or(f64::NAN)
}

fn h(row: &Row) -> f64 {
    row.result.geometry.h
}

fn unknowns(row: &Row) -> f64 {
    row.unknowns() as f64
}

/// The number of a row's backend among those of the study.
pub(super) fn mark(s: &Study, row: usize) -> usize {
    let mut known: Vec<&str> = Vec::new();
    for name in s.rows.iter().map(|row| row.spec.name()) {
        if !known.contains(&name) {
            known.push(name);
        }
    }
    known.iter().position(|name| *name == s.rows[row].spec.name()).unwrap_or(0)
}

fn group(s: &Study, lines: Vec<NamedLine>, panels: Vec<StudyPanel>) -> StudyGroup {
    let line = |(name, rows): (String, Vec<usize>)| StudyLine { name, mark: rows.first().map_or(0, |row| mark(s, *row)), rate: None };
    StudyGroup { lines: lines.into_iter().map(line).collect(), panels }
}

/// Whether values are positive and further apart than a linear axis shows.
fn spans_decades(points: &[Vec<(f64, f64)>]) -> bool {
    let (least, most) = points.iter().flatten().fold((f64::INFINITY, 0.0_f64), |(a, b), p| (a.min(p.1), b.max(p.1)));
    least > 0.0 && most / least > WIDE
}

/// Errors against the size of the elements and the number of unknowns; without an exact solution changes from level to level.
fn over_levels(s: &Study) -> StudyGroup {
    let lines: Vec<NamedLine> = s.lines().into_iter().map(|rows| (s.line(rows[0]), rows)).collect();
    let over_h = |y: String, value: &dyn Fn(usize) -> f64| {
        let points = points(s, &lines, &h, value);
        StudyPanel { x: "h, largest diameter of an element".into(), y, y_log: true, slopes: true, points, ..StudyPanel::default() }
    };
    let errors = errors_in_order(s);
    let mut panels = Vec::new();
    for name in errors.iter().take(MOST_PANELS - 1) {
        panels.push(over_h(name.clone(), &error(s, name)));
    }
    if let Some(name) = errors.first() {
        let points = points(s, &lines, &unknowns, &error(s, name));
        panels.push(StudyPanel { x: "unknowns".into(), y: name.clone(), y_log: true, points, ..StudyPanel::default() });
    }
    if errors.is_empty() {
        for a in others(s, &errors) {
            // rows of one line stand one after the other
            let change = |k: usize| match k.checked_sub(1).filter(|j| s.rows[*j].spec.same_line(&s.rows[k].spec)) {
                Some(before) => (a.value(&s.rows[k]) - a.value(&s.rows[before])).abs(),
                None => f64::NAN,
            };
            panels.push(over_h(format!("change of {} from the level before", a.name), &change));
        }
    }
    let rate = |rows: &[usize]| {
        let name = errors.first()?;
        rows.iter().rev().find_map(|k| s.rows[*k].rates.get(name)).copied()
    };
    let named = lines.iter().map(|(name, rows)| StudyLine { name: name.clone(), mark: mark(s, rows[0]), rate: rate(rows) }).collect();
    StudyGroup { lines: named, panels }
}

/// Errors on the finest level against the points of interfaces beyond the default.
fn over_points(s: &Study) -> StudyGroup {
    let lines = lines_over_points(s);
    let more = |row: &Row| row.spec.changes.extra_points.map_or(f64::NAN, |n| n as f64);
    let errors = errors_in_order(s);
    let level = if s.axes.levels > 1 { format!(" on level {}", s.axes.levels - 1) } else { String::new() };
    let panel = |name: &String, value: &dyn Fn(usize) -> f64, is_error: bool| {
        let points = points(s, &lines, &more, value);
        let y_log = is_error || spans_decades(&points);
        let (x, y) = ("points beyond the default".into(), format!("{name}{level}"));
        StudyPanel { x, x_axis: Axis::Linear, y, y_log, points, ..StudyPanel::default() }
    };
    let mut panels: Vec<StudyPanel> = errors.iter().map(|name| panel(name, &error(s, name), true)).collect();
    if errors.is_empty() {
        panels = others(s, &errors).into_iter().map(|a| panel(&a.name, &|k| a.value(&s.rows[k]), false)).collect();
    }
    group(s, lines, panels)
}

/// Errors and quantities against the values of the first key.
fn over_values(s: &Study) -> StudyGroup {
    let lines = lines_over_values(s);
    let Some(vary) = s.axes.vary.first() else { return StudyGroup::default() };
    let numbers: Option<Vec<f64>> = vary.values.iter().map(|v| v.parse::<f64>().ok().filter(|v| v.is_finite())).collect();
    let place = |row: &Row| vary.values.iter().position(|v| row.spec.vary.first().is_some_and(|(_, value)| value == v));
    let (x_axis, numbers) = match numbers {
        Some(n) => {
            let (least, most) = n.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
            (if least > 0.0 && most / least > WIDE { Axis::Log } else { Axis::Linear }, n)
        }
        None => (Axis::Places(vary.values.clone()), (0..vary.values.len()).map(|k| k as f64).collect()),
    };
    let x = |row: &Row| place(row).map_or(f64::NAN, |k| numbers[k]);
    let panel = |name: &str, value: &dyn Fn(usize) -> f64, is_error: bool| {
        let points = points(s, &lines, &x, value);
        let y_log = is_error || spans_decades(&points);
        StudyPanel { x: vary.key.clone(), x_axis: x_axis.clone(), y: name.to_owned(), y_log, points, ..StudyPanel::default() }
    };
    let errors = errors_in_order(s);
    let mut panels: Vec<StudyPanel> = errors.iter().map(|name| panel(name, &error(s, name), true)).collect();
    panels.extend(others(s, &errors).into_iter().map(|a| panel(&a.name, &|k| a.value(&s.rows[k]), false)));
    group(s, lines, panels)
}

/// An error, or the largest relative difference from the first row, against unknowns.
fn over_unknowns(s: &Study) -> StudyGroup {
    let lines: Vec<NamedLine> = s.lines().into_iter().map(|rows| (s.line(rows[0]), rows)).collect();
    let largest = |k: usize| {
        let all = s.rows[k].differences.iter().map(|(_, d)| *d);
        all.reduce(|a, b| if b.is_nan() { b } else { a.max(b) }).map_or(f64::NAN, |d| d.max(FLOOR))
    };
    let main = s.main_error();
    let (y, points) = match &main {
        Some(name) => (name.clone(), points(s, &lines, &unknowns, &error(s, name))),
        None => ("largest relative difference from the first row".to_owned(), points(s, &lines, &unknowns, &largest)),
    };
    group(s, lines, vec![StudyPanel { x: "unknowns".into(), y, y_log: true, points, ..StudyPanel::default() }])
}

/// Words for the additional points of a row: "0 points more".
pub(super) fn points_of(row: &Row) -> String {
    row.spec.changes.extra_points.map_or(String::new(), points_more)
}
