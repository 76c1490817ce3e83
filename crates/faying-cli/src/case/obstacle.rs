//! Reads `rigid = { kind = .. }`: an obstacle with its place and its motion.

use super::reader::{Block, Reader, Uses};
use super::rows;
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::place::Located;

const AXES: [&str; 3] = ["x", "y", "z"];

impl Reader {
    /// The obstacle and its table with all defaults.
    pub(super) fn obstacle(&mut self, node: &Node) -> Option<(Obstacle, Table)> {
        let added = self.known.obstacles.clone();
        let (mut b, kind) = self.kinded(node, "rigid", &rows::obstacles(&self.known))?;
        let kind = kind.as_str();
        let at = b.node("kind").map_or(node.at, |k| k.at);
        let plane = self.dimension == 2;
        if plane && matches!(kind, "cylinder" | "torus" | "sphere-octant") {
            let message = format!("a {kind} is an obstacle of three dimensions, the model has two");
            self.fault("E044", at, message, "its cross-section is a sphere (a circle), a half-plane, a level-set or a nurbs curve");
            return None;
        }
        let shape = match added.iter().find(|entry| entry.name == kind) {
            Some(entry) => ObstacleShape::Entry { kind: entry.name.clone(), given: self.given(&mut b, &entry.keys)? },
            None => self.obstacle_shape(&mut b, kind, at)?,
        };
        let n = self.dimension;
        let mut motion = |key: &str| match b.node(key).cloned() {
            Some(node) => self.formulas_of(&node, key, Uses::Time, n),
            None => (0..n).map(|_| None).collect(),
        };
        let (translate, force) = (motion("move"), motion("force"));
        for (k, f) in force.iter().enumerate() {
            if let (Some(f), Some(Some(_))) = (f, translate.get(k)) {
                let message = format!("the obstacle is moved and pressed in {}", AXES[k]);
                self.fault("E052", f.at, message, "a component has `move` or `force`; one without either is held");
            }
        }
        Some((Obstacle { shape: Located::new(shape, at), translate, force }, b.finish()))
    }

    fn obstacle_shape(&mut self, b: &mut Block, kind: &str, at: crate::place::SourceSpan) -> Option<ObstacleShape> {
        Some(match kind {
            "half-plane" => {
                let point = self.required_vector(b, "point");
                let normal = self.required_direction(b, "normal");
                ObstacleShape::HalfPlane { point, normal }
            }
            "sphere" => ObstacleShape::Sphere {
                center: self.required_vector(b, "center"),
                radius: self.required_number(b, "radius"),
                inside: self.flag(b, "inside"),
            },
            "cylinder" => ObstacleShape::Cylinder {
                center: self.required_vector(b, "center"),
                axis: self.required_direction(b, "axis"),
                radius: self.required_number(b, "radius"),
            },
            "torus" => ObstacleShape::Torus {
                center: self.required_vector(b, "center"),
                axis: self.required_direction(b, "axis"),
                radius: {
                    // [R, r]: the tube is thinner
                    let node = self.required(b, "radius")?;
                    let r = self.numbers_of(&node, "radius")?;
                    if r.len() != 2 || r.iter().any(|v| v.value <= 0.0) {
                        self.fault("E015", node.at, "`radius` must be two positive numbers", "write radius = [2.0, 0.5]");
                        return None;
                    }
                    Located::new([r[0].value, r[1].value], node.at)
                },
            },
            "level-set" => {
                let f = self.required(b, "f").and_then(|n| self.formula_of(&n, "f", Uses::Space));
                let along = b.node("along").cloned().and_then(|n| self.vector_of(&n, "along", false));
                let along = along.and_then(|v| self.unit(v, "along"));
                ObstacleShape::LevelSet { f: f?, along }
            }
            _ => {
                let n = self.dimension - 1;
                let boundary = kind == "nurbs" && b.node("knots").is_some_and(|knots| directions(knots) == n);
                let shape = if boundary { self.nurbs_of(b, n) } else { self.shape(b, kind) };
                let mut geometry = Geometry {
                    shape: Located::new(shape, at),
                    extrude: None,
                    scale: self.number(b, "scale"),
                    rotate_deg: self.number(b, "rotate_deg"),
                    axis: b.node("axis").cloned().and_then(|n| self.vector_of(&n, "axis", false)),
                    translate: None,
                };
                self.obstacle_parts(&mut geometry)?;
                ObstacleShape::Geometry(Box::new(geometry))
            }
        })
    }

    /// A direction of length 1; a coordinate axis where it is refused.
    fn required_direction(&mut self, b: &Block, key: &str) -> Located<Vec<f64>> {
        let given = self.required(b, key).and_then(|node| self.vector_of(&node, key, false));
        let scaled = given.and_then(|v| self.unit(v, key));
        scaled.unwrap_or_else(|| Located::new((0..self.dimension).map(|k| f64::from(u8::from(k == 0))).collect(), b.at))
    }

    /// A vector scaled to length 1; `None` if it is zero.
    fn unit(&mut self, v: Located<Vec<f64>>, what: &str) -> Option<Located<Vec<f64>>> {
        let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if largest == 0.0 {
            self.fault("E015", v.at, format!("`{what}` must not be zero"), "");
            return None;
        }
        // scaled first: squares of tiny or huge numbers leave the range
        let scaled: Vec<f64> = v.iter().map(|x| x / largest).collect();
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(Located::new(scaled.iter().map(|x| x / length).collect(), v.at))
    }
}

/// Number of directions of knots: a list of numbers has one, lists have one each.
fn directions(knots: &Node) -> usize {
    match &knots.value {
        Value::List(list) if list.iter().any(|item| matches!(item.value, Value::List(_))) => list.len(),
        _ => 1,
    }
}
