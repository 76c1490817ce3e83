//! Every pair of backends, degrees, integration, multiplier and coupling on one benchmark, against the errors of its halves alone.
//!
//! `FAYING_CROSS_PRODUCT=all` takes the whole product, a number every so many combinations of it; a fixed sample otherwise.
//! The summary of a whole run is kept in tests/data/cross_product.txt.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)]

#[path = "common/squares.rs"]
mod squares;

use faying::app::{Registry, Status};
use faying::io::Case;
use faying::io::case::ReadOptions;
use rayon::prelude::*;
use squares::{Errors, Half, KINDS, Kind, Squares};
use std::collections::BTreeMap;

/// A solution whose flux through the interface is not zero at the ends.
const EXACT: &str = "cos(2*x + 0.3)*exp(y)";
/// Elements along and across of the lower and the upper half.
const GRIDS: [[usize; 2]; 2] = [[6, 3], [4, 2]];
/// One combination of so many without the environment variable.
const SAMPLE: usize = 29;

/// What an interface is made with.
type Words = (&'static str, &'static str, &'static str);

#[derive(Clone, Copy, Debug)]
struct Combination {
    halves: [Half; 2],
    slave_is_lower: bool,
    /// Integration, multiplier, coupling.
    words: Words,
}

/// Multipliers that are stable for a slave of this degree.
fn multipliers(degree: usize) -> &'static [&'static str] {
    match degree {
        1 => &["p/p"],
        2 | 3 => &["p/p", "p/p-2"],
        _ => &["p/p", "p/p-2", "p/p-4"],
    }
}

fn all() -> Vec<Combination> {
    let mut list = Vec::new();
    let halves = |k: usize| KINDS.into_iter().flat_map(move |kind| (1..=4).map(move |p| Half::new(kind, p, GRIDS[k])));
    for lower in halves(0) {
        for upper in halves(1) {
            for slave_is_lower in [true, false] {
                let degree = if slave_is_lower { lower.degree } else { upper.degree };
                for &multiplier in multipliers(degree) {
                    for integration in ["merged", "mixed", "slave"] {
                        list.push(Combination { halves: [lower, upper], slave_is_lower, words: (integration, multiplier, "mortar") });
                    }
                }
            }
        }
    }
    list
}

/// The H1 error of a half whose four sides have exact data: what the backend gives without an interface.
fn alone(half: &Half, lower: bool) -> f64 {
    let both = Squares { lower: *half, upper: *half, slave_is_lower: true, interface: String::new(), exact: EXACT, neumann: false };
    let name = if lower { "lower" } else { "upper" };
    let text = format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"{EXACT}\" }}\n[[material]]\nname = \"m\"\n{}\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nname = \"h\"\nquantity = \"error.u.H1\"\n",
        both.half(name)
    );
    let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(result.status, Status::Ok);
    result.probes[0].value
}

fn solve(c: &Combination) -> Result<Errors, String> {
    let (integration, multiplier, coupling) = c.words;
    let [lower, upper] = c.halves;
    let interface = format!("integration = \"{integration}\"\nmultiplier = \"{multiplier}\"\ncoupling = \"{coupling}\"");
    Squares { lower, upper, slave_is_lower: c.slave_is_lower, interface, exact: EXACT, neumann: false }.run()
}

/// What a group of combinations comes to.
#[derive(Default)]
struct Group {
    count: usize,
    failed: usize,
    worst: f64,
    logs: f64,
}

#[test]
fn every_combination_is_as_good_as_its_worse_half() {
    let wanted = std::env::var("FAYING_CROSS_PRODUCT").ok();
    let stride = match wanted.as_deref() {
        Some("all") => 1,
        Some(number) => number.parse().expect("FAYING_CROSS_PRODUCT is all or a number"),
        None => SAMPLE,
    };
    let references: BTreeMap<(usize, usize, usize), f64> = (0..KINDS.len())
        .flat_map(|kind| (1..=4).flat_map(move |p| (0..2).map(move |k| (kind, p, k))))
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(kind, p, k)| ((kind, p, k), alone(&Half::new(KINDS[kind], p, GRIDS[k]), k == 0)))
        .collect();
    let number = |kind: Kind| KINDS.iter().position(|k| *k == kind).unwrap();
    let list: Vec<Combination> = all().into_iter().step_by(stride).collect();
    let answers: Vec<(Combination, f64, Result<Errors, String>)> = list
        .par_iter()
        .map(|c| {
            let of = |k: usize| references[&(number(c.halves[k].kind), c.halves[k].degree, k)];
            (*c, of(0).hypot(of(1)), solve(c))
        })
        .collect();
    let (mut groups, mut failures) = (BTreeMap::<Words, Group>::new(), Vec::new());
    for (c, reference, answer) in &answers {
        let group = groups.entry(c.words).or_default();
        group.count += 1;
        let fault = match answer {
            Err(error) => Some(error.clone()),
            Ok(e) => {
                // the flux enters the error of u by half a power of h; an integration that misses shows in the flux
                let h = 1.0 / GRIDS[usize::from(!c.slave_is_lower)][0] as f64;
                let ratio = e.errors[1] / (reference + h.sqrt() * e.errors[2]);
                group.worst = group.worst.max(ratio);
                group.logs += ratio.ln();
                let flux = e.errors[2] * h.sqrt() / reference;
                let exact = c.words.0 != "slave" && c.words.1 != "p/p-4";
                (ratio > RATIO || (c.words.0 != "mixed" && e.balance > BALANCE) || (exact && flux > FLUX)).then(|| {
                    format!("H1 {:.2e} for {reference:.2e}, ratio {ratio:.2}, flux {flux:.2}, balance {:.1e}", e.errors[1], e.balance)
                })
            }
        };
        if let Some(fault) = fault {
            group.failed += 1;
            failures.push(format!("{c:?}: {fault}"));
        }
    }
    for (words, g) in &groups {
        println!(
            "{words:?}: {} runs, {} failed, worst ratio {:.2}, mean {:.2}",
            g.count,
            g.failed,
            g.worst,
            (g.logs / g.count as f64).exp()
        );
    }
    println!("cross_product ends {{ combinations: {}, failed: {} }}", answers.len(), failures.len());
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), answers.len(), failures[..failures.len().min(40)].join("\n"));
}

/// Largest H1 error, over that of the halves alone plus sqrt(h) times the error of the flux.
const RATIO: f64 = 2.0;
/// Largest sqrt(h) times the error of the flux, over the H1 error of the halves alone, where integration is exact.
const FLUX: f64 = 3.0;
/// Largest difference of the forces on both sides, relative; mixed integration sums them by two rules.
const BALANCE: f64 = 1e-12;
