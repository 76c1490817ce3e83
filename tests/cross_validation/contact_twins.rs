//! Contact on one mesh: what our active sets find is what PETSc finds for the same multipliers and cones as bounds on unknowns.

use crate::cases::values;
use crate::contact::{balanced, in_balance};
use crate::document::{document, texts};
use std::collections::BTreeMap;

#[test]
fn every_cone_and_pairing_finds_the_solution_of_its_own_inequality() {
    let document = document("contact_twins");
    let agreement = document["agreement"].as_f64().unwrap();
    let runs = document["runs"].as_array().unwrap();
    assert!(!runs.is_empty());
    for stored in runs {
        let (case, sets) = (stored["case"].as_str().unwrap(), texts(&stored["sets"]));
        let quantities = stored["quantities"].as_array().unwrap();
        let names: Vec<String> = quantities.iter().map(|q| q["quantity"].as_str().unwrap().to_owned()).collect();
        let asked: Vec<String> = names.iter().cloned().chain(balanced(case)).collect();
        let mut found = values(case, &sets, &asked);
        in_balance(&found.split_off(names.len()), &sets);
        assert_eq!(found.len(), names.len());
        // per kind of quantity: the largest difference, and the scale, which is the largest value
        let mut kinds: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for ((name, quantity), own) in names.iter().zip(quantities).zip(found) {
            let value = quantity["value"].as_f64().unwrap();
            assert!(own.is_finite(), "{sets:?} {name}");
            let kind = kinds.entry(name.split(" at ").next().unwrap()).or_default();
            *kind = [kind[0].max((own - value).abs()), kind[1].max(value.abs())];
        }
        let worst = kinds.values().map(|[difference, scale]| difference / scale).fold(0.0, f64::max);
        println!("{case} {}: {} values, {worst:.1e}", sets[1..].join(" "), names.len());
        for (kind, [difference, scale]) in kinds {
            assert!(difference <= agreement * scale, "{sets:?} {kind}: {difference:.2e} of {scale:.2e}");
        }
    }
}
