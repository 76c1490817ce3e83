//! Boundary conditions and loads of the case.

use super::builder::Builder;
use super::built::Built;
use super::couples::Couples;
use super::exact::needs_exact;
use super::rims;
use super::sides::Sides;
use super::values::on_side;
use crate::case::{Boundary, Datum};
use crate::errors::Diagnostic;
use crate::formula::{Formula, Point};
use crate::place::{Located, Place};
use crate::words::{component_name, short};
use faying::assembly::{Equation, Halved, HalvedScratch, measure, planar_normal};
use faying::linalg::{Matrix, Vector};
use faying::problem::{Action, Condition, Model, PatchModel, RigidSides, SideLoad, SideModel, SideSpring, Value};
use std::sync::Arc;

/// Components of a unit normal below this count as zero.
const PERPENDICULAR: f64 = 1e-9;
/// Share by which the facets that `where` keeps may differ from the part in which it holds.
const CUT: f64 = 1e-3;

/// Adds the conditions, loads, springs and equations of all boundary blocks to `model`; errors go to the builder's faults.
pub(super) fn build<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    model: &mut Built<S, N>,
    sides: &mut Sides<S, N>,
    couples: &Couples<S, N>,
) {
    for k in 0..builder.case.boundaries.len() {
        let block = &builder.case.boundaries[k];
        let mut on = Vec::with_capacity(block.on.len());
        for wanted in &block.on {
            // sides coupled to another side are not outer sides
            if block.all_outer && couples.hold(wanted.value.patch, &wanted.value.side) {
                continue;
            }
            if let Some(names) = rims::sides(&wanted.value.side) {
                if let Err(fault) = rims::pin(builder, model, sides, block, wanted, &names) {
                    builder.faults.push(*fault);
                }
                continue;
            }
            let side = match &block.filter {
                Some(filter) => sides.filtered(builder, &model.patches, wanted, filter),
                None => sides.get(builder, &model.patches, wanted).map(Some),
            };
            match side {
                Ok(side) => on.extend(side),
                Err(fault) => builder.faults.push(*fault),
            }
        }
        if let Some(filter) = block.filter.as_ref().filter(|_| !on.is_empty()) {
            let cut = cut_facets(builder, &model.patches, sides, block, filter, &on);
            builder.faults.items.extend(cut);
        }
        for side in &on {
            if let Err(fault) = one(builder, model, block, side) {
                builder.faults.push(*fault);
            }
        }
        if let Err(fault) = resultants(builder, model, block, &on) {
            builder.faults.push(*fault);
        }
        if let (true, false, true, Some(filter)) = (on.is_empty(), block.on.is_empty(), !builder.faults.has_errors(), &block.filter) {
            let text = format!("no facet of the sides of \"{}\" has its centre where `{}` holds", block.name.value, filter.value.text());
            let fault = builder.error("E015", text, filter.at).with_help("`where` keeps whole facets; a finer mesh has smaller ones");
            builder.faults.push(fault);
        }
    }
    duplicates(builder, model);
}

/// Warns of a `where` whose border lies inside of facets, which are kept or left whole.
fn cut_facets<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    block: &Boundary,
    filter: &Located<Formula>,
    kept: &[Arc<SideModel<S, N>>],
) -> Option<Diagnostic> {
    let kept: f64 = kept.iter().map(|side| measure(&*side.trace.space, &side.rules)).sum();
    let mut scratch = HalvedScratch::default();
    let holds = |x: &Vector<N>, _: &Matrix<N, S>| [f64::from(u8::from(filter.value.value(&Point::new(x.as_slice())) != 0.0))];
    let mut exact = 0.0;
    for wanted in block.on.iter().filter(|side| rims::sides(&side.value.side).is_none()) {
        let Ok(whole) = sides.get(builder, patches, wanted) else { continue };
        let halved = Halved::new(&*whole.trace.space, whole.degree() + 1, 1);
        exact += (0..whole.trace.space.num_elements()).map(|e| halved.element(e, &mut scratch, &holds)[0]).sum::<f64>();
    }
    let off = (kept - exact).abs() / kept.max(exact);
    (off > CUT).then(|| {
        let what = if N == 2 { "length" } else { "area" };
        let text = format!(
            "`where` of \"{}\" cuts facets, which it keeps or leaves whole: a {what} of {} for the {} in which `{}` holds",
            block.name.value,
            short(kept),
            short(exact),
            filter.value.text()
        );
        let help = "let the border of `where` lie on edges of elements: give breakpoints there, or refine the mesh";
        builder.warning("E017", text, filter.at).with_help(help)
    })
}

