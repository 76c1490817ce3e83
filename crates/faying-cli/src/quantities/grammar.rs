//! The grammar of quantities: `u.y at [1.0, 0.5] in upper`, `stress.yy.max`, `contact.pad.force.y`.

use super::cut::{self, CutSum};
use super::fields::FieldName;
use super::later::later;

/// Point at which a field is evaluated.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum At {
    /// No point: the field as a whole.
    Everywhere,
    /// A point, one formula per coordinate.
    Point(Vec<String>),
    /// A named point of a mesh.
    Tag(String),
}

/// Reduction of a field to a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduce {
    /// No reduction: a single value at a point, or both extremes if a check holds over all.
    None,
    /// The least value over the closed elements.
    Min,
    /// The largest value over the closed elements.
    Max,
    /// The least value at the points of integration.
    MinGauss,
    /// The largest value at the points of integration.
    MaxGauss,
}

/// Kind of a quantity, with its data.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum QuantityKind {
    /// A field at a point, or its extreme.
    Field {
        /// The field.
        field: FieldName,
        /// The centre of its directions, one formula per coordinate; empty of fields without one.
        about: Vec<String>,
        /// The point.
        at: At,
        /// The patch; `None`: the first that holds the point, or all.
        patch: Option<String>,
        /// Least or largest value.
        reduce: Reduce,
    },
    /// lambda of an interface, or the pressure -lambda of a contact, at a point of its slave side.
    Multiplier {
        /// Whether it is the pressure of a contact.
        pressure: bool,
        /// The interface or contact.
        name: String,
        /// Component of an interface's multiplier.
        component: Option<usize>,
        /// The point.
        at: At,
    },
    /// Length (area in 3D) of a side.
    SideMeasure(String),
    /// A component of the force of the stresses on a side (elasticity), or the flux through it (`None`).
    SideForce(String, Option<usize>),
    /// A sum over a straight cut between two points; the patch: `None` for all.
    Cut(CutSum, [Vec<String>; 2], Option<String>),
    /// The inf-sup constant of a multiplier, found by studies.
    Beta(String),
    /// The rate of a quantity, found by studies.
    Rate(String),
    /// A number of the result by its path.
    Path(Vec<String>),
    /// A quantity of the language that is not built: its path, and what there is instead.
    Later(Vec<String>, &'static str),
}

/// A quantity and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Text as written.
    pub text: String,
    /// Parsed quantity.
    pub kind: QuantityKind,
}

/// Error of a text that is no quantity.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct GrammarError {
    /// The error in words.
    pub message: String,
}

fn wrong<T>(message: impl Into<String>) -> Result<T, GrammarError> {
    Err(GrammarError { message: message.into() })
}

/// The axis of a letter x, y, z.
pub fn axis(letter: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|&a| a == letter)
}

/// First parts of the names of fields.
const FIELDS: &[&str] = &["u", "displacement", "flux", "stress", "strain", "principal", "von_mises"];

/// Splits a dotted path into parts; a quoted part may hold dots and blanks.
pub fn parts(path: &str) -> Result<Vec<String>, GrammarError> {
    let (mut parts, mut part, mut quoted) = (Vec::new(), String::new(), false);
    for c in path.chars() {
        match c {
            '"' => quoted = !quoted,
            '.' if !quoted => parts.push(std::mem::take(&mut part)),
            _ => part.push(c),
        }
    }
    parts.push(part);
    if quoted || parts.iter().any(String::is_empty) {
        return wrong(format!("`{path}` is no path: parts are joined by single dots, quotes come in pairs"));
    }
    Ok(parts)
}

/// Finds the first `word` that stands alone, outside brackets and quotes.
pub(super) fn keyword(text: &str, word: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut depth, mut quoted) = (0i32, false);
    for (k, &b) in bytes.iter().enumerate() {
        match b {
            b'"' => quoted = !quoted,
            b'[' | b'(' if !quoted => depth += 1,
            b']' | b')' if !quoted => depth -= 1,
            b' ' if !quoted && depth == 0 => {
                let rest = &text[k + 1..];
                if rest.starts_with(word) && rest[word.len()..].starts_with([' ', '[']) {
                    return Some(k);
                }
            }
            _ => {}
        }
    }
    None
}

