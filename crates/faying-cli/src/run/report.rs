//! Numbers of a result from the solution.

use super::errors::{error_names, errors};
use super::iteration;
use crate::case::Case;
use crate::lower::LoweredCase;
use crate::reference::Reference;
use crate::result::{
    ActiveSetSummary, Balance, ContactReport, Extremes, Gaps, GeometryReport, InterfaceReport, Kkt, L2, LoadReport, Moment, Norm,
    RunResult, SegmentsReport, SolveReport, TiedSides, Unknowns,
};
use faying::problem::{
    ContactResult, Contents, InterfaceId, InterfaceView, LoadSum, PairView, Resultant, SideView, Solution, TieResult, Violation,
};
use faying::quadrature::{PerElement, Quadrature};
use faying::space::{diameter, quality};
use indexmap::IndexMap;

/// The result before anything is solved: all names, all counts, the geometry.
pub fn skeleton<const S: usize, const N: usize>(command: &str, case: &Case, built: &LoweredCase<S, N>) -> RunResult {
    let (mut result, contents) = (RunResult::new(command, &case.source.name), built.system.contents());
    let bodies = || contents.bodies();
    result.backend = backend(&contents);
    result.backends = bodies().map(|b| (b.name().to_owned(), b.backend().to_owned())).collect();
    let size = contents.size();
    result.unknowns = Unknowns { primal: size.primal, multipliers: size.multipliers };
    let soundness = bodies().map(|b| match b.body().known_quality() {
        Some(known) => known.least_jacobian,
        None => quality(&**b.space()).map_or(f64::NAN, |q| q.least_jacobian),
    });
    result.geometry = GeometryReport {
        measure: bodies().map(|b| (b.name().to_owned(), b.measure())).collect(),
        least_jacobian: soundness.fold(f64::INFINITY, f64::min),
        points: bodies().map(|b| (b.name().to_owned(), gauss_points(b.rules()))).collect(),
        elements: bodies().map(|b| b.space().num_elements()).sum(),
        h: bodies().map(|b| diameter::<N, f64, _>(&**b.space())).fold(0.0, f64::max),
        glued: built.glued_sides.clone(),
    };
    let contact = |c: InterfaceView<'_, S, N>| {
        let displacement = c.has_obstacle().then(|| vec![0.0; N]);
        let half_width = (S == 1).then_some(0.0);
        let (moment, segments) = (moment::<N>([0.0; 3]), segments::<N>([0; 2], 0.0, 0.0, displacement.is_none()));
        let report = ContactReport { force: vec![0.0; N], moment, displacement, segments, half_width, ..Default::default() };
        (c.name().to_owned(), report)
    };
    result.contact = contents.contacts().map(contact).collect();
    let components = contents.components();
    result.interface = contents.ties().map(|t| (t.name().to_owned(), tied(&t, components))).collect();
    for support in contents.supports() {
        result.reactions.entry(support.label.to_owned()).or_insert_with(|| vec![0.0; components]);
    }
    result.loads = loads::<N>(components, &built.system.no_loads());
    result.balance = Balance { force: vec![0.0; components], moment: (components == N).then(|| moment::<N>([0.0; 3])) };
    for name in error_names(built) {
        result.errors.insert(name, 0.0);
    }
    let active_set = (contents.contacts().len() > 0).then(ActiveSetSummary::default);
    result.solve = Some(SolveReport { active_set, ..Default::default() });
    result.checks_expected = case.checks.len();
    result.warnings.extend(case.warnings.items.iter().chain(&built.warnings.items).cloned());
    result.warnings.extend(super::warnings::of_model(case, built));
    result
}

/// Returns the Gauss points per direction, the most of all rules; without tensor cells the points of the largest rule.
fn gauss_points<const N: usize>(rules: &PerElement<N>) -> Vec<usize> {
    let along = rules.rules().iter().filter_map(|r| r.axes(0)).map(|axes| axes.map(|a| a.rule(0).points.len()));
    let most = along.reduce(|a, b| std::array::from_fn(|k| a[k].max(b[k])));
    most.map_or_else(|| rules.rules().iter().map(|r| r.rule(0).points.len()).max().into_iter().collect(), |m| m.to_vec())
}

