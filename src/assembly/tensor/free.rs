//! A patch without its matrix: what an operator holds between products.

use super::Patch;
use super::axis::Axis;
use super::diagonal::{self, ORDERS, squares};
use super::gather;
use super::grid::{Grid, Points};
use super::keep::{Kept, keep};
use super::law::Law;
use super::map::{Asks, Map};
use super::net::Net;
use super::product::product;
use crate::assembly::source::Source;
use crate::assembly::{Coefficient, Form};
use crate::linalg::{Real, lit, to_f64};
use std::ops::Range;

/// Tables of a patch, and what is kept at its points.
#[derive(Debug)]
pub(in crate::assembly) struct Free {
    axes: Vec<Axis>,
    weight: Option<(Net, Vec<f64>)>,
    net: Option<Net>,
    kept: Option<Kept>,
}

impl<'p> Patch<'p> {
    pub(super) fn grid(&self) -> Grid<'_, 'p> {
        let points = match &self.map {
            Map::Net(net) => Points::Net(net),
            Map::Elements(asks, _) => Points::Elements(*asks),
        };
        Grid { axes: &self.axes, weight: self.weight.as_ref().map(|(net, weights)| (net, &weights[..])), points }
    }
}

impl Free {
    /// `patch` for products with `form`; `keeps`: a map without product structure and tangents that vary are computed
    /// once, not at every product, and so are the tangents of one component.
    pub fn new<const C: usize, const N: usize, T: Real>(patch: Patch<'_>, form: &Form<'_, C, N, T>, keeps: bool) -> Self {
        // the map is dearer than all that is done with one component; of several it is the lesser part
        let tangents = C == 1 || matches!(form.coefficient, Coefficient::PerPoint(_));
        let kept = (keeps && (tangents || matches!(patch.map, Map::Elements(..)))).then(|| {
            let source = Source::new(form);
            let law = if tangents { Law::new::<N>(&source, C) } else { None };
            keep(patch.grid(), law.as_ref(), form.symmetric, C)
        });
        let Patch { axes, map, weight, .. } = patch;
        let net = if let (Map::Net(net), None) = (map, &kept) { Some(net) } else { None };
        Self { axes, weight, net, kept }
    }

    /// Number of functions.
    pub fn functions(&self) -> usize {
        self.axes.iter().map(|a| a.functions).product()
    }

    /// Bytes that are kept per operator beside tables of one direction.
    pub fn bytes(&self) -> usize {
        let kept = self.kept.as_ref().map_or(0, Kept::bytes);
        kept + 8 * (self.net.as_ref().map_or(0, |net| net.coefficients.len()) + self.weight.as_ref().map_or(0, |w| 2 * w.1.len()))
    }

    fn grid<'a, 'p>(&'a self, asks: &'a Asks<'p>) -> Grid<'a, 'p> {
        let points = match (&self.kept, &self.net) {
            (Some(kept), _) => kept.points(),
            (None, Some(net)) => Points::Net(net),
            (None, None) => Points::Elements(asks),
        };
        Grid { axes: &self.axes, weight: self.weight.as_ref().map(|(net, weights)| (net, &weights[..])), points }
    }

    /// Calls `work` with the law of `form`, or with that of the tangents that were kept.
    fn with_law<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, work: impl FnOnce(&Law<'_>)) {
        if let Some(tangent) = self.kept.as_ref().and_then(|kept| kept.tangent) {
            work(&Law::Kept { symmetric: tangent.symmetric });
            return;
        }
        if let Some(law) = Law::new::<N>(&Source::new(form), C) {
            work(&law);
        }
    }

    /// y = A x; `asks` gives the map of one element where nothing else is known of it.
    pub fn apply<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, asks: &Asks<'_>, x: &[T], y: &mut [T]) {
        let weights = self.weight.as_ref().map(|(_, weights)| &weights[..]);
        let read = |from: usize, to: &mut [f64]| {
            to.iter_mut().zip(&x[from..]).for_each(|(to, &x)| *to = to_f64(x));
            if let Some(weights) = weights {
                to.iter_mut().enumerate().for_each(|(k, to)| *to *= weights[(from + k) / C]);
            }
        };
        y.fill(T::zero());
        let slow = &self.axes[N - 1];
        let owners = slow.owners();
        self.with_law(form, |law| {
            let mut add = |points: Range<usize>, planes: &[f64]| gather::slow(slow, &owners, 2, planes, points, y);
            product(self.grid(asks), law, C, &read, &mut add);
        });
        if let Some(weights) = weights {
            y.chunks_exact_mut(C).zip(weights).for_each(|(y, &w)| y.iter_mut().for_each(|y| *y *= lit(w)));
        }
    }

    /// The diagonal.
    pub fn diagonal<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, asks: &Asks<'_>) -> Vec<T> {
        let slow = &self.axes[N - 1];
        let owners = slow.owners();
        let mut sums = vec![0.0; C * self.functions()];
        let plane = sums.len() / slow.functions.max(1);
        self.with_law(form, |law| {
            diagonal::diagonal(self.grid(asks), law, C, &mut |points: Range<usize>, numbers: &[f64]| {
                for (q, numbers) in points.zip(numbers.chunks_exact(plane * ORDERS)) {
                    for a in 0..slow.active {
                        let squares = squares(slow, q, a);
                        let to = &mut sums[(slow.first[owners[q]] + a) * plane..][..plane];
                        for (to, kinds) in to.iter_mut().zip(numbers.chunks_exact(ORDERS)) {
                            *to += (squares[0] * kinds[0] + squares[1] * kinds[1]) + squares[2] * kinds[2];
                        }
                    }
                }
            });
        });
        if let Some((_, weights)) = &self.weight {
            sums.chunks_exact_mut(C).zip(weights).for_each(|(sums, &w)| sums.iter_mut().for_each(|s| *s *= w * w));
        }
        sums.into_iter().map(lit).collect()
    }
}
