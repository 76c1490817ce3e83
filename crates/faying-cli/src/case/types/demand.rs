//! `[[probe]]`, `[[check]]` and `[study.NAME]`: quantities, checks on them, values of studies.

use super::Head;
use crate::formula::Formula;
use crate::place::Located;

/// Steps at which a probe or a check is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AskedSteps {
    /// Every step.
    All,
    /// The step at this time.
    At(f64),
}

/// `[[probe]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// The block.
    pub head: Head,
    /// Its name, `probe-0`, ... by default.
    pub name: Located<String>,
    /// The quantity as text.
    pub quantity: Located<String>,
    /// Steps; `None`: the last one.
    pub t: Option<Located<AskedSteps>>,
}

/// `[[line]]`: fields at points of a straight line, its ends included.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The block.
    pub head: Head,
    /// Its name, `line-0`, ... by default.
    pub name: Located<String>,
    /// The fields as texts.
    pub quantities: Vec<Located<String>>,
    /// The point at which it begins \[length\].
    pub from: Located<Vec<f64>>,
    /// The point at which it ends \[length\].
    pub to: Located<Vec<f64>>,
    /// Number of points.
    pub n: Located<usize>,
    /// Steps; `None`: the last one.
    pub t: Option<Located<AskedSteps>>,
}

/// Condition of a check; the numbers may be formulas of constants and quantities.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Condition {
    /// value < bound.
    Below(Located<Formula>),
    /// value > bound.
    Above(Located<Formula>),
    /// |value - expected| <= atol + rtol |expected|; one of them may be absent.
    Equals {
        /// Expected value.
        value: Located<Formula>,
        /// Relative tolerance.
        rtol: Option<Located<Formula>>,
        /// Absolute tolerance.
        atol: Option<Located<Formula>>,
    },
}

/// `[[check]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The block.
    pub head: Head,
    /// Its name, `check-0`, ... by default.
    pub name: Located<String>,
    /// The quantity as text.
    pub quantity: Located<String>,
    /// The condition on the quantity.
    pub condition: Condition,
    /// Only for this backend.
    pub backend: Option<Located<String>>,
    /// `over = "all"`: both extremes.
    pub over_all: Option<Located<()>>,
    /// Steps; `None`: the last one.
    pub t: Option<Located<AskedSteps>>,
}

/// `[study.NAME]`: values of a study that the command line does not give.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyValues {
    /// The command: `compare`, `convergence`, ...
    pub name: String,
    /// Number of levels.
    pub levels: Option<usize>,
    /// As words of the command line: `1,2,3` or `iga:2,3,4`.
    pub degrees: Vec<String>,
    /// Names of backends, `SLAVE+MASTER` for one on slave patches.
    pub backends: Vec<String>,
    /// Multipliers, by name or as the text of their data.
    pub pairings: Vec<String>,
    /// Integrations of interfaces and contacts.
    pub integration: Vec<String>,
    /// Extra Gauss points per segment.
    pub extra_points: Vec<usize>,
    /// As words of the command line: `KEY=v1,v2`.
    pub vary: Vec<String>,
    /// Probes or quantities.
    pub quantities: Vec<String>,
    /// Largest relative difference from the first row.
    pub tol: Option<f64>,
    /// Norms of the inf-sup test: `l2`, `h-half`.
    pub norm: Option<String>,
    /// Ends of slave sides in the inf-sup test: `case`, `zero`, `free`.
    pub ends: Option<String>,
}
