//! The space on a side of a body, with the embedding of each of its elements in the body.

use super::{FunctionSpace, SideError, Space};
use crate::basis::{Cell, Order};
use crate::geometry::{Bounds, ClosestPoint, Embedded, Embedding, MapTable, Oriented, Tree, cell, cross, unit_normal};
use crate::linalg::{Matrix, Real, Vector, lit, measure};
use std::collections::HashMap;
use std::sync::Arc;

/// A facet lies on a face of its cell if its corners are this near to it, in local coordinates.
const ON_FACE: f64 = 1e-9;
/// Corners of facets nearer than this share of the side's size are one corner.
const SAME_CORNER: f64 = 1e-9;
/// Measures below this share of the squares of the tangents are those of a pole.
const POLE: f64 = 1e-10;
/// Share of the way to the centre of the element of a point beside a pole.
const BESIDE: f64 = 1e-6;
/// A facet pushed out by this share of its element's size must leave the body.
const PUSH: f64 = 1e-3;

/// A space one dimension lower than its body, with facets. (S, N) stands for (N - 1, N).
#[derive(Clone, Debug)]
pub struct Trace<const S: usize, const N: usize, T: Real = f64> {
    /// Functions and map of the side, on its own elements.
    pub space: Arc<dyn Space<S, N, T>>,
    /// Function of the body for each function of the side.
    pub dofs: Vec<usize>,
    /// Embedding of each element of the side in the body's element.
    pub facets: Vec<Embedding<S, N, T>>,
    /// Per element: +1 or -1 times the cross product of the tangents points out of the body (curves: the tangent
    /// turned clockwise, (t_y, -t_x)).
    pub outward: Vec<T>,
}

impl<const S: usize, const N: usize, T: Real> Trace<S, N, T> {
    /// Builds a side with its own space on the elements `facets`; computes `outward` as pointing away from the cell's centre.
    ///
    /// # Errors
    /// [`SideError::Interior`] where a facet is not on the boundary of the body.
    /// # Panics
    /// If there is not one facet per element and one dof per function.
    pub fn new(
        body: &Arc<dyn Space<N, N, T>>,
        space: Arc<dyn Space<S, N, T>>,
        dofs: Vec<usize>,
        facets: Vec<Embedding<S, N, T>>,
    ) -> Result<Self, SideError> {
        assert_eq!(space.num_elements(), facets.len(), "one facet per element of the side");
        let kinds: Vec<Cell> = (0..facets.len()).map(|e| space.cell(e)).collect();
        check_boundary(&**body, &facets, &kinds)?;
        Ok(Self::on_boundary(body, space, dofs, facets))
    }

    /// Builds a side as [`Trace::new`] does, from facets known to be on the boundary.
    pub(super) fn on_boundary(
        body: &Arc<dyn Space<N, N, T>>,
        space: Arc<dyn Space<S, N, T>>,
        dofs: Vec<usize>,
        facets: Vec<Embedding<S, N, T>>,
    ) -> Self {
        assert_eq!(space.num_functions(), dofs.len(), "one dof per function of the side");
        let kinds: Vec<Cell> = (0..facets.len()).map(|e| space.cell(e)).collect();
        let outward = look_out(&**body, &facets, &kinds);
        Self { space, dofs, facets, outward }
    }

    /// Restricts the body's functions and map to `facets` of the shape `kind`: the side of any body.
    ///
    /// Corner ids of the facets are found from the positions of their corners.
    /// # Errors
    /// [`SideError::Interior`] where a facet is not on the boundary of the body.
    pub fn from_facets(body: &Arc<dyn Space<N, N, T>>, facets: Vec<Embedding<S, N, T>>, kind: Cell) -> Result<Self, SideError> {
        let kinds = vec![kind; facets.len()];
        check_boundary(&**body, &facets, &kinds)?;
        let outward = look_out(&**body, &facets, &kinds);
        let corners = corner_ids(&**body, &facets, kind);
        let geometry = Embedded::new(body.clone(), facets.clone(), kind).with_corners(corners.clone());
        let (basis, dofs) = Embedded::new(body.clone(), facets.clone(), kind).with_corners(corners).restricted();
        Ok(Self { space: Arc::new(FunctionSpace { basis, geometry }), dofs, facets, outward })
    }

