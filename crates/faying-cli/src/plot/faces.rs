//! A picture of faces: elements in colours per part, names beside them; bodies in space seen from the corner (1, -1, 1).

use crate::marks::{Mark, MarkKind};
use std::fmt::Write as _;

/// A polygon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygon {
    /// Its corners in order.
    pub points: Vec<[f64; 3]>,
    /// The part it belongs to.
    pub part: usize,
    /// Lines drawn on it; `None`: its whole outline.
    pub lines: Option<Vec<[[f64; 3]; 2]>>,
}

/// A name in a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceLabel {
    /// Its place.
    pub at: [f64; 3],
    /// The name.
    pub text: String,
    /// The normal of the face that it names: names of faces that look away are pale; `None`: it is seen.
    pub outward: Option<[f64; 3]>,
}

/// Content of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacePlot {
    /// Its heading.
    pub title: String,
    /// Names of the parts.
    pub parts: Vec<String>,
    /// The polygons.
    pub faces: Vec<Polygon>,
    /// Names.
    pub labels: Vec<FaceLabel>,
    /// Supports and loads; those of faces that look away are left out.
    pub marks: Vec<Mark>,
}

/// Most polygons of a picture.
pub const MOST_FACES: usize = 60_000;
/// Most words of a picture.
const MOST_LABELS: usize = 60;
/// Width of the drawing, in pixels.
const WIDTH: f64 = 900.0;
/// Highest drawing, in pixels.
const HEIGHT: f64 = 900.0;
/// Space around it.
const MARGIN: f64 = 60.0;
/// Mean width of a letter as a share of its size, on the large side for sans-serif fonts.
const LETTER: f64 = 0.56;
/// Sizes of the heading, in pixels.
const LARGEST: f64 = 15.0;
const SMALLEST: f64 = 9.0;
/// Colours of the parts in turn.
const COLOURS: [&str; 10] = ["#8fb8de", "#f2b880", "#a3cf9e", "#d9a3c7", "#c9c37a", "#9fd3d0", "#e59c94", "#b6a8dd", "#c2b59b", "#b9c4cf"];

/// Right, up and towards the eye.
fn view(flat: bool) -> [[f64; 3]; 3] {
    if flat {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let (a, b, c) = (0.5f64.sqrt(), 1.0 / 6f64.sqrt(), 1.0 / 3f64.sqrt());
    [[a, a, 0.0], [-b, b, 2.0 * b], [c, -c, c]]
}

fn escaped(text: &str) -> String {
    quick_xml::escape::escape(text).into_owned()
}

/// Size of the letters with which a heading fills at most `room`, in pixels.
fn title_size(title: &str, room: f64) -> f64 {
    (room / (LETTER * title.chars().count().max(1) as f64)).clamp(SMALLEST, LARGEST)
}

/// The picture as SVG; `None` if there is nothing to draw, or more than [`MOST_FACES`] polygons.
pub fn faces(plot: &FacePlot) -> Option<String> {
    let all = || plot.faces.iter().flat_map(|f| &f.points);
    if plot.faces.is_empty() || plot.faces.len() > MOST_FACES || !all().all(|p| p.iter().all(|x| x.is_finite())) {
        return None;
    }
    let flat = all().all(|p| p[2] == 0.0);
    let axes = view(flat);
    let seen = |p: &[f64; 3]| axes.map(|a| a[0] * p[0] + a[1] * p[1] + a[2] * p[2]);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in all().map(seen) {
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
        }
    }
    let (w, h) = (high[0] - low[0], high[1] - low[1]);
    let scale = ((WIDTH - 2.0 * MARGIN) / w.max(f64::MIN_POSITIVE)).min((HEIGHT - 2.0 * MARGIN) / h.max(f64::MIN_POSITIVE));
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let more = plot.parts.len().saturating_sub(COLOURS.len());
    let rows = plot.parts.len().min(COLOURS.len()) + usize::from(more > 0);
    let heading = MARGIN + 10.0 + SMALLEST * LETTER * plot.title.chars().count() as f64;
    let (width, height) = ((w * scale + 2.0 * MARGIN + 160.0).max(heading), (h * scale).max(18.0 * rows as f64) + 2.0 * MARGIN);
    let place = |p: [f64; 3]| (MARGIN + (p[0] - low[0]) * scale, MARGIN + (high[1] - p[1]) * scale);
    // far faces first
    let mut order: Vec<(f64, usize)> = plot
        .faces
        .iter()
        .enumerate()
        .map(|(k, f)| (f.points.iter().map(|p| seen(p)[2]).sum::<f64>() / f.points.len().max(1) as f64, k))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut svg = String::new();
    // writing to a String cannot fail
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{MARGIN}\" y=\"28\" font-size=\"{:.1}\">{}</text>",
        title_size(&plot.title, width - MARGIN - 10.0),
        escaped(&plot.title)
    );
    let line = if plot.faces.len() > 4000 { 0.3 } else { 0.7 };
    let _ = writeln!(svg, "<g stroke=\"#33404d\" stroke-width=\"{line}\" stroke-linejoin=\"round\">");
    for (_, k) in order {
        let face = &plot.faces[k];
        let points: Vec<String> = face.points.iter().map(|p| place(seen(p))).map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
        let (colour, points) = (COLOURS[face.part % COLOURS.len()], points.join(" "));
        match &face.lines {
            None => {
                let _ = writeln!(svg, "<polygon fill=\"{colour}\" points=\"{points}\"/>");
            }
            Some(lines) => {
                let _ = writeln!(svg, "<polygon fill=\"{colour}\" stroke=\"{colour}\" points=\"{points}\"/>");
                for [a, b] in lines {
                    let ((x, y), (u, v)) = (place(seen(a)), place(seen(b)));
                    let _ = writeln!(svg, "<path d=\"M{x:.2},{y:.2}L{u:.2},{v:.2}\"/>");
                }
            }
        }
    }
    svg.push_str("</g>\n");
    draw_marks(&mut svg, &plot.marks, flat, &seen, &place);
    for label in plot.labels.iter().take(MOST_LABELS) {
        let (x, y) = place(seen(&label.at));
        // far behind: seen through the body
        let away = label.outward.is_some_and(|normal| seen(&normal)[2] < -1e-9);
        let pale = if away { " fill-opacity=\"0.45\"" } else { "" };
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" dominant-baseline=\"middle\" stroke=\"white\" stroke-width=\"3\" \
             paint-order=\"stroke\" fill=\"#7a1f1f\"{pale}>{}</text>",
            escaped(&label.text)
        );
    }
    legend(&mut svg, &plot.parts, width, more);
    svg.push_str("</svg>\n");
    Some(svg)
}

