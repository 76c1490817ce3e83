//! Warnings where a model is rougher than its numbers look: coarse contact zones, ties across gaps, soft penalties, large deformations.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::result::Moment;
use faying_cli::{Case, Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

fn told<'a>(result: &'a RunResult, words: &[&str]) -> Option<&'a Diagnostic> {
    let found = result.warnings.iter().find(|w| w.code == "E065" && words.iter().all(|word| w.message.contains(word)));
    if let Some(w) = found {
        assert!(w.help.is_some() && w.line.is_some(), "{w:?}");
    }
    found
}

fn elastic(young: f64) -> String {
    format!("[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = {young:e}\npoisson = 0.3\n")
}

fn block(name: &str, min: [f64; 2], max: [f64; 2], elements: [usize; 2], rest: &str) -> String {
    format!(
        "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{:e}, {:e}], max = [{:e}, {:e}] }}\nelements = {elements:?}\n{rest}\n",
        min[0], min[1], max[0], max[1]
    )
}

fn on(sides: &str, what: &str) -> String {
    format!("[[boundary]]\non = {sides}\n{what}\n")
}

/// A circle pressed into a block by a given depth: with few elements in the zone its force is far off.
#[test]
fn zones_of_few_functions_are_told_where_their_force_is_wrong() {
    for (size, young) in [(1.0, 1e3), (1e-3, 210e9)] {
        let pressed = |n: usize| {
            let text = elastic(young)
                + &block("b", [-size, -size], [size, 0.0], [n, n], "")
                + &on("\"b.bottom\"", "fix = [\"x\", \"y\"]")
                + &format!(
                    "[[contact]]\nname = \"c\"\nslave = \"b.top\"\nrigid = {{ kind = \"sphere\", center = [0, {size:e}], radius = {size:e}, move = {{ y = {:e} }} }}\n",
                    -0.02 * size
                );
            run(&text)
        };
        let force = |r: &RunResult| r.contact.get("c").unwrap().force[1].abs();
        let fine = pressed(80);
        assert!(told(&fine, &["zone of contact \"c\""]).is_none(), "{:?}", fine.warnings);
        let coarse = pressed(8);
        assert!((force(&coarse) / force(&fine) - 1.0).abs() > 0.05, "{} {}", force(&coarse), force(&fine));
        let active = coarse.contact.get("c").unwrap().active;
        assert!(told(&coarse, &["zone of contact \"c\"", &format!("{active} functions")]).is_some(), "{active}: {:?}", coarse.warnings);
    }
    // all of what faces is closed: the zone ends with the side
    let flat = elastic(1e3)
        + &block("a", [0.0, 0.0], [1.0, 1.0], [2, 2], "")
        + &block("b", [0.0, 1.0], [1.0, 2.0], [2, 2], "")
        + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
        + &on("\"b.top\"", "dirichlet = [\"0\", \"-1e-3\"]")
        + "[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n";
    assert!(run(&flat).warnings.is_empty(), "{:?}", run(&flat).warnings);
}

