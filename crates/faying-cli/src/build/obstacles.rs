//! Rigid obstacles: their shape, their position at a given time, and the forces that drive them.

use super::builder::Builder;
use super::outline::{is_curve, plane_outline, surface};
use crate::case::{self, ObstacleShape};
use crate::errors::Diagnostic;
use crate::formula::{Formula, Point};
use crate::place::Place;
use crate::registry::{Fault, MakeShaped};
use faying::basis::Order;
use faying::contact::{HalfPlane, LevelSet, Sphere};
use faying::geometry::{MapTable, cell};
use faying::linalg::Vector;
use faying::problem::{AtRest, Data, ObstacleModel, Pressed, SideModel};
use std::sync::Arc;

/// Normals of a slave and of its obstacle have the same direction if their product is above this.
const SAME_WAY: f64 = 1e-6;

/// Number of obstacles' components that forces press: each is an unknown.
pub(super) fn num_pressed(case: &case::Case) -> usize {
    case.contacts.iter().map(|c| forces(c).count()).sum()
}

fn forces(contact: &case::Contact) -> impl Iterator<Item = (usize, &Formula)> {
    let force = match &contact.master {
        case::Master::Rigid(obstacle) => obstacle.force.as_slice(),
        _ => &[],
    };
    force.iter().enumerate().filter_map(|(k, f)| Some((k, &f.as_ref()?.value)))
}

/// Builds the obstacle of a contact, its force-driven unknowns numbered from `first`; `None` for a deformable master.
pub(super) fn obstacle<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    contact: &case::Contact,
    first: usize,
) -> Result<Option<Arc<ObstacleModel<S, N>>>, Box<Diagnostic>> {
    let case::Master::Rigid(obstacle) = &contact.master else { return Ok(None) };
    let at_rest = at_rest(builder, &obstacle.value, &contact.name.value, obstacle.at)?;
    let of_time = match &obstacle.shape.value {
        ObstacleShape::LevelSet { f, .. } => f.depends_on_time(),
        ObstacleShape::Entry { given, .. } => given.depends_on_time(),
        _ => false,
    };
    let motion: Vec<Option<Data>> = obstacle.translate.iter().map(|f| f.as_ref().map(|f| f.value.clone().into())).collect();
    let changes = of_time || motion.iter().flatten().any(Data::depends_on_time);
    let pressed = forces(contact)
        .enumerate()
        .map(|(k, (component, force))| Pressed { component, unknown: first + k, force: force.clone().into() })
        .collect();
    Ok(Some(Arc::new(ObstacleModel { at_rest, motion, pressed, changes })))
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

/// Returns `plain`, or E023 if all points of the slave that project on the obstacle lie behind it: the wrong side or orientation.
pub(super) fn turned_away<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    contact: &case::Contact,
    model: &ObstacleModel<S, N>,
    slave: &SideModel<S, N>,
    plain: Box<Diagnostic>,
) -> Box<Diagnostic> {
    let case::Master::Rigid(obstacle) = &contact.master else { return plain };
    let (mut map, trace) = (MapTable::new(), &slave.trace);
    let target = model.target(builder.case.steps.value.first().copied().unwrap_or(1.0), None);
    let (mut points, mut behind) = (0, 0);
    for element in 0..trace.facets.len() {
        trace.space.map(element, &[cell::center(trace.space.cell(element))], Order::Gradients, &mut map);
        if let Some(hit) = target.project(&map.x[0]) {
            points += 1;
            behind += usize::from(trace.normal(element, &map.jacobian[0]).dot(&hit.normal) >= SAME_WAY);
        }
    }
    if points == 0 || behind < points {
        return plain;
    }
    let help = match &obstacle.shape.value {
        ObstacleShape::HalfPlane { .. } => "`normal` points out of the obstacle: change its sign",
        ObstacleShape::Sphere { .. } => "`inside = true` is for bodies inside of the circle, `inside = false` for those outside",
        ObstacleShape::LevelSet { .. } => "`f` is positive outside of the obstacle, and `along` points out of it: change the sign",
        ObstacleShape::Geometry(g) if is_curve(g) => {
            "the obstacle lies to the right of its curve: reverse the order of the points and weights, and mirror the knots"
        }
        _ => "choose the side of the body that faces the obstacle",
    };
    let text = format!(
        "`{}` and the obstacle of contact \"{}\" look the same way: the body is on the wrong side of it",
        slave.label, contact.name.value
    );
    Box::new(builder.error("E023", text, obstacle.at).with_help(help))
}

/// Builds obstacles from geometries in the plane.
pub(crate) const PLANE: MakeShaped<1, 2> = |geometry| Ok(Arc::new(surface(&plane_outline(geometry)?)));
