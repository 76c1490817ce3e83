//! Question and findings of a study, in plain sentences.

use super::picture::{NamedLine, errors_in_order, lines_over_points, lines_over_values, others, points_of};
use super::study::{Study, word};
use crate::table::{decimals, short};

/// Most sentences.
const MOST: usize = 60;
/// An error within this factor of the least one is as good.
const AS_GOOD: f64 = 1.05;

/// A sentence, and whether it reports a failure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sentence {
    /// The words.
    pub text: String,
    /// Whether something failed.
    pub bad: bool,
}

fn good(text: String) -> Sentence {
    Sentence { text, bad: false }
}

/// The question of a study; the varied values and the number of rows.
pub fn question(s: &Study) -> [String; 2] {
    let keys = || s.axes.vary.iter().map(|v| v.key.as_str()).collect::<Vec<_>>().join(" and ");
    let asked = match s.command.as_str() {
        "convergence" => "How fast does the solution settle when every element is halved, again and again?".to_owned(),
        "quadrature" => "How much does the integration along the interfaces matter, and how many points does it take?".to_owned(),
        "sweep" => format!("What does {} do to the answer?", keys()),
        "compare" => "Do different discretisations of one problem agree?".to_owned(),
        "infsup" => "Are these multipliers stable on these sides?".to_owned(),
        other => format!("faying {other}"),
    };
    let axes = &s.axes;
    let mut varied: Vec<String> = Vec::new();
    let mut say = |what: &str, values: &[String]| {
        if !values.is_empty() {
            varied.push(format!("{what} {}", values.join(", ")));
        }
    };
    say("backends", &axes.backends);
    let numbers = |list: &[usize]| list.iter().map(usize::to_string).collect::<Vec<_>>();
    say("degrees", &numbers(&axes.degrees.all));
    for (backend, list) in &axes.degrees.of {
        say(&format!("degrees of {backend}"), &numbers(list));
    }
    say("multipliers", &axes.pairings);
    say("integration", &axes.integrations);
    say("points beyond the default", &numbers(&axes.extra_points));
    axes.vary.iter().for_each(|v| say(&format!("{} =", v.key), &v.values));
    if axes.levels > 1 {
        varied.push(format!("levels 0 to {}, each with elements half as large as the one before", axes.levels - 1));
    }
    let varied = if varied.is_empty() { "Nothing was varied".to_owned() } else { format!("Varied: {}", varied.join("; ")) };
    let solved = s.rows.iter().filter(|row| row.solved() || row.beta.is_some()).count();
    [asked, format!("{varied}. {} in the table, {solved} with numbers.", rows(s.rows.len()))]
}

fn rows(n: usize) -> String {
    if n == 1 { "1 row".to_owned() } else { format!("{n} rows") }
}

/// The findings of a study, line by line.
pub fn reading(s: &Study) -> Vec<Sentence> {
    let mut found = if s.rows.iter().any(|row| row.beta.is_some()) {
        constants(s)
    } else if s.command == "quadrature" {
        points(s)
    } else if s.axes.levels > 1 {
        rates(s)
    } else if s.command == "sweep" {
        values(s)
    } else {
        Vec::new()
    };
    found.extend(s.notes.iter().cloned().map(good));
    let more = found.len().saturating_sub(MOST);
    found.truncate(MOST);
    if more > 0 {
        found.push(good(format!("{more} more lines are in the table.")));
    }
    let failed: Vec<_> = s.rows.iter().filter(|row| !matches!(row.result.exit, 0 | 1)).collect();
    if let Some(first) = failed.first() {
        let code = first.code().map_or(String::new(), |code| format!(", {code}"));
        let what =
            format!("{} of {} could not be finished, the first one: {}{code}", failed.len(), rows(s.rows.len()), word(first.result.status));
        found.push(Sentence { text: what + ". The other rows are valid.", bad: true });
    }
    if s.stopped.is_some() {
        found.push(Sentence { text: format!("The study was stopped; {}.", s.left()), bad: true });
    }
    found
}

/// Plain name of an error: "the L2 error of u".
fn plain(name: &str) -> String {
    let parts: Vec<&str> = name.split('.').collect();
    match parts[..] {
        ["error", "lambda", norm] => format!("the {norm} error of the multiplier"),
        ["error", side, "lambda", norm] => format!("the {norm} error of the multiplier of {side}"),
        ["error", field, norm] => format!("the {norm} error of {field}"),
        _ => name.to_owned(),
    }
}

