//! Case files: every error with its text and place, options, defaults written out, hostile input, formulas.

use std::f64::consts::PI;

use faying_cli::case::{Case, Condition, Datum, Divisions, Master, Multiplier, ObstacleShape, ReadOptions, Shape};
use faying_cli::errors::{Diagnostic, Diagnostics, LISTED, Severity};
use faying_cli::formula::{Constants, Formula, Point, Scope};
use faying_cli::place::{Origin, SourceSpan};
use proptest::prelude::*;

const SAMPLES: [(&str, &str); 4] = [
    ("contact-patch.toml", include_str!("../../../../examples/cases/contact-patch.toml")),
    ("poisson-arc.toml", include_str!("../../../../examples/cases/poisson-arc.toml")),
    ("hertz.toml", include_str!("../../../../examples/cases/hertz.toml")),
    ("iga-fe-arc.toml", include_str!("../../../../examples/cases/iga-fe-arc.toml")),
];

/// A small case in which every test changes one thing.
const BASE: &str = r#"schema = 1

[let]
F = 2e-4

[model]
physics = "elasticity"
dimension = 2

[[material]]
name = "steel"
young = 1.0
poisson = 0.3

[[patch]]
name = "lower"
geometry = { kind = "box", min = [0, 0], max = [1, 0.5] }
elements = [4, 2]

[[patch]]
name = "upper"
geometry = { kind = "box", min = [0, 0.5], max = [1, 1] }
elements = [3, 2]

[[boundary]]
on = "lower.bottom"
fix = ["x", "y"]

[[boundary]]
on = "upper.top"
pressure = "F"

[[contact]]
name = "pad"
slave = "upper.bottom"
master = "lower.top"

[[probe]]
name = "tip"
quantity = "u.y at [1.0, 1.0] in upper"

[[check]]
quantity = "contact.pad.force.y"
equals = "F"
rtol = 1e-9
"#;

/// A Poisson case of one patch with an exact solution.
const POISSON: &str = r#"
[model]
physics = "poisson"
dimension = 2
exact = { u = "x*y" }

[[patch]]
name = "p"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [2, 2]

[[boundary]]
on = "all-outer"
dirichlet = "exact"
"#;

fn parse(text: &str) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions::default())
}

fn parse_set(text: &str, sets: &[&str]) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions { sets: sets.iter().map(|s| (*s).to_owned()).collect(), ..ReadOptions::default() })
}

fn read(text: &str) -> Case {
    parse(text).unwrap_or_else(|e| panic!("{e}"))
}

/// The base case with one piece of text exchanged.
fn with(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "{from} is not in the base case");
    BASE.replacen(from, to, 1)
}

/// The only error of a text.
fn error_of(text: &str) -> Diagnostic {
    let found = parse(text).err().unwrap_or_else(|| panic!("no error in\n{text}"));
    assert_eq!(found.items.len(), 1, "{found}");
    found.items[0].clone()
}

/// The only error has this code and message and stands at the first character of this piece of the text.
#[track_caller]
fn fails(text: &str, code: &str, message: &str, at: &str) -> Diagnostic {
    let d = error_of(text);
    assert_eq!((d.code, d.message.as_str()), (code, message));
    let offset = text.find(at).unwrap_or_else(|| panic!("{at} is not in the text"));
    let line = text[..offset].matches('\n').count() + 1;
    let column = offset - text[..offset].rfind('\n').map_or(0, |k| k + 1) + 1;
    assert_eq!((d.line, d.column), (Some(line), Some(column)), "{}", d.render());
    assert_eq!(d.exit(), 3);
    d
}

// the text of errors -----------------------------------------------------------------------------

/// The example of the contract, section 5, to the letter.
#[test]
fn a_misspelt_key_reads_as_in_the_contract() {
    let text = with("young = 1.0", "young = 1.0\nyougn = 1.0");
    let line = text.lines().position(|l| l.starts_with("yougn")).unwrap() + 1;
    let found = parse(&text).unwrap_err();
    let expected = format!(
        "error[E012]: unknown key `yougn` in material \"steel\"\n  \
           --> case.toml:{line}:1\n   \
           |\n \
         {line} | yougn = 1.0\n   \
           | ^^^^^ did you mean `young`?\n   \
           = help: keys here: name, young, poisson, lambda, mu, density, law       (faying explain E012)\n"
    );
    // two digits: one column more in the margin
    let expected = expected.replace("\n  --> ", "\n   --> ").replace("\n   |", "\n    |").replace("\n   =", "\n    =");
    assert_eq!(found.render(), expected);
    assert_eq!(found.exit(), 3);
}

#[test]
fn a_text_for_a_number_reads_as_in_the_contract() {
    let text = with("elements = [4, 2]", "elements = [4, 2]\ndegree = \"2\"");
    let d = fails(&text, "E014", "`degree` must be a whole number from 1 to 12, found the text \"2\"", "\"2\"");
    assert_eq!(d.help.as_deref(), Some("write degree = 2"));
}

#[test]
fn json_has_the_fields_of_the_contract() {
    let d = error_of(&with("young = 1.0", "young = 1.0\nyougn = 1.0"));
    let json = d.to_json();
    let keys: Vec<&String> = json.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["code", "severity", "message", "file", "line", "column", "help"]);
    assert_eq!(json["code"], "E012");
    assert_eq!(json["severity"], "error");
    assert_eq!(json["file"], "case.toml");
    assert_eq!(json["column"], 1);
    assert_eq!(serde_json::to_value(&d).unwrap(), json);
    let bare = Diagnostic::error("E003", "there is no file").to_json();
    assert!(
        bare["line"].is_null()
            && bare["help"] == "correct the name; `ls *.toml` shows the cases of this folder, `faying new --list` the samples"
    );
}

#[test]
fn codes_exit_as_the_contract_says() {
    let exit = |code| Diagnostic::error(code, "m").exit();
    for code in ["E003", "E090", "E091"] {
        assert_eq!(exit(code), 4);
    }
    for code in ["E071", "E072", "E073", "E074"] {
        assert_eq!(exit(code), 5);
    }
    assert_eq!(exit("E081"), 6);
    for code in faying_cli::codes::CODES.iter().map(|c| c.code).filter(|c| !["E003", "E090", "E091", "E081"].contains(c)) {
        // warnings end nothing
        let wanted = if ["E061", "E065"].contains(&code) { 0 } else { 3 };
        assert_eq!(exit(code), if code.starts_with("E07") { 5 } else { wanted });
    }
    assert_eq!(Diagnostic::warning("E061", "m").exit(), 0);
    // the first that applies of 4, 6, 5, 3
    let all = |codes: &[&'static str]| Diagnostics { items: codes.iter().map(|c| Diagnostic::error(c, *c)).collect() }.exit();
    assert_eq!(all(&["E012", "E003"]), 4);
    assert_eq!(all(&["E012", "E072"]), 5);
    assert_eq!(all(&["E081", "E072"]), 6);
    assert_eq!(all(&[]), 0);
}

#[test]
fn several_errors_are_listed_together_and_at_most_twenty() {
    let text = with("poisson = 0.3", "poisson = 0.7").replace("lower.top", "lower.tap").replace("fix", "fixx");
    let found = parse(&text).unwrap_err();
    let mut codes: Vec<&str> = found.items.iter().map(|d| d.code).collect();
    codes.sort_unstable();
    assert_eq!(codes, ["E012", "E021", "E053"], "{found}");
    let lines: Vec<_> = found.items.iter().map(|d| d.line).collect();
    assert!(lines.is_sorted(), "in the order of the file: {lines:?}");

    let many: String = (0..45).map(|k| format!("key{k} = 1\n")).collect();
    let found = parse(&format!("{many}{BASE}")).unwrap_err();
    assert_eq!(found.items.len(), 45);
    let text = found.render();
    assert_eq!(text.matches("error[").count(), LISTED);
    assert!(text.ends_with("\n... and 25 more\n"), "{text}");
}

#[test]
fn long_lines_and_odd_characters_keep_the_caret_in_place() {
    let text = format!("{}title = \"{}é\u{202e}\t\" ; x\n", "# ü\n", "ä".repeat(300));
    let d = error_of(&text);
    let rendered = d.render();
    assert_eq!(d.code, "E005");
    let lines: Vec<&str> = rendered.lines().collect();
    let caret = lines[4].chars().position(|c| c == '^').unwrap();
    assert_eq!(lines[3].chars().nth(caret), Some(';'), "{rendered}");
    assert!(lines[3].chars().count() < 150);
}

// one test per code ------------------------------------------------------------------------------

#[test]
fn e001_newer_schema() {
    let text = with("schema = 1", "schema = 2").replace("young", "something_new");
    fails(&text, "E001", "the case has schema 2, this program reads schema 1", "2");
}

#[test]
fn e003_file_not_found_names_similar_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("hertz.toml"), "").unwrap();
    let missing = folder.path().join("herz.toml");
    let found = Case::read(&missing).unwrap_err();
    assert_eq!((found.items[0].code, found.exit()), ("E003", 4));
    assert!(found.items[0].message.starts_with("there is no file "));
    assert_eq!(found.items[0].help.as_deref(), Some("similar names there: hertz.toml"));
    // a folder is no file
    assert_eq!(Case::read(folder.path()).unwrap_err().items[0].code, "E003");
}

#[test]
fn e005_toml_syntax_has_the_parsers_place() {
    let d = error_of("a = 1\nb = [1,\n");
    assert_eq!((d.code, d.message.as_str()), ("E005", "the file is not valid TOML: unclosed array, expected `]`"));
    // behind the comma, where the bracket is missing
    assert_eq!((d.line, d.column), (Some(2), Some(8)));
}

#[test]
fn e005_duplicate_keys_and_bytes_that_are_no_text() {
    let text = with("young = 1.0", "young = 1.0\nyoung = 2.0");
    fails(&text, "E005", "the file is not valid TOML: duplicate key", "young = 2.0");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.toml");
    std::fs::write(&path, b"a = 1\nb = \"\xff\"\n").unwrap();
    let d = Case::read(&path).unwrap_err().items[0].clone();
    assert_eq!((d.code, d.line, d.column), ("E005", Some(2), Some(6)));
}

