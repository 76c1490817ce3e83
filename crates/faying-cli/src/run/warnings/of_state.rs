//! Diagnostics of warnings about a solution.

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::text_format::{percent, place, short};
use faying::problem::{Subject, SubjectKind, Warning};

/// Moduli that differ by less are not named.
const CONTRAST: f64 = 100.0;

/// "pieces of `exact` meet so near to the slave side of "a" that it is open which one is its own".
pub fn left_open(name: &str) -> String {
    format!("pieces of `exact` meet so near to the slave side of \"{name}\" that it is open which one is its own")
}

/// Returns the diagnostic of a warning about a solution.
pub fn diagnostic(case: &Case, warning: &Warning) -> Option<Diagnostic> {
    let of = warning.subject()?;
    let name = &of.name;
    let is_contact = of.kind == SubjectKind::Contact;
    let tie = || case.interfaces.iter().find(|t| t.name.value == *name);
    let block = || match of.kind {
        SubjectKind::Body => Some(case.patches[of.number].head.at),
        SubjectKind::Contact => Some(case.contacts[of.number].head.at),
        _ => tie().map(|t| t.head.at),
    };
    let (code, text, at, help) = match warning {
        Warning::Integration { error, .. } => {
            let (kind, rule) =
                if is_contact { ("contact", &case.contacts[of.number].integration) } else { ("interface", &tie()?.integration) };
            let text = format!(
                "the integration of {kind} \"{name}\" is inexact: its consistency error is {0} %; the force and the multiplier of \"{name}\" may be off by {0} %, stresses beside it by several times that",
                percent(*error)
            );
            let help = match rule.value.as_str() {
                "slave" => "write integration = \"merged\"; or raise `extra_points`, or exchange slave and master: the finer side as slave",
                "mixed" => "write integration = \"merged\"; or raise `extra_points`; mixed integration goes with p/p",
                _ => "raise `extra_points`, or refine the sides: they are curved",
            };
            ("E065", text, rule.at, help)
        }
        Warning::Unbalanced { moved, .. } => {
            let rule = if is_contact { &case.contacts[of.number].integration } else { &tie()?.integration };
            let text = format!(
                "the forces of mixed integration of \"{name}\" on both bodies differ, and springs alone take the difference: all move by about {} for it",
                short(*moved)
            );
            ("E065", text, rule.at, "write integration = \"merged\"; or raise `extra_points`, or hold the bodies")
        }
        Warning::LeftOpen { .. } => (
            "E017",
            format!("{}: error.{name}.lambda.L2 has no value", left_open(name)),
            case.exact_at()?,
            "take more elements along the side, mapping = \"exact\" or backend = \"iga\", or give lambda as `exact` of the interface",
        ),
        _ => {
            let (text, help) = of_interface(warning, of).or_else(|| of_pressure(warning, name)).or_else(|| of_body(warning, name))?;
            ("E065", text, block()?, help)
        }
    };
    Some(Diagnostic::warning(code, text).at(&case.source, at).with_help(help))
}

/// Text and help of a warning about a tie or a contact.
fn of_interface(warning: &Warning, of: &Subject) -> Option<(String, &'static str)> {
    let name = &of.name;
    Some(match warning {
        Warning::Sliding { error, .. } => (
            format!(
                "contact \"{name}\" slides too far for small kinematics: along the normals at rest its gaps are wrong by {} % of what is closed; \
                 so are the area of the zone and its pressure",
                percent(*error)
            ),
            "let the bodies begin nearer to their places in contact, hold them against sliding, or load them less",
        ),
        Warning::CoarseZone { closed, across, least, .. } => (
            format!(
                "the zone of contact \"{name}\" is too coarse: {}, fewer than {least}; its force, pressure and extent may be off by tens of percent",
                match across {
                    // rounded down: it is told to be fewer than a whole number
                    Some(n) => format!("about {:.1} functions of the slave lie across it", (10.0 * n).floor() / 10.0),
                    None => format!("{closed} functions of the slave carry it"),
                }
            ),
            "give the slave side smaller elements where it touches (elements, grade, refine)",
        ),
        Warning::LostParts { elements, x, .. } => (
            format!(
                "the pieces of integration of contact \"{name}\" lose a part of {elements} elements of the slave that face the master, the first \
                 at {}; its pressure there may be off",
                place(x)
            ),
            "take smaller elements where sides are kinked, exchange slave and master, or write integration = \"slave\"",
        ),
        Warning::LostMoment { apart, moment, share, .. } => (
            format!(
                "interface \"{name}\" loses a moment: its sides are up to {} apart, and its forces on both have the moment {} about that gap, \
                 {} % of what they have about the middle of the side; `balance.moment` lacks it",
                short(*apart),
                short(*moment),
                percent(*share)
            ),
            "move the bodies together, or fill the gap with a body",
        ),
        Warning::HeldWithin { depth, x, .. } => (
            format!(
                "the slave side of contact \"{name}\" is held {} deep in what it faces, at {}: no pressure moves it out, and the force and the \
                 stresses beside it depend on the elements",
                short(*depth),
                place(x)
            ),
            "let the side move there, prescribe the displacement that contact gives it, or end the slave side before it",
        ),
        Warning::SoftPenalty { apart, size, moved, .. } => soft_penalty(of, *apart, *size, *moved),
        Warning::CoarseTie { apart, moved, .. } => (
            format!(
                "interface \"{name}\" is too coarse: between the functions of its multiplier its sides come apart by {} on average, {} % of \
                 their largest displacement, {}",
                short(*apart),
                percent(apart / moved),
                short(*moved)
            ),
            "give the slave side more elements, or let the finer side be the slave; no `factor` holds what the multiplier does not see",
        ),
        _ => return None,
    })
}

