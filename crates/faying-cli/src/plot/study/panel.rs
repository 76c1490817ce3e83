//! One panel of a study: axes, grid, lines with their marks, slope triangles.

use super::scale::{Axis, Scale};
use super::triangle::{Triangle, triangles};
use super::{MOST_LINES, StudyLine, StudyPanel, mark, trace};
use crate::plot::{GREY, INK, PALE, PlotError, Root, shortened, stroke, text, units};
use crate::table::short;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// The vertical axis of a panel.
fn vertical(panel: &StudyPanel) -> &'static Axis {
    if panel.y_log { &Axis::Log } else { &Axis::Linear }
}

/// Whether a point has a place.
fn is_drawn(panel: &StudyPanel, p: &(f64, f64)) -> bool {
    Scale::knows(&panel.x_axis, p.0) && Scale::knows(vertical(panel), p.1)
}

/// The points of every line that is drawn.
fn lines(panel: &StudyPanel) -> impl Iterator<Item = Vec<(f64, f64)>> {
    panel.points.iter().take(MOST_LINES).map(move |line| line.iter().copied().filter(|p| is_drawn(panel, p)).collect())
}

/// Both axes; `None` without points.
pub fn scales(panel: &StudyPanel) -> Option<(Scale<'_>, Scale<'static>)> {
    let points: Vec<(f64, f64)> = lines(panel).flatten().collect();
    let x = Scale::of(&panel.x_axis, points.iter().map(|p| p.0), 0.12)?;
    Some((x, Scale::of(vertical(panel), points.iter().map(|p| p.1), 0.2)?))
}

/// Lines nearer than this at all of their points coincide, in pixels.
const SAME: f64 = 1.5;

/// Draws a panel with these lines, which go into the area of `size` at `corner`, in pixels; without points there is an empty area.
pub fn draw(
    root: &Root<'_, '_>,
    (panel, names): (&StudyPanel, &[StudyLine]),
    [left, top]: [f64; 2],
    [w, h]: [f64; 2],
) -> Result<(), PlotError> {
    let base = units(top + h);
    let heading = shortened(&panel.y, w, 12.5);
    root.draw(&Text::new(heading, (units(left), units(top - 20.0)), text(12.5, INK, HPos::Left, VPos::Top)))?;
    let all: Vec<Vec<(f64, f64)>> = lines(panel).collect();
    let found = scales(panel).and_then(|(x, y)| {
        let slopes = if panel.slopes && panel.x_axis == Axis::Log && panel.y_log {
            triangles(all.iter().map(Vec::as_slice), y.span())
        } else {
            Vec::new()
        };
        // triangles need room, too
        let heights = all.iter().flatten().map(|p| p.1).chain(slopes.iter().flat_map(|t| t.corners.map(|c| c.1)));
        Some((x, Scale::of(vertical(panel), heights, 0.2)?, slopes))
    });
    if let Some((x, y, slopes)) = &found {
        let px = |v: f64| units(left + w * x.at(v));
        let py = |v: f64| units(top + h * (1.0 - y.at(v)));
        for (v, word) in y.marks() {
            root.draw(&PathElement::new(vec![(units(left), py(v)), (units(left + w), py(v))], stroke(PALE, 0.8)))?;
            root.draw(&Text::new(word, (units(left - 8.0), py(v)), text(11.5, GREY, HPos::Right, VPos::Center)))?;
        }
        for (v, word) in x.marks() {
            root.draw(&PathElement::new(vec![(px(v), units(top)), (px(v), base)], stroke(PALE, 0.8)))?;
            root.draw(&Text::new(shortened(&word, 90.0, 11.5), (px(v), base + units(8.0)), text(11.5, GREY, HPos::Center, VPos::Top)))?;
        }
        for triangle in slopes {
            slope(root, triangle, &px, &py)?;
        }
        let place = |p: &(f64, f64)| (px(p.0), py(p.1));
        let places: Vec<Vec<(i32, i32)>> = all.iter().map(|line| line.iter().map(place).collect()).collect();
        let near = |(a, b): (&(i32, i32), &(i32, i32))| (a.0 - b.0).abs().max((a.1 - b.1).abs()) <= units(SAME);
        for (k, line) in panel.points.iter().take(MOST_LINES).enumerate() {
            let at = &places[k];
            let over = places[..k].iter().any(|other| other.len() == at.len() && other.iter().zip(at).all(near));
            let number = names.get(k).map_or(0, |line| line.mark);
            for run in line.split(|p| p.1.is_nan()) {
                let at: Vec<(i32, i32)> = run.iter().filter(|p| is_drawn(panel, p)).map(place).collect();
                if at.len() > 1 {
                    trace(root, k, &at, over)?;
                }
                let is_bare = panel.bare && at.len() > 1;
                at.into_iter().filter(|_| !is_bare).try_for_each(|p| mark(root, (k, number), p, over))?;
            }
        }
    }
    root.draw(&PathElement::new(vec![(units(left), units(top)), (units(left), base), (units(left + w), base)], stroke(GREY, 1.0)))?;
    root.draw(&Text::new(panel.x.clone(), (units(left + w), base + units(28.0)), text(12.0, GREY, HPos::Right, VPos::Top)))?;
    Ok(())
}

/// A slope triangle with its two numbers.
fn slope(root: &Root<'_, '_>, triangle: &Triangle, px: &dyn Fn(f64) -> i32, py: &dyn Fn(f64) -> i32) -> Result<(), PlotError> {
    let [a, b, c] = triangle.corners.map(|(x, y)| (px(x), py(y)));
    root.draw(&PathElement::new(vec![a, b, c, a], stroke(INK, 1.2)))?;
    let beside = (b.0 + units(5.0), (b.1 + c.1) / 2);
    root.draw(&Text::new(short(triangle.slope, 3), beside, text(11.5, INK, HPos::Left, VPos::Center)))?;
    let below = ((a.0 + b.0) / 2, b.1 + units(3.0));
    root.draw(&Text::new("1", below, text(11.5, INK, HPos::Center, VPos::Top)))?;
    Ok(())
}
