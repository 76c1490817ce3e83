//! Trace and multiplier spaces of slave sides, one pair per scalar problem, for the inf-sup test.

use super::bodies::supported;
use super::builder::{Builder, MakeNet};
use super::fixed::fixed;
use super::multipliers::{multiplier, multiplier_fault};
use super::patches;
use super::ties::{coupling_of, list, memberships};
use crate::case::{Case, Multiplier};
use crate::errors::{Diagnostic, Diagnostics};
use crate::place::Located;
use crate::registry::{Names, is_glue};
use crate::words::component_name;
use faying::basis::{Basis, Order, ShapeTable};
use faying::coupling::multiplier::{MultiplierKind, side_ends};
use faying::geometry::MapTable;
use faying::linalg::Vector;
use faying::problem::{Model, SideModel, wrapped};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;
/// Components of a unit normal below this count as zero.
const PERPENDICULAR: f64 = 1e-9;

/// Constraints at the ends of slave sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SlaveEnds {
    /// As the case has them: supports and cross points.
    #[default]
    Case,
    /// Traces vanish at both ends, multipliers are lowered there.
    Zero,
    /// Nothing is constrained.
    Free,
}

/// The spaces of one scalar problem on one slave side.
#[derive(Debug)]
pub struct SlaveSpaces {
    /// The interface or contact.
    pub name: String,
    /// The slave side as the case has it.
    pub side: Arc<SideModel<1, 2>>,
    /// Component: "x", "y", "u"; "normal" for contacts.
    pub component: &'static str,
    /// Name of the multiplier, with `auto` resolved; `None` if it is given by data.
    pub pairing: Option<String>,
    /// Number of every function of the side in the trace space; `None` if it is constrained.
    pub functions: Vec<Option<usize>>,
    /// The multiplier space.
    pub multiplier: Box<dyn Basis<1>>,
    /// Lengths of the elements in the parameter of the side, as fractions of the whole; equal if it has no parameter.
    pub shares: Vec<f64>,
}

/// Builds the spaces of every slave side and component of `case`, in its order. No segments, no rows, no bulk integrals.
///
/// # Errors
/// All errors of the bodies, sides and multipliers, with their source locations.
pub fn slave_spaces(case: &Case, names: &Names<1, 2>, net: MakeNet<2>, ends: SlaveEnds) -> Result<Vec<SlaveSpaces>, Diagnostics> {
    let mut builder = Builder { case, names, faults: Diagnostics::new() };
    let (model, mut sides, couples) = supported(&mut builder, net)?;
    let fixed = fixed(&builder, &model).map_err(|fault| Diagnostics::from(*fault))?;
    let tied = memberships(&builder, &model, &couples);
    let mut out = Vec::new();
    let mut faults = Diagnostics::new();
    for (tie, couples) in case.interfaces.iter().zip(&couples.ties).filter(|(tie, _)| !is_glue(&tie.coupling.value)) {
        match coupling_of(&builder, tie) {
            Ok(coupling) if coupling.has_rows() => {}
            Ok(_) => continue,
            Err(fault) => {
                faults.push(*fault);
                continue;
            }
        }
        for couple in couples {
            let slave = &couple.slave;
            let field = model.patches[slave.patch].field;
            for c in 0..model.components {
                let held = |function: usize| fixed.is(field.unknown(function, c)) || tied.count(&model, slave.patch, function) > 1;
                let wanted = Wanted { name: &tie.name.value, multiplier: &tie.multiplier, component: component_name(c, model.components) };
                match spaces(&builder, &model, slave, &wanted, ends, &held, net) {
                    Ok(spaces) => out.push(spaces),
                    // both components may have the same error
                    Err(fault) if faults.items.contains(&fault) => {}
                    Err(fault) => faults.push(*fault),
                }
            }
        }
    }
    for contact in case.contacts.iter().filter(|c| c.method.value.has_multiplier()) {
        for slave in &list(&mut builder, &model, &mut sides, &contact.slave) {
            let field = model.patches[slave.patch].field;
            let normals = normals(slave);
            let held = |function: usize| {
                let taken = |c: usize| fixed.is(field.unknown(function, c)) || tied.count(&model, slave.patch, function) > 0;
                normals.get(&function).is_some_and(|n| (0..model.components.min(2)).all(|c| n[c].abs() < PERPENDICULAR || taken(c)))
            };
            let wanted = Wanted { name: &contact.name.value, multiplier: &contact.multiplier, component: "normal" };
            match spaces(&builder, &model, slave, &wanted, ends, &held, net) {
                Ok(spaces) => out.push(spaces),
                Err(fault) => faults.push(*fault),
            }
        }
    }
    builder.stop()?;
    if faults.has_errors() { Err(faults) } else { Ok(out) }
}

