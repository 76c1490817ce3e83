//! Twins: two cases of one problem, whose obstacles or places are written differently, have equal answers.
//!
//! A block that is held at the top is pressed by an obstacle that reaches into its bottom: a disc, a wedge, a box, a tilted plane, a
//! parabola. The other case has the same obstacle in other words, moved instead of the block, or both in the mirror.

use super::world::{Random, World};
use super::{End, messages};
use faying_cli::{Case, Registry, RunResult};
use std::path::Path;

type Place = [f64; 2];

/// Two texts, and how the second one's answers compare with the first one's.
pub struct Twins {
    texts: [String; 2],
    /// Whether both must be solved.
    sound: bool,
    /// Force and probes of the second case are those of the first times this, along and across.
    signs: Place,
    world: World,
}

/// What the block is pressed by, in the block's coordinates; the block is [-1, 1] x [0, height].
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Centre and radius.
    Disc(Place, f64),
    /// Apex, and the angles of both flanks below the horizontal, in degrees.
    Wedge(Place, Place),
    /// Middle of the top, half width, depth.
    Box(Place, f64, f64),
    /// Point and angle, in degrees.
    Plane(Place, f64),
    /// Apex and curvature: y = apex - curvature/2 (x - apex)².
    Parabola(Place, f64),
}

/// How an obstacle is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Words {
    Own,
    Outline,
    LevelSet,
}

fn nurbs(degree: usize, knots: &[f64], points: &[Place], weights: Option<&[f64]>, world: &World) -> String {
    let places: Vec<String> = points.iter().map(|p| world.point(*p)).collect();
    let weights = weights.map_or(String::new(), |w| format!(", weights = {w:?}"));
    format!("kind = \"nurbs\", degree = {degree}, knots = {knots:?}, points = [{}]{weights}", places.join(", "))
}

fn polyline(points: &[Place], world: &World) -> String {
    let n = points.len();
    let knots: Vec<f64> = std::iter::once(0.0).chain((0..n).map(|k| k as f64)).chain([n as f64 - 1.0]).collect();
    nurbs(1, &knots, points, None, world)
}

impl Shape {
    fn random(r: &mut Random) -> Self {
        // zones of a few elements at least
        let depth = r.within(0.02, 0.05);
        match r.below(5) {
            0 => {
                let radius = r.decades(0.0, 1.0);
                Self::Disc([r.within(-0.5, 0.5), depth - radius], radius)
            }
            1 => Self::Wedge([r.within(-0.5, 0.5), depth], [r.within(2.0, 12.0), r.within(2.0, 12.0)]),
            2 => Self::Box([r.within(-0.4, 0.4), depth], r.within(0.2, 0.5), r.decades(-0.5, 0.5)),
            3 => Self::Plane([0.0, depth * r.within(0.3, 1.0)], r.within(-3.0, 3.0)),
            _ => Self::Parabola([r.within(-0.5, 0.5), depth], r.decades(-1.0, 0.0)),
        }
    }

