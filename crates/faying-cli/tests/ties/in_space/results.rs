//! Results of ties in space: files, quantities, searches, solvers, and the same problem said in Rust.

use super::{KINDS, error, read, run, stacked};
use faying::linalg::Vector;
use faying::physics::Conductor;
use faying::problem::{Components, Problem};
use faying::space::{Mesh, Patch, PatchSpec};
use faying_cli::case::ReadOptions;
use faying_cli::plot::{self, FieldPlot, SurfaceQuantity};
use faying_cli::run::run as run_case;
use faying_cli::table::short;
use faying_cli::{Case, Registry, RunControl, RunOptions, SideOutput, SidePart};

#[test]
fn files_show_lambda_gap_traction_and_normal_of_the_side() {
    for (coupling, rows) in [("mortar", 6), ("nitsche", 0)] {
        let case = read(&stacked(false, [KINDS[0], KINDS[2]], 2, &format!("coupling = \"{coupling}\"")), &[]);
        let finished = run_case(&case, &Registry::default(), &RunOptions::default(), &RunControl::default());
        let output = finished.output.unwrap();
        let [side] = &output.sides[..] else { panic!("one side") };
        assert!(!side.contact && side.name == "seam" && (rows == 0 || side.rows.len() == rows), "{coupling}: {}", side.rows.len());
        // stress of u = G x with E = 1 and nu = 0.3: 2 mu eps + lambda tr(eps); the normal of the master is that of z, turned
        let (mu, first) = (1.0 / 2.6, 0.3 / (1.3 * 0.4));
        let trace = 0.3 - 0.4 + 0.7;
        let gradient = [[0.3, -0.2, 0.5], [0.1, -0.4, 0.2], [-0.6, 0.3, 0.7]];
        let SidePart::Surface(part) = &side.part else { panic!("a surface") };
        let names: Vec<(&str, usize)> = part.fields.iter().map(|f| (f.name.as_str(), f.components)).collect();
        assert_eq!(names, [("lambda", 3), ("gap", 1), ("active", 1), ("traction", 3), ("normal", 3)]);
        let xi = [Vector::<2>::new(0.3, 0.6)];
        for element in 0..6 {
            let value = |k: usize| (part.fields[k].sample)(element, &xi);
            let (lambda, normal) = (value(0), value(4));
            for i in 0..3 {
                let stress = |j: usize| mu * (gradient[i][j] + gradient[j][i]) + if i == j { first * trace } else { 0.0 };
                // on the slave, whose normal is the opposite one
                let wanted: f64 = (0..3).map(|j| stress(j) * normal[j]).sum();
                assert!((lambda[i] - wanted).abs() < 1e-9, "{coupling} {element} {i}: {} {wanted}", lambda[i]);
                assert_eq!(value(3)[i], -lambda[i]);
            }
            assert!((normal.iter().map(|n| n * n).sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(value(1)[0].abs() < 1e-9 && value(2) == [1.0], "{coupling}");
        }
        let text = faying_cli::table::interface_csv(&side.rows);
        assert!(text.starts_with("s,x,y,z,lambda.x,lambda.y,lambda.z,gap,active\n,"), "{text}");
        assert!(!SideOutput::vtu(&output.sides).unwrap().is_empty());
        // lambda = sigma m on the normal m of the master: one number everywhere, as its normal part m . sigma m, and what is left of it
        let sigma = |i: usize, j: usize| mu * (gradient[i][j] + gradient[j][i]) + if i == j { first * trace } else { 0.0 };
        let m = (part.fields[4].sample)(0, &xi);
        let pull: Vec<f64> = (0..3).map(|i| (0..3).map(|j| sigma(i, j) * m[j]).sum()).collect();
        let along: f64 = pull.iter().zip(&m).map(|(a, b)| a * b).sum();
        let across = (pull.iter().map(|p| p * p).sum::<f64>() - along * along).sqrt();
        for (shown, value) in SurfaceQuantity::all(false, 3).iter().zip([along, across]) {
            let svg = plot::surface(&FieldPlot { title: "seam", label: shown.label(), ..FieldPlot::default() }, *shown, &[part]).unwrap();
            let said = format!("{}: {} everywhere", shown.label(), short(value, 4));
            assert!(svg.contains(&said), "{said}: {svg}");
        }
    }
}

/// At the pole of an octant, where the tangents are dependent, files show the normal of the surface, too: of ties and of contacts.
#[test]
fn normals_at_poles_are_those_beside_them() {
    let octant = |name: &str, radii: &str, n: &str| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"sphere-octant\", radius = {radii} }}\nelements = {n}\n")
    };
    for (statement, master) in [
        ("interface", "master = \"outer.w0\"\n"),
        ("interface", "master = \"outer.w0\"\ncoupling = \"nitsche\"\n"),
        ("contact", "master = \"outer.w0\"\n"),
        ("contact", "rigid = { kind = \"sphere\", center = [0, 0, 0], radius = 1.4999, inside = true }\n"),
    ] {
        let text = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\ndegree = 2\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n"
            .to_owned()
            + &octant("inner", "[1, 1.5]", "[3, 2, 1]")
            + &octant("outer", "[1.5, 2]", "[2, 2, 1]")
            + "[[boundary]]\non = [\"inner.w0\", \"outer.w1\"]\npressure = 0.001\n\
               [[boundary]]\non = [\"inner.u0\", \"outer.u0\"]\nfix = [\"normal\"]\n\
               [[boundary]]\non = [\"inner.u1\", \"outer.u1\"]\nfix = [\"normal\"]\n\
               [[boundary]]\non = [\"inner.v0\", \"outer.v0\"]\nfix = [\"normal\"]\n"
            + &format!("[[{statement}]]\nname = \"seam\"\nslave = \"inner.w1\"\n{master}");
        let finished = run_case(&read(&text, &[]), &Registry::default(), &RunOptions::default(), &RunControl::default());
        let output = finished.output.unwrap_or_else(|| panic!("{statement} {master}"));
        let SidePart::Surface(part) = &output.sides[0].part else { panic!("a surface") };
        for element in 0..6 {
            let [at, center] = [[0.5, 1.0], [0.5, 0.5]].map(|[u, v]| (part.fields[4].sample)(element, &[Vector::<2>::new(u, v)]));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            assert!((dot(&at, &at) - 1.0).abs() < 1e-9 && dot(&at, &center) > 0.8, "{statement} {master}, {element}: {at:?} {center:?}");
            if element > 2 {
                assert!((at[2].abs() - 1.0).abs() < 1e-5, "{statement} {master}, {element}: {at:?}");
            }
        }
    }
}

