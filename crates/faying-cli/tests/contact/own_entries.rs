//! A material and an obstacle from outside have names and keys of their own in case files.

use faying::coupling::interface::{InterfaceQuadrature, SlaveRule};
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::{Conductor, Jet};
use faying::problem::{Components, Physics, Problem, Rule};
use faying::space::{Patch, PatchSpec};
use faying_cli::case::{Given, Key, KeyKind, ReadOptions};
use faying_cli::{Case, Fault, Registry, case};
use std::sync::Arc;

#[path = "../../../../examples/06_own_body_material_obstacle.rs"]
mod lesson;

fn wood(given: &Given, t: f64) -> Result<Physics<2>, Fault> {
    let stiffer = given.function::<2>("stiffer", t)(&faying::linalg::Vector::zeros());
    let at = |key: &str| given.number(key) * stiffer;
    if at("c11") * at("c22") <= at("c12").powi(2) {
        return Err(Fault { key: "c12", ..Fault::new("E053", "c11 c22 must exceed c12 squared") });
    }
    let law = lesson::Orthotropic { c11: at("c11"), c22: at("c22"), c12: at("c12"), g: at("g") };
    Physics::new::<2>(law).map_err(|e| Fault::new("E015", e.to_string()))
}

fn registry() -> Registry {
    let mut registry = Registry::default();
    let key = Key::new;
    let constants = vec![
        key("c11", KeyKind::Positive, "stiffness along x [force/area]"),
        key("c22", KeyKind::Positive, "stiffness along y [force/area]"),
        key("c12", KeyKind::Number, "coupling").unit("force/area").default("0.0"),
        key("g", KeyKind::Positive, "shear modulus [force/area]"),
        key("stiffer", KeyKind::Formula, "factor of all constants, a function of t").default("1.0"),
    ];
    registry.plane.materials.add_keyed("orthotropic", constants, Arc::new(wood));
    let bar = vec![
        key("from", KeyKind::Vector, "begin of the axis [length]"),
        key("to", KeyKind::Vector, "end of the axis [length]"),
        key("radius", KeyKind::Positive, "radius").unit("length").default("0.1"),
        key("solid", KeyKind::Flag, "whether it is no pipe").default("true"),
        key("ends", KeyKind::Word(&["round", "flat"]), "shape of its ends").default("\"round\""),
    ];
    let make = |given: &Given| {
        if given.word("ends") == "flat" || !given.flag("solid") {
            return Err(Fault { key: "ends", ..Fault::new("E019", "only solid bars with round ends are built") });
        }
        let shape = lesson::Bar { a: given.vector("from"), b: given.vector("to"), radius: given.number("radius") };
        Ok(Box::new(move |_: f64| -> Box<dyn faying::contact::Obstacle<1, 2>> { Box::new(shape.clone()) }) as _)
    };
    registry.plane.obstacles.add_keyed("bar", bar, Box::new(make));
    let rule = |points, partners| -> Box<dyn InterfaceQuadrature<1, 2>> { Box::new(SlaveRule { points: points + 3, partners }) };
    registry.plane.integrations.add("slave-finer", Rule::of(rule));
    registry
}

const CASE: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n\
    [[material]]\nname = \"wood\"\nlaw = \"orthotropic\"\nc11 = 12.0\nc22 = 1.0\nc12 = 0.4\ng = \"0.35*2\"\n\
    [[patch]]\nname = \"block\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [16, 8]\n\
    [[boundary]]\non = \"block.top\"\nfix = [\"x\", \"y\"]\n\
    [[contact]]\nname = \"bar\"\nslave = \"block.bottom\"\n\
    rigid = { kind = \"bar\", from = [0.3, -0.1], to = [0.7, -0.1], move = [0, 0.01] }\n";

fn read(text: &str, registry: &Registry) -> Result<Case, String> {
    Case::parse("case.toml", text, &ReadOptions { names: registry.case_names(), ..ReadOptions::default() }).map_err(|e| e.to_string())
}

/// The force of the bar by a program.
fn pressed(wood: lesson::Orthotropic, bar: lesson::Bar) -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let mut p = Problem::<1, 2>::new();
    let block = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_elements([16, 8]);
    let block = p.body("block", Patch::try_new(&block)?, wood)?;
    p.fix(block.side("v1"), Components::All)?;
    let bar = p.contact(block.side("v0"), bar)?.moved(1, 0.01).id();
    let force = p.assemble()?.solve(1.0, None)?.contact(bar)?.force;
    Ok([force[0], force[1]])
}

