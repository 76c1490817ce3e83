//! Which rigid motions multipliers hold: the rank of their rows, found before anything is solved.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::{check, run};
use faying_cli::{Finished, Registry, RunControl, RunOptions, Status};

const BACKENDS: [&str; 2] = ["iga", "fe"];

fn read(text: &str) -> Case {
    Case::parse("held.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn solved(text: &str) -> Finished {
    let finished = run(&read(text), &Registry::default(), &RunOptions::default(), &RunControl::default());
    assert_eq!(finished.result.status, Status::Ok, "{:?}\n{text}", finished.result.diagnostics);
    finished
}

fn probe(finished: &Finished, name: &str) -> f64 {
    finished.result.probes.iter().find(|p| p.name == name).unwrap().value
}

/// "E024: ..." of every error, by `check` and by `run`, which say the same.
fn refused(text: &str) -> String {
    let case = read(text);
    let [first, second] = [check, run].map(|f| f(&case, &Registry::default(), &RunOptions::default(), &RunControl::default()).result);
    assert_eq!(first.diagnostics, second.diagnostics);
    assert_eq!((first.exit, second.exit), (3, 3), "{text}\n{:?}", first.diagnostics);
    first.diagnostics.iter().map(|d| format!("{}: {}\n", d.code, d.message)).collect()
}

/// Boxes along y of width and height `size`, the first corner of the first one at `at`.
struct Boxes {
    backend: &'static str,
    size: f64,
    at: [f64; 2],
}

impl Boxes {
    fn unit(backend: &'static str) -> Self {
        Self { backend, size: 1.0, at: [0.0, 0.0] }
    }

    fn head(&self) -> String {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{}\"\ndegree = 2\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n",
            self.backend
        )
    }

    /// The box of number `k` with `n` elements along x.
    fn one(&self, name: &str, k: usize, n: usize) -> String {
        let (x, y, h) = (self.at[0], self.at[1] + k as f64 * self.size, self.size);
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x:?}, {y:?}], max = [{:?}, {:?}] }}\nelements = [{n}, 2]\n",
            x + h,
            y + h
        )
    }
}

fn on(side: &str, what: &str) -> String {
    format!("[[boundary]]\non = \"{side}\"\n{what}\n")
}

fn tie(name: &str, slave: &str, master: &str) -> String {
    format!("[[interface]]\nname = \"{name}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\nmultiplier = \"p/p-2\"\n")
}

const CLAMPED: &str = "fix = [\"x\", \"y\"]";

/// Box "b" of `n` elements tied upon "a", which is clamped below.
fn stacked(boxes: &Boxes, n: usize, rest: &str) -> String {
    [
        boxes.head(),
        boxes.one("a", 0, 3),
        boxes.one("b", 1, n),
        on("a.bottom", CLAMPED),
        on("b.top", "traction = { y = 0.01 }"),
        tie("mid", "b.bottom", "a.top"),
        rest.into(),
    ]
    .concat()
}

#[test]
fn one_constant_per_component_lets_a_body_turn() {
    for backend in BACKENDS {
        let boxes = Boxes::unit(backend);
        let found = refused(&stacked(&boxes, 1, ""));
        assert!(
            found.starts_with("E024: the multiplier of \"mid\" on `b.bottom` has too few functions (one function per component)")
                && found.contains("body \"b\"")
                && found.trim_end().ends_with("can still move: rotation about (0.5, 1)")
                && found.lines().count() == 1,
            "{found}"
        );
        // two constants hold it: uniform tension
        let finished = solved(&stacked(&boxes, 2, "[[probe]]\nname = \"top\"\nquantity = \"u.y at [0.3, 2]\"\n"));
        assert!((probe(&finished, "top") - 0.02).abs() < 1e-12);
    }
}

#[test]
fn the_rank_does_not_depend_on_where_and_how_large_bodies_are() {
    for backend in BACKENDS {
        for (size, at) in [(1e-9, [0.0, 0.0]), (1e-9, [3e-8, -5e-9]), (1.0, [1e6, -1e6]), (1e9, [0.0, 1e10])] {
            let boxes = Boxes { backend, size, at };
            let found = refused(&stacked(&boxes, 1, ""));
            assert!(found.starts_with("E024") && found.contains("rotation about ("), "{size:e} {at:?}: {found}");
            let good = check(&read(&stacked(&boxes, 2, "")), &Registry::default(), &RunOptions::default(), &RunControl::default()).result;
            assert_eq!(good.status, Status::Ok, "{size:e} {at:?}: {:?}", good.diagnostics);
        }
    }
}