#[test]
fn e012_unknown_keys_everywhere() {
    fails(&with("dimension = 2", "dimension = 2\ndimensoin = 2"), "E012", "unknown key `dimensoin` in [model]", "dimensoin");
    fails(&format!("pach = 1\n{BASE}"), "E012", "unknown key `pach` at the top level", "pach");
    fails(&with("rtol = 1e-9", "rtol = 1e-9\nrtoll = 1"), "E012", "unknown key `rtoll` in check 0", "rtoll");
    fails(&with("min = [0, 0],", "mini = 1, min = [0, 0],"), "E012", "unknown key `mini` in `geometry` of kind \"box\"", "mini");
    fails(&format!("{BASE}\n[study.convergense]\nlevels = 3\n"), "E012", "unknown study `convergense`", "convergense");
    let d = fails(&with("pressure = \"F\"", "pressur = \"F\"\npressure = \"F\""), "E012", "unknown key `pressur` in boundary 1", "pressur");
    assert_eq!(d.label.as_deref(), Some("did you mean `pressure`?"));
}

#[test]
fn e013_missing_keys_point_to_their_block() {
    fails(&with("physics = \"elasticity\"", ""), "E013", "`physics` is missing in [model]", "[model]");
    fails(&with("elements = [4, 2]", ""), "E013", "`elements` is missing in patch \"lower\"", "[[patch]]");
    fails(
        &with("name = \"lower\"\n", "").replace("lower.", "upper.").replace("upper.top", "upper.left").replacen(
            "upper.bottom",
            "upper.right",
            1,
        ),
        "E013",
        "`name` is missing in patch 0",
        "[[patch]]",
    );
    let nameless = fails(&with("name = \"steel\"\n", ""), "E013", "`name` is missing in material 0", "[[material]]");
    assert_eq!(nameless.help.as_deref(), Some("write name = \"steel\""));
    fails(&with("poisson = 0.3", ""), "E013", "`poisson` is missing in material \"steel\"", "[[material]]");
    fails(&with("slave = \"upper.bottom\"", ""), "E013", "`slave` is missing in contact \"pad\"", "[[contact]]");
    fails(&with("master = \"lower.top\"", ""), "E013", "`master` or `rigid` is missing in contact \"pad\"", "[[contact]]");
    fails(&with("equals = \"F\"\nrtol = 1e-9", ""), "E013", "`below`, `above` or `equals` is missing in check 0", "[[check]]");
    fails(&with("rtol = 1e-9", ""), "E013", "`rtol` is missing in check 0", "[[check]]");
    fails(&with("fix = [\"x\", \"y\"]", ""), "E013", "boundary 0 has no condition", "[[boundary]]");
    fails(&with("kind = \"box\", ", ""), "E013", "`kind` is missing in `geometry`", "{ min");
    let found = parse("").unwrap_err();
    let messages: Vec<&str> = found.items.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(messages, ["[model] is missing in the case", "[[patch]] is missing in the case"]);
    assert!(found.items.iter().all(|d| d.line == Some(1)), "{found}");
}

#[test]
fn a_misspelt_name_of_something_required_is_one_error() {
    for (text, key) in [
        (with("young = 1.0", "yougn = 1.0"), "yougn"),
        (with("young = 1.0\npoisson = 0.3", "E = 1.0\nnu = 0.3"), "E"),
        (with("[[material]]", "[[materail]]"), "materail"),
        (with("physics =", "phisics ="), "phisics"),
        (with("name = \"lower\"", "nmae = \"lower\""), "nmae"),
        (with("kind = \"box\"", "knd = \"box\""), "knd"),
        (with("elements = [4, 2]", "elemnts = [4, 2]"), "elemnts"),
        (with("master =", "mastr ="), "mastr"),
        (with("equals =", "equls ="), "equls"),
        (with("rtol =", "tol ="), "tol"),
        (with("pressure =", "presure ="), "presure"),
        (BASE.replace("[[patch]]", "[[pacth]]"), "pacth"),
    ] {
        let found = parse(&text).unwrap_err();
        assert!(found.items.iter().all(|d| d.code == "E012"), "{found}");
        assert!(found.items[0].message.starts_with(&format!("unknown key `{key}`")), "{found}");
        assert!(found.items[0].label.is_some(), "{found}");
    }
    // one of two heads: what refers to it is not wrong, too
    error_of(&with("[[patch]]\nname = \"upper\"", "[[pacth]]\nname = \"upper\""));
}

#[test]
fn names_that_are_no_names_are_one_error_each() {
    // all that refers to a bad name finds it
    let text = BASE.replace("\"lower", "\"lower part");
    fails(&text, "E016", "\"lower part\" is no name", "\"lower part\"");
    // nothing knows what the second of two equal names was meant to be
    let text = with("name = \"upper\"", "name = \"lower\"");
    assert!(error_of(&text).message.starts_with("the patch name \"lower\" is already used on line"));
    error_of(&with("name = \"lower\"\n", ""));
    // a made-up name is not quoted
    let text = with("name = \"lower\"\n", "").replace("[[material]]\nname = \"steel\"\nyoung = 1.0\npoisson = 0.3\n", "");
    let found = parse(&text).unwrap_err();
    assert!(found.items.iter().any(|d| d.message == "patch 0 has no material"), "{found}");
}

#[test]
fn e014_wrong_types() {
    fails(&with("young = 1.0", "young = true"), "E014", "`young` must be a number or a quoted formula, found true", "true");
    fails(&with("young = 1.0", "young = [1.0]"), "E014", "`young` must be a number or a quoted formula, found a list of 1", "[1.0]");
    fails(&with("name = \"pad\"", "name = 3"), "E014", "`name` must be a text in quotes, found 3", "3\nslave");
    fails(&with("[[material]]", "[material]"), "E014", "`material` must be a list of tables, found a table", "[material]");
    fails(
        &with("elements = [4, 2]", "elements = [4, 2.5]"),
        "E014",
        "`elements` must be a whole number of at least 1, found 2.5".replace("of at least 1", "from 1 to 1000000").as_str(),
        "2.5",
    );
    fails(&with("min = [0, 0]", "min = 0"), "E014", "`min` must be a list of 2 numbers, found 0", "0, max");
    fails(
        &with("pressure = \"F\"", "traction = \"F\""),
        "E014",
        "`traction` must be \"exact\", a list of 2 formulas or a table of some, found the text \"F\"",
        "\"F\"\n\n[[contact]]",
    );
    fails(&with("on = \"lower.bottom\"", "on = 7"), "E014", "`on` must be a side or a list of sides, found 7", "7");
    fails(&with("dimension = 2", "dimension = 2.0"), "E014", "`dimension` must be a whole number from 2 to 3, found 2.0", "2.0");
    let exact = POISSON.replace("exact = { u = \"x*y\" }", "exact = \"x*y\"");
    fails(&exact, "E014", "`exact` must be a table, found the text \"x*y\"", "\"x*y\"");
    fails(&with("F = 2e-4", "F = false"), "E014", "`F` must be a number or a quoted formula, found false", "false");
}

#[test]
fn e015_ranges_words_and_keys_of_other_kinds() {
    fails(
        &with("elements = [4, 2]", "elements = [4, 0]"),
        "E015",
        "`elements` must be a whole number from 1 to 1000000, found 0",
        "0]\n\n",
    );
    fails(
        &with("elements = [4, 2]", "elements = [4, 2]\nbackend = \"fe\"\ndegree = 9"),
        "E015",
        "`degree` must be a whole number from 1 to 8 for backend fe, found 9",
        "9",
    );
    let simplex = "elements = [4, 2]\nbackend = \"fe\"\ncells = \"simplex\"\ndegree = 5";
    fails(
        &with("elements = [4, 2]", simplex),
        "E015",
        "`degree` must be a whole number from 1 to 4 for backend fe with simplex cells, found 5",
        "5\n",
    );
    fails(
        &with("elements = [4, 2]", "elements = [4, 2]\ndegree = 13"),
        "E015",
        "`degree` must be a whole number from 1 to 12, found 13",
        "13",
    );
    fails(
        &with("elements = [4, 2]", "elements = [4, 2]\ncontinuity = 2"),
        "E015",
        "`continuity` must be less than the degree 2, found 2",
        "2\n\n[[patch]]",
    );
    let d = fails(
        &with("physics = \"elasticity\"", "physics = \"elasticty\""),
        "E015",
        "`physics` must be one of \"poisson\", \"elasticity\", found \"elasticty\"",
        "\"elasticty\"",
    );
    assert_eq!(d.label.as_deref(), Some("did you mean \"elasticity\"?"));
    fails(&with("max = [1, 0.5]", "radius = 1, max = [1, 0.5]"), "E015", "`radius` is not a key of kind \"box\"", "radius");
    fails(
        &with("max = [1, 0.5]", "max = [1, -0.5]"),
        "E015",
        "`max` must exceed `min` in every coordinate, but y does not: 0.0 and -0.5",
        "[1, -0.5]",
    );
    fails(&with("elements = [4, 2]", "elements = [[0, 0.5, 0.4, 1], 2]"), "E015", "breakpoints must increase, found 0.4 after 0.5", "0.4");
    fails(&with("elements = [4, 2]", "elements = [[0, 0.5, 0.9], 2]"), "E015", "breakpoints go from 0.0 to 1.0", "[0, 0.5, 0.9]");
    fails(&with("young = 1.0", "young = inf"), "E015", "`young` must be finite, found inf", "inf");
    fails(&with("rtol = 1e-9", "rtol = 1e-9\nbelow = 2"), "E015", "`equals` does not stand beside `below`", "equals");
    fails(&with("equals = \"F\"\nrtol", "below = \"F\"\nrtol"), "E015", "`rtol` is a key of checks by `equals`", "rtol");
    fails(&with("young = 1.0", "young = 1.0\nlambda = 1.0"), "E015", "material \"steel\" gives constants of both pairs", "lambda");
    fails(&with("dimension = 2", "dimension = 2\nsource = 1"), "E015", "`source` is a key of poisson", "source");
    fails(&with("slave =", "factor = 10\nslave ="), "E015", "`factor` is not a key of method = \"lagrange\"", "10");
    let rigid = "rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 0] }";
    fails(&with("master = \"lower.top\"", rigid), "E015", "`normal` must not be zero", "[0, 0] }\n\n[[probe]]");
    // a vector that is too short is one error
    let short = parse(&with("master = \"lower.top\"", &rigid.replace("[0, 0] }", "[1] }"))).unwrap_err().render();
    assert_eq!(short.matches("error[").count(), 1, "{short}");
    fails(
        &with("master = \"lower.top\"", &format!("master = \"lower.top\"\n{rigid}")),
        "E015",
        "`rigid` does not stand beside `master`",
        "{ kind = \"half-plane\"",
    );
    fails(
        &POISSON.replace("exact = {", "source = 1\nexact = {"),
        "E015",
        "a body force or source does not stand beside `exact`",
        "1\nexact",
    );
}

