//! Contact does not know units, directions, roles of the bodies or threads.

use crate::common::pressed;
use pressed::{Frame, difference, run, solve};
use rayon::prelude::*;

/// Results that differ by a scale alone agree to this.
const SAME: f64 = 1e-8;

/// What fills a patch: a backend and its words.
const BACKENDS: [&str; 3] = ["iga", "fe", "simplex"];

fn backend(name: &str) -> &'static str {
    match name {
        "iga" => "backend = \"iga\"",
        "fe" => "backend = \"fe\"",
        _ => "backend = \"fe\"\ncells = \"simplex\"",
    }
}

/// Ways to hold a contact: multipliers, cones, an integration, and methods with a variant.
const LAWS: [&str; 10] = ["p/p", "p/p-2", "dual", "weights", "values", "mixed", "penalty", "augmented", "nitsche", "nitsche unsymmetric"];

/// Whether gap and multiplier of a law meet the conditions of contact themselves: not softened, and not in the variables of a cone.
fn is_plain(law: &str) -> bool {
    ["p/p", "p/p-2", "dual", "mixed", "augmented"].contains(&law)
}

fn words(law: &str) -> String {
    match law {
        "weights" | "values" => format!("multiplier = \"p/p\"\ncone = \"{law}\""),
        "mixed" => "integration = \"mixed\"".into(),
        "penalty" | "augmented" | "nitsche" => format!("method = \"{law}\""),
        "nitsche unsymmetric" => "method = \"nitsche\"\nvariant = \"unsymmetric\"".into(),
        multiplier => format!("multiplier = \"{multiplier}\""),
    }
}

fn head(f: &Frame, kind: &str, degree: usize) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\n{}\ndegree = {degree}\n\
         [[material]]\nname = \"soft\"\nyoung = {}\npoisson = 0.3\n[[material]]\nname = \"hard\"\nyoung = {}\npoisson = 0.2\n",
        backend(kind),
        f.stress(1.0),
        f.stress(7.0)
    )
}

fn probes(f: &Frame, at: &[(&str, [f64; 2], &str)]) -> String {
    at.iter()
        .map(|(name, x, patch)| {
            let x = f.point(*x);
            format!(
                "[[probe]]\nname = \"{name}-x\"\nquantity = \"u.x at {x} in {patch}\"\n\
                 [[probe]]\nname = \"{name}-y\"\nquantity = \"u.y at {x} in {patch}\"\n\
                 [[probe]]\nname = \"{name}-stress\"\nquantity = \"von_mises at {x} in {patch}\"\n"
            )
        })
        .collect()
}

/// A roller rolls off centre over a block: both deform, a part of the roller's arc touches.
fn roller(f: &Frame, kind: &str, law: &str) -> String {
    let law = words(law);
    format!(
        "{}[[patch]]\nname = \"block\"\nmaterial = \"soft\"\nelements = [7, 4]\ngeometry = {}\n\
         [[patch]]\nname = \"roller\"\nmaterial = \"hard\"\nelements = [10, 4]\ngeometry = {}\n\
         [[boundary]]\non = \"block.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"roller.v0\"\ndirichlet = {}\n\
         [[contact]]\nname = \"c\"\nslave = \"roller.v1\"\nmaster = \"block.top\"\n{law}\n\
         active_set = {{ start = \"gap\" }}\n{}",
        head(f, kind, 2),
        f.geometry("kind = \"box\", min = [-1.1, -1], max = [1, 0]"),
        f.geometry("kind = \"annulus-sector\", center = [0.07, 1], radius = [0.4, 1], angle_deg = [-135, -45]"),
        f.data([0.004, -0.03], f.length),
        probes(f, &[("in", [0.1, -0.2], "block"), ("above", [0.0, 0.3], "roller")])
    )
}

