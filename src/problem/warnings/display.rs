//! Sentences of warnings.

use super::warning::{Subject, SubjectKind, Warning};
use crate::problem::rigid::short;
use crate::problem::{Beyond, FacetsApart, Inexact, Integral};
use std::fmt::{Display, Formatter, Result};

impl Display for Subject {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let kind = match self.kind {
            SubjectKind::Body => "body",
            SubjectKind::Tie => "tie",
            SubjectKind::Contact => "contact",
        };
        write!(f, "{kind} \"{}\"", self.name)
    }
}

/// A number of three digits.
fn digits(x: f64) -> String {
    short(x, 0.0)
}

/// A share in percent.
fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

/// A place: "(0, 0.5)".
fn place(x: &[f64]) -> String {
    format!("({})", x.iter().map(|v| digits(*v)).collect::<Vec<_>>().join(", "))
}

impl Display for Warning {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::CornerValues { .. } | Self::Overlap { .. } | Self::Adjusted { .. } | Self::Locking { .. } | Self::CoarseValues { .. } => {
                stated(self, f)
            }
            Self::TooFewFunctions { of, slave, functions, body, motions, .. } => {
                write!(f, "{of}: {functions} functions on {slave} do not hold {body}, which can still move: {}", motions.join(", "))
            }
            Self::ThinCells { of, aspect, element, .. } => {
                write!(f, "{of} has thin cells: element {element} is {} times as long as it is high", digits(*aspect))
            }
            Self::PatchTest { of, element, missed, .. } => {
                write!(f, "the Gauss points of {of} miss {} of the stress of linear fields on element {element}", percent(*missed))
            }
            Self::PartUncovered { of, slave, share } => {
                write!(f, "{} of {slave} meets no master of {of}: facets end beside each other, and nothing ties it", percent(*share))
            }
            Self::Facets { of, sag, gap } => {
                write!(f, "{of}: facets leave the surface that they stand for by {}, of a mean gap of {}", digits(*sag), digits(*gap))
            }
            Self::DualConstants { .. } | Self::MixedMultiplier { .. } | Self::RoundKink { .. } | Self::UnevenGap { .. } => {
                multiplier(self, f)
            }
            Self::HardlyHeld { of, motions, share } => {
                let (motions, share) = (motions.join(", "), digits(*share));
                write!(f, "{of} is held in {motions} only by springs {share} as stiff as the bodies: round-off grows accordingly")
            }
            Self::FluxJump { of, x, share } => {
                write!(f, "the flux of the exact solution jumps in {of} at {} by {} of its largest", place(x), percent(*share))
            }
            Self::FacetsApart(found) => facets_apart(found, f),
            Self::Inexact(found) => inexact(found, f),
            Self::Integration { of, error } => {
                write!(f, "the integration of {of} is inexact: its consistency error is {}", percent(*error))
            }
            Self::Unbalanced { of, moved } => {
                write!(
                    f,
                    "the forces of mixed integration of {of} on both bodies differ, and springs that take the difference let them move by {}",
                    digits(*moved)
                )
            }
            Self::LeftOpen { of } => write!(f, "pieces of the exact solution meet so near to {of} that it is open which one is its own"),
            Self::Sliding { of, error } => {
                write!(f, "{of} slides too far for small kinematics: gaps are wrong by {} of what is closed", percent(*error))
            }
            Self::Rounding { of, soft, contrast, condition, error } => {
                let [contrast, condition, error] = [digits(*contrast), digits(*condition), percent(*error)];
                write!(f, "rounding may be {error} at a condition number of {condition}: {of} is {contrast} times as stiff as {soft}")
            }
            Self::CoarseZone { of, closed, across, least } => match across {
                Some(n) => {
                    let n = if *n < 0.1 { "less than 0.1".into() } else { format!("about {n:.1}") };
                    write!(f, "the zone of {of} is too coarse: {n} functions of the slave lie across it, fewer than {least}")
                }
                None => write!(f, "the zone of {of} is too coarse: {closed} functions of the slave carry it, fewer than {least}"),
            },
            Self::LostMoment { of, apart, moment, share } => {
                let (apart, moment) = (digits(*apart), digits(*moment));
                write!(f, "{of} loses the moment {moment}, {}: its sides are up to {apart} apart", percent(*share))
            }
            Self::LostParts { of, elements, x: [x, y, z] } => write!(
                f,
                "pieces of integration of {of} lose a part of {elements} elements that face the opponent, the first at {}",
                place(&[*x, *y, *z])
            ),
            Self::SoftPenalty { of, apart, size, moved } => soft_penalty(of, [*apart, *size, *moved].map(digits), f),
            Self::CoarseTie { of, apart, moved } => coarse_tie(of, [*apart, *moved].map(digits), f),
            Self::GapPressure { .. } | Self::WavyFacets { .. } | Self::Tension { .. } => at_points(self, f),
            Self::HeldWithin { of, depth, x } => {
                write!(f, "{of}: its slave side is held {} deep in what it faces at {}", digits(*depth), place(x))
            }
            Self::Kinematics { of, strain, rotation, allowed } => kinematics(of, [strain, rotation], *allowed, f),
        }
    }
}

