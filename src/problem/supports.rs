//! Rigid motions that are left when every contact is closed.

use super::data::Point;
use super::model::{BodySide, ContactPart, Foundation, Model, SideSpring, TiePart};
use super::rigid::{RemainingMotions, RigidForm, RigidModes, RigidRow, short};
use super::rigid_bodies::{RigidBodies, contact_terms, unit};
use super::rigid_rows::tie_forms;
use super::slide_forms::slide_forms;
use crate::basis::Order;
use crate::contact::ContactRows;
use crate::geometry::MapTable;
use crate::linalg::Vector;
use crate::quadrature::Quadrature;
use std::ops::Range;

/// Points looked at per side.
const SAMPLES: usize = 24;
/// Relative deviation of parallel directions.
const PARALLEL: f64 = 1e-9;

/// Some points of a side, each with its body.
fn points<const S: usize, const N: usize>(model: &Model<S, N>, bodies: &RigidBodies, side: &BodySide<S, N>) -> Vec<(usize, Vector<N>)> {
    let space = &*side.trace.space;
    let (elements, mut table, mut out) = (space.num_elements(), MapTable::new(), Vec::new());
    for e in (0..elements).step_by(elements.div_ceil(SAMPLES).max(1)) {
        space.map(e, &side.rules.rule(e).points, Order::Values, &mut table);
        out.extend(table.x.iter().map(|x| (bodies.of_facet(model, side, e), *x)));
    }
    // the last element counts where the step jumped over it
    if elements > 1 {
        space.map(elements - 1, &side.rules.rule(elements - 1).points, Order::Values, &mut table);
        out.extend(table.x.iter().map(|x| (bodies.of_facet(model, side, elements - 1), *x)));
    }
    out
}

/// Some of the points at which springs pull at time `t`, each with its body: none where their stiffness is zero at all of them.
fn pulled<const S: usize, const N: usize>(
    model: &Model<S, N>,
    bodies: &RigidBodies,
    spring: &SideSpring<S, N>,
    t: f64,
) -> Vec<(usize, Vector<N>)> {
    let side = &spring.side;
    if let Some(stiffness) = spring.stiffness.as_constant() {
        return if stiffness == 0.0 { Vec::new() } else { points(model, bodies, side) };
    }
    let (space, mut table, mut all) = (&*side.trace.space, MapTable::new(), Vec::new());
    for e in 0..space.num_elements() {
        space.map(e, &side.rules.rule(e).points, Order::Values, &mut table);
        let pulls = |x: &&Vector<N>| spring.stiffness.value(&Point::new(x.as_slice()).at_time(t)) != 0.0;
        all.extend(table.x.iter().filter(pulls).map(|x| (bodies.of_facet(model, side, e), *x)));
    }
    let last = all.last().copied();
    all.iter().copied().step_by(all.len().div_ceil(SAMPLES).max(1)).chain(last).collect()
}

/// Some of the points at which a foundation pulls at time `t`, each with its body: none where its stiffness is zero at all of them.
fn pulled_inside<const S: usize, const N: usize>(
    model: &Model<S, N>,
    bodies: &RigidBodies,
    foundation: &Foundation,
    t: f64,
) -> Vec<(usize, Vector<N>)> {
    let patch = &model.patches[foundation.body];
    let (space, mut table, mut all) = (&**patch.body.space(), MapTable::new(), Vec::new());
    // parts of a body that share no functions are looked at alone
    let is_plain = foundation.stiffness.as_constant().is_some() && patch.parts.count() == 1;
    let step = if is_plain { space.num_elements().div_ceil(SAMPLES).max(1) } else { 1 };
    for e in (0..space.num_elements()).step_by(step) {
        space.map(e, &patch.rules.rule(e).points, Order::Values, &mut table);
        let body = bodies.of_element(model, foundation.body, e);
        all.extend(table.x.iter().filter(|x| foundation.at(x, t) != 0.0).map(|x| (body, *x)));
    }
    all.sort_by_key(|point| point.0);
    all.chunk_by(|a, b| a.0 == b.0)
        .flat_map(|own| own.iter().step_by(own.len().div_ceil(SAMPLES).max(1)).chain(own.last()))
        .copied()
        .collect()
}

/// The points of a contact for which `closed` holds, as rows along the normal.
pub fn contact_points<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    contact_number: usize,
    part: &ContactPart<S, N>,
    contact: &ContactRows<S, N>,
    closed: &dyn Fn(usize) -> bool,
) -> Vec<RigidForm> {
    let row = |q: usize| {
        let terms = contact_terms(model, bodies, contact_number, part, contact, q);
        modes.form(&RigidRow { terms, direction: contact.frames.normal[q] })
    };
    (0..contact.frames.x.len()).filter(|&q| closed(q)).map(row).collect()
}

