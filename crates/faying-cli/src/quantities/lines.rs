//! Lines of a case: prepared before the solve, evaluated after it.

use super::evaluate::{Answer, evaluate};
use super::grammar::Reduce;
use super::locate::{Locators, Spot};
use super::prepare::{Prepared, Preparer};
use crate::case::{Case, Line};
use crate::errors::{Diagnostic, Diagnostics};
use crate::place::Located;
use crate::result::LineReport;
use faying::linalg::Vector;
use faying::problem::Solution;
use serde_json::Value;

/// Distance from a body, as a fraction of an element, up to which a point belongs to it.
const OFF: f64 = 0.01;

/// A line, prepared for evaluation.
#[derive(Debug)]
pub struct PreparedLine<const S: usize, const N: usize> {
    points: Vec<Vector<N>>,
    /// Per field its value at every point; `None` outside.
    fields: Vec<Vec<Option<Prepared<S, N>>>>,
}

impl<const S: usize, const N: usize> PreparedLine<S, N> {
    /// Prepares a line.
    ///
    /// # Errors
    /// E018 for what is no field, E021 for unknown patches, E022 for a line that is outside of all bodies.
    pub fn of(case: &Case, line: &Line, locators: &Locators<'_, S, N>, skeleton: &Value) -> Result<Self, Diagnostics> {
        let (preparer, mut faults) = (Preparer::new(case, locators, skeleton), Diagnostics::new());
        let [from, to] = [&line.from, &line.to].map(|x| Vector::<N>::from_column_slice(&x.value));
        let last = line.n.value - 1;
        let points: Vec<Vector<N>> = (0..=last).map(|k| from + (to - from) * (k as f64 / last as f64)).collect();
        let mut fields = Vec::with_capacity(line.quantities.len());
        for text in &line.quantities {
            match field(case, &preparer, locators, text, &points) {
                Ok(found) => fields.push(found),
                Err(fault) => faults.push(*fault),
            }
        }
        if faults.has_errors() { Err(faults) } else { Ok(Self { points, fields }) }
    }

    /// Its values on a solution.
    pub fn values(&self, line: &Line, t: Option<f64>, solution: &Solution<S, N>) -> LineReport {
        let value = |at: &Option<Prepared<S, N>>| match at.as_ref().map(|at| evaluate(at, solution, &Value::Null)) {
            Some(Answer::One(value)) => value,
            _ => f64::NAN,
        };
        LineReport {
            name: line.name.value.clone(),
            quantities: line.quantities.iter().map(|q| q.value.trim().to_owned()).collect(),
            s: self.points.iter().map(|x| (x - self.points[0]).norm()).collect(),
            x: self.points.iter().map(|x| x.as_slice().to_vec()).collect(),
            values: self.fields.iter().map(|field| field.iter().map(value).collect()).collect(),
            t,
        }
    }
}

/// A field at points.
fn field<const S: usize, const N: usize>(
    case: &Case,
    preparer: &Preparer<'_, S, N>,
    locators: &Locators<'_, S, N>,
    text: &Located<String>,
    points: &[Vector<N>],
) -> Result<Vec<Option<Prepared<S, N>>>, Box<Diagnostic>> {
    let Prepared::FunctionSpace(field, bodies, Reduce::None) = preparer.prepare(&text.value, text.at, true)? else {
        let message = format!("`{}` is no field that a line can follow", text.value);
        let help = "name a field without a place, such as stress.yy, u.norm or von_mises in lower";
        return Err(Box::new(Diagnostic::error("E018", message).at(&case.source, text.at).with_help(help)));
    };
    let mut found = Vec::with_capacity(points.len());
    let mut least = f64::INFINITY;
    for x in points {
        let mut best: Option<(f64, Spot<N>)> = None;
        for &patch in &bodies {
            let at = match locators.of(patch).locate(x) {
                Ok(at) => at,
                Err(outside) => {
                    least = least.min(outside.distance);
                    continue;
                }
            };
            least = least.min(at.distance);
            let near = OFF * locators.contents().body(patch).space().bounds(at.element).diagonal();
            if at.distance <= near && best.as_ref().is_none_or(|(distance, _)| at.distance < *distance) {
                let elements = locators.around(patch, at.element, at.xi, &at.x);
                best = Some((at.distance, Spot { patch, shared: false, moved: false, elements }));
            }
        }
        found.push(best.map(|(_, spot)| Prepared::At(field, spot)));
    }
    if found.iter().any(Option::is_some) {
        return Ok(found);
    }
    let message = format!("no point of the line is in a body with `{}`; the nearest is {least:.3e} away", text.value);
    Err(Box::new(Diagnostic::error("E022", message).at(&case.source, text.at).with_help("move `from` and `to` so that it crosses a body")))
}
