//! Spline coefficients on finer knots and in higher degrees: the same functions, written in a larger space.

use super::{BSpline, Basis, ContainError, Elements, KnotError};
use crate::linalg::{Real, Vector, lit, num, to_f64};

/// Knots closer than this many roundings of the parameter range are the same knot.
const SAME_KNOT: f64 = 64.0;

/// `a` x + `b` y, entry by entry.
fn blend<T: Real>(a: T, x: &[T], b: T, y: &[T]) -> Vec<T> {
    x.iter().zip(y).map(|(&x, &y)| a * x + b * y).collect()
}

impl<T: Real> BSpline<T> {
    /// The splines with `t` repeated once more, and the coefficients that keep every function: one row of numbers per
    /// function, as many columns as there are functions to carry over.
    ///
    /// Source: W. Boehm, Computer-Aided Design 12 (1980) 199-201: every new row is a convex combination of two old ones.
    ///
    /// # Errors
    /// [`KnotError`] if `t` lies outside the open parameter interval or is repeated degree + 1 times already.
    ///
    /// # Panics
    /// If there is not one row per function.
    pub fn insert(&self, t: T, rows: &mut Vec<Vec<T>>) -> Result<Self, KnotError> {
        self.insert_all(&[t], rows)
    }

    /// [`BSpline::insert`] of several knots, which ascend: one pass over the knots, however many they are.
    ///
    /// # Errors
    /// As [`BSpline::insert`]; `rows` are as they were.
    ///
    /// # Panics
    /// If there is not one row per function, or if the knots do not ascend.
    pub fn insert_all(&self, new: &[T], rows: &mut Vec<Vec<T>>) -> Result<Self, KnotError> {
        assert_eq!(rows.len(), self.num_functions(), "one row of coefficients per function");
        assert!(new.is_sorted(), "knots to be inserted ascend");
        let p = self.polynomial_degree();
        let (mut all, mut old) = (Vec::with_capacity(self.knots().len() + new.len()), self.knots());
        for &t in new {
            let count = old.iter().take_while(|&&x| x <= t).count();
            all.extend_from_slice(&old[..count]);
            all.push(t);
            old = &old[count..];
        }
        all.extend_from_slice(old);
        let finer = Self::try_new(p, all)?;
        // as many rows as knots are behind; those ahead are still the old ones
        let (mut behind, knots, mut passed) = (Vec::with_capacity(finer.num_functions()), finer.knots(), 0);
        let (mut ahead, mut old) = (std::mem::take(rows).into_iter(), self.knots());
        for &t in new {
            let count = old.iter().take_while(|&&x| x <= t).count();
            passed += count;
            behind.extend(ahead.by_ref().take(count));
            old = &old[count..];
            let k = passed - 1; // knots[k] <= t < old[0]
            let s = knots[..passed].iter().rev().take_while(|&&x| x == t).count();
            let knot = |i: usize| if i <= k { knots[i] } else { old[i - k - 1] };
            let share = |i: usize| (t - knots[i]) / (knot(i + p) - knots[i]);
            if s >= p {
                // the function that is one at t is cut in two
                let row = behind[k - p].clone();
                behind.insert(k - p, row);
            } else {
                let changed = k + 1 - p..k + 1 - s;
                let blended: Vec<Vec<T>> = changed.map(|i| blend(share(i), &behind[i], T::one() - share(i), &behind[i - 1])).collect();
                behind.splice(k + 1 - p..k - s, blended);
            }
            passed += 1;
        }
        behind.extend(ahead);
        *rows = behind;
        Ok(finer)
    }

