//! Fields of a solved model for the files.

use super::Solved;
use crate::case::Case;
use crate::formula::Point;
use crate::output::{ExactCurve, FieldRange, Output, Parts, Picture, RunOptions, SideOutput};
use crate::table::InterfaceRow;
use faying::basis::{Basis, Order, ShapeTable};
use faying::contact::{Obstacle, Surface, opposed};
use faying::geometry::{ClosestPoint, Geometry, MapTable, Projection};
use faying::linalg::{Vector, measure};
use faying::physics::von_mises;
use faying::problem::{
    Against, ArcLength, ContactField, Extreme, PointState, SideModel, TieField, component_rows, multiplier_at, on_trace,
};
use faying::quadrature::Quadrature;
use faying_files::vtu::{CellStyle, Part};
use std::ops::Range;
use std::sync::Arc;

type Plane = Solved<1, 2>;
type Side = SideModel<1, 2>;

/// Collects the output of a plane case for its files.
pub fn plane_output(case: &Case, solved: &Arc<Plane>, options: &RunOptions) -> Output {
    let mut sides: Vec<SideOutput> = Vec::new();
    for t in 0..solved.solution.model().ties.len() {
        sides.extend((0..solved.solution.model().ties[t].parts.len()).map(|p| tied_side(solved, t, p, options)));
    }
    for c in 0..solved.solution.model().contacts.len() {
        sides.extend((0..solved.solution.model().contacts[c].parts.len()).map(|p| contact_side(solved, c, p, options)));
    }
    assembled(case, solved, Parts::Plane(bodies(solved, options)), sides)
}

/// Collects the output of a case in space for its files.
pub fn volume_output(case: &Case, solved: &Arc<Solved<2, 3>>, options: &RunOptions) -> Output {
    assembled(case, solved, Parts::Volume(bodies(solved, options)), Vec::new())
}

fn assembled<const S: usize, const N: usize>(case: &Case, solved: &Arc<Solved<S, N>>, parts: Parts, sides: Vec<SideOutput>) -> Output {
    let title = if case.title.value.is_empty() { case.source.name.clone() } else { case.title.value.clone() };
    let (field, label) = if solved.solution.model().components == 1 { ("u", "u") } else { ("von_mises", "von Mises stress") };
    let picture = Some(Picture { field: field.into(), component: 0, label: label.into() });
    let solved = Arc::clone(solved);
    let range = Some(FieldRange(Box::new(move || range(&solved))));
    Output { title, parts, picture, range, sides }
}

/// Least and largest value of the field of the picture over the closed elements of all bodies.
fn range<const S: usize, const N: usize>(solved: &Solved<S, N>) -> Option<[f64; 2]> {
    let (model, state) = (solved.solution.model(), solved.solution.state());
    let scalar = model.components == 1;
    let value = |s: &PointState<N>| if scalar { s.u[0] } else { von_mises(&s.stress) };
    let parts = model.patches.iter().map(|p| p.extremes(&state.u, state.t, !scalar, &value));
    let join = |[a, b]: [f64; 2], [low, high]: [Extreme<N>; 2]| [a.min(low.value), b.max(high.value)];
    parts.into_iter().try_fold([f64::INFINITY, f64::NEG_INFINITY], |found, part| Some(join(found, part?)))
}

fn bodies<const S: usize, const N: usize>(solved: &Arc<Solved<S, N>>, options: &RunOptions) -> Vec<Part<'static, N, N>> {
    (0..solved.solution.model().patches.len()).map(|k| body(solved, k, options)).collect()
}