pub(super) fn coordinates(text: &str) -> Result<Vec<String>, GrammarError> {
    let inner = text.strip_prefix('[').and_then(|t| t.strip_suffix(']'));
    let Some(inner) = inner else { return wrong(format!("`{text}` is no point; write at [x, y], in space [x, y, z]")) };
    let (mut list, mut item, mut depth) = (Vec::new(), String::new(), 0i32);
    for c in inner.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                list.push(std::mem::take(&mut item).trim().to_string());
                continue;
            }
            _ => {}
        }
        item.push(c);
    }
    list.push(item.trim().to_string());
    if list.iter().any(String::is_empty) {
        return wrong(format!("`{text}` is no point; write at [x, y], in space [x, y, z]"));
    }
    Ok(list)
}

/// The axes of two letters x, y, z.
pub(super) fn axes(letters: &str) -> Option<(usize, usize)> {
    let list: Vec<Option<usize>> = letters.chars().map(|l| axis(&l.to_string())).collect();
    match list.as_slice() {
        [Some(i), Some(j)] => Some((*i, *j)),
        _ => None,
    }
}

/// Radial 0 and tangential 1 of the letters r, t.
fn polar(letters: &str) -> Option<Vec<usize>> {
    letters.chars().map(|l| ['r', 't'].iter().position(|&known| known == l)).collect()
}

fn field(head: &[String]) -> Result<Option<FieldName>, GrammarError> {
    let rest: Vec<&str> = head[1..].iter().map(String::as_str).collect();
    Ok(Some(match (head[0].as_str(), rest.as_slice()) {
        ("u" | "displacement", []) => FieldName::U(None),
        ("u" | "displacement", ["norm"]) => FieldName::Norm,
        ("u" | "displacement", [c]) => match (axis(c), polar(c).as_deref()) {
            (Some(c), _) => FieldName::U(Some(c)),
            (None, Some(&[a])) => FieldName::PolarU(a),
            _ => return wrong(format!("unknown component `{c}` of u; components are x, y, z, norm, and r, t about a centre")),
        },
        ("flux", [c]) => match axis(c) {
            Some(c) => FieldName::Flux(c),
            None => return wrong(format!("unknown component `{c}` of the flux; components are x, y, z")),
        },
        ("flux", []) => return wrong("the flux has components; write flux.x or flux.y"),
        (name @ ("stress" | "strain"), [c]) => match (axes(c), polar(c).as_deref()) {
            (Some((i, j)), _) if name == "stress" => FieldName::Stress(i, j),
            (Some((i, j)), _) => FieldName::Strain(i, j),
            (None, Some(&[a, b])) if name == "stress" => FieldName::PolarStress(a, b),
            (None, Some(&[a, b])) => FieldName::PolarStrain(a, b),
            _ => {
                let known = "components are xx, yy, zz, xy, yz, xz, and rr, tt, rt about a centre";
                return wrong(format!("unknown component `{c}` of the {name}; {known}"));
            }
        },
        (name @ ("stress" | "strain"), []) => {
            return wrong(format!("the {name} has components; write {name}.xx, {name}.yy, {name}.xy, ..."));
        }
        ("principal", ["1"]) => FieldName::Principal(0),
        ("principal", ["2"]) => FieldName::Principal(1),
        ("principal", ["3"]) => FieldName::Principal(2),
        ("principal", _) => return wrong("the principal stresses are principal.1, principal.2 and principal.3, the largest first"),
        ("von_mises", []) => FieldName::VonMises,
        ("u" | "displacement" | "flux" | "stress" | "strain" | "von_mises", _) => {
            return wrong(format!("`{}` has no part `{}`", head[0], rest.join(".")));
        }
        _ => return Ok(None),
    }))
}

