//! Quarters of rings that fit into one another, tied or pressed, under pressure in the bore and outside.

use super::lame::{Ring, joints};
use super::layers::probe;
use super::world::{Random, World};
use super::{Known, Trial};
use faying_cli::RunResult;
use std::path::Path;

/// Rings from the bore outwards, in the unit of the world.
struct Nest {
    world: World,
    rings: Vec<Ring>,
    degree: usize,
    text: String,
}

impl Nest {
    /// Two or three rings; `distance` moves the bore of every outer ring outwards from where the inner one ends.
    fn random(r: &mut Random, distance: f64) -> Self {
        let world = World::random(r);
        let degree = 1 + r.below(3);
        let mut rings = Vec::new();
        let mut radius = 1.0;
        for k in 0..2 + r.below(2) {
            let from = if k == 0 { radius } else { radius + distance };
            let to = from + r.within(0.3, 0.8);
            rings.push(Ring { radius: [from, to], young: r.decades(-1.0, 1.0), poisson: r.within(0.0, 0.4) });
            radius = to;
        }
        let mut text = String::from("[model]\nphysics = \"elasticity\"\ndimension = 2\n");
        for (k, ring) in rings.iter().enumerate() {
            let backend = r.pick(&[
                "backend = \"iga\"",
                "backend = \"fe\"",
                "backend = \"fe\"\nmapping = \"exact\"",
                "backend = \"fe\"\ncells = \"simplex\"",
            ]);
            let elements = if degree == 1 { [16 + r.below(8), 8] } else { [5 + r.below(4), 3 + r.below(2)] };
            let [a, b] = ring.radius;
            let shape = format!("kind = \"annulus-sector\", center = [0, 0], radius = [{a:.17e}, {b:.17e}], angle_deg = [0, 90]");
            text += &format!(
                "[[material]]\nname = \"m{k}\"\nyoung = {}\npoisson = {:e}\n[[patch]]\nname = \"r{k}\"\nmaterial = \"m{k}\"\n\
                 geometry = {}\nelements = [{}, {}]\ndegree = {degree}\n{backend}\n[[boundary]]\non = [\"r{k}.u0\", \"r{k}.u1\"]\nfix = [\"normal\"]\n",
                world.stress(ring.young),
                ring.poisson,
                world.geometry(&shape),
                elements[0],
                elements[1]
            );
        }
        Self { world, rings, degree, text }
    }

    /// A pressure on a side, and the probes of the displacement in the bore at 45 degrees.
    fn loaded(&mut self, side: &str, pressure: f64) {
        let at = self.rings[0].radius[0] * std::f64::consts::FRAC_1_SQRT_2;
        let at = self.world.point([at, at]);
        self.text += &format!("[[boundary]]\non = \"{side}\"\npressure = {}\n", self.world.stress(pressure));
        for c in ["x", "y"] {
            self.text += &format!("[[probe]]\nname = \"u{c}\"\nquantity = \"u.{c} at {at} in r0\"\n");
        }
    }

    /// Radial displacement in the bore.
    fn bore(world: &World, result: &RunResult) -> f64 {
        let u = world.back(["x", "y"].map(|c| probe(result, &format!("u{c}"))), world.length);
        (u[0] + u[1]) * std::f64::consts::FRAC_1_SQRT_2
    }

    fn within(&self) -> f64 {
        if self.degree == 1 { 0.1 } else { 0.02 }
    }

    fn is_moderate(&self) -> bool {
        self.world.far() <= 1e3
    }
}

