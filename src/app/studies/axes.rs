//! What a study varies: backends, degrees, levels, keys of the case; and the rows that follow.

use super::rows::{Base, Spec, slaves};
use crate::io::case::{Case, Changes, FilePart};
use std::collections::{BTreeMap, BTreeSet};

/// A key of the case and the values it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    /// As in `--set`: `patch.lower.degree`.
    pub key: String,
    /// Texts of the values.
    pub values: Vec<String>,
}

impl Vary {
    /// Reads `KEY=v1,v2`; commas inside brackets, braces and quotes belong to a value.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not KEY=v1,v2, such as patch.lower.degree=2,3");
        let (key, values) = text.split_once('=').ok_or_else(wrong)?;
        let values = split(values);
        if key.trim().is_empty() || values.is_empty() || values.iter().any(String::is_empty) {
            return Err(wrong());
        }
        Ok(Self { key: key.trim().to_owned(), values })
    }
}

/// The parts of a list between commas outside brackets, braces, parentheses and quotes, without spaces around them.
pub fn split(text: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quote) = (vec![String::new()], 0_i32, None);
    for c in text.chars() {
        match (quote, c) {
            (Some(open), _) => quote = (c != open).then_some(open),
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth -= 1,
            (None, ',') if depth <= 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().expect("there is a first part").push(c);
    }
    parts.iter().map(|p| p.trim().to_owned()).collect()
}

/// Degrees of all backends, or of single ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Degrees {
    /// For every backend without degrees of its own.
    pub all: Vec<usize>,
    /// Of single backends.
    pub of: Vec<(String, Vec<usize>)>,
}

impl Degrees {
    /// Adds `1,2,3` or `iga:2,3,4`.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn add(&mut self, text: &str) -> Result<(), String> {
        let wrong = || format!("`{text}` is no list of degrees, such as 1,2,3 or iga:2,3,4");
        let (backend, list) = match text.split_once(':') {
            Some((backend, list)) => (Some(backend.trim()), list),
            None => (None, text),
        };
        let degrees: Result<Vec<usize>, _> = list.split(',').map(|p| p.trim().parse::<usize>()).collect();
        let degrees = degrees.ok().filter(|list| list.iter().all(|p| (1..=12).contains(p))).ok_or_else(wrong)?;
        match backend {
            None if self.all.is_empty() => self.all = degrees,
            Some(name) if !name.is_empty() && !self.of.iter().any(|(known, _)| known == name) => self.of.push((name.to_owned(), degrees)),
            Some("") => return Err(wrong()),
            _ => return Err(format!("`{text}` gives degrees a second time")),
        }
        Ok(())
    }

    /// The degrees of a backend; empty: as written.
    fn list(&self, backend: &str) -> &[usize] {
        self.of.iter().find(|(name, _)| name == backend).map_or(&self.all, |(_, list)| list)
    }
}

/// Everything a study varies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Axes {
    /// Names of backends, `SLAVE+MASTER` for one on slave patches and the other elsewhere.
    pub backends: Vec<String>,
    /// Whether a case that mixes backends has a row as it is written, before `backends`.
    pub as_written: bool,
    /// Degrees; none: as written.
    pub degrees: Degrees,
    /// Number of levels, at least 1; level k halves every element k times.
    pub levels: usize,
    /// Keys of the case, the first one slowest.
    pub vary: Vec<Vary>,
}

impl Axes {
    /// All rows: keys slowest, then backends, degrees, levels. A case that cannot be read with some values of its keys gives
    /// rows that cannot be read either.
    pub fn rows(&self, base: &Base<'_>) -> Vec<Spec> {
        let mut rows = Vec::new();
        for vary in combinations(&self.vary) {
            let start = Spec { vary, ..Spec::default() };
            let written = base.read(&start).ok();
            let mixed = written.as_ref().is_some_and(mixes);
            let first = (self.as_written && mixed || self.backends.is_empty()).then_some(None);
            for backend in first.into_iter().chain(self.backends.iter().map(|b| Some(b.as_str()))) {
                let of_patches = written.as_ref().map(|case| (wanted(backend, case), used_by(backend, case)));
                let mut used: Vec<&str> = Vec::new();
                match &of_patches {
                    Some((_, list)) => list.iter().for_each(|(_, b)| {
                        if !used.contains(&b.as_str()) {
                            used.push(b);
                        }
                    }),
                    None => used.extend(backend),
                }
                // the k-th degree of each backend together; a row is left out where one has no k-th degree and does not stay as written
                let longest = used.iter().map(|b| self.degrees.list(b).len()).max().unwrap_or(0);
                for k in (0..longest.max(1)).filter(|k| used.iter().all(|b| matches!(self.degrees.list(b).len(), n if n == 0 || *k < n))) {
                    let mut changes = Changes::default();
                    match (&of_patches, backend) {
                        (_, Some(name)) if !name.contains('+') => changes.backend = Some(name.to_owned()),
                        (Some((list, _)), Some(_)) => changes.backends = list.clone(),
                        _ => {}
                    }
                    let degree = |b: &str| self.degrees.list(b).get(k).copied();
                    let degrees: Vec<Option<usize>> = used.iter().map(|b| degree(b)).collect();
                    if degrees.iter().all(|p| *p == degrees[0]) {
                        changes.degree = degrees.first().copied().flatten();
                    } else if let Some((_, list)) = &of_patches {
                        changes.degrees = list.iter().filter_map(|(patch, b)| Some((patch.clone(), degree(b)?))).collect();
                    }
                    for level in 0..self.levels.max(1) {
                        rows.push(Spec {
                            backend: backend.map(str::to_owned),
                            degree: k,
                            level,
                            changes: Changes { level, ..changes.clone() },
                            ..start.clone()
                        });
                    }
                }
            }
        }
        rows
    }
}

