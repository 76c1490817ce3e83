//! Observed rates of convergence between levels, and the checks on them.

use super::quantities::{Asked, rate_of};
use super::rows::Row;
use crate::case::{Case, Condition};
use crate::formula::Formula;
use crate::quantities::{Quantity, QuantityKind, look_up};
use crate::result::{CheckReport, Status};
use serde_json::Value;

/// Relative error below which it is rounding and falls no more.
const ROUNDING: f64 = 1e-13;

/// Fills `rates` of every row: of an error from the level before, log2(e_{k-1} / e_k); of any other quantity from two levels
/// before, log2(|q_{k-1} - q_{k-2}| / |q_k - q_{k-1}|), the rate at which its changes fall. No rate where a number is missing or zero, or where
/// an error is [`ROUNDING`].
pub(super) fn fill(rows: &mut [Row], asked: &[Asked]) {
    for k in 1..rows.len() {
        let (done, rest) = rows.split_at_mut(k);
        let (row, one) = (&mut rest[0], &done[k - 1]);
        if !one.spec.same_line(&row.spec) || !one.solved() || !row.solved() {
            continue;
        }
        let two = k.checked_sub(2).map(|j| &done[j]).filter(|two| two.spec.same_line(&row.spec) && two.solved());
        let mut found: Vec<(String, f64)> = Vec::new();
        let is_rounding = |name: &str| {
            let share = |of: &Row| of.result.errors.get(&format!("{name}.rel")).is_some_and(|share| *share < ROUNDING);
            share(one) || share(row)
        };
        for (name, value) in row.result.errors.iter().filter(|(name, _)| !name.ends_with(".rel") && !is_rounding(name)) {
            found.push((name.to_owned(), one.result.errors.get(name).map_or(f64::NAN, |before| (before / value).log2())));
        }
        for a in asked.iter().filter(|a| row.result.errors.get(&a.quantity).is_none()) {
            let (q1, q2) = (a.value(one), a.value(row));
            let rate = match two {
                _ if a.is_error() => (q1 / q2).log2(),
                Some(two) => ((q1 - a.value(two)).abs() / (q2 - q1).abs()).log2(),
                None => f64::NAN,
            };
            found.push((a.name.clone(), rate));
        }
        for (name, rate) in found.into_iter().filter(|(_, rate)| rate.is_finite()) {
            row.rates.insert(name, rate);
        }
    }
}

/// Decides the checks on `rate.*` in the last level of every line; they stay skipped in a line of level 0 alone.
pub(super) fn decide(rows: &mut [Row], case: &Case, asked: &[Asked]) {
    for k in 0..rows.len() {
        let last = rows.get(k + 1).is_none_or(|next| !next.spec.same_line(&rows[k].spec));
        let row = &mut rows[k];
        if !last || row.spec.level == 0 {
            continue;
        }
        for (position, check) in case.checks.iter().enumerate() {
            let Some(inner) = asked_rate(&check.quantity.value, row) else { continue };
            let elsewhere = check.backend.as_ref().is_some_and(|b| row.result.backends.iter().any(|(_, used)| *used != b.value));
            if elsewhere || row.result.checks.get(position).is_none_or(|report| !report.skipped) {
                continue;
            }
            let name = asked.iter().find(|a| a.quantity == inner).map_or(inner.as_str(), |a| a.name.as_str());
            let rate = row.rates.get(&inner).or_else(|| row.rates.get(name)).copied();
            decided(&mut row.result.checks[position], rate, &check.condition, &row.document, "a rate");
            let failed = !row.result.checks[position].ok;
            row.result.checks_skipped -= 1;
            row.result.checks_performed += 1;
            if failed && row.result.status == Status::Ok {
                row.result.status = Status::CheckFailed;
                row.result.exit = row.result.status.exit();
            }
        }
    }
}

/// Returns Q of a check on `rate.Q` that a row can decide: a row of inf-sup constants decides only that of its own pairing.
fn asked_rate(text: &str, row: &Row) -> Option<String> {
    if row.beta.is_none() {
        return rate_of(text);
    }
    let inner = text.trim().strip_prefix("rate.")?.trim();
    let own = matches!(Quantity::parse(inner).map(|q| q.kind), Ok(QuantityKind::Beta(pairing)) if pairing == row.pairing);
    own.then(|| "beta".to_owned())
}

/// Decides a check on a number of the study, a rate or an inf-sup constant; it fails without one. Quantities of its condition are among
/// `numbers`; `on`: the kind of check, for messages.
pub(crate) fn decided(report: &mut CheckReport, rate: Option<f64>, condition: &Condition, numbers: &Value, on: &str) {
    let number = |f: &Formula| -> Result<f64, String> {
        let value = |text: &str| {
            let path: Vec<String> = text.split('.').map(str::to_owned).collect();
            look_up(numbers, &path).unwrap_or_else(|| Err(format!("a check on {on} cannot ask for `{text}`")))
        };
        let values: Result<Vec<f64>, String> = f.quantities().iter().map(|q| value(&q.text)).collect();
        Some(f.value_with(1.0, &values?)).filter(|v| v.is_finite()).ok_or_else(|| format!("`{}` is not finite", f.text()))
    };
    let optional = |f: &Option<crate::place::Located<Formula>>| f.as_ref().map_or(Ok(0.0), |f| number(&f.value));
    let verdict = || -> Result<(f64, f64, bool), String> {
        let rate = rate.ok_or("the levels give no rate")?;
        Ok(match condition {
            Condition::Below(f) => number(&f.value).map(|bound| (rate, bound, rate < bound))?,
            Condition::Above(f) => number(&f.value).map(|bound| (rate, bound, rate > bound))?,
            Condition::Equals { value, rtol, atol } => {
                let (wanted, rtol, atol) = (number(&value.value)?, optional(rtol)?, optional(atol)?);
                (rate, wanted, (rate - wanted).abs() <= atol + rtol * wanted.abs())
            }
        })
    };
    report.skipped = false;
    match verdict() {
        Ok((value, expected, ok)) => {
            (report.value, report.expected, report.ok, report.reason) = (value, expected, ok, None);
        }
        Err(reason) => {
            (report.ok, report.reason) = (false, Some(reason));
        }
    }
}