/// Rings tied to one another under a pressure in the bore or outside.
pub fn tied(r: &mut Random, _folder: &Path) -> Trial {
    let mut nest = Nest::random(r, 0.0);
    let last = nest.rings.len() - 1;
    if r.chance(0.5) {
        nest.text += "[[interface]]\nname = \"all\"\nbetween = \"all\"\n";
    } else {
        for k in 0..last {
            let ends = [(k, "v1"), (k + 1, "v0")];
            let first = r.below(2);
            let ((slave, a), (master, b)) = (ends[first], ends[1 - first]);
            nest.text += &format!(
                "[[interface]]\nname = \"i{k}\"\nslave = \"r{slave}.{a}\"\nmaster = \"r{master}.{b}\"\nintegration = \"{}\"\n",
                r.pick(&["merged", "merged", "slave", "mixed"])
            );
        }
    }
    let pressure = r.decades(-4.0, -2.0);
    let inside = r.chance(0.5);
    let ends = if inside { [pressure, 0.0] } else { [0.0, pressure] };
    nest.loaded(&if inside { "r0.v0".into() } else { format!("r{last}.v1") }, pressure);
    let (text, sound, within) = (nest.text.clone(), nest.is_moderate(), nest.within());
    let compare = move |result: &RunResult| {
        let p = joints(&nest.rings, &vec![0.0; last], ends);
        let u = nest.rings[0].displacement([ends[0], p[0]], nest.rings[0].radius[0]);
        let found = Nest::bore(&nest.world, result);
        // the scale is that of the bore alone: joints may take nearly all of it away
        let scale = u.abs().max(0.1 * nest.rings[0].displacement([pressure, 0.0], 1.0).abs());
        vec![Known { what: "u in the bore".into(), found, expected: u, within: within * scale }]
    };
    Trial { text, sound, rough: true, refuse: false, known: Box::new(compare) }
}

/// Rings that overlap (press fits), or with a clearance that a pressure in the bore closes or does not.
pub fn pressed(r: &mut Random, _folder: &Path) -> Trial {
    let distance = if r.chance(0.5) { -r.decades(-4.0, -2.5) } else { r.decades(-4.0, -2.5) };
    let mut nest = Nest::random(r, distance);
    nest.rings.truncate(2);
    // the third ring of the text has nothing to do with the others
    let keep = nest.text.find("[[material]]\nname = \"m2\"").unwrap_or(nest.text.len());
    nest.text.truncate(keep);
    let (slave, master) = if r.chance(0.5) { ("r0.v1", "r1.v0") } else { ("r1.v0", "r0.v1") };
    let method = r.pick(&["", "method = \"augmented\"\n", "method = \"nitsche\"\n", "multiplier = \"p/p\"\n", "integration = \"mixed\"\n"]);
    nest.text += &format!("[[contact]]\nname = \"fit\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{method}");
    let free = nest.rings[0].displacement([1.0, 0.0], nest.rings[0].radius[1]);
    let pressure = distance.abs() / free * r.decades(-1.0, 1.0);
    nest.loaded("r0.v0", pressure);
    // straight facets leave their circle by more than such a fit
    let faceted = nest.degree == 1
        && nest.text.lines().filter(|l| *l == "backend = \"fe\"").count() > nest.text.matches("mapping = \"exact\"").count();
    let (text, sound, within) = (nest.text.clone(), nest.is_moderate() && !faceted, nest.within());
    let compare = move |result: &RunResult| {
        // closed where the free inner ring would reach the outer one; of an overlap always
        let p = joints(&nest.rings, &[-distance], [pressure, 0.0])[0].max(0.0);
        let u = nest.rings[0].displacement([pressure, p], nest.rings[0].radius[0]);
        let stiff = joints(&nest.rings, &[distance.abs()], [0.0, 0.0])[0].abs().max(pressure);
        let scale = nest.rings[0].displacement([stiff, 0.0], nest.rings[0].radius[0]).abs();
        let found = Nest::bore(&nest.world, result);
        let contact = &result.contact[0];
        let force = &contact.force;
        let unit = nest.world.length * nest.world.modulus;
        let force = nest.world.back([force[0], force[1]], unit).map(f64::abs);
        let expected = p * nest.rings[0].radius[1];
        vec![
            Known { what: "u in the bore".into(), found, expected: u, within: within * scale },
            Known { what: "force along x".into(), found: force[0], expected, within: within * stiff },
            Known { what: "force along y".into(), found: force[1], expected, within: within * stiff },
            Known {
                what: "greatest pressure".into(),
                found: contact.pressure.max / nest.world.modulus,
                expected: p,
                within: 10.0 * within * stiff,
            },
            Known {
                what: "least pressure".into(),
                found: contact.pressure.min / nest.world.modulus,
                expected: p,
                within: 10.0 * within * stiff,
            },
        ]
    };
    Trial { text, sound, rough: true, refuse: false, known: Box::new(compare) }
}
