//! Pages of the book: what is made of formulas, pictures and links, and that nothing else is touched.

#[path = "../build/page.rs"]
mod page;

use std::fs;
use std::path::{Path, PathBuf};

use page::{Mistake, Page, Repository};
use pulldown_cmark::{Event, Options, Parser};
use quick_xml::Reader;
use quick_xml::events::Event as Xml;

fn rendered(text: &str) -> Result<String, Vec<Mistake>> {
    Page { pictures: Path::new("../../docs"), repository: None }.render(text)
}

/// Tags and texts of a page as rustdoc reads it, which knows no formulas.
fn read(page: &str) -> (Vec<String>, String) {
    let options = Options::all() - Options::ENABLE_MATH;
    let (mut tags, mut text) = (Vec::new(), String::new());
    for event in Parser::new_ext(page, options) {
        match event {
            Event::InlineHtml(tag) | Event::Html(tag) => tags.push(tag.into_string()),
            Event::Text(words) | Event::Code(words) => text.push_str(&words),
            _ => {}
        }
    }
    (tags, text)
}

/// Every formula of a page is one element of MathML without an error in it, and with as many elements inside of scripts and fractions as they take;
/// returns their number.
fn formulas(page: &str) -> usize {
    let found: Vec<&str> = page.match_indices("<math").map(|(at, _)| &page[at..]).collect();
    for math in &found {
        let math = &math[..math.find("</math>").expect("its end") + "</math>".len()];
        let math = math.replace("&nbsp;", "&#160;");
        let (mut reader, mut elements) = (Reader::from_str(&math), 0);
        // the open elements with the number of those in them
        let mut open: Vec<(String, usize)> = vec![("page".into(), 0)];
        loop {
            let event = reader.read_event().unwrap_or_else(|e| panic!("{e}: {math}"));
            if let Xml::Start(tag) | Xml::Empty(tag) = &event {
                // a blank before every attribute, which the reader does not ask for
                let outside = String::from_utf8_lossy(tag)
                    .split('"')
                    .step_by(2)
                    .skip(1)
                    .all(|s| s.trim_end_matches('/').is_empty() || s.starts_with(' '));
                assert!(outside && tag.name().as_ref() != b"merror", "{math}");
                open.last_mut().expect("the page").1 += 1;
                elements += 1;
            }
            match event {
                Xml::Start(tag) => open.push((String::from_utf8_lossy(tag.name().as_ref()).into_owned(), 0)),
                Xml::End(_) => {
                    let (name, found) = open.pop().expect("an open element");
                    let wanted = match name.as_str() {
                        "mfrac" | "msub" | "msup" | "munder" | "mover" => 2,
                        "msubsup" | "munderover" => 3,
                        _ => found,
                    };
                    assert_eq!(found, wanted, "{name} in {math}");
                }
                Xml::Eof => break,
                _ => {}
            }
        }
        assert!(elements > 1, "{math}");
    }
    found.len()
}

#[test]
fn formulas_become_mathml_with_their_tex() {
    let page = rendered("Let $\\mu_1 < \\|y\\|'$ be *small*:\n\n$$\n\\sum_{i}\n x_i * [a](b)_* = \\text{none of 2|3}\n$$\n")
        .expect("sound formulas");
    assert_eq!(formulas(&page), 2);
    let (tags, text) = read(&page);
    // what Markdown would take for emphasis, a link, a quotation mark is none
    assert_eq!(text, "Let μ1<∥y∥′ be small:∑ixi∗[a](b)∗=none of 2|3");
    assert_eq!(tags.iter().filter(|t| t.starts_with("<math")).count(), 2);
    assert!(tags[0].starts_with("<math alttext=\"&#92;mu&#95;1 &#60; &#92;&#124;y&#92;&#124;&#39;\""), "{}", tags[0]);
    // the same formula in the cell of a table: the bar ends no cell
    let page = rendered("| a | b |\n|---|---|\n| $\\lvert x \\rvert$ | `$y$` |\n").expect("sound formulas");
    let cells = Parser::new_ext(&page, Options::all()).filter(|e| matches!(e, Event::Start(pulldown_cmark::Tag::TableCell))).count();
    assert_eq!((cells, formulas(&page), read(&page).1.as_str()), (4, 1, "ab|x|$y$"));
}

