//! Fields of a solution for the files.

use super::Solved;
use crate::case::{Case, Deformed, PointNumber, ShownField};
use crate::marks::RigidPicture;
use crate::output::{DisplacementFactor, ExactAlong, FieldRange, Output, Panel, Parts, Picture, RunOptions, SideOutput, SidePart};
use crate::plot::in_unit;
use crate::quantities::FieldAbout;
use crate::table::InterfaceRow;
use faying::linalg::Vector;
use faying::physics::von_mises;
use faying::problem::{BodyId, Extreme, InterfaceId, InterfaceView, PointState, SideField, SidePoint, SlaveSide};
use faying::space::Space;
use faying_files::vtu::{CellStyle, Part};
use std::sync::Arc;

/// Collects the output of a plane case for its files.
pub fn plane_output(case: &Case, solved: &Arc<Solved<1, 2>>, options: &RunOptions) -> Output {
    let contents = solved.solution.contents();
    let side = |of: &InterfaceView<'_, 1, 2>, number: usize| {
        let field = Arc::new(solved.solution.along(of.id(), number).ok().flatten()?);
        let known = field.exact(0, &[Vector::<1>::new(0.5)]).is_some();
        let (part, output) = side_output(solved, of, number, &field, options);
        let exact = known.then(|| -> ExactAlong { Box::new(move |element, xi| field.exact(element, xi).unwrap_or_default()) });
        Some(SideOutput { exact, ..output(SidePart::Curve(part)) })
    };
    let sides = contents.interfaces().flat_map(|of| (0..of.sides().len()).filter_map(|k| side(&of, k)).collect::<Vec<_>>()).collect();
    assembled(case, solved, Parts::Plane(bodies(case, solved, options)), super::obstacles::in_plane(solved), sides)
}

/// Collects the output of a case in space for its files.
pub fn volume_output(case: &Case, solved: &Arc<Solved<2, 3>>, options: &RunOptions) -> Output {
    let contents = solved.solution.contents();
    let side = |of: &InterfaceView<'_, 2, 3>, number: usize| {
        let field = Arc::new(solved.solution.along(of.id(), number).ok().flatten()?);
        let (part, output) = side_output(solved, of, number, &field, options);
        Some(output(SidePart::Surface(part)))
    };
    let sides = contents.interfaces().flat_map(|of| (0..of.sides().len()).filter_map(|k| side(&of, k)).collect::<Vec<_>>()).collect();
    assembled(case, solved, Parts::Volume(bodies(case, solved, options)), super::obstacles::in_space(solved), sides)
}

fn assembled<const S: usize, const N: usize>(
    case: &Case,
    solved: &Arc<Solved<S, N>>,
    parts: Parts,
    obstacles: Vec<RigidPicture>,
    sides: Vec<SideOutput>,
) -> Output {
    let title = if case.title.value.is_empty() { case.source.name.clone() } else { case.title.value.clone() };
    let scalar = solved.solution.contents().components() == 1;
    let usual = match scalar {
        true => ShownField::Bodies { word: "u".into(), number: PointNumber::Unknown(0) },
        false => ShownField::Bodies { word: "von_mises".into(), number: PointNumber::VonMises },
    };
    let shown = if case.fields.is_empty() { std::slice::from_ref(&usual) } else { &case.fields[..] };
    let panels = shown.iter().map(|field| panel(case, solved, field)).collect();
    let solution = &solved.solution;
    let displaced = |body, element, xi: &Vector<N>| {
        let state = solution.in_element(body, element, &[(*xi).into()]).ok().and_then(|states| states.first().copied());
        state.map_or_else(Vector::zeros, |state| Vector::from_fn(|c, _| state.u[c]))
    };
    let marks = super::marks::of(case, &solution.contents(), solution.t(), &displaced);
    let deformed = {
        let (solved, wanted, contact) = (Arc::clone(solved), case.deformed, !case.contacts.is_empty());
        DisplacementFactor(Box::new(move || factor(&solved, wanted, contact)))
    };
    Output { title, units: case.units.clone(), parts, panels, elastic: !scalar, deformed, marks, obstacles, sides }
}

/// A panel of the picture of the fields.
fn panel<const S: usize, const N: usize>(case: &Case, solved: &Arc<Solved<S, N>>, shown: &ShownField) -> Panel {
    let (word, number) = match shown {
        ShownField::Bodies { word, number } => (word, *number),
        ShownField::Sides(name) => return Panel::Sides(name.clone()),
    };
    let (field, component, words, unit) = match number {
        PointNumber::VonMises => ("von_mises", Some(0), "von Mises stress", case.units.stress()),
        PointNumber::Displacement => ("displacement", None, "length of the displacement", case.units.length.clone()),
        PointNumber::Unknown(k) if case.model.components() == 1 => ("u", Some(k), word.as_str(), String::new()),
        PointNumber::Unknown(k) => ("displacement", Some(k), word.as_str(), case.units.length.clone()),
        PointNumber::Stress(k) => ("stress", Some(k), word.as_str(), case.units.stress()),
        PointNumber::Derived(name, _) => (word.as_str(), Some(0), word.as_str(), name.unit(&case.units)),
    };
    let solved = Arc::clone(solved);
    let range = FieldRange(Box::new(move || range(&solved, number)));
    Panel::Bodies(Picture { field: field.into(), component, label: words.to_owned() + &in_unit(&unit), range })
}

