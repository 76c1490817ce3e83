//! Pictures of the samples: their size, what stands on their axes, headings that fit.

use std::path::Path;
use std::process::{Command, Stdio};

fn faying(at: &Path, words: &[&str]) {
    let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap();
    assert!(out.status.success(), "{words:?}: {}", String::from_utf8_lossy(&out.stderr));
}

/// Words of a picture.
fn words(svg: &str) -> Vec<&str> {
    svg.split("<text").filter_map(|t| Some(t.split_once('>')?.1.split('<').next()?.trim())).collect()
}

/// Numbers that stand on a vertical line at the right of the drawing: marks of the colour bar.
fn marks(svg: &str) -> Vec<&str> {
    words(svg).into_iter().filter(|word| word.parse::<f64>().is_ok()).collect()
}

#[test]
fn units_stand_on_axes_and_bars_and_change_no_number() {
    let at = tempfile::tempdir().unwrap();
    faying(at.path(), &["new", "contact-patch"]);
    faying(at.path(), &["run", "contact-patch.toml", "--out", "plain"]);
    faying(at.path(), &["run", "contact-patch.toml", "--out", "named", "--set", "units={ length = \"mm\", force = \"N\" }"]);
    let read = |folder: &str, file: &str| std::fs::read_to_string(at.path().join(folder).join(file)).unwrap();
    let (fields, side) = (read("named", "fields.svg"), read("named", "interface_pad.svg"));
    let shown = words(&fields);
    assert!(shown.contains(&"x [mm]") && shown.contains(&"y [mm]"), "{shown:?}");
    assert!(shown.iter().any(|word| word.starts_with("von Mises stress [N/mm²]: ")), "{shown:?}");
    assert!(words(&side).contains(&"pressure [N/mm²]") && words(&side).contains(&"arc length along the slave side [mm]"), "{side}");
    assert!(read("named", "report.html").contains("Units: lengths in mm, forces in N."));
    assert!(!read("plain", "fields.svg").contains("[mm]") && !read("plain", "report.html").contains("Units:"));
    // the numbers are those without units; the effective case says them and runs
    let numbers = |folder: &str| serde_json::from_str::<serde_json::Value>(&read(folder, "result.json")).unwrap()["contact"].clone();
    assert_eq!(numbers("plain"), numbers("named"));
    assert!(read("named", "case.effective.toml").contains("force = \"N\""));
    faying(at.path(), &["run", "named/case.effective.toml", "--out", "again"]);
    assert_eq!(words(&read("again", "fields.svg")), shown);
    // a name that is no unit is refused
    let out = Command::new(env!("CARGO_BIN_EXE_faying"))
        .current_dir(at.path())
        .args(["check", "contact-patch.toml", "--set", "units.length=a very long name"])
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&out.stderr).contains("`length` must be a unit of 1 to 12 letters"));
}

#[test]
fn the_picture_of_a_fine_mesh_is_small() {
    let at = tempfile::tempdir().unwrap();
    faying(at.path(), &["new", "hertz"]);
    faying(at.path(), &["run", "hertz.toml"]);
    let svg = std::fs::read_to_string(at.path().join("hertz.out/fields.svg")).unwrap();
    assert!(svg.len() < 300_000, "{} bytes", svg.len());
    // three numbers or more on each of two axes, of body and detail, and on the bar; neighbours differ
    assert!(marks(&svg).len() >= 15, "{:?}", marks(&svg));
    assert!(marks(&svg).windows(2).all(|pair| pair[0] != pair[1]), "{:?}", marks(&svg));
}

#[test]
fn long_headings_are_wrapped_and_kept() {
    let at = tempfile::tempdir().unwrap();
    faying(at.path(), &["new", "contact-patch"]);
    let title = "A title of many words that says what is pressed on what and by how much and in which order and why it is of any interest";
    faying(at.path(), &["run", "contact-patch.toml", "--set", &format!("title=\"{title}\"")]);
    for name in ["fields.svg", "interface_pad.svg", "active_set.svg"] {
        let svg = std::fs::read_to_string(at.path().join("contact-patch.out").join(name)).unwrap();
        assert!(!svg.contains('…') && words(&svg).join(" ").contains(title), "{name}: {:?}", words(&svg));
    }
}

