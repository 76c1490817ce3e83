//! Smooth problems: every backend and tied bodies approach what FEniCSx finds with a high degree, at the order of theory.

use crate::cases::values as found;
use crate::document::{Known, document, known as known_of, texts};
use serde_json::Value;

/// The order that theory gives a quantity of this kind for functions of degree `p`, where the solution has `regularity`
/// (an exponent of a corner, or none) and the pair of multiplier and spaces loses `loss` in the energy norm.
///
/// Displacements at a point are of the order of the error in L2 and stresses of that of its gradient; energies, with
/// Galerkin's orthogonality, have twice the order of the energy norm, also as what a corner far away adds to a point. The
/// multiplier is 1/2 below the displacements' gradient, or as good as its own degree; the force on the part of a cut that
/// belongs to one body is in balance with it. The displacement of the singular corner itself has the order of its exponent.
fn order(kind: &str, p: f64, multiplier: f64, regularity: f64, loss: f64) -> f64 {
    let energy = 2.0 * (p - loss).min(regularity);
    match kind {
        "energy" => energy,
        "displacement" => (p + 1.0 - loss).min(energy),
        "stress" => (p - loss).min(energy),
        "corner" => (p + 1.0 - loss).min(regularity),
        "flux" | "reaction" => (multiplier + 1.0).min(p - 0.5).min(energy),
        other => panic!("quantities of kind {other}"),
    }
}

/// The quantities of one kind in a document.
fn known(document: &Value, kind: &str) -> Vec<Known> {
    document["quantities"].as_array().unwrap().iter().filter(|e| e["kind"] == kind).map(known_of).collect()
}

/// Runs the levels of every variant of a document, and compares with its values.
///
/// Of each kind the largest error over all points counts: one point alone may meet a zero of the error.
///
/// Isoparametric cells have order 2p in energy, too: their map meets the body's at Gauss-Lobatto nodes, so that the defect of
/// each side has no part of degree p - 2 and the measure of the body is off by order 2p only. Their bodies do not contain one
/// another, so their energies may lie on either side; those of "nested" variants grow and stay below.
fn approaches(name: &str) {
    let document = document(name);
    let (margin, share) = (document["margin"].as_f64().unwrap(), document["resolved"].as_f64().unwrap());
    let regularity = document["regularity"].as_f64().unwrap_or(f64::INFINITY);
    let mut faults = Vec::new();
    for variant in document["variants"].as_array().unwrap() {
        let label = format!("{name}, {}", variant["name"].as_str().unwrap());
        let number = |key: &str| variant[key].as_f64();
        let p = number("degree").unwrap();
        let all: Vec<(String, Vec<Known>)> = texts(&variant["kinds"]).into_iter().map(|k| (k.clone(), known(&document, &k))).collect();
        let quantities: Vec<String> = all.iter().flat_map(|(_, list)| list.iter().map(|k| k.quantity.clone())).collect();
        let levels = variant["levels"].as_array().unwrap().iter().map(|level| {
            let sets: Vec<String> = texts(&variant["sets"]).into_iter().chain(texts(level)).collect();
            found(variant["case"].as_str().unwrap(), &sets, &quantities)
        });
        let levels: Vec<Vec<f64>> = levels.collect();
        assert!(levels.len() >= 3 && levels.iter().all(|l| l.len() == quantities.len()), "{label}");
        let mut first = 0;
        for (kind, list) in &all {
            assert!(!list.is_empty(), "{label}: no {kind}");
            let values: Vec<&[f64]> = levels.iter().map(|l| &l[first..first + list.len()]).collect();
            first += list.len();
            let least = order(kind, p, number("multiplier").unwrap_or(0.0), regularity, number("loss").unwrap_or(0.0)) - margin;
            let fault = compare(list, &values, least, share, kind == "energy");
            let (Ok(text) | Err(text)) = &fault;
            println!("{label}: {kind}, {text}");
            if fault.is_err() {
                faults.push(format!("{label}: {kind}, {text}"));
            }
            if kind == "energy" && variant["nested"].as_bool() == Some(true) {
                // spaces that contain one another on one body, homogeneous Dirichlet data and loads
                let energies: Vec<f64> = values.iter().map(|v| v[0]).collect();
                let grows = energies.windows(2).all(|e| e[0] < e[1]);
                if !grows || energies.iter().any(|&e| e > list[0].value + list[0].error) {
                    faults.push(format!("{label}: energies {energies:?} of {}", list[0].value));
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Errors and rates of one kind; as an error, if they do not decrease at the `least` order, or if the last values are farther
/// from the reference than their own change and its error allow. The finest level counts on which the reference's error is at
/// most `share` of ours.
///
/// The order is that of the last step, or, but for energies, the mean of all: the error at a point changes its sign, and is then
/// smaller on a coarse mesh than its order says.
fn compare(list: &[Known], values: &[&[f64]], least: f64, share: f64, last_step: bool) -> Result<String, String> {
    let largest = |differences: &dyn Fn(usize) -> f64| (0..list.len()).map(|k| differences(k).abs()).fold(0.0, f64::max);
    let errors: Vec<f64> = values.iter().map(|v| largest(&|k| v[k] - list[k].value)).collect();
    let uncertain = largest(&|k| list[k].error);
    let resolved = (1..values.len()).rev().find(|&l| uncertain <= share * errors[l]);
    let Some(resolved) = resolved else { return Err(format!("errors {errors:?} are those of the reference, {uncertain:.0e}")) };
    // as low as the reference's own error allows
    let rate = |l: usize, m: usize| ((errors[l] - uncertain) / (errors[m] + uncertain)).log2() / (m - l) as f64;
    let rates: Vec<f64> = (0..resolved).map(|l| rate(l, l + 1)).collect();
    let starts = if last_step { vec![resolved - 1] } else { vec![resolved - 1, 0] };
    let slow = !starts.iter().any(|&l| rate(l, resolved) >= least);
    // Richardson's estimate, from this program's numbers alone
    let last = values.len() - 1;
    let change = |l: usize| largest(&|k| values[last][k] - values[l][k]) / ((least * (last - l) as f64).exp2() - 1.0);
    let estimate = starts.iter().map(|&l| change(l)).fold(0.0, f64::max);
    let far = errors[last].is_nan() || errors[last] > estimate + uncertain;
    let short = |x: f64| if x.abs() < 0.01 { format!("{x:.1e}") } else { format!("{x:.2}") };
    let all = |list: &[f64]| list.iter().map(|&x| short(x)).collect::<Vec<_>>().join(" ");
    let mut text = format!("errors {} (estimated {}, reference {uncertain:.0e})", all(&errors), short(estimate));
    text += &format!(", rates {} of at least {least:.2}", all(&rates));
    if slow {
        text += ": TOO SLOW";
    }
    if far {
        text += ": TOO FAR";
    }
    if slow || far { Err(text) } else { Ok(text) }
}

#[test]
fn a_ring_under_a_pressure_that_varies_around_it_is_approached_at_the_order_of_theory() {
    approaches("annulus");
}

#[test]
fn a_plate_with_a_hole_is_approached_at_the_order_of_theory_and_of_its_corner() {
    approaches("plate_with_hole");
}

#[test]
fn a_tube_under_a_pressure_that_varies_along_it_is_approached_at_the_order_of_theory() {
    approaches("tube");
}
