//! A solved model as a stored run, and the fingerprint of a geometry.

use crate::case::{self, BASES, BasisKind, CELLS, Case, MAPPINGS};
use crate::errors::Diagnostics;
use crate::lower::{LowerContext, specification};
use crate::reference::{Fingerprint, StoredPatch, StoredRun, StoredSide, node_points};
use crate::shapes::{MakeControlNet, point_of};
use faying::basis::{Basis, Cell, Order, ShapeTable};
use faying::geometry::Embedding;
use faying::linalg::Vector;
use faying::physics::Assumption;
use faying::problem::{BodyView, Contents, SideView, Solution};
use faying::space::{Body, MeshCells, PatchSpec};

/// Keyword of the case's physics.
pub(super) fn physics_word(case: &Case) -> &'static str {
    match case.model.physics.value {
        case::Physics::Poisson => "poisson",
        case::Physics::Elasticity => "elasticity",
    }
}

/// Keyword of what the case assumes out of the plane; Poisson's equation in the plane asks for bodies of revolution alone.
pub(super) fn assumption_word(case: &Case) -> &'static str {
    match (case.model.assumption.value, case.model.physics.value) {
        (Assumption::Axisymmetric, _) => "axisymmetric",
        (Assumption::Solid, _) => "solid",
        (_, case::Physics::Poisson) => "plane",
        (Assumption::PlaneStress, _) => "plane-stress",
        _ => "plane-strain",
    }
}

fn word<T: PartialEq>(words: &[(&str, T)], value: &T) -> String {
    words.iter().find(|(_, v)| v == value).expect("every value has a word").0.to_owned()
}

/// Returns a solution of `case` as data for a file.
///
/// # Errors
/// Errors of the geometry, which a model that is built does not have.
pub(crate) fn stored_run<const S: usize, const N: usize>(
    case: &Case,
    names: &crate::registry::Names<S, N>,
    net: MakeControlNet<N>,
    solution: &Solution<S, N>,
) -> Result<StoredRun, Diagnostics> {
    let (contents, lambda) = (solution.contents(), solution.multipliers());
    let context = LowerContext { case, names, faults: Diagnostics::new() };
    let mut patches = Vec::with_capacity(case.patches.len());
    for (body, words) in contents.bodies().zip(&case.patches) {
        patches.push(stored_patch(&context, &body, words, net, solution.unknowns()).map_err(|fault| Diagnostics::from(*fault))?);
    }
    let mut run = StoredRun {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        physics: physics_word(case).to_owned(),
        assumption: assumption_word(case).to_owned(),
        dimension: N,
        components: contents.components(),
        t: solution.t(),
        patches,
        sides: Vec::new(),
    };
    for of in contents.interfaces() {
        for slave in of.sides() {
            let mut first = slave.rows().start;
            let fields: Vec<(&dyn Basis<S>, &[f64])> = slave
                .read_through()
                .into_iter()
                .map(|m| {
                    let range = first..first + m.num_functions();
                    first = range.end;
                    (m, &lambda[range])
                })
                .collect();
            run.sides.extend(stored_sides(&contents, of.name(), slave.side(), &fields));
        }
    }
    Ok(run)
}

fn stored_patch<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    body: &BodyView<'_, S, N>,
    words: &case::Patch,
    net: MakeControlNet<N>,
    u: &[f64],
) -> Result<StoredPatch, Box<crate::errors::Diagnostic>> {
    let mut stored = StoredPatch {
        name: body.name().to_owned(),
        backend: body.backend().to_owned(),
        functions: body.space().num_functions(),
        row: row(&**body.body()),
        coefficients: u[body.unknowns()].to_vec(),
        ..StoredPatch::default()
    };
    match specification(context, words, net)? {
        Some(spec) => {
            stored.geometry = of_net(&spec);
            stored.degree = spec.degree.to_vec();
            stored.continuity = spec.continuity;
            stored.basis = word(&BASES, &spec.basis);
            stored.cells = word(&CELLS, &spec.cells);
            stored.mapping = word(&MAPPINGS, &spec.mapping);
            stored.breakpoints = spec.breakpoints.to_vec();
        }
        None => {
            stored.geometry = of_cells::<N>(words);
            stored.degree = vec![words.discretization.degree.value.first().copied().unwrap_or(1); N];
            stored.basis = word(&BASES, &BasisKind::Auto);
            stored.cells = word(&CELLS, &Cell::Tensor);
            stored.mapping = word(&MAPPINGS, &words.discretization.mapping.value);
            stored.refine = words.refine.value;
        }
    }
    Ok(stored)
}

/// Number of functions in a row of a grid: those of the third side (v0), if they are the first of the body, else 0.
fn row<const S: usize, const N: usize>(body: &dyn Body<S, N>) -> usize {
    let first = body.sides().get(2).and_then(|side| body.trace(side).ok());
    first.filter(|trace| trace.dofs.iter().enumerate().all(|(k, &f)| k == f)).map_or(0, |trace| trace.dofs.len())
}

