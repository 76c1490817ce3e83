//! Reads `[[patch]]`: shape, elements, grading, discretization.

use super::key::Key;
use super::reader::{Block, Reader, Sign};
use super::rows;
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::errors::{Diagnostic, nearest};
use crate::place::Located;

/// The key that tells kinds apart.
const KIND: Key = Key::new("kind", super::key::KeyKind::Text, "which kind").required("\"box\"");

/// Most elements of one direction; the size of the whole is limited later.
const MOST_ELEMENTS: i64 = 1_000_000;

/// Number of keys of a table that are not among `own`.
fn misfits(node: &Node, own: &[Key]) -> usize {
    let Value::Table(table) = &node.value else { return 0 };
    table.entries.iter().filter(|e| own.iter().all(|key| key.name != e.key)).count()
}

impl Reader {
    /// `[[patch]]`, every file expanded into its patches.
    pub fn patches(&mut self, root: &mut Block, model: &Model, defaults: &Discretization, materials: &[Material]) -> Vec<Patch> {
        let patches = self.list(root, "patch", rows::PATCH, |r, b, k| r.patch(b, k, model, defaults, materials));
        self.unique("patch", &patches.iter().map(|p| p.name.clone()).collect::<Vec<_>>());
        if !root.has("patch") {
            let help = "write [[patch]] with name, geometry and elements";
            self.broken.insert("patch".to_owned());
            self.fault("E013", self.source.lines.place(0..0), "[[patch]] is missing in the case", help);
        }
        self.expand(patches)
    }

    /// One `[[patch]]`.
    pub fn patch(&mut self, b: &mut Block, index: usize, model: &Model, defaults: &Discretization, materials: &[Material]) -> Patch {
        let name = self.name(b, "patch", index);
        let mut geometry = self.patch_geometry(b);
        let from = self.parts(&mut geometry.value, false);
        self.from_files.push(from);
        let material = self.patch_material(b, materials);
        let mut discretization = self.discretization(b, Some(defaults));
        self.mesh_discretization(b, &geometry, &mut discretization);
        self.check_discretization(&discretization);
        let elements = self.elements(b, &geometry.shape);
        let refine = self.whole(b, "refine");
        let grade = self.grade(b, &elements);
        let poisson = model.physics.value == Physics::Poisson;
        let source = self.source(b, poisson, model.components());
        let exact = self.exact(b, model.components());
        let other = model.source.as_ref().filter(|_| exact.is_some());
        if let (Some(_), Some(s)) = (exact.as_ref().or(model.exact.as_ref()), source.as_ref().or(other)) {
            self.fault(
                "E015",
                s.at,
                "a body force or source does not stand beside `exact`",
                "it follows from `exact`; leave one of them out",
            );
        }
        let gravity = self.gravity(b);
        let foundation = self.foundation(b, poisson, model.components(), model.exact.is_some());
        let closed = b.node("closed").cloned().and_then(|n| self.text_of(&n, "closed"));
        let glue = b.node("glue").cloned().and_then(|n| self.flag_of(&n, "glue").map(|glue| Located::new(glue, n.at)));
        let glue = glue.unwrap_or(Located::new(true, b.at));
        Patch {
            head: b.head(),
            name,
            geometry,
            material,
            elements,
            refine,
            grade,
            discretization,
            exact,
            source,
            gravity,
            foundation,
            closed,
            glue,
        }
    }

    fn patch_material(&mut self, b: &mut Block, materials: &[Material]) -> Located<usize> {
        let list = || materials.iter().map(|m| m.name.value.as_str()).collect::<Vec<_>>().join(", ");
        // [[material]] itself could not be read
        let broken = self.broken.contains("material");
        let what = b.what.clone();
        let Some(node) = b.node("material").cloned() else {
            match materials.len() {
                0 if broken => {}
                0 => self.fault("E054", b.at, format!("{what} has no material"), "add [[material]] with name, young and poisson"),
                1 => {
                    let at = b.default("material", Value::Text(materials[0].name.value.clone()));
                    return Located::new(0, at);
                }
                _ => {
                    let help = format!("write material = {:?}; materials: {}", materials[0].name.value, list());
                    self.fault("E054", b.at, format!("{what} has no material, and there are {}", materials.len()), help);
                }
            }
            return Located::new(0, b.at);
        };
        let Some(name) = self.text_of(&node, "material") else { return Located::new(0, node.at) };
        if let Some(k) = materials.iter().position(|m| m.name.value == name.value) {
            return Located::new(k, node.at);
        }
        if broken {
            return Located::new(0, node.at);
        }
        let mut d = Diagnostic::error("E054", format!("there is no material {:?}", short(&name.value)));
        if let Some(near) = nearest(&name.value, materials.iter().map(|m| m.name.value.as_str())) {
            d = d.with_label(format!("did you mean {near:?}?"));
        }
        let help = if materials.is_empty() { "add [[material]] with this name".to_owned() } else { format!("materials: {}", list()) };
        self.push(node.at, d.with_help(help));
        Located::new(0, node.at)
    }

