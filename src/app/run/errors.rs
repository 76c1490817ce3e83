//! Errors of a solved model against exact solutions and multipliers.

use super::solve::StepState;
use super::tied::TieField;
use crate::app::build::{Model, SideModel, TieModel};
use crate::app::named::Named;
use crate::assembly::Errors;
use crate::basis::Order;
use crate::coupling::Segments;
use crate::geometry::MapTable;
use crate::io::formula::Point;
use crate::linalg::Vector;

/// Errors that can be measured.
pub fn error_names<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<String> {
    let mut names = Vec::new();
    let mut add = |name: String| {
        names.push(name.clone());
        names.push(format!("{name}.rel"));
    };
    if model.exact.is_some() {
        for norm in ["L2", "H1", "energy"] {
            add(format!("error.u.{norm}"));
        }
    }
    let ties = model.ties.iter().filter(|t| t.exact.is_some() || model.exact.is_some()).map(|t| &t.name);
    let contacts = model.contacts.iter().filter(|c| c.exact.is_some() || model.exact.is_some()).map(|c| &c.name);
    let interfaces: Vec<&String> = ties.chain(contacts).collect();
    for name in &interfaces {
        add(format!("error.{name}.lambda.L2"));
    }
    if !interfaces.is_empty() {
        add("error.lambda.L2".into());
    }
    names
}

/// Calls `visit(piece, x, outward normal of the slave, points)` for the pieces of a slave side.
fn each_piece<const S: usize, const N: usize>(
    slave: &SideModel<S, N>,
    segments: &Segments<S>,
    mut visit: impl FnMut(usize, &[Vector<N>], &[Vector<N>]),
) {
    let (mut map, mut normals) = (MapTable::new(), Vec::new());
    for piece in 0..segments.num_pieces() {
        let element = segments.slave[piece];
        slave.trace.space.map(element, &segments.slave_xi[segments.points(piece)], Order::Gradients, &mut map);
        normals.clear();
        normals.extend(map.jacobian.iter().map(|j| slave.trace.normal(element, j)));
        visit(piece, &map.x, &normals);
    }
}

/// Squares of an error and of the exact size.
#[derive(Clone, Copy, Debug, Default)]
struct Squares {
    error: f64,
    exact: f64,
}

/// Every error that can be measured, by its quantity.
pub fn errors<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Named<f64> {
    let mut all = Named::default();
    let mut add = |name: String, error: f64, exact: f64| {
        all.push(name.clone(), error);
        all.push(format!("{name}.rel"), error / exact);
    };
    if let Some(exact) = &model.exact {
        let mut sum = Errors::default();
        for p in &model.patches {
            sum = sum.hypot(p.physics_at(state.t).errors(&**p.body.space(), &p.rules, &state.u[p.range()], exact, state.t));
        }
        add("error.u.L2".into(), sum.error.l2, sum.exact.l2);
        add("error.u.H1".into(), sum.error.h1, sum.exact.h1);
        add("error.u.energy".into(), sum.error.energy, sum.exact.energy);
    }
    let mut total = Squares::default();
    let mut any = false;
    for tie in model.ties.iter().filter(|t| t.exact.is_some() || model.exact.is_some()) {
        let s = tie_error(model, state, tie);
        total = Squares { error: total.error + s.error, exact: total.exact + s.exact };
        add(format!("error.{}.lambda.L2", tie.name), s.error.sqrt(), s.exact.sqrt());
        any = true;
    }
    for (k, contact) in model.contacts.iter().enumerate().filter(|(_, c)| c.exact.is_some() || model.exact.is_some()) {
        let s = contact_error(model, state, k);
        total = Squares { error: total.error + s.error, exact: total.exact + s.exact };
        add(format!("error.{}.lambda.L2", contact.name), s.error.sqrt(), s.exact.sqrt());
        any = true;
    }
    if any {
        add("error.lambda.L2".into(), total.error.sqrt(), total.exact.sqrt());
    }
    all
}

fn tie_error<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>, tie: &TieModel<S, N>) -> Squares {
    let mut sum = Squares::default();
    for part in &tie.parts {
        let physics = model.patches[part.slave.patch].physics_at(state.t);
        let lambda = TieField::of(model, part, state.t);
        for (pairing, s) in part.pairings.iter().map(|p| &p.segments).enumerate() {
            let found = lambda.on_segments(model, part, state, pairing);
            each_piece(&part.slave, s, |piece, x, normals| {
                let points = s.points(piece);
                let mut wanted = vec![0.0; model.components];
                for (k, q) in points.enumerate() {
                    let at = Point::new(x[k].as_slice()).at_time(state.t);
                    match (&tie.exact, &model.exact) {
                        (Some(list), _) => wanted.iter_mut().zip(list).for_each(|(w, f)| *w = f.value(&at)),
                        (None, Some(exact)) => {
                            physics.exact_traction(exact, &at, &x[k], &normals[k], &mut wanted);
                            wanted.iter_mut().for_each(|w| *w = -*w);
                        }
                        (None, None) => {}
                    }
                    for (c, w) in wanted.iter().enumerate() {
                        sum.error += s.ds[q] * (found[c][q] - w).powi(2);
                        sum.exact += s.ds[q] * w.powi(2);
                    }
                }
            });
        }
    }
    sum
}

fn contact_error<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>, number: usize) -> Squares {
    let contact = &model.contacts[number];
    let mut sum = Squares::default();
    for (part, built) in contact.parts.iter().zip(&state.contacts[number]) {
        let s = &built.segments;
        let pressure = part.transmitted(built, &state.lambda[part.rows()]).pressure;
        let physics = model.patches[part.slave.patch].physics_at(state.t);
        each_piece(&part.slave, s, |piece, x, normals| {
            let points = s.points(piece);
            for (k, q) in points.enumerate() {
                let at = Point::new(x[k].as_slice()).at_time(state.t);
                let wanted = match (&contact.exact, &model.exact) {
                    (Some(f), _) => f.value(&at),
                    (None, Some(exact)) => {
                        let mut traction = vec![0.0; model.components];
                        physics.exact_traction(exact, &at, &x[k], &normals[k], &mut traction);
                        traction.iter().zip(normals[k].iter()).map(|(t, n)| t * n).sum()
                    }
                    (None, None) => 0.0,
                };
                sum.error += s.ds[q] * (-pressure[q] - wanted).powi(2);
                sum.exact += s.ds[q] * wanted.powi(2);
            }
        });
    }
    sum
}