/// One sentence per line: the observed rates of all errors, else of the quantities.
fn rates(s: &Study) -> Vec<Sentence> {
    let errors = errors_in_order(s);
    let asked: Vec<(String, String, bool)> = match errors.is_empty() {
        false => errors.iter().map(|name| (name.clone(), plain(name), true)).collect(),
        true => others(s, &errors).into_iter().map(|a| (a.name.clone(), a.name.clone(), false)).collect(),
    };
    let mut found = Vec::new();
    for line in s.lines() {
        let parts = asked.iter().filter_map(|(name, words, is_error)| {
            let rates: Vec<f64> = line.iter().filter_map(|k| s.rows[*k].rates.get(name)).copied().collect();
            let last = rates.last()?;
            let shown: Vec<String> = rates.iter().rev().take(2).rev().map(|r| decimals(*r, 2)).collect();
            let listed = if shown.len() > 1 { format!("last rates {}", shown.join(", ")) } else { format!("rate {}", shown[0]) };
            let rate = decimals(*last, 1);
            Some(match (is_error, *last < 0.05) {
                (true, true) => format!("{words} does not fall ({listed})"),
                (true, false) => format!("{words} falls like h^{rate} ({listed})"),
                (false, true) => format!("the differences of {words} between levels do not fall ({listed})"),
                (false, false) => format!("the differences of {words} between levels fall like h^{rate} ({listed})"),
            })
        });
        let parts: Vec<String> = parts.collect();
        let text = if parts.is_empty() { "no rate: it takes two levels with numbers".to_owned() } else { parts.join(", ") };
        found.push(good(format!("{}: {text}.", s.line(line[0]))));
    }
    found
}

/// One sentence per integration and error: effect of the number of points on the finest level.
fn points(s: &Study) -> Vec<Sentence> {
    let errors = errors_in_order(s);
    let mut found = Vec::new();
    for (name, rows) in lines_over_points(s) {
        for error in &errors {
            let value = |k: &usize| s.rows[*k].result.errors.get(error).copied().filter(|v| s.rows[*k].solved() && v.is_finite());
            let all: Vec<(usize, f64)> = rows.iter().filter_map(|k| Some((*k, value(k)?))).collect();
            let (Some(first), Some(last)) = (all.first(), all.last()) else { continue };
            let at = |(k, v): &(usize, f64)| format!("{} with {}", short(*v, 3), points_of(&s.rows[*k]));
            let least = all.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
            let text = match all.iter().position(|p| p.1 <= AS_GOOD * least) {
                Some(0) => format!("{} is {} and more points do not help", plain(error), at(first)),
                Some(n) => format!(
                    "{} goes from {} to {}; from {} on it is within 5 % of the least",
                    plain(error),
                    at(first),
                    at(last),
                    points_of(&s.rows[all[n].0])
                ),
                None => continue,
            };
            found.push(good(format!("{name}: {text}.")));
        }
    }
    found
}

/// Sentences per line: effect of the values of the first key on errors and quantities.
fn values(s: &Study) -> Vec<Sentence> {
    let errors = errors_in_order(s);
    let Some(vary) = s.axes.vary.first() else { return Vec::new() };
    let mut found = Vec::new();
    let of_line = |line: &NamedLine, name: &str, value: &dyn Fn(usize) -> f64| {
        let all: Vec<(usize, f64)> = line.1.iter().map(|k| (*k, value(*k))).filter(|p| p.1.is_finite()).collect();
        let (first, last) = (all.first()?, all.last()?);
        let at = |(k, v): &(usize, f64)| format!("{} at {}", short(*v, 4), s.rows[*k].spec.vary.first().map_or("", |(_, value)| value));
        let (low, high) = all.iter().fold((first, first), |(a, b), p| (if p.1 < a.1 { p } else { a }, if p.1 > b.1 { p } else { b }));
        let text = match (low.0 == first.0 && high.0 == last.0) || (high.0 == first.0 && low.0 == last.0) {
            _ if low.1 == high.1 => format!("{name} stays {}", short(low.1, 4)),
            true => format!("{name} goes from {} to {}", at(first), at(last)),
            false => format!("{name} lies between {} and {}", at(low), at(high)),
        };
        Some(good(format!("{}, over {}: {text}.", line.0, vary.key)))
    };
    for line in &lines_over_values(s) {
        for error in &errors {
            let value = |k: usize| s.rows[k].result.errors.get(error).copied().filter(|_| s.rows[k].solved()).unwrap_or(f64::NAN);
            found.extend(of_line(line, &plain(error), &value));
        }
        for a in others(s, &errors) {
            found.extend(of_line(line, &a.name, &|k| a.value(&s.rows[k])));
        }
    }
    found
}

/// One sentence per line: the inf-sup constant on the finest level and the verdict.
fn constants(s: &Study) -> Vec<Sentence> {
    let of = |rows: Vec<usize>| {
        let last = rows.iter().rev().find(|k| s.rows[**k].beta.is_some())?;
        let row = &s.rows[*last];
        let verdict = row.verdict.as_deref().unwrap_or("undecided");
        let text = format!("{}: {verdict}, beta {} on level {}.", s.line(*last), short(row.beta?, 6), row.spec.level);
        Some(Sentence { text, bad: verdict == "unstable" })
    };
    s.lines().into_iter().filter_map(of).collect()
}
