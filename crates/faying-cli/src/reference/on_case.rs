//! Stored run as a reference solution: its bodies on the geometry of the case, and its multipliers on the slave sides of the case.

use super::parameters::Parameters;
use super::stored::{assumption_word, of_cells, of_net, physics_word, same_geometry};
use crate::case::{self, BASES, CELLS, MAPPINGS};
use crate::errors::Diagnostic;
use crate::lower::{LowerContext, mesh_body, mesh_counts, specification};
use crate::reference::{StoredPatch, StoredRun, StoredSide, node_weights};
use crate::shapes::MakeControlNet;
use faying::assembly::gauss_rules;
use faying::basis::{Basis, Cell};
use faying::coupling::Segments;
use faying::coupling::interface::{Partners, Tolerance};
use faying::geometry::{ClosestPoint, Embedding};
use faying::linalg::{Matrix, Vector};
use faying::problem::{Contents, InterfaceId, InterfaceSide, OtherField, SideView};
use faying::quadrature::{PerElement, Quadrature, Rule, TensorRule, gauss_legendre};
use faying::space::{Body, Dimension, Field, Mapping, PatchSpec, Space, Trace, field_at};
use std::sync::Arc;

/// Largest share of a side that a stored multiplier may leave out.
const UNCOVERED: f64 = 1e-6;
/// Gauss points beyond the higher of both degrees plus one.
const EXTRA_POINTS: usize = 1;
/// Most parts per direction of an element on which a finer field is integrated.
const MOST_PARTS: usize = 4;
/// Relative difference below which the end times of two runs are the same.
const SAME_TIME: f64 = 1e-9;

/// A stored run on the model of a case.
#[derive(Debug)]
pub struct Reference<const S: usize, const N: usize> {
    /// One per body of the model, in its order.
    pub patches: Vec<ReferencePatch<S, N>>,
    /// Multipliers of the interfaces and contacts that both have.
    pub lambda: Vec<ReferenceLambda<S>>,
}

/// A body of a stored run.
#[derive(Debug)]
pub struct ReferencePatch<const S: usize, const N: usize> {
    body: Box<dyn Body<S, N>>,
    field: Field,
    u: Vec<f64>,
    way: Way<N>,
    /// Rules on the elements of the model's body, for integrals with both fields.
    pub rules: PerElement<N>,
}

/// Method to find a point of the model's body in the stored body.
#[derive(Debug)]
enum Way<const N: usize> {
    /// By its parameters, if both maps are the same: grids of the model and of the run.
    Parameters(Box<[Parameters<N>; 2]>),
    /// By its position: closest-point projection.
    Closest(Box<ClosestPoint<N, N, Arc<dyn Space<N, N>>>>),
}

impl<const S: usize, const N: usize> ReferencePatch<S, N> {
    /// Value and gradient at a point of the model's body: element, local point, position. NaN if the closest-point projection fails,
    /// because the position or squares of distances are not finite.
    ///
    /// # Panics
    /// If u has not C components.
    pub fn at<const C: usize>(&self, element: usize, xi: &Vector<N>, x: &Vector<N>) -> (Vector<C>, Matrix<C, N>) {
        let (element, xi) = match &self.way {
            Way::Parameters(grids) => grids[1].find(&grids[0].at(element, xi)),
            Way::Closest(closest) => match closest.project(x) {
                Some(foot) => (foot.element, foot.xi),
                // errors that are not finite are reported later, with a reason
                None => return (Vector::repeat(f64::NAN), Matrix::repeat(f64::NAN)),
            },
        };
        let at = field_at::<C, N, f64, _>(&**self.body.space(), &self.field, &self.u, element, &[xi])[0];
        (at.value, at.gradient)
    }
}

