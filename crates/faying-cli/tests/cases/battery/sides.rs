//! Bodies that lie beside one another without touching, and sides that cannot meet.

use super::files;
use super::lame::{Ring, joints};
use super::layers::probe;
use super::world::{Random, World};
use super::{Known, Trial};
use faying_cli::RunResult;
use std::path::Path;

/// Materials and patches a, b, c of files; their sides u0 and u1 slide along walls.
fn bodies(world: &World, young: [f64; 3], poisson: f64) -> String {
    let mut text = String::from("[model]\nphysics = \"elasticity\"\ndimension = 2\n");
    for (name, e) in ["a", "b", "c"].iter().zip(young) {
        text += &format!(
            "[[material]]\nname = \"m{name}\"\nyoung = {}\npoisson = {poisson:e}\n[[patch]]\nname = \"{name}\"\nmaterial = \"m{name}\"\n\
             backend = \"fe\"\ngeometry = {{ kind = \"file\", file = \"{name}.msh\", group = \"body\" }}\n\
             [[boundary]]\non = [\"{name}.u0\", \"{name}.u1\"]\nfix = [\"normal\"]\n",
            world.stress(e)
        );
    }
    text + "[[interface]]\nname = \"all\"\nbetween = \"all\"\n"
}

fn probes(text: &mut String, world: &World, at: [f64; 2], patch: &str) {
    let at = world.point(at);
    for c in ["x", "y"] {
        *text += &format!("[[probe]]\nname = \"u{c}\"\nquantity = \"u.{c} at {at} in {patch}\"\n");
    }
}

/// A modest frame: files are moved by their own coordinates.
fn frame(r: &mut Random) -> World {
    World { length: 1.0, shift: [0.0; 2], ..World::random(r) }
}

/// Flat layers a and b touch, c hangs over b at a distance; thin ones have elements far longer than all of it.
pub fn clearance_of_layers(r: &mut Random, folder: &Path) -> Trial {
    let world = frame(r);
    let thickness: [f64; 3] = std::array::from_fn(|_| r.decades(-2.0, -0.3));
    let distance = thickness[1] * r.decades(-1.5, 0.0);
    let young: [f64; 3] = std::array::from_fn(|_| r.decades(-1.0, 1.0));
    let mut from = 0.0;
    for (k, name) in ["a", "b", "c"].into_iter().enumerate() {
        let (lo, hi) = (from, from + thickness[k]);
        let cells = [2 + r.below(6), 1 + r.below(2)];
        files::write(folder, name, cells, r.chance(0.5), &|[u, v]| world.place([u, lo + v * (hi - lo)]));
        from = hi + if k == 1 { distance } else { 0.0 };
    }
    let pressure = 1e-3;
    let mut text = bodies(&world, young, 0.2);
    text += "[[boundary]]\non = [\"a.v0\", \"c.v1\"]\nfix = [\"normal\"]\n";
    text += &format!("[[boundary]]\non = \"b.v1\"\npressure = {}\n", world.stress(pressure));
    probes(&mut text, &world, [0.3, thickness[0] + thickness[1]], "b");
    let compare = move |result: &RunResult| {
        let modulus = |e: f64| e * 0.8 / (1.2 * 0.6);
        let u = -pressure * (thickness[0] / modulus(young[0]) + thickness[1] / modulus(young[1]));
        let found = world.back(["x", "y"].map(|c| probe(result, &format!("u{c}"))), 1.0)[1];
        vec![Known { what: "u".into(), found, expected: u, within: 1e-6 * u.abs() }]
    };
    Trial { text, sound: true, rough: false, refuse: false, known: Box::new(compare) }
}

/// Quarters of rings of straight cells: a and b approximate one circle by different facets, c lies around b at a distance.
pub fn clearance_of_rings(r: &mut Random, folder: &Path) -> Trial {
    let world = frame(r);
    let distance = r.within(0.01, 0.03);
    let radii = [1.0, 1.4, 1.7, 1.7 + distance, 2.5 + distance];
    let mut facets = [0; 3];
    for (k, name) in ["a", "b", "c"].into_iter().enumerate() {
        let (lo, hi) = (radii[k + usize::from(k == 2)], radii[k + 1 + usize::from(k == 2)]);
        facets[k] = 8 + r.below(16);
        let place = |[u, v]: [f64; 2]| {
            let (s, c) = (u * std::f64::consts::FRAC_PI_2).sin_cos();
            let radius = lo + v * (hi - lo);
            world.place([radius * c, radius * s])
        };
        files::write(folder, name, [facets[k], 4 + r.below(3)], r.chance(0.5), &place);
    }
    let rings = [(1.0, 1.4, 1.0), (1.4, 1.7, 2.0)].map(|(a, b, young)| Ring { radius: [a, b], young, poisson: 0.3 });
    let pressure = 1e-3;
    let mut text = bodies(&world, [1.0, 2.0, 50.0], 0.3);
    text +=
        &format!("[[boundary]]\non = \"c.v1\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.v0\"\npressure = {}\n", world.stress(pressure));
    // a point on the wall, which every polygon has
    probes(&mut text, &world, [1.0, 0.0], "a");
    let compare = move |result: &RunResult| {
        let p = joints(&rings, &[0.0], [pressure, 0.0]);
        let u = rings[0].displacement([pressure, p[0]], 1.0);
        let found = world.back(["x", "y"].map(|c| probe(result, &format!("u{c}"))), 1.0)[0];
        vec![Known { what: "u in the bore".into(), found, expected: u, within: 0.15 * u.abs() }]
    };
    Trial { text, sound: true, rough: false, refuse: false, known: Box::new(compare) }
}

/// Two blocks on one another, the upper one on springs, and sides of which nothing can touch.
pub fn that_cannot_meet(r: &mut Random, _folder: &Path) -> Trial {
    let world = World::random(r);
    let names = ["u0", "u1", "v0", "v1"];
    let (slave, master) = loop {
        let upper = r.chance(0.5);
        let (s, m) = (*r.pick(&names.each_ref()), *r.pick(&names.each_ref()));
        let (a, b) = if upper { ("b", "a") } else { ("a", "b") };
        let meets = if upper { (s, m) == ("v0", "v1") } else { (s, m) == ("v1", "v0") };
        if !meets {
            break (format!("{a}.{s}"), format!("{b}.{m}"));
        }
    };
    let distance = [0.0, 0.01, 0.3][r.below(3)];
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = {}\npoisson = 0.3\n",
        world.stress(1.0)
    );
    for (name, from) in [("a", 0.0), ("b", 1.0 + distance)] {
        let backend = r.pick(&["iga", "fe"]);
        text += &format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {}\nelements = [{}, {}]\nbackend = \"{backend}\"\n",
            world.geometry(&format!("kind = \"box\", min = [0, {from}], max = [1, {}]", from + 1.0)),
            1 + r.below(5),
            1 + r.below(5)
        );
    }
    let k = format!("{:.17e}", 0.1 * world.modulus / world.length);
    let down = world.turned([0.0, -1e-3]).map(|t| t * world.modulus);
    text += &format!(
        "[[boundary]]\non = \"a.v0\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.v1\"\nspring = {{ x = {k}, y = {k} }}\n\
         traction = [{:.17e}, {:.17e}]\n[[contact]]\nname = \"c\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n",
        down[0], down[1]
    );
    Trial { text, sound: false, rough: false, refuse: true, known: Box::new(|_| Vec::new()) }
}
