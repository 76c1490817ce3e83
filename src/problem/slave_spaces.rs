//! Trace and multiplier spaces of slave sides, one pair per scalar problem, for the inf-sup test.

use super::builder::Problem;
use super::coupled::Multiplier;
use super::directions::normals;
use super::error::{ErrorKind, ProblemError, ProblemErrors};
use super::fixed::Eliminated;
use super::handles::Statement;
use super::interface_error::InterfaceError;
use super::interface_side::InterfaceSide;
use super::model::{BodySide, Model};
use super::multipliers::wrapped;
use super::smooth_pieces::places_of;
use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::multiplier::MultiplierError;
use crate::geometry::{Bounds, MapTable, Tree, cell};
use crate::linalg::Vector;
use crate::space::{Space, Trace};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;
/// Components of a unit normal below this count as zero.
const PERPENDICULAR: f64 = 1e-9;
/// Points nearer than this share of the size of a side are one.
const SAME_PLACE: f64 = 1e-9;

/// Constraints at the ends of slave sides, along the rims of those in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SlaveEnds {
    /// As stated: supports and cross points.
    #[default]
    Stated,
    /// Traces vanish at both ends, or along the whole rim, and multipliers are lowered there.
    Zero,
    /// Nothing is constrained.
    Free,
}

/// The spaces of one scalar problem on one slave side.
#[derive(Debug)]
pub struct SlaveSpace<const S: usize = 1, const N: usize = 2> {
    /// The tie or contact.
    pub of: Statement,
    /// The slave side.
    pub side: Arc<BodySide<S, N>>,
    /// The component of a tie; `None`: the normal of a contact.
    pub component: Option<usize>,
    /// Number of every function of the side in the trace space; `None` if it is constrained.
    pub functions: Vec<Option<usize>>,
    /// The multiplier space.
    pub multiplier: Box<dyn Basis<S>>,
}

/// A scalar problem on a slave side.
struct Wanted<'a, const S: usize, const N: usize> {
    of: Statement,
    name: &'a str,
    number: usize,
    multiplier: &'a Multiplier<S, N>,
    component: Option<usize>,
}

