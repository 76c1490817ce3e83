//! The faces of a file as polygons for its picture: elements in the plane, the outer surface of bodies in space.

use super::CellMap;
use super::side_place::SidePlace;
use super::splines::{faces, map_of, name_of};
use crate::plot::faces::{FaceLabel, FacePlot, Polygon};
use faying::basis::{Elements, Order};
use faying::geometry::{Geometry, MapTable, cell};
use faying::linalg::Vector;
use faying_files::{Contents, MeshFile, SplineFile, SplinePatch};
use std::collections::BTreeMap;

/// Points on an edge of a curved element.
const FINE: usize = 7;

/// The outline of every element of a map of two parameters.
fn outlines(map: &dyn Geometry<2, 3>, straight: bool, part: usize, out: &mut Vec<Polygon>) {
    let mut table = MapTable::new();
    let n = if straight { 1 } else { FINE };
    for e in 0..map.num_elements() {
        let corners = cell::corners::<2, f64>(map.cell(e));
        let ring: &[usize] = if corners.len() == 3 { &[0, 1, 2] } else { &[0, 1, 3, 2] };
        let points: Vec<Vector<2>> = (0..ring.len())
            .flat_map(|k| {
                let (a, b) = (corners[ring[k]], corners[ring[(k + 1) % ring.len()]]);
                (0..n).map(move |i| a + (b - a) * (i as f64 / n as f64))
            })
            .collect();
        map.map(e, &points, Order::Values, &mut table);
        out.push(Polygon { points: table.x.iter().map(|x| [x[0], x[1], x[2]]).collect(), part, lines: None });
    }
}

/// The elements of a surface of quadrilaterals in space in small pieces, which hide each other as they should.
fn pieces(map: &dyn Geometry<2, 3>, part: usize, out: &mut Vec<Polygon>) {
    let grid = cell::grid::<2, f64>(faying::basis::Cell::Tensor, FINE);
    let mut table = MapTable::new();
    for e in 0..map.num_elements() {
        map.map(e, &grid, Order::Values, &mut table);
        let at = |i: usize, j: usize| -> [f64; 3] { table.x[i + FINE * j].into() };
        for (i, j) in (0..FINE - 1).flat_map(|j| (0..FINE - 1).map(move |i| (i, j))) {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let border = [j == 0, i + 2 == FINE, j + 2 == FINE, i == 0];
            let lines = (0..4).filter(|&k| border[k]).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
            out.push(Polygon { points: corners.to_vec(), part, lines: Some(lines) });
        }
    }
}

fn of_patch(patch: &SplinePatch, part: usize, out: &mut Vec<Polygon>) {
    match patch.dimension() {
        2 => {
            if let Ok(map) = map_of::<2>(patch) {
                let straight = patch.degree.iter().all(|p| *p == 1);
                let flat = patch.points.iter().all(|p| p[2] == 0.0);
                if flat || straight { outlines(&*map, straight, part, out) } else { pieces(&*map, part, out) }
            }
        }
        3 => faces(patch).iter().for_each(|(_, face)| of_patch(face, part, out)),
        _ => {}
    }
}

fn of_splines(file: &SplineFile, plot: &mut FacePlot) {
    for (k, patch) in file.patches.iter().enumerate() {
        let name = name_of(file, k);
        of_patch(patch, k, &mut plot.faces);
        plot.parts.push(name.clone());
        for (k, axis) in ["u", "v", "w"].into_iter().take(patch.dimension()).enumerate().filter(|_| patch.dimension() > 1) {
            for (end, place) in [0, 1].into_iter().filter_map(|end| Some((end, SidePlace::of(patch, k, end).ok()?))) {
                // a patch of a surface has no side that looks away
                let outward = place.normal.filter(|_| patch.dimension() == 3);
                if place.normal.is_some() {
                    plot.labels.push(FaceLabel { at: place.middle, text: format!("{name}.{axis}{end}"), outward });
                }
            }
        }
    }
}

/// Outlines of the facets that bound exactly one cell.
fn surface(mesh: &MeshFile, out: &mut Vec<Polygon>, parts: &BTreeMap<usize, usize>) {
    let mut seen: BTreeMap<Vec<u32>, (usize, Vec<u32>, usize)> = BTreeMap::new();
    for (b, block) in mesh.blocks.iter().enumerate().filter(|(_, b)| b.shape.dimension() == 3) {
        let Some(map) = CellMap::<3>::new(block, &mesh.points) else { continue };
        let (kind, p) = (map.cell(0), block.order);
        let corners = cell::corners::<3, f64>(kind);
        let places: Vec<usize> = corners.iter().map(|c| map.place(&std::array::from_fn(|k| p * (c[k] as usize)))).collect();
        for e in 0..map.num_elements() {
            for face in cell::faces::<3, f64>(kind) {
                let ring: Vec<usize> = match face.corners[..] {
                    [a, b, c, d] => vec![a, b, d, c],
                    _ => face.corners,
                };
                let ring: Vec<u32> = ring.into_iter().map(|c| map.nodes(e)[places[c]]).collect();
                let mut key = ring.clone();
                key.sort_unstable();
                seen.entry(key).or_insert_with(|| (b, ring, 0)).2 += 1;
            }
        }
    }
    for (block, ring, _) in seen.into_values().filter(|(_, _, n)| *n == 1) {
        out.push(Polygon { points: ring.iter().map(|&n| mesh.points[n as usize]).collect(), part: parts[&block], lines: None });
    }
}

fn of_mesh(mesh: &MeshFile, plot: &mut FacePlot) {
    let top = mesh.dimension();
    let mut parts = BTreeMap::new();
    for (k, block) in mesh.blocks.iter().enumerate().filter(|(_, b)| b.shape.dimension() == top) {
        let name = match block.groups.first().and_then(|g| mesh.groups.get(*g)) {
            Some(group) => group.label(),
            None => "no group".to_owned(),
        };
        let part = plot.parts.iter().position(|p| *p == name).unwrap_or_else(|| {
            plot.parts.push(name);
            plot.parts.len() - 1
        });
        parts.insert(k, part);
        if top == 2
            && let Some(map) = CellMap::<2>::new(block, &mesh.points)
        {
            outlines(&map, block.order == 1, part, &mut plot.faces);
        }
    }
    if top == 3 {
        surface(mesh, &mut plot.faces, &parts);
    }
    // names of sides stand at the point of the side nearest to its middle
    for (g, group) in mesh.groups.iter().enumerate().filter(|(_, g)| g.dimension + 1 == top) {
        let own = mesh.blocks.iter().filter(|b| b.groups.contains(&g));
        let points: Vec<Vector<3>> = own.flat_map(|b| b.nodes.iter().map(|&n| Vector::from(mesh.points[n as usize]))).collect();
        let middle = points.iter().sum::<Vector<3>>() / points.len().max(1) as f64;
        let nearest = points.iter().min_by(|a, b| (*a - middle).norm().total_cmp(&(*b - middle).norm()));
        if let Some(x) = nearest {
            plot.labels.push(FaceLabel { at: [x[0], x[1], x[2]], text: group.label(), outward: None });
        }
    }
}

/// The picture of a file: its faces and the names of its parts and sides.
pub fn picture(contents: &Contents, title: &str) -> FacePlot {
    let mut plot = FacePlot { title: title.to_owned(), ..FacePlot::default() };
    match contents {
        Contents::Patches(file) => of_splines(file, &mut plot),
        Contents::Mesh(mesh) => of_mesh(mesh, &mut plot),
    }
    plot
}
