//! Two backends that are neither splines nor Lagrange run the checkers and the tied and contact suites against ours,
//! with public names only and without a line of `src/` that knows them.

mod drive;
mod modal;
mod scrambled;

use drive::{Part, contact_patch, tied_patch};
use faying::basis::Cell;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::rectangle;
use faying::space::{BasisKind, Body, Mapping, Mesh, Patch, PatchSpec};
use modal::ModalBody;
use scrambled::ScrambledBody;

/// The kinds of body under test; the first two come from outside.
const KINDS: [&str; 6] = ["modal", "scrambled splines", "scrambled triangles", "splines", "quadrilaterals", "triangles"];

/// A body of `kind` on [0, 1] x [low, low + 1] with `cells` elements of degree `p`, and the names of its sides.
fn body(kind: &str, cells: [usize; 2], p: usize, low: f64) -> (Box<dyn Body<1, 2>>, [&'static str; 4]) {
    let net = rectangle([0.0, low], [1.0, low + 1.0]).expect("a rectangle");
    let spec = |cells_kind: Cell| PatchSpec {
        breakpoints: net.breakpoints_total(cells),
        net: net.clone(),
        degree: [p, p],
        continuity: None,
        basis: BasisKind::Auto,
        cells: cells_kind,
        mapping: Mapping::Isoparametric,
    };
    let ours: Box<dyn Body<1, 2>> = match kind {
        "modal" => {
            let modal = ModalBody::new(cells, p, [0.0, low], [[1.0, 0.0], [0.0, 1.0]]);
            return (Box::new(modal), ["west", "east", "south", "north"]);
        }
        "splines" | "scrambled splines" => Box::new(Patch::<1, 2>::try_new(&spec(Cell::Tensor)).expect("a patch")),
        "quadrilaterals" => Box::new(Mesh::<1, 2>::from_patch(&spec(Cell::Tensor)).expect("a mesh")),
        _ => Box::new(Mesh::<1, 2>::from_patch(&spec(Cell::Simplex)).expect("a mesh")),
    };
    let body = if kind.starts_with("scrambled") { Box::new(ScrambledBody::new(ours)) as Box<dyn Body<1, 2>> } else { ours };
    (body, ["left", "right", "bottom", "top"])
}

/// All pairs in which at least one body comes from outside.
fn pairs() -> impl Iterator<Item = (&'static str, &'static str)> {
    KINDS
        .into_iter()
        .enumerate()
        .flat_map(|(i, a)| KINDS.into_iter().enumerate().filter(move |(j, _)| i.min(*j) < 3).map(move |(_, b)| (a, b)))
}

#[test]
fn backends_from_outside_keep_the_contracts() {
    for p in 1..=4 {
        for kind in KINDS {
            let (body, _) = body(kind, [3, 2], p, 0.0);
            let checked = faying::check::body(&*body);
            assert!(checked.is_ok(), "{kind}, degree {p}: {checked:?}");
        }
    }
    let sheared = ModalBody::new([3, 2], 3, [1.0, -1.0], [[1.0, 0.3], [-0.2, 0.8]]);
    faying::check::body(&sheared).expect("a sheared modal body");
    let mirrored = ModalBody::new([2, 2], 2, [0.0, 0.0], [[0.0, 1.0], [1.0, 0.0]]);
    faying::check::body(&mirrored).expect("a left-handed modal body");
}

#[test]
fn tied_linear_fields_cross_to_and_from_a_backend_from_outside() {
    for p in 1..=3 {
        for (a, b) in pairs() {
            let (lower, lower_sides) = body(a, [3, 2], p, 0.0);
            let (upper, upper_sides) = body(b, [4, 2], p, 1.0);
            let parts = [Part { body: lower.into(), sides: lower_sides }, Part { body: upper.into(), sides: upper_sides }];
            for slave in 0..2 {
                for condensed in [false, true] {
                    let outcome = tied_patch(&parts, slave, MultiplierKind::Lowered(0), condensed);
                    let case = format!("{a} under {b}, degree {p}, slave {slave}, condensed {condensed}: {outcome:?}");
                    assert!(outcome.displacement.l2 < 1e-11 && outcome.displacement.h1 < 1e-10, "{case}");
                    assert!(outcome.multiplier < 1e-9, "{case}");
                }
            }
        }
    }
}

#[test]
fn a_uniform_pressure_crosses_to_and_from_a_backend_from_outside() {
    for (a, b) in pairs() {
        let (lower, lower_sides) = body(a, [4, 2], 2, 0.0);
        let (upper, upper_sides) = body(b, [5, 2], 2, 1.0);
        let parts = [Part { body: lower.into(), sides: lower_sides }, Part { body: upper.into(), sides: upper_sides }];
        for slave in 0..2 {
            for condensed in [false, true] {
                let outcome = contact_patch(&parts, slave, condensed);
                let case = format!("{a} under {b}, slave {slave}, condensed {condensed}: {outcome:?}");
                assert!(outcome.displacement.l2 < 1e-10 && outcome.multiplier < 1e-10, "{case}");
                assert!(outcome.iterations <= 5, "{case}");
            }
        }
    }
}