fn one<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &mut Built<S, N>,
    block: &Boundary,
    side: &Arc<SideModel<S, N>>,
) -> Result<(), Box<Diagnostic>> {
    let supports = model.conditions.len() + model.equations.len();
    for (component, datum) in block.dirichlet.iter().enumerate() {
        let Some(datum) = datum else { continue };
        let value = match &datum.value {
            Datum::Exact => Value::Exact,
            Datum::Formula(f) if f.as_constant() == Some(0.0) => Value::Zero,
            Datum::Formula(f) => Value::Data(f.clone().into()),
        };
        if matches!(value, Value::Exact) {
            needs_exact(builder, model, datum.at)?;
        }
        model.condition(Condition { side: side.clone(), component, value }, datum.at);
    }
    if let Some(at) = block.fix_normal.as_ref().map(|f| f.at) {
        sliding(builder, model, side, at, true)?;
    }
    if let Some(at) = block.fix_tangential.as_ref().map(|f| f.at) {
        sliding(builder, model, side, at, false)?;
    }
    for (component, datum) in block.traction.iter().enumerate() {
        let Some(datum) = datum else { continue };
        let action = match &datum.value {
            Datum::Exact => {
                needs_exact(builder, model, datum.at)?;
                Action::Exact(component)
            }
            Datum::Formula(f) => {
                on_side(builder, side, &Located::new(f.clone(), datum.at), "the traction")?;
                Action::Traction(component, f.clone().into())
            }
        };
        model.loads.push(SideLoad { name: block.name.value.clone(), side: side.clone(), action });
    }
    if let Some(p) = &block.pressure {
        on_side(builder, side, p, "the pressure")?;
        let action = Action::Pressure(p.value.clone().into());
        model.loads.push(SideLoad { name: block.name.value.clone(), side: side.clone(), action });
    }
    for (component, f) in each(&block.spring) {
        on_side(builder, side, f, "the spring")?;
        let name = block.name.value.clone();
        model.springs.push(SideSpring { name, side: side.clone(), component, stiffness: f.value.clone().into() });
    }
    if model.conditions.len() + model.equations.len() > supports {
        supported(model, side);
    }
    Ok(())
}

/// Adds a side to the supports unless it is already there.
fn supported<const S: usize, const N: usize>(model: &mut Model<S, N>, side: &Arc<SideModel<S, N>>) {
    if !model.supports.iter().any(|s| Arc::ptr_eq(s, side)) {
        model.supports.push(side.clone());
    }
}

