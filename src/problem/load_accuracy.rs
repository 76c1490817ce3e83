//! Accuracy of integrals over given data: loads, springs, foundations, prescribed values and moduli that jump inside of elements or have no bound.
//!
//! With F, M the force and the moment by the rule of the problem, F*, M* those by elements that are halved ([`Halved`]), moments about the
//! centre c = ∫ |f| x / ∫ |f| of the load, and L² = ∫ |f| |x - c|² / ∫ |f| its spread, the error of a load is
//!
//! ```text
//! e = max( |F - F*|, |M - M*| / L ) / ∫ |f|.
//! ```
//!
//! Of springs it is |∫ k - ∫* k| / ∫ |k|, of a modulus E, of foundations and of prescribed values, whose errors in different elements do not make up for each
//! other, the sum of |∫ E - ∫* E| over the elements, over ∫ |E|. Loads and sources of an exact solution without pieces are smooth: they are left
//! out, and so are prescribed values that are bounded: those of a coarse mesh converge with the solution.

use super::data::{Data, Exact, Point};
use super::handles::Statement;
use super::loads::LoadSum;
use super::model::{Action, BodyModel, BodySide, Condition, Model, SideLoad, Value};
use super::resultant::{Resultant, cross};
use crate::assembly::{Halved, HalvedScratch};
use crate::basis::Order;
use crate::geometry::{Bounds, MapTable, cell};
use crate::linalg::{Matrix, Vector, measure};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;
use std::ops::Range;
use std::sync::Arc;

/// Errors up to this are accepted.
const ACCEPTED: f64 = 1e-3;
/// Halvings of every element in which a load may act on a small part only, by the dimension of the integral.
const LEAST: [usize; 3] = [4, 2, 1];
/// Moments below this share of those about the middle of the sides are round-off.
const ROUNDING: f64 = 1e-12;
/// Sources and tractions of an exact solution below this share of the terms that make them up are round-off.
const CANCELLED: f64 = 1e-9;
/// Sums over elements are not followed below this share of what is round-off.
const NOISE: f64 = 1e-4;
/// Most times at which data that change with the time are looked at.
const TIMES: usize = 16;
/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 64;

/// Data whose integral is inexact.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Integral {
    /// The load of this name; the patch whose volume it acts on, if it is not one on sides.
    Load {
        /// Its first statement, as in [`LoadSum`].
        of: Statement,
        /// Its name.
        name: String,
        /// The patch of a load per volume.
        patch: Option<usize>,
    },
    /// The stiffness of springs on a side along a component.
    Spring {
        /// The statement.
        of: Statement,
        /// Their name.
        name: String,
        /// The component.
        component: usize,
    },
    /// The values prescribed on a side along a component, which are projected.
    Prescribed {
        /// The statement.
        of: Statement,
        /// Label of the side.
        side: String,
        /// The component.
        component: usize,
    },
    /// The stiffness of a foundation of a patch along a component.
    Foundation {
        /// The statement.
        of: Statement,
        /// Name of the patch.
        name: String,
        /// The component.
        component: usize,
    },
    /// The modulus of the material of a patch.
    Modulus {
        /// The patch.
        patch: usize,
        /// Its name.
        name: String,
    },
}

/// An integral that the rule of a problem misses.
#[derive(Clone, Debug, PartialEq)]
pub struct Inexact {
    /// The load, spring, prescribed value or modulus.
    pub of: Integral,
    /// The time at which it is most inexact.
    pub t: f64,
    /// The resultant by the rule of the problem; of all others the first component of the force is their integral.
    pub integrated: Resultant,
    /// The resultant by halved elements.
    pub finer: Resultant,
    /// The error e (module docs), free of units.
    pub error: f64,
}

/// With r = (x - centre) / length: the force, ∫ r x f, ∫ |f|, ∫ |f| r and ∫ |f| |r|².
type Sums = [f64; 11];

/// The sums of a density.
struct Levers<const N: usize> {
    center: Vector<N>,
    length: f64,
}

impl<const N: usize> Levers<N> {
    fn of(bounds: Option<Bounds<N>>) -> Self {
        let (center, size) = bounds.map_or((Vector::zeros(), 1.0), |b| (b.center(), b.diagonal()));
        Self { center, length: (0.5 * size).max(f64::MIN_POSITIVE) }
    }

