//! Names of sides: the sides of a patch, their aliases, and references such as `lower.bottom`.

use super::family::Family;
use super::part::FilePart;
use super::reader::Reader;
use super::tree::{Node, Value};
use super::types::{Patch, Shape, SideRef};
use crate::errors::{Diagnostic, nearest};
use crate::place::Located;
use faying::geometry::collapsed_faces;

const ALL: [&str; 6] = ["u0", "u1", "v0", "v1", "w0", "w1"];
const PLANE: [(&str, &str); 4] = [("left", "u0"), ("right", "u1"), ("bottom", "v0"), ("top", "v1")];
const SPATIAL: [(&str, &str); 6] = [("left", "u0"), ("right", "u1"), ("front", "v0"), ("back", "v1"), ("bottom", "w0"), ("top", "w1")];

/// The sides of a shape, without collapsed edges; of a mesh its tags.
pub(super) fn sides_of(shape: &Shape, dimension: usize) -> Vec<&str> {
    let collapsed: Vec<usize> = match shape {
        _ if shape.mesh_part().is_some() => return shape.part().map_or(Vec::new(), FilePart::tags),
        Shape::DiscSector { .. } => vec![2],
        Shape::SphereOctant { .. } => vec![3],
        Shape::Nurbs { degree, knots, points, .. } => collapsed(&degree.value, knots.iter().map(|u| u.len()), points),
        _ => shape.part().and_then(FilePart::spline).map_or(Vec::new(), |p| collapsed(&p.degree, p.knots.iter().map(Vec::len), &p.points)),
    };
    (0..2 * dimension).filter(|face| !collapsed.contains(face)).map(|face| ALL[face]).collect()
}

/// The collapsed sides of a net, numbered u0, u1, v0, ..., with these degrees and numbers of knots.
fn collapsed<P: AsRef<[f64]>>(degree: &[usize], knots: impl Iterator<Item = usize>, points: &[P]) -> Vec<usize> {
    let counts: Vec<usize> = knots.zip(degree).map(|(u, p)| u.saturating_sub(p + 1)).collect();
    collapsed_faces(&counts, points).into_iter().map(|f| 2 * f.axis + f.end).collect()
}

/// Short names of the sides of a box with the sides.
fn aliases(dimension: usize) -> &'static [(&'static str, &'static str)] {
    if dimension == 2 { &PLANE } else { &SPATIAL }
}

/// The short name of a side of a box: left, right, bottom, top, front, back; others stay.
pub(crate) fn alias(side: &str, dimension: usize) -> &str {
    aliases(dimension).iter().find(|(_, s)| *s == side).map_or(side, |(a, _)| *a)
}

/// The side with a name or an alias.
pub(crate) fn canonical(side: &str, dimension: usize) -> Option<&'static str> {
    let all = ALL[..2 * dimension].iter().find(|s| **s == side).copied();
    all.or_else(|| aliases(dimension).iter().find(|(a, _)| *a == side).map(|(_, s)| *s))
}

/// The sides that meet in an edge or a corner such as u0w1, in the order u, v, w; `None` for other words.
fn rim_of(side: &str, dimension: usize) -> Option<Vec<&'static str>> {
    let word = |k: usize| side.get(2 * k..2 * k + 2).and_then(|w| ALL[..2 * dimension].iter().copied().find(|s| *s == w));
    let mut all: Vec<&'static str> = (0..side.len() / 2).map(word).collect::<Option<_>>()?;
    all.sort_unstable();
    let apart = all.windows(2).all(|w| w[0].as_bytes()[0] != w[1].as_bytes()[0]);
    (2 * all.len() == side.len() && all.len() > 1 && apart).then_some(all)
}

/// Patch or patches that the name of a side begins with.
enum NameOwner<'a> {
    /// A patch, and the rest of the text.
    Patch(usize, &'a str),
    /// All patches of a file, and the rest of the text.
    Family(usize, &'a str),
}

// the longest name that the text begins with, followed by a dot or by nothing
fn owner<'a>(text: &'a str, patches: &[Patch], families: &[Family]) -> Option<NameOwner<'a>> {
    let rest = |name: &str| -> Option<&'a str> {
        let after = match text.strip_prefix('"') {
            Some(inner) => inner.strip_prefix(name)?.strip_prefix('"')?,
            None => text.strip_prefix(name)?,
        };
        if after.is_empty() { Some("") } else { after.strip_prefix('.') }
    };
    let of_patches = patches.iter().enumerate().filter_map(|(k, p)| Some((p.name.len(), NameOwner::Patch(k, rest(&p.name.value)?))));
    let of_families = families.iter().enumerate().filter(|(_, f)| f.patches.len() != 1);
    let of_families = of_families.filter_map(|(k, f)| Some((f.name.len(), NameOwner::Family(k, rest(&f.name)?))));
    of_patches.chain(of_families).max_by_key(|(length, _)| *length).map(|(_, named)| named)
}

