//! Bodies: the net of a patch, its elements, its space, its material.

use super::lower_context::LowerContext;
use super::materials::material as material_at;
use super::places::{Places, Said};
use crate::case::{self, Patch};
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::registry::Fault;
use crate::shapes::MakeControlNet;
use faying::physics::Assumption;
use faying::problem::{BodyMaterial, BodySpec, Changing, Physics, Problem, ProblemError};
use faying::space::{Body, Dimension, PatchSpec, Trace, divided};
use std::sync::Arc;

/// Says all bodies of the case, with their sources, weights and foundations; errors go to the context's faults.
pub(super) fn say<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    net: MakeControlNet<N>,
    problem: &mut Problem<S, N>,
    places: &mut Places,
) where
    Trace<S, N>: Dimension<S, N>,
{
    for k in 0..context.case.patches.len() {
        if let Err(fault) = one(context, k, net, problem, places) {
            context.faults.push(*fault);
        }
    }
}

fn one<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    number: usize,
    net: MakeControlNet<N>,
    problem: &mut Problem<S, N>,
    places: &mut Places,
) -> Result<(), Box<Diagnostic>>
where
    Trace<S, N>: Dimension<S, N>,
{
    let case = context.case;
    let patch = &case.patches[number];
    let backend = &patch.discretization.backend;
    let spec = specification(context, patch, net)?;
    let body = match &spec {
        Some(spec) => of_spec(context, patch, spec, backend)?,
        None => super::meshes::body(context, patch)?,
    };
    let material = &case.materials[patch.material.value];
    let assumption = case.model.assumption.value;
    let first_time = case.times(false)[0];
    let law = match &material.law {
        Some(law) => of_law(context, &material.name.value, law)?,
        None => {
            let refused = |e| context.error("E053", format!("material \"{}\": {e}", material.name.value), material.place_of(&e));
            let first = material_at(material, assumption, first_time).map_err(refused)?;
            if material.changes() { BodyMaterial::Changing(changing(material, assumption)) } else { BodyMaterial::Constant(first) }
        }
    };
    let spec = BodySpec {
        extra_points: patch.discretization.extra_points.value,
        unrefined: super::meshes::unrefined(patch).map(Arc::from),
        is_shaped: spec.is_some(),
        side_names: Some(super::sides::names(case, number)),
        backend: backend.value.clone(),
        ..BodySpec::new(&patch.name.value, body.into(), law)
    };
    let refused = |at| move |error: ProblemError| Box::new(context.error("E015", error.to_string(), at));
    let id = problem.add(spec).map_err(refused(patch.head.at))?;
    places.bodies.push(id);
    places.keep(id.into(), Said { at: patch.head.at, ..Said::default() });
    for source in [&case.model.source, &patch.source].into_iter().flatten() {
        let said = problem.source(id, source.value.iter().map(|f| f.value.clone().into()).collect()).map_err(refused(source.at))?;
        places.keep(said, Said { at: source.at, what: "source", formulas: source.value.clone(), ..Said::default() });
    }
    for (component, f) in [&case.model.foundation, &patch.foundation].into_iter().flat_map(|all| all.iter().enumerate()) {
        let Some(f) = f else { continue };
        let said = problem.foundation(id, component, f.value.clone()).map_err(refused(f.at))?;
        let what = if case.model.components() == 1 { "reaction" } else { "foundation" };
        places.keep(said, Said { at: f.at, what, formulas: vec![f.clone()], ..Said::default() });
    }
    let gravity = [&case.model.gravity, &patch.gravity].into_iter().flatten();
    let sum = gravity.fold(None, |sum: Option<[f64; N]>, g| Some(std::array::from_fn(|k| sum.map_or(g.value[k], |s| s[k] + g.value[k]))));
    if let (Some(density), Some(g)) = (&material.density, sum) {
        let said = problem.gravity(id, density.value.clone(), g).map_err(refused(density.at))?;
        places.keep(said, Said { at: density.at, what: "density", formulas: vec![density.clone()], ..Said::default() });
    }
    Ok(())
}

