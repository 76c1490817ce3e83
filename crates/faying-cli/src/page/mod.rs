//! One page with everything that can be opened anywhere, in the dark, on paper, by a screen reader; well-formed as XML, too.

use crate::table::Table;
use std::fmt::Write as _;

/// The look of the page.
const STYLE: &str = include_str!("style.css");

/// A page that is being written.
#[derive(Clone, Debug)]
pub struct Page {
    text: String,
}

impl Page {
    /// Begins a page: heading, a line on the command, the case and the outcome, which is good or not.
    pub fn begin(title: &str, command: &str, case: &str, (status, good): (&str, bool)) -> Self {
        let text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{0}</title>\n<style>\n{STYLE}</style>\n</head>\n\
             <body>\n<main>\n<h1>{0}</h1>\n<p class=\"by\">faying {1} of <code>{2}</code>, version {3}: <strong class=\"{4}\">{5}</strong></p>\n",
            escaped(title),
            escaped(command),
            escaped(case),
            env!("CARGO_PKG_VERSION"),
            if good { "good" } else { "bad" },
            escaped(status),
        );
        Self { text }
    }

    /// A paragraph of a class, plain where it is empty.
    pub fn paragraph(&mut self, class: &str, text: &str) {
        let _ = writeln!(self.text, "<p{}>{}</p>", attribute(class), escaped(text));
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) {
        let _ = writeln!(self.text, "<h2>{}</h2>", escaped(text));
    }

    /// A list of sentences, each bad or not.
    pub fn list(&mut self, lines: &[(bool, String)]) {
        self.text.push_str("<ul>\n");
        for (bad, text) in lines {
            let _ = writeln!(self.text, "<li{}>{}</li>", if *bad { " class=\"bad\"" } else { "" }, escaped(text));
        }
        self.text.push_str("</ul>\n");
    }

    /// A picture, the text of an SVG file, with words for those who do not see it.
    pub fn figure(&mut self, svg: &str, said: &str) {
        // the drawing without the header of a separate file
        let start = svg.find("<svg").map_or(0, |at| at + "<svg".len());
        let inner = svg[start..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
        let _ = write!(self.text, "<figure>\n<svg role=\"img\" aria-label=\"{}\"{inner}</figure>\n", escaped(said));
    }

    /// A table with a caption, which may be empty; `class` gives that of a row and of a cell.
    pub fn table(&mut self, label: &str, caption: &str, table: &Table, class: &dyn Fn(usize, Option<usize>) -> &'static str) {
        let _ = writeln!(self.text, "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>", escaped(label));
        if !caption.is_empty() {
            let _ = writeln!(self.text, "<caption>{}</caption>", escaped(caption));
        }
        self.text.push_str("<thead><tr>");
        for cell in table.head() {
            let _ = write!(self.text, "<th scope=\"col\">{}</th>", escaped(cell));
        }
        self.text.push_str("</tr></thead>\n<tbody>\n");
        for (k, row) in table.rows().enumerate() {
            let _ = write!(self.text, "<tr{}>", attribute(class(k, None)));
            for (column, cell) in row.iter().enumerate() {
                let numeric = if cell == "-" || cell.parse::<f64>().is_ok() { "n" } else { "" };
                let classes = [numeric, class(k, Some(column))].join(" ");
                let _ = write!(self.text, "<td{}>{}</td>", attribute(classes.trim()), escaped(cell));
            }
            self.text.push_str("</tr>\n");
        }
        self.text.push_str("</tbody>\n</table></div>\n");
    }

    /// Lines as they are.
    pub fn lines(&mut self, text: &str) {
        let _ = writeln!(self.text, "<pre>{}</pre>", escaped(text));
    }

    /// Ends the page with the command line that makes it again and the files that have all digits; returns its text.
    pub fn end(mut self, words: &[String], files: &str) -> String {
        self.heading("To make it again");
        let _ = writeln!(self.text, "<pre><code>{}</code></pre>", escaped(&command(words)));
        self.paragraph("soft", &format!("The numbers of this page, with all their digits, are in {files} beside it."));
        self.text.push_str("</main>\n</body>\n</html>\n");
        self.text
    }
}

fn attribute(class: &str) -> String {
    if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") }
}

/// Options that do not affect the numbers, and whether a value follows each.
const ASIDE: [(&str, bool); 14] = [
    ("--threads", true),
    ("--out", true),
    ("--color", true),
    ("--time-limit", true),
    ("--max-memory", true),
    ("--force", false),
    ("--resume", false),
    ("--no-pictures", false),
    ("--watch", false),
    ("--json", false),
    ("--quiet", false),
    ("--verbose", false),
    ("-q", false),
    ("-v", false),
];

/// The command line without options that do not affect the numbers, quoted for a shell.
fn command(words: &[String]) -> String {
    let mut line = "faying".to_owned();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let (name, valued) = word.split_once('=').map_or((word.as_str(), false), |(name, _)| (name, true));
        if let Some((_, follows)) = ASIDE.iter().find(|(aside, _)| *aside == name) {
            if *follows && !valued {
                words.next();
            }
            continue;
        }
        line.push(' ');
        let plain = !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || "-_./=,+:@%".contains(c));
        line.push_str(&if plain { word.clone() } else { format!("'{}'", word.replace('\'', "'\\''")) });
    }
    line
}

/// Text escaped for XML; characters that XML does not allow become spaces.
fn escaped(text: &str) -> String {
    let text: String = text.chars().map(|c| if c.is_control() && c != '\n' && c != '\t' { ' ' } else { c }).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_keeps_what_decides_about_numbers() {
        let words =
            ["convergence", "my case.toml", "--threads", "2", "--out=a", "--json", "--set", "let.a=1", "--vary", "let.b=[1, 2]", "--force"];
        let words: Vec<String> = words.map(str::to_owned).to_vec();
        assert_eq!(command(&words), "faying convergence 'my case.toml' --set let.a=1 --vary 'let.b=[1, 2]'");
    }

    #[test]
    fn text_is_no_mark_up() {
        assert_eq!(escaped("<a href=\"x\">&\u{1}"), "&lt;a href=&quot;x&quot;&gt;&amp; ");
    }
}
