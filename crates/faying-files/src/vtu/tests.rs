//! Linear cells of bent elements.

use super::{CellStyle, Part, write};
use crate::vtu_read::parse;
use crate::{CellShape, Limits};
use faying::basis::{BSpline, Cell};
use faying::geometry::ControlNet;
use faying::geometry::shapes::{annulus_sector, disc_sector, plate_with_hole, sphere_octant};
use faying::linalg::Vector;
use faying::space::{Body, Mapping, Mesh, Patch, PatchSpec, Space};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Linear cells of the whole of a space: their points, and per cell its corners, first axis fastest.
fn linear<const N: usize>(space: &Arc<dyn Space<N, N>>) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let bytes = write(&[Part::new("body", space.clone(), CellStyle::Linear)]).unwrap();
    let mesh = parse(&bytes, &Limits::default()).unwrap().mesh().unwrap();
    let [block] = &mesh.blocks[..] else { panic!("one kind of cells") };
    let simplex = matches!(block.shape, CellShape::Triangle | CellShape::Tetrahedron);
    let corners = if simplex { N + 1 } else { 1 << N };
    (mesh.points.clone(), block.nodes.chunks_exact(corners).map(<[u32]>::to_vec).collect())
}

/// Determinants of the edges at the corners of a cell: at the first of a simplex, at all of a cube.
fn determinants<const N: usize>(x: &[[f64; 3]], cell: &[u32]) -> Vec<f64> {
    let simplex = cell.len() == N + 1;
    let at = |i: usize| Vector::<3>::from(x[cell[i] as usize]);
    let of = |corner: usize| {
        let mut edges = [Vector::<3>::z(); 3];
        for (k, edge) in edges.iter_mut().enumerate().take(N) {
            let (to, sign) = if simplex { (k + 1, 1.0) } else { (corner ^ (1 << k), if corner >> k & 1 == 1 { -1.0 } else { 1.0 }) };
            *edge = sign * (at(to) - at(corner));
        }
        edges[0].cross(&edges[1]).dot(&edges[2])
    };
    (0..if simplex { 1 } else { cell.len() }).map(of).collect()
}

/// The plane map moved along z.
fn extruded(net: &ControlNet<2, 2>) -> ControlNet<3, 3> {
    let [u, v] = net.axes.clone();
    let points = [0.0, 1.0].iter().flat_map(|z| net.points.iter().map(move |p| Vector::<3>::new(p[0], p[1], *z))).collect();
    let weights = net.weights.as_ref().map(|w| [&w[..], w].concat());
    ControlNet::try_new([u, v, BSpline::try_new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap()], points, weights).unwrap()
}

#[test]
fn linear_tetrahedra_of_a_quarter_ring_are_positive_and_fit() {
    // the angle may fall: a left-handed and a right-handed patch
    for angle in [[0.0, 90.0], [90.0, 0.0]] {
        let ring = extruded(&annulus_sector([0.0, 0.0], [1.0, 2.0], angle).unwrap());
        for p in 1..=4 {
            let spec = PatchSpec::new(ring.clone()).with_degree([p; 3]).with_elements([2, 2, 1]).with_cells(Cell::Simplex);
            let space = Mesh::<2, 3>::from_patch(&spec).unwrap().space().clone();
            let (x, cells) = linear(&space);
            assert_eq!(cells.len(), space.num_elements() * p * p * p, "degree {p}: the lattice is fine enough");
            let volumes: Vec<f64> = cells.iter().map(|cell| determinants::<3>(&x, cell)[0] / 6.0).collect();
            let least = volumes.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(least > 0.0, "degree {p}, {angle:?}: a tetrahedron of volume {least}");
            let mut sides: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
            for cell in &cells {
                for k in 0..4 {
                    let mut side = cell.clone();
                    side.remove(k);
                    side.sort_unstable();
                    *sides.entry(side).or_default() += 1;
                }
            }
            // 16 squares around the body, each of two triangles
            let outer = sides.values().filter(|count| **count == 1).count();
            assert_eq!(outer, 32 * p * p, "degree {p}: neighbours cut their common side alike");
            assert!(sides.values().all(|count| *count <= 2));
            // their boundary is the polygon between points on the two circles
            let step = std::f64::consts::FRAC_PI_4 / p as f64;
            let (volume, expected) = (volumes.iter().sum::<f64>(), 3.0 * p as f64 * step.sin());
            assert!((volume - expected).abs() < 2e-3, "degree {p}: {volume}, not {expected}");
        }
    }
}

