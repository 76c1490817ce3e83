//! `study.svg`: lines over the number of unknowns, both axes logarithmic, with observed rates.

use super::{BLUE_LINE, GREY, INK, PALE, PlotError, RED_LINE, document, shortened, stroke, text, units};
use crate::io::table::short;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// One line of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyLine {
    /// What the legend says.
    pub name: String,
    /// Unknowns and value, both positive, in the order of refinement.
    pub points: Vec<(f64, f64)>,
    /// Observed rate in the size of the elements between the last two points.
    pub rate: Option<f64>,
}

/// What the picture shows.
#[derive(Clone, Copy, Debug)]
pub struct StudyPlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// Name of the horizontal axis.
    pub x: &'a str,
    /// Name of the vertical axis.
    pub y: &'a str,
    /// The lines.
    pub lines: &'a [StudyLine],
}

const COLORS: [RGBColor; 6] =
    [BLUE_LINE, RED_LINE, RGBColor(45, 125, 70), RGBColor(138, 82, 160), RGBColor(190, 140, 20), RGBColor(60, 140, 150)];
/// Room for the legend of one line.
const LEGEND: f64 = 22.0;

/// The picture.
///
/// # Errors
/// [`PlotError::Empty`] where there is no point.
pub fn study(plot: &StudyPlot<'_>) -> Result<String, PlotError> {
    let points = || plot.lines.iter().flat_map(|l| &l.points).filter(|p| p.0 > 0.0 && p.1 > 0.0 && p.0.is_finite() && p.1.is_finite());
    let x = range(points().map(|p| p.0), 0.15).ok_or_else(|| PlotError::Empty(plot.title.to_owned()))?;
    let y = range(points().map(|p| p.1), 0.35).ok_or_else(|| PlotError::Empty(plot.title.to_owned()))?;
    let legend = 40.0 + LEGEND * plot.lines.len() as f64;
    let (left, top, w, h) = (92.0, legend + 26.0, 660.0, 400.0);
    let (width, height) = (left + w + 36.0, top + h + 56.0);
    let px = |v: f64| left + w * (v.log10() - x[0]) / (x[1] - x[0]);
    let py = |v: f64| top + h * (y[1] - v.log10()) / (y[1] - y[0]);
    document(width, height, |root| {
        root.draw(&Text::new(
            shortened(plot.title, width - left - 20.0, 17.0),
            (units(left), units(16.0)),
            text(17.0, INK, HPos::Left, VPos::Top),
        ))?;
        for v in marks(y) {
            let at = units(py(v));
            root.draw(&PathElement::new(vec![(units(left), at), (units(left + w), at)], stroke(PALE, 0.8)))?;
            root.draw(&Text::new(short(v, 3), (units(left - 8.0), at), text(11.5, GREY, HPos::Right, VPos::Center)))?;
        }
        let base = units(top + h);
        for v in marks(x) {
            let at = units(px(v));
            root.draw(&PathElement::new(vec![(at, units(top)), (at, base)], stroke(PALE, 0.8)))?;
            root.draw(&Text::new(short(v, 3), (at, base + units(8.0)), text(11.5, GREY, HPos::Center, VPos::Top)))?;
        }
        root.draw(&PathElement::new(vec![(units(left), units(top)), (units(left), base), (units(left + w), base)], stroke(GREY, 1.0)))?;
        root.draw(&Text::new(plot.x, (units(left + w), base + units(28.0)), text(12.0, GREY, HPos::Right, VPos::Top)))?;
        root.draw(&Text::new(plot.y.to_owned(), (units(left), units(top - 18.0)), text(12.0, GREY, HPos::Left, VPos::Top)))?;
        for (k, line) in plot.lines.iter().enumerate() {
            let color = COLORS[k % COLORS.len()];
            let at: Vec<(i32, i32)> = line.points.iter().map(|p| (units(px(p.0)), units(py(p.1)))).collect();
            if at.len() > 1 {
                root.draw(&PathElement::new(at.clone(), stroke(color, 2.0)))?;
            }
            for p in &at {
                root.draw(&Circle::new(*p, units(4.0), color.filled()))?;
            }
            let middle = units(44.0 + LEGEND * k as f64 + 7.0);
            root.draw(&PathElement::new(vec![(units(left), middle), (units(left + 24.0), middle)], stroke(color, 2.0)))?;
            root.draw(&Circle::new((units(left + 12.0), middle), units(4.0), color.filled()))?;
            let rate = line.rate.map_or(String::new(), |r| format!(": rate {r:.2} in h"));
            let words = shortened(&format!("{}{rate}", line.name), w - 40.0, 12.0);
            root.draw(&Text::new(words, (units(left + 32.0), middle), text(12.0, INK, HPos::Left, VPos::Center)))?;
        }
        Ok(())
    })
}

/// Logarithms of the ends of a range with room around; none without numbers.
fn range(values: impl Iterator<Item = f64>, room: f64) -> Option<[f64; 2]> {
    let (lo, hi) = values.map(f64::log10).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    (lo <= hi).then(|| [lo - room.max(0.05 * (hi - lo)), hi + room.max(0.05 * (hi - lo))])
}

/// Round numbers between 10^lo and 10^hi: powers of ten, few enough; with 2 and 5 where there is less than two decades.
fn marks([lo, hi]: [f64; 2]) -> Vec<f64> {
    let (first, last) = (lo.floor() as i32, hi.ceil() as i32);
    let decades = hi - lo;
    let every = ((decades / 8.0).ceil() as i32).max(1);
    let steps: &[f64] = if decades < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let all = (first..=last).filter(|d| d.rem_euclid(every) == 0).flat_map(|d| steps.iter().map(move |m| m * 10f64.powi(d)));
    all.filter(|v| (lo..=hi).contains(&v.log10())).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_powers_of_ten_and_finer_on_short_axes() {
        assert_eq!(marks([0.0, 3.0]), [1.0, 10.0, 100.0, 1000.0]);
        assert_eq!(marks([-0.1, 1.1]), [1.0, 2.0, 5.0, 10.0]);
        assert!(marks([-17.0, 3.0]).len() <= 9);
    }

    #[test]
    fn a_study_without_points_has_no_picture() {
        let plot = StudyPlot { title: "a", x: "unknowns", y: "error", lines: &[] };
        assert_eq!(study(&plot), Err(PlotError::Empty("a".into())));
    }

    #[test]
    fn one_point_is_a_picture() {
        let lines = [StudyLine { name: "fe".into(), points: vec![(100.0, 1e-3)], rate: None }];
        let svg = study(&StudyPlot { title: "a", x: "unknowns", y: "error", lines: &lines }).unwrap();
        assert!(svg.contains("<circle") && svg.contains("fe"));
    }
}
