//! Element size: the largest distance between two points of an element.

use super::Space;
use crate::basis::{Cell, Order};
use crate::geometry::{MapTable, Sampler, cell};
use crate::linalg::Real;
use crate::parallel;

/// Points per direction between which distances are taken: corners and midpoints, so that curved edges count.
const POINTS: usize = 3;

/// Returns the largest diameter of the elements of `space` \[length\], over corners and midpoints of edges, faces and cells.
pub fn diameter<const N: usize, T: Real, X: Space<N, N, T> + ?Sized>(space: &X) -> T {
    let points = [Cell::Tensor, Cell::Simplex].map(|c| [cell::grid::<N, T>(c, POINTS), cell::corners::<N, T>(c)]);
    let of = |(map, table): &mut (Sampler<'_, N, N, T, X>, MapTable<N, N, T>), e: usize| {
        let (kind, affine) = (usize::from(space.cell(e) == Cell::Simplex), usize::from(space.map_structure().is_affine(e)));
        map.map(e, 2 * kind + affine, &points[kind][affine], table);
        let pairs = table.x.iter().enumerate().flat_map(|(k, a)| table.x[..k].iter().map(move |b| (a - b).norm_squared()));
        pairs.fold(T::zero(), |most, d| most.max(d))
    };
    let maps = || (Sampler::new(space, Order::Values), MapTable::new());
    let largest = parallel::map_init(space.num_elements(), maps, of).into_iter().fold(T::zero(), T::max);
    largest.sqrt()
}