impl Quantity {
    /// Parses a quantity.
    ///
    /// # Errors
    /// [`GrammarError`] in words; a path that does not exist is found later, against a result.
    pub fn parse(text: &str) -> Result<Self, GrammarError> {
        let trimmed = text.trim();
        if trimmed.is_empty() {
            return wrong("an empty text is no quantity");
        }
        for (word, rest) in [("at", "[x, y]"), ("in", "PATCH"), ("about", "[x, y]")] {
            // a patch may have the name of a word
            let alone = |head: &&str| head.ends_with(' ') && !head.trim_end().ends_with(" in");
            if let Some(head) = trimmed.strip_suffix(word).filter(alone) {
                return wrong(format!("nothing stands after `{word}`; write {} {word} {rest}", head.trim()));
            }
        }
        // the inner quantity is parsed when it is prepared
        if let Some(inner) = trimmed.strip_prefix("rate.").filter(|inner| !inner.is_empty()) {
            return Ok(Self { text: text.to_string(), kind: QuantityKind::Rate(inner.to_string()) });
        }
        let (before, patch) = match keyword(trimmed, "in") {
            Some(end) => {
                let name = trimmed[end + 4..].trim();
                if let Some(k) = keyword(name, "at") {
                    let (patch, place) = (name[..k].trim(), name[k + 3..].trim());
                    return wrong(format!("`at` stands before `in`; write `{} at {place} in {patch}`", trimmed[..end].trim()));
                }
                if name.contains(char::is_whitespace) && !name.contains('"') {
                    return wrong(format!("`{name}` is no patch; a quantity ends with `in PATCH`"));
                }
                (trimmed[..end].trim(), Some(parts(name)?.join(".")))
            }
            None => (trimmed, None),
        };
        if let Some(k) = keyword(before, "cut") {
            let (sum, ends) = cut::parse(before[..k].trim(), before[k + 4..].trim())?;
            return Ok(Self { text: text.to_string(), kind: QuantityKind::Cut(sum, ends, patch) });
        }
        // either may stand first
        let (before, centre, last) = match (keyword(before, "at"), keyword(before, "about")) {
            (Some(at), Some(about)) if about > at => (before[..about].trim(), before[about + 6..].trim(), ""),
            (at, Some(about)) => {
                let end = at.unwrap_or(before.len());
                (before[..about].trim(), before[about + 6..end].trim(), before[end..].trim())
            }
            (_, None) => (before, "", ""),
        };
        let about = if centre.is_empty() { Vec::new() } else { coordinates(centre)? };
        let whole = if last.is_empty() { before.to_owned() } else { format!("{before} {last}") };
        let (head, at) = match keyword(&whole, "at") {
            Some(k) => {
                let place = whole[k + 3..].trim();
                let at = if place.starts_with('[') { At::Point(coordinates(place)?) } else { At::Tag(place.trim_matches('"').to_string()) };
                (whole[..k].trim(), at)
            }
            None => (whole.as_str(), At::Everywhere),
        };
        let mut path = parts(head)?;
        if path.iter().any(|p| p.contains(['[', ']', '(', ')', '+', '*'])) || head.contains(' ') && !head.contains('"') {
            return wrong("names of quantities have no blanks, brackets or signs outside of quotes");
        }
        let kind = Self::kind(&mut path, at, about, patch)?;
        Ok(Self { text: text.to_string(), kind })
    }

