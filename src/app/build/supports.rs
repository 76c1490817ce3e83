//! Rigid motions that are left when every contact is closed.

use super::model::Model;
use super::rigid::{FreeBody, RigidModes, RigidRow};
use super::{Builder, SideModel};
use crate::basis::Order;
use crate::contact::Contact;
use crate::geometry::MapTable;
use crate::linalg::Vector;
use crate::quadrature::Quadrature;

/// Points looked at per side.
const SAMPLES: usize = 24;

/// The unit vector of a component.
pub(super) fn unit<const N: usize>(component: usize) -> Vector<N> {
    Vector::from_fn(|k, _| f64::from(u8::from(k == component)))
}

/// Some points of a side.
fn points<const S: usize, const N: usize>(side: &SideModel<S, N>) -> Vec<Vector<N>> {
    let space = &*side.trace.space;
    let (elements, mut table, mut out) = (space.num_elements(), MapTable::new(), Vec::new());
    for e in (0..elements).step_by(elements.div_ceil(SAMPLES).max(1)) {
        space.map(e, &side.rules.rule(e).points, Order::Values, &mut table);
        out.extend(table.x.iter().copied());
    }
    // the last element counts where the step jumped over it
    if elements > 1 {
        space.map(elements - 1, &side.rules.rule(elements - 1).points, Order::Values, &mut table);
        out.extend(table.x.iter().copied());
    }
    out
}

/// Motions that supports, ties and contacts leave, of patches and, numbered behind them by contact, of obstacles that forces press: `contacts` at a time, per contact and part, of them the points in `closed`.
pub fn free_motions<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contacts: &[Vec<&Contact<S, N>>],
    closed: &dyn Fn(usize, usize, usize) -> bool,
) -> Vec<FreeBody> {
    // glued patches move as one body
    let mut first: Vec<usize> = (0..model.patches.len()).filter(|&k| model.glued.body(k) == k).collect();
    first.sort_unstable();
    let body = |patch: usize| first.binary_search(&model.glued.body(patch)).expect("every patch is part of a body");
    // obstacles that forces press are bodies behind them
    let pressed: Vec<usize> = (0..model.contacts.len()).filter(|&k| model.contacts[k].is_pressed()).collect();
    let modes = RigidModes { bodies: first.len() + pressed.len(), components: model.components, center: model.center, size: model.size };
    let mut rows: Vec<RigidRow<N>> = Vec::new();
    for (k, &contact) in pressed.iter().enumerate() {
        rows.extend(guides(model, first.len() + k, contact));
    }
    let mut fix = |body: usize, direction: Vector<N>, x: Vector<N>| rows.push(RigidRow { terms: vec![(body, 1.0, x)], direction });
    for c in &model.conditions {
        for x in points(&c.side) {
            fix(body(c.side.patch), unit(c.component), x);
        }
    }
    for p in &model.pins {
        for x in p.rim.rim.x.iter().step_by(p.rim.rim.x.len().div_ceil(SAMPLES).max(1)).chain(p.rim.rim.x.last()) {
            fix(body(p.rim.patch), unit(p.component), *x);
        }
    }
    for s in &model.springs {
        for x in points(&s.side) {
            fix(body(s.side.patch), unit(s.component), x);
        }
    }
    // equations between unknowns: inclined sliding; sides that move as one support nothing
    for e in &model.equations {
        let Some(&(first, _)) = e.terms.first() else { continue };
        let Some(patch) = model.patches.iter().position(|p| p.range().contains(&first)) else { continue };
        let field = model.patches[patch].field;
        if e.terms.iter().any(|t| (t.0 - field.first) / field.components != (first - field.first) / field.components) {
            continue;
        }
        let mut direction = Vector::<N>::zeros();
        for &(i, value) in &e.terms {
            direction[(i - field.first) % field.components] = value;
        }
        let function = (first - field.first) / field.components;
        let side = model.supports.iter().find(|s| s.patch == patch && s.trace.dofs.contains(&function));
        for x in side.map(|s| points(s)).unwrap_or_default() {
            fix(body(patch), direction, x);
        }
    }
    for h in &model.hinges {
        for c in 0..model.components {
            rows.push(RigidRow { terms: vec![(body(h.patches[0]), 1.0, h.x), (body(h.patches[1]), -1.0, h.x)], direction: unit(c) });
        }
    }
    let mut table = MapTable::new();
    for part in model.ties.iter().flat_map(|t| &t.parts) {
        for pairing in &part.pairings {
            let s = &pairing.segments;
            for piece in (0..s.num_pieces()).step_by(s.num_pieces().div_ceil(SAMPLES).max(1)) {
                part.slave.trace.space.map(s.slave[piece], &s.slave_xi[s.points(piece)], Order::Values, &mut table);
                for x in &table.x {
                    for c in 0..model.components {
                        rows.push(RigidRow {
                            terms: vec![(body(part.slave.patch), 1.0, *x), (body(pairing.master.patch), -1.0, *x)],
                            direction: unit(c),
                        });
                    }
                }
            }
        }
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        for (p, part) in contact.parts.iter().enumerate() {
            let (frames, segments) = (&contacts[k][p].frames, &contacts[k][p].segments);
            for (q, x) in frames.x.iter().enumerate().filter(|(q, _)| closed(k, p, *q)) {
                let mut terms = vec![(body(part.slave.patch), 1.0, *x)];
                if let super::Against::Side(master, _) = &part.against {
                    // the partner is the foot point: rotations act on it, not on the slave point
                    let foot = x - frames.normal[q] * frames.gap[q];
                    let piece = segments.start.partition_point(|&s| s <= q) - 1;
                    terms.push((body(master.patch_of(segments.master[piece])), -1.0, foot));
                }
                if let Ok(number) = pressed.binary_search(&k) {
                    terms.push((first.len() + number, -1.0, *x));
                }
                rows.push(RigidRow { terms, direction: frames.normal[q] });
            }
        }
    }
    let number = |body: usize| first.get(body).copied().unwrap_or_else(|| model.patches.len() + pressed[body - first.len()]);
    modes.free(&rows).into_iter().map(|f| FreeBody { body: number(f.body), ..f }).collect()
}

