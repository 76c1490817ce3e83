//! Jumps of the flux of the exact solution.
//!
//! The source derived from `exact` is -div sigma(u) at points. If the flux sigma n jumps across a line, inside of a body or between two
//! that are tied, that is not the load of u: the jump on the line is missing, and u is not the solution of the case. Jumps are searched
//! where the formulas are piecewise, on lines from the middle of every element to its neighbours, by bisection towards the largest change
//! of the gradient. Where u is continuous, [grad u] = a m with m normal to the line of the jump, which gives the flux to compare: in one
//! material it jumps whenever the gradient does, between two it need not. Facets leave the line that they stand for: what jumps between
//! a side and that line is not inside the body, and across a tie each body has its own piece ([`crate::problem::Depths`]).

use super::warning::{Subject, Warning};
use crate::basis::{Cell, Order};
use crate::geometry::{ClosestPoint, MapTable, cell};
use crate::linalg::{Matrix, Vector};
use crate::problem::model::{BodyModel, BodySide, Model, TiePart};
use crate::problem::own_side::OwnSide;
use crate::problem::{Exact, Point, field_slope};
use crate::space::Space;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::sync::Arc;

/// Jumps below this fraction of the largest flux are attributed to round-off.
const JUMP: f64 = 1e-3;
/// Largest number of elements that are examined per patch.
const ELEMENTS: usize = 20_000;
/// Pieces of a line before it is bisected, and bisections: jumps are kept, slopes fall to 1e-9 of the line's change.
const PIECES: usize = 8;
const BISECTIONS: usize = 27;
/// Distance from a tied side at which its own body is evaluated, over the size of the model.
const INSIDE: f64 = 1e-9;

/// Jump of the flux, the largest flux for comparison, and the position.
struct Jump<const N: usize> {
    size: f64,
    largest: f64,
    at: Vector<N>,
}

/// Finds the largest jump inside each patch and that across each tie, at time `t`.
pub(super) fn flux_jumps<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Vec<Warning> {
    if !model.has_exact() {
        return Vec::new();
    }
    let by_pieces = |patch: usize| model.patches[patch].exact.as_ref().is_some_and(|exact| exact.is_piecewise());
    let mut found = Vec::new();
    let mut tell = |jump: Jump<N>, of: Subject| {
        if jump.size > JUMP * jump.largest {
            found.push(Warning::FluxJump { of, x: jump.at.as_slice().to_vec(), share: jump.size / jump.largest });
        }
    };
    for (k, patch) in model.patches.iter().enumerate() {
        let Some(exact) = patch.exact.as_deref().filter(|exact| exact.is_piecewise()) else { continue };
        let rims = OnceCell::new();
        let in_rim = |x: &Vector<N>| rims.get_or_init(|| Rims::of(model, k)).hold(x);
        tell(inside(patch, &in_rim, exact, t), Subject::body(model, k));
    }
    for (k, tie) in model.ties.iter().enumerate() {
        for part in &tie.parts {
            let slave = part.slave.patch;
            let own = &model.patches[slave];
            let is_one = |other: &BodyModel<S, N>| {
                own.physics.is_uniform_with(&other.physics)
                    && own.exact.as_ref().zip(other.exact.as_ref()).is_some_and(|(a, b)| Arc::ptr_eq(a, b))
            };
            let is_smooth = part.pairings.iter().all(|p| is_one(&model.patches[p.master.patch]) && !by_pieces(p.master.patch));
            if by_pieces(slave) || !is_smooth {
                tell(across(model, part, t), Subject::tie(model, k));
            }
        }
    }
    found
}

