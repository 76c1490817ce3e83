//! `faying explain`: the long text of an error code.

use super::arguments::ExplainArguments;
use super::ended::Ended;
use crate::io::codes::{self, CODES};
use serde_json::json;

/// Prints what a code means and what to do.
pub fn explain(arguments: &ExplainArguments) -> Ended {
    let wanted = arguments.code.trim().to_uppercase();
    let Some(code) = codes::find(&wanted) else {
        let known = CODES.iter().map(|c| c.code).collect::<Vec<_>>().join(", ");
        return super::usage(&format!("there is no code `{}`; known: {known}", arguments.code), None);
    };
    let text = format!("{}: {} (exit {})\n\n{}\n", code.code, code.title, code.exit, wrapped(code.text, 88));
    Ended::done("explain", text, json!({"code": code.code, "title": code.title, "exit_of_code": code.exit, "text": code.text}))
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
