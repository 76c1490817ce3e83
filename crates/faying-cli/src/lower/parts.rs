//! Parts of sides: the facets that `where` keeps.

use super::lower_context::LowerContext;
use super::places::Places;
use super::sides::refused;
use crate::case::SideRef;
use crate::errors::Diagnostic;
use crate::formula::{Formula, Point};
use crate::place::Located;
use crate::text_format::{place, short};
use faying::linalg::Vector;
use faying::problem::{ErrorKind, Problem, RegionId};
use std::cell::Cell;

/// Share by which the facets that `where` keeps may differ from the part in which it holds.
const CUT: f64 = 1e-3;

/// Least and largest coordinates of the centres of facets, "x from 0.05 to 0.95, y 1".
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Centres<const N: usize>(Option<[Vector<N>; 2]>);

impl<const N: usize> Centres<N> {
    fn see(&mut self, x: &Vector<N>) {
        let [low, high] = self.0.unwrap_or([*x; 2]);
        self.0 = Some([low.inf(x), high.sup(x)]);
    }
}

impl<const N: usize> std::fmt::Display for Centres<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Some([low, high]) = self.0 else { return Ok(()) };
        let one = |k: usize| match (short(low[k]), short(high[k])) {
            (a, b) if a == b => format!("{} {a}", ["x", "y", "z"][k]),
            (a, b) => format!("{} from {a} to {b}", ["x", "y", "z"][k]),
        };
        write!(f, "; the centres lie in {}", (0..N).map(one).collect::<Vec<_>>().join(", "))
    }
}

/// The facets of a side whose centres satisfy `filter`, if any; their centres are added to `centres`.
pub(super) fn part<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    wanted: &Located<SideRef>,
    filter: &Located<Formula>,
    centres: &mut Centres<N>,
) -> Result<Option<RegionId>, Box<Diagnostic>> {
    let side = places.bodies[wanted.value.patch].side(&wanted.value.side);
    let (undefined, seen) = (Cell::new(None), Cell::new(*centres));
    let made = problem.part(side, &filter.value.text(), &|x| {
        let value = filter.value.value(&Point::new(x.as_slice()));
        let mut all = seen.get();
        all.see(x);
        seen.set(all);
        if value.is_nan() {
            undefined.set(Some(*x));
        }
        value != 0.0
    });
    *centres = seen.get();
    if let Some(x) = undefined.get() {
        let text = format!("`where`: `{}` has no value at the centre of a facet ({})", filter.value.text(), place(x.as_slice()));
        return Err(Box::new(context.error("E017", text, filter.at).with_help("give a formula that has a value everywhere")));
    }
    made.map_err(|error| {
        Box::new(match &error.kind {
            ErrorKind::MixedCells => {
                let text = format!("`where` on `{}`, a side of triangles and quadrilaterals, is not in this version", error.names()[0]);
                context.error("E019", text, filter.at).with_help("give the part a tag of its own in the mesh")
            }
            _ => refused(context, problem, &error, wanted),
        })
    })
}

/// The error of a `where` that keeps no facet of the block or the side `name`.
pub(super) fn nothing<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    name: &str,
    filter: &Located<Formula>,
    centres: &Centres<N>,
) -> Diagnostic {
    let text = format!("no facet of {name} has its centre where `{}` holds{centres}", filter.value.text());
    context.error("E015", text, filter.at).with_help("`where` keeps whole facets; a finer mesh has smaller ones")
}

/// The parts of the slave sides of the block `name`, each of which keeps a facet.
pub(super) fn of_slaves<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    slaves: &[Located<SideRef>],
    (name, filter): (&str, &Located<Formula>),
) -> Result<Vec<RegionId>, Vec<Diagnostic>> {
    let (mut kept, mut faults) = (Vec::with_capacity(slaves.len()), Vec::new());
    for wanted in slaves {
        let mut centres = Centres::default();
        match part(context, problem, places, wanted, filter, &mut centres) {
            Ok(Some(region)) => kept.push(region),
            Ok(None) => {
                let patch = &context.case.patches[wanted.value.patch].name.value;
                faults.push(nothing(context, &format!("`{patch}.{}`", wanted.value.side), filter, &centres));
            }
            Err(fault) => faults.push(*fault),
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let cut = cut(context, problem, places, (name, filter), slaves, &kept);
    context.faults.items.extend(cut);
    Ok(kept)
}

/// Warns of a `where` whose border lies inside of facets of the sides `on`, which are kept or left whole.
pub(super) fn cut<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    (name, filter): (&str, &Located<Formula>),
    on: &[Located<SideRef>],
    kept: &[RegionId],
) -> Option<Diagnostic> {
    let holds = |x: &Vector<N>| filter.value.value(&Point::new(x.as_slice())) != 0.0;
    let (mut taken, mut inside, mut exact) = (0.0, 0.0, 0.0);
    for region in kept {
        taken += problem.measure(*region).unwrap_or(0.0);
        inside += problem.measure_where(*region, &holds).unwrap_or(0.0);
    }
    for wanted in on {
        let side = places.bodies[wanted.value.patch].side(&wanted.value.side);
        exact += problem.measure_where(side, &holds).unwrap_or(0.0);
    }
    let (beside, least) = (taken - inside, CUT * exact.max(taken));
    (beside + exact - inside > least).then(|| {
        let what = if N == 2 { "a length" } else { "an area" };
        let elsewhere = if beside > least { format!(", {} of it where it does not", short(beside)) } else { String::new() };
        let text = format!(
            "`where` of \"{name}\" cuts facets, which it keeps or leaves whole: {what} of {} for the {} in which `{}` holds{elsewhere}",
            short(taken),
            short(exact),
            filter.value.text()
        );
        let help = "let the border of `where` lie on edges of elements: give breakpoints there, or refine the mesh";
        context.warning("E017", text, filter.at).with_help(help)
    })
}
