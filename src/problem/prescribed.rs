//! Prescribed values at a time: L2 projections onto sides, edges and corners.

use super::corner_search;
use super::data::Point;
use super::model::{BodyRim, BodySide, Condition, Model, PointCondition, Value};
use crate::assembly::{DirichletError, Pinned, Prescribed, Rim, dirichlet_with};
use crate::basis::Extracted;
use crate::linalg::{Ldlt, Vector};
use crate::space::{Field, FunctionSpace, Trace};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The two conditions that an error is about: numbers of [`Model::conditions`], behind them of [`Model::pins`].
pub type Conditions = Option<(usize, usize)>;

impl<const S: usize, const N: usize> Model<S, N> {
    /// (unknown, value) of all prescribed components at time `t`, ascending.
    ///
    /// # Errors
    /// [`DirichletError`] with the conditions that disagree.
    ///
    /// # Panics
    /// If a condition takes the value of the exact solution and there is none.
    pub fn prescribed(&self, t: f64) -> Result<Vec<(usize, f64)>, Box<(DirichletError, Conditions)>> {
        self.projected(|value, (patch, component)| match value {
            Value::Zero => None,
            Value::Exact => {
                let exact = self.patches[patch].exact.as_ref().expect("exact data were refused without an exact solution");
                Some(Box::new(move |x: &Vector<N>| exact.value(component, &Point::new(x.as_slice()).at_time(t))))
            }
            Value::Data(f) => Some(Box::new(move |x: &Vector<N>| f.value(&Point::new(x.as_slice()).at_time(t)))),
        })
    }

    /// Corners that bodies have in common, then one L2 projection per glued body and component of values given per condition, patch and component; of glued
    /// unknowns only the one that stands for all is listed.
    ///
    /// # Errors
    /// As [`Model::prescribed`].
    pub(super) fn projected<'a>(
        &'a self,
        value: impl Fn(&'a Value, (usize, usize)) -> Option<Box<dyn Fn(&Vector<N>) -> f64 + Sync + 'a>>,
    ) -> Result<Vec<(usize, f64)>, Box<(DirichletError, Conditions)>> {
        let mut all = Vec::new();
        let mut by_body: BTreeMap<usize, [Vec<usize>; 2]> = BTreeMap::new();
        for (k, condition) in self.conditions.iter().enumerate() {
            by_body.entry(self.glued.body(condition.side.patch)).or_default()[0].push(k);
        }
        for (k, pin) in self.pins.iter().enumerate() {
            by_body.entry(self.glued.body(pin.rim.patch)).or_default()[1].push(k);
        }
        for (body, [of_sides, of_rims]) in &by_body {
            let mine: Vec<&Condition<S, N>> = of_sides.iter().map(|&k| &self.conditions[k]).collect();
            let pins: Vec<&PointCondition<N>> = of_rims.iter().map(|&k| &self.pins[k]).collect();
            let values: Vec<_> = mine.iter().map(|c| value(&c.value, (c.side.patch, c.component))).collect();
            let pin_values: Vec<_> = pins.iter().map(|p| value(&p.value, (p.rim.patch, p.component))).collect();
            let rims: Vec<Rim<N>> = pins.iter().map(|p| self.rim_in_model(&p.rim)).collect();
            let pinned: Vec<Pinned<'_, N>> = pins
                .iter()
                .zip(&pin_values)
                .zip(&rims)
                .map(|((p, v), rim)| Pinned { rim, component: p.component, value: v.as_deref() })
                .collect();
            let traces: Vec<Trace<S, N>> = mine.iter().map(|c| self.in_model(&c.side)).collect();
            let fixed: Vec<Prescribed<'_, S, N>> = mine
                .iter()
                .zip(&values)
                .zip(&traces)
                .map(|((c, v), trace)| Prescribed { trace, component: c.component, value: v.as_deref() })
                .collect();
            let field = Field { first: 0, components: self.components };
            // corners that other bodies have, too, before all sides
            let mut corners = Vec::new();
            for corner in self.corners.iter().filter(|c| self.glued.body(self.conditions[c.condition].side.patch) == *body) {
                let condition = &self.conditions[corner.condition];
                let prescribed =
                    value(&condition.value, (condition.side.patch, condition.component)).map_or(0.0, |v| v(&corner.x)) / corner.value;
                // data without a value in the corner itself are projected there
                if prescribed.is_finite() {
                    corners.push((field.unknown(corner.function, condition.component), prescribed));
                }
            }
            let extra_points = mine.iter().map(|c| self.patches[c.side.patch].extra_points).max().unwrap_or(0);
            let at: Vec<usize> = of_sides.iter().copied().chain(of_rims.iter().map(|&k| self.conditions.len() + k)).collect();
            let numbers = |e: &DirichletError| match e {
                DirichletError::Conflict { first, second, .. } => Some((at[*first], at[*second])),
                _ => at.first().map(|&at| (at, at)),
            };
            let part = dirichlet_with(&fixed, &pinned, &corners, field, extra_points, &mut Ldlt::new()).map_err(|e| {
                let numbers = numbers(&e);
                Box::new((e, numbers))
            })?;
            all.extend(part);
        }
        all.sort_by_key(|v| v.0);
        self.combine(&mut all);
        Ok(all)
    }