// a quoted tag may hold dots and blanks
fn unquoted(side: &str) -> &str {
    side.strip_prefix('"').and_then(|s| s.strip_suffix('"')).unwrap_or(side)
}

fn labelled(family: &Family, side: &str) -> Option<Vec<SideRef>> {
    family.labels.iter().find(|l| l.name == side).map(|l| l.sides.clone())
}

/// The sides that a text names; `None` if it names no side.
pub(super) fn find(text: &str, patches: &[Patch], families: &[Family], dimension: usize) -> Option<Vec<SideRef>> {
    match owner(text, patches, families)? {
        NameOwner::Family(k, rest) => labelled(&families[k], unquoted(rest)),
        NameOwner::Patch(k, rest) => of_patch(k, rest, patches, families, dimension).or_else(|| {
            // NAME.0 may be a label of the file, too
            let (family, label) = text.rsplit_once('.')?;
            labelled(families.iter().find(|f| f.name == family)?, label).filter(|_| rest.is_empty())
        }),
    }
}

// precedence: u0, u1, .., then names of the file, then left, right, ..
fn of_patch(k: usize, rest: &str, patches: &[Patch], families: &[Family], dimension: usize) -> Option<Vec<SideRef>> {
    let side = unquoted(rest);
    let known = sides_of(&patches[k].geometry.shape, dimension);
    let one = |side: &str| vec![SideRef { patch: k, side: side.to_owned() }];
    if known.contains(&side) {
        return Some(one(side));
    }
    let family = families.iter().find(|f| f.patches.contains(&k));
    if let Some(sides) = family.and_then(|f| labelled(f, side)) {
        let own: Vec<SideRef> = sides.into_iter().filter(|s| s.patch == k).collect();
        if !own.is_empty() {
            return Some(own);
        }
    }
    if patches[k].geometry.shape.mesh_part().is_some() {
        return None;
    }
    canonical(side, dimension).filter(|s| known.contains(s)).map(one)
}

// the sides that meet in an edge or a corner of the patch
fn edge(rest: &str, patch: &Patch, dimension: usize) -> Option<String> {
    let shape = &patch.geometry.shape;
    if shape.mesh_part().is_some() {
        return None;
    }
    let known = sides_of(shape, dimension);
    rim_of(rest, dimension).filter(|r| r.iter().all(|s| known.contains(s))).map(|r| r.concat())
}

impl Reader {
    /// A side or a list of sides.
    pub fn sides(&mut self, node: &Node, what: &str, patches: &[Patch]) -> Vec<Located<SideRef>> {
        let mut out: Vec<Located<SideRef>> = Vec::new();
        match &node.value {
            Value::Text(text) => out.extend(self.side(node, text, what, patches)),
            Value::List(list) if !list.is_empty() => {
                for item in list {
                    let Value::Text(text) = &item.value else {
                        self.wrong_type(item, what, "a side or a list of sides", "");
                        continue;
                    };
                    for side in self.side(item, text, what, patches) {
                        if out.contains(&side) {
                            self.fault("E016", side.at, format!("`{}` is named twice in `{what}`", show(&side, patches)), "name it once");
                        } else {
                            out.push(side);
                        }
                    }
                }
            }
            _ => {
                let example = patches.first().map_or("lower", |p| p.name.as_str());
                self.wrong_type(node, what, "a side or a list of sides", format!("write {what} = \"{example}.v0\""));
            }
        }
        out
    }

    fn side(&mut self, node: &Node, text: &str, what: &str, patches: &[Patch]) -> Vec<Located<SideRef>> {
        let dimension = self.dimension;
        if let Some(sides) = find(text, patches, &self.families, dimension) {
            return sides.into_iter().map(|s| Located::new(s, node.at)).collect();
        }
        let shown: String = text.chars().take(60).collect();
        match owner(text, patches, &self.families) {
            None => self.no_patch(node, text, patches),
            Some(NameOwner::Family(k, rest)) => {
                let family = &self.families[k];
                let labels = family.labels.iter().map(|l| quoted(&l.name)).collect::<Vec<_>>().join(", ");
                let (name, n) = (family.name.clone(), family.patches.len());
                if n == 0 {
                    // its file could not be read, which was reported
                    return Vec::new();
                }
                let named =
                    if labels.is_empty() { "none of their sides has a name".to_owned() } else { format!("named sides are {labels}") };
                let side = rest.rsplit('.').next().filter(|side| !side.is_empty()).unwrap_or("u0");
                let message = format!("there is no side `{shown}`; {name:?} is a file of {n} patches, {named}");
                self.fault("E021", node.at, message, format!("write {name}.0.{side} for a side of the first patch"));
            }
            Some(NameOwner::Patch(k, rest)) => match edge(rest, &patches[k], dimension) {
                Some(side) if what == "on" => return vec![Located::new(SideRef { patch: k, side }, node.at)],
                Some(_) => {
                    let help =
                        format!("sides of {:?} are {}", patches[k].name.value, sides_of(&patches[k].geometry.shape, dimension).join(", "));
                    self.fault("E021", node.at, format!("`{shown}` is an edge or a corner; `{what}` takes sides"), help);
                }
                None => self.no_side(node, &shown, (what, k, rest), patches),
            },
        }
        Vec::new()
    }

