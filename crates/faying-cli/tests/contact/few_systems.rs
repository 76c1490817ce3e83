//! Few systems whatever the mesh: sets are decided by the contact rows alone.
//!
//! `FAYING_ACTIVE_SET=500` takes meshes of up to 4096 rows (`.ci/long`), 1024 otherwise.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::{Finished, Registry, RunControl, RunOptions, Status};

fn solved(text: &str, sets: &[String]) -> Finished {
    let options = ReadOptions { sets: sets.to_vec(), ..ReadOptions::default() };
    let case = Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}\n{text}"));
    run(&case, &Registry::default(), &RunOptions::default(), &RunControl::default())
}

fn set(finished: &Finished) -> &faying_cli::result::ActiveSetSummary {
    assert_eq!(finished.result.status, Status::Ok, "{:?}", finished.result.diagnostics);
    finished.result.solve.as_ref().unwrap().active_set.as_ref().unwrap()
}

const MODEL: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n";

/// A block of `layers` layers of `n` elements pressed on a plane through a gap.
fn thin(n: usize, layers: usize, gap: &str) -> String {
    format!(
        "{MODEL}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [{n}, {layers}]\n\
         [[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.top\"\ntraction = {{ y = \"-5e-3\" }}\n\
         [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\ngap = \"{gap}\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n"
    )
}

/// A quarter of a ring pressed on a block, four layers of elements each.
fn arc(n: usize) -> String {
    format!(
        "{MODEL}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 1], radius = [0.3, 1], angle_deg = [-90, 0] }}\n\
         elements = [{n}, 4]\n[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, -0.5], max = [1.5, 0] }}\nelements = [{n}, 4]\n\
         [[boundary]]\non = [\"b.u0\", \"a.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n\
         [[boundary]]\non = \"b.u1\"\ntraction = {{ y = \"-2e-2\" }}\n[[contact]]\nname = \"c\"\nslave = \"b.v1\"\nmaster = \"a.top\"\n"
    )
}

#[test]
fn thin_bodies_take_at_most_eight_systems_at_any_number_of_rows() {
    let most = if std::env::var("FAYING_ACTIVE_SET").is_ok() { 4096 } else { 1024 };
    let sizes = (5..).map(|k| 1 << k).take_while(|&n| n <= most);
    for n in sizes {
        let cases = [
            ("one zone", thin(n, 4, "(x - 0.5)^2")),
            ("wedge", thin(n, 4, "0.1*abs(x - 0.45)")),
            ("two zones", thin(n, 4, "0.02*(1 - cos(4*pi*x))")),
            ("eight layers", thin(n, 8, "(x - 0.6)^2")),
            ("arc", arc(n)),
        ];
        for (name, text) in cases {
            let finished = solved(&text, &[]);
            let found = set(&finished);
            println!("{name} {n}: {} systems, {} sets, {:?}", found.iterations, found.sets.len(), found.history);
            assert!(found.iterations <= 8, "{name} {n}: {found:?}");
            assert_eq!(found.history.len(), found.iterations);
        }
    }
}

#[test]
fn sets_of_the_rows_are_told_beside_the_systems() {
    for start in ["auto", "all", "none"] {
        let finished = solved(&thin(48, 24, "(x - 0.5)^2"), &[format!("contact.c.active_set.start={start}")]);
        let found = set(&finished);
        let solve = finished.result.solve.as_ref().unwrap();
        assert_eq!((found.iterations, found.history.len(), solve.factors), (1, 1, 1), "{start}: {found:?}");
        assert!(found.sets.len() > 1 && found.sets.last() == found.history.last(), "{start}: {found:?}");
    }
    // a factor for each system where the reaction differs from the constraint
    let mixed = arc(16).replace("master = \"a.top\"\n", "master = \"a.top\"\nintegration = \"mixed\"\n");
    let finished = solved(&mixed, &[]);
    let solve = finished.result.solve.as_ref().unwrap();
    assert!(solve.factors >= set(&finished).iterations, "{solve:?}");
    assert!(set(&finished).notes[0].starts_with("start: the set of the symmetric system"), "{solve:?}");
}