    fn density(&self, x: &Vector<N>, f: &[f64]) -> Sums {
        let (mut one, r) = (Resultant::default(), (x - self.center) / self.length);
        one.add(&r, f, 1.0);
        let size = f.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut sums = [0.0; 11];
        sums[..3].copy_from_slice(&one.force);
        sums[3..6].copy_from_slice(&one.moment);
        sums[6] = size;
        (0..N).for_each(|k| sums[7 + k] = size * r[k]);
        sums[10] = size * r.norm_squared();
        sums
    }

    /// The resultant about the origin.
    fn resultant(&self, sums: &Sums) -> Resultant {
        let force = [sums[0], sums[1], sums[2]];
        let mut out = Resultant::default();
        out.add(&self.center, &force, 1.0);
        (0..3).for_each(|k| out.moment[k] += self.length * sums[3 + k]);
        out
    }

    /// The error of `own` beside `finer`, moments of problems with as many components as coordinates.
    fn error(own: &Sums, finer: &Sums, components: usize) -> f64 {
        let off: [f64; 6] = std::array::from_fn(|k| own[k] - finer[k]);
        let length = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let (force, size) = (length(&off[..3]), finer[6].max(own[6]));
        if size <= 0.0 {
            return 0.0;
        }
        let center: [f64; 3] = std::array::from_fn(|k| finer[7 + k] / finer[6]);
        let spread = (finer[10] / finer[6] - center.iter().map(|c| c * c).sum::<f64>()).max(0.0).sqrt();
        let about = cross(&Vector::<3>::from(center), &off[..3]);
        let moment = length(&[off[3] - about[0], off[4] - about[1], off[5] - about[2]]);
        if components == N && moment > ROUNDING * size { force.max(moment / spread) / size } else { force / size }
    }
}

/// Sums `f(element)` over all elements, in their order.
fn over_elements<const K: usize, X: Default>(count: usize, f: impl Fn(usize, &mut X) -> [f64; K] + Sync) -> [f64; K] {
    let of = |chunk: Range<usize>| {
        let (mut scratch, mut sum) = (X::default(), [0.0; K]);
        for e in chunk {
            sum.iter_mut().zip(f(e, &mut scratch)).for_each(|(s, v)| *s += v);
        }
        sum
    };
    let parts: Vec<[f64; K]> = parallel::map_ranges(count, ELEMENTS_PER_TASK, of);
    let mut total = [0.0; K];
    parts.iter().for_each(|p| total.iter_mut().zip(p).for_each(|(t, v)| *t += v));
    total
}

/// The integral of a density f(x, dx/dxi) over an element by its rule.
fn by_rule<const D: usize, const N: usize, const K: usize>(
    space: &dyn Space<D, N>,
    rules: &dyn Quadrature<D>,
    element: usize,
    table: &mut MapTable<D, N>,
    f: &dyn Fn(&Vector<N>, &Matrix<N, D>) -> [f64; K],
) -> [f64; K] {
    let rule = rules.rule(element);
    space.map(element, &rule.points, crate::basis::Order::Gradients, table);
    let mut sum = [0.0; K];
    for ((x, j), w) in table.x.iter().zip(&table.jacobian).zip(&rule.weights) {
        let ds = w * measure(j);
        sum.iter_mut().zip(f(x, j)).for_each(|(s, v)| *s += v * ds);
    }
    sum
}

fn most_points<const D: usize, const N: usize>(space: &dyn Space<D, N>) -> usize {
    if space.num_elements() == 0 { 1 } else { space.degree(0).into_iter().max().unwrap_or(1) + 1 }
}

