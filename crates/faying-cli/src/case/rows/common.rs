//! Keys that several blocks have, and questions of their conditions.

use crate::case::key::{Key, KeyKind, Plain, Scene, Special};
use crate::case::tree::{Table, Value};
use crate::place::Origin;

/// A key that this version does not have, with an example of a value.
pub(super) const fn later(name: &'static str, plain: Plain, example: &'static str, help: &'static str) -> Key {
    Key::of(name, Special::Later(plain, help), "not in this version").optional(example)
}

/// `name`, made of the block and the position by default.
pub(super) const fn name() -> Key {
    Key::of("name", Special::Name, "name in messages, tables and files; default BLOCK-0, BLOCK-1, ..").optional("\"pad\"")
}

/// The reaction term of Poisson's equation.
pub(super) const fn reaction(text: &'static str) -> Key {
    Key::new("reaction", KeyKind::Formula, text).optional("\"1 + x\"")
}

/// Springs of the volume.
pub(super) const fn foundation(text: &'static str) -> Key {
    Key::of("foundation", Special::Components { exact: false }, text).unit("force/volume/length").optional("{ y = 1e3 }")
}

/// The text of a key of a table.
pub(in crate::case) fn word<'a>(table: &'a Table, key: &str) -> Option<&'a str> {
    match &table.get(key)?.node.value {
        Value::Text(word) => Some(word),
        _ => None,
    }
}

/// Whether the patch does not take `backend` from the case file: options may change it where keys of the other one stand.
pub(super) fn other_backend(table: &Table, scene: &Scene<'_>, backend: &str) -> bool {
    let own = table.get("backend").map(|e| (word(table, "backend").unwrap_or_default(), e.node.at.origin));
    let (word, origin) = own.or(scene.backend.map(|b| (b.value.as_str(), b.at.origin))).unwrap_or_default();
    scene.any_backend || word != backend || !matches!(origin, Origin::File | Origin::Default)
}
