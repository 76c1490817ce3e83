//! `report.html`: one page with everything that can be opened anywhere, in the dark, on paper, by a screen reader; well-formed as XML, too.

use super::reading::{question, reading};
use super::study::{Study, word};
use crate::table::short;
use std::fmt::Write as _;

/// The look of the page.
const STYLE: &str = include_str!("report.css");
/// Most checks that are listed.
const MOST_CHECKS: usize = 200;

/// The page; `picture` is the text of an SVG, `words` the command line that reproduces the study.
pub fn html(study: &Study, picture: Option<&str>, words: &[String]) -> String {
    let title = if study.title.is_empty() { &study.case } else { &study.title };
    let class = if study.exit() == 0 { "good" } else { "bad" };
    let [asked, varied] = question(study);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{0}</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body>\n<main>\n<h1>{0}</h1>\n<p class=\"by\">faying {1} of <code>{2}</code>, version {3}: <strong class=\"{class}\">{4}</strong></p>\n\
         <p class=\"ask\">{5}</p>\n<p>{6}</p>\n",
        escaped(title),
        escaped(&study.command),
        escaped(&study.case),
        env!("CARGO_PKG_VERSION"),
        word(study.status()),
        escaped(&asked),
        escaped(&varied),
    );
    figure(&mut page, study, picture);
    outcome(&mut page, study);
    table(&mut page, study);
    checks(&mut page, study);
    let messages = study.diagnostics();
    // writing to a String cannot fail
    if !messages.is_empty() {
        let _ = write!(page, "<h2>Messages</h2>\n<pre>{}</pre>\n", escaped(&messages.render()));
    }
    let _ = write!(page, "<h2>To make it again</h2>\n<pre><code>{}</code></pre>\n", escaped(&command(words)));
    page.push_str("<p class=\"soft\">The numbers of this page, with all their digits, are in study.csv and result.json beside it.</p>\n");
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

