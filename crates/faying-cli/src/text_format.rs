//! Numbers, components and sides in messages.

use faying::problem::SideView;
use std::sync::Arc;

/// Sizes of numbers that are written without an exponent.
const PLAIN: std::ops::Range<f64> = 1e-9..1e15;

/// Formats a number with four digits.
pub(crate) fn short(x: f64) -> String {
    let plain = |v: f64| if v == 0.0 || PLAIN.contains(&v.abs()) { format!("{v}") } else { format!("{v:e}") };
    format!("{x:.3e}").parse::<f64>().map_or_else(|_| x.to_string(), plain)
}

/// Formats a share in percent with two digits.
pub(crate) fn percent(share: f64) -> String {
    let text = format!("{:.1e}", 100.0 * share);
    text.parse::<f64>().map_or(text, |v| format!("{v}"))
}

/// Formats a number of bytes.
pub fn bytes(n: u64) -> String {
    let x = n as f64;
    if x >= 1e9 {
        format!("{:.1} GB", x / 1e9)
    } else if x >= 1e6 {
        format!("{:.0} MB", x / 1e6)
    } else {
        format!("{:.0} kB", x / 1e3)
    }
}

/// Formats a position: "x = 0.25, y = 1".
pub(crate) fn place(x: &[f64]) -> String {
    ["x", "y", "z"].iter().zip(x).map(|(name, v)| format!("{name} = {}", short(*v))).collect::<Vec<_>>().join(", ")
}

/// Formats the coordinates of a point with all their digits: "0.25, 1".
pub(crate) fn coordinates(x: &[f64]) -> String {
    x.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}

/// Text ", t = 0.5" if something changes with the time, else empty.
pub(crate) fn time_text(changes: bool, t: f64) -> String {
    if changes { format!(", t = {}", short(t)) } else { String::new() }
}

/// Names of components in messages.
pub(crate) fn component_name(component: usize, components: usize) -> &'static str {
    if components == 1 { "u" } else { ["x", "y", "z"][component.min(2)] }
}

/// Labels of sides in messages.
pub(crate) fn labels<const S: usize, const N: usize>(sides: &[Arc<SideView<S, N>>]) -> String {
    sides.iter().map(|s| format!("`{}`", s.label())).collect::<Vec<_>>().join(", ")
}
