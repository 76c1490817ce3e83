//! Observed rates of mortar coupling: every pair of backends, both pairings, slave finer and coarser; the quadrature study.

use crate::common::squares;
use rayon::prelude::*;
use squares::{Errors, Half, Kind, SMOOTH, Squares, rates};

/// Levels of a sequence: three elements face two, times 2^level.
fn sequence(kinds: [Kind; 2], degree: usize, slave_is_finer: bool, interface: &str, neumann: bool, levels: &[u32]) -> Vec<Errors> {
    levels
        .iter()
        .map(|&level| {
            let n = |k: usize| k << level;
            // squares: half as many across as along
            let half = |kind: Kind, k: usize| Half::new(kind, degree, [n(k), n(k).div_ceil(2)]);
            let squares = Squares {
                lower: half(kinds[0], 3),
                upper: half(kinds[1], 2),
                slave_is_lower: slave_is_finer,
                interface: interface.to_owned(),
                exact: SMOOTH,
                neumann,
            };
            squares.run().unwrap_or_else(|e| panic!("{kinds:?} {degree} {interface} level {level}: {e}"))
        })
        .collect()
}

const PAIRS: [[Kind; 2]; 5] = [
    [Kind::Spline, Kind::Spline],
    [Kind::Tensor, Kind::Tensor],
    [Kind::Spline, Kind::Tensor],
    [Kind::Tensor, Kind::Spline],
    [Kind::Triangle, Kind::Spline],
];