    /// The ways to write it besides `Own`.
    fn others(&self) -> &'static [Words] {
        match self {
            Self::Disc(..) | Self::Plane(..) => &[Words::Outline, Words::LevelSet],
            Self::Box(..) | Self::Parabola(..) => &[Words::Outline],
            Self::Wedge(..) => &[],
        }
    }

    fn moved(self, by: Place) -> Self {
        let at = |p: Place| [p[0] + by[0], p[1] + by[1]];
        match self {
            Self::Disc(p, a) => Self::Disc(at(p), a),
            Self::Wedge(p, a) => Self::Wedge(at(p), a),
            Self::Box(p, a, b) => Self::Box(at(p), a, b),
            Self::Plane(p, a) => Self::Plane(at(p), a),
            Self::Parabola(p, a) => Self::Parabola(at(p), a),
        }
    }

    fn mirrored(self) -> Self {
        let at = |p: Place| [-p[0], p[1]];
        match self {
            Self::Disc(p, a) => Self::Disc(at(p), a),
            Self::Wedge(p, [a, b]) => Self::Wedge(at(p), [b, a]),
            Self::Box(p, a, b) => Self::Box(at(p), a, b),
            Self::Plane(p, a) => Self::Plane(at(p), -a),
            Self::Parabola(p, a) => Self::Parabola(at(p), a),
        }
    }

    /// The text of the obstacle, without braces.
    fn text(&self, words: Words, world: &World) -> String {
        let l = world.length;
        // own coordinates, in lengths, as formulas of x and y
        let (e, n) = (world.turned([1.0, 0.0]), world.turned([0.0, 1.0]));
        let along = |v: Place, p: Place| {
            let [x, y] = world.place(p);
            format!("((({:.17e})*(x - ({x:.17e})) + ({:.17e})*(y - ({y:.17e})))/{l:.17e})", v[0], v[1])
        };
        let level_set = |f: String| format!("kind = \"level-set\", f = \"{f}\"");
        match (*self, words) {
            (Self::Disc(c, radius), Words::Own) => format!("kind = \"sphere\", center = {}, radius = {:.17e}", world.point(c), radius * l),
            (Self::Disc(c, radius), Words::LevelSet) => level_set(format!("sqrt({}^2 + {}^2) - {radius:.17e}", along(e, c), along(n, c))),
            (Self::Disc(c, radius), Words::Outline) => {
                // clockwise from the left over the top, in quarters
                let corner = |k: usize| {
                    [[-1.0, 0.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [1.0, -1.0], [0.0, -1.0], [-1.0, -1.0]][k % 8]
                };
                let points: Vec<Place> = (0..9).map(|k| [c[0] + radius * corner(k)[0], c[1] + radius * corner(k)[1]]).collect();
                let w = std::f64::consts::FRAC_1_SQRT_2;
                let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
                nurbs(2, &knots, &points, Some(&[1.0, w, 1.0, w, 1.0, w, 1.0, w, 1.0]), world)
            }
            (Self::Wedge(p, [a, b]), _) => {
                let flank = |angle: f64, x: f64| {
                    let (s, c) = angle.to_radians().sin_cos();
                    [p[0] + 4.0 * x * c, p[1] - 4.0 * s]
                };
                polyline(&[flank(a, -1.0), p, flank(b, 1.0)], world)
            }
            (Self::Box(p, half, depth), Words::Outline) => {
                let (left, right, low) = (p[0] - half, p[0] + half, p[1] - depth);
                polyline(&[[left, low], [left, p[1]], [right, p[1]], [right, low], [left, low]], world)
            }
            (Self::Box(p, half, depth), _) => {
                // turned about its middle, which is at the origin, and moved there
                let [x, y] = world.place([p[0], p[1] - 0.5 * depth]);
                format!(
                    "kind = \"box\", min = [{:.17e}, {:.17e}], max = [{:.17e}, {:.17e}], rotate_deg = {:.17e}, move = [{x:.17e}, {y:.17e}]",
                    -half * l,
                    -0.5 * depth * l,
                    half * l,
                    0.5 * depth * l,
                    world.angle
                )
            }
            (Self::Plane(p, angle), Words::Own) => {
                let (s, c) = angle.to_radians().sin_cos();
                let normal = world.turned([-s, c]);
                format!("kind = \"half-plane\", point = {}, normal = [{:.17e}, {:.17e}]", world.point(p), normal[0], normal[1])
            }
            (Self::Plane(p, angle), Words::LevelSet) => {
                let (s, c) = angle.to_radians().sin_cos();
                level_set(format!("sinh({})", along(world.turned([-s, c]), p)))
            }
            (Self::Plane(p, angle), Words::Outline) => {
                let (s, c) = angle.to_radians().sin_cos();
                polyline(&[[p[0] - 5.0 * c, p[1] - 5.0 * s], [p[0] + 5.0 * c, p[1] + 5.0 * s]], world)
            }
            (Self::Parabola(p, bend), Words::Outline) => {
                let a = 3.0;
                let end = p[1] - 0.5 * bend * a * a;
                nurbs(
                    2,
                    &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
                    &[[p[0] - a, end], [p[0], p[1] + 0.5 * bend * a * a], [p[0] + a, end]],
                    None,
                    world,
                )
            }
            (Self::Parabola(p, bend), _) => level_set(format!("{} + {:.17e}*{}^2", along(n, p), 0.5 * bend, along(e, p))),
        }
    }
}

