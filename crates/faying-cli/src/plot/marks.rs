//! Supports and loads in a picture: triangles that hold, arrows that push.

use super::{FieldPlot, INK, PlotError, RED_LINE, Root, stroke, units};
use crate::marks::{Mark, MarkKind, RigidShape};
use crate::table::short;
use plotters::prelude::*;

/// Length of an arrow and of a triangle in pixels.
const LENGTHS: [f64; 2] = [22.0, 9.0];

/// "; displacements 50 times; triangles: supports, arrows: loads", as far as there are some.
pub(super) fn words(plot: &FieldPlot<'_>) -> String {
    let mut text = String::new();
    if plot.moved == 1.0 {
        text += "; displacements as they are";
    } else if plot.moved != 0.0 {
        text += &format!("; displacements {} times", short(plot.moved, 3));
    }
    let any = |kind: MarkKind| plot.marks.iter().any(|mark| mark.kind == kind);
    let kinds = [(MarkKind::Support, "triangles: supports"), (MarkKind::Load, "arrows: loads")];
    let list: Vec<&str> = kinds.into_iter().filter(|(kind, _)| any(*kind)).map(|(_, word)| word).collect();
    if !list.is_empty() {
        text += &format!("; {}", list.join(", "));
    }
    let hatched = plot.obstacles.iter().any(|obstacle| matches!(obstacle.shape, RigidShape::Outline(_)));
    // obstacles are where they are: they touch bodies that are, too
    let unscaled = if [0.0, 1.0].contains(&plot.moved) { "" } else { ", not scaled" };
    if hatched {
        text += &format!("; hatched: rigid{unscaled}");
    } else if !plot.obstacles.is_empty() && !unscaled.is_empty() {
        text += &format!("; rigid faces{unscaled}");
    }
    text
}

/// Draws the marks that are `seen`; `pixel` is the place of a point in the drawing.
pub(super) fn draw(
    root: &Root<'_, '_>,
    plot: &FieldPlot<'_>,
    seen: &dyn Fn(&Mark) -> bool,
    pixel: &dyn Fn(&[f64; 3]) -> (i32, i32),
) -> Result<(), PlotError> {
    for mark in plot.marks.iter().filter(|mark| seen(mark)) {
        let at: [f64; 3] = std::array::from_fn(|k| mark.at[k] + plot.moved * mark.moved[k]);
        let tip = pixel(&at);
        // one pixel of length along the direction, as far as it is seen
        let Some(along) = direction(mark, plot, pixel) else { continue };
        let place = |back: f64, aside: f64| {
            let [x, y] = [along[0] * -back - along[1] * aside, along[1] * -back + along[0] * aside];
            (tip.0 + units(x), tip.1 + units(y))
        };
        match mark.kind {
            MarkKind::Support => {
                let corners = vec![tip, place(LENGTHS[1], 0.55 * LENGTHS[1]), place(LENGTHS[1], -0.55 * LENGTHS[1]), tip];
                root.draw(&PathElement::new(corners, stroke(INK, 1.0)))?;
            }
            MarkKind::Load => {
                root.draw(&PathElement::new(vec![place(LENGTHS[0], 0.0), tip], stroke(RED_LINE, 1.4)))?;
                root.draw(&PathElement::new(vec![place(6.0, 3.0), tip, place(6.0, -3.0)], stroke(RED_LINE, 1.4)))?;
            }
        }
    }
    Ok(())
}

/// Direction of a mark in the drawing, of length 1; `None` if it points to the viewer.
fn direction(mark: &Mark, plot: &FieldPlot<'_>, pixel: &dyn Fn(&[f64; 3]) -> (i32, i32)) -> Option<[f64; 2]> {
    // a step that is large against the rounding of units
    let reach = plot.marks.iter().flat_map(|m| m.at).fold(0.0, |size: f64, x| size.max(x.abs())).max(f64::MIN_POSITIVE);
    let ahead: [f64; 3] = std::array::from_fn(|k| mark.at[k] + reach * mark.toward[k]);
    let (a, b) = (pixel(&mark.at), pixel(&ahead));
    let step = [f64::from(b.0 - a.0), f64::from(b.1 - a.1)];
    let length = step[0].hypot(step[1]);
    (length > 8.0).then(|| [step[0] / length, step[1] / length])
}
