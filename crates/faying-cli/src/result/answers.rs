//! Answers to probes and checks.

use serde::Serialize;

/// Result of a probe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeReport {
    /// Its name.
    pub name: String,
    /// Its quantity, as written.
    pub quantity: String,
    /// Its value; `null` in the file where it is not finite.
    pub value: f64,
    /// Place of an extreme \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// The patch whose value was taken, where several patches hold the point and the quantity names none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patch: Option<String>,
    /// Reason for a missing value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// Its name.
    pub name: String,
    /// Its quantity, as written.
    pub quantity: String,
    /// The value found; the worse one if both extremes are checked.
    pub value: f64,
    /// Place of an extreme \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// The expected value, or the bound.
    pub expected: f64,
    /// Whether it passed.
    pub ok: bool,
    /// Relation that is checked: "below", "above", "equals".
    pub relation: String,
    /// Reason for a missing value or a skipped check.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Whether it was left to another command or backend and does not count.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub skipped: bool,
}
