//! Around a picture: axes with round numbers, a bar of colours.

use super::{FINE, GREY, INK, PALE, PlotError, Root, in_unit, labels, stroke, text, ticks, units};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Axes of the ranges `x`, `y`, lengths in a unit, in the frame left, top, width, height.
pub(super) fn axes(root: &Root<'_, '_>, [x, y]: [[f64; 2]; 2], unit: &str, [left, top, w, h]: [f64; 4]) -> Result<(), PlotError> {
    let line = stroke(PALE, 1.0);
    let place = |v: f64, [a, b]: [f64; 2], from: f64, length: f64| units(from + length * (v - a) / (b - a));
    let (base, corner) = (units(top + h), units(left));
    root.draw(&PathElement::new(vec![(corner, units(top)), (corner, base), (units(left + w), base)], line))?;
    let of_x = ticks(x[0], x[1], (w / 110.0).ceil() as usize);
    for (v, word) in of_x.iter().zip(labels(&of_x, 5)) {
        let v = *v;
        let at = place(v, x, left, w);
        root.draw(&PathElement::new(vec![(at, base), (at, base + units(4.0))], line))?;
        root.draw(&Text::new(word, (at, base + units(8.0)), text(11.5, GREY, HPos::Center, VPos::Top)))?;
    }
    let of_y = ticks(y[0], y[1], (h / 90.0).ceil() as usize);
    for (v, word) in of_y.iter().zip(labels(&of_y, 5)) {
        let v = *v;
        let at = units(top + h) - (place(v, y, 0.0, h));
        root.draw(&PathElement::new(vec![(corner - units(4.0), at), (corner, at)], line))?;
        root.draw(&Text::new(word, (corner - units(8.0), at), text(11.5, GREY, HPos::Right, VPos::Center)))?;
    }
    let [of_x, of_y] = ["x", "y"].map(|axis| axis.to_owned() + &in_unit(unit));
    root.draw(&Text::new(of_x, (units(left + w), base + units(24.0)), text(11.5, GREY, HPos::Right, VPos::Top)))?;
    root.draw(&Text::new(of_y, (corner + units(4.0), units(top - 18.0)), text(11.5, GREY, HPos::Right, VPos::Top)))?;
    Ok(())
}

/// The colours from `least` to `most` beside a frame.
pub(super) fn bar(
    root: &Root<'_, '_>,
    [left, top, w, h]: [f64; 4],
    least: f64,
    most: f64,
    uniform: bool,
    color: &dyn Fn(f64) -> RGBColor,
) -> Result<(), PlotError> {
    let steps = 160;
    let value = |k: f64| least + (most - least) * k / f64::from(steps);
    for k in 0..steps {
        let level = |k: i32| units(top + h * (1.0 - f64::from(k) / f64::from(steps)));
        let overlap = if k + 1 < steps { units(0.5) } else { 0 };
        root.draw(&Rectangle::new(
            [(units(left), level(k + 1) - overlap), (units(left + w), level(k))],
            color(value(f64::from(k) + 0.5)).filled(),
        ))?;
    }
    outline(root, [(units(left), units(top)), (units(left + w), units(top + h))], stroke(GREY, 0.8))?;
    let marks = if uniform { vec![0.5 * (least + most)] } else { ticks(least, most, ((h / 60.0) as usize).clamp(3, 8)) };
    let words = labels(&marks, 4);
    for (v, word) in marks.into_iter().zip(words) {
        let share = if uniform { 0.5 } else { (v - least) / (most - least) };
        let at = units(top) + (h * (1.0 - share) * FINE).round() as i32;
        root.draw(&PathElement::new(vec![(units(left + w), at), (units(left + w + 4.0), at)], stroke(GREY, 0.8)))?;
        root.draw(&Text::new(word, (units(left + w + 8.0), at), text(11.5, INK, HPos::Left, VPos::Center)))?;
    }
    Ok(())
}

/// The four sides of a box; the backend's own rectangles have no width of line.
pub(super) fn outline(root: &Root<'_, '_>, [a, b]: [(i32, i32); 2], style: ShapeStyle) -> Result<(), PlotError> {
    root.draw(&PathElement::new(vec![a, (b.0, a.1), b, (a.0, b.1), a], style))?;
    Ok(())
}
