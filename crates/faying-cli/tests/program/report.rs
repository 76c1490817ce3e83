//! `report.html` of a run: one self-contained, well-formed page with what the result says.

use quick_xml::Reader;
use quick_xml::events::Event;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap()
}

/// Runs a sample; returns its page.
fn page(at: &Path, sample: &str, words: &[&str]) -> String {
    if !at.join(format!("{sample}.toml")).exists() {
        assert!(faying(at, &["new", sample]).status.success());
    }
    let case = format!("{sample}.toml");
    let out = faying(at, &[&["run", case.as_str()], words].concat());
    assert!(matches!(out.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&out.stderr));
    std::fs::read_to_string(at.join(format!("{sample}.out/report.html"))).unwrap()
}

/// Well-formed, and nothing is loaded from elsewhere.
fn sound(page: &str) {
    let mut reader = Reader::from_str(page.trim_start_matches("<!DOCTYPE html>\n"));
    reader.config_mut().check_end_names = true;
    loop {
        match reader.read_event().unwrap_or_else(|e| panic!("{e} at {}", reader.error_position())) {
            Event::Eof => break,
            Event::Start(tag) | Event::Empty(tag) => {
                for attribute in tag.attributes() {
                    let attribute = attribute.unwrap();
                    let outside = matches!(attribute.key.as_ref(), b"src" | b"href" | b"xlink:href");
                    assert!(!outside || attribute.value.starts_with(b"#"), "{:?}", attribute);
                }
            }
            _ => {}
        }
    }
    assert!(!page.contains("@import") && !page.contains("url("));
    // both colour schemes, and narrow windows
    assert!(page.contains("prefers-color-scheme:dark") && page.contains("width=device-width") && page.contains("overflow-x:auto"));
}

#[test]
fn a_run_writes_one_page_with_all_that_it_found() {
    let at = tempfile::tempdir().unwrap();
    let page = page(at.path(), "contact-patch", &[]);
    sound(&page);
    for part in [
        "<h1>Contact patch test: constant pressure through a non-matching interface</h1>",
        "<strong class=\"good\">ok</strong>",
        "Elasticity in plane strain",
        "<h2>Checks</h2>",
        "<h2>Contacts</h2>",
        "<h2>Loads and reactions</h2>",
        "lower.bottom",
        "<h2>Iterations</h2>",
        "active set: ",
        "SHA-256",
        "<pre><code>faying run contact-patch.toml</code></pre>",
        env!("CARGO_PKG_VERSION"),
    ] {
        assert!(page.contains(part), "`{part}` is not in the page");
    }
    // the fields, the pressure along the side, the active set
    assert_eq!(page.matches("<figure>").count(), 3);
    let result: serde_json::Value =
        serde_json::from_slice(&std::fs::read(at.path().join("contact-patch.out/result.json")).unwrap()).unwrap();
    assert!(result["files"].as_array().unwrap().contains(&"report.html".into()));
    // again: the same bytes
    assert_eq!(page, self::page(at.path(), "contact-patch", &["--threads", "1"]));
}

#[test]
fn a_failed_check_and_a_warning_stand_on_the_page() {
    let at = tempfile::tempdir().unwrap();
    let page = page(at.path(), "seam", &["--set", "check=[{ name = \"tight\", quantity = \"error.u.L2\", below = 1e-12 }]"]);
    sound(&page);
    assert!(page.contains("<strong class=\"bad\">check-failed</strong>") && page.contains("<tr class=\"bad\"><td>tight</td>"), "{page}");
    assert!(page.contains("<h2>Interfaces</h2>") && page.contains("<h2>Errors</h2>"));
    let page = self::page(at.path(), "seam", &["--set", "interface.seam.multiplier=p/p-1"]);
    assert!(page.contains("<h2>Messages</h2>") && page.contains("E061"));
}

#[test]
fn pictures_are_left_out_on_demand() {
    let at = tempfile::tempdir().unwrap();
    let page = page(at.path(), "contact-patch", &["--no-pictures"]);
    sound(&page);
    assert!(!page.contains("<figure>") && page.contains("<h2>Contacts</h2>"));
    let names: Vec<String> =
        std::fs::read_dir(at.path().join("contact-patch.out")).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    assert!(names.iter().all(|name| !name.ends_with(".svg")) && names.iter().any(|name| name == "interface_pad.csv"), "{names:?}");
}
