//! Boundary conditions and loads of the case, said block by block.

use super::left_out;
use super::lower_context::LowerContext;
use super::parts::{self, Centres};
use super::places::{Places, Said};
use super::side_pairs::SidePairs;
use super::sides::refused;
use crate::case::{Boundary, Components, Datum, SideRef};
use crate::errors::Diagnostic;
use crate::formula::Formula;
use crate::place::{Located, SourceSpan};
use faying::problem::{self, Data, ErrorKind, Problem, ProblemError, Region, RegionId, SideView, Statement, Value};
use std::sync::Arc;

/// Says the conditions, loads and springs of all boundary blocks; errors go to the context's faults. Returns the sides of all blocks but
/// "all-outer".
pub(super) fn say<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &mut Places,
    couples: &SidePairs<S, N>,
) -> Vec<Arc<SideView<S, N>>> {
    // the sides of all blocks, and of those that name them
    let (mut given, mut by_name) = (Vec::new(), Vec::new());
    for number in 0..context.case.boundaries.len() {
        let block = &context.case.boundaries[number];
        let mut said = Block { context, problem, places, number, block, centres: Centres::default() };
        let (mut on, mut named, mut rims, mut faults) = (Vec::with_capacity(block.on.len()), Vec::new(), Vec::new(), Vec::new());
        for wanted in &block.on {
            // what is joined to another side is no outer side
            if let Some(free) = couples.joined_outer.get(&wanted.value).filter(|_| block.all_outer) {
                match said.free(wanted, free) {
                    Ok(None) => {}
                    Ok(Some(part)) => {
                        named.push(wanted);
                        on.push(part);
                    }
                    Err(fault) => faults.push(*fault),
                }
                continue;
            }
            let made = match said.below_sides(wanted) {
                Some(below) => said.on_below(wanted, &below).map(|rim| rims.push(rim)),
                None => said.side(wanted).map(|side| {
                    named.extend(side.map(|_| wanted));
                    on.extend(side);
                }),
            };
            faults.extend(made.err().map(|fault| *fault));
        }
        if let Some(filter) = block.filter.as_ref().filter(|_| !on.is_empty()) {
            let sides: Vec<_> = block.on.iter().filter(|side| meeting_sides(&side.value.side).is_none()).cloned().collect();
            let name = block.name.value.as_str();
            faults.extend(parts::cut(said.context, said.problem, said.places, (name, filter), &sides, &on));
        }
        let list = if block.all_outer { &mut given } else { &mut by_name };
        list.extend(on.iter().flat_map(|part| said.problem.sides_of(*part).unwrap_or_default()));
        faults.extend(said.twice(&on, &named));
        faults.extend(on.iter().filter_map(|side| said.on_side(*side).err()).map(|fault| *fault));
        let all = [&on[..], &rims].concat();
        faults.extend(said.on_all(&all).err().map(|fault| *fault));
        let centres = said.centres;
        context.faults.items.extend(faults);
        if let (true, false, true, Some(filter)) = (on.is_empty(), block.on.is_empty(), !context.faults.has_errors(), &block.filter) {
            let fault = parts::nothing(context, &format!("the sides of \"{}\"", block.name.value), filter, &centres);
            context.faults.push(fault);
        }
    }
    if !context.faults.has_errors() {
        left_out::tell_in_no_block(context, problem, places, couples.sides().chain(&given).chain(&by_name));
    }
    by_name
}

/// Sides that meet in an edge or a corner such as u0w1 or u0v0w0; `None` for other names.
fn meeting_sides(name: &str) -> Option<Vec<&str>> {
    let word = |k: usize| name.get(2 * k..2 * k + 2).filter(|w| ["u0", "u1", "v0", "v1", "w0", "w1"].contains(w));
    let all: Option<Vec<&str>> = (0..name.len() / 2).map(word).collect();
    all.filter(|list| list.len() > 1 && 2 * list.len() == name.len())
}

/// A place of supports and forces that is no side.
enum Below<'a> {
    /// The edge or corner in which sides meet.
    Meeting(Vec<&'a str>),
    /// Named points, edges or faces of a mesh, by their dimension.
    Named(usize),
}

impl Below<'_> {
    /// "a corner", "a line inside of its body".
    fn words<const N: usize>(&self) -> &'static str {
        match self {
            Self::Meeting(sides) if sides.len() == N => "a corner",
            Self::Meeting(_) => "an edge",
            Self::Named(0) => "a set of points",
            Self::Named(1) if N == 3 => "a set of edges",
            Self::Named(1) => "a line inside of its body",
            Self::Named(_) => "a surface inside of its body",
        }
    }
}

/// A block that is being said.
struct Block<'a, 'b, const S: usize, const N: usize> {
    context: &'a LowerContext<'b, S, N>,
    problem: &'a mut Problem<S, N>,
    places: &'a mut Places,
    number: usize,
    block: &'b Boundary,
    /// Centres of the facets that `where` was asked for.
    centres: Centres<N>,
}