impl<const S: usize, const N: usize> Problem<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// The spaces of every slave side and component, ties first, those of couplings and methods without multipliers left out. No segments,
    /// no rows, no integrals over bodies.
    ///
    /// # Errors
    /// All that is wrong with bodies, sides and multipliers.
    pub fn slave_spaces(&self, ends: SlaveEnds) -> Result<Vec<SlaveSpace<S, N>>, ProblemErrors> {
        self.between_kinks(|problem| problem.spaces_of_slaves(ends))
    }

    fn spaces_of_slaves(&self, ends: SlaveEnds) -> Result<Vec<SlaveSpace<S, N>>, ProblemErrors> {
        let model = self.model(self.contacts.iter().map(|c| c.own.forces.len()).sum())?;
        let fixed = self.fixed(&model)?;
        let tied = self.memberships(&model);
        let (mut out, mut errors) = (Vec::new(), Vec::new());
        for tie in self.ties.iter().filter(|t| t.own.coupling.has_rows()) {
            for (number, pair) in places_of(tie.own.pairs.iter().map(|p| &p.slave)).into_iter().zip(&tie.own.pairs) {
                let (slave, field) = (&pair.slave, model.patches[pair.slave.patch].field);
                let mut told: Vec<ProblemError> = Vec::new();
                for c in 0..model.components {
                    let held = |function: usize| fixed.is(field.unknown(function, c)) || tied.count(&model, slave.patch, function) > 1;
                    let wanted = Wanted { of: tie.id().into(), name: &tie.name, number, multiplier: &tie.multiplier, component: Some(c) };
                    match spaces(&model, slave, &wanted, ends, &held) {
                        Ok(spaces) => out.push(spaces),
                        // components may have the same error
                        Err(error) if told.contains(&error) => {}
                        Err(error) => told.push(error),
                    }
                }
                errors.extend(told);
            }
        }
        let seams = self.seams(&model, &fixed);
        for contact in self.contacts.iter().filter(|c| c.own.method.needs().multiplier) {
            for (number, slave) in places_of(contact.own.slaves.iter()).into_iter().zip(&contact.own.slaves) {
                let normals = normals(slave);
                let taken = |function: usize, c: usize| {
                    is_taken(&model, &fixed, slave, function, c) || tied.count(&model, slave.patch, function) > 0
                };
                let held = |function: usize| {
                    let along = |n: &Vector<N>| (0..model.components.min(N)).all(|c| n[c].abs() < PERPENDICULAR || taken(function, c));
                    seams.hold(slave, model.function(slave.patch, function)) || normals.get(&function).is_some_and(along)
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

fn is_taken<const S: usize, const N: usize>(
    model: &Model<S, N>,
    fixed: &Eliminated,
    slave: &BodySide<S, N>,
    function: usize,
    component: usize,
) -> bool {
    fixed.is(model.patches[slave.patch].field.unknown(function, component))
}

fn spaces<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &Arc<BodySide<S, N>>,
    wanted: &Wanted<'_, S, N>,
    ends: SlaveEnds,
    held: &dyn Fn(usize) -> bool,
) -> Result<SlaveSpace<S, N>, ProblemError>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let at_ends = if ends == SlaveEnds::Zero { rim_functions(model, slave) } else { HashSet::new() };
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
        Err(MultiplierError::NothingLeft { .. } | MultiplierError::NothingLeftAtEdge { .. }) => make(&|_| false),
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

/// Functions of the body that do not vanish on the rim of the side, the ends of a curve; a side that closes on itself has none there.
fn rim_functions<const S: usize, const N: usize>(model: &Model<S, N>, slave: &BodySide<S, N>) -> HashSet<usize> {
    let (space, dofs) = (&*slave.trace.space, &slave.trace.dofs);
    let mut count: HashMap<usize, usize> = HashMap::new();
    dofs.iter().for_each(|&dof| *count.entry(model.function(slave.patch, dof)).or_default() += 1);
    let (mut ids, mut table, mut found) = (Vec::new(), ShapeTable::new(), HashSet::new());
    for (element, ends) in rim(space) {
        // a polynomial that is not zero along an edge has fewer zeros there than points
        let n = space.degree(element).into_iter().max().unwrap_or(1) + 1;
        let points: Vec<Vector<S>> = (0..=n).map(|k| ends[0] + (ends[1] - ends[0]) * (k as f64 / n as f64)).collect();
        space.active(element, &mut ids);
        space.tabulate(element, &points, Order::Values, &mut table);
        for q in 0..points.len() {
            let there = ids.iter().zip(table.values(q)).filter(|(_, v)| v.abs() > NO_VALUE).map(|(&i, _)| dofs[i]);
            found.extend(there.filter(|&dof| count[&model.function(slave.patch, dof)] == 1));
        }
    }
    found
}

/// The faces of elements that no other element has, with their first and last corner in local coordinates: by corner ids, by their places
/// where those are unknown.
fn rim<const S: usize, const N: usize>(space: &dyn Space<S, N>) -> Vec<(usize, [Vector<S>; 2])> {
    let (mut all, mut places, mut ids, mut map) = (Vec::new(), Vec::new(), Vec::new(), MapTable::new());
    for element in 0..space.num_elements() {
        let kind = space.cell(element);
        let (corners, faces) = (cell::corners::<S, f64>(kind), cell::faces::<S, f64>(kind));
        space.corners(element, &mut ids);
        space.map(element, &faces.iter().map(|f| f.center).collect::<Vec<_>>(), Order::Values, &mut map);
        for (face, x) in faces.iter().zip(&map.x) {
            let mut key: Vec<usize> = if ids.is_empty() { Vec::new() } else { face.corners.iter().map(|&c| ids[c]).collect() };
            key.sort_unstable();
            all.push((key, element, [0, face.corners.len() - 1].map(|k| corners[face.corners[k]])));
            places.push(*x);
        }
    }
    let mut times: HashMap<Vec<usize>, usize> = HashMap::new();
    all.iter().for_each(|(key, ..)| *times.entry(key.clone()).or_default() += 1);
    let tree = Tree::new(places.iter().map(|x| Bounds { lo: *x, hi: *x }).collect());
    let near = tree.bounds().map_or(0.0, |b| b.diagonal()) * SAME_PLACE;
    let alone = |k: usize| tree.meeting(&Bounds { lo: places[k], hi: places[k] }.inflated(near)).len() == 1;
    let is_rim = |(k, key): (usize, &Vec<usize>)| if key.is_empty() { alone(k) } else { times[key] == 1 };
    let kept = all.iter().enumerate().filter(|(k, (key, ..))| is_rim((*k, key)));
    kept.map(|(_, (_, element, ends))| (*element, *ends)).collect()
}
