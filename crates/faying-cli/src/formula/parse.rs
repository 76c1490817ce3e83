//! Reads the text of a formula into a program; errors carry the position in the text.

mod quantity;

use super::number::{Binary, Unary};
use super::program::{Op, Program, ProgramBuilder, Variable};
use super::{FormulaError, QuantityRef, Scope};
use crate::errors::nearest;

/// Longest formula in characters.
const LONGEST: usize = 20_000;
/// Deepest nesting of brackets, signs and exponents.
const DEEPEST: usize = 100;

const VARIABLES: [(&str, Variable); 7] = [
    ("x", Variable::X),
    ("y", Variable::Y),
    ("z", Variable::Z),
    ("t", Variable::T),
    ("r", Variable::R),
    ("theta", Variable::Theta),
    ("g", Variable::G),
];

const UNARY: [(&str, Unary); 14] = [
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tan", Unary::Tan),
    ("asin", Unary::Asin),
    ("acos", Unary::Acos),
    ("atan", Unary::Atan),
    ("sinh", Unary::Sinh),
    ("cosh", Unary::Cosh),
    ("tanh", Unary::Tanh),
    ("exp", Unary::Exp),
    ("log", Unary::Log),
    ("sqrt", Unary::Sqrt),
    ("abs", Unary::Abs),
    ("sign", Unary::Sign),
];

// min and max take two or more arguments
const BINARY: [(&str, Binary); 4] = [("min", Binary::Min), ("max", Binary::Max), ("pow", Binary::Pow), ("atan2", Binary::Atan2)];

/// Whether a name is reserved in formulas.
pub(super) fn is_reserved(name: &str) -> bool {
    matches!(name, "pi" | "e" | "if" | "at" | "in")
        || VARIABLES.iter().any(|(n, _)| *n == name)
        || UNARY.iter().any(|(n, _)| *n == name)
        || BINARY.iter().any(|(n, _)| *n == name)
}

/// Whether a text can be a name in formulas.
pub(super) fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    chars.next().is_some_and(starts_name) && chars.all(continues_name)
}

fn starts_name(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

fn continues_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// A parsed text: its program and the quantities it names.
pub(super) fn parse(text: &str, scope: &Scope<'_>) -> Result<(Program, Vec<QuantityRef>), FormulaError> {
    let chars: Vec<char> = text.chars().collect();
    if chars.len() > LONGEST {
        return Err(FormulaError::new(format!("the formula is longer than {LONGEST} characters"), 0, 1));
    }
    let mut parser = Parser { chars, at: 0, nesting: 0, out: ProgramBuilder::default(), quantities: Vec::new(), scope };
    parser.skip();
    if parser.peek().is_none() {
        return Err(FormulaError::new("the formula is empty", 0, 1));
    }
    parser.comparison()?;
    match parser.peek() {
        None => Ok((parser.out.finish(), parser.quantities)),
        Some(c) => Err(parser.unexpected(c)),
    }
}

struct Parser<'a> {
    chars: Vec<char>,
    at: usize,
    nesting: usize,
    out: ProgramBuilder,
    quantities: Vec<QuantityRef>,
    scope: &'a Scope<'a>,
}

type Parsed = Result<(), FormulaError>;