/// The times at which data are looked at.
pub(super) fn looked_at(times: &[f64], changes: bool) -> impl Iterator<Item = f64> + '_ {
    let count = if changes { times.len() } else { times.len().min(1) };
    times[..count].iter().copied().step_by(count.div_ceil(TIMES).max(1))
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The loads, springs, foundations, prescribed values and moduli whose integrals are inexact by more than 1e-3 at one of `times`, each at the worst of them.
    pub fn inexact_integrals(&self, times: &[f64]) -> Vec<Inexact> {
        let mut found: Vec<Inexact> = self.no_loads().iter().filter_map(|load| self.inexact_load(load, times)).collect();
        for spring in &self.springs {
            let k = |x: &Vector<N>, t: f64| spring.stiffness.value(&Point::new(x.as_slice()).at_time(t));
            let of = || Integral::Spring { of: spring.of, name: spring.name.clone(), component: spring.component };
            if spring.stiffness.as_constant().is_none() {
                let at = |t: f64| self.side_sums(&spring.side, false, &|x, _, out| out[0] = k(x, t), 1);
                found.extend(worst(looked_at(times, spring.stiffness.depends_on_time()), of, 1, at));
            }
        }
        for f in self.foundations.iter().filter(|f| f.stiffness.as_constant().is_none()) {
            let patch = &self.patches[f.body];
            let of = || Integral::Foundation { of: f.of, name: patch.name.clone(), component: f.component };
            let at = |t: f64| by_elements(&**patch.body.space(), &patch.rules, &|x| self.around(x), &|x| f.at(x, t));
            found.extend(worst_by_elements(looked_at(times, f.stiffness.depends_on_time()), of, at));
        }
        found.extend(self.conditions.iter().filter_map(|c| self.inexact_value(c, times)));
        found.extend((0..self.patches.len()).filter_map(|k| self.inexact_modulus(k, times)));
        found
    }

    fn inexact_load(&self, load: &LoadSum, times: &[f64]) -> Option<Inexact> {
        let is_smooth = |patch: usize| self.patches[patch].exact.as_ref().is_some_and(|e| !e.is_piecewise());
        let of = || Integral::Load { of: load.of, name: load.name.clone(), patch: load.patch };
        let c = self.components;
        if let Some(k) = load.patch {
            let patch = &self.patches[k];
            let data = || patch.source.iter().chain(patch.weights.iter().map(|w| &w.0));
            let is_constant = patch.exact.is_none() && data().all(|f| f.as_constant().is_some());
            if is_smooth(k) || is_constant {
                return None;
            }
            let changes = patch.exact.as_ref().is_some_and(|e| e.depends_on_time()) || data().any(Data::depends_on_time);
            return worst(looked_at(times, changes), of, c, |t| self.volume_sums(patch, t));
        }
        let sides: Vec<&SideLoad<S, N>> = self.loads.iter().filter(|l| l.group == load.of).collect();
        let smooth = |l: &&SideLoad<S, N>| is_smooth(l.side.patch) && matches!(l.action, Action::Exact(_));
        if sides.iter().all(smooth) {
            return None;
        }
        let data = |l: &SideLoad<S, N>| match &l.action {
            Action::Traction(_, f) | Action::Pressure(f) | Action::Force(_, f, _) => Some(f.clone()),
            Action::Exact(_) => None,
        };
        let changes = sides.iter().any(|l| data(l).is_none_or(|f| f.depends_on_time()));
        worst(looked_at(times, changes), of, c, |t| {
            let levers = Levers::of(sides.iter().filter_map(|l| l.side.trace.space.extent()).reduce(|a, b| a.union(&b)));
            let (mut own, mut finer) = ([0.0; 11], [0.0; 11]);
            for load in &sides {
                let physics = self.patches[load.side.patch].physics_at(t);
                let is_constant = data(load).is_some_and(|f| f.as_constant().is_some());
                let act = |x: &Vector<N>, n: &Vector<N>, out: &mut [f64]| self.side_force(load, &physics, t, x, n, out);
                let around = |x: &Vector<N>| self.around(x);
                let (mut a, b) = sums_of_side(&load.side, &levers, is_constant, &around, &act, c);
                if let (Some(exact), Action::Exact(_)) = (&self.patches[load.side.patch].exact, &load.action) {
                    let terms = |x: &Vector<N>, _: &Vector<N>, out: &mut [f64]| out[0] = physics.modulus(x) * slope_size(&**exact, c, x, t);
                    a[6] = a[6].max(CANCELLED * sums_of_side(&load.side, &levers, true, &around, &terms, 1).0[6]);
                }
                own.iter_mut().zip(a).for_each(|(s, v)| *s += v);
                finer.iter_mut().zip(b).for_each(|(s, v)| *s += v);
            }
            (levers, own, finer)
        })
    }

    /// The sums over a side by its rule and by halves.
    fn side_sums(&self, side: &BodySide<S, N>, is_constant: bool, f: &SideDensity<'_, N>, components: usize) -> (Levers<N>, Sums, Sums) {
        let levers = Levers::of(side.trace.space.extent());
        let (own, finer) = sums_of_side(side, &levers, is_constant, &|x| self.around(x), f, components);
        (levers, own, finer)
    }

    /// The sums over a patch by its rule and by halves.
    fn volume_sums(&self, patch: &BodyModel<S, N>, t: f64) -> (Levers<N>, Sums, Sums) {
        let levers = Levers::of(patch.extent);
        let Some(force) = self.volume_force(patch, t) else { return (levers, [0.0; 11], [0.0; 11]) };
        let space = &**patch.body.space();
        let density = |x: &Vector<N>, _: &Matrix<N, N>| {
            let mut value = [0.0; 3];
            force(x, &mut value[..self.components]);
            levers.density(x, &value)
        };
        let count = space.num_elements();
        let cancelled = patch.exact.as_ref().map_or(0.0, |exact| {
            let physics = patch.physics_at(t);
            let terms = |x: &Vector<N>, _: &Matrix<N, N>| [physics.modulus(x) * bend_size(&**exact, self.components, x, t)];
            let [size] = over_elements(count, |e, table: &mut MapTable<N, N>| by_rule(space, &patch.rules, e, table, &terms));
            CANCELLED * size
        });
        let halved = Halved::new(space, most_points(space), LEAST[N - 1]).with_noise(NOISE * cancelled / count.max(1) as f64);
        let mut own = over_elements(count, |e, table: &mut MapTable<N, N>| by_rule(space, &patch.rules, e, table, &density));
        let around = |x: &Vector<N>, j: &Matrix<N, N>| density(x, j).map(|v| v * self.around(x));
        let finer = over_elements(count, |e, scratch: &mut HalvedScratch<N, N>| halved.element(e, scratch, &around));
        own[6] = own[6].max(cancelled);
        (levers, own, finer)
    }

    fn inexact_modulus(&self, number: usize, times: &[f64]) -> Option<Inexact> {
        let patch = &self.patches[number];
        if patch.physics.is_homogeneous() {
            return None;
        }
        let of = || Integral::Modulus { patch: number, name: patch.name.clone() };
        worst_by_elements(looked_at(times, patch.changing.is_some()), of, |t| {
            let physics = patch.physics_at(t);
            by_elements(&**patch.body.space(), &patch.rules, &|x| self.around(x), &|x| physics.modulus(x))
        })
    }

    fn inexact_value(&self, condition: &Condition<S, N>, times: &[f64]) -> Option<Inexact> {
        let (side, component) = (&condition.side, condition.component);
        let changes = match &condition.value {
            Value::Zero => return None,
            Value::Data(f) if f.as_constant().is_some() => return None,
            Value::Data(f) => f.depends_on_time(),
            Value::Exact => self.patches[side.patch].exact.as_ref()?.depends_on_time(),
        };
        let of = || Integral::Prescribed { of: condition.of, side: side.label.clone(), component };
        worst_by_elements(looked_at(times, changes), of, |t| {
            let value = |x: &Vector<N>| self.value_at(&condition.value, (side.patch, component), x, t);
            let found = by_elements(&*side.trace.space, &side.rules, &|x| self.around(x), &value);
            // bounded data that are coarse converge with the solution
            if found.1 > ACCEPTED && is_bounded(&*side.trace.space, &side.rules, &value) { ([0.0; 2], 0.0) } else { found }
        })
    }
}