#[test]
fn they_have_the_numbers_of_a_program() {
    lesson::main().unwrap();
    let registry = registry();
    let case = read(CASE, &registry).unwrap();
    let result = case.run(&registry).unwrap();
    assert_eq!(result.exit, 0, "{:?}", result.diagnostics);
    let wood = lesson::Orthotropic { c11: 12.0, c22: 1.0, c12: 0.4, g: 0.35 * 2.0 };
    let bar = lesson::Bar { a: [0.3, -0.1].into(), b: [0.7, -0.1].into(), radius: 0.1 };
    assert_eq!(result.contact.get("bar").unwrap().force[..2], pressed(wood, bar).unwrap());
    // the effective case has the defaults and is read again
    let effective = case.effective_toml();
    for line in ["c12 = 0.4", "stiffer = 1.0", "radius = 0.1", "solid = true", "ends = \"round\""] {
        assert!(effective.contains(line), "{line} is not in\n{effective}");
    }
    assert_eq!(
        read(effective, &registry).unwrap().run(&registry).unwrap().contact.get("bar").unwrap().force,
        result.contact.get("bar").unwrap().force
    );
}

/// A bar of the law k = k0 (1 + x): -(k u')' = 0, u = ln(1 + x) / ln 2.
#[test]
fn a_conductor_from_outside_is_a_law_of_poissons_equation() {
    let mut registry = Registry::default();
    let keys = vec![Key::new("k0", KeyKind::Positive, "conductivity at x = 0")];
    let make = |given: &Given, _: f64| {
        let k0 = given.number("k0");
        let law = Conductor::varying(move |x: &Vector<2>| Jet { value: k0 * (1.0 + x[0]), gradient: Vector::<2>::new(k0, 0.0) });
        Physics::new::<1>(law).map_err(|e| Fault::new("E015", e.to_string()))
    };
    registry.plane.materials.add_keyed("graded", keys, Arc::new(make));
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[material]]\nname = \"m\"\nlaw = \"graded\"\nk0 = 3.0\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [16, 2]\n\
        [[boundary]]\non = \"a.left\"\ndirichlet = 0.0\n[[boundary]]\non = \"a.right\"\ndirichlet = 1.0\n\
        [[probe]]\nname = \"u\"\nquantity = \"u at [0.5, 0.5]\"\n";
    let result = read(text, &registry).unwrap().run(&registry).unwrap();
    let found = result.probes.iter().find(|p| p.name == "u").unwrap().value;
    assert!((found - 1.5_f64.log2()).abs() < 1e-5, "{found}");
    // what has no effect beside it, and no law of this physics
    for (old, new, part) in
        [("k0 = 3.0", "k0 = 3.0\nconductivity = 2.0", "E015"), ("law = \"graded\"\nk0 = 3.0", "law = \"hooke\"", "E015")]
    {
        let error = read(&text.replace(old, new), &registry).unwrap_err();
        assert!(error.contains(part), "{new}: {error}");
    }
}

#[test]
fn a_law_from_outside_changes_with_the_time() {
    let registry = registry();
    let steps = "[steps]\nt = [1.0, 2.0]\n";
    let text = format!("{}{steps}", CASE.replace("c22 = 1.0\n", "c22 = 1.0\nstiffer = \"t\"\n"));
    let (once, twice) = (read(CASE, &registry).unwrap().run(&registry).unwrap(), read(&text, &registry).unwrap().run(&registry).unwrap());
    let (a, b) = (once.contact.get("bar").unwrap(), twice.contact.get("bar").unwrap());
    assert!((b.force[1] - 2.0 * a.force[1]).abs() < 1e-11, "{} and {}", a.force[1], b.force[1]);
    // it is made for every time before anything is solved
    let text = text.replace("\"t\"", "\"if(t > 1.5, 0, 1)\"");
    let result = read(&text, &registry).unwrap().run(&registry).unwrap_err().to_string();
    assert!(result.contains("E053") && result.contains("c11 c22 must exceed c12 squared"), "{result}");
}

