//! Whether facets may hold partners of each other: by their boxes and normals, and where these turn much by those of their parts.
//!
//! The box of a facet that is bent, and the cone of its normals, hold most of a body: on a tube the far side, whose images in a chart jump.

use super::facets::Facets;
use super::regions::are_apart;
use crate::basis::Order;
use crate::geometry::{Bounds, MapTable};
use crate::linalg::Vector;
use crate::parallel;

/// Angle of normals to their mean from which on a facet is looked at by its parts \[rad\].
const TURNS: f64 = std::f64::consts::PI / 18.0;
/// Most cuttings in four.
const CUTS: usize = 3;
/// Points along a direction of a part, whose box holds the part if it is inflated by this share of its diagonal.
const POINTS: usize = 5;
const BETWEEN: f64 = 0.05;
/// Share of the extent of a part by which its box is inflated in the search.
const SLACK: f64 = 0.15;

/// A part of a facet: a box, the normal at its centre and the largest angle of a normal to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningPart {
    bounds: Bounds<3>,
    normal: Vector<3>,
    cone: f64,
}

/// Whether a facet turns much.
pub(super) fn any_turns(facets: &Facets<'_>) -> bool {
    facets.list.iter().any(|facet| facet.cone > TURNS)
}

/// The parts of every facet.
pub(super) fn all_parts(facets: &Facets<'_>) -> Vec<Vec<TurningPart>> {
    parallel::map_init(facets.list.len(), MapTable::new, |table, f| parts(facets, f, table))
}

/// The parts of a facet that turn little; the facet itself if it does so.
pub(super) fn parts(facets: &Facets<'_>, f: usize, table: &mut MapTable<2, 3>) -> Vec<TurningPart> {
    let mut out = Vec::new();
    collect(facets, f, CUTS, &mut out, table);
    out
}

fn collect(facets: &Facets<'_>, f: usize, cuts: usize, out: &mut Vec<TurningPart>, table: &mut MapTable<2, 3>) {
    let facet = &facets.list[f];
    let quarters = (cuts > 0 && facet.cone > TURNS).then(|| facets.quarters(f)).flatten();
    match quarters {
        Some(quarters) => (0..quarters.list.len()).for_each(|k| collect(&quarters, k, cuts - 1, out, table)),
        None => {
            facets.at(f, &facet.polygon.grid(POINTS), Order::Values, table);
            let Some(bounds) = Bounds::around(&table.x) else { return };
            out.push(TurningPart { bounds: bounds.inflated(BETWEEN * bounds.diagonal()), normal: facet.normal, cone: facet.cone });
        }
    }
}

/// Whether a part of one facet and a part of another come within `reach` of each other with normals that may oppose; `sign` as of the facets.
pub(super) fn any_near(own: &[TurningPart], other: &[TurningPart], reach: f64, sign: f64) -> bool {
    own.iter().any(|a| {
        let around = a.bounds.inflated(reach + SLACK * a.bounds.diagonal());
        other.iter().any(|b| around.meets(&b.bounds) && !are_apart((&a.normal, a.cone), (&b.normal, b.cone), sign))
    })
}

#[cfg(test)]
mod tests {
    use crate::basis::{BSpline, Rational, TensorProduct};
    use crate::coupling::InterfaceQuadrature;
    use crate::coupling::interface::{MergedSurface, Tolerance};
    use crate::geometry::ControlPoints;
    use crate::linalg::Vector;

    /// n arcs from the angle `from`, of the angle `total` together: points and weights.
    fn arcs(n: usize, from: f64, total: f64) -> Vec<(Vector<2>, f64)> {
        let half = 0.5 * total / n as f64;
        let at = |k: usize| {
            let (angle, r) = (from + half * k as f64, if k.is_multiple_of(2) { 1.0 } else { 1.0 / half.cos() });
            (Vector::<2>::new(r * angle.cos(), r * angle.sin()), 1.0 / r)
        };
        (0..=2 * n).map(at).collect()
    }

    /// Part of a torus of the radii 2 and 0.6: n elements about its tube, m along 170 degrees of it.
    fn torus(n: usize, m: usize, from: f64) -> ControlPoints<Rational<TensorProduct<2, BSpline>>, 3> {
        let basis = TensorProduct::new([BSpline::uniform(2, n, 0), BSpline::uniform(2, m, 0)]);
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for (along, w) in arcs(m, 0.0, 170f64.to_radians()) {
            for (about, v) in arcs(n, from, 2.0 * std::f64::consts::PI) {
                let r = 2.0 + 0.6 * about[0];
                points.push(Vector::<3>::new(r * along[0], r * along[1], 0.6 * about[1]));
                weights.push(w * v);
            }
        }
        ControlPoints { basis: Rational::try_new(basis, weights).unwrap(), points }
    }

    /// The far side of a tube is no candidate: its images jump, and took thousands of points each.
    #[test]
    fn elements_of_a_torus_that_turn_much_are_paired() {
        let (slave, master) = (torus(8, 2, 0.0), torus(12, 2, 0.3));
        for tolerance in [Tolerance::Exact, Tolerance::Given(f64::INFINITY)] {
            let found = MergedSurface::tied(4, tolerance).segments(&slave, &master).unwrap();
            assert!((found.report.covered / found.report.slave_measure - 1.0).abs() < 1e-12);
            assert!(found.report.lost.is_empty());
            let meant = 2.0 * std::f64::consts::PI * 0.6 * 2.0 * 170f64.to_radians();
            assert!((found.report.covered / meant - 1.0).abs() < 1e-6, "{}", found.report.covered);
            assert!(found.num_pieces() <= 80, "{}", found.num_pieces());
        }
    }
}