impl<const S: usize, const N: usize> OtherField<N> for ReferencePatch<S, N> {
    fn at(&self, element: usize, xi: &Vector<N>, x: &Vector<N>, components: usize) -> ([f64; 3], [[f64; 3]; 3]) {
        let (mut u, mut slope) = ([0.0; 3], [[0.0; 3]; 3]);
        if components == 1 {
            let (value, gradient) = self.at::<1>(element, xi, x);
            u[0] = value[0];
            (0..N).for_each(|j| slope[0][j] = gradient[j]);
        } else {
            let (value, gradient) = self.at::<N>(element, xi, x);
            for i in 0..N {
                u[i] = value[i];
                (0..N).for_each(|j| slope[i][j] = gradient[(i, j)]);
            }
        }
        (u, slope)
    }
}

/// lambda of a stored run on the slave sides of an interface or contact.
#[derive(Debug)]
pub struct ReferenceLambda<const S: usize> {
    /// The interface or contact.
    pub name: String,
    /// Per part of it, the pieces that its slave side has in common with each side of the run.
    pub parts: Vec<Vec<OnSide<S>>>,
}

/// Pieces that a slave side of the model (slave) has in common with one of a stored run (master).
#[derive(Debug)]
pub struct OnSide<const S: usize> {
    /// The pieces.
    pub segments: Segments<S>,
    components: usize,
    degree: usize,
    cell: Cell,
    values: Arc<Vec<f64>>,
}

impl<const S: usize, const N: usize> Reference<S, N> {
    /// lambda of an interface or contact, if the run has it.
    pub fn lambda_of(&self, name: &str) -> Option<&ReferenceLambda<S>> {
        self.lambda.iter().find(|l| l.name == name)
    }
}

impl<const S: usize> OnSide<S> {
    /// lambda at a point of a piece, one number per component.
    pub fn at(&self, piece: usize, point: usize) -> Vec<f64> {
        let weights = node_weights(self.degree, self.cell, &self.segments.master_xi[point]);
        let first = self.components * weights.len() * self.segments.master[piece];
        let value = |c: usize| weights.iter().enumerate().map(|(k, w)| w * self.values[first + self.components * k + c]).sum();
        (0..self.components).map(value).collect()
    }
}

/// Builds the stored run of the case on its model; `None` if the case names none.
///
/// # Errors
/// E044 for another dimension, E015 where the run is of another problem, of other bodies, or ends at another time.
pub(crate) fn build<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contents: &Contents<'_, S, N>,
    net: MakeControlNet<N>,
) -> Result<Option<Reference<S, N>>, Box<Diagnostic>>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let (Some(run), Some(file)) = (&context.case.model.stored, &context.case.model.reference) else { return Ok(None) };
    let refused = |code: &'static str, text: String| Box::new(context.error(code, format!("{}: {text}", file.value), file.at));
    is_same_problem(context.case, run).map_err(|(code, text)| refused(code, text))?;
    let mut patches = Vec::with_capacity(contents.bodies().len());
    for (k, words) in context.case.patches.iter().enumerate() {
        let name = &words.name.value;
        let stored = run.patches.iter().find(|p| p.name == *name).expect("the names were compared");
        let patch = patch(context, contents, (k, words), stored, net);
        patches.push(patch.map_err(|text| refused("E015", format!("patch \"{name}\" of the stored run {text}")))?);
    }
    let mut lambda = Vec::new();
    for of in contents.interfaces() {
        let components = if matches!(of.id(), InterfaceId::Tie(_)) { contents.components() } else { 1 };
        let name = of.name();
        let stored: Vec<&StoredSide> = run.sides.iter().filter(|s| s.name == name).collect();
        if stored.is_empty() {
            continue;
        }
        let of_name = |text: String| refused("E015", format!("`{name}` of the stored run {text}"));
        let sides = sides(contents, &patches, &stored, components).map_err(of_name)?;
        let parts: Result<Vec<_>, String> = of.sides().iter().map(|slave| on_sides(slave.side(), &sides, contents.is_revolved())).collect();
        lambda.push(ReferenceLambda { name: name.to_owned(), parts: parts.map_err(of_name)? });
    }
    Ok(Some(Reference { patches, lambda }))
}