/// Multiplier requested on a side: name of the interface, space, component.
struct Wanted<'a> {
    name: &'a str,
    multiplier: &'a Located<Multiplier>,
    component: &'static str,
}

fn spaces(
    builder: &Builder<'_, 1, 2>,
    model: &Model<1, 2>,
    slave: &Arc<SideModel<1, 2>>,
    wanted: &Wanted<'_>,
    ends: SlaveEnds,
    held: &dyn Fn(usize) -> bool,
    net: MakeNet<2>,
) -> Result<SlaveSpaces, Box<Diagnostic>> {
    let at_ends = if ends == SlaveEnds::Zero { end_functions(model, slave) } else { HashSet::new() };
    let constrained = |function: usize| match ends {
        SlaveEnds::Case => held(function),
        SlaveEnds::Zero => at_ends.contains(&function),
        SlaveEnds::Free => false,
    };
    let maker = multiplier(builder, wanted.multiplier)?;
    let make = |constrained: &dyn Fn(usize) -> bool| {
        let made = maker(&slave.trace, constrained).map(|psi| wrapped(model, slave, constrained, psi));
        made.map_err(|e| Box::new(multiplier_fault(builder, wanted.name, slave, &e, wanted.multiplier.at, 2)))
    };
    let multiplier = match make(&constrained) {
        // too few elements to lower the multiplier: unlowered, it has more functions than the trace
        Err(fault) if fault.code == "E024" => make(&|_| false)?,
        made => made?,
    };
    let pairing = match &wanted.multiplier.value {
        Multiplier::Named(word) => {
            let kind = word.parse::<MultiplierKind>().map(|kind| kind.resolved(&*slave.trace.space).to_string());
            Some(kind.unwrap_or_else(|_| word.clone()))
        }
        _ => None,
    };
    let mut numbers = BTreeMap::new();
    let functions: Vec<Option<usize>> = slave
        .trace
        .dofs
        .iter()
        .map(|&dof| {
            let next = numbers.len();
            (!constrained(dof)).then(|| *numbers.entry(model.function(slave.patch, dof)).or_insert(next))
        })
        .collect();
    let n = slave.trace.space.num_elements();
    let shares =
        patches::shares(builder, slave.patch, &slave.side, net).filter(|s| s.len() == n).unwrap_or_else(|| vec![1.0 / n as f64; n]);
    let (name, component) = (wanted.name.to_owned(), wanted.component);
    Ok(SlaveSpaces { name, side: slave.clone(), component, pairing, functions, multiplier, shares })
}

/// Functions of the body that do not vanish at an end of the side; a side that closes on itself has no end.
fn end_functions(model: &Model<1, 2>, slave: &SideModel<1, 2>) -> HashSet<usize> {
    let (space, dofs) = (&*slave.trace.space, &slave.trace.dofs);
    let mut count: HashMap<usize, usize> = HashMap::new();
    dofs.iter().for_each(|&dof| *count.entry(model.function(slave.patch, dof)).or_default() += 1);
    let (mut ids, mut table, mut found) = (Vec::new(), ShapeTable::new(), HashSet::new());
    for end in side_ends(space) {
        space.active(end.element, &mut ids);
        space.tabulate(end.element, &[Vector::<1>::new(end.at as f64)], Order::Values, &mut table);
        let there = ids.iter().zip(table.values(0)).filter(|(_, v)| v.abs() > NO_VALUE).map(|(&i, _)| dofs[i]);
        found.extend(there.filter(|&dof| count[&model.function(slave.patch, dof)] == 1));
    }
    found
}

/// Unit normal of the side at the point where each function of the body is largest, among some points of every element.
fn normals(slave: &SideModel<1, 2>) -> HashMap<usize, Vector<2>> {
    let space = &*slave.trace.space;
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let mut best: HashMap<usize, (f64, Vector<2>)> = HashMap::new();
    for e in 0..space.num_elements() {
        let n = space.degree(e)[0] + 1;
        let points: Vec<Vector<1>> = (0..=n).map(|k| Vector::<1>::new(k as f64 / n as f64)).collect();
        space.active(e, &mut ids);
        space.tabulate(e, &points, Order::Values, &mut shapes);
        space.map(e, &points, Order::Gradients, &mut map);
        for (q, jacobian) in map.jacobian.iter().enumerate() {
            let normal = slave.trace.normal(e, jacobian);
            for (&i, value) in ids.iter().zip(shapes.values(q)) {
                let entry = best.entry(slave.trace.dofs[i]).or_insert((0.0, normal));
                if value.abs() > entry.0 {
                    *entry = (value.abs(), normal);
                }
            }
        }
    }
    best.into_iter().map(|(dof, (_, normal))| (dof, normal)).collect()
}
