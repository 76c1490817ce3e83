//! Quoted formulas of case files: numbers, functions of x, y, z, t, and derivatives to second order.
//!
//! Operators from weak to strong: comparisons (1 or 0, no chains) · `+ -` · `* /` · signs · `^` (right
//! associative). So `-x^2` is -(x^2), `2^3^2` is 2^9, `2^-1` is a half. Angles are in radians; r = sqrt(x^2 + y^2),
//! theta = atan2(y, x). `min` and `max` take two or more arguments. `if(c, a, b)` is a where c is not zero, else b.
//!
//! # Example
//! ```
//! use faying_cli::formula::{Constants, Formula, Point, Scope};
//! let constants = Constants::default();
//! let f = Formula::parse("-x^2 * y", &Scope::space(&constants))?;
//! let jet = f.jet(&Point::new(&[3.0, 2.0]));
//! assert_eq!(jet.value, -18.0);
//! assert_eq!(jet.gradient, [-12.0, -9.0, 0.0]);
//! assert_eq!(jet.hessian[0][1], -6.0);
//! # Ok::<(), faying_cli::formula::FormulaError>(())
//! ```

mod constants;
mod continued;
mod exact;
mod jet;
mod number;
mod parse;
mod program;
mod taylor;

use faying::problem::{Data, Function};
use std::sync::Arc;

pub use constants::{ConstantText, Constants};
pub(crate) use exact::exact;
pub use faying::problem::Point;
pub use jet::Jet;
pub use program::Variable;
use program::{Op, Program};

/// Parse error of a formula, with its position in the text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct FormulaError {
    /// Message.
    pub message: String,
    /// Characters before the error.
    pub offset: usize,
    /// Length of the error in characters.
    pub length: usize,
    /// Allowed values, or advice.
    pub help: Option<String>,
}

impl FormulaError {
    fn new(message: impl Into<String>, offset: usize, length: usize) -> Self {
        Self { message: message.into(), offset, length: length.max(1), help: None }
    }

    fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// Names that a formula may use.
#[derive(Clone, Copy, Debug)]
pub struct Scope<'a> {
    /// Variables that have a value.
    pub variables: &'a [Variable],
    /// Constants of `[let]`.
    pub constants: &'a Constants,
    /// `Some` if quantities are allowed (checks): the names of the case, which may contain `-`.
    pub quantities: Option<&'a [String]>,
}

const SPACE: &[Variable] = &[Variable::X, Variable::Y, Variable::Z, Variable::T, Variable::R, Variable::Theta];
const GAP: &[Variable] = &[Variable::G, Variable::X, Variable::Y, Variable::Z, Variable::T, Variable::R, Variable::Theta];

impl<'a> Scope<'a> {
    /// Physical data: x, y, z, t, r, theta.
    pub fn space(constants: &'a Constants) -> Self {
        Self { variables: SPACE, constants, quantities: None }
    }

    /// Gap formulas: g and the variables of space.
    pub fn gap(constants: &'a Constants) -> Self {
        Self { variables: GAP, constants, quantities: None }
    }

    /// Prescribed motion: t.
    pub fn time(constants: &'a Constants) -> Self {
        Self { variables: &[Variable::T], constants, quantities: None }
    }

    /// One number.
    pub fn number(constants: &'a Constants) -> Self {
        Self { variables: &[], constants, quantities: None }
    }

    /// Values of checks: t, constants and quantities.
    pub fn check(constants: &'a Constants, names: &'a [String]) -> Self {
        Self { variables: &[Variable::T], constants, quantities: Some(names) }
    }

    fn what(&self) -> &'static str {
        match (self.variables, self.quantities) {
            ([], Some(_)) => "only constants, and in checks quantities, are known",
            (_, Some(_)) => "only t, constants and quantities are known",
            ([], None) => "one number is expected, made of constants",
            ([Variable::T], _) => "only t and constants are known",
            _ => "x, y, z, t, r, theta and constants are known",
        }
    }
}

/// A quantity named in a check's formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuantityRef {
    /// Its text, such as `contact.pad.force.y` or `u.x at [1, 0] in upper`.
    pub text: String,
    /// Characters before it in the formula.
    pub offset: usize,
    /// Characters of it.
    pub length: usize,
}

