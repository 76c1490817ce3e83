//! A case and the same problem said by hand in Rust have the same numbers, bit for bit: samples, and choices of ties and contacts.

use faying::basis::Cell;
use faying::contact::{Cone, HalfPlane, Sphere};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::{Nitsche, Penalty};
use faying::geometry::ControlNet;
use faying::geometry::shapes::{annulus_sector, disc_sector, rectangle};
use faying::linalg::Vector;
use faying::physics::{Conductor, Hooke, Jet};
use faying::problem::{
    BodyId, Components, Contact, Data, Derivatives, Exact, Integration, InterfaceId, Multiplier, Point, Problem, Region, Solution, Start,
    Tie, Value,
};
use faying::space::{Divisions, Grading, Mapping, Mesh, MeshCells, Patch, PatchSpec, Trace, divided};
use faying_cli::case::ReadOptions;
use faying_cli::formula::{Constants, Formula, Scope};
use faying_cli::{Case, Registry, RunResult, Status};
use std::path::{Path, PathBuf};

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cases")
}

/// Runs a sample with probes of u and stress at points of its patches.
fn sample(name: &str, points: &[(&str, &[f64])]) -> (Case, RunResult) {
    let path = samples().join(name);
    let mut text = std::fs::read_to_string(&path).unwrap();
    text.push_str(&probes(points, text.contains("physics = \"poisson\"")));
    let options = ReadOptions { folder: Some(samples()), ..ReadOptions::default() };
    let case = Case::parse(path.to_str().unwrap(), &text, &options).unwrap_or_else(|e| panic!("{name}: {e}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(result.status, Status::Ok, "{name}");
    (case, result)
}

fn probes(points: &[(&str, &[f64])], scalar: bool) -> String {
    let mut text = String::new();
    for (k, (patch, x)) in points.iter().enumerate() {
        let components = if scalar { &["u"][..] } else { &["u.x", "u.y", "u.z"][..x.len()] };
        for c in components {
            text += &format!("[[probe]]\nname = \"parity-{k}-{}\"\nquantity = \"{c} at {x:?} in {patch}\"\n", c.replace('.', "-"));
        }
    }
    text
}

/// Compares a solution with the probes of a result.
fn same<const S: usize, const N: usize>(
    name: &str,
    result: &RunResult,
    solution: &Solution<S, N>,
    points: &[(&str, &[f64])],
    bodies: &[(&str, BodyId)],
) {
    let probes: Vec<f64> = result.probes.iter().filter(|p| p.name.starts_with("parity-")).map(|p| p.value).collect();
    let mut own = Vec::new();
    for (patch, x) in points {
        let body = bodies.iter().find(|(known, _)| known == patch).unwrap().1;
        let at = solution.at(body, &std::array::from_fn(|k| x[k])).unwrap();
        own.extend_from_slice(&at.u[..probes.len() / points.len()]);
    }
    assert_eq!(own, probes, "{name}");
    assert!(own.iter().any(|v| *v != 0.0), "{name}");
}

fn same_contact<const S: usize, const N: usize>(result: &RunResult, solution: &Solution<S, N>, name: &str) {
    let InterfaceId::Contact(contact) = solution.contents().contacts().find(|c| c.name() == name).unwrap().id() else { unreachable!() };
    let (own, report) = (solution.contact(contact).unwrap(), result.contact.get(name).unwrap());
    assert_eq!(own.force.as_slice(), &report.force[..]);
    assert_eq!(own.area, report.area);
    assert_eq!(own.active, report.active);
}

/// Formulas of a case as data of a problem.
struct Words(Constants);

impl Words {
    fn of(case: &Case) -> Self {
        Self(case.constants.clone())
    }
    fn formula(&self, text: &str) -> Formula {
        Formula::parse(text, &Scope::gap(&self.0)).unwrap_or_else(|e| panic!("{text}: {e}"))
    }
    fn data(&self, text: &str) -> Data {
        self.formula(text).into()
    }
    fn number(&self, text: &str) -> f64 {
        self.formula(text).value(&Point::default())
    }
    fn exact(&self, components: &[&str]) -> Formulas {
        Formulas(components.iter().map(|c| self.formula(c)).collect())
    }
}

/// An exact solution by the derivatives of its formulas.
#[derive(Debug)]
struct Formulas(Vec<Formula>);

impl Exact for Formulas {
    fn value(&self, component: usize, at: &Point) -> f64 {
        self.0[component].value(at)
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        let jet = self.0[component].slope(at);
        Derivatives { value: jet.value, gradient: jet.gradient, hessian: jet.hessian }
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        let jet = self.0[component].jet(at);
        Derivatives { value: jet.value, gradient: jet.gradient, hessian: jet.hessian }
    }
}

fn box_of(lo: [f64; 2], hi: [f64; 2]) -> PatchSpec<2> {
    PatchSpec::new(rectangle(lo, hi).unwrap())
}

fn iga(spec: &PatchSpec<2>) -> Patch<1, 2> {
    Patch::try_new(spec).unwrap()
}

fn lists(net: &ControlNet<2, 2>, u: &Divisions, v: &Divisions, grading: [Option<Grading>; 2]) -> [Vec<f64>; 2] {
    let axis = |k: usize, divisions| divided(net.axes[k].breakpoints(), divisions, grading[k], 0).unwrap();
    [axis(0, u), axis(1, v)]
}

fn steel() -> Hooke<2> {
    Hooke::plane_strain(1.0, 0.3).unwrap()
}

#[test]
fn the_contact_patch_test() {
    let points: &[(&str, &[f64])] = &[("lower", &[0.3, 0.2]), ("upper", &[0.7, 0.9])];
    let (_, result) = sample("contact-patch.toml", points);
    let mut p = Problem::<1, 2>::new();
    let lower = p.body("lower", iga(&box_of([0.0, 0.0], [1.0, 0.5]).with_elements([4, 2])), steel()).unwrap();
    let upper = box_of([0.0, 0.5], [1.0, 1.0]);
    let elements = lists(&upper.net, &Divisions::Breakpoints(vec![0.0, 0.2, 0.45, 0.8, 1.0]), &Divisions::Total(2), [None; 2]);
    let upper = p.body("upper", iga(&upper.with_breakpoints(elements)), steel()).unwrap();
    p.fix(lower.side("v0"), Components::Y).unwrap();
    p.fix(lower.side("u0"), Components::X).unwrap();
    p.fix(upper.side("u0"), Components::X).unwrap();
    p.pressure(upper.side("v1"), 1.25e-3).unwrap();
    p.contact(upper.side("v0"), lower.side("v1")).unwrap().named("pad").symmetry();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("contact-patch", &result, &s, points, &[("lower", lower), ("upper", upper)]);
    same_contact(&result, &s, "pad");
}

#[test]
fn hertz() {
    let points: &[(&str, &[f64])] = &[("cylinder", &[0.3, 0.4]), ("cylinder", &[0.01, 0.05])];
    let (case, result) = sample("hertz.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<1, 2>::new();
    let net = annulus_sector([0.0, 1.0], [words.number("0.1*R"), 1.0], [-90.0, 0.0]).unwrap();
    let grading = |toward| Some(Grading { toward, ratio: 0.02 });
    let elements = lists(&net, &Divisions::Total(64), &Divisions::Total(40), [grading(0.0), grading(1.0)]);
    let cylinder = p.body("cylinder", iga(&PatchSpec::new(net).with_breakpoints(elements)), steel()).unwrap();
    p.fix(cylinder.side("u0"), Components::X).unwrap();
    p.traction(cylinder.side("u1"), 1, words.data("-0.5*F/(0.9*R)")).unwrap();
    let plane = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
    p.contact(cylinder.side("v1"), plane).unwrap().named("plane").symmetry();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("hertz", &result, &s, points, &[("cylinder", cylinder)]);
    same_contact(&result, &s, "plane");
}

#[test]
fn a_manufactured_solution_on_a_ring() {
    let points: &[(&str, &[f64])] = &[("ring", &[1.1, 1.0]), ("ring", &[0.5, 1.5])];
    let (case, result) = sample("poisson-arc.toml", points);
    let words = Words::of(&case);
    let k = words.formula("1 + 0.5*x");
    let conductor = Conductor::<2>::varying(move |x: &Vector<2>| {
        let jet = k.slope(&Point::new(x.as_slice()));
        Jet::new(jet.value, Vector::from_fn(|i, _| jet.gradient[i]))
    });
    let mut p = Problem::<1, 2>::new();
    let spec = PatchSpec::new(annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap()).with_elements([24, 16]);
    let ring = p.body("ring", iga(&spec), conductor).unwrap();
    p.exact(words.exact(&["sin(pi*x)*exp(y) + r^2*theta"]));
    for side in ["u0", "u1", "v1"] {
        p.prescribe(ring.side(side), 0, Value::Exact).unwrap();
    }
    p.traction(ring.side("v0"), 0, Value::Exact).unwrap();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("poisson-arc", &result, &s, points, &[("ring", ring)]);
}

#[test]
fn a_seam_of_two_squares() {
    let points: &[(&str, &[f64])] = &[("lower", &[0.3, 0.2]), ("upper", &[0.7, 0.9])];
    let (case, result) = sample("seam.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<1, 2>::new();
    let spec = |lo, hi, n| iga(&box_of(lo, hi).with_degree([3, 3]).with_elements(n));
    let lower = p.body("lower", spec([0.0, 0.0], [1.0, 0.5], [6, 3]), Conductor::<2>::try_new(1.0).unwrap()).unwrap();
    let upper = p.body("upper", spec([0.0, 0.5], [1.0, 1.0], [4, 2]), Conductor::<2>::try_new(1.0).unwrap()).unwrap();
    p.exact(words.exact(&["cos(3*x + 0.3)*exp(y) + sin(2*pi*x*y)"]));
    p.prescribe(lower.side("v0"), 0, Value::Exact).unwrap();
    p.prescribe(upper.side("v1"), 0, Value::Exact).unwrap();
    for side in [lower.side("u0"), lower.side("u1"), upper.side("u0"), upper.side("u1")] {
        p.traction(side, 0, Value::Exact).unwrap();
    }
    p.tie(lower.side("v1"), upper.side("v0")).unwrap().named("seam");
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("seam", &result, &s, points, &[("lower", lower), ("upper", upper)]);
}

#[test]
fn a_ring_tied_to_triangles() {
    let points: &[(&str, &[f64])] = &[("inner", &[1.0, 0.5]), ("outer", &[1.2, 1.3])];
    let (case, result) = sample("iga-fe-arc.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<1, 2>::new();
    let ring = |a, b, n| PatchSpec::new(annulus_sector([0.0, 0.0], [a, b], [0.0, 90.0]).unwrap()).with_elements(n);
    let inner = p.body("inner", iga(&ring(1.0, 1.5, [12, 6])), steel()).unwrap();
    let triangles = ring(1.5, 2.0, [17, 6]).with_cells(Cell::Simplex);
    let outer = p.body("outer", Mesh::from_patch(&triangles).unwrap(), steel()).unwrap();
    p.exact(words.exact(&["(A + B/r^2)*x", "(A + B/r^2)*y"]));
    for body in [inner, outer] {
        p.fix(body.side("u0"), Components::Y).unwrap();
    }
    for body in [inner, outer] {
        p.fix(body.side("u1"), Components::X).unwrap();
    }
    p.pressure(inner.side("v0"), words.data("p")).unwrap();
    p.tie(inner.side("v1"), outer.side("v0")).unwrap().named("arc");
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("iga-fe-arc", &result, &s, points, &[("inner", inner), ("outer", outer)]);
}

#[test]
fn a_shrink_fit() {
    let points: &[(&str, &[f64])] = &[("inner", &[30.0, 25.0]), ("outer", &[55.0, 30.0])];
    let (case, result) = sample("shrink-fit.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<1, 2>::new();
    let ring = |a, b, n| {
        let net = annulus_sector([0.0, 0.0], [a, b], [0.0, 90.0]).unwrap();
        iga(&PatchSpec::new(net).with_degree([3, 3]).with_mapping(Mapping::Exact).with_elements(n))
    };
    let inner = p.body("inner", ring(30.0, 50.0, [6, 4]), Hooke::plane_strain(210e3, 0.3).unwrap()).unwrap();
    let outer = p.body("outer", ring(50.0, 80.0, [8, 5]), Hooke::plane_strain(70e3, 0.33).unwrap()).unwrap();
    for (side, component) in [("u0", Components::Y), ("u1", Components::X)] {
        for body in [inner, outer] {
            p.fix(body.side(side), component).unwrap();
        }
    }
    p.contact(outer.side("v0"), inner.side("v1")).unwrap().named("fit").gap(words.data("g - delta")).symmetry();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("shrink-fit", &result, &s, points, &[("inner", inner), ("outer", outer)]);
    same_contact(&result, &s, "fit");
}

#[test]
fn a_cylinder_on_a_block() {
    let points: &[(&str, &[f64])] = &[("lower", &[10.0, 30.0]), ("upper", &[10.0, 80.0]), ("block", &[23.0, -61.0])];
    let (case, result) = sample("cylinder-on-block.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<1, 2>::new();
    let written = |patch: &str| {
        let read = case.patches.iter().find(|p| p.name.value == patch).unwrap();
        [0, 1].map(|k| read.elements.value[k].value.clone())
    };
    let body = |patch: &str, net: ControlNet<2, 2>| {
        let [u, v] = written(patch);
        let elements = lists(&net, &u, &v, [None; 2]);
        iga(&PatchSpec::new(net).with_breakpoints(elements))
    };
    let arc = |angles| disc_sector([0.0, 50.0], 50.0, angles).unwrap();
    let metal = |young| Hooke::plane_strain(young, 0.3).unwrap();
    let lower = p.body("lower", body("lower", arc([-90.0, 0.0])), metal(210e3)).unwrap();
    let upper = p.body("upper", body("upper", arc([0.0, 90.0])), metal(210e3)).unwrap();
    let block = p.body("block", body("block", rectangle([0.0, -200.0], [100.0, 0.0]).unwrap()), metal(70e3)).unwrap();
    p.glue(upper.side("u0"), lower.side("u1"), None).unwrap();
    for side in [lower.side("u0"), upper.side("u1"), block.side("u0")] {
        p.fix(side, Components::X).unwrap();
    }
    p.fix(block.side("v0"), Components::All).unwrap();
    p.traction(upper.side("v1"), 1, words.data("-0.5*F/R*(315/128)*((y - R)/R)^9")).unwrap();
    p.contact(lower.side("v1"), block.side("v1")).unwrap().named("line").symmetry();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("cylinder-on-block", &result, &s, points, &[("lower", lower), ("upper", upper), ("block", block)]);
    same_contact(&result, &s, "line");
}

#[test]
fn a_pipe_as_three_solids() {
    let points: &[(&str, &[f64])] =
        &[("nurbs", &[1.03, 0.47, 0.41]), ("hexahedra", &[1.03, 0.47, 2.17]), ("tetrahedra", &[1.03, 0.47, 3.71])];
    let (case, result) = sample("solid.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<2, 3>::new();
    let spec = |z: f64| {
        let ring = annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap().extrude(1.0);
        PatchSpec::new(if z == 0.0 { ring } else { ring.translate(&Vector::from([0.0, 0.0, z])) }).with_elements([6, 4, 2])
    };
    let steel = || Hooke::solid(1.0, 0.3).unwrap();
    let nurbs = p.body("nurbs", Patch::<2, 3>::try_new(&spec(0.0)).unwrap(), steel()).unwrap();
    let hexahedra = p.body("hexahedra", Mesh::<2, 3>::from_patch(&spec(1.5)).unwrap(), steel()).unwrap();
    let tetrahedra = p.body("tetrahedra", Mesh::<2, 3>::from_patch(&spec(3.0).with_cells(Cell::Simplex)).unwrap(), steel()).unwrap();
    p.exact(words.exact(&["(A + B/r^2)*x", "(A + B/r^2)*y", "0"]));
    let all = [nurbs, hexahedra, tetrahedra];
    for (sides, component) in [(&["u0"][..], Components::Y), (&["u1"], Components::X), (&["w0", "w1"], Components::Z)] {
        for side in all.iter().flat_map(|b| sides.iter().map(|s| b.side(s))) {
            p.fix(side, component).unwrap();
        }
    }
    for body in all {
        p.pressure(body.side("v0"), words.data("p")).unwrap();
    }
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("solid", &result, &s, points, &[("nurbs", nurbs), ("hexahedra", hexahedra), ("tetrahedra", tetrahedra)]);
}

/// The cells that the first patch of a case was read from.
fn cells(case: &Case) -> MeshCells<2> {
    case.patches[0].geometry.value.shape.value.part().and_then(|part| part.cells::<2>()).unwrap()
}

#[test]
fn a_bracket_from_a_mesh() {
    let points: &[(&str, &[f64])] = &[("bracket", &[10.0, 50.0]), ("bracket", &[50.0, 10.0])];
    let (case, result) = sample("l-bracket.toml", points);
    let words = Words::of(&case);
    let mut p = Problem::<1, 2>::new();
    let mesh = Mesh::<1, 2>::from_cells(&cells(&case), 2, Mapping::Isoparametric).unwrap();
    let bracket = p.body("bracket", mesh, Hooke::plane_stress(210e3, 0.3).unwrap()).unwrap();
    p.fix(bracket.side("upper bolt"), Components::All).unwrap();
    p.fix(bracket.side("lower bolt"), Components::All).unwrap();
    p.force(bracket.side("load"), 1, words.data("-F/thickness")).unwrap();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    same("l-bracket", &result, &s, points, &[("bracket", bracket)]);
    let bolt = result.reactions.get("bracket.\"upper bolt\"").unwrap();
    assert_eq!(&s.reaction(bracket.side("upper bolt")).unwrap(), bolt);
}

type P = Problem<1, 2>;

/// A spline square below a mesh, four elements high.
fn two(p: &mut P) -> (BodyId, BodyId) {
    let lower = p.body("l", iga(&box_of([0.0, 0.0], [1.0, 1.0]).with_elements([3, 4])), steel()).unwrap();
    let upper = p.body("u", Mesh::from_patch(&box_of([0.0, 1.0], [1.0, 2.0]).with_elements([4, 4])).unwrap(), steel()).unwrap();
    p.fix(lower.side("v0"), Components::All).unwrap();
    (lower, upper)
}

const HEAD: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"s\"\nyoung = 1.0\npoisson = 0.3\n\
    [[patch]]\nname = \"l\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [3, 4]\n\
    [[patch]]\nname = \"u\"\nbackend = \"fe\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [4, 4]\n\
    [[boundary]]\non = \"l.bottom\"\nfix = [\"x\", \"y\"]\n";

/// Compares a problem of both squares with a case.
#[track_caller]
fn both(tail: &str, say: impl Fn(&mut P, BodyId, BodyId)) {
    let points: &[(&str, &[f64])] = &[("l", &[0.8, 0.6]), ("u", &[0.3, 1.7])];
    let registry = own_names();
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let case = Case::parse("case.toml", &format!("{HEAD}{tail}{}", probes(points, false)), &options).unwrap_or_else(|e| panic!("{e}"));
    let result = case.run(&registry).unwrap_or_else(|e| panic!("{e}"));
    let mut p = P::new();
    let (l, u) = two(&mut p);
    say(&mut p, l, u);
    let s = p.assemble().unwrap_or_else(|e| panic!("{e}")).solve(1.0, None).unwrap();
    same(tail, &result, &s, points, &[("l", l), ("u", u)]);
    for (name, _) in result.contact.iter() {
        same_contact(&result, &s, name);
    }
}

fn own_names() -> Registry {
    let mut registry = Registry::default();
    registry.plane.multipliers.add("mine", own_multiplier());
    registry
}

/// p/p by another way.
fn own_multiplier() -> Multiplier<1, 2> {
    Multiplier::of(|trace: &Trace<1, 2>, constrained| {
        use faying::problem::InterfaceSide;
        trace.multiplier(MultiplierKind::Lowered(0), constrained)
    })
}

const PUSH: &str = "[[boundary]]\non = \"u.top\"\npressure = 1e-3\n";
const SIDE: &str = "[[boundary]]\non = \"u.left\"\nfix = [\"x\"]\n";
const TIE: &str = "[[interface]]\nname = \"t\"\nslave = \"u.bottom\"\nmaster = \"l.top\"\n";
const PAD: &str = "[[contact]]\nname = \"c\"\nslave = \"u.bottom\"\nmaster = \"l.top\"\n";

#[track_caller]
fn tied(keys: &str, choose: impl Fn(&mut Tie)) {
    both(&format!("{PUSH}{TIE}{keys}"), |p, l, u| {
        p.pressure(u.side("v1"), 1e-3).unwrap();
        choose(p.tie(u.side("v0"), l.side("v1")).unwrap());
    });
}

#[track_caller]
fn pressed(keys: &str, choose: impl Fn(&mut Contact)) {
    both(&format!("{PUSH}{SIDE}{PAD}{keys}"), |p, l, u| {
        p.pressure(u.side("v1"), 1e-3).unwrap();
        p.fix(u.side("u0"), Components::X).unwrap();
        let contact = p.contact(u.side("v0"), l.side("v1")).unwrap().named("c");
        choose(contact);
    });
}

#[test]
fn every_choice_of_a_tie() {
    tied("", |_| ());
    tied("coupling = \"penalty\"\nfactor = 100\n", |t| {
        t.coupling(Penalty { factor: 100.0 });
    });
    tied("coupling = \"penalty\"\n", |t| {
        t.coupling(Penalty { factor: Penalty::AUTO });
    });
    tied("coupling = \"nitsche\"\n", |t| {
        t.coupling(Nitsche::default());
    });
    for (word, kind) in [
        ("p/p", MultiplierKind::Lowered(0)),
        ("p/p-2", MultiplierKind::Lowered(2)),
        ("dual", MultiplierKind::Dual),
        ("constant", MultiplierKind::Constant),
    ] {
        tied(&format!("multiplier = \"{word}\"\n"), |t| {
            t.multiplier(kind);
        });
    }
    tied("multiplier = \"mine\"\n", |t| {
        t.multiplier(own_multiplier());
    });
    tied("multiplier = \"dual\"\nintegration = \"mixed\"\n", |t| {
        t.multiplier(MultiplierKind::Dual).rule(Integration::Mixed);
    });
    tied("integration = \"slave\"\nextra_points = 3\n", |t| {
        t.rule(Integration::Slave).extra_points(3);
    });
    both(
        &format!("[[boundary]]\non = \"u.top\"\nforce = {{ x = 1e-3 }}\n[[boundary]]\non = \"u.right\"\nspring = {{ x = 0.1 }}\n{TIE}"),
        |p, l, u| {
            p.force(u.side("v1"), 0, 1e-3).unwrap();
            p.spring(u.side("u1"), 0, 0.1).unwrap();
            p.tie(u.side("v0"), l.side("v1")).unwrap();
        },
    );
    both(&format!("[[boundary]]\non = [\"u.left\", \"u.right\"]\nrigid_force = {{ y = -1e-3 }}\n{TIE}"), |p, l, u| {
        let flanks = p.union([Region::from(u.side("u0")), u.side("u1").into()]).unwrap();
        p.rigid(flanks, 1, -1e-3).unwrap();
        p.tie(u.side("v0"), l.side("v1")).unwrap();
    });
    both(&format!("[[boundary]]\non = \"u.top\"\nwhere = \"x > 0.5\"\ntraction = {{ y = \"-x\" }}\n{TIE}"), |p, l, u| {
        let half = p.part(u.side("v1"), "x > 0.5", &|x| x[0] > 0.5).unwrap().unwrap();
        p.traction(half, 1, Data::of(|x, _| -x[0])).unwrap();
        p.tie(u.side("v0"), l.side("v1")).unwrap();
    });
}

#[test]
fn every_choice_of_a_contact() {
    pressed("", |_| ());
    pressed("multiplier = \"p/p\"\ncone = \"weights\"\n", |c| {
        c.multiplier(MultiplierKind::Lowered(0)).cone(Cone::Weights);
    });
    pressed("multiplier = \"p/p\"\ncone = \"values\"\n", |c| {
        c.multiplier(MultiplierKind::Lowered(0)).cone(Cone::Values);
    });
    pressed("multiplier = \"dual\"\n", |c| {
        c.multiplier(MultiplierKind::Dual);
    });
    pressed("multiplier = \"mine\"\n", |c| {
        c.multiplier(own_multiplier());
    });
    pressed("integration = \"mixed\"\n", |c| {
        c.rule(Integration::Mixed);
    });
    pressed("gap = \"g - 0.01*x\"\n", |c| {
        c.gap(Data::of_gap(|x, _, g| g - 0.01 * x[0]));
    });
    pressed("active_set = { start = { seed = 3 } }\n", |c| {
        c.start(Start::Seed(3));
    });
    pressed("method = \"penalty\"\n", |c| {
        c.method(Penalty::default());
    });
    pressed("method = \"augmented\"\nfactor = 100\n", |c| {
        c.method(faying::contact::Augmented { factor: 100.0, ..Default::default() });
    });
    pressed("method = \"nitsche\"\n", |c| {
        c.method(Nitsche::default());
    });
    both(
        &format!(
            "{TIE}[[contact]]\nname = \"b\"\nslave = \"u.top\"\nrigid = {{ kind = \"half-plane\", point = [0, 2], normal = [0, -1], move = [0, \"-0.01*t\"] }}\n"
        ),
        |p, l, u| {
            p.tie(u.side("v0"), l.side("v1")).unwrap();
            let plane = HalfPlane::try_new(Vector::from([0.0, 2.0]), Vector::from([0.0, -1.0])).unwrap();
            p.contact(u.side("v1"), plane).unwrap().named("b").moved(1, Data::of(|_, t| -0.01 * t));
        },
    );
    both(
        &format!(
            "{TIE}[[contact]]\nname = \"b\"\nslave = \"u.top\"\nrigid = {{ kind = \"sphere\", center = [0.5, 3.0], radius = 1.0, force = [0, -1e-3] }}\n"
        ),
        |p, l, u| {
            p.tie(u.side("v0"), l.side("v1")).unwrap();
            let ball = Sphere { center: Vector::from([0.5, 3.0]), radius: 1.0, inside: false };
            p.contact(u.side("v1"), ball).unwrap().named("b").pressed(0, 0.0).pressed(1, -1e-3);
        },
    );
}

/// A multiplier from outside on a slave side that ends 1e-4 of an element beyond its master: functions on the sliver go to their
/// neighbours, as those of the library do.
#[test]
fn a_multiplier_from_outside_has_no_functions_on_slivers() {
    const EDGE: f64 = 0.750_025;
    let problem = |multiplier: Multiplier<1, 2>| {
        let mut p = P::new();
        let linear = |lo, hi, n| iga(&box_of(lo, hi).with_degree([1, 1]).with_elements(n));
        let lower = p.body("lower", linear([0.0, 0.0], [EDGE, 1.0], [3, 4]), steel()).unwrap();
        let upper = p.body("upper", linear([0.0, 1.0], [1.0, 2.0], [4, 4]), steel()).unwrap();
        p.fix(lower.side("v0"), Components::All).unwrap();
        p.fix(lower.side("u0"), Components::X).unwrap();
        p.fix(upper.side("u0"), Components::X).unwrap();
        p.prescribe(upper.side("v1"), 1, -1e-3).unwrap();
        let pad = p.contact(upper.side("v0"), lower.side("v1")).unwrap().multiplier(multiplier).id();
        p.assemble().unwrap().solve(1.0, None).unwrap().contact(pad).unwrap().largest_pressure
    };
    let case = |word: &str| {
        let registry = own_names();
        let text = format!(
            "[discretization]\ndegree = 1\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"s\"\nyoung = 1.0\n\
             poisson = 0.3\n[[patch]]\nname = \"lower\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{EDGE}, 1] }}\n\
             elements = [3, 4]\n[[patch]]\nname = \"upper\"\ngeometry = {{ kind = \"box\", min = [0, 1], max = [1, 2] }}\n\
             elements = [4, 4]\n[[boundary]]\non = \"lower.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = [\"lower.left\", \
             \"upper.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"upper.top\"\ndirichlet = {{ y = -1e-3 }}\n[[contact]]\nname = \"pad\"\n\
             slave = \"upper.bottom\"\nmaster = \"lower.top\"\nmultiplier = \"{word}\"\n"
        );
        let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
        let result = Case::parse("case.toml", &text, &options).unwrap().run(&registry).unwrap();
        result.contact.get("pad").unwrap().pressure.max
    };
    let expected = problem(MultiplierKind::Lowered(0).into());
    assert!((expected - 9.707e-4).abs() < 1e-7, "{expected}");
    assert_eq!(problem(own_multiplier()), expected);
    let (built_in, outside) = (case("p/p"), case("mine"));
    assert_eq!(built_in, outside);
    assert!((built_in - 9.707e-4).abs() < 1e-7, "{built_in}");
}
