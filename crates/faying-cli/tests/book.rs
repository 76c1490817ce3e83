//! The tutorials of the book do what they say. Every tutorial is read from top to bottom in a folder of its own:
//!
//! - a block `toml`, `text` or `xml` whose first line is a comment with a file name alone (`# press.toml`, `** bar.inp`,
//!   `<!-- pipe.xml -->`) writes that file; a block `toml` that begins with `# added to NAME` is appended to it; the lines of any
//!   other block `toml` stand together, in that order, in a case file of the folder;
//! - each line of a block `sh` is `faying ..` or `cat FILE`; exit codes other than 0 are said at its end, `# exit 3`;
//! - a block `text` shows output of the last block `sh`: its lines follow each other there, `...` leaves out lines, or a part of one.
//!   Numbers agree to 1e-6 or to the digits that are shown;
//! - a picture `![caption](pictures/NAME.svg)` is followed by the file that the run made, `<!-- press.out/fields.svg -->`: the stored
//!   picture has its texts. `FAYING_WRITE=1` stores the pictures anew;
//! - blocks `rust` are tests of the documentation.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the tutorials.
fn book() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../faying-book/src/tutorials")
}

/// What a tutorial consists of.
enum Part {
    /// Info string, text, and the line where it begins.
    Block(String, String, usize),
    /// Name of a stored picture, the file that a run made, and its line.
    Picture(String, String, usize),
}

/// Blocks and pictures of a tutorial, from top to bottom.
fn parts(text: &str) -> Result<Vec<Part>, String> {
    let mut found = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((n, line)) = lines.next() {
        if let Some(info) = line.strip_prefix("```") {
            let mut block = String::new();
            loop {
                match lines.next() {
                    None => return Err(format!("line {}: the block has no end", n + 1)),
                    Some((_, "```")) => break,
                    Some((_, line)) => writeln!(block, "{line}").expect("a string takes all"),
                }
            }
            found.push(Part::Block(info.trim().to_string(), block, n + 1));
        } else if line.starts_with("![") {
            let name = line.split_once("](pictures/").and_then(|(_, rest)| rest.strip_suffix(')'));
            let made = lines.next().and_then(|(_, line)| line.strip_prefix("<!-- ")?.strip_suffix(" -->"));
            match (name, made) {
                (Some(name), Some(made)) => found.push(Part::Picture(name.to_string(), made.to_string(), n + 1)),
                _ => return Err(format!("line {}: write ![caption](pictures/NAME.svg), and on the next line <!-- FILE -->", n + 1)),
            }
        }
    }
    Ok(found)
}