/// The number at a point.
fn value<const N: usize>(number: PointNumber, s: &PointState<N>) -> f64 {
    match number {
        PointNumber::VonMises => von_mises(&s.stress),
        PointNumber::Displacement => s.u.iter().map(|u| u * u).sum::<f64>().sqrt(),
        PointNumber::Unknown(k) => s.u[k],
        PointNumber::Stress(k) => s.stress[k],
        PointNumber::Derived(name, [x, y]) => {
            // directions about a centre are those of x and y in the centre itself
            let x = if s.x[0] == x && s.x[1] == y { x - 1.0 } else { x };
            let centre = Vector::<N>::from_fn(|k, _| [x, y, 0.0][k]);
            FieldAbout { name, about: centre }.value(s)
        }
    }
}

/// Fields that the picture shows and no file has by itself, by their words.
fn derived(case: &Case) -> Vec<(String, PointNumber)> {
    let of = |field: &ShownField| match field {
        ShownField::Bodies { word, number: number @ PointNumber::Derived(..) } => Some((word.clone(), *number)),
        _ => None,
    };
    let mut all: Vec<(String, PointNumber)> = Vec::new();
    for (word, number) in case.fields.iter().filter_map(of) {
        if all.iter().all(|(known, _)| *known != word) {
            all.push((word, number));
        }
    }
    all
}

/// Least and largest value of a number over the closed elements of all bodies.
fn range<const S: usize, const N: usize>(solved: &Solved<S, N>, number: PointNumber) -> Option<[f64; 2]> {
    let (solution, contents) = (&solved.solution, solved.solution.contents());
    let derived = match number {
        PointNumber::Displacement | PointNumber::Unknown(_) => false,
        PointNumber::Derived(name, _) => name.is_derived(),
        PointNumber::VonMises | PointNumber::Stress(_) => true,
    };
    let value = |s: &PointState<N>| value(number, s);
    let mut parts = contents.bodies().map(|body| solution.extremes(body.id(), derived, &value).ok().flatten());
    let join = |[a, b]: [f64; 2], [low, high]: [Extreme<N>; 2]| [a.min(low.value), b.max(high.value)];
    parts.try_fold([f64::INFINITY, f64::NEG_INFINITY], |found, part| Some(join(found, part?)))
}

/// Share of the size of all bodies that the largest displacement of a picture has.
const SHOWN: f64 = 0.05;

/// The factor of the displacements in the picture: 1, 2 or 5 times a power of ten that makes the largest at most [`SHOWN`] of the size,
/// never below 1; with contact, whose gaps do not grow, 1.
fn factor<const S: usize, const N: usize>(solved: &Solved<S, N>, wanted: Deformed, contact: bool) -> f64 {
    let contents = solved.solution.contents();
    if contents.components() == 1 {
        return 0.0;
    }
    if let Deformed::Factor(factor) = wanted {
        return factor;
    }
    let size = |s: &PointState<N>| s.u.iter().map(|u| u * u).sum::<f64>().sqrt();
    let of_body = |id| solved.solution.extremes(id, false, &size).ok().flatten().map_or(f64::NAN, |[_, high]| high.value);
    let largest = contents.bodies().map(|body| of_body(body.id())).fold(0.0, f64::max);
    let room = SHOWN * contents.size().diagonal / largest;
    if !(largest > 0.0 && room.is_finite()) {
        return 0.0;
    }
    if contact || room < 1.0 {
        return 1.0;
    }
    let power = 10f64.powf(room.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|m| *m <= room).unwrap_or(power)
}

fn bodies<const S: usize, const N: usize>(case: &Case, solved: &Arc<Solved<S, N>>, options: &RunOptions) -> Vec<Part<'static, N, N>> {
    let more = derived(case);
    solved.solution.contents().bodies().map(|of| body(solved, (of.id(), of.name(), of.space()), &more, options)).collect()
}

