//! Number types of formulas, and their functions.

/// Number type of an evaluation: plain numbers, or numbers with derivatives.
pub(super) trait Number: Copy {
    fn constant(value: f64) -> Self;
    fn coordinate(value: f64, axis: usize) -> Self;
    fn value(&self) -> f64;
    fn unary(self, f: Unary) -> Self;
    fn binary(self, other: Self, f: Binary) -> Self;
}

/// Functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Neg,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Sqrt,
    Abs,
    Sign,
}

/// Functions of two arguments; comparisons give 1 or 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Atan2,
    Min,
    Max,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn coordinate(value: f64, _: usize) -> Self {
        value
    }
    fn value(&self) -> f64 {
        *self
    }
    fn unary(self, f: Unary) -> f64 {
        match f {
            Unary::Neg => -self,
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Tan => self.tan(),
            Unary::Asin => self.asin(),
            Unary::Acos => self.acos(),
            Unary::Atan => self.atan(),
            Unary::Sinh => self.sinh(),
            Unary::Cosh => self.cosh(),
            Unary::Tanh => self.tanh(),
            Unary::Exp => self.exp(),
            Unary::Log => self.ln(),
            Unary::Sqrt => self.sqrt(),
            Unary::Abs => self.abs(),
            Unary::Sign => sign(self),
        }
    }
    fn binary(self, b: f64, f: Binary) -> f64 {
        let truth = |yes: bool| f64::from(u8::from(yes));
        match f {
            Binary::Add => self + b,
            Binary::Sub => self - b,
            Binary::Mul => self * b,
            Binary::Div => self / b,
            Binary::Pow => power(self, b),
            Binary::Atan2 => self.atan2(b),
            // not f64::min: NaN must propagate
            Binary::Min => extreme(self, b, self <= b),
            Binary::Max => extreme(self, b, self >= b),
            Binary::Less => truth(self < b),
            Binary::LessEqual => truth(self <= b),
            Binary::Greater => truth(self > b),
            Binary::GreaterEqual => truth(self >= b),
            Binary::Equal => truth(self == b),
            Binary::NotEqual => truth(self != b),
        }
    }
}

// a if `first` or if it is NaN, else b: NaN propagates
pub(super) fn extreme<N: Number>(a: N, b: N, first: bool) -> N {
    if first || a.value().is_nan() { a } else { b }
}

pub(super) fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x * 0.0
    }
}

// small whole exponents by multiplication: exact for negative bases too
pub(super) fn power(a: f64, b: f64) -> f64 {
    if b.fract() == 0.0 && b.abs() <= 64.0 { a.powi(b as i32) } else { a.powf(b) }
}