/// Checks equation, dimension, time and names of patches against the stored run.
fn is_same_problem(case: &case::Case, run: &StoredRun) -> Result<(), (&'static str, String)> {
    let dimension = case.model.dimension.value;
    if run.dimension != dimension {
        return Err(("E044", format!("the stored run has dimension {}, this case {dimension}", run.dimension)));
    }
    let physics = physics_word(case);
    if run.physics != physics || run.components != case.components() {
        return Err(("E015", format!("the stored run is one of {}, this case of {physics}", run.physics)));
    }
    let assumption = assumption_word(case);
    if !run.assumption.is_empty() && run.assumption != assumption {
        return Err(("E015", format!("the stored run is one of {}, this case of {assumption}", run.assumption.escape_default())));
    }
    let end = case.steps.value.last().copied().unwrap_or(1.0);
    if (run.t - end).abs() > SAME_TIME * end.abs().max(run.t.abs()) {
        return Err(("E015", format!("the stored run ends at t = {}, this case at t = {end}", run.t)));
    }
    let mut names = [run.patches.iter().map(|p| p.name.as_str()).collect(), case.patches.iter().map(|p| p.name.value.as_str()).collect()];
    names.iter_mut().for_each(|list: &mut Vec<&str>| list.sort_unstable());
    if names[0] != names[1] {
        return Err(("E015", format!("the stored run has the patches {}; this case has {}", names[0].join(", "), names[1].join(", "))));
    }
    Ok(())
}

fn value_of<T: Copy>(words: &[(&str, T)], word: &str) -> Result<T, String> {
    let found = words.iter().find(|(w, _)| *w == word).map(|(_, v)| *v);
    found.ok_or_else(|| format!("has `{}`, which this version does not know", word.escape_default()))
}

fn patch<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contents: &Contents<'_, S, N>,
    (number, words): (usize, &case::Patch),
    stored: &StoredPatch,
    net: MakeControlNet<N>,
) -> Result<ReferencePatch<S, N>, String>
where
    Trace<S, N>: Dimension<S, N>,
{
    let own = specification(context, words, net).map_err(|fault| fault.message)?;
    let geometry = own.as_ref().map_or_else(|| of_cells::<N>(words), of_net);
    if !same_geometry(&geometry, &stored.geometry) {
        return Err("has another geometry; store the run again".into());
    }
    if Some(stored.coefficients.len()) != contents.components().checked_mul(stored.functions) {
        return Err(format!("has {} coefficients for {} functions", stored.coefficients.len(), stored.functions));
    }
    let (body, grids) = match own {
        Some(own) => {
            let mut spec = PatchSpec::new(own.net.clone());
            spec.degree = std::array::from_fn(|k| stored.degree.get(k).copied().unwrap_or(0));
            let lists: Result<[Vec<f64>; N], _> = stored.breakpoints.clone().try_into();
            spec.breakpoints = lists.map_err(|_| "has elements of another dimension".to_owned())?;
            spec.continuity = stored.continuity;
            spec.basis = value_of(&BASES, &stored.basis)?;
            spec.cells = value_of(&CELLS, &stored.cells)?;
            spec.mapping = value_of(&MAPPINGS, &stored.mapping)?;
            enough_for(spec.breakpoints.iter().map(|list| list.len() as f64 - 1.0).product(), stored)?;
            let make = context.names.backends.get(&stored.backend).map_err(|e| format!("has an {e}"))?;
            let body = make(&spec).map_err(|fault| format!("cannot be made: {fault}"))?;
            (body, Some([Parameters(own.breakpoints), Parameters(spec.breakpoints)]))
        }
        None => {
            let mut halved = words.clone();
            halved.refine.value = stored.refine;
            enough_for(mesh_counts::<N>(&halved).map_or(0.0, |n| n.iter().sum()), stored)?;
            halved.discretization.degree.value = stored.degree.clone();
            let exact = stored.mapping == "exact";
            halved.discretization.mapping.value = if exact { Mapping::Exact } else { Mapping::Isoparametric };
            (mesh_body(context, &halved).map_err(|fault| format!("cannot be made: {}", fault.message))?, None)
        }
    };
    let functions = body.space().num_functions();
    if functions != stored.functions {
        return Err(format!("has {} functions, its elements carry {functions}", stored.functions));
    }
    let current = contents.body(number);
    let (here, there) = (&**current.space(), &**body.space());
    let grids = grids.filter(|g| Parameters::agree((&g[0], here), (&g[1], there)));
    let parts: [usize; N] = std::array::from_fn(|k| match &grids {
        Some(g) => g[1].count(k).div_ceil(g[0].count(k)).clamp(1, MOST_PARTS),
        None => ((there.num_elements() as f64 / here.num_elements() as f64).powf(1.0 / N as f64).ceil() as usize).clamp(1, MOST_PARTS),
    });
    let degree = (0..there.num_elements()).flat_map(|e| there.degree(e)).max().unwrap_or(1);
    let rules = rules(here, degree, current.extra_points() + EXTRA_POINTS, parts);
    let way = match grids {
        Some(grids) => Way::Parameters(Box::new(grids)),
        None => Way::Closest(Box::new(ClosestPoint::new(Arc::clone(body.space())))),
    };
    let field = Field { first: 0, components: contents.components() };
    Ok(ReferencePatch { body, field, u: stored.coefficients.clone(), way, rules })
}

