//! Smaller SVG: polygons and lines that follow each other in one style become one path of relative coordinates.

/// The text with every run of `<polygon>` and `<polyline>` of equal style as one `<path>`: the same picture in about half of the bytes.
///
/// Polygons turn the same way round, so that none of a path cuts a hole into another.
pub(super) fn compact(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len() / 2);
    let mut style = String::new();
    for line in svg.lines() {
        match shape(line) {
            Some((of, points, closed)) => {
                if of != style {
                    close(&mut out, &style);
                    out.push_str(&format!("<path {of} d=\""));
                    style = of;
                }
                path(&mut out, points, closed);
            }
            None => {
                close(&mut out, &style);
                style.clear();
                out.push_str(line);
                out.push('\n');
            }
        }
    }
    close(&mut out, &style);
    out
}

fn close(out: &mut String, style: &str) {
    if !style.is_empty() {
        out.push_str("\"/>\n");
    }
}

/// Style, points and kind (closed or not) of a line that is one polygon or polyline.
fn shape(line: &str) -> Option<(String, Vec<[i64; 2]>, bool)> {
    let inner = line.strip_prefix('<')?.strip_suffix("/>")?;
    let (inner, closed) = match inner.strip_prefix("polygon ") {
        Some(rest) => (rest, true),
        None => (inner.strip_prefix("polyline ")?, false),
    };
    let (before, rest) = inner.split_once("points=\"")?;
    let (points, after) = rest.split_once('"')?;
    let point = |text: &str| {
        let (x, y) = text.split_once(',')?;
        Some([x.parse().ok()?, y.parse().ok()?])
    };
    let points: Option<Vec<[i64; 2]>> = points.split_whitespace().map(point).collect();
    let style = format!("{} {}", before.trim(), after.trim()).replace("opacity=\"1\"", "");
    let style = style.split_whitespace().collect::<Vec<_>>().join(" ");
    // equal points beside each other draw nothing
    let mut points = points?;
    points.dedup();
    (points.len() > 1 && !style.is_empty()).then_some((style, points, closed))
}

/// Appends a run of points; what is closed goes round with a positive area.
fn path(out: &mut String, mut points: Vec<[i64; 2]>, closed: bool) {
    let turn = |k: usize| {
        let ([a, b], [c, d]) = (points[k], points[(k + 1) % points.len()]);
        i128::from(a) * i128::from(d) - i128::from(c) * i128::from(b)
    };
    if closed && (0..points.len()).map(turn).sum::<i128>() < 0 {
        points.reverse();
    }
    out.push_str(&format!("M{} {}l", points[0][0], points[0][1]));
    for (k, pair) in points.windows(2).enumerate() {
        for (axis, step) in [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]].into_iter().enumerate() {
            let gap = if (k == 0 && axis == 0) || step < 0 { "" } else { " " };
            out.push_str(&format!("{gap}{step}"));
        }
    }
    if closed {
        out.push('z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_one_style_are_one_path_and_all_else_stays() {
        let svg = "<svg>\n<polygon opacity=\"1\" fill=\"#440C5D\" points=\"10,10 20,10 20,5 \"/>\n<polygon opacity=\"1\" fill=\"#440C5D\" points=\"0,0 0,3 3,3 \"/>\n\
                   <polyline fill=\"none\" opacity=\"0.06\" stroke=\"#000000\" points=\"1,2 3,4 3,4 1,9 \"/>\n<text x=\"1\">a</text>\n</svg>\n";
        // the first triangle turns the other way: its points are reversed
        let expected = "<svg>\n<path fill=\"#440C5D\" d=\"M20 5l0 5-10 0zM3 3l-3 0 0-3z\"/>\n\
                        <path fill=\"none\" opacity=\"0.06\" stroke=\"#000000\" d=\"M1 2l2 2-2 5\"/>\n<text x=\"1\">a</text>\n</svg>\n";
        assert_eq!(compact(svg), expected);
    }
}
