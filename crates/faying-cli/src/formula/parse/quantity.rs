//! Quantities in formulas: `contact.pad.force.y`, `u.x at [1, 0] in upper`.

use super::{FormulaError, Op, Parsed, Parser, QuantityRef, continues_name, is_reserved};

/// Words behind the path of a quantity.
const CLAUSES: [&str; 5] = ["at", "about", "in", "cut", "to"];

impl Parser<'_> {
    // a name followed by a dot or a word such as `at`, or one without another meaning
    pub(super) fn is_quantity(&self, name: &str) -> bool {
        let mut k = self.at;
        if self.chars.get(k) == Some(&'.') {
            return true;
        }
        while self.chars.get(k).is_some_and(|c| c.is_whitespace()) {
            k += 1;
        }
        if CLAUSES.iter().any(|word| self.word_at(k, word)) {
            return true;
        }
        let open = self.chars.get(k) == Some(&'(');
        !open && (name == "g" || !is_reserved(name)) && self.scope.constants.get(name).is_none()
    }

    fn word_at(&self, at: usize, word: &str) -> bool {
        let n = word.len();
        word.chars().enumerate().all(|(k, c)| self.chars.get(at + k) == Some(&c))
            && !self.chars.get(at + n).is_some_and(|c| continues_name(*c))
    }

    // the text of a quantity: path, `at [..]` or `at TAG`, `about [..]`, `cut [..] to [..]`, `in PATCH`, `.min` and the like behind
    pub(super) fn quantity(&mut self, start: usize) -> Parsed {
        self.path()?;
        loop {
            let mark = self.at;
            self.skip();
            let Some(word) = CLAUSES.iter().find(|word| self.word_at(self.at, word)) else {
                self.at = mark;
                break;
            };
            self.at += word.len();
            self.skip();
            if self.peek() == Some('[') {
                let open = self.at;
                while self.peek().is_some_and(|c| c != ']') {
                    self.at += 1;
                }
                if self.peek().is_none() {
                    return Err(FormulaError::new("a closing bracket `]` is missing", open, 1));
                }
                self.at += 1;
            } else if !self.segment() {
                return Err(FormulaError::new(format!("a point [x, y] or a name is expected behind `{word}`"), self.at, 1));
            }
            self.path()?;
        }
        let text: String = self.chars[start..self.at].iter().collect();
        let index = self.quantities.iter().position(|q| q.text == text).unwrap_or_else(|| {
            self.quantities.push(QuantityRef { text, offset: start, length: self.at - start });
            self.quantities.len() - 1
        });
        self.skip();
        self.out.push(Op::Quantity(index));
        Ok(())
    }

    fn path(&mut self) -> Parsed {
        while self.peek() == Some('.') {
            self.at += 1;
            if !self.segment() {
                return Err(FormulaError::new("a name is expected behind `.`", self.at, 1));
            }
        }
        Ok(())
    }

    // one name of a path; names of the case may hold `-`, which else is a minus
    fn segment(&mut self) -> bool {
        if self.peek() == Some('"') {
            let Some(n) = self.chars[self.at + 1..].iter().position(|c| *c == '"') else { return false };
            self.at += n + 2;
            return true;
        }
        let names = self.scope.quantities.unwrap_or(&[]);
        let ends = |n: usize| !self.chars.get(self.at + n).is_some_and(|c| continues_name(*c));
        let known = names
            .iter()
            .map(|n| n.chars().collect::<Vec<char>>())
            .filter(|n| self.chars[self.at..].starts_with(n) && ends(n.len()))
            .map(|n| n.len())
            .max()
            .unwrap_or(0);
        let mut n = 0;
        while self.chars.get(self.at + n).is_some_and(|c| continues_name(*c)) {
            n += 1;
        }
        self.at += n.max(known);
        n.max(known) > 0
    }
}
