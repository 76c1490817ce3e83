//! Multipliers by the words of a case: their sizes, their ends per component, what is refused, and the conforming limit.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Registry, RunResult, Status};
use rayon::prelude::*;

fn solve(text: &str) -> Result<RunResult, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions::default())?.run(&Registry::default())
}

fn run(text: &str) -> RunResult {
    let result = solve(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

/// Two boxes above each other; `n` elements along the slave side `a.top`, `m` along `b.bottom`.
fn boxes(physics: &str, backend: &str, degree: usize, [n, m]: [usize; 2], rest: &str) -> String {
    let material = if physics == "elasticity" { "[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n" } else { "" };
    format!(
        "[model]\nphysics = \"{physics}\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n{material}\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [{n}, 2]\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [{m}, 2]\n{rest}"
    )
}

fn tie(multiplier: &str) -> String {
    format!("[[interface]]\nname = \"i\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\nmultiplier = {multiplier}\n")
}

const POISSON_FREE: &str = "[[boundary]]\non = [\"a.bottom\", \"b.top\"]\ndirichlet = \"x\"\n";
const POISSON_HELD: &str = "[[boundary]]\non = \"all-outer\"\ndirichlet = \"x\"\n";

#[test]
fn every_word_has_the_functions_that_the_contract_says() {
    // n = 5 elements of degree p; splines of most continuity: n + q functions of degree q; Lagrange traces: C^0 for p/p,
    // discontinuous below
    let n = 5;
    for p in 1..=6usize {
        for backend in ["iga", "fe"] {
            let iga = backend == "iga";
            let whole = if iga { n + p } else { n * p + 1 };
            let lower = |k: usize| if iga { n + p - k } else { n * (p - k + 1) };
            // word, functions with free ends, functions with both ends held (none: refused), name, degree, what it reproduces
            let mut words: Vec<(String, usize, Option<usize>, String, usize)> = vec![
                ("\"p/p\"".into(), whole, Some(whole - 2), "p/p".into(), p),
                ("\"constant\"".into(), n, Some(n).filter(|m| *m <= whole - 2), "constant".into(), 0),
                ("\"dual\"".into(), whole, Some(whole - 2), "dual".into(), p),
                (format!("{{ degree = {p}, ends = \"full\" }}"), whole, None, "data".into(), p),
                (format!("{{ degree = {p}, ends = \"lowered\" }}"), whole - 2, Some(whole - 2), "data".into(), p),
                (format!("{{ degree = {p} }}"), whole, Some(whole - 2), "data".into(), p),
            ];
            for k in (2..=p).step_by(2) {
                words.push((format!("\"p/p-{k}\""), lower(k), Some(lower(k)), format!("p/p-{k}"), p - k));
                let data = format!("{{ degree = {} }}", p - k);
                words.push((data, lower(k), Some(lower(k)), "data".into(), p - k));
            }
            if p >= 2 {
                words.push(("\"auto\"".into(), lower(2), Some(lower(2)), "p/p-2".into(), p - 2));
                // one C^0 function per breakpoint, and discontinuous ones
                words.push(("{ degree = 1, continuity = 0 }".into(), n + 1, Some(n + 1).filter(|m| *m <= whole - 2), "data".into(), 1));
            } else {
                words.push(("\"auto\"".into(), whole, Some(whole - 2), "p/p".into(), 1));
            }
            words.push(("{ degree = 0, continuity = -1 }".into(), n, Some(n).filter(|m| *m <= whole - 2), "data".into(), 0));
            for (word, free, held, name, degree) in words {
                let what = format!("{word} on {backend} of degree {p}");
                let result = run(&boxes("poisson", backend, p, [n, 4], &(tie(&word) + POISSON_FREE)));
                let found = result.interface.get("i").unwrap().multiplier.clone().unwrap();
                assert_eq!((found.name.as_str(), found.functions, found.degree), (name.as_str(), free, degree), "{what}");
                let holds = match name.as_str() {
                    // tests/dual.rs says why
                    "dual" => {
                        if iga {
                            0
                        } else {
                            p - p % 2
                        }
                    }
                    _ => degree - usize::from(word.contains("lowered")),
                };
                assert_eq!(found.reproduction, Some(holds), "{what}");
                let result = solve(&boxes("poisson", backend, p, [n, 4], &(tie(&word) + POISSON_HELD)));
                match (held, result) {
                    (Some(held), Ok(r)) => {
                        assert_eq!(r.interface.get("i").unwrap().multiplier.clone().unwrap().functions, held, "{what}, held")
                    }
                    (None, Err(e)) => assert!(e.items[0].code == "E024", "{what}: {e}"),
                    (held, found) => panic!("{what}: {held:?}, {found:?}"),
                }
            }
        }
    }
}

#[test]
fn ends_are_lowered_only_where_and_in_the_component_that_is_held() {
    // the left ends of the slave slide along y, the right ones are free
    let held = "[[boundary]]\non = [\"a.left\", \"b.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n\
                [[boundary]]\non = \"b.top\"\ntraction = [\"0.1\", \"-1\"]\n";
    for backend in ["iga", "fe"] {
        for p in 1..=4usize {
            let n = 5;
            let whole = if backend == "iga" { n + p } else { n * p + 1 };
            for (word, x, y) in [("\"p/p\"", whole - 1, whole), ("\"dual\"", whole - 1, whole)] {
                let result = run(&boxes("elasticity", backend, p, [n, 4], &(tie(word) + held)));
                let found = result.interface.get("i").unwrap().multiplier.clone().unwrap();
                assert_eq!((found.functions, result.unknowns.multipliers), (x + y, x + y), "{word} on {backend} of degree {p}");
            }
        }
    }
}

#[test]
fn multipliers_that_cannot_be_are_refused_in_words() {
    let refused = |text: &str, code: &str, part: &str| {
        let faults = solve(text).expect_err(text);
        let fault = faults.items.iter().find(|d| d.code == code).unwrap_or_else(|| panic!("{faults}"));
        assert!(fault.message.contains(part) && fault.line.is_some(), "{faults}\nhas not: {part}");
    };
    for backend in ["iga", "fe"] {
        let text = |p: usize, n: usize, word: &str, data: &str| boxes("poisson", backend, p, [n, 4], &(tie(word) + data));
        refused(
            &text(2, 4, "\"p/p-4\"", POISSON_FREE),
            "E064",
            "\"i\" on `a.top`: there is no multiplier \"p/p-4\" with degree 2; this side has p/p, p/p-1, p/p-2, constant, dual",
        );
        refused(&text(2, 4, "{ degree = 1, continuity = 1 }", POISSON_FREE), "E015", "`continuity` must be less than the degree 1");
        refused(&text(1, 1, "\"p/p\"", POISSON_HELD), "E024", "a.top");
        refused(&text(1, 1, "\"dual\"", POISSON_HELD), "E024", "a.top");
        refused(&text(2, 1, "{ degree = 2, ends = \"full\" }", POISSON_HELD), "E024", "component u has 3 functions for 1 free unknowns");
        refused(&text(2, 4, "\"duall\"", POISSON_FREE), "E064", "there is no multiplier \"duall\"");
        // every multiplier that a remedy names is there
        let held = solve(&text(1, 1, "\"p/p\"", POISSON_HELD)).expect_err("nothing is left");
        assert!(held.items.iter().all(|d| d.help.as_ref().is_none_or(|help| !help.contains("p/p-2"))), "{held}");
        for (p, remedy) in [(1, "use p/p, or raise"), (2, "use p/p or p/p-2")] {
            let warned = run(&text(p, 4, "\"p/p-1\"", POISSON_FREE)).warnings;
            assert!(warned.iter().any(|d| d.code == "E061" && d.help.as_ref().is_some_and(|help| help.starts_with(remedy))), "{warned:?}");
        }
        // not stable, and said so
        let result = run(&text(3, 4, "\"p/p-1\"", POISSON_FREE));
        assert!(result.warnings.iter().any(|d| d.code == "E061" && d.message.contains("p/p-1")), "{:?}", result.warnings);
    }
    // x = 0.01 t + 0.99 t^3 along the slave: (1 - 2t)(1 - t) has the weight 0.01/6 - 0.99/20
    let x = [0.0, 0.01 / 3.0, 0.02 / 3.0, 1.0];
    let points: Vec<[f64; 2]> = [0.0, 0.5].iter().flat_map(|&y| x.map(|x| [x, y])).collect();
    let cubic = format!(
        "geometry = {{ kind = \"nurbs\", degree = [3, 1], knots = [[0, 0, 0, 0, 1, 1, 1, 1], [0, 0, 1, 1]], points = {points:?} }}\nelements = [1, 2]"
    );
    let text = boxes("poisson", "fe", 2, [1, 4], &(tie("\"dual\"") + POISSON_FREE))
        .replace("geometry = { kind = \"box\", min = [0, 0], max = [1, 0.5] }\nelements = [1, 2]", &cubic)
        .replace("degree = 2\n", "degree = 2\nmapping = \"exact\"\n");
    refused(
        &text,
        "E064",
        "the lumped weight of function 0 on element 0 is -4.783e-2, not positive; this side has p/p, p/p-1, p/p-2, constant",
    );
}

#[test]
fn dual_multipliers_carry_a_constant_contact_pressure_in_case_files() {
    for backends in [["iga", "fe"], ["fe", "iga"], ["iga", "iga"], ["fe", "fe"]] {
        for degree in 1..=3 {
            for constraint in ["saddle-point", "condensed"] {
                let holds = if backends[1] == "fe" { degree - degree % 2 } else { 0 };
                let rest = format!(
                    "[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = [\"a.left\", \"b.left\"]\nfix = [\"x\"]\n\
                     [[boundary]]\non = \"b.top\"\npressure = 1.25e-3\n[solver]\nconstraint = \"{constraint}\"\n\
                     [[contact]]\nname = \"pad\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmultiplier = \"dual\"\n\
                     [[check]]\nquantity = \"stress.yy\"\nequals = -1.25e-3\nover = \"all\"\nrtol = 1e-10\n\
                     [[check]]\nquantity = \"contact.pad.pressure.max\"\nequals = 1.25e-3\nrtol = 1e-10\n\
                     [[check]]\nquantity = \"contact.pad.pressure.min\"\nequals = 1.25e-3\nrtol = 1e-10\n\
                     [[check]]\nquantity = \"contact.pad.multiplier.reproduction\"\nequals = {holds}\natol = 0\n"
                );
                let text = boxes("elasticity", backends[0], degree, [5, 4], &rest)
                    .replace("elements = [4, 2]", &format!("elements = [4, 2]\nbackend = \"{}\"", backends[1]));
                let result = run(&text);
                let pad = result.contact.get("pad").unwrap();
                assert_eq!(pad.active, pad.multiplier.clone().unwrap().functions, "{backends:?} {degree} {constraint}");
            }
        }
    }
}

// The conforming limit. Where the grids match, both sides carry one trace space W, and the jump [u] lies in W. Tied rows
// say ∫ psi [u] ds = 0 for all psi of M. If W_0, the part of W that [u] can lie in, has as many functions as M and the
// pair is inf-sup stable (no w of W_0 but zero is orthogonal to M), then [u] = 0: the mortar solution is continuous, so
// it minimises the energy over the same functions as the glued one, and is that one.
//
// Free ends: W_0 = W. p/p has M = W, and psi = [u] gives ∫ [u]^2 ds = 0; on Lagrange traces alike, M being the Bernstein
// basis of W. Both ends on Dirichlet sides: the data lie in the trace space of the outer sides, so both L2 projections
// reproduce them, the end values of both sides agree, and W_0 are the functions of W that vanish at the ends: two less.
// M has two less, too: p/p lowered at both ends and p/p-2 of most continuity have n + p - 2 functions on n elements. Lagrange
// traces have np - 1 against np - 1 for p/p lowered, but n(p - 1) for p/p-2: there the jump keeps n - 1 degrees of
// freedom, and no such limit exists. A dual M has the dimension of W_0 by construction, and D is diagonal: in all cases.
#[test]
fn on_matching_grids_the_mortar_solution_is_the_glued_one() {
    let held = "[[boundary]]\non = \"all-outer\"\ndirichlet = \"1 + x - 2*y\"\n";
    let free = "[[boundary]]\non = [\"a.bottom\", \"b.top\"]\ndirichlet = \"1 + x - 2*y\"\n";
    let probes: String = [[0.13, 0.11], [0.5, 0.5], [0.31, 0.49], [0.77, 0.52], [0.97, 0.6], [0.02, 0.95]]
        .iter()
        .enumerate()
        .map(|(k, x)| format!("[[probe]]\nname = \"p{k}\"\nquantity = \"u at {x:?}\"\n"))
        .collect();
    let mut cases = Vec::new();
    for p in 1..=4usize {
        for backend in ["iga", "fe"] {
            for (word, ends) in [("p/p", free), ("p/p", held), ("p/p-2", held), ("dual", free), ("dual", held)] {
                if word == "p/p-2" && (p < 2 || backend == "fe") {
                    continue;
                }
                cases.push((p, backend, word, ends));
            }
        }
    }
    let apart: Vec<(String, f64)> = cases
        .par_iter()
        .map(|&(p, backend, word, ends)| {
            let with = |tie: String| {
                let text = boxes("poisson", backend, p, [6, 6], &(tie + ends + &probes));
                run(&text.replace("dimension = 2\n", "dimension = 2\nsource = \"20*sin(3*x)*exp(y)\"\n"))
            };
            let tied = with(tie(&format!("\"{word}\"")));
            let glued = with("[[interface]]\nname = \"i\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\ncoupling = \"glue\"\n".into());
            let scale = glued.probes.iter().map(|p| p.value.abs()).fold(0.0, f64::max);
            let probes = tied.probes.iter().zip(&glued.probes).map(|(a, b)| (a.value - b.value).abs() / scale).fold(0.0, f64::max);
            let energy = (tied.energy - glued.energy).abs() / glued.energy;
            let jump = tied.interface.get("i").unwrap().jump.l2 / scale;
            (format!("{word} of degree {p} on {backend}, held {}", ends == held), probes.max(energy).max(jump))
        })
        .collect();
    let worst = apart.iter().map(|a| a.1).fold(0.0, f64::max);
    println!("{} pairs apart by {worst:.1e}", apart.len());
    let missed: Vec<&(String, f64)> = apart.iter().filter(|a| a.1.is_nan() || a.1 > 1e-11).collect();
    assert!(missed.is_empty(), "{missed:#?}");
    // p/p-2 on Lagrange traces leaves jumps: the count above, not the tolerance, decides
    let text = boxes("poisson", "fe", 3, [6, 6], &(tie("\"p/p-2\"") + held));
    let jump =
        run(&text.replace("dimension = 2\n", "dimension = 2\nsource = \"20*sin(3*x)*exp(y)\"\n")).interface.get("i").unwrap().jump.l2;
    assert!(jump > 1e-9, "{jump:e}");
}