    fn kind(path: &mut Vec<String>, at: At, about: Vec<String>, patch: Option<String>) -> Result<QuantityKind, GrammarError> {
        let placed = at != At::Everywhere;
        if let Some(instead) = later(path) {
            return Ok(QuantityKind::Later(std::mem::take(path), instead));
        }
        if FIELDS.contains(&path[0].as_str()) {
            let words: Vec<&str> = path.iter().map(String::as_str).collect();
            let (reduce, length) = match words.as_slice() {
                [.., "min"] => (Reduce::Min, 1),
                [.., "max"] => (Reduce::Max, 1),
                [.., "min", "gauss"] => (Reduce::MinGauss, 2),
                [.., "max", "gauss"] => (Reduce::MaxGauss, 2),
                _ => (Reduce::None, 0),
            };
            if reduce != Reduce::None {
                path.truncate(path.len() - length);
                if placed {
                    return wrong("a value at a point has no extremes; leave out `.min` and `.max`, or `at`");
                }
            }
            if let Some(field) = field(path)? {
                let name = path.join(".");
                return match (field.is_polar(), about.is_empty()) {
                    (true, true) => wrong(format!("`{name}` has a centre; write {name} about [0, 0]")),
                    (false, false) => wrong(format!("`{name}` takes no `about`; u.r, u.t, stress.rr, stress.tt, stress.rt and strains do")),
                    _ => Ok(QuantityKind::Field { field, about, at, patch, reduce }),
                };
            }
        }
        if !about.is_empty() {
            return wrong(format!("`{}` takes no `about`; u.r, u.t, stress.rr, stress.tt, stress.rt and strains do", path.join(".")));
        }
        if patch.is_some() {
            return wrong(format!("`{}` takes no `in PATCH`; only u, flux, stress, strain, principal and von_mises do", path.join(".")));
        }
        match (path[0].as_str(), path.len()) {
            ("infsup", n) if n > 1 && !placed => {
                return match path.last().map(String::as_str) {
                    Some("beta") if n == 3 => Ok(QuantityKind::Beta(path[1].clone())),
                    _ => wrong("inf-sup constants are written infsup.PAIRING.beta, such as infsup.p/p-2.beta"),
                };
            }
            ("interface", 3 | 4) if placed && path[2] == "lambda" => {
                let component = match path.get(3) {
                    None => None,
                    Some(c) => match axis(c) {
                        Some(c) => Some(c),
                        None => return wrong(format!("unknown component `{c}` of lambda; components are x, y, z")),
                    },
                };
                return Ok(QuantityKind::Multiplier { pressure: false, name: path[1].clone(), component, at });
            }
            ("contact", 3) if placed && matches!(path[2].as_str(), "pressure" | "lambda") => {
                return Ok(QuantityKind::Multiplier { pressure: path[2] == "pressure", name: path[1].clone(), component: None, at });
            }
            _ => {}
        }
        if placed {
            return wrong(format!(
                "`{}` takes no `at`; u, flux, stress, strain, principal, von_mises, interface.NAME.lambda and contact.NAME.pressure do",
                path.join(".")
            ));
        }
        Ok(match (path[0].as_str(), path.len()) {
            ("length" | "area", n) if n > 2 => QuantityKind::SideMeasure(path[1..].join(".")),
            ("force", n) if n > 2 => match axis(&path[n - 1]) {
                Some(c) if n > 3 => QuantityKind::SideForce(path[1..n - 1].join("."), Some(c)),
                _ => QuantityKind::SideForce(path[1..].join("."), None),
            },
            _ => QuantityKind::Path(std::mem::take(path)),
        })
    }

