//! Values that are prescribed on a part of a slave side and hold it within what it faces.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A block of `size` above a gap of 0.02 `size`, turned by a quarter where `turned`; the part of its side beside the gap that `held` keeps is
/// moved by `u` times `size` across it.
fn block(size: f64, turned: bool, held: &str, u: &str, contact: &str, rigid: bool) -> String {
    let s = |v: f64| format!("{:e}", v * size);
    let (across, along, side, top) = if turned { ("x", "y", "left", "right") } else { ("y", "x", "bottom", "top") };
    let at = |along: f64, across: f64| if turned { [across, along] } else { [along, across] }.map(s).join(", ");
    let opponent = if rigid {
        format!("rigid = {{ kind = \"half-plane\", point = [{}], normal = [{}] }}", at(0.0, -0.02), at(0.0, 1.0))
    } else {
        format!("master = \"a.{top}\"")
    };
    let below = format!(
        "[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [{}], max = [{}] }}\nelements = [3, 3]\n[[boundary]]\non = \"a.{top}\"\n\
         fix = [\"x\", \"y\"]\n",
        at(0.0, -0.5),
        at(1.0, -0.02)
    );
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n[[patch]]\nname = \"b\"\n\
         geometry = {{ kind = \"box\", min = [0, 0], max = [{0}, {0}] }}\nelements = [6, 6]\n[[boundary]]\non = \"b.{top}\"\nfix = [\"{along}\"]\n\
         [[boundary]]\non = \"b.{side}\"\nwhere = \"{along} {held}*{0}\"\ndirichlet = {{ {across} = \"{u}*{0}\" }}\n{1}[[contact]]\nname = \"pad\"\n\
         slave = \"b.{side}\"\n{opponent}\n{contact}\n",
        s(1.0),
        if rigid { "" } else { &below }
    )
}

#[test]
fn values_that_hold_a_side_within_what_it_faces_are_infeasible() {
    for (size, turned) in [(1.0, false), (1e-3, true), (1e4, false)] {
        for rigid in [true, false] {
            for method in ["lagrange", "augmented", "penalty"] {
                for more in ["", "\nmultiplier = \"p/p\"", "\nactive_set = { start = \"none\" }"] {
                    let contact = format!("method = \"{method}\"{more}");
                    let text = block(size, turned, "< 0.4", "-0.1", &contact, rigid);
                    let result = run(&text);
                    let [found] = &result.diagnostics[..] else { panic!("{:?}\n{text}", result.diagnostics) };
                    let slave = text.lines().position(|l| l.starts_with("slave")).unwrap() + 1;
                    assert_eq!((result.exit, found.code, found.line), (5, "E072", Some(slave)), "{found:?}\n{text}");
                    let faced = if rigid { "the obstacle" } else { "the master" };
                    for word in ["infeasible contact", faced, "contact \"pad\"", if turned { "`b.left`" } else { "`b.bottom`" }] {
                        assert!(found.message.contains(word), "{word}: {found:?}");
                    }
                    assert!(found.help.as_ref().unwrap().contains("line 18"), "{found:?}");
                }
            }
        }
    }
}

#[test]
fn values_that_leave_the_gap_open_or_just_close_it_are_feasible() {
    for (size, turned) in [(1.0, false), (1e-3, true), (1e4, false)] {
        for method in ["lagrange", "augmented", "penalty"] {
            for u in ["0.1", "0", "-0.02"] {
                for start in ["auto", "all"] {
                    let contact = format!("method = \"{method}\"\nactive_set = {{ start = \"{start}\" }}");
                    let text = block(size, turned, "> 0.7", u, &contact, true);
                    let result = run(&text);
                    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
                }
            }
        }
    }
}

#[test]
fn the_step_in_which_values_reach_the_obstacle_is_told() {
    let text = block(1.0, false, "< 0.4", "-0.03*t", "", true) + "[steps]\nt = [0.5, 1]\n";
    let result = run(&text);
    let [found] = &result.diagnostics[..] else { panic!("{:?}\n{text}", result.diagnostics) };
    assert!(found.message.starts_with("step 2, t = 1: infeasible contact"), "{found:?}");
    assert_eq!(result.steps[0].status, Status::Ok);
}
