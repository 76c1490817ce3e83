//! `report.html` of a run.

use super::case::Loaded;
use super::files::OutputFile;
use super::summary;
use crate::RunResult;
use crate::errors::Diagnostics;
use crate::page::Page;
use crate::table::{Table, short};

/// The page on a run; `shown` are its files, whose pictures the page holds, `words` the command line that makes it again.
pub fn html(result: &RunResult, loaded: &Loaded, shown: &[OutputFile], messages: &Diagnostics, words: &[String]) -> String {
    let title = loaded.case.title.value.as_str();
    let title = if title.is_empty() { result.case.as_str() } else { title };
    let mut page = Page::begin(title, &result.command, &result.case, (&summary::status(result), result.exit == 0));
    page.paragraph("ask", &format!("{}.", crate::run::equation(&loaded.case)));
    let u = &result.unknowns;
    let elements = result.geometry.elements;
    let units = loaded.case.units.words();
    page.paragraph("", &format!("{elements} elements, {} unknowns, {} multipliers. {units}", u.primal, u.multipliers));
    let picture = |page: &mut Page, name: &str, said: &str| {
        if let Some(svg) = shown.iter().find(|f| f.name == name).and_then(|f| std::str::from_utf8(&f.bytes).ok()) {
            page.figure(svg, said);
        }
    };
    picture(&mut page, "fields.svg", "The bodies and a field on them");
    section(&mut page, "Checks", &[summary::checks(result)]);
    section(&mut page, "Probes", &[summary::probes(result)]);
    let mut sides = |heading: &str, table: Table, names: Vec<&str>| {
        section(&mut page, heading, &[table]);
        for name in names {
            picture(&mut page, &format!("interface_{name}.svg"), &format!("{heading}: {name}, along its slave side"));
        }
    };
    if result.solved {
        sides("Contacts", summary::contacts(result), result.contact.iter().map(|(name, _)| name.as_str()).collect());
        sides("Interfaces", summary::interfaces(result), result.interface.iter().map(|(name, _)| name.as_str()).collect());
        section(&mut page, "Loads and reactions", &[summary::loads(result), reactions(result), balance(result)]);
        section(&mut page, "Errors", &[summary::errors(result)]);
    }
    let is_new = |k: &usize| result.lines[..*k].iter().all(|before| before.name != result.lines[*k].name);
    for line in (0..result.lines.len()).filter(is_new).map(|k| &result.lines[k]) {
        picture(&mut page, &format!("line_{}.svg", line.name), &format!("Line {}", line.name));
    }
    section(&mut page, "Steps", &[summary::steps(result)]);
    iterations(&mut page, result);
    picture(&mut page, "active_set.svg", "Active rows, and rows that violate the contact conditions, in every iteration");
    if !messages.is_empty() {
        page.heading("Messages");
        page.lines(&messages.render());
    }
    section(&mut page, "What was solved", &[bodies(result, loaded), inputs(loaded)]);
    page.end(words, "result.json and the .csv files")
}

/// A heading with the tables that have rows; nothing without.
fn section(page: &mut Page, heading: &str, tables: &[Table]) {
    if tables.iter().all(Table::is_empty) {
        return;
    }
    page.heading(heading);
    for table in tables.iter().filter(|table| !table.is_empty()) {
        let bad = |k: usize| table.rows().nth(k).is_some_and(|row| row.last().is_some_and(|cell| cell.starts_with("FAILED")));
        page.table(heading, "", table, &|k, column| if column.is_none() && bad(k) { "bad" } else { "" });
    }
}

fn reactions(result: &RunResult) -> Table {
    let mut table = Table::new(["reaction of the support", "force on the body"]);
    for (name, force) in result.reactions.iter() {
        table.row([name.to_owned(), summary::vector(force)]);
    }
    table
}

fn balance(result: &RunResult) -> Table {
    let mut table = Table::new(["balance of all forces", "moment"]);
    table.row([summary::vector(&result.balance.force), summary::moment(result.balance.moment.as_ref())]);
    table
}

/// Sentences on how the system was solved.
fn iterations(page: &mut Page, result: &RunResult) {
    let Some(solve) = result.solve.as_ref().filter(|_| result.solved) else { return };
    let mut lines = vec![(solve.reason != "converged", format!("{}: {}", solve.linear, solve.reason))];
    lines.push((false, format!("relative residual {}; factorisations: {}", short(solve.residual, 2), solve.factors)));
    lines.extend(solve.condition.map(|c| (false, format!("condition number of about {}", short(c, 2)))));
    if solve.iterations > 0 {
        lines.push((false, format!("{} iterations of the linear solver", solve.iterations)));
    }
    if let Some(set) = &solve.active_set {
        let list = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        lines.push((false, format!("active set: {} iterations, active rows {}", set.iterations, list(&set.history))));
        lines.extend(set.notes.iter().map(|note| (false, note.clone())));
    }
    page.heading("Iterations");
    page.list(&lines);
}

fn bodies(result: &RunResult, loaded: &Loaded) -> Table {
    let mut table = Table::new(["patch", "geometry", "backend", "degree", "measure", "material"]);
    for (patch, (_, backend)) in loaded.case.patches.iter().zip(result.backends.iter()) {
        let name = &patch.name.value;
        let degree: Vec<String> = patch.discretization.degree.value.iter().map(usize::to_string).collect();
        let material = loaded.case.materials.get(patch.material.value).map_or("", |m| m.name.as_str());
        let measure = result.geometry.measure.get(name).map_or("-".to_owned(), |m| short(*m, 6));
        table.row([name.as_str(), patch.geometry.shape.kind(), backend, &degree.join(" x "), &measure, material]);
    }
    table
}

fn inputs(loaded: &Loaded) -> Table {
    let mut table = Table::new(["file that was read", "bytes", "SHA-256"]);
    for input in &loaded.inputs {
        table.row([input.file.clone(), input.bytes.to_string(), input.sha256.clone()]);
    }
    table
}
