//! Probes and checks of steps other than the last, and `t` in the values of checks.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Diagnostics, Registry, RunResult};

/// A bar of length 4 and modulus 50 pulled by t² per area: its end moves by 4 t² / 50.
fn bar(rest: &str) -> Result<RunResult, Diagnostics> {
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 50\npoisson = 0\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [4, 1] }}\nelements = [2, 1]\n\
         [[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n\
         [[boundary]]\non = \"a.right\"\ntraction = {{ x = \"t^2\" }}\n{rest}"
    );
    Case::parse("case.toml", &text, &ReadOptions::default())?.run(&Registry::default())
}

const STEPS: &str = "[steps]\nt = [0.25, 0.5, 1.0]\n";

fn end(t: f64) -> f64 {
    4.0 * t * t / 50.0
}

#[test]
fn a_probe_is_that_of_its_step_and_a_check_may_ask_for_it() {
    let probe = |name: &str, t: &str| format!("[[probe]]\nname = \"{name}\"\nquantity = \"u.x at [4, 0.5]\"\n{t}");
    let rest = format!(
        "{STEPS}{}{}{}[[check]]\nquantity = \"probes.half.value\"\nequals = \"4*0.5^2/50\"\nrtol = 1e-12\n",
        probe("half", "t = 0.5\n"),
        probe("all", "t = \"all\"\n"),
        probe("end", "")
    );
    let result = bar(&rest).unwrap();
    let of = |k: usize| (result.probes[k].value, result.probes[k].t);
    for ((value, t), (exact, at)) in [of(0), of(1), of(2)].into_iter().zip([(end(0.5), Some(0.5)), (end(1.0), Some(1.0)), (end(1.0), None)])
    {
        assert!((value - exact).abs() < 1e-14 && t == at, "{value} at {t:?}");
    }
    // every step has every probe
    for step in &result.steps {
        for probe in &step.probes {
            assert!((probe.value - end(step.t)).abs() < 1e-14, "{} at t = {}: {}", probe.name, step.t, probe.value);
        }
    }
    assert_eq!(result.exit, 0, "{:?}", result.checks);
}

#[test]
fn checks_hold_at_their_step_or_at_all_with_t_in_their_values() {
    let check = |name: &str, rest: &str| format!("[[check]]\nname = \"{name}\"\nquantity = \"u.x at [4, 0.5]\"\nrtol = 1e-12\n{rest}");
    let good = STEPS.to_owned()
        + &check("all", "equals = \"4*t^2/50\"\nt = \"all\"\n")
        + &check("half", "equals = \"4*0.25/50\"\nt = 0.5\n")
        + &check("end", "equals = \"4*t/50\"\n");
    let result = bar(&good).unwrap();
    assert_eq!(result.exit, 0, "{:?}", result.checks);
    let times: Vec<Option<f64>> = result.checks.iter().map(|c| c.t).collect();
    assert_eq!((times, result.checks_performed), (vec![Some(1.0), Some(0.5), None], 3));
    // wrong at t = 0.5 alone
    let bad = STEPS.to_owned()
        + &check("all", "equals = \"if(t == 0.5, 0, 4*t^2/50)\"\nt = \"all\"\n")
        + &check("half", "equals = \"4*t/50\"\nt = 0.5\n")
        + &check("end", "equals = \"4*t/50\"\n");
    let result = bar(&bad).unwrap();
    let found: Vec<(bool, Option<f64>)> = result.checks.iter().map(|c| (c.ok, c.t)).collect();
    assert_eq!(found, [(false, Some(0.5)), (false, Some(0.5)), (true, None)]);
    assert!((result.checks[0].value - end(0.5)).abs() < 1e-14 && result.exit == 1, "{:?}", result.checks);
}

#[test]
fn a_time_that_is_no_step_is_an_error_with_the_steps() {
    let probe = "[[probe]]\nname = \"p\"\nquantity = \"energy\"\nt = 0.4\n";
    let faults = bar(&format!("{STEPS}{probe}")).unwrap_err().to_string();
    assert!(faults.contains("E015") && faults.contains("steps end at t = 0.25, 0.5, 1"), "{faults}");
    let faults = bar(probe).unwrap_err().to_string();
    assert!(faults.contains("without [steps] there is one, at t = 1"), "{faults}");
    let faults = bar(&format!("{STEPS}[[check]]\nquantity = \"energy\"\nbelow = 1\nt = \"each\"\n")).unwrap_err().to_string();
    assert!(faults.contains("a time of [steps], or \"all\""), "{faults}");
    assert!(bar("[[check]]\nquantity = \"energy\"\nbelow = 1\nt = 1\n").is_ok_and(|result| result.exit == 0));
}
