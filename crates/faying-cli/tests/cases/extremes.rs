//! Extremes of fields over bodies: never inside of any value at a point, whatever the shape and the backend; their place beside them.

use faying_cli::case::ReadOptions;
use faying_cli::result::{ProbeReport, RunResult};
use faying_cli::{Case, Registry, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

fn probe<'a>(result: &'a RunResult, quantity: &str) -> &'a ProbeReport {
    result.probes.iter().find(|p| p.quantity == quantity).unwrap_or_else(|| panic!("no probe {quantity}"))
}

/// Numbers in 0..1 that look like chance.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A shape with loads, and the place of a point of its unit square or cube.
struct Shape {
    name: &'static str,
    dimension: usize,
    text: &'static str,
    place: fn(&[f64]) -> Vec<f64>,
}

fn polar(radius: [f64; 2], angle: [f64; 2], u: &[f64]) -> Vec<f64> {
    let (r, a) = (radius[0] + (radius[1] - radius[0]) * u[1], (angle[0] + (angle[1] - angle[0]) * u[0]).to_radians());
    vec![r * a.cos(), r * a.sin()]
}

const SHAPES: [Shape; 6] = [
    Shape {
        name: "bar with a load on a part of its end",
        dimension: 2,
        text: "[[patch]]\nname = \"p\"\ngeometry = { kind = \"box\", min = [0, 0], max = [2, 1] }\nelements = [5, 4]\n\
               [[boundary]]\non = \"p.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"p.right\"\ntraction = [\"sin(5*y)\", \"-y^2\"]\n",
        place: |u| vec![2.0 * u[0], u[1]],
    },
    Shape {
        name: "sector of a ring",
        dimension: 2,
        text: "[[patch]]\nname = \"p\"\ngeometry = { kind = \"annulus-sector\", radius = [1, 2], angle_deg = [10, 130] }\nelements = [6, 3]\n\
               [[boundary]]\non = \"p.u0\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"p.v1\"\npressure = \"1 + x\"\n",
        place: |u| polar([1.0, 2.0], [10.0, 130.0], u),
    },
    Shape {
        name: "disc",
        dimension: 2,
        text: "[[patch]]\nname = \"p\"\ngeometry = { kind = \"disc-sector\", radius = 1, angle_deg = [0, 90] }\nelements = [4, 3]\n\
               [[boundary]]\non = \"p.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"p.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"p.v1\"\npressure = \"x*y\"\n",
        // at the centre, or not so near to it that gradients are rounding
        place: |u| polar([0.0, 1.0], [0.0, 90.0], &[u[0], if u[1] < 1e-6 { 0.0 } else { u[1].max(1e-3) }]),
    },
    Shape {
        name: "plate with a hole",
        dimension: 2,
        text: "[[patch]]\nname = \"p\"\ngeometry = { kind = \"plate-with-hole\", radius = 1, half_width = 4 }\nelements = [8, 6]\n\
               [[boundary]]\non = \"p.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"p.u0\"\nfix = [\"y\"]\n\
               [[boundary]]\non = \"p.v1\"\nwhere = \"x > 3.99\"\ntraction = [1, 0]\n",
        place: |u| {
            let a = (90.0 * u[0]).to_radians();
            let (c, s) = (a.cos(), a.sin());
            let far = 4.0 / c.max(s);
            let r = 1.0 + (far - 1.0) * (0.02 + 0.96 * u[1].powi(3));
            vec![r * c, r * s]
        },
    },
    Shape {
        name: "block",
        dimension: 3,
        text: "[[patch]]\nname = \"p\"\ngeometry = { kind = \"box\", min = [0, 0, 0], max = [2, 1, 1] }\nelements = [3, 2, 2]\n\
               [[boundary]]\non = \"p.left\"\nfix = [\"x\", \"y\", \"z\"]\n[[boundary]]\non = \"p.right\"\ntraction = [\"y\", \"z^2\", \"-y\"]\n",
        place: |u| vec![2.0 * u[0], u[1], u[2]],
    },
    Shape {
        name: "octant of a sphere",
        dimension: 3,
        text: "[[patch]]\nname = \"p\"\ngeometry = { kind = \"sphere-octant\", radius = [1, 2] }\nelements = [3, 3, 2]\n\
               [[boundary]]\non = \"p.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"p.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"p.v0\"\nfix = [\"z\"]\n\
               [[boundary]]\non = \"p.w1\"\npressure = \"1 + z*x\"\n",
        place: |u| {
            let (a, b, r) = ((90.0 * u[0]).to_radians(), (90.0 * u[1]).to_radians(), 1.05 + 0.9 * u[2]);
            vec![r * b.cos() * a.cos(), r * b.cos() * a.sin(), r * b.sin()]
        },
    },
];