    fn no_patch(&mut self, node: &Node, text: &str, patches: &[Patch]) {
        if self.broken.contains("patch") {
            return;
        }
        let name = text.rsplit_once('.').map_or(text, |(name, _)| name).trim_matches('"');
        if name == "all-outer" {
            let d = Diagnostic::error(
                "E021",
                "\"all-outer\" stands alone, not in a list: it is every side that no other block names".to_owned(),
            );
            return self.push(node.at, d.with_help("a [[boundary]] takes it: on = \"all-outer\"; sides of other blocks are not in it"));
        }
        let names = patches.iter().map(|p| p.name.value.clone()).collect::<Vec<_>>();
        let mut d = Diagnostic::error("E021", format!("there is no patch {:?}", name.chars().take(60).collect::<String>()));
        if let Some(near) = nearest(name, names.iter().map(String::as_str)) {
            d = d.with_label(format!("did you mean {near:?}?"));
        }
        self.push(node.at, d.with_help(format!("sides are written PATCH.SIDE; patches are {}", some(&names))));
    }

    /// Reports a side that the patch with the number `k` does not have, asked for by the key `what`.
    fn no_side(&mut self, node: &Node, shown: &str, (what, k, rest): (&str, usize, &str), patches: &[Patch]) {
        let (dimension, name, shape) = (self.dimension, &patches[k].name.value, &patches[k].geometry.shape.value);
        if matches!(shape, Shape::File { parts, .. } if parts.is_empty()) {
            // its file could not be read, which was reported
            return;
        }
        let part = shape.mesh_part();
        let mut known: Vec<String> =
            part.map_or_else(|| sides_of(shape, dimension), FilePart::outer_tags).into_iter().map(quoted).collect();
        if let Some(family) = self.families.iter().find(|f| f.patches.contains(&k)) {
            let own = family.labels.iter().filter(|l| l.sides.iter().any(|s| s.patch == k));
            known.extend(own.map(|l| quoted(&l.name)));
        }
        let mesh = part.is_some();
        let inner: Vec<String> = match part {
            Some(part) if what == "on" => part.inner_tags().into_iter().map(quoted).collect(),
            _ => Vec::new(),
        };
        let list = match (mesh, known.is_empty()) {
            (true, true) => format!("no side of {name:?} is named in its file; \"all-outer\" is its whole boundary"),
            _ => format!("sides of {name:?} are {}", some(&known)),
        };
        let list = if inner.is_empty() { list } else { format!("{list}; points, edges and what lies inside: {}", some(&inner)) };
        known.extend(inner);
        let message = if rest.is_empty() {
            format!("`{shown}` names a patch, not a side; {list}")
        } else {
            format!("there is no side `{shown}`; {list}")
        };
        let help = match (shape, canonical(rest, dimension)) {
            (Shape::DiscSector { .. }, Some("v0")) => "v0 is the centre of the disc and no side",
            (Shape::DiscSector { .. }, _) if dimension == 3 && rest.contains("v0") => {
                "v0 is the centre of the disc: it is no side, and nothing can be given on its edges"
            }
            (Shape::Nurbs { .. }, Some(_)) => "this edge is collapsed to a point and no side",
            (Shape::File { .. }, Some(_)) if !mesh => "this side is collapsed and none",
            _ if mesh => {
                "tags with dots or blanks are quoted: PATCH.\"top face\"; \"all-outer\" is every side that stands in no other block"
            }
            _ if dimension == 2 => "in 2D left, right, bottom, top are u0, u1, v0, v1",
            _ => "in 3D left, right, front, back, bottom, top are u0, u1, v0, v1, w0, w1",
        };
        let mut d = Diagnostic::error("E021", message).with_help(help);
        if let Some(near) = nearest(unquoted(rest), known.iter().map(String::as_str)).filter(|_| mesh) {
            d = d.with_label(format!("did you mean {near}?"));
        }
        self.push(node.at, d);
    }
}

// a list of bounded length
fn some(names: &[String]) -> String {
    const MOST: usize = 20;
    match names.len() {
        n if n > MOST => format!("{}, .. ({n} in all)", names[..MOST].join(", ")),
        _ => names.join(", "),
    }
}

/// A name as it is written in references: quoted where it holds anything but letters, digits, `_`, `-`.
pub(crate) fn quoted(name: &str) -> String {
    let plain = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    if plain { name.to_owned() } else { format!("\"{name}\"") }
}

/// Returns the full name of a side, such as `lower.v0`.
pub(super) fn show(side: &SideRef, patches: &[Patch]) -> String {
    format!("{}.{}", patches.get(side.patch).map_or("?", |p| p.name.as_str()), quoted(&side.side))
}
