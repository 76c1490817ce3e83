//! Patches without their matrix: what an operator holds between products.

use super::axis::Axis;
use super::diagonal::{self, ORDERS, squares};
use super::grid::{Points, QuadratureGrid};
use super::integrate;
use super::map::{Asks, Map};
use super::part::PatchNumbering;
use super::point_cache::{PointCache, keep};
use super::point_operator::PointOperator;
use super::product::product;
use super::tensor_field::TensorField;
use super::{Patch, Patches};
use crate::assembly::source::Integrand;
use crate::assembly::{Coefficient, Form};
use crate::linalg::{Real, lit};
use std::ops::Range;

/// Tables of patches, and what is kept at their points.
#[derive(Debug)]
pub(in crate::assembly) struct Free {
    patches: Vec<FreePatch>,
    /// Number in the whole of every function of the patches.
    ids: Option<Vec<u32>>,
}

#[derive(Debug)]
struct FreePatch {
    axes: Vec<Axis>,
    weight: Option<(TensorField, Vec<f64>)>,
    net: Option<TensorField>,
    kept: Option<PointCache>,
    first_element: usize,
    /// Its functions among those of all patches.
    functions: Range<usize>,
    arch: pulp::Arch,
}

impl Free {
    /// `patches` for products with `form`; `keeps`: a map without product structure and tangents that vary are computed
    /// once, not at every product, and so are the tangents of one component.
    ///
    /// `None` where a function is a sum of several of one patch: its diagonal entry is no contraction of squares.
    pub fn new<const C: usize, const N: usize, T: Real>(patches: Patches<'_>, form: &Form<'_, C, N, T>, keeps: bool) -> Option<Self> {
        let Patches { patches, glue } = patches;
        if glue.as_ref().is_some_and(|glue| !glue.merged.is_empty()) {
            return None;
        }
        let (mut element, mut function) = (0, 0);
        let mut all = Vec::with_capacity(patches.len());
        let source = Integrand::new(form);
        for patch in patches {
            let functions = function..function + patch.functions();
            let ids = glue.as_ref().map(|glue| &glue.ids[functions.clone()]);
            let own = FreePatch::new(patch, element, functions, ids, (form, &source), keeps);
            element += own.axes.iter().map(Axis::elements).product::<usize>();
            function = own.functions.end;
            all.push(own);
        }
        Some(Self { patches: all, ids: glue.map(|glue| glue.ids.clone()) })
    }

    /// Bytes that are kept per operator beside tables of one direction.
    pub fn bytes(&self) -> usize {
        let ids = self.ids.as_ref().map_or(0, |ids| 4 * ids.len());
        ids + self.patches.iter().map(FreePatch::bytes).sum::<usize>()
    }

    fn part(&self, patch: &FreePatch, width: usize) -> PatchNumbering<'_> {
        PatchNumbering { ids: self.ids.as_ref().map(|ids| &ids[patch.functions.clone()]), weights: None, width }
    }

    /// y = A x; `asks` returns an evaluator of the map of one element, for maps that are no net and not stored.
    pub fn apply<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, asks: &Asks<'_>, x: &[T], y: &mut [T]) {
        y.fill(T::zero());
        let source = Integrand::new(form);
        for patch in &self.patches {
            let part = PatchNumbering { weights: patch.weights(), ..self.part(patch, C) };
            let read = |from: usize, to: &mut [f64]| part.read(x, from, to);
            let slow = &patch.axes[N - 1];
            let owners = slow.owners();
            part.add(patch.functions.len(), y, |own| {
                let kinds = (2, 2 * own.len() / slow.functions.max(1));
                let mut add = |points: Range<usize>, planes: &[f64]| integrate::slow(slow, &owners, kinds, planes, points, own);
                patch.with_law::<C, N>(part, &source, asks, |grid, law| product(grid, law, C, &read, &mut add));
            });
        }
    }

    /// The diagonal.
    pub fn diagonal<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, asks: &Asks<'_>, out: &mut [T]) {
        out.fill(T::zero());
        let source = Integrand::new(form);
        for patch in &self.patches {
            let part = self.part(patch, C);
            part.add(patch.functions.len(), out, |own| patch.diagonal::<C, N, T>(part, &source, asks, own));
        }
    }
}

