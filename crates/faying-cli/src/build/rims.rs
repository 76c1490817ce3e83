//! Conditions on edges and in corners: the functions that two or three sides share.

use super::builder::Builder;
use super::built::Built;
use super::exact::needs_exact;
use super::sides::Sides;
use crate::case::{Boundary, Datum, SideRef};
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::words::component_name;
use faying::assembly::Rim;
use faying::problem::{Pin, RimModel, Value};
use std::sync::Arc;

/// Sides that meet in an edge or a corner such as u0w1 or u0v0w0; `None` for other names.
pub(super) fn sides(name: &str) -> Option<Vec<&str>> {
    let word = |k: usize| name.get(2 * k..2 * k + 2).filter(|w| ["u0", "u1", "v0", "v1", "w0", "w1"].contains(w));
    let all: Option<Vec<&str>> = (0..name.len() / 2).map(word).collect();
    all.filter(|list| list.len() > 1 && 2 * list.len() == name.len())
}

/// Applies the conditions of `block` to the edge or corner where the sides `names` meet.
pub(super) fn pin<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &mut Built<S, N>,
    sides: &mut Sides<S, N>,
    block: &Boundary,
    wanted: &Located<SideRef>,
    names: &[&str],
) -> Result<(), Box<Diagnostic>> {
    let patch = wanted.value.patch;
    let what = if names.len() == N { "corner" } else { "edge" };
    let label = format!("{}.{}", model.patches[patch].name, wanted.value.side);
    let loads = block.traction.iter().any(Option::is_some)
        || block.pressure.is_some()
        || [&block.force, &block.spring, &block.rigid_force].into_iter().any(|list| list.iter().any(Option::is_some));
    if loads {
        let text = format!("`{label}` is {what_it_is}; loads and springs act on sides", what_it_is = with_article(what));
        return Err(Box::new(builder.error("E015", text, wanted.at).with_help("name a side, or prescribe values by fix or dirichlet")));
    }
    if let Some(at) = block.fix_normal.as_ref().or(block.fix_tangential.as_ref()).map(|f| f.at) {
        let text = format!("`{label}` is {} and has no normal", with_article(what));
        return Err(Box::new(builder.error("E015", text, at).with_help("fix components x, y, z")));
    }
    if let Some(filter) = &block.filter {
        let text = format!("`where` chooses facets of sides; `{label}` is {}", with_article(what));
        return Err(Box::new(builder.error("E015", text, filter.at)));
    }
    let mut met = Vec::new();
    for side in names {
        let side = Located::new(SideRef { patch, side: (*side).to_owned() }, wanted.at);
        met.push(sides.get(builder, &model.patches, &side)?);
    }
    let known = model.pins.iter().find(|p| p.rim.patch == patch && p.rim.name == wanted.value.side).map(|p| p.rim.clone());
    let rim = known.unwrap_or_else(|| {
        let others: Vec<_> = met[1..].iter().map(|s| &s.trace).collect();
        let rim = Rim::shared(&met[0].trace, &others, model.patches[patch].extra_points);
        Arc::new(RimModel { patch, name: wanted.value.side.clone(), label: label.clone(), rim })
    });
    if rim.rim.x.is_empty() {
        let list: Vec<&str> = met.iter().map(|s| s.label.as_str()).collect();
        let text = format!("there is no {what} `{label}`: {} share no function there", list.join(" and "));
        return Err(Box::new(builder.error("E021", text, wanted.at)));
    }
    for (component, datum) in block.dirichlet.iter().enumerate() {
        let Some(datum) = datum else { continue };
        if let Some(first) = model.pins.iter().position(|p| Arc::ptr_eq(&p.rim, &rim) && p.component == component) {
            let line = model.sources.pins[first].in_file().map_or(String::new(), |(line, _)| format!(", first in line {line}"));
            let text = format!("component {} of `{label}` is prescribed twice{line}", component_name(component, model.components));
            return Err(Box::new(builder.error("E052", text, datum.at).with_help("drop one of the two")));
        }
        let value = match &datum.value {
            Datum::Exact => {
                needs_exact(builder, model, datum.at)?;
                Value::Exact
            }
            Datum::Formula(f) if f.as_constant() == Some(0.0) => Value::Zero,
            Datum::Formula(f) => Value::Data(f.clone().into()),
        };
        model.pin(Pin { rim: rim.clone(), component, value }, datum.at);
    }
    Ok(())
}

fn with_article(what: &str) -> String {
    if what == "edge" { "an edge".into() } else { format!("a {what}") }
}
