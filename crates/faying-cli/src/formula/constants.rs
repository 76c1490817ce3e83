//! Constants of `[let]`: numbers and formulas of one another in any order.

use std::collections::{BTreeMap, BTreeSet};

use super::{Formula, FormulaError, Scope};

/// Named numbers in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constants {
    values: Vec<(String, f64)>,
    index: BTreeMap<String, usize>,
}

/// Definition of a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum ConstantText {
    /// A number.
    Number(f64),
    /// A formula of other constants.
    Formula(String),
}

impl Constants {
    /// The value of a name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.index.get(name).map(|&k| self.values[k].1)
    }

    /// Adds or replaces a constant.
    pub fn insert(&mut self, name: &str, value: f64) {
        match self.index.get(name) {
            Some(&k) => self.values[k].1 = value,
            None => {
                self.index.insert(name.to_owned(), self.values.len());
                self.values.push((name.to_owned(), value));
            }
        }
    }

    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.values.iter().map(|(n, _)| n.as_str())
    }

    /// All names with their values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.values.iter().map(|(n, v)| (n.as_str(), *v))
    }

    /// Values of all definitions, in any order, and the errors with the index of their definition.
    ///
    /// A definition in error has no value, nor do those that use it; only the first is reported.
    pub fn resolve(definitions: &[(String, ConstantText)]) -> (Self, Vec<(usize, FormulaError)>) {
        let mut errors = Vec::new();
        let names: BTreeMap<&str, usize> = definitions.iter().enumerate().map(|(k, (n, _))| (n.as_str(), k)).collect();
        // names of other constants are read as quantities first
        let none = Self::default();
        let scope = Scope { variables: &[], constants: &none, quantities: Some(&[]) };
        let mut formulas: Vec<Option<Formula>> = Vec::with_capacity(definitions.len());
        let mut waits: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); definitions.len()];
        let mut feeds: Vec<Vec<usize>> = vec![Vec::new(); definitions.len()];
        for (k, (_, text)) in definitions.iter().enumerate() {
            let parsed = match text {
                ConstantText::Number(v) => Ok(Formula::constant(*v)),
                ConstantText::Formula(text) => Formula::parse(text, &scope).and_then(|f| {
                    for q in f.quantities() {
                        match names.get(q.text.as_str()) {
                            Some(&j) => {
                                if waits[k].insert(j) {
                                    feeds[j].push(k);
                                }
                            }
                            None => {
                                let near = crate::errors::nearest(&q.text, names.keys().copied());
                                let hint = near.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                                let message = format!("unknown constant `{}`{hint}", q.text);
                                return Err(FormulaError::new(message, q.offset, q.length)
                                    .with_help("formulas of [let] are made of numbers, pi, e and other names of [let]"));
                            }
                        }
                    }
                    Ok(f)
                }),
            };
            formulas.push(parsed.map_err(|e| errors.push((k, e))).ok());
        }
        let mut values: Vec<Option<f64>> = vec![None; definitions.len()];
        let mut ready: Vec<usize> = (0..definitions.len()).filter(|&k| waits[k].is_empty()).collect();
        let mut done = vec![false; definitions.len()];
        while let Some(k) = ready.pop() {
            done[k] = true;
            values[k] = formulas[k].as_ref().and_then(|f| {
                let given: Option<Vec<f64>> = f.quantities().iter().map(|q| names.get(q.text.as_str()).and_then(|&j| values[j])).collect();
                let v = f.value_with(1.0, &given?);
                if !v.is_finite() {
                    errors.push((k, FormulaError::new(format!("the value of `{}` is not finite", definitions[k].0), 0, 1)));
                    return None;
                }
                Some(v)
            });
            for &j in &feeds[k] {
                waits[j].remove(&k);
                if waits[j].is_empty() {
                    ready.push(j);
                }
            }
        }
        if let Some(first) = (0..definitions.len()).find(|&k| !done[k] && formulas[k].is_some()) {
            let cycle = cycle_from(first, &waits);
            let path: Vec<&str> = cycle.iter().take(12).map(|&k| definitions[k].0.as_str()).collect();
            let closed = format!("{} -> {}", path.join(" -> "), path.first().copied().unwrap_or(""));
            errors.push((cycle[0], FormulaError::new(format!("constants of [let] define each other: {closed}"), 0, 1)));
        }
        let mut out = Self::default();
        for (k, (name, _)) in definitions.iter().enumerate() {
            if let Some(v) = values[k] {
                out.insert(name, v);
            }
        }
        errors.sort_by_key(|(k, _)| *k);
        (out, errors)
    }
}

// follows the dependencies from `start` until one repeats
fn cycle_from(start: usize, waits: &[BTreeSet<usize>]) -> Vec<usize> {
    let mut path = vec![start];
    let mut seen = BTreeMap::from([(start, 0)]);
    let mut at = start;
    while let Some(&next) = waits[at].iter().next() {
        if let Some(&k) = seen.get(&next) {
            return path.split_off(k);
        }
        seen.insert(next, path.len());
        path.push(next);
        at = next;
    }
    path
}