#[test]
fn loads_of_no_component_and_springs_that_push_are_refused() {
    let fix = "fix = [\"x\", \"y\"]";
    for key in ["force", "spring", "rigid_force"] {
        let d = error_of(&with(fix, &format!("{key} = {{}}")));
        assert_eq!((d.code, d.message.contains(key)), ("E014", true), "{d:?}");
    }
    let text = with(fix, "spring = { x = 1.0, y = -1e9 }");
    fails(&text, "E015", "`spring` must not be negative, found -1000000000.0", "-1e9");
    read(&with(fix, "spring = { x = 0.0, y = 1e9 }"));
}

#[test]
fn e016_names() {
    let d = fails(
        &with("name = \"upper\"", "name = \"lower\"").replace("upper.", "lower.").replace("lower.bottom\"\nmaster", "lower.left\"\nmaster"),
        "E016",
        "the patch name \"lower\" is already used on line 16",
        "\"lower\"\ngeometry = { kind = \"box\", min = [0, 0.5]",
    );
    assert!(d.help.is_some());
    fails(&with("name = \"pad\"", "name = \"my pad\""), "E016", "\"my pad\" is no name", "\"my pad\"");
    fails(&with("[let]", "[let]\npi = 3"), "E016", "`pi` cannot be the name of a constant", "pi");
    fails(&with("[let]", "[let]\nx = 3"), "E016", "`x` cannot be the name of a constant", "x = 3");
    fails(&with("on = \"upper.top\"", "on = [\"upper.top\", \"upper.v1\"]"), "E016", "`upper.v1` is named twice in `on`", "\"upper.v1\"");
    fails(
        &with("slave =", "nonmortar = \"upper.bottom\"\nslave ="),
        "E016",
        "`nonmortar` is another name of `slave`, which is given too",
        "nonmortar",
    );
    // interfaces and contacts share their names
    let tie = "[[interface]]\nname = \"pad\"\nslave = \"upper.left\"\nmaster = \"lower.left\"\n\n[[probe]]";
    fails(
        &with("[[probe]]", tie),
        "E016",
        "the interface or contact name \"pad\" is already used on line 39",
        "\"pad\"\nslave = \"upper.bottom\"",
    );
}

#[test]
fn e017_formulas_point_inside_the_text() {
    let formula = |text: &str, message: &str, at: &str| {
        fails(&with("pressure = \"F\"", &format!("pressure = \"{text}\"")), "E017", &format!("formula of `pressure`: {message}"), at)
    };
    let d = formula("2*FF + x", "unknown name `FF`; did you mean `F`?", "FF + x");
    assert_eq!(d.help.as_deref(), Some("names here: x, y, z, t, r, theta, pi, e, F; others are defined in [let]"));
    formula("sni(x)", "unknown function `sni`; did you mean `sin`?", "sni(x)");
    formula("2theta", "an operator is missing; products are written with `*`", "theta");
    formula("(x + 1", "a closing bracket `)` is missing", "\"\n\n[[contact]]");
    formula("x = 1", "`=` is no operator; write == to compare", "= 1\"");
    formula("1,5", "`,` is not expected here; a decimal point is written `.`", ",5");
    formula("x**2", "`**` is no operator; write ^", "**2");
    formula("atan2(y)", "`atan2` takes 2 arguments", "atan2(y)");
    formula("sin(x, y)", "`sin` takes 1 argument", "sin(x, y)");
    formula("if(x, y)", "`if` takes 3 arguments", "if(x, y)");
    formula("sin", "the function `sin` needs its arguments in brackets", "sin\"");
    formula("F(2)", "`F` is no function; products are written with `*`", "F(2)");
    formula("1 < x < 2", "comparisons do not chain; use if(a < b, b < c, 0)", "< 2\"");
    formula("g", "`g` has a value only in the gap formula of a contact", "g\"");
    formula("1e999", "`1e999` is too large for a number", "1e999");
    formula("x +", "the formula ends where a number or a name is expected", "\"\n\n[[contact]]");
    formula("", "the formula is empty", "\"\n\n[[contact]]");
    formula("x § 2", "unexpected character `§`", "§");
    formula(&"(".repeat(100_000), "the formula is longer than 20000 characters", "((((");
    let deep = format!("{}x", "(".repeat(5000));
    let d = error_of(&with("pressure = \"F\"", &format!("pressure = \"{deep}\"")));
    assert_eq!(d.message, "formula of `pressure`: the formula is nested deeper than 100 levels");
    for hostile in ["sin(", "2^", "-", "-2^", "if(x,", "max(1,"] {
        let d = error_of(&with("pressure = \"F\"", &format!("pressure = \"{}\"", hostile.repeat(3000))));
        assert_eq!(d.code, "E017");
    }
    // where columns are unknown the position is counted in the text
    fails(
        &with("pressure = \"F\"", "pressure = \"\\u0078 + Q\""),
        "E017",
        "formula of `pressure`: unknown name `Q` (character 5)",
        "\"\\u0078",
    );
}

#[test]
fn e017_constants_that_define_each_other() {
    let text = with("F = 2e-4", "F = \"2*a\"\na = \"b + 1\"\nb = \"F/3\"");
    fails(&text, "E017", "formula of `F`: constants of [let] define each other: F -> a -> b -> F", "2*a");
    fails(&with("F = 2e-4", "F = \"2*k\""), "E017", "formula of `F`: unknown constant `k`", "k\"");
    fails(
        &with("F = 2e-4", "F = \"2*x\""),
        "E017",
        "formula of `F`: `x` has no value here; only constants, and in checks quantities, are known",
        "x\"",
    );
    fails(&with("F = 2e-4", "F = \"1/0\""), "E017", "formula of `F`: the value of `F` is not finite", "1/0");
}

#[test]
fn e019_known_but_not_in_this_version() {
    let later = |from: &str, to: &str, what: &str, at: &str| {
        fails(&with(from, to), "E019", &format!("{what} is not in this version"), at);
    };
    later("slave =", "friction = 0.3\nslave =", "`friction`", "friction");
}

/// Every key of the contract that is not built (line before it, the key with a value, what is said), and the values that ask for
/// nothing new.
#[test]
fn e019_every_key_of_the_contract_that_is_not_built() {
    let (model, material) = ("physics = \"elasticity\"", "name = \"steel\"");
    let (contact, steps, solver) = ("name = \"pad\"", "[steps]\ncount = 2", "[solver]");
    let base = format!("{BASE}\n{steps}\n{solver}\n");
    let put = |after: &str, line: &str| base.replacen(after, &format!("{after}\n{line}"), 1);
    for (after, line, key) in [
        (model, "kinematics = \"finite\"", "kinematics = \"finite\""),
        (material, "law = \"neo-hooke\"", "law = \"neo-hooke\""),
        (material, "law = \"saint-venant-kirchhoff\"", "law = \"saint-venant-kirchhoff\""),
        (material, "law = \"mooney-rivlin\"", "law = \"mooney-rivlin\""),
        (material, "volumetric = \"log\"", "`volumetric`"),
        (material, "c1 = 1.0", "`c1`"),
        (material, "c2 = 1.0", "`c2`"),
        (material, "bulk = 1.0", "`bulk`"),
        (contact, "friction = 0.3", "`friction`"),
        (contact, "friction = \"F\"", "`friction`"),
        (contact, "friction = \"0.1*x\"", "`friction`"),
        (contact, "friction = { tresca = 0.05 }", "`friction`"),
        (steps, "smallest = 1e-3", "`smallest`"),
        (solver, "newton = { tolerance = 1e-10, max_iterations = 25 }", "`newton`"),
        (solver, "preconditioner = \"fast-diagonal\"", "preconditioner = \"fast-diagonal\""),
        (solver, "preconditioner = \"multigrid\"", "preconditioner = \"multigrid\""),
        (solver, "preconditioner = \"aggregation\"", "preconditioner = \"aggregation\""),
        (solver, "preconditioner = \"gauss-seidel\"", "preconditioner = \"gauss-seidel\""),
        (solver, "operator = \"matrix-free\"", "operator = \"matrix-free\""),
        (solver, "precision = \"mixed\"", "precision = \"mixed\""),
    ] {
        let d = error_of(&put(after, line));
        assert_eq!((d.code, d.message), ("E019", format!("{key} is not in this version")), "{line}");
        assert!(d.line.is_some() && !d.help.unwrap_or_default().is_empty(), "{line}");
    }
    let same = parse(&base).unwrap();
    for (after, line) in [
        (model, "kinematics = \"small\""),
        (material, "law = \"hooke\""),
        (contact, "friction = 0"),
        (contact, "friction = 0.0"),
        (contact, "friction = \"F - F\""),
        (contact, "friction = { tresca = 0 }"),
        (solver, "preconditioner = \"auto\""),
        (solver, "operator = \"auto\""),
        (solver, "operator = \"matrix\""),
        (solver, "precision = \"double\""),
    ] {
        let case = parse(&put(after, line)).unwrap_or_else(|e| panic!("{line}: {e}"));
        let effective = case.effective_toml();
        let (key, _) = line.split_once(" = ").unwrap();
        assert!(effective.contains(&format!("{key} = ")), "{line} is not in\n{effective}");
        let without: Vec<&str> = effective.lines().filter(|l| !l.starts_with(&format!("{key} = "))).collect();
        assert_eq!(without, same.effective_toml().lines().collect::<Vec<_>>(), "{line}");
        parse(effective).unwrap_or_else(|e| panic!("{line}, effective: {e}"));
    }
    // words that the contract does not know are no promise
    assert_eq!(error_of(&put(material, "law = \"hoke\"")).code, "E015");
    assert_eq!(error_of(&put(model, "kinematic = \"small\"")).code, "E012");
    // physics without the key
    let flow = "[model]\nphysics = \"poisson\"\ndimension = 2\nassumption = \"axisymmetric\"\n[[patch]]\nname = \"a\"\nelements = [2, 2]\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\n";
    assert!(parse(flow).is_ok());
    assert_eq!(error_of(&flow.replace("axisymmetric", "plane-stress")).code, "E015");
    assert_eq!(
        error_of(&flow.replace("dimension = 2", "dimension = 3").replace("0]", "0, 0]").replace("1]", "1, 1]").replace("2]", "2, 2]")).code,
        "E015"
    );
}

