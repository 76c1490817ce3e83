//! Rigid obstacles: their shape, their position at a given time, and the forces that drive them.

use super::builder::Builder;
use super::outline::{is_closed, is_curve, plane_outline, surface};
use super::sides::alias;
use super::values::times;
use crate::case::{self, ObstacleShape};
use crate::errors::Diagnostic;
use crate::formula::Point;
use crate::place::{Located, Place};
use crate::registry::{AtRest, Fault, MakeShaped};
use faying::basis::Order;
use faying::contact::{HalfPlane, LevelSet, Obstacle, Sphere, opposed};
use faying::geometry::{MapTable, cell};
use faying::linalg::Vector;
use faying::problem::{Changing, Model, ObstacleModel, Opponent, SideModel};
use faying::space::Trace;
use std::sync::Arc;

/// Least share of the facets of a side that must face an obstacle for a suggestion.
const SEEN: f64 = 0.25;
/// Sides deeper in an obstacle than this share of their size are no suggestion.
const DEEP: f64 = 0.1;
/// Share of the facets that look the same way as the obstacle, for a side that is on the wrong side of it.
const WHOLE: f64 = 0.999;
/// Cells of a body that are looked at, whether it lies in an obstacle.
const LOOKS: usize = 100;

/// The obstacle of a contact without its motion.
pub(super) fn opponent<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    obstacle: &Located<case::Obstacle>,
    name: &str,
) -> Result<Opponent<'static, S, N>, Box<Diagnostic>> {
    let at_rest = at_rest(builder, &obstacle.value, name, obstacle.at)?;
    let changes = match &obstacle.shape.value {
        ObstacleShape::LevelSet { f, .. } => f.depends_on_time(),
        ObstacleShape::Entry { given, .. } => given.depends_on_time(),
        _ => false,
    };
    Ok(if changes { Opponent::Changing(Changing(Arc::from(at_rest))) } else { Opponent::Obstacle(Arc::from(at_rest(0.0))) })
}

fn vector<const N: usize>(list: &[f64]) -> Vector<N> {
    Vector::from_fn(|k, _| list.get(k).copied().unwrap_or(0.0))
}

fn at_rest<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    obstacle: &case::Obstacle,
    name: &str,
    at: Place,
) -> Result<AtRest<S, N>, Box<Diagnostic>> {
    Ok(match &obstacle.shape.value {
        ObstacleShape::HalfPlane { point, normal } => {
            let Some(plane) = HalfPlane::<N>::try_new(vector(&point.value), vector(&normal.value)) else {
                return Err(Box::new(builder.error("E015", "the normal of the half-plane has length zero", normal.at)));
            };
            Box::new(move |_| Box::new(plane))
        }
        ObstacleShape::Sphere { center, radius, inside } => {
            let sphere = Sphere::<N> { center: vector(&center.value), radius: radius.value, inside: inside.value };
            Box::new(move |_| Box::new(sphere))
        }
        ObstacleShape::LevelSet { f, along } => {
            let (f, along) = (f.value.clone(), along.as_ref().map(|a| vector::<N>(&a.value)));
            if along.is_some_and(|a| a.norm() == 0.0) {
                return Err(Box::new(builder.error("E015", "`along` of the level set has length zero", obstacle.shape.at)));
            }
            Box::new(move |t| {
                let f = f.clone();
                let function = move |x: &Vector<N>| {
                    let jet = f.slope(&Point::new(x.as_slice()).at_time(t));
                    (jet.value, Vector::<N>::from_fn(|k, _| jet.gradient[k]))
                };
                match along {
                    Some(a) => Box::new(LevelSet::try_along(function, a).expect("its length was checked")),
                    None => Box::new(LevelSet::new(function)),
                }
            })
        }
        ObstacleShape::Geometry(geometry) => {
            let Some(make) = builder.names.shaped.0 else {
                return Err(Box::new(builder.error("E019", "this kind of obstacle is not in this version", obstacle.shape.at)));
            };
            let surface = make(geometry).map_err(|fault: Fault| {
                Box::new(builder.error(fault.code, format!("the obstacle of contact \"{name}\": {}", fault.message), at))
            })?;
            Box::new(move |_| Box::new(Arc::clone(&surface)))
        }
        ObstacleShape::Entry { kind, given } => {
            let entry = builder.names.obstacles.get(kind).map_err(|e| builder.error("E015", e.to_string(), obstacle.shape.at))?;
            (entry.make)(given).map_err(|fault| {
                Box::new(builder.error(fault.code, format!("the obstacle of contact \"{name}\": {}", fault.message), obstacle.shape.at))
            })?
        }
        other => {
            let text = format!("an obstacle of kind {} is not in this version", other.kind());
            return Err(Box::new(builder.error("E019", text, obstacle.shape.at)));
        }
    })
}

/// View of an obstacle from the centres of the facets of a side.
struct Look {
    /// Share of the facets that face it, by their number.
    share: f64,
    /// Share of those that would face it if their normals were reversed.
    reversed: f64,
    /// Mean gap of those that face it \[length\].
    gap: f64,
}