impl<'b, const S: usize, const N: usize> Block<'_, 'b, S, N> {
    fn error(&self, code: &'static str, text: String, at: SourceSpan) -> Diagnostic {
        self.context.error(code, text, at)
    }

    /// The side of a reference, or the part of it that `where` keeps, if any.
    fn side(&mut self, wanted: &Located<SideRef>) -> Result<Option<RegionId>, Box<Diagnostic>> {
        let patch = &self.context.case.patches[wanted.value.patch];
        if let (Some(pressure), Some(closed)) = (&self.block.pressure, &patch.closed)
            && wanted.value.side.starts_with(closed.value.as_str())
        {
            let (name, side) = (&patch.name.value, &wanted.value.side);
            let text = format!("`{name}.{side}` is inside of its body, which is closed along {}: no pressure acts there", closed.value);
            return Err(Box::new(
                self.error("E015", text, pressure.at).with_help("name a side, or give a traction or `force`, which act on it"),
            ));
        }
        if let Some(filter) = &self.block.filter {
            return parts::part(self.context, self.problem, self.places, wanted, filter, &mut self.centres);
        }
        let side = self.places.bodies[wanted.value.patch].side(&wanted.value.side);
        let made = self.problem.region(side);
        made.map(Some).map_err(|error| Box::new(refused(self.context, self.problem, &error, wanted)))
    }

    /// The parts of a side of "all-outer" that nothing joins, if any.
    fn free(&mut self, wanted: &Located<SideRef>, parts: &[Arc<SideView<S, N>>]) -> Result<Option<RegionId>, Box<Diagnostic>> {
        if parts.is_empty() {
            return Ok(None);
        }
        if let Some(filter) = &self.block.filter {
            let label = format!("{}.{}", self.context.case.patches[wanted.value.patch].name.value, wanted.value.side);
            let text = format!("`where` on \"all-outer\" with `{label}`, of which a part is joined, is not in this version");
            return Err(Box::new(self.error("E019", text, filter.at).with_help("name the sides that are meant")));
        }
        Ok(Some(self.problem.region_of_sides(parts.to_vec())))
    }

    /// Sides of the block, `named` so, that have facets in common, on which its loads and springs would act twice.
    fn twice(&self, on: &[RegionId], named: &[&Located<SideRef>]) -> Option<Diagnostic> {
        let block = self.block;
        let lists = [&block.spring, &block.force, &block.rigid_force];
        let acts =
            block.pressure.is_some() || block.traction.iter().any(Option::is_some) || lists.iter().any(|list| each(list).next().is_some());
        let [first, second] = if acts { self.problem.overlap(on)? } else { return None };
        let label = |k: usize| format!("{}.{}", self.context.case.patches[named[k].value.patch].name.value, named[k].value.side);
        let text =
            format!("`{}` has facets of `{}`, named in `on` before: loads and springs would act twice there", label(second), label(first));
        Some(self.error("E016", text, named[second].at).with_help("name every facet once, or give each of them a block if both are meant"))
    }

    /// The edge, the corner or the named part of a mesh of a reference; `None` of a side.
    fn below_sides<'w>(&self, wanted: &'w Located<SideRef>) -> Option<Below<'w>> {
        let name = &wanted.value.side;
        let view = self.problem.bodies().nth(wanted.value.patch)?;
        // a tag of a mesh may look like an edge or a corner
        if view.body().sides().contains(name) {
            return None;
        }
        let named = view.body().submesh(name).map(|submesh| Below::Named(submesh.dimension));
        named.or_else(|| meeting_sides(name).map(Below::Meeting))
    }

    /// Says the conditions of what is no side, and returns it.
    fn on_below(&mut self, wanted: &Located<SideRef>, below: &Below<'_>) -> Result<RegionId, Box<Diagnostic>> {
        let (block, patch, what) = (self.block, wanted.value.patch, below.words::<N>());
        let label = format!("{}.{}", self.context.case.patches[patch].name.value, wanted.value.side);
        let loads = block.traction.iter().any(Option::is_some)
            || block.pressure.is_some()
            || [&block.spring, &block.rigid_force].into_iter().any(|list| list.iter().any(Option::is_some));
        if loads {
            let text = format!("`{label}` is {what}; it takes fix, dirichlet and force, other loads and springs act on sides");
            return Err(Box::new(self.error("E015", text, wanted.at).with_help("name a side, or give `force`, the resultant")));
        }
        if let Some(at) = block.fix_normal.as_ref().or(block.fix_tangential.as_ref()).map(|f| f.at) {
            let text = format!("`{label}` is {what} and has no normal");
            return Err(Box::new(self.error("E015", text, at).with_help("fix components x, y, z")));
        }
        if let Some(filter) = &block.filter {
            return Err(Box::new(self.error("E015", format!("`where` chooses facets of sides; `{label}` is {what}"), filter.at)));
        }
        let body = self.places.bodies[patch];
        let made = match below {
            Below::Meeting(names) => self.problem.meeting(&names.iter().map(|name| body.side(name)).collect::<Vec<_>>()),
            Below::Named(_) => self.problem.region(body.side(&wanted.value.side)),
        };
        let region = made.map_err(|error| match &error.kind {
            ErrorKind::Side(_) => Box::new(refused(self.context, self.problem, &error, wanted)),
            _ => {
                let text = format!("`{label}` is not {what}: {} share no function there", error.names().join(" and "));
                Box::new(self.error("E021", text, wanted.at))
            }
        })?;
        self.dirichlet(region)?;
        Ok(region)
    }

    /// Keeps the place of a statement, with its formula if it has one.
    fn keep(
        &mut self,
        made: Result<Statement, ProblemError>,
        at: SourceSpan,
        what: &'static str,
        formula: Option<&Formula>,
    ) -> Result<Statement, Box<Diagnostic>> {
        let statement = made.map_err(|error| Box::new(self.error("E015", error.to_string(), at)))?;
        let formulas = formula.into_iter().map(|f| Located::new(f.clone(), at)).collect();
        self.places.keep(statement, Said { at, block: Some(self.number), what, formulas, ..Said::default() });
        Ok(statement)
    }

    /// Keeps a load or springs, which have the name of the block.
    fn named(&mut self, made: Result<Statement, ProblemError>, f: &Located<Formula>, what: &'static str) -> Result<(), Box<Diagnostic>> {
        let statement = self.keep(made, f.at, what, Some(&f.value))?;
        self.problem.name(statement, &self.block.name.value);
        Ok(())
    }

    /// The formula of the exact solution in the first patch of the block.
    fn exact(&self, component: usize) -> Option<&'b Formula> {
        let case = self.context.case;
        let own = self.block.on.first().and_then(|side| case.patches.get(side.value.patch)?.exact.as_ref());
        own.or(case.model.exact.as_ref())?.get(component).map(|f| &f.value)
    }

    fn dirichlet(&mut self, region: RegionId) -> Result<(), Box<Diagnostic>> {
        for (component, datum) in each(&self.block.dirichlet) {
            let (value, formula) = match &datum.value {
                Datum::Exact => (Value::Exact, self.exact(component)),
                Datum::Formula(f) => (Value::from(Data::from(f.clone())), Some(f)),
            };
            let made = self.problem.prescribe(region, component, value);
            self.keep(made, datum.at, "the value", formula)?;
        }
        Ok(())
    }

    /// Says everything that the block says of each of its sides.
    fn on_side(&mut self, side: RegionId) -> Result<(), Box<Diagnostic>> {
        let block = self.block;
        self.dirichlet(side)?;
        let sliding = match (&block.fix_normal, &block.fix_tangential) {
            (Some(_), Some(both)) => Some((self.problem.fix(side, problem::Components::All), both.at)),
            (Some(normal), None) => Some((self.problem.fix_normal(side), normal.at)),
            (None, Some(tangential)) => Some((self.problem.fix_tangential(side), tangential.at)),
            (None, None) => None,
        };
        if let Some((made, at)) = sliding {
            self.keep(made, at, "the value", None)?;
        }
        for (component, datum) in each(&block.traction) {
            let (value, formula) = match &datum.value {
                Datum::Exact => (Value::Exact, None),
                Datum::Formula(f) => (Value::Data(f.clone().into()), Some(f)),
            };
            let made = self.problem.traction(side, component, value);
            let statement = self.keep(made, datum.at, "the traction", formula)?;
            self.problem.name(statement, &block.name.value);
        }
        if let Some(p) = &block.pressure {
            let made = self.problem.pressure(side, p.value.clone());
            self.named(made, p, "the pressure")?;
        }
        for (component, f) in each(&block.spring) {
            let made = self.problem.spring(side, component, f.value.clone());
            self.named(made, f, "the spring")?;
        }
        Ok(())
    }

    /// Says the resultants, spread evenly over all sides, edges or corners of the block, and that sides move as one.
    fn on_all(&mut self, regions: &[RegionId]) -> Result<(), Box<Diagnostic>> {
        let block = self.block;
        if regions.is_empty() || each(&block.force).chain(each(&block.rigid_force)).next().is_none() {
            return Ok(());
        }
        let all = self.problem.union(regions.iter().map(|region| Region::from(*region)));
        let all = all.map_err(|error| Box::new(self.error("E015", error.to_string(), block.head.at)))?;
        for (component, f) in each(&block.force) {
            let made = self.problem.force(all, component, f.value.clone());
            self.named(made, f, "the force")?;
        }
        for (component, f) in each(&block.rigid_force) {
            let made = self.problem.rigid(all, component, f.value.clone());
            self.named(made, f, "the rigid force")?;
        }
        Ok(())
    }
}

fn each<T>(list: &Components<T>) -> impl Iterator<Item = (usize, &Located<T>)> {
    list.iter().enumerate().filter_map(|(k, f)| f.as_ref().map(|f| (k, f)))
}
