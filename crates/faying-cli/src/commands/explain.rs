//! `faying explain`: the long text of an error code, or the list of all codes.

use super::arguments::ExplainArguments;
use super::ended::Ended;
use crate::case::is_key;
use crate::codes::{self, CODES};
use crate::errors::nearest;
use crate::quantities::{Kind, Quantity};
use crate::table::Table;
use serde_json::{Value, json};

/// Prints what a code means and what to do; without a code the list of all.
pub fn explain(arguments: &ExplainArguments) -> Ended {
    let Some(given) = &arguments.code else { return all() };
    let Some(code) = codes::find(given.trim()) else {
        let word = given.trim();
        // a code is a letter with digits; every other word may be a key or a quantity
        let later = if is_key(word) {
            Some(("key of case files", "keys", "`faying schema` describes every key"))
        } else if is_quantity(word) {
            Some(("quantity", "quantities", "write it in a [[probe]]: `faying check` says whether the case has it"))
        } else {
            None
        };
        if let Some((what, them, help)) = later {
            return super::ended::usage(&format!("`{word}` is a {what}, and explaining {them} is not in this version"), Some(help));
        }
        let near = nearest(&given.trim().to_uppercase(), CODES.iter().map(|c| c.code));
        let help = near.map_or_else(
            || "`faying explain` lists all codes".to_owned(),
            |n| format!("did you mean {n}? `faying explain` lists all codes"),
        );
        return super::ended::usage(&format!("there is no code `{given}`"), Some(&help));
    };
    let example: String = code.example.lines().map(|line| format!("    {line}\n")).collect();
    let text = format!(
        "{}: {} (exit {})\n\n{}\n\nFor example\n\n{example}\nWhat to do: {}\n",
        code.code,
        code.title,
        code.exit,
        wrapped(code.text, 88),
        wrapped(code.remedy, 88)
    );
    let document = json!({"code": code.code, "title": code.title, "exit_of_code": code.exit, "text": code.text, "example": code.example, "remedy": code.remedy});
    Ended::done("explain", text, document)
}

/// Whether a word has the form of a quantity; numbers of results are named by paths of at least two parts.
fn is_quantity(word: &str) -> bool {
    Quantity::parse(word).is_ok_and(|quantity| match quantity.kind {
        Kind::Path(path) => path.len() > 1 || matches!(word, "energy" | "unknowns"),
        _ => true,
    })
}

fn all() -> Ended {
    let mut table = Table::new(["code", "exit", "mistake"]);
    for c in CODES {
        table.row([c.code.to_owned(), c.exit.to_string(), c.title.to_owned()]);
    }
    let list: Vec<Value> = CODES.iter().map(|c| json!({"code": c.code, "title": c.title, "exit_of_code": c.exit})).collect();
    Ended::done("explain", format!("{table}\n`faying explain E021` says more about one.\n"), json!({ "codes": list }))
}

/// `text` in lines of at most `width` characters, broken at spaces.
fn wrapped(text: &str, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is a first line");
        if line.is_empty() || line.chars().count() + 1 + word.chars().count() <= width {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines.join("\n")
}