/// `[study.NAME]` has the names of the options.
#[test]
fn a_study_takes_its_quantity_under_the_name_of_the_option() {
    let studies = |key: &str| parse(&format!("{BASE}\n[study.sweep]\n{key} = [\"tip\"]\n")).unwrap().studies[0].value.quantities.clone();
    assert_eq!(studies("quantity"), ["tip"]);
    assert_eq!(studies("quantities"), ["tip"]);
}

#[test]
fn e021_unknown_patches_and_sides() {
    fails(
        &with("slave = \"upper.bottom\"", "slave = \"upper.u0v0\""),
        "E021",
        "`upper.u0v0` is an edge or a corner; `slave` takes sides",
        "\"upper.u0v0\"",
    );
    // the text of the contract
    fails(
        &with("\"upper.bottom\"", "\"upper.v2\""),
        "E021",
        "there is no side `upper.v2`; sides of \"upper\" are u0, u1, v0, v1",
        "\"upper.v2\"",
    );
    let d = fails(&with("\"upper.bottom\"", "\"uper.bottom\""), "E021", "there is no patch \"uper\"", "\"uper.bottom\"");
    assert_eq!(d.label.as_deref(), Some("did you mean \"upper\"?"));
    assert_eq!(d.help.as_deref(), Some("sides are written PATCH.SIDE; patches are lower, upper"));
    fails(
        &with("\"upper.bottom\"", "[\"upper.bottom\", \"all-outer\"]"),
        "E021",
        "\"all-outer\" stands alone, not in a list: it is every side that no other block names",
        "\"all-outer\"",
    );
    fails(
        &with("\"upper.bottom\"", "\"upper\""),
        "E021",
        "`upper` names a patch, not a side; sides of \"upper\" are u0, u1, v0, v1",
        "\"upper\"\nmaster",
    );
    let disc = with("kind = \"box\", min = [0, 0], max = [1, 0.5]", "kind = \"disc-sector\", radius = 1.0, angle_deg = [0, 90]");
    let d = fails(&disc, "E021", "there is no side `lower.bottom`; sides of \"lower\" are u0, u1, v1", "\"lower.bottom\"");
    assert_eq!(d.help.as_deref(), Some("v0 is the centre of the disc and no side"));
    // w0 belongs to volumes
    assert_eq!(error_of(&with("\"upper.bottom\"", "\"upper.w0\"")).code, "E021");
}

#[test]
fn e026_slave_twice_or_its_own_master() {
    fails(&with("\"lower.top\"", "\"upper.v0\""), "E026", "`upper.v0` is its own master", "\"upper.bottom\"");
    let twice = format!("{BASE}\n[[interface]]\nslave = \"upper.v0\"\nmaster = \"lower.left\"\n");
    fails(&twice, "E026", "`upper.v0` is slave twice: on line 48 and on line 35", "\"upper.bottom\"").line.unwrap();
}

#[test]
fn e031_to_e034_name_direction_index_and_value() {
    let net = |knots: &str, points: &str, weights: &str| {
        let g = format!("kind = \"nurbs\", degree = [2, 1], knots = {knots}, points = {points}, weights = {weights}");
        with("kind = \"box\", min = [0, 0], max = [1, 0.5]", &g)
    };
    let knots = "[[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]]";
    let points = "[[0, 0], [0.5, 0], [1, 0], [0, 0.5], [0.5, 0.5], [1, 0.5]]";
    let weights = "[1, 0.9, 1, 1, 0.9, 1]";
    let case = read(&net(knots, points, weights));
    let Shape::Nurbs { degree, knots: u, points: p, weights: w } = &case.patches[0].geometry.shape.value else { panic!() };
    assert_eq!((degree.value.as_slice(), u[1].value.as_slice()), (&[2, 1][..], &[0.0, 0.0, 1.0, 1.0][..]));
    assert_eq!((p[4].as_slice(), w.as_ref().unwrap()[4]), (&[0.5, 0.5][..], 0.9));
    assert_eq!(case.patches[0].elements[0].value, Divisions::PerSpan(4));

    let k = "[[0, 0, 0, 0.6, 0.5, 1, 1, 1], [0, 0, 1, 1]]";
    fails(&net(k, points, weights), "E031", "knots of direction u decrease at index 4: 0.5 after 0.6", "0.5, 1, 1, 1]");
    let k = "[[0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1], [0, 0, 1, 1]]";
    fails(
        &net(k, points, weights),
        "E032",
        "knot 0.5 of direction u is repeated 3 times, at most 2 are allowed (index 3)",
        "0.5, 0.5, 0.5, 1",
    );
    let k = "[[0, 0, 0, 1, 1, 1], [0, 0.2, 0.8, 1]]";
    fails(&net(k, points, weights), "E032", "knot 0.0 at an end of direction v stands 1 times, it must stand 2 times", "0, 0.2");
    let k = "[[0, 0, 0, 0.5, 1, 1, 1], [0, 0, 1, 1]]";
    fails(&net(k, points, weights), "E033", "degree and knots ask for 4 x 2 control points, found 6", points);
    fails(&net(knots, points, "[1, 1, 1]"), "E033", "there are 6 control points, but 3 weights", "[1, 1, 1] }");
    fails(&net(knots, points, "[1, 1, 1, -0.5, 1, 1]"), "E034", "weight 3 must be positive, found -0.5", "-0.5");
    fails(&net("[[0, 1], [0, 0, 1, 1]]", points, weights), "E033", "the knots of direction u are 2, degree 2 needs at least 6", "[0, 1]");
    // an edge that is one point is no side
    let collapsed = net(knots, "[[0, 0], [0, 0], [0, 0], [0, 0.5], [0.5, 0.5], [1, 0.5]]", weights);
    let d = fails(&collapsed, "E021", "there is no side `lower.bottom`; sides of \"lower\" are u0, u1, v1", "\"lower.bottom\"");
    assert_eq!(d.help.as_deref(), Some("this edge is collapsed to a point and no side"));
}

#[test]
fn e044_wrong_dimensions() {
    fails(&with("min = [0, 0]", "min = [0, 0, 1]"), "E044", "`min` must have 2 coordinates, found 3", "[0, 0, 1]");
    // points with z = 0 are points of the plane
    read(&with("min = [0, 0]", "min = [0, 0, 0]"));
    fails(
        &with("elements = [4, 2]", "elements = [4, 2, 1]"),
        "E044",
        "`elements` must have 2 entries, one per direction, found 3",
        "[4, 2, 1]",
    );
    fails(
        &with("elements = [4, 2]", "elements = [4, 2]\ndegree = [2]"),
        "E044",
        "`degree` must be one number or a list of 2, found a list of 1",
        "[2]",
    );
    fails(&with("pressure = \"F\"", "traction = [0]"), "E044", "`traction` must have 2 components, found 1", "[0]");
    let g = "max = [1, 0.5], extrude = 1.0";
    fails(&with("max = [1, 0.5]", g), "E044", "`extrude` makes a body of dimension 3, the model has dimension 2", "1.0 }");
}

#[test]
fn e044_says_what_to_do_about_a_plane_that_is_extruded() {
    let d = error_of(&with("max = [1, 0.5] }", "max = [1, 0.5], extrude = 1.0 }"));
    assert_eq!((d.code, d.help.is_some_and(|h| h.contains("dimension = 3"))), ("E044", true));
}

#[test]
fn e052_two_conditions_name_both_lines() {
    let text =
        with("pressure = \"F\"", "pressure = \"F\"\n\n[[boundary]]\non = [\"lower.left\", \"lower.v0\"]\ndirichlet = { y = \"-F\" }");
    let d = fails(&text, "E052", "`lower.v0` has two conditions for component y: prescribed on line 27, and again on line 35", "\"-F\"");
    assert!(d.help.unwrap().contains("prescribed once"));
    let text = with("fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\"]\ntraction = [0, 1]");
    fails(&text, "E052", "`lower.v0` has two conditions for component y: prescribed on line 27, loaded on line 28", "1]\n\n[[boundary]]");
    let text = with("fix = [\"x\", \"y\"]", "fix = [\"x\"]\ndirichlet = { x = 1 }");
    fails(&text, "E052", "component x is fixed and prescribed in one block", "1 }\n\n[[boundary]]");
    let text = with("fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\"]\npressure = 1");
    assert_eq!(error_of(&text).code, "E052");
    // other components, and loads that add up, are no conflict
    read(&with("fix = [\"x\", \"y\"]", "fix = [\"x\"]\ntraction = { y = 1 }"));
    read(&with("pressure = \"F\"", "pressure = \"F\"\ntraction = [1, 0]"));
    let twice = POISSON.replace("[[boundary]]", "[[boundary]]\non = \"all-outer\"\nneumann = 1\n\n[[boundary]]");
    fails(&twice, "E052", "\"all-outer\" stands in two blocks: on line 13 and on line 17", "\"all-outer\"\ndirichlet");
}

#[test]
fn e053_material_limits() {
    let d = fails(&with("poisson = 0.3", "poisson = 0.5"), "E053", "poisson = 0.5 makes plane strain singular", "0.5\n\n[[patch]]");
    assert!(d.help.is_some());
    fails(&with("poisson = 0.3", "poisson = -1.5"), "E053", "`poisson` must be between -1 and 0.5, found -1.5", "-1.5");
    fails(&with("young = 1.0", "young = 0"), "E053", "`young` must be positive, found 0.0", "0\npoisson");
    read(&with("dimension = 2", "dimension = 2\nassumption = \"plane-stress\"").replace("poisson = 0.3", "poisson = 0.5"));
    let k = POISSON.replace("[[patch]]", "[[material]]\nname = \"m\"\nconductivity = -2\n\n[[patch]]");
    fails(&k, "E053", "`conductivity` must be positive, found -2.0", "-2");
}

