//! `study.svg`: panels of lines with one legend per group of panels, slope triangles where both axes are logarithmic.

mod panel;
mod scale;
mod triangle;

use super::{BLUE_LINE, INK, PlotError, RED_LINE, Root, document, heading, shortened, stroke, taller, text, units};
use crate::table::decimals;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

pub use scale::Axis;

/// One line of a study, in every panel of its group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyLine {
    /// Name in the legend.
    pub name: String,
    /// Number of its backend among those of the study: lines of one have one mark.
    pub mark: usize,
    /// Observed rate in the size of the elements between the last two points of the first panel.
    pub rate: Option<f64>,
}

/// One panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyPanel {
    /// Name of the horizontal axis.
    pub x: String,
    /// Its scale.
    pub x_axis: Axis,
    /// Name of the vertical axis.
    pub y: String,
    /// Whether it is logarithmic.
    pub y_log: bool,
    /// Whether slopes are shown by triangles: both axes logarithmic, x the size of the elements.
    pub slopes: bool,
    /// Whether points have no marks.
    pub bare: bool,
    /// Points of every line of the group, in the order of its rows; points without a logarithm on a logarithmic axis are left out, and lines
    /// are cut where a value is no number.
    pub points: Vec<Vec<(f64, f64)>>,
}

/// Lines with a legend, and the panels that show them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyGroup {
    /// The lines.
    pub lines: Vec<StudyLine>,
    /// The panels, two beside each other.
    pub panels: Vec<StudyPanel>,
}

/// Content of the picture.
#[derive(Clone, Copy, Debug)]
pub struct StudyPlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// One below the other.
    pub groups: &'a [StudyGroup],
}

const COLORS: [RGBColor; 6] =
    [BLUE_LINE, RED_LINE, RGBColor(45, 125, 70), RGBColor(138, 82, 160), RGBColor(190, 140, 20), RGBColor(60, 140, 150)];
/// Most lines of a group that are drawn: more cannot be told apart.
pub const MOST_LINES: usize = 48;
/// Height of the legend of one line in pixels.
const LEGEND: f64 = 21.0;
/// Room of a panel for its axes: left, top, right, bottom.
const ROOM: [f64; 4] = [84.0, 30.0, 34.0, 56.0];

/// Width and height of the drawing area of a panel: one alone, or two beside each other.
fn area(alone: bool) -> [f64; 2] {
    if alone { [660.0, 400.0] } else { [400.0, 320.0] }
}

/// Columns of the legend of `lines` lines.
fn columns(lines: usize, wide: bool) -> usize {
    match (lines, wide) {
        (0..=2, _) | (0..=6, false) => 1,
        (0..=12, _) | (_, false) => 2,
        _ => 3,
    }
}

