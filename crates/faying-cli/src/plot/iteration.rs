//! `active_set.svg`: active and violated rows of every iteration, step by step.

use super::{BLUE_LINE, GREY, INK, PALE, PlotError, RED_LINE, document, heading, stroke, taller, text, ticks, units};
use crate::table::short;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// The iteration of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IterationStep {
    /// Its time, where there are steps.
    pub t: Option<f64>,
    /// Active rows in every iteration.
    pub active: Vec<usize>,
    /// Rows that violate the contact conditions after each.
    pub wrong: Vec<usize>,
    /// The iteration whose state the other pictures show, from 1.
    pub best: usize,
}

/// Content of the picture.
#[derive(Clone, Copy, Debug)]
pub struct IterationPlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// One after the other.
    pub steps: &'a [IterationStep],
}

/// Least distance of the times that stand over steps, in pixels.
const APART: f64 = 62.0;

/// The picture of an iteration: one dot per linear system and curve.
///
/// # Errors
/// [`PlotError`] where there is no iteration.
pub fn iteration(plot: &IterationPlot<'_>) -> Result<String, PlotError> {
    let last: usize = plot.steps.iter().map(|step| step.active.len()).sum();
    if last == 0 || plot.steps.iter().any(|step| step.wrong.len() != step.active.len()) {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let all = plot.steps.iter().flat_map(|step| step.active.iter().chain(&step.wrong));
    let most = all.copied().max().unwrap_or(0).max(1) as f64;
    let (left, w, h) = (62.0, 460.0, 200.0);
    let width = left + w + 24.0;
    let timed = plot.steps.iter().any(|step| step.t.is_some());
    let top = 76.0 + taller(plot.title, width - left - 16.0, 15.0) + if timed { 16.0 } else { 0.0 };
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
        let axis = if plot.steps.len() > 1 { "iteration, all steps" } else { "iteration" };
        root.draw(&Text::new(axis, (px(x1), base + units(26.0)), text(12.0, GREY, HPos::Right, VPos::Top)))?;
        let (mut before, mut said) = (0.0, f64::NEG_INFINITY);
        for step in plot.steps {
            let begin = px(x0 + before);
            if before > 0.0 {
                root.draw(&PathElement::new(vec![(begin, units(top)), (begin, base)], stroke(GREY, 0.8)))?;
            }
            let at = left + w * before / (x1 - x0);
            if let Some(t) = step.t.filter(|_| at - said >= APART) {
                let word = format!("t = {}", short(t, 4));
                root.draw(&Text::new(word, (begin, units(top - 4.0)), text(11.5, GREY, HPos::Left, VPos::Bottom)))?;
                said = at;
            }
            before += step.active.len() as f64;
        }
        let middle = units(top - if timed { 34.0 } else { 18.0 });
        let series: [(_, fn(&IterationStep) -> &[usize], _, _); 2] = [
            ("active rows", |step| &step.active, BLUE_LINE, 0.0),
            ("rows that violate the contact conditions", |step| &step.wrong, RED_LINE, 130.0),
        ];
        // dots of many iterations do not touch
        let dot = (0.35 * w / last as f64).clamp(1.0, 3.2);
        for (name, values, color, at) in series {
            let mut before = 0.0;
            for step in plot.steps {
                let place = |(k, &v): (usize, &usize)| (px(before + k as f64 + 1.0), py(v as f64));
                let points: Vec<(i32, i32)> = values(step).iter().enumerate().map(place).collect();
                before += points.len() as f64;
                root.draw(&PathElement::new(points.clone(), stroke(color, 2.0)))?;
                for point in points {
                    root.draw(&Circle::new(point, units(dot), color.filled()))?;
                }
            }
            let x = left + at;
            root.draw(&PathElement::new(vec![(units(x), middle), (units(x + 20.0), middle)], stroke(color, 2.0)))?;
            root.draw(&Text::new(name, (units(x + 26.0), middle), text(12.0, INK, HPos::Left, VPos::Center)))?;
        }
        // the other pictures show the last step
        let Some(end) = plot.steps.last().filter(|step| (1..step.active.len()).contains(&step.best)) else { return Ok(()) };
        let before = last - end.active.len();
        let ring = (px((before + end.best) as f64), py(end.wrong[end.best - 1] as f64));
        root.draw(&Circle::new(ring, units(6.0), stroke(INK, 1.2)))?;
        let words = (ring.0 + units(9.0), ring.1 - units(9.0));
        root.draw(&Text::new("results", words, text(11.5, INK, HPos::Left, VPos::Center)))?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(steps: &[IterationStep]) -> Result<String, PlotError> {
        iteration(&IterationPlot { title: "t", steps })
    }

    #[test]
    fn every_iteration_has_two_dots_and_none_no_picture() {
        let plot = IterationStep { t: None, active: vec![5, 3, 2], wrong: vec![2, 1, 0], best: 3 };
        let svg = drawn(std::slice::from_ref(&plot)).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("active rows") && !svg.contains("t = "));
        let ringed = drawn(&[IterationStep { best: 1, ..plot }]).unwrap();
        assert_eq!(ringed.matches("<circle").count(), 7);
        let one = IterationStep { active: vec![1], wrong: vec![0], best: 1, ..IterationStep::default() };
        assert!(drawn(std::slice::from_ref(&one)).is_ok());
        assert!(drawn(&[]).is_err() && drawn(&[IterationStep::default()]).is_err());
        assert!(drawn(&[IterationStep { wrong: vec![0, 0], ..one }]).is_err());
    }

    #[test]
    fn every_step_has_its_dots_and_its_time_where_there_is_room() {
        let step = |k: usize, n: usize| IterationStep { t: Some(0.25 * k as f64), active: vec![k; n], wrong: vec![0; n], best: n };
        let svg = drawn(&[step(1, 3), step(2, 1), step(3, 2)]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 12);
        assert!(["t = 0.25", "t = 0.5", "t = 0.75", "iteration, all steps"].iter().all(|word| svg.contains(word)), "{svg}");
        let many: Vec<IterationStep> = (1..=100).map(|k| step(k, 2)).collect();
        let svg = drawn(&many).unwrap();
        // 460 pixels, a time per 62 of them: every 14th step, whose width is 4.6
        assert_eq!((svg.matches("<circle").count(), svg.matches("t = ").count()), (400, 8));
    }
}