/// A number or a quoted formula. Copies are cheap.
#[derive(Clone, Debug)]
pub struct Formula {
    text: Option<Arc<str>>,
    program: Arc<Program>,
    quantities: Arc<[QuantityRef]>,
}

impl PartialEq for Formula {
    /// Equal programs: the same number, or the same steps.
    fn eq(&self, other: &Self) -> bool {
        self.program == other.program && self.quantities == other.quantities
    }
}

impl Formula {
    /// A plain number.
    pub fn constant(value: f64) -> Self {
        Self { text: None, program: Arc::new(Program::constant(value)), quantities: Arc::new([]) }
    }

    /// Reads a text.
    ///
    /// # Errors
    /// [`FormulaError`] with the position where reading stopped.
    pub fn parse(text: &str, scope: &Scope<'_>) -> Result<Self, FormulaError> {
        let (program, quantities) = parse::parse(text, scope)?;
        Ok(Self { text: Some(text.into()), program: Arc::new(program), quantities: quantities.into() })
    }

    /// The number, if the formula depends on nothing.
    pub fn as_constant(&self) -> Option<f64> {
        self.program.as_constant()
    }

    /// Whether it depends on the time.
    pub fn depends_on_time(&self) -> bool {
        self.uses(Variable::T)
    }

    /// Whether it depends on a variable.
    pub fn uses(&self, variable: Variable) -> bool {
        self.program.any(|op| *op == Op::Variable(variable))
    }

    /// Whether it has pieces: `if`, comparisons, abs, sign, min or max, whose derivatives may jump.
    pub fn is_piecewise(&self) -> bool {
        self.program.any(Op::has_pieces)
    }

    /// The value at a point; NaN where the formula is undefined.
    pub fn value(&self, at: &Point) -> f64 {
        self.program.run(at, &[])
    }

    /// Value, gradient and Hessian at a point.
    pub fn jet(&self, at: &Point) -> Jet {
        self.program.jet(at)
    }

    /// Value and gradient at a point, the Hessian zero: for less than half the cost of [`Formula::jet`].
    pub fn slope(&self, at: &Point) -> Jet {
        self.program.slope(at)
    }

    /// Value and gradient at a point, the Hessian zero, of the piece that holds at the point `inside` of the same time: the choices of
    /// `if`, comparisons, abs, sign, min and max are made there.
    pub fn continued(&self, at: &Point, inside: &Point) -> Jet {
        self.program.continued(at, inside)
    }

    /// The quantities it names, in the order of [`Formula::value_with`].
    pub fn quantities(&self) -> &[QuantityRef] {
        &self.quantities
    }

    /// The value at time `t` with the quantities' values, one per entry of [`Formula::quantities`].
    pub fn value_with(&self, t: f64, quantities: &[f64]) -> f64 {
        self.program.run(&Point::default().at_time(t), quantities)
    }

    /// The text as written, or the number.
    pub fn text(&self) -> String {
        match (&self.text, self.as_constant()) {
            (Some(text), _) => text.to_string(),
            (None, Some(v)) => format!("{v:?}"),
            (None, None) => String::new(),
        }
    }
}

impl From<f64> for Formula {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl Function for Formula {
    fn value(&self, at: &Point) -> f64 {
        Self::value(self, at)
    }
    fn depends_on_time(&self) -> bool {
        Self::depends_on_time(self)
    }
    fn as_constant(&self) -> Option<f64> {
        Self::as_constant(self)
    }
}

impl From<Formula> for Data {
    fn from(formula: Formula) -> Self {
        Self::new(formula)
    }
}

/// Whether a name is free to be a constant of `[let]`; `g`, which is a variable of gap formulas alone, is.
pub fn is_free_name(name: &str) -> bool {
    parse::is_name(name) && (name == "g" || !parse::is_reserved(name))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let c = Constants::default();
        Formula::parse(text, &Scope::space(&c)).map(|f| f.value(&Point::new(&[0.5, 2.0, 3.0]))).unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        assert_eq!(value("-x^2"), -0.25);
        assert_eq!(value("2^3^2"), 512.0);
        assert_eq!(value("2^-1"), 0.5);
        assert_eq!(value("1 - 2 - 3"), -4.0);
        assert_eq!(value("8/4/2"), 1.0);
        assert_eq!(value("1 + 2*3 < 8"), 1.0);
        assert_eq!(value("if(x > 1, 1, max(1, y, z))"), 3.0);
        assert_eq!(value("2*e^0 + 2e0"), 4.0);
        assert_eq!(value("--x"), 0.5);
        assert_eq!(value("atan2(y, x) - theta"), 0.0);
    }

