//! Diagnostics of loads, springs, foundations, prescribed values and moduli that jump inside of elements or have no bound, of which the rule of integration
//! misses a part.

use crate::case::{Boundary, Case, Datum};
use crate::errors::Diagnostic;
use crate::formula::Formula;
use crate::lower::LoweredCase;
use crate::place::{Located, SourceSpan};
use crate::text_format::{component_name, percent, short};
use faying::problem::{Inexact, Integral, Resultant, Statement};

/// Components below this share of the largest are round-off.
const ROUNDING: f64 = 1e-9;
const HELP: &str = "let it jump on edges of elements only: give breakpoints there, as in elements = [[0, 0.23, 1], 4], or refine the mesh";

/// Returns the diagnostic of a load, springs, a prescribed value or a material whose integral is inexact.
pub fn diagnostic<const S: usize, const N: usize>(case: &Case, model: &LoweredCase<S, N>, found: &Inexact) -> Option<Diagnostic> {
    let (components, error) = (model.system.contents().components(), percent(found.error));
    let when = if case.has_steps() { format!(" at t = {}", short(found.t)) } else { String::new() };
    let [by_rule, finer] = [&found.integrated, &found.finer];
    let one = |r: &Resultant| short(r.force[0]);
    let block = |of: &Statement| model.places.said(*of).and_then(|said| case.boundaries.get(said.block?));
    let (text, at, help) = match &found.of {
        Integral::Load { of, name, patch } => {
            let at = match patch {
                Some(k) => case.patches[*k].head.at,
                None => block(of).map_or_else(SourceSpan::default, place_of_load),
            };
            let text = format!(
                "the load \"{name}\" is integrated inexactly{when}: {} for {} by a finer rule, {error} % off",
                resultant::<N>(by_rule, components),
                resultant::<N>(finer, components)
            );
            (text, at, HELP)
        }
        Integral::Spring { of, name, component } => {
            let at = block(of)
                .map_or_else(SourceSpan::default, |b| b.spring.get(*component).and_then(Option::as_ref).map_or(b.head.at, |f| f.at));
            let text = format!(
                "the springs of \"{name}\" along {} are integrated inexactly{when}: stiffness {} for {} by a finer rule, {error} % off",
                component_name(*component, components),
                one(by_rule),
                one(finer)
            );
            (text, at, HELP)
        }
        Integral::Foundation { of, name, component } => {
            let key = if components == 1 { "reaction" } else { "foundation" };
            let text = format!(
                "the {key} of patch \"{name}\" along {} varies inside of elements{when}: their rules see {} for {} in all, and {error} % of it in wrong elements",
                component_name(*component, components),
                one(by_rule),
                one(finer)
            );
            (text, model.places.at(*of), HELP)
        }
        Integral::Prescribed { of, side, component } => {
            let text = format!(
                "the value of {} prescribed on `{side}` is integrated inexactly{when}: {} for {} by a finer rule, {error} % off",
                component_name(*component, components),
                one(by_rule),
                one(finer)
            );
            let help = "data without a bound give results that depend on the mesh; let jumps lie on edges of elements, or refine the mesh";
            (text, model.places.at(*of), help)
        }
        Integral::Modulus { patch, name } => {
            let text = format!(
                "the modulus of patch \"{}\" varies inside of elements{when}: their rules see {} for {} in all, and {error} % of it in wrong elements",
                name,
                one(by_rule),
                one(finer)
            );
            (text, case.patches[*patch].head.at, "give each material a patch of its own, or breakpoints where it jumps; or refine the mesh")
        }
        _ => return None,
    };
    Some(Diagnostic::warning("E017", text).at(&case.source, at).with_help(help))
}

/// Returns the diagnostic of prescribed values that the mesh holds badly: side, component, time and share in the mean.
pub fn coarse_values<const S: usize, const N: usize>(
    case: &Case,
    model: &LoweredCase<S, N>,
    of: Statement,
    (side, component, t, error): (&str, usize, f64, f64),
) -> Diagnostic {
    let when = if case.has_steps() { format!(" at t = {}", short(t)) } else { String::new() };
    let text = format!(
        "the mesh does not have the values of {} prescribed on `{side}`{when}: in the mean it is {} % off",
        component_name(component, model.system.contents().components()),
        percent(error)
    );
    let help = "values that change within an element need smaller ones; where they jump give each part a [[boundary]] with `where`";
    Diagnostic::warning("E017", text).at(&case.source, model.places.at(of)).with_help(help)
}

/// The formula of a load that is no number, else its block.
fn place_of_load(block: &Boundary) -> SourceSpan {
    let varies = |f: &&Located<Formula>| f.value.as_constant().is_none();
    let tractions = block.traction.iter().flatten().filter(|d| !matches!(&d.value, Datum::Formula(f) if f.as_constant().is_some()));
    let formulas = block.pressure.iter().chain(block.force.iter().flatten()).filter(varies).map(|f| f.at);
    tractions.map(|d| d.at).chain(formulas).next().unwrap_or(block.head.at)
}

/// Force and moment: "(0, -2.278) with the moment -2.6".
fn resultant<const N: usize>(r: &Resultant, components: usize) -> String {
    if components == 1 {
        return short(r.force[0]);
    }
    let list = |values: &[f64]| {
        let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let clean = values.iter().map(|v| if v.abs() > ROUNDING * largest { short(*v) } else { "0".into() });
        format!("({})", clean.collect::<Vec<_>>().join(", "))
    };
    let moment = if N == 2 { short(r.moment[2]) } else { list(&r.moment) };
    format!("{} with the moment {moment}", list(&r.force[..components]))
}
