//! The picture of a study, and one page with everything that can be opened anywhere.

use super::study::Study;
use crate::io::plot::{PlotError, StudyLine, StudyPlot, study};
use crate::io::table::short;
use std::fmt::Write as _;

/// Relative differences below this are drawn on it: round-off.
const FLOOR: f64 = 1e-17;

/// `study.svg`: constants against the size of elements; else an error, or the largest relative difference from the first row, against unknowns.
///
/// # Errors
/// [`PlotError::Empty`] where no row has a number.
pub fn picture(study_: &Study) -> Result<String, PlotError> {
    if study_.rows.iter().any(|row| row.beta.is_some()) {
        return super::constants::picture(study_);
    }
    let error = study_.main_error();
    let mut lines: Vec<StudyLine> = Vec::new();
    let mut last = None;
    for (k, row) in study_.rows.iter().enumerate() {
        let value = match &error {
            Some(name) => row.result.errors.get(name).copied(),
            None => row.differences.iter().map(|(_, d)| *d).reduce(|a, b| if b.is_nan() { b } else { a.max(b) }).map(|d| d.max(FLOOR)),
        };
        let begins = last.is_none_or(|j: usize| !study_.rows[j].spec.same_line(&row.spec));
        if begins {
            let vary: String = row.spec.vary.iter().map(|(key, value)| format!(", {key} = {value}")).collect();
            let degree = if row.degree.is_empty() { String::new() } else { format!(", degree {}", row.degree) };
            lines.push(StudyLine { name: format!("{}{degree}{vary}", row.spec.name()), points: Vec::new(), rate: None });
        }
        last = Some(k);
        let line = lines.last_mut().expect("the first row begins a line");
        if let Some(v) = value.filter(|v| row.solved() && v.is_finite() && *v > 0.0) {
            line.points.push((row.unknowns() as f64, v));
            line.rate = error.as_ref().and_then(|name| row.rates.get(name)).copied();
        }
    }
    lines.retain(|line| !line.points.is_empty());
    let title = if study_.title.is_empty() { &study_.case } else { &study_.title };
    let y = error.unwrap_or_else(|| "largest relative difference from the first row".to_owned());
    study(&StudyPlot { title, x: "unknowns", y: &y, lines: &lines })
}

/// `report.html`: heading, table, picture, checks and messages in one file.
pub fn html(study: &Study, picture: Option<&str>) -> String {
    let title = if study.title.is_empty() { &study.case } else { &study.title };
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{0}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p class=\"by\">faying {1} of <code>{2}</code>: \
         <strong class=\"{3}\">{4}</strong></p>\n",
        escaped(title),
        escaped(&study.command),
        escaped(&study.case),
        if study.exit() == 0 { "good" } else { "bad" },
        super::study::word(study.status())
    );
    // writing to a String cannot fail
    let table = study.table();
    page.push_str("<div class=\"wide\"><table>\n<thead><tr>");
    for cell in table.head() {
        let _ = write!(page, "<th>{}</th>", escaped(cell));
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for (k, row) in table.rows().enumerate() {
        let class = if study.rows[k].result.exit == 0 { "" } else { " class=\"bad\"" };
        let _ = write!(page, "<tr{class}>");
        for cell in row {
            let numeric = cell == "-" || cell.parse::<f64>().is_ok();
            let _ = write!(page, "<td{}>{}</td>", if numeric { " class=\"n\"" } else { "" }, escaped(cell));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody>\n</table></div>\n");
    if let Some(svg) = picture {
        // the drawing itself, without the line that makes it a file
        let start = svg.find("<svg").unwrap_or(0);
        let _ = writeln!(page, "<figure>{}</figure>", &svg[start..]);
    }
    if !study.notes.is_empty() {
        page.push_str("<h2>What the rows say together</h2>\n<ul>\n");
        study.notes.iter().for_each(|note| page.push_str(&format!("<li>{}</li>\n", escaped(note))));
        page.push_str("</ul>\n");
    }
    if let Some((tol, found)) = &study.tolerance {
        let _ = write!(page, "<h2>Differences from the first row, at most {}</h2>\n<ul>\n", short(*tol, 3));
        for t in found {
            let class = if t.ok { "good" } else { "bad" };
            let _ = writeln!(page, "<li class=\"{class}\">{}: {}</li>", escaped(&t.quantity), escaped(&study.largest(t)));
        }
        page.push_str("</ul>\n");
    }
    let failed = study.failed_checks();
    if !failed.is_empty() {
        page.push_str("<h2>Checks that failed</h2>\n<ul>\n");
        failed.iter().for_each(|f| page.push_str(&format!("<li class=\"bad\">{}</li>\n", escaped(f))));
        page.push_str("</ul>\n");
    }
    let messages = study.diagnostics();
    if !messages.is_empty() {
        let _ = write!(page, "<h2>Messages</h2>\n<pre>{}</pre>\n", escaped(&messages.render()));
    }
    page.push_str("</body>\n</html>\n");
    page
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;color:#262b33;max-width:60rem;margin:2rem auto;padding:0 1rem}\
h1{font-size:1.5rem;margin-bottom:.2rem}h2{font-size:1.1rem;margin-top:2rem}.by{color:#787f8a;margin-top:0}.wide{overflow-x:auto}\
table{border-collapse:collapse;font-size:.9rem}th,td{padding:.3rem .8rem;text-align:left;border-bottom:1px solid #e2e5ea;white-space:nowrap}\
th{border-bottom:2px solid #787f8a}td.n{text-align:right;font-variant-numeric:tabular-nums}.good{color:#2d7d46}.bad{color:#c94c33}\
figure{margin:2rem 0}figure svg{max-width:100%;height:auto}pre{background:#f6f7f9;padding:1rem;overflow-x:auto;font-size:.85rem}";

/// Text that is no mark-up.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