/// Some points of a tie, held in every component.
pub fn tie_points<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    part: &TiePart<S, N>,
) -> Vec<RigidForm> {
    let (mut table, mut forms) = (MapTable::new(), Vec::new());
    for pairing in &part.pairings {
        let s = &pairing.segments;
        for piece in (0..s.num_pieces()).step_by(s.num_pieces().div_ceil(SAMPLES).max(1)) {
            part.slave.trace.space.map(s.slave[piece], &s.slave_xi[s.points(piece)], Order::Values, &mut table);
            let slave = bodies.of_facet(model, &part.slave, s.slave[piece]);
            let master = bodies.of_facet(model, &pairing.master, s.master[piece]);
            for x in &table.x {
                let row = |c: usize| RigidRow { terms: vec![(slave, 1.0, *x), (master, -1.0, *x)], direction: unit(c) };
                forms.extend((0..model.components).map(|c| modes.form(&row(c))));
            }
        }
    }
    forms
}

/// Motions that supports, ties and contacts leave, of patches and, numbered behind them by contact, of obstacles that forces press.
///
/// `contacts` at time `t`, per contact and part; of them the points in `closed`.
pub fn free_motions<const S: usize, const N: usize>(
    model: &Model<S, N>,
    t: f64,
    contacts: &[Vec<&ContactRows<S, N>>],
    closed: &dyn Fn(usize, usize, usize) -> bool,
) -> Vec<RemainingMotions> {
    remaining_motions_with(model, t, contacts, closed, Ties::Functions)
}

/// Computes [`free_motions`] with ties by points or by functions.
pub fn remaining_motions_with<const S: usize, const N: usize>(
    model: &Model<S, N>,
    t: f64,
    contacts: &[Vec<&ContactRows<S, N>>],
    closed: &dyn Fn(usize, usize, usize) -> bool,
    ties: Ties,
) -> Vec<RemainingMotions> {
    let bodies = RigidBodies::of(model);
    let (modes, mut forms) = rigid_forms(model, &bodies, Some(t), ties);
    for (k, contact) in model.contacts.iter().enumerate() {
        for (p, part) in contact.parts.iter().enumerate() {
            forms.extend(contact_points(model, &modes, &bodies, k, part, contacts[k][p], &|q| closed(k, p, q)));
        }
    }
    modes.free(&forms).into_iter().map(|f| bodies.numbered(model, &modes, f)).collect()
}

/// A description of ties by rows on rigid motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ties {
    /// Every point holds.
    Points,
    /// By the functions of their multipliers, where there are any.
    Functions,
}

/// The unknowns of every body that supports and ties leave a rigid motion at time `t`, patches and obstacles that forces press: contact has
/// to hold it.
pub(super) fn floating<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Vec<Vec<Range<usize>>> {
    let bodies = RigidBodies::of(model);
    let (modes, rows) = held(model, t, &bodies);
    let unknowns = |body: usize| match bodies.first.get(body) {
        Some(_) => bodies.unknowns(model, body),
        None => {
            let obstacle = &model.contacts[bodies.pressed[body - bodies.first.len()]].obstacle;
            obstacle.iter().flat_map(|o| &o.pressed).map(|p| p.unknown..p.unknown + 1).collect()
        }
    };
    modes.free(&rows).iter().map(|f| unknowns(f.body)).collect()
}

/// The rigid motions of a model and what supports, springs and ties ask of them at time `t`: both ways, without contacts.
pub(super) fn held<const S: usize, const N: usize>(model: &Model<S, N>, t: f64, bodies: &RigidBodies) -> (RigidModes<N>, Vec<RigidForm>) {
    rigid_forms(model, bodies, Some(t), Ties::Functions)
}

/// The rigid motions of a model and what supports and ties ask of them, with the springs and foundations of a time, or without any.
pub fn rigid_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    bodies: &RigidBodies,
    springs: Option<f64>,
    ties: Ties,
) -> (RigidModes<N>, Vec<RigidForm>) {
    let of = |side: &BodySide<S, N>| points(model, bodies, side);
    let modes = bodies.modes(model);
    let mut rows: Vec<RigidRow<N>> = Vec::new();
    for (k, &contact) in bodies.pressed.iter().enumerate() {
        rows.extend(guides(model, bodies.first.len() + k, contact));
    }
    let mut fix = |body: usize, direction: Vector<N>, x: Vector<N>| rows.push(RigidRow { terms: vec![(body, 1.0, x)], direction });
    for c in &model.conditions {
        for (body, x) in of(&c.side) {
            fix(body, unit(c.component), x);
        }
    }
    for p in &model.pins {
        let Some(&function) = p.rim.rim.functions().first() else { continue };
        let body = bodies.of_function(model, p.rim.patch, function);
        for x in p.rim.rim.x.iter().step_by(p.rim.rim.x.len().div_ceil(SAMPLES).max(1)).chain(p.rim.rim.x.last()) {
            fix(body, unit(p.component), *x);
        }
    }
    for (t, s) in springs.iter().flat_map(|t| model.springs.iter().map(move |s| (*t, s))) {
        for (body, x) in pulled(model, bodies, s, t) {
            fix(body, unit(s.component), x);
        }
    }
    for (t, f) in springs.iter().flat_map(|t| model.foundations.iter().map(move |f| (*t, f))) {
        for (body, x) in pulled_inside(model, bodies, f, t) {
            fix(body, unit(f.component), x);
        }
    }
    for (body, direction, x) in slides(model, &of) {
        fix(body, direction, x);
    }
    // sides that move as one along an axis: all their points move as the first
    for group in &model.rigid_sides {
        let all: Vec<_> = group.sides.iter().flat_map(|side| of(side)).collect();
        let Some(&(of, at)) = all.first() else { continue };
        let as_first =
            |&(body, x): &(usize, Vector<N>)| RigidRow { terms: vec![(body, 1.0, x), (of, -1.0, at)], direction: unit(group.component) };
        rows.extend(all[1..].iter().map(as_first));
    }
    for h in &model.hinges {
        let [a, b] = [0, 1].map(|k| bodies.of_function(model, h.patches[k], h.functions[k]));
        for c in 0..model.components {
            rows.push(RigidRow { terms: vec![(a, 1.0, h.x), (b, -1.0, h.x)], direction: unit(c) });
        }
    }
    let mut forms: Vec<RigidForm> = rows.iter().map(|row| modes.form(row)).collect();
    forms.extend(model.held_by_symmetry(modes.num_bodies()));
    forms.extend(model.slides.iter().flat_map(|part| slide_forms(model, &modes, bodies, part)));
    for part in model.ties.iter().flat_map(|t| &t.parts) {
        forms.extend(match ties {
            // functions may reach over parts that share none
            Ties::Functions if !part.function_sums.is_empty() && bodies.are_whole() => tie_forms(model, &modes, bodies, part),
            _ => tie_points(model, &modes, bodies, part),
        });
    }
    (modes, forms)
}

