//! Trace and multiplier spaces of slave sides, one pair per scalar problem, for the inf-sup test.

use super::builder::Problem;
use super::coupled::Multiplier;
use super::error::{ErrorKind, ProblemError, ProblemErrors};
use super::fixed::Eliminated;
use super::handles::Statement;
use super::interface_error::InterfaceError;
use super::model::{BodySide, Model};
use super::multipliers::wrapped;
use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::multiplier::{MultiplierError, side_ends};
use crate::geometry::MapTable;
use crate::linalg::Vector;
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
    /// As stated: supports and cross points.
    #[default]
    Stated,
    /// Traces vanish at both ends, multipliers are lowered there.
    Zero,
    /// Nothing is constrained.
    Free,
}

/// The spaces of one scalar problem on one slave side.
#[derive(Debug)]
pub struct SlaveSpace {
    /// The tie or contact.
    pub of: Statement,
    /// The slave side.
    pub side: Arc<BodySide<1, 2>>,
    /// The component of a tie; `None`: the normal of a contact.
    pub component: Option<usize>,
    /// Number of every function of the side in the trace space; `None` if it is constrained.
    pub functions: Vec<Option<usize>>,
    /// The multiplier space.
    pub multiplier: Box<dyn Basis<1>>,
}

/// A scalar problem on a slave side.
struct Wanted<'a> {
    of: Statement,
    name: &'a str,
    number: usize,
    multiplier: &'a Multiplier<1, 2>,
    component: Option<usize>,
}

impl Problem<1, 2> {
    /// The spaces of every slave side and component, ties first, those of couplings and methods without multipliers left out. No segments,
    /// no rows, no integrals over bodies.
    ///
    /// # Errors
    /// All that is wrong with bodies, sides and multipliers.
    pub fn slave_spaces(&self, ends: SlaveEnds) -> Result<Vec<SlaveSpace>, ProblemErrors> {
        let model = self.model(self.contacts.iter().map(|c| c.own.forces.len()).sum())?;
        let fixed = self.fixed(&model)?;
        let tied = self.memberships(&model);
        let (mut out, mut errors) = (Vec::new(), Vec::new());
        for tie in self.ties.iter().filter(|t| t.own.coupling.has_rows()) {
            for (number, pair) in tie.own.pairs.iter().enumerate() {
                let (slave, field) = (&pair.slave, model.patches[pair.slave.patch].field);
                let mut told: Vec<ProblemError> = Vec::new();
                for c in 0..model.components {
                    let held = |function: usize| fixed.is(field.unknown(function, c)) || tied.count(&model, slave.patch, function) > 1;
                    let wanted = Wanted { of: tie.id().into(), name: &tie.name, number, multiplier: &tie.multiplier, component: Some(c) };
                    match spaces(&model, slave, &wanted, ends, &held) {
                        Ok(spaces) => out.push(spaces),
                        // both components may have the same error
                        Err(error) if told.contains(&error) => {}
                        Err(error) => told.push(error),
                    }
                }
                errors.extend(told);
            }
        }
        for contact in self.contacts.iter().filter(|c| c.own.method.needs().multiplier) {
            for (number, slave) in contact.own.slaves.iter().enumerate() {
                let normals = normals(slave);
                let taken = |function: usize, c: usize| {
                    is_taken(&model, &fixed, slave, function, c) || tied.count(&model, slave.patch, function) > 0
                };
                let held = |function: usize| {
                    let along = |n: &Vector<2>| (0..model.components.min(2)).all(|c| n[c].abs() < PERPENDICULAR || taken(function, c));
                    normals.get(&function).is_some_and(along)
                };
                let (of, multiplier) = (contact.id().into(), &contact.multiplier);
                let wanted = Wanted { of, name: &contact.name, number, multiplier, component: None };
                match spaces(&model, slave, &wanted, ends, &held) {
                    Ok(spaces) => out.push(spaces),
                    Err(error) => errors.push(error),
                }
            }
        }
        if errors.is_empty() { Ok(out) } else { Err(ProblemErrors(errors)) }
    }
}

fn is_taken(model: &Model<1, 2>, fixed: &Eliminated, slave: &BodySide<1, 2>, function: usize, component: usize) -> bool {
    fixed.is(model.patches[slave.patch].field.unknown(function, component))
}

fn spaces(
    model: &Model<1, 2>,
    slave: &Arc<BodySide<1, 2>>,
    wanted: &Wanted<'_>,
    ends: SlaveEnds,
    held: &dyn Fn(usize) -> bool,
) -> Result<SlaveSpace, ProblemError> {
    let at_ends = if ends == SlaveEnds::Zero { end_functions(model, slave) } else { HashSet::new() };
    let constrained = |function: usize| match ends {
        SlaveEnds::Stated => held(function),
        SlaveEnds::Zero => at_ends.contains(&function),
        SlaveEnds::Free => false,
    };
    let make = |constrained: &dyn Fn(usize) -> bool| {
        wanted.multiplier.make(&slave.trace, constrained).map(|psi| wrapped(model, slave, constrained, psi))
    };
    let multiplier = match make(&constrained) {
        // too few elements to lower the multiplier: unlowered, it has more functions than the trace
        Err(MultiplierError::NothingLeft { .. }) => make(&|_| false),
        made => made,
    };
    let multiplier = multiplier.map_err(|error| {
        // the side is to blame, not a component
        let error = InterfaceError::Multiplier { component: None, error };
        let names = vec![wanted.name.to_owned(), slave.label.clone()];
        ProblemError::new(ErrorKind::Interface { slave: wanted.number, error }, vec![wanted.of], names)
    })?;
    let mut numbers = BTreeMap::new();
    let number = |&dof: &usize| {
        let next = numbers.len();
        (!constrained(dof)).then(|| *numbers.entry(model.function(slave.patch, dof)).or_insert(next))
    };
    let functions = slave.trace.dofs.iter().map(number).collect();
    Ok(SlaveSpace { of: wanted.of, side: slave.clone(), component: wanted.component, functions, multiplier })
}

/// Functions of the body that do not vanish at an end of the side; a side that closes on itself has no end.
fn end_functions(model: &Model<1, 2>, slave: &BodySide<1, 2>) -> HashSet<usize> {
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
fn normals(slave: &BodySide<1, 2>) -> HashMap<usize, Vector<2>> {
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
