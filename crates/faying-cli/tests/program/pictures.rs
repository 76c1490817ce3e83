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
