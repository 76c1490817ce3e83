//! `faying explain`: the long text of an error code, of a key of case files, of a quantity, or the list of all codes.

use super::arguments::ExplainArguments;
use super::ended::Exit;
use crate::case::{Names, reference};
use crate::codes::{self, CODES};
use crate::errors::nearest;
use crate::quantities::reference as quantities;
use crate::table::Table;
use serde_json::{Value, json};

/// Prints what a code, a key or a quantity means; without a word the list of all codes.
pub fn explain(arguments: &ExplainArguments, names: &Names) -> Exit {
    let Some(given) = &arguments.code else { return all() };
    let word = given.trim();
    match codes::find(word) {
        Some(code) => of_code(code),
        None => of_word(word, names),
    }
}

fn of_code(code: &codes::Code) -> Exit {
    let example: String = code.example.lines().map(|line| format!("    {line}\n")).collect();
    let exit = if code.exit == 0 { "a warning".to_owned() } else { format!("exit {}", code.exit) };
    let text = format!(
        "{}: {} ({exit})\n\n{}\n\nFor example\n\n{example}\nWhat to do: {}\n",
        code.code,
        code.title,
        wrapped(code.text, 88),
        wrapped(code.remedy, 88)
    );
    let document = json!({"code": code.code, "title": code.title, "exit_of_code": code.exit, "text": code.text, "example": code.example, "remedy": code.remedy});
    Exit::done("explain", text, document)
}

/// Keys and quantities of a word; both where it is both.
fn of_word(word: &str, names: &Names) -> Exit {
    let keys = reference::find(word, names);
    let found = quantities::find(word);
    if keys.is_empty() && found.is_empty() {
        let keys = reference::keys(names);
        let words =
            CODES.iter().map(|c| c.code).chain(keys.iter().map(|k| k.key.name)).chain(quantities::QUANTITIES.iter().map(|k| k.pattern));
        let near = nearest(word, words).or_else(|| nearest(&word.to_uppercase(), CODES.iter().map(|c| c.code)));
        let help = near.map_or_else(
            || "`faying explain` lists all codes".to_owned(),
            |n| format!("did you mean {n}? `faying explain` lists all codes"),
        );
        let is_code = word.len() == 4 && word.bytes().skip(1).all(|b| b.is_ascii_digit());
        let what = if is_code { "code" } else { "code, key or quantity" };
        return super::ended::usage(&format!("there is no {what} `{word}`"), Some(&help));
    }
    // one text for keys that say the same in several blocks
    let mut texts: Vec<String> = Vec::new();
    let mut told: Vec<(String, Vec<&str>)> = Vec::new();
    for key in &keys {
        let text = reference::explained(key, names);
        let text = text.strip_prefix(&key.path).unwrap_or(&text).to_owned();
        match told.iter_mut().find(|(known, _)| *known == text) {
            Some((_, paths)) => paths.push(&key.path),
            None => told.push((text, vec![&key.path])),
        }
    }
    texts.extend(told.iter().map(|(text, paths)| format!("{}{text}", paths.join(", "))));
    texts.extend(found.iter().map(|k| {
        let unit = if k.unit.is_empty() { String::new() } else { format!(" [{}]", k.unit) };
        format!("{}, a quantity{unit}\n    {}\n    example  quantity = \"{}\"\n", k.pattern, k.text, k.example)
    }));
    let of_keys: Vec<Value> = keys
        .iter()
        .map(|k| {
            json!({"path": k.path, "text": k.key.text, "unit": k.key.unit, "values": reference::values(&k.key, names),
                "default": reference::absent(&k.key), "only": k.only})
        })
        .collect();
    let of_quantities: Vec<Value> =
        found.iter().map(|k| json!({"quantity": k.pattern, "text": k.text, "unit": k.unit, "example": k.example})).collect();
    Exit::done("explain", texts.join("\n"), json!({"keys": of_keys, "quantities": of_quantities}))
}

fn all() -> Exit {
    let mut table = Table::new(["code", "exit", "mistake"]);
    for c in CODES {
        table.row([c.code.to_owned(), c.exit.to_string(), c.title.to_owned()]);
    }
    let list: Vec<Value> = CODES.iter().map(|c| json!({"code": c.code, "title": c.title, "exit_of_code": c.exit})).collect();
    let more = "`faying explain E021` says more about one, `faying explain KEY` about a key of case files, `faying explain QUANTITY` about a quantity.";
    Exit::done("explain", format!("{table}\n{more}\n"), json!({ "codes": list }))
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
