//! Middles and outward normals of the groups of a mesh that are sides.

use super::SidePlace;
use faying::assembly::gauss_rules;
use faying::basis::Order;
use faying::coupling::interface::slave_segments;
use faying::geometry::MapTable;
use faying::linalg::Vector;
use faying::space::{Body, Dimension, Mapping, Mesh, Trace};
use faying_files::MeshFile;
use std::collections::BTreeMap;

/// Mean normals shorter than this are none: the side closes around the body.
const CLOSED: f64 = 0.1;

/// Per label of a group that is a side of the whole mesh, the mean of its points and the direction of its mean outward normal; none where
/// the mesh is no body.
pub(super) fn places(mesh: &MeshFile) -> BTreeMap<String, SidePlace> {
    let found = match mesh.dimension() {
        2 => of::<1, 2>(mesh),
        3 => of::<2, 3>(mesh),
        _ => None,
    };
    found.unwrap_or_default()
}

fn of<const S: usize, const N: usize>(mesh: &MeshFile) -> Option<BTreeMap<String, SidePlace>>
where
    Trace<S, N>: Dimension<S, N>,
{
    let cells = mesh.cells::<N>(None).ok()?;
    let body = Mesh::<S, N>::from_cells(&cells, 1, Mapping::Exact).ok()?;
    let sides = body.sides().into_iter().filter(|side| cells.tags.iter().any(|tag| tag.name == *side));
    Some(sides.filter_map(|side| Some((side.clone(), place(&body.trace(&side).ok()?)))).collect())
}

/// Means over a side.
fn place<const S: usize, const N: usize>(side: &Trace<S, N>) -> SidePlace {
    let points = slave_segments(&*side.space, &gauss_rules(&*side.space, 0));
    let (mut x, mut normal, mut map) = (Vector::<N>::zeros(), Vector::<N>::zeros(), MapTable::new());
    for piece in 0..points.num_pieces() {
        let (element, range) = (points.slave[piece], points.points(piece));
        side.space.map(element, &points.slave_xi[range.clone()], Order::Gradients, &mut map);
        for (q, ds) in points.ds[range].iter().enumerate() {
            x += map.x[q] * *ds;
            normal += side.normal(element, &map.jacobian[q]) * *ds;
        }
    }
    let [x, normal] = [x, normal].map(|sum| sum / points.measure());
    let in_space = |v: Vector<N>| std::array::from_fn(|k| v.get(k).copied().unwrap_or(0.0));
    let normal = Some(normal).filter(|n| n.norm() > CLOSED).map(|n| in_space(n.normalize()));
    SidePlace { middle: in_space(x), normal, closed_with: None }
}
