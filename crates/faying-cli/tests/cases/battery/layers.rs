//! Layers between walls that do not yield: every layer has one stress and no strain across.
//!
//!   sigma = -p,  strain along the stack = -p / M,  M = E (1 - nu) / ((1 + nu)(1 - 2 nu)) (plane strain), E / (1 - nu^2) (plane stress)

use super::world::{Random, World};
use super::{Known, Trial};
use faying_cli::RunResult;
use std::path::Path;

/// A layer of the stack.
#[derive(Clone, Debug)]
struct Layer {
    thickness: f64,
    young: f64,
    poisson: f64,
    elements: [usize; 2],
    degree: usize,
    backend: &'static str,
    mirrored: bool,
}

/// A stack of layers of one width, with the distance between each and the next (negative: overlap).
#[derive(Clone, Debug)]
struct Stack {
    world: World,
    width: f64,
    stress: bool,
    layers: Vec<Layer>,
    distance: Vec<f64>,
}

/// Rules that do not integrate both sides exactly may be off by this share without a word.
const ROUGH: f64 = 0.01;

const BACKENDS: [&str; 3] = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];

impl Stack {
    fn random(r: &mut Random, most: usize, contrast: f64) -> Self {
        let n = 2 + r.below(most - 1);
        let layer = |r: &mut Random| Layer {
            thickness: if r.chance(0.3) { r.decades(-2.0, -0.5) } else { r.within(0.3, 1.0) },
            young: r.decades(-contrast, contrast),
            poisson: r.within(0.0, 0.45),
            elements: [1 + r.below(6), 1 + r.below(3)],
            degree: 1 + r.below(3),
            backend: r.pick(&BACKENDS),
            mirrored: r.chance(0.3),
        };
        let layers = (0..n).map(|_| layer(r)).collect();
        Self { world: World::random(r), width: r.within(0.5, 3.0), stress: r.chance(0.3), layers, distance: vec![0.0; n - 1] }
    }

    /// Where layer k begins and ends along the stack.
    fn heights(&self, k: usize) -> [f64; 2] {
        let below: f64 = (0..k).map(|j| self.layers[j].thickness + self.distance[j]).sum();
        [below, below + self.layers[k].thickness]
    }

    /// The end of the stack, and a point on it.
    fn top(&self) -> [f64; 2] {
        [0.37 * self.width, self.heights(self.layers.len() - 1)[1]]
    }

    fn modulus(&self, k: usize) -> f64 {
        let Layer { young: e, poisson: nu, .. } = self.layers[k];
        if self.stress { e / (1.0 - nu * nu) } else { e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) }
    }

    /// How much the stack yields per pressure.
    fn compliance(&self) -> f64 {
        (0..self.layers.len()).map(|k| self.layers[k].thickness / self.modulus(k)).sum()
    }

    /// Largest over least modulus.
    fn contrast(&self) -> f64 {
        let all: Vec<f64> = (0..self.layers.len()).map(|k| self.modulus(k)).collect();
        all.iter().fold(0.0f64, |m, x| m.max(*x)) / all.iter().fold(f64::MAX, |m, x| m.min(*x))
    }

    fn thinnest(&self) -> f64 {
        self.layers.iter().fold(f64::MAX, |m, l| m.min(l.thickness))
    }

    /// Largest length of an element over the thinnest layer.
    fn flatness(&self) -> f64 {
        self.layers.iter().map(|l| self.width / l.elements[0] as f64).fold(0.0, f64::max) / self.thinnest()
    }

    /// Share by which rounding may move an answer: strains of the stiffest layer stand against the rounding of coordinates and of its rigid
    /// motion, relative to the thinnest layer, and flat elements are stiffer along it.
    fn digits(&self, pressure: f64) -> f64 {
        let stiffest = (0..self.layers.len()).map(|k| self.modulus(k)).fold(0.0, f64::max);
        1e-8 + 1e-14 * (1.0 + self.world.far() + pressure.min(1e9) * self.compliance()) / self.thinnest()
            * (1.0 + stiffest / pressure)
            * self.flatness().max(1.0)
    }

    fn is_moderate(&self) -> bool {
        self.world.far() <= 1e3 && self.contrast() <= 1e5 && self.flatness() <= 50.0
    }

    /// Patches, materials and walls on both sides.
    fn text(&self, physics: &str) -> String {
        let mut out = format!("[model]\nphysics = \"{physics}\"\ndimension = 2\n");
        if self.stress && physics == "elasticity" {
            out += "assumption = \"plane-stress\"\n";
        }
        for (k, l) in self.layers.iter().enumerate() {
            let [lo, hi] = self.heights(k);
            let (left, right) = if l.mirrored { (self.width, 0.0) } else { (0.0, self.width) };
            let shape = format!(
                "kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], \
                 points = [[{left:e}, {lo:e}], [{right:e}, {lo:e}], [{left:e}, {hi:e}], [{right:e}, {hi:e}]]"
            );
            let material = match physics {
                "elasticity" => format!("young = {}\npoisson = {:e}", self.world.stress(l.young), l.poisson),
                _ => format!("conductivity = {:e}", l.young),
            };
            out += &format!(
                "[[material]]\nname = \"m{k}\"\n{material}\n[[patch]]\nname = \"l{k}\"\nmaterial = \"m{k}\"\ngeometry = {}\n\
                 elements = [{}, {}]\ndegree = {}\n{}\n",
                self.world.geometry(&shape),
                l.elements[0],
                l.elements[1],
                l.degree,
                l.backend
            );
            if physics == "elasticity" {
                out += &format!("[[boundary]]\non = [\"l{k}.u0\", \"l{k}.u1\"]\nfix = [\"normal\"]\n");
            }
        }
        out
    }

    fn last(&self) -> usize {
        self.layers.len() - 1
    }

    /// A pair of probes of the displacement at a point of layer k.
    fn probe(&self, at: [f64; 2], k: usize) -> String {
        let at = self.world.point(at);
        ["x", "y"].map(|c| format!("[[probe]]\nname = \"u{k}{c}\"\nquantity = \"u.{c} at {at} in l{k}\"\n")).concat()
    }

    /// The displacement of [`Stack::probe`] along the stack, in lengths.
    fn along(&self, result: &RunResult, k: usize) -> f64 {
        let v = ["x", "y"].map(|c| probe(result, &format!("u{k}{c}")));
        self.world.back(v, self.world.length)[1]
    }
}

