//! Bodies of four straight sides under the same pressure on all of them, pressed on what has a flat face of any direction.
//!
//!   sigma = -p,  u = -p c (x - x_0) + d n,   c = (1 + nu)(1 - 2 nu) / E (plane strain), (1 - nu) / E (plane stress)
//!
//! x_0 lies on the slave side, n is its outward normal and d the distance of the face: the gap closes, the side slides along the face,
//! and the contact pressure is p, whatever the multiplier, the obstacle and the angles of the body are.

use super::world::{Random, World};
use super::{Known, Trial};
use faying_cli::RunResult;
use std::path::Path;

type Place = [f64; 2];

fn add(a: Place, b: Place, t: f64) -> Place {
    [a[0] + t * b[0], a[1] + t * b[1]]
}

fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// `angle` in degrees, counter-clockwise.
fn rotated(v: Place, angle: f64) -> Place {
    let (s, c) = angle.to_radians().sin_cos();
    [c * v[0] - s * v[1], s * v[0] + c * v[1]]
}

/// A convex quadrilateral with the corners (u0, v0), (u1, v0), (u0, v1), (u1, v1).
#[derive(Clone, Copy, Debug)]
struct Quadrilateral([Place; 4]);

const SIDES: [&str; 4] = ["u0", "u1", "v0", "v1"];

impl Quadrilateral {
    /// A square of size one whose corners are moved by up to a fifth; left-handed at times.
    fn random(r: &mut Random) -> Self {
        let mut corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        if r.chance(0.7) {
            corners.iter_mut().for_each(|c| *c = [c[0] + r.within(-0.2, 0.2), c[1] + r.within(-0.2, 0.2)]);
        }
        let flat = if r.chance(0.3) { r.within(0.3, 1.0) } else { 1.0 };
        corners.iter_mut().for_each(|c| c[1] *= flat);
        if r.chance(0.3) {
            corners.swap(0, 1);
            corners.swap(2, 3);
        }
        Self(corners)
    }

    /// The ends of a side, in the direction of its parameter.
    fn ends(&self, side: usize) -> [Place; 2] {
        let [a, b] = [[0, 2], [1, 3], [0, 1], [2, 3]][side];
        [self.0[a], self.0[b]]
    }

    /// The outward normal of a side, its middle and its length.
    fn side(&self, side: usize) -> (Place, Place, f64) {
        let [a, b] = self.ends(side);
        let (t, middle) = ([b[0] - a[0], b[1] - a[1]], add([0.5 * a[0], 0.5 * a[1]], b, 0.5));
        let length = t[0].hypot(t[1]);
        let normal = [t[1] / length, -t[0] / length];
        let inside = self.0.iter().fold([0.0; 2], |s, c| add(s, *c, 0.25));
        let sign = if dot(normal, add(middle, inside, -1.0)) > 0.0 { 1.0 } else { -1.0 };
        ([sign * normal[0], sign * normal[1]], middle, length)
    }

    fn shape(&self) -> String {
        let points: Vec<String> = self.0.iter().map(|c| format!("[{:.17e}, {:.17e}]", c[0], c[1])).collect();
        format!("kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], points = [{}]", points.join(", "))
    }
}

/// What the body is pressed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    HalfPlane,
    Box,
    Polyline,
    LevelSet,
    Body,
}

/// The plane of a face: a point, the normal out of the face, and the length of the side that it meets.
#[derive(Clone, Copy, Debug)]
struct Plane {
    point: Place,
    normal: Place,
    length: f64,
}

impl Plane {
    /// The point `along` from the middle, `depth` below the face.
    fn at(&self, along: f64, depth: f64) -> Place {
        add(add(self.point, [-self.normal[1], self.normal[0]], along), self.normal, -depth)
    }

