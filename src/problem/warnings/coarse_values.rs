//! Prescribed values that the functions of a side hold badly.
//!
//! Values g are projected in L2, g_h. Where |g - g_h| / |g|, in L2 over the side, is large, the problem that is solved has other values than
//! those that are stated: they change within elements, or they jump. Values of an exact solution are left out: their error is measured.

use super::warning::Warning;
use crate::assembly::gauss_rules;
use crate::basis::{Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::measure;
use crate::problem::data::{Data, Point};
use crate::problem::load_accuracy::{Integral, looked_at};
use crate::problem::model::{Condition, Model, Value};
use crate::quadrature::Quadrature;

/// Largest error that is not told.
const COARSE: f64 = 0.3;
/// Values below this share of the size of the model, in the mean, are rounding of their formulas.
const ROUNDING: f64 = 1e-12;
/// Gauss points per direction beyond those of the side, to see what its own points do not.
const EXTRA: usize = 8;

/// Finds the conditions whose values the functions of their sides hold badly at one of `times`, each at the worst of them; those whose integral
/// is inexact are `told` already.
pub(super) fn coarse_values<const S: usize, const N: usize>(model: &Model<S, N>, times: &[f64], told: &[Warning]) -> Vec<Warning> {
    let varying = |c: &&Condition<S, N>| matches!(&c.value, Value::Data(f) if f.as_constant().is_none());
    let is_told = |c: &&Condition<S, N>| {
        let same = |of: &Integral| matches!(of, Integral::Prescribed { of, component, .. } if *of == c.of && *component == c.component);
        told.iter().any(|w| matches!(w, Warning::Inexact(inexact) if same(&inexact.of)))
    };
    let asked: Vec<&Condition<S, N>> = model.conditions.iter().filter(varying).filter(|c| !is_told(c)).collect();
    let changes = asked.iter().any(|c| matches!(&c.value, Value::Data(f) if f.depends_on_time()));
    let mut worst = vec![(0.0, 0.0); asked.len()];
    for t in looked_at(if asked.is_empty() { &[] } else { times }, changes) {
        // values that contradict each other are an error of their own
        let Ok(values) = model.prescribed(t) else { continue };
        for (condition, worst) in asked.iter().zip(&mut worst) {
            let Value::Data(f) = &condition.value else { continue };
            let error = error(model, condition, f, t, &values);
            if error > worst.0 {
                *worst = (error, t);
            }
        }
    }
    let found = asked.iter().zip(worst).filter(|(_, (error, _))| *error > COARSE);
    let warning = |(c, (error, t)): (&&Condition<S, N>, (f64, f64))| Warning::CoarseValues {
        of: c.of,
        side: c.side.label.clone(),
        component: c.component,
        t,
        error,
    };
    found.map(warning).collect()
}

/// |g - g_h| / |g| of a condition at time `t`, by the prescribed unknowns `values`; zero of values that are rounding, and where some of its functions are not among them.
fn error<const S: usize, const N: usize>(
    model: &Model<S, N>,
    condition: &Condition<S, N>,
    f: &Data,
    t: f64,
    values: &[(usize, f64)],
) -> f64 {
    let trace = model.in_model(&condition.side);
    let unknown = |function: usize| model.components * function + condition.component;
    let at = |function: usize| values.binary_search_by_key(&unknown(function), |v| v.0).ok().map(|k| values[k].1);
    let Some(coefficients) = trace.dofs.iter().map(|&function| at(function)).collect::<Option<Vec<f64>>>() else { return 0.0 };
    let (space, rules) = (&*trace.space, gauss_rules(&*trace.space, EXTRA));
    let (mut map, mut shapes, mut ids) = (MapTable::new(), ShapeTable::new(), Vec::new());
    let (mut off, mut size, mut area) = (0.0, 0.0, 0.0);
    for e in 0..space.num_elements() {
        let rule = rules.rule(e);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        space.active(e, &mut ids);
        space.tabulate(e, &rule.points, Order::Values, &mut shapes);
        for (q, w) in rule.weights.iter().enumerate() {
            let wanted = f.value(&Point::new(map.x[q].as_slice()).at_time(t));
            let held: f64 = ids.iter().zip(shapes.values(q)).map(|(&i, shape)| coefficients[i] * shape).sum();
            let ds = w * measure(&map.jacobian[q]);
            off += ds * (wanted - held).powi(2);
            size += ds * wanted.powi(2);
            area += ds;
        }
    }
    let (share, mean) = ((off / size).sqrt(), (size / area).sqrt());
    if share.is_finite() && mean > ROUNDING * (model.size + model.center.norm()) { share } else { 0.0 }
}