    /// Functions that are combinations of prescribed ones are prescribed, too, with the value of the combination.
    fn combine(&self, values: &mut Vec<(usize, f64)>) {
        let n = self.components;
        for (a, terms) in self.glued.combined() {
            for c in 0..n {
                let place = |values: &[(usize, f64)], f: usize| values.binary_search_by_key(&(n * self.glued.root(f) + c), |v| v.0);
                let sum = terms.iter().try_fold(0.0, |sum, &(b, factor)| place(values, b).ok().map(|k| sum + factor * values[k].1));
                let Some(sum) = sum else { continue };
                match place(values, *a) {
                    Ok(k) => values[k].1 = sum,
                    Err(k) => values.insert(k, (n * self.glued.root(*a) + c, sum)),
                }
            }
        }
    }

    /// (function, coefficient) of `value` on everything that is held by conditions, equations or pins, whatever the
    /// component: one L2 projection per glued body; functions as [`Self::function`] numbers them.
    pub(super) fn coefficients(&self, value: &(dyn Fn(&Vector<N>) -> f64 + Sync)) -> Vec<(usize, f64)> {
        let mut by_body: BTreeMap<usize, (Vec<Trace<S, N>>, Vec<Rim<N>>, usize)> = BTreeMap::new();
        for side in &self.supports {
            let body = by_body.entry(self.glued.body(side.patch)).or_default();
            body.0.push(self.in_model(side));
            body.2 = body.2.max(self.patches[side.patch].extra_points);
        }
        for pin in &self.pins {
            by_body.entry(self.glued.body(pin.rim.patch)).or_default().1.push(self.rim_in_model(&pin.rim));
        }
        let field = Field { first: 0, components: 1 };
        let mut all = Vec::new();
        for (traces, rims, extra) in by_body.values() {
            let fixed: Vec<_> = traces.iter().map(|trace| Prescribed { trace, component: 0, value: Some(value) }).collect();
            let pinned: Vec<_> = rims.iter().map(|rim| Pinned { rim, component: 0, value: Some(value) }).collect();
            match dirichlet_with(&fixed, &pinned, &[], field, *extra, &mut Ldlt::new()) {
                Ok(found) => all.extend(found),
                // sides glued with a gap place their common corners differently: each side by itself
                Err(_) => {
                    let sides = fixed.iter().map(|f| dirichlet_with(&[*f], &[], &[], field, *extra, &mut Ldlt::new()));
                    let rims = pinned.iter().map(|p| dirichlet_with::<S, N, f64>(&[], &[*p], &[], field, *extra, &mut Ldlt::new()));
                    all.extend(rims.chain(sides).flatten().flatten());
                }
            }
        }
        all
    }

    /// Finds the corners in which prescribed sides of several bodies meet.
    pub fn find_corners(&mut self) {
        self.corners = corner_search::shared(self, &|k| self.in_model(&self.conditions[k].side));
    }

    /// The trace of a side in functions of the model: unknown / components, glued ones by the one that stands for all, those
    /// that are combinations by the functions they are made of.
    pub(super) fn in_model(&self, side: &BodySide<S, N>) -> Trace<S, N> {
        let own: Vec<usize> = side.trace.dofs.iter().map(|&dof| self.function(side.patch, dof)).collect();
        let combined = self.glued.combined();
        let parts: HashMap<usize, &[(usize, f64)]> = combined.iter().map(|(a, terms)| (self.glued.root(*a), terms.as_slice())).collect();
        if own.iter().all(|f| !parts.contains_key(f)) {
            return Trace { dofs: own, ..side.trace.clone() };
        }
        let (mut dofs, mut place) = (Vec::new(), HashMap::new());
        let mut number = |f: usize| {
            *place.entry(f).or_insert_with(|| {
                dofs.push(f);
                dofs.len() - 1
            })
        };
        let rows: Vec<Vec<(usize, f64)>> = own
            .iter()
            .map(|f| match parts.get(f) {
                Some(terms) => terms.iter().map(|&(b, c)| (number(self.glued.root(b)), c)).collect(),
                None => vec![(number(*f), 1.0)],
            })
            .collect();
        let geometry = side.trace.space.clone();
        let basis = Extracted::new::<S>(geometry.clone(), dofs.len(), rows);
        Trace { space: Arc::new(FunctionSpace { basis, geometry }), dofs, ..side.trace.clone() }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// An edge or a corner in functions of the model, as [`Self::in_model`].
    fn rim_in_model(&self, rim: &BodyRim<N>) -> Rim<N> {
        let mut out = rim.rim.clone();
        for f in out.shapes.iter_mut().flatten() {
            f.0 = self.function(rim.patch, f.0);
        }
        out
    }
}
