//! Numbers of a result from the solution.

use super::errors::{error_names, errors};
use super::iteration;
use crate::case::Case;
use crate::lower::Built;
use crate::named::Named;
use crate::reference::Reference;
use crate::result::{
    ActiveSetSummary, Balance, ContactReport, Extremes, Gaps, GeometryReport, InterfaceReport, Kkt, L2, LoadReport, Moment, Norm,
    RunResult, SolveReport, TiedSides, Unknowns,
};
use faying::contact::{Contact, NoHalfWidth, Transmitted};
use faying::coupling::Rows;
use faying::geometry::Geometry;
use faying::problem::{Against, LoadSum, Model, Resultant, SideModel, Solution, StepState, TieModel, reactions};
use faying::quadrature::{PerElement, Quadrature};
use faying::space::{diameter, measure, quality};
use std::collections::BTreeMap;

/// Slave side, rows of its contact, and the pressure and forces it transmits.
pub type Zone<'a, const S: usize, const N: usize> = (&'a dyn Geometry<S, N>, &'a Contact<S, N>, Transmitted<N>);
/// Function for half the width of a contact zone on slave sides of S dimensions; the flag: half model.
pub type HalfWidth<const S: usize, const N: usize> = fn(&[Zone<'_, S, N>], bool) -> Result<f64, NoHalfWidth>;

/// The result before anything is solved: all names, all counts, the geometry.
pub fn skeleton<const S: usize, const N: usize>(command: &str, case: &Case, model: &Built<S, N>) -> RunResult {
    let mut result = RunResult::new(command, &case.source.name);
    result.backend = backend(model);
    result.backends = model.patches.iter().map(|p| (p.name.clone(), p.backend.clone())).collect();
    result.unknowns = Unknowns { primal: model.num_primal(), multipliers: model.num_multipliers() };
    let soundness = model.patches.iter().map(|p| match p.body.known_quality() {
        Some(known) => known.least_jacobian,
        None => quality(&**p.body.space()).map_or(f64::NAN, |q| q.least_jacobian),
    });
    result.geometry = GeometryReport {
        measure: model.patches.iter().map(|p| (p.name.clone(), measure::<N, N, f64, _>(&**p.body.space()))).collect(),
        least_jacobian: soundness.fold(f64::INFINITY, f64::min),
        points: model.patches.iter().map(|p| (p.name.clone(), gauss_points(&p.rules))).collect(),
        elements: model.patches.iter().map(|p| p.body.space().num_elements()).sum(),
        h: model.patches.iter().map(|p| diameter::<N, f64, _>(&**p.body.space())).fold(0.0, f64::max),
        glued: model.glued_sides.clone(),
    };
    result.contact = model
        .contacts
        .iter()
        .map(|c| {
            let displacement = c.obstacle.as_ref().map(|_| vec![0.0; N]);
            (c.name.clone(), ContactReport { force: vec![0.0; N], moment: moment::<N>([0.0; 3]), displacement, ..Default::default() })
        })
        .collect();
    result.interface = model.ties.iter().map(|t| (t.name.clone(), tied(t))).collect();
    for label in model.supports.iter().map(|s| &s.label).chain(model.pins.iter().map(|p| &p.rim.label)) {
        if result.reactions.get(label).is_none() {
            result.reactions.push(label.clone(), vec![0.0; model.components]);
        }
    }
    result.loads = loads::<N>(model.components, &model.no_loads());
    result.balance = Balance { force: vec![0.0; model.components], moment: (model.components == N).then(|| moment::<N>([0.0; 3])) };
    for name in error_names(model) {
        result.errors.push(name, 0.0);
    }
    result.solve = Some(SolveReport { active_set: (!model.contacts.is_empty()).then(ActiveSetSummary::default), ..Default::default() });
    result.checks_expected = case.checks.len();
    result.warnings.extend(case.warnings.items.iter().chain(&model.warnings.items).cloned());
    result.warnings.extend(super::poor::of_model(case, model));
    result
}

/// Returns the Gauss points per direction, the most of all rules; without tensor cells the points of the largest rule.
fn gauss_points<const N: usize>(rules: &PerElement<N>) -> Vec<usize> {
    let along = rules.rules().iter().filter_map(|r| r.axes(0)).map(|axes| axes.map(|a| a.rule(0).points.len()));
    let most = along.reduce(|a, b| std::array::from_fn(|k| a[k].max(b[k])));
    most.map_or_else(|| rules.rules().iter().map(|r| r.rule(0).points.len()).max().into_iter().collect(), |m| m.to_vec())
}

/// Name of the backend: that of all patches, "slave+master" if all side pairs have the same two different backends, else "mixed".
fn backend<const S: usize, const N: usize>(model: &Model<S, N>) -> String {
    let first = model.patches.first().map_or("", |p| &p.backend);
    if model.patches.iter().all(|p| p.backend == first) {
        return first.into();
    }
    let name = |side: &SideModel<S, N>| model.patches[side.patch].backend.as_str();
    let ties = model.ties.iter().flat_map(|t| &t.parts).flat_map(|p| p.pairings.iter().map(|m| (name(&p.slave), name(&m.master))));
    let contacts = model.contacts.iter().flat_map(|c| &c.parts).filter_map(|p| match &p.against {
        Against::Side(master, _) => Some((name(&p.slave), name(master))),
        Against::Rigid(..) => None,
    });
    let mut pairs: Vec<(&str, &str)> = ties.chain(contacts).collect();
    pairs.dedup();
    match pairs.as_slice() {
        [(slave, master)] if slave != master => format!("{slave}+{master}"),
        _ => "mixed".into(),
    }
}

fn moment<const N: usize>(m: [f64; 3]) -> Moment {
    if N == 2 { Moment::Plane(m[2]) } else { Moment::Space(m.to_vec()) }
}

/// The loads of a problem in N dimensions under their names.
pub fn loads<const N: usize>(components: usize, sums: &[LoadSum]) -> Named<LoadReport> {
    let report =
        |r: &Resultant| LoadReport { force: r.force[..components].to_vec(), moment: (components == N).then(|| moment::<N>(r.moment)) };
    sums.iter().map(|s| (s.name.clone(), report(&s.resultant))).collect()
}

/// Fills `result` from the solution of a step.
pub fn fill<const S: usize, const N: usize>(
    result: &mut RunResult,
    solution: &Solution<S, N>,
    reference: Option<&Reference<S, N>>,
    half_width: Option<HalfWidth<S, N>>,
    reason: &str,
) {
    let (model, state) = (solution.model(), solution.state());
    result.solved = true;
    result.solve = Some(SolveReport {
        reason: reason.into(),
        linear: state.method.clone(),
        residual: state.residual,
        condition: state.condition,
        iterations: state.iterations,
        factors: state.factors,
        active_set: state.active_set.as_ref().map(iteration::summary),
    });
    result.energy = solution.energy();
    let mut outside = state.load;
    let known = std::mem::take(&mut result.contact);
    result.contact = contacts(model, state, half_width, &mut outside);
    for ((_, report), (_, old)) in result.contact.0.iter_mut().zip(known.0) {
        report.multiplier = old.multiplier;
    }
    let known = std::mem::take(&mut result.interface);
    result.interface = model.ties.iter().map(|t| (t.name.clone(), interface(model, state, t))).collect();
    for ((_, report), (_, old)) in result.interface.0.iter_mut().zip(known.0) {
        report.multiplier = old.multiplier;
    }
    let mut sums: Named<Vec<f64>> = Named::default();
    for reaction in reactions(model, state, &mut outside) {
        match sums.0.iter_mut().find(|(label, _)| label == reaction.label()) {
            Some((_, sum)) => sum.iter_mut().zip(&reaction.force).for_each(|(s, f)| *s += f),
            None => sums.push(reaction.label().to_owned(), reaction.force),
        }
    }
    result.reactions = sums;
    result.loads = loads::<N>(model.components, &state.loads);
    result.balance =
        Balance { force: outside.force[..model.components].to_vec(), moment: (model.components == N).then(|| moment::<N>(outside.moment)) };
    result.errors = errors(solution, reference);
}

/// Sum of coupling forces on both bodies, which vanishes: action and reaction.
#[derive(Debug, Default)]
struct Pull {
    sum: [f64; 3],
    size: f64,
}

impl Pull {
    fn push<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, unknown: usize, force: f64) {
        let of = model.patches.iter().find(|p| p.range().contains(&unknown));
        self.sum[of.map_or(0, |p| (unknown - p.field.first) % p.field.components)] += force;
        self.size += force.abs();
    }

    fn add<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, rows: &Rows, lambda: &[f64]) {
        for &(i, j, value) in rows.slave.entries.iter().chain(&rows.master.entries) {
            self.push(model, j, value * lambda[i]);
        }
    }

    /// Returns the largest component of the sum, as a share of all forces.
    fn defect(&self) -> f64 {
        if self.size > 0.0 { self.sum.iter().fold(0.0, |m: f64, d| m.max(d.abs())) / self.size } else { 0.0 }
    }
}

