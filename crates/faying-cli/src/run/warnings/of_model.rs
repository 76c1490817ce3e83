//! Diagnostics of warnings about a model.

use super::loads;
use crate::case::{Case, Master, Tie};
use crate::errors::Diagnostic;
use crate::lower::LoweredCase;
use crate::place::SourceSpan;
use crate::text_format::{percent, place, short};
use faying::problem::{Subject, SubjectKind, Warning};

/// Returns the diagnostic of a warning about the accuracy of a model.
pub fn diagnostic<const S: usize, const N: usize>(case: &Case, model: &LoweredCase<S, N>, warning: &Warning) -> Option<Diagnostic> {
    if let Warning::Inexact(found) = warning {
        return loads::diagnostic(case, model, found);
    }
    if let Warning::CoarseValues { of, side, component, t, error } = warning {
        return Some(loads::coarse_values(case, model, *of, (side, *component, *t, *error)));
    }
    let of = warning.subject()?;
    let name = &of.name;
    let block = |number: usize| case.patches[number].head.at;
    let (code, text, at, help): (_, _, _, String) = match warning {
        Warning::ThinCells { aspect, allowed, element, x, .. } => (
            "E041",
            format!(
                "cells of patch \"{name}\" are very thin: element {element} (at {}) has an aspect of {aspect:.1e}; beyond {allowed:.0e} rounding spoils the result",
                place(x)
            ),
            block(of.number),
            "give the patch more elements along its length, or fewer across; a larger `ratio` of `grade` makes its least cells less thin"
                .into(),
        ),
        Warning::PatchTest { element, x, missed, enough, .. } => {
            let own = case.patches[of.number].discretization.extra_points.value;
            let help = match enough {
                Some((more, left)) => {
                    let extra = own + more;
                    format!("write extra_points = {extra} in the patch: {} % then; or give it more elements along its bend", percent(*left))
                }
                None => "give the patch more elements along its bend".into(),
            };
            let text = format!(
                "the integration of patch \"{name}\" is inexact: on element {element} (at {}) its Gauss points miss {} % of the stress of linear fields",
                place(x),
                percent(*missed)
            );
            ("E065", text, block(of.number), help)
        }
        Warning::HardlyHeld { motions, share, .. } => {
            let springs = case.boundaries.iter().find(|b| b.spring.iter().any(Option::is_some)).map(|b| b.head.at);
            let foundation = || [&case.model.foundation, &case.patches[of.number].foundation].into_iter().flatten().flatten().next();
            let held_by = springs.or_else(|| foundation().map(|f| f.at));
            let text = format!(
                "body \"{name}\" is held in {} only by springs {} as stiff as the body: round-off grows accordingly",
                motions.join(", "),
                crate::table::short(*share, 2)
            );
            let help = "fix the motion, or make the springs stiffer where they stand for a support";
            ("E051", text, held_by.unwrap_or(block(of.number)), help.into())
        }
        Warning::Locking { ratio, .. } => (
            "E053",
            format!(
                "patch \"{name}\" of degree 1 is too stiff: its material resists changes of volume {} times as much as those of shape, and linear functions lock",
                short(*ratio)
            ),
            block(of.number),
            "write degree = 2 or more; finer elements of degree 1 help slowly".into(),
        ),
        Warning::FluxJump { x, share, .. } => {
            let where_ = if of.kind == SubjectKind::Body { "inside patch" } else { "across interface" };
            let text = format!(
                "the flux of `exact` jumps {where_} \"{name}\": at {} by {} % of its largest; the source that follows from it lacks the jump",
                place(x),
                percent(*share)
            );
            let help = "a solution has a continuous flux (sigma n, k du/dn) across every line inside and every tie; choose the pieces so that it is, \
                        or give source and data instead of `exact`";
            ("E017", text, case.exact_at()?, help.into())
        }
        _ => of_slave(case, of, warning)?,
    };
    Some(Diagnostic::warning(code, text).at(&case.source, at).with_help(help))
}