#[test]
fn lambda_at_a_point_and_numbers_by_their_paths() {
    let probes = "[[probe]]\nname = \"l\"\nquantity = \"interface.seam.lambda at [0.5, 0.4, 0]\"\n\
                  [[probe]]\nname = \"n\"\nquantity = \"interface.seam.segments.count\"\n\
                  [[probe]]\nname = \"a\"\nquantity = \"interface.seam.segments.measure\"\n";
    let text = stacked(true, [KINDS[3], KINDS[0]], 2, "").replace(", rotate_deg = 40, axis = [1, 2, 0.5]", "") + probes;
    let result = run(&text, &[]);
    let value = |k: usize| result.probes[k].value;
    // minus k du/dn of the slave, whose normal is -z
    assert!((value(0) - 2.0 * 0.5).abs() < 1e-9, "{}", value(0));
    assert!(value(1) >= 12.0 && (value(2) - 0.8).abs() < 1e-12, "{} {}", value(1), value(2));
}

/// Three boxes in a row: every pair of touching sides is found, and gives what names give.
#[test]
fn touching_sides_are_found() {
    let named = run(&stacked(false, [KINDS[0], KINDS[2]], 2, ""), &[]);
    let all = stacked(false, [KINDS[0], KINDS[2]], 2, "").replace("slave = \"upper.bottom\"\nmaster = \"lower.top\"", "between = \"all\"");
    let found = run(&all, &[]);
    let sides = &found.interface.get("seam").unwrap().sides;
    assert_eq!(sides.len(), 1, "{sides:?}");
    assert!(error(&found, "error.u.L2") < 1e-9 && error(&named, "error.u.L2") < 1e-9);
}