#[test]
fn code_and_all_else_stays_as_it_is() {
    let text = "# Title\n\nIt costs 5 \\$ or 6 \\$; `$a$`, \\$x\\$, [`b`](faying::basis::Basis), [c](#c).\n\n```sh\necho $HOME $x$\n```\n\n    $$y$$\n\n<!-- $z$ -->\n";
    assert_eq!(rendered(text).expect("no formula"), text);
}

#[test]
fn mistakes_have_their_lines() {
    let found = rendered(
        "One\n\n$\\frac{a$ and\n$b$ and $\\nosuch$ and $\\sqrt{$\n\n![a $\\bad$](hertz.svg)\n\n![a](none.svg)\n\n![b](iga-fe-arc.png)\n",
    )
    .expect_err("six mistakes");
    let lines: Vec<usize> = found.iter().map(|m| m.line).collect();
    assert_eq!(lines, [3, 4, 4, 6, 8, 10]);
    for (mistake, words) in found.iter().zip(["begins", "$\\nosuch$", "begins", "$\\bad$", "none.svg", "only SVG"]) {
        assert!(mistake.message.contains(words) && !mistake.message.contains('\n'), "{mistake:?}");
    }
}

#[test]
fn pictures_are_part_of_the_page() {
    let page = rendered("See\n\n![The `pressure` | here,\n$\\mu$](hertz.svg)\n").expect("a picture");
    let (tags, text) = read(&page);
    assert_eq!(text, "SeeThe pressure | here, μ");
    let image = tags.iter().find(|t| t.starts_with("<img")).expect("an image");
    assert!(image.contains("alt=\"The pressure &#124; here&#44; &#92;mu\"") && formulas(&page) == 1, "{image}");
    let data = image.split("data:image/svg+xml,").nth(1).and_then(|d| d.split('"').next()).expect("data");
    let mut bytes = Vec::new();
    let mut rest = data.as_bytes();
    while let [first, more @ ..] = rest {
        let escaped = *first == b'%';
        bytes.push(if escaped { u8::from_str_radix(&data[data.len() - more.len()..][..2], 16).expect("two digits") } else { *first });
        rest = &more[if escaped { 2 } else { 0 }..];
    }
    assert!(bytes == fs::read("../../docs/hertz.svg").expect("the picture"));
}

#[test]
fn links_to_files_lead_to_the_repository() {
    let repository = Some(Repository { url: "https://host/tree", folder: "docs" });
    let page = Page { pictures: Path::new("."), repository };
    let text = "[a $x$](verified.md), [p](a.svg), [b](../benches/README.md), [c](#c), [d](https://e.org)";
    let rendered = page.render(text).expect("sound links");
    assert_eq!(formulas(&rendered), 1);
    let links: Vec<&str> = rendered.split("](").skip(1).map(|l| l.split(')').next().expect("its end")).collect();
    assert_eq!(links, ["crate::verified", "https://host/tree/docs/a.svg", "https://host/tree/benches/README.md", "#c", "https://e.org"]);
    assert_eq!(page.render("\n[a]\n\n[a]: verified.md").expect_err("no place to write to")[0].line, 2);
}

/// Every page of the book: as many formulas as its source has, all of them sound.
#[test]
fn all_pages_are_sound() {
    let mut files = vec![PathBuf::from("src")];
    let mut all = 0;
    while let Some(path) = files.pop() {
        if path.is_dir() {
            files.extend(fs::read_dir(path).expect("a folder").map(|entry| entry.expect("an entry").path()));
        } else if path.extension().is_some_and(|e| e == "md") {
            let source = fs::read_to_string(&path).expect("a chapter");
            let math =
                Parser::new_ext(&source, Options::all()).filter(|e| matches!(e, Event::InlineMath(_) | Event::DisplayMath(_))).count();
            let out = Path::new(env!("OUT_DIR")).join(path.strip_prefix("src").expect("a file of src"));
            let page = fs::read_to_string(out).expect("its page");
            assert_eq!(formulas(&page), math, "{}", path.display());
            assert!(!read(&page).1.contains("$$"), "{}", path.display());
            all += math;
        }
    }
    // the theory alone has 245
    assert!(all >= 245, "{all}");
}