pub fn probe(result: &RunResult, name: &str) -> f64 {
    result.probes.iter().find(|p| p.name == name).unwrap().value
}

fn known(what: &str, found: f64, expected: f64, within: f64) -> Known {
    Known { what: what.into(), found, expected, within }
}

/// A multiplier that fits a slave of this degree, and whether it is stable.
fn multiplier(r: &mut Random, degree: usize) -> &'static str {
    match degree {
        1 => r.pick(&["p/p", "auto", "dual"]),
        _ => r.pick(&["p/p", "p/p-2", "auto", "dual"]),
    }
}

/// Layers tied to one another, all by `between` or pair by pair, under a pressure on top.
pub fn tied(r: &mut Random, _folder: &Path) -> Trial {
    let contrast = if r.chance(0.3) { 4.0 } else { 1.0 };
    let stack = Stack::random(r, 4, contrast);
    let pressure = r.decades(-4.0, -1.0);
    let mut text = stack.text("elasticity");
    let (mut soft, mut rough) = (false, false);
    if r.chance(0.5) {
        text += "[[interface]]\nname = \"all\"\nbetween = \"all\"\n";
    } else {
        for k in 0..stack.last() {
            let ends = [(k, "v1"), (k + 1, "v0")];
            let first = r.below(2);
            let ((slave, a), (master, b)) = (ends[first], ends[1 - first]);
            let coupling = *r.pick(&[&"mortar", &"mortar", &"nitsche", &"penalty"]);
            let multiplier = multiplier(r, stack.layers[slave].degree);
            let integration = r.pick(&["merged", "slave", "mixed"]);
            soft |= coupling == "penalty";
            rough |= coupling == "mortar" && integration != "merged";
            text += &format!("[[interface]]\nname = \"i{k}\"\nslave = \"l{slave}.{a}\"\nmaster = \"l{master}.{b}\"\n");
            text += &match coupling {
                "mortar" => format!("multiplier = \"{multiplier}\"\nintegration = \"{integration}\"\n"),
                other => format!("coupling = \"{other}\"\n"),
            };
        }
    }
    let top = stack.last();
    text += &format!("[[boundary]]\non = \"l0.v0\"\nfix = [\"normal\"]\n[[boundary]]\non = \"l{top}.v1\"\npressure = ");
    text += &format!("{}\n{}", stack.world.stress(pressure), stack.probe(stack.top(), top));
    let sound = stack.is_moderate() && stack.layers.iter().all(|l| l.elements[0] > 1);
    let exact = stack.digits(pressure);
    let rough_by = if rough { ROUGH } else { 0.0 };
    let (within, balance) = (exact + if soft { 0.05 } else { rough_by }, exact + rough_by);
    let compare = move |result: &RunResult| {
        let u = -pressure * stack.compliance();
        let force = result.reactions.get("l0.v0").unwrap();
        let force = stack.world.back([force[0], force[1]], stack.world.length * stack.world.modulus)[1];
        let expected = pressure * stack.width;
        vec![known("u", stack.along(result, top), u, u.abs() * within), known("reaction", force, expected, expected * balance)]
    };
    Trial { text, sound, rough, refuse: false, known: Box::new(compare) }
}