fn body<const S: usize, const N: usize>(solved: &Arc<Solved<S, N>>, k: usize, options: &RunOptions) -> Part<'static, N, N> {
    let patch = &solved.solution.model().patches[k];
    let at = |solved: &Arc<Solved<S, N>>| {
        let solved = Arc::clone(solved);
        move |element: usize, xi: &[Vector<N>]| {
            let patch = &solved.solution.model().patches[k];
            patch.physics_at(solved.solution.state().t).at(&**patch.body.space(), &patch.field, &solved.solution.state().u, element, xi)
        }
    };
    let (values, stresses, equivalent, all) = (at(solved), at(solved), at(solved), at(solved));
    let part = Part::new(patch.name.clone(), Arc::clone(patch.body.space()), options.cells.unwrap_or(CellStyle::Lagrange));
    if solved.solution.model().components == 1 {
        return part.with_exact("u", 1, move |e, xi| values(e, xi).iter().map(|p| p.u[0]).collect());
    }
    part.with_exact("displacement", N, move |e, xi| values(e, xi).iter().flat_map(|p| p.u.into_iter().take(N)).collect())
        .with("stress", 6, move |e, xi| stresses(e, xi).iter().flat_map(|p| p.stress).collect())
        .with("von_mises", 1, move |e, xi| equivalent(e, xi).iter().map(|p| von_mises(&p.stress)).collect())
        .with_together(move |e, xi| {
            let numbers = |p: PointState<N>| p.u.into_iter().take(N).chain(p.stress).chain([von_mises(&p.stress)]);
            all(e, xi).into_iter().flat_map(numbers).collect()
        })
}

/// Returns `name`, or `name.k` if the interface has several slave sides.
fn part_name(name: &str, part: usize, parts: usize) -> String {
    if parts == 1 { name.into() } else { format!("{name}.{part}") }
}

/// The highest degree of a multiplier.
fn degree(psi: &dyn Basis<1>) -> usize {
    (0..psi.num_elements()).map(|e| psi.degree(e)[0]).max().unwrap_or(1).max(1)
}

/// Returns the centre of every function along the side: arc length and point.
fn centres(side: &Side, psi: &dyn Basis<1>) -> Vec<(f64, [f64; 3])> {
    let space = &*side.trace.space;
    let arc = ArcLength::new(space);
    let (mut sums, mut table, mut ids, mut map) = (vec![[0.0; 2]; psi.num_functions()], ShapeTable::new(), Vec::new(), MapTable::new());
    for e in 0..space.num_elements() {
        let rule = side.rules.rule(e);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        psi.active(e, &mut ids);
        psi.tabulate(e, &rule.points, Order::Values, &mut table);
        for (q, &w) in rule.weights.iter().enumerate() {
            let (s, ds) = (arc.of(e, rule.points[q][0]), w * measure(&map.jacobian[q]));
            for (&j, v) in ids.iter().zip(table.values(q)) {
                sums[j][0] += v.abs() * ds * s;
                sums[j][1] += v.abs() * ds;
            }
        }
    }
    sums.iter()
        .map(|[moment, weight]| {
            let s = if *weight > 0.0 { moment / weight } else { 0.0 };
            let x = arc.point(s);
            (s, [x[0], x[1], 0.0])
        })
        .collect()
}

/// The normal of the obstacle or master that faces each point of a slave element.
type Normals = Box<dyn Fn(usize, &[Vector<1>]) -> Vec<f64> + Send + Sync>;

fn normals(solved: &Arc<Plane>, slave: &Arc<Side>, target: Box<dyn Obstacle<1, 2>>) -> Normals {
    let (solved, slave) = (Arc::clone(solved), Arc::clone(slave));
    Box::new(move |element, xi| {
        let _ = &solved;
        let mut map = MapTable::new();
        slave.trace.space.map(element, xi, Order::Gradients, &mut map);
        (0..xi.len())
            .flat_map(|q| {
                // points that face nothing show minus the slave's normal
                let own = slave.trace.normal(element, &map.jacobian[q]);
                let n = opposed(&*target, &map.x[q], &own).map_or(-own, |hit| hit.normal);
                [n[0], n[1]]
            })
            .collect()
    })
}

/// Style of cells of a side: linear if the bodies have linear cells, else curved.
fn side_cells(options: &RunOptions) -> CellStyle {
    if options.cells == Some(CellStyle::Linear) { CellStyle::Linear } else { CellStyle::Lagrange }
}

