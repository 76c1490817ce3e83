//! Contacts: multiplier space, opponent and constraint rows of each slave side.

use super::couples::Couples;
use super::fixed::Fixed;
use super::meant::{meant, overlap};
use super::multipliers::{has_lowered, held_help, multiplier, multiplier_fault, positive_help, wrapped};
use super::obstacles::{num_pressed, obstacle, turned_away};
use super::sides::{Sides, as_one};
use super::ties::{FINER_POINTS, degree, labels, list, memberships, nitsche_variant};
use super::values::times;
use super::{Builder, Built};
use crate::case::{self, Cone, Integration, Master, Method};
use crate::errors::{Diagnostic, Severity};
use crate::place::Place;
use crate::registry::MASTER_SUMS;
use faying::assembly::gauss_rules;
use faying::basis::Basis;
use faying::constraint::Proximal;
use faying::contact::{self, ContactError, Frames};
use faying::coupling::consistency::Finer;
use faying::coupling::interface::{Partners, slave_segments};
use faying::coupling::multiplier::MultiplierError;
use faying::coupling::{Interface, Nitsche, Penalty, Segments, Side};
use faying::linalg::Vector;
use faying::problem::{Against, ContactModel, ContactPart, Formulation, Model, PointSides, SideModel, directions, rows, slides};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Components of a unit vector below this count as zero.
const PERPENDICULAR: f64 = 1e-9;

/// Builds all contacts of the case; errors go to the builder's faults.
pub(super) fn build<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    model: &mut Built<S, N>,
    sides: &mut Sides<S, N>,
    couples: &Couples<S, N>,
    fixed: &Fixed,
) {
    if builder.case.contacts.is_empty() {
        return;
    }
    let tied = memberships(builder, model, couples);
    let case = builder.case;
    let seams = seams(builder, model, sides);
    let mut next_unknown = model.unknowns - num_pressed(case);
    for contact in &case.contacts {
        if let Err(fault) = known(builder, contact, model) {
            builder.faults.push(*fault);
            continue;
        }
        let slaves = list(builder, model, sides, &contact.slave);
        let masters = match &contact.master {
            Master::Sides(wanted) => list(builder, model, sides, wanted),
            _ => Vec::new(),
        };
        let obstacle = match obstacle(builder, contact, next_unknown) {
            Ok(obstacle) => obstacle,
            Err(fault) => {
                builder.faults.push(*fault);
                continue;
            }
        };
        next_unknown += obstacle.as_ref().map_or(0, |o| o.pressed.len());
        let mut built = ContactModel {
            name: contact.name.value.clone(),
            parts: Vec::new(),
            obstacle,
            gap: contact.gap.value.clone().into(),
            reach: contact.reach.value,
            exact: contact.exact.as_ref().map(|f| f.value.clone().into()),
            symmetry: contact.symmetry.value,
            start: contact.active_set.start.value,
            formulation: formulation(contact),
        };
        let mut behind = Vec::new();
        for (k, slave) in slaves.iter().enumerate() {
            let at = contact.slave.get(k).map_or(contact.head.at, |s| s.at);
            let taken = |function: usize, component: usize| {
                fixed.is(model.patches[slave.patch].field.unknown(function, component)) || tied.count(model, slave.patch, function) > 0
            };
            let on_seam = |function: usize| seams.contains(&model.function(slave.patch, function));
            match part(builder, model, contact, &built, slave, &masters, at, &taken, &on_seam) {
                Ok((part, warning)) => {
                    model.rows += part.num_rows;
                    built.parts.push(part);
                    if let Some(warning) = warning {
                        builder.faults.push(warning);
                    }
                }
                // a slave side that faces nothing is only a warning if another side of the list faces the opponent
                Err(Missed::Nothing(fault)) => behind.push(*fault),
                Err(Missed::Fault(fault)) => builder.faults.push(*fault),
            }
        }
        if let Some(fault) = built.parts.iter().find_map(|part| overlap(builder, model, &built, part, contact)) {
            builder.faults.push(fault);
        }
        for mut fault in behind {
            if !built.parts.is_empty() {
                fault.severity = Severity::Warning;
                fault.help = Some("leave the side out of `slave`".into());
            }
            builder.faults.push(fault);
        }
        model.contacts.push(built);
    }
}