/// A block and what presses it.
struct Pair {
    height: f64,
    degree: usize,
    elements: Place,
    backend: &'static str,
    words: String,
    held: &'static str,
}

impl Pair {
    fn random(r: &mut Random) -> Self {
        let degree = 1 + r.below(3);
        let multiplier = if degree == 1 { "p/p" } else { r.pick(&["p/p", "p/p-2"]) };
        let words = match r.below(5) {
            0 => "method = \"nitsche\"\n".into(),
            1 => "method = \"augmented\"\n".into(),
            2 => format!("multiplier = \"{multiplier}\"\nintegration = \"slave\"\n"),
            _ => format!("multiplier = \"{multiplier}\"\n"),
        };
        Self {
            height: r.within(0.6, 1.5),
            degree,
            elements: [(8 + r.below(17)) as f64, (2 + r.below(4)) as f64],
            backend: r.pick(&["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""]),
            words,
            held: r.pick(&["[\"b.v1\"]", "[\"b.v1\", \"b.u0\"]", "[\"b.v1\", \"b.u0\", \"b.u1\"]"]),
        }
    }

    /// The case with the block moved by `by` in its own coordinates, from left to right or, mirrored, from right to left.
    fn text(&self, world: &World, by: Place, mirrored: bool, obstacle: &str) -> String {
        let sign = if mirrored { -1.0 } else { 1.0 };
        let corners = [[-1.0, 0.0], [1.0, 0.0], [-1.0, self.height], [1.0, self.height]];
        let points: Vec<String> = corners.iter().map(|c| world.point([sign * c[0] + by[0], c[1] + by[1]])).collect();
        let probe = world.point([sign * 0.3 + by[0], by[1] + 0.25 * self.height]);
        let probes: String =
            ["x", "y"].iter().map(|c| format!("[[probe]]\nname = \"u{c}\"\nquantity = \"u.{c} at {probe} in b\"\n")).collect();
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = {}\npoisson = 0.3\n[[patch]]\nname = \"b\"\n\
             geometry = {{ kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], points = [{}] }}\n\
             elements = [{}, {}]\ndegree = {}\n{}\n[[boundary]]\non = {}\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.v0\"\nrigid = {{ {obstacle} }}\n{}{probes}",
            world.stress(1.0),
            points.join(", "),
            self.elements[0],
            self.elements[1],
            self.degree,
            self.backend,
            self.held,
            self.words
        )
    }
}

/// A frame near the origin: twins far away differ by the rounding of their coordinates.
fn frame(r: &mut Random) -> World {
    World { shift: [0.0; 2], ..World::random(r) }
}

/// One obstacle in two ways.
pub fn in_other_words(r: &mut Random) -> Twins {
    let (world, pair) = (frame(r), Pair::random(r));
    let shape = loop {
        let shape = Shape::random(r);
        if !shape.others().is_empty() {
            break shape;
        }
    };
    let others = shape.others();
    let words = others[r.below(others.len())];
    let texts = [Words::Own, words].map(|w| pair.text(&world, [0.0; 2], false, &shape.text(w, &world)));
    Twins { texts, sound: true, signs: [1.0; 2], world }
}

/// The obstacle moved, or the block moved the other way.
pub fn moved(r: &mut Random) -> Twins {
    let (world, pair, shape) = (frame(r), Pair::random(r), Shape::random(r));
    let words = if r.chance(0.5) || shape.others().is_empty() { Words::Own } else { shape.others()[r.below(shape.others().len())] };
    let by = [r.within(-0.3, 0.3), r.within(-0.3, 0.3)];
    let back = [-by[0], -by[1]];
    let texts = [
        pair.text(&world, [0.0; 2], false, &shape.text(words, &world)),
        pair.text(&world, back, false, &shape.moved(back).text(words, &world)),
    ];
    Twins { texts, sound: true, signs: [1.0; 2], world }
}

/// Block and obstacle in the mirror.
pub fn mirrored(r: &mut Random) -> Twins {
    let (world, pair, shape) = (frame(r), Pair::random(r), Shape::random(r));
    let words = if r.chance(0.5) || shape.others().is_empty() { Words::Own } else { shape.others()[r.below(shape.others().len())] };
    let texts = [
        pair.text(&world, [0.0; 2], false, &shape.text(words, &world)),
        pair.text(&world, [0.0; 2], true, &shape.mirrored().text(words, &world)),
    ];
    Twins { texts, sound: true, signs: [-1.0, 1.0], world }
}

/// Largest difference of twins, relative to the largest number of a kind.
const SAME: f64 = 1e-6;

/// Runs both twins; an error says what is wrong with them.
pub fn end(twins: &Twins, folder: &Path) -> Result<End, String> {
    let mut results: Vec<RunResult> = Vec::new();
    let mut refused = Vec::new();
    for (k, text) in twins.texts.iter().enumerate() {
        let file = folder.join(format!("case{k}.toml"));
        std::fs::write(&file, text).map_err(|e| e.to_string())?;
        match Case::read(file.to_str().unwrap()).and_then(|case| case.run(&Registry::default())) {
            Ok(result) if result.exit == 0 => results.push(result),
            Ok(result) => {
                refused.push(format!("exit {}: {:?}", result.exit, result.diagnostics.iter().map(|d| &d.message).collect::<Vec<_>>()))
            }
            Err(faults) => refused.push(messages(&faults)),
        }
    }
    let [a, b] = match (results.as_slice(), refused.as_slice()) {
        ([a, b], _) => [a, b],
        ([_], [why]) => return Err(format!("one is solved, the other refused: {why}")),
        (_, [why, ..]) if twins.sound => return Err(format!("sound cases are refused: {why}")),
        _ => return Ok(End::Refused),
    };
    let unit = twins.world.length * twins.world.modulus;
    let [p, q] = [a, b].map(|r| &r.contact[0]);
    let [f, g] = [p, q].map(|c| twins.world.back([c.force[0], c.force[1]], unit));
    let [u, v] = [a, b].map(|r| twins.world.back(["ux", "uy"].map(|name| super::layers::probe(r, name)), twins.world.length));
    let signs = twins.signs;
    let (force, motion) = (f[0].hypot(f[1]), u[0].hypot(u[1]));
    let mut pairs = vec![
        ("force along", f[0], signs[0] * g[0], force),
        ("force across", f[1], signs[1] * g[1], force),
        ("u along", u[0], signs[0] * v[0], motion),
        ("u across", u[1], signs[1] * v[1], motion),
        ("greatest pressure", p.pressure.max / twins.world.modulus, q.pressure.max / twins.world.modulus, force),
        ("area", p.area / twins.world.length, q.area / twins.world.length, 1.0),
        ("least gap", p.gap.min / twins.world.length, q.gap.min / twins.world.length, motion),
    ];
    pairs.push(("active", p.active as f64, q.active as f64, 1.0));
    if force <= 0.0 || !force.is_finite() {
        return Err(format!("the obstacle does not press: force {f:?}"));
    }
    let wrong: Vec<String> = pairs
        .iter()
        .filter(|(_, a, b, size)| (a - b).abs() > SAME * (size + a.abs()) || !(a - b).is_finite())
        .map(|(what, a, b, _)| format!("{what}: {a:e} and {b:e}"))
        .collect();
    match wrong.is_empty() {
        true if a.warnings.is_empty() && b.warnings.is_empty() => Ok(End::Right),
        true => Ok(End::Warned),
        false => Err(wrong.join("; ")),
    }
}

impl Twins {
    /// Both texts.
    pub fn text(&self) -> String {
        self.texts.join("\n# ---- the other twin ----\n")
    }
}