/// Layers that conduct heat between two temperatures.
pub fn conducting(r: &mut Random, _folder: &Path) -> Trial {
    let contrast = if r.chance(0.3) { 4.0 } else { 1.0 };
    let stack = Stack::random(r, 4, contrast);
    let top = stack.last();
    let mut text = stack.text("poisson");
    text += "[[interface]]\nname = \"all\"\nbetween = \"all\"\n[[boundary]]\non = \"l0.v0\"\ndirichlet = \"1\"\n";
    text += &format!("[[boundary]]\non = \"l{top}.v1\"\ndirichlet = \"3\"\n");
    let at = [0.4 * stack.width, stack.heights(0)[1]];
    text += &format!("[[probe]]\nname = \"u\"\nquantity = \"u at {} in l0\"\n", stack.world.point(at));
    let sound = stack.is_moderate() && stack.layers.iter().all(|l| l.elements[0] > 1);
    let compare = move |result: &RunResult| {
        let resistance: f64 = stack.layers.iter().map(|l| l.thickness / l.young).sum();
        let first = stack.layers[0].thickness / stack.layers[0].young;
        vec![known("u", probe(result, "u"), 1.0 + 2.0 * first / resistance, 2.0 * stack.digits(f64::MAX))]
    };
    Trial { text, sound, rough: false, refuse: false, known: Box::new(compare) }
}

/// A method of contact, and the share by which its answer may be off.
fn law(r: &mut Random, degree: usize) -> (String, f64) {
    let multiplier = multiplier(r, degree);
    match r.below(8) {
        0 => (format!("multiplier = \"{multiplier}\"\nintegration = \"slave\""), ROUGH),
        1 => (format!("multiplier = \"{multiplier}\"\nintegration = \"mixed\""), ROUGH),
        2 => ("multiplier = \"p/p\"\ncone = \"weights\"".into(), 0.0),
        3 => ("multiplier = \"p/p\"\ncone = \"values\"".into(), 0.0),
        4 => ("method = \"augmented\"".into(), 1e-6),
        5 => ("method = \"nitsche\"".into(), 0.0),
        6 => ("method = \"penalty\"".into(), 0.05),
        _ => (format!("multiplier = \"{multiplier}\""), 0.0),
    }
}

/// Layers that lie on one another, apart or in one another. Under a pressure on top all clearances close; between two walls overlaps are
/// pushed apart, and with a clearance in sum nothing is pressed.
pub fn pressed(r: &mut Random, _folder: &Path) -> Trial {
    let contrast = if r.chance(0.3) { 4.0 } else { 1.0 };
    let mut stack = Stack::random(r, 4, contrast);
    let walls = r.chance(0.4);
    for k in 0..stack.last() {
        let thinner = stack.layers[k].thickness.min(stack.layers[k + 1].thickness);
        stack.distance[k] = match r.below(4) {
            0 => thinner * r.decades(-4.0, -0.6),
            1 => -thinner * r.decades(-4.0, -1.0),
            _ => 0.0,
        };
    }
    let pressure = r.decades(-4.0, -1.0);
    let mut text = stack.text("elasticity");
    let (mut soft, mut rough) = (0.0f64, false);
    for k in 0..stack.last() {
        let ends = [(k, "v1"), (k + 1, "v0")];
        let first = r.below(2);
        let ((slave, a), (master, b)) = (ends[first], ends[1 - first]);
        let (words, off) = law(r, stack.layers[slave].degree);
        soft = soft.max(off);
        rough |= words.contains("integration");
        text += &format!("[[contact]]\nname = \"c{k}\"\nslave = \"l{slave}.{a}\"\nmaster = \"l{master}.{b}\"\n{words}\n");
    }
    let top = stack.last();
    text += "[[boundary]]\non = \"l0.v0\"\nfix = [\"normal\"]\n";
    text += &format!("[[boundary]]\non = \"l{top}.v1\"\n");
    text += &if walls { "fix = [\"normal\"]\n".into() } else { format!("pressure = {}\n", stack.world.stress(pressure)) };
    text += &stack.probe(stack.top(), top);
    let closing: f64 = stack.distance.iter().sum();
    // between walls a layer in the middle that nothing presses is free
    let free = walls && closing > 0.0 && stack.layers.len() > 2;
    let sound = stack.is_moderate() && !free && stack.layers.iter().all(|l| l.elements[0] > 1);
    let digits = soft + stack.digits(if walls { closing.abs() / stack.compliance() } else { pressure });
    let inexact = rough;
    let compare = move |result: &RunResult| {
        let p = if walls { (-closing).max(0.0) / stack.compliance() } else { pressure };
        let scale = if walls { stack.thinnest() / stack.compliance() * 1e-3 } else { pressure };
        let unit = stack.world.length * stack.world.modulus;
        let mut out = Vec::new();
        for (k, (_, c)) in result.contact.iter().enumerate() {
            let force = stack.world.back([c.force[0], c.force[1]], unit)[1].abs();
            out.push(known(&format!("force {k}"), force, p * stack.width, digits * p.max(scale) * stack.width));
            // a rule that does not see the other side's functions moves single pressures by more
            let unit = stack.world.modulus;
            let near = (if inexact { 0.5 } else { 30.0 * digits }) * p.max(scale);
            out.push(known(&format!("greatest pressure {k}"), c.pressure.max / unit, p, near));
            out.push(known(&format!("least pressure {k}"), c.pressure.min / unit, p, near));
        }
        if !walls {
            let u = -pressure * stack.compliance() - closing;
            let size = pressure * stack.compliance() + stack.distance.iter().map(|d| d.abs()).sum::<f64>();
            out.push(known("u", stack.along(result, top), u, size * digits));
        }
        out
    };
    Trial { text, sound, rough, refuse: false, known: Box::new(compare) }
}

