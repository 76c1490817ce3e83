//! Univariate B-splines of any degree on any open knot vector.

use super::{Basis, BasisStructure, Block, Elements, KnotError, Order, Polynomials, ShapeTable, knots};
use crate::linalg::{Real, Vector, num};

/// The B-splines of one degree on an open knot vector.
///
///   N_i^q(t) = (t - t_i) / (t_(i+q) - t_i) N_i^(q-1)(t) + (t_(i+q+1) - t) / (t_(i+q+1) - t_(i+1)) N_(i+1)^(q-1)(t)
///
/// Elements are the non-empty knot spans; local coordinate xi = (t - a) / (b - a) on the element [a, b]. Interior knots
/// may be repeated up to degree + 1 times (regularity -1, discontinuous). With all interior knots repeated that often
/// the functions are the Bernstein polynomials of every element.
///
/// Source: Piegl, Tiller, The NURBS Book (1997), algorithms A2.2 and A2.3.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline<T: Real = f64> {
    degree: usize,
    knots: Vec<T>,
    breakpoints: Vec<T>,
    /// Element e is the knot span [knots[k], knots[k + 1]) with k = spans[e].
    spans: Vec<usize>,
}

impl<T: Real> BSpline<T> {
    /// The B-splines of `degree` on `knots`.
    ///
    /// # Errors
    /// [`KnotError`] where knots decrease, are repeated more than degree + 1 times, are too few or not finite, or where
    /// the first or last knot is not repeated exactly degree + 1 times.
    ///
    /// ```
    /// use faying::basis::{Basis, BSpline, Elements};
    /// let spline = BSpline::try_new(2, vec![0.0, 0.0, 0.0, 1.0, 3.0, 3.0, 3.0])?;
    /// assert_eq!((spline.num_elements(), spline.num_functions()), (2, 4));
    /// # Ok::<(), faying::basis::KnotError>(())
    /// ```
    pub fn try_new(degree: usize, knots: Vec<T>) -> Result<Self, KnotError> {
        knots::check(degree, &knots)?;
        let spans: Vec<usize> = (0..knots.len() - 1).filter(|&k| knots[k] < knots[k + 1]).collect();
        let mut breakpoints: Vec<T> = spans.iter().map(|&k| knots[k]).collect();
        breakpoints.extend(knots.last().copied());
        Ok(Self { degree, knots, breakpoints, spans })
    }

    /// `elements` equal elements on [0, 1]; `continuity` between them, cut to what the degree allows (-1 to degree - 1).
    ///
    /// # Panics
    /// If `elements` is zero.
    pub fn uniform(degree: usize, elements: usize, continuity: isize) -> Self {
        assert!(elements > 0, "a spline has at least one element");
        let breakpoints: Vec<T> = (0..=elements).map(|k| num::<T>(k) / num::<T>(elements)).collect();
        Self::from_breakpoints(degree, &breakpoints, &vec![continuity; elements - 1])
    }

    /// Elements between rising `breakpoints`; `continuity[k]` at `breakpoints[k + 1]`, cut to what the degree allows.
    ///
    /// # Panics
    /// If there are fewer than two breakpoints, they do not rise, or there is not one continuity per interior one.
    pub fn from_breakpoints(degree: usize, breakpoints: &[T], continuity: &[isize]) -> Self {
        let n = breakpoints.len();
        assert!(n >= 2 && continuity.len() == n - 2, "one continuity per interior breakpoint");
        assert!(breakpoints.windows(2).all(|w| w[0] < w[1]), "breakpoints rise");
        let p = degree as isize;
        let mut knots = vec![breakpoints[0]; degree + 1];
        for (&t, &c) in breakpoints[1..n - 1].iter().zip(continuity) {
            let times = p - c.clamp(-1, (p - 1).max(-1));
            knots.extend((0..times).map(|_| t));
        }
        knots.extend((0..=degree).map(|_| breakpoints[n - 1]));
        Self::try_new(degree, knots).expect("rising breakpoints make an open knot vector")
    }

    /// The Bernstein polynomials of `degree` of every element between rising `breakpoints`: discontinuous splines.
    ///
    /// # Panics
    /// As [`BSpline::from_breakpoints`].
    pub fn bernstein(degree: usize, breakpoints: &[T]) -> Self {
        Self::from_breakpoints(degree, breakpoints, &vec![-1; breakpoints.len().saturating_sub(2)])
    }

    /// Polynomial degree.
    pub fn polynomial_degree(&self) -> usize {
        self.degree
    }

    /// The knot vector.
    pub fn knots(&self) -> &[T] {
        &self.knots
    }

    /// The different knots: ends of the elements, one more than elements.
    pub fn breakpoints(&self) -> &[T] {
        &self.breakpoints
    }

    /// The parameters [a, b] of `element`.
    pub fn interval(&self, element: usize) -> (T, T) {
        (self.breakpoints[element], self.breakpoints[element + 1])
    }

    /// The element of the parameter `t` and its local coordinate; at a breakpoint the element on the right, outside the
    /// knots the end element with a coordinate outside [0, 1].
    pub fn find(&self, t: T) -> (usize, T) {
        let inner = &self.breakpoints[1..self.breakpoints.len() - 1];
        let element = inner.partition_point(|&b| b <= t);
        let (a, b) = self.interval(element);
        (element, (t - a) / (b - a))
    }