/// ∫ f by the rule of the problem and by halves, whose points have the factor `around`, and the error that sums up those of the elements.
fn by_elements<const D: usize, const N: usize>(
    space: &dyn Space<D, N>,
    rules: &dyn Quadrature<D>,
    around: &(dyn Fn(&Vector<N>) -> f64 + Sync),
    f: &(dyn Fn(&Vector<N>) -> f64 + Sync),
) -> ([f64; 2], f64) {
    let halved = Halved::new(space, most_points(space), LEAST[D - 1]);
    let density = |x: &Vector<N>, _: &Matrix<N, D>| [f(x), f(x).abs()];
    let finer_density = |x: &Vector<N>, j: &Matrix<N, D>| density(x, j).map(|v| v * around(x));
    let [own, finer, off, size] = over_elements(space.num_elements(), |e, both: &mut (MapTable<D, N>, HalvedScratch<D, N>)| {
        let [own, own_size] = by_rule(space, rules, e, &mut both.0, &density);
        let [finer, size] = halved.element(e, &mut both.1, &finer_density);
        [own, finer, (own - finer).abs(), size.max(own_size)]
    });
    ([own, finer], if size > 0.0 { off / size } else { 0.0 })
}

/// Whether `f` is finite in the corners of all elements, and nowhere, as far as samples tell, several times as large as at the points of the
/// rule.
fn is_bounded<const D: usize, const N: usize>(space: &dyn Space<D, N>, rules: &dyn Quadrature<D>, f: &dyn Fn(&Vector<N>) -> f64) -> bool {
    const SAMPLES: usize = 65;
    const GROWTH: f64 = 4.0;
    let mut map = MapTable::new();
    let mut largest = |e: usize, points: &[Vector<D>]| {
        space.map(e, points, Order::Values, &mut map);
        map.x.iter().map(|x| f(x).abs()).fold(0.0_f64, |a, b| if b.is_nan() { f64::INFINITY } else { a.max(b) })
    };
    let (mut seen, mut sampled) = (0.0_f64, 0.0_f64);
    for e in 0..space.num_elements() {
        let corners = cell::corners::<D, f64>(space.cell(e));
        seen = seen.max(largest(e, &rules.rule(e).points));
        // along the lines between corners
        let between = |a: &Vector<D>, b: &Vector<D>, k: usize| a + (b - a) * (k as f64 / (SAMPLES - 1) as f64);
        let points: Vec<_> =
            corners.iter().flat_map(|a| corners.iter().flat_map(move |b| (0..SAMPLES).map(move |k| between(a, b, k)))).collect();
        sampled = sampled.max(largest(e, &points));
    }
    sampled <= GROWTH * seen
}