/// A square of modulus 1000 that the traction 0.1 stretches along x: u.x = 1e-4 x.
const STRETCHED: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\n[[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0\n\
    [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
    [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.right\"\ntraction = { x = 0.1 }\n";

#[test]
fn bodies_are_drawn_deformed_with_their_supports_and_loads() {
    let at = tempfile::tempdir().unwrap();
    std::fs::write(at.path().join("a.toml"), STRETCHED).unwrap();
    let picture = |deformed: &str| {
        faying(at.path(), &["run", "a.toml", "--set", &format!("output.deformed={deformed}")]);
        std::fs::read_to_string(at.path().join("a.out/fields.svg")).unwrap()
    };
    let line = |svg: &str| words(svg).into_iter().find(|word| word.starts_with("von Mises")).unwrap().to_owned();
    // auto: the largest displacement 1e-4 times 500 is below a twentieth of the diagonal, times 1000 above
    let auto = picture("auto");
    assert!(line(&auto).ends_with("; displacements 500 times; triangles: supports, arrows: loads"), "{}", line(&auto));
    // at rest the frame is square: 1.12 of the size on 560 pixels
    let rest = picture("false");
    assert!(rest.starts_with("<svg width=\"754\" height=\"686\""), "{}", &rest[..60]);
    assert!(line(&rest).ends_with("everywhere; triangles: supports, arrows: loads"), "{}", line(&rest));
    // times 10,000 the square is 2 x 1: (2 + 0.24) x (1 + 0.24) on 720 pixels of width
    let long = picture("1e4");
    assert!(long.starts_with("<svg width=\"914\" height=\"525\""), "{}", &long[..60]);
    assert!(line(&long).contains("displacements 1e4 times") || line(&long).contains("displacements 10000 times"), "{}", line(&long));
    // an arrow is two lines, seven on the loaded side
    let red = |svg: &str| svg.split("<path").filter(|p| p.contains("stroke=\"#C94C33\"")).map(|p| p.matches('M').count()).sum::<usize>();
    assert_eq!(red(&long), 2 * 7);
}

/// Points of the paths of a picture whose lines are so many units wide, an eighth of a pixel each: relative coordinates summed up.
fn paths(svg: &str, width: &str) -> Vec<Vec<[i64; 2]>> {
    let of_width = svg.split("<path").filter(|p| p.contains(&format!("stroke-width=\"{width}\"")));
    let data = of_width.filter_map(|p| p.split_once(" d=\"")?.1.split('"').next());
    let numbers = |text: &str| -> Vec<i64> {
        text.replace('-', " -").replace('l', " ").split_whitespace().map(|word| word.trim_end_matches('z').parse().unwrap()).collect()
    };
    let points = |path: &str| {
        let mut at = [0, 0];
        numbers(path)
            .chunks(2)
            .map(|step| {
                at = [at[0] + step[0], at[1] + step[1]];
                at
            })
            .collect()
    };
    data.flat_map(|d| d.split('M').skip(1)).map(points).collect()
}

#[test]
fn obstacles_are_drawn_where_they_have_moved_to() {
    let at = tempfile::tempdir().unwrap();
    let floor = "[[contact]]\nname = \"floor\"\nslave = \"a.bottom\"\n\
        rigid = { kind = \"half-plane\", point = [0, -0.5], normal = [0, 1], move = { y = \"0.25*t\" } }\n";
    let held = STRETCHED.split("[[boundary]]").next().unwrap().to_owned() + "[[boundary]]\non = \"a.top\"\nfix = [\"x\", \"y\"]\n";
    std::fs::write(at.path().join("a.toml"), held + floor).unwrap();
    faying(at.path(), &["run", "a.toml"]);
    let svg = std::fs::read_to_string(at.path().join("a.out/fields.svg")).unwrap();
    // the window holds the square and the floor at y = -1/4, with 0.06 of the height 1.25 around: 400 pixels per length, 460 x 560 of them,
    // at (62, 80); the floor is 30 pixels above its lower end
    assert_eq!(paths(&svg, "13"), [vec![[62 * 8, 610 * 8], [522 * 8, 610 * 8]]]);
    // strokes of 8 pixels below it, 9 pixels apart, the first one after half of that
    let strokes = paths(&svg, "7");
    let strokes: Vec<_> = strokes.iter().filter(|line| line.len() == 2 && line[0][1] == 610 * 8).collect();
    assert_eq!(strokes.len(), 51);
    for (k, line) in strokes.iter().enumerate() {
        let step = [line[1][0] - line[0][0], line[1][1] - line[0][1]];
        assert_eq!((line[0][0], step), (62 * 8 + 36 + 72 * k as i64, [-45, 45]));
    }
    assert!(words(&svg).contains(&"floor") && words(&svg).iter().any(|word| word.ends_with("; hatched: rigid")), "{:?}", words(&svg));
    // bodies that are drawn further than they move do not touch it where they do
    std::fs::write(at.path().join("a.toml"), STRETCHED.to_owned() + floor).unwrap();
    for (factor, words_of_floor) in
        [("20", "; displacements 20 times; triangles: supports, arrows: loads; hatched: rigid, not scaled"), ("1", "; hatched: rigid")]
    {
        faying(at.path(), &["run", "a.toml", "--force", "--set", &format!("output.deformed={factor}")]);
        let svg = std::fs::read_to_string(at.path().join("a.out/fields.svg")).unwrap();
        assert!(words(&svg).iter().any(|word| word.ends_with(words_of_floor)), "{:?}", words(&svg));
    }
}

/// Polylines of a colour, each point in pixels.
fn lines(svg: &str, color: &str) -> Vec<Vec<[f64; 2]>> {
    let point = |text: &str| {
        let (x, y) = text.split_once(',').unwrap();
        [x, y].map(|v| v.parse::<f64>().unwrap() / 8.0)
    };
    let of_color = svg.lines().filter(|line| line.starts_with("<polyline") && line.contains(color));
    of_color
        .map(|line| line.split_once("points=\"").unwrap().1.split('"').next().unwrap().split_whitespace().map(point).collect())
        .collect()
}

const BLUE: &str = "#1F67AD";
const RED: &str = "#C94C33";
const INK: &str = "#262B33";

#[test]
fn all_slaves_of_a_contact_are_in_one_picture() {
    let at = tempfile::tempdir().unwrap();
    let mut case = STRETCHED.split("[[patch]]").next().unwrap().to_owned();
    for (name, x, pressed) in [("a", 0, 0.1), ("b", 2, 0.2)] {
        case += &format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x}, 0], max = [{}, 1] }}\nelements = [2, 2]\n\
             [[boundary]]\non = \"{name}.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"{name}.top\"\npressure = {pressed}\n",
            x + 1
        );
    }
    case += "[[contact]]\nname = \"floor\"\nslave = [\"a.bottom\", \"b.bottom\"]\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n";
    std::fs::write(at.path().join("a.toml"), case).unwrap();
    faying(at.path(), &["run", "a.toml"]);
    let file = |name: &str| at.path().join("a.out").join(name);
    assert!(file("interface_floor.0.csv").is_file() && file("interface_floor.1.csv").is_file() && !file("interface_floor.0.svg").exists());
    let svg = std::fs::read_to_string(file("interface_floor.svg")).unwrap();
    // 0 to 0.2 and 0.08 of that at both ends on 330 pixels from 84, two sides of length 1 on 700 pixels from 78
    let height = |pressure: f64| 84.0 + 330.0 * (0.216 - pressure) / 0.232;
    let drawn: Vec<[f64; 2]> = lines(&svg, BLUE).into_iter().flatten().filter(|p| p[1] > 84.0).collect();
    assert!(drawn.len() > 60, "{drawn:?}");
    for [x, y] in &drawn {
        let wanted: Vec<f64> =
            [(78.0..=428.0, 0.1), (428.0..=778.0, 0.2)].into_iter().filter(|(on, _)| on.contains(x)).map(|(_, p)| height(p)).collect();
        assert!(wanted.iter().any(|h| (y - h).abs() < 0.2), "{x} {y} {wanted:?}");
    }
    assert!(["a.bottom", "b.bottom"].iter().all(|name| words(&svg).contains(name)), "{:?}", words(&svg));
    assert!(words(&svg).contains(&"arc length along the slave sides"));
    assert!(std::fs::read_to_string(file("report.html")).unwrap().contains("Contacts: floor, along its slave side"));
}

