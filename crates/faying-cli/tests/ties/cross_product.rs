//! Every pair of backends, degrees, coupling, multiplier and integration on one benchmark, against one solution in closed form.
//!
//! Strang's lemma bounds a stable tie by the best approximations of both halves and of the flux, and by what the rule misses:
//!
//!   |u - u_h|_1,  √h |lambda - lambda_h|,  |u - u_h|(x)   <=   C (best(u) + √h best(lambda) + missed)
//!
//! - best(u): errors of both halves solved alone with exact data on all four sides, root of the sum of squares. The weaker side rules it.
//! - best(lambda) = 2 (h/4)^m max|lambda^(m)| / m!, Chebyshev's error of polynomials of degree m - 1 on elements of the slave's size
//!   h; m - 1 is the degree the multiplier holds on every element (p - 1 at the lowered ends of p/p). None without a multiplier.
//! - missed = e S (1 + 1/√h): e is the consistency estimate of the mortar rows of the same rule, free of units, S the size of u and lambda.
//!   The constraint's part is a jump in L2, 1/√h dearer in H1; the equilibrium's part is a load on the traces.
//! - a penalty gives way by 1/factor.
//!
//! Limits of C are the worst of the whole product and up to a third more. From below nothing is much better than best(u).
//! Combinations that cannot be give their code and nothing else.
//! A seeded sample runs by itself, the whole product with `FAYING_CROSS_PRODUCT=all`; its summary is tests/data/cross_product.txt.

use crate::common::squares;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, RunResult, Status};
use rayon::prelude::*;
use squares::{Half, KINDS, Kind, Squares};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// A solution whose flux through the interface is not zero at the ends.
const EXACT: &str = "cos(2*x + 0.3)*exp(y)";
/// Points of the probes of [`Squares`], one in each half.
const PROBES: [[f64; 2]; 2] = [[0.37, 0.21], [0.61, 0.83]];
/// Elements along and across of the lower and the upper half.
const GRIDS: [[usize; 2]; 2] = [[6, 3], [4, 2]];
/// One combination of so many is in the sample.
const STRIDE: usize = 180;
/// Start of the sample's random numbers.
const SEED: u64 = 0x5eed;
/// Largest size of u and lambda on the interface: max |cos| exp(1/2).
const SIZE: f64 = 1.65;
/// 1 / factor of a penalty by `factor = "auto"`.
const COMPLIANCE: f64 = 1e-6;
/// Largest difference of the forces on both sides, relative. Mixed integration sums them by two rules and has no such balance.
const BALANCE: f64 = 1e-12;

fn exact([x, y]: [f64; 2]) -> f64 {
    (2.0 * x + 0.3).cos() * y.exp()
}

