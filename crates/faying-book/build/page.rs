//! A page of the book: Markdown whose formulas are TeX becomes Markdown whose formulas are MathML and whose pictures are part of it.
//!
//! rustdoc reads the page after this. So nothing in what is written here may mean anything in Markdown: punctuation is given by number.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use pulldown_latex::{RenderConfig, Storage, config::DisplayMode, mathml::push_mathml};

/// Where the files of a page lie in the repository.
#[derive(Clone, Copy)]
pub struct Repository<'a> {
    /// Address of the repository's files.
    pub url: &'a str,
    /// Folder of the page there.
    pub folder: &'a str,
}

/// What a page takes from outside of its text.
pub struct Page<'a> {
    /// The folder that paths of pictures start from.
    pub pictures: &'a Path,
    /// What links to other files lead to; pages without it have no such links.
    pub repository: Option<Repository<'a>>,
}

/// What is wrong with a page, and the line of its file, from 1.
#[derive(Debug, PartialEq)]
pub struct Mistake {
    pub line: usize,
    pub message: String,
}

/// What rustdoc reads, and formulas: `$..$`, `$$..$$`. Code is told from them by the parser.
fn options() -> Options {
    Options::ENABLE_TABLES
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_SMART_PUNCTUATION
        | Options::ENABLE_MATH
}

impl Page<'_> {
    /// The page with formulas as MathML, pictures as data, and links to files of the repository as addresses.
    pub fn render(&self, text: &str) -> Result<String, Vec<Mistake>> {
        let (mut parts, mut mistakes) = (Vec::new(), Vec::new());
        let mut events = Parser::new_ext(text, options()).into_offset_iter();
        let mut code = false;
        while let Some((event, range)) = events.next() {
            let part = match event {
                Event::InlineMath(tex) => formula(&tex, DisplayMode::Inline),
                // wide formulas scroll on narrow screens
                Event::DisplayMath(tex) => {
                    formula(&tex, DisplayMode::Block).map(|math| format!("<span style=\"display:block;overflow-x:auto\">{math}</span>"))
                }
                Event::Start(Tag::Image { dest_url, .. }) => {
                    let caption = events.by_ref().map(|(event, _)| event).take_while(|e| !matches!(e, Event::End(TagEnd::Image)));
                    caption_of(caption).and_then(|caption| self.picture(&dest_url, &caption))
                }
                Event::Start(Tag::Link { dest_url, .. }) => match self.address(&dest_url) {
                    None => continue,
                    Some(address) => match text[range.clone()].rfind(&format!("]({dest_url})")) {
                        None => Err(format!("link to {dest_url}: write it as [text](address)")),
                        Some(at) => {
                            let start = range.start + at + 2;
                            parts.push((start..start + dest_url.len(), address));
                            continue;
                        }
                    },
                },
                Event::Start(Tag::CodeBlock(_)) | Event::End(TagEnd::CodeBlock) => {
                    code = !code;
                    continue;
                }
                // braces that do not match, a blank beside the sign: no formula in Markdown's eyes
                Event::Text(_) if !code && dollar(text, range.clone()) => {
                    Err("`$` that no formula begins or ends with; `\\$` is the sign".into())
                }
                _ => continue,
            };
            match part {
                Ok(part) => parts.push((range, part)),
                Err(message) => mistakes.push(Mistake { line: text[..range.start].matches('\n').count() + 1, message }),
            }
        }
        parts.sort_by_key(|(range, _)| range.start);
        mistakes.dedup();
        if mistakes.is_empty() { Ok(replaced(text, &parts)) } else { Err(mistakes) }
    }

    /// Picture and caption. An SVG goes along as data, so that the page needs no other file.
    fn picture(&self, name: &str, caption: &Caption) -> Result<String, String> {
        if !name.ends_with(".svg") {
            return Err(format!("picture {name}: only SVG is shown"));
        }
        let path = self.pictures.join(name);
        println!("cargo::rerun-if-changed={}", path.display());
        let svg = std::fs::read_to_string(&path).map_err(|e| format!("picture {name}: {e}"))?;
        let Caption { plain, shown } = caption;
        let data = svg.bytes().fold(String::with_capacity(2 * svg.len()), |mut data, byte| {
            match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b',' | b'-' | b'/' | b':' | b'=' | b';' | b'(' | b')' => {
                    data.push(byte.into())
                }
                _ => write!(data, "%{byte:02X}").expect("text takes all"),
            }
            data
        });
        // drawn on white, whatever the colours of the page
        Ok(format!(
            "<span style=\"display:block\"><img alt=\"{plain}\" style=\"background:white;max-width:100%\" src=\"data:image/svg+xml,{data}\"><br><small>{shown}</small></span>"
        ))
    }

    /// The address of a link to a file of the repository, pages beside this one being chapters; `None` for all other links.
    fn address(&self, link: &str) -> Option<String> {
        let Repository { url, folder } = self.repository?;
        let file = !link.starts_with('#') && !link.contains(':');
        file.then(|| match (link.strip_suffix(".md"), link.strip_prefix("../")) {
            (Some(chapter), _) if !chapter.contains('/') => format!("crate::{chapter}"),
            (_, Some(rest)) => format!("{url}/{rest}"),
            _ => format!("{url}/{folder}/{link}"),
        })
    }
}

