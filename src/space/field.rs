//! Fields at points: values and gradients on an element, and the element that contains a physical point.

use super::{Field, Space};
use crate::basis::{Order, ShapeTable};
use crate::geometry::{ClosestPoint, Geometry, MapTable};
use crate::linalg::{Matrix, Real, Vector, inverse, lit, with_scratch};

/// A point off the body by less than this share of the nearest element's size is moved to the nearest point.
const OFF: f64 = 0.25;

/// A field of C components at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldAt<const C: usize, const N: usize, T: Real = f64> {
    /// Position of the point \[length\].
    pub x: Vector<N, T>,
    /// Value u.
    pub value: Vector<C, T>,
    /// du_i/dx_j at (i, j); not finite where the map is singular (a collapsed edge).
    pub gradient: Matrix<C, N, T>,
}

/// Evaluates the field with the unknowns `u` at the local points `xi` of `element`.
///
/// # Panics
/// If `field` has not C components.
pub fn field_at<const C: usize, const N: usize, T: Real, X: Space<N, N, T> + ?Sized>(
    space: &X,
    field: &Field,
    u: &[T],
    element: usize,
    xi: &[Vector<N, T>],
) -> Vec<FieldAt<C, N, T>> {
    assert_eq!(field.components, C, "the field has {C} components");
    with_scratch(|(shapes, map, ids): &mut Scratch<N, T>| {
        space.active(element, ids);
        space.evaluate(element, xi, Order::Gradients, shapes, map);
        (0..xi.len())
            .map(|q| {
                let mut value = Vector::<C, T>::zeros();
                let mut local = Matrix::<C, N, T>::zeros();
                for ((&i, &n), g) in ids.iter().zip(shapes.values(q)).zip(shapes.grads(q)) {
                    let u = Vector::<C, T>::from_fn(|c, _| u[field.unknown(i, c)]);
                    value += u * n;
                    local += u * g.transpose();
                }
                let gradient = inverse(&map.jacobian[q]).map_or_else(|| Matrix::repeat(T::one() / T::zero()), |j| local * j);
                FieldAt { x: map.x[q], value, gradient }
            })
            .collect()
    })
}

/// Functions, map and numbers of the functions of an element.
type Scratch<const N: usize, T> = (ShapeTable<N, T>, MapTable<N, N, T>, Vec<usize>);

/// Location of a physical point in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located<const N: usize, T: Real = f64> {
    /// The element.
    pub element: usize,
    /// Local coordinates.
    pub xi: Vector<N, T>,
    /// Image of `xi` \[length\].
    pub x: Vector<N, T>,
    /// Distance of the given point from `x`: zero inside, to rounding \[length\].
    pub distance: T,
}

/// A point outside every element.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the point is {distance:.4e} away from the body, more than a quarter of an element ({allowed:.4e})")]
pub struct OutsideBody {
    /// Distance to the nearest point of the body \[length\].
    pub distance: f64,
    /// Largest distance allowed \[length\].
    pub allowed: f64,
}

/// Finds elements by physical points, for many points of one body.
#[derive(Clone, Debug)]
pub struct Locator<const N: usize, G, T: Real = f64> {
    closest: ClosestPoint<N, N, G, T>,
}

impl<const N: usize, G: Geometry<N, N, T>, T: Real> Locator<N, G, T> {
    /// Builds the tree over the elements of `space`.
    pub fn new(space: G) -> Self {
        Self { closest: ClosestPoint::new(space) }
    }

    /// Closest points of the body, with the tree over its elements.
    pub fn closest(&self) -> &ClosestPoint<N, N, G, T> {
        &self.closest
    }

    /// Finds the element of the point `x`; a point off the body by less than a quarter of the nearest element's size moves to
    /// the nearest point. A point shared by elements belongs to the first that is found, always the same one.
    ///
    /// # Errors
    /// [`OutsideBody`] with the distance (infinite where the body is empty or `x` is not finite).
    pub fn locate(&self, x: &Vector<N, T>) -> Result<Located<N, T>, OutsideBody> {
        let Some(p) = self.closest.project(x) else { return Err(OutsideBody { distance: f64::INFINITY, allowed: 0.0 }) };
        let allowed = self.closest.geometry().bounds(p.element).diagonal() * lit(OFF);
        if p.distance > allowed {
            return Err(OutsideBody { distance: crate::linalg::to_f64(p.distance), allowed: crate::linalg::to_f64(allowed) });
        }
        Ok(Located { element: p.element, xi: p.xi, x: p.x, distance: p.distance })
    }
}

/// Finds the element and local coordinates of the point `x`; `None` if [`Locator::locate`] fails. For many points, and for the
/// distance of points outside, keep a [`Locator`].
pub fn locate<const N: usize, T: Real, G: Geometry<N, N, T> + ?Sized>(space: &G, x: &Vector<N, T>) -> Option<(usize, Vector<N, T>)> {
    Locator::new(space).locate(x).ok().map(|l| (l.element, l.xi))
}