/// Coupling, multiplier, integration; a variant follows the coupling, no multiplier is "-".
type Words = (&'static str, &'static str, &'static str);

const COUPLINGS: [&str; 5] = ["mortar", "penalty", "nitsche symmetric", "nitsche unsymmetric", "nitsche incomplete"];
const MULTIPLIERS: [&str; 5] = ["p/p", "p/p-2", "p/p-4", "constant", "dual"];
const INTEGRATIONS: [&str; 3] = ["merged", "slave", "mixed"];

#[derive(Clone, Copy, Debug)]
struct Combination {
    halves: [Half; 2],
    /// 0 lower, 1 upper.
    slave: usize,
    words: Words,
}

fn has_rows(coupling: &str) -> bool {
    !coupling.starts_with("nitsche")
}

fn is_lagrange(kind: Kind) -> bool {
    matches!(kind, Kind::Tensor | Kind::Triangle)
}

/// Constants under odd splines: an alternating one is orthogonal to all functions that are even about the knots.
fn is_unstable(slave: &Half, multiplier: &str) -> bool {
    multiplier == "constant" && slave.degree == 3 && !is_lagrange(slave.kind)
}

/// Not for mixed sums of dual multipliers of degree four on splines: these jump by many times their mean within the master's
/// elements, the sums miss up to half of them (consistency 0.5), and Strang's lemma asks for rows that are nearly exact.
/// One pair of the product is next to singular. They must run; errors are shown beside the others.
fn has_claim(c: &Combination) -> bool {
    let slave = &c.halves[c.slave];
    !(c.words.1 == "dual" && c.words.2 == "mixed" && slave.degree == 4 && !is_lagrange(slave.kind))
}

fn all() -> Vec<Combination> {
    let halves = |k: usize| KINDS.into_iter().flat_map(move |kind| (1..=4).map(move |p| Half::new(kind, p, GRIDS[k])));
    let mut list = Vec::new();
    for lower in halves(0) {
        for upper in halves(1) {
            for slave in 0..2 {
                let halves = [lower, upper];
                for coupling in COUPLINGS {
                    let multipliers: &[&'static str] = if has_rows(coupling) { &MULTIPLIERS } else { &["-"] };
                    for &multiplier in multipliers.iter().filter(|m| !is_unstable(&halves[slave], m)) {
                        list.extend(INTEGRATIONS.map(|integration| Combination {
                            halves,
                            slave,
                            words: (coupling, multiplier, integration),
                        }));
                    }
                }
            }
        }
    }
    list
}

/// One of every [`STRIDE`] combinations, by splitmix64.
fn sample() -> Vec<Combination> {
    let mut state = SEED;
    all()
        .chunks(STRIDE)
        .map(|few| {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            few[(z ^ (z >> 31)) as usize % few.len()]
        })
        .collect()
}

/// The code of a combination that cannot be.
fn refusal(c: &Combination) -> Option<&'static str> {
    let degree = c.halves[c.slave].degree;
    match c.words {
        // no multiplier whose test functions could be integrated another way
        (coupling, _, "mixed") if !has_rows(coupling) => Some("E015"),
        (_, "p/p-2", _) if degree < 2 => Some("E064"),
        (_, "p/p-4", _) if degree < 4 => Some("E064"),
        // as many constants as elements, one free function less
        (_, "constant", _) if degree < 2 => Some("E024"),
        _ => None,
    }
}

/// The result of a case, or the codes of its errors.
fn run(text: &str) -> Result<RunResult, Vec<&'static str>> {
    let codes = |e: faying_cli::Diagnostics| e.items.iter().map(|d| d.code).collect::<Vec<_>>();
    let result = Case::parse("case.toml", text, &ReadOptions::default()).map_err(codes)?.run(&Registry::default()).map_err(codes)?;
    if result.status == Status::Ok { Ok(result) } else { Err(result.diagnostics.iter().map(|d| d.code).collect()) }
}

/// The H1 error of a half whose four sides have exact data.
fn alone(half: Half, k: usize) -> f64 {
    let both = Squares { lower: half, upper: half, slave_is_lower: true, interface: String::new(), exact: EXACT };
    let patch = both.half(["lower", "upper"][k]);
    let text = format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"{EXACT}\" }}\n[[material]]\nname = \"m\"\n{patch}\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nname = \"h\"\nquantity = \"error.u.H1\"\n",
    );
    run(&text).unwrap_or_else(|e| panic!("{half:?}: {e:?}")).probes[0].value
}

/// What a solution has.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// Errors of u in H1, of lambda in L2, of u at a point.
    errors: [f64; 3],
    balance: f64,
    consistency: f64,
}

fn solve(c: &Combination) -> Result<Found, Vec<&'static str>> {
    let (coupling, multiplier, integration) = c.words;
    let mut interface = format!("integration = \"{integration}\"\ncoupling = \"{}\"\n", coupling.split(' ').next().unwrap());
    if let Some((_, variant)) = coupling.split_once(' ') {
        interface += &format!("variant = \"{variant}\"\n");
    } else {
        interface += &format!("multiplier = \"{multiplier}\"\n");
    }
    let [lower, upper] = c.halves;
    let result = run(&Squares { lower, upper, slave_is_lower: c.slave == 0, interface, exact: EXACT }.text())?;
    let v: Vec<f64> = result.probes.iter().map(|p| p.value).collect();
    let at = |k: usize| (v[3 + k] - exact(PROBES[k])).abs();
    let i = result.interface.get("i").unwrap();
    // one measure for all couplings: that of mortar rows with the integrals of the same rule
    let consistency = match (coupling, integration) {
        (_, "merged") => 0.0,
        ("mortar", _) => i.consistency,
        _ => {
            let rows = if has_rows(coupling) { multiplier } else { "p/p" };
            solve(&Combination { words: ("mortar", rows, integration), ..*c })?.consistency
        }
    };
    Ok(Found { errors: [v[1], v[2], at(0).max(at(1))], balance: i.balance, consistency })
}