#[test]
fn e054_no_material() {
    let none = with("[[material]]\nname = \"steel\"\nyoung = 1.0\npoisson = 0.3\n", "");
    let found = parse(&none).unwrap_err();
    assert_eq!(found.items.len(), 2);
    assert_eq!((found.items[0].code, found.items[0].message.as_str()), ("E054", "patch \"lower\" has no material"));
    let two = with("[[patch]]", "[[material]]\nname = \"brass\"\nyoung = 2\npoisson = 0.3\n\n[[patch]]");
    let found = parse(&two).unwrap_err();
    assert_eq!(found.items[0].message, "patch \"lower\" has no material, and there are 2");
    assert_eq!(found.items[0].help.as_deref(), Some("write material = \"steel\"; materials: steel, brass"));
    let d =
        fails(&with("elements = [4, 2]", "elements = [4, 2]\nmaterial = \"stel\""), "E054", "there is no material \"stel\"", "\"stel\"");
    assert_eq!(d.label.as_deref(), Some("did you mean \"steel\"?"));
}

#[test]
fn e062_exact_data_need_an_exact_solution() {
    let text = POISSON.replace("exact = { u = \"x*y\" }\n", "");
    fails(&text, "E062", "data marked \"exact\" need `exact` in [model]", "\"exact\"");
}

#[test]
fn e064_no_such_multiplier() {
    let d = fails(&with("slave =", "multiplier = \"p/q\"\nslave ="), "E064", "there is no multiplier \"p/q\"", "\"p/q\"");
    assert_eq!(
        d.help.unwrap(),
        "known: auto, p/p, p/p-1, p/p-2, p/p-2k, constant, dual, or { degree = 1, continuity = 0, ends = \"auto\" }"
    );
    let case = read(&with("slave =", "multiplier = { degree = 1, continuity = -1, ends = \"full\" }\nslave ="));
    assert!(matches!(case.contacts[0].multiplier.value, Multiplier::Data { degree: 1, continuity: Some(-1), .. }));
    read(&with("slave =", "multiplier = \"p/p-4\"\nslave ="));
}

#[test]
fn e018_a_quantity_is_not_empty() {
    fails(&with("quantity = \"contact.pad.force.y\"", "quantity = \" \""), "E018", "the quantity is empty", "\" \"");
}

#[test]
fn gravity_needs_densities() {
    let text = with("dimension = 2", "dimension = 2\ngravity = [0, -9.81]");
    fails(&text, "E013", "`gravity` needs a density, material \"steel\" has none", "[0, -9.81]");
    let case = read(&text.replace("poisson = 0.3", "poisson = 0.3\ndensity = 7.8e-9"));
    assert_eq!(case.model.gravity.unwrap().value, [0.0, -9.81]);
    // of one patch
    let text = with("elements = [4, 2]", "elements = [4, 2]\ngravity = { y = -9.81 }");
    fails(&text, "E013", "`gravity` needs a density, material \"steel\" has none", "{ y = -9.81 }");
    let case = read(&text.replace("poisson = 0.3", "poisson = 0.3\ndensity = 7.8e-9"));
    assert_eq!(case.patches[0].gravity.as_ref().unwrap().value, [0.0, -9.81]);
    round_trip(&case);
    let case = POISSON.replace("elements", "gravity = [0, -1]\nelements");
    fails(&case, "E015", "`gravity` is a key of elasticity", "gravity");
    let exact =
        POISSON.replace("physics = \"poisson\"", "physics = \"elasticity\"\ngravity = [0, -1]").replace("\"x*y\"", "[\"x\", \"y\"]");
    let exact = exact.replace("[[patch]]", "[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\ndensity = 1\n\n[[patch]]");
    fails(&exact, "E015", "`gravity` does not stand beside `exact`", "[0, -1]");
}

// options ----------------------------------------------------------------------------------------

#[test]
fn set_names_entries_by_name_or_position() {
    let case = parse_set(
        BASE,
        &["patch.lower.degree=3", "boundary.1.pressure=2", "let.F=5e-4", "patch.upper.backend=fe", "solver.constraint=condensed"],
    )
    .unwrap();
    assert_eq!(case.patches[0].discretization.degree.value, [3, 3]);
    assert_eq!(case.patches[1].discretization.degree.value, [2, 2]);
    assert_eq!(case.boundaries[1].pressure.as_ref().unwrap().as_constant(), Some(2.0));
    assert_eq!(case.constants.get("F"), Some(5e-4));
    assert_eq!(case.patches[1].discretization.backend.value, "fe");
    assert_eq!(case.solver.constraint.value, "condensed");
    let case = parse_set(
        BASE,
        &[
            "patch.0.elements.1=7",
            "boundary.1.pressure=x + F",
            "patch.1.name=above",
            "contact.pad.slave=above.v0",
            "boundary.1.on=above.top",
        ],
    )
    .unwrap();
    assert_eq!(case.patches[0].elements[1].value, Divisions::Total(7));
    assert_eq!(case.boundaries[1].pressure.as_ref().unwrap().value(&Point::new(&[1.0])), 1.0 + 2e-4);
    // the later option wins
    let case = parse_set(BASE, &["let.F=1", "let.F=3"]).unwrap();
    assert_eq!(case.constants.get("F"), Some(3.0));
}

#[test]
fn errors_of_set_point_to_the_option() {
    let one = |set: &str| {
        let found = parse_set(BASE, &[set]).unwrap_err();
        assert_eq!(found.items.len(), 1, "{found}");
        let d = found.items[0].clone();
        assert_eq!((d.line, d.file.as_deref()), (None, Some(format!("--set {set}").as_str())));
        (d.code, d.message, d.help.unwrap_or_default())
    };
    assert_eq!(
        one("patch.lowr.degree=3"),
        ("E012", "there is no patch `lowr`; did you mean `lower`?".into(), "names: lower, upper; positions 0 to 1".into())
    );
    assert_eq!(one("patch.2.degree=3").1, "there is no patch `2`");
    assert_eq!(one("patch.lower.degree=\"x\"").1, "`degree` must be a whole number from 1 to 12, found the text \"x\"");
    assert_eq!(one("patch.lower.degre=3").1, "unknown key `degre` in patch \"lower\"");
    assert_eq!(one("interface.arc.slave=a.v0").1, "there is no [[interface]] in the case");
    assert_eq!(one("patch.lower.elements=[4,").0, "E005");
    assert_eq!(one("degree").0, "E014");
    assert_eq!(one("model..x=1").0, "E012");
    assert_eq!(one("model.dimension.x=1").1, "`dimension` has no keys: it is 2");
    let d = parse_set(BASE, &["patch.lower.degree=13"]).unwrap_err().items[0].clone();
    assert_eq!(d.render().lines().nth(1), Some("  --> --set patch.lower.degree=13"));
}

#[test]
fn the_backend_option_replaces_every_backend() {
    let text = with("elements = [4, 2]", "elements = [4, 2]\nbackend = \"iga\"");
    let options = ReadOptions { backend: Some("fe".into()), ..ReadOptions::default() };
    let case = Case::parse("case.toml", &text, &options).unwrap();
    assert!(case.patches.iter().all(|p| p.discretization.backend.value == "fe"));
    let options = ReadOptions { backend: Some("fem".into()), ..ReadOptions::default() };
    let found = Case::parse("case.toml", &text, &options).unwrap_err();
    assert_eq!(found.items[0].message, "`backend` must be one of \"iga\", \"fe\", found \"fem\"");
    assert_eq!(found.items[0].file.as_deref(), Some("the command line"));
}

#[test]
fn a_registry_adds_names() {
    let mut options = ReadOptions { sets: vec!["patch.lower.backend=modal".into()], ..ReadOptions::default() };
    assert!(Case::parse("case.toml", BASE, &options).is_err());
    faying_cli::case::Names::add(&mut options.names.backends, ["modal", "iga"]);
    assert_eq!(options.names.backends, ["iga", "fe", "modal"]);
    assert_eq!(Case::parse("case.toml", BASE, &options).unwrap().patches[0].discretization.backend.value, "modal");
}

// what a case says -------------------------------------------------------------------------------

#[test]
fn the_base_case_is_typed_with_its_defaults() {
    let case = read(BASE);
    assert_eq!((case.components(), case.patches.len(), case.materials.len()), (2, 2, 1));
    assert_eq!(case.patches[1].material.value, 0);
    assert_eq!(case.side_name(&case.contacts[0].slave[0]), "upper.v0");
    assert_eq!(case.boundaries[0].name.value, "boundary-0");
    assert!(
        case.boundaries[0]
            .dirichlet
            .iter()
            .all(|d| matches!(&d.as_ref().unwrap().value, Datum::Formula(f) if f.as_constant() == Some(0.0)))
    );
    let c = &case.contacts[0];
    assert!(matches!(&c.master, Master::Sides(s) if s.len() == 1));
    assert_eq!(c.gap.value(&Point::default().with_gap(0.25)), 0.25);
    assert_eq!((c.active_set.max_iterations.value, c.active_set.c.value, c.reach.value), (100, 1.0, None));
    assert_eq!(c.multiplier.value, Multiplier::Named("auto".into()));
    assert_eq!(case.steps.value, [1.0]);
    // places: the value of young stands on line 12
    let Some(faying_cli::case::Elastic::YoungPoisson(young, _)) = &case.materials[0].elastic else { panic!() };
    assert_eq!((young.at.line, young.at.column, young.at.origin), (12, 9, Origin::File));
    assert_eq!(case.contacts[0].head.at, SourceSpan { line: 33, column: 1, length: 11, origin: Origin::File });
    let d = case.diagnostic(Diagnostic::error("E051", "body \"upper\" can still move"), case.patches[1].head.at);
    assert!(d.render().contains("[[patch]]"));
}

#[test]
fn all_outer_is_the_rest_of_the_sides() {
    let text = with("on = \"upper.top\"\npressure = \"F\"", "on = \"all-outer\"\ntraction = [0, 1]");
    let case = read(&text);
    let names: Vec<String> = case.boundaries[1].on.iter().map(|s| case.side_name(s)).collect();
    assert_eq!(names, ["lower.u0", "lower.u1", "upper.u0", "upper.u1", "upper.v1"]);
}

#[test]
fn a_poisson_case_needs_no_material() {
    let case = read(POISSON);
    assert_eq!((case.materials[0].name.as_str(), case.materials[0].conductivity.as_constant()), ("default", Some(1.0)));
    assert!(case.effective_toml().contains("[[material]]\nname = \"default\"\nconductivity = 1.0\n"));
}