/// Fields that are asked for, by dimension.
fn fields(dimension: usize) -> &'static [&'static str] {
    if dimension == 2 {
        &["stress.xx", "stress.yy", "stress.xy", "von_mises", "u.x"]
    } else {
        &["stress.xx", "stress.yz", "von_mises", "u.z"]
    }
}

fn case(shape: &Shape, discretization: &str, points: usize, chance: &mut Chance) -> String {
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {}\n[discretization]\n{discretization}\n[[material]]\nname = \"m\"\nyoung = 10.0\npoisson = 0.3\n{}",
        shape.dimension, shape.text
    );
    for field in fields(shape.dimension) {
        for end in ["min", "max", "min.gauss", "max.gauss"] {
            text += &format!("[[probe]]\nquantity = \"{field}.{end}\"\n");
        }
    }
    for k in 0..points {
        // a part of them on faces and edges
        let u: Vec<f64> = (0..shape.dimension)
            .map(|_| match (k % 4, chance.next()) {
                (0, x) if x < 0.5 => (4.0 * x).round() / 2.0,
                (_, x) => x,
            })
            .map(|x| x.clamp(1e-9, 1.0 - 1e-9))
            .collect();
        let x: Vec<String> = (shape.place)(&u).iter().map(|x| format!("{x:?}")).collect();
        let field = fields(shape.dimension)[k % fields(shape.dimension).len()];
        text += &format!("[[probe]]\nquantity = \"{field} at [{}]\"\n", x.join(", "));
    }
    text
}

#[test]
fn no_value_at_a_point_is_beyond_the_extremes() {
    let mut chance = Chance(7);
    for shape in &SHAPES {
        let solids = ["backend = \"iga\"\ndegree = 2", "backend = \"fe\"\ndegree = 1", "backend = \"fe\"\ndegree = 2\ncells = \"simplex\""];
        let plane = ["backend = \"iga\"\ndegree = 3", "backend = \"fe\"\ndegree = 3", "backend = \"fe\"\ndegree = 1\ncells = \"simplex\""];
        for discretization in solids.iter().chain(plane.iter().filter(|_| shape.dimension == 2)) {
            let result = run(&case(shape, discretization, 1000, &mut chance));
            for field in fields(shape.dimension) {
                let of = |end: &str| probe(&result, &format!("{field}.{end}"));
                let (low, high) = (of("min"), of("max"));
                let rounding = 1e-8 * high.value.abs().max(low.value.abs());
                assert!(
                    of("min.gauss").value >= low.value && of("max.gauss").value <= high.value,
                    "{} {discretization} {field}",
                    shape.name
                );
                for p in [low, high, of("min.gauss")] {
                    assert_eq!(p.at.as_ref().map(Vec::len), Some(shape.dimension), "{} {discretization} {field}", shape.name);
                }
                let mut beyond = (0.0, String::new());
                for p in result.probes.iter().filter(|p| p.quantity.starts_with(&format!("{field} at"))) {
                    let by = (p.value - high.value).max(low.value - p.value);
                    if by > beyond.0 {
                        beyond = (by, p.quantity.clone());
                    }
                }
                assert!(
                    beyond.0 <= rounding,
                    "{} {discretization}: {} beyond {:?} by {:e}",
                    shape.name,
                    beyond.1,
                    [low.value, high.value],
                    beyond.0
                );
            }
        }
    }
}

