//! Contacts: multiplier space, opponent and constraint rows of each slave side.

use super::builder::Builder;
use super::built::Built;
use super::couples::Couples;
use super::multipliers::{has_lowered, held_help, judged, multiplier, multiplier_fault, positive_help};
use super::obstacles::{num_pressed, obstacle, swallowed, turned_away};
use super::sides::Sides;
use super::ties::{list, memberships, nitsche_variant, rules};
use super::values::times;
use super::warned::{meant, tell};
use crate::case::{self, Cone, Master, Method};
use crate::errors::{Diagnostic, Severity};
use crate::place::Place;
use crate::registry::MASTER_SUMS;
use crate::words::labels;
use faying::constraint::Proximal;
use faying::contact::{self, ContactError};
use faying::coupling::multiplier::MultiplierError;
use faying::coupling::{Nitsche, Penalty};
use faying::problem::{ContactModel, ContactPart, ContactSetup, Fixed, Formulation, InterfaceError, MakeMultiplier, Model, SideModel};
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, OnceLock};

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
    for (number, contact) in case.contacts.iter().enumerate() {
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
        let inside = || built.parts.iter().find_map(|part| swallowed(builder, contact, built.obstacle.as_deref()?, (model, &part.slave)));
        match inside() {
            Some(fault) => builder.faults.push(fault),
            None => tell(builder, model, model.overlap(number, &built, times(case, true)[0]).as_slice()),
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
    let is_dual = matches!(&contact.multiplier.value, case::Multiplier::Named(word) if word == "dual");
    let warning = OnceLock::new();
    let multiplier: Box<MakeMultiplier<'_, S, N>> = match built.formulation {
        Formulation::Nitsche(_) => Box::new(|_, _| unreachable!("Nitsche's method has no multipliers")),
        _ => judged(builder, model, &contact.name.value, slave, &contact.multiplier, multiplier(builder, &contact.multiplier)?, &warning),
    };
    let setup = ContactSetup {
        slave,
        masters,
        multiplier: &*multiplier,
        covered: builder.names.covered.0.filter(|_| is_dual),
        cut: builder.names.cut.0.filter(|_| !is_dual),
        cone: match contact.cone.value {
            Cone::Weights => contact::Cone::Weights,
            Cone::Values => contact::Cone::Values,
            _ => contact::Cone::Coefficients,
        },
        rules: rules(builder, &contact.integration, contact.extra_points.value, Some(MASTER_SUMS))?,
        times: times(builder.case, true),
        taken,
        on_seam,
    };
    let part = model.contact_part(built, &setup).map_err(|e| fault(builder, model, contact, built, (slave, masters, at), &e))?;
    Ok((part, warning.get().cloned().flatten()))
}

/// Builds the diagnostic of a slave side that cannot be built.
fn fault<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Built<S, N>,
    contact: &case::Contact,
    built: &ContactModel<S, N>,
    (slave, masters, at): (&Arc<SideModel<S, N>>, &[Arc<SideModel<S, N>>], Place),
    error: &InterfaceError,
) -> Missed {
    let name = &contact.name.value;
    let fault = match error {
        InterfaceError::NoMaster => builder.error("E021", format!("contact \"{name}\" has no master"), contact.head.at),
        InterfaceError::Factor(e) => builder.error("E015", format!("contact \"{name}\": {e}"), contact.factor.at),
        InterfaceError::PressedAtPoints => {
            let text = "method = \"nitsche\" against an obstacle that a `force` presses is not in this version";
            builder.error("E019", text, contact.method.at).with_help("write method = \"lagrange\", or give the obstacle a `move`")
        }
        InterfaceError::Segments(e) => builder.error("E023", format!("contact \"{name}\": {e}"), at),
        InterfaceError::Contact(e) => contact_fault(builder, contact, slave, masters, e, at),
        InterfaceError::NothingFaces => {
            let plain = Box::new(contact_fault(builder, contact, slave, masters, &ContactError::NoTarget, at));
            return Missed::Nothing(match &built.obstacle {
                Some(obstacle) => turned_away(builder, contact, obstacle, (model, slave), plain),
                None => match model.meant_sides(slave, masters) {
                    Some(sides) => Box::new(plain.with_help(meant(model, &sides))),
                    None => plain,
                },
            });
        }
        InterfaceError::Held { components, by_equations } => {
            let text =
                format!("the multiplier of \"{name}\" on `{}` is over-constrained: the normal direction has 0 free unknowns", slave.label);
            let help = held_help(model, slave, components, *by_equations);
            builder.error("E024", text, at).with_help(help.unwrap_or_else(|| "free the side, or give it more elements".into()))
        }
        InterfaceError::TooMany { multipliers, free, components, by_equations } => {
            let error = MultiplierError::TooMany { component: 0, multipliers: *multipliers, free: *free };
            let mut fault = multiplier_fault(builder, name, slave, &error, contact.multiplier.at, N);
            fault.message = fault.message.replace("component x", "the normal direction");
            match held_help(model, slave, components, *by_equations) {
                Some(help) => fault.with_help(help),
                None => fault,
            }
        }
        InterfaceError::Multiplier { error, .. } => multiplier_fault(builder, name, slave, error, contact.multiplier.at, N.max(2)),
        other => builder.error("E041", format!("contact \"{name}\": {other}"), at),
    };
    Missed::Fault(Box::new(fault))
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
        ContactError::Gap { .. } => {
            let fault = builder.error("E017", text, contact.gap.at);
            match &contact.master {
                Master::Rigid(obstacle) if matches!(obstacle.shape.value, case::ObstacleShape::LevelSet { .. }) => {
                    fault.with_help("`f` must have a zero on the line along its gradient from there; `along` takes f itself as the gap")
                }
                _ => fault,
            }
        }
        ContactError::NoTarget if masters.is_empty() => builder
            .error("E023", format!("no part of `{}` faces the obstacle of contact \"{}\"", slave.label, contact.name.value), at)
            .with_help("turn the obstacle's normal towards the body, or raise `reach`"),
        ContactError::NoTarget => builder
            .error("E023", format!("no part of `{}` faces {}", slave.label, labels(masters)), at)
            .with_help("raise `reach`, or choose the sides that face each other"),
        _ => builder.error("E041", text, at),
    }
}