#[test]
fn ties_show_normal_and_tangential_part_beside_the_exact_ones() {
    let at = tempfile::tempdir().unwrap();
    // E = 1, nu = 0: the stress is the strain, xx 0.1, xy (0.2 + 0.05) / 2
    let case = "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = { u = [\"0.1*x + 0.2*y\", \"0.05*x + 0.3*y\"] }\n\
        [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [3, 3]\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 1] }\nelements = [2, 2]\n\
        [[boundary]]\non = [\"a.left\", \"b.right\"]\ndirichlet = \"exact\"\n\
        [[boundary]]\non = [\"a.top\", \"b.top\", \"a.bottom\", \"b.bottom\"]\ntraction = \"exact\"\n\
        [[interface]]\nname = \"seam\"\nslave = \"a.right\"\nmaster = \"b.left\"\n";
    std::fs::write(at.path().join("a.toml"), case).unwrap();
    faying(at.path(), &["run", "a.toml"]);
    let svg = std::fs::read_to_string(at.path().join("a.out/interface_seam.svg")).unwrap();
    // 0 to 0.125 and 0.08 of that at both ends on 330 pixels
    let height = |part: f64| 84.0 + 330.0 * (0.135 - part) / 0.145;
    let on_curve = |color: &str| -> Vec<f64> { lines(&svg, color).into_iter().flatten().map(|p| p[1]).filter(|y| *y > 84.0).collect() };
    for (color, part) in [(BLUE, 0.1), (RED, 0.125)] {
        let curve = on_curve(color);
        assert!(curve.len() > 40 && curve.iter().all(|y| (y - height(part)).abs() < 0.2), "{color}: {curve:?}");
    }
    let exact = on_curve(INK);
    for part in [0.1, 0.125] {
        assert!(exact.iter().filter(|y| (*y - height(part)).abs() < 0.2).count() > 40, "{part}: {exact:?}");
    }
    let shown = words(&svg);
    assert!(["lambda: normal part (tension positive)", "tangential part", "exact"].iter().all(|word| shown.contains(word)), "{shown:?}");
}

