//! Cases with contact: running them, the conditions that hold after each, and frames of any unit and direction.
#![allow(dead_code, clippy::unwrap_used)]

use faying_cli::Case;
use faying_cli::Registry;
use faying_cli::case::ReadOptions;
use faying_cli::result::{ContactReport, Moment, RunResult, Status};

/// Largest penetration of the lumped gap as a share of the size of the model.
const PENETRATION: f64 = 1e-12;
/// Largest tension and product of multiplier and gap as a share of their scale.
const ZERO: f64 = 1e-12;

/// Reads a case with `--set` words.
pub fn read(text: &str, sets: &[&str]) -> Case {
    let options = ReadOptions { sets: sets.iter().map(|s| (*s).to_owned()).collect(), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}\n{sets:?}\n{text}"))
}

/// Runs a case; every check passes.
pub fn solve(text: &str, sets: &[&str]) -> RunResult {
    let result = read(text, sets).run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{sets:?}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?} {:?}\n{sets:?}\n{text}", result.diagnostics, result.checks);
    result
}

/// Runs a case of size `size`; every check passes and the conditions of contact hold.
pub fn run(text: &str, sets: &[&str], size: f64) -> RunResult {
    let result = solve(text, sets);
    kkt(&result, size);
    result
}

/// No tension, no penetration, no pressure at a distance: after every step.
pub fn kkt(result: &RunResult, size: f64) {
    let ends = result.steps.iter().map(|s| &s.contact).chain([&result.contact]);
    for (name, c) in ends.flat_map(|named| named.iter()) {
        let scale = c.pressure.max.abs().max(c.pressure.min.abs());
        assert!(c.kkt.lambda <= ZERO * scale, "{name}: tension {:e} of {scale:e}", c.kkt.lambda);
        assert!(c.gap.min >= -PENETRATION * size, "{name}: gap {:e} of {size:e}", c.gap.min);
        assert!(c.kkt.product <= ZERO * scale * size, "{name}: product {:e} of {:e}", c.kkt.product, scale * size);
        // rows lambda < 0, = 0, > 0; columns gap = 0, > 0, < 0
        let [_, off_closed, off_through, _, _, through, tension @ ..] = c.sign_cases;
        assert_eq!((off_closed, off_through, through, tension), (0, 0, 0, [0; 3]), "{name}");
    }
}

/// The only contact, or the one of this name.
pub fn contact<'a>(result: &'a RunResult, name: &str) -> &'a ContactReport {
    result.contact.get(name).unwrap()
}

/// The value of a probe.
pub fn probe(result: &RunResult, name: &str) -> f64 {
    result.probes.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("no probe {name}")).value
}

/// Units and a direction in which a case is written.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Lengths are multiplied by this.
    pub length: f64,
    /// Moduli and pressures are.
    pub modulus: f64,
    /// Everything is turned about the origin \[degrees\].
    pub angle: f64,
}

impl Frame {
    /// The frame the models are written in.
    pub const OWN: Self = Self { length: 1.0, modulus: 1.0, angle: 0.0 };

    fn turned(&self, v: [f64; 2], by: f64) -> [f64; 2] {
        let (s, c) = (by * self.angle).to_radians().sin_cos();
        [c * v[0] - s * v[1], s * v[0] + c * v[1]]
    }

    /// "[x, y]" of a direction of length 1, or of any vector times `unit`.
    pub fn vector(&self, v: [f64; 2], unit: f64) -> String {
        let v = self.turned(v, 1.0);
        format!("[{:.17e}, {:.17e}]", v[0] * unit, v[1] * unit)
    }

    /// The same as data: numbers in quotes.
    pub fn data(&self, v: [f64; 2], unit: f64) -> String {
        let v = self.turned(v, 1.0);
        format!("[\"{:.17e}\", \"{:.17e}\"]", v[0] * unit, v[1] * unit)
    }

    /// "[x, y]" of a point.
    pub fn point(&self, p: [f64; 2]) -> String {
        self.vector(p, self.length)
    }