/// Largest number of elements per function: tetrahedra of degree 1 have six.
const MOST_ELEMENTS: f64 = 8.0;

/// Rejects more elements than the number of functions allows, before anything of that size is allocated.
fn enough_for(elements: f64, stored: &StoredPatch) -> Result<(), String> {
    if elements > MOST_ELEMENTS * stored.functions as f64 {
        return Err(format!("has {} functions for {elements} elements", stored.functions));
    }
    Ok(())
}

/// Gauss rules for a field on `space` and one of `degree`; tensor cells are divided into `parts` per direction.
fn rules<const N: usize>(space: &dyn Space<N, N>, degree: usize, extra: usize, parts: [usize; N]) -> PerElement<N> {
    let own = (0..space.num_elements()).flat_map(|e| space.degree(e)).max().unwrap_or(1);
    let plain = gauss_rules(space, extra + degree.saturating_sub(own));
    let points = degree.max(own) + 1 + extra;
    let cut: Arc<dyn Quadrature<N>> = Arc::new(TensorRule::new(parts.map(|n| in_parts(&gauss_legendre(points), n))));
    let mut rules = plain.rules().to_vec();
    rules.push(cut);
    let last = rules.len() - 1;
    let which = (0..space.num_elements()).map(|e| if space.cell(e) == Cell::Tensor { last } else { plain.which()[e] }).collect();
    PerElement::new(rules, which)
}

/// Composite rule on `n` equal parts of [0, 1].
fn in_parts(rule: &Rule<1>, n: usize) -> Rule<1> {
    let mut cut = Rule { points: Vec::new(), weights: Vec::new() };
    for k in 0..n {
        cut.points.extend(rule.points.iter().map(|x| (x.add_scalar(k as f64)) / n as f64));
        cut.weights.extend(rule.weights.iter().map(|w| w / n as f64));
    }
    cut
}

/// A slave side of the run.
struct Side<'a, const S: usize, const N: usize> {
    patch: usize,
    trace: Trace<S, N>,
    stored: &'a StoredSide,
    cell: Cell,
    values: Arc<Vec<f64>>,
}