fn contacts<const S: usize, const N: usize>(
    model: &Model<S, N>,
    state: &StepState<S, N>,
    half_width: Option<HalfWidth<S, N>>,
    outside: &mut Resultant,
) -> Named<ContactReport> {
    let mut all = Named::default();
    for (contact, built) in model.contacts.iter().zip(&state.contacts) {
        let mut total = Resultant::default();
        let mut report = ContactReport {
            pressure: Extremes { min: f64::INFINITY, max: f64::NEG_INFINITY },
            gap: Gaps { min: f64::INFINITY, least: f64::INFINITY },
            iterations: state.active_set.as_ref().map_or(0, |a| a.iterations),
            ..Default::default()
        };
        let mut zones: Vec<Zone<'_, S, N>> = Vec::new();
        let mut pull = Pull::default();
        for (part, rows) in contact.parts.iter().zip(built) {
            let range = part.rows();
            let lambda = &state.lambda[range.clone()];
            let sent = part.transmitted(rows, lambda);
            for k in 0..N {
                total.force[k] += sent.force[k];
            }
            for k in 0..3 {
                total.moment[k] += sent.moment[k];
            }
            report.area += sent.area;
            report.pressure.min = report.pressure.min.min(sent.least_pressure);
            report.pressure.max = report.pressure.max.max(sent.largest_pressure);
            for ((gap, &l), j) in part.gaps(model, rows, &state.u).into_iter().zip(&state.mu[range.clone()]).zip(range) {
                report.active += usize::from(state.active[j]);
                if state.sign_case[j] < 9 {
                    report.sign_cases[usize::from(state.sign_case[j])] += 1;
                }
                let Some(gap) = gap else { continue };
                report.gap.min = report.gap.min.min(gap);
                report.kkt = Kkt {
                    lambda: report.kkt.lambda.max(l),
                    gap: report.kkt.gap.max(-gap),
                    product: report.kkt.product.max((l * gap).abs()),
                };
            }
            report.gap.least = part.point_gaps(model, rows, &state.u).into_iter().fold(report.gap.least, f64::min);
            report.segments.count += rows.segments.num_pieces();
            report.segments.measure += rows.segments.measure();
            if let Against::Side(..) = part.against {
                pull.add(model, rows.reaction.as_ref().unwrap_or(&rows.rows), lambda);
            }
            if matches!(part.against, Against::Rigid(..)) {
                let mut force = [0.0; 3];
                force[..N].copy_from_slice(sent.force.as_slice());
                // the force that drives the obstacle is among the loads
                contact.obstacle.iter().flat_map(|o| &o.pressed).for_each(|p| force[p.component] = 0.0);
                outside.sum(&Resultant { force, moment: sent.moment });
            }
            zones.push((&*part.slave.trace.space, rows, sent));
        }
        report.consistency = contact.consistency(built, state);
        report.balance = pull.defect();
        match half_width.map_or(Ok(0.0), |f| f(&zones, contact.symmetry)) {
            Ok(found) => report.half_width = found,
            Err(why) => (report.half_width, report.reason) = (f64::NAN, Some(format!("half_width: {why}"))),
        }
        report.force = total.force[..N].to_vec();
        report.moment = moment::<N>(total.moment);
        report.displacement = contact.obstacle.as_ref().map(|o| o.displacement(state.t, Some(&state.u)).as_slice().to_vec());
        all.push(contact.name.clone(), report);
    }
    all
}

