//! Tables and lists of tables of the document.

use super::{Block, Reader};
use crate::case::key::Key;
use crate::case::tree::{Node, Table, Value};

impl Reader {
    /// `[key]`: an absent section is an empty one, unless it is required.
    pub fn section<T>(
        &mut self,
        root: &mut Block,
        key: &str,
        known: &[Key],
        required: bool,
        read: impl FnOnce(&mut Self, &mut Block) -> T,
    ) -> Option<T> {
        let node = match root.node(key).cloned() {
            Some(node) if matches!(node.value, Value::Table(_)) => node,
            Some(node) => {
                self.fault("E014", node.at, format!("`{key}` must be a table, found {}", node.describe()), format!("write [{key}]"));
                return None;
            }
            None if required => {
                self.fault(
                    "E013",
                    self.source.lines.place(0..0),
                    format!("[{key}] is missing in the case"),
                    format!("keys of [{key}]: {}", known.iter().filter(|k| !k.is_later()).map(|k| k.name).collect::<Vec<_>>().join(", ")),
                );
                return None;
            }
            None => {
                let at = root.default(key, Value::Table(Table::default()));
                Node::new(Value::Table(Table::default()), at)
            }
        };
        let mut b = self.block(&node, &format!("[{key}]"), known)?;
        let value = read(self, &mut b);
        root.replace(key, b.finish());
        Some(value)
    }

    /// `[[key]]`.
    pub fn list<T>(
        &mut self,
        root: &mut Block,
        key: &str,
        known: &[Key],
        mut read: impl FnMut(&mut Self, &mut Block, usize) -> T,
    ) -> Vec<T> {
        if root.meant.contains(&key) {
            self.broken.insert(key.to_owned());
        }
        let Some(node) = root.node(key).cloned() else { return Vec::new() };
        let wrong = |r: &mut Self, node: &Node| {
            r.broken.insert(key.to_owned());
            r.fault("E014", node.at, format!("`{key}` must be a list of tables, found {}", node.describe()), format!("write [[{key}]]"));
        };
        let Value::List(items) = &node.value else {
            wrong(self, &node);
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut tables = Vec::new();
        for (k, item) in items.iter().enumerate() {
            if !matches!(item.value, Value::Table(_)) {
                wrong(self, item);
                continue;
            }
            let named = matches!(&item.value, Value::Table(t) if t.get("name").is_some());
            let what = if named { key.to_owned() } else { format!("{key} {k}") };
            let Some(mut b) = self.block(item, &what, known) else { continue };
            out.push(read(self, &mut b, k));
            tables.push(Node { value: Value::Table(b.finish()), ..item.clone() });
        }
        if let Some(e) = root.table.get_mut(key) {
            e.node.value = Value::List(tables);
        }
        out
    }
}