impl Parser<'_> {
    fn peek(&self) -> Option<char> {
        self.chars.get(self.at).copied()
    }

    fn skip(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.at += 1;
        }
    }

    // consumes `text`, if it is next, and the blanks after it
    fn take(&mut self, text: &str) -> bool {
        let found = text.chars().enumerate().all(|(k, c)| self.chars.get(self.at + k) == Some(&c));
        if found {
            self.at += text.chars().count();
            self.skip();
        }
        found
    }

    fn enter(&mut self) -> Parsed {
        self.nesting += 1;
        if self.nesting > DEEPEST {
            return Err(FormulaError::new(format!("the formula is nested deeper than {DEEPEST} levels"), self.at, 1));
        }
        Ok(())
    }

    fn comparison(&mut self) -> Parsed {
        self.sum()?;
        if let Some(f) = self.take_comparison() {
            self.sum()?;
            self.out.push(Op::Binary(f));
            let at = self.at;
            if self.take_comparison().is_some() {
                return Err(FormulaError::new("comparisons do not chain; use if(a < b, b < c, 0)", at, 1));
            }
        }
        Ok(())
    }

    fn take_comparison(&mut self) -> Option<Binary> {
        const SIGNS: [(&str, Binary); 6] = [
            ("<=", Binary::LessEqual),
            (">=", Binary::GreaterEqual),
            ("==", Binary::Equal),
            ("!=", Binary::NotEqual),
            ("<", Binary::Less),
            (">", Binary::Greater),
        ];
        SIGNS.iter().find(|(s, _)| self.take(s)).map(|(_, f)| *f)
    }

    fn sum(&mut self) -> Parsed {
        self.product()?;
        loop {
            let f = match self.peek() {
                Some('+') => Binary::Add,
                Some('-') => Binary::Sub,
                _ => return Ok(()),
            };
            self.at += 1;
            self.skip();
            self.product()?;
            self.out.push(Op::Binary(f));
        }
    }

    fn product(&mut self) -> Parsed {
        self.signed()?;
        loop {
            let f = match self.peek() {
                Some('*') => Binary::Mul,
                Some('/') => Binary::Div,
                _ => return Ok(()),
            };
            self.at += 1;
            if self.peek() == Some('*') {
                return Err(FormulaError::new("`**` is no operator; write ^", self.at - 1, 2));
            }
            self.skip();
            self.signed()?;
            self.out.push(Op::Binary(f));
        }
    }

    // a sign binds weaker than ^: -x^2 is -(x^2)
    fn signed(&mut self) -> Parsed {
        let mut negative = false;
        while let Some(c @ ('-' | '+')) = self.peek() {
            negative ^= c == '-';
            self.at += 1;
            self.skip();
        }
        self.power()?;
        if negative {
            self.out.push(Op::Unary(Unary::Neg));
        }
        Ok(())
    }

    // right associative: 2^3^2 is 2^9; the exponent may carry a sign
    fn power(&mut self) -> Parsed {
        self.atom()?;
        if self.take("^") {
            self.enter()?;
            self.signed()?;
            self.nesting -= 1;
            self.out.push(Op::Binary(Binary::Pow));
        }
        Ok(())
    }

    fn atom(&mut self) -> Parsed {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.skip();
                self.enter()?;
                self.comparison()?;
                self.nesting -= 1;
                self.close()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if starts_name(c) => self.name(),
            Some(c) => Err(self.unexpected(c)),
            None => Err(FormulaError::new("the formula ends where a number or a name is expected", self.at, 1)),
        }
    }

    fn close(&mut self) -> Parsed {
        if self.take(")") {
            return Ok(());
        }
        Err(match self.peek() {
            None => FormulaError::new("a closing bracket `)` is missing", self.at, 1),
            Some(c) => self.unexpected(c),
        })
    }

    fn unexpected(&self, c: char) -> FormulaError {
        let before = self.chars[..self.at].iter().rev().find(|c| !c.is_whitespace());
        let operand = before.is_some_and(|b| continues_name(*b) || *b == ')' || *b == '.');
        let message = match c {
            '=' => "`=` is no operator; write == to compare".to_owned(),
            ',' => "`,` is not expected here; a decimal point is written `.`".to_owned(),
            '(' | '_' if operand => "an operator is missing; products are written with `*`".to_owned(),
            c if operand && c.is_ascii_alphanumeric() => "an operator is missing; products are written with `*`".to_owned(),
            c => format!("unexpected character `{}`", c.escape_debug()),
        };
        FormulaError::new(message, self.at, 1)
    }

    fn number(&mut self) -> Parsed {
        let start = self.at;
        let digits = |p: &mut Self| {
            let from = p.at;
            while p.peek().is_some_and(|c| c.is_ascii_digit()) {
                p.at += 1;
            }
            p.at > from
        };
        let whole = digits(self);
        let mut fraction = false;
        if self.peek() == Some('.') {
            self.at += 1;
            fraction = digits(self);
        }
        if !whole && !fraction {
            return Err(FormulaError::new("a number is expected around `.`", start, 1));
        }
        // an exponent only if digits follow: 2*e is Euler's number, 2e3 is 2000
        if matches!(self.peek(), Some('e' | 'E')) {
            let mark = self.at;
            self.at += 1;
            if matches!(self.peek(), Some('+' | '-')) {
                self.at += 1;
            }
            if !digits(self) {
                self.at = mark;
            }
        }
        let text: String = self.chars[start..self.at].iter().collect();
        let value: f64 = text.parse().map_err(|_| FormulaError::new(format!("`{text}` is no number"), start, self.at - start))?;
        if !value.is_finite() {
            return Err(FormulaError::new(format!("`{text}` is too large for a number"), start, self.at - start));
        }
        self.skip();
        self.out.push(Op::Constant(value));
        Ok(())
    }

    fn name(&mut self) -> Parsed {
        let start = self.at;
        while self.peek().is_some_and(continues_name) {
            self.at += 1;
        }
        let name: String = self.chars[start..self.at].iter().collect();
        let end = self.at;
        if self.scope.quantities.is_some() && self.is_quantity(&name) {
            return self.quantity(start);
        }
        self.skip();
        if self.take("(") {
            return self.call(&name, start);
        }
        let variable = VARIABLES.iter().find(|(n, _)| *n == name).map(|(_, v)| *v);
        // `g` is a variable of gap formulas alone, and may be a constant elsewhere
        let op = if let Some(v) = variable.filter(|v| self.scope.variables.contains(v)) {
            Op::Variable(v)
        } else if let Some(value) = self.scope.constants.get(&name) {
            Op::Constant(value)
        } else if name == "pi" {
            Op::Constant(std::f64::consts::PI)
        } else if name == "e" {
            Op::Constant(std::f64::consts::E)
        } else if let Some(v) = variable {
            let message = if v == Variable::G {
                "`g` has a value only in the gap formula of a contact".to_owned()
            } else {
                format!("`{name}` has no value here; {}", self.scope.what())
            };
            return Err(FormulaError::new(message, start, end - start));
        } else if self.is_function(&name) {
            return Err(FormulaError::new(format!("the function `{name}` needs its arguments in brackets"), start, end - start));
        } else {
            return Err(self.unknown(&name, start));
        };
        self.out.push(op);
        Ok(())
    }

    fn is_function(&self, name: &str) -> bool {
        name == "if" || UNARY.iter().any(|(n, _)| *n == name) || BINARY.iter().any(|(n, _)| *n == name)
    }

    fn unknown(&self, name: &str, start: usize) -> FormulaError {
        let known: Vec<&str> = VARIABLES
            .iter()
            .filter(|(_, v)| self.scope.variables.contains(v))
            .map(|(n, _)| *n)
            .chain(["pi", "e"])
            .chain(self.scope.constants.names())
            .collect();
        let functions = UNARY.iter().map(|(n, _)| *n).chain(BINARY.iter().map(|(n, _)| *n));
        let near = nearest(name, known.iter().copied().chain(functions));
        let hint = near.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        let mut list: Vec<&str> = known.into_iter().take(40).collect();
        if list.len() == 40 {
            list.push("...");
        }
        FormulaError::new(format!("unknown name `{name}`{hint}"), start, name.chars().count())
            .with_help(format!("names here: {}; others are defined in [let]", list.join(", ")))
    }

    fn call(&mut self, name: &str, start: usize) -> Parsed {
        self.enter()?;
        if let Some((_, f)) = UNARY.iter().find(|(n, _)| *n == name) {
            self.arguments(name, start, 1, 1)?;
            self.out.push(Op::Unary(*f));
        } else if let Some((_, f)) = BINARY.iter().find(|(n, _)| *n == name) {
            self.fold_arguments(name, start, *f)?;
        } else if name == "if" {
            self.arguments(name, start, 3, 3)?;
            self.out.push(Op::If);
        } else {
            let functions = UNARY.iter().map(|(n, _)| *n).chain(BINARY.iter().map(|(n, _)| *n)).chain(["if"]);
            let known: Vec<&str> = functions.collect();
            let message = if self.scope.constants.get(name).is_some() || is_reserved(name) {
                format!("`{name}` is no function; products are written with `*`")
            } else {
                let near = if name == "ln" { Some("log") } else { nearest(name, known.iter().copied()) };
                let near = near.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                format!("unknown function `{name}`{near}")
            };
            return Err(FormulaError::new(message, start, name.chars().count()).with_help(format!("functions: {}", known.join(", "))));
        }
        self.nesting -= 1;
        Ok(())
    }

    fn arguments(&mut self, name: &str, start: usize, least: usize, most: usize) -> Result<usize, FormulaError> {
        let mut count = 0;
        loop {
            self.comparison()?;
            count += 1;
            if !self.take(",") {
                break;
            }
            if count == most {
                break;
            }
        }
        if count < least || (count == most && self.chars[..self.at].iter().rev().find(|c| !c.is_whitespace()) == Some(&',')) {
            let arguments = if most == 1 { "argument" } else { "arguments" };
            return Err(FormulaError::new(format!("`{name}` takes {most} {arguments}"), start, name.chars().count()));
        }
        self.close()?;
        Ok(count)
    }

    // min(a, b, c): folded while reading, so any number of arguments needs two places
    fn fold_arguments(&mut self, name: &str, start: usize, f: Binary) -> Parsed {
        let many = matches!(f, Binary::Min | Binary::Max);
        let mut count = 0;
        loop {
            self.comparison()?;
            count += 1;
            if count >= 2 {
                self.out.push(Op::Binary(f));
            }
            if !self.take(",") {
                break;
            }
            if count == 2 && !many {
                count += 1;
                break;
            }
        }
        if count < 2 || (count > 2 && !many) {
            let number = if many { "2 or more" } else { "2" };
            return Err(FormulaError::new(format!("`{name}` takes {number} arguments"), start, name.chars().count()));
        }
        self.close()
    }
}