/// Returns the functions of the model that slave sides of different patches share.
fn seams<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Model<S, N>, sides: &mut Sides<S, N>) -> HashSet<usize> {
    let (mut first, mut shared) = (HashMap::new(), HashSet::new());
    if model.glued.is_empty() {
        return shared;
    }
    let case = builder.case;
    for slave in case.contacts.iter().flat_map(|c| &c.slave) {
        // errors of a side are reported when its contact is built
        let Ok(side) = sides.get(builder, &model.patches, slave) else { continue };
        for &dof in &side.trace.dofs {
            let function = model.function(side.patch, dof);
            if *first.entry(function).or_insert(side.patch) != side.patch {
                shared.insert(function);
            }
        }
    }
    shared
}

/// Returns the enforcement method of the contact, with automatic factors where the case gives none.
fn formulation(contact: &case::Contact) -> Formulation {
    let factor = contact.factor.value;
    match contact.method.value {
        Method::Penalty => Formulation::Penalty { factor: factor.unwrap_or(Penalty::AUTO) },
        Method::Augmented => Formulation::Augmented {
            factor: factor.unwrap_or(Proximal::<()>::FACTOR),
            tolerance: contact.tolerance.value.unwrap_or(Proximal::<()>::TOLERANCE),
        },
        Method::Nitsche => {
            Formulation::Nitsche(Nitsche { factor: factor.unwrap_or(Nitsche::AUTO), variant: nitsche_variant(contact.variant.value) })
        }
        _ => Formulation::Lagrange,
    }
}

/// Checks that the model is one of elasticity and that the contact has the same `c` as all others (E015).
fn known<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    contact: &case::Contact,
    model: &Model<S, N>,
) -> Result<(), Box<Diagnostic>> {
    if model.components == 1 {
        return Err(Box::new(builder.error("E015", "contact needs elasticity; the model is poisson", contact.head.at)));
    }
    if contact.active_set.c.value != model.c {
        let text = "all contacts of a case share one active set; `c` must be the same";
        return Err(Box::new(builder.error("E015", text, contact.active_set.c.at)));
    }
    Ok(())
}

/// Error of building the part of a slave side.
enum Missed {
    /// No point of it faces the opponent.
    Nothing(Box<Diagnostic>),
    /// Any other error.
    Fault(Box<Diagnostic>),
}

impl From<Box<Diagnostic>> for Missed {
    fn from(fault: Box<Diagnostic>) -> Self {
        Self::Fault(fault)
    }
}

