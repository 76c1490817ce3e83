//! Checks of material and load formulas at quadrature points: limits, and values that are not finite.

use super::builder::Builder;
use super::materials::assumption;
use crate::case::{self, Elastic as Constants};
use crate::errors::Diagnostic;
use crate::formula::{Formula, Point};
use crate::place::{Located, Place};
use crate::words::short;
use faying::basis::Order;
use faying::geometry::{Geometry, MapTable};
use faying::linalg::Vector;
use faying::physics::{Conductor, Elastic, MaterialError};
use faying::problem::{Model, PatchModel, SideModel};
use faying::quadrature::Quadrature;
use rayon::prelude::*;

/// Returns the first quadrature point, elements ascending, at which `wrong` returns an error.
fn first_wrong<const D: usize, const N: usize, E: Send>(
    space: &dyn Geometry<D, N>,
    rules: &dyn Quadrature<D>,
    wrong: &(dyn Fn(&Vector<N>) -> Option<E> + Sync),
) -> Option<(Vector<N>, E)> {
    (0..space.num_elements()).into_par_iter().find_map_first(|e| {
        let mut map = MapTable::new();
        space.map(e, &rules.rule(e).points, Order::Values, &mut map);
        map.x.iter().find_map(|x| wrong(x).map(|found| (*x, found)))
    })
}

/// Formats a point: "x = 0.25, y = 1".
fn place_text<const N: usize>(x: &Vector<N>) -> String {
    ["x", "y", "z"].iter().zip(x.iter()).map(|(name, v)| format!("{name} = {}", short(*v))).collect::<Vec<_>>().join(", ")
}

/// Times at which a formula is checked: all of the case if it changes, else the first.
pub(crate) fn times(case: &case::Case, changes: bool) -> &[f64] {
    match case.steps.value.as_slice() {
        [] => &[1.0],
        all if changes => all,
        all => &all[..1],
    }
}

/// Text ", t = 0.5" if something changes with the time, else empty.
pub(super) fn time_text(changes: bool, t: f64) -> String {
    if changes { format!(", t = {}", short(t)) } else { String::new() }
}

/// Source location of the key that an error of a material refers to.
pub(super) fn key(material: &case::Material, error: &MaterialError) -> Place {
    match (&material.elastic, error) {
        (Some(Constants::YoungPoisson(_, nu)), MaterialError::Singular { .. } | MaterialError::Ratio { .. }) => nu.at,
        (Some(Constants::YoungPoisson(e, _)), _) => e.at,
        (Some(Constants::Lame(l, _)), MaterialError::Lambda { .. }) => l.at,
        (Some(Constants::Lame(_, m)), _) => m.at,
        (None, _) => material.conductivity.at,
    }
}

/// The formulas of the constants of a material.
pub(super) fn constants(material: &case::Material) -> Vec<&Formula> {
    match &material.elastic {
        Some(Constants::YoungPoisson(a, b) | Constants::Lame(a, b)) => vec![&a.value, &b.value],
        None => vec![&material.conductivity.value],
    }
}

/// Reports E053 for varying constants outside their limits at a quadrature point of a patch, at one of the times of the case.
pub(super) fn materials<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, patches: &[PatchModel<S, N>]) {
    let case = builder.case;
    for (patch, read) in patches.iter().zip(&case.patches) {
        let material = &case.materials[read.material.value];
        let formulas = constants(material);
        if formulas.iter().all(|f| f.as_constant().is_some()) {
            continue;
        }
        let assumption = assumption::<N>(case.model.assumption.value);
        let refused = |x: &Vector<N>, t: f64| {
            let at = Point::new(x.as_slice()).at_time(t);
            match &material.elastic {
                None => Conductor::<N>::try_new(material.conductivity.value.value(&at)).err(),
                Some(Constants::YoungPoisson(e, nu)) => {
                    Elastic::Young { young: e.value.value(&at), poisson: nu.value.value(&at) }.check(assumption).err()
                }
                Some(Constants::Lame(l, m)) => Elastic::Lame { lambda: l.value.value(&at), mu: m.value.value(&at) }.check(assumption).err(),
            }
        };
        let changes = formulas.iter().any(|f| f.depends_on_time());
        let wrong = times(case, changes)
            .iter()
            .find_map(|&t| first_wrong(&**patch.body.space(), &patch.rules, &|x: &Vector<N>| refused(x, t)).map(|(x, e)| (x, e, t)));
        if let Some((x, error, t)) = wrong {
            let place = place_text(&x) + &time_text(changes, t);
            let text = format!("material \"{}\" in patch \"{}\", at {place}: {error}", material.name.value, patch.name);
            let fault = builder
                .error("E053", text, key(material, &error))
                .with_help("formulas of materials are checked at the quadrature points of the patches that use them");
            builder.faults.push(fault);
        }
    }
}

/// Returns E017 if a formula is not finite at a quadrature point, at one of the times of the case.
fn finite<const S: usize, const N: usize, const D: usize>(
    builder: &Builder<'_, S, N>,
    space: &dyn Geometry<D, N>,
    rules: &dyn Quadrature<D>,
    formula: &Located<Formula>,
    what: &str,
) -> Result<(), Box<Diagnostic>> {
    let f = &formula.value;
    for &t in times(builder.case, f.depends_on_time()) {
        let value = |x: &Vector<N>| Some(f.value(&Point::new(x.as_slice()).at_time(t))).filter(|v| !v.is_finite());
        let found = match f.as_constant() {
            Some(_) => None,
            None => first_wrong(space, rules, &value),
        };
        if let Some((x, value)) = found {
            let place = place_text(&x) + &time_text(f.depends_on_time(), t);
            let text = format!("{what}: `{}` is not finite at {place} (found {value})", f.text());
            let help = "loads are integrated over the whole side or patch: give a formula that has a value at each of its points";
            return Err(Box::new(builder.error("E017", text, formula.at).with_help(help)));
        }
    }
    Ok(())
}

/// Returns E017 if the formula of a load on a side is not finite at a quadrature point.
pub(super) fn on_side<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    side: &SideModel<S, N>,
    formula: &Located<Formula>,
    what: &str,
) -> Result<(), Box<Diagnostic>> {
    finite(builder, &*side.trace.space, &side.rules, formula, &format!("{what} of `{}`", side.label))
}

/// Reports E017 for a source or a density under gravity that is not finite at a quadrature point of a patch.
pub(super) fn in_bodies<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Model<S, N>) {
    let case = builder.case;
    if model.exact.is_some() {
        // the source follows from the solution
        return;
    }
    for (patch, read) in model.patches.iter().zip(&case.patches) {
        let density = case.materials[read.material.value].density.iter().filter(|_| case.model.gravity.is_some());
        let sources = [&case.model.source, &read.source].into_iter().flatten().flat_map(|s| &s.value);
        for (formula, what) in sources.map(|f| (f, "source")).chain(density.map(|f| (f, "density"))) {
            let what = format!("{what} in patch \"{}\"", patch.name);
            if let Err(fault) = finite(builder, &**patch.body.space(), &patch.rules, formula, &what) {
                builder.faults.push(*fault);
            }
        }
    }
}
