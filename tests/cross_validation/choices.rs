//! Choices of a run, as the documents write them: `path=value`. What nothing asks for is an error.

use faying::basis::Cell;
use faying::space::{BasisKind, Divisions, Mapping};
use std::cell::RefCell;
use std::collections::BTreeSet;

/// Texts `path=value`; of several with one path the last one holds.
#[derive(Debug)]
pub struct Choices {
    all: Vec<(String, String)>,
    asked: RefCell<BTreeSet<String>>,
}

/// Discretisation of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretisation {
    /// Lagrange cells; else splines.
    pub is_fe: bool,
    pub degree: usize,
    pub cells: Cell,
    pub mapping: Mapping,
    pub basis: BasisKind,
    pub continuity: Option<usize>,
    pub extra_points: usize,
}

impl Default for Discretisation {
    fn default() -> Self {
        Self {
            is_fe: false,
            degree: 2,
            cells: Cell::Tensor,
            mapping: Mapping::Isoparametric,
            basis: BasisKind::Auto,
            continuity: None,
            extra_points: 0,
        }
    }
}

impl Discretisation {
    /// Lagrange cells of degree 2.
    pub fn fe() -> Self {
        Self { is_fe: true, ..Self::default() }
    }
}

impl Choices {
    /// Reads texts `path=value`.
    pub fn of(texts: &[String]) -> Self {
        let one = |text: &String| {
            let (path, value) = text.split_once('=').unwrap_or_else(|| panic!("{text}"));
            (path.to_owned(), value.to_owned())
        };
        Self { all: texts.iter().map(one).collect(), asked: RefCell::default() }
    }

    /// The value of a path.
    pub fn word(&self, path: &str) -> Option<&str> {
        self.asked.borrow_mut().insert(path.to_owned());
        self.all.iter().rev().find(|(known, _)| known == path).map(|(_, value)| &**value)
    }

    /// The number of a path, if it is given, else `default`.
    pub fn number(&self, path: &str, default: f64) -> f64 {
        self.word(path).map_or(default, |word| word.parse().unwrap_or_else(|e| panic!("{path}={word}: {e}")))
    }

    /// The discretisation of a body: its own choices stand before those of all bodies, these before `default`.
    pub fn discretisation(&self, body: &str, default: Discretisation) -> Discretisation {
        let word = |key: &str| {
            let all = self.word(&format!("discretization.{key}"));
            self.word(&format!("patch.{body}.{key}")).or(all)
        };
        let count = |key: &str, default: usize| word(key).map_or(default, |w| w.parse().unwrap());
        Discretisation {
            is_fe: word("backend").map_or(default.is_fe, |w| one_of(w, ["iga", "fe"]) == 1),
            degree: count("degree", default.degree),
            cells: word("cells").map_or(default.cells, |w| [Cell::Tensor, Cell::Simplex][one_of(w, ["tensor", "simplex"])]),
            mapping: word("mapping")
                .map_or(default.mapping, |w| [Mapping::Isoparametric, Mapping::Exact][one_of(w, ["isoparametric", "exact"])]),
            extra_points: count("extra_points", default.extra_points),
            ..default
        }
    }

    /// Elements per direction of a body, and how often they are halved.
    pub fn elements<const N: usize>(&self, body: &str, default: [Divisions; N]) -> ([Divisions; N], usize) {
        let mut elements = default;
        if let Some(word) = self.word(&format!("patch.{body}.elements")) {
            let counts: Vec<usize> = word.trim_matches(['[', ']']).split(',').map(|n| n.trim().parse().unwrap()).collect();
            assert_eq!(counts.len(), N, "{word}");
            elements = std::array::from_fn(|k| Divisions::Total(counts[k]));
        }
        for (k, own) in elements.iter_mut().enumerate() {
            if let Some(word) = self.word(&format!("patch.{body}.elements.{k}")) {
                *own = Divisions::Total(word.parse().unwrap());
            }
        }
        (elements, self.number(&format!("patch.{body}.refine"), 0.0) as usize)
    }

    /// Fails if there is a choice that nothing asked for.
    pub fn all_were_asked(&self) {
        let asked = self.asked.borrow();
        let missed: Vec<_> = self.all.iter().filter(|(path, _)| !asked.contains(path)).collect();
        assert!(missed.is_empty(), "nothing asked for {missed:?}");
    }
}

/// The place of a word among those that are allowed.
pub fn one_of<const K: usize>(word: &str, allowed: [&str; K]) -> usize {
    allowed.iter().position(|known| *known == word).unwrap_or_else(|| panic!("`{word}` is none of {allowed:?}"))
}