    /// Whether the value is known to studies only.
    pub fn is_study(&self) -> bool {
        matches!(self.kind, QuantityKind::Beta(_) | QuantityKind::Rate(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &str) -> QuantityKind {
        Quantity::parse(text).unwrap().kind
    }

    #[test]
    fn fields_have_components_places_patches_and_extremes() {
        assert_eq!(
            kind("u.y at [1.0, 0.5] in upper"),
            QuantityKind::Field {
                field: FieldName::U(Some(1)),
                about: Vec::new(),
                at: At::Point(vec!["1.0".into(), "0.5".into()]),
                patch: Some("upper".into()),
                reduce: Reduce::None
            }
        );
        assert_eq!(
            kind("displacement.x.max"),
            QuantityKind::Field { field: FieldName::U(Some(0)), about: Vec::new(), at: At::Everywhere, patch: None, reduce: Reduce::Max }
        );
        assert_eq!(
            kind("stress.xy.min in a"),
            QuantityKind::Field {
                field: FieldName::Stress(0, 1),
                about: Vec::new(),
                at: At::Everywhere,
                patch: Some("a".into()),
                reduce: Reduce::Min
            }
        );
        assert_eq!(
            kind("von_mises.max.gauss"),
            QuantityKind::Field {
                field: FieldName::VonMises,
                about: Vec::new(),
                at: At::Everywhere,
                patch: None,
                reduce: Reduce::MaxGauss
            }
        );
        assert_eq!(
            kind("von_mises at TIP"),
            QuantityKind::Field {
                field: FieldName::VonMises,
                about: Vec::new(),
                at: At::Tag("TIP".into()),
                patch: None,
                reduce: Reduce::None
            }
        );
        assert_eq!(
            kind("u at [max(a, b), 0]"),
            QuantityKind::Field {
                field: FieldName::U(None),
                about: Vec::new(),
                at: At::Point(vec!["max(a, b)".into(), "0".into()]),
                patch: None,
                reduce: Reduce::None
            }
        );
    }

    #[test]
    fn a_centre_stands_before_or_behind_the_place() {
        let about = vec!["0".to_owned(), "a + 1".to_owned()];
        let at = At::Point(vec!["1".into(), "2".into()]);
        let wanted =
            |at, patch, reduce| QuantityKind::Field { field: FieldName::PolarStress(0, 1), about: about.clone(), at, patch, reduce };
        let inside = Some("ring".to_owned());
        assert_eq!(kind("stress.rt about [0, a + 1] at [1, 2] in ring"), wanted(at.clone(), inside.clone(), Reduce::None));
        assert_eq!(kind("stress.rt at [1, 2] about [0, a + 1]"), wanted(at, None, Reduce::None));
        assert_eq!(kind("stress.rt.max about [0, a + 1] in ring"), wanted(At::Everywhere, inside, Reduce::Max));
        assert_eq!(kind("force.lower.top.y"), QuantityKind::SideForce("lower.top".into(), Some(1)));
        assert_eq!(kind("force.lower.top"), QuantityKind::SideForce("lower.top".into(), None));
    }

    #[test]
    fn multipliers_sides_and_paths_are_told_apart() {
        assert_eq!(
            kind("interface.arc.lambda.x at [1,2]"),
            QuantityKind::Multiplier {
                pressure: false,
                name: "arc".into(),
                component: Some(0),
                at: At::Point(vec!["1".into(), "2".into()])
            }
        );
        assert_eq!(kind("length.lower.top"), QuantityKind::SideMeasure("lower.top".into()));
        assert_eq!(kind("area.lower"), QuantityKind::Path(vec!["area".into(), "lower".into()]));
        assert_eq!(kind("contact.pad.pressure.max"), QuantityKind::Path(["contact", "pad", "pressure", "max"].map(String::from).to_vec()));
        assert!(Quantity::parse("rate.error.u.L2").unwrap().is_study());
        assert_eq!(kind("rate.u.y at [0, 1] in a"), QuantityKind::Rate("u.y at [0, 1] in a".into()));
        assert!(Quantity::parse("infsup.p/p-2.beta").unwrap().is_study());
        assert_eq!(
            kind("reaction.bracket.\"top face\".y"),
            QuantityKind::Path(["reaction", "bracket", "top face", "y"].map(String::from).to_vec())
        );
    }

    #[test]
    fn patches_may_have_the_names_of_words() {
        for name in ["in", "at", "about"] {
            assert!(Quantity::parse(&format!("u.x at [0, 0] in {name}")).is_ok(), "{name}");
        }
    }

    #[test]
    fn what_is_no_quantity_says_why() {
        for (text, part) in [
            ("", "empty"),
            ("u.q", "components are x, y, z"),
            ("stress at [0,0]", "write stress.xx"),
            ("stress.xw", "components are xx"),
            ("strain", "write strain.xx"),
            ("principal.4", "principal.1, principal.2 and principal.3"),
            ("stress.rr at [1, 0]", "write stress.rr about [0, 0]"),
            ("stress.xx about [0, 0] at [1, 0]", "takes no `about`"),
            ("energy about [0, 0]", "takes no `about`"),
            ("energy at [0,0]", "takes no `at`"),
            ("energy in lower", "takes no `in PATCH`"),
            ("u.x.max at [0, 0]", "no extremes"),
            ("u.x at [0,, 1]", "no point"),
            ("u.y in b at [1, 0]", "write `u.y at [1, 0] in b`"),
            ("u.y in \"b c\" at tip", "write `u.y at tip in \"b c\"`"),
            ("u.x at", "nothing stands after `at`; write u.x at [x, y]"),
            ("infsup.p/p-2.gamma", "infsup.PAIRING.beta"),
            ("a..b", "no path"),
        ] {
            let error = Quantity::parse(text).unwrap_err().message;
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
