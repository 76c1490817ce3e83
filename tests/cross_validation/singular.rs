//! Corners with a singularity, against graded meshes of FEniCSx: a corner of 270 degrees and Cook's membrane.

use crate::answers::Answers;
use crate::cases::{Said, said, solved, values as found};
use crate::document::{Known, all_known as known, document, texts};
use serde_json::Value;

/// One way to discretise a case, refined uniformly.
struct Study {
    name: &'static str,
    sets: Vec<String>,
    degree: usize,
    levels: std::ops::RangeInclusive<usize>,
    /// The spaces are nested subspaces of the problem's own, so that energies rise to the exact one.
    nested: bool,
}

/// Splines and elements in glued patches or one.
fn nested(levels: impl Fn(usize) -> std::ops::RangeInclusive<usize>) -> Vec<Study> {
    let mut all = Vec::new();
    for (backend, degree, name) in [("iga", 2, "iga 2"), ("iga", 3, "iga 3"), ("iga", 4, "iga 4"), ("fe", 2, "fe 2"), ("fe", 3, "fe 3")] {
        let levels = levels(degree);
        all.push(Study { name, sets: vec![format!("discretization.backend={backend}")], degree, levels, nested: true });
    }
    all
}

/// Patches tied where their grids do not match; both interfaces end in the corner.
fn tied() -> Vec<Study> {
    let mut all = Vec::new();
    for (name, backends, degree, coupling) in [
        ("iga-iga 2, p/p-2", ["iga"; 3], 2, "mortar"),
        ("fe-iga-fe 3, p/p-2", ["fe", "iga", "fe"], 3, "mortar"),
        ("fe-iga-fe 2, p/p", ["fe", "iga", "fe"], 2, "mortar,multiplier=p/p"),
        ("iga-fe-iga 2, nitsche", ["iga", "fe", "iga"], 2, "nitsche"),
    ] {
        let mut sets: Vec<String> =
            ["lower", "corner", "right"].iter().zip(backends).map(|(p, b)| format!("patch.{p}.backend={b}")).collect();
        sets.push("patch.corner.elements=[6,6]".into());
        let (coupling, multiplier) = coupling.split_once(',').unwrap_or((coupling, ""));
        sets.push(format!("interface.cuts.coupling={coupling}"));
        sets.extend((!multiplier.is_empty()).then(|| format!("interface.cuts.{multiplier}")));
        all.push(Study { name, sets, degree, levels: if degree == 2 { 3..=4 } else { 2..=3 }, nested: false });
    }
    all
}

/// Differences of a level to the reference, value by value.
struct Kind {
    name: &'static str,
    differences: Vec<f64>,
    /// The greatest error of the reference.
    uncertain: f64,
}

/// What one level found: the energy, and the other quantities by kind.
struct Level {
    energy: f64,
    kinds: Vec<Kind>,
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| if v.is_nan() { v } else { m.max(v.abs()) })
}

fn level(part: &Value, study: &Study, patches: &[&str], refine: usize) -> Level {
    let mut sets = texts(&part["sets"]);
    sets.extend(study.sets.iter().cloned());
    sets.push(format!("discretization.degree={}", study.degree));
    sets.extend(patches.iter().map(|p| format!("patch.{p}.refine={refine}")));
    let kinds: Vec<(&str, Vec<Known>)> =
        ["u", "stress", "flux"].iter().filter(|k| part[**k].is_array()).map(|k| (*k, known(&part[*k]))).collect();
    let sides = texts(&part["reaction_sides"]);
    let mut quantities = vec!["energy".to_owned()];
    quantities.extend(kinds.iter().flat_map(|(_, list)| list.iter().map(|q| q.quantity.clone())));
    quantities.extend(sides.iter().map(|s| format!("reaction.{s}")));
    let values = found(part["case"].as_str().unwrap(), &sets, &quantities);
    assert_eq!(values.len(), quantities.len());
    let mut at = 1;
    let mut found = Vec::new();
    for (name, list) in kinds {
        let differences = list.iter().zip(&values[at..]).map(|(q, v)| v - q.value).collect();
        at += list.len();
        found.push(Kind { name, differences, uncertain: largest(list.iter().map(|q| q.error)) });
    }
    if !sides.is_empty() {
        let (total, reaction) = (values[at..].iter().sum::<f64>(), &known(&part["reaction"])[0]);
        found.push(Kind { name: "reaction", differences: vec![total - reaction.value], uncertain: reaction.error });
    }
    Level { energy: values[0], kinds: found }
}

fn short(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.3e} ")).collect()
}