/// Multiplier of a slave side, in parts on single patches with facets of one shape; empty without multiplier.
fn stored_sides<const S: usize, const N: usize>(
    contents: &Contents<'_, S, N>,
    name: &str,
    slave: &SideView<S, N>,
    fields: &[(&dyn Basis<S>, &[f64])],
) -> Vec<StoredSide> {
    if fields.is_empty() {
        return Vec::new();
    }
    let trace = slave.trace();
    let elements = trace.space.num_elements();
    let ends = slave.runs().iter().skip(1).map(|r| r.0).chain([elements]);
    let degree = fields.iter().flat_map(|(m, _)| (0..elements).map(|e| m.degree(e).into_iter().max().unwrap_or(0))).max().unwrap_or(0);
    let mut all = Vec::new();
    for (&(first, patch), end) in slave.runs().iter().zip(ends) {
        for (cells, cell) in CELLS {
            let elements: Vec<usize> = (first..end).filter(|&e| trace.space.cell(e) == cell).collect();
            if elements.is_empty() {
                continue;
            }
            let facets: Vec<&Embedding<S, N>> = elements.iter().map(|&e| &trace.facets[e]).collect();
            let bodies = facets.iter().map(|f| f.element as f64);
            let origins = (0..N).flat_map(|k| facets.iter().map(move |f| f.origin[k]));
            let axes = (0..S).flat_map(|s| (0..N).map(move |k| (k, s))).flat_map(|(k, s)| facets.iter().map(move |f| f.axes[(k, s)]));
            all.push(StoredSide {
                name: name.to_owned(),
                patch: contents.body(patch).name().to_owned(),
                components: fields.len(),
                degree,
                cells: cells.to_owned(),
                facets: bodies.chain(origins).chain(axes).collect(),
                values: at_nodes(fields, &elements, &node_points(degree, cell)),
            });
        }
    }
    all
}

/// Values of all `fields` at `points` of `elements`: the field fastest, then the point.
fn at_nodes<const S: usize>(fields: &[(&dyn Basis<S>, &[f64])], elements: &[usize], points: &[Vector<S>]) -> Vec<f64> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    let mut values = vec![0.0; elements.len() * points.len() * fields.len()];
    for (c, (basis, lambda)) in fields.iter().enumerate() {
        for (k, &e) in elements.iter().enumerate() {
            basis.active(e, &mut ids);
            basis.tabulate(e, points, Order::Values, &mut table);
            for q in 0..points.len() {
                let value: f64 = ids.iter().zip(table.values(q)).map(|(&j, v)| lambda[j] * v).sum();
                values[fields.len() * (k * points.len() + q) + c] = value;
            }
        }
    }
    values
}

/// The fingerprint of the net of a patch.
pub(super) fn of_net<const N: usize>(spec: &PatchSpec<N>) -> Fingerprint {
    let net = &spec.net;
    let mut counts = vec![net.points.len(), usize::from(net.weights.is_some())];
    counts.extend(net.axes.iter().flat_map(|a| [a.polynomial_degree(), a.num_functions()]));
    let knots = net.axes.iter().flat_map(|a| a.knots().iter().copied());
    let points = net.points.iter().flat_map(|x| x.iter().copied());
    fingerprint(&counts, knots.chain(points).chain(net.weights.iter().flatten().copied()))
}

/// The fingerprint of the cells that a patch is read from, moved as the patch is.
pub(super) fn of_cells<const N: usize>(patch: &case::Patch) -> Fingerprint {
    let Some(cells) = patch.geometry.shape.part().and_then(|p| p.cells::<N>()) else { return Fingerprint::default() };
    let MeshCells { points, blocks, .. } = &cells;
    let mut counts = vec![points.len()];
    for block in blocks {
        counts.extend([usize::from(block.cell == Cell::Simplex), block.order, block.nodes.len()]);
        counts.extend(&block.nodes);
    }
    let places = (0..points.len()).filter_map(|k| point_of::<N>(patch, k));
    fingerprint(&counts, places.flat_map(|x| x.iter().copied().collect::<Vec<f64>>()))
}

/// Tolerance for the sums of a fingerprint, relative to their scale.
const SAME: f64 = 1e-12;

/// Whether two fingerprints are those of one geometry, up to round-off.
pub(super) fn same_geometry(a: &Fingerprint, b: &Fingerprint) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= SAME * a.size.max(b.size);
    a.counts == b.counts && a.sums.iter().zip(&b.sums).all(|(x, y)| near(*x, *y))
}

fn fingerprint(counts: &[usize], numbers: impl Iterator<Item = f64>) -> Fingerprint {
    let bytes: Vec<u8> = counts.iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
    let (mut sums, mut size) = ([0.0; 4], 0.0);
    for (k, x) in numbers.enumerate() {
        size += x.abs();
        for (j, sum) in sums.iter_mut().enumerate() {
            *sum += factor(4 * k + j) * x;
        }
    }
    Fingerprint { counts: case::sha256(&bytes), sums, size }
}

/// Pseudo-random number in [-1, 1): SplitMix64 of `k`.
fn factor(k: usize) -> f64 {
    let mut z = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) as f64 / 2f64.powi(63) - 1.0
}
