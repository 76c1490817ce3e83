//! Two materials that meet on an arc, tied with grids that do not match, against one body of FEniCSx.

use crate::cases::values as found;
use crate::document::{all_known, document};
use serde_json::Value;

/// How the two rings are discretised and tied.
struct Tie {
    name: &'static str,
    inner: &'static str,
    outer: &'static str,
    mapping: &'static str,
    degree: usize,
    coupling: Coupling,
}

#[derive(Clone, Copy, PartialEq)]
enum Coupling {
    /// Multipliers of the degree of the slave's trace.
    Equal,
    /// Of two degrees less, the default.
    Lower,
    Nitsche,
}

fn ties() -> Vec<Tie> {
    let tie = |name, inner, outer, mapping, degree, coupling| Tie { name, inner, outer, mapping, degree, coupling };
    use Coupling::{Equal, Lower, Nitsche};
    vec![
        tie("iga-iga p/p", "iga", "iga", "exact", 2, Equal),
        tie("iga-iga p/p", "iga", "iga", "exact", 3, Equal),
        tie("iga-iga p/p-2", "iga", "iga", "exact", 2, Lower),
        tie("iga-iga p/p-2", "iga", "iga", "exact", 3, Lower),
        tie("fe-fe p/p", "fe", "fe", "exact", 1, Equal),
        tie("fe-fe p/p", "fe", "fe", "exact", 2, Equal),
        tie("fe-fe p/p", "fe", "fe", "isoparametric", 2, Equal),
        tie("fe-fe p/p-2", "fe", "fe", "exact", 2, Lower),
        tie("fe-fe p/p", "fe", "fe", "exact", 3, Equal),
        tie("iga-fe p/p", "iga", "fe", "exact", 2, Equal),
        tie("fe-iga p/p-2", "fe", "iga", "exact", 3, Lower),
        tie("iga-fe nitsche", "iga", "fe", "exact", 2, Nitsche),
        tie("iga-fe nitsche", "iga", "fe", "exact", 3, Nitsche),
    ]
}

/// A kind of quantities: texts, values and the greatest error of the reference.
struct Kind {
    name: &'static str,
    texts: Vec<String>,
    values: Vec<f64>,
    error: f64,
}

const KINDS: [&str; 5] = ["energy", "u", "stress", "flux", "lambda"];

fn kinds(part: &Value) -> Vec<Kind> {
    KINDS
        .iter()
        .filter(|&name| part[*name].is_array())
        .map(|name| (name, all_known(&part[*name])))
        .map(|(name, list)| Kind {
            name,
            texts: list.iter().map(|q| q.quantity.clone()).collect(),
            values: list.iter().map(|q| q.value).collect(),
            error: list.iter().map(|q| q.error).fold(0.0, f64::max),
        })
        .collect()
}

/// The root of the mean square.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (values.map(|v| v * v).sum::<f64>() / count).sqrt()
}

/// The differences to the reference on one level, by kind.
fn differences(part: &Value, tie: &Tie, kinds: &[Kind], level: usize) -> Vec<Vec<f64>> {
    let mut sets = vec![
        format!("discretization.degree={}", tie.degree),
        format!("discretization.mapping={}", tie.mapping),
        format!("patch.inner.backend={}", tie.inner),
        format!("patch.outer.backend={}", tie.outer),
        format!("patch.inner.refine={level}"),
        format!("patch.outer.refine={level}"),
    ];
    sets.push(match tie.coupling {
        Coupling::Equal => "interface.arc.multiplier=p/p".into(),
        Coupling::Lower => "interface.arc.multiplier=p/p-2".into(),
        Coupling::Nitsche => "interface.arc.coupling=nitsche".into(),
    });
    let texts: Vec<String> = kinds.iter().flat_map(|k| k.texts.clone()).collect();
    let values = found(part["case"].as_str().unwrap(), &sets, &texts);
    assert_eq!(values.len(), texts.len());
    let mut rest = values.as_slice();
    kinds
        .iter()
        .map(|k| {
            let (own, after) = rest.split_at(k.values.len());
            rest = after;
            own.iter().zip(&k.values).map(|(a, b)| a - b).collect()
        })
        .collect()
}

/// The least order that theory gives for a kind of quantities at degree p.
///
/// The energy of a tie by Nitsche's method is that of the bodies alone; what the terms on the arc take is left out of it.
/// Multipliers of degree p-2 and what is computed beside them on the arc have order p-1.
fn least_order(kind: &str, tie: &Tie) -> f64 {
    let p = tie.degree as f64;
    match (kind, tie.coupling) {
        ("energy", Coupling::Equal) => 2.0 * p,
        ("energy", Coupling::Lower) => 2.0 * p - 1.0,
        ("energy", Coupling::Nitsche) => p,
        ("u", _) => p + 1.0,
        ("lambda" | "stress" | "flux", Coupling::Lower) => p - 1.0,
        ("lambda", _) => p - 0.5,
        ("stress" | "flux", _) => p,
        _ => unreachable!("{kind}"),
    }
}

fn approaches(part: &Value, margin: f64) {
    let kinds = kinds(part);
    for tie in ties() {
        let levels: Vec<Vec<Vec<f64>>> = (0..=3).map(|level| differences(part, &tie, &kinds, level)).collect();
        for (k, kind) in kinds.iter().enumerate() {
            // what is not well above the reference's own error says nothing
            let seen: Vec<f64> = levels.iter().map(|d| mean(d[k].iter().copied())).take_while(|e| *e > 3.0 * kind.error).collect();
            assert!(seen.len() >= 2, "{} {}: {} of the reference is too coarse", tie.name, tie.degree, kind.name);
            let rates: Vec<f64> = seen.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
            // points lie anywhere in the elements of a level: means where that shows, over more rates where the points are few
            let last = match kind.name {
                "u" => rates.len(),
                "stress" | "flux" => 1,
                _ => 2,
            };
            let tail = &rates[rates.len().saturating_sub(last)..];
            let observed = tail.iter().sum::<f64>() / tail.len() as f64;
            let least = least_order(kind.name, &tie);
            println!(
                "{} {} degree {} {:8} {} rates {rates:.2?}: {observed:.2}, theory {least}",
                part["case"].as_str().unwrap(),
                tie.name,
                tie.degree,
                kind.name,
                seen.iter().map(|e| format!("{e:.2e} ")).collect::<String>()
            );
            assert!(observed > least - margin, "{} {} {}: {rates:?}", tie.name, tie.degree, kind.name);
            // as near as its own last step says, by half the order
            let last = seen.len() - 1;
            let own = mean(levels[last][k].iter().zip(&levels[last - 1][k]).map(|(a, b)| a - b)) / ((0.5 * least).exp2() - 1.0);
            let error = seen[last];
            assert!(error <= own + kind.error, "{} {} {}: {error:e}, own estimate {own:e}", tie.name, tie.degree, kind.name);
            // a rate beyond 2p would show that the values meet by chance
            if kind.name == "energy" && tie.coupling == Coupling::Equal {
                assert!((rates.last().unwrap() - least).abs() < margin, "{} {}: {rates:?}", tie.name, tie.degree);
            }
        }
    }
}

#[test]
fn tied_rings_of_two_materials_approach_one_elastic_body() {
    let known = document("interface");
    approaches(&known["elasticity"], known["margin"].as_f64().unwrap());
}

#[test]
fn tied_rings_of_two_conductivities_approach_one_body() {
    let known = document("interface");
    approaches(&known["poisson"], known["margin"].as_f64().unwrap());
}
