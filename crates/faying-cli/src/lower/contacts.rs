//! Contacts of the case, said one by one, and what is found of them once they are built.

use super::lower_context::LowerContext;
use super::lowered_case::LoweredCase;
use super::multipliers::{multiplier, unstable};
use super::obstacles::{opponent, swallowed};
use super::parts::of_slaves;
use super::places::{Places, Said};
use super::refused::contact_fault;
use super::sides::side;
use super::ties::rule;
use super::warned::tell;
use crate::case::{self, Contact, Master, SideRef};
use crate::errors::{Diagnostic, Severity};
use crate::formula::Formula;
use crate::place::{Located, SourceSpan};
use crate::registry::Fault;
use faying::contact::{ContactError, ContactMethod};
use faying::coupling::multiplier::MultiplierKind;
use faying::problem::{self, ErrorKind, Multiplier, Opponent, Problem, RegionId, Rule, Warning};
use std::sync::Arc;

/// Says all contacts of the case; errors go to the context's faults.
pub(super) fn say<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>, problem: &mut Problem<S, N>, places: &mut Places) {
    let case = context.case;
    for (k, contact) in case.contacts.iter().enumerate() {
        let parts = match &contact.filter {
            Some(filter) => match of_slaves(context, problem, places, &contact.slave, (&contact.name.value, filter)) {
                Ok(parts) => Some(parts),
                Err(faults) => {
                    context.faults.items.extend(faults);
                    continue;
                }
            },
            None => None,
        };
        if let Err(fault) = one(context, problem, places, (k, contact), parts) {
            context.faults.items.extend(fault);
        }
    }
}

/// Sides of a list by the bodies of their patches.
fn sides<'a>(places: &Places, wanted: &'a [Located<SideRef>]) -> problem::Sides<'a> {
    wanted.iter().map(|side| places.bodies[side.value.patch].side(&side.value.side)).collect::<Vec<_>>().into()
}

/// Looks up the sides of a list, each of which exists.
fn named<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    wanted: &[Located<SideRef>],
) -> Result<(), Vec<Diagnostic>> {
    let faults: Vec<_> = wanted.iter().filter_map(|of| side(context, problem, places, of).err()).map(|fault| *fault).collect();
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

fn one<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &mut Places,
    (number, contact): (usize, &Contact),
    parts: Option<Vec<RegionId>>,
) -> Result<(), Vec<Diagnostic>> {
    let refused = |fault: Box<Diagnostic>| vec![*fault];
    known(context, contact).map_err(refused)?;
    named(context, problem, places, &contact.slave)?;
    let (method, multiplier, rule) = choices(context, contact).map_err(refused)?;
    let faced: Opponent<'_, S, N> = match &contact.master {
        Master::Sides(wanted) => {
            named(context, problem, places, wanted)?;
            Opponent::Sides(sides(places, wanted))
        }
        Master::Rigid(obstacle) => opponent(context, obstacle, &contact.name.value).map_err(refused)?,
    };
    let said = problem.contact(parts.map_or_else(|| sides(places, &contact.slave), Into::into), faced).map_err(|error| {
        let name = &contact.name.value;
        vec![match error.kind {
            ErrorKind::NoMaster => context.error("E021", format!("contact \"{name}\" has no master"), contact.head.at),
            _ => context.error("E015", format!("contact \"{name}\": {error}"), contact.head.at),
        }]
    })?;
    said.named(&contact.name.value).method(method).multiplier(multiplier).rule(rule).extra_points(contact.extra_points.value);
    said.cone(contact.cone.value).gap(contact.gap.value.clone()).start(contact.active_set.start.value);
    said.exact(contact.exact.iter().map(|f| f.value.clone().into()).collect());
    if let Some(reach) = contact.reach.value {
        said.reach(reach);
    }
    if contact.symmetry.value {
        said.symmetry();
    }
    if contact.adjust.value {
        said.adjust();
    }
    if let Master::Rigid(obstacle) = &contact.master {
        for (k, f) in obstacle.translate.iter().enumerate().filter_map(|(k, f)| Some((k, f.as_ref()?))) {
            said.moved(k, f.value.clone());
        }
        for (k, f) in obstacle.force.iter().enumerate().filter_map(|(k, f)| Some((k, f.as_ref()?))) {
            said.pressed(k, f.value.clone());
        }
    }
    let slaves = contact.slave.iter().map(|s| s.at).collect();
    let formulas = match &contact.master {
        Master::Rigid(obstacle) => driven(obstacle),
        Master::Sides(_) => Vec::new(),
    };
    places.keep(said.id().into(), Said { at: contact.head.at, block: Some(number), what: "the drive of the obstacle", formulas, slaves });
    Ok(())
}