    fn text(&self, face: Face, r: &mut Random, world: &World) -> String {
        let over = |r: &mut Random| self.length * (0.5 + r.decades(-3.0, 0.3));
        let normal = world.turned(self.normal);
        let outline = |list: Vec<Place>| {
            let knots: Vec<String> = (0..list.len()).map(|k| k.to_string()).collect();
            let points: Vec<String> = list.iter().map(|p| world.point(*p)).collect();
            format!(
                "{{ kind = \"nurbs\", degree = 1, knots = [0, {}, {}], points = [{}] }}",
                knots.join(", "),
                list.len() - 1,
                points.join(", ")
            )
        };
        match face {
            Face::HalfPlane => {
                let along = r.within(-3.0, 3.0);
                format!(
                    "{{ kind = \"half-plane\", point = {}, normal = [{:.17e}, {:.17e}] }}",
                    world.point(self.at(along, 0.0)),
                    normal[0],
                    normal[1]
                )
            }
            Face::Box => {
                // the face is one of the four sides of a box that is turned and moved
                let (left, right, depth) = (over(r), over(r), self.length * r.decades(0.0, 0.5));
                let turn = f64::from(r.below(4) as u32) * 90.0;
                let (width, height) = if turn % 180.0 == 0.0 { (left + right, depth) } else { (depth, left + right) };
                // its face looks up, before it is turned
                let angle = (-self.normal[0]).atan2(self.normal[1]).to_degrees() + turn;
                let middle = self.at(0.5 * (left - right), 0.5 * depth);
                let [x, y] = world.place(middle);
                let l = world.length;
                format!(
                    "{{ kind = \"box\", min = [{:.17e}, {:.17e}], max = [{:.17e}, {:.17e}], rotate_deg = {:.17e}, move = [{x:.17e}, {y:.17e}] }}",
                    -0.5 * width * l,
                    -0.5 * height * l,
                    0.5 * width * l,
                    0.5 * height * l,
                    angle + world.angle
                )
            }
            Face::Polyline => {
                // from left to right where the normal looks up: the obstacle lies to the right of its direction
                let (left, right) = (over(r), over(r));
                let mut list = vec![self.at(left, 0.0)];
                let mut inner: Vec<f64> = (0..r.below(4)).map(|_| r.within(-right, left)).collect();
                inner.sort_by(|a, b| b.total_cmp(a));
                list.extend(inner.into_iter().map(|t| self.at(t, 0.0)));
                list.push(self.at(-right, 0.0));
                let far = self.length * r.decades(-1.0, 0.5);
                let [before, after] = [0, 1].map(|_| r.within(0.0, 90.0).to_radians().sin_cos());
                if r.chance(0.5) {
                    list.insert(0, self.at(left + far * before.1, far * before.0));
                    list.push(self.at(-right - far * after.1, far * after.0));
                }
                outline(list)
            }
            Face::LevelSet => {
                // the distance in lengths, through a function that is zero where it is
                let [x, y] = world.place(self.point);
                let s = format!("(({:.17e})*(x - ({x:.17e})) + ({:.17e})*(y - ({y:.17e})))/{:.17e}", normal[0], normal[1], world.length);
                let k = r.decades(-1.0, 2.0);
                let f = match r.below(7) {
                    0 => s.clone(),
                    1 => format!("atan({k:e}*{s})"),
                    2 => format!("sinh({:e}*{s})", k.min(10.0)),
                    3 => format!("exp({:e}*{s}) - 1", k.min(10.0)),
                    4 => format!("({s})*(1 + {k:e}*({s})^2)"),
                    5 => format!("{k:e}*({s})/sqrt(1 + ({s})^2)"),
                    _ => {
                        let t = format!("(({:.17e})*(x - ({x:.17e})) + ({:.17e})*(y - ({y:.17e})))", -normal[1], normal[0]);
                        format!("({s})*(2 + sin({k:e}*{t}/{:.17e}))", world.length)
                    }
                };
                format!("{{ kind = \"level-set\", f = \"{f}\" }}")
            }
            Face::Body => unreachable!("a body is no obstacle"),
        }
    }
}

/// Patch, material and pressure of a body; `motion`: its displacement (slope, fixed point, shift), prescribed on some of the sides that
/// are not in contact.
struct Pressed<'a> {
    world: &'a World,
    name: &'a str,
    shape: Quadrilateral,
    contact: usize,
    pressure: f64,
    slope: f64,
    fixed: Place,
    shift: Place,
}