    #[test]
    fn pieces_are_continued_beyond_their_ends() {
        let c = Constants::default();
        let jet = |text: &str, x: f64, inside: f64| {
            let f = Formula::parse(text, &Scope::space(&c)).unwrap();
            let found = f.continued(&Point::new(&[x, 2.0]), &Point::new(&[inside, 2.0]));
            (found.value, found.gradient[0])
        };
        // x^2 up to 1, beyond it 3 x
        let forms = ["if(x < 1, x^2, 3*x)", "if(1 <= x, 3*x, x^2)", "(x < 1)*x^2 + (x >= 1)*3*x", "x^2 + (3*x - x^2)*max(0, sign(x - 1))"];
        for text in forms {
            assert_eq!((jet(text, 1.0, 0.5), jet(text, 1.0, 1.5), jet(text, 1.2, 0.9)), ((1.0, 2.0), (3.0, 3.0), (1.44, 2.4)), "{text}");
        }
        assert_eq!((jet("abs(x - 1)", 1.0, 0.5), jet("abs(x - 1)", 1.0, 1.5)), ((0.0, -1.0), (0.0, 1.0)));
        assert_eq!((jet("min(x, y - x)", 1.0, 0.5), jet("max(x, y - x)", 1.0, 0.5)), ((1.0, 1.0), (1.0, -1.0)));
        assert_eq!((jet("if(r < y, r, theta)", 0.0, 1.0).0, jet("sqrt(x)", 4.0, 1.0)), (std::f64::consts::FRAC_PI_2, (2.0, 0.25)));
    }

    #[test]
    fn constants_of_let_come_in_any_order() {
        let d = |n: &str, t: &str| (n.to_owned(), ConstantText::Formula(t.to_owned()));
        let (c, e) = Constants::resolve(&[d("a", "sqrt(4*F/pi)"), d("F", "b/2"), ("b".to_owned(), ConstantText::Number(2.0))]);
        assert!(e.is_empty(), "{e:?}");
        assert_eq!(c.get("a"), Some((4.0 / std::f64::consts::PI).sqrt()));
        let (_, e) = Constants::resolve(&[d("p", "q + 1"), d("q", "2*s"), d("s", "q")]);
        assert_eq!(e.len(), 1);
        assert!(e[0].1.message.contains("q -> s -> q"), "{}", e[0].1);
    }

    #[test]
    fn quantities_stand_in_formulas_of_checks() {
        let c = Constants::default();
        let names = ["my-pad".to_owned()];
        let f = Formula::parse("2*contact.my-pad.force.y-1 + u.x at [1.0, 0.5] in upper - energy", &Scope::check(&c, &names)).unwrap();
        let texts: Vec<&str> = f.quantities().iter().map(|q| q.text.as_str()).collect();
        assert_eq!(texts, ["contact.my-pad.force.y", "u.x at [1.0, 0.5] in upper", "energy"]);
        assert_eq!(f.value_with(1.0, &[3.0, 10.0, 1.0]), 14.0);
        let f =
            Formula::parse("-2*moment cut [0, 1] to [max(1, 2), 1] in a + force.x cut [0,0] to [0,1]", &Scope::check(&c, &names)).unwrap();
        let texts: Vec<&str> = f.quantities().iter().map(|q| q.text.as_str()).collect();
        assert_eq!(texts, ["moment cut [0, 1] to [max(1, 2), 1] in a", "force.x cut [0,0] to [0,1]"]);
        assert_eq!(f.value_with(1.0, &[3.0, 10.0]), 4.0);
    }
}