#[test]
fn every_solver_gives_the_same_numbers() {
    let text = stacked(false, [KINDS[2], KINDS[0]], 2, "").replace("\"0.1*x - 0.4*y + 0.2*z\"", "\"0.1*x^2 - 0.4*y*z + 0.2*z\"");
    let wanted = run(&text, &[]).interface.get("seam").unwrap().lambda.norm;
    for sets in [
        &["solver.constraint=\"condensed\""][..],
        &["solver.constraint=\"schur\""],
        &["solver.constraint=\"uzawa\""],
        &["solver.linear=\"iterative\"", "solver.tolerance=1e-11"],
    ] {
        let found = run(&format!("{text}[solver]\n"), sets).interface.get("seam").unwrap().lambda.norm;
        assert!((found / wanted - 1.0).abs() < 1e-8, "{sets:?}: {found} {wanted}");
    }
}

#[test]
fn the_same_problem_in_rust_has_the_same_numbers() {
    let text = stacked(true, [KINDS[0], KINDS[3]], 2, "")
        .replace(", rotate_deg = 40, axis = [1, 2, 0.5]", "")
        .replace("exact = { u = \"0.3*x - 0.2*y + 0.5*z + 1\" }", "")
        .replace(
            "on = \"all-outer\"\ndirichlet = \"exact\"",
            "on = \"lower.bottom\"\nfix = [\"u\"]\n[[boundary]]\non = \"upper.top\"\ndirichlet = \"1.5\"",
        );
    let probe = "[[probe]]\nname = \"u\"\nquantity = \"u at [0.4, 0.3, 0.2] in upper\"\n";
    let case = run(&(text + probe), &[]);
    let mut p = Problem::<2, 3>::new();
    let spec = |min, max, n| PatchSpec::new(faying::geometry::shapes::brick(min, max).unwrap()).with_degree([2; 3]).with_elements(n);
    let lower = Patch::<2, 3>::try_new(&spec([0.0, 0.0, -0.5], [1.0, 0.8, 0.0], [3, 2, 1])).unwrap();
    let upper = spec([0.0, 0.0, 0.0], [1.0, 0.8, 0.6], [2, 3, 1]).with_cells(faying::basis::Cell::Simplex);
    let lower = p.body("lower", lower, Conductor::try_new(2.0).unwrap()).unwrap();
    let upper = p.body("upper", Mesh::<2, 3>::from_patch(&upper).unwrap(), Conductor::try_new(2.0).unwrap()).unwrap();
    p.fix(lower.side("w0"), Components::All).unwrap();
    p.prescribe(upper.side("w1"), 0, 1.5).unwrap();
    let seam = p.tie(upper.side("w0"), lower.side("w1")).unwrap().id();
    let solution = p.assemble().unwrap().solve(1.0, None).unwrap();
    assert_eq!(case.probes[0].value, solution.at(upper, &[0.4, 0.3, 0.2]).unwrap().u[0]);
    let (found, own) = (case.interface.get("seam").unwrap(), solution.tie(seam).unwrap());
    assert_eq!((found.lambda.norm, found.jump.l2, found.segments.count), (own.multiplier, own.jump, own.pieces));
    assert_eq!((found.segments.outside, found.segments.lost), (Some(own.outside), Some(0)));
    // u = 1.5 (z + 0.5)/1.1: a flux of 2 * 1.5/1.1
    assert!((own.force[0].abs() - 0.8 * 3.0 / 1.1).abs() < 1e-9, "{:?}", own.force);
}

#[test]
fn the_sample_passes_its_checks() {
    for backend in [None, Some("fe")] {
        let options = ReadOptions { backend: backend.map(str::to_owned), ..ReadOptions::default() };
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/cases/seam-solid.toml");
        let result = Case::read_with(path, &options).unwrap().run(&Registry::default()).unwrap();
        assert_eq!(result.exit, 0, "{backend:?}: {:?} {:?}", result.diagnostics, result.checks);
    }
}