/// The file that a block writes: its first line is a comment with a name alone.
fn names_file(block: &str) -> Option<&str> {
    let first = block.lines().next()?;
    let name = first
        .strip_prefix("# ")
        .or(first.strip_prefix("** "))
        .or(first.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->")))?;
    let (stem, ending) = name.rsplit_once('.')?;
    let plain = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    (plain(stem) && plain(ending)).then_some(name)
}

/// A tutorial while it is followed.
struct Reader {
    folder: tempfile::TempDir,
    /// Output of the last block of commands, stdout before stderr.
    output: Option<String>,
}

impl Reader {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder"), output: None }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Does what a block says, or tells why it is wrong.
    fn block(&mut self, info: &str, block: &str) -> Result<(), String> {
        if let Some(name) = names_file(block).filter(|_| ["toml", "text", "xml"].contains(&info)) {
            return fs::write(self.path(name), block).map_err(|e| format!("{name}: {e}"));
        }
        match info {
            "rust" => Ok(()),
            "sh" => self.commands(block),
            "text" => {
                let output = self.output.as_ref().ok_or("a block `text` before any command")?;
                shown(block, output).map_err(|line| format!("this is not in the output: {line}\n--- output\n{output}---"))
            }
            "toml" => match block.split_once('\n').and_then(|(first, rest)| Some((first.strip_prefix("# added to ")?, rest))) {
                Some((name, rest)) => {
                    let before = fs::read_to_string(self.path(name)).map_err(|e| format!("{name}: {e}"))?;
                    fs::write(self.path(name), format!("{before}\n{rest}")).map_err(|e| format!("{name}: {e}"))
                }
                None => self.quoted(block),
            },
            other => Err(format!("blocks are toml, sh, text, xml or rust, not `{other}`")),
        }
    }

    /// The lines of a piece stand together in a case file of the folder.
    fn quoted(&self, piece: &str) -> Result<(), String> {
        let is_case = |path: &Path| path.extension().is_some_and(|e| e == "toml");
        let cases =
            fs::read_dir(self.folder.path()).map_err(|e| e.to_string())?.flatten().map(|entry| entry.path()).filter(|path| is_case(path));
        let wanted: Vec<&str> = piece.lines().map(str::trim_end).collect();
        for case in cases {
            let text = fs::read_to_string(&case).map_err(|e| e.to_string())?;
            let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
            if lines.windows(wanted.len()).any(|window| window == wanted) {
                return Ok(());
            }
        }
        Err(format!("no case file has these lines:\n{piece}"))
    }

    /// Runs the lines up to the first that does not end as it should, and keeps what they print.
    fn commands(&mut self, block: &str) -> Result<(), String> {
        let mut output = String::new();
        let done = block.lines().try_for_each(|line| self.command(line, &mut output));
        self.output = Some(output);
        done
    }

    /// Runs a line and adds what it prints.
    fn command(&self, line: &str, output: &mut String) -> Result<(), String> {
        let (command, said) = line.split_once(" # ").unwrap_or((line, ""));
        let wanted: i32 = match said.trim() {
            "" => 0,
            said => {
                said.strip_prefix("exit ").and_then(|code| code.parse().ok()).ok_or(format!("`{line}`: a comment says an exit code"))?
            }
        };
        let words = words(command);
        match words.split_first() {
            Some((first, rest)) if first == "faying" => {
                let mut program = Command::new(env!("CARGO_BIN_EXE_faying"));
                let done = program.args(rest).current_dir(self.folder.path()).output().map_err(|e| e.to_string())?;
                *output += &String::from_utf8_lossy(&done.stdout);
                *output += &String::from_utf8_lossy(&done.stderr);
                if done.status.code() != Some(wanted) {
                    return Err(format!("`{command}` ends with {:?}, not {wanted}:\n{output}", done.status.code()));
                }
            }
            Some((first, [file])) if first == "cat" => {
                *output += &fs::read_to_string(self.path(file)).map_err(|e| format!("{file}: {e}"))?;
            }
            _ => return Err(format!("`{line}`: commands are faying and cat")),
        }
        Ok(())
    }

    /// Compares a stored picture with the one that a run made, or stores it.
    fn picture(&self, stored: &Path, made: &str) -> Result<(), String> {
        let made = fs::read_to_string(self.path(made)).map_err(|e| format!("{made}: {e}"))?;
        if made.len() > 300_000 {
            return Err(format!("the picture has {} kB; at most 300", made.len() / 1000));
        }
        if std::env::var_os("FAYING_WRITE").is_some() {
            return fs::write(stored, made).map_err(|e| format!("{}: {e}", stored.display()));
        }
        let kept = fs::read_to_string(stored).map_err(|e| format!("{}: {e}; FAYING_WRITE=1 stores it", stored.display()))?;
        let (kept, made) = (texts(&kept), texts(&made));
        match kept.iter().zip(&made).find(|(kept, made)| !agree(kept, made)) {
            Some((kept, made)) => Err(format!("the picture says `{made}`, the stored one `{kept}`")),
            None if kept.len() != made.len() => Err(format!("the picture has {} texts, the stored one {}", made.len(), kept.len())),
            None => Ok(()),
        }
    }
}

/// Words of a command; quotes hold blanks together.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut quote) = (vec![String::new()], None);
    for c in command.chars() {
        match quote {
            Some(q) if c == q => quote = None,
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == ' ' => words.push(String::new()),
            _ => words.last_mut().expect("one word").push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Texts of an SVG: titles, labels, ticks.
fn texts(svg: &str) -> Vec<String> {
    let after = svg.split("<text").skip(1);
    after
        .filter_map(|rest| Some(rest.split_once('>')?.1.split_once("</text>")?.0.split_whitespace().collect::<Vec<_>>().join(" ")))
        .collect()
}

/// Whether the lines of `block` stand in `output` one after the other; else the first one that does not.
fn shown(block: &str, output: &str) -> Result<(), String> {
    let output: Vec<&str> = output.lines().filter(|line| !line.trim().is_empty()).collect();
    let chunks = block.lines().filter(|line| !line.trim().is_empty()).collect::<Vec<_>>();
    let mut from = 0;
    for chunk in chunks.split(|line| line.trim() == "...").filter(|chunk| !chunk.is_empty()) {
        let matched = |at: usize| chunk.iter().zip(&output[at..]).take_while(|(wanted, line)| agree(wanted, line)).count();
        match (from..output.len()).find(|&at| matched(at) == chunk.len()) {
            Some(at) => from = at + chunk.len(),
            None => {
                let most = (from..output.len()).map(matched).max().unwrap_or(0);
                return Err(chunk[most].to_string());
            }
        }
    }
    Ok(())
}

/// Whether a line is as wanted: the same text but for blanks, numbers to the digits shown, anything for `...`.
fn agree(wanted: &str, line: &str) -> bool {
    fits(&tokens(wanted), &tokens(line))
}

/// Texts, numbers, and gaps `...` of a line; blanks only separate.
#[derive(Debug)]
enum Token {
    Text(String),
    /// A value and the unit of its last digit.
    Number(f64, f64),
    Gap,
}

fn fits(wanted: &[Token], line: &[Token]) -> bool {
    match (wanted.split_first(), line.split_first()) {
        (None, None) => true,
        (Some((Token::Gap, rest)), _) => (0..=line.len()).any(|skip| fits(rest, &line[skip..])),
        (Some((Token::Text(a), wanted)), Some((Token::Text(b), line))) => a == b && fits(wanted, line),
        (Some((Token::Number(a, digit), wanted)), Some((Token::Number(b, _), line))) => {
            (a - b).abs() <= (1e-6 * b.abs()).max(1.001 * digit) && fits(wanted, line)
        }
        _ => false,
    }
}

fn tokens(line: &str) -> Vec<Token> {
    let mut found = Vec::new();
    for word in line.split_whitespace() {
        let mut rest = word;
        while !rest.is_empty() {
            if let Some(after) = rest.strip_prefix("...") {
                found.push(Token::Gap);
                rest = after;
                continue;
            }
            let length = number_length(rest);
            if length > 0 {
                found.push(number(&rest[..length]));
                rest = &rest[length..];
                continue;
            }
            // a text ends where a number or a gap begins; digits within names belong to them
            let end = rest
                .char_indices()
                .skip(1)
                .find(|&(at, _)| {
                    let before = rest[..at].chars().next_back().expect("a first character");
                    rest[at..].starts_with("...") || (!before.is_alphanumeric() && number_length(&rest[at..]) > 0)
                })
                .map_or(rest.len(), |(at, _)| at);
            found.push(Token::Text(rest[..end].to_string()));
            rest = &rest[end..];
        }
    }
    found
}

/// Length of the number that a text begins with, 0 if it begins with none.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let sign = usize::from(text.starts_with('-'));
    let whole = digits(sign);
    if whole == 0 {
        return 0;
    }
    let mut length = sign + whole;
    if text[length..].starts_with('.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if text[length..].starts_with('e') {
        let sign = usize::from(text[length + 1..].starts_with('-'));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

fn number(text: &str) -> Token {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
    let exponent: i32 = exponent.parse().expect("digits");
    // whole numbers count things and are exact
    let digit = if decimals == 0 && exponent == 0 { 0.0 } else { 10f64.powi(exponent - decimals) };
    Token::Number(text.parse().expect("digits"), digit)
}

/// Follows a tutorial and returns everything that is wrong with it.
fn follow(tutorial: &Path) -> Vec<String> {
    let text = fs::read_to_string(tutorial).expect("a tutorial");
    let parts = match parts(&text) {
        Ok(parts) => parts,
        Err(wrong) => return vec![wrong],
    };
    let mut reader = Reader::new();
    let (mut wrong, mut commands, mut pictures) = (Vec::new(), 0, 0);
    for part in &parts {
        let (line, done) = match part {
            Part::Block(info, block, line) => {
                commands += usize::from(info == "sh");
                (line, reader.block(info, block))
            }
            Part::Picture(name, made, line) => {
                pictures += 1;
                (line, reader.picture(&tutorial.with_file_name("../pictures").join(name), made))
            }
        };
        wrong.extend(done.err().map(|why| format!("line {line}: {why}")));
    }
    if commands == 0 || pictures == 0 {
        wrong.push("a tutorial runs the program and shows a picture".to_string());
    }
    wrong
}

#[test]
fn tutorials_do_what_they_say() {
    let Ok(folder) = fs::read_dir(book()) else {
        println!("skipped: the book is not here");
        return;
    };
    let mut tutorials: Vec<PathBuf> =
        folder.flatten().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "md")).collect();
    tutorials.sort();
    // FAYING_TUTORIAL=03 follows that one alone
    if let Ok(only) = std::env::var("FAYING_TUTORIAL") {
        tutorials.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(&only)));
    }
    assert!(!tutorials.is_empty(), "no tutorial in {}", book().display());
    let mut failures = String::new();
    for tutorial in &tutorials {
        for wrong in follow(tutorial) {
            writeln!(failures, "{}, {wrong}\n", tutorial.file_name().unwrap_or_default().to_string_lossy()).expect("a string takes all");
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

#[test]
fn numbers_agree_to_the_digits_shown_and_texts_exactly() {
    assert!(agree("force (0, 0.00125) 4", "force   (0,  0.00125)   4"));
    assert!(agree("u.x at [1, 0] is 1.9067", "u.x at [1, 0] is 1.90666666"));
    assert!(agree("pressure 1.234567891", "pressure 1.234567999"));
    assert!(!agree("pressure 1.2346", "pressure 1.2348"));
    assert!(!agree("active 4", "active 5"));
    assert!(!agree("pad 1.0", "fit 1.0"));
    assert!(!agree("u.x 1.0", "u.y 1.0"));
    assert!(!agree("boundary-1 2.0", "boundary-2 2.0"));
    assert!(agree("residual ...; ok", "residual 3.1e-17; ok"));
    assert!(!agree("residual ...; ok", "residual 3.1e-17; failed"));
    assert!(agree("error 4.2e-5", "error 4.24463e-5") && !agree("error 4.2e-5", "error 4.24463e-6"));
}

#[test]
fn lines_left_out_are_marked() {
    let output = "one 1\ntwo 2\n\nthree 3\nfour 4\n";
    assert_eq!(shown("one 1\ntwo 2\nthree 3\n", output), Ok(()));
    assert_eq!(shown("one 1\n...\nfour 4\n", output), Ok(()));
    assert_eq!(shown("one 1\nthree 3\n", output), Err("three 3".to_string()));
    assert_eq!(shown("two 2\n...\none 1\n", output), Err("one 1".to_string()));
    assert_eq!(shown("two 3\n", output), Err("two 3".to_string()));
}

#[test]
fn wrong_tutorials_are_told() {
    let mut reader = Reader::new();
    assert!(reader.block("text", "anything\n").is_err(), "no output yet");
    assert_eq!(reader.block("sh", "faying new contact-patch\nfaying check contact-patch.toml --set a.b=1 # exit 3\n"), Ok(()));
    assert!(reader.block("sh", "faying check contact-patch.toml --set a.b=1\n").is_err(), "exit 3 is not 0");
    assert!(reader.block("sh", "rm contact-patch.toml\n").is_err(), "a command of the system");
    assert!(reader.block("toml", "[no-such-block]\n").is_err(), "a piece that stands nowhere");
    assert!(reader.block("c", "int main;\n").is_err(), "an info string that nothing runs");
    assert_eq!(reader.block("text", "** bar.inp\n*NODE\n"), Ok(()));
    assert_eq!(fs::read_to_string(reader.path("bar.inp")).unwrap(), "** bar.inp\n*NODE\n");
    assert_eq!(reader.block("toml", "# a.toml\nschema = 1\n"), Ok(()));
    assert_eq!(reader.block("toml", "# added to a.toml\nx = 2\n"), Ok(()));
    assert_eq!(fs::read_to_string(reader.path("a.toml")).unwrap(), "# a.toml\nschema = 1\n\nx = 2\n");
    assert!(parts("![a](b.svg)\ntext").is_err(), "a picture of no run");
    assert!(parts("```sh\nfaying").is_err(), "a block without end");
    let picture = |text: &str| format!("<svg><text x=\"1\">\n{text}\n</text></svg>");
    fs::write(reader.path("made.svg"), picture("error 1.25")).unwrap();
    fs::write(reader.path("kept.svg"), picture("error 1.35")).unwrap();
    let (kept, same) = (reader.path("kept.svg"), reader.path("made.svg"));
    if std::env::var_os("FAYING_WRITE").is_none() {
        assert!(reader.picture(&kept, "made.svg").is_err(), "another label");
        assert_eq!(reader.picture(&same, "made.svg"), Ok(()));
    }
}