/// Warnings about multipliers in words.
fn multiplier(warning: &Warning, f: &mut Formatter<'_>) -> Result {
    match warning {
        Warning::DualConstants { of, slave, degree } => {
            write!(f, "the dual multiplier of {of} holds constants only on {slave} of degree {degree}: errors fall as at degree 2")
        }
        Warning::MixedMultiplier { of, slave, degree, multiplier, order } => write!(
            f,
            "mixed integration of {of} with a multiplier of degree {multiplier} on {slave} of degree {degree}: errors of u may fall with order {order}"
        ),
        Warning::RoundKink { of, slave } => {
            write!(
                f,
                "the multiplier of {of} runs round an edge of {slave}: tractions jump there, and those of a constant stress are not held"
            )
        }
        Warning::UnevenGap { of, slave, share } => write!(
            f,
            "the sides of {of} are apart by unlike distances along {slave}: its multiplier may be off by {} of the stress of linear fields",
            percent(*share)
        ),
        _ => Ok(()),
    }
}

/// Warnings about pressures at points in words.
fn at_points(warning: &Warning, f: &mut Formatter<'_>) -> Result {
    match warning {
        Warning::GapPressure { of, pressure, from_gap, gap, x } => {
            let [pressure, from_gap, gap] = [pressure, from_gap, gap].map(|v| digits(*v));
            write!(f, "pressures of {of} at points are not the stress: at {} {from_gap} of {pressure} is from a gap of {gap}", place(x))
        }
        Warning::WavyFacets { of, height, wave, pressure } => {
            let [height, wave, pressure] = [height, wave, pressure].map(|v| digits(*v));
            write!(f, "pressures of {of} at points have waves of {wave}, of {pressure}: its facets leave their surface by {height}")
        }
        Warning::Tension { of, least, largest } => {
            let [least, largest] = [least, largest].map(|v| digits(*v));
            write!(f, "{of} pulls: its pressure falls to {least} beside {largest}, as its cone does not hold it at all points")
        }
        _ => Ok(()),
    }
}

/// Warnings about statements and discretisations in words.
fn stated(warning: &Warning, f: &mut Formatter<'_>) -> Result {
    match warning {
        Warning::CornerValues { sides: [a, b], component, values, x, t, .. } => {
            let ([u, v], at, t) = (values.map(digits), place(x), digits(*t));
            write!(f, "component {component} is {u} on {a} and {v} on {b}, which are tied, in their common corner {at} at t = {t}")
        }
        Warning::Overlap { of, slave, depth, x, .. } => {
            let (depth, at) = (digits(*depth), place(x));
            write!(f, "{of}: {slave} lies {depth} deep in its opponent at {at}, more than half of a body's thickness")
        }
        Warning::Adjusted { of, mean, explained } => {
            let [mean, explained] = [*mean, *explained].map(digits);
            write!(
                f,
                "{of} closes {mean} between its surfaces in the mean, of which facets explain {explained}: a fit that was drawn is lost"
            )
        }
        Warning::Locking { of, ratio } => {
            write!(
                f,
                "{of} of degree 1 is too stiff: its material resists changes of volume {} times as much as those of shape",
                digits(*ratio)
            )
        }
        Warning::CoarseValues { side, component, t, error, .. } => {
            let (t, error) = (digits(*t), percent(*error));
            write!(f, "functions of {side} miss {error} of the values prescribed of component {component} at t = {t}")
        }
        _ => Ok(()),
    }
}

fn facets_apart(FacetsApart { sides, mean, greatest, explained, is_tied }: &FacetsApart, f: &mut Formatter<'_>) -> Result {
    let tied = if *is_tied { "they are tied because they are named" } else { "they are not tied" };
    let [mean, greatest, explained] = [mean, greatest, explained].map(|x| digits(*x));
    write!(f, "{} are {mean} apart on average, up to {greatest}; faceting would explain {explained}: {tied}", sides.join(", "))
}

fn soft_penalty(of: &Subject, [apart, size, moved]: [String; 3], f: &mut Formatter<'_>) -> Result {
    let word = if of.kind == SubjectKind::Contact { "deep in each other" } else { "apart in the mean" };
    write!(f, "the penalty of {of} is soft: bodies are {apart} {word}, of a size of {size} and displacements up to {moved}")
}

fn coarse_tie(of: &Subject, [apart, moved]: [String; 2], f: &mut Formatter<'_>) -> Result {
    write!(f, "{of} is too coarse: its sides come apart by {apart} between the functions of its multiplier, of displacements up to {moved}")
}

fn kinematics(of: &Subject, beyond: [&Option<Beyond>; 2], allowed: f64, f: &mut Formatter<'_>) -> Result {
    write!(f, "{of} deforms too far for small kinematics")?;
    let mut found = beyond.into_iter().zip(["strains", "rotations"]).filter_map(|(b, word)| Some((b.as_ref()?, word)));
    found.try_for_each(|(b, word)| write!(f, "; {word} up to {}, beyond {allowed} in {}", digits(b.largest), percent(b.share)))
}

fn inexact(found: &Inexact, f: &mut Formatter<'_>) -> Result {
    match &found.of {
        Integral::Load { name, .. } => write!(f, "the load {name}")?,
        Integral::Spring { name, component, .. } => write!(f, "the springs of {name} along component {component}")?,
        Integral::Foundation { name, component, .. } => write!(f, "the foundation of body \"{name}\" along component {component}")?,
        Integral::Prescribed { side, component, .. } => write!(f, "the value of component {component} prescribed on {side}")?,
        Integral::Modulus { name, .. } => write!(f, "the modulus of body \"{name}\"")?,
    }
    write!(f, " is integrated inexactly at t = {}, by {}", digits(found.t), percent(found.error))
}