#[test]
fn their_keys_are_read_as_strictly_as_those_of_the_language() {
    let registry = registry();
    for (old, new, parts) in [
        ("c22 = 1.0\n", "", &["E013", "`c22` is missing"][..]),
        ("c22 = 1.0", "c22 = -1.0", &["E015", "`c22` must be positive"]),
        ("c22 = 1.0", "c22 = \"x\"", &["E017"]),
        ("c12 =", "c21 =", &["E012", "unknown key `c21`"]),
        ("c12 = 0.4", "young = 0.4", &["E015", "`young` is a key of law \"hooke\" of elasticity"]),
        ("law = \"orthotropic\"", "young = 1.0\npoisson = 0.3", &["E015", "`c11` is not a key of law = \"hooke\""]),
        ("\"orthotropic\"", "\"orthotropc\"", &["E015", "did you mean \"orthotropic\"?"]),
        ("from = [0.3, -0.1]", "from = [0.3, -0.1, 1]", &["E044"]),
        ("from = [0.3, -0.1], ", "", &["E013", "`from` is missing"]),
        ("\"bar\", from", "\"barr\", from", &["E015", "did you mean \"bar\"?"]),
        ("move =", "ends = \"sharp\", move =", &["E015", "\"round\", \"flat\""]),
        ("move =", "axis = [0, 1], move =", &["E015", "`axis` is not a key of kind \"bar\""]),
    ] {
        let error = read(&CASE.replace(old, new), &registry).unwrap_err();
        assert!(parts.iter().all(|p| error.contains(p)), "{new}: {error}");
    }
    // faults of the entries have their place
    for (old, new, parts) in [
        ("move =", "ends = \"flat\", move =", ["E019", "the obstacle of contact \"bar\": only solid bars"]),
        ("c12 = 0.4", "c12 = 4", ["E053", "material \"wood\": c11 c22 must exceed"]),
    ] {
        let case = CASE.replace(old, new);
        let error = read(&case, &registry).unwrap().run(&registry).unwrap_err().to_string();
        assert!(parts.iter().all(|p| error.contains(p)), "{new}: {error}");
        // the place of the key's value
        let line = case.lines().position(|l| l.contains(new)).unwrap();
        let column = case.lines().nth(line).unwrap().find(new).unwrap() + new.find("= ").unwrap() + 3;
        assert!(error.contains(&format!("case.toml:{}:{column}", line + 1)), "{line}: {error}");
    }
    // unknown to the program as it comes
    assert!(read(CASE, &Registry::default()).unwrap_err().contains("E015"));
    let schema = case::schema(&registry.case_names()).to_string();
    assert!(schema.contains("coupling [force/area]") && schema.contains("whether it is no pipe") && schema.contains("orthotropic"));
}

/// The block below another one, with a KIND of seam that has the keys RULE.
fn two_blocks() -> String {
    let base = "[[patch]]\nname = \"base\"\nmaterial = \"steel\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [7, 4]\n\
        [[material]]\nname = \"steel\"\nyoung = 100.0\npoisson = 0.3\n\
        [[boundary]]\non = \"block.left\"\nfix = [\"x\"]\n\
        [[KIND]]\nname = \"seam\"\nslave = \"block.top\"\nmaster = \"base.bottom\"\nRULE\n";
    CASE.replace("block.top", "base.top").replace("elements = [16, 8]", "elements = [16, 8]\nmaterial = \"wood\"") + base
}

#[test]
fn an_integration_from_outside_has_the_numbers_of_its_twin() {
    let registry = registry();
    let text = two_blocks();
    for kind in ["interface", "contact"] {
        let run = |rule: &str| read(&text.replace("KIND", kind).replace("RULE", rule), &registry).unwrap().run(&registry).unwrap();
        let (own, twin) = (run("integration = \"slave-finer\""), run("integration = \"slave\"\nextra_points = 3"));
        assert_eq!((own.exit, own.energy), (0, twin.energy), "{kind}: {:?}", own.diagnostics);
        assert_eq!(own.contact.get("bar").unwrap().force, twin.contact.get("bar").unwrap().force);
        assert_ne!(own.energy, run("integration = \"slave\"").energy);
    }
    let text = text.replace("KIND", "interface");
    let error = read(&text.replace("RULE", "integration = \"slave-fine\""), &registry).unwrap_err();
    assert!(error.contains("E015") && error.contains("did you mean \"slave-finer\"?"), "{error}");
}

/// The lesson about methods of contact.
#[allow(dead_code)]
#[path = "../../../../examples/05_own_contact_method.rs"]
mod method_lesson;