    /// The part of the side on `elements`, all of the shape `kind`: the functions that do not vanish there, with the polynomials of the side.
    pub fn part(&self, elements: &[usize], kind: Cell) -> Self {
        let whole = |&element: &usize| Embedding { element, origin: Vector::zeros(), axes: Matrix::<S, S, T>::identity() };
        let cells: Vec<Embedding<S, S, T>> = elements.iter().map(whole).collect();
        let corners = corner_ids(&*self.space, &cells, kind);
        let restrict = || Embedded::new(Arc::clone(&self.space), cells.clone(), kind).with_corners(corners.clone());
        let (basis, kept) = restrict().restricted();
        Self {
            space: Arc::new(FunctionSpace { basis, geometry: restrict() }),
            dofs: kept.into_iter().map(|function| self.dofs[function]).collect(),
            facets: elements.iter().map(|&e| self.facets[e]).collect(),
            outward: elements.iter().map(|&e| self.outward[e]).collect(),
        }
    }

    /// Replaces the space on the elements of the side, for instance by a [`Deformed`](super::Deformed) one.
    ///
    /// # Panics
    /// If the number of elements or functions differs.
    pub fn with_space(&self, space: Arc<dyn Space<S, N, T>>) -> Self {
        assert_eq!(space.num_elements(), self.facets.len(), "one facet per element of the side");
        assert_eq!(space.num_functions(), self.dofs.len(), "one dof per function of the side");
        Self { space, dofs: self.dofs.clone(), facets: self.facets.clone(), outward: self.outward.clone() }
    }

    /// Maps a local point of the side to the body's element and its local coordinates there.
    #[inline]
    pub fn lift(&self, element: usize, xi: &Vector<S, T>) -> (usize, Vector<N, T>) {
        let facet = &self.facets[element];
        (facet.element, facet.lift(xi))
    }

    /// The map of the side with its outward signs.
    pub fn oriented(&self) -> Oriented<Arc<dyn Space<S, N, T>>, T> {
        Oriented { map: Arc::clone(&self.space), outward: self.outward.clone() }
    }

    /// The unit normal out of the body where the side's map has the Jacobian `jacobian`.
    #[inline]
    pub fn normal(&self, element: usize, jacobian: &Matrix<N, S, T>) -> Vector<N, T> {
        unit_normal(jacobian, self.outward[element])
    }

    /// Outward unit normals at points of an element, whose map is left in `map`; at a pole, where the tangents are dependent up to rounding, the
    /// normal of a point beside it.
    pub fn normals(&self, element: usize, xi: &[Vector<S, T>], map: &mut MapTable<S, N, T>) -> Vec<Vector<N, T>> {
        self.space.map(element, xi, Order::Gradients, map);
        let mut beside = MapTable::new();
        let center = cell::center::<S, T>(if S == 1 { Cell::Tensor } else { self.space.cell(element) });
        let normal = |(jacobian, xi): (&Matrix<N, S, T>, &Vector<S, T>)| {
            if S < 2 || measure(jacobian) > jacobian.norm_squared() * lit(POLE) {
                return self.normal(element, jacobian);
            }
            self.space.map(element, &[xi + (center - xi) * lit::<T>(BESIDE)], Order::Gradients, &mut beside);
            self.normal(element, &beside.jacobian[0])
        };
        map.jacobian.iter().zip(xi).map(normal).collect()
    }
}

/// The local points of a facet's corners in its parent.
fn lifted<const S: usize, const N: usize, T: Real>(facet: &Embedding<S, N, T>, kind: Cell) -> Vec<Vector<N, T>> {
    cell::corners::<S, T>(kind).iter().map(|c| facet.lift(c)).collect()
}

/// Computes the sign of every facet: the cross product of its tangents against the vector from the parent's centre.
fn look_out<const S: usize, const N: usize, T: Real>(body: &dyn Space<N, N, T>, facets: &[Embedding<S, N, T>], kinds: &[Cell]) -> Vec<T> {
    let mut table = MapTable::new();
    facets
        .iter()
        .zip(kinds)
        .map(|(facet, &kind)| {
            let xi = facet.lift(&cell::center::<S, T>(kind));
            let away = xi - cell::center::<N, T>(body.cell(facet.element));
            body.map(facet.element, &[xi], Order::Gradients, &mut table);
            // cofactors carry reference normals to physical ones; their sign survives any map that is not singular here
            let tangents: Matrix<N, S, T> = table.jacobian[0] * facet.axes;
            if cross(&tangents).dot(&(table.jacobian[0] * away)) < T::zero() { -T::one() } else { T::one() }
        })
        .collect()
}