fn look<const S: usize, const N: usize>(trace: &Trace<S, N>, target: &dyn Obstacle<S, N>) -> Look {
    let (mut map, facets) = (MapTable::new(), trace.facets.len());
    let (mut faced, mut reversed, mut gap) = (0.0, 0.0, 0.0);
    for element in 0..facets {
        trace.space.map(element, &[cell::center(trace.space.cell(element))], Order::Gradients, &mut map);
        let (x, normal) = (map.x[0], trace.normal(element, &map.jacobian[0]));
        let sees = |n: &Vector<N>| opposed(target, &x, n).filter(|hit| hit.gap.is_finite());
        match sees(&normal) {
            Some(hit) => {
                faced += 1.0;
                gap += hit.gap;
            }
            None => reversed += f64::from(u8::from(sees(&-normal).is_some())),
        }
    }
    Look { share: faced / facets as f64, reversed: reversed / facets as f64, gap: if faced > 0.0 { gap / faced } else { 0.0 } }
}

/// The diagnostic of a slave side that faces nothing of its obstacle: `plain` with the side that was probably meant, or the wrong
/// side or orientation of the obstacle.
pub(super) fn turned_away<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    contact: &case::Contact,
    built: &ObstacleModel<S, N>,
    (model, slave): (&Model<S, N>, &SideModel<S, N>),
    plain: Box<Diagnostic>,
) -> Box<Diagnostic> {
    let case::Master::Rigid(obstacle) = &contact.master else { return plain };
    if let Some(found) = swallowed(builder, contact, built, (model, slave)) {
        return Box::new(found);
    }
    let target = built.target(times(builder.case, false)[0], None);
    let own = look(&slave.trace, &*target);
    if own.share > 0.0 {
        return plain;
    }
    let patch = &model.patches[slave.patch];
    let sides = patch.body.sides().into_iter().filter_map(|name| Some((patch.body.trace(&name).ok()?, name)));
    let meant = sides
        .map(|(trace, name)| (look(&trace, &*target), trace.space.extent().map_or(0.0, |b| b.diagonal()), name))
        .filter(|(look, size, _)| look.share > SEEN && look.gap > -DEEP * size)
        .min_by(|a, b| a.0.gap.abs().total_cmp(&b.0.gap.abs()));
    if let Some((_, _, name)) = meant {
        let help = format!("their normals must oppose, within 60 degrees; `{}.{}` faces it: was that meant?", patch.name, alias(&name, N));
        return Box::new((*plain).with_help(help));
    }
    if own.reversed < WHOLE {
        return plain;
    }
    let text = format!(
        "`{}` and the obstacle of contact \"{}\" look the same way: the body is on the wrong side of it",
        slave.label, contact.name.value
    );
    Box::new(builder.error("E023", text, obstacle.at).with_help(way_round(&obstacle.shape.value)))
}

/// Change of a case that turns an obstacle round.
fn way_round(shape: &ObstacleShape) -> &'static str {
    match shape {
        ObstacleShape::HalfPlane { .. } => "`normal` points out of the obstacle: change its sign",
        ObstacleShape::Sphere { .. } => "`inside = true` is for bodies inside of the circle, `inside = false` for those outside",
        ObstacleShape::LevelSet { .. } => "`f` is positive outside of the obstacle, and `along` points out of it: change the sign",
        ObstacleShape::Geometry(g) if is_curve(g) => {
            "the obstacle lies to the right of its curve: reverse the order of the points and weights, and mirror the knots"
        }
        _ => "choose the side of the body that faces the obstacle",
    }
}

/// E023 if the body of a slave side lies as a whole in an obstacle with the outline of a curve: that has the wrong way round. Of open
/// curves that a force presses it may lie behind them.
pub(super) fn swallowed<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    contact: &case::Contact,
    built: &ObstacleModel<S, N>,
    (model, slave): (&Model<S, N>, &SideModel<S, N>),
) -> Option<Diagnostic> {
    let case::Master::Rigid(obstacle) = &contact.master else { return None };
    let ObstacleShape::Geometry(geometry) = &obstacle.shape.value else { return None };
    if !is_curve(geometry) || !built.pressed.is_empty() && !is_closed(geometry) {
        return None;
    }
    let target = built.target(times(builder.case, false)[0], None);
    let (space, mut map) = (model.patches[slave.patch].body.space(), MapTable::new());
    let inside = |x: &Vector<N>| {
        let hits = around::<N>().into_iter().filter_map(|n| opposed(&*target, x, &n));
        hits.min_by(|a, b| (x - a.x).norm().total_cmp(&(x - b.x).norm())).is_some_and(|hit| hit.gap < 0.0)
    };
    let cells = space.num_elements();
    for e in (0..cells).step_by(cells.div_ceil(LOOKS)) {
        space.map(e, &[cell::center(space.cell(e))], Order::Values, &mut map);
        if !inside(&map.x[0]) {
            return None;
        }
    }
    let text = format!("the body of `{}` lies inside of the obstacle of contact \"{}\"", slave.label, contact.name.value);
    Some(builder.error("E023", text, obstacle.at).with_help(way_round(&obstacle.shape.value)))
}

/// Unit vectors all around in the plane of the first two axes.
fn around<const N: usize>() -> [Vector<N>; 8] {
    std::array::from_fn(|k| {
        let (s, c) = (std::f64::consts::FRAC_PI_4 * k as f64).sin_cos();
        Vector::from_fn(|i, _| [c, s].get(i).copied().unwrap_or(0.0))
    })
}

/// Builds obstacles from geometries in the plane.
pub(crate) const PLANE: MakeShaped<1, 2> = |geometry| Ok(Arc::new(surface(&plane_outline(geometry)?)));