/// Half cylinders and balls of revolution on a plane (Hertz): whatever is beyond a quarter of the greatest pressure is told, and fine zones are not.
#[test]
fn coarse_zones_of_half_models_and_on_axes_are_told() {
    let text = |is_ball: bool, degree: usize, n: usize| {
        let (assumption, force) = if is_ball { ("axisymmetric", "4*Es*a^3/(3*R)") } else { ("plane-strain", "pi*a^2*Es/(8*R)") };
        let symmetry = if is_ball { "" } else { "symmetry = true\n" };
        format!(
            "[let]\nR = 1.0\nE = 1.0\nnu = 0.3\na = 0.02\nEs = \"E/(1 - nu^2)\"\nF = \"{force}\"\n[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"{assumption}\"\n\
             [discretization]\ndegree = {degree}\nmapping = \"exact\"\n[[material]]\nname = \"m\"\nyoung = \"E\"\npoisson = \"nu\"\n[[patch]]\nname = \"k\"\nelements = [{n}, {n}]\n\
             geometry = {{ kind = \"annulus-sector\", center = [0, \"R\"], radius = [\"0.1*R\", \"R\"], angle_deg = [-90, 0] }}\n\
             grade = {{ toward = {{ u = 0.0, v = 1.0 }}, ratio = 0.02 }}\n[[boundary]]\non = \"k.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"k.u1\"\nrigid_force = {{ y = \"-F\" }}\n\
             [[contact]]\nname = \"c\"\nslave = \"k.v1\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n{symmetry}"
        )
    };
    let fine = [false, true].map(|is_ball| run(&text(is_ball, 2, 48)).contact.get("c").unwrap().pressure.max);
    for (is_ball, fine) in [false, true].into_iter().zip(fine) {
        for degree in 1..=4 {
            for n in [8, 10, 12, 16, 20, 48] {
                let result = run(&text(is_ball, degree, n));
                let found = result.contact.get("c").unwrap();
                let off = (found.pressure.max / fine - 1.0).abs();
                let warned = told(&result, &["zone of contact \"c\" is too coarse"]).is_some();
                println!("ball {is_ball} degree {degree} n {n}: {} functions, {off:.3} {warned}", found.active);
                assert!(warned || off < 0.35, "ball {is_ball} degree {degree} n {n}: {} functions, {off}", found.active);
                assert!(!warned || n < 48, "ball {is_ball} degree {degree} n {n}: {} functions, {off}", found.active);
            }
        }
    }
}