/// Motion or force of an obstacle per component, zero where there is none.
fn driven(obstacle: &case::Obstacle) -> Vec<Located<Formula>> {
    let none = || Located::new(Formula::constant(0.0), SourceSpan::default());
    let count = obstacle.translate.len().max(obstacle.force.len());
    let of = |list: &[Option<Located<Formula>>], k: usize| list.get(k).cloned().flatten();
    (0..count).map(|k| of(&obstacle.translate, k).or_else(|| of(&obstacle.force, k)).unwrap_or_else(none)).collect()
}

/// Method, multiplier and rule of a contact.
type Choices<const S: usize, const N: usize> = (Arc<dyn ContactMethod<S, N>>, Multiplier<S, N>, Rule<S, N>);

fn choices<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, contact: &Contact) -> Result<Choices<S, N>, Box<Diagnostic>> {
    let name = &contact.method;
    let entry = context.names.methods.get(&name.value).map_err(|e| context.error("E015", e.to_string(), name.at))?;
    let refused = |fault: &Fault| context.error(fault.code, fault.message.clone(), contact.given.at(fault.key).unwrap_or(name.at));
    let method = (entry.make)(&contact.given).map_err(|fault| refused(&fault))?;
    let multiplier = if contact.needs.multiplier { multiplier(context, &contact.multiplier)? } else { MultiplierKind::Auto.into() };
    Ok((method, multiplier, rule(context, &contact.integration)?))
}

/// Checks that the model is one of elasticity and that the contact has the same `c` as all others (E015).
fn known<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, contact: &Contact) -> Result<(), Box<Diagnostic>> {
    let case = context.case;
    if case.model.components() == 1 {
        return Err(Box::new(context.error("E015", "contact needs elasticity; the model is poisson", contact.head.at)));
    }
    if contact.active_set.c.value != case.contacts[0].active_set.c.value {
        let text = "all contacts of a case share one active set; `c` must be the same";
        return Err(Box::new(context.error("E015", text, contact.active_set.c.at)));
    }
    Ok(())
}

/// Warns of unstable multipliers and of slave sides that face nothing, and refuses overlaps that are no press fits.
pub(super) fn check<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &Problem<S, N>,
    built: &LoweredCase<S, N>,
    found: &[Warning],
) {
    let case = context.case;
    for (number, (contact, of)) in case.contacts.iter().zip(built.system.contents().contacts()).enumerate() {
        let sides = of.sides();
        for slave in sides.iter().filter(|slave| !slave.multipliers().is_empty()) {
            let found = unstable(context, &contact.name.value, slave.side(), &contact.multiplier, slave.unstable());
            context.faults.items.extend(found);
        }
        match sides.iter().find_map(|slave| swallowed(context, contact, problem, of.id(), slave.number())) {
            Some(fault) => context.faults.push(fault),
            None => {
                let own = |w: &&Warning| matches!(w, Warning::Overlap { of, .. } if of.number == number);
                tell(context, &built.places, found.iter().filter(own));
            }
        }
        for &slave in of.idle() {
            let at = contact.slave.get(slave).map_or(contact.head.at, |s| s.at);
            let Some((slave, masters)) = problem.slave_and_masters(of.id().into(), slave) else { continue };
            let mut fault = contact_fault(context, contact, &slave, &masters, &ContactError::NoTarget, at);
            fault.severity = Severity::Warning;
            context.faults.push(fault.with_help("leave the side out of `slave`"));
        }
    }
}
