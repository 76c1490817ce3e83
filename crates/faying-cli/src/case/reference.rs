//! `faying explain KEY` and the reference of all keys, made of the rows of the grammar.

use super::key::{Absent, Inside, Key, KeyKind, Plain, Special};
use super::names::Names;
use super::reader::Uses;
use super::rows::{ROOT, inside};
use std::fmt::Write;

/// A key with its path from the top level, such as `contact.rigid.sphere.radius`.
#[derive(Clone, Debug)]
pub struct KeyPath {
    /// The path.
    pub path: String,
    /// The key.
    pub key: Key,
    /// Condition under which it has an effect; empty if everywhere.
    pub only: String,
}

impl KeyPath {
    /// The key of a block at a path.
    fn new(block: &[Key], at: &str, key: &Key, names: &Names) -> Self {
        let path = if at.is_empty() { key.name.to_owned() } else { format!("{at}.{}", key.name) };
        let only = key.only.map_or_else(|| names.owners(block, key).join(", "), |only| only.of.to_owned());
        Self { path, key: key.clone(), only }
    }
}

impl KeyPath {
    /// Whether these are parts of the path in their order, the last of them the key itself or another name of it.
    fn is_named(&self, parts: &[&str]) -> bool {
        let Some((last, before)) = parts.split_last() else { return false };
        let mut path = self.path.split('.').rev();
        let own = path.next() == Some(last) || self.key.aliases.contains(last);
        own && before.iter().rev().all(|part| path.any(|p| p == *part))
    }
}

/// All keys of case files with their paths; an alias is no key of its own.
pub fn keys(names: &Names) -> Vec<KeyPath> {
    fn walk(keys: &[Key], at: &str, names: &Names, all: &mut Vec<KeyPath>) {
        for key in keys {
            let found = KeyPath::new(keys, at, key, names);
            let path = found.path.clone();
            all.push(found);
            match inside(key, names) {
                Inside::Nothing => {}
                Inside::Block(keys) => walk(&keys, &path, names, all),
                Inside::Kinds(kinds) => kinds.iter().for_each(|(kind, keys)| walk(keys, &format!("{path}.{kind}"), names, all)),
            }
        }
    }
    let mut all = Vec::new();
    walk(ROOT, "", names, &mut all);
    all
}

/// The keys that a word names: a path, some parts of one in their order with the last one (`geometry.extrude`), another name of a key, or a
/// path of `--set`, which names a block (`patch.lower.degree`).
pub fn find(word: &str, names: &Names) -> Vec<KeyPath> {
    let word = word.trim_matches(['[', ']']);
    let parts: Vec<&str> = word.split('.').collect();
    let all = keys(names);
    let exact: Vec<KeyPath> = all.iter().filter(|found| found.path == word).cloned().collect();
    if !exact.is_empty() {
        return exact;
    }
    let matching = |parts: &[&str]| -> Vec<KeyPath> { all.iter().filter(|found| found.is_named(parts)).cloned().collect() };
    let found = matching(&parts);
    if found.is_empty() && parts.len() > 2 { matching(&[&parts[..1], &parts[2..]].concat()) } else { found }
}