/// A roller on springs is pressed on a half-plane by a traction.
fn on_a_plane(f: &Frame, kind: &str, law: &str) -> String {
    let law = words(law);
    format!(
        "{}[[patch]]\nname = \"roller\"\nmaterial = \"soft\"\nelements = [9, 4]\ngeometry = {}\n\
         [[boundary]]\non = \"roller.v0\"\ntraction = {}\nspring = {{ x = \"{k}\", y = \"{k}\" }}\n\
         [[contact]]\nname = \"c\"\nslave = \"roller.v1\"\nrigid = {{ kind = \"half-plane\", point = {}, normal = {} }}\n\
         {law}\nactive_set = {{ start = \"gap\" }}\n{}",
        head(f, kind, 2),
        f.geometry("kind = \"annulus-sector\", center = [0, 1], radius = [0.4, 1], angle_deg = [-130, -50]"),
        f.data([0.001, -0.08], f.modulus),
        f.point([0.3, 0.001]),
        f.vector([0.01, 1.0], 1.0),
        probes(f, &[("in", [0.05, 0.2], "roller")]),
        k = f.stress(0.1) + &format!("/{:.17e}", f.length),
    )
}

/// A rigid ball is pressed into a block that lies in a box.
fn under_a_ball(f: &Frame, kind: &str, law: &str) -> String {
    let law = words(law);
    format!(
        "{}[[patch]]\nname = \"block\"\nmaterial = \"soft\"\nelements = [11, 5]\ngeometry = {}\n\
         [[boundary]]\non = [\"block.bottom\", \"block.left\", \"block.right\"]\nfix = [\"normal\"]\n\
         [[contact]]\nname = \"c\"\nslave = \"block.top\"\nrigid = {{ kind = \"sphere\", center = {}, radius = {} }}\n\
         {law}\nactive_set = {{ start = \"gap\" }}\n{}",
        head(f, kind, 2),
        f.geometry("kind = \"box\", min = [-1, -1], max = [1.2, 0]"),
        f.point([0.05, 0.77]),
        f.length(0.8),
        probes(f, &[("in", [0.1, -0.2], "block")])
    )
}

/// A block stands on another, grids do not match: closed everywhere.
fn stack(f: &Frame, kind: &str, law: &str) -> String {
    let law = words(law);
    format!(
        "{}[[patch]]\nname = \"lower\"\nmaterial = \"soft\"\nelements = [4, 2]\ngeometry = {}\n\
         [[patch]]\nname = \"upper\"\nmaterial = \"hard\"\nelements = [[0, 0.2, 0.45, 0.8, 1], 2]\ngeometry = {}\n\
         [[boundary]]\non = [\"lower.bottom\", \"lower.left\", \"upper.left\"]\nfix = [\"normal\"]\n\
         [[boundary]]\non = \"upper.top\"\npressure = {}\n\
         [[contact]]\nname = \"c\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n{law}\n{}",
        head(f, kind, 2),
        f.geometry("kind = \"box\", min = [0, 0], max = [1, 0.5]"),
        f.geometry("kind = \"box\", min = [0, 0.5], max = [1, 1]"),
        f.stress(0.002),
        probes(f, &[("in", [0.4, 0.3], "lower"), ("above", [0.7, 0.9], "upper")])
    )
}

type Make = fn(&Frame, &str, &str) -> String;
const MODELS: [(&str, Make); 4] = [("roller", roller), ("plane", on_a_plane), ("ball", under_a_ball), ("stack", stack)];

/// Some frames; with `FAYING_CONTACT=all` every pair of a length and a modulus, straight and turned.
fn frames() -> Vec<Frame> {
    if std::env::var("FAYING_CONTACT").is_ok_and(|v| v == "all") {
        let lengths = [-6, -4, -2, 0, 1, 3, 6].map(|k| 10.0_f64.powi(k));
        let moduli = [-9, -6, -3, 0, 4, 8, 12].map(|k| 10.0_f64.powi(k));
        let pairs = lengths.into_iter().flat_map(|length| moduli.map(|modulus| (length, modulus)));
        return pairs.flat_map(|(length, modulus)| [0.0, 37.0, 90.0, -123.0].map(|angle| Frame { length, modulus, angle })).collect();
    }
    let all =
        [(1e-6, 1.0, 0.0), (1e6, 1.0, 0.0), (1.0, 1e-9, 0.0), (1.0, 1e12, 0.0), (1.0, 1.0, 37.0), (1e-6, 1e12, 37.0), (1e6, 1e-9, 37.0)];
    all.into_iter().map(|(length, modulus, angle)| Frame { length, modulus, angle }).collect()
}

