//! Answers of a solution to the quantities of the documents, by their texts.

use crate::setting::Setting;
use faying::geometry::{Embedded, Embedding, Geometry, closest_point};
use faying::linalg::{Matrix, Vector};
use faying::problem::{BodyId, InterfaceSide, PointState, Solution};
use faying::space::Trace;

/// Distance, as a share of an element, up to which a point belongs to it.
const NEAR: f64 = 1e-9;

/// A quantity, taken apart: its path, a place and a body.
struct Asked<'a> {
    path: Vec<&'a str>,
    place: Option<Vec<f64>>,
    body: Option<&'a str>,
}

impl<'a> Asked<'a> {
    fn of(text: &'a str) -> Self {
        let (text, body) = text.split_once(" in ").map_or((text, None), |(a, b)| (a, Some(b)));
        let (path, place) = text.split_once(" at ").map_or((text, None), |(a, b)| (a, Some(b)));
        let place = place.map(|p| p.trim_matches(['[', ']']).split(',').map(|n| n.trim().parse().unwrap()).collect());
        Self { path: path.split('.').collect(), place, body }
    }
}

fn axis(letter: &str) -> usize {
    ["x", "y", "z"].iter().position(|known| *known == letter).unwrap_or_else(|| panic!("no component {letter}"))
}

/// The name of a side of a box by its directions.
pub fn side<const N: usize>(name: &str) -> &str {
    let known = [("left", "u0"), ("right", "u1"), ("bottom", ["v0", "w0"][N - 2]), ("top", ["v1", "w1"][N - 2]), ("front", "v0")];
    known.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, own)| own)
}

impl<const S: usize, const N: usize> Setting<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// The solution at a place, the mean over all elements of the body that contain it.
    fn at(&self, solution: &Solution<S, N>, body: BodyId, x: &[f64; N]) -> Option<PointState<N>> {
        let found = solution.at(body, x).ok()?;
        let space = self.member(body).body.space();
        let mut all = Vec::new();
        for element in 0..space.num_elements() {
            let bounds = space.bounds(element);
            let near = NEAR * bounds.diagonal();
            if bounds.distance(&found.x) > near {
                continue;
            }
            let whole = Embedding { element, origin: Vector::zeros(), axes: Matrix::<N, N>::identity() };
            let alone = Embedded::new(space.clone(), vec![whole], space.cell(element));
            if let Some(p) = closest_point(&alone, &found.x).filter(|p| p.distance <= near) {
                all.extend(solution.in_element(body, element, &[p.xi.into()]).unwrap());
            }
        }
        let share = 1.0 / all.len() as f64;
        let sum = |of: &dyn Fn(&PointState<N>) -> f64| all.iter().map(of).sum::<f64>() * share;
        if all.is_empty() {
            return Some(found);
        }
        let (u, stress) = (std::array::from_fn(|c| sum(&|p| p.u[c])), std::array::from_fn(|c| sum(&|p| p.stress[c])));
        Some(PointState { x: found.x, u, stress, strain: std::array::from_fn(|c| sum(&|p| p.strain[c])) })
    }

    /// The value of a quantity that bodies have; `None` for those of ties and contacts.
    fn of_bodies(&self, solution: &Solution<S, N>, text: &str) -> Option<f64> {
        let asked = Asked::of(text);
        match &asked.path[..] {
            ["energy"] => return Some(solution.energy()),
            ["reaction", body, name, rest @ ..] => {
                let force = solution.reaction(self.named(body).id.side(side::<N>(name))).unwrap();
                return Some(force[rest.first().map_or(0, |c| axis(c))]);
            }
            _ => {}
        }
        let component = |p: &PointState<N>| match &asked.path[..] {
            ["u"] => p.u[0],
            ["u", c] => p.u[axis(c)],
            ["flux", c] => p.stress[axis(c)],
            ["stress", both] => p.stress[["xx", "yy", "zz", "xy", "yz", "xz"].iter().position(|known| known == both).unwrap()],
            _ => panic!("{text}"),
        };
        if ["interface", "contact"].contains(&asked.path[0]) {
            return None;
        }
        let x: [f64; N] = asked.place.as_ref().unwrap_or_else(|| panic!("{text}: no place"))[..].try_into().unwrap();
        let bodies = self.bodies.iter().filter(|b| asked.body.is_none_or(|name| b.name == name));
        let mut found = bodies.filter_map(|b| self.at(solution, b.id, &x));
        Some(component(&found.next().unwrap_or_else(|| panic!("{text}: in no body"))))
    }
}

/// Settings that answer quantities by their texts.
pub trait Answers<const S: usize, const N: usize> {
    /// The values of quantities in a solution.
    fn values(&self, solution: &Solution<S, N>, quantities: &[String]) -> Vec<f64>;
}

impl Answers<1, 2> for Setting<1, 2> {
    fn values(&self, solution: &Solution<1, 2>, quantities: &[String]) -> Vec<f64> {
        let of_interface = |text: &String| {
            let asked = Asked::of(text);
            let place = || -> [f64; 2] { asked.place.clone().unwrap()[..].try_into().unwrap() };
            let found = |name: &str| self.contacts.iter().find(|c| c.name == name).unwrap_or_else(|| panic!("{text}"));
            let result = |name: &str| solution.contact(found(name).id).unwrap();
            match &asked.path[..] {
                ["interface", name, "lambda", rest @ ..] => {
                    let tie = self.ties.iter().find(|t| t.name == *name).unwrap_or_else(|| panic!("{text}"));
                    self.lambda(solution, tie.id, &tie.slave, &place())[rest.first().map_or(0, |c| axis(c))]
                }
                ["contact", name, "force", c] => result(name).force[axis(c)],
                ["contact", name, "moment"] => result(name).moment[2],
                ["contact", name, "area"] => result(name).area,
                ["contact", name, "active"] => result(name).active as f64,
                ["contact", name, "pressure", "max"] => result(name).largest_pressure,
                ["contact", name, "pressure"] => -self.lambda(solution, found(name).id, &found(name).slave, &place())[0],
                // not a number where the pressure does not tell the end of the zone, as on coarse sides
                ["contact", name, "half_width"] => result(name).half_width.unwrap().unwrap_or(f64::NAN),
                _ => panic!("{text}"),
            }
        };
        quantities.iter().map(|text| self.of_bodies(solution, text).unwrap_or_else(|| of_interface(text))).collect()
    }
}

impl Answers<2, 3> for Setting<2, 3> {
    fn values(&self, solution: &Solution<2, 3>, quantities: &[String]) -> Vec<f64> {
        quantities.iter().map(|text| self.of_bodies(solution, text).unwrap_or_else(|| panic!("{text}"))).collect()
    }
}