/// Admissible values of a key, in words.
pub fn values(key: &Key, names: &Names) -> String {
    let quoted = |words: &[&str]| words.iter().map(|w| format!("{w:?}")).collect::<Vec<_>>().join(" | ");
    let special = match &key.kind {
        KeyKind::Number => return "a number, or a quoted formula of constants".to_owned(),
        KeyKind::Positive => return "a number above zero".to_owned(),
        KeyKind::Whole(least, i64::MAX) => return format!("a whole number of at least {least}"),
        KeyKind::Whole(least, most) => return format!("a whole number from {least} to {most}"),
        KeyKind::Auto => return "\"auto\" or a number above zero".to_owned(),
        KeyKind::Formula => return "a number, or a quoted formula of x, y, z, t, r, theta".to_owned(),
        KeyKind::Vector => return "a list of a number per coordinate".to_owned(),
        KeyKind::Flag => return "true | false".to_owned(),
        KeyKind::Word(words) => return quoted(words),
        KeyKind::Text => return "a text in quotes".to_owned(),
        KeyKind::Language(kind) => &kind.0,
    };
    match special {
        Special::Name => "a name of letters, digits, `_`, `-`".to_owned(),
        Special::FormulaOf(Uses::Gap) => "a number, or a quoted formula of g, x, y, z, t".to_owned(),
        Special::FormulaOf(Uses::Time) => "a number, or a quoted formula of t".to_owned(),
        Special::FormulaOf(Uses::Check) => "a number, or a quoted formula of t, constants and quantities".to_owned(),
        Special::FormulaOf(Uses::Space) => "a number, or a quoted formula".to_owned(),
        Special::Numbers => "a list of numbers".to_owned(),
        Special::Pair => "two numbers".to_owned(),
        Special::Field => "a formula per component (a list; one formula in Poisson's equation)".to_owned(),
        Special::Components { exact } => {
            let word = if *exact { "\"exact\", " } else { "" };
            format!("{word}a list of all components, a table of some, or one formula in Poisson's equation")
        }
        Special::SomeCoordinates => "a list of all coordinates, or a table of some".to_owned(),
        Special::Sides => "a side \"PATCH.SIDE\", or a list of sides".to_owned(),
        Special::Words => "a text, or a list of texts".to_owned(),
        Special::Entry(family) => quoted(&names.words(*family)),
        Special::Multiplier => {
            let names: Vec<&str> = names.multipliers.iter().map(String::as_str).collect();
            format!("{} | \"p/p-k\" | {{ degree = 1, continuity = 0, ends = \"auto\" }}", quoted(&names))
        }
        Special::Block(_) => "a table".to_owned(),
        Special::Blocks(_) => "a list of tables".to_owned(),
        Special::BlockPer(words, _) => format!("a table for each of {}", words.join(", ")),
        Special::Let => "a table of NAME = number or quoted formula".to_owned(),
        Special::Geometry | Special::Obstacle => {
            let Inside::Kinds(kinds) = inside(key, names) else { return String::new() };
            let mut words: Vec<&str> = kinds.iter().map(|(kind, _)| kind.as_str()).collect();
            words.dedup();
            format!("a table with kind = {}", quoted(&words))
        }
        Special::Only(words, _) => (*words).to_owned(),
        Special::Later(Plain::Never, _) => "none in this version".to_owned(),
        Special::Later(Plain::Zero, _) => "0; other values are not in this version".to_owned(),
        Special::Later(Plain::Words(words, others), _) => format!("{}; not in this version: {}", quoted(words), quoted(others)),
    }
}

/// Text for a key without it: its default, or whether it is required.
pub fn absent(key: &Key) -> String {
    match key.absent {
        Absent::Is(default) => default.to_owned(),
        Absent::Required(_) => "required".to_owned(),
        Absent::None(_) => "none".to_owned(),
    }
}

/// The text of `faying explain KEY`.
pub fn explained(found: &KeyPath, names: &Names) -> String {
    let key = &found.key;
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    let mut out = format!("{}: {}{unit}\n", found.path, key.text);
    let mut line = |what: &str, text: &str| writeln!(out, "    {what:<9}{text}").expect("writing to a string");
    line("values", &values(key, names));
    line("default", &absent(key));
    match key.absent {
        Absent::Required(example) | Absent::None(example) | Absent::Is(example)
            if !example.is_empty() && !matches!(key.special(), Some(Special::Blocks(_))) =>
        {
            // a flag is written where it differs from its default
            let example = match (&key.kind, &key.absent, example) {
                (KeyKind::Flag, Absent::Is(_), "false") => "true",
                (KeyKind::Flag, Absent::Is(_), "true") => "false",
                _ => example,
            };
            line("example", &format!("{} = {example}", key.name));
        }
        _ => {}
    }
    if !key.aliases.is_empty() {
        line("also", &key.aliases.join(", "));
    }
    if !found.only.is_empty() {
        line("only for", &found.only);
    }
    if let Some(Special::Later(_, help)) = key.special() {
        line("instead", help);
    }
    match inside(key, names) {
        Inside::Nothing => {}
        Inside::Block(keys) => line("keys", &keys.iter().map(|k| k.name).collect::<Vec<_>>().join(", ")),
        Inside::Kinds(kinds) => {
            for (kind, keys) in kinds {
                line("", &format!("{kind}: {}", keys.iter().map(|k| k.name).collect::<Vec<_>>().join(", ")));
            }
        }
    }
    out
}