/// Chebyshev's error of the flux; its derivative of order m is at most 2^m exp(1/2).
fn best_flux(slave: &Half, multiplier: &str) -> f64 {
    let p = slave.degree;
    let order = match multiplier {
        "-" => return 0.0,
        "constant" => 1,
        "p/p" => p,
        // Gauss-Lobatto nodes hold degree p - 1 along straight sides, splines the constants
        "dual" if is_lagrange(slave.kind) => p,
        "dual" => 1,
        word => p + 1 - word.strip_prefix("p/p-").unwrap().parse::<usize>().unwrap(),
    };
    let h = 1.0 / slave.elements[0] as f64;
    let factorial: f64 = (1..=order).map(|k| k as f64).product();
    2.0 * (h / 4.0 * 2.0).powi(order as i32) * 0.5f64.exp() / factorial
}

/// Errors over their bound, and the H1 error over best(u).
fn ratios(c: &Combination, best: f64, found: &Found) -> ([f64; 3], f64) {
    let slave = &c.halves[c.slave];
    let h = 1.0 / slave.elements[0] as f64;
    let compliance = if c.words.0 == "penalty" { COMPLIANCE } else { 0.0 };
    let missed = found.consistency * (1.0 + 1.0 / h.sqrt());
    let bound = best + h.sqrt() * best_flux(slave, c.words.1) + SIZE * (missed + compliance);
    let [u, lambda, point] = found.errors;
    ([u / bound, h.sqrt() * lambda / bound, point / bound], u / best)
}

/// Largest H1 error of u over its bound; 1.08 is the worst of the whole product.
const MOST_U: f64 = 1.25;
/// Largest error of lambda over its bound; 2.99 is the worst. The inverse inequality behind √h grows with the degree.
const MOST_LAMBDA: f64 = 4.0;
/// The same of dual multipliers, 12.80: their sizes in L2 grow faster with the degree, most on splines.
const MOST_DUAL: f64 = 16.0;
/// Largest error of u at a point over the bound; 0.12 is the worst.
const MOST_POINT: f64 = 0.15;
/// Least H1 error over best(u), 0.97: data on the cut cost the halves alone a little.
const LEAST: f64 = 0.9;

/// What a group of combinations comes to.
struct Group {
    count: usize,
    refused: usize,
    worst: [f64; 3],
    least: f64,
}

/// Errors of the halves alone, by kind, degree and half.
struct Alone(Vec<((Kind, usize, usize), f64)>);

impl Alone {
    fn new() -> Self {
        let of = |(kind, p, k): (Kind, usize, usize)| ((kind, p, k), alone(Half::new(kind, p, GRIDS[k]), k));
        let keys: Vec<_> = KINDS.into_iter().flat_map(|kind| (1..=4).flat_map(move |p| (0..2).map(move |k| (kind, p, k)))).collect();
        Self(keys.into_par_iter().map(of).collect())
    }

    fn best(&self, c: &Combination) -> f64 {
        let of = |k: usize| self.0.iter().find(|(key, _)| *key == (c.halves[k].kind, c.halves[k].degree, k)).unwrap().1;
        of(0).hypot(of(1))
    }
}