/// Report of an interface before anything is solved.
fn tied<const S: usize, const N: usize>(tie: &TieModel<S, N>) -> InterfaceReport {
    let mut report = InterfaceReport::default();
    let mut whole = 0.0;
    let mut covered = 0.0;
    for part in &tie.parts {
        whole += part.pairings.first().map_or(0.0, |p| p.segments.report.slave_measure);
        for pairing in &part.pairings {
            let seen = &pairing.segments.report;
            covered += seen.covered;
            report.distance = report.distance.max(seen.distance);
            let share = if seen.slave_measure > 0.0 { seen.covered / seen.slave_measure } else { 0.0 };
            let (slave, master) = (part.slave.label.clone(), pairing.master.label.clone());
            report.sides.push(TiedSides { slave, master, distance: seen.distance, share });
        }
    }
    report.share = if whole > 0.0 { covered / whole } else { 0.0 };
    report
}

fn interface<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>, tie: &TieModel<S, N>) -> InterfaceReport {
    let (mut report, result) = (tied(tie), tie.result(model, state));
    let mut pull = Pull::default();
    for part in &tie.parts {
        report.segments.count += part.pairings.iter().map(|p| p.segments.num_pieces()).sum::<usize>();
        let lambda = &state.lambda[part.first_row..part.first_row + part.num_rows];
        pull.add(model, part.reaction.as_ref().unwrap_or(&part.rows), lambda);
        // forces of the added stiffness satisfy action and reaction, too
        let mut forces: BTreeMap<usize, f64> = BTreeMap::new();
        let changed = if part.changes(model) { part.stiffness_at(model, state.t).ok() } else { None };
        for &(i, j, value) in &changed.as_ref().unwrap_or(&part.stiffness).entries {
            *forces.entry(i).or_default() += value * state.u[j];
        }
        forces.iter().for_each(|(&i, &force)| pull.push(model, i, force));
    }
    report.segments.measure = result.area;
    report.lambda = Norm { norm: result.multiplier };
    report.jump = L2 { l2: result.jump };
    report.consistency = result.consistency;
    report.balance = pull.defect();
    report
}