/// Returns the jump u_slave - u_master of a tie as a function of points of a slave element; in elasticity its component along the master's
/// outward normal, positive when open. Zero at points that no master faces.
fn jumps(solved: &Arc<Plane>, t: usize, p: usize) -> impl Fn(usize, &[Vector<1>]) -> Vec<f64> + Send + Sync + use<> {
    let solved = Arc::clone(solved);
    let surfaces: Vec<Surface> =
        solved.solution.model().ties[t].parts[p].pairings.iter().map(|pairing| Surface::new(&pairing.master.trace, None)).collect();
    move |element, xi| {
        let model = solved.solution.model();
        let part = &model.ties[t].parts[p];
        let mut map = MapTable::new();
        part.slave.trace.space.map(element, xi, Order::Values, &mut map);
        let own = on_trace(&part.slave.trace, model.patches[part.slave.patch].field, &solved.solution.state().u, element, xi);
        map.x
            .iter()
            .zip(own)
            .map(|(x, own)| {
                let hits = surfaces.iter().zip(&part.pairings).filter_map(|(s, pairing)| Some((s.closest(x)?, &pairing.master)));
                let nearest = hits.min_by(|(a, _), (b, _)| a.gap.abs().total_cmp(&b.gap.abs()));
                let Some((hit, master)) = nearest else { return 0.0 };
                let Some(at) = hit.at else { return 0.0 };
                let other = on_trace(&master.trace, model.patches[master.patch].field, &solved.solution.state().u, at.element, &[at.xi])[0];
                match model.components {
                    1 => own[0] - other[0],
                    _ => (0..2).map(|k| (own[k] - other[k]) * hit.normal[k]).sum(),
                }
            })
            .collect()
    }
}

fn tied_side(solved: &Arc<Plane>, t: usize, p: usize, options: &RunOptions) -> SideOutput {
    let tie = &solved.solution.model().ties[t];
    let part = &tie.parts[p];
    let components = solved.solution.model().components;
    let lambda = |solved: &Arc<Plane>, sign: f64| {
        let solved = Arc::clone(solved);
        let field = TieField::of(solved.solution.model(), &solved.solution.model().ties[t].parts[p], solved.solution.state().t);
        move |element: usize, xi: &[Vector<1>]| {
            let part = &solved.solution.model().ties[t].parts[p];
            let per_component = field.at(solved.solution.model(), part, solved.solution.state(), element, xi);
            (0..xi.len()).flat_map(|q| per_component.iter().map(move |v| sign * v[q]).collect::<Vec<_>>()).collect::<Vec<f64>>()
        }
    };
    let mut drawn = Part::new(part_name(&tie.name, p, tie.parts.len()), Arc::clone(&part.slave.trace.space), side_cells(options));
    let own = || degree(&*part.slave.trace.space);
    drawn.least_degree = part.multipliers.iter().map(|m| degree(&**m)).max().unwrap_or_else(own);
    drawn = drawn
        .with("lambda", components, lambda(solved, 1.0))
        .with("gap", 1, jumps(solved, t, p))
        .with("active", 1, |_, xi| vec![1.0; xi.len()])
        .with("traction", components, lambda(solved, -1.0));
    if let Some(pairing) = part.pairings.first() {
        drawn = drawn.with("normal", 2, normals(solved, &part.slave, Box::new(Surface::new(&pairing.master.trace, None))));
    }
    let exact: Option<ExactCurve> = tie.exact.clone().filter(|list| list.len() == 1).map(|list| -> ExactCurve {
        let t = solved.solution.state().t;
        Box::new(move |x| list[0].value(&Point::new(x.as_slice()).at_time(t)))
    });
    let name = part_name(&tie.name, p, tie.parts.len());
    if part.multipliers.is_empty() {
        return SideOutput { name, contact: false, part: drawn, rows: without_rows(solved, t, p), exact };
    }
    let rows = component_rows(part);
    // components may have different functions at the ends: one line per function of the one with most
    let richest = (0..rows.len()).max_by_key(|&c| rows[c].len()).unwrap_or(0);
    let jump = jumps(solved, t, p);
    let slave = ClosestPoint::new(&*part.slave.trace.space);
    let arc = ArcLength::new(&*part.slave.trace.space);
    let gap_at = |x: [f64; 3]| {
        let found = slave.project(&Vector::<2>::new(x[0], x[1]))?;
        jump(found.element, &[found.xi]).first().copied()
    };
    let table = centres(&part.slave, &*part.multipliers[richest])
        .into_iter()
        .enumerate()
        .map(|(j, (s, x))| {
            let lambda = if rows.iter().all(|r| r.len() == rows[richest].len()) {
                rows.iter().map(|r| solved.solution.state().lambda[r.start + j]).collect()
            } else {
                at_centre(solved, t, p, slave.project(&arc.point(s)))
            };
            InterfaceRow { s, x, lambda, gap: gap_at(x), active: true }
        })
        .collect();
    SideOutput { name, contact: false, part: drawn, rows: table, exact }
}

