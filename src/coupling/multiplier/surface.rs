//! Multiplier spaces on surfaces.

use super::dual_surface::dual_surface;
use super::edges::{ALL, Grid};
use super::handed_on::handed_on;
use super::kind::{functions_of, known_here, polynomials_of};
use super::{Ends, MultiplierError, MultiplierKind, SideEnd, end_lowered};
use crate::basis::Basis;
use crate::linalg::Real;
use crate::space::Space;
use std::sync::Arc;

/// Builds the multiplier space of `kind` on the surface `space`, for one component.
///
/// `constrained`: whether a function of the side is constrained in this component (prescribed, or on a cross point or edge). Where the
/// functions are products of those of two directions, polynomials are products, too, and their inf-sup constant is the product of those
/// of the directions: the degree across an edge is lowered along the whole edge if a function within it is constrained, and a constrained
/// corner alone lowers the shorter one of its edges. An edge that is a pole is lowered if its function is constrained; the multipliers along it
/// are then apart. On all other sides every constrained function gives its multiplier to one beside it: the space
/// then holds constants along constrained edges, and loses half an order in L2 there. Of p/p-k and constants
/// nothing is lowered.
///
/// On triangles p/p-k is continuous. Inf-sup constants in L2, traces zero along the rim: 0.21 and more for p/p-1 at p = 2, 0.66 for p/p-2 at
/// p = 3, 0.51 at p = 4, from 2 to 12 elements along an edge.
///
/// # Errors
/// [`MultiplierError::NotHere`] and [`MultiplierError::NoDual`] where the side has no such space, [`MultiplierError::NothingLeftAtEdge`] and
/// [`MultiplierError::NothingFree`] where it is too small to be lowered.
///
/// # Example
/// A square of 4 x 3 elements of degree 2, held along the edge where the first direction begins:
/// ```
/// use faying::basis::Basis;
/// use faying::coupling::multiplier::{MultiplierKind, build_on_surface};
/// use faying::space::{Body, Patch, PatchSpec};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let net = faying::geometry::shapes::brick([0.0; 3], [1.0; 3])?;
/// let body = Patch::<2, 3>::try_new(&PatchSpec::new(net).with_elements([4, 3, 2]))?;
/// let side = body.trace("w0")?.space; // 6 x 5 functions
/// let psi = build_on_surface(&side, MultiplierKind::Lowered(0), &|function| function % 6 == 0)?;
/// assert_eq!(psi.num_functions(), 5 * 5);
/// # Ok(())
/// # }
/// ```
pub fn build_on_surface<const N: usize, T: Real>(
    space: &Arc<dyn Space<2, N, T>>,
    kind: MultiplierKind,
    constrained: &dyn Fn(usize) -> bool,
) -> Result<Box<dyn Basis<2, T>>, MultiplierError> {
    let basis: &dyn Basis<2, T> = &**space;
    let kind = kind.resolved(basis);
    let known = || known_here(basis).join(", ");
    if kind == MultiplierKind::Dual {
        let constrained: Vec<bool> = (0..basis.num_functions()).map(constrained).collect();
        return dual_surface(space, &constrained);
    }
    let found = functions_of(space, kind)?;
    if !kind.lowers_ends(basis) {
        return Ok(found);
    }
    let always = matches!(kind, MultiplierKind::Uniform { ends: Ends::Lowered, .. });
    let grid = Grid::of(basis).and_then(|grid| Some((grid.polynomials(polynomials_of(basis, kind)?)?, grid)));
    if let Some((axes, grid)) = grid {
        let edges = if always { grid.edges() } else { grid.constrained_edges(&**space, constrained) };
        if edges == [[false; 2]; 2] {
            return Ok(found);
        }
        if let Some(product) = grid.product(lowered(axes, edges)?, edges) {
            return Ok(product);
        }
    }
    if always {
        return Err(MultiplierError::NotHere { wanted: kind.to_string(), degree: super::least_degree(basis), known: known() });
    }
    let constrained: Vec<bool> = (0..basis.num_functions()).map(constrained).collect();
    // of those that are numbered otherwise there are more than functions of the side
    if constrained.contains(&true) && numbered_alike(&*found, basis) { handed_on(found, &constrained) } else { Ok(found) }
}

/// The `axes`, each of a degree less at the ends of `edges`.
fn lowered<T: Real>(axes: [Box<dyn Basis<1, T>>; 2], edges: [[bool; 2]; 2]) -> Result<[Box<dyn Basis<1, T>>; 2], MultiplierError> {
    let ends = |k: usize, elements: usize| -> Vec<SideEnd> {
        let of = |end: usize| SideEnd { element: if end == 0 { 0 } else { elements - 1 }, at: end };
        ALL.into_iter().filter(|&(axis, end)| axis == k && edges[k][end]).map(|(_, end)| of(end)).collect()
    };
    let mut lowered = axes.into_iter().enumerate().map(|(k, axis)| {
        let ends = ends(k, axis.num_elements());
        end_lowered(axis, &ends).map_err(|error| match error {
            // of an only element that loses two degrees, it is the second one that is missing
            MultiplierError::NothingLeft { element, degree } => {
                let end = ends.iter().rev().find(|end| end.element == element).map_or(0, |end| end.at);
                MultiplierError::NothingLeftAtEdge { axis: k, end, degree }
            }
            other => other,
        })
    });
    let mut next = || lowered.next().expect("two directions");
    Ok([next()?, next()?])
}

/// Whether the functions of both bases have the same numbers on every element.
pub(crate) fn numbered_alike<const S: usize, T: Real>(psi: &dyn Basis<S, T>, basis: &dyn Basis<S, T>) -> bool {
    let (mut ids, mut others) = (Vec::new(), Vec::new());
    psi.num_functions() == basis.num_functions()
        && (0..basis.num_elements()).all(|element| {
            basis.active(element, &mut ids);
            psi.active(element, &mut others);
            ids == others
        })
}
