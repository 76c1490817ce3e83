//! Inf-sup constants of sides in space: products of those of their directions on tensor cells, bounded on triangles.

use faying::problem::SlaveEnds;
use faying_cli::case::ReadOptions;
use faying_cli::infsup::{Constant, InfSupOptions, constants};
use faying_cli::{Case, Registry, RunControl};

fn found(text: &str, ends: SlaveEnds) -> Vec<Constant> {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    constants(&case, &Registry::default(), &InfSupOptions { ends, ..InfSupOptions::default() }, &RunControl::default())
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Two boxes of one layer, the lower one slave, with these elements along the interface.
fn boxes(physics: &str, cells: &str, elements: &[&str], multiplier: &str) -> String {
    let n = elements.len() + 1;
    let point = |last: f64| format!("[{}{last}]", "0, ".repeat(n - 1));
    let far = |last: f64| format!("[{}{last}]", "1, ".repeat(n - 1));
    let patch = |name: &str, z: f64, elements: &str| {
        let shape = format!("{{ kind = \"box\", min = {}, max = {} }}", point(z), far(z + 1.0));
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {shape}\nelements = [{elements}]\n")
    };
    format!(
        "[model]\nphysics = \"{physics}\"\ndimension = {n}\n[discretization]\n{cells}\n[[material]]\nname = \"m\"\n{}\n{}{}\
         [[boundary]]\non = \"all-outer\"\ndirichlet = {}\n\
         [[interface]]\nname = \"seam\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\nmultiplier = \"{multiplier}\"\n",
        if physics == "poisson" { "" } else { "young = 1\npoisson = 0.3" },
        patch("lower", 0.0, &format!("{}, 1", elements.join(", "))),
        patch("upper", 1.0, &vec!["1"; n].join(", ")),
        if physics == "poisson" { "\"0\"" } else { "[\"0\", \"0\", \"0\"]" },
    )
}

/// The constant of a side of tensor cells is the product of those of its directions, one of them graded, by area and in the parameters.
#[test]
fn a_side_of_tensor_cells_has_the_product_of_its_directions() {
    let axes = ["5", "[0, 0.1, 0.25, 0.5, 0.8, 0.9, 1]"];
    for backend in ["iga", "fe"] {
        for (degree, multiplier) in [(1, "p/p"), (2, "p/p"), (2, "p/p-1"), (2, "p/p-2"), (3, "p/p-2"), (3, "constant")] {
            for ends in [SlaveEnds::Stated, SlaveEnds::Zero, SlaveEnds::Free] {
                let cells = format!("backend = \"{backend}\"\ndegree = {degree}");
                let one = |axis: &str| found(&boxes("poisson", &cells, &[axis], multiplier), ends).remove(0);
                let [u, v] = axes.map(one);
                let surface = found(&boxes("poisson", &cells, &axes, multiplier), ends).remove(0);
                let label = format!("{cells} {multiplier} {ends:?}");
                let wanted = u.found.beta * v.found.beta;
                assert!((surface.found.beta - wanted).abs() < 1e-8, "{label}: {} {wanted}", surface.found.beta);
                let wanted = u.parametric * v.parametric;
                assert!((surface.parametric - wanted).abs() < 1e-8, "{label}: {} {wanted}", surface.parametric);
                assert_eq!(surface.found.multipliers, u.found.multipliers * v.found.multipliers, "{label}");
                assert_eq!(surface.found.functions, u.found.functions * v.found.functions, "{label}");
                assert_eq!((surface.elements, surface.pairing.as_deref()), (30, Some(multiplier)), "{label}");
            }
        }
    }
}

/// `auto` on triangles, whatever the ends: continuous polynomials one degree lower at p = 2, two degrees lower from p = 3 on.
#[test]
fn continuous_multipliers_are_stable_on_triangles() {
    for (degree, name, least) in [(2, "p/p-1", 0.2), (3, "p/p-2", 0.6), (4, "p/p-2", 0.5)] {
        let sizes: &[usize] = if degree == 2 { &[4, 6, 8, 12] } else { &[4, 6] };
        for &n in sizes {
            for ends in [SlaveEnds::Stated, SlaveEnds::Zero, SlaveEnds::Free] {
                let cells = format!("backend = \"fe\"\ncells = \"simplex\"\ndegree = {degree}");
                let n = n.to_string();
                let side = found(&boxes("poisson", &cells, &[&n, &n], "auto"), ends).remove(0);
                assert_eq!(side.pairing.as_deref(), Some(name));
                assert!(side.found.beta >= least, "{degree} {n} {ends:?}: {}", side.found.beta);
                assert!((side.found.beta - side.parametric).abs() < 1e-8, "{degree} {n} {ends:?}: equal triangles");
            }
        }
    }
}

/// One constant per component of a tie, and one for the normal of a contact.
#[test]
fn ties_and_contacts_have_their_constants() {
    let text = boxes("elasticity", "degree = 2", &["4", "3"], "auto");
    let tied = found(&text, SlaveEnds::Stated);
    assert_eq!(tied.iter().map(|c| c.component).collect::<Vec<_>>(), ["x", "y", "z"]);
    assert!(tied.iter().all(|c| (c.found.beta - tied[0].found.beta).abs() < 1e-12 && c.found.beta > 0.5));
    let pressed = found(&text.replace("[[interface]]", "[[contact]]"), SlaveEnds::Stated);
    assert_eq!((pressed.len(), pressed[0].component), (1, "normal"));
    assert!((pressed[0].found.beta - tied[2].found.beta).abs() < 1e-12, "{} {}", pressed[0].found.beta, tied[2].found.beta);
}