#[test]
fn obstacles_are_read() {
    let rigid = |r: &str| read(&with("master = \"lower.top\"", &format!("rigid = {r}")));
    let shape = |c: &Case| match &c.contacts[0].master {
        Master::Rigid(o) => o.shape.value.clone(),
        _ => panic!("a rigid master"),
    };
    let case = rigid("{ kind = \"half-plane\", point = [0, 0.5], normal = [3, 4], move = { y = \"-0.05*t\" } }");
    let ObstacleShape::HalfPlane { normal, .. } = shape(&case) else { panic!() };
    assert_eq!(normal.value, [0.6, 0.8]);
    let Master::Rigid(o) = &case.contacts[0].master else { panic!() };
    assert_eq!(o.translate[1].as_ref().unwrap().value(&Point::default().at_time(0.5)), -0.025);
    let case = rigid("{ kind = \"sphere\", center = [0, -1], radius = 1.5 }");
    assert!(matches!(shape(&case), ObstacleShape::Sphere { inside, .. } if !inside.value));
    let case = rigid("{ kind = \"level-set\", f = \"y - 0.1*x^2\", along = [0, 2] }");
    let ObstacleShape::LevelSet { f, along } = shape(&case) else { panic!() };
    assert_eq!((f.value(&Point::new(&[2.0, 1.0])), along.unwrap().value), (0.6, vec![0.0, 1.0]));
    let case = rigid("{ kind = \"disc-sector\", radius = 1, angle_deg = [0, 90], scale = 2, move = { y = \"t\" } }");
    let ObstacleShape::Geometry(g) = shape(&case) else { panic!() };
    assert_eq!((g.shape.value.kind(), g.scale.unwrap().value, g.translate), ("disc-sector", 2.0, None));
    // one list of knots, or a list of one: a curve
    for (degree, knots) in [("2", "[0, 0, 0, 1, 1, 1]"), ("[2]", "[[0, 0, 0, 1, 1, 1]]")] {
        let nurbs = format!("{{ kind = \"nurbs\", degree = {degree}, knots = {knots}, points = [[0, 0], [1, 0], [2, 0]] }}");
        let case = rigid(&nurbs);
        let ObstacleShape::Geometry(g) = shape(&case) else { panic!() };
        assert!(matches!(&g.shape.value, Shape::Nurbs { degree, knots, .. } if degree.value == [2] && knots.len() == 1));
        assert_eq!(read(case.effective_toml()).contacts[0].name, case.contacts[0].name, "{}", case.effective_toml());
    }
}

#[test]
fn checks_may_name_quantities() {
    let case = read(&with("equals = \"F\"", "equals = \"-2*reaction.lower.bottom.y + contact.pad.area*F\""));
    let Condition::Equals { value, rtol, atol } = &case.checks[0].condition else { panic!() };
    let names: Vec<&str> = value.quantities().iter().map(|q| q.text.as_str()).collect();
    assert_eq!(names, ["reaction.lower.bottom.y", "contact.pad.area"]);
    assert_eq!(value.value_with(1.0, &[1.0, 10.0]), -2.0 + 10.0 * 2e-4);
    assert!(rtol.is_some() && atol.is_none());
}

// the effective case -----------------------------------------------------------------------------

/// Everything that this version builds, in one file.
const RICH: &str = r#"
title = "all of it \"quoted\" \\ ü"
[let]
k = "2*m"
m = 0.5
[model]
physics = "elasticity"
dimension = 2
assumption = "plane-stress"
body_force = ["0", "-1 + 0*x"]
[discretization]
backend = "fe"
degree = [3, 2]
continuity = 0
basis = "b-spline"
mapping = "exact"
extra_points = 1
[[material]]
name = "a"
lambda = "1 + x^2"
mu = 1
density = 7.8e-9
[[material]]
name = "b"
young = 2.1e5
poisson = 0.3
[[patch]]
name = "one"
material = "a"
geometry = { kind = "disc-sector", radius = "k", angle_deg = [0, 90], scale = 2, rotate_deg = 30, move = { y = 1 } }
elements = [[0, 0.25, 1], 3]
grade = { toward = { v = 1 }, ratio = 0.1 }
refine = 1
[[patch]]
name = "two-2"
material = "b"
backend = "iga"
degree = 4
geometry = { kind = "plate-with-hole", radius = 1, half_width = 4 }
elements = 6
body_force = { x = "t" }
[[patch]]
name = "net"
material = "b"
geometry = { kind = "nurbs", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], points = [[0, 0], [1, 0], [0, 1], [1, 1]], weights = [1, 2, 1, 1] }
[[boundary]]
name = "hold"
on = ["one.u0", "net.left"]
fix = "x"
dirichlet = { y = "sin(pi*x)" }
[[boundary]]
on = "all-outer"
traction = { x = 1e-300 }
pressure = "k*x"
[[interface]]
secondary = "one.v1"
primary = ["net.right", "net.top"]
multiplier = { degree = 1 }
tolerance = 1e-3
exact = ["1", "x"]
extra_points = 2
[[contact]]
slave = "two-2.v0"
rigid = { kind = "sphere", center = [0, 0], radius = 0.9 }
gap = "g - 0.001"
reach = 0.5
exact = -1.25e-3
active_set = { start = { seed = 7 }, c = 2 }
[solver]
constraint = "saddle-point"
linear = "direct"
[[probe]]
quantity = "u.x at [1, 0] in one"
[[check]]
quantity = "energy"
below = "2*interface.interface-0.lambda.norm + 1e300"
backend = "fe"
[[check]]
name = "all"
quantity = "stress.yy"
over = "all"
equals = 1
atol = 1e-6
[study.convergence]
levels = 5
degrees = { iga = [2, 3], fe = [1, 2] }
"#;

fn round_trip(case: &Case) {
    let again = parse(case.effective_toml()).unwrap_or_else(|e| panic!("{e}\n{}", case.effective_toml()));
    assert_eq!(*case, again, "{}", case.effective_toml());
    let body = |c: &Case| c.effective_toml().lines().skip(1).collect::<Vec<_>>().join("\n");
    assert_eq!(body(case), body(&again));
}

#[test]
fn the_effective_case_reads_back_to_the_same_case() {
    for (name, text) in SAMPLES {
        round_trip(&Case::parse(name, text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")));
    }
    for text in [BASE, POISSON, RICH] {
        round_trip(&read(text));
    }
    let case = read(RICH);
    assert_eq!(case.title.value, "all of it \"quoted\" \\ ü");
    assert_eq!(case.side_name(&case.interfaces[0].slave[0]), "one.v1");
    let toml = case.effective_toml();
    for default in [
        "coupling = \"mortar\"",
        "integration = \"merged\"",
        "method = \"lagrange\"",
        "max_iterations = 100",
        "cells = \"tensor\"",
        "inside = false",
        "refine = 0",
        "center = [0.0, 0.0]",
    ] {
        assert!(toml.contains(default), "{default} in\n{toml}");
    }
}

#[test]
fn the_effective_case_holds_the_options() {
    let options = ReadOptions { sets: vec!["let.F=3".into()], backend: Some("fe".into()), ..ReadOptions::default() };
    let case = Case::parse("case.toml", BASE, &options).unwrap();
    let again = parse(case.effective_toml()).unwrap();
    assert_eq!(again.constants.get("F"), Some(3.0));
    assert!(again.patches.iter().all(|p| p.discretization.backend.value == "fe"));
}

// hostile input ----------------------------------------------------------------------------------

/// Xorshift: the same mutations on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self, below: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % below.max(1)
    }

    fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.next(from.len())]
    }
}

fn mutate(text: &str, r: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let k = r.next(lines.len());
    match r.next(15) {
        0 => {
            lines.remove(k);
        }
        1 => {
            let j = r.next(lines.len());
            lines.swap(k, j);
        }
        2 => lines.insert(k, lines[r.next(lines.len())].clone()),
        3 => {
            // a character somewhere
            let chars: Vec<char> = lines[k].chars().collect();
            let at = r.next(chars.len() + 1);
            let odd = ['"', '\'', '[', ']', '{', '}', '=', ',', '.', '#', '\\', '\u{0}', 'é', '\u{1F600}', '-', '0', 'e', '\u{202e}', '\t'];
            lines[k] = chars[..at].iter().chain(&[odd[r.next(odd.len())]]).chain(&chars[at..]).collect();
        }
        4 => {
            let chars: Vec<char> = lines[k].chars().collect();
            let (a, b) = (r.next(chars.len() + 1), r.next(chars.len() + 1));
            lines[k] = chars[..a.min(b)].iter().chain(&chars[a.max(b)..]).collect();
        }
        5 | 6 => {
            // another value
            let values = [
                "1e400",
                "-1",
                "0",
                "99999999999999999999999",
                "-0.0",
                "nan",
                "inf",
                "true",
                "\"\"",
                "\"x\"",
                "[]",
                "{}",
                "[[]]",
                "[1, 2, 3]",
                "\"exact\"",
                "2024-01-01",
                "{ kind = \"nurbs\" }",
                "[[0, 0, 1, 1], [0, 0, 1, 1]]",
                "\"auto\"",
                "0x7fffffffffffffff",
                "1e-320",
                "\"sqrt(-1)\"",
                "\"x/0\"",
                "[\"x\", 3]",
                "{ x = 1, y = \"t\" }",
                "9223372036854775807",
                "\"lower.v0\"",
                "{ degree = 0 }",
                "\"dual\"",
                "\"penalty\"",
            ];
            if let Some((key, _)) = lines[k].clone().split_once('=') {
                lines[k] = format!("{key}= {}", r.pick(&values));
            }
        }
        7 => {
            // a value of another line
            let j = r.next(lines.len());
            if let (Some((key, _)), Some((_, value))) = (lines[k].clone().split_once('='), lines[j].clone().split_once('=')) {
                lines[k] = format!("{key}={value}");
            }
        }
        8 => {
            // a key of another line
            let j = r.next(lines.len());
            if let (Some((key, _)), Some((_, value))) = (lines[j].clone().split_once('='), lines[k].clone().split_once('=')) {
                lines[k] = format!("{key}={value}");
            }
        }
        9 => {
            let depth = 1 + r.next(300);
            let open = r.pick(&["[", "{ a = ", "(", "sin(", "-", "2^"]);
            let quote = r.pick(&["", "\""]);
            if let Some((key, _)) = lines[k].clone().split_once('=') {
                lines[k] = format!("{key}= {quote}{}1{quote}", open.repeat(depth));
            }
        }
        10 => lines[k] = lines[k].replace(r.pick(&["1", "2", "0", "."]), r.pick(&["9", "-", "1e9", "000", "é"])),
        11 => lines.truncate(k),
        12 => {
            let later = [
                "friction = 0.1",
                "gravity = [0, 1]",
                "closed = \"u\"",
                "where = \"x\"",
                "force = { y = 1 }",
                "method = \"penalty\"",
                "gap = \"g*x\"",
            ];
            lines.insert(k, r.pick(&later).to_owned());
        }
        13 => {
            let head = r.pick(&[
                "[model]",
                "[[model]]",
                "[[patch]]",
                "[patch]",
                "[[contact]]",
                "[let]",
                "[[let]]",
                "[study.convergence]",
                "[[steps]]",
                "[a.b.c]",
            ]);
            lines.insert(k, head.to_owned());
        }
        _ => {
            for line in lines.iter_mut().skip(k).take(3) {
                *line = line.replace('"', r.pick(&["", "'", "\"\"\"", "\\\""]));
            }
        }
    }
    lines.join(r.pick(&["\n", "\n", "\r\n"])) + "\n"
}

