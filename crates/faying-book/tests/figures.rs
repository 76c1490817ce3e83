//! Figures of the chapter on choices are those of the texts that it cites.

use std::fs;

/// A figure of the chapter, the text that it is taken from, and the figure there.
const FIGURES: [(&str, &str, &str); 31] = [
    (
        "by 0.1 % where the zone is 3 % of the radius, by 0.6 % at 11 %",
        CONTACT,
        "0.1 % in energy where the zone is 3 % of the radius, 0.6 % at 11 %",
    ),
    ("a factor 1.6 in energy", VERIFIED, "in energy (1.6 the worst of Nitsche)"),
    ("$1.9\\cdot 10^{-8}$ with 311 unknowns", COMPARISONS, "1.9e-8 (311)"),
    ("$5.2\\cdot 10^{-5}$ with 1,310", COMPARISONS, "5.2e-5 (1,310)"),
    ("0.05 % off at degree 2, 0.23 % at degree 3", COMPARISONS, "0.05 % (2,695) | 0.23 % (2,956)"),
    ("$1.2\\cdot 10^{-7}$ with 33,800", COMPARISONS, "| IGA | 2 | 33,800 | 1.236e-07 |"),
    ("132,098 (elements) at degree 2", COMPARISONS, "| FE | 2 | 132,098 | 1.231e-07 |"),
    ("$10^{-3}$ at points of exact sides, $10^{-2}$ on facets", VERIFIED, "pressure at points 1e-3, on facets 1e-2 | `press_fit`"),
    ("$10^{-11}$ in 1120 runs", VERIFIED, "tied linear patch test, 1120 runs"),
    ("80 to 125 per factor 100", VERIFIED, "80 to 125 per factor 100"),
    ("the same to $2\\cdot 10^{-15}$", VERIFIED, "the glued solution | 1e-11 (2e-15) | `skeletons`"),
    ("0.873, 0.809, 0.716, 0.643, 0.585", TIES, "0.873, 0.809, 0.716, 0.643, 0.585"),
    ("3.52 and 2.02 measured at degree 3, where $u$ has 4.17", TIES, "// 4.17, 3.52"),
    ("3.52 and 2.02", TIES, "// 4.17, 2.02"),
    ("$7.5\\cdot 10^{-8}$ for $1.7\\cdot 10^{-6}$", VERIFIED, "p/p 7.5e-8 and 4.7e-7, p/p-2 1.7e-6"),
    ("4.01, 3.00, 3.49", VERIFIED, "4.01/3.00/3.49; 2.26/1.58/.20, 3.67/2.80/.22, 4.01/3.00/1.23"),
    (
        "2.26, 1.58, 0.20; with two points more 3.67, 2.80, 0.22; with ten 4.01, 3.00, 1.23",
        VERIFIED,
        "2.26/1.58/.20, 3.67/2.80/.22, 4.01/3.00/1.23",
    ),
    ("has 6.4 % of its energy, refined three times 20 %", VERIFIED, "6.4 %, 20 % of it"),
    ("bends by 7.4 % of what it should (shear locking), of degree 2 by 99.96 %", VERIFIED, "7.4 %, 99.96 % of it"),
    ("$10^{-7}$ with p + 2 points, $10^{-11}$ with p + 4", VERIFIED, "1e-7 with p + 2 points, 1e-11 with p + 4"),
    ("1: 8.236e-3 | 4: 3587.1", COMPARISONS, "| 2 | 4: 3587.1 | 4 | 6 (3) | 6, 5, 5: 3591.7 |"),
    ("2: 8.244e-3 | 6: 3591.7", COMPARISONS, "| 2 | 1: 8.236e-3 | 1: the same | 3 (3): the same | 2, 2, 2: 8.244e-3 |"),
    ("9.54e-3 for\n  8.242e-3 in `hertz`, 8.241e-3 on halved elements", COMPARISONS, "9.54e-3 at the rim; halved elements 8.241e-3"),
    ("0.179, 0 | 0.076, 0 | 0.021, 0", CONTACT, "| 0 | 0.179 / 0 | 0.131 / -0.147 | 0.139 / -0.089 |"),
    ("0.131, -0.147 | 0.049, -0.062 | 0.022, -0.010", CONTACT, "| 1 | 0.076 / 0 | 0.049 / -0.062 | 0.059 / -0.062 |"),
    ("0.139, -0.089 | 0.059, -0.062 | 0.034, -0.059", CONTACT, "| 2 | 0.021 / 0 | 0.022 / -0.010 | 0.034 / -0.059 |"),
    (
        "83,592 unknowns takes 4.3 to 4.6 s for the 9.9 to 10.3 s",
        BENCHES,
        "83,592 unknowns, one thread, CPU from 9.9 to 10.3 s to 4.3 to 4.6 s",
    ),
    ("522,242 unknowns of elasticity on triangles take 3.4 s", BENCHES, "| W4e | 522242 | 3.40 |"),
    ("103,823 on quadratic hexahedra 3.8 s", BENCHES, "| W4d | 103823 | 3.81 |"),
    ("$2\\cdot 10^{-12}$ where $10^{-9}$ is demanded", VERIFIED, "each other | 1e-9 (2e-12) | `iterative`"),
    ("to two percent", SURFACES, "Elements of the slave a sixth of the zone or smaller: the pressure of Hertz comes within two percent"),
];

const BENCHES: &str = "../../benches/README.md";
const COMPARISONS: &str = "../../docs/comparisons.md";
const CONTACT: &str = "src/theory/contact.md";
const SURFACES: &str = "src/theory/surfaces.md";
const TIES: &str = "src/theory/ties.md";
const VERIFIED: &str = "../../docs/verified.md";

#[test]
fn choices_cite_what_their_sources_say() {
    let chapter = fs::read_to_string("src/choose.md").expect("the chapter");
    for (figure, source, there) in FIGURES {
        assert!(chapter.contains(figure), "the chapter no longer says \"{figure}\"");
        let text = fs::read_to_string(source).expect("a source");
        assert!(text.contains(there), "{source} no longer says \"{there}\", from which \"{figure}\" is");
    }
}