/// Shear F through a gap h loses the moment F h; a normal force loses none.
#[test]
fn the_moment_that_a_tie_across_a_gap_loses_is_told_as_it_is() {
    for (size, young) in [(1.0, 1e3), (1e-3, 1e9)] {
        let tied = |gap: f64, load: &str| {
            let text = elastic(young)
                + &block("a", [0.0, 0.0], [size, size], [4, 4], "")
                + &block("b", [0.0, size * (1.0 + gap)], [size, size * (2.0 + gap)], [3, 3], "")
                + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
                + &on("\"b.top\"", &format!("traction = {load}"))
                + &format!("[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\ntolerance = {:e}\n", size);
            run(&text)
        };
        let t = 1e-3 * young;
        let result = tied(0.05, &format!("{{ x = {t:e} }}"));
        let lost = 0.05 * size * t * size;
        let Some(Moment::Plane(missing)) = result.balance.moment else { panic!() };
        assert!((missing.abs() / lost - 1.0).abs() < 1e-3, "{missing} {lost}");
        let warning = told(&result, &["interface \"i\" loses a moment"]).unwrap_or_else(|| panic!("{:?}", result.warnings));
        let number: f64 = warning.message.split("have the moment ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((number / lost - 1.0).abs() < 1e-2, "{warning:?}");
        for sound in [tied(0.0, &format!("{{ x = {t:e} }}")), tied(0.05, &format!("{{ y = {t:e} }}"))] {
            assert!(told(&sound, &["loses a moment"]).is_none(), "{:?}", sound.warnings);
        }
    }
}

#[test]
fn penalties_that_let_bodies_sink_are_told_with_the_depth() {
    for (size, young) in [(1.0, 1e3), (1e-3, 210e9)] {
        let pressed = |method: &str| {
            let text = elastic(young)
                + &block("a", [0.0, 0.0], [size, size], [4, 4], "")
                + &block("b", [0.0, size], [size, 2.0 * size], [4, 4], "")
                + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
                + &on("[\"b.left\", \"b.right\"]", "fix = [\"x\"]")
                + &on("\"b.top\"", &format!("pressure = {:e}", 0.02 * young))
                + &format!("[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n{method}\n");
            run(&text)
        };
        let soft = pressed("method = \"penalty\"\nfactor = 0.1");
        let depth = -soft.contact.get("c").unwrap().gap.min;
        assert!(depth > 0.015 * size, "{depth}");
        let warning = told(&soft, &["penalty of contact \"c\""]).unwrap_or_else(|| panic!("{:?}", soft.warnings));
        let number: f64 = warning.message.split("by ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
        assert!((number / depth - 1.0).abs() < 1e-3, "{warning:?}");
        for method in ["method = \"penalty\"", "method = \"augmented\"\nfactor = 0.1", ""] {
            let sound = pressed(method);
            assert!(told(&sound, &["penalty"]).is_none(), "{method}: {:?}", sound.warnings);
        }
    }
}

/// Blocks pushed together by less than a hundredth of their size, through a penalty that yields nearly all of it.
#[test]
fn penalties_that_take_most_of_a_small_displacement_are_told() {
    for (size, young) in [(1.0, 1e3), (1e-3, 210e9)] {
        let joints = [
            ("contact", "method = \"penalty\"", "method = \"augmented\""),
            ("interface", "coupling = \"penalty\"", "coupling = \"mortar\""),
        ];
        for (joint, soft, sound) in joints {
            let pushed = |method: &str| {
                let text = elastic(young)
                    + &block("a", [0.0, 0.0], [size, size], [4, 4], "")
                    + &block("b", [0.0, size], [size, 2.0 * size], [4, 4], "")
                    + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
                    + &on("\"b.top\"", &format!("dirichlet = {{ x = 0, y = {:e} }}", -1e-4 * size))
                    + &format!("[[{joint}]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n{method}\n");
                run(&text)
            };
            let force = |r: &RunResult| r.reactions.get("a.bottom").unwrap()[1];
            let (yields, stiff) = (pushed(&format!("{soft}\nfactor = 1e-3")), pushed(sound));
            assert!(force(&yields) < 0.2 * force(&stiff), "{} {}", force(&yields), force(&stiff));
            let words = [&*format!("penalty of {joint} \"c\""), "of their largest displacement"];
            assert!(told(&yields, &words).is_some(), "{:?}", yields.warnings);
            for fine in [stiff, pushed(soft)] {
                assert!(told(&fine, &["penalty"]).is_none(), "{:?}", fine.warnings);
            }
        }
    }
}

/// A plate that bends between the two or three functions of its support: no penalty is soft there, the multiplier is too coarse.
#[test]
fn sides_that_come_apart_between_the_functions_of_a_multiplier_are_not_blamed_on_the_penalty() {
    for (size, young) in [(1.0, 1.0), (1e-3, 210e9)] {
        let bent = |n: usize, method: &str| {
            let text = elastic(young)
                + "[discretization]\ndegree = 2\n"
                + &block("a", [0.0, 0.0], [size, 0.5 * size], [n, 1], "")
                + &block("b", [0.0, 0.5 * size], [size, 0.7 * size], [8, 2], "")
                + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
                + &on("\"b.top\"", &format!("traction = [\"0\", \"{:e}*sin(4*pi*x/{size:e})\"]", 0.001 * young))
                + &format!("[[interface]]\nname = \"c\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\n{method}\n");
            run(&text)
        };
        for n in [2, 3, 4] {
            // the same jump with exact rows and with any stiff penalty, so it is not the penalty's
            let [mortar, stiff, stiffer] =
                ["", "coupling = \"penalty\"", "coupling = \"penalty\"\nfactor = 1e12"].map(|method| bent(n, method));
            let jump = |r: &RunResult| r.interface.get("c").unwrap().jump.l2 / size.sqrt();
            for result in [&mortar, &stiff, &stiffer] {
                assert!((jump(result) / jump(&mortar) - 1.0).abs() < 1e-6);
                assert!(told(result, &["penalty"]).is_none(), "{:?}", result.warnings);
                let warning = told(result, &["interface \"c\" is too coarse"]).unwrap_or_else(|| panic!("{n}: {:?}", result.warnings));
                let number: f64 = warning.message.split("come apart by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
                assert!((number / jump(result) - 1.0).abs() < 1e-3, "{warning:?}");
            }
        }
        // eight elements hold it, and a soft penalty is told by the means that it leaves
        assert!(told(&bent(8, ""), &["too coarse"]).is_none());
        let soft = bent(8, "coupling = \"penalty\"\nfactor = 1e-2");
        assert!(told(&soft, &["penalty of interface \"c\""]).is_some(), "{:?}", soft.warnings);
    }
}

/// Rings pressed into one another by Nitsche's method: curved elements that leave their circle by 1e-5 of the radius have pressures at points
/// that are several times too large, while the force is right.
#[test]
fn pressures_at_points_that_are_not_the_stress_are_told() {
    for (size, modulus) in [(1.0, 1.0), (1e-2, 1e9)] {
        let pressed = |outer: &str, method: &str| {
            let ring = |name: &str, radius: [f64; 2], young: f64, rest: &str| {
                format!(
                    "[[material]]\nname = \"m{name}\"\nyoung = {:e}\npoisson = 0.3\n[[patch]]\nname = \"{name}\"\nmaterial = \"m{name}\"\n\
                     geometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [{:e}, {:e}], angle_deg = [0, 90] }}\n\
                     elements = [6, 3]\ndegree = 3\n{rest}\n",
                    young * modulus,
                    radius[0] * size,
                    radius[1] * size
                )
            };
            let text = String::from("[model]\nphysics = \"elasticity\"\ndimension = 2\n")
                + &ring("a", [1.0, 1.4], 0.3, "")
                + &ring("b", [1.399, 1.9], 0.2, outer)
                + &on("[\"a.u0\", \"a.u1\", \"b.u0\", \"b.u1\"]", "fix = [\"normal\"]")
                + &format!("[[contact]]\nname = \"c\"\nslave = \"a.v1\"\nmaster = \"b.v0\"\nmethod = \"{method}\"\n");
            run(&text)
        };
        let words = ["the pressure of contact \"c\" at points is not the stress of its bodies"];
        let range = |r: &RunResult| r.contact.get("c").map(|c| (c.pressure.min / modulus, c.pressure.max / modulus)).unwrap();
        let (right, wrong) = (pressed("mapping = \"exact\"\nbackend = \"fe\"", "nitsche"), pressed("backend = \"fe\"", "nitsche"));
        let ((least, most), (_, too_much)) = (range(&right), range(&wrong));
        assert!(most < 1.05 * least && too_much > 1.3 * most, "{least} {most} {too_much}");
        assert!(told(&right, &words).is_none(), "{:?}", right.warnings);
        assert!(told(&wrong, &words).is_some(), "{:?}", wrong.warnings);
        assert!(told(&pressed("backend = \"fe\"", "lagrange"), &words).is_none());
    }
}

/// Factors so large that rounding of the gap times the factor is the pressure.
#[test]
fn factors_of_nitsches_method_that_turn_rounding_into_pressure_are_told() {
    let pressed = |factor: f64| {
        let text = elastic(1e3)
            + &block("a", [0.0, 0.0], [1.0, 1.0], [4, 4], "")
            + &block("b", [0.0, 1.0], [1.0, 2.0], [3, 3], "")
            + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
            + &on("\"b.top\"", "dirichlet = { x = 0, y = -1e-3 }")
            + &format!("[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmethod = \"nitsche\"\nfactor = {factor:e}\n");
        let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap();
        case.run(&Registry::default()).unwrap()
    };
    let right = pressed(100.0);
    let force = |r: &RunResult| r.contact.get("c").unwrap().force[1];
    let most = |r: &RunResult| r.contact.get("c").unwrap().pressure.max;
    for factor in [1e6, 1e9, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e18] {
        let found = pressed(factor);
        let is_right =
            found.status == Status::Ok && (force(&found) / force(&right) - 1.0).abs() < 0.05 && most(&found) < 3.0 * most(&right);
        assert!(is_right || found.status != Status::Ok || !found.warnings.is_empty(), "{factor:e}: {} {}", force(&found), most(&found));
    }
}

/// A cantilever: small strains and large rotations; a block in tension: large strains.
#[test]
fn strains_and_rotations_beyond_small_kinematics_are_told() {
    for (size, young) in [(1.0, 1e3), (1e-3, 210e9)] {
        let beam = |load: f64| {
            let text = elastic(young)
                + &block("b", [0.0, 0.0], [10.0 * size, size], [20, 2], "")
                + &on("\"b.left\"", "fix = [\"x\", \"y\"]")
                + &on("\"b.right\"", &format!("traction = {{ y = {:e} }}", load * young));
            run(&text)
        };
        // rotation of the end 6 F L² / (E h³) / (1 + ..): 0.55 rad per thousandth of E
        let far = beam(-1e-3);
        assert!(told(&far, &["patch \"b\"", "rotations up to", "rad"]).is_some(), "{:?}", far.warnings);
        assert!(told(&far, &["strains"]).is_none(), "{:?}", far.warnings);
        assert!(told(&beam(-1e-2), &["rotations", "strains"]).is_some());
        assert!(beam(-1e-4).warnings.is_empty(), "{:?}", beam(-1e-4).warnings);
        let pulled = |strain: f64| {
            let text = elastic(young)
                + &block("b", [0.0, 0.0], [size, size], [2, 2], "")
                + &on("\"b.left\"", "fix = [\"x\"]")
                + &on("\"b.bottom\"", "fix = [\"y\"]")
                + &on("\"b.right\"", &format!("dirichlet = {{ x = {:e} }}", strain * size));
            run(&text)
        };
        let warning = pulled(0.2);
        assert!(told(&warning, &["strains up to 0.2,", "100 %"]).is_some(), "{:?}", warning.warnings);
        assert!(pulled(0.09).warnings.is_empty());
    }
    // a manufactured solution of any size solves the linear equations
    let exact = "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = { u = [\"sin(x)*y\", \"x*y\"] }\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
        .to_owned()
        + &block("b", [0.0, 0.0], [1.0, 1.0], [2, 2], "")
        + &on("\"all-outer\"", "dirichlet = \"exact\"");
    assert!(run(&exact).warnings.is_empty(), "{:?}", run(&exact).warnings);
    // a strip where strains are large, in a body that hardly deforms
    let strip = elastic(1.0)
        + &block("b", [0.0, 0.0], [1.0, 1.0], [0, 0], "")
            .replace("[0, 0]\n", "[[0, 0.01, 0.02, 0.1, 0.3, 0.6, 1], [0, 0.4, 0.8, 0.95, 0.98, 0.99, 1]]\n")
        + &on("\"b.bottom\"", "fix = [\"x\", \"y\"]")
        + &on("\"b.top\"", "pressure = \"if(x < 0.01, 0.5, 0)\"")
        + "[[probe]]\nname = \"e\"\nquantity = \"stress.yy at [0.005, 0.995]\"\n";
    let result = run(&strip);
    assert!(result.probes[0].value < -0.3, "{:?}", result.probes);
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
}

/// A hard block on a soft one in uniform compression: the error of its stress grows with the contrast, and the condition number says so.
#[test]
fn contrasts_that_leave_few_digits_are_told() {
    for unit in [1.0, 1e9] {
        for (contrast, poor) in [(1.0, false), (1e3, false), (1e9, true), (1e12, true)] {
            let text = format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"hard\"\nyoung = {:e}\npoisson = 0.3\n[[material]]\nname = \"soft\"\nyoung = {unit:e}\npoisson = 0.3\n",
                contrast * unit
            ) + &block("a", [0.0, 0.0], [1.0, 1.0], [8, 8], "material = \"soft\"")
                + &block("b", [0.0, 1.0], [1.0, 2.0], [9, 8], "material = \"hard\"")
                + &on("[\"a.left\", \"a.right\", \"b.left\", \"b.right\"]", "fix = [\"x\"]")
                + &on("\"a.bottom\"", "fix = [\"y\"]")
                + &on("\"b.top\"", &format!("pressure = {:e}", 1e-3 * unit))
                + "[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n[[probe]]\nname = \"s\"\nquantity = \"stress.yy at [0.5, 1.5]\"\n";
            let result = run(&text);
            let off = (result.probes[0].value / (-1e-3 * unit) - 1.0).abs();
            let warning = told(&result, &["rounding", "\"b\"", "times as stiff as \"a\""]);
            assert_eq!(warning.is_some(), poor, "{contrast:e}, off by {off:e}: {:?}", result.warnings);
            assert!(poor || off < 1e-9, "{contrast:e}: {off:e}");
        }
    }
}
