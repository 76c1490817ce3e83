//! Contract of [`Flux`]: the stress of the field behind the side times the outward normal, bounded by the energy.

use crate::assembly::{contract, gauss_rules};
use crate::basis::Order;
use crate::geometry::MapTable;
use crate::linalg::{Real, Vector, lit, measure, num};
use crate::physics::{Flux, FluxTable, Material, hoop_strain, stress_of};
use crate::quadrature::Quadrature;
use crate::space::{Field, Space, Trace, field_at};

/// Checks `flux` on `trace` of the body with functions and map `space`, unknowns `field` and a linear `material`.
///
/// Rules: the table has the declared shape and lists unknowns of the body once; for fields that oscillate from unknown to
/// unknown it gives sigma n; and ∫ |sigma n|² over a facet is at most the stabilisation times the energy of the element.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn flux<const C: usize, const S: usize, const N: usize, T: Real>(
    flux: &dyn Flux<S, N, T>,
    trace: &Trace<S, N, T>,
    space: &dyn Space<N, N, T>,
    field: Field,
    material: &dyn Material<C, N, T>,
) -> Result<(), String> {
    let unknowns = C * space.num_functions();
    let own_field = Field { first: 0, components: C };
    let (rules, inside) = (gauss_rules(&*trace.space, 0), gauss_rules(space, 0));
    let (mut table, mut map) = (FluxTable::default(), MapTable::new());
    let mut bound_met = T::zero();
    for e in 0..trace.space.num_elements() {
        let rule = rules.rule(e);
        let facet = &trace.facets[e];
        flux.tabulate(e, &rule.points, &mut table);
        let n = table.dofs.len();
        if table.components != C || table.values.len() != rule.points.len() * C * n {
            return Err(format!("the table of element {e} has not the shape points x components x unknowns"));
        }
        let mut sorted = table.dofs.clone();
        sorted.sort_unstable();
        if sorted.windows(2).any(|w| w[0] == w[1]) || sorted.iter().any(|&d| d < field.first || d >= field.first + unknowns) {
            return Err(format!("the table of element {e} lists an unknown twice or one that is not the body's"));
        }
        let stabilisation = flux.stabilisation(e);
        if !(stabilisation > T::zero() && stabilisation.is_finite()) {
            return Err(format!("the stabilisation of element {e} is {stabilisation}, not positive"));
        }
        let lifted: Vec<Vector<N, T>> = rule.points.iter().map(|xi| facet.lift(xi)).collect();
        trace.space.map(e, &rule.points, Order::Gradients, &mut map);
        for pattern in 0..3usize {
            let u: Vec<T> = (0..unknowns).map(|i| (num::<T>(i * (2 * pattern + 3)) + num(pattern)).sin()).collect();
            let samples = field_at::<C, N, T, _>(space, &own_field, &u, facet.element, &lifted);
            let mut flux_square = T::zero();
            for (q, s) in samples.iter().enumerate() {
                let normal = trace.normal(e, &map.jacobian[q]);
                let expected = stress_of(material, &s.x, &s.value, &s.gradient) * normal;
                for c in 0..C {
                    let row = &table.values[(q * C + c) * n..][..n];
                    let found = row.iter().zip(&table.dofs).fold(T::zero(), |sum, (&v, &d)| sum + v * u[d - field.first]);
                    let size = row.iter().fold(T::zero(), |m, v| m.max(v.abs())) * num(n);
                    if (found - expected[c]).abs() > T::default_epsilon() * num(1000) * size {
                        return Err(format!(
                            "component {c} of the flux of element {e} is {found} at point {q}, the stress gives {}",
                            expected[c]
                        ));
                    }
                    flux_square += rule.weights[q] * measure(&map.jacobian[q]) * found * found;
                }
            }
            let own = inside.rule(facet.element);
            let mut body = MapTable::new();
            space.map(facet.element, &own.points, Order::Gradients, &mut body);
            let energy = field_at::<C, N, T, _>(space, &own_field, &u, facet.element, &own.points).iter().enumerate().fold(
                T::zero(),
                |sum, (q, s)| {
                    let tangent = material.respond(&s.x, &s.gradient).tangent;
                    let strain = hoop_strain(&s.x, &s.value, &s.gradient, T::zero());
                    let around = material.hoop(&s.x).map_or(T::zero(), |hoop| hoop.energy(&s.gradient, strain));
                    sum + own.weights[q] * measure(&body.jacobian[q]) * (contract(&tangent, &s.gradient).dot(&s.gradient) + around)
                },
            );
            if flux_square > stabilisation * energy * lit(1.001) {
                return Err(format!("the flux of element {e} exceeds the stabilisation {stabilisation} times the energy"));
            }
            bound_met = bound_met.max(flux_square);
        }
    }
    if bound_met == T::zero() {
        return Err("the flux is zero everywhere".into());
    }
    Ok(())
}