/// The worst of `times` of what [`by_elements`] finds, if the error is beyond what is accepted there.
fn worst_by_elements(times: impl Iterator<Item = f64>, of: impl Fn() -> Integral, at: impl Fn(f64) -> ([f64; 2], f64)) -> Option<Inexact> {
    let mut found: Option<Inexact> = None;
    for t in times {
        let (sums, error) = at(t);
        if error > found.as_ref().map_or(ACCEPTED, |f| f.error) {
            let [integrated, finer] = sums.map(|v| Resultant { force: [v, 0.0, 0.0], moment: [0.0; 3] });
            found = Some(Inexact { of: of(), t, integrated, finer, error });
        }
    }
    found
}

/// The norm of the gradient of an exact solution.
fn slope_size<const N: usize>(exact: &dyn Exact, components: usize, x: &Vector<N>, t: f64) -> f64 {
    let at = Point::new(x.as_slice()).at_time(t);
    (0..components).flat_map(|c| exact.slope(c, &at).gradient).map(|v| v * v).sum::<f64>().sqrt()
}

/// The norm of its second derivatives.
fn bend_size<const N: usize>(exact: &dyn Exact, components: usize, x: &Vector<N>, t: f64) -> f64 {
    let at = Point::new(x.as_slice()).at_time(t);
    (0..components).flat_map(|c| exact.derivatives(c, &at).hessian.concat()).map(|v| v * v).sum::<f64>().sqrt()
}

/// Force per area at a place with its outward normal, one entry per component.
type SideDensity<'a, const N: usize> = dyn Fn(&Vector<N>, &Vector<N>, &mut [f64]) + Sync + 'a;

/// The sums over a side by its rule and by halves.
fn sums_of_side<const S: usize, const N: usize>(
    side: &BodySide<S, N>,
    levers: &Levers<N>,
    is_constant: bool,
    around: &(dyn Fn(&Vector<N>) -> f64 + Sync),
    f: &SideDensity<'_, N>,
    components: usize,
) -> (Sums, Sums) {
    let space: &Arc<dyn Space<S, N>> = &side.trace.space;
    let halved = Halved::new(&**space, most_points(&**space), if is_constant { 1 } else { LEAST[S - 1] });
    let density = |e: usize| {
        move |x: &Vector<N>, j: &Matrix<N, S>| {
            let mut value = [0.0; 3];
            f(x, &side.trace.normal(e, j), &mut value[..components]);
            levers.density(x, &value)
        }
    };
    let own = over_elements(space.num_elements(), |e, table: &mut MapTable<S, N>| by_rule(&**space, &side.rules, e, table, &density(e)));
    let finer = over_elements(space.num_elements(), |e, scratch: &mut HalvedScratch<S, N>| {
        let density = density(e);
        halved.element(e, scratch, &|x: &Vector<N>, j: &Matrix<N, S>| density(x, j).map(|v| v * around(x)))
    });
    (own, finer)
}

/// The worst of `times`, if the error is beyond what is accepted there.
fn worst<const N: usize>(
    times: impl Iterator<Item = f64>,
    of: impl Fn() -> Integral,
    components: usize,
    at: impl Fn(f64) -> (Levers<N>, Sums, Sums),
) -> Option<Inexact> {
    let mut found: Option<Inexact> = None;
    for t in times {
        let (levers, own, finer) = at(t);
        let error = Levers::<N>::error(&own, &finer, components);
        if error > found.as_ref().map_or(ACCEPTED, |f| f.error) {
            found = Some(Inexact { of: of(), t, integrated: levers.resultant(&own), finer: levers.resultant(&finer), error });
        }
    }
    found
}
