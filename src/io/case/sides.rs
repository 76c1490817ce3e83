//! Names of sides: which a patch has, their aliases, and references such as `lower.bottom`.

use super::reader::Reader;
use super::tree::{Node, Value};
use super::types::{Patch, Shape, SideRef};
use crate::io::errors::{Diagnostic, nearest};
use crate::io::place::Located;

/// Control points nearer than this share of the size are one point.
const SAME_POINT: f64 = 1e-12;

const ALL: [&str; 6] = ["u0", "u1", "v0", "v1", "w0", "w1"];
const PLANE: [(&str, &str); 4] = [("left", "u0"), ("right", "u1"), ("bottom", "v0"), ("top", "v1")];
const SPATIAL: [(&str, &str); 6] = [("left", "u0"), ("right", "u1"), ("front", "v0"), ("back", "v1"), ("bottom", "w0"), ("top", "w1")];

/// The sides of a shape; collapsed edges are none.
pub(super) fn sides_of(shape: &Shape, dimension: usize) -> Vec<&'static str> {
    ALL[..2 * dimension].iter().copied().filter(|s| !is_collapsed(shape, s, dimension)).collect()
}

fn is_collapsed(shape: &Shape, side: &str, dimension: usize) -> bool {
    match shape {
        Shape::DiscSector { .. } => side == "v0",
        Shape::SphereOctant { .. } => side == "v1",
        Shape::Nurbs { degree, knots, points, .. } => {
            let counts: Vec<usize> = knots.iter().zip(&degree.value).map(|(u, p)| u.len() - p - 1).collect();
            let Some(face) = ALL[..2 * dimension.min(counts.len())].iter().position(|s| *s == side) else { return false };
            let (axis, end) = (face / 2, face % 2);
            (0..counts.len()).filter(|&along| along != axis).any(|along| lines_are_points(points, &counts, (axis, end), along))
        }
        _ => false,
    }
}

/// Whether the lines along `along` of a face (axis, end) of a net are points; `counts` points per direction, the first fastest.
fn lines_are_points(points: &[Vec<f64>], counts: &[usize], (axis, end): (usize, usize), along: usize) -> bool {
    let stride = |k: usize| counts[..k].iter().product::<usize>();
    let index = |i: usize, k: usize| i / stride(k) % counts[k];
    let extent = |k: usize| points.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[k]), b.max(p[k])));
    let size = (0..points[0].len()).map(|k| extent(k).1 - extent(k).0).fold(0.0, f64::max);
    let on_face = (0..points.len()).filter(|&i| index(i, axis) == end * (counts[axis] - 1));
    on_face.into_iter().all(|i| {
        let first = i - index(i, along) * stride(along);
        points[i].iter().zip(&points[first]).all(|(a, b)| (a - b).abs() <= SAME_POINT * size)
    })
}

fn canonical(side: &str, dimension: usize) -> Option<&'static str> {
    let aliases: &[(&str, &'static str)] = if dimension == 2 { &PLANE } else { &SPATIAL };
    let all = ALL[..2 * dimension].iter().find(|s| **s == side).copied();
    all.or_else(|| aliases.iter().find(|(a, _)| *a == side).map(|(_, s)| *s))
}

/// The sides that meet in an edge or a corner such as u0w1, in the order u, v, w; none for other words.
fn rim_of(side: &str, dimension: usize) -> Option<Vec<&'static str>> {
    let word = |k: usize| side.get(2 * k..2 * k + 2).and_then(|w| ALL[..2 * dimension].iter().copied().find(|s| *s == w));
    let mut all: Vec<&'static str> = (0..side.len() / 2).map(word).collect::<Option<_>>()?;
    all.sort_unstable();
    let apart = all.windows(2).all(|w| w[0].as_bytes()[0] != w[1].as_bytes()[0]);
    (2 * all.len() == side.len() && all.len() > 1 && apart).then_some(all)
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
                    if let Some(side) = self.side(item, text, what, patches) {
                        if out.contains(&side) {
                            self.fault("E016", side.at, format!("`{}` is named twice in `{what}`", show(&side, patches)), "");
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

    fn side(&mut self, node: &Node, text: &str, what: &str, patches: &[Patch]) -> Option<Located<SideRef>> {
        let list = |d: usize, p: &Patch| sides_of(&p.geometry.shape, d).join(", ");
        let names = || patches.iter().map(|p| p.name.value.clone()).collect::<Vec<_>>().join(", ");
        let (name, side) = text.rsplit_once('.').unwrap_or((text, ""));
        let name = name.trim_matches('"');
        let shown: String = text.chars().take(60).collect();
        let Some(k) = patches.iter().position(|p| p.name.value == name) else {
            if self.broken.contains("patch") {
                return None;
            }
            let mut d = Diagnostic::error("E021", format!("there is no patch {:?}", name.chars().take(60).collect::<String>()));
            if let Some(near) = nearest(name, patches.iter().map(|p| p.name.as_str())) {
                d = d.with_label(format!("did you mean {near:?}?"));
            }
            self.push(node.at, d.with_help(format!("sides are written PATCH.SIDE; patches are {}", names())));
            return None;
        };
        let dimension = self.dimension;
        let known = sides_of(&patches[k].geometry.shape, dimension);
        match canonical(side, dimension).filter(|s| known.contains(s)) {
            Some(s) => Some(Located::new(SideRef { patch: k, side: s.to_owned() }, node.at)),
            None if rim_of(side, dimension).is_some_and(|r| r.iter().all(|s| known.contains(s))) => {
                if what != "on" {
                    let help = format!("sides of {name:?} are {}", list(dimension, &patches[k]));
                    self.fault("E021", node.at, format!("`{shown}` is an edge or a corner; `{what}` takes sides"), help);
                    return None;
                }
                let side = rim_of(side, dimension).unwrap_or_default().concat();
                Some(Located::new(SideRef { patch: k, side }, node.at))
            }
            None => {
                let message = if side.is_empty() {
                    format!("`{shown}` names a patch, not a side; sides of {name:?} are {}", list(dimension, &patches[k]))
                } else {
                    format!("there is no side `{shown}`; sides of {name:?} are {}", list(dimension, &patches[k]))
                };
                let help = match (&patches[k].geometry.shape.value, canonical(side, dimension)) {
                    (Shape::DiscSector { .. }, Some("v0")) => "v0 is the centre of the disc and no side",
                    (Shape::Nurbs { .. }, Some(_)) => "this edge is collapsed to a point and no side",
                    _ if dimension == 2 => "in 2D left, right, bottom, top are u0, u1, v0, v1",
                    _ => "in 3D left, right, front, back, bottom, top are u0, u1, v0, v1, w0, w1",
                };
                self.fault("E021", node.at, message, help);
                None
            }
        }
    }
}

/// `lower.v0`.
pub(super) fn show(side: &SideRef, patches: &[Patch]) -> String {
    format!("{}.{}", patches.get(side.patch).map_or("?", |p| p.name.as_str()), side.side)
}