/// Name of the backend: that of all patches, "slave+master" if all side pairs have the same two different backends, else "mixed".
fn backend<const S: usize, const N: usize>(contents: &Contents<'_, S, N>) -> String {
    let first = contents.bodies().next().map_or("", |b| b.backend());
    if contents.bodies().all(|b| b.backend() == first) {
        return first.into();
    }
    let name = |side: &SideView<S, N>| contents.body(side.body()).backend();
    let slaves = contents.interfaces().flat_map(|of| of.sides());
    let mut pairs: Vec<(&str, &str)> =
        slaves.flat_map(|s| s.pairs().iter().map(|pair| (name(s.side()), name(pair.master()))).collect::<Vec<_>>()).collect();
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
pub fn loads<const N: usize>(components: usize, sums: &[LoadSum]) -> IndexMap<String, LoadReport> {
    let report =
        |r: &Resultant| LoadReport { force: r.force[..components].to_vec(), moment: (components == N).then(|| moment::<N>(r.moment)) };
    sums.iter().map(|s| (s.name.clone(), report(&s.resultant))).collect()
}

/// Fills `result` from the solution of a step.
pub fn fill<const S: usize, const N: usize>(
    result: &mut RunResult,
    solution: &Solution<S, N>,
    reference: Option<&Reference<S, N>>,
    reason: &str,
) {
    let (contents, linear) = (solution.contents(), solution.linear());
    result.solved = true;
    result.solve = Some(SolveReport {
        reason: reason.into(),
        linear: linear.method.to_owned(),
        residual: linear.residual,
        condition: linear.condition,
        iterations: linear.iterations,
        factors: linear.factors,
        active_set: solution.active_set().map(iteration::summary),
    });
    result.energy = solution.energy();
    let iterations = solution.active_set().map_or(0, |a| a.iterations);
    let (mut ties, mut contacts) = (result.interface.values_mut(), result.contact.values_mut());
    for of in contents.interfaces() {
        match of.id() {
            InterfaceId::Tie(tie) => {
                let (Some(report), Ok(found)) = (ties.next(), solution.tie(tie)) else { continue };
                *report = interface_report::<N>(std::mem::take(report), found);
            }
            InterfaceId::Contact(contact) => {
                let (Some(report), Ok(found)) = (contacts.next(), solution.contact(contact)) else { continue };
                *report = ContactReport { multiplier: report.multiplier.take(), ..contact_report(found, iterations) };
            }
        }
    }
    let mut sums: IndexMap<String, Vec<f64>> = IndexMap::default();
    for reaction in solution.reactions() {
        let add = |sum: &mut Vec<f64>| sum.iter_mut().zip(&reaction.force).for_each(|(s, f)| *s += f);
        sums.entry(reaction.label().to_owned()).and_modify(add).or_insert_with(|| reaction.force.clone());
    }
    result.reactions = sums;
    let (components, outside) = (contents.components(), solution.balance());
    result.loads = loads::<N>(components, solution.loads());
    result.balance =
        Balance { force: outside.force[..components].to_vec(), moment: (components == N).then(|| moment::<N>(outside.moment)) };
    result.errors = errors(solution, reference);
}

fn contact_report<const N: usize>(result: ContactResult<N>, iterations: usize) -> ContactReport {
    let (half_width, reason) = match result.half_width {
        Some(Err(why)) => (Some(f64::NAN), Some(format!("half_width: {why}"))),
        Some(Ok(found)) => (Some(found), None),
        None => (None, None),
    };
    let Violation { lambda, gap, product } = result.violation;
    ContactReport {
        force: result.force.as_slice().to_vec(),
        moment: moment::<N>(result.moment),
        displacement: result.displacement.map(|by| by.as_slice().to_vec()),
        area: result.area,
        pressure: Extremes { min: result.least_pressure, max: result.largest_pressure },
        gap: Gaps { min: result.least_gap, least: result.least_point_gap },
        active: result.active,
        kkt: Kkt { lambda, gap, product },
        sign_cases: result.sign_cases,
        segments: segments::<N>([result.pieces, result.lost], result.measure, result.outside, result.displacement.is_none()),
        half_width,
        reason,
        iterations,
        consistency: result.consistency,
        balance: result.balance,
        multiplier: None,
    }
}

/// Report of an interface before anything is solved.
fn tied<const S: usize, const N: usize>(tie: &InterfaceView<'_, S, N>, components: usize) -> InterfaceReport {
    let segments = segments::<N>([0; 2], 0.0, 0.0, true);
    let mut report =
        InterfaceReport { force: vec![0.0; components], moment: moment::<N>([0.0; 3]), segments, ..InterfaceReport::default() };
    let mut whole = 0.0;
    let mut covered = 0.0;
    // pieces of one side between its kinks are one
    for pieces in tie.sides().chunk_by(|a, b| a.number() == b.number()) {
        let first = report.sides.len();
        let measure: f64 = pieces.iter().map(|piece| piece.pairs().first().map_or(0.0, PairView::slave_measure)).sum();
        whole += measure;
        for pair in pieces.iter().flat_map(|piece| piece.pairs()) {
            covered += pair.covered();
            report.distance = report.distance.max(pair.distance());
            let share = if measure > 0.0 { pair.covered() / measure } else { 0.0 };
            let (slave, master) = (pieces[0].side().label().to_owned(), pair.master().label().to_owned());
            match report.sides[first..].iter_mut().find(|known| known.master == master) {
                Some(known) => (known.distance, known.share) = (known.distance.max(pair.distance()), known.share + share),
                None => report.sides.push(TiedSides { slave, master, distance: pair.distance(), share }),
            }
        }
    }
    report.share = if whole > 0.0 { covered / whole } else { 0.0 };
    report
}

/// Pieces and lost elements; what is told of surfaces is left out in the plane and against obstacles.
fn segments<const N: usize>([count, lost]: [usize; 2], measure: f64, outside: f64, of_bodies: bool) -> SegmentsReport {
    let told = N == 3 && of_bodies;
    SegmentsReport { count, measure, outside: told.then_some(outside), lost: told.then_some(lost) }
}

fn interface_report<const N: usize>(report: InterfaceReport, result: TieResult) -> InterfaceReport {
    InterfaceReport {
        force: result.force[..report.force.len()].to_vec(),
        moment: moment::<N>(result.moment),
        segments: segments::<N>([result.pieces, result.lost], result.area, result.outside, true),
        lambda: Norm { norm: result.multiplier },
        jump: L2 { l2: result.jump },
        consistency: result.consistency,
        balance: result.balance,
        ..report
    }
}