/// Text and help of a warning about the pressure of a contact at points.
fn of_pressure(warning: &Warning, name: &str) -> Option<(String, &'static str)> {
    Some(match warning {
        Warning::GapPressure { pressure, from_gap, gap, x, .. } => (
            format!(
                "the pressure of contact \"{name}\" at points is not the stress of its bodies: at {} {} of {} is the factor times a gap of {}; its \
                 force, a mean, is usually less affected",
                place(x),
                short(*from_gap),
                short(*pressure),
                short(*gap)
            ),
            "write method = \"lagrange\"; or mapping = \"exact\" or smaller elements where sides are curved, or a smaller `factor`",
        ),
        Warning::WavyFacets { height, wave, pressure, .. } => (
            format!(
                "the pressure of contact \"{name}\" at points has waves of about {} beside {}: facets leave the surface that they stand for by {}; \
                 its force, a mean, is usually less affected",
                short(*wave),
                short(*pressure),
                short(*height)
            ),
            "write mapping = \"exact\", or method = \"lagrange\" with multiplier = \"p/p-2\", or take smaller elements or a higher degree where sides are curved",
        ),
        Warning::Tension { least, largest, .. } => (
            format!(
                "contact \"{name}\" pulls: its pressure falls to {} beside {}, as its cone does not hold it at all points; its force and \
                 pressure may be off by tens of percent",
                short(*least),
                short(*largest)
            ),
            "write cone = \"coefficients\", or a multiplier of lower degree, such as \"auto\"",
        ),
        _ => return None,
    })
}

/// Text and help where bodies sink into each other by `apart`, or sides of a tie come apart by it.
fn soft_penalty(of: &Subject, apart: f64, size: f64, moved: f64) -> (String, &'static str) {
    let name = &of.name;
    // a hundredth of the size and a tenth of the displacement are told: of both the one that is passed by more
    let (of_what, whole) = if 10.0 * moved >= size { ("their size", size) } else { ("their largest displacement", moved) };
    let [depth, share, whole] = [short(apart), percent(apart / whole), short(whole)];
    let (text, help) = if of.kind == SubjectKind::Contact {
        let text =
            format!("the penalty of contact \"{name}\" is soft: bodies sink into each other by {depth}, {share} % of {of_what}, {whole}");
        (text, "raise `factor` (or what the method has in its place), or write method = \"lagrange\" or \"augmented\"")
    } else {
        let text = format!(
            "the penalty of interface \"{name}\" is soft: its sides come apart by {depth} on average, {share} % of {of_what}, {whole}"
        );
        (text, "raise `factor`, or write coupling = \"mortar\"")
    };
    (text, help)
}

/// Text and help of a warning about a body.
fn of_body(warning: &Warning, name: &str) -> Option<(String, &'static str)> {
    Some(match warning {
        Warning::Rounding { soft, contrast, condition, error, .. } => {
            let why = match *contrast > CONTRAST {
                true => format!("; patch \"{name}\" is {} times as stiff as \"{}\"", short(*contrast), soft.name),
                false => String::new(),
            };
            let text = format!(
                "rounding is not small: the condition number {} of the system lets the displacements be wrong by up to {} %, stresses \
                 of stiff or thin bodies by more{why}",
                short(*condition),
                percent(error.min(1.0))
            );
            let help = "let moduli differ less: a body that hardly deforms may be a rigid obstacle, or a side that moves as one; cells may be too thin, springs too soft";
            (text, help)
        }
        Warning::Kinematics { strain, rotation, allowed, .. } => {
            let list = [(strain, "strains", ""), (rotation, "rotations", " rad")].into_iter().filter_map(|(b, word, unit)| {
                let b = b.as_ref()?;
                Some(format!("{word} up to {}{unit}, beyond {allowed} in {} % of it", short(b.largest), percent(b.share)))
            });
            let text = format!("patch \"{name}\" deforms too far for small kinematics: {}", list.collect::<Vec<_>>().join("; "));
            (text, "load it less; lengths, moduli and forces may be in units that do not fit")
        }
        _ => return None,
    })
}
