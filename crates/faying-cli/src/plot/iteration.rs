//! `active_set.svg`: active and violated rows of every iteration.

use super::{BLUE_LINE, GREY, INK, PALE, PlotError, RED_LINE, document, heading, stroke, taller, text, ticks, units};
use crate::table::short;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Content of the picture.
#[derive(Clone, Copy, Debug)]
pub struct IterationPlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// Active rows in every iteration.
    pub active: &'a [usize],
    /// Rows that violate the contact conditions after each.
    pub wrong: &'a [usize],
    /// The iteration whose state the other pictures show, from 1.
    pub best: usize,
}

/// The picture of an iteration: one dot per linear system and curve.
///
/// # Errors
/// [`PlotError`] where there is no iteration.
pub fn iteration(plot: &IterationPlot<'_>) -> Result<String, PlotError> {
    let last = plot.active.len();
    if last == 0 || plot.wrong.len() != last {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let most = plot.active.iter().chain(plot.wrong).copied().max().unwrap_or(0).max(1) as f64;
    let (left, w, h) = (62.0, 460.0, 200.0);
    let width = left + w + 24.0;
    let top = 76.0 + taller(plot.title, width - left - 16.0, 15.0);
    let height = top + h + 50.0;
    // a single iteration stands in the middle
    let (x0, x1) = (0.5, last as f64 + 0.5);
    let px = |x: f64| units(left + w * (x - x0) / (x1 - x0));
    let py = |v: f64| units(top + h * (1.0 - v / (1.06 * most)));
    let base = units(top + h);
    document(width, height, |root| {
        heading(root, plot.title, [left, 14.0], width - left - 16.0, 15.0)?;
        for v in ticks(0.0, most, 5).into_iter().filter(|v| v.fract() == 0.0) {
            root.draw(&PathElement::new(vec![(px(x0), py(v)), (px(x1), py(v))], stroke(PALE, 0.8)))?;
            root.draw(&Text::new(short(v, 5), (px(x0) - units(8.0), py(v)), text(11.5, GREY, HPos::Right, VPos::Center)))?;
        }
        for x in ticks(x0, x1, 8).into_iter().filter(|x| x.fract() == 0.0) {
            root.draw(&PathElement::new(vec![(px(x), base), (px(x), base + units(4.0))], stroke(GREY, 0.8)))?;
            root.draw(&Text::new(short(x, 5), (px(x), base + units(8.0)), text(11.5, GREY, HPos::Center, VPos::Top)))?;
        }
        root.draw(&PathElement::new(vec![(px(x0), base), (px(x1), base)], stroke(GREY, 1.0)))?;
        root.draw(&Text::new("iteration", (px(x1), base + units(26.0)), text(12.0, GREY, HPos::Right, VPos::Top)))?;
        let middle = units(top - 18.0);
        let series =
            [("active rows", plot.active, BLUE_LINE, 0.0), ("rows that violate the contact conditions", plot.wrong, RED_LINE, 130.0)];
        for (name, values, color, at) in series {
            let points: Vec<(i32, i32)> = values.iter().enumerate().map(|(k, &v)| (px(k as f64 + 1.0), py(v as f64))).collect();
            root.draw(&PathElement::new(points.clone(), stroke(color, 2.0)))?;
            for point in points {
                root.draw(&Circle::new(point, units(3.2), color.filled()))?;
            }
            let x = left + at;
            root.draw(&PathElement::new(vec![(units(x), middle), (units(x + 20.0), middle)], stroke(color, 2.0)))?;
            root.draw(&Text::new(name, (units(x + 26.0), middle), text(12.0, INK, HPos::Left, VPos::Center)))?;
        }
        if (1..last).contains(&plot.best) {
            let ring = (px(plot.best as f64), py(plot.wrong[plot.best - 1] as f64));
            root.draw(&Circle::new(ring, units(6.0), stroke(INK, 1.2)))?;
            let words = (ring.0 + units(9.0), ring.1 - units(9.0));
            root.draw(&Text::new("results", words, text(11.5, INK, HPos::Left, VPos::Center)))?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_iteration_has_two_dots_and_none_no_picture() {
        let plot = IterationPlot { title: "t", active: &[5, 3, 2], wrong: &[2, 1, 0], best: 3 };
        let svg = iteration(&plot).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("active rows"));
        let ringed = iteration(&IterationPlot { best: 1, ..plot }).unwrap();
        assert_eq!(ringed.matches("<circle").count(), 7);
        assert!(iteration(&IterationPlot { active: &[1], wrong: &[0], best: 1, ..plot }).is_ok());
        assert!(iteration(&IterationPlot { active: &[], wrong: &[], ..plot }).is_err());
    }
}