#[allow(clippy::type_complexity)]
fn part<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Built<S, N>,
    contact: &case::Contact,
    built: &ContactModel<S, N>,
    slave: &Arc<SideModel<S, N>>,
    masters: &[Arc<SideModel<S, N>>],
    at: Place,
    taken: &dyn Fn(usize, usize) -> bool,
    on_seam: &dyn Fn(usize) -> bool,
) -> Result<(ContactPart<S, N>, Option<Diagnostic>), Missed> {
    let name = &contact.name.value;
    let moves = built.obstacle.as_ref().is_some_and(|o| o.changes);
    let (mut second, mut finer) = (None, None);
    let against = match &built.obstacle {
        // an obstacle has no quadrature points of its own: mixed integration uses those of the slave
        Some(obstacle) => {
            let rules = gauss_rules(&*slave.trace.space, contact.extra_points.value);
            Against::Rigid(Arc::clone(obstacle), slave_segments(&*slave.trace.space, &rules))
        }
        None => {
            let Some(master) = &as_one(model, masters) else {
                return Err(Box::new(builder.error("E021", format!("contact \"{name}\" has no master"), contact.head.at)).into());
            };
            let points = degree(slave).max(degree(master)) + 1 + contact.extra_points.value;
            let make = |word: &str, points: usize| {
                let make = builder
                    .names
                    .integrations
                    .get(word)
                    .map_err(|e| Box::new(builder.error("E019", e.to_string(), contact.integration.at)))?;
                make(points, Partners::Facing { reach: contact.reach.value })
                    .segments(&*slave.trace.space, &*master.trace.space)
                    .map_err(|e| Box::new(builder.error("E023", format!("contact \"{name}\": {e}"), at)))
            };
            let word = if contact.integration.value == Integration::Merged { "merged" } else { "slave" };
            let segments = make(word, points)?;
            if contact.integration.value == Integration::Mixed {
                second = Some(make(MASTER_SUMS, points)?);
            }
            finer = make("merged", points + FINER_POINTS).ok();
            Against::Side(master.clone(), segments)
        }
    };
    let fault = |e: &ContactError| Box::new(contact_fault(builder, contact, slave, masters, e, at));
    let missed = || {
        let plain = fault(&ContactError::NoTarget);
        let found = match &built.obstacle {
            Some(obstacle) => turned_away(builder, contact, obstacle, slave, plain),
            None => meant(model, slave, masters, plain),
        };
        Missed::Nothing(found)
    };
    if let Formulation::Nitsche(method) = &built.formulation {
        method.check_factor().map_err(|e| Box::new(builder.error("E015", format!("contact \"{name}\": {e}"), contact.factor.at)))?;
        if built.is_pressed() {
            let text = "method = \"nitsche\" against an obstacle that a `force` presses is not in this version";
            let help = "write method = \"lagrange\", or give the obstacle a `move`";
            return Err(Box::new(builder.error("E019", text, contact.method.at).with_help(help)).into());
        }
        let sides = PointSides { slave, against: &against, masters };
        let changes = moves || built.gap.depends_on_time() || sides.change(model);
        for &t in times(builder.case, moves) {
            let first = sides.contact(model, method, &built.gap, built.reach, t).map_err(|e| fault(&e))?;
            if first.facing.contains(&true) {
                let (masters, num_rows, first_row) = (masters.to_vec(), first.offset.len(), model.rows);
                let (slave, cone) = (slave.clone(), contact::Cone::Coefficients);
                let (multiplier, second, finer) = (None, None, None);
                let reading = None;
                let part =
                    ContactPart { slave, multiplier, reading, cone, against, second, finer, masters, first, changes, first_row, num_rows };
                return Ok((part, None));
            }
        }
        return Err(missed());
    }
    // rows act along the opponent's normal: an end is constrained if the body cannot move in that direction
    let slides = slides(model, slave);
    let cannot_move = |function: usize, n: &Vector<N>| {
        (0..N).all(|c| n[c].abs() < PERPENDICULAR || taken(function, c))
            || slides.iter().any(|(f, d)| *f == function && (n - d * n.dot(d)).norm() < PERPENDICULAR)
    };
    // the normals of a moving obstacle change; a function that cannot move at one of the times is constrained
    let turning = |n: usize| -> Vec<_> { times(builder.case, moves).iter().map(|&t| directions(slave, &against, t, n)).collect() };
    let normals = turning(2);
    // a function shared by two slave sides would get two multipliers: it counts as constrained
    let stuck =
        |function: usize| on_seam(function) || normals.iter().filter_map(|list| list.get(&function)).any(|n| cannot_move(function, n));
    // functions inside of elements vanish at corners: their direction is taken where they are largest
    let inner = turning(degree(slave) + 2);
    let held =
        |f: usize| stuck(f) || inner.iter().filter_map(|list| list.get(&f)).any(|n| cannot_move(f, n)) || (0..N).all(|c| taken(f, c));
    let free = slave.trace.dofs.iter().filter(|&&f| !held(f)).map(|&f| model.function(slave.patch, f)).collect::<HashSet<_>>().len();
    let along: Vec<usize> = (0..N).filter(|&c| inner.iter().flat_map(|list| list.values()).any(|n| n[c].abs() >= PERPENDICULAR)).collect();
    let help = || held_help(model, slave, &along, !slides.is_empty());
    if free == 0 {
        let text =
            format!("the multiplier of \"{name}\" on `{}` is over-constrained: the normal direction has 0 free unknowns", slave.label);
        let advice = help().unwrap_or_else(|| "free the side, or give it more elements".into());
        return Err(Box::new(builder.error("E024", text, at).with_help(advice)).into());
    }
    let (mut psi, warning) = multiplier(builder, model, name, slave, &contact.multiplier, &stuck, None)?;
    let mut reading = None;
    let is_dual = matches!(&contact.multiplier.value, case::Multiplier::Named(word) if word == "dual");
    // what faces something at the first time at which anything does
    let faced = match &against {
        Against::Side(_, segments) if !is_dual => Some(segments.clone()).filter(|s| !s.ds.is_empty()),
        _ => times(builder.case, moves).iter().map(|&t| faced(slave, &against, built.reach, t)).find(|s| !s.ds.is_empty()),
    };
    match (&faced, builder.names.covered.0, builder.names.cut.0) {
        (Some(segments), Some(make), _) if is_dual => {
            let (functions, read) = make(&slave.trace, &stuck, segments)
                .map_err(|e| Box::new(multiplier_fault(builder, name, slave, &e, contact.multiplier.at, N.max(2))))?;
            psi = wrapped(model, slave, &stuck, functions);
            reading = Some(wrapped(model, slave, &stuck, read)).filter(|read| read.num_functions() == psi.num_functions());
        }
        (Some(segments), _, Some(cut)) => psi = cut(psi, &slave.trace, segments),
        _ => {}
    }
    if psi.num_functions() > free {
        let error = MultiplierError::TooMany { component: 0, multipliers: psi.num_functions(), free };
        let mut fault = multiplier_fault(builder, name, slave, &error, contact.multiplier.at, N);
        fault.message = fault.message.replace("component x", "the normal direction");
        if let Some(help) = help() {
            fault = fault.with_help(help);
        }
        return Err(Box::new(fault).into());
    }
    let changes = moves || built.gap.depends_on_time();
    let cone = match contact.cone.value {
        Cone::Weights => contact::Cone::Weights,
        Cone::Values => contact::Cone::Values,
        _ => contact::Cone::Coefficients,
    };
    // an obstacle may come within reach later
    for &t in times(builder.case, moves) {
        let first =
            rows(model, slave, &against, (&*psi, cone, second.as_ref()), &built.gap, built.reach, t, None).map_err(|e| fault(&e))?;
        if first.facing.contains(&true) {
            let finer = finer.and_then(|segments| finer_rows(model, slave, &against, &*psi, &segments));
            let (masters, num_rows, first_row) = (masters.to_vec(), psi.num_functions(), model.rows);
            let multiplier = Some(psi);
            let slave = slave.clone();
            let part =
                ContactPart { slave, multiplier, reading, cone, against, second, finer, masters, first, changes, first_row, num_rows };
            return Ok((part, warning));
        }
    }
    Err(missed())
}