    /// Greville parameters (t_(i+1) + .. + t_(i+p)) / p of the functions; for degree 0 the middle of the element.
    pub fn greville(&self) -> Vec<T> {
        let p = self.degree;
        let range = |i: usize| if p == 0 { &self.knots[i..i + 2] } else { &self.knots[i + 1..=i + p] };
        (0..self.num_functions()).map(|i| range(i).iter().fold(T::zero(), |s, &t| s + t) / num::<T>(range(i).len())).collect()
    }

    /// Multiplicity of the knot at `breakpoints()[breakpoint]`.
    pub fn multiplicity(&self, breakpoint: usize) -> usize {
        let end = |b: usize| self.spans.get(b).map_or(self.knots.len(), |&k| k + 1);
        end(breakpoint) - breakpoint.checked_sub(1).map_or(0, end)
    }

    /// Number of continuous derivatives at `breakpoints()[breakpoint]`: degree - multiplicity, -1 where discontinuous
    /// and at both ends.
    pub fn regularity(&self, breakpoint: usize) -> isize {
        self.degree as isize - self.multiplicity(breakpoint) as isize
    }

    /// The first active function on `element`; the others follow.
    pub fn first_active(&self, element: usize) -> usize {
        self.spans[element] - self.degree
    }

    /// The splines on the same breakpoints whose degree and regularity (per interior breakpoint) are given.
    fn on_same_breakpoints(&self, degree: usize, regularity: impl Fn(isize) -> isize) -> Self {
        let continuity: Vec<isize> = (1..self.num_elements()).map(|b| regularity(self.regularity(b))).collect();
        Self::from_breakpoints(degree, &self.breakpoints, &continuity)
    }

    /// Splines of the kind `wanted` on the same breakpoints, see [`Polynomials`]; `None` if the degree does not allow them.
    pub fn made_of(&self, wanted: Polynomials) -> Option<Self> {
        match wanted {
            Polynomials::Lowered(k) => {
                let degree = self.degree.checked_sub(k)?;
                Some(self.on_same_breakpoints(degree, |r| (r - k as isize).max(-1)))
            }
            Polynomials::Uniform { degree, continuity } => {
                let allowed = (-1..(degree as isize).max(0)).contains(&continuity);
                allowed.then(|| self.on_same_breakpoints(degree, |_| continuity))
            }
        }
    }
}

impl<T: Real> Elements for BSpline<T> {
    fn num_elements(&self) -> usize {
        self.spans.len()
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend([element, element + 1]);
    }
}

impl<T: Real> Basis<1, T> for BSpline<T> {
    fn num_functions(&self) -> usize {
        self.knots.len() - self.degree - 1
    }
    fn degree(&self, _element: usize) -> [usize; 1] {
        [self.degree]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        let first = self.first_active(element);
        ids.clear();
        ids.extend(first..=first + self.degree);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1, T>], order: Order, table: &mut ShapeTable<1, T>) {
        let (p, k) = (self.degree, self.spans[element]);
        table.reset(xi.len(), p + 1, order);
        let mut scratch = std::mem::take(&mut table.numbers);
        scratch.clear();
        scratch.resize(5 * p + 1, T::zero());
        let (u, rest) = scratch.split_at_mut(2 * p);
        let (n1, rest) = rest.split_at_mut(p); // degree p - 1
        let (n2, d1) = rest.split_at_mut(p); // degree p - 2, and the derivatives of degree p - 1
        let (a, b) = self.interval(element);
        for (j, uj) in u.iter_mut().enumerate() {
            *uj = (self.knots[k + 1 + j - p] - a) / (b - a); // in the element's coordinate: u[p - 1] = 0, u[p] = 1
        }
        for (q, x) in xi.iter().enumerate() {
            let x = x[0];
            let values = table.values_mut(q);
            values[0] = T::one();
            for r in 1..=p {
                if order >= Order::Hessians && r + 1 == p {
                    n2[..r].copy_from_slice(&values[..r]);
                }
                if order >= Order::Gradients && r == p {
                    n1[..r].copy_from_slice(&values[..r]);
                }
                let mut saved = T::zero();
                for j in 0..r {
                    let (left, right) = (x - u[p - r + j], u[p + j] - x);
                    let share = values[j] / (left + right);
                    values[j] = saved + right * share;
                    saved = left * share;
                }
                values[r] = saved;
            }
            if order >= Order::Gradients && p >= 1 {
                let grads = table.grads_mut(q);
                for j in 0..p {
                    let slope = num::<T>(p) * n1[j] / (u[p + j] - u[j]);
                    grads[j][0] -= slope;
                    grads[j + 1][0] += slope;
                }
            }
            if order >= Order::Hessians && p >= 2 {
                d1.fill(T::zero());
                for j in 0..p - 1 {
                    // one degree lower, the element's first knot difference starts one knot further
                    let slope = num::<T>(p - 1) * n2[j] / (u[p + j] - u[j + 1]);
                    d1[j] -= slope;
                    d1[j + 1] += slope;
                }
                let hessians = table.hessians_mut(q);
                for j in 0..p {
                    let slope = num::<T>(p) * d1[j] / (u[p + j] - u[j]);
                    hessians[j][0] -= slope;
                    hessians[j + 1][0] += slope;
                }
            }
        }
        table.numbers = scratch;
    }
    fn structure(&self) -> &dyn BasisStructure<1, T> {
        self
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<1, T>>> {
        Some(Box::new(self.made_of(wanted)?))
    }
}

impl<T: Real> BasisStructure<1, T> for BSpline<T> {
    fn block(&self, _element: usize) -> Option<Block<'_, 1, T>> {
        Some(Block { first: 0, axes: [self], weights: None })
    }
}
