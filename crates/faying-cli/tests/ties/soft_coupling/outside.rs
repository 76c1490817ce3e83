//! Couplings from outside that add stiffness, with rows beside it and without.

use super::sample::{Sample, error, probe};
use faying::basis::{Basis, Order, ShapeTable};
use faying::coupling::{Coupling, CouplingBlocks, CouplingError, Interface, Mortar};
use faying::linalg::Triplets;
use faying_cli::case::{Changes, Multiplier, Names, ReadOptions};
use faying_cli::{Case, Diagnostics, Registry, RunResult, Status};

/// Springs of stiffness k [force/area per length] between the sides: ∫ k [u] . [v] ds, and the rows of mortar where wanted.
#[derive(Debug)]
struct Springs {
    k: f64,
    rows: bool,
}

impl Coupling<1, 2> for Springs {
    fn assemble(&self, interface: &Interface<'_, 1, 2>, unknowns: usize) -> Result<CouplingBlocks, CouplingError> {
        let master = interface.master.ok_or_else(|| CouplingError::Missing("springs need two sides".into()))?;
        let (mut stiffness, segments) = (Triplets::new(unknowns, unknowns), interface.segments);
        let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
        for piece in 0..segments.num_pieces() {
            let points = segments.points(piece);
            for (q, ds) in points.clone().map(|q| (q, segments.ds[q])) {
                let mut jump: Vec<(usize, usize, f64)> = Vec::new();
                let sides = [
                    (interface.slave, segments.slave[piece], segments.slave_xi[q], 1.0),
                    (master, segments.master[piece], segments.master_xi[q], -1.0),
                ];
                for (side, element, xi, sign) in sides {
                    side.trace.space.active(element, &mut ids);
                    side.trace.space.tabulate(element, &[xi], Order::Values, &mut table);
                    for c in 0..side.field.components {
                        jump.extend(
                            ids.iter().zip(table.values(0)).map(|(&i, v)| (side.field.unknown(side.trace.dofs[i], c), c, sign * v)),
                        );
                    }
                }
                for a in &jump {
                    jump.iter().filter(|b| a.1 == b.1).for_each(|b| stiffness.push(a.0, b.0, self.k * ds * a.2 * b.2));
                }
            }
        }
        let rows = if self.rows { Mortar.assemble(interface, unknowns)? } else { CouplingBlocks::empty(unknowns) };
        Ok(CouplingBlocks { stiffness, ..rows })
    }

    fn has_rows(&self) -> bool {
        self.rows
    }
}

fn run(text: &str) -> RunResult {
    let result = tried(text);
    assert_eq!(result.status, Status::Ok, "{:?}", result.diagnostics);
    result
}

fn tried(text: &str) -> RunResult {
    read(text, Changes::default()).unwrap_or_else(|e| panic!("{e}")).run(&names()).unwrap_or_else(|e| panic!("{e}"))
}

/// The names of the program and those of these couplings.
fn names() -> Registry {
    let mut registry = Registry::default();
    for (name, k, rows) in [("springs", 4.0, false), ("springs-and-rows", 4.0, true), ("pushes", -4.0, false)] {
        registry.plane.couplings.add_keyed(name, Vec::new(), Box::new(move |_| Ok(Box::new(Springs { k, rows }))));
    }
    registry
}

fn read(text: &str, changes: Changes) -> Result<Case, Diagnostics> {
    let options = ReadOptions { names: names().case_names(), changes, ..ReadOptions::default() };
    Case::parse("case.toml", text, &options)
}

// Two bars of length 1/2 and k = 1 in a row with springs of 4 between them: q = 1 / (1/2 + 1/4 + 1/2).
#[test]
fn springs_from_outside_carry_what_three_resistances_in_a_row_carry() {
    let probes = "[[probe]]\nname = \"l\"\nquantity = \"interface.i.lambda at [0.3, 0.5]\"";
    for slave in [0, 1] {
        let text = Sample { slave, ..Sample::poisson("y", &format!("coupling = \"springs\"\n{probes}")) }.text();
        let text = text.replace("exact = { u = \"y\" }\n", "").replace(
            "on = \"all-outer\"\ndirichlet = \"exact\"",
            "on = \"lower.bottom\"\ndirichlet = \"0\"\n[[boundary]]\non = \"upper.top\"\ndirichlet = \"1\"",
        );
        let (result, q) = (run(&text), 0.8);
        let interface = result.interface.get("i").unwrap();
        assert!((interface.jump.l2 - q / 4.0).abs() < 1e-10, "{interface:?}");
        // lambda: minus the slave's traction
        let lambda = if slave == 0 { -q } else { q };
        assert!((probe(&result, "l") - lambda).abs() < 1e-10, "{}", probe(&result, "l"));
        assert!((result.reactions.get("upper.top").unwrap()[0] - q).abs() < 1e-10, "{:?}", result.reactions);
        assert!(result.balance.force[0].abs() < 1e-12 && interface.balance < 1e-12);
        assert_eq!(result.unknowns.multipliers, 0);
    }
}

#[test]
fn stiffness_beside_rows_changes_nothing_where_the_rows_close_the_jump() {
    let exact = ["0.3*x + 0.5*y", "0.1*x - 0.4*y"];
    let result = run(&Sample::elastic(exact, "coupling = \"springs-and-rows\"").text());
    assert!(error(&result, "u.L2") < 1e-11 && error(&result, "i.lambda.L2.rel") < 1e-9, "{:?}", result.errors);
    assert!(result.unknowns.multipliers > 0 && result.interface.get("i").unwrap().balance < 1e-12);
}

// Springs that push instead of pulling have negative energy: the factorisation counts its directions, and nothing wrong is reported.
#[test]
fn a_coupling_with_negative_energy_is_refused_after_the_factorisation() {
    let result = tried(&Sample::poisson("y", "coupling = \"pushes\"").text());
    let said = result.diagnostics[0].render();
    assert!(
        result.status == Status::Singular && result.exit == 5 && said.contains("E072") && said.contains("not positive definite"),
        "{said}"
    );
}

#[test]
fn a_pairing_is_given_to_the_couplings_that_make_rows() {
    assert_eq!(names().case_names().rowless, ["nitsche", "springs", "pushes"]);
    // the names of the language agree with the couplings of the program
    assert_eq!(Registry::default().case_names().rowless, Names::default().rowless);
    for (coupling, given) in [("springs", false), ("pushes", false), ("nitsche", false), ("springs-and-rows", true), ("penalty", true)] {
        let text = Sample::poisson("y", &format!("coupling = \"{coupling}\"")).text();
        let changes = Changes { pairing: Some("p/p".into()), ..Changes::default() };
        let case = read(&text, changes).unwrap_or_else(|e| panic!("{coupling}: {e}"));
        let expected = Multiplier::Named(if given { "p/p" } else { "auto" }.into());
        assert_eq!(case.interfaces[0].multiplier.value, expected, "{coupling}");
        let written = read(&format!("{text}\n").replace("coupling =", "multiplier = \"p/p\"\ncoupling ="), Changes::default());
        assert_eq!(written.is_ok(), given, "{coupling}");
    }
}
