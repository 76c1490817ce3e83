//! Contact against variational inequalities with bounds, which PETSc solves on meshes of dolfinx: converged quantities.
//!
//! The discrete problems differ, so what is compared are values and their errors: |ours - theirs| within both errors, where ours comes
//! from our own levels; and the orders at which ours approach theirs. Errors of one load depend on where the end of its zone lies in an
//! element, by more than a halving changes them; so orders are those of the mean square over the loads of a document, and an error of
//! ours is the largest one over them.

use crate::cases::values;
use crate::choices::Choices;
use crate::document::{Known, all_known, document, texts};
use serde_json::Value;

/// Levels of a study, each a halving.
const LEVELS: usize = 3;
/// An error estimated from levels for order one is taken so many times: the error of a pressure of low degree
/// depends on the place within the element, which halvings move, so that two levels may lie nearer to each other than to the limit.
const SAFETY: f64 = 2.0;
/// What is left in a fitted order of where the ends of the zones lie, after the mean over the loads.
const SPREAD: f64 = 0.5;
/// The augmented Lagrangian stops where its multiplier does not change by more than this share, or better.
const SETTLED: f64 = 1e-7;

/// One load of a document.
struct Load {
    sets: Vec<String>,
    quantities: Vec<Known>,
}

struct Reference {
    case: String,
    bodies: Vec<String>,
    /// u ~ r^exponent at the end of the zone.
    exponent: f64,
    /// Quantities that are a minimum over all displacements that are allowed: their errors are squares of others.
    stationary: Vec<String>,
    loads: Vec<Load>,
}

fn reference(name: &str) -> Reference {
    let document = document(name);
    let load = |l: &Value| Load { sets: texts(&l["sets"]), quantities: all_known(&l["quantities"]) };
    Reference {
        case: document["case"].as_str().unwrap().to_owned(),
        bodies: texts(&document["bodies"]),
        exponent: document["exponent"].as_f64().unwrap(),
        stationary: texts(&document["stationary"]),
        loads: document["loads"].as_array().unwrap().iter().map(load).collect(),
    }
}

/// One way to solve the problem of a document.
#[derive(Clone, Copy)]
struct Variant<'a> {
    sets: &'a [&'a str],
    /// Degree of the displacements, and of what the pressure is made of.
    degrees: [usize; 2],
    /// The upper side is the master: forces are those on the other body.
    swapped: bool,
}