#[test]
fn results_scale_with_units_and_turn_with_the_frame() {
    let mut cases = Vec::new();
    for (name, make) in MODELS {
        for kind in BACKENDS {
            for law in LAWS {
                cases.push((name, make, kind, law));
            }
        }
    }
    let failures: Vec<String> = cases
        .par_iter()
        .flat_map_iter(|&(name, make, kind, law)| {
            let numbers = move |f: &Frame| {
                let text = make(f, kind, law);
                let mut numbers = f.numbers(&if is_plain(law) { run(&text, &[], f.length) } else { solve(&text, &[]) });
                // its updates end at round-off, where one more or less is chance
                numbers.retain(|(name, ..)| law != "augmented" || name != "c.iterations");
                numbers
            };
            let own = numbers(&Frame::OWN);
            frames().into_iter().filter_map(move |f| {
                let (worst, at) = difference(&own, &numbers(&f));
                println!("{name} {kind} {law} {f:?}: {worst:e} {at}");
                (worst > SAME || worst.is_nan()).then(|| format!("{name} {kind} {law} {f:?}: {worst:e} at {at}"))
            })
        })
        .collect();
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

// ------------------------------------------------------------------------------------------------------------------ roles exchanged

/// Two blocks of unlike materials with a parabolic gap of at most 0.0121 between their flat sides, pressed by 0.01 and sheared.
fn pads(kind: &str, multiplier: &str, [lower, upper]: [&str; 2], swapped: bool) -> String {
    let law = words(multiplier);
    let (slave, master) = if swapped { ("lower.top", "upper.bottom") } else { ("upper.bottom", "lower.top") };
    let f = Frame::OWN;
    format!(
        "{}[[patch]]\nname = \"lower\"\nmaterial = \"soft\"\nelements = {lower}\ngeometry = {}\n\
         [[patch]]\nname = \"upper\"\nmaterial = \"hard\"\nelements = {upper}\ngeometry = {}\n\
         [[boundary]]\non = \"lower.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"upper.top\"\ndirichlet = [\"0.003\", \"-0.01\"]\n\
         [[contact]]\nname = \"c\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{law}\ngap = \"0.04*(x - 0.45)^2\"\n\
         active_set = {{ start = \"gap\" }}\n{}",
        head(&f, kind, 2),
        f.geometry("kind = \"box\", min = [0, 0], max = [1, 0.5]"),
        f.geometry("kind = \"box\", min = [0, 0.5], max = [1, 1]"),
        probes(&f, &[("in", [0.4, 0.3], "lower"), ("above", [0.7, 0.9], "upper")])
    )
}

/// The numbers of a result whose roles were exchanged: its forces act on the other body.
fn as_seen_from_the_other_body(numbers: Vec<(String, f64, f64)>) -> Vec<(String, f64, f64)> {
    let turns = |name: &str| ["c.x", "c.y", "c.moment"].contains(&name);
    numbers.into_iter().map(|(name, x, scale)| if turns(&name) { (name, -x, scale) } else { (name, x, scale) }).collect()
}

#[test]
fn roles_do_not_matter_on_grids_that_match_and_in_patch_states() {
    let own = Frame::OWN;
    for kind in BACKENDS {
        for multiplier in ["p/p", "p/p-2", "dual"] {
            let grid = ["[[0, 0.2, 0.3, 0.45, 0.6, 0.8, 1], 3]", "[[0, 0.2, 0.3, 0.45, 0.6, 0.8, 1], 2]"];
            let [one, other] = [false, true].map(|swapped| own.numbers(&run(&pads(kind, multiplier, grid, swapped), &[], 1.0)));
            let (worst, at) = difference(&one, &as_seen_from_the_other_body(other));
            println!("pads {kind} {multiplier}: {worst:e} {at}");
            assert!(worst <= SAME, "{kind} {multiplier}: {worst:e} at {at}");
            assert!(one.iter().any(|(n, x, _)| n == "c.area" && *x > 0.5 && *x < 0.99), "contact is partial: {one:?}");

            let stack = stack(&own, kind, multiplier);
            // the materials' lateral strains are the same: the stress is uniform
            let stack = stack
                .replace(&format!("young = {}\npoisson = 0.2", own.stress(7.0)), &format!("young = {}\npoisson = 0.3", own.stress(1.0)));
            let [one, other] = [stack.clone(), stack.replace("slave", "m").replace("master", "slave").replace("\nm = ", "\nmaster = ")]
                .map(|text| own.numbers(&run(&text, &[], 1.0)).into_iter().filter(|(n, ..)| n != "c.active").collect::<Vec<_>>());
            let (worst, at) = difference(&one, &as_seen_from_the_other_body(other));
            println!("stack {kind} {multiplier}: {worst:e} {at}");
            assert!(worst <= SAME, "{kind} {multiplier}: {worst:e} at {at}");
        }
    }
}

/// Rings of SSNP167 with a pressure that varies by a half, grids 6 x 3 against 4 x 2.
fn rings(swapped: bool) -> String {
    let (slave, master) = if swapped { ("inner.v1", "outer.v0") } else { ("outer.v0", "inner.v1") };
    let ring = |name: &str, radius: &str, elements: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\nelements = {elements}\n\
             geometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = {radius}, angle_deg = [0, 90] }}\n"
        )
    };
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nmapping = \"exact\"\n[[material]]\nname = \"m\"\nyoung = 1e9\npoisson = 0.2\n\
         {}{}[[boundary]]\non = [\"inner.u0\", \"outer.u0\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"inner.u1\", \"outer.u1\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"outer.v1\"\npressure = \"1e7 + 5e6*cos(2*theta)\"\n\
         [[contact]]\nname = \"fit\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n",
        ring("outer", "[0.6, 1]", "[6, 3]"),
        ring("inner", "[0.2, 0.6]", "[4, 2]")
    )
}