/// A material of the case as a function of time, its constants checked at the first one.
fn changing<const N: usize>(material: &case::Material, assumption: Assumption) -> Changing<Physics<N>> {
    let material = material.clone();
    Changing(Arc::new(move |t| material_at(&material, assumption, t).expect("constants were checked when the first one was made")))
}

/// A material of the registry, made for all times of the case.
fn of_law<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    material: &str,
    law: &Located<case::Law>,
) -> Result<BodyMaterial<N>, Box<Diagnostic>> {
    let entry = context.names.materials.get(&law.name).map_err(|e| context.error("E015", e.to_string(), law.at))?;
    let refused = |fault: Fault| {
        let at = law.given.at(fault.key).unwrap_or(law.at);
        Box::new(context.error(fault.code, format!("material \"{material}\": {}", fault.message), at))
    };
    let changes = law.given.depends_on_time();
    let mut first = None;
    for &t in context.case.times(changes) {
        let made = (entry.make)(&law.given, t).map_err(refused)?;
        let (found, wanted) = (made.components(), context.case.model.components());
        if found != wanted {
            let text = format!("law \"{}\" has {found} components of the unknown, the physics has {wanted}", law.name);
            return Err(refused(Fault::new("E015", text)));
        }
        first.get_or_insert(made);
    }
    let (make, given) = (Arc::clone(&entry.make), law.given.clone());
    if changes {
        return Ok(BodyMaterial::changing(move |t| make(&given, t).expect("it was made at all times of the case")));
    }
    Ok(BodyMaterial::Constant(first.expect("a case has a time")))
}

/// The body of a specification.
fn of_spec<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    patch: &Patch,
    spec: &PatchSpec<N>,
    backend: &Located<String>,
) -> Result<Box<dyn Body<S, N>>, Box<Diagnostic>> {
    let name = &patch.name.value;
    let make = context.names.backends.get(&backend.value).map_err(|e| context.error("E015", e.to_string(), backend.at))?;
    make(spec).map_err(|fault| {
        let at = match fault.code {
            "E041" => patch.geometry.at,
            _ if fault.key == "elements" => patch.elements.at,
            _ => patch.discretization.degree.at,
        };
        Box::new(context.error(fault.code, format!("patch \"{name}\": {}", fault.message), at))
    })
}

/// Returns the specification of a patch for a backend; `None` for meshes that are read from files.
pub(crate) fn specification<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    patch: &Patch,
    net: MakeControlNet<N>,
) -> Result<Option<PatchSpec<N>>, Box<Diagnostic>> {
    if patch.geometry.shape.mesh_part().is_some() {
        return Ok(None);
    }
    let name = &patch.name.value;
    let net = net(&patch.geometry.value)
        .map_err(|fault| context.error(fault.code, format!("geometry of patch \"{name}\": {fault}"), patch.geometry.at))?;
    let d = &patch.discretization;
    let mut lists: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for (k, list) in lists.iter_mut().enumerate() {
        let own = net.axes[k].breakpoints();
        let grading = patch.grade.as_ref().and_then(|g| g.value.get(k).copied().flatten());
        let divisions = &patch.elements.value[k];
        *list = divided(own, &divisions.value, grading, patch.refine.value)
            .map_err(|e| context.error("E015", format!("elements of patch \"{name}\": {e}"), divisions.at))?;
    }
    let mut spec = PatchSpec::new(net).with_breakpoints(lists);
    spec.degree = std::array::from_fn(|k| d.degree.value[k.min(d.degree.value.len() - 1)]);
    spec.continuity = d.continuity.value;
    (spec.basis, spec.cells, spec.mapping) = (d.basis.value, d.cells.value, d.mapping.value);
    Ok(Some(spec))
}