/// The backend that a row wants of every block of patches, by the name of the block.
fn wanted(backend: Option<&str>, case: &Case) -> Vec<(String, String)> {
    let slave = slaves(case);
    let on_slaves: BTreeSet<&str> = case.patches.iter().zip(&slave).filter(|(_, slave)| **slave).map(|(p, _)| block(&p.name)).collect();
    let mut known = BTreeSet::new();
    let mut list: Vec<(String, String)> = Vec::new();
    for p in &case.patches {
        let name = block(&p.name);
        if !known.insert(name) {
            continue;
        }
        let word = match backend.map(|b| b.split_once('+').unwrap_or((b, b))) {
            None => &p.discretization.backend.value,
            Some((of_slaves, _)) if on_slaves.contains(name) => of_slaves,
            Some((_, elsewhere)) => elsewhere,
        };
        list.push((name.to_owned(), word.to_owned()));
    }
    list
}

/// What becomes of it: blocks that are read from a mesh stay as they are.
fn used_by(backend: Option<&str>, case: &Case) -> Vec<(String, String)> {
    let read = case.patches.iter().filter(|p| p.geometry.shape.part().is_some_and(FilePart::is_mesh));
    let stay: BTreeMap<&str, &str> = read.map(|p| (block(&p.name), p.discretization.backend.value.as_str())).collect();
    let mut list = wanted(backend, case);
    for (name, word) in &mut list {
        if let Some(stays) = stay.get(name.as_str()) {
            *word = (*stays).to_owned();
        }
    }
    list
}

/// The name of the block of a patch: `NAME` of `NAME.0`, which is a patch of a file.
fn block(patch: &str) -> &str {
    patch.split('.').next().unwrap_or(patch)
}

/// Whether the patches of a case have several backends.
fn mixes(case: &Case) -> bool {
    case.patches.windows(2).any(|p| p[0].discretization.backend.value != p[1].discretization.backend.value)
}

/// Every combination of values, the first key slowest; one empty combination without keys.
fn combinations(vary: &[Vary]) -> Vec<Vec<(String, String)>> {
    let Some((first, rest)) = vary.split_first() else { return vec![Vec::new()] };
    let inner = combinations(rest);
    let with = |value: &String| {
        let head = (first.key.clone(), value.clone());
        inner.iter().map(|more| std::iter::once(head.clone()).chain(more.iter().cloned()).collect()).collect::<Vec<_>>()
    };
    first.values.iter().flat_map(with).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn commas_inside_brackets_and_quotes_do_not_separate() {
        assert_eq!(split("2, [3, 2],\"a,b\""), ["2", "[3, 2]", "\"a,b\""]);
        assert_eq!(split("u.y at [1, 0.5] in upper,energy"), ["u.y at [1, 0.5] in upper", "energy"]);
        assert!(Vary::parse("let.a").is_err());
        assert!(Vary::parse("let.a=1,,2").is_err());
    }

    #[test]
    fn degrees_are_of_all_backends_or_of_one() {
        let mut degrees = Degrees::default();
        degrees.add("1,2").unwrap();
        degrees.add("iga:2,3,4").unwrap();
        assert_eq!((degrees.list("fe"), degrees.list("iga")), (&[1, 2][..], &[2, 3, 4][..]));
        for wrong in ["3", "iga:2", ":2", "fe:", "fe:0", "fe:13", "fe:x"] {
            assert!(degrees.add(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_first_key_is_the_slowest() {
        let vary = [Vary::parse("a=1,2").unwrap(), Vary::parse("b=x,y").unwrap()];
        let all: Vec<String> = combinations(&vary).iter().map(|c| c.iter().map(|(k, v)| format!("{k}{v}")).collect()).collect();
        assert_eq!(all, ["a1bx", "a1by", "a2bx", "a2by"]);
    }
}