/// Code, text, place and help of a warning about the slave side of a tie or a contact.
fn of_slave(case: &Case, of: &Subject, warning: &Warning) -> Option<(&'static str, String, SourceSpan, String)> {
    let name = &of.name;
    Some(match warning {
        Warning::PartUncovered { slave, share, .. } => (
            "E025",
            format!(
                "{} % of the slave side `{slave}` of interface \"{name}\" meets no master: facets end beside each other at the rim of the surface that they stand for; nothing ties that part",
                percent(*share)
            ),
            tie(case, name)?.head.at,
            "take more elements along the sides, degree 2 or more, mapping = \"exact\", or backend = \"iga\"".into(),
        ),
        Warning::Facets { sag, gap, .. } => (
            "E065",
            format!(
                "the facets of contact \"{name}\" leave the surface that they stand for by up to {}, {} % of the mean gap {}: facets decide what touches",
                short(*sag),
                percent(sag / gap),
                short(*gap)
            ),
            case.contacts[of.number].head.at,
            facets_help(case, of.number).into(),
        ),
        Warning::Adjusted { mean, explained, .. } => (
            "E023",
            format!(
                "`adjust` of contact \"{name}\" closes what facets do not explain: its surfaces are {} apart or in each other in the mean, facets explain {}; \
                 a press fit or a clearance that is drawn is lost",
                short(*mean),
                short(*explained)
            ),
            case.contacts[of.number].head.at,
            "draw the sides where they touch and give the fit by `gap`, such as gap = \"g - 0.01\"; or leave `adjust` out and take finer or exact sides".into(),
        ),
        Warning::DualConstants { slave, degree, .. } => (
            "E061",
            format!(
                "multiplier \"dual\" of \"{name}\" holds constants only on `{slave}`, a side of degree {degree}: errors of u fall as at degree 2, \
                 those of lambda with order 1, and on coarse elements lambda is off by tens of percent"
            ),
            multiplier_at(case, of)?,
            "use p/p or p/p-2".into(),
        ),
        Warning::RoundKink { slave, .. } => (
            "E065",
            format!(
                "the multiplier of \"{name}\" runs round an edge of `{slave}`: tractions jump there, and beside it lambda and stresses may be off by \
                 tens of percent"
            ),
            multiplier_at(case, of)?,
            "give the walls beside the edge two elements or more, or degree 2".into(),
        ),
        Warning::UnevenGap { slave, share, .. } => (
            "E065",
            format!(
                "the facets of both sides of \"{name}\" are apart by unlike distances along `{slave}`: lambda and stresses beside it may be off by \
                 about {} % of the stress of linear fields",
                percent(*share)
            ),
            multiplier_at(case, of)?,
            "mesh the sides with the same facets, or with elements of order 2 on curved sides; or write coupling = \"nitsche\"".into(),
        ),
        Warning::MixedMultiplier { slave, degree, multiplier, order, .. } => (
            "E065",
            format!(
                "mixed integration of \"{name}\" with a multiplier of degree {multiplier} on `{slave}`, a side of degree {degree}: it jumps or \
                 kinks inside of the master's elements, and errors of u may fall with order {order} only"
            ),
            integration_at(case, of)?,
            "write integration = \"merged\", or multiplier = \"p/p\" with smooth splines on the slave side".into(),
        ),
        _ => return None,
    })
}

/// Ways to finer facets of a contact: those of files are as they are read.
fn facets_help(case: &Case, contact: usize) -> &'static str {
    let contact = &case.contacts[contact];
    let masters = if let Master::Sides(list) = &contact.master { &list[..] } else { &[] };
    let read = contact.slave.iter().chain(masters).all(|side| case.patches[side.value.patch].geometry.shape.mesh_part().is_some());
    if read {
        "read meshes with more elements along the sides, or of order 2 or more; or write adjust = true where the surfaces touch without clearance or interference"
    } else {
        "take more elements along the sides, degree 2 or more, mapping = \"exact\", backend = \"iga\", or adjust = true where the surfaces touch without clearance or interference"
    }
}

/// The [[interface]] with a name.
fn tie<'c>(case: &'c Case, name: &str) -> Option<&'c Tie> {
    case.interfaces.iter().find(|tie| tie.name.value == name)
}

/// The place of the multiplier of a tie or a contact.
fn multiplier_at(case: &Case, of: &Subject) -> Option<SourceSpan> {
    if of.kind == SubjectKind::Contact { Some(case.contacts[of.number].multiplier.at) } else { Some(tie(case, &of.name)?.multiplier.at) }
}

/// The place of the integration of a tie or a contact.
fn integration_at(case: &Case, of: &Subject) -> Option<SourceSpan> {
    if of.kind == SubjectKind::Contact { Some(case.contacts[of.number].integration.at) } else { Some(tie(case, &of.name)?.integration.at) }
}