/// The picture.
///
/// # Errors
/// [`PlotError::Empty`] where there is no point.
pub fn study(plot: &StudyPlot<'_>) -> Result<String, PlotError> {
    let groups: Vec<&StudyGroup> = plot.groups.iter().filter(|g| g.panels.iter().any(|p| panel::scales(p).is_some())).collect();
    if groups.is_empty() {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let alone = groups.iter().all(|g| g.panels.len() == 1);
    let [w, h] = area(alone);
    let (across, down) = (ROOM[0] + w + ROOM[2], ROOM[1] + h + ROOM[3]);
    let width = if alone { across } else { 2.0 * across };
    let legend = |g: &StudyGroup| LEGEND * g.lines.len().min(MOST_LINES).div_ceil(columns(g.lines.len(), !alone)) as f64;
    let room = width - ROOM[0] - 20.0;
    let begin = 44.0 + taller(plot.title, room, 17.0);
    let height = begin + groups.iter().map(|g| legend(g) + 10.0 + down * g.panels.len().div_ceil(2) as f64).sum::<f64>();
    document(width, height, |root| {
        heading(root, plot.title, [ROOM[0], 16.0], room, 17.0)?;
        let mut top = begin;
        for group in &groups {
            draw_legend(root, group, top, width - ROOM[0] - ROOM[2], columns(group.lines.len(), !alone))?;
            top += legend(group) + 10.0;
            for (k, panel) in group.panels.iter().enumerate() {
                let left = across * (k % 2) as f64;
                panel::draw(root, (panel, &group.lines), [left + ROOM[0], top + ROOM[1] + down * (k / 2) as f64], [w, h])?;
            }
            top += down * group.panels.len().div_ceil(2) as f64;
        }
        Ok(())
    })
}

/// The names of the lines, column by column.
fn draw_legend(root: &Root<'_, '_>, group: &StudyGroup, top: f64, width: f64, columns: usize) -> Result<(), PlotError> {
    let count = group.lines.len().min(MOST_LINES);
    let per_column = count.div_ceil(columns).max(1);
    let wide = width / columns as f64;
    for (k, line) in group.lines.iter().take(count).enumerate() {
        let left = ROOM[0] + wide * (k / per_column) as f64;
        let middle = units(top + LEGEND * (k % per_column) as f64 + 7.0);
        trace(root, k, &[(units(left), middle), (units(left + 24.0), middle)], false)?;
        mark(root, (k, line.mark), (units(left + 12.0), middle), false)?;
        let rate = line.rate.map_or(String::new(), |r| format!(": rate {} in h", decimals(r, 2)));
        let words = shortened(&format!("{}{rate}", line.name), wide - 40.0, 12.0);
        root.draw(&Text::new(words, (units(left + 32.0), middle), text(12.0, INK, HPos::Left, VPos::Center)))?;
    }
    Ok(())
}

/// The colour of line `k`.
fn color(k: usize) -> RGBColor {
    COLORS[k % COLORS.len()]
}

/// Lengths of dashes and of the gaps between them, in pixels: lines of one colour differ in them.
const DASHES: [[f64; 2]; 4] = [[0.0, 0.0], [9.0, 4.0], [4.0, 4.0], [2.0, 3.0]];
/// Dashes of a line that lies on another one, which shows between them.
const OVER: [f64; 2] = [8.0, 8.0];

/// Draws line `k`; `over`: it lies on another one.
fn trace(root: &Root<'_, '_>, k: usize, points: &[(i32, i32)], over: bool) -> Result<(), PlotError> {
    let [dash, gap] = if over { OVER } else { DASHES[(k / COLORS.len()) % DASHES.len()] };
    let style = stroke(color(k), 2.0);
    if dash == 0.0 {
        root.draw(&PathElement::new(points.to_vec(), style))?;
    } else {
        root.draw(&DashedPathElement::new(points.to_vec(), units(dash), units(gap), style))?;
    }
    Ok(())
}

/// Draws the mark with a number in the colour of line `k`; `over`: around the one of another line.
fn mark(root: &Root<'_, '_>, (k, number): (usize, usize), at: (i32, i32), over: bool) -> Result<(), PlotError> {
    let (color, r) = (color(k), units(if over { 6.5 } else { 4.0 }));
    let diamond = vec![(at.0 - r, at.1), (at.0, at.1 - r), (at.0 + r, at.1), (at.0, at.1 + r)];
    let square = vec![(at.0 - r, at.1 - r), (at.0 + r, at.1 - r), (at.0 + r, at.1 + r), (at.0 - r, at.1 + r)];
    let corners = match number % 4 {
        0 => None,
        1 => Some(square),
        2 => Some(diamond),
        _ => Some(vec![(at.0 - r, at.1 + r), (at.0, at.1 - r), (at.0 + r, at.1 + r)]),
    };
    match (corners, over) {
        (None, false) => root.draw(&Circle::new(at, r, color.filled()))?,
        (None, true) => root.draw(&Circle::new(at, r, stroke(color, 1.6)))?,
        (Some(corners), false) => root.draw(&Polygon::new(corners, color.filled()))?,
        (Some(mut corners), true) => {
            corners.push(corners[0]);
            root.draw(&PathElement::new(corners, stroke(color, 1.6)))?;
        }
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn panel(points: Vec<Vec<(f64, f64)>>) -> StudyPanel {
        StudyPanel { x: "h".into(), y: "error".into(), y_log: true, slopes: true, points, ..StudyPanel::default() }
    }

    #[test]
    fn a_study_without_points_has_no_picture() {
        let empty = [StudyGroup::default(), StudyGroup { lines: Vec::new(), panels: vec![panel(vec![vec![(0.0, 1.0), (1.0, f64::NAN)]])] }];
        assert_eq!(study(&StudyPlot { title: "a", groups: &empty }), Err(PlotError::Empty("a".into())));
    }

    #[test]
    fn one_point_is_a_picture() {
        let lines = vec![StudyLine { name: "fe".into(), ..StudyLine::default() }];
        let group = StudyGroup { lines, panels: vec![panel(vec![vec![(100.0, 1e-3)]])] };
        let svg = study(&StudyPlot { title: "a", groups: &[group] }).unwrap();
        assert!(svg.contains("<circle") && svg.contains("fe"));
    }

    #[test]
    fn a_line_of_order_three_has_a_triangle_that_says_so() {
        let line: Vec<(f64, f64)> = (0..4).map(|k| (0.5_f64.powi(k), 0.7 * 0.125_f64.powi(k))).collect();
        let of = |slopes: bool| {
            let lines = vec![StudyLine { name: "fe".into(), rate: Some(3.0), ..StudyLine::default() }];
            let group = StudyGroup { lines, panels: vec![StudyPanel { slopes, ..panel(vec![line.clone()]) }] };
            study(&StudyPlot { title: "a", groups: &[group] }).unwrap()
        };
        let (with, without) = (of(true), of(false));
        let count = |svg: &str, word: &str| svg.matches(word).count();
        assert_eq!(count(&with, "<polyline"), count(&without, "<polyline") + 1);
        assert_eq!(count(&with, "<text"), count(&without, "<text") + 2);
        // forty lines are drawn, and told apart by colours and marks
        let lines: Vec<StudyLine> = (0..60).map(|k| StudyLine { name: format!("line {k}"), ..StudyLine::default() }).collect();
        let many = StudyGroup { lines, panels: vec![panel(vec![line.clone(); 60]), panel(vec![line; 60])] };
        let svg = study(&StudyPlot { title: "a", groups: &[many] }).unwrap();
        assert!(svg.contains("line 47") && !svg.contains("line 48"));
    }
    #[test]
    fn lines_that_coincide_are_both_seen_and_backends_have_one_mark() {
        let line: Vec<(f64, f64)> = (0..3).map(|k| (0.5_f64.powi(k), 0.25_f64.powi(k))).collect();
        let other: Vec<(f64, f64)> = line.iter().map(|p| (p.0, 3.0 * p.1)).collect();
        let drawn = |points: Vec<Vec<(f64, f64)>>, marks: &[usize]| {
            let line = |mark: &usize| StudyLine { name: format!("line of {mark}"), mark: *mark, rate: None };
            let panels = vec![StudyPanel { slopes: false, ..panel(points) }];
            study(&StudyPlot { title: "a", groups: &[StudyGroup { lines: marks.iter().map(line).collect(), panels }] }).unwrap()
        };
        let count = |svg: &str, word: &str| svg.matches(word).count();
        // three points and the legend
        let alone = drawn(vec![line.clone()], &[0]);
        assert_eq!((count(&alone, "<circle"), count(&alone, "<polygon")), (4, 0));
        let two = drawn(vec![line.clone(), other.clone()], &[0, 1]);
        assert_eq!((count(&two, "<circle"), count(&two, "<polygon")), (4, 4));
        let same = drawn(vec![line.clone(), other], &[0, 0]);
        assert_eq!((count(&same, "<circle"), count(&same, "<polygon")), (8, 0));
        // the line on the other one is in dashes, many lines in place of one, its marks are rings
        let over = drawn(vec![line.clone(), line], &[0, 0]);
        let red = |svg: &str| svg.lines().filter(|l| l.starts_with("<polyline") && l.contains("#C94C33")).count();
        let rings = |svg: &str| svg.lines().filter(|l| l.starts_with("<circle") && l.contains("fill=\"none\"")).count();
        assert_eq!((red(&same), rings(&same)), (2, 0));
        assert!(red(&over) > 10 && rings(&over) == 3, "{} {}", red(&over), rings(&over));
    }
}