/// sigma n of the exact solution.
fn traction<const S: usize, const N: usize>(
    patch: &BodyModel<S, N>,
    exact: &dyn Exact,
    t: f64,
    x: &Vector<N>,
    normal: &Vector<N>,
) -> [f64; 3] {
    let mut out = [0.0; 3];
    let components = patch.field.components;
    patch.physics_at(t).exact_traction(exact, &Point::new(x.as_slice()).at_time(t), x, normal, &mut out[..components]);
    out
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// grad u, rows beyond the components zero.
fn gradient<const N: usize>(exact: &dyn Exact, components: usize, t: f64, x: &Vector<N>) -> Matrix<3, N> {
    let at = Point::new(x.as_slice()).at_time(t);
    let mut all = Matrix::<3, N>::zeros();
    if components == 1 {
        all.row_mut(0).copy_from(&field_slope::<1, N>(exact, &at).1.row(0));
    } else {
        let slope = field_slope::<N, N>(exact, &at).1;
        (0..N).for_each(|c| all.row_mut(c).copy_from(&slope.row(c)));
    }
    all
}

/// The largest jump of the flux inside a patch, but at points where `in_rim` holds.
fn inside<const S: usize, const N: usize>(
    patch: &BodyModel<S, N>,
    in_rim: &dyn Fn(&Vector<N>) -> bool,
    exact: &dyn Exact,
    t: f64,
) -> Jump<N> {
    let components = patch.field.components;
    let grad = |x: &Vector<N>| gradient(exact, components, t, x);
    let mut worst = Jump { size: 0.0, largest: 0.0, at: Vector::zeros() };
    for [a, b] in lines(patch) {
        let point = |s: f64| a + (b - a) * s;
        let values: Vec<Matrix<3, N>> = (0..=PIECES).map(|k| grad(&point(k as f64 / PIECES as f64))).collect();
        for axis in 0..N {
            let normal = Vector::<N>::from_fn(|k, _| f64::from(u8::from(k == axis)));
            worst.largest = worst.largest.max(distance(&traction(patch, exact, t, &a, &normal), &[0.0; 3]));
        }
        let change = |k: usize| (values[k + 1] - values[k]).norm();
        let Some(k) = (0..PIECES).max_by(|&i, &j| change(i).total_cmp(&change(j))) else { continue };
        let size = values.iter().map(|v| v.norm()).fold(0.0, f64::max);
        if change(k) <= JUMP * size {
            continue;
        }
        let (mut left, mut right) = (k as f64 / PIECES as f64, (k + 1) as f64 / PIECES as f64);
        let (mut before, mut after) = (values[k], values[k + 1]);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (left + right);
            let value = grad(&point(middle));
            if (value - before).norm() > (after - value).norm() {
                (right, after) = (middle, value);
            } else {
                (left, before) = (middle, value);
            }
        }
        let Some(normal) = direction(&(after - before)).filter(|_| (after - before).norm() > JUMP * size) else { continue };
        let (here, there) = (point(left), point(right));
        let jump = distance(&traction(patch, exact, t, &here, &normal), &traction(patch, exact, t, &there, &normal));
        if jump > worst.size && !in_rim(&here) {
            (worst.size, worst.at) = (jump, here);
        }
    }
    worst
}

/// The layers between the sides of a body and the surfaces that their facets stand for.
struct Rims<const S: usize, const N: usize>(Vec<Rim<S, N>>);

/// A side and the thickness of its layer per element.
type Rim<const S: usize, const N: usize> = (ClosestPoint<S, N, Arc<dyn Space<S, N>>>, Vec<f64>);

impl<const S: usize, const N: usize> Rims<S, N> {
    /// The layers of a patch; sides of exact maps have none.
    fn of(model: &Model<S, N>, number: usize) -> Self {
        let patch = &model.patches[number];
        let sides = patch.body.sides().into_iter().filter(|_| !patch.exact_map);
        let of_side = |name: String| {
            let side = BodySide::new(patch, number, &name, name.clone()).ok()?;
            let own = OwnSide::new(model, &side);
            let layer: Vec<f64> = (0..side.trace.facets.len()).map(|e| own.depths(e, 0.0).certain).collect();
            layer.iter().any(|d| *d > 0.0).then(|| (ClosestPoint::new(Arc::clone(&side.trace.space)), layer))
        };
        Self(sides.filter_map(of_side).collect())
    }

    /// Whether a point lies in one of them.
    fn hold(&self, x: &Vector<N>) -> bool {
        self.0.iter().any(|(side, layer)| {
            let most = layer.iter().copied().fold(0.0, f64::max);
            side.project_within(x, most).is_some_and(|foot| foot.distance <= layer[foot.element])
        })
    }
}

/// m of a matrix a mᵀ: its longest row, of length one.
fn direction<const N: usize>(jump: &Matrix<3, N>) -> Option<Vector<N>> {
    let row = (0..3).map(|c| jump.row(c).transpose()).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    (row.norm() > 0.0).then(|| row / row.norm())
}

