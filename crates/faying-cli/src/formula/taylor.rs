//! Numbers with their derivatives: truncated Taylor series in the first coordinates.

use super::jet::Jet;
use super::number::{Binary, Number, Unary, extreme, power, sign};

/// A value with its first derivatives in the first N coordinates and, if H > 0, its N (N + 1) / 2 second ones: the rows of the upper
/// triangle one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taylor<const N: usize, const H: usize> {
    value: f64,
    gradient: [f64; N],
    hessian: [f64; H],
}

impl<const N: usize, const H: usize> Taylor<N, H> {
    fn is_constant(&self) -> bool {
        self.gradient == [0.0; N] && self.hessian == [0.0; H]
    }

    /// A number with the derivatives `first(i)` and `second(k, i, j)`, i <= j, where k counts the pairs row by row.
    #[inline(always)]
    fn build(value: f64, first: impl Fn(usize) -> f64, second: impl Fn(usize, usize, usize) -> f64) -> Self {
        let mut out = Self::constant(value);
        let mut k = 0;
        for i in 0..N {
            out.gradient[i] = first(i);
            for j in i..N {
                if k < H {
                    out.hessian[k] = second(k, i, j);
                    k += 1;
                }
            }
        }
        out
    }

    /// f(self) with f, f', f'' at the value.
    #[inline(always)]
    fn chain(&self, f: f64, df: f64, ddf: f64) -> Self {
        let g = &self.gradient;
        if df.is_finite() && ddf.is_finite() {
            return Self::build(f, |i| df * g[i], |k, i, j| df * self.hessian[k] + ddf * (g[i] * g[j]));
        }
        Self::build(f, |i| times(df, g[i]), |k, i, j| times(df, self.hessian[k]) + times(ddf, g[i] * g[j]))
    }

    /// f(a, b) with first derivatives d = [f_a, f_b] and second derivatives h = [f_aa, f_ab, f_bb].
    #[inline(always)]
    fn chain2(a: &Self, b: &Self, f: f64, d: [f64; 2], h: [f64; 3]) -> Self {
        let (ga, gb) = (&a.gradient, &b.gradient);
        let mixed = |i: usize, j: usize| ga[i] * gb[j] + gb[i] * ga[j];
        if d.iter().chain(&h).all(|v| v.is_finite()) {
            return Self::build(
                f,
                |i| d[0] * ga[i] + d[1] * gb[i],
                |k, i, j| d[0] * a.hessian[k] + d[1] * b.hessian[k] + h[0] * (ga[i] * ga[j]) + h[1] * mixed(i, j) + h[2] * (gb[i] * gb[j]),
            );
        }
        Self::build(
            f,
            |i| times(d[0], ga[i]) + times(d[1], gb[i]),
            |k, i, j| {
                times(d[0], a.hessian[k])
                    + times(d[1], b.hessian[k])
                    + times(h[0], ga[i] * ga[j])
                    + times(h[1], mixed(i, j))
                    + times(h[2], gb[i] * gb[j])
            },
        )
    }

    /// The derivatives in x, y, z; derivatives that are not carried are zero.
    pub fn jet(&self) -> Jet {
        let mut out = Jet { value: self.value, gradient: [0.0; 3], hessian: [[0.0; 3]; 3] };
        out.gradient[..N].copy_from_slice(&self.gradient);
        let mut entries = self.hessian.iter();
        for i in 0..N {
            for j in i..N {
                let entry = entries.next().copied().unwrap_or(0.0);
                (out.hessian[i][j], out.hessian[j][i]) = (entry, entry);
            }
        }
        out
    }
}

// 0 times an infinite derivative is 0: that direction does not move the argument
fn times(derivative: f64, direction: f64) -> f64 {
    if direction == 0.0 { 0.0 } else { derivative * direction }
}

impl<const N: usize, const H: usize> Number for Taylor<N, H> {
    fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N], hessian: [0.0; H] }
    }
    fn coordinate(value: f64, axis: usize) -> Self {
        let mut out = Self::constant(value);
        if axis < N {
            out.gradient[axis] = 1.0;
        }
        out
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
            Binary::Add => Self::build(v, |i| self.gradient[i] + o.gradient[i], |k, _, _| self.hessian[k] + o.hessian[k]),
            Binary::Sub => Self::build(v, |i| self.gradient[i] - o.gradient[i], |k, _, _| self.hessian[k] - o.hessian[k]),
            Binary::Mul if o.is_constant() && b.is_finite() => self.chain(v, b, 0.0),
            Binary::Mul if self.is_constant() && a.is_finite() => o.chain(v, a, 0.0),
            Binary::Div if o.is_constant() => self.chain(v, 1.0 / b, 0.0),
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
