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
    /// Time of its step, where it asks for one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
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
    /// Time of the step that decided it, where it asks for one or for all: of all the first one at which it failed, else the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
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

/// Fields at the points of a straight line.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LineReport {
    /// Its name.
    pub name: String,
    /// Its fields, as written.
    pub quantities: Vec<String>,
    /// Distance of every point from the first \[length\].
    pub s: Vec<f64>,
    /// Every point \[length\].
    pub x: Vec<Vec<f64>>,
    /// Values of every field point by point; not finite, in the file `null`, where the point is in no body.
    pub values: Vec<Vec<f64>>,
    /// Time of its step, where it asks for one; a line that asks for all has one report per step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
}