/// A column between walls over a half-plane, pressed from above or moved by a prescribed amount.
pub fn on_a_plane(r: &mut Random, _folder: &Path) -> Trial {
    let mut stack = Stack::random(r, 2, 1.0);
    stack.layers.truncate(1);
    stack.distance.clear();
    let (degree, h) = (stack.layers[0].degree, stack.layers[0].thickness);
    let (words, soft) = loop {
        let found = law(r, degree);
        if !found.0.contains("integration") {
            break found;
        }
    };
    // the plane stands below the column, or in it
    let distance = [0.0, h * r.decades(-4.0, -0.6), -h * r.decades(-4.0, -1.0)][r.below(3)];
    let moved = r.chance(0.5);
    let by = h * r.decades(-4.0, -1.0);
    let pressure = r.decades(-4.0, -1.0);
    let world = stack.world;
    let normal = world.turned([0.0, 1.0]);
    let mut text = stack.text("elasticity");
    let turned = world.turned([0.0, -by * world.length]);
    text += "[[boundary]]\non = \"l0.v1\"\n";
    text += &if moved {
        format!("dirichlet = [\"{:.17e}\", \"{:.17e}\"]\n", turned[0], turned[1])
    } else {
        format!("pressure = {}\n", world.stress(pressure))
    };
    text += &format!(
        "[[contact]]\nname = \"c\"\nslave = \"l0.v0\"\nrigid = {{ kind = \"half-plane\", point = {}, normal = [{:.17e}, {:.17e}] }}\n{words}\n{}",
        world.point([0.2, -distance]),
        normal[0],
        normal[1],
        stack.probe(stack.top(), 0)
    );
    let sound = stack.is_moderate() && stack.layers[0].elements[0] > 1;
    let digits = soft + stack.digits(if moved { by / stack.compliance() } else { pressure });
    let compare = move |result: &RunResult| {
        let p = if moved { (by - distance).max(0.0) / stack.compliance() } else { pressure };
        let unit = world.length * world.modulus;
        let c = &result.contact[0];
        let force = world.back([c.force[0], c.force[1]], unit)[1];
        let scale = if moved { by / stack.compliance() } else { pressure };
        let near = 30.0 * digits * scale;
        let mut out = vec![
            known("force", force, p * stack.width, digits * scale * stack.width),
            known("greatest pressure", c.pressure.max / world.modulus, p, near),
            known("least pressure", c.pressure.min / world.modulus, p, near),
        ];
        // where it does not touch
        if moved && p == 0.0 {
            let gap = distance - by;
            out.push(known("least gap", c.gap.min / world.length, gap, (digits + 1e-8) * (distance.abs() + by)));
        }
        if !moved {
            let u = -pressure * stack.compliance() - distance;
            out.push(known("u", stack.along(result, 0), u, digits * (u.abs() + distance.abs())));
        }
        out
    };
    Trial { text, sound, rough: false, refuse: false, known: Box::new(compare) }
}
