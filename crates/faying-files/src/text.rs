//! Words and numbers of text files, each with its line.

use super::budget::Budget;
use super::{FileError, Spot};

/// [`FileError::Broken`] in a line.
pub(super) fn broken(line: usize, what: impl Into<String>) -> FileError {
    FileError::Broken { what: what.into(), spot: Some(Spot::Line(line)) }
}

/// [`FileError::Unsupported`] in a line.
pub(super) fn unsupported(line: usize, what: impl Into<String>) -> FileError {
    FileError::Unsupported { what: what.into(), spot: Some(Spot::Line(line)) }
}

/// Largest number of characters of a file's words quoted in a message.
const SHOWN: usize = 40;

/// Beginning of a word, with control characters replaced, for a message.
pub(super) fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(4 * SHOWN)]);
    let mut short: String = text.chars().take(SHOWN).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > SHOWN {
        short.push_str("...");
    }
    short
}

/// Words between white space, without comments.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
    /// Whether a word that begins with `#` opens a comment to the end of the line.
    comments: bool,
}

impl<'a> Words<'a> {
    /// The words of `text`, whose first line is number `line`.
    pub(super) fn new(text: &'a [u8], line: usize) -> Self {
        Self { text, at: 0, line, comments: false }
    }

    /// Skips comments, which begin with `#`.
    pub(super) fn with_comments(mut self) -> Self {
        self.comments = true;
        self
    }

    /// The line of the next word.
    pub(super) fn line(&mut self) -> usize {
        self.skip();
        self.line
    }

    /// Bytes not read yet.
    pub(super) fn left(&self) -> usize {
        self.text.len() - self.at
    }

    /// Whether nothing is left.
    pub(super) fn done(&mut self) -> bool {
        self.skip();
        self.at == self.text.len()
    }

    fn skip(&mut self) {
        while let Some(&byte) = self.text.get(self.at) {
            match byte {
                b'\n' => {
                    self.line += 1;
                    self.at += 1;
                }
                b'#' if self.comments => self.at += self.text[self.at..].iter().position(|&b| b == b'\n').unwrap_or(self.left()),
                b if b.is_ascii_whitespace() => self.at += 1,
                _ => return,
            }
        }
    }

