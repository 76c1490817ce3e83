//! A problem stated in a program and the same problem in a case file have the same numbers, to the bit.

use faying::contact::{Augmented, ContactMethod, Lagrange};
use faying::coupling::Nitsche;
use faying_cli::{Case, Registry, RunResult};
use std::sync::Arc;

#[path = "../../../../examples/03_contact.rs"]
mod lesson;

const CASE: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
    [[patch]]\nname = \"lower\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 0.5] }\nelements = [7, 3]\n\
    backend = \"fe\"\n\
    [[patch]]\nname = \"upper\"\ngeometry = { kind = \"box\", min = [0, 0.5], max = [1, 1] }\nelements = [9, 4]\n\
    [[boundary]]\non = \"lower.bottom\"\nfix = [\"x\", \"y\"]\n\
    [[boundary]]\non = \"upper.top\"\ntraction = { y = \"-1e-3*(1 - 1.3*x)\" }\n\
    [[boundary]]\non = \"upper.left\"\ntraction = { x = 1e-4 }\n\
    [[contact]]\nname = \"table\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\nmethod = \"METHOD\"\n\
    [[contact]]\nname = \"wall\"\nslave = \"upper.right\"\nmethod = \"METHOD\"\n\
    rigid = { kind = \"half-plane\", point = [1, 0], normal = [-1, 0] }\n";

fn by_case(method: &str) -> RunResult {
    let case = Case::parse("case.toml", &CASE.replace("METHOD", method), &Default::default()).unwrap();
    case.run(&Registry::default()).unwrap()
}

#[test]
fn a_program_and_a_case_have_the_same_numbers_by_every_method() {
    let methods: [(&str, Arc<dyn ContactMethod<1, 2>>); 3] =
        [("lagrange", Arc::new(Lagrange)), ("augmented", Arc::new(Augmented::default())), ("nitsche", Arc::new(Nitsche::default()))];
    lesson::main().unwrap();
    for (word, method) in methods {
        let ((solution, contacts), result) = (lesson::pressed(method).unwrap(), by_case(word));
        assert_eq!(result.exit, 0, "{word}: {:?}", result.diagnostics);
        for (name, contact) in ["table", "wall"].into_iter().zip(contacts) {
            let (own, known) = (solution.contact(contact).unwrap(), result.contact.get(name).unwrap());
            assert_eq!(own.force.as_slice(), &known.force[..], "{word}, {name}");
            assert_eq!((own.largest_pressure, own.least_gap, own.area), (known.pressure.max, known.gap.min, known.area), "{word}, {name}");
            assert_eq!(own.active, known.active, "{word}, {name}");
        }
        let set = (solution.active_set().map(|s| s.iterations), solution.linear().residual);
        let solve = result.solve.unwrap();
        assert_eq!(set, (solve.active_set.map(|s| s.iterations), solve.residual), "{word}");
    }
}