/// A penalty with a stiffness per area of its own, and a coupling of springs.
fn with_methods() -> Registry {
    let mut registry = registry();
    registry.plane.methods.add_keyed("interior-point", Vec::new(), Box::new(|_| Ok(Arc::new(method_lesson::InteriorPoint))));
    add_penalties(&mut registry, "pads", "springs");
    registry
}

/// Adds a method of contact and a coupling with keys of their own.
fn add_penalties(registry: &mut Registry, method: &str, coupling: &str) {
    let keys = vec![
        Key::new("softness", KeyKind::Positive, "1 / factor, a pure number"),
        Key::new("factor", KeyKind::Auto, "multiplies modulus/h").default("\"auto\""),
    ];
    let make = |given: &Given| {
        let softness = given.number("softness");
        if softness > 1.0 {
            return Err(Fault { key: "softness", ..Fault::new("E015", "softer than the bodies") });
        }
        Ok(Arc::new(faying::coupling::Penalty { factor: given.auto("factor").unwrap_or(1.0) / softness }) as _)
    };
    registry.plane.methods.add_keyed(method, keys, Box::new(make));
    let keys = vec![Key::new("per_area", KeyKind::Positive, "factor of the springs").default("4.0")];
    let make = |given: &Given| Ok(Box::new(faying::coupling::Penalty { factor: given.number("per_area") }) as _);
    registry.plane.couplings.add_keyed(coupling, keys, Box::new(make));
}

#[test]
fn a_method_of_contact_from_outside_is_used_by_name() {
    let registry = with_methods();
    let run = |method: &str| read(&format!("{CASE}{method}\n"), &registry).unwrap().run(&registry).unwrap();
    let (own, exact) = (run("method = \"interior-point\""), run(""));
    assert_eq!(own.exit, 0, "{:?}", own.diagnostics);
    let (a, b) = (own.contact.get("bar").unwrap(), exact.contact.get("bar").unwrap());
    assert!((a.force[1] - b.force[1]).abs() < 1e-9 * b.force[1].abs() && a.active == b.active, "{a:?} {b:?}");
    assert!(own.solve.as_ref().unwrap().linear.starts_with("interior point"), "{:?}", own.solve);
    // keys of its own, with the numbers of the twin in the language
    let (own, twin) = (run("method = \"pads\"\nsoftness = 1e-3"), run("method = \"penalty\"\nfactor = 1e3"));
    assert_eq!(own.contact.get("bar").unwrap().force, twin.contact.get("bar").unwrap().force);
    assert_ne!(own.contact.get("bar").unwrap().force, b.force);
    let effective = read(&format!("{CASE}method = \"pads\"\nsoftness = 1e-3\n"), &registry).unwrap().effective_toml().to_owned();
    for line in ["method = \"pads\"", "softness = 0.001", "factor = \"auto\""] {
        assert!(effective.contains(line), "{line} is not in\n{effective}");
    }
    read(&effective, &registry).unwrap();
}

#[test]
fn keys_of_methods_and_couplings_are_read_as_strictly_as_those_of_the_language() {
    let registry = with_methods();
    for (method, parts) in [
        ("method = \"interior-pont\"", &["E015", "did you mean \"interior-point\"?"][..]),
        ("method = \"pads\"", &["E013", "`softness` is missing"]),
        ("method = \"pads\"\nsoftness = -1", &["E015", "`softness` must be positive"]),
        ("softness = 0.5", &["E015", "`softness` is not a key of method = \"lagrange\"", "method = \"pads\""]),
        (
            "method = \"pads\"\nsoftness = 0.5\nvariant = \"incomplete\"",
            &["E015", "`variant` is not a key of method = \"pads\"", "\"nitsche\""],
        ),
        ("factor = 2", &["E015", "`factor` is not a key of method = \"lagrange\"", "\"penalty\", \"augmented\", \"nitsche\" or \"pads\""]),
        ("per_area = 2", &["E012", "`per_area`"]),
    ] {
        let error = read(&format!("{CASE}{method}\n"), &registry).unwrap_err();
        assert!(parts.iter().all(|p| error.contains(p)), "{method}: {error}");
    }
    // defaults of other entries say nothing, and stay
    read(&format!("{CASE}factor = \"auto\"\nvariant = \"symmetric\"\n"), &registry).unwrap();
    // faults of the entry have their place
    let error = read(&format!("{CASE}method = \"pads\"\nsoftness = 2\n"), &registry).unwrap().run(&registry).unwrap_err().to_string();
    assert!(error.contains("E015") && error.contains("softer than the bodies") && error.contains("softness = 2"), "{error}");
    let schema = case::schema(&registry.case_names());
    let contact = &schema["properties"]["contact"]["items"]["properties"];
    assert_eq!(contact["softness"]["description"], "method = \"pads\": 1 / factor, a pure number");
    assert!(contact["method"]["enum"].as_array().unwrap().contains(&"interior-point".into()));
    assert_eq!(schema["properties"]["interface"]["items"]["properties"]["per_area"]["default"], 4.0);
}

