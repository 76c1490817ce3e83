//! Prescribed values at a given time, and the unknowns that supports eliminate.

use super::Builder;
use super::boundary::component_name;
use super::corners;
use super::model::{Condition, Model, Pin, RimModel, SideModel, Value};
use super::values::{time_text, times};
use crate::errors::Diagnostic;
use crate::formula::Point;
use crate::place::Place;
use faying::assembly::{DirichletError, Fixed as Prescribed, Pinned, Rim, dirichlet_with};
use faying::basis::Extracted;
use faying::linalg::{Ldlt, LinearError, Vector};
use faying::space::{Field, Over, Trace};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Unknowns eliminated by supports.
#[derive(Clone, Debug)]
pub(super) struct Fixed {
    taken: Vec<bool>,
}

impl Fixed {
    /// Finds the unknowns of `model` that are prescribed or bound by an equation.
    pub fn of<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, model: &Model<S, N>) -> Result<Self, Box<Diagnostic>> {
        let mut taken = vec![false; model.unknowns];
        let changes = model.conditions.iter().any(|c| match &c.value {
            Value::Zero => false,
            Value::Exact => builder.case.model.exact.iter().flat_map(|e| &e.value).any(|f| f.depends_on_time()),
            Value::Formula(f) => f.depends_on_time(),
        });
        // values that contradict each other at a later time are reported now, too
        for &t in times(builder.case, changes) {
            for (unknown, _) in model.prescribed(t).map_err(|e| conflict(builder, model, &e.0, e.1, &time_text(changes, t)))? {
                taken[unknown] = true;
            }
        }
        for equation in &model.equations {
            // the reduction binds the unknown with the largest coefficient that is still free
            let free = equation.terms.iter().map(|&(i, c)| (model.glued.unknown(i), c)).filter(|(i, _)| !taken[*i]);
            if let Some((i, _)) = free.fold(None, |best: Option<(usize, f64)>, t| best.filter(|b| b.1.abs() >= t.1.abs()).or(Some(t))) {
                taken[i] = true;
            }
        }
        // a function glued to a held function is held
        for i in 0..model.unknowns {
            taken[i] = taken[model.glued.unknown(i)];
        }
        for (a, terms) in model.glued.combined() {
            for c in 0..model.components {
                taken[model.components * a + c] |= terms.iter().all(|&(b, _)| taken[model.components * b + c]);
            }
        }
        Ok(Self { taken })
    }

    /// Whether `unknown` is eliminated.
    pub fn is(&self, unknown: usize) -> bool {
        self.taken[unknown]
    }
}

/// Source locations of the two conditions of an error.
pub(crate) type Places = Option<(Place, Place)>;

impl<const S: usize, const N: usize> Model<S, N> {
    /// Returns (unknown, value) of all prescribed components at time `t`, ascending; an error comes with the source locations of the
    /// conditions that disagree.
    pub(crate) fn prescribed(&self, t: f64) -> Result<Vec<(usize, f64)>, Box<(DirichletError, Places)>> {
        self.projected(|value, component| match value {
            Value::Zero => None,
            Value::Exact => {
                let exact = self.exact.as_ref().expect("exact data were refused without an exact solution");
                Some(Box::new(move |x: &Vector<N>| exact.value(component, &Point::new(x.as_slice()).at_time(t))))
            }
            Value::Formula(f) => Some(Box::new(move |x: &Vector<N>| f.value(&Point::new(x.as_slice()).at_time(t)))),
        })
    }

