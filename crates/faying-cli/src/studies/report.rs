//! `report.html` of a study.

use super::reading::{question, reading};
use super::study::{Study, word};
use crate::page::Page;
use crate::table::{Table, short};

/// Most checks that are listed.
const MOST_CHECKS: usize = 200;

/// The page; `picture` is the text of an SVG, `words` the command line that reproduces the study.
pub fn html(study: &Study, picture: Option<&str>, words: &[String]) -> String {
    let title = if study.title.is_empty() { &study.case } else { &study.title };
    let [asked, varied] = question(study);
    let mut page = Page::begin(title, &study.command, &study.case, (&word(study.status()), study.exit() == 0));
    page.paragraph("ask", &asked);
    page.paragraph("", &varied);
    if let Some(svg) = picture {
        page.figure(svg, &format!("Picture of the study: {}; its numbers are in the table below", study.command));
    }
    outcome(&mut page, study);
    table(&mut page, study);
    checks(&mut page, study);
    let messages = study.diagnostics();
    if !messages.is_empty() {
        page.heading("Messages");
        page.lines(&messages.render());
    }
    page.end(words, "study.csv and result.json")
}

fn outcome(page: &mut Page, study: &Study) {
    let mut lines: Vec<(bool, String)> = reading(study).into_iter().map(|s| (s.bad, s.text)).collect();
    if let Some((tol, found)) = &study.tolerance {
        for t in found {
            let verdict = if t.ok { "within" } else { "beyond" };
            lines.push((!t.ok, format!("{}: {}, {verdict} the tolerance {}", t.quantity, study.largest(t), short(*tol, 3))));
        }
    }
    if !lines.is_empty() {
        page.heading("What came out");
        page.list(&lines);
    }
}

fn table(page: &mut Page, study: &Study) {
    let rates = if study.axes.levels > 1 { "; a rate is that of the column before it, from the level above" } else { "" };
    let caption = format!("One row per combination{rates}. Rows that failed are coloured.");
    let class = |k: usize, column: Option<usize>| {
        let begins = k > 0 && study.axes.levels > 1 && !study.rows[k].spec.same_line(&study.rows[k - 1].spec);
        match (column, study.rows[k].result.exit != 0, begins) {
            (None, true, true) => "bad new",
            (None, true, false) => "bad",
            (None, false, true) => "new",
            _ => "",
        }
    };
    page.heading("Table");
    page.table("Table of the study", &caption, &study.table(), &class);
}

fn checks(page: &mut Page, study: &Study) {
    let of = |k: usize| study.rows[k].result.checks.iter().filter(|c| !c.skipped).map(move |c| (k, c));
    let all: Vec<_> = (0..study.rows.len()).flat_map(of).collect();
    if all.is_empty() {
        return;
    }
    let mut table = Table::new(["check", "row", "quantity", "found", "wanted", "verdict"]);
    for (k, c) in all.iter().take(MOST_CHECKS) {
        let why = c.reason.as_ref().filter(|_| !c.ok).map_or(String::new(), |why| format!(": {why}"));
        let verdict = if c.ok { "passed" } else { "failed" };
        let wanted = format!("{} {}", c.relation, short(c.expected, 6));
        table.row([c.name.clone(), study.label(*k), c.quantity.clone(), short(c.value, 6), wanted, format!("{verdict}{why}")]);
    }
    page.heading("Checks");
    page.table("Checks", "", &table, &|k, column| match (column, all[k].1.ok) {
        (Some(5), true) => "good",
        (Some(5), false) => "bad",
        _ => "",
    });
    if all.len() > MOST_CHECKS {
        page.paragraph("soft", &format!("{} more checks are in result.json.", all.len() - MOST_CHECKS));
    }
}