/// Returns the table of a tie without multiplier: one line per point of its segments, along the slave.
fn without_rows(solved: &Arc<Plane>, t: usize, p: usize) -> Vec<InterfaceRow> {
    let (model, state) = (solved.solution.model(), solved.solution.state());
    let part = &model.ties[t].parts[p];
    let arc = ArcLength::new(&*part.slave.trace.space);
    let (field, jump) = (TieField::of(model, part, state.t), jumps(solved, t, p));
    let (mut rows, mut map) = (Vec::new(), MapTable::new());
    for (k, segments) in part.pairings.iter().map(|pairing| &pairing.segments).enumerate() {
        let lambda = field.on_segments(model, part, state, k);
        for piece in 0..segments.num_pieces() {
            let (element, points) = (segments.slave[piece], segments.points(piece));
            let xi = &segments.slave_xi[points.clone()];
            part.slave.trace.space.map(element, xi, Order::Values, &mut map);
            for (i, gap) in jump(element, xi).into_iter().enumerate() {
                rows.push(InterfaceRow {
                    s: arc.of(element, xi[i][0]),
                    x: [map.x[i][0], map.x[i][1], 0.0],
                    lambda: lambda.iter().map(|values| values[points.start + i]).collect(),
                    gap: Some(gap),
                    active: true,
                });
            }
        }
    }
    rows.sort_by(|a, b| a.s.total_cmp(&b.s));
    rows
}

/// Returns the multipliers of all components at a point of the slave, for components with different functions.
fn at_centre(solved: &Arc<Plane>, t: usize, p: usize, at: Option<Projection<1, 2>>) -> Vec<f64> {
    let part = &solved.solution.model().ties[t].parts[p];
    let Some(found) = at else { return vec![0.0; part.multipliers.len()] };
    part.multipliers
        .iter()
        .zip(component_rows(part))
        .map(|(psi, rows)| multiplier_at(&**psi, &solved.solution.state().lambda[rows], found.element, &[found.xi])[0])
        .collect()
}

fn contact_side(solved: &Arc<Plane>, c: usize, p: usize, options: &RunOptions) -> SideOutput {
    let contact = &solved.solution.model().contacts[c];
    let part = &contact.parts[p];
    let target = |solved: &Arc<Plane>| -> Box<dyn Obstacle<1, 2>> {
        match &solved.solution.model().contacts[c].parts[p].against {
            Against::Side(master, _) => Box::new(Surface::new(&master.trace, None)),
            Against::Rigid(obstacle, _) => obstacle.target(solved.solution.state().t, Some(&solved.solution.state().u)),
        }
    };
    let facing = normals(solved, &part.slave, target(solved));
    let name = part_name(&contact.name, p, contact.parts.len());
    let mut drawn = Part::new(name.clone(), Arc::clone(&part.slave.trace.space), side_cells(options));
    let (fields, rows) = match &part.multiplier {
        Some(psi) => {
            drawn.least_degree = degree(&**psi);
            by_functions(solved, c, p)
        }
        None => {
            drawn.least_degree = degree(&*part.slave.trace.space);
            by_points(solved, c, p)
        }
    };
    let [lambda, gap, active, push] = fields;
    drawn = drawn
        .with("lambda", 1, lambda)
        .with("gap", 1, gap)
        .with("active", 1, active)
        .with("traction", 2, move |e, xi| {
            let lambda = push(e, xi);
            facing(e, xi).iter().enumerate().map(|(k, n)| -lambda[k / 2] * n).collect()
        })
        .with("normal", 2, normals(solved, &part.slave, target(solved)));
    let exact: Option<ExactCurve> = contact.exact.clone().map(|f| -> ExactCurve {
        let t = solved.solution.state().t;
        Box::new(move |x| f.value(&Point::new(x.as_slice()).at_time(t)))
    });
    SideOutput { name, contact: true, part: drawn, rows, exact }
}