#[test]
fn surfaces_show_pressure_and_gap_around_a_small_zone() {
    let at = tempfile::tempdir().unwrap();
    let case = |rigid: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\nbackend = \"fe\"\ndegree = 1\n\
             [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0, 0], max = [1, 1, 0.2] }}\nelements = [24, 24, 1]\n\
             [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\", \"z\"]\n[[contact]]\nname = \"c\"\nslave = \"a.top\"\nrigid = {{ {rigid} }}\n"
        )
    };
    let picture = |rigid: &str| {
        std::fs::write(at.path().join("a.toml"), case(rigid)).unwrap();
        faying(at.path(), &["run", "a.toml"]);
        let read = |name: &str| std::fs::read_to_string(at.path().join("a.out").join(name)).unwrap();
        assert!(words(&read("fields.svg")).contains(&"c (rigid)"), "the obstacle has its name");
        read("interface_c.svg")
    };
    let apart = picture("kind = \"half-plane\", point = [0, 0, 0.45], normal = [0, 0, -1]");
    let shown = words(&apart);
    assert!(shown.contains(&"pressure: 0 everywhere") && shown.contains(&"gap: 0.25 everywhere"), "{shown:?}");
    assert!(shown.iter().filter(|word| **word == "largest extent in view: 1").count() == 2, "{shown:?}");
    // a ball of radius 1 that is 0.004 deep: the circle in which it cuts the plane has the radius 0.09
    let ball = picture("kind = \"sphere\", center = [0.5, 0.5, 1.196], radius = 1");
    let shown = words(&ball);
    let extent = shown.iter().find_map(|word| word.strip_prefix("largest extent in view: ")).unwrap().parse::<f64>().unwrap();
    assert!(extent < 0.6, "{shown:?}");
    let gap = shown.iter().find(|word| word.starts_with("gap, near the contact zone: from ")).unwrap();
    let most: f64 = gap.rsplit(' ').next().unwrap().parse().unwrap();
    // at the corner of a square of that size around the middle, at most its half diagonal away: r^2 / 2
    assert!(most > 0.0 && most < 0.25 * extent * extent, "{gap} {extent}");
}

