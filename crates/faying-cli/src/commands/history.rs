//! `history.csv`: one line per step with its probes and contacts.

use crate::result::{ContactReport, Moment, RunResult};
use crate::table::exact;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Names and numbers of a contact, as in its report.
fn of_contact(c: &ContactReport) -> Vec<(String, f64)> {
    let mut all: Vec<(String, f64)> = c.force.iter().zip(AXES).map(|(f, axis)| (format!("force.{axis}"), *f)).collect();
    match &c.moment {
        Moment::Plane(m) => all.push(("moment.z".into(), *m)),
        Moment::Space(list) => all.extend(list.iter().zip(AXES).map(|(m, axis)| (format!("moment.{axis}"), *m))),
    }
    let numbers = [
        ("area", Some(c.area)),
        ("pressure.min", Some(c.pressure.min)),
        ("pressure.max", Some(c.pressure.max)),
        ("gap.min", Some(c.gap.min)),
        ("gap.least", Some(c.gap.least)),
        ("active", Some(c.active as f64)),
        ("half_width", c.half_width),
        ("iterations", Some(c.iterations as f64)),
    ];
    all.extend(numbers.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
    all
}

/// The text of the file: t, status, probes by name, then `contact.NAME.*`; missing values are empty.
pub fn csv(result: &RunResult) -> String {
    let contacts: Vec<(&str, Vec<String>)> =
        result.contact.iter().map(|(name, c)| (name.as_str(), of_contact(c).into_iter().map(|(n, _)| n).collect())).collect();
    let mut head = vec!["t".to_owned(), "status".to_owned()];
    head.extend(result.probes.iter().map(|p| p.name.clone()));
    for (name, columns) in &contacts {
        head.extend(columns.iter().map(|c| format!("contact.{name}.{c}")));
    }
    let mut text = head.join(",") + "\n";
    for step in &result.steps {
        let status = serde_json::to_value(step.status).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default();
        let mut cells = vec![exact(step.t), status];
        cells.extend(step.probes.iter().map(|p| exact(p.value)));
        for (name, columns) in &contacts {
            match step.contact.get(*name) {
                Some(c) => cells.extend(of_contact(c).iter().map(|(_, v)| exact(*v))),
                None => cells.extend(columns.iter().map(|_| String::new())),
            }
        }
        text += &(cells.join(",") + "\n");
    }
    text
}