fn variant<'a>(sets: &'a [&'a str], degrees: [usize; 2]) -> Variant<'a> {
    Variant { sets, degrees, swapped: false }
}

impl Variant<'_> {
    /// Values at a level and a load, in the order of its quantities.
    fn values(&self, reference: &Reference, level: usize, load: &Load) -> Vec<f64> {
        let mut all: Vec<String> = self.sets.iter().map(|s| s.to_string()).chain(load.sets.iter().cloned()).collect();
        all.push(format!("discretization.degree={}", self.degrees[0]));
        all.extend(reference.bodies.iter().map(|b| format!("patch.{b}.refine={level}")));
        let mut names: Vec<String> = load.quantities.iter().map(|q| q.quantity.clone()).collect();
        let count = names.len();
        names.extend(balanced(&reference.case));
        let mut found = values(&reference.case, &all, &names);
        in_balance(&found.split_off(count), &all);
        let on_slave = |name: &str| name.contains(".force.") || name.ends_with(".moment");
        let signed = |(value, name): (f64, &String)| if self.swapped && on_slave(name) { -value } else { value };
        found.into_iter().zip(&names).map(signed).collect()
    }

    /// The order at which a quantity is expected to converge. At the end of the zone, u ~ r^s: energy norm h^min(p, s), of its square the
    /// order of what is stationary. An error of a potential energy that depends on where the zone ends within an element, e(a/h) h^2s, has
    /// a derivative h^(2s-1) with respect to a load: the order of forces, displacements and pressures inside, up to that of the pressure's
    /// own functions. The end of the zone itself is known up to an element.
    fn order(&self, reference: &Reference, name: &str) -> f64 {
        let [p, q] = self.degrees.map(|d| d as f64);
        let s = reference.exponent;
        match name {
            _ if reference.stationary.iter().any(|other| other == name) => 2.0 * p.min(s),
            _ if name.contains("half_width") || name.ends_with(".area") => 1.0,
            _ if name.contains("pressure") => (q + 1.0).min(2.0 * s - 1.0),
            _ => (2.0 * p).min(2.0 * s - 1.0),
        }
    }

    /// Compares all levels with the document.
    fn compare(&self, reference: &Reference) {
        let values: Vec<Vec<Vec<f64>>> =
            (0..LEVELS).map(|level| reference.loads.iter().map(|load| self.values(reference, level, load)).collect()).collect();
        println!("{} {:?}", reference.case, self.sets);
        // squares of relative errors per level, of the quantities of one order and kind
        let mut groups: Vec<(String, f64, Vec<f64>, usize)> = Vec::new();
        let last = LEVELS - 1;
        let mut share = (0.0, "");
        for (k, first) in reference.loads[0].quantities.iter().enumerate() {
            let of = |level: usize, l: usize| values[level][l][k] / reference.loads[l].quantities[k].value;
            let loads = 0..reference.loads.len();
            // of order one at least: the difference to a level that is d halvings coarser is 2^d - 1 times the error
            let own = |l: usize| {
                (0..last).map(|level| (of(last, l) - of(level, l)).abs() / ((1 << (last - level)) as f64 - 1.0)).fold(0.0, f64::max)
            };
            let own = SAFETY * loads.clone().map(own).fold(0.0, f64::max);
            for l in loads.clone() {
                let Known { quantity: name, value, error } = &reference.loads[l].quantities[k];
                // the end of a zone that is not Hertz' is known to 0.4 %, whatever the mesh (contact::half_width)
                let bias = if name.contains("half_width") { 4e-3 } else { 0.0 };
                let (difference, allowed) = ((of(last, l) - 1.0).abs(), error / value.abs() + own + bias);
                assert!(
                    difference <= allowed,
                    "{:?} {:?} {name}: {difference:.2e} of {value}, allowed {allowed:.2e}",
                    self.sets,
                    reference.loads[l].sets
                );
                if difference / allowed > share.0 {
                    share = (difference / allowed, name);
                }
            }
            let squares: Vec<f64> = (0..LEVELS).map(|level| loads.clone().map(|l| (of(level, l) - 1.0).powi(2)).sum()).collect();
            // what is given by balance has no order; a maximum has errors of both signs, overshoots and points that miss it, and so has the
            // end of a zone that is found within an element: errors of 0.5 % on the coarsest level that are there by chance
            if first.quantity.ends_with(".max") || first.quantity.ends_with(".half_width") {
                continue;
            }
            // and all else is seen through a reference that is finer than the coarsest level
            if squares[0].sqrt() < reference.loads[0].quantities[k].error / first.value.abs() {
                assert!(first.quantity.contains(".force."), "{}: the reference is too coarse", first.quantity);
                continue;
            }
            let (order, kind) = (self.order(reference, &first.quantity), first.quantity.split(" at ").next().unwrap().to_owned());
            match groups.iter_mut().find(|g| g.0 == kind) {
                Some(group) => {
                    group.2.iter_mut().zip(&squares).for_each(|(a, b)| *a += b);
                    group.3 += loads.len();
                }
                None => groups.push((kind, order, squares, loads.len())),
            }
        }
        println!("  at most {:.2} of what is allowed: {}", share.0, share.1);
        for (kind, order, squares, count) in groups {
            let errors: Vec<f64> = squares.iter().map(|s| (s / count as f64).sqrt()).collect();
            let fitted = fitted(&errors);
            let shown: Vec<String> = errors.iter().map(|e| format!("{e:.2e}")).collect();
            println!("  {kind:24} {} order {fitted:.2}, expected {order}", shown.join(" "));
            assert!(fitted >= order - SPREAD, "{:?} {kind}: order {fitted:.2} of {errors:?}, expected {order}", self.sets);
        }
    }
}