/// Every diagnostic lies in the file or names an option, renders, and quotes its own line.
fn located(found: &Diagnostics, text: &str, sets: &[String]) {
    let lines: Vec<&str> = text.split('\n').collect();
    for d in &found.items {
        assert!(faying_cli::codes::find(d.code).is_some(), "{d:?}");
        let rendered = d.render();
        assert!(rendered.starts_with(&format!("{}[{}]: ", d.severity.word(), d.code)), "{rendered}");
        match (d.line, d.column) {
            (Some(line), Some(column)) => {
                let content = lines.get(line - 1).unwrap_or_else(|| panic!("line {line} of {}: {rendered}", lines.len()));
                assert!(column <= content.chars().count() + 1, "column {column}: {rendered}");
                assert_eq!(d.snippet.as_deref(), Some(content.trim_end_matches('\r')));
                assert!(rendered.contains('^'));
            }
            _ => {
                let option = d.file.as_deref().is_some_and(|f| sets.iter().any(|s| f == format!("--set {s}")));
                assert!(option || d.message.ends_with("is missing in the case"), "{rendered}");
            }
        }
    }
    assert!(found.has_errors() && found.exit() == 3);
    assert!(found.render().matches("error[").count() <= LISTED);
}

#[test]
fn two_thousand_mutated_case_files_do_not_panic() {
    let mut r = Random(0x2545_f491_4f6c_dd1d);
    let mut good = 0;
    let mut codes = std::collections::BTreeMap::new();
    let sources: Vec<&str> = SAMPLES.iter().map(|s| s.1).chain([BASE, RICH, POISSON]).collect();
    for k in 0..2000 {
        let mut text = sources[k % sources.len()].to_owned();
        for _ in 0..1 + r.next(3) {
            text = mutate(&text, &mut r);
        }
        let options = ReadOptions {
            sets: if r.next(8) == 0 {
                vec![
                    r.pick(&[
                        "patch.0.degree=3",
                        "let.F=\"1",
                        "patch.lower.elements=[9999999, 1]",
                        "boundary.0.on=é",
                        "model=1",
                        "patch=[]",
                        "a.b.c.d=1",
                    ])
                    .to_owned(),
                ]
            } else {
                Vec::new()
            },
            ..ReadOptions::default()
        };
        match Case::parse("case.toml", &text, &options) {
            Ok(case) => {
                good += 1;
                round_trip(&case);
            }
            Err(found) => {
                located(&found, &text, &options.sets);
                for d in &found.items {
                    *codes.entry(d.code).or_insert(0) += 1;
                }
            }
        }
    }
    // the mutations reach most of the reader, and do not only break the syntax
    assert!(good > 200 && good < 1800, "{good}");
    for code in ["E005", "E012", "E013", "E014", "E015", "E016", "E017", "E019", "E021", "E044", "E053"] {
        assert!(codes.contains_key(code), "{code} never came up: {codes:?}");
    }
}

#[test]
fn huge_files_are_read_in_reasonable_time() {
    let lets: String = (1..20_000).map(|k| format!("c{k} = \"c{} + 1\"\n", k - 1)).collect();
    let start = std::time::Instant::now();
    let case = read(&with("F = 2e-4", &format!("F = 2e-4\nc0 = 1\n{lets}")));
    assert_eq!(case.constants.get("c19999"), Some(20_000.0));
    let many: String = (0..20_000).map(|k| format!("k{k} = 1\n")).collect();
    assert!(parse(&format!("{many}{BASE}")).is_err());
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

// formulas ---------------------------------------------------------------------------------------

/// An expression as a tree, so that Rust can evaluate what the parser reads.
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    Variable(usize),
    Unary(usize, Box<Tree>),
    Binary(usize, Box<Tree>, Box<Tree>),
    Power(Box<Tree>, i32),
    If(Box<Tree>, Box<Tree>, Box<Tree>),
}

const UNARY: [(&str, fn(f64) -> f64); 15] = [
    ("-", |x| -x),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("exp", f64::exp),
    ("log", f64::ln),
    ("sqrt", f64::sqrt),
    ("abs", f64::abs),
    ("sign", |x| {
        if x > 0.0 {
            1.0
        } else if x < 0.0 {
            -1.0
        } else {
            0.0 * x
        }
    }),
];

const BINARY: [(&str, fn(f64, f64) -> f64); 9] = [
    ("+", |a, b| a + b),
    ("-", |a, b| a - b),
    ("*", |a, b| a * b),
    ("/", |a, b| a / b),
    ("atan2", f64::atan2),
    ("min", |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }),
    ("max", |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }),
    ("pow", f64::powf),
    ("<", |a, b| f64::from(u8::from(a < b))),
];

const VARIABLES: [&str; 6] = ["x", "y", "z", "t", "r", "theta"];

impl Tree {
    fn text(&self) -> String {
        match self {
            Self::Number(v) => format!("({v:?})"),
            Self::Variable(k) => VARIABLES[*k].to_owned(),
            Self::Unary(0, a) => format!("(-{})", a.text()),
            Self::Unary(k, a) => format!("{}({})", UNARY[*k].0, a.text()),
            Self::Binary(k, a, b) if BINARY[*k].0.chars().all(char::is_alphanumeric) => {
                format!("{}({}, {})", BINARY[*k].0, a.text(), b.text())
            }
            Self::Binary(k, a, b) => format!("({} {} {})", a.text(), BINARY[*k].0, b.text()),
            Self::Power(a, n) => format!("({}^{n})", a.text()),
            Self::If(c, a, b) => format!("if({}, {}, {})", c.text(), a.text(), b.text()),
        }
    }

    fn value(&self, at: &[f64; 4]) -> f64 {
        match self {
            Self::Number(v) => *v,
            Self::Variable(k @ 0..=3) => at[*k],
            Self::Variable(4) => (at[0] * at[0] + at[1] * at[1]).sqrt(),
            Self::Variable(_) => at[1].atan2(at[0]),
            Self::Unary(k, a) => UNARY[*k].1(a.value(at)),
            Self::Binary(k, a, b) => BINARY[*k].1(a.value(at), b.value(at)),
            Self::Power(a, n) => a.value(at).powi(*n),
            Self::If(c, a, b) => {
                if c.value(at) != 0.0 {
                    a.value(at)
                } else {
                    b.value(at)
                }
            }
        }
    }
}

fn trees() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![(-4.0..4.0f64).prop_map(Tree::Number), (0usize..6).prop_map(Tree::Variable)];
    leaf.prop_recursive(4, 40, 3, |inner| {
        prop_oneof![
            (0..UNARY.len(), inner.clone()).prop_map(|(k, a)| Tree::Unary(k, Box::new(a))),
            (0..BINARY.len(), inner.clone(), inner.clone()).prop_map(|(k, a, b)| Tree::Binary(k, Box::new(a), Box::new(b))),
            (inner.clone(), -3..5i32).prop_map(|(a, n)| Tree::Power(Box::new(a), n)),
            (inner.clone(), inner.clone(), inner).prop_map(|(c, a, b)| Tree::If(Box::new(c), Box::new(a), Box::new(b))),
        ]
    })
}

fn point(at: &[f64; 4]) -> Point {
    Point::new(&at[..3]).at_time(at[3])
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a.is_nan() && b.is_nan()) || a == b || (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs()))
}

proptest! {
    #![proptest_config(crate::random::inputs(2000))]

    /// Rust's own functions are the reference. pow of whole exponents is by multiplication there and here.
    #[test]
    fn formulas_have_the_values_of_rust(tree in trees(), at in [-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64, 0.0..1.0f64]) {
        let c = Constants::default();
        let f = Formula::parse(&tree.text(), &Scope::space(&c)).map_err(|e| TestCaseError::fail(format!("{e}: {}", tree.text())))?;
        let (a, b) = (f.value(&point(&at)), tree.value(&at));
        prop_assert!(close(a, b, 1e-12), "{}: {a} and {b}", tree.text());
        let jet = f.jet(&point(&at));
        prop_assert!(jet.value == a || (a.is_nan() && jet.value.is_nan()));
    }

    /// No text makes the parser panic; what it reads can be evaluated.
    #[test]
    fn any_text_is_read_or_refused(text in "[-+*/^()<>=!,. 0-9a-gxyzt\"\\[\\]é]{0,40}") {
        let c = Constants::default();
        let names = ["a-b".to_owned()];
        for scope in [Scope::space(&c), Scope::check(&c, &names)] {
            match Formula::parse(&text, &scope) {
                Ok(f) => { f.jet(&Point::default()); f.value_with(1.0, &[1.0]); }
                Err(e) => prop_assert!(e.offset <= text.chars().count()),
            }
        }
    }
}