/// Lines from the middle of every element to the middle of each face, to just before it, and across each inner face.
fn lines<const S: usize, const N: usize>(patch: &BodyModel<S, N>) -> Vec<[Vector<N>; 2]> {
    let space = &**patch.body.space();
    let step = space.num_elements().div_ceil(ELEMENTS).max(1);
    let (mut table, mut ids) = (MapTable::new(), Vec::new());
    let mut first: HashMap<Vec<usize>, Vector<N>> = HashMap::new();
    let mut lines = Vec::new();
    for e in (0..space.num_elements()).step_by(step) {
        let kind = space.cell(e);
        let (center, corners) = (cell::center::<N, f64>(kind), cell::corners::<N, f64>(kind));
        let on_face: Vec<Vec<usize>> = match kind {
            Cell::Simplex => (0..corners.len()).map(|k| (0..corners.len()).filter(|&i| i != k).collect()).collect(),
            Cell::Tensor => (0..2 * N).map(|f| (0..corners.len()).filter(|&i| i >> (f / 2) & 1 == f % 2).collect()).collect(),
        };
        let middle = |face: &Vec<usize>| face.iter().map(|&i| corners[i]).sum::<Vector<N>>() / face.len() as f64;
        let mut points = vec![center];
        // inside by 1e-6: faces are where pieces of formulas meet
        points.extend(on_face.iter().map(|face| center + (middle(face) - center) * (1.0 - 1e-6)));
        space.map(e, &points, Order::Values, &mut table);
        space.corners(e, &mut ids);
        for (face, &x) in on_face.iter().zip(&table.x[1..]) {
            lines.push([table.x[0], x]);
            if ids.is_empty() {
                continue;
            }
            let mut key: Vec<usize> = face.iter().map(|&i| ids[i]).collect();
            key.sort_unstable();
            // across the face, from one side to the other
            match first.remove(&key) {
                Some(other) => lines.push([other, x]),
                None => drop(first.insert(key, x)),
            }
        }
    }
    lines
}

/// The largest jump of the flux across a tie.
fn across<const S: usize, const N: usize>(model: &Model<S, N>, part: &TiePart<S, N>, t: f64) -> Jump<N> {
    let mut worst = Jump { size: 0.0, largest: 0.0, at: Vector::zeros() };
    let (on_slave, mut table) = (OwnSide::new(model, &part.slave), MapTable::new());
    let slave = model.patches[part.slave.patch].physics_at(t);
    let exact_in = |patch: usize| model.patches[patch].exact.as_ref();
    for pairing in &part.pairings {
        let Some((own_exact, other_exact)) = exact_in(part.slave.patch).zip(exact_in(pairing.master.patch)) else { continue };
        let (s, on_master) = (&pairing.segments, OwnSide::new(model, &pairing.master));
        let master = model.patches[pairing.master.patch].physics_at(t);
        for piece in 0..s.num_pieces() {
            let (element, opposite) = (s.slave[piece], s.master[piece]);
            // points of the slave's facets leave those of the master by the deviations of both
            let depths = [on_slave.depths(element, 0.0), on_master.depths(opposite, on_slave.deviation(element))];
            part.slave.trace.space.map(element, &s.slave_xi[s.points(piece)], Order::Gradients, &mut table);
            for (x, j) in table.x.iter().zip(&table.jacobian) {
                let normal = part.slave.trace.normal(element, j);
                let off = normal * (INSIDE * model.size);
                let own = slave.own_traction(&**own_exact, t, &(x - off), [&normal, &-normal], depths[0]);
                let other = master.own_traction(&**other_exact, t, &(x + off), [&normal, &normal], depths[1]);
                // which piece is meant is open there
                let (Some(own), Some(other)) = (own, other) else { continue };
                let jump = distance(&own, &other);
                worst.largest = worst.largest.max(distance(&own, &[0.0; 3])).max(distance(&other, &[0.0; 3]));
                // the flux along a side counts, too: that across it may be zero but for rounding
                let axes = if jump > JUMP * worst.largest { N } else { 0 };
                for axis in 0..axes {
                    let along = Vector::<N>::from_fn(|k, _| f64::from(u8::from(k == axis)));
                    let flux = slave.own_traction(&**own_exact, t, &(x - off), [&along, &-normal], depths[0]);
                    worst.largest = worst.largest.max(flux.map_or(0.0, |flux| distance(&flux, &[0.0; 3])));
                }
                if jump > worst.size {
                    (worst.size, worst.at) = (jump, *x);
                }
            }
        }
    }
    worst
}
