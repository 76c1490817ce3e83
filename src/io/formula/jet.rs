//! Jets: a value with its first and second derivatives in x, y, z, and the numbers that formulas run on.

/// Value, gradient and Hessian in x, y, z at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First derivatives.
    pub gradient: [f64; 3],
    /// Second derivatives, symmetric.
    pub hessian: [[f64; 3]; 3],
}

impl Jet {
    /// A number that does not depend on the point.
    pub const fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; 3], hessian: [[0.0; 3]; 3] }
    }

    /// The coordinate of this axis.
    pub fn coordinate(value: f64, axis: usize) -> Self {
        let mut jet = Self::constant(value);
        jet.gradient[axis] = 1.0;
        jet
    }

    fn is_constant(&self) -> bool {
        self.gradient == [0.0; 3] && self.hessian == [[0.0; 3]; 3]
    }

    /// f(self) with f, f', f'' at the value.
    fn chain(&self, f: f64, df: f64, ddf: f64) -> Self {
        // a constant stays one where f' is infinite
        if self.is_constant() {
            return Self::constant(f);
        }
        let mut out = Self::constant(f);
        for i in 0..3 {
            out.gradient[i] = times(df, self.gradient[i]);
            for j in 0..3 {
                out.hessian[i][j] = times(df, self.hessian[i][j]) + times(ddf, self.gradient[i] * self.gradient[j]);
            }
        }
        out
    }

    /// f(a, b) with first derivatives d = [f_a, f_b] and second derivatives h = [f_aa, f_ab, f_bb].
    fn chain2(a: &Self, b: &Self, f: f64, d: [f64; 2], h: [f64; 3]) -> Self {
        let mut out = Self::constant(f);
        for i in 0..3 {
            out.gradient[i] = times(d[0], a.gradient[i]) + times(d[1], b.gradient[i]);
            for j in 0..3 {
                out.hessian[i][j] = times(d[0], a.hessian[i][j])
                    + times(d[1], b.hessian[i][j])
                    + times(h[0], a.gradient[i] * a.gradient[j])
                    + times(h[1], a.gradient[i] * b.gradient[j] + b.gradient[i] * a.gradient[j])
                    + times(h[2], b.gradient[i] * b.gradient[j]);
            }
        }
        out
    }
}

// 0 times an infinite derivative is 0: that direction does not move the argument
fn times(derivative: f64, direction: f64) -> f64 {
    if direction == 0.0 { 0.0 } else { derivative * direction }
}

/// What a formula is evaluated over: plain numbers or jets.
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
            // not f64::min: a number that is not one must be seen
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

impl Number for Jet {
    fn constant(value: f64) -> Self {
        Self::constant(value)
    }
    fn coordinate(value: f64, axis: usize) -> Self {
        Self::coordinate(value, axis)
    }
    fn value(&self) -> f64 {
        self.value
    }
    fn unary(self, f: Unary) -> Self {
        let x = self.value;
        let v = x.unary(f);
        let (d, h) = match f {
            Unary::Neg => (-1.0, 0.0),
            Unary::Sin => (x.cos(), -v),
            Unary::Cos => (-x.sin(), -v),
            Unary::Tan => (1.0 + v * v, 2.0 * v * (1.0 + v * v)),
            Unary::Asin => {
                let s = 1.0 - x * x;
                (1.0 / s.sqrt(), x / (s * s.sqrt()))
            }
            Unary::Acos => {
                let s = 1.0 - x * x;
                (-1.0 / s.sqrt(), -x / (s * s.sqrt()))
            }
            Unary::Atan => {
                let s = 1.0 + x * x;
                (1.0 / s, -2.0 * x / (s * s))
            }
            Unary::Sinh => (x.cosh(), v),
            Unary::Cosh => (x.sinh(), v),
            Unary::Tanh => (1.0 - v * v, -2.0 * v * (1.0 - v * v)),
            Unary::Exp => (v, v),
            Unary::Log => (1.0 / x, -1.0 / (x * x)),
            Unary::Sqrt => (0.5 / v, -0.25 / (v * x)),
            Unary::Abs => (sign(x), 0.0),
            Unary::Sign => (0.0, 0.0),
        };
        self.chain(v, d, h)
    }
    fn binary(self, o: Self, f: Binary) -> Self {
        let (a, b) = (self.value, o.value);
        let v = a.binary(b, f);
        match f {
            Binary::Add => Self::chain2(&self, &o, v, [1.0, 1.0], [0.0; 3]),
            Binary::Sub => Self::chain2(&self, &o, v, [1.0, -1.0], [0.0; 3]),
            Binary::Mul => Self::chain2(&self, &o, v, [b, a], [0.0, 1.0, 0.0]),
            Binary::Div => Self::chain2(&self, &o, v, [1.0 / b, -a / (b * b)], [0.0, -1.0 / (b * b), 2.0 * a / (b * b * b)]),
            Binary::Pow if o.is_constant() => {
                // vanishing factors first: 0 * infinity at a = 0 is no derivative
                let d = if b == 0.0 { 0.0 } else { b * power(a, b - 1.0) };
                let h = if b == 0.0 || b == 1.0 { 0.0 } else { b * (b - 1.0) * power(a, b - 2.0) };
                self.chain(v, d, h)
            }
            Binary::Pow => {
                let l = a.ln();
                let pa = power(a, b - 1.0);
                let h = [b * (b - 1.0) * power(a, b - 2.0), pa * (1.0 + b * l), v * l * l];
                Self::chain2(&self, &o, v, [b * pa, v * l], h)
            }
            Binary::Atan2 => {
                // a is y, b is x
                let s = a * a + b * b;
                let h = [-2.0 * a * b / (s * s), (a * a - b * b) / (s * s), 2.0 * a * b / (s * s)];
                Self::chain2(&self, &o, v, [b / s, -a / s], h)
            }
            Binary::Min => extreme(self, o, a <= b),
            Binary::Max => extreme(self, o, a >= b),
            _ => Self::constant(v),
        }
    }
}

// the first if it wins; where nothing wins one of them is not a number, and that one is the answer
fn extreme<N: Number>(a: N, b: N, first: bool) -> N {
    if first || a.value().is_nan() { a } else { b }
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x * 0.0
    }
}

// small whole exponents by multiplication: exact for negative bases too
fn power(a: f64, b: f64) -> f64 {
    if b.fract() == 0.0 && b.abs() <= 64.0 { a.powi(b as i32) } else { a.powf(b) }
}