    /// The splines of degree + `times` with the same breakpoints and regularity, and the coefficients that keep every
    /// function (rows as in [`BSpline::insert`]).
    ///
    /// The coefficient of function i is the polar form of any of its elements at the knots t_(i+1) .. t_(i+q), computed in
    /// Bernstein form; of elements \[a, b\] the one is taken that lets rounding grow least, by the product of
    /// (|b - t| + |t - a|) / (b - a) over these knots.
    ///
    /// Source: L. Ramshaw, Blossoming (1987), DEC SRC report 19.
    ///
    /// # Panics
    /// If there is not one row per function.
    pub fn elevate(&self, times: usize, rows: &[Vec<T>]) -> (Self, Vec<Vec<T>>) {
        assert_eq!(rows.len(), self.num_functions(), "one row of coefficients per function");
        let (p, q, n) = (self.polynomial_degree(), self.polynomial_degree() + times, self.num_elements());
        if times == 0 {
            return (self.clone(), rows.to_vec());
        }
        let regularity: Vec<isize> = (1..n).map(|b| self.regularity(b)).collect();
        let target = Self::from_breakpoints(q, self.breakpoints(), &regularity);
        // Bernstein coefficients of every element, the degree raised there
        let mut pieces = rows.to_vec();
        let missing = |b: usize| std::iter::repeat_n(self.breakpoints()[b], p.saturating_sub(self.multiplicity(b)));
        let bezier = self.insert_all(&(1..n).flat_map(missing).collect::<Vec<T>>(), &mut pieces);
        let bezier = bezier.expect("interior knots below their largest multiplicity");
        let raised = |e: usize| -> Vec<Vec<T>> {
            let first = bezier.first_active(e);
            (0..=q)
                .map(|k| {
                    let mut row = vec![T::zero(); pieces[first].len()];
                    for j in k.saturating_sub(times)..=k.min(p) {
                        let share = binomial::<T>(p, j) * binomial::<T>(times, k - j) / binomial::<T>(q, k);
                        row.iter_mut().zip(&pieces[first + j]).for_each(|(r, &c)| *r += share * c);
                    }
                    row
                })
                .collect()
        };
        let (mut start, mut element, mut piece) = (0, usize::MAX, Vec::new());
        let mut out = Vec::with_capacity(target.num_functions());
        for i in 0..target.num_functions() {
            let arguments = &target.knots()[i + 1..=i + q];
            let growth = |e: usize| {
                let (a, b) = target.interval(e);
                arguments.iter().fold(T::one(), |g, &t| g * (((b - t) / (b - a)).abs() + ((t - a) / (b - a)).abs()))
            };
            while target.first_active(start) + q < i {
                start += 1;
            }
            let support = (start..n).take_while(|&e| target.first_active(e) <= i);
            let least = support.map(|e| (growth(e), e)).reduce(|x, y| if y.0 < x.0 { y } else { x });
            let (_, e) = least.expect("every function has an element");
            if e != element {
                (element, piece) = (e, raised(e));
            }
            let (a, b) = target.interval(e);
            let mut c = piece.clone();
            for (r, &t) in arguments.iter().enumerate() {
                let u = (t - a) / (b - a);
                for k in 0..q - r {
                    c[k] = blend(T::one() - u, &c[k], u, &c[k + 1]);
                }
            }
            out.push(c.swap_remove(0));
        }
        (target, out)
    }

    /// Coefficients in the space of `to` that keep every function (rows as in [`BSpline::insert`]): degrees may be higher,
    /// knots more, regularity lower.
    ///
    /// # Errors
    /// [`ContainError`] if `to` does not contain the splines of `self`.
    ///
    /// # Panics
    /// If there is not one row per function.
    pub fn express_in(&self, to: &Self, rows: &[Vec<T>]) -> Result<Vec<Vec<T>>, ContainError> {
        let (own, other) = (self.breakpoints(), to.breakpoints());
        let range = own[own.len() - 1] - own[0];
        let same = |a: T, b: T| (a - b).abs() <= lit::<T>(SAME_KNOT) * T::default_epsilon() * range;
        let times = to.polynomial_degree().checked_sub(self.polynomial_degree());
        let times = times.ok_or(ContainError::Degree { found: to.polynomial_degree(), needed: self.polynomial_degree() })?;
        for (found, needed) in [(other[0], own[0]), (other[other.len() - 1], own[own.len() - 1])] {
            if !same(found, needed) {
                return Err(ContainError::Ends { found: to_f64(found), needed: to_f64(needed) });
            }
        }
        // the breakpoint of `to` that is the interior breakpoint b of `self`
        let partner = |b: usize| {
            let c = other.partition_point(|&x| x < own[b] && !same(x, own[b]));
            (c > 0 && c < to.num_elements() && same(other[c], own[b])).then_some(c)
        };
        for b in 1..self.num_elements() {
            let found = partner(b).map_or(to.polynomial_degree() as isize, |c| to.regularity(c));
            if found > self.regularity(b) {
                return Err(ContainError::Continuity { knot: to_f64(own[b]), found, needed: self.regularity(b) });
            }
        }
        let (spline, mut out) = self.elevate(times, rows);
        let mut new = Vec::new();
        for c in 1..to.num_elements() {
            let b = own.partition_point(|&x| x < other[c] && !same(x, other[c]));
            let known = same(own[b], other[c]);
            let (t, there) = if known { (own[b], self.multiplicity(b) + times) } else { (other[c], 0) };
            new.extend(std::iter::repeat_n(t, to.multiplicity(c).saturating_sub(there)));
        }
        // knots that are the same up to rounding may be those of either
        new.sort_by(|a, b| a.partial_cmp(b).expect("knots are finite"));
        spline.insert_all(&new, &mut out).expect("the space of `to` has these knots");
        debug_assert_eq!(out.len(), to.num_functions());
        Ok(out)
    }

    /// Value at the parameter `t` of the functions whose coefficients are the columns of `rows`.
    pub fn value_at(&self, t: T, rows: &[Vec<T>]) -> Vec<T> {
        let (element, xi) = self.find(t);
        let mut table = super::ShapeTable::new();
        self.tabulate(element, &[Vector::<1, T>::new(xi)], super::Order::Values, &mut table);
        let first = self.first_active(element);
        let mut sum = vec![T::zero(); rows.first().map_or(0, Vec::len)];
        for (a, &n) in table.values(0).iter().enumerate() {
            sum.iter_mut().zip(&rows[first + a]).for_each(|(s, &c)| *s += n * c);
        }
        sum
    }
}

/// n over k.
fn binomial<T: Real>(n: usize, k: usize) -> T {
    (0..k).fold(T::one(), |b, j| b * num::<T>(n - j) / num::<T>(j + 1))
}
