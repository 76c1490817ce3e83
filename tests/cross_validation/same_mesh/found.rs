//! What the library finds of a problem of one body.

use crate::answers::side;
use crate::cases::{Said, said, solved, solved_in_space};
use crate::setting::Setting;
use faying::basis::Cell;
use faying::problem::Solution;
use std::collections::BTreeMap;

/// What the library finds: values at the nodes of its cells, and numbers by name.
pub struct Found {
    pub points: Vec<[f64; 3]>,
    pub components: usize,
    pub values: Vec<f64>,
    pub unknowns: usize,
    pub energy: f64,
    pub reactions: BTreeMap<String, f64>,
    pub errors: BTreeMap<String, f64>,
    /// The library's name of a side that a case calls "left", "top", ...
    pub side: fn(&str) -> &str,
}

/// Nodes of a cell: equally spaced, `degree` + 1 along an edge.
fn nodes<const N: usize>(cell: Cell, degree: usize) -> Vec<[f64; N]> {
    let all = (0..(degree + 1).pow(N as u32)).map(|k| std::array::from_fn(|d| k / (degree + 1).pow(d as u32) % (degree + 1)));
    let inside = |k: &[usize; N]| cell == Cell::Tensor || k.iter().sum::<usize>() <= degree;
    all.filter(inside).map(|k| k.map(|k| k as f64 / degree as f64)).collect()
}

/// The numbers of a problem of one body.
fn of_setting<const S: usize, const N: usize>(setting: &Setting<S, N>, solution: &Solution<S, N>) -> Found {
    let body = &setting.bodies[0];
    let (space, components) = (body.body.space(), body.components);
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for element in 0..space.num_elements() {
        let xi = nodes::<N>(space.cell(element), space.degree(element)[0]);
        for state in solution.in_element(body.id, element, &xi).unwrap() {
            points.push(std::array::from_fn(|k| if k < N { state.x[k] } else { 0.0 }));
            values.extend(&state.u[..components]);
        }
    }
    let mut reactions = BTreeMap::new();
    for own in body.body.sides() {
        let forces = solution.reaction(body.id.side(&own)).unwrap();
        for (k, f) in forces.iter().enumerate() {
            let name = if components == 1 { format!("body.{own}") } else { format!("body.{own}.{}", ["x", "y", "z"][k]) };
            reactions.insert(name, *f);
        }
    }
    let mut errors = BTreeMap::new();
    if let Some(exact) = &setting.exact {
        let norms = solution.errors(&**exact)[0];
        let [own, whole] = [norms.error, norms.exact].map(|n| [n.l2, n.h1, n.energy]);
        for (k, norm) in ["L2", "H1", "energy"].iter().enumerate() {
            errors.insert(format!("error.u.{norm}"), own[k]);
            errors.insert(format!("error.u.{norm}.rel"), own[k] / whole[k]);
        }
    }
    let (unknowns, energy) = (solution.coefficients(body.id).unwrap().len(), solution.energy());
    Found { points, components, values, unknowns, energy, reactions, errors, side: side::<N> }
}

/// Solves a case with choices.
pub fn found(case: &str, sets: &[String]) -> Found {
    match said(case, sets) {
        Said::Plane(setting) => of_setting(&setting, &solved(&setting.problem)),
        Said::Space(setting) => of_setting(&setting, &solved_in_space(&setting.problem)),
    }
}
