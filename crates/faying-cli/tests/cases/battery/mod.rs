//! Tied and pressed bodies whose states are known in closed form, and twins that must agree, in any unit, direction and place: every case is
//! right, refused or warned. Forces, displacements, pressures and gaps are compared.
//!
//! A case of moderate numbers must be right. One of extreme numbers (far from the origin, stiffnesses that differ by 1e8, layers far thinner
//! than their elements) may be refused or warned instead, but no case ends with exit 0, without a word, and a wrong number.
//!
//! `FAYING_BATTERY=2000` in the environment takes that many cases of each kind (`.ci/long`), 60 otherwise.

mod files;
mod lame;
mod layers;
mod pairs;
mod rings;
mod sides;
mod uniform;
mod world;

use faying_cli::{Case, Diagnostics};
use faying_cli::{Registry, RunResult};
use pairs::Twins;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use world::Random;

/// A number of a result that is known.
struct Known {
    what: String,
    found: f64,
    expected: f64,
    /// Largest difference allowed, absolute.
    within: f64,
}

/// A case and what is known of it.
struct Trial {
    text: String,
    /// Whether it must be right; else a refusal or a warning will do.
    sound: bool,
    /// Whether its rule of integration is inexact: a warning will do.
    rough: bool,
    /// Whether it must not be solved: there is no such model.
    refuse: bool,
    /// Compares a result with the closed form.
    known: Box<dyn Fn(&RunResult) -> Vec<Known> + Send + Sync>,
}

/// The ends of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Right,
    Warned,
    Refused,
}

/// Runs a trial; an error says what is wrong with its end.
fn end(trial: &Trial, folder: &Path) -> Result<End, String> {
    let file = folder.join("case.toml");
    std::fs::write(&file, &trial.text).map_err(|e| e.to_string())?;
    let refused = |why: String| {
        if trial.sound { Err(format!("a sound case is refused: {why}")) } else { Ok(End::Refused) }
    };
    let result = match Case::read(file.to_str().unwrap()).and_then(|case| case.run(&Registry::default())) {
        Ok(result) => result,
        // the weights of a cone are those of a quadrature at its points: on few elements some are zero, and no sign of the pressure follows
        Err(faults)
            if trial.text.contains("cone = ") && faults.items.iter().all(|d| d.code == "E064" && d.message.contains("in this cone")) =>
        {
            return Ok(End::Refused);
        }
        Err(faults) => return refused(messages(&faults)),
    };
    if result.exit != 0 {
        return refused(format!("exit {}: {:?}", result.exit, result.diagnostics.iter().map(|d| &d.message).collect::<Vec<_>>()));
    }
    if trial.refuse {
        return Err("a model that does not exist is solved".into());
    }
    let wrong: Vec<String> = (trial.known)(&result)
        .iter()
        .filter(|k| (k.found - k.expected).abs() > k.within || !k.found.is_finite())
        .map(|k| format!("{} is {:e}, expected {:e} within {:e}", k.what, k.found, k.expected, k.within))
        .collect();
    match (wrong.is_empty(), result.warnings.is_empty()) {
        (true, true) => Ok(End::Right),
        (true, false) => Ok(End::Warned),
        (false, false) if !trial.sound || trial.rough => Ok(End::Warned),
        (false, _) => {
            let words: Vec<&str> = result.warnings.iter().map(|w| w.message.as_str()).collect();
            Err(format!("{} (warnings: {words:?})", wrong.join("; ")))
        }
    }
}

fn messages(faults: &Diagnostics) -> String {
    faults.items.iter().map(|d| format!("{} {}", d.code, d.message)).collect::<Vec<_>>().join("; ")
}

/// Runs the cases of a family, tells how they ended, and fails with the first wrong ones.
fn battery(name: &str, share: usize, make: fn(&mut Random, &Path) -> Trial) {
    all(name, share, |number, folder| {
        let trial = make(&mut Random::of(name, number), folder);
        (end(&trial, folder), trial.text)
    });
}

/// As [`battery`], of twins.
fn twins(name: &str, make: fn(&mut Random) -> Twins) {
    all(name, 1, |number, folder| {
        let twins = make(&mut Random::of(name, number));
        (pairs::end(&twins, folder), twins.text())
    });
}