/// First and second derivatives against central differences of values and of gradients.
#[test]
fn jets_agree_with_finite_differences() {
    let texts = [
        "sin(x)*cos(y) + tan(z/3)",
        "asin(x/3) + acos(y/3) + atan(z)",
        "sinh(x) + cosh(y*z) + tanh(x*y)",
        "exp(x*y - z)",
        "log(4 + x + y^2)",
        "sqrt(5 + x*y*z)",
        "abs(x - 3)*y + sign(z)*x^2",
        "min(x, y + 5) * max(x, z - 5)",
        "(3 + x)^(y/2 + z)",
        "pow(x, 3) - x^-2 + 2^x",
        "atan2(y + 3, x*z)",
        "r^3*cos(2*theta) + z*r",
        "if(x < 5, x^2*y, z)",
        "x/(y + 3) / (2 + z^2)",
        "-x^2*y^2 + x^1*y^0 + (x*0)^2.5",
        "sqrt(x^2 + y^2) - r + theta - atan2(y, x)",
        "(x + 3)^2.5 * e^(pi*z/4)",
    ];
    let c = Constants::default();
    let h = 1e-5;
    for text in texts {
        let f = Formula::parse(text, &Scope::space(&c)).unwrap();
        for at in [[0.7, -0.4, 0.3], [-1.1, 0.6, -0.8], [0.2, 0.9, 0.5]] {
            let p = Point::new(&at);
            let jet = f.jet(&p);
            assert!(jet.value.is_finite(), "{text}");
            let slope = f.slope(&p);
            assert_eq!((slope.value, slope.gradient, slope.hessian), (jet.value, jet.gradient, [[0.0; 3]; 3]), "{text}");
            for i in 0..3 {
                let shifted = |s: f64| {
                    let mut q = p;
                    q.x[i] += s * h;
                    f.jet(&q)
                };
                let (above, below) = (shifted(1.0), shifted(-1.0));
                let first = (above.value - below.value) / (2.0 * h);
                assert!(close(jet.gradient[i], first, 1e-8), "{text} at {at:?}, d{i}: {} and {first}", jet.gradient[i]);
                for j in 0..3 {
                    let second = (above.gradient[j] - below.gradient[j]) / (2.0 * h);
                    assert!(close(jet.hessian[i][j], second, 1e-7), "{text} at {at:?}, d{i}{j}: {} and {second}", jet.hessian[i][j]);
                    assert_eq!(jet.hessian[i][j], jet.hessian[j][i]);
                }
            }
        }
    }
}

/// Derivatives are carried in x and y only where z does not occur; also where derivatives are infinite.
#[test]
fn formulas_without_z_have_the_derivatives_of_those_with_it() {
    let c = Constants::default();
    let parse = |text: &str| Formula::parse(text, &Scope::space(&c)).unwrap();
    // `==` takes the zeros of either sign for one, and here a missing number for itself
    let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
    for text in
        ["sqrt(x) + y", "r*theta", "x^1.5*y", "abs(x)^0.5", "2*sqrt(x)/3", "x/(y - 1)", "min(x, y)*r^3", "sqrt(x)*y - 0*log(x)", "y^x"]
    {
        let (plane, space) = (parse(text), parse(&format!("{text} + 0*z")));
        for at in [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.7, 1.0, 0.0], [0.7, -0.4, 0.3]] {
            let (a, b) = (plane.jet(&Point::new(&at)), space.jet(&Point::new(&at)));
            assert!(same(a.value, b.value), "{text} at {at:?}: {a:?} {b:?}");
            assert_eq!((a.gradient[2], a.hessian[2]), (0.0, [0.0; 3]));
            for i in 0..2 {
                assert!(same(a.gradient[i], b.gradient[i]), "{text} at {at:?}: {a:?} {b:?}");
                assert!((0..2).all(|j| same(a.hessian[i][j], b.hessian[i][j])), "{text} at {at:?}: {a:?} {b:?}");
            }
        }
    }
}

/// A harmonic function has no source; r^2 theta has 4 theta: known by hand.
#[test]
fn the_laplacian_of_a_manufactured_solution_is_known() {
    let c = Constants::default();
    let laplacian = |text: &str, at: &[f64]| {
        let h = Formula::parse(text, &Scope::space(&c)).unwrap().jet(&Point::new(at)).hessian;
        h[0][0] + h[1][1]
    };
    assert!(laplacian("exp(x)*sin(y)", &[0.3, 0.7]).abs() < 1e-15);
    assert!(laplacian("log(r)", &[1.0, 2.0]).abs() < 1e-15);
    assert!((laplacian("r^2*theta", &[1.0, 1.0]) - PI).abs() < 1e-14);
}

#[test]
fn derivatives_at_zero_are_those_of_polynomials() {
    let c = Constants::default();
    let jet = Formula::parse("x^2 + y^3 + x^1 + z^0 + 0^x", &Scope::space(&c)).unwrap().jet(&Point::new(&[0.0, 0.0, 0.0]));
    assert!(!jet.hessian[0][0].is_finite(), "0^x has no derivative");
    let jet = Formula::parse("x^2 + y^3 + x^1 + z^0", &Scope::space(&c)).unwrap().jet(&Point::new(&[0.0, 0.0, 0.0]));
    assert_eq!((jet.value, jet.gradient, jet.hessian[0][0], jet.hessian[1][1]), (1.0, [1.0, 0.0, 0.0], 2.0, 0.0));
}

#[test]
fn warnings_do_not_stop_reading() {
    let d = Diagnostic::warning("E061", "multiplier \"p/p-1\" is not stable");
    assert_eq!((d.severity, d.exit()), (Severity::Warning, 0));
    assert!(d.render().starts_with("warning[E061]: multiplier"));
}

#[test]
fn the_largest_limit_of_several_contacts_counts_and_a_warning_says_so() {
    let contacts = |limits: [&str; 2]| {
        let second =
            "[[contact]]\nname = \"wall\"\nslave = \"lower.left\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [1, 0] }\n";
        let limited = |block: &str, limit: &str| match limit {
            "" => block.to_owned(),
            _ => format!("{block}active_set = {{ max_iterations = {limit} }}\n"),
        };
        let own = "master = \"lower.top\"\n";
        assert!(BASE.contains(own));
        format!("{}\n{}", BASE.replace(own, &limited(own, limits[0])), limited(second, limits[1]))
    };
    let warnings = |limits: [&str; 2]| Case::parse("a.toml", &contacts(limits), &ReadOptions::default()).unwrap().warnings.items;
    for limits in [["", ""], ["30", "30"], ["", "200"], ["300", ""]] {
        assert_eq!(warnings(limits).len(), 0, "{limits:?}");
    }
    for (limits, said, at) in [
        (["30", "40"], "max_iterations = 30 of contact \"pad\"", "the largest counts, 40 of \"wall\""),
        (["40", "30"], "max_iterations = 30 of contact \"wall\"", "the largest counts, 40 of \"pad\""),
        (["30", ""], "max_iterations = 30 of contact \"pad\"", "100 of \"wall\", its default"),
        (["100", "101"], "max_iterations = 100 of contact \"pad\"", "101 of \"wall\""),
    ] {
        let found = warnings(limits);
        assert_eq!(found.len(), 1, "{limits:?}");
        let text = found[0].render();
        assert!(found[0].severity == Severity::Warning && text.contains("E015") && text.contains(said) && text.contains(at), "{text}");
        assert!(found[0].line.is_some() && found[0].help.is_some(), "{text}");
    }
}

// every load and support that needs an integral or an equation of its own -----------------------

/// One box 2 x 1 with E = rho = 1 and nu = 0, so that every direction is a bar of its own: answers by hand.
#[test]
fn loads_and_supports_of_a_side_have_the_answers_of_a_bar() {
    let run = |model: &str, motion: &str, blocks: &str, checks: &[(&str, f64)]| {
        let rollers = "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n";
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n{model}\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\ndensity = 1\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1]{motion} }}\nelements = [3, 2]\n{}{blocks}\n{}",
            if motion.is_empty() { rollers } else { "" },
            checks.iter().map(|(q, v)| format!("[[check]]\nquantity = \"{q}\"\nequals = {v:?}\natol = 1e-11\n")).collect::<String>()
        );
        for backend in ["iga", "fe"] {
            let options = ReadOptions { backend: Some(backend.into()), ..ReadOptions::default() };
            let case = Case::parse("bar.toml", &text, &options).unwrap_or_else(|e| panic!("{e}"));
            let result = case.run(&faying_cli::Registry::default()).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(result.exit, 0, "{backend}\n{text}\n{:?}", result.checks);
        }
    };
    let held = "[[boundary]]\non = \"b.bottom\"\nfix = [\"y\"]\n";
    let on_top = |load: &str| format!("{held}[[boundary]]\non = \"b.top\"\n{load}\n");
    // own weight: half of rho g h / E, the support carries rho g times the area
    run("gravity = [0, -1]", "", held, &[("u.y at [1, 1]", -0.5), ("reaction.b.v0.y", 2.0)]);
    // a resultant of 2 over a length of 2
    run("", "", &on_top("force = { y = -2 }"), &[("stress.yy at [1, 0.5]", -1.0)]);
    run("", "", &on_top("rigid_force = { y = -2 }"), &[("u.y at [0.3, 1]", -1.0), ("u.y at [2, 1]", -1.0)]);
    // pressure / stiffness
    let springs = "[[boundary]]\non = \"b.bottom\"\nspring = { y = 10 }\n[[boundary]]\non = \"b.top\"\npressure = 1\n";
    run("", "", springs, &[("u.y at [1, 0]", -0.1), ("u.y at [1, 1]", -1.1)]);
    // the same bar turned by 30 degrees moves by -1 along its own axis (-sin 30, cos 30)
    let turned = "[[boundary]]\non = [\"b.bottom\", \"b.left\"]\nfix = [\"normal\"]\n[[boundary]]\non = \"b.top\"\npressure = 1\n";
    let corner = "at [-0.5, 0.8660254037844386]";
    let answer = [(format!("u.x {corner}"), 0.5), (format!("u.y {corner}"), -(3.0_f64.sqrt() / 2.0))];
    let answer: Vec<(&str, f64)> = answer.iter().map(|(q, v)| (q.as_str(), *v)).collect();
    run("", ", rotate_deg = 30", turned, &answer);
    let clamped = turned.replace("[\"b.bottom\", \"b.left\"]", "\"b.bottom\"").replace("[\"normal\"]", "[\"normal\", \"tangential\"]");
    run("", ", rotate_deg = 30", &clamped, &answer);
}
