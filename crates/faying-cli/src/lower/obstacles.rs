//! Rigid obstacles: their shape, their position at a given time, and the forces that drive them.

use super::lower_context::LowerContext;
use crate::case::{self, ObstacleShape, alias};
use crate::errors::Diagnostic;
use crate::formula::Point;
use crate::place::{Located, SourceSpan};
use crate::registry::{Fault, ObstacleAtTime};
use crate::shapes::{is_boundary, is_closed};
use crate::text_format::short;
use faying::contact::{Cylinder, HalfPlane, LevelSet, Sphere, Torus};
use faying::linalg::Vector;
use faying::problem::{Changing, InterfaceId, Opponent, Problem, SideView, TurnedAway};
use std::sync::Arc;

/// The obstacle of a contact without its motion.
pub(super) fn opponent<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    obstacle: &Located<case::Obstacle>,
    name: &str,
) -> Result<Opponent<'static, S, N>, Box<Diagnostic>> {
    let at_rest = at_rest(context, &obstacle.value, name, obstacle.at)?;
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
    context: &LowerContext<'_, S, N>,
    obstacle: &case::Obstacle,
    name: &str,
    at: SourceSpan,
) -> Result<ObstacleAtTime<S, N>, Box<Diagnostic>> {
    Ok(match &obstacle.shape.value {
        ObstacleShape::HalfPlane { point, normal } => {
            let Some(plane) = HalfPlane::<N>::try_new(vector(&point.value), vector(&normal.value)) else {
                return Err(Box::new(context.error("E015", "the normal of the half-plane has length zero", normal.at)));
            };
            Box::new(move |_| Box::new(plane))
        }
        ObstacleShape::Sphere { center, radius, inside } => {
            let sphere = Sphere::<N> { center: vector(&center.value), radius: radius.value, inside: inside.value };
            Box::new(move |_| Box::new(sphere))
        }
        ObstacleShape::Cylinder { center, axis, radius } => {
            let made = Cylinder::<N>::try_new(vector(&center.value), vector(&axis.value), radius.value);
            let Some(cylinder) = made else { return Err(no_axis(context, "cylinder", axis.at)) };
            Box::new(move |_| Box::new(cylinder))
        }
        ObstacleShape::Torus { center, axis, radius } => {
            let [circle, tube] = radius.value;
            if tube >= circle {
                let fault = context.error("E015", "the tube of the torus must be thinner than its circle", radius.at);
                return Err(Box::new(fault.with_help("write radius = [2.0, 0.5]: the circle, then the tube")));
            }
            let made = Torus::<N>::try_new(vector(&center.value), vector(&axis.value), circle, tube);
            let Some(torus) = made else { return Err(no_axis(context, "torus", axis.at)) };
            Box::new(move |_| Box::new(torus))
        }
        ObstacleShape::LevelSet { f, along } => {
            let (f, along) = (f.value.clone(), along.as_ref().map(|a| vector::<N>(&a.value)));
            if along.is_some_and(|a| a.norm() == 0.0) {
                return Err(Box::new(context.error("E015", "`along` of the level set has length zero", obstacle.shape.at)));
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
            let Some(make) = context.names.shaped.0 else {
                let text = format!("the names of this program have no obstacle of kind {}", obstacle.shape.value.kind());
                return Err(Box::new(context.error("E019", text, obstacle.shape.at)));
            };
            let surface = make(geometry).map_err(|fault: Fault| {
                Box::new(context.error(fault.code, format!("the obstacle of contact \"{name}\": {}", fault.message), at))
            })?;
            Box::new(move |_| Box::new(Arc::clone(&surface)))
        }
        ObstacleShape::Entry { kind, given } => {
            let entry = context.names.obstacles.get(kind).map_err(|e| context.error("E015", e.to_string(), obstacle.shape.at))?;
            (entry.make)(given).map_err(|fault| {
                let at = given.at(fault.key).unwrap_or(obstacle.shape.at);
                Box::new(context.error(fault.code, format!("the obstacle of contact \"{name}\": {}", fault.message), at))
            })?
        }
    })
}

/// The error of an obstacle with an axis of no length.
fn no_axis<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, kind: &str, at: SourceSpan) -> Box<Diagnostic> {
    Box::new(context.error("E015", format!("the axis of the {kind} has length zero"), at))
}