/// Relative differences of the energies of two roles over levels of refinement.
fn role_differences(
    levels: std::ops::RangeInclusive<usize>,
    make: impl Fn(bool) -> String,
    patches: [&str; 2],
    sets: &[String],
) -> Vec<f64> {
    levels
        .map(|level| {
            let energy = |swapped| {
                let mut words: Vec<String> = sets.to_vec();
                words.extend(patches.map(|p| format!("patch.{p}.refine={level}")));
                let words: Vec<&str> = words.iter().map(String::as_str).collect();
                run(&make(swapped), &words, 1.0).energy
            };
            let (a, b) = (energy(false), energy(true));
            (a / b - 1.0).abs()
        })
        .collect()
}

// The energy converges twice as fast as its norm: h^(2p) with p/p; p/p-2 loses half an order of the norm.
#[test]
fn the_difference_of_roles_falls_at_the_order_of_the_discretisation() {
    for backend in ["iga", "fe"] {
        for degree in [2, 3] {
            for (multiplier, order) in [("p/p", 2 * degree), ("p/p-2", 2 * degree - 1)] {
                let sets = [
                    format!("discretization.backend={backend}"),
                    format!("discretization.degree={degree}"),
                    format!("contact.fit.multiplier={multiplier}"),
                ];
                let d = role_differences(0..=2, rings, ["inner", "outer"], &sets);
                let rate = (d[0] / d[2]).log2() / 2.0;
                println!("{backend} {degree} {multiplier}: {d:?}, rate {rate}");
                assert!(rate >= f64::from(order) - 0.1, "{backend} {degree} {multiplier}: {d:?}, rate {rate}, expected {order}");
            }
        }
        // the end of a partial contact moves by parts of elements: no rate from level to level, one over three
        for multiplier in ["p/p", "p/p-2", "dual"] {
            let grid = ["[5, 3]", "[7, 3]"];
            let d = role_differences(0..=3, |swapped| pads(backend, multiplier, grid, swapped), ["lower", "upper"], &[]);
            let rate = (d[0] / d[3]).log2() / 3.0;
            println!("{backend} {multiplier}, partial: {d:?}, rate {rate}");
            assert!(rate >= 2.0, "{backend} {multiplier}, partial: {d:?}, rate {rate}");
        }
    }
}

// ------------------------------------------------------------------------------------------------------------------------- threads

#[test]
fn results_have_the_same_bits_on_one_thread_and_on_two() {
    for (name, make) in MODELS {
        for kind in BACKENDS {
            let text = make(&Frame::OWN, kind, "p/p-2");
            let patches = ["block", "roller", "lower", "upper"].into_iter().filter(|p| text.contains(&format!("name = \"{p}\"")));
            let sets: Vec<String> = patches.map(|p| format!("patch.{p}.refine=2")).collect();
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let on = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| serde_json::to_string(&run(&text, &sets, 1.0)).unwrap())
            };
            assert_eq!(on(1), on(2), "{name} {kind}");
        }
    }
}