// benchmarks.md section 3, Brivadis et al. (2015): L2(u) and L2(lambda) fall with p + 1 and p - 1/2 for p/p, with p + 1/2 and
// p - 1 for p/p-2; H1 with one order less than L2(u). Lower bounds.
#[test]
fn errors_fall_at_least_at_the_rates_of_the_theory_for_every_pair_of_backends() {
    let mut cases = Vec::new();
    for kinds in PAIRS {
        for degree in 1..=4usize {
            for finer in [true, false] {
                for pairing in ["p/p", "p/p-2"] {
                    if pairing == "p/p" || degree >= 2 {
                        cases.push((kinds, degree, finer, pairing));
                    }
                }
            }
        }
    }
    let failures: Vec<String> = cases
        .par_iter()
        .filter_map(|&(kinds, degree, finer, pairing)| {
            let levels: &[u32] = if degree <= 2 { &[3, 4] } else { &[2, 3] };
            let found = sequence(kinds, degree, finer, &format!("multiplier = \"{pairing}\""), false, levels);
            let p = degree as f64;
            let theory = if pairing == "p/p" { [p + 1.0, p, p - 0.5] } else { [p + 0.5, p - 0.5, p - 1.0] };
            let observed = rates(&found[0], &found[1]);
            let balance = found.iter().fold(0.0f64, |m, e| m.max(e.balance));
            let bad = (0..3).any(|k| observed[k] < theory[k] - 0.1) || balance > 1e-12;
            bad.then(|| {
                format!("{kinds:?} p = {degree} {pairing}, slave finer: {finer}: {observed:?} below {theory:?}, balance {balance:e}")
            })
        })
        .collect();
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

/// Two levels with Neumann ends; elements along on the slave (lower) and master side, half as many across, rounded down.
fn neumann(kind: Kind, degree: usize, slave: [usize; 2], interface: &str) -> ([Errors; 2], [f64; 3]) {
    let found: Vec<Errors> = slave
        .par_iter()
        .map(|&n| {
            let half = |k: usize| Half::new(kind, degree, [k, k / 2]);
            let interface = interface.to_owned();
            let squares = Squares { lower: half(n), upper: half(n * 2 / 3), slave_is_lower: true, interface, exact: SMOOTH, neumann: true };
            squares.run().unwrap_or_else(|e| panic!("{kind:?} {degree} {n}: {e}"))
        })
        .collect();
    let observed = rates(&found[0], &found[1]);
    ([found[0], found[1]], observed)
}

// benchmarks.md section 3: last observed rates of L2(u), H1, L2(lambda), to the digit they are printed with.
#[test]
fn last_rates_of_splines_are_those_of_the_table() {
    let table: [(usize, &str, [usize; 2], [Option<&str>; 3]); 6] = [
        (2, "p/p", [48, 96], [Some("3.0"), Some("2.0"), Some("2.5")]),
        (3, "p/p", [24, 48], [Some("4.0"), Some("3.0"), Some("3.5")]),
        (4, "p/p", [24, 48], [Some("5.1"), Some("4.0"), Some("4.5")]),
        (2, "p/p-2", [48, 96], [Some("3.0"), None, Some("1.0")]),
        (3, "p/p-2", [24, 48], [Some("4.0"), None, Some("2.0")]),
        (4, "p/p-2", [24, 48], [Some("5.1"), None, Some("3.0")]),
    ];
    let failures: Vec<String> = table
        .par_iter()
        .filter_map(|&(degree, pairing, slave, expected)| {
            let (_, observed) = neumann(Kind::Spline, degree, slave, &format!("multiplier = \"{pairing}\""));
            let differs = (0..3).any(|k| expected[k].is_some_and(|printed| format!("{:.1}", observed[k]) != printed));
            differs.then(|| format!("p = {degree} {pairing}: {observed:?} for {expected:?}"))
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

// benchmarks.md section 3: the quadrature study of p = 3 with p/p, within 5 % of its last rates.
#[test]
fn the_quadrature_study_has_the_rates_of_the_table() {
    let study = [
        ("merged", 0, [4.01, 3.00, 3.49]),
        ("slave", 0, [2.29, 1.58, 0.20]),
        ("slave", 2, [3.68, 2.80, 0.22]),
        ("slave", 10, [4.01, 3.00, 1.23]),
        ("mixed", 0, [4.01, 3.00, 3.49]),
    ];
    let words = |integration: &str, extra: usize| format!("multiplier = \"p/p\"\nintegration = \"{integration}\"\nextra_points = {extra}");
    let failures: Vec<String> = study
        .par_iter()
        .filter_map(|&(integration, extra, table)| {
            let (found, observed) = neumann(Kind::Spline, 3, [48, 96], &words(integration, extra));
            println!("splines, {integration} +{extra}: {:?}, rates {observed:?}", found[1].errors);
            (0..3)
                .any(|k| (observed[k] / table[k] - 1.0).abs() > 0.05)
                .then(|| format!("{integration} +{extra}: {observed:?} for {table:?}"))
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

// Seed: splines are less sensitive to the slave's quadrature than finite elements of the same degree.
#[test]
fn finite_elements_lose_more_to_the_slave_rule_than_splines() {
    for extra in [0, 2] {
        let words = format!("multiplier = \"p/p\"\nintegration = \"slave\"\nextra_points = {extra}");
        let (splines, a) = neumann(Kind::Spline, 3, [24, 48], &words);
        let (elements, b) = neumann(Kind::Tensor, 3, [24, 48], &words);
        println!("slave +{extra}: splines {:?} {a:?}, finite elements {:?} {b:?}", splines[1].errors, elements[1].errors);
        // 3/2 in L2(u), 1/2 in H1, none in lambda: the kinks of C0 functions, against those of C2 functions
        assert!(b[0] < 1.6 && b[1] < 0.6 && b[2] < 0.1, "{b:?}");
        assert!(a[0] > b[0] + 1.0, "{a:?} {b:?}");
        assert!((0..3).all(|k| elements[1].errors[k] > 10.0 * splines[1].errors[k]), "{elements:?} {splines:?}");
    }
    let (merged, rates) = neumann(Kind::Tensor, 3, [24, 48], "multiplier = \"p/p\"");
    println!("finite elements, merged: {:?} {rates:?}", merged[1].errors);
    assert!(rates[0] > 3.9 && rates[1] > 2.9 && rates[2] > 2.4, "{rates:?}");
}