/// A band along a quarter circle whose lines across stand at 20 degrees to it.
fn slanted() -> ControlNet<2, 2> {
    let ring = annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap();
    let half = ring.points.len() / 2;
    let (sin, cos) = 110.0_f64.to_radians().sin_cos();
    let across = |p: &Vector<2>| p + 0.1 * Vector::<2>::new(cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]);
    let inner = &ring.points[..half];
    let points = inner.iter().copied().chain(inner.iter().map(across)).collect();
    ControlNet::try_new(ring.axes.clone(), points, ring.weights.clone()).unwrap()
}

#[test]
fn lattices_too_coarse_for_a_bend_are_doubled() {
    fn check<const N: usize>(space: &Arc<dyn Space<N, N>>, coarse: usize) {
        let (x, cells) = linear(space);
        let least = cells.iter().flat_map(|cell| determinants::<N>(&x, cell)).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0, "{:?}, dimension {N}: {least}", space.cell(0));
        // chords of 45 degrees stand at 22.5 degrees to the circle, those of half the length at 11.25
        assert_eq!(cells.len(), coarse << N, "{:?}, dimension {N}", space.cell(0));
    }
    for (cell, pieces) in [(Cell::Tensor, [1, 1]), (Cell::Simplex, [2, 6])] {
        let plane = PatchSpec::new(slanted()).with_elements([1, 1]).with_cells(cell).with_mapping(Mapping::Exact);
        check(Mesh::<1, 2>::from_patch(&plane).unwrap().space(), 4 * pieces[0]);
        let solid = PatchSpec::new(extruded(&slanted())).with_elements([1; 3]).with_cells(cell).with_mapping(Mapping::Exact);
        check(Mesh::<2, 3>::from_patch(&solid).unwrap().space(), 8 * pieces[1]);
    }
}

#[test]
fn usual_shapes_keep_their_lattice() {
    fn check<const N: usize>(space: &Arc<dyn Space<N, N>>, p: usize) {
        let (x, cells) = linear(space);
        let least = cells.iter().flat_map(|cell| determinants::<N>(&x, cell)).fold(f64::INFINITY, f64::min);
        let (kind, sides) = (space.cell(0), p.max(2).pow(N as u32));
        assert!(least > -1e-12, "{kind:?}, degree {p}, dimension {N}: {least}");
        assert!(cells.len() <= space.num_elements() * sides, "{kind:?}, degree {p}, dimension {N}: {} cells", cells.len());
    }
    let shapes =
        [disc_sector([0.0, 0.0], 1.0, [0.0, 90.0]), plate_with_hole(1.0, 4.0), annulus_sector([0.0, 0.0], [1.0, 1.1], [0.0, 90.0])];
    let solids: Vec<_> = shapes.iter().map(|s| extruded(s.as_ref().unwrap())).chain(sphere_octant([0.0; 3], [1.0, 2.0])).collect();
    for p in 1..=4 {
        for net in shapes.iter().flatten() {
            let spec = PatchSpec::new(net.clone()).with_degree([p; 2]).with_elements([2, 2]);
            check(Patch::<1, 2>::try_new(&spec).unwrap().space(), p);
            check(Mesh::<1, 2>::from_patch(&spec).unwrap().space(), p);
            Mesh::<1, 2>::from_patch(&spec.with_cells(Cell::Simplex)).iter().for_each(|mesh| check(mesh.space(), p));
        }
        for net in &solids {
            let spec = PatchSpec::new(net.clone()).with_degree([p; 3]).with_elements([2, 2, 1]);
            check(Patch::<2, 3>::try_new(&spec).unwrap().space(), p);
            check(Mesh::<2, 3>::from_patch(&spec).unwrap().space(), p);
            Mesh::<2, 3>::from_patch(&spec.with_cells(Cell::Simplex)).iter().for_each(|mesh| check(mesh.space(), p));
        }
    }
}