/// Forces whose balance is checked: what the hill carries, the top holds; what is applied on the upper block, the base of the lower one
/// holds.
pub fn balanced(case: &str) -> Vec<String> {
    let forces = match case {
        "contact-obstacle" => &["contact.hill.force.y", "reaction.block.top.y"][..],
        "contact-blocks" => &["reaction.lower.bottom.y"],
        _ => panic!("{case}"),
    };
    forces.iter().map(|f| (*f).to_owned()).collect()
}

/// Fails if the values of [`balanced`] are not.
pub fn in_balance(forces: &[f64], choices: &[String]) {
    // the pressure on a top of length 1
    let applied = || Choices::of(choices).number("let.q", 0.0026);
    let wanted = forces.get(1).map_or_else(applied, |held| -held);
    assert!((forces[0] - wanted).abs() <= 1e-9 * wanted.abs(), "{choices:?}: {} for {wanted}", forces[0]);
}

/// The slope of least squares of -log2(error) over the levels.
fn fitted(errors: &[f64]) -> f64 {
    let middle = (errors.len() as f64 - 1.0) / 2.0;
    let (mut product, mut square) = (0.0, 0.0);
    for (level, error) in errors.iter().enumerate() {
        let x = level as f64 - middle;
        product -= x * error.log2();
        square += x * x;
    }
    product / square
}

#[test]
fn a_block_on_a_rigid_hill_comes_to_what_bounds_on_nodal_values_come_to() {
    let reference = reference("contact_obstacle");
    for variant in [
        variant(&[], [2, 0]),
        variant(&["contact.hill.multiplier=p/p"], [2, 2]),
        variant(&["contact.hill.method=nitsche"], [2, 1]),
        variant(&["discretization.backend=fe"], [1, 1]),
        variant(&["discretization.backend=fe"], [2, 0]),
        variant(&[], [3, 1]),
    ] {
        variant.compare(&reference);
    }
}

#[test]
fn two_blocks_on_grids_that_do_not_match_come_to_what_bounds_on_relative_displacements_come_to() {
    let reference = reference("contact_blocks");
    let lower_is_slave = ["contact.pad.slave=lower.top", "contact.pad.master=upper.bottom"];
    for variant in [
        variant(&[], [2, 0]),
        Variant { swapped: true, ..variant(&lower_is_slave, [2, 0]) },
        variant(&["patch.upper.backend=fe", "contact.pad.method=nitsche"], [2, 1]),
        // twelve elements beside eight: the grids match
        variant(&["patch.lower.backend=fe", "patch.lower.elements.0=12", "contact.pad.multiplier=p/p"], [2, 2]),
    ] {
        variant.compare(&reference);
    }
}

#[test]
fn augmented_and_stiff_penalty_methods_end_where_multipliers_do() {
    let reference = reference("contact_obstacle");
    let load = &reference.loads[0];
    let at = |sets: &[&str]| variant(sets, [2, 0]).values(&reference, 2, load);
    let exact = at(&[]);
    let largest = |other: &[f64]| exact.iter().zip(other).map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max);
    let augmented = largest(&at(&["contact.hill.method=augmented"]));
    // the gap left over falls like one over the factor
    let [soft, stiff] = ["1e4", "1e5"].map(|f| largest(&at(&["contact.hill.method=penalty", &format!("contact.hill.factor={f}")])));
    println!("augmented {augmented:.1e}, penalty {soft:.1e}, ten times as stiff {stiff:.1e}");
    assert!(augmented < SETTLED && soft > stiff);
    assert!((soft / stiff / 10.0 - 1.0).abs() < 0.1, "{soft} {stiff}");
}