/// The reference of case files, in Markdown: a table per block.
pub fn reference(names: &Names) -> String {
    let mut out = String::from(
        "# Keys of case files\n\nEvery block with its keys: admissible values, default, meaning with the unit of dimensional values, and where a key has an effect if not everywhere. \
         `faying explain KEY` says the same of one key, `faying schema` as JSON Schema.\n\n\
         In formulas r = sqrt(x^2 + y^2) and theta = atan2(y, x), in radians, whatever the model is: in axisymmetric ones x is the distance from the axis, not r.\n",
    );
    table("Top level", "", ROOT, names, &mut out);
    out.push_str(SIDES);
    out
}

/// The sides of every geometry.
const SIDES: &str = "
## Sides of geometries

A body has the directions u, v and, in three dimensions, w; u0 is its side where u begins, u1 where it ends. An edge or a corner is named by the sides that meet in it, \
as `u0v1`. The aliases are those of a box: left, right = u0, u1; in the plane bottom, top = v0, v1; in three dimensions front, back = v0, v1 and bottom, top = w0, w1. \
`faying inspect CASE` tells where every side is and where it looks.

| geometry | u0, u1 | v0, v1 | w0, w1 |
| --- | --- | --- | --- |
| box | least and greatest x | least and greatest y | least and greatest z |
| annulus-sector | first and last angle | first and last radius | least and greatest z of what `extrude` makes |
| disc-sector | first and last angle | v0 is the centre and no side; v1 the arc | as annulus-sector |
| plate-with-hole | y = 0 and x = 0, which a quarter model supports | the hole; both outer edges | as annulus-sector |
| sphere-octant | y = 0 and x = 0 through the centre | z = 0 through the centre; v1 is the pole and no side | first and last radius |
| nurbs, file | the ends of its parameters; of meshes the names of the file | | |
";

fn table(title: &str, at: &str, keys: &[Key], names: &Names, out: &mut String) {
    let cell = |text: &str| text.replace('|', "\\|");
    write!(out, "\n## {title}\n\n| key | values | default | meaning |\n| --- | --- | --- | --- |\n").expect("writing to a string");
    for key in keys {
        let found = KeyPath::new(keys, at, key, names);
        let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
        let of = if found.only.is_empty() { String::new() } else { format!("; only for {}", found.only) };
        let default = match key.absent {
            Absent::Is(default) => format!("`{default}`"),
            _ => absent(key),
        };
        let also = if key.aliases.is_empty() { String::new() } else { format!(" (also {})", key.aliases.join(", ")) };
        let (values, text) = (cell(&values(key, names)), cell(&format!("{}{unit}{of}", key.text)));
        writeln!(out, "| `{}`{also} | {values} | {} | {text} |", key.name, cell(&default)).expect("writing to a string");
    }
    for key in keys {
        let path = KeyPath::new(keys, at, key, names).path;
        let title = match key.special() {
            Some(Special::Blocks(_)) => format!("[[{path}]]"),
            Some(Special::BlockPer(..)) => format!("[{path}.COMMAND]"),
            Some(Special::Block(_)) if at.is_empty() => format!("[{path}]"),
            _ => format!("{path} = {{ .. }}"),
        };
        match inside(key, names) {
            Inside::Nothing => {}
            Inside::Block(keys) => table(&title, &path, &keys, names, out),
            Inside::Kinds(kinds) => {
                for (kind, keys) in kinds {
                    table(&format!("{path} = {{ kind = {kind:?}, .. }}"), &format!("{path}.{kind}"), &keys, names, out);
                }
            }
        }
    }
}