    /// A geometry block of a shape that is written in the own frame.
    pub fn geometry(&self, shape: &str) -> String {
        format!("{{ {shape}, scale = {:.17e}, rotate_deg = {:.17e} }}", self.length, self.angle)
    }

    /// A length.
    pub fn length(&self, l: f64) -> String {
        format!("{:.17e}", l * self.length)
    }

    /// A stress or modulus.
    pub fn stress(&self, s: f64) -> String {
        format!("{:.17e}", s * self.modulus)
    }

    /// A vector of a result in the own frame.
    fn back(&self, v: &[f64], unit: f64) -> [f64; 2] {
        self.turned([v[0] / unit, v[1] / unit], -1.0)
    }

    /// The numbers of a result in the own frame, each with the scale it is compared on.
    ///
    /// Probes are pairs NAME.x, NAME.y of displacements and single stresses.
    pub fn numbers(&self, result: &RunResult) -> Vec<(String, f64, f64)> {
        let (l, force) = (self.length, self.length * self.modulus);
        let mut out: Vec<(String, f64, f64)> = Vec::new();
        let pair = |out: &mut Vec<(String, f64, f64)>, name: &str, v: [f64; 2]| {
            let scale = v[0].hypot(v[1]);
            out.push((format!("{name}.x"), v[0], scale));
            out.push((format!("{name}.y"), v[1], scale));
        };
        for (name, c) in &result.contact {
            let scale = (c.force[0].hypot(c.force[1])) / force;
            pair(&mut out, name, self.back(&c.force, force));
            let Moment::Plane(moment) = &c.moment else { panic!("a moment in the plane is one number") };
            out.push((format!("{name}.moment"), moment / (force * l), scale));
            let pressure = c.pressure.max / self.modulus;
            out.push((format!("{name}.pressure.max"), pressure, pressure));
            out.push((format!("{name}.pressure.min"), c.pressure.min / self.modulus, pressure));
            out.push((format!("{name}.area"), c.area / l, 1.0));
            // too coarse a zone has none in any frame
            out.push((format!("{name}.half_width"), if c.half_width.unwrap().is_nan() { -1.0 } else { c.half_width.unwrap() / l }, 1.0));
            out.push((format!("{name}.segments"), c.segments.measure / l, 1.0));
            out.push((format!("{name}.active"), c.active as f64, 1.0));
            out.push((format!("{name}.iterations"), c.iterations as f64, 1.0));
        }
        for (side, r) in &result.reactions {
            pair(&mut out, side, self.back(r, force));
        }
        let energy = result.energy / (force * l);
        out.push(("energy".into(), energy, energy.abs()));
        for p in &result.probes {
            if let Some(name) = p.name.strip_suffix("-x") {
                let other = probe(result, &format!("{name}-y"));
                pair(&mut out, name, self.back(&[p.value, other], l));
            } else if !p.name.ends_with("-y") {
                let stress = p.value / self.modulus;
                out.push((p.name.clone(), stress, stress.abs()));
            }
        }
        out
    }
}

/// Largest difference of two lists of numbers, each on its scale, and where.
pub fn difference(a: &[(String, f64, f64)], b: &[(String, f64, f64)]) -> (f64, String) {
    assert_eq!(a.len(), b.len());
    // forces that are round-off of the largest one have no digits of their own
    let largest = a.iter().filter(|(n, ..)| n.ends_with(".y") || n.ends_with(".x")).fold(0.0f64, |m, x| m.max(x.2));
    a.iter().zip(b).fold((0.0, String::new()), |worst, ((name, x, scale), (other, y, _))| {
        assert_eq!(name, other);
        let is_vector = name.ends_with(".x") || name.ends_with(".y");
        let scale = if is_vector { scale.max(1e-3 * largest) } else { *scale };
        let d = (x - y).abs() / scale;
        if d > worst.0 || d.is_nan() { (d, format!("{name}: {x:e} and {y:e}")) } else { worst }
    })
}