#[test]
fn the_active_set_of_every_step_is_drawn() {
    let at = tempfile::tempdir().unwrap();
    let floor = "[[contact]]\nname = \"floor\"\nslave = \"a.bottom\"\n\
        rigid = { kind = \"half-plane\", point = [0, -0.5], normal = [0, 1], move = { y = \"0.51*t\" } }\n[steps]\nt = [0.5, 0.99, 1]\n";
    let held = STRETCHED.split("[[boundary]]").next().unwrap().to_owned() + "[[boundary]]\non = \"a.top\"\nfix = [\"x\", \"y\"]\n";
    std::fs::write(at.path().join("a.toml"), held + floor).unwrap();
    faying(at.path(), &["run", "a.toml"]);
    let read = |name: &str| std::fs::read_to_string(at.path().join("a.out").join(name)).unwrap();
    let svg = read("active_set.svg");
    let result: serde_json::Value = serde_json::from_str(&read("result.json")).unwrap();
    let steps = result["steps"].as_array().unwrap();
    let systems: usize = steps.iter().map(|step| step["active_set"]["history"].as_array().unwrap().len()).sum();
    assert!(steps.len() == 3 && systems >= 3, "{steps:?}");
    let rings = svg.matches("fill=\"none\"").count() - svg.matches("<polyline").count();
    assert_eq!(svg.matches("<circle").count() - rings, 2 * systems);
    assert!(["t = 0.5", "iteration, all steps"].iter().all(|word| words(&svg).contains(word)), "{:?}", words(&svg));
}

#[test]
fn fields_that_are_asked_for_are_shown_one_below_the_other() {
    let at = tempfile::tempdir().unwrap();
    let floor =
        "[[contact]]\nname = \"floor\"\nslave = \"a.bottom\"\nrigid = { kind = \"half-plane\", point = [0, -0.5], normal = [0, 1] }\n";
    let case = |fields: &str| format!("{STRETCHED}{floor}[output]\nfields = {fields}\n");
    let run = |fields: &str| {
        std::fs::write(at.path().join("a.toml"), case(fields)).unwrap();
        faying(at.path(), &["run", "a.toml"]);
        std::fs::read_to_string(at.path().join("a.out/fields.svg")).unwrap()
    };
    // u.x = 1e-4 x, nothing else
    let svg = run("[\"stress.xx\", \"displacement\", \"u.y\", \"contact.floor.pressure\"]");
    let order = ["stress.xx: 0.1 everywhere", "length of the displacement: from 0 to 0.0001", "u.y: ", "pressure"];
    let places: Vec<usize> = order.iter().map(|word| words(&svg).iter().position(|w| w.starts_with(word)).unwrap_or(usize::MAX)).collect();
    assert!(places.is_sorted() && places[3] < usize::MAX, "{places:?} {:?}", words(&svg));
    // four documents in one, as high as all together
    let size = |text: &str, word: &str| text.split_once(word).unwrap().1.split('"').next().unwrap().parse::<f64>().unwrap();
    let inner: Vec<&str> = svg.split("<svg ").skip(2).collect();
    let heights: Vec<f64> = inner.iter().map(|svg| size(svg, " height=\"")).collect();
    let tops: Vec<f64> = inner.iter().map(|svg| size(svg, "y=\"")).collect();
    assert_eq!(tops, [0.0, heights[0], heights[0] + heights[1], heights[0] + heights[1] + heights[2]]);
    assert_eq!(size(&svg, " height=\""), heights.iter().sum::<f64>());
    assert!(std::fs::read_to_string(at.path().join("a.out/report.html")).unwrap().contains("stress.xx: 0.1 everywhere"));
    // one alone is a picture as without the key, and a text stands for a list of one
    assert_eq!(run("[\"von_mises\"]"), run("\"von_mises\""));
    assert_eq!(run("\"von_mises\"").matches("<svg").count(), 1);
    // what there is not is told with its place and what there is
    std::fs::write(at.path().join("a.toml"), case("[\"von_mises\", \"stress.xz\"]")).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at.path()).args(["check", "a.toml"]).output().unwrap();
    let told = String::from_utf8_lossy(&out.stderr);
    let line = case("").lines().count();
    assert_eq!(out.status.code(), Some(3));
    assert!(told.contains("error[E018]: there is no field `stress.xz` to show") && told.contains(&format!("a.toml:{line}:24")), "{told}");
    let list = "fields here: von_mises, displacement, u.x, u.y, stress.xx, stress.yy, stress.zz, stress.xy, contact.floor.pressure";
    assert!(told.contains(list), "{told}");
}