    fn patch_geometry(&mut self, b: &mut Block) -> Located<Geometry> {
        let fallback = |at| {
            let shape = Shape::PlateWithHole { radius: Located::new(1.0, at), half_width: Located::new(2.0, at) };
            Located::new(
                Geometry { shape: Located::new(shape, at), extrude: None, scale: None, rotate_deg: None, axis: None, translate: None },
                at,
            )
        };
        let Some(node) = self.required(b, "geometry") else {
            return fallback(b.at);
        };
        let Some((geometry, table)) = self.geometry(&node) else { return fallback(node.at) };
        b.replace("geometry", table);
        geometry
    }

    /// `geometry = { kind = .. }`.
    fn geometry(&mut self, node: &Node) -> Option<(Located<Geometry>, Table)> {
        let (mut b, kind) = self.kinded(node, "geometry", &rows::geometries())?;
        let at = b.node("kind").map_or(node.at, |k| k.at);
        let shape = Located::new(self.shape_of_patch(&mut b, &kind), at);
        let extrude = self.number(&b, "extrude");
        let scale = self.number(&b, "scale");
        let rotate_deg = self.number(&b, "rotate_deg");
        let axis = b.node("axis").cloned().and_then(|n| self.vector_of(&n, "axis", false));
        if let (2, Some(h)) = (self.dimension, &extrude) {
            self.fault(
                "E044",
                h.at,
                "`extrude` makes a body of dimension 3, the model has dimension 2",
                "leave out `extrude`, or write dimension = 3",
            );
        }
        let translate = b.node("move").cloned().and_then(|n| self.vector_of(&n, "move", true));
        let geometry = Geometry { shape, extrude, scale, rotate_deg, axis, translate };
        Some((Located::new(geometry, node.at), b.finish()))
    }

    // shapes of the plane, and what is extruded, have two coordinates in space, too
    fn shape_of_patch(&mut self, b: &mut Block, kind: &str) -> Shape {
        let plane = matches!(kind, "annulus-sector" | "disc-sector" | "plate-with-hole");
        let extruded = b.has("extrude") && matches!(kind, "box" | "nurbs");
        let whole = self.dimension;
        if plane || extruded {
            self.dimension = 2;
        }
        let shape = self.shape(b, kind);
        self.dimension = whole;
        shape
    }

    /// Opens a table with a `kind`; keys of other kinds are E015, keys of none E012.
    pub fn kinded(&mut self, node: &Node, what: &str, kinds: &[(String, Vec<Key>)]) -> Option<(Block, String)> {
        let all: Vec<&'static str> = std::iter::once("kind").chain(kinds.iter().flat_map(|(_, keys)| keys).map(|k| k.name)).collect();
        let mut list: Vec<&str> = Vec::new();
        for (kind, _) in kinds {
            if !list.contains(&kind.as_str()) {
                list.push(kind);
            }
        }
        // the kind first: its keys are the ones to suggest
        let kind_node = match &node.value {
            Value::Table(t) => self.kind_of(t, what, &all),
            _ => {
                self.wrong_type(node, what, "a table with a `kind`", format!("write {what} = {{ kind = {:?}, .. }}", list[0]));
                return None;
            }
        };
        let Some(kind_node) = kind_node else {
            let meant = kinds.iter().min_by_key(|(_, own)| misfits(node, own)).map_or(list[0], |(kind, _)| kind);
            let help = format!("write {what} = {{ kind = {meant:?}, .. }}; kinds: {}", list.join(", "));
            self.fault("E013", node.at, format!("`kind` is missing in `{what}`"), help);
            return None;
        };
        let words: Vec<(&str, usize)> = list.iter().enumerate().map(|(k, kind)| (*kind, k)).collect();
        let kind = list[self.word_of(&kind_node, "kind", &words)?];
        let (_, own) = kinds.iter().find(|(name, _)| name == kind)?;
        let keys = [&[KIND], own.as_slice()].concat();
        let known = |key: &str| keys.iter().any(|k| k.name == key);
        let Value::Table(table) = &node.value else { return None };
        let mut table = table.clone();
        if table.get("kind").is_none() {
            // misspelt, and reported
            if let Some(e) = table.entries.iter_mut().find(|e| e.node.at == kind_node.at) {
                e.key = "kind".to_owned();
            }
        }
        for e in &table.entries {
            if !known(&e.key) && all.contains(&e.key.as_str()) {
                let help = format!("keys here: {}", keys.iter().map(|k| k.name).collect::<Vec<_>>().join(", "));
                self.fault("E015", e.key_at, format!("`{}` is not a key of kind {kind:?}", e.key), help);
            }
        }
        table.entries.retain(|e| known(&e.key) || !all.contains(&e.key.as_str()));
        let clean = Node { value: Value::Table(table), ..node.clone() };
        let b = self.block(&clean, &format!("`{what}` of kind {kind:?}"), &keys)?;
        Some((b, kind.to_owned()))
    }

