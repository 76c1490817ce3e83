//! Compiled formulas: a flat list of steps on a stack.

use super::continued::Continued;
use super::jet::Jet;
use super::number::{Binary, Number, Unary};
use super::taylor::Taylor;
use faying::problem::Point;

/// Variables of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Variable {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
    /// Time.
    T,
    /// Geometric gap.
    G,
    /// sqrt(x^2 + y^2).
    R,
    /// atan2(y, x).
    Theta,
}

/// One step of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Constant(f64),
    Variable(Variable),
    Quantity(usize),
    Unary(Unary),
    Binary(Binary),
    /// c, a, b become a where c is not 0, else b.
    If,
}

impl Op {
    /// Whether it is piecewise: `if`, abs, sign, comparisons, min, max.
    pub fn has_pieces(&self) -> bool {
        use Binary::{Add, Atan2, Div, Mul, Pow, Sub};
        match self {
            Self::If | Self::Unary(Unary::Abs | Unary::Sign) => true,
            // the others are comparisons, min and max
            Self::Binary(op) => !matches!(op, Add | Sub | Mul | Div | Pow | Atan2),
            _ => false,
        }
    }
}

/// Stack that needs no heap up to this depth.
const SHALLOW: usize = 24;

/// Steps and the depth of stack they need.
#[derive(Clone, Debug, PartialEq, Default)]
pub(super) struct Program {
    pub ops: Vec<Op>,
    pub depth: usize,
    /// Whether it depends on z: otherwise derivatives are carried in x and y only.
    pub spatial: bool,
}

impl Program {
    pub fn constant(value: f64) -> Self {
        Self { ops: vec![Op::Constant(value)], depth: 1, spatial: false }
    }

    pub fn as_constant(&self) -> Option<f64> {
        match self.ops[..] {
            [Op::Constant(v)] => Some(v),
            _ => None,
        }
    }

    pub fn run<N: Number>(&self, at: &Point, quantities: &[f64]) -> N {
        self.run_with(at, &|k| N::coordinate(at.x[k], k), quantities)
    }

    /// Runs with the coordinates `axis`; time and gap are those of `at`.
    fn run_with<N: Number>(&self, at: &Point, axis: &impl Fn(usize) -> N, quantities: &[f64]) -> N {
        if let Some(v) = self.as_constant() {
            return N::constant(v);
        }
        if self.depth <= SHALLOW {
            self.run_on(&mut [N::constant(0.0); SHALLOW], at, axis, quantities)
        } else {
            self.run_on(&mut vec![N::constant(0.0); self.depth], at, axis, quantities)
        }
    }

    fn run_on<N: Number>(&self, stack: &mut [N], at: &Point, axis: &impl Fn(usize) -> N, quantities: &[f64]) -> N {
        let (mut top, mut radius, mut angle) = (0, None, None);
        for op in &self.ops {
            match *op {
                Op::Constant(v) => {
                    stack[top] = N::constant(v);
                    top += 1;
                }
                Op::Variable(v) => {
                    // r and theta are computed once
                    stack[top] = match v {
                        Variable::R => *radius.get_or_insert_with(|| variable(v, at, axis)),
                        Variable::Theta => *angle.get_or_insert_with(|| variable(v, at, axis)),
                        _ => variable(v, at, axis),
                    };
                    top += 1;
                }
                Op::Quantity(k) => {
                    // a missing quantity is NaN
                    stack[top] = N::constant(quantities.get(k).copied().unwrap_or(f64::NAN));
                    top += 1;
                }
                Op::Unary(f) => stack[top - 1] = stack[top - 1].unary(f),
                Op::Binary(f) => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1].binary(stack[top], f);
                }
                Op::If => {
                    top -= 2;
                    stack[top - 1] = if stack[top - 1].value() != 0.0 { stack[top] } else { stack[top + 1] };
                }
            }
        }
        stack[0]
    }
}

fn variable<N: Number>(v: Variable, at: &Point, axis: &impl Fn(usize) -> N) -> N {
    match v {
        Variable::X => axis(0),
        Variable::Y => axis(1),
        Variable::Z => axis(2),
        Variable::T => N::constant(at.t),
        Variable::G => N::constant(at.g),
        Variable::R => {
            let square = |n: N| n.binary(n, Binary::Mul);
            square(axis(0)).binary(square(axis(1)), Binary::Add).unary(Unary::Sqrt)
        }
        Variable::Theta => axis(1).binary(axis(0), Binary::Atan2),
    }
}

/// Builds a program; constant parts are evaluated at once.
#[derive(Debug, Default)]
pub(super) struct ProgramBuilder {
    ops: Vec<Op>,
    height: usize,
    depth: usize,
}

impl ProgramBuilder {
    pub fn push(&mut self, op: Op) {
        let (takes, fold) = match op {
            Op::Constant(_) | Op::Variable(_) | Op::Quantity(_) => (0, false),
            Op::Unary(_) => (1, true),
            Op::Binary(_) => (2, true),
            Op::If => (3, true),
        };
        self.height = self.height + 1 - takes;
        self.depth = self.depth.max(self.height);
        let n = self.ops.len();
        self.ops.push(op);
        if fold && n >= takes && self.ops[n - takes..n].iter().all(|o| matches!(o, Op::Constant(_))) {
            let part = Program { ops: self.ops[n - takes..].to_vec(), depth: takes, spatial: false };
            let value: f64 = part.run(&Point::default(), &[]);
            self.ops.truncate(n - takes);
            self.ops.push(Op::Constant(value));
        }
    }

    pub fn finish(self) -> Program {
        let spatial = self.ops.contains(&Op::Variable(Variable::Z));
        Program { ops: self.ops, depth: self.depth.max(1), spatial }
    }
}

impl Program {
    /// Whether a step satisfies the predicate.
    pub fn any(&self, predicate: impl Fn(&Op) -> bool) -> bool {
        self.ops.iter().any(predicate)
    }

    /// Value, first and second derivatives.
    pub fn jet(&self, at: &Point) -> Jet {
        if self.spatial { self.run::<Taylor<3, 6>>(at, &[]).jet() } else { self.run::<Taylor<2, 3>>(at, &[]).jet() }
    }

    /// Value and first derivatives; the second ones are zero.
    pub fn slope(&self, at: &Point) -> Jet {
        if self.spatial { self.run::<Taylor<3, 0>>(at, &[]).jet() } else { self.run::<Taylor<2, 0>>(at, &[]).jet() }
    }

    /// Value and first derivatives at `at` of the piece that holds at `inside`; the second derivatives are zero.
    pub fn continued(&self, at: &Point, inside: &Point) -> Jet {
        if self.spatial {
            self.run_with(at, &|k| Continued { here: Taylor::<3, 0>::coordinate(at.x[k], k), inside: inside.x[k] }, &[]).here.jet()
        } else {
            self.run_with(at, &|k| Continued { here: Taylor::<2, 0>::coordinate(at.x[k], k), inside: inside.x[k] }, &[]).here.jet()
        }
    }
}