#[test]
fn an_extreme_is_the_value_at_its_place() {
    // a plate with a hole under tension: the greatest stress is on the rim of the hole, at the end of its axis
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\n[[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0.3\n\
                [[patch]]\nname = \"p\"\ngeometry = { kind = \"plate-with-hole\", radius = 1, half_width = 20 }\nelements = [16, 16]\n\
                [[boundary]]\non = \"p.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"p.u0\"\nfix = [\"y\"]\n\
                [[boundary]]\non = \"p.v1\"\nwhere = \"x > 19.99\"\ntraction = [1, 0]\n\
                [[probe]]\nquantity = \"stress.xx.max\"\n[[probe]]\nquantity = \"stress.xx at [0, 1]\"\n[[probe]]\nquantity = \"stress.xx.max.gauss\"\n\
                [[check]]\nquantity = \"stress.xx.max\"\nabove = 3\n[[check]]\nquantity = \"stress.xx\"\nover = \"all\"\nbelow = 3.5\n";
    let result = run(text);
    let (most, at_point, inside) = (&result.probes[0], &result.probes[1], &result.probes[2]);
    let place = most.at.as_ref().unwrap();
    assert!((place[0].abs() + (place[1] - 1.0).abs()) < 0.01, "{place:?}");
    let above = most.value / at_point.value - 1.0;
    assert!((0.0..1e-3).contains(&above) && inside.value < 0.9 * most.value, "{most:?} {at_point:?} {inside:?}");
    assert!(result.checks.iter().all(|c| c.at.is_some()), "{:?}", result.checks);
    let document: serde_json::Value = serde_json::from_str(&result.to_json()).unwrap();
    assert_eq!(document["probes"][0]["at"].as_array().map(Vec::len), Some(2));
    // a cubic with its top inside of an element, found to rounding: x (1 - x) y (1 - y), flux.x = (1 - 2 x) y (1 - y)
    for backend in ["iga", "fe"] {
        let text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x*(1-x)*y*(1-y)\" }}\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
             [[patch]]\nname = \"p\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [3, 3]\n\
             [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n[[probe]]\nquantity = \"u.max\"\n[[probe]]\nquantity = \"flux.x.max\"\n[[probe]]\nquantity = \"flux.x.min\"\n"
        );
        let result = run(&text);
        let wanted = [(0.0625, [0.5, 0.5]), (0.25, [0.0, 0.5]), (-0.25, [1.0, 0.5])];
        for (found, (value, place)) in result.probes.iter().zip(wanted) {
            assert!((found.value - value).abs() < 1e-12, "{backend} {found:?}");
            let at = found.at.as_ref().unwrap();
            assert!((at[0] - place[0]).hypot(at[1] - place[1]) < 1e-5, "{backend} {found:?}");
        }
    }
}

/// Control points at a centre that are one but for rounding, as scripts write r cos(90 degrees): uniform stress there, in numbers and in files.
#[test]
fn stresses_at_a_pole_of_rounded_control_points_are_those_of_the_disc() {
    for off in [0.0, 6e-17, 1e-13, 2e-12, 5e-11] {
        let points = format!("[[0, 0], [{off:e}, {:e}], [{:e}, {off:e}], [1, 0], [1, 1], [0, 1]]", -0.5 * off, -0.3 * off);
        let w = std::f64::consts::FRAC_1_SQRT_2;
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = 2\nextra_points = 6\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n[[patch]]\nname = \"b\"\nelements = [2, 2]\n\
             geometry = {{ kind = \"nurbs\", degree = [2, 1], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], points = {points}, \
             weights = [1, {w}, 1, 1, {w}, 1] }}\n\
             [[boundary]]\non = \"b.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"b.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.v1\"\npressure = 0.001\n"
        ) + &["stress.xx.min", "stress.xx.max", "stress.xx at [0, 0]", "stress.xy.max", "stress.yy.min"]
            .map(|q| format!("[[probe]]\nquantity = \"{q}\"\n"))
            .concat();
        let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let finished =
            faying_cli::run::run(&case, &Registry::default(), &faying_cli::RunOptions::default(), &faying_cli::RunControl::default());
        let values: Vec<f64> = finished.result.probes.iter().map(|p| p.value).collect();
        let wanted = [-1e-3, -1e-3, -1e-3, 0.0, -1e-3];
        assert!(values.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9), "{off:e}: {values:?}");
        let bytes = finished.output.unwrap().parts.vtu().unwrap();
        let file = faying_files::vtu_read::parse(&bytes, &faying_files::Limits::default()).unwrap();
        let field = file.point_fields.iter().find(|f| f.name == "von_mises").unwrap_or_else(|| panic!("von_mises"));
        assert!(field.values.iter().all(|v| (v - 1e-3).abs() < 1e-9), "{off:e}: {:?}", field.values);
    }
}