/// What stands below a picture.
struct Caption {
    /// For readers that do not see the picture; formulas are TeX.
    plain: String,
    /// With formulas.
    shown: String,
}

/// The caption that the events inside of an image make.
fn caption_of<'a>(events: impl Iterator<Item = Event<'a>>) -> Result<Caption, String> {
    let mut caption = Caption { plain: String::new(), shown: String::new() };
    // to the end even after a mistake, so that the image is read as a whole
    let mut mistake = None;
    for event in events {
        let (plain, shown) = match event {
            Event::Text(text) | Event::Code(text) => (numbered(&text), numbered(&text)),
            Event::SoftBreak => (" ".into(), " ".into()),
            Event::InlineMath(tex) => match formula(&tex, DisplayMode::Inline) {
                Ok(math) => (numbered(&tex), math),
                Err(message) => {
                    mistake = Some(message);
                    continue;
                }
            },
            _ => continue,
        };
        caption.plain += &plain;
        caption.shown += &shown;
    }
    mistake.map_or(Ok(caption), Err)
}

/// Whether a part of a page has a dollar sign without a backslash.
fn dollar(text: &str, part: Range<usize>) -> bool {
    text[part.clone()].match_indices('$').any(|(at, _)| !text[..part.start + at].ends_with('\\'))
}

/// A text with parts of it replaced.
fn replaced(text: &str, parts: &[(Range<usize>, String)]) -> String {
    let (mut out, mut at) = (String::with_capacity(2 * text.len()), 0);
    for (range, part) in parts {
        out.push_str(&text[at..range.start]);
        out.push_str(part);
        at = range.end;
    }
    out.push_str(&text[at..]);
    out
}

/// A formula as MathML, with the TeX as `alttext`.
fn formula(tex: &str, display_mode: DisplayMode) -> Result<String, String> {
    let storage = Storage::new();
    let events = pulldown_latex::Parser::new(tex, &storage).collect::<Result<Vec<_>, _>>().map_err(|e| {
        // the parser draws the context over several lines
        let message = e.to_string();
        format!("{} in ${tex}$", message.lines().next().unwrap_or_default())
    })?;
    let mut math = String::new();
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    push_mathml(&mut math, events.into_iter().map(Ok::<_, std::fmt::Error>), config).map_err(|e| format!("{e} in ${tex}$"))?;
    Ok(mended(&math).replacen("<math", &format!("<math alttext=\"{}\"", numbered(tex)), 1))
}

/// The MathML of the parser as browsers want it, and so that Markdown sees its tags alone.
fn mended(math: &str) -> String {
    // the sign of micro stands for mu, and browsers do not slant it
    let mut math = math.replace('\u{b5}', "\u{3bc}");
    // the blank before a name is put inside of what takes two or three elements
    for scripts in ["munder", "mover", "munderover", "msub", "msup", "msubsup"] {
        const BLANK: &str = "<mspace width=\"0.1667em\" />";
        math = math.replace(&format!("<{scripts}>{BLANK}"), &format!("{BLANK}<{scripts}>"));
    }
    // the size of a delimiter stands without a blank before it
    unread(&math.replace("\"minsize", "\" minsize"))
}

/// MathML of which Markdown sees the tags alone.
fn unread(math: &str) -> String {
    let mut out = String::with_capacity(2 * math.len());
    let mut rest = math;
    while let Some(next) = rest.chars().next() {
        let whole = match next {
            '<' if rest.starts_with("<m") || rest.starts_with("</m") => rest.find('>'),
            '&' if ["&nbsp;", "&amp;", "&lt;", "&gt;"].iter().any(|entity| rest.starts_with(entity)) => rest.find(';'),
            _ => None,
        };
        let (part, after) = rest.split_at(whole.map_or(next.len_utf8(), |end| end + 1));
        match whole {
            Some(_) => out.push_str(part),
            None => out.push_str(&numbered(part)),
        }
        rest = after;
    }
    out
}

/// A text for HTML in Markdown: punctuation by number, on one line.
fn numbered(text: &str) -> String {
    let mut out = String::with_capacity(2 * text.len());
    for c in text.chars() {
        match c {
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_ascii_punctuation() => write!(out, "&#{};", u32::from(c)).expect("text takes all"),
            c => out.push(c),
        }
    }
    out
}