/// A ring of radii 1 and 2 under the pressure 1 from inside: Lame's stresses A - B/r^2 and A + B/r^2 with A = 1/3, B = 4/3.
#[test]
fn fields_about_a_centre_and_principal_stresses_are_shown() {
    let ring = "units = { length = \"mm\", force = \"N\" }\n[let]\nc = 3\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = 3\n[[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0.3\n\
        [[patch]]\nname = \"ring\"\ngeometry = { kind = \"annulus-sector\", center = [3, 0], radius = [1, 2], angle_deg = [0, 90] }\nelements = [4, 4]\n\
        [[boundary]]\non = \"ring.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"ring.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"ring.v0\"\npressure = 1\n[output]\n";
    let at = tempfile::tempdir().unwrap();
    let write = |fields: &str| std::fs::write(at.path().join("ring.toml"), format!("{ring}fields = {fields}\n")).unwrap();
    write("[\"stress.tt about [c, 0]\", \"stress.rr about [3, 0]\", \"principal.1\", \"u.r about [3, 0]\"]");
    faying(at.path(), &["run", "ring.toml"]);
    let svg = std::fs::read_to_string(at.path().join("ring.out/fields.svg")).unwrap();
    let shown = words(&svg);
    // "stress.tt about [c, 0] [N/mm2]: from 0.6667 to 1.667; ..."
    let range = |label: &str| -> [f64; 2] {
        let word = shown.iter().find(|word| word.starts_with(&format!("{label}: from "))).unwrap_or_else(|| panic!("{label}: {shown:?}"));
        let numbers = word.split("from ").nth(1).unwrap().split(';').next().unwrap();
        let (least, most) = numbers.split_once(" to ").unwrap();
        [least, most].map(|n| n.parse().unwrap())
    };
    let near = |found: [f64; 2], exact: [f64; 2]| found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 0.01);
    let hoop = [2.0 / 3.0, 5.0 / 3.0];
    assert!(near(range("stress.tt about [c, 0] [N/mm²]"), hoop), "{shown:?}");
    assert!(near(range("principal.1 [N/mm²]"), hoop), "{shown:?}");
    assert!(near(range("stress.rr about [3, 0] [N/mm²]"), [-1.0, 0.0]), "{shown:?}");
    // u_r = (1 + nu)/E ((1 - 2 nu) A r + B/r) from 1.907e-3 at r = 1 to 1.213e-3 at r = 2
    let u = |r: f64| 1.3e-3 * (0.4 / 3.0 * r + 4.0 / 3.0 / r);
    let found = range("u.r about [3, 0] [mm]");
    assert!((found[0] / u(2.0) - 1.0).abs() < 1e-3 && (found[1] / u(1.0) - 1.0).abs() < 1e-3, "{found:?}");
    // the file has them under the same names
    let vtu = std::fs::read(at.path().join("ring.out/fields.vtu")).unwrap();
    assert!(String::from_utf8_lossy(&vtu).contains("principal.1"));
    for (fields, part) in [
        ("\"stress.tt about [0]\"", "the centre of `stress.tt about [0]` has 1 coordinates"),
        ("\"u.r about [q, 0]\"", "the coordinate `q` of `u.r about [q, 0]` is no number"),
        ("\"principal.4\"", "there is no field `principal.4` to show"),
        ("\"strain.xz\"", "there is no field `strain.xz` to show"),
        ("\"principal.1 in ring\"", "there is no field `principal.1 in ring` to show"),
    ] {
        write(fields);
        let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at.path()).args(["check", "ring.toml"]).output().unwrap();
        let told = String::from_utf8_lossy(&out.stderr);
        assert!(told.contains("error[E018]") && told.contains(part), "{part}: {told}");
    }
}