/// A scalar field on a side.
type SideField = Box<dyn Fn(usize, &[Vector<1>]) -> Vec<f64> + Send + Sync>;

/// Returns lambda, gap, status and lambda again of a contact with multiplier functions, and one line of its table per function.
fn by_functions(solved: &Arc<Plane>, c: usize, p: usize) -> ([SideField; 4], Vec<InterfaceRow>) {
    let part = &solved.solution.model().contacts[c].parts[p];
    let rows: Range<usize> = part.rows();
    let gaps = part.gaps(solved.solution.model(), &solved.solution.state().contacts[c][p], &solved.solution.state().u);
    let field = |coefficients: Vec<f64>| -> SideField {
        let solved = Arc::clone(solved);
        Box::new(move |element, xi| {
            let read = solved.solution.model().contacts[c].parts[p].read_through();
            read.map_or_else(Vec::new, |read| multiplier_at(read, &coefficients, element, xi))
        })
    };
    let lambda: Vec<f64> = solved.solution.state().lambda[rows.clone()].to_vec();
    let shown = field(rows.clone().map(|j| f64::from(u8::from(solved.solution.state().active[j]))).collect());
    let active: SideField = Box::new(move |e, xi| shown(e, xi).iter().map(|v| f64::from(u8::from(*v > 0.5))).collect());
    let fields = [field(lambda.clone()), field(gaps.iter().map(|g| g.unwrap_or(0.0)).collect()), active, field(lambda.clone())];
    let centres = part.multiplier.as_ref().map_or_else(Vec::new, |psi| centres(&part.slave, &**psi));
    let line = |(j, (s, x)): (usize, (f64, [f64; 3]))| InterfaceRow {
        s,
        x,
        lambda: vec![lambda[j]],
        gap: gaps[j],
        active: solved.solution.state().active[rows.start + j],
    };
    (fields, centres.into_iter().enumerate().map(line).collect())
}

/// Returns lambda, gap, status and lambda again of a contact by Nitsche's method, and one line of its table per point of the segments,
/// along the slave.
fn by_points(solved: &Arc<Plane>, c: usize, p: usize) -> ([SideField; 4], Vec<InterfaceRow>) {
    let (state, part) = (solved.solution.state(), &solved.solution.model().contacts[c].parts[p]);
    let field = |of: fn([f64; 2]) -> f64| -> SideField {
        let solved = Arc::clone(solved);
        let field = ContactField::of(solved.solution.model(), &solved.solution.model().contacts[c].parts[p], solved.solution.state().t);
        Box::new(move |element, xi| {
            let contact = &solved.solution.model().contacts[c];
            field
                .at(solved.solution.model(), contact, &contact.parts[p], solved.solution.state(), element, xi)
                .into_iter()
                .map(of)
                .collect()
        })
    };
    let (lambda, gap) = (|[l, _]: [f64; 2]| l, |[_, g]: [f64; 2]| g);
    let fields = [field(lambda), field(gap), field(|[l, _]| f64::from(u8::from(l < 0.0))), field(lambda)];
    let (built, first) = (&state.contacts[c][p], part.first_row);
    let gaps = part.gaps(solved.solution.model(), built, &state.u);
    let arc = ArcLength::new(&*part.slave.trace.space);
    let segments = &built.segments;
    let rows_of_points = built.points.as_ref().map_or(&[][..], |points| &points.row);
    let mut rows: Vec<InterfaceRow> = Vec::new();
    for piece in 0..segments.num_pieces() {
        for q in segments.points(piece) {
            let (x, j) = (built.frames.x[q], rows_of_points[q]);
            rows.push(InterfaceRow {
                s: arc.of(segments.slave[piece], segments.slave_xi[q][0]),
                x: [x[0], x[1], 0.0],
                lambda: vec![state.lambda[first + j]],
                gap: gaps[j],
                active: state.active[first + j],
            });
        }
    }
    rows.sort_by(|a, b| a.s.total_cmp(&b.s));
    (fields, rows)
}