impl FreePatch {
    fn new<const C: usize, const N: usize, T: Real>(
        patch: Patch<'_>,
        first_element: usize,
        functions: Range<usize>,
        ids: Option<&[u32]>,
        (form, source): (&Form<'_, C, N, T>, &Integrand<'_>),
        keeps: bool,
    ) -> Self {
        // for one component the map costs more than the rest of a product, for several components less
        let tangents = C == 1 || !matches!(form.coefficient, Coefficient::Constant(_));
        let kept = (keeps && (tangents || matches!(patch.map, Map::Elements(..)))).then(|| {
            let law = if tangents { PointOperator::new::<N>(source, C) } else { None };
            let part = PatchNumbering { ids, weights: patch.weight.as_ref().map(|(_, weights)| &weights[..]), width: C };
            keep(patch.grid().with_state(part, source), law.as_ref(), form.symmetric, C)
        });
        let Patch { axes, map, weight, arch, .. } = patch;
        let net = if let (Map::TensorField(net), None) = (map, &kept) { Some(net) } else { None };
        Self { axes, weight, net, kept, first_element, functions, arch }
    }

    fn weights(&self) -> Option<&[f64]> {
        self.weight.as_ref().map(|(_, weights)| &weights[..])
    }

    fn bytes(&self) -> usize {
        let kept = self.kept.as_ref().map_or(0, PointCache::bytes);
        kept + 8 * (self.net.as_ref().map_or(0, |net| net.coefficients.len()) + 2 * self.weights().map_or(0, <[f64]>::len))
    }

    fn grid<'a, 'p>(&'a self, asks: &'a Asks<'p>) -> QuadratureGrid<'a, 'p> {
        let points = match (&self.kept, &self.net) {
            (Some(kept), _) => kept.points(),
            (None, Some(net)) => Points::TensorField(net),
            (None, None) => Points::Elements(asks),
        };
        let weight = self.weight.as_ref().map(|(net, _)| net);
        QuadratureGrid { axes: &self.axes, weight, state: None, points, first_element: self.first_element, arch: self.arch }
    }

    /// Calls `work` with the grid and the law of `source`, or that of the tangents that were kept; `part`: the functions of the patch.
    fn with_law<const C: usize, const N: usize>(
        &self,
        part: PatchNumbering<'_>,
        source: &Integrand<'_>,
        asks: &Asks<'_>,
        work: impl FnOnce(QuadratureGrid<'_, '_>, &PointOperator<'_>),
    ) {
        if let Some(tangent) = self.kept.as_ref().and_then(|kept| kept.tangent) {
            work(self.grid(asks), &PointOperator::Kept { symmetric: tangent.symmetric });
        } else if let Some(law) = PointOperator::new::<N>(source, C) {
            let part = PatchNumbering { weights: self.weights(), ..part };
            work(self.grid(asks).with_state(part, source), &law);
        }
    }

    /// Adds the diagonal to `out`, the functions of the patch alone, `part` of all.
    fn diagonal<const C: usize, const N: usize, T: Real>(
        &self,
        part: PatchNumbering<'_>,
        source: &Integrand<'_>,
        asks: &Asks<'_>,
        out: &mut [T],
    ) {
        let slow = &self.axes[N - 1];
        let owners = slow.owners();
        let mut sums = vec![0.0; out.len()];
        let plane = sums.len() / slow.functions.max(1);
        self.with_law::<C, N>(part, source, asks, |grid, law| {
            diagonal::diagonal(grid, law, C, &mut |points: Range<usize>, numbers: &[f64]| {
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
        if let Some(weights) = self.weights() {
            sums.chunks_exact_mut(C).zip(weights).for_each(|(sums, &w)| sums.iter_mut().for_each(|s| *s *= w * w));
        }
        out.iter_mut().zip(sums).for_each(|(out, sum)| *out += lit(sum));
    }
}