impl Pressed<'_> {
    fn text(&self, r: &mut Random, young: f64, poisson: f64, degree: usize) -> String {
        let (world, name) = (self.world, self.name);
        let backend = r.pick(&["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""]);
        let mut out = format!(
            "[[material]]\nname = \"{name}\"\nyoung = {}\npoisson = {poisson:e}\n[[patch]]\nname = \"{name}\"\nmaterial = \"{name}\"\n\
             geometry = {}\nelements = [{}, {}]\ndegree = {degree}\n{backend}\n",
            world.stress(young),
            world.geometry(&self.shape.shape()),
            2 + r.below(5),
            2 + r.below(5)
        );
        let [x, y] = world.place(self.fixed);
        let shift = world.turned(self.shift).map(|s| s * world.length);
        let prescribed = format!(
            "dirichlet = [\"({:.17e})*(x - ({x:.17e})) + ({:.17e})\", \"({:.17e})*(y - ({y:.17e})) + ({:.17e})\"]",
            self.slope, shift[0], self.slope, shift[1]
        );
        let others: Vec<usize> = (0..4).filter(|&s| s != self.contact).collect();
        let held = 1 + r.below(3);
        let first = r.below(3);
        for (k, side) in others.iter().enumerate() {
            let is_held = (k + 3 - first) % 3 < held;
            let load = if is_held { prescribed.clone() } else { format!("pressure = {}", world.stress(self.pressure)) };
            out += &format!("[[boundary]]\non = \"{name}.{}\"\n{load}\n", SIDES[*side]);
        }
        // one end of the side itself
        if r.chance(0.3) {
            let (side, end) = (SIDES[self.contact], r.below(2));
            let corner = if self.contact < 2 { format!("{side}v{end}") } else { format!("u{end}{side}") };
            out += &format!("[[boundary]]\non = \"{name}.{corner}\"\n{prescribed}\n");
        }
        out
    }
}

/// How much a body shrinks per pressure.
fn shrink(stress: bool, young: f64, poisson: f64) -> f64 {
    if stress { (1.0 - poisson) / young } else { (1.0 + poisson) * (1.0 - 2.0 * poisson) / young }
}

/// A method of contact, and the share by which its answer may be off.
fn law(r: &mut Random, degree: usize) -> (String, f64) {
    let multiplier = if degree == 1 { r.pick(&["p/p", "auto"]) } else { r.pick(&["p/p", "p/p-2", "auto"]) };
    match r.below(8) {
        0 => ("multiplier = \"p/p\"\ncone = \"weights\"".into(), 0.0),
        1 => ("multiplier = \"p/p\"\ncone = \"values\"".into(), 0.0),
        2 => ("method = \"augmented\"".into(), 1e-6),
        3 => ("method = \"nitsche\"".into(), 0.0),
        4 if degree < 3 => ("multiplier = \"dual\"".into(), 0.0),
        _ => (format!("multiplier = \"{multiplier}\""), 0.0),
    }
}

/// A quadrilateral pressed on a face.
fn on(face: Face, r: &mut Random) -> Trial {
    let (world, stress) = (World::random(r), r.chance(0.3));
    let (shape, contact, degree) = (Quadrilateral::random(r), r.below(4), 1 + r.below(3));
    let (young, poisson, pressure) = (r.decades(-1.0, 1.0), r.within(0.0, 0.45), r.decades(-4.0, -2.0));
    let (normal, middle, length) = shape.side(contact);
    let distance = [0.0, r.decades(-4.0, -1.5), -r.decades(-4.0, -0.8)][r.below(3)];
    let mut text = String::from("[model]\nphysics = \"elasticity\"\ndimension = 2\n");
    if stress {
        text += "assumption = \"plane-stress\"\n";
    }
    let slope = -pressure * shrink(stress, young, poisson);
    // the side slides along the face: the fixed point is any on it
    let fixed = add(middle, [-normal[1], normal[0]], r.within(-1.0, 1.0) * length);
    let shift = add([0.0; 2], normal, distance);
    text += &Pressed { world: &world, name: "b", shape, contact, pressure, slope, fixed, shift }.text(r, young, poisson, degree);
    let plane = Plane { point: add(middle, normal, distance), normal: [-normal[0], -normal[1]], length };
    let (words, off) = law(r, degree);
    let slave = SIDES[contact];
    if face == Face::Body {
        // the mirror image of the body, as far from its side as the body; its side may be longer on neither end
        let mirror = |c: &Place| add(*c, normal, 2.0 * (dot(add(middle, *c, -1.0), normal)) + distance);
        let other = Quadrilateral([0, 1, 2, 3].map(|k| mirror(&shape.0[k])));
        let (young, poisson) = (r.decades(-1.0, 1.0), r.within(0.0, 0.45));
        let slope = -pressure * shrink(stress, young, poisson);
        let pressed = Pressed {
            world: &world,
            name: "a",
            shape: other,
            contact,
            pressure,
            slope,
            fixed: add(fixed, normal, distance),
            shift: [0.0; 2],
        };
        text += &pressed.text(r, young, poisson, degree);
        let (s, m) = if r.chance(0.5) { ("a", "b") } else { ("b", "a") };
        text += &format!("[[contact]]\nname = \"c\"\nslave = \"{s}.{slave}\"\nmaster = \"{m}.{slave}\"\n{words}\n");
        return compared(text, world, normal, length, pressure, slope, off, s == "b");
    }
    let rigid = plane.text(face, r, &world);
    text += &format!("[[contact]]\nname = \"c\"\nslave = \"b.{slave}\"\nrigid = {rigid}\n{words}\n");
    compared(text, world, normal, length, pressure, slope, off, true)
}

#[allow(clippy::too_many_arguments)]
fn compared(text: String, world: World, normal: Place, length: f64, pressure: f64, slope: f64, off: f64, first: bool) -> Trial {
    // strains stand against the rounding of coordinates
    let digits = off + 1e-7 + 1e-13 * (1.0 + world.far()) / slope.abs();
    // of few elements not every function has a dual one
    let sound = world.far() <= 1e3 && digits < 1e-2 && !text.contains("multiplier = \"dual\"");
    let compare = move |result: &RunResult| {
        let c = &result.contact[0];
        let unit = world.length * world.modulus;
        let force = world.back([c.force[0], c.force[1]], unit);
        let sign = if first { -1.0 } else { 1.0 };
        let known = |what: &str, found: f64, expected: f64, within: f64| Known { what: what.into(), found, expected, within };
        vec![
            known("force along the normal", sign * dot(force, normal), pressure * length, digits * pressure * length),
            known("force along the side", dot(force, [-normal[1], normal[0]]), 0.0, digits * pressure * length),
            known("greatest pressure", c.pressure.max / world.modulus, pressure, 30.0 * digits * pressure),
            known("least pressure", c.pressure.min / world.modulus, pressure, 30.0 * digits * pressure),
            known("least gap", c.gap.min / world.length, 0.0, 30.0 * digits * slope.abs()),
            known("area", c.area / world.length, length, 1e-6 * length),
        ]
    };
    Trial { text, sound, rough: false, refuse: false, known: Box::new(compare) }
}

pub fn on_half_planes(r: &mut Random, _folder: &Path) -> Trial {
    on(Face::HalfPlane, r)
}

pub fn on_boxes(r: &mut Random, _folder: &Path) -> Trial {
    on(Face::Box, r)
}

pub fn on_polylines(r: &mut Random, _folder: &Path) -> Trial {
    on(Face::Polyline, r)
}

pub fn on_level_sets(r: &mut Random, _folder: &Path) -> Trial {
    on(Face::LevelSet, r)
}

pub fn on_their_images(r: &mut Random, _folder: &Path) -> Trial {
    on(Face::Body, r)
}

/// A side beside a face that it does not face: turned from where it would by 62 degrees and more.
pub fn turned_away(r: &mut Random, _folder: &Path) -> Trial {
    let world = World::random(r);
    let (shape, contact, degree) = (Quadrilateral::random(r), r.below(4), 1 + r.below(3));
    let (normal, middle, length) = shape.side(contact);
    let turn = [90.0, 90.0 + r.within(-0.1, 0.1), r.within(62.0, 180.0)][r.below(3)] * if r.chance(0.5) { 1.0 } else { -1.0 };
    let outwards = rotated([-normal[0], -normal[1]], turn);
    // the face passes by the side's middle, before or behind it
    let point = add(middle, outwards, length * [0.0, 0.02, -0.02, -0.2][r.below(4)]);
    let plane = Plane { point, normal: outwards, length: 6.0 * length };
    let face = [Face::HalfPlane, Face::LevelSet][r.below(2)];
    let pressed = Pressed { world: &world, name: "b", shape, contact, pressure: 1e-3, slope: -1e-3, fixed: middle, shift: [0.0; 2] };
    let mut text = String::from("[model]\nphysics = \"elasticity\"\ndimension = 2\n");
    text += &pressed.text(r, 1.0, 0.3, degree);
    text += &format!("[[contact]]\nname = \"c\"\nslave = \"b.{}\"\nrigid = {}\n", SIDES[contact], plane.text(face, r, &world));
    Trial { text, sound: false, rough: false, refuse: true, known: Box::new(|_| Vec::new()) }
}
