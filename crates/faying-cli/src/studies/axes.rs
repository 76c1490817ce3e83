//! Axes of a study, and the rows that they span.

use super::choice::{Degrees, Vary};
use super::rows::{Base, Spec, slaves};
use crate::case::{Case, Changes};
use crate::registry::Registry;
use std::collections::{BTreeMap, BTreeSet};

/// Most rows of a study.
pub const MOST_ROWS: usize = 10_000;

/// Axes of a study; an empty list leaves the case as written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Axes {
    /// Names of backends, `SLAVE+MASTER` for one on slave patches and the other elsewhere.
    pub backends: Vec<String>,
    /// Whether a case with several backends has a row as written, before `backends`.
    pub as_written: bool,
    /// Degrees.
    pub degrees: Degrees,
    /// Multipliers of all interfaces and contacts.
    pub pairings: Vec<String>,
    /// Their integrations.
    pub integrations: Vec<String>,
    /// Extra Gauss points per segment.
    pub extra_points: Vec<usize>,
    /// Number of levels, at least 1; level k halves every element k times.
    pub levels: usize,
    /// Keys of the case, the first one slowest.
    pub vary: Vec<Vary>,
}

/// The entries of an axis, or a single `None` if it is empty.
fn each<T: Clone>(values: &[T]) -> Vec<Option<T>> {
    if values.is_empty() { vec![None] } else { values.iter().cloned().map(Some).collect() }
}

impl Axes {
    /// All rows: keys slowest, then backends, degrees, multipliers, integrations, points, levels. A case that cannot be read with some
    /// values of its keys gives rows that cannot be read either.
    ///
    /// # Errors
    /// The number of combinations if it is more than [`MOST_ROWS`].
    pub fn rows(&self, base: &Base<'_>, registry: &Registry) -> Result<Vec<Spec>, usize> {
        let lists = [self.backends.len() + 1, self.pairings.len(), self.integrations.len(), self.extra_points.len(), self.levels];
        let lists = lists.into_iter().chain(self.vary.iter().map(|v| v.values.len()));
        let most = lists.map(|n| n.max(1)).try_fold(1_usize, usize::checked_mul).unwrap_or(usize::MAX);
        // degrees and the row as written change this by a small factor; the exact number is checked below
        if most > 2 * MOST_ROWS {
            return Err(most);
        }
        let mut rows = Vec::new();
        for vary in combinations(&self.vary) {
            let start = Spec { vary, ..Spec::default() };
            let written = base.read(&start).ok();
            for (backend, degree, changes) in self.discretizations(written.as_ref(), registry) {
                let start = Spec { backend, degree, changes, ..start.clone() };
                for pairing in each(&self.pairings) {
                    for integration in each(&self.integrations) {
                        for extra_points in each(&self.extra_points) {
                            let changes = Changes {
                                pairing: pairing.clone(),
                                integration: integration.clone(),
                                extra_points,
                                ..start.changes.clone()
                            };
                            rows.extend((0..self.levels.max(1)).map(|level| Spec {
                                level,
                                changes: Changes { level, ..changes.clone() },
                                ..start.clone()
                            }));
                            if rows.len() > MOST_ROWS {
                                return Err(rows.len());
                            }
                        }
                    }
                }
            }
        }
        Ok(rows)
    }

    /// Backend, position on the axis of degrees, and their changes; for a case that cannot be read, changes of all patches alone.
    fn discretizations(&self, written: Option<&Case>, registry: &Registry) -> Vec<(Option<String>, usize, Changes)> {
        let mut list = Vec::new();
        let mixed = written.is_some_and(mixes);
        let pairs = self.backends.iter().any(|b| b.contains('+'));
        let slave = written.filter(|_| pairs).map_or(Vec::new(), |case| slaves(case, registry));
        let first = (self.as_written && mixed || self.backends.is_empty()).then_some(None);
        for backend in first.into_iter().chain(self.backends.iter().map(|b| Some(b.as_str()))) {
            let of_patches = written.map(|case| (wanted(backend, case, &slave), used_by(backend, case, &slave)));
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
                list.push((backend.map(str::to_owned), k, changes));
            }
        }
        list
    }
}

/// The backend that a row requests for every block of patches, by the name of the block.
fn wanted(backend: Option<&str>, case: &Case, slave: &[bool]) -> Vec<(String, String)> {
    let on_slaves: BTreeSet<&str> = case.patches.iter().zip(slave).filter(|(_, slave)| **slave).map(|(p, _)| block(&p.name)).collect();
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

/// The backend that every block of patches gets: that of [`wanted`], except that blocks read from a mesh keep theirs.
fn used_by(backend: Option<&str>, case: &Case, slave: &[bool]) -> Vec<(String, String)> {
    let read = case.patches.iter().filter(|p| p.geometry.shape.mesh_part().is_some());
    let stay: BTreeMap<&str, &str> = read.map(|p| (block(&p.name), p.discretization.backend.value.as_str())).collect();
    let mut list = wanted(backend, case, slave);
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
    fn the_first_key_is_the_slowest() {
        let vary = [Vary::parse("a=1,2").unwrap(), Vary::parse("b=x,y").unwrap()];
        let all: Vec<String> = combinations(&vary).iter().map(|c| c.iter().map(|(k, v)| format!("{k}{v}")).collect()).collect();
        assert_eq!(all, ["a1bx", "a1by", "a2bx", "a2by"]);
    }

    #[test]
    fn rows_are_counted_before_they_are_made() {
        let base = Base { name: "a", text: "", options: crate::case::ReadOptions::default() };
        let key = |k: usize| Vary { key: format!("let.a{k}"), values: (0..100).map(|v| v.to_string()).collect() };
        let axes = Axes { levels: 1, vary: (0..20).map(key).collect(), ..Axes::default() };
        assert_eq!(axes.rows(&base, &Registry::default()).unwrap_err(), usize::MAX);
        let axes = Axes { levels: 2, pairings: ["p/p", "p/p-2"].map(String::from).to_vec(), extra_points: vec![0, 4], ..Axes::default() };
        let rows = axes.rows(&base, &Registry::default()).unwrap();
        let place = |r: &Spec| (r.changes.pairing.clone().unwrap(), r.changes.extra_points.unwrap(), r.changes.level);
        assert_eq!(rows.len(), 8);
        assert_eq!(
            [place(&rows[0]), place(&rows[3]), place(&rows[7])],
            [("p/p".into(), 0, 0), ("p/p".into(), 4, 1), ("p/p-2".into(), 4, 1)]
        );
        assert!(rows[0].same_line(&rows[1]) && !rows[1].same_line(&rows[2]) && !rows[3].same_line(&rows[4]));
    }
}