/// A combination's ratios, none where it is refused as it should be; else what is wrong with it.
fn judged(c: &Combination, best: f64, found: &Result<Found, Vec<&'static str>>) -> (Option<([f64; 3], f64)>, Option<String>) {
    match (found, refusal(c)) {
        (Err(codes), Some(code)) if codes[..] == [code] => (None, None),
        (_, Some(code)) => (None, Some(format!("{code} expected, {found:?}"))),
        (Err(codes), None) => (None, Some(format!("{codes:?}"))),
        (Ok(found), None) => {
            let (over, under) = ratios(c, best, found);
            let balanced = c.words.2 == "mixed" || found.balance <= BALANCE;
            let most = [MOST_U, if c.words.1 == "dual" { MOST_DUAL } else { MOST_LAMBDA }, MOST_POINT];
            let good = !has_claim(c) || (0..3).all(|k| over[k] <= most[k]) && under >= LEAST && balanced;
            (Some((over, under)), (!good).then(|| format!("ratios {over:.3?}, {under:.3} of best(u), {found:?}")))
        }
    }
}

/// Groups as lines, in the order of their words.
fn summary(groups: &BTreeMap<(Words, bool), Group>, failed: usize) -> String {
    let mut text = String::new();
    for (((coupling, multiplier, integration), claim), g) in groups {
        write!(text, "cross_product ends {{ {coupling}, {multiplier}, {integration}: {} runs, {} refused", g.count, g.refused).unwrap();
        if g.count > g.refused {
            let [u, lambda, point] = g.worst;
            let kind = if *claim { "worst" } else { "no claim, worst" };
            write!(text, "; {kind} H1 {u:.2}, lambda {lambda:.2}, point {point:.2}; least H1 {:.2}", g.least).unwrap();
        }
        text += " }\n";
    }
    let (count, refused) = groups.values().fold((0, 0), |(a, b), g| (a + g.count, b + g.refused));
    writeln!(text, "cross_product ends {{ all: {count} runs, {refused} refused, {failed} failed }}").unwrap();
    text
}

#[test]
fn every_combination_is_as_good_as_its_halves_its_multiplier_and_its_rule() {
    let whole = std::env::var("FAYING_CROSS_PRODUCT").is_ok_and(|word| word == "all");
    let alone = Alone::new();
    let answers: Vec<_> =
        if whole { all() } else { sample() }.into_par_iter().map(|c| (c, judged(&c, alone.best(&c), &solve(&c)))).collect();
    let (mut groups, mut failures) = (BTreeMap::<(Words, bool), Group>::new(), Vec::new());
    for (c, (ratios, fault)) in answers {
        let group = groups.entry((c.words, has_claim(&c))).or_insert(Group { count: 0, refused: 0, worst: [0.0; 3], least: f64::INFINITY });
        group.count += 1;
        match ratios {
            None => group.refused += 1,
            Some((over, under)) => {
                (0..3).for_each(|k| group.worst[k] = group.worst[k].max(over[k]));
                group.least = group.least.min(under);
            }
        }
        failures.extend(fault.map(|fault| format!("{c:?}: {fault}")));
    }
    let text = summary(&groups, failures.len());
    // a line of its own after the runner's words
    print!("\n{text}");
    assert!(failures.is_empty(), "{} failed:\n{}", failures.len(), failures[..failures.len().min(40)].join("\n"));
    if whole {
        let kept = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cross_product.txt")).unwrap_or_default();
        assert!(text == kept, "the summary differs from tests/data/cross_product.txt; keep the new one if the change is meant");
    }
}

#[test]
fn the_bound_tells_a_poorer_multiplier_and_a_poorer_rule() {
    let alone = Alone::new();
    let of = |kind: Kind, words: Words| Combination { halves: [0, 1].map(|k| Half::new(kind, 4, GRIDS[k])), slave: 1, words };
    let wanted = of(Kind::Tensor, ("mortar", "p/p", "merged"));
    let best = alone.best(&wanted);
    let (_, fault) = judged(&wanted, best, &solve(&wanted));
    assert!(fault.is_none(), "{fault:?}");
    for poorer in [("mortar", "constant", "merged"), ("mortar", "p/p", "slave")] {
        // a rule without its estimate is taken for an exact one
        let found = solve(&of(Kind::Tensor, poorer)).map(|found| Found { consistency: 0.0, ..found });
        let (ratios, fault) = judged(&wanted, best, &found);
        assert!(fault.is_some(), "{poorer:?} passes for {:?}: {ratios:?}", wanted.words);
    }
}