    /// The next word, if any.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        self.skip();
        let rest = &self.text[self.at..];
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        self.at += end;
        (end > 0).then(|| &rest[..end])
    }

    /// The next word without taking it.
    pub(super) fn peek(&mut self) -> Option<&'a [u8]> {
        self.clone().next()
    }

    /// The rest of the current line.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.text[self.at..];
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += end;
        rest[..end].trim_ascii()
    }

    /// The next word, which is `what` in messages.
    ///
    /// # Errors
    /// [`FileError::Broken`] at the end.
    pub(super) fn word(&mut self, what: &str) -> Result<&'a [u8], FileError> {
        let line = self.line;
        self.next().ok_or_else(|| broken(line, format!("the text ends where {what} is expected")))
    }

    /// Takes the word `keyword`.
    ///
    /// # Errors
    /// [`FileError::Broken`] for any other.
    pub(super) fn expect(&mut self, keyword: &str) -> Result<(), FileError> {
        let line = self.line();
        let word = self.word(&format!("\"{keyword}\""))?;
        if word == keyword.as_bytes() {
            return Ok(());
        }
        Err(broken(line, format!("expected \"{keyword}\", found \"{}\"", shown(word))))
    }

    /// Takes the word `keyword` if it is the next one.
    pub(super) fn accept(&mut self, keyword: &str) -> bool {
        let mut ahead = self.clone();
        let found = ahead.next() == Some(keyword.as_bytes());
        if found {
            *self = ahead;
        }
        found
    }

    fn parse<T: std::str::FromStr>(&mut self, what: &str, kind: &str) -> Result<(T, usize), FileError> {
        let line = self.line();
        let word = self.word(what)?;
        let value = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        let found = || broken(line, format!("{what} must be {kind}, found \"{}\"", shown(word)));
        value.map(|v| (v, line)).ok_or_else(found)
    }

    /// A whole number.
    ///
    /// # Errors
    /// [`FileError::Broken`] for any other word.
    pub(super) fn int(&mut self, what: &str) -> Result<i64, FileError> {
        Ok(self.parse(what, "a whole number")?.0)
    }

    /// A whole number from 0.
    ///
    /// # Errors
    /// [`FileError::Broken`] for any other word.
    pub(super) fn index(&mut self, what: &str) -> Result<usize, FileError> {
        Ok(self.parse(what, "a whole number from 0")?.0)
    }

    /// A finite number.
    ///
    /// # Errors
    /// [`FileError::Broken`] for any other word.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, FileError> {
        let (value, line) = self.parse::<f64>(what, "a number")?;
        if value.is_finite() { Ok(value) } else { Err(broken(line, format!("{what} must be finite, found {value}"))) }
    }

    /// A count of things that take at least `words` words each.
    ///
    /// # Errors
    /// [`FileError::Broken`] for any other word, and if the rest of the text is too short for so many.
    pub(super) fn count(&mut self, what: &str, words: usize) -> Result<usize, FileError> {
        let line = self.line();
        let count = self.index(&format!("the number of {what}"))?;
        self.room(count, words, what, line)?;
        Ok(count)
    }

    /// Checks that the rest of the text has room for `count` items of `words` words each.
    ///
    /// # Errors
    /// [`FileError::Broken`] if the rest of the text is too short.
    pub(super) fn room(&self, count: usize, words: usize, what: &str, line: usize) -> Result<(), FileError> {
        // A word takes a byte and one of white space before it, which may have been read already before the first.
        if count.saturating_mul(words).saturating_mul(2) > self.left().saturating_add(1) {
            return Err(broken(line, format!("{count} {what} do not fit in the {} bytes that follow", self.left())));
        }
        Ok(())
    }

    /// `count` finite numbers, which are `what` in messages; the memory is taken from `budget`.
    ///
    /// # Errors
    /// [`FileError::Broken`] if there are fewer; [`FileError::Memory`].
    pub(super) fn numbers(&mut self, count: usize, what: &str, budget: &mut Budget) -> Result<Vec<f64>, FileError> {
        let line = self.line();
        self.room(count, 1, what, line)?;
        budget.items(count, size_of::<f64>())?;
        let mut all = Vec::with_capacity(count);
        for k in 0..count {
            all.push(self.number(what).map_err(|e| few(e, k, count, what))?);
        }
        Ok(all)
    }
}

/// Adds the number of values found to an error at an early end of the text.
fn few(error: FileError, found: usize, expected: usize, what: &str) -> FileError {
    match error {
        FileError::Broken { what: text, spot } if text.starts_with("the text ends") => {
            FileError::Broken { what: format!("{expected} numbers are expected as {what}, found {found}"), spot }
        }
        other => other,
    }
}

/// Checks an open knot vector.
///
/// # Errors
/// [`FileError::Broken`] for knots that decrease, do not have multiplicity degree + 1 at the ends or are repeated too often.
pub(super) fn check_knots(degree: usize, knots: &[f64], line: usize) -> Result<(), FileError> {
    if degree >= knots.len() {
        return Err(broken(line, format!("{} knots are too few for degree {degree}", knots.len())));
    }
    faying::basis::BSpline::try_new(degree, knots.to_vec()).map(|_| ()).map_err(|e| broken(line, format!("the knot vector: {e}")))
}

/// Checks weights.
///
/// # Errors
/// [`FileError::Broken`] for one that is not positive.
pub(super) fn check_weights(weights: &[f64], line: usize) -> Result<(), FileError> {
    match weights.iter().position(|w| *w <= 0.0) {
        Some(k) => Err(broken(line, format!("weight {k} is {}, weights are positive", weights[k]))),
        None => Ok(()),
    }
}