/// Checks that every facet lies on a face of its cell that no other element has.
fn check_boundary<const S: usize, const N: usize, T: Real>(
    body: &dyn Space<N, N, T>,
    facets: &[Embedding<S, N, T>],
    kinds: &[Cell],
) -> Result<(), SideError> {
    let mut ids = Vec::new();
    let mut named: HashMap<Vec<usize>, (usize, usize)> = HashMap::new();
    let mut unnamed = Vec::new();
    for (f, facet) in facets.iter().enumerate() {
        let parent = body.cell(facet.element);
        let face = cell::face_of(parent, &lifted(facet, kinds[f]), lit(ON_FACE)).ok_or(SideError::Interior { facet: f })?;
        body.corners(facet.element, &mut ids);
        let local = &cell::faces::<N, T>(parent)[face].corners;
        if ids.is_empty() {
            unnamed.push(f);
        } else {
            named.insert(sorted(local.iter().map(|&c| ids[c])), (facet.element, f));
        }
    }
    if !named.is_empty() {
        let mut inside = None::<usize>;
        for e in 0..body.num_elements() {
            body.corners(e, &mut ids);
            if ids.is_empty() {
                continue;
            }
            for face in cell::faces::<N, T>(body.cell(e)) {
                if let Some(&(element, f)) = named.get(&sorted(face.corners.iter().map(|&c| ids[c])))
                    && element != e
                {
                    inside = Some(inside.map_or(f, |g| g.min(f)));
                }
            }
        }
        if let Some(facet) = inside {
            return Err(SideError::Interior { facet });
        }
    }
    if unnamed.is_empty() { Ok(()) } else { check_by_leaving(body, facets, kinds, &unnamed) }
}

fn sorted(ids: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut ids: Vec<usize> = ids.collect();
    ids.sort_unstable();
    ids
}

/// Checks facets of cells without corner ids: a point pushed out through the facet must not be in the body.
fn check_by_leaving<const S: usize, const N: usize, T: Real>(
    body: &dyn Space<N, N, T>,
    facets: &[Embedding<S, N, T>],
    kinds: &[Cell],
    which: &[usize],
) -> Result<(), SideError> {
    let closest = ClosestPoint::<N, N, _, T>::new(body);
    let mut table = MapTable::new();
    for &f in which {
        let facet = &facets[f];
        let xi = facet.lift(&cell::center::<S, T>(kinds[f]));
        body.map(facet.element, &[xi], Order::Gradients, &mut table);
        let jacobian = table.jacobian[0];
        let mut normal = cross(&(jacobian * facet.axes));
        if normal.dot(&(jacobian * (xi - cell::center::<N, T>(body.cell(facet.element))))) < T::zero() {
            normal = -normal;
        }
        let push = body.bounds(facet.element).diagonal() * lit(PUSH);
        let Some(normal) = normal.try_normalize(T::zero()) else { continue };
        let left = closest.project(&(table.x[0] + normal * push)).is_none_or(|p| p.distance > push * lit(0.5));
        if !left {
            return Err(SideError::Interior { facet: f });
        }
    }
    Ok(())
}

/// Corner ids of facets: coinciding corners have the same id.
fn corner_ids<const S: usize, const D: usize, const N: usize, T: Real>(
    body: &dyn Space<D, N, T>,
    facets: &[Embedding<S, D, T>],
    kind: Cell,
) -> Vec<Vec<usize>> {
    let mut table = MapTable::new();
    let mut places: Vec<Vector<N, T>> = Vec::new();
    for facet in facets {
        body.map(facet.element, &lifted(facet, kind), Order::Values, &mut table);
        places.extend_from_slice(&table.x);
    }
    let Some(all) = Bounds::around(&places) else { return Vec::new() };
    let tree = Tree::new(places.iter().map(|p| Bounds { lo: *p, hi: *p }).collect());
    let tolerance = all.diagonal() * lit(SAME_CORNER);
    let ids: Vec<usize> =
        places.iter().map(|p| tree.meeting(&Bounds { lo: *p, hi: *p }.inflated(tolerance)).first().copied().unwrap_or(0)).collect();
    ids.chunks(cell::corners::<S, T>(kind).len()).map(<[usize]>::to_vec).collect()
}