fn sides<'a, const S: usize, const N: usize>(
    contents: &Contents<'_, S, N>,
    patches: &[ReferencePatch<S, N>],
    stored: &[&'a StoredSide],
    components: usize,
) -> Result<Vec<Side<'a, S, N>>, String>
where
    Trace<S, N>: Dimension<S, N>,
{
    let mut all = Vec::with_capacity(stored.len());
    for side in stored {
        if side.components != components {
            return Err(format!("has a multiplier of {} components instead of {components}", side.components));
        }
        let patch = contents.bodies().position(|p| p.name() == side.patch);
        let patch = patch.ok_or_else(|| format!("has its multiplier on `{}`, which is no patch", side.patch.escape_default()))?;
        let space = patches[patch].body.space();
        let count = side.elements(N);
        let number = |column: usize, k: usize| side.facets[column * count + k];
        let mut facets = Vec::with_capacity(count);
        for k in 0..count {
            let element = number(0, k);
            if element < 0.0 || element >= space.num_elements() as f64 {
                return Err(format!("has a facet on element {element}, and {} elements", space.num_elements()));
            }
            let origin = Vector::from_fn(|i, _| number(1 + i, k));
            facets.push(Embedding { element: element as usize, origin, axes: Matrix::from_fn(|i, s| number(1 + N + s * N + i, k)) });
        }
        let cell = if side.cells.is_empty() { Cell::Tensor } else { value_of(&CELLS, &side.cells)? };
        let trace = Trace::<S, N>::side_of_facets(space, facets, cell).map_err(|e| format!("is not on a side: {e}"))?;
        all.push(Side { patch, trace, stored: side, cell, values: Arc::new(side.values.clone()) });
    }
    Ok(all)
}

/// The common refinement of a slave side and those sides of the run that lie on it.
fn on_sides<const S: usize, const N: usize>(
    slave: &SideView<S, N>,
    sides: &[Side<'_, S, N>],
    is_revolved: bool,
) -> Result<Vec<OnSide<S>>, String>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let (mut found, mut covered) = (Vec::new(), 0.0);
    let whole = faying::space::measure::<S, N, f64, _>(&*slave.trace().space);
    let own = slave.runs().iter().map(|r| r.1);
    for side in sides.iter().filter(|side| own.clone().any(|patch| patch == side.patch)) {
        let points = slave.degree().max(side.stored.degree) + 1 + EXTRA_POINTS;
        let quadrature = Trace::<S, N>::merged(points, Partners::Near(Tolerance::Local));
        let segments = quadrature.segments(&*slave.trace().space, &*side.trace.space).map_err(|e| e.to_string())?;
        covered += segments.measure();
        let segments = if is_revolved { segments.revolved(&*slave.trace().space) } else { segments };
        let (components, degree, values) = (side.stored.components, side.stored.degree, Arc::clone(&side.values));
        found.push(OnSide { segments, components, degree, cell: side.cell, values });
    }
    if covered < (1.0 - UNCOVERED) * whole {
        let share = (100.0 * covered / whole).floor();
        let has: Vec<&str> = sides.iter().map(|s| s.stored.patch.as_str()).collect();
        let has = has.join(", ");
        return Err(format!("has its multiplier on {has} and covers {share} % of `{}`, the slave side here", slave.label()));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use faying::geometry::shapes::rectangle;
    use faying::space::Patch;

    #[test]
    fn a_place_that_is_no_number_has_no_value_in_a_stored_run() {
        let spec = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([2, 2]);
        let body: Box<dyn Body<1, 2>> = Box::new(Patch::try_new(&spec).unwrap());
        let (space, functions) = (Arc::clone(body.space()), body.space().num_functions());
        let stored = ReferencePatch {
            body,
            field: Field { first: 0, components: 1 },
            u: vec![3.0; functions],
            way: Way::Closest(Box::new(ClosestPoint::new(Arc::clone(&space)))),
            rules: gauss_rules(&*space, 0),
        };
        let at = |x: Vector<2>| stored.at::<1>(0, &Vector::zeros(), &x);
        assert!((at(Vector::<2>::new(0.7, 0.2)).0[0] - 3.0).abs() < 1e-14);
        for x in [[f64::NAN, 0.2], [0.7, f64::INFINITY]] {
            let (value, gradient) = at(x.into());
            assert!(value[0].is_nan() && gradient.iter().all(|g| g.is_nan()), "{x:?}: {value} {gradient}");
        }
    }
}