/// Length of an arrow and of a triangle in pixels.
const LENGTHS: [f64; 2] = [22.0, 9.0];

/// Writes triangles at supports and arrows at loads, and what they mean; `seen` are the coordinates of a vector to the right, up and to the
/// eye, `place` is where such coordinates are drawn.
fn draw_marks(svg: &mut String, marks: &[Mark], flat: bool, seen: &dyn Fn(&[f64; 3]) -> [f64; 3], place: &dyn Fn([f64; 3]) -> (f64, f64)) {
    for mark in marks.iter().filter(|mark| flat || seen(&mark.normal)[2] > 0.0) {
        let ([right, up, _], (x, y)) = (seen(&mark.toward), place(seen(&mark.at)));
        let length = right.hypot(up);
        // one that points to the eye is a point
        if length < 1e-3 {
            continue;
        }
        let along = [right / length, -up / length];
        let at = |back: f64, aside: f64| {
            let (x, y) = (x - back * along[0] - aside * along[1], y - back * along[1] + aside * along[0]);
            format!("{x:.2},{y:.2}")
        };
        let _ = match mark.kind {
            MarkKind::Support => {
                let [back, half] = [LENGTHS[1], 0.55 * LENGTHS[1]];
                let corners = [at(0.0, 0.0), at(back, half), at(back, -half)].join(" ");
                writeln!(svg, "<polygon class=\"support\" fill=\"white\" stroke=\"#33404d\" points=\"{corners}\"/>")
            }
            MarkKind::Load => {
                let [tail, tip] = [at(LENGTHS[0], 0.0), at(0.0, 0.0)];
                let head = [at(6.0, 3.0), tip.clone(), at(6.0, -3.0)].join("L");
                writeln!(svg, "<path class=\"load\" fill=\"none\" stroke=\"#c94c33\" stroke-width=\"1.4\" d=\"M{tail}L{tip}M{head}\"/>")
            }
        };
    }
    let any = |kind: MarkKind| marks.iter().any(|mark| mark.kind == kind);
    let kinds = [(MarkKind::Support, "triangles: supports"), (MarkKind::Load, "arrows: loads")];
    let list: Vec<&str> = kinds.into_iter().filter(|(kind, _)| any(*kind)).map(|(_, words)| words).collect();
    if !list.is_empty() {
        let _ = writeln!(svg, "<text x=\"{MARGIN}\" y=\"44\" fill=\"#787f8a\">{}</text>", list.join(", "));
    }
}

/// Writes the names of the parts beside their colours, at the right of a picture; `more` parts have none.
fn legend(svg: &mut String, parts: &[String], width: f64, more: usize) {
    for (k, name) in parts.iter().enumerate().take(COLOURS.len()) {
        let (x, y) = (width - 150.0, MARGIN + 18.0 * k as f64);
        let _ = writeln!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"12\" height=\"12\" fill=\"{}\"/><text x=\"{:.1}\" y=\"{y:.1}\">{}</text>",
            y - 10.0,
            COLOURS[k],
            x + 18.0,
            escaped(name)
        );
    }
    if more > 0 {
        let (x, y) = (width - 132.0, MARGIN + 18.0 * COLOURS.len() as f64);
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\">and {more} more</text>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(parts: usize, title: &str) -> String {
        let face = |part: usize| Polygon { points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]], part, lines: None };
        let names = (0..parts).map(|k| format!("part-{k}")).collect();
        let plot = FacePlot { title: title.into(), parts: names, faces: (0..parts).map(face).collect(), ..FacePlot::default() };
        faces(&plot).expect("there is something to draw")
    }

    #[test]
    fn the_legend_counts_the_parts_that_it_does_not_name() {
        let svg = plot(21, "many");
        assert!(svg.contains(">part-9<") && !svg.contains(">part-10<") && svg.contains(">and 11 more<"), "{svg}");
        assert!(!plot(10, "few").contains(" more<"));
    }

    #[test]
    fn a_long_heading_has_smaller_letters() {
        assert!(plot(1, "short").contains("y=\"28\" font-size=\"15.0\""));
        let room = 700.0;
        let long = "x".repeat(120);
        let size = title_size(&long, room);
        assert!(size < LARGEST && size * LETTER * 120.0 <= room * (1.0 + 1e-12), "{size}");
    }
}