/// The diagnostic of a slave side, with a number, that faces nothing of its obstacle: `plain` with the side that was probably meant, or the
/// wrong side or orientation of the obstacle.
pub(super) fn turned_away<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contact: &case::Contact,
    problem: &Problem<S, N>,
    (of, number): (InterfaceId, usize),
    slave: &SideView<S, N>,
    plain: Box<Diagnostic>,
) -> Box<Diagnostic> {
    let (case::Master::Rigid(obstacle), InterfaceId::Contact(id)) = (&contact.master, of) else { return plain };
    if let Some(found) = swallowed(context, contact, problem, of, number) {
        return Box::new(found);
    }
    match problem.turned_away(id, number) {
        Some(TurnedAway::OtherSide(name)) => {
            let side = format!("{}.{}", context.case.patches[slave.body()].name.value, alias(&name, N));
            let help = format!("their normals must oppose, within 60 degrees; `{side}` faces it: was that meant?");
            Box::new((*plain).with_help(help))
        }
        Some(TurnedAway::SameWay) => {
            let (label, name) = (slave.label(), &contact.name.value);
            let text = format!("`{label}` and the obstacle of contact \"{name}\" look the same way: the body is on the wrong side of it");
            Box::new(context.error("E023", text, obstacle.at).with_help(way_round::<N>(&obstacle.shape.value)))
        }
        None => plain,
    }
}

/// The diagnostic of an obstacle that looks the same way as a slave side at time `t`, though it faces it at others.
pub(super) fn turned_round<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contact: &case::Contact,
    slave: &SideView<S, N>,
    t: f64,
    at: SourceSpan,
) -> Diagnostic {
    let (label, name) = (slave.label(), &contact.name.value);
    let text = format!(
        "the obstacle of contact \"{name}\" is turned round: nothing of it faces `{label}` at t = {}, it looks the same way",
        short(t)
    );
    let case::Master::Rigid(obstacle) = &contact.master else { return context.error("E023", text, at) };
    let (at, help) = match &obstacle.shape.value {
        ObstacleShape::LevelSet { f, .. } => (f.at, "`f` is positive outside of the obstacle at all times of [steps]"),
        _ => (obstacle.at, "the obstacle must face the side at all times of [steps]"),
    };
    context.error("E023", text, at).with_help(help)
}

/// Change of a case that turns an obstacle round.
fn way_round<const N: usize>(shape: &ObstacleShape) -> &'static str {
    match shape {
        ObstacleShape::HalfPlane { .. } => "`normal` points out of the obstacle: change its sign",
        ObstacleShape::Sphere { .. } => "`inside = true` is for bodies inside of the circle, `inside = false` for those outside",
        ObstacleShape::LevelSet { .. } => "`f` is positive outside of the obstacle, and `along` points out of it: change the sign",
        ObstacleShape::Cylinder { .. } | ObstacleShape::Torus { .. } => "the obstacle is the inside: bodies lie outside of it",
        ObstacleShape::Geometry(g) if N == 3 && is_boundary(g, N) => {
            "the normal t_u x t_v of an open surface points out of the obstacle, exchange its directions u and v; of a closed one the obstacle \
             is the inside"
        }
        ObstacleShape::Geometry(g) if is_boundary(g, N) => {
            "the obstacle lies to the right of its curve: reverse the order of the points and weights, and mirror the knots"
        }
        _ => "choose the side of the body that faces the obstacle",
    }
}

/// E023 if the body of a slave side lies as a whole in an obstacle behind a curve or a surface: that has the wrong way round. Of open
/// ones that a force presses it may lie behind them.
pub(super) fn swallowed<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contact: &case::Contact,
    problem: &Problem<S, N>,
    of: InterfaceId,
    number: usize,
) -> Option<Diagnostic> {
    let (case::Master::Rigid(obstacle), InterfaceId::Contact(id)) = (&contact.master, of) else { return None };
    let ObstacleShape::Geometry(geometry) = &obstacle.shape.value else { return None };
    let is_pressed = obstacle.force.iter().any(Option::is_some);
    if !is_boundary(geometry, N) || is_pressed && !is_closed(geometry) || !problem.is_swallowed(id, number) {
        return None;
    }
    let (slave, _) = problem.slave_and_masters(of.into(), number)?;
    let text = format!("the body of `{}` lies inside of the obstacle of contact \"{}\"", slave.label(), contact.name.value);
    Some(context.error("E023", text, obstacle.at).with_help(way_round::<N>(&obstacle.shape.value)))
}