#[test]
fn an_entry_takes_the_place_of_one_of_the_language_with_its_keys() {
    let (plain, mut registry) = (registry(), registry());
    add_penalties(&mut registry, "penalty", "penalty");
    registry.plane.multipliers.add("constant", MultiplierKind::Lowered(1).into());
    let energy = |registry: &Registry, kind: &str, rule: &str| {
        let text = two_blocks().replace("KIND", kind).replace("RULE", rule);
        let result = read(&text, registry).unwrap().run(registry).unwrap();
        assert_eq!(result.exit, 0, "{kind}, {rule}: {:?}", result.diagnostics);
        result.energy
    };
    for (kind, own, twin) in [
        ("contact", "method = \"penalty\"\nsoftness = 1e-3", "method = \"penalty\"\nfactor = 1e3"),
        ("interface", "coupling = \"penalty\"\nper_area = 7", "coupling = \"penalty\"\nfactor = 7"),
        ("interface", "coupling = \"penalty\"", "coupling = \"penalty\"\nfactor = 4"),
        ("interface", "multiplier = \"constant\"", "multiplier = \"p/p-1\""),
        ("contact", "multiplier = \"constant\"", "multiplier = \"p/p-1\""),
    ] {
        assert_eq!(energy(&registry, kind, own), energy(&plain, kind, twin), "{kind}, {own}");
    }
    assert_ne!(energy(&plain, "interface", "multiplier = \"constant\""), energy(&registry, "interface", "multiplier = \"constant\""));
    // keys of the entry that was there before are none, its defaults are not asked for
    for (kind, rule, parts) in [
        ("contact", "method = \"penalty\"", ["E013", "`softness` is missing"]),
        (
            "contact",
            "method = \"penalty\"\nsoftness = 1\nvariant = \"incomplete\"",
            ["E015", "`variant` is not a key of method = \"penalty\""],
        ),
        ("interface", "coupling = \"penalty\"\nfactor = 7", ["E015", "`factor` is not a key of coupling = \"penalty\""]),
    ] {
        let error = read(&two_blocks().replace("KIND", kind).replace("RULE", rule), &registry).unwrap_err();
        assert!(parts.iter().all(|p| error.contains(p)), "{rule}: {error}");
    }
}

#[test]
fn an_obstacle_takes_the_place_of_one_of_the_language_with_its_keys() {
    let mut registry = registry();
    let keys = vec![Key::new("depth", KeyKind::Number, "depth of the floor").unit("length")];
    let make = |given: &Given| {
        let y = given.number("depth");
        let floor =
            faying::contact::HalfPlane::try_new([0.0, y].into(), [0.0, 1.0].into()).ok_or_else(|| Fault::new("E015", "no normal"))?;
        Ok(Box::new(move |_: f64| -> Box<dyn faying::contact::Obstacle<1, 2>> { Box::new(floor) }) as _)
    };
    registry.plane.obstacles.add_keyed("sphere", keys, Box::new(make));
    let with =
        |rigid: &str| read(&CASE.replace("kind = \"bar\", from = [0.3, -0.1], to = [0.7, -0.1], move = [0, 0.01]", rigid), &registry);
    let force = |rigid: &str| with(rigid).unwrap().run(&registry).unwrap().contact.get("bar").unwrap().force.clone();
    let own = force("kind = \"sphere\", depth = 0.0, move = [0, 0.01]");
    assert_eq!(own, force("kind = \"half-plane\", point = [0, 0], normal = [0, 1], move = [0, 0.01]"));
    let error = with("kind = \"sphere\", center = [0, 0], radius = 1").unwrap_err();
    assert!(error.contains("E013") && error.contains("`depth` is missing"), "{error}");
}
