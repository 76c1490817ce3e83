//! Quantities of the language that this version does not have.

use super::grammar::{axes, axis};

/// Substitute for a quantity of the contract that this version lacks; `None` for every other path.
pub(super) fn later(path: &[String]) -> Option<&'static str> {
    let words: Vec<&str> = path.iter().map(String::as_str).collect();
    let words = words.strip_suffix(&["gauss"]).unwrap_or(&words);
    match words.strip_suffix(&["min"]).or_else(|| words.strip_suffix(&["max"])).unwrap_or(words) {
        ["nominal", c] if axes(c).is_some() => Some("under small kinematics it is the stress: stress.xx, stress.yy, stress.xy"),
        ["newton", "iterations" | "rate"] => Some("it belongs to finite kinematics: small ones need no Newton iteration"),
        ["stretch", _, .., "least"] => Some("it belongs to finite kinematics: displacements and rotations are small here"),
        ["contact", _, "friction", c] if axis(c).is_some() => Some("contact is frictionless here: leave it out"),
        ["contact", _, "stick" | "slip" | "dissipated"] => Some("contact is frictionless here: leave it out"),
        _ => None,
    }
}