/// Runs `one`, which has the number of a case and a folder and returns its end and its text.
fn all(name: &str, share: usize, one: impl Fn(usize, &Path) -> (Result<End, String>, String) + Sync) {
    let asked = std::env::var("FAYING_BATTERY").ok().and_then(|n| n.parse::<usize>().ok());
    let only = std::env::var("FAYING_BATTERY_CASE").ok().and_then(|n| n.parse::<usize>().ok());
    let count = asked.unwrap_or(60).div_ceil(share);
    let numbers: Vec<usize> = only.map_or_else(|| (0..count).collect(), |n| vec![n]);
    let ends: Vec<(usize, Result<End, String>, String)> = numbers
        .into_par_iter()
        .map(|number| {
            let folder = tempfile::tempdir().unwrap();
            let (end, text) = one(number, folder.path());
            (number, end, text)
        })
        .collect();
    let mut counts: BTreeMap<End, usize> = BTreeMap::new();
    ends.iter().filter_map(|(_, e, _)| e.as_ref().ok()).for_each(|e| *counts.entry(*e).or_default() += 1);
    println!("{name} ends {counts:?}");
    let wrong: Vec<_> = ends.iter().filter(|(_, e, _)| e.is_err()).collect();
    let shown: Vec<String> = wrong.iter().take(12).map(|(n, e, _)| format!("{name} {n}: {}", e.as_ref().unwrap_err())).collect();
    let first = wrong.first().map_or("", |(_, _, text)| text);
    assert!(wrong.is_empty(), "{} of {} wrong\n{}\nthe first:\n{first}", wrong.len(), ends.len(), shown.join("\n"));
    let refused = ends.len() == counts.get(&End::Refused).copied().unwrap_or(0);
    let expected = if name.contains("cannot") { refused } else { counts.get(&End::Right).copied().unwrap_or(0) > 0 };
    assert!(expected || only.is_some(), "{name} ends {counts:?}");
}

// 2,000 tied and 2,000 contact cases: the families of each kind share its number

#[test]
fn tied_layers_carry_a_uniform_stress() {
    battery("tied layers", 2, layers::tied);
}

#[test]
fn tied_layers_conduct_heat() {
    battery("conducting layers", 8, layers::conducting);
}

#[test]
fn tied_rings_are_those_of_lame() {
    battery("tied rings", 8, rings::tied);
}

#[test]
fn bodies_beside_a_clearance_are_not_tied() {
    battery("layers with a clearance", 8, sides::clearance_of_layers);
    battery("rings with a clearance", 8, sides::clearance_of_rings);
}

#[test]
fn pressed_layers_close_their_clearances_and_push_overlaps_apart() {
    battery("pressed layers", 2, layers::pressed);
}

#[test]
fn pressed_rings_are_those_of_lame() {
    battery("pressed rings", 4, rings::pressed);
}

#[test]
fn blocks_on_half_planes_take_their_pressure() {
    battery("blocks on half-planes", 8, layers::on_a_plane);
}

#[test]
fn sides_that_cannot_meet_are_refused() {
    battery("sides that cannot meet", 8, sides::that_cannot_meet);
}

// 2,000 of each kind

#[test]
fn bodies_of_any_sides_lie_evenly_on_half_planes() {
    battery("quadrilaterals on half-planes", 1, uniform::on_half_planes);
}

#[test]
fn bodies_of_any_sides_lie_evenly_on_boxes() {
    battery("quadrilaterals on boxes", 1, uniform::on_boxes);
}

#[test]
fn bodies_of_any_sides_lie_evenly_on_polylines() {
    battery("quadrilaterals on polylines", 1, uniform::on_polylines);
}

#[test]
fn bodies_of_any_sides_lie_evenly_on_level_sets() {
    battery("quadrilaterals on level sets", 1, uniform::on_level_sets);
}

#[test]
fn bodies_of_any_sides_lie_evenly_on_one_another() {
    battery("quadrilaterals on their images", 1, uniform::on_their_images);
}

#[test]
fn sides_that_are_turned_away_are_refused() {
    battery("sides that cannot face an obstacle", 1, uniform::turned_away);
}

#[test]
fn an_obstacle_in_other_words_presses_the_same() {
    twins("obstacles in other words", pairs::in_other_words);
}

#[test]
fn an_obstacle_that_moves_is_a_body_that_moves_the_other_way() {
    twins("moved obstacles and bodies", pairs::moved);
}

#[test]
fn the_mirror_changes_signs_alone() {
    twins("twins in the mirror", pairs::mirrored);
}