/// Returns the points of a slave side that face its opponent at time `t`.
fn faced<const S: usize, const N: usize>(slave: &SideModel<S, N>, against: &Against<S, N>, reach: Option<f64>, t: f64) -> Segments<S> {
    match against {
        // a master without tangent is reported when the rows are built
        Against::Side(master, segments) => {
            Frames::against_master(&slave.trace, &master.trace, segments).map_or_else(|_| segments.clone(), |(segments, _)| segments)
        }
        Against::Rigid(obstacle, segments) => Frames::against_target(&slave.trace, &*obstacle.target(t, None), segments, reach).0,
    }
}

/// Rows on finer segments, against which the consistency error is estimated.
fn finer_rows<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &SideModel<S, N>,
    against: &Against<S, N>,
    psi: &dyn Basis<S>,
    segments: &Segments<S>,
) -> Option<Finer> {
    let Against::Side(master, _) = against else { return None };
    let (segments, frames) = Frames::against_master(&slave.trace, &master.trace, segments).ok()?;
    let interface = Interface {
        slave: Side { trace: &slave.trace, field: model.patches[slave.patch].field, flux: None },
        master: Some(Side { trace: &master.trace, field: master.field, flux: None }),
        multiplier: &[psi],
        segments: &segments,
        master_segments: None,
        direction: Some(&frames.normal),
    };
    Finer::try_new(&[interface], model.unknowns).ok()
}

fn contact_fault<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    contact: &case::Contact,
    slave: &SideModel<S, N>,
    masters: &[Arc<SideModel<S, N>>],
    error: &ContactError,
    at: Place,
) -> Diagnostic {
    let text = format!("contact \"{}\": {error}", contact.name.value);
    match error {
        ContactError::Weight { .. } => builder.error("E064", text, contact.multiplier.at).with_help(positive_help(slave)),
        ContactError::NoGreville => builder.error("E064", text, contact.cone.at).with_help(format!(
            "write cone = \"weights\" or \"coefficients\", or take a multiplier such as {}",
            if has_lowered(slave) { "p/p-2" } else { "p/p" }
        )),
        ContactError::ConeWeight { .. } => {
            builder.error("E064", text, contact.cone.at).with_help("take a multiplier of lower degree, or cone = \"coefficients\"")
        }
        ContactError::ConeSize { .. } => {
            builder.error("E081", text, contact.cone.at).with_help("write cone = \"coefficients\", or give the slave side fewer elements")
        }
        ContactError::Gap { .. } => builder.error("E017", text, contact.gap.at),
        ContactError::NoTarget if masters.is_empty() => builder
            .error("E023", format!("no part of `{}` faces the obstacle of contact \"{}\"", slave.label, contact.name.value), at)
            .with_help("turn the obstacle's normal towards the body, or raise `reach`"),
        ContactError::NoTarget => builder
            .error("E023", format!("no part of `{}` faces {}", slave.label, labels(masters)), at)
            .with_help("raise `reach`, or choose the sides that face each other"),
        _ => builder.error("E041", text, at),
    }
}