fn figure(page: &mut String, study: &Study, picture: Option<&str>) {
    let Some(svg) = picture else { return };
    // the drawing without the header of a separate file
    let start = svg.find("<svg").map_or(0, |at| at + "<svg".len());
    let inner = svg[start..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    let said = format!("Picture of the study: {}; its numbers are in the table below", study.command);
    let _ = write!(page, "<figure>\n<svg role=\"img\" aria-label=\"{}\"{}</figure>\n", escaped(&said), inner);
}

fn outcome(page: &mut String, study: &Study) {
    let mut lines: Vec<(bool, String)> = reading(study).into_iter().map(|s| (s.bad, s.text)).collect();
    if let Some((tol, found)) = &study.tolerance {
        for t in found {
            let verdict = if t.ok { "within" } else { "beyond" };
            lines.push((!t.ok, format!("{}: {}, {verdict} the tolerance {}", t.quantity, study.largest(t), short(*tol, 3))));
        }
    }
    if lines.is_empty() {
        return;
    }
    page.push_str("<h2>What came out</h2>\n<ul>\n");
    for (bad, text) in lines {
        let _ = writeln!(page, "<li{}>{}</li>", if bad { " class=\"bad\"" } else { "" }, escaped(&text));
    }
    page.push_str("</ul>\n");
}

fn table(page: &mut String, study: &Study) {
    let table = study.table();
    page.push_str(
        "<h2>Table</h2>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Table of the study\"><table>\n<caption>",
    );
    let rates = if study.axes.levels > 1 { "; a rate is that of the column before it, from the level above" } else { "" };
    let _ = write!(page, "One row per combination{rates}. Rows that failed are coloured.</caption>\n<thead><tr>");
    for cell in table.head() {
        let _ = write!(page, "<th scope=\"col\">{}</th>", escaped(cell));
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for (k, row) in table.rows().enumerate() {
        let begins = k > 0 && study.axes.levels > 1 && !study.rows[k].spec.same_line(&study.rows[k - 1].spec);
        let classes = [(study.rows[k].result.exit != 0, "bad"), (begins, "new")];
        let classes: Vec<&str> = classes.into_iter().filter(|(there, _)| *there).map(|(_, name)| name).collect();
        let class = if classes.is_empty() { String::new() } else { format!(" class=\"{}\"", classes.join(" ")) };
        let _ = write!(page, "<tr{class}>");
        for cell in row {
            let numeric = cell == "-" || cell.parse::<f64>().is_ok();
            let _ = write!(page, "<td{}>{}</td>", if numeric { " class=\"n\"" } else { "" }, escaped(cell));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody>\n</table></div>\n");
}

fn checks(page: &mut String, study: &Study) {
    let of = |k: usize| study.rows[k].result.checks.iter().filter(|c| !c.skipped).map(move |c| (k, c));
    let all: Vec<_> = (0..study.rows.len()).flat_map(of).collect();
    if all.is_empty() {
        return;
    }
    page.push_str("<h2>Checks</h2>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Checks\"><table>\n<thead><tr>");
    for head in ["check", "row", "quantity", "found", "wanted", "verdict"] {
        let _ = write!(page, "<th scope=\"col\">{head}</th>");
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for (k, c) in all.iter().take(MOST_CHECKS) {
        let (class, verdict) = if c.ok { ("good", "passed") } else { ("bad", "failed") };
        let why = c.reason.as_ref().filter(|_| !c.ok).map_or(String::new(), |why| format!(": {why}"));
        let wanted = format!("{} {}", c.relation, short(c.expected, 6));
        let _ = write!(page, "<tr><td>{}</td><td>{}</td><td>{}</td>", escaped(&c.name), escaped(&study.label(*k)), escaped(&c.quantity));
        let _ = writeln!(
            page,
            "<td class=\"n\">{}</td><td>{}</td><td class=\"{class}\">{verdict}{}</td></tr>",
            short(c.value, 6),
            escaped(&wanted),
            escaped(&why)
        );
    }
    page.push_str("</tbody>\n</table></div>\n");
    if all.len() > MOST_CHECKS {
        let _ = writeln!(page, "<p class=\"soft\">{} more checks are in result.json.</p>", all.len() - MOST_CHECKS);
    }
}

/// Options that do not affect the numbers of a study, and whether a value follows each.
const ASIDE: [(&str, bool); 12] = [
    ("--threads", true),
    ("--out", true),
    ("--color", true),
    ("--time-limit", true),
    ("--max-memory", true),
    ("--force", false),
    ("--resume", false),
    ("--json", false),
    ("--quiet", false),
    ("--verbose", false),
    ("-q", false),
    ("-v", false),
];

/// The command line without options that do not affect the numbers, quoted for a shell.
fn command(words: &[String]) -> String {
    let mut line = "faying".to_owned();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let (name, valued) = word.split_once('=').map_or((word.as_str(), false), |(name, _)| (name, true));
        if let Some((_, follows)) = ASIDE.iter().find(|(aside, _)| *aside == name) {
            if *follows && !valued {
                words.next();
            }
            continue;
        }
        line.push(' ');
        let plain = !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || "-_./=,+:@%".contains(c));
        line.push_str(&if plain { word.clone() } else { format!("'{}'", word.replace('\'', "'\\''")) });
    }
    line
}

/// Text escaped for XML; characters that XML does not allow become spaces.
fn escaped(text: &str) -> String {
    let text: String = text.chars().map(|c| if c.is_control() && c != '\n' && c != '\t' { ' ' } else { c }).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_keeps_what_decides_about_numbers() {
        let words =
            ["convergence", "my case.toml", "--threads", "2", "--out=a", "--json", "--set", "let.a=1", "--vary", "let.b=[1, 2]", "--force"];
        let words: Vec<String> = words.map(str::to_owned).to_vec();
        assert_eq!(command(&words), "faying convergence 'my case.toml' --set let.a=1 --vary 'let.b=[1, 2]'");
    }

    #[test]
    fn text_is_no_mark_up() {
        assert_eq!(escaped("<a href=\"x\">&\u{1}"), "&lt;a href=&quot;x&quot;&gt;&amp; ");
    }
}