/// Directions that equations between components of one function hold, along inclined sides: body, direction and point.
fn slides<const S: usize, const N: usize>(
    model: &Model<S, N>,
    points_of: &dyn Fn(&BodySide<S, N>) -> Vec<(usize, Vector<N>)>,
) -> Vec<(usize, Vector<N>, Vector<N>)> {
    let mut held = Vec::new();
    for e in model.equations.iter().map(|e| &e.equation) {
        let Some(&(first, _)) = e.terms.first() else { continue };
        let Some(patch) = model.patches.iter().position(|p| p.range().contains(&first)) else { continue };
        let field = model.patches[patch].field;
        // unknowns of other patches may come before those of this one
        let function = |unknown: usize| unknown.checked_sub(field.first).map(|k| k / field.components);
        if e.terms.iter().any(|t| function(t.0) != function(first)) {
            continue;
        }
        let mut direction = Vector::<N>::zeros();
        for &(i, value) in &e.terms {
            direction[(i - field.first) % field.components] = value;
        }
        let function = (first - field.first) / field.components;
        let has = |s: &BodySide<S, N>| s.patch == patch && s.trace.dofs.contains(&function);
        // in a corner of two such sides each has its own direction
        let along = |d: &Vector<N>| (direction - d * direction.dot(d) / d.norm_squared()).norm() <= PARALLEL * direction.norm();
        let own = model.held.iter().find(|h| has(&h.side) && along(&h.direction)).map(|h| &h.side);
        let side = own.or_else(|| model.supports.iter().find(|s| has(s)));
        held.extend(side.map(|s| points_of(s)).unwrap_or_default().into_iter().map(|(body, x)| (body, direction, x)));
    }
    held
}

/// Rows that hold the obstacle of a contact, body `body`, in all but the components in which forces press it.
fn guides<const S: usize, const N: usize>(model: &Model<S, N>, body: usize, contact: usize) -> Vec<RigidRow<N>> {
    let free = |c: usize| model.contacts[contact].obstacle.iter().flat_map(|o| &o.pressed).any(|p| p.component == c);
    let mut rows: Vec<RigidRow<N>> =
        (0..N).filter(|&c| !free(c)).map(|c| RigidRow { terms: vec![(body, 1.0, model.center)], direction: unit(c) }).collect();
    for i in 0..N {
        for j in i + 1..N {
            let beside = model.center + unit::<N>(j) * model.size;
            rows.push(RigidRow { terms: vec![(body, 1.0, beside), (body, -1.0, model.center)], direction: unit(i) });
        }
    }
    rows
}

/// Sentences such as `body "upper" can still move: translation x, rotation`, one per body.
pub fn motion_texts<const S: usize, const N: usize>(model: &Model<S, N>, free: &[RemainingMotions]) -> Vec<String> {
    free.iter()
        .map(|f| {
            if let Some(contact) = f.body.checked_sub(model.patches.len()) {
                let name = &model.contacts[contact].name;
                return format!("the obstacle of contact \"{name}\" can still move: {}", f.motions.join(", "));
            }
            let name = &model.patches[f.body].name;
            let who = match &f.middle {
                None => format!("body \"{name}\""),
                Some(x) => {
                    let at: Vec<String> = x[..N].iter().map(|x| short(*x, model.size)).collect();
                    format!("the part around ({}) of body \"{name}\", which shares no node with the rest,", at.join(", "))
                }
            };
            if model.components == 1 {
                format!("the level of {} is not determined", who.trim_end_matches(','))
            } else {
                format!("{who} can still move: {}", f.motions.join(", "))
            }
        })
        .collect()
}