/// Adds the resultants, spread evenly over all sides of the block, and the sides that move as one.
fn resultants<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &mut Model<S, N>,
    block: &Boundary,
    sides: &[Arc<SideModel<S, N>>],
) -> Result<(), Box<Diagnostic>> {
    let area = || sides.iter().map(|side| measure(&*side.trace.space, &side.rules)).sum::<f64>();
    for (list, what) in [(&block.force, "the force"), (&block.rigid_force, "the rigid force")] {
        for (component, f) in each(list) {
            let area = area();
            for side in sides {
                on_side(builder, side, f, what)?;
                let action = Action::Force(component, f.value.clone().into(), area);
                model.loads.push(SideLoad { name: block.name.value.clone(), side: side.clone(), action });
            }
        }
    }
    for (component, _) in each(&block.rigid_force) {
        // functions of a side sum to one: equal coefficients are a constant
        let mut unknowns: Vec<usize> = Vec::new();
        for side in sides {
            let field = model.patches[side.patch].field;
            unknowns.extend(side.trace.dofs.iter().map(|&dof| field.unknown(dof, component)));
        }
        unknowns.sort_unstable();
        unknowns.dedup();
        let Some((&first, rest)) = unknowns.split_first() else { continue };
        model.equations.extend(rest.iter().map(|&i| Equation { terms: vec![(i, 1.0), (first, -1.0)], value: 0.0 }));
        model.rigid_sides.push(RigidSides { sides: sides.to_vec(), component });
        for side in sides {
            supported(model, side);
            model.held.push((side.clone(), Vector::from_fn(|k, _| f64::from(u8::from(k == component)))));
        }
    }
    Ok(())
}

fn each(list: &[Option<Located<Formula>>]) -> impl Iterator<Item = (usize, &Located<Formula>)> {
    list.iter().enumerate().filter_map(|(k, f)| f.as_ref().map(|f| (k, f)))
}

/// Adds n . u = 0, or u - (n . u) n = 0, on a planar side: as conditions along an axis, else as equations.
fn sliding<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &mut Built<S, N>,
    side: &Arc<SideModel<S, N>>,
    at: Place,
    along_normal: bool,
) -> Result<(), Box<Diagnostic>> {
    let word = if along_normal { "normal" } else { "tangential" };
    let Some(normal) = planar_normal(&side.trace) else {
        let text = format!("fix = [\"{word}\"] needs a planar side; `{}` is curved", side.label);
        return Err(Box::new(builder.error("E015", text, at).with_help("prescribe components x, y on curved sides")));
    };
    if let Some(axis) = (0..N).find(|&k| (normal[k].abs() - 1.0).abs() < PERPENDICULAR) {
        for component in (0..N).filter(|&c| (c == axis) == along_normal) {
            model.condition(Condition { side: side.clone(), component, value: Value::Zero }, at);
        }
        return Ok(());
    }
    let directions: Vec<Vector<N>> = if along_normal { vec![normal] } else { tangents(&normal) };
    model.held.extend(directions.iter().map(|d| (side.clone(), *d)));
    let field = model.patches[side.patch].field;
    let mut dofs = side.trace.dofs.clone();
    dofs.sort_unstable();
    dofs.dedup();
    for dof in dofs {
        for d in &directions {
            let terms = (0..N).filter(|&c| d[c].abs() > PERPENDICULAR).map(|c| (field.unknown(dof, c), d[c])).collect();
            model.equations.push(Equation { terms, value: 0.0 });
        }
    }
    Ok(())
}

/// Unit vectors perpendicular to `normal` and to each other.
fn tangents<const N: usize>(normal: &Vector<N>) -> Vec<Vector<N>> {
    let mut basis: Vec<Vector<N>> = vec![*normal];
    for k in 0..N {
        let mut v = Vector::<N>::from_fn(|i, _| f64::from(u8::from(i == k)));
        for b in &basis {
            v -= b * b.dot(&v);
        }
        if v.norm() > 0.1 && basis.len() < N {
            basis.push(v / v.norm());
        }
    }
    basis.split_off(1)
}

/// A component of a side is prescribed once, and has no traction then.
fn duplicates<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Built<S, N>) {
    for (k, b) in model.conditions.iter().enumerate() {
        let twin = model.conditions[..k].iter().position(|a| Arc::ptr_eq(&a.side, &b.side) && a.component == b.component);
        if let Some(first) = twin {
            let name = component_name(b.component, model.components);
            let line = model.sources.of(first).in_file().map_or(String::new(), |(line, _)| format!(", first in line {line}"));
            let text = format!("component {name} of `{}` is prescribed twice{line}", b.side.label);
            let fault = builder.error("E052", text, model.sources.of(k)).with_help("drop one of the two");
            builder.faults.push(fault);
        }
    }
}
