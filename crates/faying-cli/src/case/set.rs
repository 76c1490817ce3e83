//! `--set a.b=v`: changes of the tree before it is typed.
//!
//! Entries of `[[lists]]` are named by their `name` (`boundary-1` where they have none) or by their position from 0:
//! `patch.lower.degree=3`, `boundary.1.pressure=2`. A value that is not TOML is taken as a text, so `patch.lower.backend=fe` needs no quotes.

use super::key::Special;
use super::rows;
use super::tree::{Node, Table, Value, parse_value};
use crate::errors::{Diagnostic, nearest};
use crate::place::{Origin, SourceSpan};

/// Applies one option.
///
/// # Errors
/// A diagnostic that points to the option.
pub(super) fn apply(root: &mut Table, option: &str, index: usize) -> Result<(), Box<Diagnostic>> {
    let at = SourceSpan { origin: Origin::Set(index), ..SourceSpan::NONE };
    let fault = |code, message: String| Box::new(Diagnostic::error(code, message).in_file(format!("--set {option}")));
    let Some((path, text)) = option.split_once('=') else {
        return Err(fault("E014", "`--set` needs KEY=VALUE".to_owned()).help("write for example --set patch.lower.degree=3"));
    };
    let path: Vec<&str> = path.trim().split('.').map(str::trim).collect();
    if path.iter().any(|p| p.is_empty()) || path.len() > 16 {
        return Err(fault("E012", format!("`{}` is no path of keys", path.join("."))).help("write for example --set patch.lower.degree=3"));
    }
    let text = text.trim();
    let value = match parse_value(text, at) {
        Ok(node) => node,
        // a bare word or formula needs no quotes; an opened quote or bracket is a mistake
        Err(message) if text.starts_with(['[', '{', '"', '\'']) => {
            return Err(fault("E005", format!("the value of `--set` is not valid TOML: {message}")));
        }
        Err(_) => Node::new(Value::Text(text.to_owned()), at),
    };
    put(root, &path, value, at).map_err(|(code, message, help)| match help {
        Some(h) => fault(code, message).help(&h),
        None => fault(code, message),
    })
}

/// Names of the constants of `[let]`.
pub(super) fn constants(root: &Table) -> Vec<String> {
    match root.get("let").map(|e| &e.node.value) {
        Some(Value::Table(table)) => table.entries.iter().map(|e| e.key.clone()).collect(),
        _ => Vec::new(),
    }
}

/// Errors of options that give a constant which neither the file defines (`own`) nor anything in the case uses.
pub(super) fn unused(root: &Table, own: &[String], options: &[String]) -> Vec<Diagnostic> {
    let added = options.iter().filter_map(|option| Some((option, option.split_once('=')?.0.trim().strip_prefix("let.")?.trim())));
    let unused = added.filter(|(_, name)| !own.iter().any(|o| o == name) && !root.entries.iter().any(|e| mentions(&e.node, name)));
    let fault = |(option, name): (&String, &str)| {
        let near = nearest(name, own.iter().map(String::as_str)).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        let help = match own {
            [] => "the case has no [let], and no formula of it uses the name".to_owned(),
            _ => format!("constants here: {}", own.join(", ")),
        };
        let fault = Diagnostic::error("E012", format!("no formula uses a constant `{name}`{near}"));
        fault.with_help(help).in_file(format!("--set {option}"))
    };
    unused.map(fault).collect()
}

/// Whether a text in `node` has `name` as a word.
fn mentions(node: &Node, name: &str) -> bool {
    match &node.value {
        Value::Text(text) => text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name),
        Value::List(list) => list.iter().any(|node| mentions(node, name)),
        Value::Table(table) => table.entries.iter().any(|e| mentions(&e.node, name)),
        _ => false,
    }
}

/// All names of a key that has several.
fn synonyms(key: &str) -> Vec<&'static str> {
    let blocks = rows::ROOT.iter().filter_map(|row| match row.special() {
        Some(Special::Blocks(keys) | Special::Block(keys) | Special::BlockPer(_, keys)) => Some(*keys),
        _ => None,
    });
    let rows = blocks.flatten().filter(|row| row.aliases.contains(&key) || row.name == key && !row.aliases.is_empty());
    rows.flat_map(|row| std::iter::once(row.name).chain(row.aliases.iter().copied())).collect()
}

type Fault = (&'static str, String, Option<String>);

fn put(table: &mut Table, path: &[&str], value: Node, at: SourceSpan) -> Result<(), Fault> {
    let key = path[0];
    if path.len() == 1 {
        let same = synonyms(key);
        table.entries.retain(|e| e.key == key || !same.contains(&e.key.as_str()));
        table.set(key, at, value);
        return Ok(());
    }
    if table.get(key).is_none() {
        if rows::ROOT.iter().any(|row| row.name == key && matches!(row.special(), Some(Special::Blocks(_)))) {
            return Err(("E012", format!("there is no [[{key}]] in the case"), None));
        }
        if path[1].parse::<usize>().is_ok() {
            return Err(("E012", format!("there is no list `{key}` in the case"), None));
        }
        table.set(key, at, Node::new(Value::Table(Table::default()), at));
    }
    match table.get_mut(key) {
        Some(entry) => into(&mut entry.node, key, &path[1..], value, at),
        None => Ok(()),
    }
}

fn into(node: &mut Node, key: &str, path: &[&str], value: Node, at: SourceSpan) -> Result<(), Fault> {
    let found = node.describe();
    match &mut node.value {
        Value::Table(t) => put(t, path, value, at),
        Value::List(list) => {
            let names: Vec<String> = list.iter().map(|n| name_of(n).unwrap_or_default()).collect();
            // entries without a name are called BLOCK-0, BLOCK-1, ..
            let number = |word: &str| word.parse::<usize>().ok().filter(|k| *k < list.len());
            let by_default = || number(path[0].strip_prefix(key)?.strip_prefix('-')?).filter(|k| names[*k].is_empty());
            let which = names.iter().position(|n| n == path[0]).or_else(|| number(path[0])).or_else(by_default);
            let Some(which) = which else {
                let known: Vec<&str> = names.iter().map(String::as_str).filter(|n| !n.is_empty()).collect();
                let near = nearest(path[0], known.iter().copied()).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                let positions = match list.len() {
                    0 => "the list is empty".to_owned(),
                    n => format!("positions 0 to {}", n - 1),
                };
                let help = if known.is_empty() { positions } else { format!("names: {}; {positions}", known.join(", ")) };
                return Err(("E012", format!("there is no {key} `{}`{near}", path[0]), Some(help)));
            };
            if path.len() == 1 {
                list[which] = value;
                return Ok(());
            }
            into(&mut list[which], path[0], &path[1..], value, at)
        }
        _ => Err(("E014", format!("`{key}` has no keys: it is {found}"), None)),
    }
}

fn name_of(node: &Node) -> Option<String> {
    let Value::Table(t) = &node.value else { return None };
    match &t.get("name")?.node.value {
        Value::Text(s) => Some(s.clone()),
        _ => None,
    }
}

trait Help {
    fn help(self, text: &str) -> Self;
}

impl Help for Box<Diagnostic> {
    fn help(mut self, text: &str) -> Self {
        self.help = Some(text.to_owned());
        self
    }
}