/// What holds the obstacle of a contact, body `body`: all but the components in which forces press it.
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

/// "body "upper" can still move: translation x, rotation" for every such body.
pub(crate) fn sentences<const S: usize, const N: usize>(model: &Model<S, N>, free: &[FreeBody]) -> Vec<String> {
    free.iter()
        .map(|f| {
            if let Some(contact) = f.body.checked_sub(model.patches.len()) {
                let name = &model.contacts[contact].name;
                return format!("the obstacle of contact \"{name}\" can still move: {}", f.motions.join(", "));
            }
            let name = &model.patches[f.body].name;
            if model.components == 1 {
                format!("the level of body \"{name}\" is not determined")
            } else {
                format!("body \"{name}\" can still move: {}", f.motions.join(", "))
            }
        })
        .collect()
}

/// E051 for every body that can still move with all contacts closed.
pub(super) fn check<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Model<S, N>) {
    let first: Vec<Vec<_>> = model.contacts.iter().map(|c| c.parts.iter().map(|p| &p.first).collect()).collect();
    let free = free_motions(model, &first, &|_, _, _| true);
    for (f, sentence) in free.iter().zip(sentences(model, &free)) {
        let obstacle = f.body.checked_sub(model.patches.len());
        let at = match obstacle {
            Some(contact) => builder.case.contacts[contact].head.at,
            None => builder.case.patches[f.body].head.at,
        };
        let text = if model.contacts.is_empty() { sentence } else { format!("{sentence}, even with every contact closed") };
        let help = match obstacle {
            Some(_) => "leave the component out of `force`: the obstacle is held there then; or support the body that it presses on",
            None => "prescribe what is left by [[boundary]], or tie the body to one that is supported",
        };
        let fault = builder.error("E051", text, at).with_help(help);
        builder.faults.push(fault);
    }
}