    /// Computes (unknown, value) of all prescribed components: corners shared by several bodies first, then one L2 projection per glued
    /// body and component of the values given per condition. Of glued unknowns only the representative is listed.
    pub(crate) fn projected<'a>(
        &'a self,
        value: impl Fn(&'a Value, usize) -> Option<Box<dyn Fn(&Vector<N>) -> f64 + Sync + 'a>>,
    ) -> Result<Vec<(usize, f64)>, Box<(DirichletError, Places)>> {
        let mut all = Vec::new();
        let mut by_body: BTreeMap<usize, (Vec<&Condition<S, N>>, Vec<&Pin<N>>)> = BTreeMap::new();
        for condition in &self.conditions {
            by_body.entry(self.glued.body(condition.side.patch)).or_default().0.push(condition);
        }
        for pin in &self.pins {
            by_body.entry(self.glued.body(pin.rim.patch)).or_default().1.push(pin);
        }
        for (body, (mine, pins)) in &by_body {
            let values: Vec<_> = mine.iter().map(|c| value(&c.value, c.component)).collect();
            let pin_values: Vec<_> = pins.iter().map(|p| value(&p.value, p.component)).collect();
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
            // corners shared with other bodies, before all sides
            let mut corners = Vec::new();
            for corner in self.corners.iter().filter(|c| self.glued.body(self.conditions[c.condition].side.patch) == *body) {
                let condition = &self.conditions[corner.condition];
                let prescribed = value(&condition.value, condition.component).map_or(0.0, |v| v(&corner.x)) / corner.value;
                // data that are not finite at the corner itself are projected there
                if prescribed.is_finite() {
                    corners.push((field.unknown(corner.function, condition.component), prescribed));
                }
            }
            let extra_points = mine.iter().map(|c| self.patches[c.side.patch].extra_points).max().unwrap_or(0);
            let at: Vec<Place> = mine.iter().map(|c| c.at).chain(pins.iter().map(|p| p.at)).collect();
            let places = |e: &DirichletError| match e {
                DirichletError::Conflict { first, second, .. } => Some((at[*first], at[*second])),
                _ => at.first().map(|&at| (at, at)),
            };
            let part = dirichlet_with(&fixed, &pinned, &corners, field, extra_points, &mut Ldlt::new()).map_err(|e| {
                let places = places(&e);
                Box::new((e, places))
            })?;
            all.extend(part);
        }
        all.sort_by_key(|v| v.0);
        self.combine(&mut all);
        Ok(all)
    }

    /// Adds functions that are combinations of prescribed ones, with the combined value.
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

    /// Returns (function, coefficient) of the L2 projection of `value` on all functions held by conditions, equations or pins, in any
    /// component: one projection per glued body; functions are numbered as in [`Self::function`].
    pub(crate) fn coefficients(&self, value: &(dyn Fn(&Vector<N>) -> f64 + Sync)) -> Vec<(usize, f64)> {
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
                // sides glued across a gap have different corner positions: each side by itself
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
    pub(super) fn find_corners(&mut self) {
        self.corners = corners::shared(self, &|k| self.in_model(&self.conditions[k].side));
    }

    /// Returns the trace of a side in functions of the model (unknown / components): glued functions by their representative, dependent
    /// ones by the functions they combine.
    fn in_model(&self, side: &SideModel<S, N>) -> Trace<S, N> {
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
        Trace { space: Arc::new(Over { basis, geometry }), dofs, ..side.trace.clone() }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Returns an edge or a corner in functions of the model, as [`Self::in_model`].
    fn rim_in_model(&self, rim: &RimModel<N>) -> Rim<N> {
        let mut out = rim.rim.clone();
        for f in out.shapes.iter_mut().flatten() {
            f.0 = self.function(rim.patch, f.0);
        }
        out
    }
}

/// Builds the diagnostic of an error in prescribed values: E052 if they disagree, E017 if they are not finite, else E072.
fn conflict<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
    error: &DirichletError,
    places: Places,
    time: &str,
) -> Diagnostic {
    let (first, second) = places.unwrap_or_default();
    match error {
        DirichletError::Conflict { component, at, first_value, second_value, .. } => {
            let name = component_name(*component, model.components);
            let place: Vec<String> = at[..N].iter().map(|x| format!("{x}")).collect();
            let lines = first.in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
            builder
                .error(
                    "E052",
                    format!(
                        "component {name} is prescribed as {first_value}{lines} and as {second_value} at the common point ({}{time})",
                        place.join(", ")
                    ),
                    second,
                )
                .with_help("make the values equal there, or prescribe one of them")
        }
        DirichletError::Projection { source: LinearError::NotFinite, .. } => {
            builder.error("E017", format!("a prescribed value is not finite somewhere on its side{time}"), second)
        }
        other => builder.error("E072", other.to_string(), second),
    }
}
