//! `study.csv`: columns named as in the rows of `result.json`, with dots; errors and rates by their quantities.

use super::rows::Row;
use super::study::{Study, names_of, word};
use crate::table::{csv_field, exact};

impl Study {
    /// The text of the file: a line of names, a line per row.
    pub fn csv(&self) -> String {
        let errors = names_of(&self.rows, |r| r.result.errors.keys());
        let rates = names_of(&self.rows, |r| r.rates.keys());
        let probes = names_of(&self.rows, |r| r.result.probes.iter().map(|p| &p.name));
        let differences = names_of(&self.rows, |r| r.differences.keys());
        let constants = self.rows.iter().any(|r| r.beta.is_some() || r.interface.is_some());
        let mut head: Vec<String> =
            ["name", "backend", "degree", "level", "pairing", "integration", "extra_points"].map(str::to_owned).to_vec();
        head.extend(self.axes.vary.iter().map(|v| format!("vary.{}", v.key)));
        head.extend(["elements", "h", "unknowns.primal", "unknowns.multipliers", "energy"].map(str::to_owned));
        head.extend(errors.iter().cloned());
        head.extend(rates.iter().map(|n| format!("rate.{n}")));
        if constants {
            head.extend(["side", "beta", "parametric", "slope", "verdict"].map(str::to_owned));
        }
        head.extend(probes.iter().map(|n| format!("probes.{n}")));
        head.extend(differences.iter().map(|n| format!("differences.{n}")));
        head.extend(["status", "exit", "code"].map(str::to_owned));
        let mut text = line(&head);
        for row in &self.rows {
            let r = &row.result;
            let solved = |v: f64| if row.solved() { exact(v) } else { String::new() };
            let mut cells = place(row);
            cells.push(solved(r.energy));
            cells.extend(errors.iter().map(|n| r.errors.get(n).map_or(String::new(), |v| solved(*v))));
            cells.extend(rates.iter().map(|n| row.rates.get(n).map_or(String::new(), |v| exact(*v))));
            if constants {
                let words = |text: &Option<String>| text.clone().unwrap_or_default();
                let number = |v: Option<f64>| v.map_or(String::new(), exact);
                cells.extend([words(&row.interface), number(row.beta), number(row.parametric), number(row.slope), words(&row.verdict)]);
            }
            let probe = |n: &String| r.probes.iter().find(|p| p.name == *n).map_or(String::new(), |p| solved(p.value));
            cells.extend(probes.iter().map(probe));
            cells.extend(differences.iter().map(|n| row.differences.get(n).map_or(String::new(), |v| exact(*v))));
            cells.extend([word(r.status), r.exit.to_string(), row.code().unwrap_or_default().to_owned()]);
            text.push_str(&line(&cells));
        }
        text
    }
}

/// Cells of a row for its position on the axes and its size.
fn place(row: &Row) -> Vec<String> {
    let r = &row.result;
    let built = r.geometry.elements > 0;
    let count = |n: usize| if built { n.to_string() } else { String::new() };
    let backend = if r.backend.is_empty() { row.spec.name() } else { &r.backend };
    let mut cells = vec![row.spec.name().to_owned(), backend.to_owned(), row.degree.clone(), row.spec.level.to_string()];
    cells.extend([row.pairing.clone(), row.integration.clone(), row.extra_points.clone()]);
    cells.extend(row.spec.vary.iter().map(|(_, v)| v.clone()));
    cells.push(count(r.geometry.elements));
    cells.push(if built { exact(r.geometry.h) } else { String::new() });
    cells.extend([count(r.unknowns.primal), count(r.unknowns.multipliers)]);
    cells
}

fn line(cells: &[String]) -> String {
    cells.iter().map(|c| csv_field(c)).collect::<Vec<_>>().join(",") + "\n"
}