    // `kind`, or the misspelt key nearest to it
    fn kind_of(&mut self, table: &Table, what: &str, all: &[&'static str]) -> Option<Node> {
        if let Some(e) = table.get("kind") {
            return Some(e.node.clone());
        }
        let e = table.entries.iter().find(|e| !all.contains(&e.key.as_str()) && nearest(&e.key, all.iter().copied()) == Some("kind"))?;
        self.unknown_key(&e.key, e.key_at, &format!("`{what}`"), &[KIND], "kind");
        Some(e.node.clone())
    }

    /// The shape of a kind; also used for obstacles.
    pub fn shape(&mut self, b: &mut Block, kind: &str) -> Shape {
        match kind {
            "box" => {
                let min = self.required_vector(b, "min");
                let max = self.required_vector(b, "max");
                if b.has("min") && b.has("max") {
                    let wrong = min.iter().zip(max.iter()).position(|(a, c)| a >= c);
                    // both zero: one of them was in error already
                    if let (Some(k), false) = (wrong, min.value == max.value && min.iter().all(|v| *v == 0.0)) {
                        let message = format!(
                            "`max` must exceed `min` in every coordinate, but {} does not: {:?} and {:?}",
                            ["x", "y", "z"][k],
                            min[k],
                            max[k]
                        );
                        self.fault("E015", max.at, message, "");
                    }
                }
                Shape::Box { min, max }
            }
            "annulus-sector" => {
                let radius = self.pair(b, "radius", Sign::Positive);
                Shape::AnnulusSector { center: self.center(b), radius, angle_deg: self.angles(b) }
            }
            "disc-sector" => {
                let radius = self.required_number(b, "radius");
                Shape::DiscSector { center: self.center(b), radius, angle_deg: self.angles(b) }
            }
            "plate-with-hole" => {
                let radius = self.required_number(b, "radius");
                let half_width = self.required_number(b, "half_width");
                if b.has("radius") && b.has("half_width") && half_width.value <= radius.value && half_width.value != 1.0 {
                    self.fault(
                        "E015",
                        half_width.at,
                        format!("`half_width` must exceed the radius {:?}, found {:?}", radius.value, half_width.value),
                        "",
                    );
                }
                Shape::PlateWithHole { radius, half_width }
            }
            "sphere-octant" => {
                let radius = self.pair(b, "radius", Sign::Positive);
                Shape::SphereOctant { center: self.center(b), radius }
            }
            "nurbs" => self.nurbs(b),
            _ => self.file_shape(b),
        }
    }

    // the origin by default
    fn center(&mut self, b: &mut Block) -> Located<Vec<f64>> {
        let n = self.dimension;
        match b.node("center").cloned() {
            None => {
                let zero = || Node::new(Value::Float(0.0), b.at);
                let list = (0..n).map(|_| zero()).collect();
                Located::new(vec![0.0; n], b.default("center", Value::List(list)))
            }
            Some(node) => self.vector_of(&node, "center", false).unwrap_or(Located::new(vec![0.0; n], node.at)),
        }
    }

    fn angles(&mut self, b: &mut Block) -> Located<[f64; 2]> {
        let angles = self.pair(b, "angle_deg", Sign::Any);
        if angles[1] - angles[0] > 360.0 {
            self.fault("E015", angles.at, format!("`angle_deg` spans more than 360 degrees: {:?} to {:?}", angles[0], angles[1]), "");
        }
        angles
    }

    fn elements(&mut self, b: &mut Block, shape: &Located<Shape>) -> Located<Vec<Located<Divisions>>> {
        let n = self.dimension;
        // built-in shapes count in total, others per knot span
        let count = if shape.is_built_in() { Divisions::Total } else { Divisions::PerSpan };
        let ones = |at| Located::new(vec![Located::new(count(1), at); n], at);
        let Some(node) = b.node("elements").cloned() else {
            if shape.is_built_in() {
                let help = if n == 2 { "write elements = [4, 4]" } else { "write elements = [4, 4, 4]" };
                self.fault("E013", b.at, format!("`elements` is missing in {}", b.what), help);
                return ones(b.at);
            }
            if shape.mesh_part().is_some() {
                return ones(b.at);
            }
            let at = b.default("elements", Value::Integer(1));
            return ones(at);
        };
        let range = |k: usize| match &shape.value {
            Shape::File { parts, .. } => parts.first().and_then(|p| p.spline()?.knots.get(k)).map_or((0.0, 1.0), |u| ends(u)),
            Shape::Nurbs { knots, .. } => knots.get(k).and_then(|u| Some((*u.first()?, *u.last()?))).unwrap_or((0.0, 1.0)),
            _ => (0.0, 1.0),
        };
        match &node.value {
            Value::List(list) if list.len() == n => {
                let all = list.iter().enumerate().map(|(k, item)| Located::new(self.divisions(item, range(k), count), item.at)).collect();
                Located::new(all, node.at)
            }
            Value::List(list) => {
                let message = format!("`elements` must have {n} entries, one per direction, found {}", list.len());
                self.fault("E044", node.at, message, if n == 2 { "write elements = [4, 4]" } else { "write elements = [4, 4, 4]" });
                ones(node.at)
            }
            _ => {
                let number = self.whole_of(&node, "elements", 1, MOST_ELEMENTS).unwrap_or(1);
                Located::new(vec![Located::new(count(number), node.at); n], node.at)
            }
        }
    }

    fn divisions(&mut self, node: &Node, range: (f64, f64), count: fn(usize) -> Divisions) -> Divisions {
        let Value::List(_) = &node.value else {
            return count(self.whole_of(node, "elements", 1, MOST_ELEMENTS).unwrap_or(1));
        };
        let Some(points) = self.numbers_of(node, "elements") else { return count(1) };
        if let Some(w) = points.windows(2).find(|w| w[0].value >= w[1].value) {
            self.fault("E015", w[1].at, format!("breakpoints must increase, found {:?} after {:?}", w[1].value, w[0].value), "");
            return count(1);
        }
        let (first, last) = (points.first().map(|p| p.value), points.last().map(|p| p.value));
        if points.len() < 2 || first != Some(range.0) || last != Some(range.1) {
            let message = format!("breakpoints go from {:?} to {:?}", range.0, range.1);
            self.fault(
                "E015",
                node.at,
                message,
                format!("write a list such as [{:?}, {:?}, {:?}]", range.0, 0.5 * (range.0 + range.1), range.1),
            );
            return count(1);
        }
        Divisions::Breakpoints(points.iter().map(|p| p.value).collect())
    }

    fn grade(&mut self, b: &mut Block, elements: &Located<Vec<Located<Divisions>>>) -> Option<Located<Vec<Option<Grading>>>> {
        let node = b.node("grade").cloned()?;
        let inner = self.block(&node, "`grade`", rows::GRADE)?;
        let toward = self.required(&inner, "toward");
        let ratio = self.required_number(&inner, "ratio");
        if ratio.value > 1.0 {
            self.fault(
                "E015",
                ratio.at,
                format!("`ratio` must be at most 1, found {:?}", ratio.value),
                "it is the first element's size over the uniform size",
            );
        }
        let places = self.block(&toward?, "`toward`", &rows::PARAMETERS[..self.dimension])?;
        let mut out = Vec::new();
        for (k, d) in places.keys.iter().map(|key| key.name).enumerate() {
            let at = self.number(&places, d);
            if let Some(p) = &at {
                if !(0.0..=1.0).contains(&p.value) {
                    self.fault("E015", p.at, format!("`{d}` must be from 0 to 1, found {:?}", p.value), "it is a parameter of the patch");
                }
                if matches!(elements[k].value, Divisions::Breakpoints(_)) {
                    self.fault("E015", p.at, format!("direction {d} has breakpoints and is graded too"), "leave one of them out");
                }
            }
            out.push(at.map(|p| Grading { toward: p.value, ratio: ratio.value }));
        }
        Some(Located::new(out, node.at))
    }
}

fn ends(knots: &[f64]) -> (f64, f64) {
    (knots.first().copied().unwrap_or(0.0), knots.last().copied().unwrap_or(1.0))
}

fn short(text: &str) -> String {
    text.chars().take(60).collect()
}