/// Energies approach the reference with twice the exponent, not slower and not faster.
fn converges(part: &Value, margin: f64, study: &Study, patches: &[&str]) {
    let order = 2.0 * part["exponent"].as_f64().unwrap();
    let energy = &known(&part["energy"])[0];
    let levels: Vec<Level> = study.levels.clone().map(|k| level(part, study, patches, k)).collect();
    let case = part["case"].as_str().unwrap();
    let missing: Vec<f64> = levels.iter().map(|l| energy.value - l.energy).collect();
    let rates: Vec<f64> = missing.windows(2).map(|e| (e[0] / e[1]).abs().log2()).collect();
    println!("{case} {:22} missing energy {} rates {rates:.4?}, theory {order:.4}", study.name, short(&missing));
    // away from the corner everything has the order of the energy, the loaded corners of Cook's membrane have order one; half of it
    // is taken for the estimate, since few points and two levels show an order roughly
    let steps = (0.5 * order).exp2() - 1.0;
    assert!(levels[0].kinds.len() >= 2, "{case}: kinds of quantities beside the energy");
    for (a, b) in levels[levels.len() - 2].kinds.iter().zip(&levels[levels.len() - 1].kinds) {
        let (before, error) = (largest(a.differences.iter().copied()), largest(b.differences.iter().copied()));
        let own = largest(a.differences.iter().zip(&b.differences).map(|(a, b)| a - b)) / steps;
        println!("    {:8} {before:.3e} -> {error:.3e}, rate {:.3}, own estimate {own:.3e}", a.name, (before / error).log2());
        assert!(error < before, "{case} {} {}: {before:e} -> {error:e}", study.name, a.name);
        assert!(error <= own + b.uncertain, "{case} {} {}: {error:e}, own estimate {own:e}", study.name, a.name);
        assert!(b.uncertain < 0.1 * error, "{case} {} {}: the reference is too coarse", study.name, a.name);
    }
    assert!((rates.last().unwrap() - order).abs() < margin, "{case} {}: {rates:?}", study.name);
    // the reference must be good enough to say so
    assert!(energy.error < 1e-3 * missing.last().unwrap().abs(), "{case}: the reference is too coarse");
    if study.nested {
        assert!(missing.iter().all(|e| *e > energy.error), "{case} {}: energies lie below the exact one", study.name);
        assert!(missing.windows(2).all(|e| e[1] < e[0]), "{case} {}: energies rise", study.name);
    }
}

#[test]
fn energies_at_a_corner_of_270_degrees_rise_with_twice_the_exponent() {
    let known = document("lshape");
    for part in ["elasticity", "poisson"] {
        for study in nested(|_| 1..=3).iter().chain(&tied()) {
            converges(&known[part], known["margin"].as_f64().unwrap(), study, &["lower", "corner", "right"]);
        }
    }
}

#[test]
fn energies_of_cooks_membrane_rise_with_twice_the_exponent() {
    let known = document("cook");
    for part in ["plane-stress", "plane-strain"] {
        for study in &nested(|degree| if degree == 2 { 2..=4 } else { 1..=3 }) {
            converges(&known[part], known["margin"].as_f64().unwrap(), study, &["panel"]);
        }
    }
}

/// The tip of the membrane on elements that shrink towards its corners: much closer than on uniform ones with more unknowns, and
/// as close as two degrees of our own and the reference say.
#[test]
fn graded_elements_find_the_tip_of_cooks_membrane() {
    let part = &document("cook")["plane-stress"];
    let tip = known(&part["u"]).into_iter().find(|q| q.quantity == "u.y at [48, 60]").unwrap();
    let tip_of = |case: &str, sets: &[String]| {
        let Said::Plane(setting) = said(case, sets) else { panic!("a case of the plane") };
        let solution = solved(&setting.problem);
        (setting.values(&solution, std::slice::from_ref(&tip.quantity))[0], solution.unknowns().len())
    };
    let (uniform, unknowns) = tip_of("cook", &["patch.panel.refine=4".into(), "discretization.degree=3".into()]);
    let graded: Vec<(f64, usize)> = [3, 5]
        .iter()
        .map(|degree| {
            let mut sets = vec![format!("discretization.degree={degree}"), "let.first=1e-3".into()];
            sets.extend(["low-left", "low-right", "high-left", "high-right"].map(|p| format!("patch.{p}.elements=[16,16]")));
            tip_of("cook-graded", &sets)
        })
        .collect();
    let (error, own) = ((graded[1].0 - tip.value).abs(), (graded[1].0 - graded[0].0).abs());
    println!(
        "tip: {:.3e} off on {unknowns} unknowns, graded {:.3e} on {}, {error:.3e} on {}; own estimate {own:.3e}, the reference's {:.1e}",
        (uniform - tip.value).abs(),
        (graded[0].0 - tip.value).abs(),
        graded[0].1,
        graded[1].1,
        tip.error
    );
    assert!(error <= own + tip.error);
    assert!(graded[1].1 < unknowns && own + tip.error < 0.1 * (uniform - tip.value).abs());
}