fn body<const S: usize, const N: usize>(
    solved: &Arc<Solved<S, N>>,
    (body, name, space): (BodyId, &str, &Arc<dyn Space<N, N>>),
    more: &[(String, PointNumber)],
    options: &RunOptions,
) -> Part<'static, N, N> {
    let at = || {
        let solved = Arc::clone(solved);
        move |element: usize, xi: &[Vector<N>]| {
            let xi: Vec<[f64; N]> = xi.iter().map(|xi| (*xi).into()).collect();
            solved.solution.in_element(body, element, &xi).expect("an element of the body")
        }
    };
    let (values, stresses, equivalent, all) = (at(), at(), at(), at());
    let mut part = Part::new(name.to_owned(), Arc::clone(space), options.cells.unwrap_or(CellStyle::Lagrange));
    part.averaged = part.style == CellStyle::Quadratic;
    if solved.solution.contents().components() == 1 {
        return part.with_exact("u", 1, move |e, xi| values(e, xi).iter().map(|p| p.u[0]).collect());
    }
    part = part
        .with_exact("displacement", N, move |e, xi| values(e, xi).iter().flat_map(|p| p.u.into_iter().take(N)).collect())
        .with("stress", 6, move |e, xi| stresses(e, xi).iter().flat_map(|p| p.stress).collect())
        .with("von_mises", 1, move |e, xi| equivalent(e, xi).iter().map(|p| von_mises(&p.stress)).collect());
    for (word, number) in more {
        let (states, number) = (at(), *number);
        part = part.with(word, 1, move |e, xi| states(e, xi).iter().map(|p| value(number, p)).collect());
    }
    let more: Vec<PointNumber> = more.iter().map(|(_, number)| *number).collect();
    part.with_together(move |e, xi| {
        let own = |p: &PointState<N>| more.iter().map(|number| value(*number, p)).collect::<Vec<_>>();
        let numbers = |p: PointState<N>| p.u.into_iter().take(N).chain(p.stress).chain([von_mises(&p.stress)]).chain(own(&p));
        all(e, xi).into_iter().flat_map(numbers).collect()
    })
}

/// Style of cells of a side: linear or quadratic if the bodies have such cells, else Lagrange cells.
fn side_cells(options: &RunOptions) -> CellStyle {
    match options.cells {
        Some(cells @ (CellStyle::Linear | CellStyle::Quadratic)) => cells,
        _ => CellStyle::Lagrange,
    }
}

/// The place of a slave side among those that are shown, pieces of one side together, and that of the piece in the side; `None` for a side without
/// pieces.
fn place<const S: usize, const N: usize>(sides: &[SlaveSide<'_, S, N>], number: usize) -> (usize, Option<usize>) {
    let mut groups = sides.chunk_by(|a, b| a.number() == b.number()).enumerate().scan(0, |first, (place, group)| {
        let range = *first..*first + group.len();
        *first = range.end;
        Some((place, range))
    });
    let (place, range) = groups.find(|(_, range)| range.contains(&number)).expect("a side of the interface");
    (place, (range.len() > 1).then(|| number - range.start))
}

/// The fields of a slave side, and what makes its output of them.
fn side_output<const S: usize, const N: usize>(
    solved: &Arc<Solved<S, N>>,
    of: &InterfaceView<'_, S, N>,
    number: usize,
    field: &Arc<SideField<S, N>>,
    options: &RunOptions,
) -> (Part<'static, S, N>, impl FnOnce(SidePart) -> SideOutput + use<S, N>) {
    let (sides, contact) = (of.sides(), matches!(of.id(), InterfaceId::Contact(_)));
    let (place, piece) = place(&sides, number);
    let alone = sides.iter().all(|side| side.number() == sides[0].number());
    let name = if alone { of.name().to_owned() } else { format!("{}.{place}", of.name()) };
    let show = |ask: fn(&SideField<S, N>, usize, &[Vector<S>]) -> Vec<f64>| {
        let field = Arc::clone(field);
        move |element: usize, xi: &[Vector<S>]| ask(&field, element, xi)
    };
    let components = solved.solution.contents().components();
    let part_name = piece.map_or_else(|| name.clone(), |piece| format!("{name}.{piece}"));
    let mut part = Part::new(part_name, Arc::clone(&sides[number].side().trace().space), side_cells(options));
    part.least_degree = field.degree();
    part = part
        .with("lambda", if contact { 1 } else { components }, show(SideField::lambda))
        .with("gap", 1, show(SideField::gap))
        .with("active", 1, show(SideField::active))
        .with("traction", components, show(SideField::traction))
        .with("normal", N, show(SideField::normal));
    if contact {
        // no negative zeros
        part = part.with("pressure", 1, show(|field, element, xi| field.lambda(element, xi).into_iter().map(|l| 0.0 - l).collect()));
    }
    let place = |x: &Vector<N>| std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
    let row = |p: &SidePoint<N>| InterfaceRow { s: p.s, x: place(&p.x), lambda: p.lambda.clone(), gap: p.gap, active: p.active };
    let rows = field.points().iter().map(row).collect();
    let (of, label) = (of.name().to_owned(), sides[number].side().label().to_owned());
    (part, move |part| SideOutput { name, of, label, contact, part, rows, exact: None })
}