#[test]
fn a_small_body_far_from_the_others_is_held_by_its_own_side() {
    // 1e-5 of the distance between the bodies, less than what counts as zero for motions of the whole model
    for backend in BACKENDS {
        let boxes = Boxes { backend, size: 1e-6, at: [0.0, 0.0] };
        let far = "[[patch]]\nname = \"c\"\ngeometry = { kind = \"box\", min = [10, 0], max = [11, 1] }\nelements = [2, 2]\n";
        let text = stacked(&boxes, 2, &[far.into(), on("c.bottom", CLAMPED)].concat());
        solved(&text);
    }
}

#[test]
fn a_body_between_two_others_is_held_by_both() {
    for backend in BACKENDS {
        let boxes = Boxes::unit(backend);
        let chain = |upper: &str, top: &str| {
            [
                boxes.head(),
                boxes.one("a", 0, 3),
                boxes.one("b", 1, 1),
                boxes.one("c", 2, 3),
                on("a.bottom", CLAMPED),
                top.into(),
                tie("lower", "b.bottom", "a.top"),
                upper.into(),
            ]
            .concat()
        };
        // means below and above: no rotation leaves both
        let upper = tie("upper", "b.top", "c.bottom");
        let finished = solved(
            &(chain(&upper, &on("c.top", "dirichlet = { x = \"0\", y = \"0.3\" }"))
                + "[[probe]]\nname = \"mid\"\nquantity = \"u.y at [0.5, 1.5]\"\n"),
        );
        assert!((probe(&finished, "mid") - 0.15).abs() < 1e-12);
        // what turns with it is not to blame: "c" holds on to "b" by all its functions
        let found = refused(&chain(&tie("upper", "c.bottom", "b.top"), &on("c.top", "traction = { y = 0.01 }")));
        assert!(
            found.contains("of \"lower\" on `b.bottom`") && found.contains("rotation about (0.5, 1)") && !found.contains("upper"),
            "{found}"
        );
        // both let go
        let found = refused(&chain(&upper, &on("c.top", "traction = { y = 0.01 }")));
        assert!(found.contains("\"lower\"") && found.contains("\"upper\""), "{found}");
    }
}

#[test]
fn springs_and_sides_that_move_as_one_hold_what_the_multiplier_does_not() {
    for backend in BACKENDS {
        let boxes = Boxes::unit(backend);
        // the resultant of the springs is nothing: they only keep the side from turning
        let springs = solved(&stacked(&boxes, 1, &on("b.left", "spring = { x = 1.0 }")));
        assert!(springs.result.status == Status::Ok);
        let text = [
            boxes.head(),
            boxes.one("a", 0, 3),
            boxes.one("b", 1, 1),
            on("a.bottom", CLAMPED),
            on("b.top", "rigid_force = { y = 0.01 }"),
            tie("mid", "b.bottom", "a.top"),
            "[[probe]]\nname = \"top\"\nquantity = \"u.y at [0.3, 2]\"\n".into(),
        ]
        .concat();
        assert!((probe(&solved(&text), "top") - 0.02).abs() < 1e-12);
    }
}

#[test]
fn a_side_that_moves_as_one_does_not_turn() {
    // two rollers in one point hold the translations; the guided top holds the rotation
    for backend in BACKENDS {
        let boxes = Boxes::unit(backend);
        let text = [
            boxes.head(),
            boxes.one("a", 0, 2),
            on("a.u0v0", CLAMPED),
            on("a.top", "rigid_force = { y = 0.01 }"),
            on("a.bottom", "traction = { y = -0.01 }"),
            "[[probe]]\nname = \"top\"\nquantity = \"u.y at [0.3, 1]\"\n".into(),
        ]
        .concat();
        assert!((probe(&solved(&text), "top") - 0.01).abs() < 1e-12);
    }
}

#[test]
fn one_contact_function_does_not_keep_a_block_upright() {
    for backend in BACKENDS {
        let boxes = Boxes::unit(backend);
        for opponent in ["master = \"a.top\"", "rigid = { kind = \"half-plane\", point = [0, 1], normal = [0, 1] }"] {
            let text = |n: usize| {
                [
                    boxes.head(),
                    boxes.one("a", 0, 3),
                    boxes.one("b", 1, n),
                    on("a.bottom", CLAMPED),
                    on("b.u0v0", "fix = [\"x\"]"),
                    on("b.top", "pressure = 0.01"),
                    format!("[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\n{opponent}\nmultiplier = \"p/p-2\"\n"),
                    "[[probe]]\nname = \"force\"\nquantity = \"contact.c.force.y\"\n".into(),
                ]
                .concat()
            };
            let found = refused(&text(1));
            assert!(
                found.starts_with("E024: the multiplier of \"c\" on `b.bottom` has too few functions")
                    && found.contains("can still move: rotation about (0.5, 1)") | found.contains("can still move: rotation about (0, 1)")
                    && found.contains("even with every contact closed"),
                "{found}"
            );
            assert!((probe(&solved(&text(2)), "force") - 0.01).abs() < 1e-12);
        }
    }
}
